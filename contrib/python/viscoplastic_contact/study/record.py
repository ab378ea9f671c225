# SPDX-License-Identifier: LGPL-2.1-or-later
"""Finished runs in numbers: result.json in the directory of each."""

import json
import math
import re
from dataclasses import asdict, dataclass, field, replace
from math import inf, nan
from typing import NamedTuple

import numpy as np

from ..results import read_statistics
from ..tables import UserError
from .cost import SolverDemand

STRATEGIES = ("uniform", "adaptive", "tolerance")

# Columns of errors of fields, relative to the largest norms.
FIELD_ERRORS = ("error_energy", "error_h1", "error_stress", "error_multiplier")

# Columns of the estimated error and its parts.
PARTS = "space", "time", "algebraic", "initial", "total"
ESTIMATE_PARTS = tuple(f"estimate_{part}" for part in PARTS)

TIMED = (
    *("rate", "tangent", "load", "contact", "balance", "estimate", "output", "errors"),
    "checkpoint",
)
# The phases of a run, as the program times them (results/run_summary.h), and the
# column of study.csv for each; several phases may share one.
PHASES = {
    **dict.fromkeys(("pilot run", "set-up", "adaptation"), "seconds_set_up"),
    **{phase: f"seconds_{phase}" for phase in TIMED},
}
# Neither fields nor the comparison with a solution are what a user would pay for.
NO_COST = ("output", "errors")


class MethodVariant(NamedTuple):
    """How a run is computed, whatever its mesh width and its time steps. The
    strategy says how its mesh comes about: it is refined everywhere (uniform), or
    where the error estimator says, with given numbers of cells and steps (adaptive)
    or with as many as a tolerance needs. Scheme and history are values of
    `Time/Scheme' and `Material/Stress history'."""

    strategy: str
    scheme: str
    history: str

    @property
    def order(self):
        """That of the scheme in k."""
        return 2 if self.scheme == "Heun" else 1

    @property
    def name(self):
        return ", ".join(self)


class RunKey(NamedTuple):
    """Which run of a study. Levels are halvings of h and k from those of the scene,
    or both those of its tolerance; negative ones are doublings. Where step control
    chooses the steps, its tolerance halves k. A timing run only tells what it
    costs, and is compared with nothing."""

    variant: MethodVariant
    mesh_level: int = 0
    time_level: int = 0
    is_timing: bool = False


@dataclass
class RunRecord:
    """A finished run in numbers."""

    key: RunKey
    name: str = ""
    # Of the scene and the program: with another one it belongs to something else.
    stamp: dict = field(default_factory=dict)
    # Sizes, costs and errors, by the name of their column in study.csv.
    numbers: dict = field(default_factory=dict)
    # What decides on the linear solver, with the mean number of unknowns.
    demand: SolverDemand = field(default_factory=SolverDemand)
    # Quantities of interest at the end, in the order of the table.
    quantities: dict = field(default_factory=dict)

    def number(self, column):
        """Not a number if there is none."""
        return self.numbers.get(column, nan)

    @property
    def step_measure(self):
        """What the time part of the error is a power of: the longest step, or,
        where step control chooses them, the tolerance of the steps."""
        return self.number("step_tolerance" if "step_tolerance" in self.numbers else "k")


def vector_name(name):
    """"friction_force" of "friction_force_x"; others are scalars."""
    return name[:-2] if len(name) > 2 and name[-2:] in ("_x", "_y", "_z") else name


# What has one unit, by the beginning of its name.
UNITS = {
    "force": ("friction_force", "contact_force", "reaction_"),
    "displacement": ("point", "max_displacement"),
    "stress": ("max_von_mises", "mean_von_mises"),
    "energy": (
        *("friction_dissipation", "viscous_dissipation", "stored_energy"),
        *("external_work", "thermal_work"),
    ),
}


def unit_of(column):
    """The unit of a force, a displacement, a stress or an energy; else empty."""
    return next((unit for unit, names in UNITS.items() if column.startswith(names)), "")


# Quantities of interest, with or without _x, _y, _z.
QUANTITY = re.compile(
    r"(friction_force|contact_force)(_\d+)?|reaction_\d+|point\d+|contact_area|slip_area|"
    r"friction_dissipation|viscous_dissipation|max_displacement|stored_energy"
)


def read_table(path):
    """The columns of statistics.csv, of which there must be some."""
    table = read_statistics(path)
    if not table:
        raise UserError(f"There is no table in '{path}'.")
    return table


def largest(table, name):
    """The largest size in a column; not a number without it."""
    if name not in table:
        return nan
    return float(np.fmax.reduce(np.abs(table[name]), initial=0.0))


def relative(value, size):
    return value / size if size > 0.0 else nan


def make_record(key, table, costs, is_difference=False, quantity=""):
    """The numbers of a finished run, from its table and the costs in its run.json.
    Errors are the largest of all steps over the largest norm of the exact solution; if
    is_difference, they are differences to another run, at few times: then the largest
    norms of the run itself count, too. Estimates are relative to the largest energy norm,
    that of a quantity of interest, if there is one, to its largest value. Numbers of
    unknowns and cells are means over the steps."""
    number = {"steps": len(table["step"]) - 1.0}  # without the initial state
    number["k"] = largest(table, "k")
    for name in ("cells", "dofs"):
        number[name] = float((table[name][1:] if number["steps"] else table[name]).mean())
    # A table knows all of a run that was resumed, the timer the last part.
    total = rest = float(table["wall_total"][-1])
    for phase, column in PHASES.items():
        wall = f"wall_{phase}"
        timed = costs.get("seconds", {}).get(phase, 0.0)
        seconds = float(table[wall].sum()) if wall in table else timed
        number[column] = number.get(column, 0.0) + seconds
        rest -= seconds
        total -= seconds if phase in NO_COST else 0.0
    number["seconds_total"], number["seconds_rest"] = total, rest
    number["peak_memory_MB"] = costs.get("peak_memory_MB", nan)
    number["first_memory_MB"] = costs.get("memory_before_MB", nan)
    for name in ("contact_iterations", "linear_iterations"):
        number[name] = float(np.sum(table.get(name, 0.0)))
    limits = [value for value in table.get("step_limit", ()) if value > 0.0]
    number["step_limit"] = float(min(limits, default=inf))

    # Errors are known at some steps only, where the norms of the solution may have
    # gone; those of the run itself are known always.
    own_norms = {"error_energy": "energy_norm", "error_stress": "stress_norm"}
    for name in FIELD_ERRORS:
        size = largest(table, "exact" + name[len("error") :])
        if is_difference and name in own_norms:
            own = largest(table, own_norms[name])
            size = own if own > size else size
        number[name] = relative(largest(table, name), size)
    if is_difference:
        number["is_difference"] = 1.0
    norm, error = largest(table, "energy_norm"), largest(table, "error_energy")
    for name in ESTIMATE_PARTS:
        number[name] = relative(largest(table, name), norm)
    number["effectivity"] = relative(largest(table, "estimate_total"), error)
    number["effectivity_recovery"] = relative(largest(table, "estimate_recovery"), error)
    if quantity:
        number["estimate_quantity"] = relative(
            largest(table, "quantity_total"), largest(table, quantity)
        )
    demand = SolverDemand(**costs.get("solver_demand", {}))
    return RunRecord(
        key,
        numbers=number,
        demand=replace(demand, dofs=math.floor(number["dofs"] + 0.5)),
        quantities={
            name: float(values[-1])
            for name, values in table.items()
            if QUANTITY.fullmatch(vector_name(name))
        },
    )


def json_text(contents):
    """With null for numbers that JSON does not have."""
    known = json.loads(json.dumps(contents), parse_constant=lambda name: None)
    return json.dumps(known, indent=2, ensure_ascii=False) + "\n"


def picked(source, names):
    """Attributes as a dictionary, by names `name' or `name=attribute'."""
    pairs = (name.split("=") for name in names.split())
    return {pair[0]: getattr(source, pair[-1]) for pair in pairs}


def to_json(record):
    """The text of result.json."""
    key = record.key
    return json_text(
        {
            "run": record.name,
            **key.variant._asdict(),
            "mesh_level": key.mesh_level,
            "time_level": key.time_level,
            "timing": key.is_timing,
            "stamp": record.stamp,
            "solver_demand": asdict(record.demand),
            "numbers": record.numbers,
            "quantities": record.quantities,
        }
    )


def from_json(text, path):
    """The record in the text of a file, which has to be that of to_json()."""

    def numbers(values):
        given = {name: nan if v is None else v for name, v in values.items()}
        return {n: v if type(v) is int else float(v) for n, v in given.items()}

    try:
        found = json.loads(text)
        variant = MethodVariant(*(found[name] for name in MethodVariant._fields))
        levels = int(found["mesh_level"]), int(found["time_level"])
        record = RunRecord(
            RunKey(variant, *levels, bool(found["timing"])),
            found["run"],
            {name: str(value) for name, value in found["stamp"].items()},
            numbers(found["numbers"]),
            SolverDemand(**found["solver_demand"]),
            numbers(found["quantities"]),
        )
        if variant.strategy not in STRATEGIES or to_json(record) != text:
            raise ValueError("it has been changed")
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise UserError(f"'{path}' is no record of a finished run: {error}") from error
    return record
