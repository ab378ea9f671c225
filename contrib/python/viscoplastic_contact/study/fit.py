# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the runs of a study say of errors: powers of the mesh width h and the
time step k, by robust least squares. Pure functions of numbers."""

import functools
from dataclasses import dataclass, replace
from math import exp, hypot, isfinite, log, nan, sqrt
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

# The unknowns of a fit are log c_1, p, log c_2, q. Their ranges: a coefficient
# of e^-60 means that the term is not there.
SMALLEST = np.array([-60.0, 0.25, -60.0, 0.25])
LARGEST = np.array([60.0, 5.0, 60.0, 5.0])
# Below this share of every sample a term does not show.
INVISIBLE_SHARE = 1e-4
# Logarithms of coordinates that are closer are the same.
SAME = 1e-6


class Misfit(NamedTuple):
    """How far a fit is from the samples that it was made from: the root mean
    square of log(fit/sample) and the median of its absolute value, which outliers
    do not move; the largest of fit/sample and sample/fit with the index of that
    sample; and how many samples count. Without any there is no fit."""

    rms: float = nan
    median: float = nan
    worst_factor: float = 1.0
    worst_sample: int = 0
    n_samples: int = 0


def misfit_of(log_ratios):
    """The misfit where log(fit/sample) of each sample is given; samples for which
    that is not finite do not count."""
    sizes = np.abs(np.array(list(log_ratios), dtype=float))
    known = sizes[np.isfinite(sizes)]
    if not known.size:
        return Misfit()
    worst = int(np.argmax(np.where(np.isfinite(sizes), sizes, -1.0)))
    rms = sqrt(np.mean(known**2))
    return Misfit(rms, upper_median(known), exp(sizes[worst]), worst, known.size)


def upper_median(values):
    return float(np.sort(values)[len(values) // 2])


@dataclass(frozen=True)
class TwoPowers:
    """The law y(x_1, x_2)^m = (c_1 x_1^p)^m + (c_2 x_2^q)^m with c_1, c_2 >= 0;
    m is 1, or 2 for two parts of an error that are orthogonal to each other."""

    c_1: float = 0.0
    p: float = 1.0
    c_2: float = 0.0
    q: float = 1.0
    m: float = 1.0
    # Whether the exponents come from the samples, not from theory.
    p_is_fitted: bool = False
    q_is_fitted: bool = False
    # Whether the samples can tell the two terms apart: otherwise each has half
    # of the sum.
    is_separable: bool = True
    misfit: Misfit = Misfit()

    def first(self, x_1):
        return self.c_1 * x_1**self.p if self.c_1 > 0.0 else 0.0

    def second(self, x_2=1.0):
        return self.c_2 * x_2**self.q if self.c_2 > 0.0 else 0.0

    def __call__(self, x_1, x_2=1.0):
        first, second = self.first(x_1), self.second(x_2)
        return first + second if self.m == 1.0 else hypot(first, second)

    def rest(self, total, first_part):
        """What the second term may be where the first one is first_part and both
        together are total; 0 if nothing is left."""
        power = total**self.m - first_part**self.m
        return power ** (1.0 / self.m) if power > 0.0 else 0.0


class Finer(NamedTuple):
    """The run that has been taken for the truth, so that samples are differences
    to it. Where its errors are orthogonal to these differences, as those of
    Galerkin methods are in their norm, squares subtract (m = 2), otherwise the
    errors themselves (m = 1)."""

    x_1: float
    x_2: float
    m_1: float = 1.0
    m_2: float = 1.0


class Prior(NamedTuple):
    """What is believed of the exponents without samples. The weight is the
    residual of a deviation of 1 from them, next to the residuals of log y: small
    ones leave all to the samples, and decide where these say nothing."""

    p: float = 1.0
    q: float = 1.0
    weight: float = 1e-3
    is_one_term: bool = False


class Problem:
    """What a fit goes by, in logarithms: those of x_1 and x_2 (both with the mean
    0) and of y."""

    def __init__(self, coordinates, log_y, prior, finer):
        self.coordinates, self.log_y = coordinates, log_y
        self.prior, self.finer = prior, finer
        self.gradient_of_prior = prior.weight * np.eye(4)[[1, 3]]

    def term(self, c, log_c, p):
        """One of the two terms in all samples, and d log(term) / dp."""
        x = self.coordinates[:, c]
        value, slope = np.exp(log_c + p * x), x
        if self.finer is None:
            return value, slope
        f, m = self.finer[c], self.finer[2 + c]
        below = f < x - SAME
        # 1 - (x_finer/x)^(m p)
        rest = np.where(below, -np.expm1(m * p * np.where(below, f - x, -1.0)), 1.0)
        value = value * rest ** (1.0 / m)
        slope = np.where(below, (x - (1.0 - rest) * f) / rest, x)
        # In both runs, and not in their difference.
        other = self.finer[1 - c] < self.coordinates[:, 1 - c] - SAME
        shared = (f < x + SAME) & other
        return np.where(~below & shared, 0.0, value), slope

    def equations(self, x):
        """log(fit/sample) of all samples, and its derivatives; then the share of
        the first term."""
        first, slope_1 = self.term(0, x[0], x[1])
        second, slope_2 = self.term(1, x[2], x[3])
        total = first + second
        share = first / total
        gradient = [share, share * slope_1, 1.0 - share, (1.0 - share) * slope_2]
        return np.log(total) - self.log_y, np.stack(gradient, axis=1), share

    def weights(self, residuals):
        """Huber's: samples within some 1.5 median deviations count in full,
        outliers by their sign."""
        sizes = np.abs(residuals)
        threshold = 1.5 * max(0.02, 1.4826 * upper_median(sizes))
        return np.minimum(1.0, threshold / np.maximum(sizes, 1e-300))

    def of_prior(self, x):
        """The residuals of the prior."""
        return self.prior.weight * np.array([x[1] - self.prior.p, x[3] - self.prior.q])

    def square_of(self, residuals):
        """The sum of their squares with their weights."""
        return (self.weights(residuals) * residuals**2).sum()

    def value(self, x):
        """The sum of squares that is to be small."""
        return self.square_of(self.equations(x)[0]) + (self.of_prior(x) ** 2).sum()

    def deviation(self, choice, x, which):
        """Standard deviation of the unknown number which among those that are chosen,
        for deviations of at least 1 % in the samples."""
        residuals, gradient, _ = self.equations(x)
        rows = np.vstack([gradient, self.gradient_of_prior])[:, choice]
        weights = np.append(self.weights(residuals), [1.0, 1.0])
        curvature = rows.T @ (weights[:, None] * rows) + 1e-12 * np.eye(rows.shape[1])
        position = int(np.count_nonzero(choice[:which]))
        variance = np.linalg.inv(curvature)[position, position]
        square = self.square_of(residuals)
        square /= max(1.0, len(residuals) - np.count_nonzero(choice))
        return sqrt(max(1e-4, square) * max(0.0, variance))


def minimize(problem, choice, start):
    """Least squares for the unknowns that are chosen, again and again with the
    weights of the last residuals."""
    x = start.copy()

    def place(unknowns):
        result = x.copy()
        result[choice] = unknowns
        return np.clip(result, SMALLEST, LARGEST)

    for _ in range(30):
        root = np.sqrt(problem.weights(problem.equations(x)[0]))

        def residuals(unknowns):
            at = place(unknowns)
            return np.append(root * problem.equations(at)[0], problem.of_prior(at))

        def jacobian(unknowns):
            at = place(unknowns)
            inside = (at > SMALLEST) & (at < LARGEST)
            rows = root[:, None] * problem.equations(at)[1]
            return (np.vstack([rows, problem.gradient_of_prior]) * inside)[:, choice]

        found = least_squares(
            residuals, x[choice], jacobian, method="lm", xtol=1e-10, ftol=1e-12
        )
        moved = place(found.x)
        change = np.abs(moved - x).max()
        x = moved
        if change < 1e-7:
            break
    return x, problem.value(x)


def best_fit(problem, choice, fixed):
    """The best of several starts, which a coarse grid tells: which term explains
    the errors is not known. Unknowns that are not chosen are those of fixed."""
    exponents = (0.35, 0.5, 0.75, 1.0, 1.4, 2.0, 3.0)
    mean = problem.log_y.mean()
    starts = []
    for share in (0.02, 0.3, 0.7, 0.98) if choice[2] else (0.02,):
        second = mean + log(1.0 - share) if choice[2] else fixed[2]
        grid = [
            np.array([mean + log(share), p, second, q])
            for p in (exponents if choice[1] else (fixed[1],))
            for q in (exponents if choice[3] else (fixed[3],))
        ]
        starts.append(min(((problem.value(x), x) for x in grid), key=lambda s: s[0]))
    starts.sort(key=lambda start: start[0])
    found = [minimize(problem, choice, x) for _, x in starts[:3]]
    return min(found, key=lambda result: result[1])[0]


def fit_two_powers(samples, prior=Prior(), smallest=0.0, finer=None):
    """The law for samples (x_1, x_2, y), by robust (Huber) least squares for
    log y. Samples that are not finite, or not above smallest, are left out. An
    exponent that the samples do not determine to 0.3 (one standard deviation) has
    the value of the prior. With finer the terms are those of both runs subtracted;
    the result is the law of the errors themselves."""
    return fit_once(tuple(tuple(map(float, s)) for s in samples), prior, smallest, finer)


# Reports are written again and again while a study grows.
@functools.lru_cache(maxsize=4096)
def fit_once(samples, prior, smallest, finer):
    table = np.array(samples, dtype=float).reshape(-1, 3)
    is_used = np.isfinite(table[:, 2]) & (table > (0.0, 0.0, smallest)).all(axis=1)
    if not is_used.any():
        return TwoPowers(p=prior.p, q=prior.q)
    logs = np.log(table[is_used])
    center = logs[:, :2].mean(axis=0)
    if finer:
        x_1, x_2 = np.log(finer[:2]) - center
        finer = finer._replace(x_1=x_1, x_2=x_2)
    problem = Problem(logs[:, :2] - center, logs[:, 2], prior, finer)

    s_11, s_22 = (problem.coordinates**2).sum(axis=0)
    s_12 = problem.coordinates.prod(axis=1).sum()
    varies_1, varies_2 = s_11 > SAME**2, s_22 > SAME**2
    fixed = np.array([0.0, prior.p, SMALLEST[2], prior.q])
    are_parallel = varies_1 and varies_2 and s_12**2 >= 0.998 * s_11 * s_22
    is_separable = not are_parallel or prior.is_one_term
    if not is_separable:
        # One coordinate follows from the other. Half of one power each: this is
        # all that the samples say.
        x = best_fit(problem, np.array([True, True, False, False]), fixed)
        x[0] -= log(2.0)
        x[2], x[3] = x[0], x[1] * s_11 / s_12
        p_is_fitted = q_is_fitted = True
    else:
        # Something that does not vary is a constant, whose share still shows
        # beside what varies; of two constants only the sum does.
        has_second = not prior.is_one_term and (varies_1 or varies_2)
        choice = np.array([True, varies_1, has_second, has_second and varies_2])
        for a in (3, 1, 2):
            if np.count_nonzero(choice) > len(logs):
                choice[a] = False
        x = best_fit(problem, choice, fixed)
        # Exponents that could be anything, or want to be nonsense.
        for a in (3, 1):
            if choice[a] and (
                problem.deviation(choice, x, a) > 0.3
                or not SMALLEST[a] < x[a] < LARGEST[a]
            ):
                choice[a] = False
                x = best_fit(problem, choice, fixed)
        p_is_fitted, q_is_fitted = bool(choice[1]), bool(choice[3])

    residuals, _, share = problem.equations(x)
    log_ratios = np.full(len(table), nan)
    log_ratios[is_used] = residuals
    first = {"c_1": exp(x[0] - x[1] * center[0]), "p": float(x[1])}
    second = {"c_2": exp(x[2] - x[3] * center[1]), "q": float(x[3])}
    # Terms that no sample sees.
    if share.max() < INVISIBLE_SHARE:
        first, p_is_fitted = {"p": prior.p}, False
    if share.min() > 1.0 - INVISIBLE_SHARE:
        second, q_is_fitted = {"q": prior.q}, False
    return TwoPowers(
        **first,
        **second,
        p_is_fitted=p_is_fitted,
        q_is_fitted=q_is_fitted,
        is_separable=is_separable,
        misfit=misfit_of(log_ratios),
    )


# What is below is rounding.
ROUNDING = 1e-13


def fit_error(samples, finer=None):
    """Relative errors: C_h h^p + C_k k^q, or the root of the sum of squares if
    that fits better; where nothing else is known p = q = 1 as in (5.14) and
    (5.20)."""
    total = fit_two_powers(samples, Prior(), ROUNDING, finer)
    has_two = total.is_separable and total.c_1 > 0.0 and total.c_2 > 0.0
    if not has_two or total.misfit.n_samples < 4:
        return total
    # The same for the squares.
    squares = [(x_1, x_2, y * y) for x_1, x_2, y in samples]
    if finer:
        finer = finer._replace(m_1=finer.m_1 / 2.0, m_2=finer.m_2 / 2.0)
    root = fit_two_powers(squares, Prior(p=2.0, q=2.0), ROUNDING**2, finer)
    rms, median, worst_factor, *which = root.misfit
    misfit = Misfit(rms / 2.0, median / 2.0, sqrt(worst_factor), *which)
    if not misfit.median < 0.8 * total.misfit.median - 1e-5:
        return total
    powers = {"p": root.p / 2.0, "q": root.q / 2.0}
    sizes = {"c_1": sqrt(root.c_1), "c_2": sqrt(root.c_2)}
    return replace(root, m=2.0, **sizes, **powers, misfit=misfit)


def fit_error_parts(samples, parts_of_h, parts_of_k):
    """The same where each part is known by itself, as those of an error estimate
    are: two fits of one power each. The misfit is that of the sum to the
    samples."""
    prior = Prior(is_one_term=True)
    space = [(x_1, 1.0, part) for (x_1, _, _), part in zip(samples, parts_of_h)]
    time = [(x_2, 1.0, part) for (_, x_2, _), part in zip(samples, parts_of_k)]
    of_h = fit_two_powers(space, prior, ROUNDING)
    of_k = fit_two_powers(time, prior, ROUNDING)
    result = replace(of_h, c_2=of_k.c_1, q=of_k.p, q_is_fitted=of_k.p_is_fitted)
    ratios = (log_ratio(result(x_1, x_2), y) for x_1, x_2, y in samples)
    return replace(result, misfit=misfit_of(ratios))


def log_ratio(fit, sample):
    """log(fit/sample); not a number where there is none."""
    ratio = fit / sample if sample else nan
    return log(ratio) if isfinite(ratio) and ratio > 0.0 else nan


def fit_line(samples, prior_p):
    """c_1 x_1^p by least squares in logarithms; the exponent of samples (x_1, y)
    with one x_1 is prior_p."""
    logs = np.log([sample for sample in samples if sample[1] > 0.0])
    if not len(logs):
        return TwoPowers()
    x, y = logs.T
    distances = x - x.mean()
    spread = (distances**2).sum()
    is_fitted = bool(spread > SAME**2)
    p = float((distances * y).sum() / spread) if is_fitted else prior_p
    result = TwoPowers(exp(y.mean() - p * x.mean()), p, p_is_fitted=is_fitted)
    ratios = (log_ratio(result(x_1), y) for x_1, y in samples)
    return replace(result, misfit=misfit_of(ratios))
