# SPDX-License-Identifier: LGPL-2.1-or-later
"""What an error costs, from a few short runs before a long one; and that run. The
short runs are those of a study of the scene, so that finished ones are used
again."""

import re
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from ..scene import set_options
from ..tables import UserError
from .analysis import (
    MEASURES,
    best_measure,
    cost_of_run,
    error_of,
    fit_tolerance_runs,
    fit_work_precision,
)
from .price import list_prices, price_in_words
from .record import RunKey
from .runs import Failure, Interrupted, make_directory, replace_file
from .scene import LARGEST_TOLERANCE, n_steps
from .timing import is_affordable, make_timing_runs, seconds_for_timing, seconds_of
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

NO_ERROR = (
    "A price needs an error to go by, but the pilot runs know none: neither an error bar "
    "nor an exact solution has given one."
)


class PilotFailure(UserError):
    """A pilot run that fails."""

    def __init__(self, reason):
        super().__init__(f"The pilot runs for the price fail: {reason}")


def pilot_run(runs, key, console):
    """The record of a run, which is computed unless it is finished already."""
    record, name = runs.find(key), runs.name(key)
    if record:
        return record
    console.status(f"Pilot run {name}")
    try:
        return runs.make(key, f"the pilot run {name}")
    except Failure as failure:
        raise PilotFailure(failure) from None


def runs_in_words(records, measure):
    """Runs that have been made, a line each. Without a measure they have no error,
    and only tell what they cost."""
    text = ""
    for record in records:
        text += (
            f"  {record.name}: {round(record.number('cells'))} cells, "
            f"{record.number('steps'):g} steps, "
        )
        if measure:
            text += f"error {digits(error_of(record, measure, None))}, "
        text += seconds_in_words(record.number("seconds_total"))
        text += "\n" if measure else ", for its cost alone\n"
    return text


def say_prices(console, model, measure, records, eps, budget):
    """Of twice, once and half of the error; returns the one between."""
    console.say(
        f"Prices by the {MEASURES[measure]}, from pilots of "
        f"{seconds_in_words(seconds_of(records))}:"
    )
    prices = list_prices(model, [2.0 * eps, eps, 0.5 * eps], budget)
    for price in prices:
        console.say(f"  {price_in_words(model, price, budget)}")
    return prices[1]


def check_budget(model, price, budget):
    if not price.is_in_budget:
        raise UserError(
            f"{price_in_words(model, price, budget)} Raise 'Study/Budget' or take a "
            "larger error."
        )


# With given meshes and steps


def finest_time_level(scene, must_save):
    """That of the finest pilots: coarser than the scene where it has so many steps,
    or so small a tolerance of them, that pilots twice as coarse still tell
    something. Where each is as fine as the scene in space, it must save steps."""
    for level in range(-2 if must_save else -1, 1):
        coarsest = scene.key()._replace(time_level=level - 1)
        if scene.has_step_control:
            may_be = scene.step_tolerance(coarsest) <= LARGEST_TOLERANCE
        else:
            fewest = 2.0 ** (2 - level) * len(scene.phases)
            may_be = n_steps(scene.phases) >= fewest
        if may_be:
            return level
    return 1


def make_pilots(runs, finest, has_coarser, console):
    """Pilots on two mesh levels, the finer one of which is that of the finest, or on
    that alone; with steps as long as there, and twice as long."""
    variant, mesh_level, time_level, _ = finest
    return [
        pilot_run(runs, RunKey(variant, mesh_level + m, time_level + t), console)
        for m in ((-1, 0) if has_coarser else (0,))
        for t in (-1, 0)
    ]


def finer_pilot(runs, pilots, seconds, console):
    """Pilots on one mesh do not tell what the mesh does to the error: one more on a
    finer mesh, with the longest steps of these, if it takes no more than so many
    seconds. Without it, or where it fails, the law is a theoretical one."""
    key = pilots[0].key._replace(mesh_level=pilots[0].key.mesh_level + 1)
    cost = cost_of_run(runs.scene, pilots, key)
    if not runs.find(key) and not is_affordable(cost, seconds):
        return []
    try:
        return [pilot_run(runs, key, console)]
    except PilotFailure:
        return []


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
        level = [
            finest.key.mesh_level - ("h" in halved.split()),
            finest.key.time_level - ("k" in halved.split()),
        ]
        before = [r for r in pilots if [r.key.mesh_level, r.key.time_level] == level]
        if not before:
            continue
        old, new = value(before[0]), value(finest)
        if new > max(STAGNANT * old, share * eps):
            return (
                f"where {halved} {'are' if ' ' in halved else 'is'} halved, the {what} "
                f"goes from {digits(old)} to {digits(new)}"
            )
    return ""


def refine_pilots(runs, pilots, measure, eps, n_left, console):
    """Pilots on the next finer meshes, so many times at most, where those that there are
    stagnate. Raises UserError where they still do."""
    who = "The pilots stagnate"
    while why := stagnation(pilots, measure, eps):
        finest = max(pilots, key=lambda r: (r.key.mesh_level, r.key.time_level))
        key = finest.key._replace(mesh_level=finest.key.mesh_level + 1)
        cost = cost_of_run(runs.scene, pilots, key)
        affordable = seconds_for_timing(FINER_SHARE * seconds_of(pilots), 0.0)
        if n_left == 0 or not is_affordable(cost, affordable):
            raise UserError(
                f"The price cannot be predicted: {why}, which says nothing of finer "
                f"runs. An error of {digits(eps)} takes more than the "
                f"{seconds_in_words(finest.number('seconds_total'))} of the finest "
                f"pilot ({finest.name}); begin with a finer mesh or shorter steps, or "
                "let 'Error control/Tolerance' choose them."
            )
        n_left -= 1
        console.say(f"{who}: {why}; finer ones follow.")
        who = "So do these"
        pilots = make_pilots(runs, key, True, console)
    return pilots


def price_with_given_meshes(runs, eps, seconds, console):
    """The price of the error eps of the scene with given meshes and steps, by its own
    strategy for meshes, from pilot runs: on coarser meshes with longer steps, or,
    where the scene is small already, on finer ones; four of them, h and k (or the
    tolerance of the steps) each halved alone and both. A mesh that cannot be made
    coarser is the only one of two, beside a third run on the next finer mesh where
    there is time for it. Where the run is worth so many seconds, this one and timing
    runs take no longer than a share of them, see seconds_for_timing().

    Prints what it makes and finds."""
    scene, budget = runs.scene, runs.scene.budget
    is_small, n_coarser = scene.n_cells <= SMALL_MESH, scene.n_coarser_meshes()
    # The mesh of a file that is not refined has nothing coarser.
    has_two_meshes = is_small or n_coarser >= 1
    mesh_level = 1 if is_small else -1 if n_coarser >= 2 else 0
    time_level = finest_time_level(scene, not has_two_meshes)
    runs.lock_directory()
    while True:
        finest = RunKey(scene.key().variant, mesh_level, time_level)
        try:
            pilots = make_pilots(runs, finest, has_two_meshes, console)
            break
        except PilotFailure:
            # Long steps may be unstable or fail otherwise: then shorter ones follow.
            time_level += 1
            if time_level > 1:
                raise
    measure = best_measure(pilots, None, 2)
    if not measure:
        raise UserError(NO_ERROR)

    def fit(timed):
        return fit_work_precision(scene, pilots, timed, measure, None)

    def seconds_left(price):
        return seconds_for_timing(seconds_of(pilots), min(price, budget, seconds))

    if has_two_meshes:
        pilots = refine_pilots(runs, pilots, measure, eps, N_FINER, console)
    model = fit(pilots)
    if not has_two_meshes:
        wanted = model.cheapest(eps)
        if wanted:
            pilots += finer_pilot(runs, pilots, seconds_left(wanted.seconds), console)
            refine_pilots(runs, pilots, measure, eps, 0, console)
            model = fit(pilots)
    console.say("Pilot runs:\n" + runs_in_words(pilots, measure), end="")
    if not has_two_meshes and len(pilots) == 2:
        console.say(
            "A finer mesh would take too long for a pilot, and there is none coarser: "
            "the error of the mesh is taken to be of first order in h."
        )
    # A run on a mesh that is much finer than those of the pilots may have another
    # solver.
    timings, wanted = [], model.cheapest(eps)
    if wanted:
        left = seconds_left(wanted.seconds)
        of_runs = runs, pilots, wanted.mesh_level, left, timings, "the timing runs"
        make_timing_runs(*of_runs, console)
    console.say(runs_in_words(timings, ""), end="")
    model, known = fit(pilots + timings), pilots + timings
    return measure, model, say_prices(console, model, measure, known, eps, budget)


# To a tolerance


def price_to_tolerance(runs, eps, console):
    """The measure and the price of the error eps of a scene with a tolerance, from
    pilot runs to larger ones: the tolerance of the scene times powers of two, from
    the largest that makes sense down to the last that is well above the one for eps,
    and does not take half of the budget.

    Prints what it makes and finds."""
    scene, budget, pilots = runs.scene, runs.scene.budget, []
    variant = scene.key().variant._replace(strategy="tolerance")
    runs.lock_directory()
    level, measure = scene.coarsest_tolerance_level(), ""
    while True:
        key = RunKey(variant, level, level)
        if len(pilots) >= N_PILOTS:
            measure = best_measure(pilots, None, N_PILOTS)
            if not measure:
                raise UserError(NO_ERROR)
            model = fit_tolerance_runs(scene, pilots[-N_FITTED:], measure, None)
            following = scene.tolerance(key)
            if (
                following < PILOT_FACTOR * model.tolerance_for(eps)
                or model.predict(following).seconds > 0.5 * budget
            ):
                break
        pilots.append(pilot_run(runs, key, console))
        quantity = scene["Error control/Quantity"]
        if quantity and not isfinite(pilots[-1].number("estimate_quantity")):
            raise UserError(
                f"'Error control/Quantity' = {quantity} is zero in the pilot run "
                f"{pilots[-1].name}: it has no relative error to go by."
            )
        level += 1
    console.say(
        "Pilot runs to larger tolerances:\n" + runs_in_words(pilots, measure), end=""
    )
    price = say_prices(console, model, measure, pilots, eps, budget)
    console.say(model.exponents_in_words())
    check_budget(model, price, budget)
    return measure, price


# The run


@dataclass
class ChosenRun:
    """The run that has been chosen, with what is set for it, by a measure of the
    error, and what it is expected to give and to cost."""

    key: RunKey
    assignments: list
    measure: str
    expected: object


def choose_mesh_and_steps(runs, eps, console):
    scene, budget = runs.scene, runs.scene.budget
    measure, model, price = price_with_given_meshes(runs, eps, budget, console)
    console.say(model.next_refinement())
    check_budget(model, price, budget)
    run = price.run
    key = scene.key()._replace(mesh_level=run.mesh_level)
    return ChosenRun(key, scene.discretization(key, run.phases, run.k), measure, run)


def choose_tolerance(runs, eps, console):
    """Beside its price, that of runs with given meshes and steps is said."""
    measure, price = price_to_tolerance(runs, eps, console)
    run, key = price.run, runs.scene.key()
    console.say("\nFor comparison, runs with one uniform mesh and equal steps.")
    try:
        other = price_with_given_meshes(runs, eps, run.seconds, console)[2].run
        text = f"With one uniform mesh and equal steps, the error {digits(eps)} "
        if other:
            text += (
                f"would take about {seconds_in_words(other.seconds)}, "
                f"{digits(other.seconds / run.seconds, 2)} times as long"
                + (", far beyond what was measured." if other.is_far else ".")
            )
        else:
            text += "is out of reach."
        console.say(text + "\n")
    except Interrupted:
        raise
    except UserError as error:
        console.say(f"Not priced: {error}\n")
    return ChosenRun(
        key._replace(variant=key.variant._replace(strategy="tolerance")),
        [f"Error control/Tolerance={digits(run.tolerance, 4)}"],
        measure,
        run,
    )


def comparison(scene, chosen, result):
    """What was predicted and what has been found."""
    columns = {
        "error": error_of(result, chosen.measure, None),
        "seconds": result.number("seconds_total"),
        "memory": result.number("peak_memory_MB"),
    }
    for name, is_chosen in (
        ("cells", scene.has_tolerance),
        ("steps", scene.has_tolerance or scene.has_step_control),
    ):
        if is_chosen:
            columns[name] = result.number(name)
    text = "\nThe prediction:\n"
    for name, found in columns.items():
        expected = getattr(chosen.expected, name)
        words = [digits(v) if isfinite(v) else "unknown" for v in (expected, found)]
        text += f"  {name:7}  {words[0]} predicted, {words[1]} found"
        if found > 0.0 and isfinite(found):
            text += f" (factor {digits(expected / found, 2)})"
        text += {"seconds": ", without field output", "memory": " MB"}.get(name, "") + "\n"
    return text


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


def run_at_price(runs, eps, console, only_price=False, options=()):
    """A run with the mesh and the steps that reach the error eps at the lowest cost,
    as short runs predict it; says both before and afterwards what it costs and gives,
    which price.md has, too. With only_price it only says what it would cost. Options of
    the program go to the run. Returns the directory of the results, beside those that
    the scene itself may have. Raises Interrupted, and UserError."""
    scene, program = runs.scene, runs.program
    directory = scene.directory + "price/"

    def report():
        make_directory(directory)
        title = f"# Price of an error of {digits(eps)}: `{Path(scene.file).name}`"
        said = as_markdown("".join(console.said))
        text = f"{title}\n\n*{program.origin()}*\n\n{said}"
        replace_file(directory + "price.md", text)

    if (
        not scene["Exact solution/Displacement"]
        and scene["Error control/Error bar"] != "true"
    ):
        raise UserError(
            "A price needs an error to go by: set 'Error control/Error bar = true', or "
            "give an 'Exact solution'."
        )
    choose = choose_tolerance if scene.has_tolerance else choose_mesh_and_steps
    chosen = choose(runs, eps, console)
    report()
    if only_price:
        return directory

    # The run that was chosen, with all output of the scene.
    chosen_entries = "".join(f"  --set '{entry}'\n" for entry in chosen.assignments)
    console.say(f"Now the run with\n{chosen_entries}")
    entries = [
        *(*runs.overrides, *chosen.assignments, f"Output/Directory={directory}"),
        f"Checkpoint/Directory={directory}checkpoint",
    ]
    words = [*options, *runs.files, *set_options(entries)]
    console.follow(lambda log, stdout: program.launch(*log, *words, stdout=stdout))
    result = runs.record_of(chosen.key, Path(directory))
    if result:  # otherwise there was nothing left to compute
        console.say(comparison(scene, chosen, result), end="")
        report()
    return directory
