# SPDX-License-Identifier: LGPL-2.1-or-later
"""Time steps by their error, events of slip, and what becomes of stiff steps.

A step is a function of the accepted state, the time and the step size.  So a
run that has tried and dropped steps must agree bit by bit with a run that is
given its accepted steps as phases of one step each.
"""

import re

import numpy as np

from harness import EFFORT, TestCase, main, run
from laws import NORTON, PERZYNA
from runs import EVERY_STEP, Job, without_wall_times

CONTROL = {"Step control/Tolerance": 0.02}
SMALL = {
    "Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true",
    "Time/Phases": "1: 8, 2: 8",
    "Output/Fields every": 0,
}


def accepted_times(job):
    """The ends of all steps, as exact as checkpoints have them."""
    times = {}
    for manifest in job.checkpoints.glob("step_*/manifest*"):
        text = manifest.read_text(errors="replace")
        n = int(manifest.parent.name[5:])
        times[n] = re.search(r'"time": (.*),', text).group(1)
    return [times[n] for n in sorted(times)]


class DroppedSteps(TestCase):
    """Rejected and failed steps leave nothing behind."""

    def same_as_given_steps(self, scene, entries, ranks=1, drops=1):
        # Only runs that look for kinks know where slopes end.
        entries = {**entries, "Step control/Land on kinks": "false"}
        with Job(scene, {**entries, **EVERY_STEP}) as tried:
            result = tried.run(ranks=ranks)
            rejected = result["rejected"].sum()
            self.assertGreaterEqual(rejected, drops, "no step was rejected")
            times = accepted_times(tried)
            self.assertEqual(len(times), len(result["t"]) - 1)
            given = {
                **entries,
                **EVERY_STEP,
                "Time/Phases": ", ".join(f"{t}: 1" for t in times),
                "Step control/Tolerance": 0,
                "Step control/Landing times": "",
                "Output/Fields interval": 0,
            }
            if given.get("Time/Stiffness policy") == "subdivide":
                given["Time/Stiffness policy"] = "refuse"
            with Job(scene, given) as once:
                other = once.run(ranks=ranks)
                keep = lambda r: {
                    name: column
                    for name, column in r.statistics.items()
                    if not name.startswith("wall_")
                    and name not in ("rejected", "time_indicator")
                }
                mine, theirs = keep(result), keep(other)
                self.assertEqual(list(mine), list(theirs))
                for name in mine:
                    np.testing.assert_array_equal(mine[name], theirs[name], name)
                for n in range(1, len(times) + 1):
                    for rank in range(ranks):
                        file = f"step_{n:06d}/fields_{rank:05d}.bin"
                        paths = [j.checkpoints / file for j in (tried, once)]
                        if not paths[0].exists():
                            names = [p.name for p in tried.checkpoints.iterdir()]
                            self.fail(f"no {file} in {names}")
                        self.assertEqual(
                            paths[0].read_bytes(), paths[1].read_bytes(), file
                        )
            return result

    def test_schemes_direct(self):
        for scheme, law, tolerance in (
            ("forward Euler", {}, 0.05),
            ("Heun", PERZYNA, 0.01),
            ("backward Euler", {}, 0.05),
            ("backward Euler", NORTON, 0.1),
        ):
            self.same_as_given_steps(
                "slab",
                {
                    **SMALL,
                    **law,
                    "Time/Scheme": scheme,
                    "Step control/Tolerance": tolerance,
                    "Solver/Linear solver": "direct",
                },
            )

    def test_schemes_multigrid_two_ranks(self):
        """Preconditioners remember solves: those of dropped steps, too?"""
        for scheme in "forward Euler", "backward Euler":
            self.same_as_given_steps(
                "slab",
                {
                    **SMALL,
                    "Time/Phases": "1: 8, 1.5: 4",
                    "Step control/Tolerance": 0.05,
                    "Time/Scheme": scheme,
                    "Solver/Linear solver": "multigrid",
                    "Step control/Event tolerance": 0.01,
                },
                ranks=2,
            )

    def test_adaptive_3d(self):
        self.same_as_given_steps(
            "pad_adaptive",
            {
                "Time/Phases": "0.8: 2, 1.5: 2",
                "Output/Fields every": 0,
                "Step control/Tolerance": 0.1,
                "Step control/Event tolerance": 0.1,
                "Mesh refinement/Cell budget": 400,
                "Solver/Linear solver": "multigrid",
            },
        )

    def test_steps_that_fail(self):
        """Newton's method is not given the iterations that long steps need."""
        result = self.same_as_given_steps(
            "slab",
            {
                **SMALL,
                **NORTON,
                "Time/Phases": "1: 1",
                "Time/Scheme": "backward Euler",
                "Solver/Linear solver": "direct",
                "Solver/Maximal contact iterations": 4,
                "Step control/Tolerance": 1e3,
                "Step control/Resolve events": "false",
            },
        )
        self.assertRegex(result.stdout, r"Steps: \d+ accepted, \d+ that failed")

    def test_failures_on_one_rank(self):
        """A law without value or derivative where the step goes, in one half."""
        for scheme, rate, tolerance, end in (
            # at rest, no derivative for the first tangent
            (
                "backward Euler",
                "sigma_eq*if(t < 0.3, 1, 1 + sqrt(p + 1e-3*sigma_eq))",
                0.02,
                0.6,
            ),
            # no value beyond a strain that long explicit steps reach
            ("forward Euler", "50*sigma_eq*exp(log(0.2 - eps_eq))", 10, 1.5),
        ):
            alone, two = (
                run(
                    "layers",
                    {
                        "Material 2/Law": "parsed",
                        "Material 2/parsed/Strain rate": rate,
                        "Time/Phases": f"{end}: 1",
                        "Time/Scheme": scheme,
                        "Output/Fields every": 0,
                        "Step control/Tolerance": tolerance,
                        "Step control/Land on kinks": "false",
                    },
                    ranks=ranks,
                )
                for ranks in (1, 2)
            )
            for result in alone, two:
                self.assertRegex(result.stdout, r"Steps: \d+ acc.*, \d+ that failed")
            # Steps follow from errors less what iterations leave of them, which
            # differs between ranks: 1.2e-8 was measured.
            for name in "t", "rejected", "stored_energy", "viscous_dissipation":
                self.assertClose(
                    two[name],
                    alone[name],
                    absolute=1e-7 * abs(alone[name]).max(),
                    what=f"{scheme}, {name}",
                )

    def test_divided_steps(self):
        self.same_as_given_steps(
            "slab", {**SMALL, **PERZYNA, "Time/Stiffness policy": "subdivide"}, drops=0
        )


class Tolerance(TestCase):
    """The error of the time steps follows the tolerance."""

    def slab(self, scheme, tolerance, **entries):
        return run(
            "slab",
            {
                **SMALL,
                "Time/Scheme": scheme,
                "Step control/Tolerance": tolerance,
                "Step control/Resolve events": "false",
                "Solver/Linear solver": "direct",
                **entries,
            },
        )

    def test_error_and_number_of_steps(self):
        names = "viscous_dissipation", "stored_energy", "max_displacement"
        fine = run(
            "slab", {**SMALL, "Time/Scheme": "Heun", "Time/Phases": "1: 800, 2: 800"}
        )
        for scheme, order in ("forward Euler", 1), ("backward Euler", 1), ("Heun", 2):
            tolerances = [0.08, 0.02, 0.005, 0.00125]
            errors, steps = [], []
            for tolerance in tolerances:
                result = self.slab(scheme, tolerance)
                steps.append(len(result["t"]) - 1)
                error = max(
                    abs(result[name][result.row(t)] - fine[name][fine.row(t)])
                    / abs(fine[name]).max()
                    for name in names
                    for t in (1, 2)
                )
                errors.append(error)
                # These quantities are of first order in the error of u, with
                # constants of order one.  The estimate does not know what the
                # front of slip does that passes node by node, which is most of
                # the error of Heun's method here.
                self.assertLess(error, (2 if order == 1 else 4) * tolerance, scheme)
                self.assertLess(
                    result["estimate_time"].max() / result["energy_norm"].max(),
                    2 * tolerance,
                    scheme,
                )
            print(f"{scheme}: steps {steps}, errors {errors}")
            # Four times more exactly: four times the steps, or twice in the
            # second order; some steps are those to the ends of phases.
            growth = np.log(steps[3] / steps[2]) / np.log(4)
            self.assertClose(growth, 1 / order, absolute=0.15, what=scheme)
            # 4.0, 3.9; Heun: 2.2, by that front
            self.assertLess(errors[3], errors[2] / (2.5 if order == 1 else 2))

    def test_steps_grow_where_nothing_happens(self):
        """Held after t = 1: creep fades, and steps become longer."""
        result = self.slab(
            "backward Euler",
            0.02,
            **{
                "Time/Phases": "1: 10, 100: 990",
                "Boundary 0/Traction": "0.3*min(t, 1); 0",
            },
        )
        self.assertLess(len(result["t"]), 200)
        k = result["k"]
        late, early = k[result["t"] > 50].max(), k[1:8].min()
        self.assertGreater(late, 20 * early)

    def test_explicit_steps_stay_within_the_limit(self):
        for scheme in "forward Euler", "Heun":
            result = self.slab(scheme, 10, **PERZYNA)
            inner = slice(1, None)
            self.assertLessEqual(result["k_r"][inner].max(), 2 * (1 + 1e-9))
            self.assertGreater(result["k_r"][inner].max(), 1.5)
            self.assertTrue(np.all(np.isfinite(result["max_displacement"])))

    def test_jump_in_the_load(self):
        """Survived at a time nobody knows, landed on, and found."""
        jump = {
            "Boundary 0/Traction": "if(t < 0.537, 0.05, 0.15)*min(10*t, 1); 0",
            "Time/Phases": "1: 10",
        }
        fine = run(
            "slab",
            {**SMALL, **jump, "Time/Scheme": "Heun",
             "Time/Phases": "0.537: 537, 1: 463"},
        )
        for scheme in "forward Euler", "Heun", "backward Euler":
            tolerance = 0.01 if scheme != "Heun" else 0.002
            blind = {**jump, "Step control/Land on kinks": "false"}
            unknown = self.slab(scheme, tolerance, **blind)
            self.assertLess(unknown["force_balance_defect"][1:].max(), 1e-8)
            known = self.slab(
                scheme, tolerance, **blind, **{"Step control/Landing times": "0.537"}
            )
            self.assertIn(0.537, known["t"])
            self.assertLess(len(known["t"]), 1.5 * len(unknown["t"]))
            found = self.slab(scheme, tolerance, **jump)
            self.assertTrue(np.any(abs(found["t"] - 0.5370005) < 1e-9))
            self.assertLess(len(found["t"]), 1.2 * len(unknown["t"]))
            # the jump is as large as the solution, whose path is some two times
            # as long as itself, and dissipation is of second degree
            for result in unknown, known, found:
                for name in "max_displacement", "viscous_dissipation":
                    self.assertClose(
                        result[name][-1], fine[name][-1], relative=0.05, what=name
                    )


class Times(TestCase):
    def test_landing(self):
        """Phase ends, listed times and times of output are ends of steps, and
        no step is much shorter for it than those before and after it."""
        result = run(
            "slab",
            {
                **SMALL,
                "Step control/Tolerance": 0.02,
                "Step control/Resolve events": "false",
                "Step control/Landing times": "0.123456789, 1.7",
                "Output/Fields interval": 0.3,
            },
        )
        for t in [0.123456789, 1.0, 1.7, 2.0] + [0.3 * i for i in range(1, 7)]:
            self.assertLess(abs(result["t"] - t).min(), 1e-12, f"t = {t}")
        written = [t for t, _ in result.series("solution")]
        self.assertClose(
            written, [0.3 * i for i in range(7)] + [2], absolute=1e-12, what="output"
        )
        self.assertClose(np.cumsum(result["k"]), result["t"], absolute=1e-10)
        # the last of few steps up to a time are equal
        ends = [result.row(t) for t in (0.3, 0.6, 0.9)]
        for i in ends:
            self.assertGreater(result["k"][i], 0.45 * result["k"][i - 1])

    def test_largest_step(self):
        result = run("slab", {**SMALL, **CONTROL, "Step control/Largest step": 0.01})
        self.assertLess(result["k"].max(), 0.01 * (1 + 1e-9))


class Events(TestCase):
    """The sliding block, whose times are known (prm/verification)."""

    def block(self, dim=2, **entries):
        return run(
            f"coulomb_block_{dim}d",
            {
                "Time/Phases": "1: 2, 2: 4, 4: 4",
                "Step control/Tolerance": 0.01,
                "Step control/Largest step": 0.3,
                "Step control/Event tolerance": 1e-4,
                **entries,
            },
        )

    def test_onset_and_return(self):
        result = self.block()
        t, k = result["t"], result["k"]
        slips = result["slip_area"] > 1
        # U = 0.104 at t = 1 + 0.104/0.3; back at U = 0.092: t = 3 - 0.092/0.3
        for exact, phase in ((1 + 0.104 / 0.3, 1), (3 - 0.092 / 0.3, 2)):
            first = next(i for i in range(len(t)) if slips[i] and t[i] > exact - 0.1)
            self.assertLess(t[first] - k[first], exact)
            self.assertGreater(t[first], exact - 1e-9)
            self.assertLessEqual(k[first], 1e-4 * phase * (1 + 1e-9))
        self.assertLess(len(t), 80)
        self.assertGreater(k[t > 3.3].max(), 0.05)  # and grow again
        coarse = self.block(**{"Step control/Resolve events": "false"})
        self.assertLess(len(coarse["t"]), len(t) / 2)

    def test_unloading_in_the_middle_of_a_step(self):
        """Slip ends where a smooth load turns, t = 1 in a phase to 2."""
        smooth = {
            **SMALL,
            "Material/Law": "elastic",
            "Time/Phases": "2: 16",
            "Boundary 0/Traction": "0.3*sin(pi*t/2); 0",
            "Step control/Tolerance": 0.01,
            "Step control/Event tolerance": 1e-4,
        }
        result = run("slab", smooth)
        t, k = result["t"], result["k"]
        (stop,) = [
            i
            for i in range(1, len(t))
            if result["slip_area"][i] == 0 and result["slip_area"][i - 1] > 0
        ]
        self.assertLessEqual(k[stop], 2e-4 * (1 + 1e-9))
        # The step before may have met the turn in its middle: its load is then
        # that of its end, which is as large to second order.
        self.assertClose(t[stop], 1, absolute=0.125)
        fine = run("slab", {**smooth, "Time/Phases": "2: 4000",
                            "Step control/Tolerance": 0})
        self.assertClose(
            result["friction_dissipation"][-1],
            fine["friction_dissipation"][-1],
            relative=0.02,
        )

    def test_three_dimensions_and_ranks(self):
        alone, two = (
            run(
                "pad",
                {
                    "Geometry/Arguments": "5, 5, 5 : 0, 0, 0 : 1, 1, 1 : true",
                    "Time/Phases": "0.8: 4, 1.5: 4",
                    "Output/Fields every": 0,
                    "Solver/Linear solver": "multigrid",
                    **CONTROL,
                },
                ranks=ranks,
            )
            for ranks in (1, 2)
        )
        self.assertEqual(len(alone["t"]), len(two["t"]))
        for name in "t", "rejected", "slip_area", "critical_cell_x":
            self.assertClose(
                two[name], alone[name], absolute=1e-6 * abs(alone[name]).max(), what=name
            )
        self.assertGreater(alone["rejected"].sum(), 0)


class Stiffness(TestCase):
    """The watchdog: k r of each step, the critical cell, and the policies."""

    STEPS = {**SMALL, **PERZYNA, "Time/Phases": "1: 6, 2: 6"}  # three times 2/r

    def test_reports(self):
        """In a stack of two fluids the stiffer one decides; r = mu/eta."""
        result = run(
            "layers",
            {
                "Material 1/Law": "maxwell",
                "Material 1/maxwell/Viscosity": 0.5,
                "Material 2/maxwell/Viscosity": 4,
                "Time/Phases": "2: 32",
            },
        )
        r = (2 / 2.6) / 0.5
        self.assertClose(result["k_r"][1:], 0.0625 * r, relative=1e-9)
        self.assertLess(result["critical_cell_y"][1:].max(), 0.5)
        self.assertGreater(result["critical_cell_y"][1:].min(), 0)
        self.assertRegex(result.stdout, r"time step times r +0\.096154 at t = ")

    def test_refuse(self):
        result = run("slab", self.STEPS, check=False)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"Step 1 \(t = 0\.1666\d*\): the time step 0\.1666\d* "
                         r"exceeds the stability limit 2/r = 0\.052 of forward Euler, "
                         r"which is that of the cell at x = \(")

    def test_subdivide(self):
        """Four equal parts of each step: as if they had been asked for."""
        for scheme in "forward Euler", "Heun":
            divided = run(
                "slab",
                {**self.STEPS, "Time/Scheme": scheme,
                 "Time/Stiffness policy": "subdivide"},
            )
            asked = run(
                "slab",
                {**self.STEPS, "Time/Scheme": scheme, "Time/Phases": "1: 24, 2: 24"},
            )
            self.assertLessEqual(divided["k_r"][1:].max(), 2 * (1 + 1e-9))
            for name in "t", "max_displacement", "friction_force_x", "stored_energy":
                self.assertClose(
                    divided[name],
                    asked[name],
                    absolute=1e-9 * abs(asked[name]).max(),
                    what=name,
                )

    def test_backward_euler(self):
        """All steps beyond the limit: backward Euler to the last bit. All
        within it: forward Euler. In between, both."""
        policy = {"Time/Stiffness policy": "backward Euler"}
        beyond = run("slab", {**self.STEPS, **policy})
        implicit = run("slab", {**self.STEPS, "Time/Scheme": "backward Euler"})
        within = {"Time/Phases": "1: 24, 2: 24"}
        same, explicit = (
            run("slab", {**self.STEPS, **within, **more}) for more in (policy, {})
        )
        for one, other in (beyond, implicit), (same, explicit):
            for name in "max_displacement", "friction_force_x", "estimate_time":
                np.testing.assert_array_equal(one[name], other[name], name)
        self.assertRegex(beyond.stdout, "beyond the limit 2/r: 12 of 12")
        self.assertRegex(same.stdout, "beyond the limit 2/r: 0 of 48")

        mixed = {"Time/Phases": "0.5: 3, 1: 12, 1.5: 3, 2: 12"}
        both = run("slab", {**self.STEPS, **policy, **mixed})
        newton = both["newton_iterations"][1:]
        self.assertTrue(np.array_equal(newton > 0, both["k_r"][1:] > 2))
        fine = run("slab", {**self.STEPS, "Time/Phases": "1: 200, 2: 200"})
        for name in "max_displacement", "friction_force_x":
            self.assertClose(
                both[name][-1],
                fine[name][-1],
                absolute=0.05 * abs(fine[name]).max(),
                what=name,
            )

    def test_heun_at_the_end_of_its_step(self):
        """Norton's r grows with the stress, so that only the predicted end of a
        step may be beyond the limit."""
        entries = {
            **SMALL,
            **NORTON,
            "Time/Scheme": "Heun",
            "Time/Phases": "1: 6, 2: 6",
            "Boundary 0/Traction": "0.8*min(t, 2 - t); 0",
        }
        refused = run("slab", entries, check=False)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("exceeds the stability limit", refused.stderr)
        fine = run("slab", {**entries, "Time/Phases": "1: 400, 2: 400"})
        for policy in "subdivide", "backward Euler":
            result = run("slab", {**entries, "Time/Stiffness policy": policy})
            self.assertClose(
                result["max_displacement"][-1],
                fine["max_displacement"][-1],
                relative=0.1,
                what=policy,
            )

    def test_ranks(self):
        for policy in "subdivide", "backward Euler":
            alone, two = (
                run(
                    "slab",
                    {**self.STEPS, "Time/Stiffness policy": policy,
                     "Solver/Linear solver": "multigrid"},
                    ranks=ranks,
                )
                for ranks in (1, 2)
            )
            for name, column in alone.statistics.items():
                if name in EFFORT or name.startswith(("wall_", "newton", "estimate_")):
                    continue
                if name.endswith(("_defect", "_slip", "_misalignment", "_utilisation")):
                    continue
                finite = np.isfinite(column)
                self.assertClose(
                    two[name][finite],
                    column[finite],
                    absolute=1e-6 * abs(column[finite]).max() + 1e-12,
                    what=f"{policy}, {name}",
                )


class Restart(TestCase):
    """A run that goes on from a checkpoint makes the same steps."""

    def test_same_steps(self):
        for entries in (
            CONTROL,
            {**CONTROL, "Time/Scheme": "backward Euler",
             "Solver/Linear solver": "multigrid"},
            {**PERZYNA, "Time/Stiffness policy": "subdivide"},
            {**PERZYNA, "Time/Stiffness policy": "backward Euler",
             "Time/Phases": "0.5: 3, 1: 12, 1.5: 3, 2: 12",
             "Solver/Linear solver": "multigrid"},
        ):
            with Job("slab", {**SMALL, **entries, **EVERY_STEP}) as whole:
                whole.run()
                reference = without_wall_times(whole.results / "statistics.csv")
                last = whole.steps()[-1]
                for n in (last // 4, (3 * last) // 4):
                    with Job("slab", whole.overrides, copy_of=whole) as part:
                        part.forget_after(n)
                        part.run("--restart")
                        resumed = without_wall_times(part.results / "statistics.csv")
                        self.assertEqual(resumed, reference)


class Refused(TestCase):
    refused_scene = ("slab", CONTROL, None)

    def test_entries(self):
        self.refused(
            {"Error control/Error bar": "false"},
            r"'Step control/Tolerance' needs an estimate of the error; set 'Error "
            r"control/Error bar' = true",
        )
        self.refused(
            {"Step control/Landing times": "1, 3"},
            re.compile(r"'Step control/Landing times': '3' is not a time between 0 and 2\."),
        )
        self.refused(
            {"Step control/Landing times": "soon"},
            re.compile(r"'Step control/Landing times': 'soon' is not a time between 0 and 2\."),
        )
        self.refused(
            {"Step control/Landing times": "1", "Step control/Tolerance": 0},
            r"'Step control/Landing times' are given, but the steps are those of",
        )
        self.refused(
            {"Step control/Smallest step": 0.1, "Step control/Largest step": 0.01},
            re.compile(
                r"'Step control/Smallest step' = 0\.1 is larger than 'Step control/Largest "
                r"step' = 0\.01"
            ),
        )

    def test_divisions_without_end(self):
        self.refused(
            {"Material/maxwell/Viscosity": 1e-12},
            re.compile(r"The stability limit 2/r = \S+ at t = 0 would take \S+ steps until"),
        )


if __name__ == "__main__":
    main()
