# SPDX-License-Identifier: LGPL-2.1-or-later
"""The demo scenes do what their comments and doc/gallery.md say.

One physical check each, on coarser meshes.  SI units: forces of 1e7 N/m,
displacements of 1e-3 m, viscosities of 1e17 Pa s in one scene are a test of
scaling, too.
"""

import unittest

import numpy as np

from harness import TestCase, main, run


class SaltPillar(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.result = run(
            "salt_pillar_2d",
            {"Geometry/Arguments": "64, 32 : 0, 0 : 6, 3 : true"},
        )

    def test_identities(self):
        self.check_identities(self.result, tolerance=1e-8)

    def test_load_of_the_pillar(self):
        """About 17 MPa on 6 m after 30 days, less after relaxation."""
        roof = -self.result["reaction_3_y"] / 6
        self.assertClose(roof[self.result.row(2.592e6)], 17e6, relative=0.05)
        self.assertLess(roof[-1], 14e6)
        self.assertGreater(roof[-1], 8e6)

    def test_slip_zone_grows_from_the_edge(self):
        slip = self.result["slip_area"]
        ramp = self.result["t"] <= 2.592e6 * (1 + 1e-9)
        self.assertClose(slip[: np.argmax(self.result["t"] > 2e5)], 0)
        # a node more or less is a tie
        self.assertGreaterEqual(np.diff(slip[ramp]).min(), -1.01 * 6 / 64)
        self.assertGreater(slip[ramp][-1], 3)
        self.assertClose(slip.max(), 4.8, absolute=0.2)
        self.assertLess(slip[-1], slip.max())

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
        self.check_identities(self.result, tolerance=1e-8)

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
        self.check_identities(self.result, tolerance=1e-8)

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
        self.assertClose(error, 0, absolute=[7.5e-3, 3.5e-3])
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
