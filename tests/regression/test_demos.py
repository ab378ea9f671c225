# SPDX-License-Identifier: LGPL-2.1-or-later
"""The demo scenes do what their comments say.

SI units: forces of 1e7 N/m, displacements of 1e-3 m, viscosities of 1e17 Pa s
in one scene are a test of scaling, too.
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
        self.assertGreater(size.max(), 3900)
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


if __name__ == "__main__":
    main()
