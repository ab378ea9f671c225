# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the runs of a study say together: errors, laws of errors and costs."""

from math import isfinite, log2, nan, sqrt
from operator import add

from .cost import CostSample, fit_cost
from .fit import Finer, Prior, fit_error, fit_error_parts, fit_two_powers
from .price import ToleranceSample, WorkPrecisionModel, fit_tolerance
from .record import FIELD_ERRORS, unit_of, vector_name
from .scene import largest_step

# What can say how large the error of a run is, the best first.
MEASURES = {
    "estimate_quantity": "estimated error of the quantity of interest",
    "error_energy": "error of u in the energy norm",
    "estimate_total": "estimated error of u in the energy norm",
    "quantities": "largest error of all quantities of interest",
}

# Of the estimate: of the mesh, the initial data, which it approximates, and the steps.
PARTS = ("space", "initial", "time")


def size_of(record, quantity):
    """The size of a quantity; for a component that of its vector. Zero for what
    only rounding keeps from being that."""
    known = {name: v for name, v in record.quantities.items() if isfinite(v)}
    vector = vector_name(quantity)
    square = sum(
        value * value
        for name, value in known.items()
        if name == quantity
        or (vector_name(name) == vector and vector not in (name, quantity))
    )
    unit, size = unit_of(quantity) or quantity, sqrt(square)
    alike = (abs(v) for name, v in known.items() if (unit_of(name) or name) == unit)
    return size if size > 1e-9 * max(alike, default=0.0) else 0.0


def quantity_error(record, quantity, reference):
    """The error of a quantity of interest, relative to its size (of vectors: to
    that of the vector) in the reference; not a number without one."""
    has_other = reference is not None and record.key != reference.key
    size = size_of(reference, quantity) if has_other else 0.0
    if not size > 0.0:
        return nan
    value = record.quantities.get(quantity, nan)
    return abs(value - reference.quantities.get(quantity, nan)) / size


def error_of(record, measure, reference):
    """The error of a run in a measure: a column of study.csv that holds errors or
    estimates, `QUANTITY_error', or `quantities', the largest error of all quantities
    of interest. Not a number where it is not known."""
    if measure in record.numbers:
        return record.number(measure)
    if measure != "quantities":
        return quantity_error(record, measure.rsplit("_error", 1)[0], reference)
    errors = (quantity_error(record, name, reference) for name in record.quantities)
    return max(filter(isfinite, errors), default=nan)


def best_measure(records, reference, n_least=3):
    """The best measure that at least so many of the runs have; empty if none."""
    for measure in MEASURES:
        errors = [error_of(record, measure, reference) for record in records]
        if sum(isfinite(error) and error > 0.0 for error in errors) >= n_least:
            return measure
    return ""


def of_variant(records, variant):
    """The records of one method variant."""
    return [record for record in records if record.key.variant == variant]


def are_differences(records):
    return any("is_difference" in record.numbers for record in records)


def fit_measure(records, measure, reference):
    """The fit of the errors in a measure; that of estimates is by their parts."""
    samples = [
        (record.number("h"), record.step_measure, error_of(record, measure, reference))
        for record in records
    ]
    if measure == "estimate_total":
        parts = ([r.number(f"estimate_{part}") for r in records] for part in PARTS)
        space, initial, time = parts
        return fit_error_parts(samples, list(map(add, space, initial)), time)
    is_norm, finer = measure in FIELD_ERRORS, None
    # A reference with meshes of its own is on no ladder of h and k.
    if (
        reference is not None
        and "tolerance" not in reference.numbers
        and (not is_norm or are_differences(records))
    ):
        of_reference = reference.number("h"), reference.step_measure
        finer = Finer(*of_reference, 2.0 if is_norm else 1.0, 1.0)
    return fit_error(samples, finer)


def fit_chosen_steps(records):
    """How many steps step control takes to the tolerance TOL, of the records of one
    method variant: c TOL^-q + c_0, with q = 1/p for a scheme of order p where they
    do not tell."""
    samples = [
        (1.0 / record.number("step_tolerance"), 1.0, record.number("steps"))
        for record in records
    ]
    # Some 10 % of chance.
    prior = Prior(p=1.0 / records[0].key.variant.order, weight=0.3)
    return fit_two_powers(samples, prior)


def expected_steps(scene, records, key):
    """How many steps a run has: those of its phases, or what its tolerance takes by
    the records."""
    if not scene.has_step_control:
        return scene.planned_steps(key)
    steps = fit_chosen_steps(records)(1.0 / scene.step_tolerance(key))
    return max(len(scene.phases), steps)


def cost_of(records):
    """The fit of seconds and memory."""
    names = "steps,set_ups,seconds_set_up,seconds_total,peak_memory_MB".split(",")
    return fit_cost([CostSample(r.demand, *map(r.number, names)) for r in records])


def cost_of_run(scene, records, key):
    """Seconds and memory (in MB) that a run is expected to take by these records."""
    finest = max(records, key=lambda record: record.key.mesh_level)
    levels = key.mesh_level - finest.key.mesh_level
    steps = expected_steps(scene, records, key)
    n_set_ups = scene.n_set_ups(key.variant.strategy, steps, scene.planned_steps(key))
    dofs = finest.number("dofs") * 2.0 ** (scene.dimension * levels)
    cost = cost_of(records)
    return cost.seconds(dofs, steps, n_set_ups), cost.memory(dofs, steps, n_set_ups)


def fit_work_precision(scene, records, timed, measure, reference):
    """All that follows from runs of one method variant, of which there must be one.
    Those that are timed tell what runs cost."""
    strategy = records[0].key.variant.strategy
    model = WorkPrecisionModel(
        fit_measure(records, measure, reference),
        cost_of(timed),
        scene.dimension,
        scene.h,
        largest_step(scene.phases),
        phases=scene.phases,
        n_set_ups=lambda steps, planned: scene.n_set_ups(strategy, steps, planned),
        # Nothing coarser than what was measured: there errors obey no law.
        coarsest_level=max(-record.key.mesh_level for record in records),
        smallest_k=min(record.step_measure for record in records),
    )
    if scene.has_step_control:
        model.k = scene.number("Step control/Tolerance")
        model.order = records[0].key.variant.order
        model.chosen_steps = fit_chosen_steps(timed)
    # From the finest mesh, whose boundary counts least.
    finest = min(records, key=lambda record: record.number("h"))
    model.smallest_h = finest.number("h")
    model.dofs = finest.number("dofs") * (model.smallest_h / model.h) ** model.dimension
    model.largest_k = max(record.step_measure for record in records)
    for record in records:
        limit = record.number("step_limit")
        # Stresses may lower it still; implicit schemes go beyond, and step control
        # looks after it.
        if not model.chosen_steps and isfinite(limit) and limit >= record.step_measure:
            model.largest_k = min(model.largest_k, 0.95 * limit)
    return model


def fit_tolerance_runs(scene, records, measure, reference):
    """The same of runs to a tolerance."""
    # Where the first mesh is better than a tolerance asks for, the error does not
    # depend on it. Otherwise a run keeps the estimate near three quarters of the
    # tolerance.
    controlled = (
        "estimate_quantity" if scene["Error control/Quantity"] else "estimate_total"
    )

    def has_first_mesh(record):
        return (
            record.number(controlled) < 0.6 * record.number("tolerance")
            or abs(record.number("cells") / scene.n_cells - 1.0) < 1e-3
        )

    have_others = not all(map(has_first_mesh, records))
    names = "seconds_total,cells,dofs,steps,peak_memory_MB".split(",")
    samples = [
        ToleranceSample(
            record.number("tolerance"),
            nan
            if have_others and has_first_mesh(record)
            else error_of(record, measure, reference),
            *map(record.number, names),
        )
        for record in records
    ]
    is_norm, is_estimate = measure in FIELD_ERRORS, measure == controlled
    finer = None
    if (not is_norm or are_differences(records)) and not is_estimate:
        # Absent of other runs.
        finer = reference.numbers.get("tolerance") if reference is not None else None
    # Schemes may differ from run to run, but not in one method variant.
    order, m = records[0].key.variant.order, 2.0 if is_norm else 1.0
    model = fit_tolerance(samples, scene.dimension, order, finer, m)
    model.is_kept = is_estimate
    return model


def extrapolate(runs):
    """Richardson extrapolation of every quantity of interest, of three runs on meshes and
    with steps that halve each time: its name, the three values, their order, the
    extrapolated value, the error of the last value relative to the size of the quantity,
    and whether that can serve as a reference, as differences shrink with an order between
    1/2 and 3."""
    for name in runs[2].quantities:
        values = [run.quantities.get(name, nan) for run in runs]
        first, last = values[1] - values[0], values[2] - values[1]
        size = size_of(runs[2], name)
        if not size > 0.0:
            continue
        if not abs(last) > 1e-12 * size:  # nothing left to converge
            yield name, values, nan, values[2], 0.0, True
            continue
        ratio = first / last
        order = log2(ratio) if ratio > 0.0 else nan
        is_good = 0.5 <= order <= 3.0
        extrapolated = values[2] + last / (ratio - 1.0) if is_good else nan
        error = abs(extrapolated - values[2] if is_good else last) / size
        yield name, values, order, extrapolated, error, is_good
