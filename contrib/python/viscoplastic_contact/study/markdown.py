# SPDX-License-Identifier: LGPL-2.1-or-later
"""study.md: the runs of a study, orders, fits, prices and the reference in tables and
sentences."""

from math import exp, isfinite, log, nan
from pathlib import Path

from .analysis import MEASURES, error_of, extrapolate
from .cost import DIRECT, SOLVERS, choose_solver
from .price import price_in_words
from .record import FIELD_ERRORS
from .words import digits, number_or_dash, seconds_in_words, table

# Columns of study.csv by shorter names.
SHORT = {"step_tolerance": "TOL", "dofs": "unknowns"}
SHORT |= {"seconds_total": "seconds", "peak_memory_MB": "MB"}


def markdown(study, results, about, is_finished):
    scene = study.scene
    text = (
        f"# Study of {scene.file}\n\n"
        f"{'' if is_finished else '**Not finished yet.** '}"
        f"viscoplastic_contact {about['version']}, {about['ranks']} MPI rank(s), "
        f"{about['machine']}, {about['date']}.\n\n"
        "The ladder `space` refines the mesh with the steps of the finest level of the "
        "study, `time` the steps on its finest mesh, `both` both, which share the "
        "finest run: what a ladder leaves alone is as good as the study has it, and its "
        "part of the error is named below. Errors are relative to the largest norm over "
        "all times. In adaptive runs, h is the width of a uniform mesh with as many "
        "cells. Runs to a tolerance choose meshes and steps themselves: their cells and "
        "unknowns are means over the steps.\n"
    )
    if scene.has_step_control:
        text += (
            "\nThe steps are chosen by their error, to the tolerance TOL, `Step "
            "control/Tolerance`: the ladder `time` divides it by 2 (by 4 with Heun's "
            "method), so that steps are half as long; its orders are against TOL, and k "
            "is the longest step of a run.\n"
        )
    for result in results:
        text += f"\n## {result.variant.name}\n\n{runs_table(study, result)}\n"
        if result.is_to_tolerance:
            text += tolerance_results(study, result) if result.model else ""
        else:
            text += "Observed orders between neighbors:\n\n"
            text += f"{orders_table(study, result)}\n"
        if not result.model:
            text += "No price list: the error is known of fewer than three runs.\n"
            continue
        if not result.is_to_tolerance:
            text += f"{fits_in_words(study, result)}\n"
        text += f"### Price list\n\n{prices_table(study, result)}"
        if not result.is_to_tolerance:
            text += f"{result.model.next_refinement()}\n"
    text += f"\n## Reference\n\n{reference_in_words(study)}\n## Left out\n\n"
    skipped = "".join(
        f"- `{study.runs.name(run.key)}`: {run.skipped}.\n"
        for run in study.plan
        if run.skipped
    )
    fewer, directory = study.levels_in_words(), study.directory
    if fewer:
        skipped = fewer + ("\n\n" + skipped if skipped else "\n")
    text += (skipped or "Nothing.\n") + f"\n## Pictures\n\n    contrib/plot {directory}\n"
    for picture in sorted(Path(directory).glob("*.png")):
        text += f"\n![{picture.stem}]({picture.name})\n"
    return text


def shown_measures(study):
    """Errors to show: those of the fields or estimates that are known, or else
    quantities."""
    records, reference = study.records(), study.reference()
    result = [
        measure
        for measure in (*FIELD_ERRORS, "estimate_total", "estimate_quantity")
        if any(isfinite(error_of(record, measure, reference)) for record in records)
    ]
    if not result or not study.scene.has_exact_solution:
        result.append("quantities")
    return result


def runs_table(study, result):
    columns = ["h", "k"]
    if result.is_to_tolerance:
        columns = ["tolerance"]
    elif study.scene.has_step_control:
        columns = ["h", "step_tolerance", "k"]
    columns += ["cells", "dofs", "steps", "seconds_total", "peak_memory_MB"]
    columns += shown_measures(study)
    for name in ("effectivity", "effectivity_recovery"):
        columns += [name] if isfinite(result.records[0].number(name)) else []
    reference = study.reference()

    def row(record):
        values = (error_of(record, column, reference) for column in columns)
        return [f"`{record.name}`", *map(number_or_dash, values)]

    head = ["run", *(SHORT.get(name, name) for name in columns)]
    return table(head, map(row, result.records))


def runs_of(study, variant, ladder):
    """The finished runs of a method variant in a ladder, the coarsest first."""
    return [
        run.record
        for run in study.plan
        if run.record and run.key.variant == variant and ladder in run.ladders
    ]


def order(one, two, refinement):
    """log(one/two)/log(refinement); not a number where that is none."""
    quotient = one / two if two else nan
    if not (quotient > 0.0 and isfinite(quotient)) or not refinement > 0.0:
        return nan
    return log(quotient) / log(refinement) if refinement != 1.0 else nan


def orders_table(study, result):
    """Orders between neighbors of each ladder."""
    measures, rows = shown_measures(study), []

    def errors_of(run):
        return [error_of(run, measure, study.reference()) for measure in measures]

    for ladder in ("space", "time", "both"):
        runs = runs_of(study, result.variant, ladder)
        for one, two in zip(runs, runs[1:]):
            halving = one.number("h") / two.number("h")
            if ladder == "time":
                halving = one.step_measure / two.step_measure
            pairs = zip(errors_of(one), errors_of(two))
            orders = [order(*pair, halving) for pair in pairs]
            if any(map(isfinite, orders)):
                names = [ladder, f"`{one.name}`", f"`{two.name}`"]
                rows.append([*names, *map(number_or_dash, orders)])
    return table(["ladder", "from", "to", *measures], rows)


def missed(misfit, words=" (root mean square)", name=""):
    """By which factors a fit misses the runs: their mean and the worst."""
    return f"{digits(exp(misfit.rms))}{words} and {digits(misfit.worst_factor)}{name}"


def error_in_words(result, k):
    """The law of the errors, where k stands for the time steps."""
    error, records = result.model.error, result.records
    of_h = f"{digits(error.c_1)} h^{digits(error.p)}"
    of_k = f"{digits(error.c_2)} {k}^{digits(error.q)}"
    text = f"Fit to the {MEASURES[result.measure]}, relative:\n\n    error = "
    if error.m == 1.0:
        text += f"{of_h} + {of_k}\n\n"
    else:
        text += (
            f"(({of_h})^2 + ({of_k})^2)^(1/2)\n\nThe parts add up in squares, as "
            "orthogonal ones do: this fits better than their sum. "
        )
    if not error.is_separable:
        text += (
            f"The runs refine h and {k} together, so that their parts cannot be told "
            "apart; half of the error is given to each. "
        )
    are_fitted = error.p_is_fitted, error.q_is_fitted
    for name, is_fitted in zip(("p, that of h,", f"q, that of {k},"), are_fitted):
        if not is_fitted:
            text += (
                f"The exponent {name} does not show in these runs and is the "
                "theoretical 1. "
            )
    if "is_difference" in records[0].numbers and result.measure in FIELD_ERRORS:
        text += (
            "This is the law of the errors themselves; what was measured are differences "
            "to the reference, whose own error the fit subtracts. "
        )
    worst, finest = records[error.misfit.worst_sample], records[-1]
    of_mesh = error.first(finest.number("h"))
    total = of_mesh + error.second(finest.step_measure)
    share = of_mesh / total if total else nan
    return text + (
        f"The fit misses {error.misfit.n_samples} runs by a factor of "
        f"{missed(error.misfit)} at worst (`{worst.name}`).\n"
        f"At the finest run `{finest.name}` the mesh has {100.0 * share:.0f} % of the "
        "sum of both parts, the steps have the rest.\n\n"
    )


def fits_in_words(study, result):
    cost, steps = result.model.cost, result.model.chosen_steps
    text = error_in_words(result, "TOL" if steps else "k")
    if steps:
        text += (
            f"The number of steps to their tolerance:\n\n    steps = {digits(steps.c_1)} "
            f"TOL^-{digits(steps.p)} + {digits(steps.c_2)}\n\nwhich misses by a factor "
            f"of {missed(steps.misfit, '')} at worst.\n\n"
        )

    def power(fit):
        formula = f"{digits(fit.c_1)} dofs^{digits(fit.p)}"
        return formula + (f" + {digits(fit.c_2)}" if fit.c_2 > 0.0 else "")

    meshes = "meshes" if result.variant.strategy == "adaptive" else "1"
    for name in SOLVERS:
        if name in cost.solvers:
            fit = cost.solvers[name]
            text += (
                f"With {'the direct solver' if name == DIRECT else name}, measured up to "
                f"{digits(fit.largest)} unknowns:\n\n    seconds = {meshes} "
                f"({power(fit.set_up)})\n            + steps ({power(fit.step)})\n\n"
            )
    timed = study.timed(result.variant)
    text += (
        f"The seconds miss {cost.misfit.n_samples} runs by a factor of "
        f"{missed(cost.misfit)} at worst "
        f"(`{timed[cost.misfit.worst_sample].name}`), the memory by "
        f"{digits(exp(cost.memory_misfit.rms))}. One power alone, seconds = "
        f"{digits(cost.simple.c_1)} dofs^{digits(cost.simple.p)} steps, misses by "
        f"{missed(cost.simple.misfit, '')} at worst.\n"
    )
    listed = ", ".join(
        f"`{record.name}` ({digits(record.number('dofs'))} unknowns, "
        f"{choose_solver(record.demand)}, "
        f"{seconds_in_words(record.number('seconds_total'))})"
        for record in timed
        if record.key.is_timing
    )
    return text + (f"Runs that only tell what they cost: {listed}.\n" if listed else "")


def prices_table(study, result):
    def row(price):
        run, far = price.run, " (far)" if price.is_far else ""
        if result.is_to_tolerance:
            size = [digits(run.tolerance) + far, *map(digits, (run.cells, run.dofs))]
            size.append(digits(run.steps))
        else:
            size = [f"{run.mesh_level}{far}", digits(run.h), run.steps]
            size += [digits(run.k), digits(run.dofs), run.solver]
        cost = digits(run.seconds, 2), digits(run.memory, 2)
        return [digits(price.error), *size, *cost, f"{digits(price.halving, 2)} times"]

    if result.is_to_tolerance:
        head = "error,tolerance,cells,unknowns,steps"
    else:
        k = "TOL" if result.model.chosen_steps else "k"
        head = f"error,mesh level,h,steps,{k},unknowns,solver"
    text = table(
        f"{head},seconds,MB,half the error costs",
        [row(price) for price in result.prices if price.is_in_budget],
    )
    beyond = "".join(
        f"- {price_in_words(result.model, price, study.budget)}\n"
        for price in result.prices
        if not price.is_in_budget
    )
    return f"{text}\n{beyond}" + ("\n" if beyond and not result.is_to_tolerance else "")


def tolerance_results(study, result):
    """On runs to a tolerance: exponents and fits."""
    records, reference, measure = result.records, study.reference(), result.measure
    rows, model = [], result.model
    for one, two in zip(records, records[1:]):
        old, new = (error_of(record, measure, reference) for record in (one, two))
        if new and isfinite(old / new) and old / new > 0.0:
            exponents = (
                order(two.number(column), one.number(column), old / new)
                for column in ("seconds_total", "cells", "steps")
            )
            names = (f"`{record.name}`" for record in (one, two))
            rows.append([*names, *map(number_or_dash, exponents)])
    text = "Observed exponents against 1/error between neighbors:\n\n"
    text += table("from,to,seconds,cells,steps", rows) + (
        f"\nFits to the {MEASURES[measure]}, relative, and to what the runs cost:\n\n"
        f"    error   = {digits(model.error.c_1)} tolerance^{digits(model.error.p)}\n"
    )
    for name in ("seconds", "cells", "steps"):
        fit = getattr(model, name)
        text += f"    {name:7} = {digits(fit.c_1)} tolerance^-{digits(fit.p)}"
        text += f" + {digits(fit.c_2)}\n" if fit.c_2 > 0.0 else "\n"
    text += f"\n{model.exponents_in_words()}"
    if not model.error.p_is_fitted:
        text += (
            " The exponent of the error does not show in these runs and is taken for 1."
        )
    if not model.seconds.p_is_fitted:
        text += " That of the seconds does not show either and is the theoretical one."
    of_error, of_seconds = (
        missed(misfit, "", f" (`{records[misfit.worst_sample].name}`)")
        for misfit in (model.error.misfit, model.seconds.misfit)
    )
    return text + (
        " The fits miss the runs by factors (root mean square and worst) of "
        f"{of_error} in the error and {of_seconds} in the seconds.\n\n"
    )


def reference_in_words(study):
    runs, reference, text = study.runs, study.reference(), ""
    is_exact, to_tolerance = runs.scene.has_exact_solution, runs.scene.has_tolerance
    if is_exact:
        text += "Errors of fields are those to the exact solution of the scene. "
    elif runs.reference:
        text += (
            f"Errors of fields are differences to those of the run "
            f"`{runs.name(runs.reference)}` at the ends of the phases of time; its own "
            "error, unknown, is part of them. "
        )
        if reference and to_tolerance:
            error = number_or_dash(reference.number("estimate_total"))
            text += f"The error bar of that run itself is {error}. "
    if reference:
        text += (
            "Quantities of interest are compared with those of the run "
            f"`{reference.name}`.\n"
        )
    for run in study.plan:
        if run.is_reference and not run.record:
            text += (
                f"\nThe reference run `{runs.name(run.key)}` is missing: {run.skipped}. "
                "The finest run there is has taken its place, and errors near it are too "
                "small.\n"
            )
    # Halved tolerances leave the order of neighbors to chance.
    if to_tolerance:
        return text
    # The finest three of those with equal levels.
    last = study.plan[-1].key.variant
    diagonal = runs_of(study, last._replace(strategy="uniform"), "both")[-3:]
    if len(diagonal) < 3:
        return text
    names = [f"`{record.name}`" for record in diagonal]
    text += (
        "\nRichardson check of the quantities at the end, in the runs "
        f"{names[0]}, {names[1]} and {names[2]}:\n\n"
    )
    rows = [
        [
            name,
            ", ".join(digits(value, 5) for value in values),
            *(number_or_dash(order), number_or_dash(extrapolated, 5)),
            *(number_or_dash(error, 2), "good" if is_good else "not to be trusted"),
        ]
        for name, values, order, extrapolated, error, is_good in extrapolate(diagonal)
    ]
    head = "quantity,values,order,extrapolated,error of the last,as a reference"
    return text + table(head, rows)
