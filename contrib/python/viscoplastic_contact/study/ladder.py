# SPDX-License-Identifier: LGPL-2.1-or-later
"""Refinement studies: ladders of runs of one scene, as its section `Study' describes
them (doc/study.md), and what follows from them: study.csv, study.json and study.md.

A scene without an exact solution gets a reference run, which comes before those that are
compared with it; a few coarse runs tell whether it fits into the budget. If it does not,
the study has fewer levels, but three at least."""

import itertools
import time
from dataclasses import dataclass, field
from math import isfinite, nan
from typing import Optional

from ..tables import UserError
from .analysis import cost_of_run, fit_tolerance_runs, of_variant
from .record import MethodVariant, RunKey, RunRecord
from .report import analyze, prices_in_words, write_report
from .runs import Failure, Interrupted, seconds_for_timing, seconds_of
from .scene import Scene
from .words import seconds_in_words

LADDERS = ("space", "time", "both")
# Without an exact solution: fewer do not show whether the finest run can serve as
# a reference.
FEWEST_LEVELS = 3


@dataclass
class PlannedRun:
    """A run of a study, made or not."""

    key: RunKey
    # Those that the run belongs to: ladders share runs.
    ladders: set = field(default_factory=set)
    is_reference: bool = False
    # Absent until the run is finished.
    record: Optional[RunRecord] = None
    # Why there is no record and will be none.
    skipped: str = ""


class Study:
    """The study that the scene of these runs asks for."""

    def __init__(self, runs, console):
        self.runs, self.console, self.scene = runs, console, runs.scene
        self.directory, scene = runs.directory, runs.scene
        self.start, self.last_report = time.monotonic(), 0.0
        self.budget = scene.budget
        self.ladders = scene.items("Study/Ladders") or ["both"]
        self.reference_strategy = "tolerance" if scene.has_tolerance else "uniform"
        strategies = scene.items("Study/Strategies") or [self.reference_strategy]
        own = scene.key().variant
        schemes = scene.items("Study/Time schemes") or [own.scheme]
        histories = scene.items("Study/Stress histories") or [own.history]
        choices = itertools.product(strategies, schemes, histories)
        self.planned_variants = [MethodVariant(*choice) for choice in choices]
        self.wanted_levels = self.n_levels = int(scene.number("Study/Levels"))
        # Runs that only tell what they cost, by method variant.
        self.timings = {}
        # Seconds that runs have taken beyond their steps, above all to start.
        self.overheads = []
        if "tolerance" in strategies and not scene.has_tolerance:
            raise UserError(
                "'Study/Strategies' has tolerance, but the scene has none to begin "
                "with; set 'Error control/Tolerance', or take uniform or adaptive."
            )
        needs_levels = not (scene.has_exact_solution or scene.has_tolerance)
        if needs_levels and self.n_levels < FEWEST_LEVELS:
            raise UserError(
                f"'Study/Levels' = {self.n_levels} is too few for a scene without an "
                "exact solution: whether its finest run can serve as a reference shows "
                "only in three levels; take at least 3, or give 'Exact solution' or "
                "'Error control/Tolerance'."
            )
        # Of schemes and histories the program knows the names.
        for method in itertools.product(schemes, histories):
            if method != own[1:]:
                names = "Time/Scheme", "Material/Stress history"
                entries = [f"{name}={value}" for name, value in zip(names, method)]
                Scene(runs.program, runs.files, runs.overrides + entries)
        self.make_plan()

    def levels_of(self, strategy, ladder):
        """The runs of a method variant in a ladder, as levels of mesh and time."""
        finest = self.n_levels - 1
        if strategy == "tolerance":
            coarsest = min(0, self.scene.coarsest_tolerance_level())
            levels = range(max(-finest, coarsest), 1)
            return [(level, level) for level in levels] if ladder == "both" else []
        levels = range(self.n_levels) if ladder in self.ladders else ()
        mesh, steps = ladder != "time", ladder != "space"
        return [(i if mesh else finest, i if steps else finest) for i in levels]

    def make_plan(self):
        """Decide which runs there are, the cheapest first."""
        scene, finest, planned = self.scene, self.n_levels - 1, {}

        def add(variant, level, ladder, time_level=None):
            key = RunKey(variant, level, level if time_level is None else time_level)
            planned.setdefault(key, PlannedRun(key)).ladders.add(ladder)
            return planned[key]

        for variant in self.planned_variants:
            for ladder in LADDERS:
                for mesh_level, time_level in self.levels_of(variant.strategy, ladder):
                    add(variant, mesh_level, ladder, time_level)
        if not scene.has_exact_solution:
            _, scheme, history = self.planned_variants[0]
            strategies, schemes, _ = zip(*self.planned_variants)
            last, before = finest, [finest - 1, finest]
            if scene.has_tolerance:
                # Two that tell how long it will take.
                coarsest, last = scene.coarsest_tolerance_level(), 0
                before = [level for level in (-3, -2) if level >= coarsest]
                before = [] if "tolerance" in strategies else before
                # A scene with a tolerance has the scheme that is the best for it.
                own = scene["Time/Scheme"]
                scheme = own if own in schemes else scheme
            first = MethodVariant(self.reference_strategy, scheme, history)
            for level in before:
                add(first, level, "both")
            add(first, last + 1, "both").is_reference = True

        def work(run):
            # Levels of tolerances end where those of meshes begin.
            strategy = run.key.variant.strategy
            shift = finest if strategy == "tolerance" else 0
            levels = scene.dimension * (run.key.mesh_level + shift)
            levels += run.key.time_level + shift
            return (1.0 if strategy == "uniform" else 1.5) * 2.0**levels

        # What is known early predicts the rest.
        self.plan = sorted(planned.values(), key=work)

    def records(self):
        """Those of finished runs, the cheapest first."""
        return [run.record for run in self.plan if run.record]

    def missing(self):
        return [run for run in self.plan if not run.record and not run.skipped]

    def reference(self):
        """What quantities are compared with: the reference run, or the finest
        finished uniform run in its place; None if there is none."""
        finished = [run for run in self.plan if run.record]
        uniform = [
            run
            for run in finished
            if run.key.variant.strategy == self.reference_strategy
            and "both" in run.ladders
        ]
        made = [run for run in finished if run.is_reference] or uniform
        return made[-1].record if made else None

    def timed(self, variant):
        """The records of a method variant that tell what its runs cost: all its
        finished runs, and those that were made for that alone."""
        return of_variant(self.records(), variant) + self.timings.get(variant, [])

    def variants(self):
        """Those of which there are finished runs, in the order of the plan."""
        found = [run for run in self.plan if run.record and not run.is_reference]
        return list(dict.fromkeys(run.key.variant for run in found))

    def levels_in_words(self):
        """Why the ladders have fewer levels than `Study/Levels'; empty if they do
        not."""
        if self.n_levels == self.wanted_levels:
            return ""
        return (
            f"'Study/Budget' does not reach the reference run of {self.wanted_levels} "
            f"levels: the ladders have {self.n_levels}."
        )

    def elapsed(self):
        return time.monotonic() - self.start

    def left(self):
        """Seconds in the budget."""
        return self.budget - self.elapsed()

    def expected_seconds(self, key):
        """What a run will take with its start, from those that are finished; not a
        number if that cannot be known yet."""
        scene, variant, records = self.scene, key.variant, self.records()
        # Those of the same variant, or else as similar as there are.
        alike = [r for r in records if r.key.variant.strategy == variant.strategy]
        known = of_variant(records, variant) or alike
        overhead = sum(self.overheads) / max(1, len(self.overheads))
        if variant.strategy != "tolerance":
            known = known or [r for r in records if r.key.variant.strategy != "tolerance"]
            return cost_of_run(scene, known, key)[0] + overhead if known else nan
        if not known:
            return nan
        model = fit_tolerance_runs(scene, known, "estimate_total", None)
        return model.predict(scene.tolerance(key)).seconds + overhead

    def seconds_left(self):
        """What the runs that are missing will take; not a number if that of some
        cannot be known yet."""
        return sum(self.expected_seconds(run.key) for run in self.missing())

    def find_finished(self):
        for run in self.plan:
            run.record = self.runs.find(run.key)

    def make(self, run):
        """Make a run unless it takes too long."""
        name, seconds = self.runs.name(run.key), self.expected_seconds(run.key)
        run.record = None  # such as that of a coarse run before there was a reference
        left, about = self.left(), ""
        if isfinite(seconds):
            about = f"about {seconds_in_words(seconds)}"
        if (seconds if about else 0.0) > left:
            run.skipped = (
                f"{seconds_in_words(max(0.0, left))} of 'Study/Budget' = "
                f"{seconds_in_words(self.budget)} were left"
            )
            if about:
                run.skipped = f"would take {about}, and {run.skipped}"
            it = " it" if about else ""
            self.console.say(f"{name}: left out,{it} {run.skipped}")
            return
        self.console.status(f"{name}: running" + (f", {about}" if about else ""))
        start = self.elapsed()
        try:
            run.record = self.runs.make(run.key, f"the study in the run {name}")
        except Failure as failure:
            run.skipped = f"failed: {failure}"
            self.console.say(f"{name} {run.skipped}")
            return
        spent = run.record.number("seconds_total")
        self.overheads.append(max(0.0, self.elapsed() - start - spent))
        self.announce(run.record)
        # The fits of a large study take as long as a small run.
        if self.elapsed() - self.last_report > 10.0:
            self.report()
            self.last_report = self.elapsed()

    def announce(self, record):
        """Print what a finished run has given and how long the others will take."""
        text = (
            f"{record.name}: {round(record.number('cells'))} cells, "
            f"{record.number('steps'):.3g} steps"
        )
        for column, word in (
            ("error_energy", "error "),
            ("error_stress", "of the stress "),
            ("estimate_total", "estimate "),
            ("estimate_quantity", "of the quantity "),
        ):
            if isfinite(record.number(column)):
                text += f", {word}{record.number(column):.3g}"
        text += ", " + seconds_in_words(record.number("seconds_total"))
        n_left = len(self.missing())
        if n_left:
            seconds, in_budget = self.seconds_left(), max(0.0, self.left())
            text += f"; {n_left} left"
            if isfinite(seconds):  # otherwise some are of an unknown kind
                text += f", about {seconds_in_words(seconds)}"
            if seconds > in_budget:
                text += f" of which {seconds_in_words(in_budget)} are in the budget"
        self.console.say(text)

    def make_timings(self):
        """Time the method variants on meshes for which prices are wanted and that no
        finished run has."""
        for result in analyze(self):
            if result.variant.strategy == "tolerance":
                continue
            wanted = [price for price in result.prices if price.run]
            levels = [0, *(price.run.mesh_level for price in wanted)]
            in_budget = [price.run.seconds for price in wanted if price.is_in_budget]
            most = max(in_budget, default=0.0)
            seconds = seconds_for_timing(seconds_of(result.records), most)
            seconds = min(seconds, self.left())
            found = self.timings[result.variant] = []
            what = f"the study in the run for timing of {result.variant.name}"
            for record in self.runs.make_timings(
                result.records, max(levels), seconds, what, self.console
            ):
                found.append(record)
                self.announce(record)

    def must_take_fewer_levels(self):
        can_be = not self.scene.has_tolerance and self.n_levels > FEWEST_LEVELS
        return can_be and self.seconds_left() > self.left()

    def make_first_runs(self):
        """Make the coarse runs without a reference that tell how long the reference
        run takes."""
        last = self.plan[-1].key
        self.find_finished()
        for run in self.plan:
            variant, mesh_level, time_level, _ = run.key
            is_coarse = mesh_level == time_level < last.mesh_level - 2
            if run.record is None and variant == last.variant and is_coarse:
                self.make(run)
                # Two tell that there will have to be fewer levels.
                if len(self.records()) >= 2 and self.must_take_fewer_levels():
                    return

    def find_reference(self, n_levels):
        """The record of the reference run of so many levels, which the plan has then."""
        self.n_levels = n_levels
        self.make_plan()
        self.runs.reference = self.plan[-1].key  # nothing costs more
        return self.runs.find(self.plan[-1].key)

    def make_reference(self):
        """Make the reference run, if there is time for it, of fewer levels if need
        be, unless an earlier call has made it."""
        wanted = self.wanted_levels
        fewest = wanted if self.scene.has_tolerance else FEWEST_LEVELS
        # Of fewer levels unless the budget reaches further now: the next one has twice
        # the steps on 2^dim times the cells, and all other runs take about as long as it.
        growth = 2.0 ** (self.scene.dimension + 2)
        for n_levels in range(wanted, fewest - 1, -1):
            found = self.find_reference(n_levels)
            if found and (
                n_levels == wanted
                or growth * found.number("seconds_total") > self.budget
            ):
                break
        else:
            for n_levels in range(wanted, fewest - 1, -1):
                found = self.find_reference(n_levels)
                if found:
                    break
                self.runs.reference = None
                self.make_first_runs()
                if not self.must_take_fewer_levels():
                    break
        if self.n_levels < wanted:
            self.console.say(self.levels_in_words())
        if found:
            return
        last = self.plan[-1]
        self.runs.reference = last.key
        self.make(last)
        if last.record is None:
            self.runs.reference = None
            self.console.say("The study goes on without a reference run.")

    def run(self):
        """Make what is missing. Raises Interrupted, and UserError if not a single run
        could be computed."""
        self.runs.lock_directory()
        self.console.say(f"Study of {self.scene.file}: {len(self.plan)} runs")
        try:
            self.make_all()
        except Interrupted:
            self.report()
            raise
        prices = prices_in_words(write_report(self, True), self.budget)
        self.console.say(
            f"{prices}Results in {self.directory}\n"
            f"Pictures: contrib/plot {self.directory}"
        )

    def make_all(self):
        if not self.scene.has_exact_solution:
            self.make_reference()
        self.find_finished()
        if self.records():
            self.console.say(f"Finished already: {len(self.records())}")
        for run in self.missing():
            self.make(run)
        if not self.records():
            skipped = [run for run in self.plan if run.skipped]
            reason = "'Study/Budget' leaves no time."
            if skipped:
                last = skipped[-1]
                reason = f"the run {self.runs.name(last.key)} {last.skipped}"
            raise UserError(f"No run of the study could be computed: {reason}")
        self.make_timings()

    def report(self):
        """Write the files, which say that the study is not finished."""
        if self.records():
            write_report(self, False)
