# SPDX-License-Identifier: LGPL-2.1-or-later
"""What an error costs, from a few short runs before a long one; and that run. The
short runs are those of a study of the scene, so that finished ones are used
again."""

import re
from math import isfinite
from pathlib import Path
from typing import NamedTuple

from ..scene import set_options
from ..tables import UserError
from .analysis import MEASURES, best_measure, cost_of_run, error_of
from .analysis import fit_tolerance_runs, fit_work_precision
from .price import list_prices, price_in_words
from .record import RunKey
from .runs import Failure, Interrupted, is_affordable, make_directory, replace_file
from .runs import seconds_for_timing, seconds_of
from .scene import LARGEST_TOLERANCE, n_steps
from .words import digits, seconds_in_words

# Meshes with so many cells are small enough to be pilots themselves.
SMALL_MESH = 1500
# The smallest tolerance of a pilot over the one that is priced, how many pilots
# there are at least, and how many count: coarser ones are too coarse to say how the
# finest go on.
PILOT_FACTOR, N_PILOTS, N_FITTED = 1.4, 2, 4
# Errors that fall by less where h or k is halved, an order of 1/3, obey no law yet.
STAGNANT = 0.8
# How often finer pilots are tried then, and for how many times what they have taken.
N_FINER, FINER_SHARE = 2, 4.0


class PilotFailure(UserError):
    """A pilot run that fails."""


class Chosen(NamedTuple):
    """The run that has been chosen, with what is set for it, by a measure of the error,
    and what it is expected to give and to cost."""

    key: RunKey
    entries: list
    measure: str
    expected: object


def stagnation(pilots, measure, eps):
    """In words, what halving h, k or both does to the error of pilots where it hardly
    falls and is not below eps yet: then no law of them reaches further. Empty where
    one does."""
    parts = [("h and k", "error", lambda r: error_of(r, measure, None), 0.0)]
    if measure == "estimate_total":
        # Each part falls by itself, and the smaller one may hide behind the other.
        for h, part, names in (
            ("h", "mesh", ("estimate_space", "estimate_initial")),
            ("k", "steps", ("estimate_time",)),
        ):
            part = f"part of the {part} in the error"
            parts.append((h, part, lambda r, names=names: sum(map(r.number, names)), 0.5))
    finest = min(pilots, key=lambda r: (r.number("h"), r.step_measure))
    if error_of(finest, measure, None) <= eps:
        return ""
    for halved, what, value, share in parts:
        shift = ("h" in halved.split(), "k" in halved.split())
        level = [n - less for n, less in zip(finest.key[1:], shift)]
        for old in (value(r) for r in pilots if list(r.key[1:3]) == level):
            if (new := value(finest)) > max(STAGNANT * old, share * eps):
                return (
                    f"where {halved} {'are' if ' ' in halved else 'is'} halved, the "
                    f"{what} goes from {digits(old)} to {digits(new)}"
                )
    return ""


def as_markdown(said):
    """Indented lines are points of a list, or options; others are paragraphs."""
    lines = []
    for line in said.splitlines():
        mark = re.match(r"  (--set )?", line)
        if not mark:
            lines += ["", line]
        elif mark[1]:
            lines += [] if lines[-1].startswith("    ") else [""]
            lines.append(f"    {line[2:]}")
        else:
            lines += [] if lines[-1].startswith("- ") else [""]
            lines.append(f"- {' '.join(line.split())}")
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip() + "\n"


class Pricing:
    """The price of the error eps of a scene, from pilot runs; says what it makes and
    finds."""

    def __init__(self, runs, eps, console):
        self.runs, self.eps, self.console = runs, eps, console
        self.scene, self.budget = runs.scene, runs.scene.budget
        self.directory = self.scene.directory + "price/"

    def pilot(self, key):
        """The record of a run, which is computed unless it is finished already."""
        record, name = self.runs.find(key), self.runs.name(key)
        if record:
            return record
        self.console.status(f"Pilot run {name}")
        try:
            return self.runs.make(key, f"the pilot run {name}")
        except Failure as failure:
            raise PilotFailure(f"The pilot runs for the price fail: {failure}") from None

    def say_runs(self, records, measure=""):
        """Runs that have been made, a line each. Without a measure they have no error,
        and only tell what they cost."""
        for record in records:
            text = f"  {record.name}: {round(record.number('cells'))} cells, "
            text += f"{record.number('steps'):g} steps, "
            if measure:
                text += f"error {digits(error_of(record, measure, None))}, "
            text += seconds_in_words(record.number("seconds_total"))
            self.console.say(text + ("" if measure else ", for its cost alone"))

    def say_prices(self, model, measure, records):
        """Of twice, once and half of the error; returns the one between."""
        seconds = seconds_in_words(seconds_of(records))
        self.console.say(f"Prices by the {MEASURES[measure]}, from pilots of {seconds}:")
        eps = self.eps
        prices = list_prices(model, [2.0 * eps, eps, 0.5 * eps], self.budget)
        for price in prices:
            self.console.say(f"  {price_in_words(model, price, self.budget)}")
        return prices[1]

    def check_budget(self, model, price):
        if not price.is_in_budget:
            raise UserError(
                f"{price_in_words(model, price, self.budget)} Raise 'Study/Budget' or "
                "take a larger error."
            )

    def measure(self, pilots):
        measure = best_measure(pilots, None, N_PILOTS)
        if not measure:
            raise UserError(
                "A price needs an error to go by, but the pilot runs know none: neither "
                "an error bar nor an exact solution has given one."
            )
        return measure

    # With given meshes and steps

    def finest_time_level(self, must_save):
        """That of the finest pilots: coarser than the scene where it has so many steps,
        or so small a tolerance of them, that pilots twice as coarse still tell
        something. Where each is as fine as the scene in space, it must save steps."""
        scene = self.scene
        for level in range(-2 if must_save else -1, 1):
            coarsest = scene.key()._replace(time_level=level - 1)
            may_be = n_steps(scene.phases) >= 2.0 ** (2 - level) * len(scene.phases)
            if scene.has_step_control:
                may_be = scene.step_tolerance(coarsest) <= LARGEST_TOLERANCE
            if may_be:
                return level
        return 1

    def pilots(self, mesh_level, time_level, has_coarser):
        """Pilots on two mesh levels, the finer one of which is given, or on that alone;
        with steps of a time level, and twice as long."""
        variant = self.scene.key().variant
        return [
            self.pilot(RunKey(variant, mesh_level + m, time_level + t))
            for m in ((-1, 0) if has_coarser else (0,))
            for t in (-1, 0)
        ]

    def finer_pilot(self, pilots, seconds):
        """Pilots on one mesh do not tell what the mesh does to the error: one more on a
        finer mesh, with the longest steps of these, if it takes no more than so many
        seconds. Without it, or where it fails, the law is a theoretical one."""
        key = pilots[0].key._replace(mesh_level=pilots[0].key.mesh_level + 1)
        cost = cost_of_run(self.scene, pilots, key)
        try:
            may_be = self.runs.find(key) or is_affordable(cost, seconds)
            return [self.pilot(key)] if may_be else []
        except PilotFailure:
            return []

    def refine(self, pilots, measure, n_left):
        """Pilots on the next finer meshes, so many times at most, where those that there
        are stagnate. Raises UserError where they still do."""
        who = "The pilots stagnate"
        while why := stagnation(pilots, measure, self.eps):
            finest = max(pilots, key=lambda r: (r.key.mesh_level, r.key.time_level))
            key = finest.key._replace(mesh_level=finest.key.mesh_level + 1)
            cost = cost_of_run(self.scene, pilots, key)
            affordable = seconds_for_timing(FINER_SHARE * seconds_of(pilots), 0.0)
            if n_left == 0 or not is_affordable(cost, affordable):
                raise UserError(
                    f"The price cannot be predicted: {why}, which says nothing of finer "
                    f"runs. An error of {digits(self.eps)} takes more than the "
                    f"{seconds_in_words(finest.number('seconds_total'))} of the finest "
                    f"pilot ({finest.name}); begin with a finer mesh or shorter steps, "
                    "or let 'Error control/Tolerance' choose them."
                )
            n_left -= 1
            self.console.say(f"{who}: {why}; finer ones follow.")
            who = "So do these"
            pilots = self.pilots(key.mesh_level, key.time_level, True)
        return pilots

    def with_given_meshes(self, seconds):
        """Measure, model and price with given meshes and steps, by the scene's own
        strategy for meshes. Pilots are on coarser meshes with longer steps, or, where the
        scene is small already, on finer ones; four of them, h and k (or the tolerance of
        the steps) each halved alone and both. A mesh that cannot be made coarser is the
        only one of two, beside a third run on the next finer mesh where there is time for
        it. Where the run is worth so many seconds, this one and timing runs take no
        longer than a share of them, see seconds_for_timing()."""
        scene, console, runs = self.scene, self.console, self.runs
        is_small, n_coarser = scene.n_cells <= SMALL_MESH, scene.n_coarser_meshes()
        # The mesh of a file that is not refined has nothing coarser.
        has_two_meshes = is_small or n_coarser >= 1
        mesh_level = 1 if is_small else -1 if n_coarser >= 2 else 0
        time_level = self.finest_time_level(not has_two_meshes)
        runs.lock_directory()
        while True:
            try:
                pilots = self.pilots(mesh_level, time_level, has_two_meshes)
                break
            except PilotFailure:
                # Long steps may be unstable or fail otherwise: then shorter ones follow.
                time_level += 1
                if time_level > 1:
                    raise
        measure = self.measure(pilots)

        def fit(timed):
            return fit_work_precision(scene, pilots, timed, measure, None)

        def seconds_left(run):
            most = min(run.seconds, self.budget, seconds)
            return seconds_for_timing(seconds_of(pilots), most)

        if has_two_meshes:
            pilots = self.refine(pilots, measure, N_FINER)
        elif wanted := fit(pilots).cheapest(self.eps):
            pilots += self.finer_pilot(pilots, seconds_left(wanted))
            self.refine(pilots, measure, 0)
        console.say("Pilot runs:")
        self.say_runs(pilots, measure)
        if not has_two_meshes and len(pilots) == 2:
            console.say(
                "A finer mesh would take too long for a pilot, and there is none "
                "coarser: the error of the mesh is taken to be of first order in h."
            )
        # A run on a mesh that is much finer than those of the pilots may have another
        # solver.
        timings = []
        if wanted := fit(pilots).cheapest(self.eps):
            level, left = wanted.mesh_level, seconds_left(wanted)
            made = runs.make_timings(pilots, level, left, "the timing runs", console)
            timings = list(made)
        self.say_runs(timings)
        model = fit(pilots + timings)
        return measure, model, self.say_prices(model, measure, pilots + timings)

    def choose_mesh_and_steps(self):
        measure, model, price = self.with_given_meshes(self.budget)
        self.console.say(model.next_refinement())
        self.check_budget(model, price)
        run = price.run
        key = self.scene.key()._replace(mesh_level=run.mesh_level)
        entries = self.scene.discretization(key, run.phases, run.k)
        return Chosen(key, entries, measure, run)

    # To a tolerance

    def to_tolerance(self):
        """Measure and price of a run to a tolerance, from pilot runs to larger ones: the
        tolerance of the scene times powers of two, from the largest that makes sense down
        to the last that is well above the one for eps, and does not take half of the
        budget."""
        scene, pilots = self.scene, []
        variant = scene.key().variant._replace(strategy="tolerance")
        self.runs.lock_directory()
        level, measure = scene.coarsest_tolerance_level(), ""
        while True:
            key = RunKey(variant, level, level)
            if len(pilots) >= N_PILOTS:
                measure = self.measure(pilots)
                model = fit_tolerance_runs(scene, pilots[-N_FITTED:], measure, None)
                following = scene.tolerance(key)
                if (
                    following < PILOT_FACTOR * model.tolerance_for(self.eps)
                    or model.predict(following).seconds > 0.5 * self.budget
                ):
                    break
            pilots.append(self.pilot(key))
            quantity = scene["Error control/Quantity"]
            if quantity and not isfinite(pilots[-1].number("estimate_quantity")):
                raise UserError(
                    f"'Error control/Quantity' = {quantity} is zero in the pilot run "
                    f"{pilots[-1].name}: it has no relative error to go by."
                )
            level += 1
        self.console.say("Pilot runs to larger tolerances:")
        self.say_runs(pilots, measure)
        price = self.say_prices(model, measure, pilots)
        self.console.say(model.exponents_in_words())
        self.check_budget(model, price)
        return measure, price

    def choose_tolerance(self):
        """Beside its price, that of runs with given meshes and steps is said."""
        measure, price = self.to_tolerance()
        run, key = price.run, self.scene.key()
        key = key._replace(variant=key.variant._replace(strategy="tolerance"))
        say, eps = self.console.say, digits(self.eps)
        say("\nFor comparison, runs with one uniform mesh and equal steps.")
        try:
            words = "is out of reach."
            if other := self.with_given_meshes(run.seconds)[2].run:
                words = (
                    f"would take about {seconds_in_words(other.seconds)}, "
                    f"{digits(other.seconds / run.seconds, 2)} times as long"
                    + (", far beyond what was measured." if other.is_far else ".")
                )
            say(f"With one uniform mesh and equal steps, the error {eps} {words}\n")
        except Interrupted:
            raise
        except UserError as error:
            say(f"Not priced: {error}\n")
        entry = f"Error control/Tolerance={digits(run.tolerance, 4)}"
        return Chosen(key, [entry], measure, run)

    # The run

    def comparison(self, chosen, result):
        """What was predicted and what has been found."""
        found = {
            "error": error_of(result, chosen.measure, None),
            "seconds": result.number("seconds_total"),
            "memory": result.number("peak_memory_MB"),
        }
        names = ["steps"] if self.scene.has_step_control else []
        names = ["cells", "steps"] if self.scene.has_tolerance else names
        after = {"seconds": ", without field output", "memory": " MB"}
        text = "\nThe prediction:\n"
        for name, actual in (found | {n: result.number(n) for n in names}).items():
            expected = getattr(chosen.expected, name)
            words = [digits(v) if isfinite(v) else "unknown" for v in (expected, actual)]
            text += f"  {name:7}  {words[0]} predicted, {words[1]} found"
            if actual > 0.0 and isfinite(actual):
                text += f" (factor {digits(expected / actual, 2)})"
            text += after.get(name, "") + "\n"
        return text

    def report(self):
        make_directory(self.directory)
        title = f"Price of an error of {digits(self.eps)}: `{Path(self.scene.file).name}`"
        said = as_markdown("".join(self.console.said))
        text = f"# {title}\n\n*{self.runs.program.origin()}*\n\n{said}"
        replace_file(self.directory + "price.md", text)

    def run(self, only_price=False, options=()):
        """A run with the mesh and the steps that reach the error at the lowest cost, as
        short runs predict it; says both before and afterwards what it costs and gives,
        which price.md has, too. With only_price it only says what it would cost. Options
        of the program go to the run. Raises Interrupted, and UserError."""
        scene, runs = self.scene, self.runs
        has_bar = scene["Error control/Error bar"] == "true"
        if not scene["Exact solution/Displacement"] and not has_bar:
            raise UserError(
                "A price needs an error to go by: set 'Error control/Error bar = true', "
                "or give an 'Exact solution'."
            )
        is_chosen = scene.has_tolerance
        chosen = self.choose_tolerance() if is_chosen else self.choose_mesh_and_steps()
        self.report()
        if only_price:
            return
        # The run that was chosen, with all output of the scene, beside what the scene
        # itself may have computed.
        entries = "".join(f"  --set '{entry}'\n" for entry in chosen.entries)
        self.console.say(f"Now the run with\n{entries}")
        entries = [
            *(*runs.overrides, *chosen.entries, f"Output/Directory={self.directory}"),
            f"Checkpoint/Directory={self.directory}checkpoint",
        ]
        words = [*options, *runs.files, *set_options(entries)]
        launch = runs.program.launch
        self.console.follow(lambda log, stdout: launch(*log, *words, stdout=stdout))
        result = runs.record_of(chosen.key, Path(self.directory))
        if result:  # otherwise there was nothing left to compute
            self.console.say(self.comparison(chosen, result), end="")
            self.report()
