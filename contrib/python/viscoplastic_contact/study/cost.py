# SPDX-License-Identifier: LGPL-2.1-or-later
"""What runs cost: the cost model of the program (source/linear_solvers/solver_choice.cc),
which prices need for meshes that nobody has, and powers of the number of unknowns that
are fitted to the runs of a study. Each run.json says which solver the program itself
has chosen and what it expected; tests/regression/test_study.py compares."""

import math
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from .fit import Misfit, Prior, TwoPowers
from .fit import fit_line, fit_two_powers, log_ratio, misfit_of

DIRECT = "direct"
GEOMETRIC = "geometric multigrid"
ALGEBRAIC = "algebraic multigrid"
SOLVERS = (DIRECT, GEOMETRIC, ALGEBRAIC)


@dataclass
class SolverDemand:
    """What decides on the solver of a system."""

    choice: str = "automatic"
    dimension: int = 2
    ranks: int = 1
    # The largest Poisson's ratio of the material that the matrix stands for.
    poissons_ratio: float = 0.0
    # How often the solver will be used at least, and how often in a step.
    solves: int = 1
    solves_per_step: int = 1
    # Degrees of freedom in all, of these on the contact face, and those of the
    # mesh that the present one is refined from (0 where it is not refined).
    dofs: int = 0
    face_dofs: int = 0
    first_dofs: int = 0
    # Whether there is friction on the face.
    friction: bool = False


# As benchmarks/results.md has them, at so many degrees of freedom: (seconds,
# exponent) of a new mesh without a factorization, of what that adds, of a step
# with each solver, and how many times more algebraic multigrid takes.
COSTS = {
    2: (5e5, (7.0, 1.0), (9.4, 1.1), (0.41, 1.07), (1.08, 1.07), 5.0),
    3: (1.1e5, (2.3, 1.0), (14.5, 1.3), (0.74, 1.24), (0.37, 1.0), 15.0),
}


def has_small_first_mesh(demand):
    """Whether the mesh is refined from a small one, on which a direct solver costs
    little against a multigrid cycle on the present one."""
    share = demand.dofs // 20
    largest = max(600, min(share, 6000))
    if demand.dimension == 2:
        largest = max(2000, min(share, 20000))
    return 0 < demand.first_dofs <= largest


def has_levels(demand):
    """Whether geometric multigrid has meshes to work on."""
    return has_small_first_mesh(demand) or 0 < demand.first_dofs <= demand.dofs // 3


def prefer_direct(demand):
    """Whether the direct solver is expected to win."""
    is_2d = demand.dimension == 2
    # The dense face problem: 200 MB and a cubic set-up. Beyond, the memory of the
    # factor.
    if demand.face_dofs > 5000 or demand.dofs >= (2000000 if is_2d else 200000):
        return False
    # An exact solution, where it costs next to nothing.
    is_large_face = demand.friction and demand.face_dofs > 1500
    if not is_large_face and demand.dofs < (
        2000 if demand.solves < 4 and has_levels(demand) else 20000
    ):
        return True
    if has_levels(demand):
        costs = (expected_cost(solver, demand) for solver in (DIRECT, GEOMETRIC))
        direct, multigrid = (set_up + demand.solves * step for set_up, step in costs)
        return direct < multigrid
    # Algebraic multigrid takes several times the iterations.
    return (
        is_2d
        or demand.poissons_ratio > 0.45
        or (demand.dofs < 150000 and demand.solves >= 20)
    )


def choose_solver(demand):
    if demand.choice == "direct" or (
        demand.choice == "automatic" and demand.ranks == 1 and prefer_direct(demand)
    ):
        return DIRECT
    if demand.choice != "algebraic multigrid" and has_levels(demand):
        return GEOMETRIC
    return ALGEBRAIC


def expected_cost(solver, demand):
    """Seconds of one set-up, with all that a new mesh brings, and of one step.
    Only ratios mean anything on other machines and in other scenes."""
    n_dofs, mesh, factorization, direct, multigrid, algebraic = COSTS[demand.dimension]

    def seconds(power):
        return power[0] * (demand.dofs / n_dofs) ** power[1]

    # What small systems take, whatever their solver.
    least_set_up, least_step = 1e-3, 2.5e-3
    set_up = least_set_up + seconds(mesh)
    if solver == DIRECT:
        # Some 60 products of a step with friction, limited by memory.
        products = 1e-7 * demand.face_dofs**2 if demand.friction else 0.0
        return set_up + seconds(factorization), least_step + seconds(direct) + products
    factor = algebraic
    if solver == GEOMETRIC:
        # Cycles of algebraic multigrid on a large first mesh.
        factor = 1.0 if has_small_first_mesh(demand) else 1.6
    # Nearly incompressible bodies take more iterations.
    growth = max(1.0, 0.35 / math.sqrt(max(1.0 - 2.0 * demand.poissons_ratio, 1e-8)))
    return set_up, least_step + seconds(multigrid) * factor * growth


def expected_memory(solver, demand):
    """In MB, what matrix, solver and vectors take beyond mesh and spaces."""
    is_2d, n = demand.dimension == 2, float(demand.dofs)
    # 5 or 14 blocks a node, with their columns; some 20 vectors.
    matrix, vectors = n * (90.0 if is_2d else 14.0 * 76.0 / 3.0), n * 20.0 * 8.0
    if solver == GEOMETRIC:
        return 1e-6 * (matrix + vectors + n * (950.0 if is_2d else 1200.0))
    # A second matrix without the prescribed rows, of 12 bytes an entry, and ML.
    if solver == ALGEBRAIC:
        rest = 18.0 * 12.0 + 850.0 if is_2d else 81.0 * 12.0 + 2700.0
        return 1e-6 * (matrix + vectors + n * rest)
    # Nested dissection: n log n entries in 2D, n^(4/3) in 3D.
    factor = n * 78.0 * math.log2(max(n, 2.0)) if is_2d else n * 190.0 * n ** (1 / 3)
    return 1e-6 * (matrix + vectors + factor + 16.0 * float(demand.face_dofs) ** 2)


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

    def seconds(self, dofs, steps, n_set_ups):
        return n_set_ups * self.set_up(dofs) + steps * self.step(dofs)


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
            return known.seconds(dofs, steps, n_set_ups)
        of_known = solver
        if not known:
            of_known = max(self.solvers, key=lambda name: self.solvers[name].largest)
            known = self.solvers[of_known]
        n = known.largest
        there = expected_cost(of_known, self.demand_at(n, steps, n_set_ups))
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
    # The last of the largest.
    model.demand = max(reversed(samples), key=lambda s: s.demand.dofs).demand
    # Some 10 % of noise in seconds against exponents known to a few tenths.
    # Solving is nearly linear; assembly is, factorizations n^(3/2) and n^2.
    is_2d = model.demand.dimension == 2
    linear = Prior(weight=0.3)
    solve = Prior(p=1.0 if is_2d else 4.0 / 3.0, weight=0.3)
    factorize = Prior(p=1.2 if is_2d else 1.7, weight=0.3)
    demands = [s.demand for s in samples]
    sizes = [float(demand.dofs) for demand in demands]
    names = [choose_solver(demand) for demand in demands]
    known_memory = [expected_memory(*of) for of in zip(names, demands)]
    for solver in dict.fromkeys(names):
        of_it = [(n, s) for n, s, name in zip(sizes, samples, names) if name == solver]
        set_ups = [(n, 1.0, s.set_up_seconds / s.n_set_ups) for n, s in of_it]
        steps = [(n, 1.0, (s.seconds - s.set_up_seconds) / s.steps) for n, s in of_it]
        is_direct = solver == DIRECT
        model.solvers[solver] = SolverModel(
            fit_two_powers(set_ups, factorize if is_direct else linear),
            fit_two_powers(steps, solve if is_direct else linear),
            max(n for n, _ in of_it),
        )
    # Meshes, spaces and states.
    rest = [(n, 1.0, s.memory - m) for n, s, m in zip(sizes, samples, known_memory)]
    model.other_memory = fit_two_powers(rest, Prior(weight=10.0))
    per_step = [(n, s.seconds / s.steps) for n, s in zip(sizes, samples)]
    model.simple = fit_line(per_step, solve.p)
    model.misfit = misfit_of(
        log_ratio(model.solvers[name].seconds(n, s.steps, s.n_set_ups), s.seconds)
        for n, s, name in zip(sizes, samples, names)
    )
    model.memory_misfit = misfit_of(
        log_ratio(m + model.other_memory(n), s.memory)
        for n, s, m in zip(sizes, samples, known_memory)
    )
    return model
