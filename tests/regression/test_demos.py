# SPDX-License-Identifier: LGPL-2.1-or-later
"""The demo scenes do what their comments and doc/gallery.md say.

One physical check each, on coarser meshes.  SI units: forces of 1e7 N/m,
displacements of 1e-3 m, viscosities of 1e17 Pa s in one scene are a test of
scaling, too.
"""

import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np

from harness import COUPLED, SOURCE, TestCase, main, run


class SaltPillar(TestCase):
    DESCENT = 2.592e6  # s, end of the fast part

    # of the scene
    YOUNG, POISSON = 31e9, 0.25
    RATE, EXPONENT = 8.25e-46, 5
    HEIGHT = 3.0

    @classmethod
    def setUpClass(cls):
        cls.result = run(
            "salt_pillar_2d",
            {"Geometry/Arguments": "48, 24 : 0, 0 : 6, 3 : true"},
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
        self.assertClose(
            -self.free["reaction_3_y"][-1] / 6, steady, relative=1e-7
        )
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


class BrakePad(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.result = run(
            "brake_pad_3d",
            {
                "Geometry/Arguments":
                    "16, 8, 3 : 0, 0, 0 : 0.1, 0.05, 0.012 : true",
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
            r["external_work"][-1],
            (heat + r["stored_energy"])[-1],
            relative=1.5e-3,
        )
        # and each is a part to be seen
        self.assertGreater(r["friction_dissipation"][-1] / heat[-1], 0.5)
        self.assertGreater(r["viscous_dissipation"][-1] / heat[-1], 0.1)


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
        self.assertClose(
            force[cycle][-1], force[cycle][0], absolute=1e-4 * force.max()
        )
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
                "Boundary 0/Role": "displacement",
                "Boundary 0/Displacement": "free; 0",
                "Boundary 1/Role": "displacement",
                "Boundary 1/Displacement": "free; 0",
                "Boundary 2/Friction bound": "100e3",
                "Output/Fields every": 0,
            },
        )
        constants = dict(
            modulus=20e6, thickness=0.02, viscosity=2.3e8, bound=100e3
        )
        t = result["t"]
        stress = result["reaction_3_x"] / 0.12
        self.assertClose(
            stress, layer(t, self.plate(t), **constants), absolute=1e-3
        )
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
                "Boundary 4/Friction law": "tresca",
                "Boundary 4/Friction bound": "1e9",
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
        hoop = L * (1 + a**2 / r**2) + (2 * A + 12 * B * r**2 + 6 * C / r**4) * cos
        radial = (1 - 2 * nu) * L * r + L * a**2 / r + cos * (
            -2 * A * r - 4 * nu * B * r**3 + 2 * C / r**3 + 4 * (1 - nu) * D / r
        )
        tangential = sin * (
            2 * A * r
            + (6 - 4 * nu) * B * r**3
            + 2 * C / r**3
            - (2 - 4 * nu) * D / r
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
                np.linalg.norm(error_u, axis=0).max()
                / np.linalg.norm(u, axis=0).max(),
                abs(computed - hoop).max() / abs(hoop).max(),
            ]
        )

    def test_closed_form(self):
        """Second order, and no friction, law or history on the way."""
        coarse, fine = (
            run("tunnel_lining_2d", {"Geometry/Global refinements": n})
            for n in (2, 3)
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
            result["reaction_3_y"], result["t"] * result["reaction_3_y"][-1],
            relative=1e-10,
        )


if __name__ == "__main__":
    main()
