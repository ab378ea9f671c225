# SPDX-License-Identifier: LGPL-2.1-or-later
"""contrib/make_results: its tables from made-up studies with known answers,
and the page that keeps what was computed before."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import shear_layer
import synthetic_study as synthetic
import test_pad
import test_slab
from harness import PROGRAM, SOURCE, TestCase, main

sys.path.insert(0, str(SOURCE / "contrib"))

from plotting.results import UserError
from plotting.study import Study
from results_page import page, pieces, plan, references, tables
from viscoplastic_contact.scene import set_options

UNIFORM = ("uniform", "forward Euler", "cell means")
ADAPTIVE = ("adaptive", "forward Euler", "cell means")
FACTS = {"scene": "s", "law": "maxwell", "friction": "none", "d": "2", "mesh": "m"}


def cells(markdown):
    """The cells of a table, its header first."""
    lines = [line for line in markdown.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


class Folder(TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="page_")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def study(self, name="study", about=None, **more):
        rows = synthetic.rows(**more)
        return Study(
            synthetic.write(
                self.folder / name, rows, synthetic.about(rows, **(about or {}))
            )
        )


class Tables(Folder):
    def test_markdown(self):
        header, line, *rows = cells(
            tables.table(("a", "b", "c"), [("x", "1.5 s", "–"), ("y", "*2 %*", "1e-3")])
        )
        self.assertEqual(header, ["a", "b", "c"])
        self.assertEqual(line, ["---", "---:", "---:"])
        self.assertEqual(rows[1], ["y", "*2 %*", "1e-3"])

    def test_numbers(self):
        for value, digits, text in (
            (12345.6, 3, "12300"),
            (0.00012345, 2, "0.00012"),
            (1e-9, 2, "1e-09"),
            (2.0, 3, "2"),
            (float("nan"), 3, "–"),
            (None, 3, "–"),
        ):
            self.assertEqual(tables.number(value, digits), text)
        self.assertEqual(tables.percent(0.003), "0.3 %")
        self.assertEqual(tables.percent(0.1), "10 %")

    def test_orders_of_a_known_study(self):
        """The model's orders: its other term is made tiny."""
        study = self.study(model={"C_h": 1.0, "p": 1.0, "C_k": 1e-9, "q": 2.0})
        self.assertClose(tables.orders(study, "space"), 1, absolute=1e-6)
        study = self.study(model={"C_h": 1e-9, "p": 1.0, "C_k": 1.0, "q": 2.0})
        self.assertClose(tables.orders(study, "time"), 2, absolute=1e-6)
        self.assertEqual(tables.orders(study, "sideways"), [None] * 4)

    def test_convergence_rows(self):
        variants = (UNIFORM, ("uniform", "fast", "cell means"))
        study = self.study(variants=variants, known=("energy", "stress"), effectivity=2.5)
        coarse = self.study("coarse", variants=variants, levels=3, effectivity=0.5)
        studies = {"space": coarse, "time": study, "both": study}
        rows = tables.convergence_rows(studies, FACTS)
        self.assertEqual(len(rows), 2)
        for row, variant in zip(rows, variants):
            self.assertEqual(len(row), len(tables.CONVERGENCE_HEADER))
            self.assertEqual(row[:6], ["s", "maxwell", "none", "2", "m", variant[1]])
            self.assertEqual(row[8], "1.00 / – / 1.00 / –")
            # C_h h + C_k k of the finest run
            self.assertEqual(row[9], f"{100 * (0.3 / 64 + 0.2 / 80):.2g} %")
            self.assertEqual(row[10], "0.50 to 2.50")
        # one line a law; the order in k alone of one way is that of the mesh
        rows[0][7] = "0.97 / – / 0.90 / –"
        rows[1][7:9] = ["0.20 / – / 0.10 / –", "1.30 / – / 1.10 / –"]
        (line,) = tables.orders_by_law(rows)
        self.assertEqual(len(line), len(tables.ORDERS_HEADER))
        expected = ["maxwell", "2", 2, "1.00 to 1.30", "1.00 to 1.10", "–", "0.97"]
        self.assertEqual(line, [*expected, rows[0][9], "0.50 to 2.50"])
        study = self.study(known=(), levels=1)
        (row,) = tables.convergence_rows(
            dict.fromkeys(("space", "time", "both"), study), FACTS
        )
        self.assertEqual(row[6:], ["– / – / – / –"] * 3 + ["–", "–"])

    def test_low_regularity(self):
        variants = (UNIFORM, ADAPTIVE)
        rows = tables.low_regularity_rows("x", "why", self.study(variants=variants))
        for row, variant in zip(rows, variants):
            self.assertEqual(len(row), len(tables.LOW_REGULARITY_HEADER))
            self.assertEqual(row[:4], ["x", "why", variant[0], variant[1]])
            self.assertEqual(row[6], "1.00 / 1.00 / 1.00 / 1.00")
        for row, variant in zip(tables.without_other_norms(rows), variants):
            self.assertEqual((row[:3], row[5]), (["x", *variant[:2]], "1.00"))

    def test_lines_of_the_page(self):
        """They are taken from rows as they are computed."""
        known = [
            ["a", "maxwell", "20 %", "15 %", "10 %", "0.6", "9", "3", "1 s"],
            ["a", "maxwell", "10 %", "9 %", "5 %", "0.5", "90", "5", "2 s"],
            ["a", "norton", "10 %", "8 %", "4 %", "0.4", "70", "6", "3 s"],
        ]
        self.assertEqual(
            tables.known_by_scene([*known, ["b", *known[2][1:]]]),
            [
                ["a", "maxwell; norton", "20 % to 10 %", "0.4 to 0.6", "90", "5", "2 s"],
                ["b", "norton", "10 %", "0.4", "70", "6", "3 s"],
            ],
        )
        reached = [
            [scene, f"{eps} %", *(f"{eps} {name}" for name in tables.TO_TOLERANCE_HEADER[2:])]
            for scene, eps in (("a", 4), ("a", 2), ("a", 1), ("b", 8))
        ]
        lines = tables.smallest_tolerances(reached)
        shown = [["a", "2 %"], ["a", "1 %"], ["b", "8 %"]]
        self.assertEqual([line[:2] for line in lines], shown)
        self.assertEqual(lines[0][-2:], ["2 seconds", "2 uniform meshes"])
        values = [("c", "m", 1.0, "q", 1.001, 1.0), ("c", "m", 2.0, "q", 1.01, 1.0)]
        rows = [tables.reference_row(*row) for row in values]
        self.assertEqual(tables.by_case(rows), [["c", "m", 2, "1.0e-02"]])
        crept = [
            ["b", "uniform", "4", "5", "1 / 9", "9 / 1.5", "`q`", "1 / 3", "1 / 7"],
            ["b", "to 5 %", "4", "5", "1 / 4", "9 / 0.8", "`q`", "1 / 2", "– / –"],
            ["b", "quantity to 2 %", "4", "5", "1 / 3", "9 / 2", "`q`", "1 / 1", "1 / 6"],
        ]
        self.assertEqual(
            tables.creep_by_scene(crept),
            [["b", "0.8 to 2", "4 % (to 5 %)", "`q`", "6 to 7", "1 % (to 2 %)"]],
        )
        for header, shown, shorten in tables.SHORTENED.values():
            self.assertEqual(shorten([]), [])
            self.assertGreater(len(header), len(shown) - 2)

    def test_prices_are_those_of_the_cheapest_sufficient_run(self):
        study = self.study(variants=(UNIFORM, ADAPTIVE))
        error, seconds = study["error_energy"], study["seconds_total"]
        uniform = study["strategy"] == "uniform"
        for tolerance in plan.TOLERANCES:
            found = tables.price(study, UNIFORM, tolerance, "error_energy")
            enough = uniform & (error <= tolerance)
            if enough.any():
                self.assertTrue(found["measured"])
                self.assertClose(found["seconds"], seconds[enough].min(), absolute=0)
            else:
                self.assertIsNone(found)

    def test_prices_beyond_the_ladder_are_predicted(self):
        offered = {
            "strategy": "uniform",
            "scheme": "forward Euler",
            "history": "cell means",
            "error": "error_energy",
            "tolerance": 1e-4,
            "seconds": 1234.0,
            "dofs": 2e6,
            "steps": 640,
            "memory_MB": 2000.0,
        }
        about = {"prices": [{**offered, "seconds": None, "error": "x"}, offered]}
        study = self.study(variants=(UNIFORM, ADAPTIVE), about=about)
        tolerances = (0.03, 1e-4)
        rows = tables.price_rows("x", study, tolerances, "error_energy")
        header = tables.price_header(tolerances)
        self.assertEqual(header[-2:], ("3 %", "0.01 %"))
        self.assertEqual([len(row) for row in rows], [len(header)] * 2)
        # cells for unknowns as on the finest mesh
        cells = round(2e6 * 2 * 64**2 / (2 * 2 * 65**2), -1)
        self.assertEqual(rows[0][-1], f"***1200 s**: {cells:.0f} cells, 640 steps*")
        self.assertEqual(rows[1][-1], "–")
        bold = [row[-2].startswith("**") for row in rows]
        self.assertEqual(sum(bold), 1, rows)
        # other errors and other variants have no offer
        self.assertIsNone(tables.offer(study, ADAPTIVE, 1e-4, "error_energy"))
        self.assertIsNone(tables.offer(study, UNIFORM, 1e-4, "error_h1"))
        self.assertIsNone(tables.offer(study, UNIFORM, 1e-3, "error_energy"))

    def test_predictions_do_not_beat_measurements(self):
        measured = {"seconds": 5.0, "measured": True}
        predicted = {"seconds": 1.0, "measured": False}
        self.assertEqual(tables.best_seconds([None, measured, predicted]), 5)
        self.assertEqual(tables.best_seconds([None, predicted]), 1)
        self.assertIsNone(tables.best_seconds([None]))

    def test_runs_to_a_tolerance(self):
        columns = {
            "step": np.arange(4.0),
            "cells": np.array([4.0, 16.0, 40.0, 28.0]),
            "wall_total": np.array([0.0, 0.1, 0.3, 0.5]),
            "energy_norm": np.array([0.0, 1.0, 2.0, 1.0]),
            "estimate_total": np.array([0.01, 0.05, 0.08, 0.03]),
            "error_energy": np.array([0.0, 0.02, 0.06, 0.03]),
            "exact_energy": np.array([0.0, 1.0, 2.0, 1.0]),
        }
        row = tables.known_to_tolerance_row("x", "norton", 0.05, columns)
        self.assertEqual(
            row, ["x", "norton", "5 %", "4 %", "3 %", "0.6", "40", "3", "0.5 s"]
        )
        self.assertEqual(len(row), len(tables.KNOWN_TO_TOLERANCE_HEADER))

    def test_long_creep(self):
        """Errors at the ends of the last four phases, of norm and quantity."""
        known = np.array([np.nan, 0.1, 0.01, np.nan, 0.02, 0.03, 0.05])
        columns = {
            "t": np.arange(7.0),
            "step": np.arange(7.0),
            "cells": np.full(7, 16.0),
            "energy_norm": np.arange(7.0) / 6,
            "error_energy": known,
            "estimate_total": 1.5 * known,
            "point0_x": np.arange(7.0) + 0.4,
            "quantity_total": np.full(7, 0.2),
        }
        reference = {"t": np.arange(0, 6.1, 0.5), "point0_x": np.arange(0, 6.1, 0.5)}
        row = tables.long_creep_row("x", "uniform", "point0_x", columns, reference)
        self.assertEqual(
            row,
            [
                *("x", "uniform", "16", "6", "1 / 2 / 3 / 5"),
                *("1.5 / 1.5 / 1.5 / 1.5", "`point0_x`"),
                *("6.7 / 6.7 / 6.7 / 6.7", "0.5 / 0.5 / 0.5 / 0.5"),
            ],
        )
        self.assertEqual(len(row), len(tables.LONG_CREEP_HEADER))
        del columns["quantity_total"]
        row = tables.long_creep_row("x", "to 5 %", "point0_x", columns, reference)
        self.assertEqual(row[-1], " / ".join([tables.UNKNOWN] * 4))
        self.assertEqual(plan.more_steps("1: 2, 10: 3"), "1: 8, 10: 12")

    def test_runs_to_a_tolerance_beside_uniform_meshes(self):
        variants = (("tolerance", *UNIFORM[1:]), UNIFORM)
        offered = {
            **dict(zip(("strategy", "scheme", "history"), UNIFORM)),
            "error": "error_energy",
            "tolerance": 1e-5,
            "seconds": 2e5,
        }
        study = self.study(
            variants=variants, ladders=("both",), about={"prices": [offered]}
        )
        uniform = study["strategy"] == "uniform"
        error, seconds = study["error_energy"][uniform], study["seconds_total"][uniform]

        def between(reached):
            return tables.uniform_seconds(reached, study, (1e-5,), "error_energy")

        for e, s in zip(error, seconds):
            self.assertClose(between(e), s, 1e-12)
        middle = (error[:-1] * error[1:]) ** 0.5
        for e, s in zip(middle, (seconds[:-1] * seconds[1:]) ** 0.5):
            self.assertClose(between(e), s, 1e-12)
        self.assertTrue(np.isnan(between(2 * error.max())))
        # beyond the runs, the price list
        self.assertClose(between(1e-5), 2e5, 1e-12)
        self.assertTrue(seconds.max() < between(1e-4) < 2e5)

        rows = tables.to_tolerance_rows(
            "x", study, (1e-5,), "error_energy", "forward Euler"
        )
        self.assertEqual(len(rows), len(error))
        for row in rows:
            self.assertEqual(len(row), len(tables.TO_TOLERANCE_HEADER))
            self.assertEqual(row[-1], "1")  # they are the same runs
        self.assertEqual(rows[0][5], "–")
        # first order in the width of the cells
        self.assertEqual([row[5] for row in rows[1:]], ["0.50"] * (len(rows) - 1))

    def test_fits(self):
        study = self.study(variants=(UNIFORM, ADAPTIVE))
        rows = tables.fit_rows(study, "error_energy")
        self.assertEqual(rows[0][3:], ["0.3", "1", "0.2", "1", "1.01", "1.5"])
        self.assertEqual(rows[1][3:], ["0.15", "1", "0.2", "1", "1.01", "1.5"])
        self.assertEqual(tables.fit_rows(study, "error_stress"), [])

    def test_savings(self):
        """Half of the seconds, one error changed by 4 %; a run that only one
        of the studies has does not count."""
        coupled = self.study("coupled", ladders=("both",))
        rows = synthetic.rows(ladders=("both",), levels=3)
        for row in rows:
            row["seconds_total"] *= 2
            row["seconds_contact"] *= 3
        rows[1]["error_stress"] /= 1.04
        fixed = Study(synthetic.write(self.folder / "fixed", rows))
        self.assertEqual(len(tables.matched(coupled, fixed)), 3)
        row = tables.saving_row("x", coupled, fixed)
        self.assertEqual(len(row), len(tables.SAVING_HEADER))
        self.assertEqual(row[1], "3")
        self.assertEqual(row[-2:], ["50 %", "4 % (stress)"])
        total = sum(row["seconds_total"] for row in rows)
        self.assertEqual(row[4], tables.seconds(total))
        self.assertEqual(row[5], tables.seconds(total / 2))
        other = self.study("other", variants=(ADAPTIVE,))
        self.assertEqual(tables.saving_row("x", coupled, other)[1], "0")

    def test_references(self):
        row = tables.reference_row("c", "m", 1.0, "q", 1.001, 1.0)
        self.assertEqual(len(row), len(tables.REFERENCE_HEADER))
        self.assertEqual(row, ["c", "m", "1", "q", "1.001", "1", "1.0e-03"])


class Page(Folder):
    def test_parts_are_kept(self):
        file = self.folder / "page.md"
        page.write(file, "slab", "first\n")
        page.write(file, "tolerance", "second\n")
        page.write(file, "slab", "third\n")
        parts = page.parts_of(file.read_text())
        self.assertEqual(parts["slab"], "third\n")
        self.assertEqual(parts["tolerance"], "second\n")
        self.assertEqual(parts["manufactured"], page.NOT_YET)
        self.assertEqual(set(parts), set(pieces.ABOUT))
        # what is on the page is what would be written again
        self.assertEqual(page.render(parts), file.read_text())

    def test_other_files_are_left_alone(self):
        file = self.folder / "page.md"
        file.write_text("# Mine\n")
        with self.assertRaisesRegex(UserError, "no page of contrib/make_results"):
            page.write(file, "slab", "text\n")
        self.assertEqual(file.read_text(), "# Mine\n")

    def test_redraw(self):
        """Pictures of the studies that are there; the parts of the page stay."""
        file = self.folder / "page.md"
        page.write(file, "slab", "fits of the slab\n")
        rows = synthetic.rows()
        synthetic.write(self.folder / "results" / "slab" / "study", rows)
        process = subprocess.run(
            [sys.executable, SOURCE / "contrib" / "make_results", "--redraw"]
            + ["--results", self.folder / "results", "--page", file],
            capture_output=True,
            text=True,
        )
        self.assertEqual((process.returncode, process.stderr), (0, ""))
        self.assertEqual(
            sorted(path.name for path in (self.folder / "images").iterdir()),
            [f"accuracy_slab_{name}.png" for name in ("convergence", "cost", "work_precision")],
        )
        parts = page.parts_of(file.read_text())
        self.assertEqual(parts["slab"], "fits of the slab\n")
        self.assertEqual(parts["prices"], page.NOT_YET)

    def check(self, files, overrides):
        """The program accepts the scene."""
        process = subprocess.run(
            [PROGRAM, "--check", *files, *set_options(overrides)],
            capture_output=True,
            text=True,
            cwd=self.folder,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
        )
        self.assertEqual(process.returncode, 0, process.stderr)

    def test_scenes_of_the_plan(self):
        for name, (_, overrides) in (
            *plan.DIAGRAMS.items(),
            *plan.LOW_REGULARITY.items(),
            *((name, ("", overrides)) for name, overrides in plan.TO_TOLERANCE.items()),
        ):
            scene = pieces.SCENES / f"{name}.prm"
            self.assertTrue(scene.exists(), scene)
            self.check([scene], {**plan.COUPLED, **overrides})

    def test_cases_of_manufactured_solutions(self):
        cases = pieces.manufactured_cases()
        seen = {tuple(pieces.facts(*case[:3]).values()) for case in cases}
        self.assertEqual(len(seen), len(cases))
        for scene in "tresca_2d", "coulomb_2d", "tresca_3d", "coulomb_3d":
            friction, dimension = scene.split("_")
            for law, mesh in (
                ("maxwell", "uniform"),
                ("maxwell", "distorted"),
                ("maxwell", "locally refined"),
                ("perzyna, hardening", "uniform"),
                ("elastic", "uniform"),
            ):
                case = (f"`{scene}`", law, friction, dimension[0], mesh)
                self.assertIn(case, seen)
        for scene, law, mesh, overrides in cases:
            if law is None:  # each mesh
                self.check([scene], overrides["both"])

    def test_what_is_wrong(self):
        def make(*arguments):
            process = subprocess.run(
                [sys.executable, SOURCE / "contrib" / "make_results", *arguments],
                capture_output=True,
                text=True,
            )
            self.assertNotEqual(process.returncode, 0)
            self.assertNotIn("Traceback", process.stderr)
            return process.stderr

        self.assertIn('no piece "slabs"; there are', make("slabs"))
        nothing = self.folder / "nothing"
        self.assertIn("no program", make("slab", "--executable", nothing))
        file = self.folder / "page.md"
        words = make(
            "slab",
            "--executable",
            "/bin/false",
            "--results",
            self.folder / "results",
            "--page",
            file,
        )
        self.assertIn("Not made: slab: the study of", words)
        self.assertIn("Error: slab could not be made", words)
        self.assertFalse(file.exists())


class References(TestCase):
    def test_small_sizes(self):
        """Every row is a comparison of like with like."""
        rows = [
            *references.slab_rows(test_slab, 16),
            *references.block_rows(test_slab, 32),
            *references.pad_rows(test_pad, 8),
            *references.layer_rows(shear_layer, 8, 20),
        ]
        self.assertEqual(len(rows), 12 + 3 + 6 + 2)
        for row in rows:
            what = " ".join(row)
            self.assertEqual(len(row), len(tables.REFERENCE_HEADER))
            # the scheme's error in time is 0.1 k of 0.31
            bound = 0.017 if row[3] == "foot, closed form" else 1e-3
            self.assertLess(float(row[-1]), bound, what)


if __name__ == "__main__":
    main()
