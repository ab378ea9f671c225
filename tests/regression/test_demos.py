# SPDX-License-Identifier: LGPL-2.1-or-later
"""The demo scenes do what their comments and doc/gallery.md say.

One physical check each, on coarser meshes.  SI units: forces of 1e7 N/m,
displacements of 1e-3 m, viscosities of 1e17 Pa s in one scene are a test of
scaling, too.
"""

import os
import re
import subprocess
import sys
import tempfile

import numpy as np

from harness import COUPLED, SOURCE, TestCase, main, run, scene_file
from runs import on_boundary


class SaltPillar(TestCase):
    DESCENT = 2.592e6  # s, end of the fast part

    # of the scene
    YOUNG, POISSON = 31e9, 0.25
    RATE, EXPONENT = 8.25e-46, 5
    HEIGHT = 3.0

    @classmethod
    def setUpClass(cls):
        cls.result = run(
            "salt_pillar_2d", {"Geometry/Arguments": "48, 24 : 0, 0 : 6, 3 : true"}
        )
        # the same without friction: uniaxial stress in plane strain, so one
        # cell would do
        cls.free = run(
            "salt_pillar_2d",
            {
                "Geometry/Arguments": "2, 1 : 0, 0 : 6, 3 : true",
                "Boundary 3/Friction law": "none",
                "Time/Phases": "2.592e6: 240, 5.184e6: 60, 3e8: 400",
                "Output/Fields every": 0,
            },
        )

    @staticmethod
    def strain(t):
        descent = 1.6e-3 * np.minimum(t / 2.592e6, 1)
        return (descent + 1.2e-3 * np.maximum(t - 2.592e6, 0) / 3.1536e7) / 3

    def stress(self, times, step):
        """sigma_yy at these times, compression positive, with sigma_xx = 0 and
        eps_zz = 0: Heun's method with steps near this size."""
        E, nu = self.YOUNG, self.POISSON

        def evaluate(t, creep):
            a, b = E * (self.strain(t) - creep[0]), -E * creep[1]
            yy, zz = np.array([a + nu * b, b + nu * a]) / (1 - nu**2)
            mises = np.sqrt(yy**2 + zz**2 - yy * zz)
            if mises == 0:
                return yy, np.zeros(2)
            deviator = np.array([2 * yy - zz, 2 * zz - yy]) / 3
            flow = 1.5 * self.RATE * mises ** (self.EXPONENT - 1) * deviator
            return yy, flow

        t, creep, result = 0.0, np.zeros(2), []
        for end in times:
            n = max(1, int(np.ceil((end - t) / step)))
            k = (end - t) / n
            for i in range(n):
                _, first = evaluate(t + i * k, creep)
                _, second = evaluate(t + (i + 1) * k, creep + k * first)
                creep = creep + k / 2 * (first + second)
            t = end
            result.append(evaluate(t, creep)[0])
        return np.array(result)

    def test_identities(self):
        self.check_identities(self.result, tolerance=COUPLED)
        self.check_identities(self.free, tolerance=COUPLED)

    def test_steady_creep_by_nortons_formula(self):
        """In steady flow sigma_zz = sigma_yy/2, so sigma_eq = sqrt(3)/2
        sigma_yy and the rate of eps_yy is sqrt(3)/2 A sigma_eq^n.  The final
        state of forward Euler does not depend on its step."""
        rate = 1.2e-3 / 3.1536e7 / self.HEIGHT
        half_root = np.sqrt(3) / 2
        steady = (rate / (half_root * self.RATE)) ** (1 / self.EXPONENT) / half_root
        self.assertClose(-self.free["reaction_3_y"][-1] / 6, steady, relative=1e-7)
        self.assertClose(
            self.free["max_von_mises"][-1], half_root * steady, relative=1e-7
        )

    def test_load_history_without_friction(self):
        """Forward Euler is of first order: 0.1 % with 240 steps of 3 hours."""
        rows = [self.free.row(t) for t in (0.5 * self.DESCENT, self.DESCENT)]
        self.assertClose(
            -self.free["reaction_3_y"][rows] / 6,
            self.stress(self.free["t"][rows], 2e3),
            relative=2e-3,
        )

    def test_friction_confines_the_pillar(self):
        """It carries more than without friction, more than 14.3 MPa, which
        steady creep alone could carry at the first rate; and sheds load when
        the descent slows down."""
        roof = -self.result["reaction_3_y"] / 6
        fast = self.result.row(self.DESCENT)
        self.assertGreater(roof[fast], 14.3e6)
        self.assertGreater(roof[-1], 1.1 * 8.17e6)
        self.assertLess(roof[-1], 0.75 * roof[fast])
        self.assertClose(self.result["capped_volume"], 0)

    def test_slip_zone_grows_from_the_edge(self):
        slip = self.result["slip_area"]
        ramp = self.result["t"] <= self.DESCENT * (1 + 1e-9)
        self.assertClose(slip[: np.argmax(self.result["t"] > 2e5)], 0)
        # a node more or less is a tie
        self.assertGreaterEqual(np.diff(slip[ramp]).min(), -1.01 * 6 / 48)
        self.assertGreater(slip[ramp][-1], 3)

        contact = self.result.fields("contact")
        stick = contact.point_data["stick"] > 0.5
        x = contact.points[:, 0]
        interior = x > 0.01  # on the axis there is no friction point
        self.assertLess(x[stick & interior].max(), x[~stick & interior].min())
        # outward slip, traction inwards at the bound
        traction = contact.point_data["traction"][:, 0]
        self.assertClose(traction[~stick & interior], -3e6, relative=1e-6)
        self.assertGreater(contact.point_data["slip"][:, 0].max(), 1e-3)


class SaltPillarUnderRock(TestCase):
    def test_what_a_rigid_roof_leaves_out(self):
        """Statics say what the seam carries; the roof presses on the pillar's edge
        more than a rigid one, and rubs more, until salt has crept away."""
        elastic, rigid = (
            run(
                "salt_pillar_rock_2d",
                {
                    "Geometry/Arguments": "24, 12 : 0, 0 : 6, 3 : true | "
                    "24, 24 : 0, 3 : 12, 15 : true",
                    "Material 1/Young's modulus": modulus,
                    "Time/Phases": "2.592e6: 20, 3.42144e7: 40",
                    "Output/Fields every": 0,
                },
            )
            for modulus in (15e9, 1e13)
        )
        driven = elastic.row(2.592e6)
        for result in elastic, rigid:
            self.check_identities(result, tolerance=COUPLED)
            self.assertClose(result["contact_force_y"][driven], 72e6, relative=1e-6)
        for column, now, then in (
            ("max_pressure", 1.2, 1.02), ("friction_dissipation", 5, 1.4)
        ):
            ratio = elastic[column] / np.maximum(rigid[column], 1e-300)
            self.assertGreater(ratio[driven], now)
            self.assertLess(ratio[-1], then)
        sag = elastic["point1_y"] - elastic["point2_y"]
        self.assertGreater(sag[driven], 5e-3)


class SaltDrift(TestCase):
    """Initial stress and weight in equilibrium, numbers with units."""

    SHORT = {
        "Geometry/File": SOURCE / "prm" / "demos" / "salt_drift_2d.msh",
        "Geometry/Global refinements": 0,
        "Time/Phases": "20: 10, 1 year: 20",
        "Output/Fields every": 0,
    }
    DEPTH = "0.022e6*(700 - y)"
    IN_SI = {
        "Material/norton/Rate factor": "0.18*exp(-54000/(8.314*300))*1e-30/86400",
        "Initial state/Stress": f"-{DEPTH}; -{DEPTH}; -{DEPTH}; 0",
        "Boundary 1/Pressure": f"{DEPTH}*max(0, 1 - t/1728000)",
        "Boundary 5/Pressure": DEPTH,
        "Time/Phases": "1728000: 10, 31557600: 20",
    }

    def test_the_same_in_si_units(self):
        declared = run("salt_drift_2d", self.SHORT)
        text = scene_file("salt_drift_2d").read_text()
        text = re.sub(r"subsection Units.*?\nend\n", "", text, flags=re.DOTALL)
        for unit, power in (" GPa", "e9"), (" MPa", "e6"), (" kN/m^3", "e3"):
            text = text.replace(unit, power)
        text = text.replace("20: 20, 10 year: 200", "1: 1")  # that of IN_SI
        plain = run("salt_drift_2d", {**self.SHORT, **self.IN_SI}, text=text)
        header = (declared.directory / "statistics.csv").read_text().splitlines()[0]
        self.assertIn(",t [day],", header)
        self.assertIn(",max_von_mises [MPa],", header)
        self.assertEqual(len(declared["t"]), len(plain["t"]))
        self.assertClose(plain["t"], 86400 * declared["t"], relative=1e-6)
        for name in ("point0_y", "point1_y", "point2_x"):
            self.assertClose(
                plain[name], declared[name], absolute=1e-6 * abs(plain[name]).max()
            )
        name = "max_von_mises"
        self.assertClose(plain[name][-1], 1e6 * declared[name][-1], relative=1e-6)
        # The drift closes: roof down, floor up, rib inwards.
        self.assertLess(declared["point1_y"][-1], -0.010)
        self.assertGreater(declared["point0_y"][-1], 0.010)
        self.assertLess(declared["point2_x"][-1], -0.010)

    def test_at_rest(self):
        """While the pressure of the wall stays, the base carries what is above."""
        at_rest = {**self.SHORT, "Boundary 1/Pressure": "0.022*(700 - y)"}
        result = run(
            "salt_drift_2d", {**at_rest, "Material/Volumetric integration": "full"}
        )
        self.assertLess(result["max_displacement"].max(), 1e-12)
        self.assertClose(result["reaction_3_y"], -result["load_y"], relative=1e-9)
        # Mean dilatation leaves some of a pressure that varies in cells.
        result = run("salt_drift_2d", at_rest)
        self.assertLess(result["max_displacement"].max(), 3e-4)


class SaltCavern(TestCase):
    """A body of revolution, pressure by table, temperature by depth and time."""

    FILES = {
        "Table 1/File": SOURCE / "prm" / "demos" / "salt_cavern_2d.csv",
        "Output/Fields every": 0,
    }

    def test_closes_like_a_thick_sphere(self):
        """Bailey's formula, with the rate that Arrhenius gives at 328 K."""
        shape = "sin(pi*y)*(y < 0.999)*(y > 0.001)", "cos(pi*y)"
        result = run(
            "salt_cavern_2d",
            {
                **self.FILES,
                "Geometry/Coordinates": f"30*(1400/30)^x*{shape[0]}; "
                f"-1500 - 30*(1400/30)^x*{shape[1]}",
                "Temperature/Value": 328,
                "Loads/Body force": "",
                "Initial state/Stress": "",
                "Initial state/Equilibrate": "false",
                "Boundary 0/Pressure": "-15*min(1, t)",
                "Boundary 1/Pressure": 0,
                "Output/Points": "30, -1500",
                "Time/Phases": "1: 5, 30: 15, 3000: 30",
            },
        )
        n, a, b = 5, 30.0, 1400.0
        A = 0.18 * 365.25 * np.exp(-54e3 / 8.314462618 / 328)
        rate = A / 2 * (3 * 15 / 2 / n) ** n / (1 - (a / b) ** (3 / n)) ** n
        u, t = result["point0_x"], result["t"]
        self.assertClose((u[-2] - u[-1]) / (t[-1] - t[-2]), a * rate, relative=0.05)

    def test_what_the_table_and_the_brine_do(self):
        cold = run("salt_cavern_2d", self.FILES)
        warm = run(
            "salt_cavern_2d", {**self.FILES, "Temperature/Value": "283 - 0.03*y"}
        )
        for result in cold, warm:
            u, row = result["point0_x"], result.row
            rates = [
                (u[row(b)] - u[row(a)]) / (b - a)
                for a, b in ((1, 10), (10.5, 18), (18.5, 30))
            ]
            # It closes while the well is open.
            self.assertLess(max(rates[0], rates[2]), 10 * -abs(rates[1]))
            self.assertLess(
                abs(result["energy_balance_defect"]).max(),
                1e-4 * result["viscous_dissipation"][-1],
            )
        # The cold wall creeps less.
        self.assertLess(cold["point0_x"][-1] / warm["point0_x"][-1], 0.8)


class Cavern(TestCase):
    """doc/ground.md"""

    def test_subsidence(self):
        folder = SOURCE / "doc" / "ground"
        result = run(
            "cavern",
            {
                "Geometry/File": folder / "cavern.msh",
                "Output/Lines": "0, 0 : 1200, 0 : 13",
            },
            text=(folder / "cavern.prm").read_text(),
        )
        for t, surface, roof, side in [
            (1, -1.3e-3, -7.2e-3, -2.4e-3),
            (10, -1.9e-3, -10.0e-3, -5.2e-3),
            (30, -2.5e-3, -12.9e-3, -7.7e-3),
        ]:
            row = result.row(t)
            self.assertClose(result["point0_y"][row], surface, absolute=0.06e-3)
            self.assertClose(result["point1_y"][row], roof, absolute=0.06e-3)
            self.assertClose(result["point2_x"][row], side, absolute=0.06e-3)
        header, *lines = (result.directory / "line_0.csv").read_text().splitlines()
        self.assertEqual(header.split(",")[:3], ["step", "t [year]", "s [m]"])
        columns = [name.partition(" [")[0] for name in header.split(",")]
        down = columns.index("displacement_y")
        trough = np.array([float(line.split(",")[down]) for line in lines[-13:]])
        self.assertClose(trough[0], result["point0_y"][-1], relative=1e-9)
        self.assertEqual(int(np.argmin(trough)), 0)  # deepest above the cavern


class BrakePad(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.result = run(
            "brake_pad_3d",
            {
                "Geometry/Arguments": "16, 8, 3 : 0, 0, 0 : 0.1, 0.05, 0.012 : true",
                "Output/Fields every": 1,
            },
        )

    def test_identities(self):
        self.check_identities(self.result, tolerance=COUPLED)

    def test_force_reaches_the_bound_and_turns(self):
        """At full slip the points pull nearly in line: 0.4 times 2 MPa times
        50 cm^2 = 4 kN, less the spread of directions."""
        force = self.result.vector("friction_force")[:, :2]
        size = np.linalg.norm(force, axis=1)
        self.assertLessEqual(size.max(), 4000 * (1 + 1e-9))
        self.assertGreater(size.max(), 3995)
        full = self.result["slip_area"] > 0.0049
        self.assertGreater(full.sum(), 20)
        direction = np.unwrap(np.arctan2(force[full, 1], force[full, 0]))
        self.assertGreater(direction[-1] - direction[0], np.radians(100))
        self.assertGreater(np.diff(direction).min(), 0)

    def test_sticks_while_pressed_and_when_at_rest(self):
        slip = self.result["slip_area"]
        pressed = self.result["t"] < 0.11
        self.assertClose(slip[pressed], 0)
        self.assertGreater(slip.max(), 0.00499)
        self.assertLess(slip[-1], 0.004)

    def test_frictional_power(self):
        """What friction dissipates in a step is mu p times the integral of
        the length that each part of the face has slipped."""
        nodes = self.result.fields("contact").nodes()
        for step in (20, 30, 45):
            face = self.result.fields("contact", step)
            x, y = face.points[nodes, 0], face.points[nodes, 1]
            # lumped weights of a uniform mesh: half at the edges
            edge = 1e-6
            weight = (0.1 / 16) * (0.05 / 8)
            weight = weight * np.where((x < edge) | (x > 0.1 - edge), 0.5, 1)
            weight = weight * np.where((y < edge) | (y > 0.05 - edge), 0.5, 1)
            self.assertClose(weight.sum(), 0.005, relative=1e-12)
            rate = np.linalg.norm(face.point_data["slip_rate"][nodes], axis=1)
            work = np.diff(self.result["friction_dissipation"])[step - 1]
            # fields have single precision
            self.assertClose(
                work,
                0.4 * 2e6 * (weight * rate).sum() * self.result["k"][step],
                relative=1e-5,
                what=f"step {step}",
            )

    def test_work_is_stored_or_dissipated(self):
        """Up to the error in time of friction, which is first order in the
        step: 1e-3 with 60 steps."""
        r = self.result
        heat = r["viscous_dissipation"] + r["friction_dissipation"]
        self.assertClose(
            r["external_work"][-1], (heat + r["stored_energy"])[-1], relative=1.5e-3
        )
        # and each is a part to be seen
        self.assertGreater(r["friction_dissipation"][-1] / heat[-1], 0.5)
        self.assertGreater(r["viscous_dissipation"][-1] / heat[-1], 0.1)


def face_of(result, index, spacing):
    """Places, pressures and lumped weights of the nodes of a contact face, and
    its other fields. spacing: of a uniform mesh, in each direction of the face."""
    face = result.fields("contact", index)
    nodes = face.nodes()
    points = face.points[nodes]
    weight = np.full(len(nodes), float(np.prod(spacing)))
    for d, h in enumerate(spacing):
        x = points[:, d]
        edge = (x < x.min() + 1e-3 * h) | (x > x.max() - 1e-3 * h)
        weight[edge] /= 2
    fields = {name: values[nodes] for name, values in face.point_data.items()}
    return points, fields["contact_pressure"], weight, fields


class BrakePadPressed(TestCase):
    FORCE, HEIGHT, FRICTION = 1e4, 0.018, 0.4

    @classmethod
    def setUpClass(cls):
        cls.result = run(
            "brake_pad_pressed_3d",
            {"Geometry/Global refinements": 0, "Output/Fields every": 1},
        )

    def face(self, step):
        return face_of(self.result, step, (0.1 / 12, 0.05 / 6))

    def test_identities(self):
        self.check_identities(self.result, tolerance=COUPLED)

    def test_forces_balance(self):
        """The disc carries the piston; the center of pressure is ahead by the
        friction force times the height of the plane that drags."""
        r = self.result
        load = self.FORCE * np.minimum(r["t"] / 0.1, 1)
        self.assertClose(r["contact_force_z"], -load, absolute=1e-5 * self.FORCE)
        for step in (5, 15, 25, 35, 45, 60):
            points, pressure, weight, _ = self.face(step)
            for d, half in enumerate((0.05, 0.025)):
                ahead = (weight * pressure * (points[:, d] - half)).sum()
                friction = r.vector("friction_force")[step, d]
                self.assertClose(
                    ahead,
                    friction * self.HEIGHT,
                    absolute=1e-5 * self.FORCE * self.HEIGHT,
                    what=f"step {step}",
                )

    def test_force_and_heat_of_full_slip(self):
        r = self.result
        size = np.linalg.norm(r.vector("friction_force"), axis=1)
        self.assertLessEqual(size.max(), self.FRICTION * self.FORCE * (1 + 1e-6))
        self.assertGreater(size.max(), 0.997 * self.FRICTION * self.FORCE)
        for step in (25, 35, 45):
            _, pressure, weight, fields = self.face(step)
            rate = np.linalg.norm(fields["slip_rate"], axis=1)
            work = np.diff(r["friction_dissipation"])[step - 1]
            # fields have single precision
            self.assertClose(
                work,
                self.FRICTION * (weight * pressure * rate).sum() * r["k"][step],
                relative=1e-5,
            )

    def test_pressure(self):
        """Not even, and not below the whole face."""
        r = self.result
        mean = self.FORCE / 0.005
        pressed, dragged = r.row(0.1), r.row(0.694)
        self.assertGreater(r["max_pressure"][pressed], 1.5 * mean)
        self.assertGreater(r["max_pressure"][dragged], 2.5 * mean)
        self.assertGreater(r["contact_area"][pressed], 0.95 * 0.005)
        self.assertLess(r["contact_area"][dragged], 0.9 * 0.005)
        # the edge that leads is y = 50 mm, the middle of x
        points, pressure, _, _ = self.face(dragged)
        place = points[np.argmax(pressure)]
        self.assertClose(place[0], 0.05, absolute=0.01)
        self.assertClose(place[1], 0.05, absolute=1e-6)


class HotShrinkFit(TestCase):
    B, C, OUTSIDE, NU = 100, 170e3, 250, 0.3
    HEAT = 530  # to 50 K more than the temperature of the law

    def pressures(self, times):
        """Of rings with e_zz = 0 by linear elements in r, which are one body but for
        the interference of 0.2, and small steps of Heun's method."""
        shaft, hub = np.linspace(0, self.B, 41), np.linspace(self.B, self.OUTSIDE, 61)
        r = np.concatenate([shaft, hub[1:]])
        n, is_hub = len(r), np.arange(len(r) - 1) >= 40
        width, middle = np.diff(r), (r[1:] + r[:-1]) / 2
        B = np.zeros((n - 1, 3, 2))
        B[:, 0] = np.stack([-1 / width, 1 / width], axis=1)
        B[:, 1] = 0.5 / middle[:, None]
        C = self.C / (1 + self.NU) * (np.eye(3) + self.NU / (1 - 2 * self.NU))
        nodes = np.stack([np.arange(n - 1), np.arange(1, n)], axis=1)
        forces = np.einsum("mki,kl,m->mil", B, C, middle * width)
        K = np.zeros((n, n))
        for element, dofs in zip(forces @ B, nodes):
            K[np.ix_(dofs, dofs)] += element
        K[0], K[0, 0] = 0, 1
        K = np.linalg.inv(K)
        # The hub's first node is 0.2 further out than the shaft's last one.
        jump = B[40, :, 0] * 0.2
        alpha = np.where(is_hub, 2e-6, 0)[:, None]

        def state(creep, t):
            T = 293 + self.HEAT * min(1, t / 10)
            eigen = creep + alpha * (T - 293)
            eigen[40] -= jump
            f = np.zeros(n)
            np.add.at(f, nodes, np.einsum("mil,ml->mi", forces, eigen))
            f[0] = 0
            u = K @ f
            stress = (np.einsum("mki,mi->mk", B, u[nodes]) - eigen) @ C
            s = stress - stress.mean(axis=1, keepdims=True)
            size = np.sqrt(1.5 * np.sum(s**2, axis=1, keepdims=True)) / 100
            rate = 1.5e-9 * np.exp(-110e3 / 8.314462618 * (1 / T - 1 / 773))
            return rate * size**3 * s * is_hub[:, None], -stress[39, 0]

        creep, t, found = np.zeros((n - 1, 3)), 0.0, [state(np.zeros((n - 1, 3)), 0)[1]]
        for end in times:
            for k in np.diff(np.geomspace(t + 5, end + 5, 200)):
                first = state(creep, t)[0]
                second = state(creep + k * first, t + k)[0]
                creep, t = creep + k / 2 * (first + second), t + k
            found.append(state(creep, t)[1])
        return np.array(found)

    def test_between_walls(self):
        symmetry = {f"Boundary {n}/Role": "symmetry" for n in (3, 23)}
        result = run(
            "hot_shrink_fit_2d",
            {
                "Geometry/Arguments": "10, 1 : 0, 0 : 100, 10 : true"
                " | 15, 1 : 100, 0 : 250, 10 : true",
                "Boundary 20/Friction law": "none",
                "Temperature/Value": f"293 K + {self.HEAT} K*min(1, t/(10 h))",
                # By their difference alone: walls would crush what is this hot.
                "Material 0/Thermal expansion": "",
                "Material 1/Thermal expansion": 2e-6,
                "Time/Phases": "10: 20, 100: 40, 1000: 60, 10000: 100",
                "Output/Points": "",
                "Output/Fields every": 0,
                **symmetry,
            },
        )
        times = 10, 100, 1000, 10000
        rows = [0, *(result.row(t) for t in times)]
        pressure = abs(result["contact_force_x"][rows]) / result["contact_area"][rows]
        expected = self.pressures(times)
        # measured: 2e-3 at most until 100 h, then 8e-3 and 9e-3 (backward Euler);
        # 2e-2, 4e-2 and 5e-2 of an activation energy of 100
        self.assertClose(pressure, expected, relative=0.012)
        # Lame's pressure of one modulus: E d/2b (1 - b^2/c^2)/(1 - nu^2)
        lame = self.C * 0.2 / 200 * (1 - (100 / 250) ** 2) / 0.91
        self.assertClose(pressure[0], lame, relative=2e-3)


class BallCreep(TestCase):
    def test_sinks_in(self):
        """Hertz's ball with the creep compliance in the place of 1/mu: its area
        only grows until it is relieved (Lee and Radok)."""
        result = run(
            "ball_creep_2d",
            {"Output/Fields every": 0, "Error control/Error bar": "false"},
        )
        self.check_identities(result, tolerance=COUPLED)
        mu, K, R, force = 900 / 2.92, 900 / 3 / 0.08, 10, 10
        depths = []
        for t in (1, 60, 600, 3600):
            row = result.row(t)
            self.assertClose(result["contact_force_y"][row], -force, relative=1e-6)
            shear = 1 / (1 / mu + t / 5e6 + (1 - np.exp(-t * 300 / 9e4)) / 300)
            plate = 4 * shear * (3 * K + shear) / (3 * K + 4 * shear)
            modulus = 1 / (1 / plate + 0.91 / 210e3)
            a = (0.75 * force * R / modulus) ** (1 / 3)
            # measured: at most 0.029 and 0.052, of cells of an eighth of it
            depths.append((-result["point0_y"][row], a**2 / R))
            self.assertClose(*depths[-1], relative=0.04)
            peak = 1.5 * force / np.pi / a**2
            self.assertClose(result["max_pressure"][row], peak, relative=0.07)
        # What the mesh adds is much the same. Measured: 0.005; 0.012 with a Maxwell
        # viscosity of 7e6
        found, known = np.divide(depths[-1], depths[-2])
        self.assertClose(found, known, relative=0.008)
        up = result["point0_y"][[result.row(t) for t in (3600, 3601, 7200)]]
        self.assertGreater(np.diff(up).min(), 0.25 * -up[0])


class BallOnRubber(TestCase):
    SHORT, LONG, TIME, NU = 10, 3, 0.1, 0.49
    RADIUS, SPEED = 20, 60
    COARSE = {
        "Geometry/Arguments": "12, 4, 4 : -12, 0, -12 : 24, 12, 0 : true",
        "Output/Lines": "",
    }

    def hertz(self, force, modulus):
        """Largest pressure of a whole ball on a half space."""
        stiffness = modulus / (1 - self.NU**2)
        return (6 * force * stiffness**2 / (np.pi**3 * self.RADIUS**2)) ** (1 / 3)

    def test_pressed_in_at_once(self):
        """Nothing but the moduli changes while the ball rests."""
        n, end = 20, 0.6
        r = run(
            "ball_zener_3d",
            {
                **self.COARSE,
                "Boundary 6/Gap": "(x^2 + y^2)/(2*20)",
                "Boundary 6/Foundation displacement": "-0.5*min(t/1e-5, 1)",
                "Time/Phases": f"1e-5: 1, {end}: {n}",
                "Output/Fields every": 0,
            },
        )
        self.check_identities(r, tolerance=COUPLED)
        force = 2 * r["contact_force_z"]  # of the whole ball
        self.assertClose(r["contact_area"][1:], r["contact_area"][1])
        # measured: 0.031 and 0.036, also on the finer mesh of the demo, whose cells
        # below the face are as coarse
        for row, modulus in (1, self.SHORT), (-1, self.LONG):
            self.assertClose(
                r["max_pressure"][row], self.hertz(force[row], modulus), relative=0.06
            )
        rest = self.LONG / self.SHORT
        step = (end - 1e-5) / n / self.TIME
        heun = (1 - step + step**2 / 2) ** np.arange(n + 1)
        self.assertClose(force[1:] / force[1], rest + (1 - rest) * heun, absolute=1e-4)
        exact = np.exp(-(r["t"][1:] - 1e-5) / self.TIME)
        self.assertClose(force[1:] / force[1], rest + (1 - rest) * exact, absolute=6e-3)

    def test_rolled_and_lifted_off(self):
        r = run("ball_zener_3d", {**self.COARSE, "Output/Fields every": 1})
        self.check_identities(r, tolerance=COUPLED)
        t, force = r["t"], r["contact_force_z"]
        self.assertGreater(force[r.row(0.02)], 2.5 * force[r.row(0.3)])
        self.assertGreater(force[r.row(0.475)], 1.8 * force[r.row(0.3)])
        work = r["external_work"]
        self.assertLess(abs(r["energy_balance_defect"]).max(), 1e-4 * work.max())

        # The moment of the pressure about the axis of the ball is what rolling
        # costs: the mean of four steps, in which the ball passes two thirds of a
        # cell. measured: 0.0035
        last = r.row(0.475)
        moments = []
        for step in range(last - 3, last + 1):
            points, pressure, weight, _ = face_of(r, step, (0.75, 0.75))
            self.assertClose((weight * pressure).sum(), force[step], relative=1e-6)
            ball = self.SPEED * (t[step] - 0.3)
            moments.append((weight * pressure * (points[:, 0] - ball)).sum())
        resistance = np.mean(moments) / self.RADIUS
        heat = r["viscous_dissipation"]
        way = self.SPEED * (t[last] - t[last - 4])
        self.assertClose(resistance, (heat[last] - heat[last - 4]) / way, relative=0.02)
        self.assertGreater(resistance, 0.02 * force[last])

        # Without contact there is no stress; what is left are strains, which fade
        # with the retardation time.
        after = t > 0.507
        self.assertClose(r["contact_area"][after], 0)
        stress = r["max_von_mises"]
        self.assertLess(stress[after].max(), 1e-6 * stress.max())
        rate = self.LONG / self.SHORT / self.TIME
        for name, least in ("point0_z", 0.2), ("point1_z", 0.14):
            groove = -r[name][after]
            self.assertGreater(groove[0], least)
            exact = groove[0] * np.exp(-rate * (t[after] - t[after][0]))
            # measured: 0.0007, of Heun's steps
            self.assertClose(groove, exact, absolute=2e-3 * groove[0])


class SaltJoint(TestCase):
    MEAN, WEIGHT, WIDTH = 8, 0.022 * 4, 2
    COARSE = {
        "Geometry/Arguments": "16, 16 : -1, 0 : 1, 4 : true",
        "Output/Fields interval": 0,
    }

    def face(self, result, index):
        face = result.fields("contact", index)
        nodes = face.nodes()
        nodes = nodes[np.argsort(face.points[nodes, 0])]
        x = face.points[nodes, 0]
        weight = np.zeros(len(x))
        weight[:-1] += np.diff(x) / 2
        weight[1:] += np.diff(x) / 2
        return x, face.point_data["contact_pressure"][nodes], weight

    def elastic(self, slope, friction=1e-6):
        """With a pressure of the roof that is 1 + slope x in the end."""
        return run(
            "salt_joint_2d",
            {
                **self.COARSE,
                "Material/Law": "elastic",
                "Boundary 2/Friction coefficient": friction,
                "Boundary 3/Pressure": f"{self.MEAN}*(1 + {slope}*x*min(t, 1))",
                "Step control/Tolerance": 0,
                "Time/Scheme": "forward Euler",
                "Time/Phases": "1: 4",
            },
        )

    def test_middle_third(self):
        """Without friction the pressure is linear while it is positive everywhere;
        beyond that the joint opens, the more the farther."""
        r = self.elastic(0.9)
        x, pressure, _ = self.face(r, 4)
        exact = self.MEAN * (1 + 0.9 * x) + self.WEIGHT
        # measured: 0.020 at the edges
        self.assertClose(pressure, exact, absolute=0.05)
        areas = [r["contact_area"][-1]]
        self.assertClose(areas[0], self.WIDTH)
        for slope in (1.2, 1.5, 1.8):
            r = self.elastic(slope)
            areas.append(r["contact_area"][-1])
            x, pressure, weight = self.face(r, 4)
            moment = self.MEAN * slope * 2 / 3
            self.assertClose((weight * pressure * x).sum(), moment, relative=1e-4)
        self.assertLess(max(np.diff(areas)), -0.2)
        # Nodes on one side only could not balance this.
        self.assertGreater(areas[-1], 2 * (1 - 1.8 / 3))

    def test_creep_opens_what_elasticity_keeps_closed(self):
        r = run("salt_joint_2d", self.COARSE)
        self.check_identities(r, tolerance=COUPLED, balance=1e-3)
        weight = self.WIDTH * (self.MEAN + self.WEIGHT)
        self.assertClose(r["contact_force_y"], -weight, relative=1e-5)
        # Nothing pushes to the side; friction is bounded by mu times the force.
        self.assertLess(abs(r["friction_force_x"]).max(), 1e-4 * 0.2 * weight)
        # What the tolerance leaves of it is no force in the closing words.
        self.assertRegex(r.stdout, r"friction force +0; 0 MN/m\n")
        for i in range(0, len(r["t"]), 3):
            t = r["t"][i]
            slope = 0.9 * (min(max(t - 20, 0), 20) - min(max(t - 240, 0), 20)) / 20
            x, pressure, lengths = self.face(r, i)
            self.assertClose(
                (lengths * pressure * x).sum(),
                self.MEAN * slope * 2 / 3,
                absolute=1e-4 * weight,
                what=f"moment at t = {t:g}",
            )
        area, t = r["contact_area"], r["t"]
        node = 2 / 32 * 1.01
        self.assertGreater(area[t < 40].min(), 2 - node)
        moved = (t > 41) & (t < 240.001)
        self.assertLess(np.diff(area[moved]).max(), node)
        last = r.row(240)
        self.assertLess(area[last], 1.8)
        self.assertGreater(area[last], 1.5)
        self.assertGreater(r["max_gap"][last], 5e-5)
        self.assertClose(area[t > 253], self.WIDTH)
        self.assertClose(r["max_gap"][t > 253], 0, absolute=1e-9)
        # Without friction it is as in a beam of this law: p as the power 1/n of the
        # distance from where contact ends.
        smooth = run(
            "salt_joint_2d",
            {
                **self.COARSE,
                "Boundary 2/Friction coefficient": 1e-6,
                "Time/Phases": "20: 4, 40: 10, 240: 50",
                "Output/Fields every": 0,
            },
        )
        n, force = 5, weight
        width = (1 - self.MEAN * 0.9 * 2 / 3 / force) * (2 + 1 / n)
        # measured: 0.047, a node and a half, and 0.011
        self.assertClose(smooth["contact_area"][-1], width, absolute=0.1)
        self.assertClose(
            smooth["max_pressure"][-1], (1 + 1 / n) * force / width, relative=0.03
        )
        # The side that carried more has been squeezed, and carries less.
        _, pressure, _ = self.face(r, len(t) - 1)
        self.assertGreater(pressure[0], 1.03 * pressure[-1])


def layer(t, plate, modulus, thickness, viscosity, bound):
    """Forward Euler for a Maxwell layer that is sheared by a plate above it and
    slips on a base below it where its shear stress reaches the bound."""
    stress, slip, creep = np.zeros(len(t)), 0.0, 0.0
    for n in range(1, len(t)):
        creep += (t[n] - t[n - 1]) * stress[n - 1] / viscosity
        trial = modulus * ((plate[n] - slip) / thickness - creep)
        stress[n] = np.clip(trial, -bound, bound)
        slip += thickness * (trial - stress[n]) / modulus
    return stress


def loop_area(force, displacement):
    return (0.5 * (force[1:] + force[:-1]) * np.diff(displacement)).sum()


class ShearedSlab(TestCase):
    @staticmethod
    def plate(t):
        return 2e-4 * np.sin(2 * np.pi * t / 60)

    @classmethod
    def setUpClass(cls):
        cls.result = run(
            "sheared_slab_2d",
            {"Geometry/Arguments": "48, 8 : 0, 0 : 0.12, 0.02 : true"},
        )

    def test_identities(self):
        self.check_identities(self.result, tolerance=COUPLED)

    def test_area_of_the_loop_is_dissipated(self):
        """A closed loop of force over displacement: nothing is stored."""
        r = self.result
        force, plate = r["reaction_3_x"], self.plate(r["t"])
        cycle = slice(r.row(120), r.row(180) + 1)
        area = loop_area(force[cycle], plate[cycle])
        viscous = np.ptp(r["viscous_dissipation"][cycle])
        friction = np.ptp(r["friction_dissipation"][cycle])
        # closed: stored energy and force come back
        stored = r["stored_energy"][cycle]
        self.assertClose(stored[-1], stored[0], absolute=1e-4 * area)
        self.assertClose(force[cycle][-1], force[cycle][0], absolute=1e-4 * force.max())
        # Up to the error in time of friction while nodes begin to slip, of
        # second order in the step.
        self.assertClose(viscous + friction, area, relative=3e-4)
        self.assertGreater(viscous / area, 0.4)
        self.assertGreater(friction / area, 0.4)

    def test_flat_ends_are_full_slip(self):
        """0.09 m times 100 kPa and 0.03 m times 20 kPa; jumps of the bound
        are at nodes here."""
        force = self.result["reaction_3_x"]
        self.assertClose(force.max(), 9600, relative=1e-9)
        self.assertClose(force.min(), -9600, relative=1e-9)
        full = self.result["slip_area"] > 0.12 - 1e-9
        self.assertGreater(full.sum(), 90)
        self.assertClose(abs(force[full]), 9600, relative=1e-9)

    def test_layer_in_pure_shear(self):
        """With guided ends and one bound the layer is a Maxwell element and a
        slider in series."""
        result = run(
            "sheared_slab_2d",
            {
                "Geometry/Arguments": "12, 4 : 0, 0 : 0.12, 0.02 : true",
                **on_boundary(0, Role="displacement", Displacement="free; 0"),
                **on_boundary(1, Role="displacement", Displacement="free; 0"),
                "Boundary 2/Friction bound": "100e3",
                "Output/Fields every": 0,
            },
        )
        constants = dict(modulus=20e6, thickness=0.02, viscosity=2.3e8, bound=100e3)
        t = result["t"]
        stress = result["reaction_3_x"] / 0.12
        self.assertClose(stress, layer(t, self.plate(t), **constants), absolute=1e-3)
        # and nearly what 100 times smaller steps give: the error is of first
        # order, 1.2 % of the area with 120 steps a cycle
        fine = np.linspace(0, 180, 100 * (len(t) - 1) + 1)
        exact = layer(fine, self.plate(fine), **constants)
        cycle = slice(result.row(120), None)
        self.assertClose(
            loop_area(stress[cycle], self.plate(t)[cycle]),
            loop_area(exact[fine > 120 - 1e-9], self.plate(fine[fine > 120 - 1e-9])),
            relative=0.015,
        )


class TreadBlock(TestCase):
    SHORT, LONG, TIME = 15.4e6, 7.7e6, 1e-3
    CELLS = "12, 8, 4 : 0, 0, 0 : 0.03, 0.02, 0.008 : true"

    def test_sliding_force(self):
        """In full sliding mu p A = 150 N along the motion of the road: what
        the road pulls at is minus the friction force on it."""
        r = run("tread_block_3d", {"Geometry/Arguments": self.CELLS})
        self.check_identities(r, tolerance=COUPLED)
        pull = -r.vector("friction_force")
        # Braked, then driven.  Sideways components vanish by symmetry; the
        # block still creeps a little beside the road's 1 m/s.
        for t, sign in ((4e-3, 1), (7e-3, -1)):
            row = r.row(t)
            self.assertClose(r["slip_area"][row], 6e-4, relative=1e-9)
            self.assertClose(pull[row, 0], sign * 150, relative=5e-4, what=f"{t}")
            self.assertClose(pull[row, 1:], 0, absolute=1e-5)
        size = np.linalg.norm(pull, axis=1)
        self.assertLessEqual(size.max(), 150 * (1 + 1e-9))

        # Reversed, the face sticks first; turned by a right angle it does not:
        # the force turns after the road, the block trailing behind.
        def between(begin, end):
            return (r["t"] > begin + 1e-9) & (r["t"] < end + 1e-9)

        self.assertClose(r["slip_area"][between(4e-3, 4.5e-3)][-2:], 0)
        turn = between(7e-3, 1.1e-2)
        self.assertGreater(r["slip_area"][turn].min(), 0.7 * 6e-4)
        self.assertClose(r["slip_area"][turn][5:], 6e-4, relative=1e-9)
        self.assertGreater(size[turn].min(), 0.99 * 150)
        angle = np.arctan2(pull[turn, 1], pull[turn, 0])
        self.assertLess(np.diff(angle).max(), 0)  # from pi to pi/2
        self.assertClose(angle[-1], np.pi / 2, absolute=0.06)
        # the block follows the road
        row = r.row(4e-3)
        self.assertGreater(r["point0_x"][row], 3e-4)

    def test_relaxation_to_the_long_term_modulus(self):
        """Held fast and sheared at once, then kept: with equal Poisson's ratios
        the force relaxes from E to E_inf in every geometry."""
        n, end = 300, 6e-3
        r = run(
            "tread_block_3d",
            {
                "Geometry/Arguments": self.CELLS,
                **on_boundary(4, Friction_law="tresca", Friction_bound="1e9"),
                "Boundary 4/Foundation motion": "5e-4*min(t/1e-6, 1); 0; 0",
                "Time/Phases": f"1e-6: 1, {end}: {n}",
                "Output/Fields every": 0,
            },
        )
        self.assertClose(r["slip_area"], 0)
        force = r["friction_force_x"][1:] / r["friction_force_x"][1]
        step = (end - 1e-6) / n
        rest = self.LONG / self.SHORT
        # as forward Euler has it, to the tolerance of the solver
        euler = (1 - step / self.TIME) ** np.arange(n + 1)
        self.assertClose(force, rest + (1 - rest) * euler, absolute=1e-7)
        # and as it is: the step's error is half of 2 % of the decay
        exact = np.exp(-(r["t"][1:] - 1e-6) / self.TIME)
        self.assertClose(force, rest + (1 - rest) * exact, absolute=3e-3)


class RodSeal(TestCase):
    MESH = SOURCE / "prm" / "demos" / "rod_seal_2d.msh"
    MAKER = SOURCE / "prm" / "demos" / "rod_seal_2d.py"
    LIP, BACKING, HEIGHT = 4e-3, 2.5e-3, 5e-3
    PRESSURE = 0.6e6

    @staticmethod
    def oedometric(young, poisson):
        """Stiffness of uniaxial strain."""
        return young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))

    def make_mesh(self, *options):
        file = tempfile.NamedTemporaryFile(suffix=".msh", delete=False)
        file.close()
        self.addCleanup(os.unlink, file.name)
        subprocess.run([sys.executable, self.MAKER, *options, file.name], check=True)
        return file.name

    def test_mesh_is_what_the_script_writes(self):
        with open(self.make_mesh()) as made, open(self.MESH) as committed:
            self.assertEqual(made.read(), committed.read())

    def test_two_materials_in_series(self):
        """With a straight outline and smooth walls the pressure makes uniform
        uniaxial strain in each material.  The exact answer is in the finite
        element space."""
        r = run(
            "rod_seal_2d",
            {
                "Geometry/File": self.make_mesh(
                    "--straight", "--lip", "4", "--backing", "3", "--height", "2"
                ),
                "Geometry/Global refinements": 0,
                "Boundary 1/Friction law": "none",
                "Boundary 2/Friction law": "none",
                "Boundary 1/Foundation displacement": "0",
                "Boundary 4/Traction": "0.6e6*min(t, 1); 0",
                "Time/Phases": "1: 20, 20: 190",
                "Output/Fields every": 0,
                "Output/Points": "0, 0; 0.004, 0.0025",
            },
        )
        p, ptfe = self.PRESSURE, self.oedometric(500e6, 0.46)
        long_term = self.oedometric(10e6, 0.49)
        backing = p * self.BACKING / ptfe
        self.assertClose(r["point1_x"][-1], backing, relative=1e-7)
        self.assertClose(
            r["point0_x"][-1], backing + p * self.LIP / long_term, relative=1e-7
        )
        self.assertClose(r["reaction_3_x"][-1], -p * self.HEIGHT, relative=1e-9)
        # lateral pressure p nu/(1 - nu) on the rod and on the top
        lateral = p * (0.49 / 0.51 * self.LIP + 0.46 / 0.54 * self.BACKING)
        rod = r["reaction_1_y"] + r["reaction_2_y"]
        self.assertClose(rod[-1], lateral, relative=1e-7)
        self.assertClose(r["reaction_5_y"][-1], -lateral, relative=1e-7)

    def test_seal(self):
        r = run(
            "rod_seal_2d",
            {"Geometry/File": self.MESH, "Geometry/Global refinements": 0},
        )
        self.check_identities(r, tolerance=COUPLED)
        p, pressed = self.PRESSURE, r.row(1)

        # The air's force is the pressure on the chord of the arc; chords of
        # 24 edges for the arc leave an error of second order.
        self.assertClose(r["load_x"][pressed], p * self.HEIGHT, relative=1e-3)
        self.assertClose(r["load_y"][pressed], -p * 1.099e-3, relative=5e-3)

        # The seal presses the harder the higher the pressure: nearly
        # incompressible, it hands on most of it to the rod.
        dry = run(
            "rod_seal_2d",
            {
                "Geometry/File": self.MESH,
                "Geometry/Global refinements": 0,
                "Boundary 4/Traction": "0; 0",
                "Time/Phases": "1: 20",
                "Output/Fields every": 0,
            },
        )
        more = sum(
            r[f"reaction_{i}_y"][pressed] - dry[f"reaction_{i}_y"][-1] for i in (1, 2)
        )
        self.assertGreater(more, 0.7 * p * (self.LIP + self.BACKING))
        self.assertLess(more, p * (self.LIP + self.BACKING))
        # and touches the groove; contact pulls at one node, where the bond
        # of the materials meets the rod
        self.assertLess(r["reaction_3_x"][1:].max(), 0)
        self.assertLess(r["tension_area"].max(), 0.03 * (self.LIP + self.BACKING))

        # Strokes in full slip: each foot at its bound, against the motion.  The
        # node in the corner of the groove, half a cell of 14, cannot slip.
        backing = self.BACKING * (1 - 0.5 / 14)
        slide = 0.15 * 0.7e6 * self.LIP + 0.08 * 0.5e6 * backing
        for t, sign in ((2.5, -1), (5, 1)):
            row = r.row(t)
            self.assertClose(r["slip_area"][row], self.LIP + backing, relative=1e-9)
            self.assertClose(r["friction_force_x"][row], sign * slide, relative=1e-9)


class TunnelLining(TestCase):
    INNER, OUTER = 2.7, 3.05
    YOUNG, POISSON = 37e9, 0.2

    def exact(self, x, y):
        """Displacement and hoop stress of a ring with the normal stress
        -(p - q cos 2t) on its outside and nothing inside: Lame's solution for
        p, Michell's for q (stress function A r^2 + B r^4 + C/r^2 + D times
        cos 2t, see Timoshenko and Goodier, Theory of Elasticity)."""
        a, b, p, q = self.INNER, self.OUTER, 0.5e6, 0.02e6
        nu = self.POISSON
        r, t = np.hypot(x, y), np.arctan2(y, x)

        def normal(r):
            return [-2, 0, -6 / r**4, -4 / r**2]

        def shear(r):
            return [2, 6 * r**2, -6 / r**4, -2 / r**2]

        A, B, C, D = np.linalg.solve(
            [normal(a), shear(a), normal(b), shear(b)], [0, 0, q, 0]
        )
        L = -p * b**2 / (b**2 - a**2)
        cos, sin = np.cos(2 * t), np.sin(2 * t)
        hoop = (L * (1 + a**2 / r**2) + (2 * A + 12 * B * r**2 + 6 * C / r**4) * cos)
        radial = (
            (1 - 2 * nu) * L * r
            + L * a**2 / r
            + cos
            * (-2 * A * r - 4 * nu * B * r**3 + 2 * C / r**3 + 4 * (1 - nu) * D / r)
        )
        tangential = sin * (
            2 * A * r + (6 - 4 * nu) * B * r**3 + 2 * C / r**3 - (2 - 4 * nu) * D / r
        )
        u = np.stack(
            [
                radial * np.cos(t) - tangential * np.sin(t),
                radial * np.sin(t) + tangential * np.cos(t),
            ]
        )
        return u * (1 + nu) / self.YOUNG, hoop

    def errors(self, result):
        """Largest errors of displacement and of the cells' hoop stress,
        relative to the largest values."""
        body = result.fields()
        x, y = body.points[:, 0], body.points[:, 1]
        u, _ = self.exact(x, y)
        error_u = body.point_data["displacement"][:, :2].T - u
        x, y = body.points[body.cells].mean(axis=1)[:, :2].T
        _, hoop = self.exact(x, y)
        xx, yy, xy = (body.cell_data[f"stress_{c}"] for c in ("xx", "yy", "xy"))
        computed = (xx * y**2 + yy * x**2 - 2 * xy * x * y) / (x**2 + y**2)
        return np.array(
            [
                np.linalg.norm(error_u, axis=0).max() / np.linalg.norm(u, axis=0).max(),
                abs(computed - hoop).max() / abs(hoop).max(),
            ]
        )

    def test_closed_form(self):
        """Second order, and no friction, law or history on the way."""
        coarse, fine = (
            run("tunnel_lining_2d", {"Geometry/Global refinements": n}) for n in (2, 3)
        )
        for result in coarse, fine:
            self.check_identities(result)
            self.assertNotIn("friction_dissipation", result.statistics)
            self.assertNotIn("viscous_dissipation", result.statistics)
        error = self.errors(fine)
        self.assertLess(error[0], 7.5e-3)  # of the displacement
        self.assertLess(error[1], 3.5e-3)  # of the hoop stress
        ratio = self.errors(coarse) / error
        self.assertGreater(ratio.min(), 3.4)
        self.assertLess(ratio.max(), 4.5)

    def test_joint_force(self):
        """Half the ring in equilibrium: the joint at the springline carries
        the vertical load of a quarter, the integral of p - q cos 2t times
        sin t, that is (p + q/3) times the outer radius."""
        result = run("tunnel_lining_2d")
        load = self.OUTER * (0.5e6 + 0.02e6 / 3)
        # 48 chords a quarter for the arc
        self.assertClose(result["reaction_3_y"][-1], load, relative=2e-5)
        # the load grows in equal parts, the response with it
        self.assertClose(
            result["reaction_3_y"],
            result["t"] * result["reaction_3_y"][-1],
            relative=1e-10,
        )


class LapJoint(TestCase):
    """Two bodies: friction that slips at the ends of what bolts press together."""

    def test_loop(self):
        result = run("lap_joint_2d")
        self.check_identities(result, COUPLED)
        t, force = result["t"], result["friction_force_x"]
        pull = 0.18e6 * np.interp(t, [0, 1, 2, 4, 6], [0, 0, 1, -1, 1])
        self.assertClose(force, pull, absolute=1e-5 * 0.18e6)
        self.assertClose(result["contact_force_y"][5:], -1e6, relative=1e-5)
        # some of it sticks at any time, and slip begins anew when the load turns
        self.assertGreater(result["stick_area"][1:].min(), 4e-3)
        slips = result["slip_area"]
        self.assertLess(slips[16], slips[15] / 3)
        # from one pull to the next one the work done at the grip is turned to heat
        cycle = t >= 2
        grip, heat = result["point0_x"][cycle], result["friction_dissipation"][cycle]
        work = -np.trapz(force[cycle], grip)
        self.assertClose(heat[-1] - heat[0], work, relative=0.02)
        # Masing: half of the cycle is the first pull, twice as large
        first, back = (
            abs(result["point0_x"][a] - result["point0_x"][b])
            for a, b in ((15, 5), (35, 15))
        )
        self.assertClose(back / first, 2, relative=0.02)


class PadOnDisc(TestCase):
    """Two bodies in space: what the piston presses, the disc feels."""

    def test_forces(self):
        result = run(
            "brake_pad_disc_3d",
            {
                "Geometry/Arguments": "7, 4, 1 : -0.02, -0.01, -0.007 : 0.12, 0.06, 0"
                " : true | 12, 6, 3 : 0, 0, 0 : 0.1, 0.05, 0.018 : true",
                "Time/Phases": "0.1: 2, 1: 8",
                "Output/Fields every": 0,
            },
        )
        self.check_identities(result, COUPLED)
        self.assertClose(result["contact_force_z"][2:], -1e4, relative=1e-6)
        # all of it slides, nearly along x
        self.assertEqual(result["stick_area"][-1], 0)
        self.assertClose(result["friction_force_x"][-1], -4e3, relative=5e-3)
        self.assertClose(result["reaction_4_x"][-1], 4e3, relative=5e-3)
        # the trailing edge has lifted off
        self.assertClose(result["contact_area"][-1], 0.9 * 0.005, relative=0.06)


class SealInHousing(TestCase):
    """Three bodies of revolution."""

    def test_seals(self):
        result = run("seal_in_housing_2d", {"Output/Fields every": 0})
        self.check_identities(result, COUPLED)
        t, lip = result["t"], 2 * np.pi * 10 * 5
        oil = 2 * np.interp(t, [1, 2], [0, 1])
        self.assertTrue(np.all(-result["contact_force_20_x"][1:] / lip > oil[1:]))
        # what the oil presses, the wall of the groove and friction hold
        ring = np.pi * (14**2 - 10**2)
        held = -result["reaction_23_y"] + result["friction_force_y"]
        self.assertClose(held, oil * ring, absolute=1e-4 * ring)
        slips = result["slip_area"] / (lip * 2.4)
        self.assertLess(slips[t == 3][0], 0.1)
        self.assertGreater(slips[-1], 0.25)


if __name__ == "__main__":
    main()
