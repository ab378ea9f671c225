# SPDX-License-Identifier: LGPL-2.1-or-later
"""What an error costs: the cheapest of all runs that could be made, with given meshes
and steps or to a tolerance, from a law of errors and one of costs. Pure functions of
numbers."""

import math
from dataclasses import dataclass, field
from math import inf, isfinite, log, nan
from types import SimpleNamespace
from typing import Callable, NamedTuple, Optional

from .cost import CostModel, choose_solver
from .fit import ROUNDING, Finer, Prior, TwoPowers, fit_two_powers
from .scene import MOST_STEPS, largest_step, n_steps, scale_phases
from .words import digits, seconds_in_words

FINEST_LEVEL = 12


@dataclass
class Price:
    """What an error costs: the run for it, which is absent if no mesh is fine enough,
    and by which factor the seconds grow for half of the error. It is far if the run is
    far beyond what was measured."""

    error: float
    run: object
    is_in_budget: bool
    is_far: bool = False
    halving: float = nan


def list_prices(model, errors, budget):
    return [model.price(error, budget) for error in errors]


def price_in_words(model, price, budget):
    """One price as a sentence."""
    text = f"Error {digits(price.error)}: "
    if price.is_in_budget:
        far = " (far beyond what was measured)" if price.is_far else ""
        return (
            f"{text}{model.describe(price.run)}; half of it costs "
            f"{digits(price.halving, 2)} times as much{far}."
        )
    text += "not within " + seconds_in_words(budget)
    if price.run and price.run.seconds < 3e8:
        text += ", it would take about " + seconds_in_words(price.run.seconds)
    best = model.most_accurate(budget)
    if best:
        text += f"; the smallest error there is about {digits(best.error)}: "
        text += model.describe(best)
    return text + "."


# With given meshes and steps


@dataclass
class WorkPrecisionModel:
    """What is known of the errors and costs of a scene, as functions of the mesh
    width h and the longest time step k. Where step control chooses the steps, k is
    its tolerance instead, which the time part of the error is a power of."""

    error: TwoPowers
    cost: CostModel
    dimension: int = 2
    # Of the scene as it is: mesh level 0 and its own steps.
    h: float = 1.0
    k: float = 1.0
    dofs: float = 1.0
    phases: list = field(default_factory=list)
    # With step control: how many steps there are, as a function of 1/k, and the
    # order of the scheme: steps half as long take k/2^order.
    chosen_steps: Optional[TwoPowers] = None
    order: int = 1
    # How many levels the mesh may be coarsened.
    coarsest_level: int = 0
    # The longest step that was measured, or the limit of stability.
    largest_k: float = inf
    # How often a run of so many steps is set up, once for each of its meshes,
    # where so many are those of its phases.
    n_set_ups: Callable = lambda n_steps, n_planned: 1.0
    # The smallest that have been measured, to tell extrapolations.
    smallest_h: float = 0.0
    smallest_k: float = 0.0

    def dofs_at(self, h):
        return self.dofs * (self.h / h) ** self.dimension

    def refinement_of_steps(self, k):
        """How many times as many steps as those of the scene k stands for."""
        return (self.k / k) ** (1.0 / self.order) if self.chosen_steps else self.k / k

    def steps_at(self, k):
        """About how many steps there are, before whole numbers for each phase."""
        if self.chosen_steps:
            return self.chosen_steps(1.0 / k)
        return n_steps(self.phases) * self.refinement_of_steps(k)

    def seconds(self, h, k):
        n_phases = len(self.phases)
        steps = max(n_phases, self.steps_at(k))
        planned = max(n_phases, n_steps(self.phases) * self.refinement_of_steps(k))
        n_set_ups = self.n_set_ups(steps, int(min(planned, MOST_STEPS)))
        return self.cost.seconds(self.dofs_at(h), steps, n_set_ups)

    def predict(self, mesh_level, k):
        """What the run on this mesh level with steps of at most k, or to that tolerance
        of them, is expected to give and to cost; it is far if h or k is below half of the
        smallest one that was measured."""
        h = self.h * 0.5**mesh_level
        k = min(k, self.largest_k)
        phases = scale_phases(self.phases, self.refinement_of_steps(k))
        n_planned = steps = n_steps(phases)
        if self.chosen_steps:
            wanted = min(self.steps_at(k), MOST_STEPS)
            steps = max(math.floor(wanted + 0.5), len(self.phases))
        else:
            k = largest_step(phases)
        dofs = self.dofs_at(h)
        size = dofs, steps, self.n_set_ups(steps, n_planned)
        return SimpleNamespace(
            mesh_level=mesh_level,
            phases=phases,
            h=h,
            k=k,
            steps=steps,
            dofs=dofs,
            error=self.error(h, k),
            seconds=self.cost.seconds(*size),
            memory=self.cost.memory(*size),
            solver=choose_solver(self.cost.demand_at(*size)),
            is_far=h < 0.49 * self.smallest_h or k < 0.49**self.order * self.smallest_k,
        )

    def step_for(self, part):
        """The longest step that leaves the time part of the error at this."""
        if self.error.c_2 <= 0.0:
            return self.largest_k
        return min((part / self.error.c_2) ** (1.0 / self.error.q), self.largest_k)

    def levels(self):
        """Of meshes that a run may have; none where the model has no samples."""
        is_known = self.error.misfit.n_samples > 0
        return range(-self.coarsest_level, FINEST_LEVEL + 1) if is_known else ()

    def cheapest(self, tolerance):
        """The cheapest run with an error of at most the tolerance. Mesh widths halve
        from level to level, steps are whole in every phase. None if no mesh level is
        fine enough."""
        found = []
        for level in self.levels():
            rest = self.error.rest(tolerance, self.error.first(self.h * 0.5**level))
            if rest > 0.0 and self.steps_at(k := self.step_for(rest)) <= MOST_STEPS:
                found.append(self.predict(level, k))
        return min(found, key=lambda run: run.seconds, default=None)

    def most_accurate(self, seconds):
        """The run of the smallest error within so many seconds, if any."""
        found = []
        for level in self.levels():
            # Steps cost the same each, up to rounding in phases.
            coarse, fine = self.largest_k, self.k * 1e-6
            if not isfinite(coarse):
                coarse = self.k * n_steps(self.phases)
            if self.predict(level, coarse).seconds > seconds:
                continue
            for _ in range(60):
                middle = math.sqrt(coarse * fine)
                if self.predict(level, middle).seconds <= seconds:
                    coarse = middle
                else:
                    fine = middle
            found.append(self.predict(level, coarse))
        return min(found, key=lambda run: run.error, default=None)

    def ideal_seconds(self, tolerance):
        """Seconds for an error of exactly the tolerance if h and k could have any
        value: a smooth curve below those of all runs."""
        error, lowest = self.error, inf
        # A scan over the part of the error that the mesh may have.
        for i in range(1, 400):
            part = i / 400.0 * tolerance
            h, rest = self.h * 2.0**self.coarsest_level, tolerance
            if error.c_1 > 0.0:
                h, rest = (part / error.c_1) ** (1.0 / error.p), error.rest(rest, part)
            lowest = min(lowest, self.seconds(h, self.step_for(rest)))
        return lowest

    def price(self, error, budget):
        run = self.cheapest(error)
        if not run:
            return Price(error, None, False)
        halving = self.ideal_seconds(error / 2.0) / self.ideal_seconds(error)
        return Price(error, run, run.seconds <= budget, run.is_far, halving)

    def describe(self, run):
        steps = f"{run.steps} steps"
        if self.chosen_steps:
            steps = f"step tolerance {digits(run.k)}, about {steps}"
        return (
            f"h = {digits(run.h)} (mesh level {run.mesh_level}), {steps}, "
            f"{digits(run.dofs)} unknowns, about {seconds_in_words(run.seconds)} and "
            f"{digits(run.memory, 2)} MB ({run.solver})"
        )

    def next_refinement(self):
        """What halving h, k, or both does to the scene as it is, in sentences."""
        now = self.predict(0, self.k)
        text = (
            f"The scene as it is: error about {digits(now.error)} "
            f"({digits(self.error.first(now.h), 2)} of the mesh, "
            f"{digits(self.error.second(now.k), 2)} of the steps), "
            f"{seconds_in_words(now.seconds)}."
        )
        # In the first order, or with given steps, half of k; else a quarter.
        finer_k, of_steps = self.k / 2.0**self.order, "Halving k"
        if self.chosen_steps:
            part = "Half" if self.order == 1 else "A quarter of"
            of_steps = f"{part} the step tolerance"
        gains = []
        for what, level, k in (
            ("Halving h", 1, self.k), (of_steps, 0, finer_k), ("Both", 1, finer_k)
        ):
            run = self.predict(level, k)
            ratio = run.seconds / now.seconds if now.seconds > 0.0 else nan
            text += f" {what}: error {digits(run.error)} for {digits(ratio, 2)} times "
            text += "the seconds."
            gains.append(log(now.error / run.error) / log(max(1.001, ratio)))
        of_h, of_k, _ = gains
        refine = "the mesh" if of_h > 1.2 * of_k else "both"
        if of_k > 1.2 * of_h:
            refine = "the steps"
        return f"{text} Refine {refine} next."


# To a tolerance

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
        return min(tolerance, error if self.is_kept else inf, largest)

    def most_accurate(self, seconds):
        """The run that takes so long; None if not even one without any cells is that
        short."""
        rest = seconds - self.seconds.second()
        if rest <= 0.0 or self.seconds.c_1 <= 0.0:
            return None
        return self.predict((rest / self.seconds.c_1) ** (-1.0 / self.seconds.p))

    def exponent(self, cost):
        """Of what is a power of 1/TOL, against 1/error."""
        return cost.p / self.error.p

    def price(self, error, budget):
        run, half = (self.predict(self.tolerance_for(e)) for e in (error, error / 2.0))
        halving = half.seconds / run.seconds if run.seconds > 0.0 else nan
        is_far = run.tolerance < 0.24 * self.smallest_tolerance
        return Price(error, run, run.seconds <= budget, is_far, halving)

    def describe(self, run):
        return (
            f"tolerance {digits(run.tolerance)}, on average {digits(run.cells)} cells "
            f"and {digits(run.dofs)} unknowns, {round(run.steps)} steps, about "
            f"{seconds_in_words(run.seconds)} and {digits(run.memory, 2)} MB"
        )

    def exponents_in_words(self):
        """What halving the error does to seconds, cells and steps, in a sentence."""
        seconds, cells, steps = (
            f"error^-{digits(self.exponent(cost), 2)}"
            for cost in (self.seconds, self.cells, self.steps)
        )
        return (
            f"Beyond what any run takes, seconds grow as {seconds}, the mean number of "
            f"cells as {cells}, steps as {steps}."
        )


def fit_tolerance(samples, dimension, order, reference=None, m=2.0):
    """The model of these runs with a scheme of that order. Where their errors are
    differences to a run of the tolerance reference, its own error is subtracted (of
    norms in squares, otherwise m = 1); the model is that of the errors themselves."""
    # Meshes come in generations of cells: errors and costs are off their powers by
    # some 10 %, as seconds are. The program itself hides the law of the memory.
    weights = {name: 0.3 for name in COSTS} | {"memory": 10.0}
    finer = Finer(reference, 1.0, m, 1.0) if reference is not None else None
    errors = [(s.tolerance, 1.0, s.error) for s in samples]
    error = fit_two_powers(errors, Prior(weight=0.3, is_one_term=True), ROUNDING, finer)
    d, of_steps = float(dimension), 1.0 / order
    costs = {}
    for name, exponent in zip(COSTS, (d + of_steps, d, d, of_steps, d)):
        known = [(1.0 / s.tolerance, 1.0, getattr(s, name)) for s in samples]
        costs[name] = fit_two_powers(known, Prior(p=exponent, weight=weights[name]))
    smallest = min((s.tolerance for s in samples), default=inf)
    return ToleranceModel(error, **costs, smallest_tolerance=smallest)
