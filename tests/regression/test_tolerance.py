# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs to a tolerance, which choose meshes and steps by themselves."""

import numpy as np

from harness import TestCase, main, run
from runs import (
    EVERY_STEP,
    Job,
    elastic_moduli,
    manufactured,
    of_law,
    on_boundary,
    with_roles,
    without_wall_times,
)

# What laws have by default; the scenes of the paper keep cell means.
POINTS = {"Material/Stress history": "quadrature points"}
COARSE_SLAB = {
    **POINTS,
    "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
    "Time/Phases": "1: 4, 2: 4",
    "Output/Fields every": 0,
}


def to(tolerance, **more):
    return {"Error control/Tolerance": tolerance, **more}


class Kept(TestCase):
    """The error of known solutions is below the tolerance, but not by far."""

    def check(self, name, tolerance, law=None, **more):
        result = manufactured(name, law, **to(tolerance, **{**POINTS, **more}))
        size = result["exact_energy"].max()
        error = result["error_energy"].max() / size
        estimate = result["estimate_total"].max() / result["energy_norm"].max()
        what = f"{name}, {law}, {tolerance}, estimated {estimate}"
        self.assertLess(estimate, tolerance, what)
        self.assertLess(error, tolerance, what)
        self.assertGreater(error, tolerance / 4, what)
        self.assertIn("has been kept", result.stdout)
        return result

    def test_plane(self):
        for tolerance in 0.2, 0.08:
            self.check("coulomb_2d", tolerance)
            self.check("tresca_2d", tolerance)

    def test_laws(self):
        for law in "elastic", "norton", "perzyna_hardening", "zener":
            self.check("tresca_2d", 0.1, law)

    def test_first_order_in_time(self):
        for scheme in "forward Euler", "backward Euler":
            self.check("coulomb_2d", 0.1, **{"Time/Scheme": scheme})

    def test_space(self):
        result = self.check("coulomb_3d", 0.3)
        # The data ask for a finer mesh than the scene's of 64 cells, not
        # everywhere.
        self.assertGreater(result["cells"][1], 100)
        self.assertNotEqual(result["cells"][1], 512)

    def test_cell_means(self):
        for tolerance in 0.3, 0.05:
            result = self.check(
                "tresca_2d", tolerance, **{"Material/Stress history": "cell means"}
            )
        # 104 000 and no end where children inherit what their parents have had
        self.assertLess(result["cells"].max(), 6000)

    def test_what_coarse_meshes_leave_in_the_history(self):
        """Has more than a third of the tolerance: the run begins again."""
        scene = {
            "Dimension": 2,
            "Geometry/Arguments": "3, 2 : 0, 0 : 1.5, 0.8 : true",
            **elastic_moduli(10, 0.35),
            **of_law("maxwell", Viscosity=3),
            **with_roles(free=(0, 1)),
            **on_boundary(2, Role="contact", Contact_law="unilateral",
                          Friction_law="coulomb", Friction_coefficient=0.3,
                          Foundation_motion="0.05*max(t - 1, 0); 0"),
            **on_boundary(3, Role="displacement", Displacement="0; -0.03*min(t, 1)"),
            "Time/Phases": "1: 3, 3: 4",
        }  # fmt: skip
        result = run("history", {**scene, **to(0.35)}, text="")
        # 0.38 and 81 cells if it went on; its true error was 0.97 of the tolerance,
        # and of a block of burgers in 3D with 0.45 of it 1.2
        left = result["estimate_history"].max() / result["energy_norm"].max()
        self.assertLess(left, 0.35 / 3)
        self.assertEqual(result.stdout.count("Again from the beginning"), 1)
        self.assertIn("has been kept", result.stdout)


class Meshes(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.slab = run("slab", {**COARSE_SLAB, **to(0.04)})

    def test_grow_with_the_solution_and_keep_the_estimate(self):
        result = self.slab
        size = result["energy_norm"].max()
        # within the step, before it is accepted
        self.assertLess(result["estimate_total"].max(), 0.04 * size)
        self.assertGreater(result["estimate_total"].max(), 0.02 * size)
        # A load that grows needs ever finer meshes, none at the beginning.
        self.assertLess(result["cells"][1], 100)
        self.assertGreater(result["cells"].max(), 1000)
        self.assertIn("tolerance of 4 % has been kept", result.stdout)

    def test_agree_with_fine_runs(self):
        """Limits of 32 x 16 to 256 x 128 cells, and of 128 to 1024 steps."""
        self.assertClose(self.slab["friction_force_x"][-1], -0.009763, 0.03)
        peak = self.slab["t"].tolist().index(1.0)
        self.assertClose(self.slab["friction_force_x"][peak], 0.12870, 0.01)
        self.assertClose(self.slab["strain_energy"][peak], 0.03228, 0.01)

    def test_follow_a_solution_that_shrinks(self):
        """A load that goes away takes the cells with it."""
        result = run(
            "slab",
            {
                **COARSE_SLAB,
                "Boundary 0/Traction": "0.3*sin(3.14159265*t)^8; 0",
                "Time/Phases": "1: 20",
                "Material/Law": "elastic",
                **to(0.1),
            },
        )
        cells = result["cells"]
        self.assertLess(cells[-1], cells.max() / 2)

    def test_on_ranks(self):
        several = run("slab", {**COARSE_SLAB, **to(0.04)}, ranks=3)
        self.assertEqual(list(several["cells"]), list(self.slab["cells"]))
        self.assertClose(several["t"], self.slab["t"], 1e-6)
        self.assertClose(several["estimate_total"], self.slab["estimate_total"], 1e-5)


class Rounding(TestCase):
    """A first step that carries the body without strain."""

    SCENE = {
        "Geometry/Arguments": "6, 2 : 0, 0 : 2, 1 : true",
        "Geometry/Global refinements": 1,
        "Material/Young's modulus": 1e6,
        "Material/Law": "elastic",
        **with_roles(free=[0, 1]),
        **on_boundary(2, Role="contact", Contact_law="unilateral", Gap="0.003*(1 - t)"),
        **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
        "Boundary 3/Role": "displacement",
        "Boundary 3/Displacement": "0.006*sin(2*t); -0.012*sin(2*t)",
        "Time/Phases": "0.5: 8",
        "Solver/Contact tolerance": 1e-11,
        "Output/Fields every": 0,
    }

    def test_of_an_initial_stress(self):
        """One that contact holds in balance strains nothing but by rounding, 1e-20."""
        for solver in "direct", "multigrid":
            scene = {
                "Dimension": 3,
                "Geometry/Generator": "truncated_cone",
                "Geometry/Arguments": "0.6 : 0.4 : 1.0",
                **elastic_moduli(0.8, 0.45),
                **of_law("maxwell", Viscosity=2),
                "Initial state/Stress": "-9e-5; -9e-5; -9e-5; 0; 0; 0",
                **with_roles(clamped=[0, 1]),
                **on_boundary(2, Role="contact", Contact_law="unilateral"),
                **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
                "Solver/Coulomb pressure": "lagged",
                "Solver/Linear solver": solver,
                "Time/Scheme": "backward Euler",
                "Time/Phases": "0.5: 4",
                "Mesh refinement/Strategy": "kelly",
                "Mesh refinement/Refinement fraction": 0.6,
                "Output/Fields every": 0,
            }
            result = run("at_rest", scene, text="")
            self.assertEqual(set(result["cells"]), {10})

    def test_makes_no_mesh(self):
        """What it leaves of an estimate does not, whatever chooses the mesh."""
        for more in (
            {"Error control/Tolerance": 0.2, "Mesh refinement/Cell budget": 500},
            {"Mesh refinement/Strategy": "residual"},
            {"Mesh refinement/Strategy": "kelly"},
        ):
            with self.subTest(more):
                result = run("carried", {**self.SCENE, **more}, text="")
                strains = result["max_von_mises"] > 1e-6 * result["max_von_mises"].max()
                first = int(np.argmax(strains))
                self.assertGreater(first, 1)
                self.assertEqual(set(result["cells"][: first + 1]), {48})
                self.assertNotEqual(result["cells"][-1], 48)

    def test_of_a_quantity_that_statics_fixes(self):
        """Friction carries all of the pull: no mesh changes the force."""
        strip = {
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "4, 1 : 0, 0 : 1, 0.06 : true",
            "Boundary 0/Role": "free",
            **on_boundary(1, Role="traction", Traction="-1.4e-5*t; 0"),
            **on_boundary(2, Role="contact", Contact_law="unilateral"),
            **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
            "Boundary 2/Gap": "1e-4*(1 + sin(9*x))",
            "Boundary 3/Role": "free",
            "Loads/Body force": "0; -0.0036*t",
            "Time/Phases": "0.5: 4",
            "Error control/Quantity": "friction_force_x",
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Maximal level": 2,
        }
        for solver in "direct", "multigrid":
            with self.subTest(solver=solver):
                result = run("pull", {**strip, "Solver/Linear solver": solver}, text="")
                self.assertEqual(set(result["cells"]), {4})
                self.assertEqual(result["quantity_space"].max(), 0)
                self.assertClose(
                    result["friction_force_x"], -8.4e-7 * result["t"], relative=1e-5
                )


class Kinks(TestCase):
    """The turn of a load, which no step of the phases meets."""

    SCENE = {
        **COARSE_SLAB,
        "Material/Law": "elastic",
        "Boundary 0/Traction": "0.3*min(t, 1.86 - t); 0",
        "Mesh refinement/Strategy": "none",
    }

    def test_turn_of_a_load_is_found(self):
        """Plane elastic bodies are exact at the ends of steps then."""
        fine = run("slab", {**self.SCENE, "Time/Phases": "0.93: 50, 1.86: 50"})
        # the load is the same at both ends of the step that contains the turn
        phases = {"Time/Phases": "1.86: 9"}
        found = run("slab", {**self.SCENE, **phases, **to(0.5)})
        self.assertIn("Steps end at kinks", found.stdout)
        self.assertIn("'Boundary 0/Traction': t = 0.93\n", found.stdout)
        self.assertIn(0.93, list(found["t"]))
        missed = run(
            "slab",
            {**self.SCENE, **phases, **to(0.5), "Step control/Land on kinks": "false"},
        )
        self.assertNotIn("Steps end at kinks", missed.stdout)
        for column in "friction_force_x", "friction_dissipation", "point0_x":
            self.assertClose(found[column][-1], fine[column][-1], 1e-8)
        # What the load does within steps is counted, and found by shorter ones; not
        # exactly.
        self.assertGreater(len(missed["t"]), len(found["t"]))
        for column in "friction_force_x", "friction_dissipation":
            error = abs(missed[column][-1] / fine[column][-1] - 1)
            self.assertGreater(error, 1e-4)
            self.assertLess(error, 0.05)

    def test_jumps_get_steps_of_their_own(self):
        scene = {
            **self.SCENE,
            "Material/Law": "maxwell",
            "Material/Stress history": "cell means",
            "Boundary 0/Traction": "0.05*min(1, 10*t) + if(t < 0.77, 0, 0.15); 0",
            "Time/Phases": "2: 8",
            "Step control/Tolerance": 0.05,
        }
        found = run("slab", scene)
        missed = run("slab", {**scene, "Step control/Land on kinks": "false"})
        self.assertEqual(found["rejected"].sum(), 0)
        self.assertGreater(missed["rejected"].sum(), 5)
        self.assertLess(len(found["t"]), len(missed["t"]))
        self.assertClose(found["friction_force_x"][-1], 0.095455, 1e-3)
        # Fields there and at 1.54 end steps, and those after them grow again.
        heun = {**scene, "Time/Scheme": "Heun"}
        found = run("slab", heun)
        shown = run("slab", {**heun, "Output/Fields interval": 0.77})
        self.assertLessEqual(len(shown["t"]), len(found["t"]) + 8)

    def test_on_3_ranks(self):
        scene = {**self.SCENE, "Time/Phases": "1.86: 9", **to(0.5)}
        several = run("slab", {**scene, "Solver/Linear solver": "multigrid"}, ranks=3)
        self.assertIn(0.93, list(several["t"]))


class Restart(TestCase):
    def check(self, name, scene, after, ranks=1):
        with Job(name, {**scene, **EVERY_STEP}) as job:
            reference = job.run(ranks=ranks)
            rows = without_wall_times(reference.directory / "statistics.csv")
            for n in after:
                with Job(name, {**scene, **EVERY_STEP}, copy_of=job) as again:
                    again.forget_after(n)
                    result = again.run("--restart", ranks=ranks)
                    self.assertEqual(
                        without_wall_times(result.directory / "statistics.csv"), rows
                    )

    def test_bit_by_bit(self):
        self.check("slab", {**COARSE_SLAB, **to(0.06)}, (1, 4, 9))

    def test_bit_by_bit_on_two_ranks(self):
        self.check("slab", {**COARSE_SLAB, **to(0.06)}, (5,), ranks=2)

    def test_another_tolerance_but_not_none(self):
        scene = {**COARSE_SLAB, **to(0.1), **EVERY_STEP}
        with Job("slab", scene) as job:
            most_cells = job.run()["cells"].max()
            job.forget_after(2)
            finer = {"Error control__Tolerance": 0.05}
            result = job.run("--restart", overrides=finer)
            self.assertGreater(result["cells"].max(), most_cells)
            job.forget_after(2)
            none = {"Error control__Tolerance": 0}
            refusal = job.run("--restart", code=1, overrides=none)
            self.assertIn("'Error control/Tolerance' is 0", refusal.stderr)


class Missed(TestCase):
    """A tolerance out of reach: the run ends with what it has, and says why."""

    def check(self, pattern, tolerance=0.03, **more):
        short = {"Time/Phases": "1: 4"}
        result = run("slab", {**COARSE_SLAB, **short, **to(tolerance), **more})
        self.assertEqual(result["t"][-1], 1.0)
        self.assertNotIn("has been kept", result.stdout)
        self.assertRegex(
            result.stdout,
            rf"Warning: 'Error control/Tolerance' = {tolerance} has not been kept: at t = "
            r"\S+ the error is estimated as 0\.\d+ of the solution.*" + pattern,
        )
        return result

    def test_for_cells(self):
        result = self.check(
            "'Mesh refinement/Cell budget' = 200", **{"Mesh refinement/Cell budget": 200}
        )
        self.assertLess(result["cells"].max(), 260)

    def test_for_memory(self):
        result = self.check(
            "'Mesh refinement/Memory budget' = 0.193 GB",
            **{"Mesh refinement/Memory budget": 0.193},
        )
        self.assertGreater(result["cells"].max(), 200)
        self.assertLess(result["cells"].max(), 1500)

    def test_for_levels(self):
        self.check(
            r"'Mesh refinement/Maximal level' = 2; at x = \(\S+ \S+\) they are 0.0625 wide",
            **{"Mesh refinement/Maximal level": 2},
        )

    def test_for_a_fixed_mesh(self):
        result = self.check(
            "fixed by 'Mesh refinement/Strategy'",
            **{"Mesh refinement/Strategy": "none"},
        )
        self.assertEqual(set(result["cells"]), {32})

    def test_for_steps(self):
        self.check(
            "'Step control/Smallest step'",
            0.05,
            **{
                "Step control/Smallest step": 0.25,
                "Material/maxwell/Viscosity": 0.2,
                "Time/Scheme": "forward Euler",
                "Time/Stiffness policy": "backward Euler",
            },
        )


class Refused(TestCase):
    refused_scene = ("slab", {**COARSE_SLAB, **to(0.1)}, None)

    def test_contradictions(self):
        self.refused(
            {"Error control/Error bar": "false"},
            r"'Error control/Tolerance' needs an estimate of the error; set 'Error "
            r"control/Error bar' = true",
        )
        self.refused(
            {"Step control/Tolerance": 0.01},
            r"'Error control/Tolerance' chooses the steps, too; set 'Step "
            r"control/Tolerance' = 0",
        )
        self.refused(
            {"Mesh refinement/Strategy": "kelly"},
            r"refines by the estimate of the error; set 'Mesh refinement/Strategy' = "
            r"residual, or none",
        )


if __name__ == "__main__":
    main()
