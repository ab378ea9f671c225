# SPDX-License-Identifier: LGPL-2.1-or-later
"""The creeping cantilever: long creep without locking.

Fine value: quadratic elements, stress history at nine points per cell, on 4,
8, 16 cells over the height -3.6265, -3.6706, -3.6869 from below, bilinear
elements with mean dilatation on 8, 16, 32 cells -3.6903, -3.6911, -3.6944;
both tend to -3.696 (plus or minus 0.002).
"""

from harness import TestCase, main, run

FINE = -3.696
ELASTIC = -0.2431


class Cantilever(TestCase):
    def tip(self, volumetric, history):
        result = run(
            "cantilever_creep",
            {
                "Material/Volumetric integration": volumetric,
                "Material/Stress history": history,
            },
        )
        self.check_identities(result, tolerance=1e-8)
        return result["point0_y"]

    def test_quadrature_points_with_mean_dilatation_do_not_lock(self):
        tip = self.tip("mean dilatation", "quadrature points")
        self.assertClose(tip[-1], FINE, relative=0.03, what="tip after creep")
        # the elastic answer on four cells: linear elements, bending
        self.assertClose(tip[0], ELASTIC, relative=0.03, what="tip before creep")
        # the independent solver on the same mesh, same scheme
        self.assertClose(tip[-1], -3.715107, relative=1e-5, what="same mesh")

    def test_each_half_of_the_remedy_alone_locks(self):
        """What the traps cost, measured independently on the same mesh."""
        for volumetric, history, expected in (
            ("full", "cell means", -1.793539),
            ("mean dilatation", "cell means", -2.442308),
            ("full", "quadrature points", -2.451530),
        ):
            tip = self.tip(volumetric, history)
            self.assertClose(
                tip[-1], expected, relative=1e-5, what=f"{volumetric}, {history}"
            )

    def test_the_run_reports_what_cell_means_leave_out(self):
        """With quadrature points the part of the stress that cell means drop
        is known, and the run says so where it is large."""
        result = run("cantilever_creep", {"Material/Stress history": "cell means"})
        self.assertRegex(result.stdout + result.stderr, "quadrature points")

    def test_automatic_integration_of_a_creeping_law_is_mean_dilatation(self):
        automatic = self.tip("automatic", "quadrature points")
        self.assertClose(automatic[-1], -3.715107, relative=1e-5)


if __name__ == "__main__":
    main()
