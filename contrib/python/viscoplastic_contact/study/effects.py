# SPDX-License-Identifier: LGPL-2.1-or-later
"""Ablation: a scene, and the same with one effect left out or simplified at a time.
Tells for each what it costs and what it changes, beside the error of the
discretization: what twice the mesh width changes and what twice the time steps change
(or twice the tolerance). The coarsest come first; what is settled there is not
computed on finer ones. Runs are those of StudyRuns, each in a directory of its own:
the same command goes on after an interruption."""

import time
from dataclasses import dataclass, field, replace
from math import inf, nan

from ..tables import UserError
from .effects_report import effects_in_words, write_effects
from .histories import QuantityChange, bound, changes_between, contact_force_of
from .histories import error_of_iterations, interactions, largest_of
from .record import RunRecord
from .runs import Failure, Interrupted, StudyRuns, TooSlow
from .scene import Scene
from .variants import KINDS, OBSERVATION, PROBLEM, EffectVariant, both, effect_variants

# What an effect is worth to the answer. Some quantity changes by more than twice its
# error; nothing changes by more than its error; in between, on the finest
# discretization there was time for; nothing changes but for the error of the
# iterations; what should change nothing changes nothing by more than its error; the
# scene cannot be computed without it; what stands in its place is beyond the program,
# which says nothing of the effect.
CALLED_FOR = "called for"
BELOW_THE_ERROR = "below the error of this discretization"
AS_LARGE_AS_THE_ERROR = "as large as the error of this discretization"
NEVER_ACTED = "never acted"
ONLY_WATCHES = "only watches"
CANNOT_BE_LEFT_OUT = "cannot be left out"
NOT_COMPUTED = "could not be computed"

# Changes by so many errors are changes.
CLEAR = 2.0
# A simplification may take so many times as long as the scene, and these seconds in
# any case.
MOST_TIMES, LEAST_LIMIT = 50, 10.0
# Runs shorter than this are timed twice.
SHORT_RUN = 1.0
# A run on more than this part of the cells is no coarser one.
LARGEST_COARSER = 0.75


@dataclass
class Computed:
    """A run, with its table; what it takes, and how much of that is chance: the
    difference between two runs of the same scene. Memory in MB beyond what the process
    had before."""

    record: RunRecord = None
    table: dict = field(default_factory=dict)
    seconds: float = 0.0
    seconds_chance: float = 0.0
    memory: float = 0.0
    memory_chance: float = 0.0


@dataclass
class EffectResult:
    """What the scene is without one effect, on one discretization: level 0 is that of
    the scene. Changes are those of all quantities, in the order of the scene's table,
    and last that of the displacements in the energy norm; decisive is the one that is
    the largest in proportion to its error."""

    variant: EffectVariant
    level: int = 0
    cells: float = 0.0
    verdict: str = CANNOT_BE_LEFT_OUT
    changes: list = field(default_factory=list)
    decisive: QuantityChange = field(default_factory=lambda: QuantityChange(""))
    with_it: Computed = field(default_factory=Computed)
    without: Computed = field(default_factory=Computed)
    # Why it could not be computed, and whether for its time alone.
    failure: str = ""
    is_too_slow: bool = False

    def change_of(self, quantity):
        """Not a number if there is none of this name."""
        return next((c.change for c in self.changes if c.quantity == quantity), nan)


def judge(result, smallest):
    """Find verdict and decisive change of a result whose changes are known. No change
    is one that is not larger than smallest."""
    changes = [(q, q.change, bound(q.error)) for q in result.changes]
    if changes:
        result.decisive = max(changes, key=lambda c: c[1] / (c[2] + smallest))[0]
    acts = any(change > smallest for _, change, _ in changes)
    is_above = any(change > max(error, smallest) for _, change, error in changes)
    is_clear = any(change > CLEAR * error + smallest for _, change, error in changes)
    # Iterations that end a little earlier or later are no other answer.
    if result.variant.kind == OBSERVATION and not is_above:
        result.verdict = ONLY_WATCHES
    elif not acts:
        result.verdict = NEVER_ACTED
    elif is_clear:
        result.verdict = CALLED_FOR
    else:
        result.verdict = AS_LARGE_AS_THE_ERROR if is_above else BELOW_THE_ERROR


@dataclass
class EffectInteraction:
    """Two effects left out: each by itself and both at once, on the same
    discretization. Largest: by how much leaving out the second changes another
    quantity than it does where the first is left out already, the largest in
    proportion to its error."""

    first: EffectResult
    second: EffectResult
    joint: EffectResult
    largest: QuantityChange

    @property
    def is_clear(self):
        """Whether that is more than the error explains."""
        # Four runs, each with its error.
        return self.largest.change > 2.0 * CLEAR * bound(self.largest.error)


class NoTime(Failure):
    """The budget leaves none for a run."""


def own_memory(record):
    """Beyond what the process had before."""
    return record.number("peak_memory_MB") - record.number("first_memory_MB")


class EffectsStudy:
    """The study of the effects of the scene that files and overrides give."""

    def __init__(self, program, files, overrides, console):
        self.start = time.monotonic()
        self.program, self.files = program, [str(file) for file in files]
        self.console = console
        # What `automatic' stands for in the scene is set: a variant without a law or with
        # other moduli is to differ by these alone.
        chosen = Scene(program, self.files, overrides).about["volumetric_integration"]
        self.overrides = [*overrides, f"Material/Volumetric integration={chosen}"]
        self.scene = Scene(program, self.files, self.overrides, means=True)
        self.directory = self.scene.directory + "effects/"
        self.names = self.scene.about.get("names", {})
        self.base = self.make_runs([], self.directory + "scene")
        # What has been found of each simplification: of the problem first, the largest
        # changes first.
        self.results = []
        # Two of them at once, if there are two that matter.
        self.interaction = None
        # What the budget did not reach, and why the scene could not be computed.
        self.left_out = self.failure = ""
        self.of_scene, self.with_longer_steps = {}, {}

    def make_runs(self, entries, directory, has_outputs=False):
        entries = [*entries, f"Output/Directory={directory}"]
        # With another scheme `automatic' may stand for something else.
        has_scheme = any(entry.startswith("Time/Scheme=") for entry in entries)
        scene = None if has_scheme else self.scene.with_entries(entries)
        overrides = self.overrides + entries
        return StudyRuns(self.program, self.files, overrides, scene, True, has_outputs)

    def runs_of(self, variant, level):
        """Runs of a variant below its own directory, compared with those of the scene
        on this level."""
        entries = list(variant.overrides)
        # Differences from the scene stand in the place of errors, where these are not
        # from the solution that makes the data.
        if self.is_compared:
            place = self.base.place(self.key_of(self.base, level))
            entries += [
                "Exact solution/Displacement=",
                "Exact solution/Stress=",
                f"Exact solution/Reference directory={place}",
            ]
        directory = self.directory + variant.name
        return self.make_runs(entries, directory, variant.has_outputs)

    @property
    def is_compared(self):
        return self.scene["Exact solution/Data"] == "scene"

    def key_of(self, runs, level):
        key = runs.scene.key()._replace(mesh_level=level, time_level=level)
        strategy = "tolerance" if runs.scene.has_tolerance else key.variant.strategy
        return key._replace(variant=key.variant._replace(strategy=strategy))

    def left(self):
        """Seconds in the budget."""
        return self.start + self.scene.budget - time.monotonic()

    def make(self, runs, key, expected_seconds, limit=None):
        """The record of a run, which is computed unless it is finished already. Raises
        NoTime unless it can be expected to end within the budget."""
        record = runs.find(key)
        if not record and expected_seconds > self.left():
            raise NoTime("its run would not end within 'Study/Budget'.")
        return record or runs.make(key, "the study of effects", limit)

    def compute(self, runs, level, expected_seconds, limit=None):
        """A run with its table, see make()."""
        key = self.key_of(runs, level)
        record = self.make(runs, key, expected_seconds, limit)
        seconds, memory = record.number("seconds_total"), own_memory(record)
        run = Computed(record, runs.table(key), seconds, 0.0, memory, 0.0)
        # Once more, to know what is chance. Of long runs only the scene, whose chance
        # then stands for that of others, too.
        if seconds > SHORT_RUN and level in self.of_scene:
            other = self.of_scene[level]
            run.seconds_chance = other.seconds_chance / other.seconds * seconds
            run.memory_chance = other.memory_chance
            return run
        try:
            timing = key._replace(is_timing=True)
            again = self.make(runs, timing, seconds, limit)
            pairs = (seconds, again.number("seconds_total")), (memory, own_memory(again))
            run.seconds, run.memory = map(min, pairs)
            run.seconds_chance, run.memory_chance = (abs(a - b) for a, b in pairs)
        except Failure:  # the first run is enough
            pass
        return run

    def compute_scene(self, level):
        """The scene as it is, to be found in of_scene; whether that is possible."""
        self.base.reference = self.key_of(self.base, level)
        # The first run is made in any case, another one has twice the resolution in
        # space and time.
        coarser = self.of_scene.get(level - 1)
        expected = 0.0 if self.of_scene else -inf
        if coarser:
            growth = 2.0 ** (self.scene.dimension + 1)
            expected = coarser.record.number("seconds_total") * growth
        self.failure = ""
        try:
            self.of_scene[level] = self.compute(self.base, level, expected)
        except Failure as failure:
            self.failure = str(failure)
            return False
        if coarser and not self.scene.has_tolerance:
            self.compute_with_longer_steps(level)
        return True

    def compute_with_longer_steps(self, level):
        """The scene on the mesh of a level with the steps of the coarser one, if the
        budget allows."""
        key = self.key_of(self.base, level)._replace(time_level=level - 1)
        seconds = self.of_scene[level].record.number("seconds_total")
        try:
            self.make(self.base, key, 0.5 * seconds)
            self.with_longer_steps[level] = self.base.table(key)
        except Failure:
            pass

    def add_errors(self, changes, level):
        """Put the errors of the quantities of the scene on a level beside changes of
        the same quantities: what halving the mesh and halving the steps have changed,
        at times of both runs (in a single difference they may cancel); or the error
        bar in energy, also where two tolerances had the same mesh."""
        here = self.of_scene[level]
        coarser, longer = self.of_scene.get(level - 1), self.with_longer_steps.get(level)
        cells = here.record.number("cells")
        if coarser and coarser.record.number("cells") > LARGEST_COARSER * cells:
            coarser = None
        errors = []
        if coarser:
            # Without a run with longer steps both are halved at once.
            runs = [run for run in (coarser.table, longer, here.table) if run]
            pairs = [changes_between(*pair) for pair in zip(runs, runs[1:])]
            shares = zip(*([change.change for change in of_pair] for of_pair in pairs))
            errors = list(map(sum, shares))
        bar = here.record.number("estimate_total")
        for change, error in zip(changes, errors + [bar] * len(changes)):
            change.error = error

    def compare(self, variant, level):
        """The result of a variant beside the scene on a level; None where the budget has
        ended the study."""
        self.console.status(f"{variant.effect}: {variant.instead}")
        here = self.of_scene[level]
        self.base.reference = self.key_of(self.base, level)
        cells, seconds = map(here.record.number, ("cells", "seconds_total"))
        result = EffectResult(variant, level, cells, with_it=here)
        limit = max(LEAST_LIMIT, MOST_TIMES * seconds)
        rest = max(LEAST_LIMIT, self.left())
        try:
            runs = self.runs_of(variant, level)
            found = self.compute(runs, level, seconds, min(limit, rest))
        except Interrupted:
            raise
        except NoTime:
            return None
        except TooSlow:
            if rest < limit:
                return None
            result.is_too_slow, result.verdict = True, NOT_COMPUTED
            result.failure = (
                f"not computed: it takes more than {MOST_TIMES} times the "
                f"{seconds:.2g} s of the scene."
            )
            return result
        except UserError as error:  # or what is wrong with its entries
            without = "Error control/Quantity="
            if f"'{without[:-1]}'" in str(error) and without not in variant.overrides:
                # Without the effect the scene does not have its quantity of interest.
                other = replace(variant, overrides=[*variant.overrides, without])
                return self.compare(other, level)
            result.failure = str(error)
            result.verdict = NOT_COMPUTED if variant.is_extreme else result.verdict
            return result
        result.without = found
        if variant.has_outputs:
            # Of what the runs of studies go without.
            found.seconds += found.record.number("seconds_output")
            result.with_it, result.without = found, here
        result.changes = changes_between(here.table, found.table)
        size = largest_of(here.table, "energy_norm")
        # Energy norms of a body and a rigid one cannot be compared.
        if self.is_compared and size > 0.0 and variant.instead != "rigid":
            distance = largest_of(found.table, "error_energy") / size
            result.changes.append(QuantityChange("energy_norm", distance))
        self.add_errors(result.changes, level)
        judge(result, error_of_iterations(here.table, found.table))
        return result

    def keep(self, result):
        """Replace what is known of the variant."""
        names = [*(known.variant.name for known in self.results), result.variant.name]
        place = names.index(result.variant.name)
        self.results[place : place + 1] = [result]

        def order(of):
            size = of.decisive.change if not of.failure else 1e300
            return KINDS.index(of.variant.kind), -size

        self.results.sort(key=order)

    def judge_on(self, level, variants):
        """Judge these variants on a level; returns those that are not settled."""
        undecided = []
        for variant in variants:
            result = self.compare(variant, level)
            if result:
                self.keep(result)
            # What cannot be computed here may be so with smaller steps.
            if (
                not result
                or result.verdict in (BELOW_THE_ERROR, AS_LARGE_AS_THE_ERROR)
                or (result.failure and level < 0 and not result.is_too_slow)
            ):
                undecided.append(variant)
            write_effects(self, False)
        return undecided

    def judge_all(self):
        """Judge all variants, on as fine levels as they need."""
        scene, variants = self.base.scene, []
        coarsest = -min(2, scene.n_coarser_meshes())
        if scene.has_tolerance:
            coarsest = max(-3, scene.coarsest_tolerance_level())
        levels = range(min(0, coarsest), 1)
        for level in levels:
            has_coarser = level - 1 in self.of_scene
            if not self.compute_scene(level):
                if not has_coarser:
                    continue  # too coarse
                # With the error bar in the place of a coarser run.
                if not self.results:
                    variants = self.judge_on(level - 1, variants)
                break
            if not variants:
                # What belongs to the problem first, for the budget may end.
                table = self.of_scene[level].table
                variants = effect_variants(
                    self.scene,
                    largest_of(table, "mean_von_mises"),
                    contact_force_of(table),
                )
                variants.sort(key=lambda variant: KINDS.index(variant.kind))
                self.console.say(
                    f"Effects of {self.scene.file}: {len(variants)} simplifications"
                )
            # The first one is what the next is compared with.
            if has_coarser or level == levels[-1]:
                variants = self.judge_on(level, variants)
            if not variants:
                return
        if not self.of_scene:
            raise UserError(f"The scene itself could not be computed: {self.failure}")
        # Those that are open on the mesh of the scene are settled.
        known = {result.variant.name: result for result in self.results}
        missing = [v for v in variants if v.name not in known]
        n_open = sum(v.name in known and known[v.name].level < 0 for v in variants)
        if missing:
            names = "; ".join(f"{v.effect}: {v.instead}" for v in missing)
            self.left_out = f"No time within 'Study/Budget' for {names}. "
        if n_open:
            why = ", but not within 'Study/Budget'."
            if self.failure:
                why = f", but on these the scene could not be computed: {self.failure}"
            self.left_out += (
                f"Finer meshes might tell {n_open} of them from the error{why}"
            )

    def find_interaction(self):
        """Leave out the two largest at once that are no loads: everything depends on
        these."""
        candidates = [
            result
            for result in self.results
            if result.variant.kind == PROBLEM
            and not result.variant.is_load
            and result.verdict == CALLED_FOR
        ]
        others = (
            r for r in candidates[1:] if not candidates[0].variant.excludes(r.variant)
        )
        second = next(others, None)
        if not second:
            return
        level = max(candidates[0].level, second.level)
        pair = candidates[0].variant, second.variant
        results = []
        for variant in (*pair, both(*pair)):
            results.append(self.compare(variant, level))
            if not results[-1] or results[-1].failure:
                return
        tables = [result.without.table for result in results]
        total = EffectResult(pair[0], level)
        total.changes = interactions(self.of_scene[level].table, *tables)
        self.add_errors(total.changes, level)
        judge(total, error_of_iterations(tables[0], tables[2]))
        self.interaction = EffectInteraction(*results, total.decisive)

    def run(self):
        """Make what is missing, print and write the table. Raises Interrupted, and
        UserError if the scene itself cannot be computed."""
        self.base.lock_directory()
        self.judge_all()
        self.find_interaction()
        write_effects(self, True)
        self.console.say(effects_in_words(self) + f"Results in {self.directory}")
