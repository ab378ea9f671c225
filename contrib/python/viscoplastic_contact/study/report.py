# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a study writes: study.csv, a row for each run and ladder; study.json, fits
and prices; study.md, the same for people (markdown.py)."""

import time
from dataclasses import dataclass, field
from math import nan
from pathlib import Path
from typing import Optional, Union

from . import analysis
from .analysis import MEASURES, of_variant, quantity_error
from .cost import SOLVERS, choose_solver
from .markdown import markdown
from .price import COSTS, ToleranceModel, WorkPrecisionModel
from .price import list_prices, price_in_words
from .record import ESTIMATE_PARTS, FIELD_ERRORS, PHASES
from .record import MethodVariant, json_text, picked
from .runs import replace_file

# Sizes, costs and errors in study.csv.
NUMBERS = (
    *("tolerance", "step_tolerance", "h", "k", "cells", "dofs", "steps"),
    *("seconds_total", *dict.fromkeys(PHASES.values()), "seconds_rest"),
    *("peak_memory_MB", "contact_iterations", "linear_iterations"),
    *(*FIELD_ERRORS, *ESTIMATE_PARTS),
    *("effectivity", "effectivity_recovery", "estimate_quantity"),
)


@dataclass
class VariantResult:
    """What the finished runs of a method variant say: a model and prices of given
    meshes and steps, or of tolerances. Without a known error there is neither."""

    variant: MethodVariant
    records: list
    measure: str
    model: Optional[Union[WorkPrecisionModel, ToleranceModel]] = None
    prices: list = field(default_factory=list)

    @property
    def is_to_tolerance(self):
        return self.variant.strategy == "tolerance"


def analyze(study):
    """The results of all method variants."""
    errors = [float(item) for item in study.scene.items("Study/Target errors")]
    reference, scene, results = study.reference(), study.scene, []
    for variant in study.variants():
        records = of_variant(study.records(), variant)
        measure = analysis.best_measure(records, reference)
        result = VariantResult(variant, records, measure)
        results.append(result)
        if not measure:
            continue
        found = measure, reference
        if result.is_to_tolerance:
            result.model = analysis.fit_tolerance_runs(scene, records, *found)
        else:
            timed = study.timed(variant)
            result.model = analysis.fit_work_precision(scene, records, timed, *found)
        result.prices = list_prices(result.model, errors, study.budget)
    return results


def prices_in_words(results, budget):
    """The price lists as sentences, one a line."""
    return "".join(
        f"Prices ({r.variant.name}), by the {MEASURES[r.measure]}:\n"
        + "".join(f"  {price_in_words(r.model, p, budget)}\n" for p in r.prices)
        for r in results
        if r.measure
    )


def origin(runs):
    """Where and when numbers are made, as study.json has it."""
    about = runs.scene.about
    return {
        "version": f"{about['version']} ({about['revision']})",
        "ranks": runs.program.ranks,
        "machine": runs.program.processor(),
        "date": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime()),
    }


def write_report(study, is_finished):
    """Each file is replaced at once. Returns the results."""
    results, about = analyze(study), origin(study.runs)
    json = json_text(contents(study, results, about, is_finished))
    replace_file(study.directory + "study.csv", csv(study))
    replace_file(study.directory + "study.json", json)
    replace_file(
        study.directory + "study.md", markdown(study, results, about, is_finished)
    )
    return results


def csv(study):
    names = list(study.records()[0].quantities)
    lines = ["run,strategy,scheme,history,solver,ladder,mesh_level,time_level"]
    lines[0] += "".join(f",{column}" for column in NUMBERS)
    lines[0] += "".join(f",{name},{name}_error" for name in names)
    for ladder in ("space", "time", "both"):
        for run in study.plan:
            if not run.record or ladder not in run.ladders:
                continue
            record, key = run.record, run.record.key
            texts = [record.name, *key.variant, choose_solver(record.demand), ladder]
            numbers = [key.mesh_level, key.time_level, *map(record.number, NUMBERS)]
            for name in names:
                numbers.append(record.quantities.get(name, nan))
                numbers.append(quantity_error(record, name, study.reference()))
            lines.append(",".join([*texts, *(f"{value:.12g}" for value in numbers)]))
    return "\n".join(lines) + "\n"


# study.json


def contents(study, results, about, is_finished):
    reference, scene = study.reference(), study.scene
    fits, tolerance_fits, costs, prices = [], [], [], []
    for result in results:
        variant = result.variant._asdict()
        if not result.is_to_tolerance:
            fits += ({**variant, **fit} for fit in fits_of(study, result))
            costs.append({**variant, **costs_of(study, result)})
        elif result.model:
            tolerance_fits.append({**variant, **tolerance_fit(result)})
        prices += ({**variant, **price_of(result, price)} for price in result.prices)
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
        fit = analysis.fit_measure(result.records, measure, study.reference())
        if fit.misfit.n_samples >= 3:
            yield {
                "error": measure,
                **picked(fit, "C_h=c_1 p p_is_fitted C_k=c_2 q q_is_fitted m"),
                **picked(fit.misfit, "rms_of_log=rms worst_factor"),
                "worst_run": result.records[fit.misfit.worst_sample].name,
            }


def costs_of(study, result):
    timed = study.timed(result.variant)
    cost = analysis.cost_of(timed)

    def power(fit, names="c=c_1 a=p constant=c_2"):
        return {**picked(fit, names), "rms_of_log": fit.misfit.rms}

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
        **picked(cost.misfit, "rms_of_log=rms worst_factor"),
        "memory_rms_of_log": cost.memory_misfit.rms,
    }
    if study.scene.has_step_control:
        names = "c=c_1 q=p q_is_fitted=p_is_fitted constant=c_2"
        found["steps"] = power(analysis.fit_chosen_steps(timed), names)
    return found


def tolerance_fit(result):
    """c_1 TOL^p for errors, c_1 TOL^-p + c_2 for costs."""
    model = result.model
    found = {
        "error": result.measure,
        **picked(model.error, "C=c_1 s=p s_is_fitted=p_is_fitted"),
        "rms_of_log": model.error.misfit.rms,
    }
    for name in COSTS:
        cost = getattr(model, name)
        found["memory_MB" if name == "memory" else name] = {
            **picked(cost, "c=c_1 q=p q_is_fitted=p_is_fitted constant=c_2"),
            "exponent_against_error": model.exponent(cost),
            "rms_of_log": cost.misfit.rms,
        }
    return found


def price_of(result, price):
    found = {"error": result.measure}
    found |= picked(price, "tolerance=error in_budget=is_in_budget")
    if not price.run:
        return found
    if result.is_to_tolerance:
        names = "run_tolerance=tolerance cells steps dofs predicted_error=error "
    else:
        k = "step_tolerance=k" if result.model.chosen_steps else "k"
        names = f"h mesh_level {k} steps dofs predicted_error=error solver "
    found |= picked(price.run, names + "seconds memory_MB=memory")
    return {**found, "halving_factor": price.halving}
