# SPDX-License-Identifier: LGPL-2.1-or-later
"""Steps in which nothing changes take over the solution of the step before.

They are compared with the full evaluation, `Solver/Reuse unchanged = false'.
"""

import numpy as np

from harness import TestCase, main, run
from runs import EVERY_STEP, Job

FULL = {"Solver/Reuse unchanged": "false"}
# Loads grow for two steps and are held for three; then they are another.
HELD = "if(t < 0.6, min(t, 0.2), 0.1)"
STEPS = {"Time/Phases": "0.2: 2, 0.6: 4, 0.7: 1", "Output/Fields every": 0}
IS_HELD = np.array([0, 0, 0, 1, 1, 1, 0, 1], bool)
SMALL = {"Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true", **STEPS}
PUSHED = {**SMALL, "Boundary 0/Traction": f"1.5*({HELD}); 0"}
PUSHED_PAD = {
    **STEPS,
    "Geometry/Arguments": "3, 3, 3 : 0, 0, 0 : 1, 1, 1 : true",
    "Boundary 0/Traction": f"0.3*({HELD}); 0.2*({HELD}); 0",
}
CONSTANT = {
    **SMALL,
    "Material/Law": "elastic",
    "Boundary 0/Traction": "0.3; 0",
    "Initial state/Equilibrate": "true",
}
# Of the clock and the iterations; and a point at the edge of slip, as those are
# that slipped in the step before, may stick or slip as rounding will.
NOT_COMPARED = (
    "wall_",
    "unchanged",
    "linear_iterations",
    "contact_iterations",
    "newton_iterations",
    "duality_gap",
    "algebraic_error",
    "estimate_algebraic",
    "estimate_total",
    "stick_area",
    "slip_area",
    "slip_misalignment",
)


class Steps(TestCase):
    def compare(self, scene, overrides, held=IS_HELD, ranks=1, tolerance=1e-8):
        """All numbers of both runs, beside the largest of their kind."""
        result = run(scene, overrides, ranks)
        full = run(scene, {**overrides, **FULL}, ranks)
        self.assertFalse(full["unchanged"].any())
        if held is None:
            held = result["unchanged"] == 1
        np.testing.assert_array_equal(result["unchanged"], held)
        self.assertIn(f"without a solve: {held.sum()} of {len(held) - 1}", result.stdout)
        self.assertFalse(result["linear_iterations"][held].any())
        if "contact_iterations" in result.statistics:
            self.assertFalse(result["contact_iterations"][held].any())
        for column, expected in full.statistics.items():
            if column.startswith(NOT_COMPARED) or "defect" in column:
                continue
            kind = column.split("_")[0]
            sizes = [
                np.abs(values[np.isfinite(values)]).max()
                for name, values in full.statistics.items()
                if name.split("_")[0] == kind and np.isfinite(values).any()
            ]
            self.assertClose(
                result[column],
                expected,
                absolute=tolerance * max(sizes, default=0),
                what=column,
            )
        # Their bounds are those of the solve before.
        for column in ("algebraic_error", "duality_gap", "estimate_algebraic"):
            if column in result.statistics:
                bounds = result[column]
                np.testing.assert_array_equal(
                    bounds[held], bounds[np.flatnonzero(held) - 1], column
                )
        return result

    def test_elastic_with_friction(self):
        """Slipping and sticking parts of a face under a load that stays."""
        overrides = {**PUSHED, "Material/Law": "elastic"}
        for solver in "direct", "multigrid":
            result = self.compare("slab", {**overrides, "Solver/Linear solver": solver})
            self.assertGreater(result["slip_area"][2], 0)
            self.assertFalse(result["slip_area"][IS_HELD].any())
        self.compare("slab", overrides, ranks=2)

    def test_elastic_with_friction_3d(self):
        result = self.compare("pad", {**PUSHED_PAD, "Material/Law": "elastic"})
        self.assertGreater(result["slip_area"][2], 0)

    def test_hanging_nodes(self):
        result = self.compare(
            "slab",
            {
                **PUSHED,
                "Material/Law": "elastic",
                "Mesh refinement/Strategy": "kelly",
                "Mesh refinement/Every n steps": 2,
                "Mesh refinement/Cell budget": 60,
            },
            held=None,
            tolerance=1e-6,
        )
        cells, unchanged = result["cells"], result["unchanged"]
        self.assertGreater(cells.max(), cells.min())
        self.assertTrue(unchanged[cells > cells[0]].any())
        # After each change of the mesh there is something to solve.
        self.assertFalse(unchanged[1:][np.diff(cells) != 0].any())

    def test_below_yield(self):
        """Each scheme, and a body of which nothing flows."""
        law = {"Material/Law": "perzyna", "Material/perzyna/Yield radius": 10}
        for scheme in "forward Euler", "Heun", "backward Euler":
            with self.subTest(scheme):
                result = self.compare(
                    "slab",
                    {**PUSHED, **law, "Time/Scheme": scheme},
                    ranks=1 if scheme == "Heun" else 2,
                )
                self.assertFalse(result["viscous_dissipation"].any())

    def test_flow_is_a_change(self):
        """Where anything flows, steps are solved, with the same bits."""
        for scheme in "forward Euler", "backward Euler":
            overrides = {**PUSHED, "Time/Scheme": scheme}
            result = run("slab", overrides)
            full = run("slab", {**overrides, **FULL})
            self.assertFalse(result["unchanged"].any())
            for column, expected in full.statistics.items():
                if not column.startswith("wall_"):
                    np.testing.assert_array_equal(
                        result[column], expected, f"{scheme}: {column}"
                    )

    def test_a_bound_that_drops_below_the_multiplier(self):
        """The load stays; the foundation lets go. A bound that grows holds."""
        elastic = {**PUSHED, "Material/Law": "elastic"}
        drops = run("slab", {**elastic, "Boundary 2/Friction bound": "0.1 - 0.12*t"})
        self.assertFalse(drops["unchanged"].any())
        self.assertGreater(drops["slip_area"][5], 0)
        self.compare("slab", {**elastic, "Boundary 2/Friction bound": "0.05 + t"})
        # The estimate knows the bound.
        varies = {"Boundary 2/Friction bound": "(0.05 + t)*if(x < 0.5, 1, 3)"}
        held = run("slab", {**CONSTANT, **varies})
        full = run("slab", {**CONSTANT, **varies, **FULL})
        self.assertTrue(held["unchanged"][1:].all())
        self.assertClose(held["estimate_space"], full["estimate_space"], 1e-9)

    def test_a_foundation_that_moves(self):
        overrides = {
            **SMALL,
            "Material/Law": "elastic",
            "Boundary 2/Normal stress": -0.2,
            "Initial state/Equilibrate": "true",
            "Boundary 2/Foundation motion": f"{HELD}; 0",
        }
        self.compare("conveyor_2d", overrides)


class Restarts(TestCase):
    def check_unchanged(self, result, expected):
        for column, values in expected.statistics.items():
            if not column.startswith("wall_"):
                np.testing.assert_array_equal(result[column], values, column)

    def test_go_on_as_runs_in_one_piece(self):
        """With the estimate that unchanged steps take over."""
        with Job("slab", {**CONSTANT, **EVERY_STEP}) as job:
            whole = job.run()
            job.forget_after(3)
            again = job.run("--restart")
            self.assertTrue(again["unchanged"][3:].all())
            self.assertGreater(again["estimate_space"][-1], 0)
            self.check_unchanged(again, whole)

    def test_other_loads_move_the_body(self):
        with Job("slab", {**CONSTANT, **EVERY_STEP}) as job:
            job.run()
            job.forget_after(3)
            more = {"Boundary 0__Traction": "0.4; 0"}
            again = job.run("--restart", overrides=more)
            self.assertFalse(again["unchanged"][4])
            before, after = again["max_displacement"][3:5]
            self.assertGreater(after, 1.2 * before)


if __name__ == "__main__":
    main()
