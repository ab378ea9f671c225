# SPDX-License-Identifier: LGPL-2.1-or-later
"""contrib/plot on studies: orders, frontiers and triangles of made-up data
with known answers, pictures of synthetic studies, and what is refused."""

import json
import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np

import synthetic_study as synthetic
from harness import SOURCE, TestCase, main
from plot_process import plot, plot_afresh

sys.path.insert(0, str(SOURCE / "contrib"))
matplotlib.use("Agg")

import matplotlib.image
import matplotlib.pyplot as plt
from plotting import convergence, cost, rates, style, work_precision
from plotting.results import UserError
from plotting.study import VARIANT, Study, error_label

NAN = float("nan")
UNIFORM = ("uniform", "forward Euler", "cell means")
ADAPTIVE = ("adaptive", "forward Euler", "cell means")
FAST = ("uniform", "fast scheme", "quadrature points")


class Folder(TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="study_")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name) / "results"


class Numbers(Folder):
    def test_observed_orders(self):
        h = np.array([0.4, 0.2, 0.1, 0.05])
        self.assertClose(rates.observed_orders(h, 3 * h**1.5), 1.5, absolute=1e-12)
        # sizes need not halve
        h = np.array([0.9, 0.3, 0.2])
        self.assertClose(rates.observed_orders(h, 7 * h**2), 2, absolute=1e-12)
        self.assertClose(rates.observed_orders(h, [1, 1, 1]), 0, absolute=0)

    def test_orders_that_are_none(self):
        for sizes, errors in (
            ([], []),
            ([0.1], [1.0]),
            ([0.1, 0.1], [1.0, 0.5]),
            ([0.1, 0.095], [1.0, 0.5]),  # hardly a change of the size
            ([0.2, 0.1], [1.0, NAN]),
            ([0.2, 0.1], [1.0, 0.0]),  # exact by chance has no logarithm
            ([0.2, 0.1], [-1.0, 0.5]),
            ([0.2, 0.1], [np.inf, 0.5]),
        ):
            orders = rates.observed_orders(sizes, errors)
            self.assertEqual(len(orders), max(len(sizes) - 1, 0))
            self.assertTrue(np.isnan(orders).all(), (sizes, errors))
            self.assertIsNone(rates.final_order(sizes, errors))

    def test_final_order_is_that_of_the_finest_known_errors(self):
        h = [0.8, 0.4, 0.2, 0.1]
        self.assertClose(rates.final_order(h, [9, 4, 2, 1]), 1, absolute=1e-12)
        self.assertClose(rates.final_order(h, [16, 4, 1, NAN]), 2, absolute=1e-12)
        self.assertClose(rates.final_order(h, [16, NAN, 1, NAN]), 2, absolute=1e-12)
        # not that of coarser runs in its place
        self.assertIsNone(rates.final_order([0.8, 0.4, 0.39], [16, 4, 3]))

    def test_efficient_frontier(self):
        seconds = np.array([1, 2, 4, 8, 3, 8, 2])
        errors = np.array([10, 5, 2, 1, 6, 0.9, 5])
        self.assertEqual(rates.efficient_frontier(seconds, errors), [0, 1, 2, 5])
        # in any order of the runs
        order = [6, 5, 4, 3, 2, 1, 0]
        found = rates.efficient_frontier(seconds[order], errors[order])
        self.assertEqual([errors[order][i] for i in found], [10, 5, 2, 0.9])

    def test_frontier_of_degenerate_studies(self):
        self.assertEqual(rates.efficient_frontier([], []), [])
        self.assertEqual(rates.efficient_frontier([3], [0.1]), [0])
        self.assertEqual(rates.efficient_frontier([3, 3], [0.1, 0.1]), [0])
        self.assertEqual(rates.efficient_frontier([3, 3], [0.2, 0.1]), [1])
        # unknown, zero and negative values never count
        seconds, errors = [1, 0, NAN, 2, 3], [NAN, 0.1, 0.1, 0.0, 0.5]
        self.assertEqual(rates.efficient_frontier(seconds, errors), [4])

    def test_frontier_dominates(self):
        """By definition, on random runs with ties."""
        random = np.random.default_rng(7)
        for n in (2, 5, 40):
            seconds = random.integers(1, 9, n) / 2
            errors = random.integers(1, 9, n) / 8
            frontier = rates.efficient_frontier(seconds, errors)
            for i in range(n):
                as_good = (seconds[frontier] <= seconds[i]) & (
                    errors[frontier] <= errors[i]
                )
                self.assertTrue(as_good.any(), "a run that nobody beats is missing")
            self.assertTrue((np.diff(seconds[frontier]) > 0).all())
            self.assertTrue((np.diff(errors[frontier]) < 0).all())

    def test_frontier_of_runs_that_gain(self):
        seconds, errors = [1, 2, 3, 4, 5], [1.0, 0.95, 0.8, 0.75, 0.5]
        self.assertEqual(rates.efficient_frontier(seconds, errors, 0.1), [0, 2, 4])

    def test_frontier_without_detours(self):
        """The third run gains next to nothing: it is far above the line between its
        neighbors, the fourth 15 % above its own."""
        seconds = 2.0 ** np.array([0, 1, 2, 3, 6])
        errors = 2.0 ** np.array([0, -3, -3.2, -5.2, -9])
        found = rates.without_detours(seconds, errors, range(5))
        self.assertEqual(found, [0, 1, 3, 4])
        self.assertEqual(rates.without_detours(seconds, errors, range(5), 1.01), [0, 1, 4])
        self.assertEqual(rates.without_detours(seconds, errors, [2]), [2])

    def test_where_fits_fit(self):
        fit = {"C_h": 2.0, "p": 1.0, "C_k": 0.0, "q": 1.0}
        h = np.array([0.4, 0.2, 0.1])
        good = rates.fits(fit, h, h, np.array([1.0, 0.43, 0.19]))
        self.assertEqual(good.tolist(), [False, True, True])

    def test_cheapest_within(self):
        seconds, errors = [1, 2, 4, 3], [0.3, 0.1, 0.01, 0.05]
        self.assertEqual(rates.cheapest_within(0.1, seconds, errors), 1)
        self.assertEqual(rates.cheapest_within(0.06, seconds, errors), 3)
        self.assertIsNone(rates.cheapest_within(0.001, seconds, errors))
        self.assertIsNone(rates.cheapest_within(0.1, [], []))

    def test_predicted_error(self):
        fit = {"C_h": 2.0, "p": 1.0, "C_k": 3.0, "q": 2.0}
        self.assertClose(rates.predicted_error(fit, 0.1, 0.2), 0.32, relative=1e-12)
        space = {"C_h": 2.0, "p": 1.0, "C_k": None, "q": None}
        self.assertClose(rates.predicted_error(space, 0.1, 0.2), 0.2, relative=1e-12)

    def test_slope_triangles(self):
        x = np.array([0.1, 0.2, 0.4])
        low, high = (x, 2 * x**1.5), (x, 5 * x)
        # a third curve crosses both in their first segments
        curves = [low, high, (x, 0.05 * (0.14 / x) ** 4)]
        for (curve_x, curve_y), above in ((low, False), (high, True)):
            segment = list(zip(curve_x[:2], curve_y[:2]))
            corners, order = rates.slope_triangle(segment, curves, above)
            self.assertClose(order, 1 if above else 1.5, absolute=1e-12)
            (x0, y0), (x1, y1), right_angle = corners
            self.assertClose(np.log(y1 / y0) / np.log(x1 / x0), order, absolute=1e-12)
            self.assertTrue(0.1 < x0 < x1 < 0.2)
            # axis-parallel sides, and away from both curves
            self.assertIn(tuple(right_angle), [(x0, y1), (x1, y0)])
            for other_x, other_y in curves:
                gap = corners[:, 1] / rates.at(corners[:, 0], other_x, other_y)
                self.assertTrue((gap > 1.2 if above else gap < 0.85).all(), gap)
        # an error that grows, and one that stays
        for p in (-1.0, 0.0):
            corners, order = rates.slope_triangle([(0.1, 0.1**p), (0.2, 0.2**p)], [])
            self.assertClose(order, p, absolute=1e-12)
            self.assertTrue(np.isfinite(corners).all())

    def test_shares_of_phases(self):
        columns = {
            "seconds_contact": np.array([2.0, 3.0, 1.0]),
            "seconds_rate": np.array([1.0, 2.0, NAN]),
            "seconds_load": np.zeros(3),
            "seconds_output": np.ones(3),  # not part of the total
        }
        parts = cost.shares(columns, [4.0, 4.0, 0.0])
        self.assertEqual(list(parts), ["seconds_rate", "seconds_contact", "rest"])
        self.assertClose(parts["seconds_contact"][:2], [0.5, 0.75], absolute=1e-15)
        # clocks that overlap leave no negative rest
        self.assertClose(parts["rest"][:2], [0.25, 0], absolute=1e-15)
        self.assertTrue(np.isnan(parts["rest"][2]))

    def test_no_phase_is_lost(self):
        """One that the picture has no words for is not drawn as the rest; a
        study without the columns of later versions is drawn as it is."""
        columns = {"seconds_tangent": [3.0], "seconds_news": [1.0], "run": ["x"]}
        parts = cost.shares(columns, [5.0])
        self.assertEqual(list(parts), ["seconds_tangent", "seconds_news", "rest"])
        self.assertClose(parts["rest"], 0.2, absolute=1e-15)
        self.assertEqual(cost.look("seconds_news")[0], "news")
        colors = [cost.look(name)[1] for name in (*cost.PHASES, "rest")]
        self.assertEqual(len(set(colors)), len(cost.PHASES) + 1)
        rows = synthetic.rows(ladders=("both",))
        new = Study(synthetic.write(self.folder / "new", rows))
        for row in rows:
            del row["seconds_tangent"]
        old = Study(synthetic.write(self.folder / "old", rows))
        for study, tangent in ((new, True), (old, False)):
            figure = cost.draw(study)
            self.addCleanup(plt.close, figure)
            texts = figure.axes[0].get_legend().get_texts()
            self.assertEqual("tangent" in [t.get_text() for t in texts], tangent)

    def test_labels(self):
        self.assertIn("$H^1$", error_label("error_h1"))
        for name, words in (
            ("slip_area_error", "of the slip area"),
            ("friction_force_x_error", "of the friction force, $x$"),
            ("reaction_12_y_error", "of the reaction 12, $y$"),
            ("point0_x_error", "of the point 0, $x$"),
            ("max_displacement_error", "of the largest displacement"),
        ):
            self.assertIn(words, error_label(name))


class Reading(Folder):
    def study(self, **more):
        rows = synthetic.rows(**more)
        return Study(synthetic.write(self.folder, rows, synthetic.about(rows)))

    def test_ladders_and_orders(self):
        study = self.study(variants=(UNIFORM, ADAPTIVE))
        self.assertEqual(study.variants(), [UNIFORM, ADAPTIVE])
        self.assertEqual(len(study.ladders()), 6)
        for ladder in study.ladders():
            axis = "k" if ladder.name == "time" else "h"
            self.assertEqual(len(ladder.rows), 4)
            self.assertTrue((np.diff(ladder.sizes(axis)) < 0).all())
            if ladder.name == "both":
                order = rates.final_order(ladder.h, study["error_stress"][ladder.rows])
                self.assertClose(order, 1, absolute=1e-12)

    def test_rows_in_any_order_and_repeated(self):
        """What a resumed study may leave behind: the last one counts."""
        rows = synthetic.rows(ladders=("both",))
        repeated = {**rows[1], "error_energy": 0.123}
        synthetic.write(self.folder, [rows[2], rows[1], rows[3], rows[0], repeated])
        (ladder,) = Study(self.folder).ladders()
        self.assertEqual(list(ladder.rows), [3, 4, 0, 2])

    def test_meshes_that_are_not_finer(self):
        """Adaptive ladders go by their levels, whatever h came out."""
        rows = synthetic.rows(ladders=("time", "both"))
        for row, h in zip(rows, (0.1, 0.11, 0.09, 0.1, 0.2, 0.1, 0.12, 0.08)):
            row["h"] = h
        study = Study(synthetic.write(self.folder, rows[::-1]))
        for ladder in study.ladders():
            self.assertTrue((np.diff(ladder.k) < 0).all(), ladder.name)

    def test_worst_quantity(self):
        rows = synthetic.rows(ladders=("both",))
        rows[0] |= dict.fromkeys(("friction_force_x_error", "point0_x_error"), "nan")
        study = Study(synthetic.write(self.folder, rows))
        self.assertTrue(np.isnan(study["quantities"][0]))
        worst = [row["friction_force_x_error"] for row in rows[1:]]
        self.assertClose(study["quantities"][1:], worst, relative=1e-12)

    def test_unknown_errors_are_left_out(self):
        study = self.study(known=("h1", "stress"))
        self.assertEqual(
            study.errors(),
            [
                "error_h1",
                "error_stress",
                "estimate_total",
                "quantities",
                "friction_force_x_error",
                "point0_x_error",
            ],
        )
        self.assertEqual(study.error(), "error_h1")
        self.assertEqual(study.error("point0_x"), "point0_x_error")
        for name, words in (
            ("error_energy", "is known for no run"),
            ("reaction_3_y", "is known for no run"),
            ("slip", "does not exist; there are: error_h1"),
        ):
            with self.assertRaisesRegex(UserError, words):
                study.error(name)

    def test_names_of_ways_say_what_differs(self):
        study = self.study(variants=(UNIFORM, ADAPTIVE))
        self.assertEqual(study.variant_label(ADAPTIVE), "adaptive")
        study = self.study(variants=(UNIFORM, FAST))
        self.assertEqual(study.variant_label(FAST), "fast scheme, quadrature points")
        study = self.study()
        self.assertEqual(study.variant_label(UNIFORM), "uniform, forward Euler")

    def test_fits_belong_to_a_way_and_an_error(self):
        study = self.study(variants=(UNIFORM, ADAPTIVE))
        self.assertClose(study.fit(ADAPTIVE, "error_energy")["C_h"], 0.15, absolute=1e-15)
        self.assertIsNone(study.fit(FAST, "error_energy"))
        self.assertIsNone(study.fit(UNIFORM, "error_stress"))


class Pictures(Folder):
    NAMES = ("convergence.png", "work_precision.png", "cost.png")

    def draw(self, *arguments, plot=plot):
        process = plot(self.folder, *arguments, "--dpi", 50)
        self.assertEqual(process.stderr, "")
        self.assertEqual(process.returncode, 0)
        paths = [Path(line) for line in process.stdout.split("\n") if line]
        for path in paths:
            self.assertTrue(path.exists())
            if path.suffix == ".png":
                image = matplotlib.image.imread(path)[:, :, :3]
                self.assertGreater(min(image.shape[:2]), 100)
                self.assertGreater((image.min(axis=2) < 0.9).mean(), 0.01)
        return [path.name for path in paths]

    def refuse(self, *arguments):
        process = plot(self.folder, *arguments)
        self.assertEqual(process.returncode, 1, process.stdout)
        self.assertNotIn("Traceback", process.stderr)
        self.assertEqual(process.stderr.count("\n"), 1, process.stderr)
        return process.stderr

    def test_a_whole_study(self):
        rows = synthetic.rows(variants=(UNIFORM, ADAPTIVE, FAST))
        synthetic.write(self.folder, rows, synthetic.about(rows))
        self.assertEqual(self.draw(plot=plot_afresh), list(self.NAMES))
        self.assertEqual(
            self.draw("convergence", "--error", "error_stress,point0_x"),
            ["convergence_error_stress.png", "convergence_point0_x_error.png"],
        )
        self.assertEqual(
            self.draw("work_precision", "--format", "pdf,svg"),
            ["work_precision.pdf", "work_precision.svg"],
        )
        self.assertEqual(
            self.draw("cost", "--output", self.folder / "x.png"), ["x.png"]
        )
        listed = plot(self.folder, "--list").stdout
        for words in ("work-precision", "error_multiplier", "peak_memory_MB"):
            self.assertIn(words, listed)

    def test_runs_to_a_tolerance(self):
        """They have no time steps to speak of, and tolerances for names."""
        rows = synthetic.rows(variants=(UNIFORM,))
        rows += synthetic.rows(
            variants=(("tolerance", *UNIFORM[1:]),), ladders=("both",)
        )
        synthetic.write(self.folder, rows)
        self.assertEqual(self.draw(), list(self.NAMES))
        study = Study(self.folder)
        figure = convergence.draw(study, "error_energy")
        lines = [
            sum(line.get_marker() in ("o", "s") for line in axes.get_lines())
            for axes in figure.axes
        ]
        self.assertEqual(lines, [3, 2], "ladders in the panels of h and k")
        rows, _ = cost.chosen(study, study.variants())
        _, heads, labels = cost.positions(study, rows)
        self.assertEqual(labels[-2:], ["25 %", "12.5 %"])
        self.assertEqual(heads[-1][1], "tolerance")

    def test_a_run_of_several_ladders_costs_once(self):
        rows = synthetic.rows(variants=(UNIFORM,))
        finest = [row for row in rows if row["mesh_level"] == row["time_level"] == 1]
        self.assertGreater(len(finest), 1)
        for row in finest:
            row["run"] = "finest"
        synthetic.write(self.folder, rows)
        study = Study(self.folder)
        chosen, _ = cost.chosen(study, study.variants())
        self.assertEqual(sorted(study["run"][chosen]), sorted(set(study["run"])))

    def test_one_run_and_no_json(self):
        synthetic.write(self.folder, synthetic.rows(levels=1, ladders=("both",)))
        self.assertEqual(self.draw(), list(self.NAMES))

    def test_very_many_runs(self):
        variants = [
            (strategy, scheme, history)
            for strategy in ("uniform", "adaptive", "tolerance")
            for scheme in ("first", "second")
            for history in ("cell means", "quadrature points")
        ]
        rows = synthetic.rows(variants=variants, levels=5)
        synthetic.write(self.folder, rows, synthetic.about(rows))
        self.assertEqual(self.draw(), list(self.NAMES))
        study = Study(self.folder)
        groups = study.groups("error_energy")
        self.assertEqual([len(group) for group in groups], [3, 4, 4, 1])
        self.assertEqual(sorted(sum(groups, [])), sorted(variants))
        strategies = [variant[0] for variant in groups[0]]
        self.assertEqual(strategies, ["uniform", "adaptive", "tolerance"])
        for group in groups:
            looks = [str(look) for look in study.looks(group).values()]
            self.assertEqual(len(set(looks)), len(group), "curves that look alike")
        shown, remark = cost.chosen(study, groups[1])
        self.assertLessEqual(len(shown), cost.MOST_RUNS)
        self.assertIn("of 60 runs", remark)
        found = set(zip(*(study[name][shown] for name in VARIANT)))
        self.assertEqual(found, set(groups[1]))
        names = self.draw("work-precision", "--all")
        numbers = ("", "_2", "_3", "_4")
        self.assertEqual(names, [f"work_precision{number}.png" for number in numbers])

    def test_best_of_each_strategy(self):
        """The one that is cheapest at the smallest error that all of them reach."""
        rows = []
        for scheme, seconds, finest in (
            ("a", 1, 4), ("b", 2000, 0.9), ("c", 3, 1.9), ("d", 9, 4)
        ):
            for strategy in ("uniform", "adaptive"):
                for row in synthetic.rows(
                    variants=((strategy, scheme, "cell means"),), ladders=("both",)
                ):
                    if strategy == "uniform":
                        row["error_energy"] *= finest / 4
                        row["seconds_total"] *= seconds
                    else:
                        row["seconds_total"] /= seconds
                    rows.append(row)
        study = Study(synthetic.write(self.folder, rows))
        best = study.groups("error_energy")[0]
        # c needs one refinement less than a, for thrice the seconds of a run; b two,
        # for far more seconds; adaptive runs differ in their seconds alone
        expected = [("adaptive", "b", "cell means"), ("uniform", "c", "cell means")]
        self.assertEqual(best, expected)

    def test_plateau_of_the_reference(self):
        """Gray up to the error that the reference is estimated to have."""
        rows = synthetic.rows(variants=(UNIFORM,))
        about = {**synthetic.about(rows), "reference_run": "finest"}
        study = Study(synthetic.write(self.folder, rows, about))
        self.assertIsNone(study.error_of_reference("error_energy"))
        (self.folder / "finest").mkdir()
        (self.folder / "finest" / "run.json").write_text(
            '{"estimated_error": {"relative": 0.05}}'
        )
        self.assertEqual(study.error_of_reference("error_energy"), 0.05)
        self.assertIsNone(study.error_of_reference("error_h1"))
        self.addCleanup(plt.close, "all")
        for module in (convergence, work_precision):
            figure = module.draw(study, "error_energy")
            (area,) = figure.axes[0].patches[-1:]
            self.assertClose(area.get_xy()[:, 1].max(), 0.05, relative=1e-12)

    def test_only_time_is_refined(self):
        rows = synthetic.rows(ladders=("time",), known=())
        synthetic.write(self.folder, rows, synthetic.about(rows, fits=[]))
        self.assertEqual(self.draw(), list(self.NAMES))

    def test_nothing_overlaps(self):
        """Legends stay off the data, numbers of an axis off each other."""
        style.set_up()
        self.addCleanup(plt.close, "all")
        rows = synthetic.rows(variants=(UNIFORM, ADAPTIVE, FAST))
        study = Study(synthetic.write(self.folder, rows, synthetic.about(rows)))
        for module in (convergence, work_precision, cost):
            figure = module.draw(study, "error_energy")
            figure.draw_without_rendering()
            for axes in figure.axes:
                panel = axes.get_window_extent()
                legend = axes.get_legend()
                if legend:
                    self.assertFalse(legend.get_window_extent().overlaps(panel))
                for axis in (axes.xaxis, axes.yaxis):
                    boxes = [
                        label.get_window_extent()
                        for label in axis.get_ticklabels()
                        if label.get_text() and label.get_visible()
                    ]
                    for a, b in zip(boxes, boxes[1:]):
                        self.assertFalse(a.overlaps(b), (module.__name__, axis))
                for text in axes.texts:
                    box = text.get_window_extent()
                    self.assertLessEqual(box.x1, figure.bbox.x1)
                    self.assertGreaterEqual(box.x0, figure.bbox.x0)

    def test_what_is_in_the_pictures(self):
        """Measured points, and orders in the words below them."""
        style.set_up()
        self.addCleanup(plt.close, "all")
        rows = synthetic.rows(variants=(UNIFORM,))
        study = Study(synthetic.write(self.folder, rows, synthetic.about(rows)))
        figure = convergence.draw(study, "error_energy")
        for axes, alone in zip(figure.axes, ("space", "time")):
            drawn = {
                tuple(np.round(point, 9))
                for line in axes.lines
                if line.get_marker() in ("o", "s")
                for point in line.get_xydata()
            }
            size = "h" if alone == "space" else "k"
            wanted = {
                (round(row[size], 9), round(row["error_energy"], 9))
                for row in rows
                if row["ladder"] in (alone, "both")
            }
            self.assertEqual(drawn, wanted)
            texts = [text.get_text() for text in axes.get_legend().get_texts()]
            self.assertIn("1.00 ($h$ and $k$)", texts[0])
            self.assertIn("fit, where it is within 10 %", texts)
        figure = work_precision.draw(study, "error_energy")
        lines = [line.get_xydata() for line in figure.axes[0].lines]
        points = {tuple(point) for line in lines for point in np.round(line, 9)}
        wanted = {
            (round(row["seconds_total"], 9), round(row["error_energy"], 9))
            for row in rows
        }
        self.assertEqual(points, wanted)

    def test_what_is_wrong(self):
        rows = synthetic.rows()
        synthetic.write(self.folder, rows, synthetic.about(rows))
        for arguments, words in (
            (["overview"], 'no picture "overview" of a study; .* work-precision'),
            (["--animate"], "--animate has no meaning"),
            (["--time", 1], "--time has no meaning"),
            (["--error", "heat"], 'the error "heat" does not exist; there are: error'),
            (["--error", "reaction_3_y"], "known for no run"),
        ):
            self.assertRegex(self.refuse(*arguments), words)

    def test_damaged_files(self):
        table = self.folder / "study.csv"
        rows = synthetic.rows()
        synthetic.write(self.folder, rows, synthetic.about(rows))
        text = table.read_text()
        header, first, *others = text.splitlines()
        for content, words in (
            ("", "study.csv has no runs"),
            (header + "\n", "study.csv has no runs"),
            (text.replace("seconds_total", "minutes"), "lacks the columns seconds_total"),
            (f"{header}\n{first}\n{others[0][:50]}\n", "damaged: its run 2 has"),
            (text.replace("dofs", "cells"), "two of its columns have the same name"),
            (text.replace(",0.125,", ",many,", 1), 'run 1 has "many" for h'),
        ):
            table.write_text(content)
            self.assertRegex(self.refuse(), words)
        table.write_bytes(b"\xff\xfe\x00")
        self.assertIn("cannot be read", self.refuse())
        table.unlink()
        self.assertIn("there is no file", self.refuse())
        table.write_text(text)
        for content, words in (
            ("{", "cannot be read"),
            ("[1]", "no JSON object"),
            ('{"fits": 3}', "its fits have no numbers"),
            ('{"fits": [{"C_h": "x"}]}', "its fits have no numbers"),
        ):
            (self.folder / "study.json").write_text(content)
            self.assertIn(words, self.refuse())
        (self.folder / "study.json").write_text(json.dumps({"fits": [None, 3]}))
        self.assertEqual(self.draw(), list(self.NAMES))

    def test_no_study(self):
        self.folder.mkdir()
        self.assertIn("no study.csv", self.refuse())
        (self.folder / "statistics.csv").write_text("step,t\n0,0\n1,1\n")
        self.assertIn("no study.csv", self.refuse("--error", "error_h1"))


if __name__ == "__main__":
    main()
