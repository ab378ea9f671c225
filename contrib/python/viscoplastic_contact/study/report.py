# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a study writes: study.csv, a row for each run and ladder; study.json, fits
and prices; study.md, the same for people (markdown.py)."""

import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Optional

from .analysis import (
    MEASURES,
    best_measure,
    cost_of,
    fit_chosen_steps,
    fit_measure,
    fit_tolerance_runs,
    fit_work_precision,
    of_variant,
    quantity_error,
)
from .markdown import markdown
from .price import WorkPrecisionModel, list_prices, price_in_words
from .record import ESTIMATE_PARTS, FIELD_ERRORS, PHASES, MethodVariant, json_text
from ..program import processor
from .runs import replace_file
from .solvers import SOLVERS, choose_solver
from .tolerance import ToleranceModel, price_of, tolerance_price_in_words

# Sizes and costs in study.csv.
NUMBERS = (
    *("h", "k", "cells", "dofs", "steps", "seconds_total"),
    *dict.fromkeys(PHASES.values()),
    *("seconds_rest", "peak_memory_MB", "contact_iterations", "linear_iterations"),
)
ERRORS = (
    *FIELD_ERRORS,
    *ESTIMATE_PARTS,
    *("effectivity", "effectivity_recovery", "estimate_quantity"),
)


@dataclass
class VariantResult:
    """What the finished runs of a method variant say: models and prices of given
    meshes and steps, or of tolerances. Without a known error there is neither a model
    nor a price."""

    variant: MethodVariant
    records: list
    measure: str
    model: Optional[WorkPrecisionModel] = None
    prices: list = field(default_factory=list)
    tolerance_model: Optional[ToleranceModel] = None
    tolerance_prices: list = field(default_factory=list)

    def prices_in_words(self, budget):
        return [
            *(price_in_words(self.model, price, budget) for price in self.prices),
            *(
                tolerance_price_in_words(self.tolerance_model, price, budget)
                for price in self.tolerance_prices
            ),
        ]


def analyze(study):
    """The results of all method variants."""
    errors = [float(item) for item in study.runs.scene.items("Study/Target errors")]
    reference, scene, results = study.reference(), study.runs.scene, []
    for variant in study.variants():
        records = of_variant(study.records(), variant)
        measure = best_measure(records, reference)
        result = VariantResult(variant, records, measure)
        if measure and variant.strategy == "tolerance":
            model = fit_tolerance_runs(scene, records, measure, reference)
            result.tolerance_model = model
            result.tolerance_prices = [price_of(model, e, study.budget) for e in errors]
        elif measure:
            timed = study.timed(variant)
            result.model = fit_work_precision(scene, records, timed, measure, reference)
            result.prices = list_prices(result.model, errors, study.budget)
        results.append(result)
    return results


def prices_in_words(study):
    """The price lists as sentences, one a line."""
    return "".join(
        f"Prices ({result.variant.name}), by the {MEASURES[result.measure]}:\n"
        + "".join(f"  {price}\n" for price in result.prices_in_words(study.budget))
        for result in analyze(study)
        if result.measure
    )


def origin(runs):
    """Where and when numbers are made, as study.json has it."""
    about = runs.scene.about
    return {
        "version": f"{about['version']} ({about['revision']})",
        "ranks": runs.program.ranks,
        "machine": processor(),
        "date": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
    }


def write_report(study, is_finished):
    """Each file is replaced at once."""
    results, about = analyze(study), origin(study.runs)
    directory = study.runs.directory
    replace_file(directory + "study.csv", csv(study))
    replace_file(
        directory + "study.json", json_text(contents(study, results, about, is_finished))
    )
    replace_file(directory + "study.md", markdown(study, results, about, is_finished))


def csv(study):
    names = list(study.records()[0].quantities)
    head = "run,strategy,scheme,history,solver,ladder,mesh_level,time_level"
    head = [head, "tolerance", "step_tolerance", *NUMBERS, *ERRORS]
    head += [column for name in names for column in (name, f"{name}_error")]
    lines = [",".join(head)]
    for ladder in ("space", "time", "both"):
        for run in study.plan:
            if run.record and ladder in run.ladders:
                record, key = run.record, run.record.key
                texts = [record.name, *key.variant, choose_solver(record.demand), ladder]
                numbers = [key.mesh_level, key.time_level]
                numbers += map(record.number, ("tolerance", "step_tolerance"))
                numbers += map(record.number, (*NUMBERS, *ERRORS))
                for name in names:
                    numbers.append(record.quantity(name))
                    numbers.append(quantity_error(record, name, study.reference()))
                lines.append(",".join([*texts, *(f"{value:.12g}" for value in numbers)]))
    return "\n".join(lines) + "\n"


# study.json


def contents(study, results, about, is_finished):
    reference, scene = study.reference(), study.runs.scene
    fits, tolerance_fits, costs, prices = [], [], [], []
    for result in results:
        variant = result.variant._asdict()
        if result.tolerance_model:
            tolerance_fits.append({**variant, **tolerance_fit(result)})
        elif result.variant.strategy != "tolerance":
            fits += ({**variant, **fit} for fit in fits_of(study, result))
            costs.append({**variant, **costs_of(study, result)})
        prices += ({**variant, **price} for price in prices_of(result))
    return {
        "scene": Path(scene.file).stem,
        **about,
        "finished": is_finished,
        "dimension": scene.dimension,
        "reference": "exact" if scene.has_exact_solution else "finest run",
        "reference_run": reference.name if reference else "",
        "budget": study.budget,
        "fits": fits,
        "tolerance_fits": tolerance_fits,
        "costs": costs,
        "prices": prices,
    }


def fits_of(study, result):
    names = [f"{name}_error" for name in study.records()[0].quantities]
    for measure in (*FIELD_ERRORS, "estimate_total", "estimate_quantity", *names):
        fit = fit_measure(result.records, measure, study.reference())
        if fit.misfit.n_samples >= 3:
            yield {
                "error": measure,
                "C_h": fit.c_1,
                "p": fit.p,
                "p_is_fitted": fit.p_is_fitted,
                "C_k": fit.c_2,
                "q": fit.q,
                "q_is_fitted": fit.q_is_fitted,
                "m": fit.m,
                "rms_of_log": fit.misfit.rms,
                "worst_factor": fit.misfit.worst_factor,
                "worst_run": result.records[fit.misfit.worst_sample].name,
            }


def costs_of(study, result):
    timed = study.timed(result.variant)
    cost = cost_of(timed)

    def power(fit):
        return {
            "c": fit.c_1,
            "a": fit.p,
            "constant": fit.c_2,
            "rms_of_log": fit.misfit.rms,
        }

    found = {
        "solvers": [
            {
                "solver": name,
                "largest_dofs": cost.solvers[name].largest,
                "seconds_per_set_up": power(cost.solvers[name].set_up),
                "seconds_per_step": power(cost.solvers[name].step),
            }
            for name in SOLVERS
            if name in cost.solvers
        ],
        "c_dofs_a_steps": power(cost.simple),
        "rms_of_log": cost.misfit.rms,
        "worst_factor": cost.misfit.worst_factor,
        "memory_rms_of_log": cost.memory_misfit.rms,
    }
    if study.runs.scene.has_step_control:
        steps = fit_chosen_steps(timed)
        found["steps"] = {
            "c": steps.c_1,
            "q": steps.p,
            "q_is_fitted": steps.p_is_fitted,
            "constant": steps.c_2,
            "rms_of_log": steps.misfit.rms,
        }
    return found


def tolerance_fit(result):
    """c_1 TOL^p for errors, c_1 TOL^-p + c_2 for costs."""
    model = result.tolerance_model
    found = {
        "error": result.measure,
        "C": model.error.c_1,
        "s": model.error.p,
        "s_is_fitted": model.error.p_is_fitted,
        "rms_of_log": model.error.misfit.rms,
    }
    for name in ("seconds", "cells", "dofs", "steps", "memory"):
        cost = getattr(model, name)
        found["memory_MB" if name == "memory" else name] = {
            "c": cost.c_1,
            "q": cost.p,
            "q_is_fitted": cost.p_is_fitted,
            "constant": cost.c_2,
            "exponent_against_error": model.exponent(cost),
            "rms_of_log": cost.misfit.rms,
        }
    return found


def prices_of(result):
    for price in result.tolerance_prices:
        yield {
            "error": result.measure,
            "tolerance": price.error,
            "in_budget": price.is_in_budget,
            "run_tolerance": price.run.tolerance,
            "cells": price.run.cells,
            "steps": price.run.steps,
            "dofs": price.run.dofs,
            "predicted_error": price.run.error,
            "seconds": price.run.seconds,
            "memory_MB": price.run.memory,
            "halving_factor": price.halving,
        }
    for price in result.prices:
        found = {
            "error": result.measure,
            "tolerance": price.error,
            "in_budget": price.is_in_budget,
        }
        if price.run:
            run = price.run
            found |= {
                "h": run.h,
                "mesh_level": run.mesh_level,
                "step_tolerance" if result.model.chosen_steps else "k": run.k,
                "steps": run.steps,
                "dofs": run.dofs,
                "predicted_error": run.error,
                "solver": run.solver,
                "seconds": run.seconds,
                "memory_MB": run.memory,
                "halving_factor": price.halving,
            }
        yield found
