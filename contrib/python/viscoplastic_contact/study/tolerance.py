# SPDX-License-Identifier: LGPL-2.1-or-later
"""What runs to a tolerance say together: their errors and costs as powers of the
tolerance, and prices. Pure functions of numbers."""

from dataclasses import dataclass
from math import inf, nan
from typing import NamedTuple

from .fit import ROUNDING, Finer, Prior, TwoPowers, fit_two_powers
from .price import Price
from .words import digits, seconds_in_words

COSTS = ("seconds", "cells", "dofs", "steps", "memory")


class ToleranceSample(NamedTuple):
    """What belongs to a tolerance, found or predicted; cells and unknowns are means
    over the steps, the memory is in MB."""

    tolerance: float
    error: float
    seconds: float
    cells: float
    dofs: float
    steps: float
    memory: float


@dataclass
class ToleranceModel:
    """error = c TOL^s, and of seconds, cells, unknowns, steps and memory each
    c TOL^-q + c_0. Where the samples do not tell an exponent it is that of a run
    whose mesh and steps are chosen at the least cost: d of cells, unknowns and
    memory, 1/p of steps, their sum of seconds, in d dimensions with a scheme of
    order p."""

    error: TwoPowers  # of TOL, others of 1/TOL
    seconds: TwoPowers
    cells: TwoPowers
    dofs: TwoPowers
    steps: TwoPowers
    memory: TwoPowers
    # The smallest that was measured.
    smallest_tolerance: float = inf
    # Whether the errors are the estimates that a run keeps below TOL.
    is_kept: bool = False

    def predict(self, tolerance):
        """The run to that tolerance."""
        costs = (getattr(self, name)(1.0 / tolerance) for name in COSTS)
        return ToleranceSample(tolerance, self.error(tolerance), *costs)

    def tolerance_for(self, error, largest=0.5):
        """The tolerance for that error, at most the largest."""
        tolerance = (error / self.error.c_1) ** (1.0 / self.error.p)
        # What a run promises is worth more than what it is expected to give.
        if self.is_kept:
            tolerance = min(tolerance, error)
        return min(tolerance, largest)

    def tolerance_within(self, seconds):
        """The tolerance of a run that takes so long; None if not even a run without
        any cells is that short."""
        rest = seconds - self.seconds.second()
        if rest <= 0.0 or self.seconds.c_1 <= 0.0:
            return None
        return (rest / self.seconds.c_1) ** (-1.0 / self.seconds.p)

    def exponent(self, cost):
        """Of what is a power of 1/TOL, against 1/error."""
        return cost.p / self.error.p


def fit_tolerance(samples, dimension, order, reference=None, m=2.0):
    """The model of these runs with a scheme of that order. Where their errors are
    differences to a run of the tolerance reference, its own error is subtracted (of
    norms in squares, otherwise m = 1); the model is that of the errors themselves."""
    # Meshes come in generations of cells: errors and costs are off their powers by
    # some 10 %, as seconds are.
    weight = 0.3
    finer = Finer(reference, 1.0, m, 1.0) if reference is not None else None
    error = fit_two_powers(
        [(sample.tolerance, 1.0, sample.error) for sample in samples],
        Prior(weight=weight, is_one_term=True),
        ROUNDING,
        finer,
    )

    def fit(name, exponent, weight=weight):
        return fit_two_powers(
            [(1.0 / sample.tolerance, 1.0, getattr(sample, name)) for sample in samples],
            Prior(p=float(exponent), weight=weight),
        )

    d, of_steps = dimension, 1.0 / order
    return ToleranceModel(
        error=error,
        seconds=fit("seconds", d + of_steps),
        cells=fit("cells", d),
        dofs=fit("dofs", d),
        steps=fit("steps", of_steps),
        # The program itself hides it.
        memory=fit("memory", d, 10.0),
        smallest_tolerance=min((s.tolerance for s in samples), default=inf),
    )


def price_of(model, error, budget):
    """What the error costs by a run to a tolerance."""
    run = model.predict(model.tolerance_for(error))
    half = model.predict(model.tolerance_for(error / 2.0))
    return Price(
        error,
        run,
        is_in_budget=run.seconds <= budget,
        is_far=run.tolerance < 0.24 * model.smallest_tolerance,
        halving=half.seconds / run.seconds if run.seconds > 0.0 else nan,
    )


def tolerance_price_in_words(model, price, budget):
    """The price as a sentence."""

    def describe(run):
        return (
            f"tolerance {digits(run.tolerance)}, on average {digits(run.cells)} cells "
            f"and {digits(run.dofs)} unknowns, {round(run.steps)} steps, about "
            f"{seconds_in_words(run.seconds)} and {digits(run.memory, 2)} MB"
        )

    tolerance = None if price.is_in_budget else model.tolerance_within(budget)
    best = model.predict(tolerance) if tolerance is not None else None
    return price.in_words(describe, best, budget)


def exponents_in_words(model):
    """What halving the error does to seconds, cells and steps, in a sentence."""
    seconds, cells, steps = (
        f"error^-{digits(model.exponent(cost), 2)}"
        for cost in (model.seconds, model.cells, model.steps)
    )
    return (
        f"Beyond what any run takes, seconds grow as {seconds}, the mean number of "
        f"cells as {cells}, steps as "
        f"{steps}."
    )
