# SPDX-License-Identifier: LGPL-2.1-or-later
"""Studies: ladders of runs, what follows from them, and how they go on after
an interruption; prices of errors."""

import fcntl
import json
import re
import signal
import subprocess
import sys
import time

import numpy as np

from harness import SOURCE, TestCase, main, study_command, study_environment
from runs import TEXTS, Folder

sys.path[:0] = [str(SOURCE / "contrib"), str(SOURCE / "contrib" / "python")]

from plotting import cost
from plotting.results import read_statistics
from reporting import run as report_of_run
from reporting import written
from viscoplastic_contact.study import cost as cost_model
from viscoplastic_contact.study.record import PHASES

MANUFACTURED = SOURCE / "prm" / "verification" / "manufactured"
VERIFICATION = SOURCE / "prm" / "verification"

NUMBERS = (
    "h,k,cells,dofs,steps,seconds_total,seconds_set_up,seconds_rate,seconds_tangent,"
    "seconds_load,seconds_contact,seconds_balance,seconds_estimate,seconds_output,"
    "seconds_errors,seconds_checkpoint,seconds_rest,"
    "peak_memory_MB,contact_iterations,linear_iterations"
).split(",")
ERRORS = "error_energy,error_h1,error_stress,error_multiplier".split(",")
ESTIMATES = (
    "estimate_space,estimate_time,estimate_algebraic,estimate_initial,"
    "estimate_total,effectivity,effectivity_recovery,estimate_quantity"
).split(",")


# No price is wanted beyond the ladders.
NOTHING_TIMED = {"Study__Target_errors": 1}


def announced(text):
    """Names of the runs that were made, in their order."""
    return re.findall(r"^(\w+_h-?\d+_k-?\d+): \d+ cells", text, re.M)


def orders(rows, error, size):
    e = np.array([row[error] for row in rows])
    s = np.array([row[size] for row in rows])
    return np.log(e[:-1] / e[1:]) / np.log(s[:-1] / s[1:])


class Ladders(TestCase):
    def test_manufactured_tresca(self):
        with Folder(
            MANUFACTURED / "tresca_2d.prm",
            Geometry__Global_refinements=1,
            Time__Phases="1: 8",
            Study__Levels=3,
            Study__Target_errors="0.2, 0.1, 1e-5",
            Study__Budget=200,
        ) as folder:
            process = folder.run("study", code=0)
            rows = folder.rows()
            names = list(rows[0])
            levels = ["mesh_level", "time_level", "tolerance", "step_tolerance"]
            expected = TEXTS + levels + NUMBERS + ERRORS + ESTIMATES
            self.assertEqual(names[: len(expected)], expected)
            for quantity in names[len(expected) :: 2]:
                self.assertIn(quantity + "_error", names)
            for quantity in ("friction_force_x", "slip_area", "stored_energy"):
                self.assertIn(quantity, names)

            # three ladders of three levels that share their last run
            self.assertEqual(len(rows), 9)
            self.assertEqual(len({row["run"] for row in rows}), 7)
            self.assertEqual(sorted(announced(process.stdout)), sorted(folder.finished()))
            for row in rows:
                for name in NUMBERS + ERRORS + ["estimate_space", "effectivity"]:
                    self.assertTrue(np.isfinite(row[name]), (row["run"], name))
                self.assertEqual(row["cells"], 64 * 4 ** row["mesh_level"])
                self.assertEqual(row["steps"], 8 * 2 ** row["time_level"])
                self.assertClose(row["h"], 0.125 / 2 ** row["mesh_level"], 1e-6)
                self.assertClose(row["k"], 0.125 / 2 ** row["time_level"], 1e-6)
                self.assertGreater(row["peak_memory_MB"], 20)
                self.assertLess(row["seconds_contact"], row["seconds_total"])

            space = orders(folder.ladder("space"), "error_energy", "h")
            both = orders(folder.ladder("both"), "error_energy", "h")
            print("orders of u, energy norm:", space, both)
            self.assertGreater(both.min(), 0.9)
            # The steps of the finest level still have most of the error: only
            # the fit below knows the order of the mesh.
            self.assertGreater(space.min(), 0.3)

            about = json.loads((folder.study / "study.json").read_text())
            self.assertEqual(about["reference"], "exact")
            self.assertTrue(about["finished"])
            fit = next(f for f in about["fits"] if f["error"] == "error_energy")
            print("fit:", {k: fit[k] for k in ("C_h", "p", "C_k", "q", "m")})
            self.assertClose(fit["p"], 1, absolute=0.2)
            self.assertClose(fit["q"], 1, absolute=0.1)
            for row in rows:
                parts = [
                    fit["C_h"] * row["h"] ** fit["p"], fit["C_k"] * row["k"] ** fit["q"]
                ]
                value = np.linalg.norm(parts, ord=fit["m"])
                self.assertClose(value, row["error_energy"], 0.1)
            # What the price list promises holds where a run can be compared.
            prices = {p["tolerance"]: p for p in about["prices"]}
            self.assertLess(prices[0.1]["predicted_error"], 0.1001)
            self.assertGreater(prices[0.1]["seconds"], 0)
            self.assertFalse(prices[1e-5]["in_budget"])
            self.assertRegex(
                process.stdout, r"Error 1e-05: not within 3 min[;,].* smallest error"
            )
            text = (folder.study / "study.md").read_text()
            for part in ("Observed orders", "error = ", "Price list", "Left out"):
                self.assertIn(part, text)
            self.check_solvers(folder)

    def check_solvers(self, folder):
        """The rules by which prices choose solvers are those of the program."""
        runs = list(folder.study.glob("*/run.json"))
        self.assertGreater(len(runs), 1)
        for path in runs:
            costs = json.loads(path.read_text())["costs"]
            demand = cost_model.SolverDemand(**costs["solver_demand"])
            self.assertEqual(cost_model.choose_solver(demand), costs["solver"])
            set_up, step = cost_model.expected_cost(costs["solver"], demand)
            memory = cost_model.expected_memory(costs["solver"], demand)
            for value, name in (set_up, "set_up"), (step, "step"), (memory, "memory_MB"):
                self.assertClose(value, costs["expected"][name], 1e-12, what=name)

    def test_adaptive_with_as_many_cells(self):
        with Folder(
            MANUFACTURED / "tresca_2d.prm",
            Geometry__Global_refinements=1,
            Time__Phases="1: 10",
            Study__Levels=2,
            Study__Ladders="both",
            Study__Strategies="uniform, adaptive",
            Study__Time_schemes="backward Euler",
            **NOTHING_TIMED,
        ) as folder:
            folder.run("study", code=0)
            self.check_phases(folder)
            uniform = folder.ladder("both", strategy="uniform")[-1]
            adaptive = folder.ladder("both", strategy="adaptive")[-1]
            self.assertLess(adaptive["cells"], 1.3 * uniform["cells"])
            self.assertGreater(adaptive["cells"], 64)
            self.assertTrue(np.isfinite(adaptive["error_energy"]))
            self.assertGreater(adaptive["h"], 0.0625 / 1.2)

    def check_phases(self, folder):
        """None is lost between a run, study.csv, its picture and the manual."""
        manual = (SOURCE / "doc" / "command_line.md").read_text()
        rows = folder.rows()
        columns = {name for name in rows[0] if name.startswith("seconds_")}
        self.assertEqual(columns, {*cost.PHASES, *cost.NO_PHASES})
        for row in rows:
            table = read_statistics(folder.study / row["run"] / "statistics.csv")
            walls = {name for name in table if name.startswith("wall_")}
            self.assertIn("wall_tangent", walls)
            for name in walls - {"wall_total"}:
                seconds = row[f"seconds_{name.removeprefix('wall_')}"]
                self.assertClose(seconds, table[name].sum(), 1e-9, what=name)
            record = folder.study / row["run"] / "run.json"
            costs = json.loads(record.read_text())["costs"]
            self.assertLessEqual(set(costs["seconds"]), set(PHASES))
            parts = sum(row[name] for name in columns - {"seconds_total"})
            self.assertClose(parts, table["wall_total"][-1], 1e-9)
            log = (folder.study / row["run"] / "log.txt").read_text()
            for name in re.findall(r"^  (\S+) +\d+\.\d+ +\d+ %", log, re.M):
                if name != "whole":
                    self.assertIn(f"`{name}`", manual)

    def test_steps_that_their_error_chooses(self):
        """The time ladder is their tolerance: halved, or quartered in the second
        order; steps are counted."""
        with Folder(
            MANUFACTURED / "tresca_2d.prm",
            Geometry__Global_refinements=0,
            Time__Phases="1: 8",
            Step_control__Tolerance=0.1,
            Step_control__Resolve_events="false",
            Study__Levels=3,
            Study__Target_errors="0.1",
        ) as folder:
            folder.run("study", code=0)
            rows = folder.ladder("time")
            self.assertEqual([row["step_tolerance"] for row in rows], [0.1, 0.05, 0.025])
            self.assertEqual([row["cells"] for row in rows], [256] * 3)
            steps = np.array([row["steps"] for row in rows])
            print("steps:", steps)
            growth = steps[1:] / steps[:-1]
            self.assertGreater(growth.min(), 1.6)
            self.assertLess(growth.max(), 2.4)
            self.assertLess(rows[-1]["error_energy"], 0.7 * rows[0]["error_energy"])
            about = json.loads((folder.study / "study.json").read_text())
            fit = next(f for f in about["fits"] if f["error"] == "error_energy")
            print("fit:", {k: fit[k] for k in ("C_h", "p", "C_k", "q", "m")})
            self.assertClose(fit["p"], 1, absolute=0.2)
            self.assertClose(fit["q"], 1, absolute=0.35)
            for row in folder.rows():
                parts = [
                    fit["C_h"] * row["h"] ** fit["p"],
                    fit["C_k"] * row["step_tolerance"] ** fit["q"],
                ]
                value = np.linalg.norm(parts, ord=fit["m"])
                self.assertClose(value, row["error_energy"], 0.1)
            (cost,) = about["costs"]
            for row in rows:
                counted = cost["steps"]["c"] * row["step_tolerance"] ** -cost["steps"]["q"]
                self.assertClose(counted + cost["steps"]["constant"], row["steps"], 0.15)
            for price in about["prices"]:
                self.assertNotIn("k", price)
                self.assertGreater(price["steps"], 8)
                self.assertLess(price["step_tolerance"], 0.10001)
            text = (folder.study / "study.md").read_text()
            for part in ("TOL^", "steps = ", "Half the step tolerance"):
                self.assertIn(part, text)

            folder.set(
                Study__Time_schemes="Heun",
                Study__Levels=2,
                Study__Ladders="both",
                **NOTHING_TIMED,
            )
            folder.run("study", code=0)
            rows = folder.ladder("both")
            self.assertEqual([row["step_tolerance"] for row in rows], [0.1, 0.025])
            self.assertEqual({row["scheme"] for row in rows}, {"Heun"})

    def test_three_dimensions(self):
        with Folder(
            MANUFACTURED / "coulomb_3d.prm",
            Geometry__Arguments="2, 2, 2 : 0, 0, 0 : 1, 1, 1 : true",
            Geometry__Global_refinements=0,
            Time__Phases="1: 3",
            Study__Levels=2,
            Study__Ladders="both",
            **NOTHING_TIMED,
        ) as folder:
            folder.run("study", code=0)
            rows = folder.ladder("both")
            self.assertEqual([row["cells"] for row in rows], [8, 64])
            self.assertLess(rows[1]["error_energy"], rows[0]["error_energy"])
            self.check_solvers(folder)

    def test_timing_runs_reach_where_prices_are_wanted(self):
        """A few steps on meshes beyond those of the study tell their cost."""
        with Folder(
            VERIFICATION / "slab.prm",
            Geometry__Arguments="8, 4 : 0, 0 : 2, 1 : true",
            Time__Phases="1: 2, 2: 2",
            Study__Levels=3,
            Study__Ladders="both",
            Study__Target_errors="0.02",
        ) as folder:
            folder.run("study", code=0)
            timed = sorted(folder.study.glob("*_timing/result.json"))
            self.assertGreater(len(timed), 0)
            # finer than the reference, which is the finest
            self.assertRegex(timed[0].parent.name, r"uniform_h4_k\d_timing")
            result = json.loads(timed[-1].read_text())
            self.assertNotIn("is_difference", result["numbers"])
            self.assertFalse([row for row in folder.rows() if "timing" in row["run"]])
            about = json.loads((folder.study / "study.json").read_text())
            (costs,), (price,) = about["costs"], about["prices"]
            largest = max(solver["largest_dofs"] for solver in costs["solvers"])
            self.assertEqual(largest, result["numbers"]["dofs"])
            self.assertGreater(price["dofs"], 1e4)
            self.assertIn(
                price["solver"], ("direct", "geometric multigrid", "algebraic multigrid")
            )
            self.assertIn(result["run"], (folder.study / "study.md").read_text())
            # the same command takes them up again
            before = folder.finished()
            folder.run("study")
            self.assertEqual(folder.finished(), before)

    def test_tolerances(self):
        """Halved down to that of the scene, beside uniform meshes; errors are
        differences to a run of half the last."""
        with Folder(
            VERIFICATION / "slab.prm",
            Geometry__Arguments="8, 4 : 0, 0 : 2, 1 : true",
            Time__Phases="1: 4, 2: 4",
            Error_control__Tolerance=0.1,
            Study__Levels=3,
            Study__Ladders="both",
            Study__Strategies="tolerance, uniform",
            Study__Target_errors="0.2, 0.1, 1e-5",
            # What the last run takes is extrapolated 180-fold from the first.
            Study__Budget=600,
        ) as folder:
            folder.run("study", code=0)
            rows = folder.ladder("both", strategy="tolerance")
            self.assertEqual([row["tolerance"] for row in rows], [0.4, 0.2, 0.1, 0.05])
            self.assertEqual(rows[-1]["run"], "tolerance_0.05")
            self.assertTrue(np.isnan(rows[-1]["error_energy"]))
            for row in rows[:-1]:
                self.assertLess(row["error_energy"], row["tolerance"])
                self.assertLess(row["estimate_total"], row["tolerance"])
            self.assertLess(rows[2]["error_energy"], 0.6 * rows[1]["error_energy"])
            about = json.loads((folder.study / "study.json").read_text())
            self.assertEqual(about["reference_run"], "tolerance_0.05")
            (fit,) = about["tolerance_fits"]
            self.assertGreater(fit["cells"]["exponent_against_error"], 1.0)
            prices = [p for p in about["prices"] if p["strategy"] == "tolerance"]
            self.assertEqual([p["in_budget"] for p in prices], [True, True, False])
            for price in prices[:2]:
                self.assertClose(price["predicted_error"], price["tolerance"], 1e-2)
            text = (folder.study / "study.md").read_text()
            self.assertIn("Observed exponents against 1/error", text)
            # The same reference for given meshes, down to the finest of them.
            folder.set(Study__Strategies="uniform, adaptive", **NOTHING_TIMED)
            folder.run("study", code=0)
            about = json.loads((folder.study / "study.json").read_text())
            self.assertEqual(about["reference_run"], "tolerance_0.05")
            errors = [
                row["error_energy"]
                for strategy in ("uniform", "adaptive")
                for row in folder.ladder("both", strategy=strategy)
            ]
            self.assertEqual(len(errors), 6)
            self.assertTrue(all(0.01 < error < 0.4 for error in errors), errors)
            # With a smaller tolerance those of before are there already.
            before = folder.finished()
            folder.set(
                Error_control__Tolerance=0.05,
                Study__Strategies="tolerance",
                Study__Budget=600,
            )
            folder.run("study", code=0)
            after = folder.finished()
            # (Errors of the others are differences to another run now.)
            self.assertIn("tolerance_0.025", after)
            self.assertEqual(
                folder.ladder("both")[-1]["run"], "tolerance_0.025", list(after)
            )
            self.assertTrue(set(before) <= set(after))

    def test_reference_run_and_richardson(self):
        with Folder(
            VERIFICATION / "shear_layer_2d.prm",
            Geometry__Arguments="4, 4 : 0, 0 : 1, 1 : true",
            Time__Phases="1: 10",
            Study__Levels=3,
            Study__Ladders="both",
            **NOTHING_TIMED,
        ) as folder:
            folder.run("study", code=0)
            rows = folder.ladder("both")
            self.assertEqual(rows[-1]["run"], "uniform_h3_k3")
            self.assertTrue(np.isnan(rows[-1]["point0_x_error"]))
            # The foot has moved by 0.31 - k/10 in the discrete solution.
            for row in rows:
                self.assertClose(row["point0_x"], 0.31 - 0.1 * row["k"], 1e-6)
            reference = rows[-1]["point0_x"]
            self.assertClose(
                rows[0]["point0_x_error"], 1 - rows[0]["point0_x"] / reference, 1e-4
            )
            self.assertTrue(
                all(np.isfinite(row["error_energy"]) for row in rows[:-1]), rows
            )
            # Zero but for rounding: no relative error.
            self.assertTrue(np.isnan(rows[0]["reaction_2_y_error"]))
            text = (folder.study / "study.md").read_text()
            row = next(
                line for line in text.splitlines() if line.startswith("| point0_x ")
            )
            cells = [cell.strip() for cell in row.split("|")]
            self.assertClose(float(cells[3]), 1.0, 1e-3, what="order")
            self.assertClose(float(cells[4]), 0.31, 1e-4, what="extrapolated")
            self.assertEqual(cells[6], "good")

    def test_fewer_levels_where_the_budget_ends(self):
        """A reference that nobody can wait for would leave errors unknown."""
        with Folder(
            VERIFICATION / "slab.prm",
            Geometry__Arguments="4, 2 : 0, 0 : 2, 1 : true",
            Geometry__Global_refinements=0,
            Time__Phases="1: 1, 2: 1",
            Study__Levels=8,
            Study__Ladders="both",
            **NOTHING_TIMED,
            Study__Budget=5,
        ) as folder:
            process = folder.run("study", code=0)
            found = re.search(
                r"does not reach the reference run of 8 levels: the ladders have (\d)\.",
                process.stdout,
            )
            self.assertTrue(found, process.stdout)
            levels = int(found.group(1))
            self.assertIn(levels, range(3, 8))
            rows = folder.ladder("both")
            self.assertEqual(rows[-1]["run"], f"uniform_h{levels}_k{levels}")
            self.assertEqual(
                json.loads((folder.study / "study.json").read_text())["reference_run"],
                rows[-1]["run"],
            )
            self.assertTrue(all(row["error_energy"] > 0 for row in rows[:-1]), rows)
            self.assertIn(found.group(0), (folder.study / "study.md").read_text())

    def test_two_ranks(self):
        with Folder(
            MANUFACTURED / "tresca_2d.prm",
            Geometry__Global_refinements=1,
            Time__Phases="1: 4",
            Study__Levels=2,
            Study__Ladders="both",
            **NOTHING_TIMED,
        ) as folder:
            folder.run("study", ranks=2, code=0)
            parallel = folder.ladder("both")
            again = folder.run("study", ranks=2)
            self.assertEqual(announced(again.stdout), [])
            self.check_solvers(folder)
            # Seconds of other numbers of ranks do not go together.
            serial = folder.run("study")
            self.assertEqual(len(announced(serial.stdout)), 2)
            for one, two in zip(folder.ladder("both"), parallel):
                for name in ERRORS + ["friction_force_x", "stored_energy"]:
                    self.assertClose(two[name], one[name], 1e-5, what=name)


class Resumed(TestCase):
    SMALL = {
        "Geometry__Global_refinements": 1,
        "Time__Phases": "1: 8",
        "Study__Levels": 3,
        **NOTHING_TIMED,
    }

    def wait_for(self, folder, process, n):
        """Until so many runs are finished."""
        for _ in range(3000):
            if len(folder.finished()) >= n or process.poll() is not None:
                break
            time.sleep(0.01)
        self.assertIsNone(process.poll(), "the study ended too early")

    def start(self, folder):
        return subprocess.Popen(
            study_command(*folder.arguments("study")),
            cwd=folder.work,
            env=study_environment(),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )

    def test_after_kill(self):
        coarse = {**self.SMALL, "Geometry__Global_refinements": 0}
        with Folder(MANUFACTURED / "tresca_2d.prm", **coarse) as folder:
            process = self.start(folder)
            self.wait_for(folder, process, 3)
            process.kill()
            process.communicate()
            before = folder.finished()
            self.assertGreaterEqual(len(before), 3)
            self.assertLess(len(before), 7)
            process = folder.run("study", code=0)
            after = folder.finished()
            self.assertEqual(len(after), 7)
            self.assertEqual({name: after[name] for name in before}, before)
            self.assertEqual(set(announced(process.stdout)), set(after) - set(before))
            # One more level costs only the runs that are new.
            folder.set(Study__Levels=4, Study__Ladders="both")
            process = folder.run("study")
            self.assertEqual(announced(process.stdout), ["uniform_h3_k3"])
            # Of another scene nothing counts.
            folder.set(Study__Levels=2, Material__maxwell__Viscosity=0.4)
            process = folder.run("study")
            self.assertEqual(len(announced(process.stdout)), 2)

    def test_after_signal(self):
        with Folder(MANUFACTURED / "tresca_2d.prm", **self.SMALL) as folder:
            process = self.start(folder)
            self.wait_for(folder, process, 6)
            time.sleep(0.1)
            process.send_signal(signal.SIGTERM)
            _, stderr = process.communicate()
            # 3 in the steps of a run; between runs a signal just ends it.
            self.assertIn(process.returncode, (3, -signal.SIGTERM), stderr)
            if process.returncode == 3:
                self.assertRegex(
                    stderr, "SIGTERM has ended the study in the run uniform_"
                )
            self.assertEqual(folder.run("study").returncode, 0)
            self.assertEqual(len(folder.finished()), 7)


class Refused(TestCase):
    def refuse(self, folder, *arguments):
        process = folder.run(*arguments)
        self.assertEqual(process.returncode, 1, process.stdout)
        self.assertEqual(process.stderr.count("\n"), 1, process.stderr)
        return process.stderr

    def test_two_levels_without_exact_solution(self):
        with Folder(VERIFICATION / "shear_layer_2d.prm", Study__Levels=2) as folder:
            self.assertIn("'Study/Levels' = 2 is too few", self.refuse(folder, "study"))
            self.assertFalse(folder.results.exists())

    def test_runs_to_no_tolerance(self):
        with Folder(
            MANUFACTURED / "tresca_2d.prm", Study__Strategies="tolerance"
        ) as folder:
            self.assertIn("'Error control/Tolerance'", self.refuse(folder, "study"))

    def test_unknown_scheme(self):
        with Folder(
            MANUFACTURED / "tresca_2d.prm", Study__Time_schemes="forward Oiler"
        ) as folder:
            self.assertIn("forward Euler", self.refuse(folder, "study"))

    def test_budget(self):
        with Folder(
            MANUFACTURED / "tresca_2d.prm",
            Geometry__Global_refinements=0,
            Study__Levels=9,
            Study__Ladders="both",
            Study__Budget=2,
        ) as folder:
            process = folder.run("study", code=0)
            self.assertRegex(process.stdout, r"uniform_h8_k8: left out, it would take")
            text = (folder.study / "study.md").read_text()
            self.assertRegex(text, r"- `uniform_h8_k8`: would take about ")
            self.assertGreaterEqual(len(folder.finished()), 2)

    def test_unstable_steps_are_named_and_the_study_goes_on(self):
        with Folder(
            MANUFACTURED / "tresca_2d.prm",
            Geometry__Global_refinements=0,
            Material__maxwell__Viscosity=0.02,
            Time__Phases="1: 4",
            Study__Levels=4,
            Study__Ladders="both",
            **NOTHING_TIMED,
        ) as folder:
            folder.run("study", code=0)
            text = (folder.study / "study.md").read_text()
            self.assertRegex(text, r"`uniform_h0_k0`: failed: Step 1 .*: the time step")
            self.assertIn("uniform_h3_k3", folder.finished())

    def test_another_study_at_the_same_time(self):
        with Folder(MANUFACTURED / "tresca_2d.prm") as folder:
            folder.study.mkdir(parents=True)
            with open(folder.study / "viscoplastic_contact.lock", "w") as lock:
                fcntl.flock(lock, fcntl.LOCK_EX)
                for arguments in ("study",), ("price", "0.1", "--check"):
                    self.assertRegex(
                        self.refuse(folder, *arguments),
                        r"Another run is writing into '\S+/study/'",
                    )

    def test_price(self):
        with Folder(
            VERIFICATION / "shear_layer_2d.prm", Error_control__Error_bar="false"
        ) as folder:
            self.assertIn("needs an error", self.refuse(folder, "price", "0.1"))
            self.assertFalse(folder.results.exists())


class Price(TestCase):
    SCENE = {"Geometry__Global_refinements": 2, "Time__Phases": "1: 16"}

    def test_promise_and_truth(self):
        with Folder(MANUFACTURED / "tresca_2d.prm", **self.SCENE) as folder:
            process = folder.run("price", "0.1", "--check", code=0)
            self.assertRegex(process.stdout, r"Error 0\.1: h = .* steps, .* MB")
            self.assertFalse((folder.results / "price" / "statistics.csv").exists())
            pilots = folder.finished()
            self.assertEqual(len(pilots), 4)
            # The same again needs no pilots.
            process = folder.run("price", "0.1", code=0)
            self.assertEqual(folder.finished(), pilots)
            found = re.search(
                r"error +([\d.e-]+) predicted, ([\d.e-]+) found", process.stdout
            )
            self.assertTrue(found, process.stdout)
            predicted, actual = map(float, found.groups())
            print("error predicted and found:", predicted, actual)
            self.assertLessEqual(predicted, 0.1001)
            self.assertLess(max(predicted / actual, actual / predicted), 2)
            self.assertRegex(process.stdout, r"seconds +\S+ predicted, \S+ found")
            self.assertTrue((folder.results / "price" / "statistics.csv").exists())
            # It is in the report of the run, and a page by itself.
            page = report_of_run.page(folder.results / "price").html()
            self.assertIn("Price: what an error costs", page)
            self.assertIn(found.group(0).replace("error    ", "error "), page)
            self.assertIn("Pilot runs:", written.page(folder.results / "price").html())
            # What the scene itself has computed stays as it is.
            self.assertFalse((folder.results / "statistics.csv").exists())

    def test_of_steps_that_their_error_chooses(self):
        with Folder(
            MANUFACTURED / "tresca_2d.prm",
            Geometry__Global_refinements=1,
            Time__Phases="1: 8",
            Step_control__Tolerance=0.025,
            Step_control__Resolve_events="false",
        ) as folder:
            process = folder.run("price", "0.06", code=0)
            self.assertIn("  --set 'Step control/Tolerance=", process.stdout)
            for name, factor in ("error", 1.6), ("steps", 1.5):
                found = re.search(
                    rf"{name} +([\d.e-]+) predicted, ([\d.e-]+) found", process.stdout
                )
                self.assertTrue(found, process.stdout)
                predicted, actual = map(float, found.groups())
                print(name, "predicted and found:", predicted, actual)
                self.assertLess(max(predicted / actual, actual / predicted), factor)

    def test_of_a_mesh_that_cannot_be_made_coarser(self):
        """It is a pilot itself, and a finer one follows where there is time."""
        with Folder(
            MANUFACTURED / "tresca_2d.prm",
            Geometry__Generator="subdivided_hyper_cube",
            Geometry__Arguments="40 : 0 : 1 : true",
            Geometry__Global_refinements=0,
            Time__Phases="1: 16",
        ) as folder:
            process = folder.run("price", "0.05", "--check", code=0)
            self.assertRegex(process.stdout, r"Error 0\.05: h = .* steps, .* MB")
            pilots = set(folder.finished())
            self.assertLessEqual({"uniform_h0_k-3", "uniform_h0_k-2"}, pilots)
            self.assertFalse(any("_h-" in name for name in pilots), pilots)
            finer = [name for name in pilots if "_h1_" in name]
            message = "taken to be of first order in h"
            self.assertEqual(message in process.stdout, not finer, process.stdout)

    def test_of_pilots_that_stagnate(self):
        """Data that contradict each other at a corner: no price is better than one that
        is wrong by powers of ten."""
        with Folder(
            VERIFICATION / "slab.prm",
            Geometry__Arguments="4, 2 : 0, 0 : 2, 1 : true",
            Time__Phases="1: 16",
            Boundary_0__Role="displacement",
            Boundary_0__Displacement="0.1*t; 0",
            Boundary_3__Role="displacement",
            Boundary_3__Displacement="-0.1*t; 0",
        ) as folder:
            process = folder.run("price", "0.02", "--check")
            self.assertEqual(process.returncode, 1, process.stdout)
            for sentence in "The pilots stagnate", "So do these":
                self.assertEqual(process.stdout.count(f"{sentence}: where h and k"), 1)
            self.assertRegex(
                process.stderr,
                r"cannot be predicted: where h .* takes more than the .* of the finest",
            )
            self.assertNotIn("Error 0.02: h", process.stdout)

    def test_of_a_tolerance_beside_one_mesh(self):
        with Folder(
            MANUFACTURED / "tresca_2d.prm", Error_control__Tolerance=0.15, **self.SCENE
        ) as folder:
            process = folder.run("price", "0.1", code=0)
            self.assertRegex(process.stdout, r"Error 0\.1: tolerance 0\.\d+, on average")
            self.assertRegex(
                process.stdout, r"With one uniform mesh and equal steps, .* times as long"
            )
            table = read_statistics(folder.results / "price" / "statistics.csv")
            error = table["error_energy"].max() / table["exact_energy"].max()
            print("error asked for and found: 0.1", error)
            self.assertLess(error, 1.2 * 0.1)
            self.assertGreater(error, 0.1 / 3)

    def test_of_a_quantity(self):
        """The measure is the quantity's, far below that of the energy norm."""
        with Folder(
            VERIFICATION / "slab.prm",
            Geometry__Arguments="8, 4 : 0, 0 : 2, 1 : true",
            Material__Stress_history="quadrature points",
            Time__Phases="1: 4, 2: 4",
            Error_control__Tolerance=0.05,
            Output__Points="near = 0, 0; held = 2, 1",
            Error_control__Quantity="displacement_x of near",
        ) as folder:
            process = folder.run("price", "0.02", code=0)
            self.assertIn("estimated error of the quantity of interest", process.stdout)
            table = read_statistics(folder.results / "price" / "statistics.csv")
            self.assertLess(
                table["quantity_total"].max(),
                1.2 * 0.02 * np.abs(table["point0_x"]).max(),
            )
            self.assertGreater(
                table["estimate_total"].max(), 0.05 * table["energy_norm"].max()
            )
            folder.set(Error_control__Quantity="displacement_x of held")
            process = folder.run("price", "0.01")
            self.assertEqual(process.returncode, 1)
            self.assertIn("of held is zero in the pilot run", process.stderr)

    def test_beyond_the_budget(self):
        with Folder(
            MANUFACTURED / "tresca_2d.prm", Study__Budget=4, **self.SCENE
        ) as folder:
            process = folder.run("price", "1e-6")
            self.assertEqual(process.returncode, 1)
            self.assertRegex(
                process.stderr, r"not within 4 s.*smallest error there is about"
            )


if __name__ == "__main__":
    main()
