# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the runs of a study say of cost: powers of the number of unknowns in
seconds and memory, for each linear solver by itself."""

from dataclasses import dataclass, field, replace
from typing import NamedTuple

from .fit import (
    Misfit,
    Prior,
    TwoPowers,
    fit_line,
    fit_two_powers,
    log_ratio,
    misfit_of,
)
from .solvers import DIRECT, SolverDemand, choose_solver, expected_cost, expected_memory


class CostSample(NamedTuple):
    """What one run has cost: seconds of all set-ups together and of the whole
    run, memory in MB."""

    demand: SolverDemand
    steps: float
    n_set_ups: float
    set_up_seconds: float
    seconds: float
    memory: float


class SolverModel(NamedTuple):
    """Seconds of a set-up and of a step as powers of the unknowns, of which some
    run had as many as largest."""

    set_up: TwoPowers
    step: TwoPowers
    largest: float


@dataclass
class CostModel:
    """seconds = n_set_ups s(dofs) + steps r(dofs), where s and r have the form
    c_1 dofs^a + c_2 and are those of the solver that a run would have. Where the
    runs do not tell the exponent of that solver, or none has had it, s and r are
    those of expected_cost() times the factor by which the largest run with it, or
    the largest of all, differs from them. Without runs all costs are zero."""

    solvers: dict = field(default_factory=dict)
    # That of the largest run.
    demand: SolverDemand = field(default_factory=SolverDemand)
    # In MB, what expected_memory() does not know of.
    other_memory: TwoPowers = field(default_factory=TwoPowers)
    misfit: Misfit = field(default_factory=Misfit)
    memory_misfit: Misfit = field(default_factory=Misfit)
    # seconds = c dofs^a steps.
    simple: TwoPowers = field(default_factory=TwoPowers)

    def demand_at(self, dofs, steps, n_set_ups=1.0):
        """What would decide on the solver of a run."""
        known = self.demand
        result = replace(
            known,
            dofs=round(dofs),
            solves=int(min(max(known.solves_per_step * steps / n_set_ups, 1.0), 1e8)),
        )
        # What is finer than a mesh that is not refined is refined from it.
        if known.first_dofs == 0 and dofs > 1.5 * known.dofs:
            result.first_dofs = known.dofs
        if known.dofs > 0:
            # A face has one dimension less than its body.
            exponent = (known.dimension - 1.0) / known.dimension
            result.face_dofs = round(known.face_dofs * (dofs / known.dofs) ** exponent)
        return result

    def seconds(self, dofs, steps, n_set_ups=1.0):
        if not self.solvers:
            return 0.0
        wanted = self.demand_at(dofs, steps, n_set_ups)
        solver = choose_solver(wanted)
        known = self.solvers.get(solver)
        if known and known.step.p_is_fitted:
            return n_set_ups * known.set_up(dofs) + steps * known.step(dofs)
        known_solver = solver
        if not known:
            known_solver = max(self.solvers, key=lambda name: self.solvers[name].largest)
            known = self.solvers[known_solver]
        n = known.largest
        there = expected_cost(known_solver, self.demand_at(n, steps, n_set_ups))
        here = expected_cost(solver, wanted)
        return (
            n_set_ups * known.set_up(n) * here[0] / there[0]
            + steps * known.step(n) * here[1] / there[1]
        )

    def memory(self, dofs, steps, n_set_ups=1.0):
        """In MB."""
        wanted = self.demand_at(dofs, steps, n_set_ups)
        return expected_memory(choose_solver(wanted), wanted) + self.other_memory(dofs)


def fit_cost(samples):
    """The model of these runs."""
    model = CostModel()
    if not samples:
        return model
    for s in samples:
        if s.demand.dofs >= model.demand.dofs:
            model.demand = s.demand
    of_set_up, of_step, memory, simple = {}, {}, [], []
    for s in samples:
        n = float(s.demand.dofs)
        solver = choose_solver(s.demand)
        of_set_up.setdefault(solver, []).append((n, 1.0, s.set_up_seconds / s.n_set_ups))
        of_step.setdefault(solver, []).append(
            (n, 1.0, (s.seconds - s.set_up_seconds) / s.steps)
        )
        memory.append((n, 1.0, s.memory - expected_memory(solver, s.demand)))
        simple.append((n, s.seconds / s.steps))

    # Some 10 % of noise in seconds against exponents known to a few tenths.
    # Solving is nearly linear; assembly is, factorizations n^(3/2) and n^2.
    is_2d = model.demand.dimension == 2
    linear = Prior(weight=0.3)
    solve = Prior(p=1.0 if is_2d else 4.0 / 3.0, weight=0.3)
    factorize = Prior(p=1.2 if is_2d else 1.7, weight=0.3)
    for solver, steps in of_step.items():
        is_direct = solver == DIRECT
        model.solvers[solver] = SolverModel(
            fit_two_powers(of_set_up[solver], factorize if is_direct else linear),
            fit_two_powers(steps, solve if is_direct else linear),
            max(n for n, _, _ in steps),
        )
    # Meshes, spaces and states.
    model.other_memory = fit_two_powers(memory, Prior(weight=10.0))
    model.simple = fit_line(simple, solve.p)

    seconds, megabytes = [], []
    for s in samples:
        n = float(s.demand.dofs)
        solver = choose_solver(s.demand)
        known = model.solvers[solver]
        seconds.append(
            log_ratio(s.n_set_ups * known.set_up(n) + s.steps * known.step(n), s.seconds)
        )
        megabytes.append(
            log_ratio(
                expected_memory(solver, s.demand) + model.other_memory(n), s.memory
            )
        )
    model.misfit, model.memory_misfit = misfit_of(seconds), misfit_of(megabytes)
    return model


