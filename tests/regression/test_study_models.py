# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fits to made-up errors and costs whose coefficients are known, the prices that
follow from them, and records of finished runs; all without the program."""

import itertools
import math
import sys
import tempfile
import unittest
from dataclasses import replace
from math import hypot, nan, sqrt
from pathlib import Path
from types import SimpleNamespace

import numpy as np

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "contrib" / "python"))

from viscoplastic_contact.study.cost import (
    DIRECT,
    GEOMETRIC,
    CostSample,
    SolverDemand,
    choose_solver,
    expected_cost,
    expected_memory,
    fit_cost,
)
from viscoplastic_contact.study.effects import (
    AS_LARGE_AS_THE_ERROR,
    BELOW_THE_ERROR,
    CALLED_FOR,
    NEVER_ACTED,
    ONLY_WATCHES,
    EffectResult,
    EffectsStudy,
    judge,
)
from viscoplastic_contact.study.effects_report import in_words, with_chance
from viscoplastic_contact.study.fit import (
    Finer,
    Prior,
    fit_error,
    fit_error_parts,
    fit_two_powers,
)
from viscoplastic_contact.study.histories import (
    QuantityChange,
    changes_between,
    interactions,
    piecewise_linear,
)
from viscoplastic_contact.study.price import (
    ToleranceSample,
    WorkPrecisionModel,
    fit_tolerance,
    list_prices,
    price_in_words,
)
from viscoplastic_contact.study.pricing import stagnation
from viscoplastic_contact.study.record import (
    NO_COST,
    PHASES,
    MethodVariant,
    RunKey,
    RunRecord,
    from_json,
    make_record,
    read_table,
    to_json,
)
from viscoplastic_contact.study.scene import (
    n_steps,
    read_phases,
    scale_phases,
    write_phases,
)
from viscoplastic_contact.study.variants import (
    OBSERVATION,
    PROBLEM,
    EffectVariant,
    both,
    zeros_for,
)
from viscoplastic_contact.tables import UserError


# Of a normal distribution.
CHANCE = (
    *(0.184128, -1.005955, -0.341980, -0.044724, 0.278441),
    *(-0.580894, -0.151515, -1.147434, -0.611000, -1.189517),
)


def ladders(truth, noise=0.0, space=True, time=True, both=True):
    """Samples (h, k, error) of a study with four levels, of the law C_h h^p +
    C_k k^q; noise is that of log(error)."""
    c_h, p, c_k, q = truth
    chance, samples = iter(CHANCE), []

    def add(i, j):
        h, k = 0.125 * 0.5**i, 0.05 * 0.5**j
        error = (c_h * h**p + c_k * k**q) * math.exp(noise * next(chance))
        samples.append((h, k, error))

    for i in range(4):
        if space:
            add(i, 3)
        if time and (i < 3 or not space):
            add(3, i)
        if both and i < 3:
            add(i, i)
    return samples


def law(truth, h, k):
    c_h, p, c_k, q = truth
    return c_h * h**p + c_k * k**q


PLAIN = (2.0, 1.0, 3.0, 1.0)


class TestCase(unittest.TestCase):
    def near(self, value, expected, tolerance):
        self.assertAlmostEqual(value, expected, delta=tolerance)


class Fits(TestCase):
    def test_known_coefficients(self):
        for truth in (
            PLAIN, (2.0, 0.75, 3.0, 1.0), (2.0, 1.0, 40.0, 2.0), (0.1, 0.5, 0.3, 1.0)
        ):
            fit = fit_error(ladders(truth))
            self.assertEqual(fit.m, 1.0)
            self.assertTrue(fit.p_is_fitted and fit.q_is_fitted)
            # The weak belief in 1 is all that is between.
            self.near(fit.p, truth[1], 1e-4)
            self.near(fit.q, truth[3], 1e-4)
            self.near(fit.c_1, truth[0], 1e-3 * truth[0])
            self.near(fit.c_2, truth[2], 1e-3 * truth[2])
            self.assertLess(fit.misfit.rms, 1e-5)
            self.assertEqual(fit.misfit.n_samples, 10)

    def test_noise(self):
        fit = fit_error(ladders(PLAIN, 0.05))
        self.near(fit.p, 1.0, 0.1)
        self.near(fit.q, 1.0, 0.2)
        self.assertGreater(fit.misfit.rms, 0.01)
        self.assertLess(fit.misfit.rms, 0.06)
        self.assertLess(fit.misfit.worst_factor, 1.15)
        # One level beyond the samples.
        h, k = 0.125 / 16, 0.05 / 16
        self.near(fit(h, k), law(PLAIN, h, k), 0.1 * law(PLAIN, h, k))

    def test_outlier(self):
        samples = ladders(PLAIN, 0.01)
        h, k, error = samples[4]
        samples[4] = (h, k, 3.0 * error)
        fit = fit_error(samples)
        self.near(fit.c_1, 2.0, 0.2)
        self.near(fit.c_2, 3.0, 0.3)
        self.assertEqual(fit.misfit.worst_sample, 4)
        self.near(fit.misfit.worst_factor, 3.0, 0.2)

    def test_what_one_ladder_cannot_tell(self):
        space = fit_error(ladders(PLAIN, time=False, both=False))
        self.assertTrue(space.p_is_fitted)
        self.assertFalse(space.q_is_fitted)  # theoretical
        self.assertEqual(space.q, 1.0)
        self.near(space.c_1, 2.0, 1e-3)
        self.near(space.c_2, 3.0, 1e-3)
        time = fit_error(ladders(PLAIN, space=False, both=False))
        self.assertFalse(time.p_is_fitted)
        self.near(time.c_1, 2.0, 1e-3)
        self.near(time.c_2, 3.0, 1e-3)
        both = fit_error(ladders(PLAIN, space=False, time=False))
        self.assertFalse(both.is_separable)
        self.near(both(0.01, 0.004), law(PLAIN, 0.01, 0.004), 1e-6)
        self.near(both.first(0.01), both.second(0.004), 1e-6)

    def test_parts_that_do_not_show(self):
        of_h = fit_error(ladders((2.0, 1.0, 1e-9, 1.0)))
        self.near(of_h.c_1, 2.0, 1e-3)
        self.assertEqual(of_h.c_2, 0.0)
        self.assertFalse(of_h.q_is_fitted)
        noisy = fit_error(ladders((2.0, 1.0, 1e-5, 1.0), 0.03))
        self.assertFalse(noisy.q_is_fitted)
        self.assertLess(noisy.second(0.05), 0.1 * noisy.first(0.125 / 8))
        of_k = fit_error(ladders((0.0, 1.0, 3.0, 1.0)))
        self.assertEqual(of_k.c_1, 0.0)
        self.assertFalse(of_k.p_is_fitted)
        self.near(of_k.c_2, 3.0, 1e-3)

    def test_differences_to_a_finer_run(self):
        finer = Finer(0.125 / 16, 0.05 / 16, 2.0, 1.0)
        samples = [
            (h, k, 2.0 * sqrt(h**2 - finer.x_1**2) + 3.0 * (k - finer.x_2))
            for h, k, _ in ladders(PLAIN)
        ]
        fit = fit_error(samples, finer)
        self.near(fit.p, 1.0, 1e-3)
        self.near(fit.q, 1.0, 1e-3)
        self.near(fit.c_1, 2.0, 0.01)
        self.near(fit.c_2, 3.0, 0.01)
        self.assertLess(fit.misfit.rms, 1e-4)
        # Taken for errors, they seem to fall faster.
        self.assertGreater(fit_error(samples).q, 1.1)
        # The finest of the ladders in its place: its steps are those of the ladder in
        # space, and do not count there.
        corner = Finer(0.125 / 8, 0.05 / 8, 1.0, 1.0)
        of_corner = fit_error(
            [
                (h, k, 2.0 * (h - corner.x_1) + 3.0 * (k - corner.x_2))
                for h, k, _ in ladders(PLAIN)
            ],
            corner,
        )
        self.assertEqual(of_corner.misfit.n_samples, 9)
        self.near(of_corner.c_1, 2.0, 0.01)
        self.near(of_corner.c_2, 3.0, 0.01)

    def test_orthogonal_parts(self):
        places = ladders(PLAIN)
        fit = fit_error([(h, k, hypot(2.0 * h, 3.0 * k)) for h, k, _ in places])
        self.assertEqual(fit.m, 2.0)
        self.near(fit.p, 1.0, 1e-3)
        self.near(fit.q, 1.0, 1e-3)
        self.near(fit(0.01, 0.01), hypot(0.02, 0.03), 1e-4)
        self.near(fit.rest(0.05, 0.03), 0.04, 1e-12)
        self.assertEqual(fit.rest(0.03, 0.05), 0.0)
        # Against a finer run.
        finer = Finer(0.125 / 16, 0.05 / 16, 2.0, 1.0)
        of_differences = fit_error(
            [
                (h, k, hypot(2.0 * sqrt(h**2 - finer.x_1**2), 3.0 * (k - finer.x_2)))
                for h, k, _ in places
            ],
            finer,
        )
        self.assertEqual(of_differences.m, 2.0)
        self.near(of_differences.c_1, 2.0, 0.02)
        self.near(of_differences.c_2, 3.0, 0.03)

    def test_known_parts(self):
        samples = ladders((2.0, 1.0, 0.03, 2.0))  # steps hardly show
        space = [2.0 * h for h, _, _ in samples]
        fit = fit_error_parts(samples, space, [0.03 * k * k for _, k, _ in samples])
        self.near(fit.c_1, 2.0, 1e-3)
        self.near(fit.q, 2.0, 1e-3)
        self.near(fit.c_2, 0.03, 1e-4)
        self.assertLess(fit.misfit.rms, 1e-4)
        # An elastic body has no error of the steps.
        elastic = fit_error_parts(samples, space, [0.0] * len(samples))
        self.assertEqual(elastic.c_2, 0.0)
        self.assertEqual(elastic.misfit.n_samples, len(samples))

    def test_unusable_samples(self):
        self.assertEqual(fit_error([]).misfit.n_samples, 0)
        nothing = [(0.1, 0.1, 0.0), (0.1, 0.2, nan), (0.2, 0.1, 1e-15)]
        self.assertEqual(fit_error(nothing).misfit.n_samples, 0)
        samples = ladders(PLAIN)
        for i, value in ((1, 0.0), (5, nan), (7, math.inf)):
            samples[i] = (*samples[i][:2], value)
        fit = fit_error(samples)
        self.assertEqual(fit.misfit.n_samples, 7)
        self.near(fit.c_1, 2.0, 1e-3)
        # A single one, and equal ones: no order, but a value.
        one = fit_error([(0.1, 0.2, 0.05), (0.1, 0.2, 0.05)])
        self.assertFalse(one.p_is_fitted or one.q_is_fitted)
        self.near(one(0.1, 0.2), 0.05, 1e-6)


def demand(dofs, choice="direct"):
    """That of a scene in two dimensions."""
    return SolverDemand(choice=choice, dofs=round(dofs), first_dofs=50)


def costs(choice="direct"):
    """Runs with the direct solver. Beside it meshes fill 2 kB an unknown."""
    samples = []
    for dofs in (1e3, 4e3, 1.6e4, 6.4e4):
        for steps in (20.0, 40.0):
            set_up = 2e-6 * dofs**1.2
            wanted = replace(demand(dofs, choice), solves=int(steps))
            samples.append(
                CostSample(
                    wanted,
                    steps,
                    1.0,
                    set_up,
                    set_up + steps * (1e-3 + 1e-6 * dofs**1.1),
                    90.0 + 2e-3 * dofs + expected_memory(DIRECT, wanted),
                )
            )
    return samples


class Costs(TestCase):
    def test_known_powers(self):
        model = fit_cost(costs())
        self.assertEqual(list(model.solvers), [DIRECT])
        direct = model.solvers[DIRECT]
        self.near(direct.set_up.p, 1.2, 0.01)
        self.near(direct.step.p, 1.1, 0.01)
        memory = 2090.0 + expected_memory(DIRECT, demand(1e6))
        self.near(model.memory(1e6, 100.0), memory, 20.0)
        # Sixteen times the unknowns of the largest sample, to 1 %: what is believed of
        # the exponents has a weight.
        seconds = 2e-6 * 1e6**1.2 + 100.0 * (1e-3 + 1e-6 * 1e6**1.1)
        self.near(model.seconds(1e6, 100.0), seconds, 5.0)
        self.assertLess(model.misfit.worst_factor, 1.01)
        self.assertLess(model.memory_misfit.worst_factor, 1.01)
        self.assertGreater(model.simple.misfit.worst_factor, 1.1)
        # One run: what is believed of sparse solvers.
        sample = costs()[0]
        sample = sample._replace(demand=replace(sample.demand, dimension=3))
        step = fit_cost([sample]).solvers[DIRECT].step
        self.near(step(8e3) / step(1e3), 16.0, 1e-3)
        none = fit_cost([])
        self.assertEqual(none.misfit.n_samples, 0)
        self.assertEqual(none.seconds(1e4, 10.0), 0.0)

    def test_of_the_solver_that_a_run_would_have(self):
        # Small meshes have the direct solver. A large one that is kept for a few steps
        # only has multigrid, whose cost is known from elsewhere at first,
        samples = costs("automatic")
        before = fit_cost(samples)
        self.assertEqual(choose_solver(before.demand_at(1e6, 2.0)), GEOMETRIC)
        self.assertEqual(choose_solver(before.demand_at(1e6, 1e3)), DIRECT)
        # however often: each new mesh has a solver of its own.
        self.assertEqual(choose_solver(before.demand_at(1e6, 1e3, 500.0)), GEOMETRIC)
        known = before.solvers[DIRECT]
        self.near(
            before.seconds(1e4, 1e3, 50.0) - before.seconds(1e4, 1e3, 1.0),
            49.0 * known.set_up(1e4),
            1e-9,
        )
        there = expected_cost(DIRECT, before.demand_at(6.4e4, 2.0))
        here = expected_cost(GEOMETRIC, before.demand_at(1e6, 2.0))
        self.near(
            before.seconds(1e6, 2.0),
            known.set_up(6.4e4) * here[0] / there[0]
            + 2.0 * known.step(6.4e4) * here[1] / there[1],
            1e-9,
        )
        # and measured as soon as there is a run with it.
        timing = CostSample(before.demand_at(2.5e5, 2.0), 2.0, 1.0, 3.0, 4.0, 1000.0)
        self.assertEqual(choose_solver(timing.demand), GEOMETRIC)
        samples.append(timing)
        after = fit_cost(samples)
        self.assertEqual(after.solvers[GEOMETRIC].largest, 2.5e5)
        self.near(after.seconds(2.5e5, 2.0), 4.0, 1e-6)
        # One run does not tell how the seconds grow.
        of_timing = expected_cost(GEOMETRIC, timing.demand)
        self.near(
            after.seconds(1e6, 2.0),
            3.0 * here[0] / of_timing[0] + 1.0 * here[1] / of_timing[1],
            1e-6,
        )
        self.near(after.seconds(6.4e4, 40.0), before.seconds(6.4e4, 40.0), 1e-9)
        # Prices look at far finer meshes than anybody has.
        for model in (before, after):
            self.near(model.seconds(1e13, 2.0) / model.seconds(1e12, 2.0), 10.0, 2.5)
        # Meshes that nobody has refined yet would be refined from the finest one.
        samples = [s._replace(demand=replace(s.demand, first_dofs=0)) for s in samples]
        self.assertEqual(fit_cost(samples).demand_at(3e5, 2.0).first_dofs, 0)
        self.assertEqual(fit_cost(samples).demand_at(1e6, 2.0).first_dofs, 250000)
        # A face has one dimension less than its body.
        last = samples[-1]
        samples[-1] = last._replace(demand=replace(last.demand, face_dofs=300))
        self.assertEqual(fit_cost(samples).demand_at(1e6, 2.0).face_dofs, 600)


def model():
    return WorkPrecisionModel(
        error=fit_error(ladders(PLAIN)),
        cost=fit_cost(costs()),
        h=0.125,
        k=0.05,
        dofs=162.0,
        phases=read_phases("0.5: 10, 1: 10"),
        coarsest_level=2,
        smallest_h=0.125 / 8,
        smallest_k=0.05 / 8,
    )


def ladder_of_steps(longest, shortest):
    k = longest
    while k > shortest:
        yield k
        k /= 1.1


class Prices(TestCase):
    def test_phases(self):
        phases = read_phases(" 1e-3: 10, 4e-3 : 33")
        self.assertEqual(write_phases(phases), "1e-3: 10, 4e-3: 33")
        self.assertEqual(write_phases(scale_phases(phases, 2.0)), "1e-3: 20, 4e-3: 66")
        self.assertEqual(write_phases(scale_phases(phases, 0.25)), "1e-3: 3, 4e-3: 9")
        self.assertEqual(write_phases(scale_phases(phases, 1e-6)), "1e-3: 1, 4e-3: 1")
        self.assertEqual(n_steps(phases), 43)
        self.assertEqual(write_phases(read_phases("1: 1e3")), "1: 1000")

    def test_cheapest_is_cheapest(self):
        m = model()
        found = m.cheapest(0.01)
        self.assertLessEqual(found.error, 0.01)
        # No level and no number of steps is cheaper.
        for level in range(-2, 11):
            for k in ladder_of_steps(0.05, 1e-4):
                other = m.predict(level, k)
                if other.error <= 0.01:
                    self.assertGreaterEqual(other.seconds, 0.999 * found.seconds)
        self.assertLessEqual(m.ideal_seconds(0.01), 1.01 * found.seconds)
        self.assertGreater(m.ideal_seconds(0.01), 0.2 * found.seconds)

    def test_budget(self):
        m = model()
        self.assertLessEqual(m.most_accurate(10.0).seconds, 10.0)
        prices = list_prices(m, [0.1, 1e-4], 10.0)
        self.assertTrue(prices[0].is_in_budget)
        self.assertFalse(prices[1].is_in_budget)
        # h^-2.2 for the mesh and k^-1: 3.2 powers of two at most.
        self.assertGreater(prices[0].halving, 1.5)
        self.assertLess(prices[0].halving, 10.0)
        sentence = price_in_words(m, prices[1], 10.0)
        self.assertIn("not within 10 s", sentence)
        self.assertIn("the smallest error there is about", sentence)
        self.assertIsNone(m.most_accurate(1e-6))

    def test_stability_limit(self):
        m = model()
        m.largest_k = 0.01
        self.assertLessEqual(m.cheapest(0.5).k, 0.01)

    def test_steps_to_a_tolerance(self):
        # Heun's method: 20 TOL^(-1/2) steps, and five for events.
        m = model()
        steps = [(1.0 / tol, 1.0, 20.0 * tol**-0.5 + 5.0) for tol in (0.16, 0.04, 0.01)]
        m.chosen_steps = fit_two_powers(steps, Prior(p=0.5))
        m.order, m.k, m.largest_k, m.smallest_k = 2, 0.04, 0.16, 0.01
        finer = m.predict(0, 0.0025)
        self.assertEqual(finer.steps, 405)
        self.assertEqual(finer.k, 0.0025)
        # A sixteenth of the tolerance: four times as many steps.
        self.assertEqual(write_phases(finer.phases), "0.5: 40, 1: 40")
        self.near(finer.seconds, m.seconds(m.h, 0.0025), 1e-3 * finer.seconds)
        self.assertFalse(finer.is_far)  # one level beyond
        self.assertTrue(m.predict(0, 0.0006).is_far)
        self.assertEqual(m.predict(0, 1.0).k, 0.16)  # coarser has not been measured
        found = m.cheapest(0.01)
        self.assertLessEqual(found.error, 0.01 * (1.0 + 1e-12))
        for level in range(-2, 11):
            for k in ladder_of_steps(0.16, 1e-5):
                other = m.predict(level, k)
                if other.error <= 0.01:
                    self.assertGreaterEqual(other.seconds, 0.99 * found.seconds)
        self.assertLessEqual(m.ideal_seconds(0.01), 1.01 * found.seconds)
        (price,) = list_prices(m, [0.01], 1e9)
        self.assertIn("step tolerance", price_in_words(m, price, 1e9))
        self.assertIn("A quarter of the step tolerance", m.next_refinement())

    def test_errors_without_one_part(self):
        m = model()
        m.error = fit_error(ladders((2.0, 1.0, 1e-9, 1.0)))
        # Steps cost nothing: as few as there are phases.
        self.assertEqual(m.cheapest(0.1).steps, 2)
        self.assertTrue(math.isfinite(m.ideal_seconds(0.1)))
        m.error = fit_error(ladders((0.0, 1.0, 3.0, 1.0)))
        self.assertEqual(m.cheapest(0.1).mesh_level, -2)
        self.assertTrue(math.isfinite(m.ideal_seconds(0.1)))
        m.error = fit_error([])
        self.assertIsNone(m.cheapest(0.1))
        self.assertFalse(list_prices(m, [0.1], 10.0)[0].is_in_budget)


def sample(tolerance, exponent=2.5):
    """In two dimensions with a scheme of second order, all laws are those of theory
    but for the constants: those of seconds and steps are seen in large tolerances."""
    x = 1.0 / tolerance
    return ToleranceSample(
        tolerance,
        error=0.6 * tolerance,
        seconds=0.4 + 2e-4 * x**exponent,
        cells=0.5 * x * x,
        dofs=1.2 * x * x,
        steps=6.0 + 2.0 * sqrt(x),
        memory=60.0 + 1e-3 * x * x,
    )


def ladder(finest, n, exponent=2.5):
    return [sample(finest * 2.0 ** (n - 1 - i), exponent) for i in range(n)]


class Stagnation(TestCase):
    """Pilots from whose errors no law follows."""

    def pilots(self, space, time, initial=0.0):
        """On two meshes with two steps; parts of the error as functions of h and k."""
        result = []
        for mesh_level, time_level in itertools.product((0, 1), (-1, 0)):
            h, k = 0.5**mesh_level, 0.5**time_level
            numbers = {
                "h": h,
                "k": k,
                "estimate_space": space(h),
                "estimate_time": time(k),
                "estimate_initial": initial,
                "estimate_total": space(h) + time(k) + initial,
            }
            key = RunKey(MethodVariant("uniform", "Heun", "x"), mesh_level, time_level)
            result.append(RunRecord(key, numbers=numbers))
        return result

    def words(self, eps, *parts):
        return stagnation(self.pilots(*parts), "estimate_total", eps)

    def test_errors_that_fall(self):
        for order in 0.5, 1.0, 2.0:
            parts = lambda h: h**order, lambda k: 0.1 * k
            self.assertEqual(self.words(1e-3, *parts), "")

    def test_errors_that_hardly_fall(self):
        self.assertIn(
            "where h and k are halved, the error goes from 0.3 to 0.28",
            self.words(0.05, lambda h: 0.3 * h**0.1, lambda k: 0.0),
        )
        # Good enough already.
        self.assertEqual(self.words(0.3, lambda h: 0.3 * h**0.1, lambda k: 0.0), "")

    def test_a_part_that_hides_behind_the_other(self):
        """What stays when steps no longer count is more than half of the error asked."""
        parts = lambda h: 0.04 * h**0.1, lambda k: 0.5 * k
        self.assertIn("where h is halved, the part of the mesh", self.words(0.05, *parts))
        self.assertEqual(self.words(0.2, *parts), "")
        parts = lambda h: 0.5 * h, lambda k: 0.04 * k**0.1
        self.assertIn(
            "where k is halved, the part of the steps", self.words(0.05, *parts)
        )

    def test_initial_data_stay_as_they_are(self):
        self.assertIn(
            "of the mesh", self.words(0.05, lambda h: 0.01 * h, lambda k: k, 0.1)
        )


class Tolerances(TestCase):
    def test_known_laws(self):
        model = fit_tolerance(ladder(0.01, 5), 2, 2)
        self.near(model.error.p, 1.0, 1e-3)
        self.near(model.error.c_1, 0.6, 1e-3)
        self.near(model.seconds.p, 2.5, 0.01)
        self.near(model.seconds.c_2, 0.4, 0.02)
        self.near(model.cells.p, 2.0, 0.01)
        self.near(model.exponent(model.seconds), 2.5, 0.02)
        run, truth = model.predict(0.005), sample(0.005)
        self.near(run.error / truth.error, 1.0, 0.01)
        for name in ("seconds", "cells", "dofs", "steps", "memory"):
            self.near(getattr(run, name) / getattr(truth, name), 1.0, 0.03)

    def test_exponents_of_the_runs_beat_those_of_theory(self):
        model = fit_tolerance(ladder(0.01, 5, 3.2), 2, 2)
        self.assertTrue(model.seconds.p_is_fitted)
        self.near(model.seconds.p, 3.2, 0.05)

    def test_one_run_is_scaled_by_theory(self):
        model, one = fit_tolerance([sample(0.04)], 3, 1), sample(0.04)
        self.assertFalse(model.seconds.p_is_fitted)
        self.near(model.predict(0.04).seconds, one.seconds, 1e-6)
        self.near(model.predict(0.02).seconds, 2.0 ** (3 + 1) * one.seconds, 1e-3)
        self.near(model.predict(0.02).error, 0.6 * 0.02, 1e-6)

    def test_the_error_of_the_reference_is_no_part_of_the_law(self):
        """Squares of orthogonal errors subtract."""
        reference = 0.005
        samples = [
            s._replace(error=0.6 * sqrt(s.tolerance**2 - reference**2))
            for s in ladder(0.01, 4)
        ]
        model = fit_tolerance(samples, 2, 2, reference)
        self.near(model.error.p, 1.0, 2e-3)
        self.near(model.predict(0.01).error, 0.006, 1e-4)

    def test_tolerance_of_an_error(self):
        model = fit_tolerance(ladder(0.02, 4), 2, 2)
        self.near(model.tolerance_for(0.006), 0.01, 1e-4)
        self.assertEqual(model.tolerance_for(0.4), 0.5)
        # What is promised is not exceeded although less is expected.
        model.is_kept = True
        self.assertEqual(model.tolerance_for(0.006), 0.006)
        seconds = model.predict(0.007).seconds
        self.near(model.most_accurate(seconds).tolerance, 0.007, 1e-6)
        self.assertIsNone(model.most_accurate(0.1))  # less than the constant

    def test_prices_in_words(self):
        model = fit_tolerance(ladder(0.02, 4), 2, 2)
        price = model.price(0.006, 1000.0)
        self.assertTrue(price.is_in_budget)
        self.assertFalse(price.is_far)
        self.assertGreater(price.halving, 4.0)
        self.assertLess(price.halving, 5.7)
        text = price_in_words(model, price, 1000.0)
        self.assertTrue(text.startswith("Error 0.006: tolerance 0.01, "), text)
        self.assertTrue(model.price(0.001, 1e9).is_far)
        large = model.price(1e-5, 20.0)
        self.assertFalse(large.is_in_budget)
        text = price_in_words(model, large, 20.0)
        self.assertIn("not within 20 s, it would take about", text)
        self.assertIn("the smallest error there is about 0.00", text)


# The phases of a run that statistics.csv has in each step.
IN_TABLE = ("rate", "tangent", "load", "contact", "balance", "estimate", "output")
KEY = RunKey(MethodVariant("adaptive", "backward Euler", "cell means"), -1, 2)


def table_of_all_phases():
    """A table of three rows in which each phase that it may have takes seconds of its
    own: powers of two, whose sums are exact and tell who is missing."""
    table = {name: np.array([1.0, 2.0, 4.0]) for name in ("step", "k", "cells", "dofs")}
    seconds = 1.0 / 1024.0
    for phase in IN_TABLE:
        seconds *= 8.0
        table[f"wall_{phase}"] = seconds * np.array([1.0, 2.0, 4.0])
    table["wall_total"] = 8.0 * seconds * np.array([1.0, 2.0, 4.0])
    return table


def any_record():
    return RunRecord(
        KEY,
        'a "run"',
        {"ranks": "2", "scene": "17"},
        {"h": 1.0 / 3.0, "steps": 12.0, "error_h1": nan, "step_limit": math.inf},
        # In this order, which is not that of the alphabet.
        quantities={"slip_area": 1e-300, "point0_x": -math.pi},
    )


class Records(TestCase):
    def test_seconds_of_all_phases_and_the_rest_are_those_of_the_run(self):
        table = table_of_all_phases()
        # What the table has counts, not the timer of a resumed run.
        seconds = {phase: 1e6 if phase in IN_TABLE else 0.25 for phase in PHASES}
        outside = sum(
            table[f"wall_{phase}"].sum() if phase in IN_TABLE else 0.25
            for phase in NO_COST
        )
        record = make_record(KEY, table, {"seconds": seconds})
        for phase in IN_TABLE:
            self.assertEqual(
                record.number(f"seconds_{phase}"), table[f"wall_{phase}"].sum()
            )
        # The pilot run, the first mesh, later ones.
        self.assertEqual(record.number("seconds_set_up"), 0.75)
        everything = sum(map(record.number, set(PHASES.values())))
        run = table["wall_total"][-1]
        self.assertGreater(record.number("seconds_rest"), 0.0)
        self.assertEqual(everything + record.number("seconds_rest"), run)
        self.assertEqual(record.number("seconds_total"), run - outside)

    def test_phases_that_the_table_lacks_are_those_of_the_timer(self):
        """Explicit schemes have no tangents, and without an error bar only adaptive
        runs estimate."""
        table = table_of_all_phases()
        del table["wall_tangent"], table["wall_estimate"]
        record = make_record(KEY, table, {"seconds": {"estimate": 3.0}})
        self.assertEqual(record.number("seconds_tangent"), 0.0)
        self.assertEqual(record.number("seconds_estimate"), 3.0)

    def test_text_has_all_digits_and_the_order_of_quantities(self):
        record = any_record()
        found = from_json(to_json(record), "result.json")
        self.assertEqual(found.name, record.name)
        self.assertEqual(found.key, record.key)
        self.assertEqual(found.stamp, record.stamp)
        self.assertEqual(list(found.quantities.items()), list(record.quantities.items()))
        self.assertEqual(len(found.numbers), len(record.numbers))
        self.assertEqual(found.number("h"), 1.0 / 3.0)
        self.assertEqual(found.number("steps"), 12.0)
        # JSON has no other numbers than finite ones.
        self.assertTrue(math.isnan(found.number("error_h1")))
        self.assertTrue(math.isnan(found.number("step_limit")))

    def test_other_text_is_refused_by_the_name_of_its_file(self):
        text = to_json(any_record())
        for other in (
            "",
            "[1, 2]",
            text[: len(text) // 2],
            text.replace('"mesh_level"', '"level"', 1),
            text.replace("-1", '"one"', 1),
            text.replace("12.0", "true", 1),
            text.replace('"17"', "17", 1),
            text.replace("adaptive", "adoptive", 1),
            text.replace("12.0", "1e999", 1),
        ):
            self.assertNotEqual(other, text)
            with self.assertRaisesRegex(UserError, "'place/result.json' is no record"):
                from_json(other, "place/result.json")

    def test_tables_with_units(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "statistics.csv"
            file.write_text("step,t [day]\n0,0\n1,2\n2,5\n")
            table = read_table(file)
            self.assertEqual(list(table), ["step", "t"])
            self.assertEqual(list(table["t"]), [0.0, 2.0, 5.0])
            file.write_text("")
            with self.assertRaisesRegex(UserError, "no table"):
                read_table(file)


class Effects(TestCase):
    def test_quantities_by_the_names_of_places(self):
        names = {"boundary 3": "roof", "point 10": "crown"}
        for quantity, words in (
            ("reaction_3", "reaction of roof"),
            ("contact_force_3", "contact force on roof"),
            ("reaction_4", "reaction_4"),
            ("point10", "displacement of crown"),
            ("contact_force", "contact_force"),
        ):
            self.assertEqual(in_words(quantity, names), words)

    def test_costs_within_the_scatter_are_the_scatter(self):
        self.assertEqual(with_chance(12.3, 4.0, " %"), "12 +- 4 %")
        self.assertEqual(with_chance(-542.0, 48.0, " %", "+-"), "-542+-48 %")
        self.assertEqual(with_chance(3.1, 93.0, " %", "+-"), "+-93 %")

    def test_what_excludes_what(self):
        elastic = EffectVariant("flow", "", ["Material/Law=elastic"])
        power = EffectVariant("power", "", ["Material/norton/Exponent=1"])
        free = EffectVariant("friction", "", ["Boundary 2/Bound=0"])
        stick = EffectVariant("slip", "", ["Boundary 2/Bound=9"])
        load = EffectVariant("load", "", ["Boundary 1/Traction=1", "A/Equilibrate=true"])
        other = EffectVariant("other", "", ["A/Equilibrate=true"])
        self.assertTrue(elastic.excludes(power))
        self.assertTrue(power.excludes(elastic))
        self.assertTrue(free.excludes(stick))
        self.assertTrue(free.excludes(free))
        self.assertFalse(free.excludes(elastic))
        self.assertFalse(load.excludes(other))
        self.assertEqual(len(both(free, load).overrides), 3)
        self.assertEqual(zeros_for("; -t"), "; 0")

    def judged(self, *changes, kind=PROBLEM):
        result = EffectResult(EffectVariant("", "", kind=kind))
        result.changes = [QuantityChange(*change) for change in changes]
        judge(result, 1e-6)
        return result

    def test_verdicts_by_the_largest_change_for_its_error(self):
        clear = self.judged(("reaction", 0.5, 0.4), ("force", 0.03, 0.01))
        self.assertEqual(clear.verdict, CALLED_FOR)
        self.assertEqual(clear.decisive.quantity, "force")
        for change, error, kind, verdict in (
            (0.015, 0.01, PROBLEM, AS_LARGE_AS_THE_ERROR),
            (0.005, 0.01, PROBLEM, BELOW_THE_ERROR),
            (1e-7, 0.0, PROBLEM, NEVER_ACTED),
            # Iterations may end elsewhere without an error bar.
            (0.01, 0.02, OBSERVATION, ONLY_WATCHES),
            (0.05, 0.02, OBSERVATION, CALLED_FOR),
            # An error that is not known may be anything.
            (3.0, nan, PROBLEM, BELOW_THE_ERROR),
        ):
            judged = self.judged(("force", change, error), kind=kind)
            self.assertEqual(judged.verdict, verdict, (change, error))

    def test_two_tolerances_with_one_mesh_have_no_difference_of_errors(self):
        table = self.table(t=[0, 1], friction_force_x=[0, 3], friction_force_y=[0, 4])
        finer = self.table(t=[0, 1], friction_force_x=[0, 3.3], friction_force_y=[0, 4.4])

        def of(cells, table):
            number = {"cells": cells, "estimate_total": 0.2}.get
            return SimpleNamespace(record=SimpleNamespace(number=number), table=table)

        for coarser_cells, expected in (100, 0.1), (144, 0.2):
            study = SimpleNamespace(
                of_scene={0: of(coarser_cells, table), 1: of(144, finer)},
                with_longer_steps={},
            )
            changes = [QuantityChange("friction_force", 0.01)]
            EffectsStudy.add_errors(study, changes, 1)
            self.assertAlmostEqual(changes[0].error, expected)

    def table(self, **columns):
        return {name: np.array(values, dtype=float) for name, values in columns.items()}

    def test_differences_at_the_times_of_the_first(self):
        run = self.table(
            t=[0, 1, 2],
            friction_force_x=[0, 3, 0],
            friction_force_y=[0, 4, 0],
            cells=[1, 2, 3],
            reaction_3_x=[0, 1e-9, 0],
            reaction_3_y=[0, 0, 0],
        )
        # Between its rows linear, at t = 1 the vector (3, 3).
        other = self.table(
            t=[0, 0.5, 1.5, 2],
            friction_force_x=[0, 2, 4, 1],
            friction_force_y=[0, 2, 4, 0],
        )
        force, reaction = changes_between(run, other)
        self.assertEqual(force.quantity, "friction_force")
        self.near(force.change, 1.0 / 5.0, 1e-15)
        # What is not there is zero; what is almost zero is measured by forces that are
        # not.
        self.assertEqual(reaction.quantity, "reaction_3")
        self.near(reaction.change, 1e-9 / (1e-3 * 5.0), 1e-15)
        for none in changes_between(run, run):
            self.assertEqual(none.change, 0.0)

    def test_contact_force_of_other_contact_laws(self):
        unilateral = self.table(t=[0, 1], contact_force_y=[0, -4], stored_energy=[0, 2])
        force, energy = changes_between(
            unilateral, self.table(t=[0, 1], stored_energy=[0, 1])
        )
        self.assertEqual(force.quantity, "contact_force")
        self.assertEqual(force.change, 0.0)
        self.near(energy.change, 0.5, 1e-15)
        weaker = self.table(t=[0, 1], contact_force_y=[0, -3], stored_energy=[0, 2])
        self.near(changes_between(unilateral, weaker)[0].change, 0.25, 1e-15)

    def test_what_does_not_add_up(self):
        # The force changes by -1 and -2, by both -3; the energy by -4 and -2, by both
        # -5.
        force, energy = interactions(
            *(
                self.table(t=[0, 1], friction_force_x=[0, f], stored_energy=[0, e])
                for f, e in ((10, 10), (9, 6), (8, 8), (7, 5))
            )
        )
        self.near(force.change, 0.0, 1e-15)
        self.near(energy.change, 0.1, 1e-15)

    def test_ramps_only_where_the_slope_changes(self):
        t, v = [0.0, 0.1, 0.2, 0.3, 0.7, 1.0], [1.0, 1.0, 1.05, 1.1, 1.1, -1.0]
        text = piecewise_linear(t, v)
        for at, value in [*zip(t, v), (0.25, 1.075)]:
            self.near(eval(text, {"t": at, "max": max}), value, 1e-13)
        self.assertEqual(text.count("max"), 3)
        self.assertEqual(piecewise_linear(t, [2.0] * 6), "2")


if __name__ == "__main__":
    unittest.main()
