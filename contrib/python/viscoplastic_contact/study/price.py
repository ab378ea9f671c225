# SPDX-License-Identifier: LGPL-2.1-or-later
"""What an error costs with given meshes and steps: the cheapest of all runs that
could be made, from a law of errors and one of costs. Pure functions of numbers."""

import math
from dataclasses import dataclass, field
from math import inf, isfinite, log, nan
from typing import Callable, Optional

from .cost import CostModel
from .fit import TwoPowers
from .phases import MOST_STEPS, largest_step, n_steps, scale_phases
from .solvers import choose_solver
from .words import digits, seconds_in_words

FINEST_LEVEL = 12


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


@dataclass
class PredictedRun:
    """A run that could be made, and what it is expected to give and to cost; it is
    far if h or k is below half of the smallest one that was measured."""

    mesh_level: int
    phases: list
    h: float
    k: float
    steps: int
    dofs: float
    error: float
    seconds: float
    memory: float
    solver: str
    is_far: bool


def predict(model, mesh_level, k):
    """The run on this mesh level with steps of at most k, or to that tolerance of
    them."""
    h = model.h * 0.5**mesh_level
    k = min(k, model.largest_k)
    phases = scale_phases(model.phases, model.refinement_of_steps(k))
    n_planned = steps = n_steps(phases)
    if model.chosen_steps:
        wanted = min(model.steps_at(k), MOST_STEPS)
        steps = max(math.floor(wanted + 0.5), len(model.phases))
    else:
        k = largest_step(phases)
    dofs = model.dofs_at(h)
    n_set_ups = model.n_set_ups(steps, n_planned)
    return PredictedRun(
        mesh_level=mesh_level,
        phases=phases,
        h=h,
        k=k,
        steps=steps,
        dofs=dofs,
        error=model.error(h, k),
        seconds=model.cost.seconds(dofs, steps, n_set_ups),
        memory=model.cost.memory(dofs, steps, n_set_ups),
        solver=choose_solver(model.cost.demand_at(dofs, steps, n_set_ups)),
        is_far=h < 0.49 * model.smallest_h or k < 0.49**model.order * model.smallest_k,
    )


def step_for(model, part):
    """The longest step that leaves the time part of the error at this."""
    if model.error.c_2 <= 0.0:
        return model.largest_k
    return min((part / model.error.c_2) ** (1.0 / model.error.q), model.largest_k)


def cheapest(model, tolerance):
    """The cheapest run with an error of at most the tolerance. Mesh widths halve
    from level to level, steps are whole in every phase. None if no mesh level up to
    12 is fine enough or the model has no samples."""
    best = None
    if model.error.misfit.n_samples == 0:
        return best
    for level in range(-model.coarsest_level, FINEST_LEVEL + 1):
        rest = model.error.rest(tolerance, model.error.first(model.h * 0.5**level))
        if rest <= 0.0:
            continue
        k = step_for(model, rest)
        if model.steps_at(k) > MOST_STEPS:
            continue
        candidate = predict(model, level, k)
        if best is None or candidate.seconds < best.seconds:
            best = candidate
    return best


def most_accurate(model, seconds):
    """The run of the smallest error within so many seconds, if any."""
    best = None
    if model.error.misfit.n_samples == 0:
        return best
    for level in range(-model.coarsest_level, FINEST_LEVEL + 1):
        # Steps cost the same each, up to rounding in phases.
        coarse, fine = model.largest_k, model.k * 1e-6
        if not isfinite(coarse):
            coarse = model.k * n_steps(model.phases)
        if predict(model, level, coarse).seconds > seconds:
            continue
        for _ in range(60):
            middle = math.sqrt(coarse * fine)
            if predict(model, level, middle).seconds <= seconds:
                coarse = middle
            else:
                fine = middle
        candidate = predict(model, level, coarse)
        if best is None or candidate.error < best.error:
            best = candidate
    return best


def ideal_seconds(model, tolerance):
    """Seconds for an error of exactly the tolerance if h and k could have any
    value: a smooth curve below those of all runs."""
    error, lowest = model.error, inf
    # A scan over the part of the error that the mesh may have.
    for i in range(1, 400):
        part = i / 400.0 * tolerance
        if error.c_1 > 0.0:
            h, rest = (part / error.c_1) ** (1.0 / error.p), error.rest(tolerance, part)
        else:
            h, rest = model.h * 2.0**model.coarsest_level, tolerance
        lowest = min(lowest, model.seconds(h, step_for(model, rest)))
    return lowest


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

    def in_words(self, describe, best, budget):
        """As a sentence: describe(run) in words; best is the most accurate run within the
        budget, if any."""
        text = f"Error {digits(self.error)}: "
        if self.is_in_budget:
            far = " (far beyond what was measured)" if self.is_far else ""
            return (
                f"{text}{describe(self.run)}; half of it costs {digits(self.halving, 2)} "
                f"times as much{far}."
            )
        text += "not within " + seconds_in_words(budget)
        if self.run and self.run.seconds < 3e8:
            text += ", it would take about " + seconds_in_words(self.run.seconds)
        if best:
            text += f"; the smallest error there is about {digits(best.error)}: "
            text += describe(best)
        return text + "."


def list_prices(model, errors, budget):
    prices = []
    for error in errors:
        run = cheapest(model, error)
        price = Price(error, run, run is not None and run.seconds <= budget)
        if run:
            price.is_far = run.is_far
            half = ideal_seconds(model, error / 2.0)
            price.halving = half / ideal_seconds(model, error)
        prices.append(price)
    return prices


def price_in_words(model, price, budget):
    """One price as a sentence."""

    def describe(run):
        steps = f"{run.steps} steps"
        if model.chosen_steps:
            steps = f"step tolerance {digits(run.k)}, about {steps}"
        return (
            f"h = {digits(run.h)} (mesh level {run.mesh_level}), {steps}, "
            f"{digits(run.dofs)} unknowns, about {seconds_in_words(run.seconds)} and "
            f"{digits(run.memory, 2)} MB ({run.solver})"
        )

    best = None if price.is_in_budget else most_accurate(model, budget)
    return price.in_words(describe, best, budget)


def next_refinement(model):
    """What halving h, k, or both does to the scene as it is, in sentences."""
    now = predict(model, 0, model.k)
    text = (
        f"The scene as it is: error about {digits(now.error)} "
        f"({digits(model.error.first(now.h), 2)} of the mesh, "
        f"{digits(model.error.second(now.k), 2)} of the steps), "
        f"{seconds_in_words(now.seconds)}."
    )
    # In the first order, or with given steps, half of k; else a quarter.
    finer_k = model.k / 2.0**model.order
    of_steps = "Halving k"
    if model.chosen_steps:
        part = "Half" if model.order == 1 else "A quarter of"
        of_steps = f"{part} the step tolerance"
    gains = []
    for what, level, k in (
        ("Halving h", 1, model.k),
        (of_steps, 0, finer_k),
        ("Both", 1, finer_k),
    ):
        run = predict(model, level, k)
        ratio = run.seconds / now.seconds if now.seconds > 0.0 else nan
        text += f" {what}: error {digits(run.error)} for {digits(ratio, 2)} times the "
        text += "seconds."
        gains.append(log(now.error / run.error) / log(max(1.001, ratio)))
    of_h, of_k, _ = gains
    refine = "both"
    if of_h > 1.2 * of_k:
        refine = "the mesh"
    elif of_k > 1.2 * of_h:
        refine = "the steps"
    return f"{text} Refine {refine} next."
