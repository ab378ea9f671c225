# SPDX-License-Identifier: LGPL-2.1-or-later
"""Orders, frontiers and prices: what the numbers of a study say.

Functions of plain arrays.  An error that is unknown is nan and never counts.
"""

import numpy as np


def known(*columns):
    """Where all columns hold positive, finite numbers."""
    columns = [np.asarray(column, dtype=float) for column in columns]
    with np.errstate(invalid="ignore"):
        found = [np.isfinite(column) & (column > 0.0) for column in columns]
    return np.logical_and.reduce(found)


def differ(first, second):
    """Whether two sizes are far enough apart for an order: on adaptive meshes
    h may hardly change."""
    return abs(np.log(first / second)) > np.log(1.1)


def observed_orders(sizes, errors):
    """log(e_i/e_{i-1}) / log(s_i/s_{i-1}) for i = 1, ...; nan where an error is
    not known or the sizes hardly differ."""
    sizes, errors = np.asarray(sizes, float), np.asarray(errors, float)
    orders = np.full(max(len(sizes) - 1, 0), np.nan)
    usable = known(sizes, errors)
    for i in range(1, len(sizes)):
        if usable[i - 1] and usable[i] and differ(sizes[i], sizes[i - 1]):
            orders[i - 1] = np.log(errors[i] / errors[i - 1]) / np.log(
                sizes[i] / sizes[i - 1]
            )
    return orders


def final_order(sizes, errors):
    """The order between the two finest runs whose error is known, or None
    where their sizes hardly differ."""
    sizes, errors = np.asarray(sizes, float), np.asarray(errors, float)
    usable = known(sizes, errors)
    orders = observed_orders(sizes[usable], errors[usable])
    return float(orders[-1]) if np.isfinite(orders[-1:]).any() else None


def efficient_frontier(seconds, errors, gain=0.0):
    """Indices, the cheapest first, of the runs than which no other is both at
    least as cheap and at least as accurate (of equal ones the first).  Each has to
    lower the error by more than a share `gain` of that of the run before."""
    seconds, errors = np.asarray(seconds, float), np.asarray(errors, float)
    candidates = np.nonzero(known(seconds, errors))[0]
    best, frontier = np.finfo(float).max, []
    for i in sorted(candidates, key=lambda i: (seconds[i], errors[i], i)):
        if errors[i] < (1.0 - gain) * best:
            best = errors[i]
            frontier.append(int(i))
    return frontier


def without_detours(seconds, errors, frontier, factor=1.2):
    """Those runs of a frontier whose error is within a factor of the straight line,
    in logarithms, between those before and after them."""
    kept = []
    for i in frontier:
        while len(kept) > 1:
            before, last = kept[-2:]
            line = at(seconds[last], seconds[[before, i]], errors[[before, i]])
            if errors[last] <= factor * line:
                break
            kept.pop()
        kept.append(i)
    return kept


def cheapest_within(tolerance, seconds, errors):
    """The index of the cheapest run with an error of at most `tolerance`, or
    None."""
    for i in efficient_frontier(seconds, errors):
        if errors[i] <= tolerance:
            return i
    return None


def predicted_error(fit, h, k):
    """((C_h h^p)^m + (C_k k^q)^m)^(1/m); a part that the fit lacks is zero."""
    h, k, m = np.asarray(h, float), np.asarray(k, float), fit.get("m") or 1.0
    of_mesh = (fit.get("C_h") or 0.0) * h ** (fit.get("p") or 0.0)
    of_steps = (fit.get("C_k") or 0.0) * k ** (fit.get("q") or 0.0)
    return (of_mesh**m + of_steps**m) ** (1.0 / m)


def fits(fit, h, k, errors, factor=1.1):
    """Where a fit is within a factor of the errors."""
    return np.abs(np.log(predicted_error(fit, h, k) / errors)) <= np.log(factor)


def at(x, curve_x, curve_y):
    """A curve that is straight in logarithms, at x; nan outside of it."""
    order = np.argsort(curve_x)
    x = np.log(np.asarray(x, float))
    log_x, log_y = np.log(curve_x)[order], np.log(curve_y)[order]
    return np.exp(np.interp(x, log_x, log_y, left=np.nan, right=np.nan))


def slope_triangle(segment, curves, above=False, gap=1.35):
    """Corners of a triangle with the slope of `segment`, clear of `curves`.

    segment  two points ((x, y), (x, y)) of a curve, in any order
    curves   [(x values, y values), ...] that it must not touch
    above    over all curves, instead of below them
    gap      factor between the triangle and the nearest curve

    Returns the corners (3, 2): both ends of the side with the slope, the one
    with the smaller x first, then the right angle; and the order.
    """
    (xa, ya), (xb, yb) = sorted(segment)
    order = np.log(yb / ya) / np.log(xb / xa)
    # the middle half of the segment
    x = np.exp(np.log(xa) + np.log(xb / xa) * np.array([0.25, 0.75]))
    y = ya * (x / xa) ** order
    samples = np.geomspace(*x, 9)
    line = ya * (samples / xa) ** order
    factor = 1.0
    for curve_x, curve_y in curves:
        ratio = at(samples, curve_x, curve_y) / line
        ratio = ratio[np.isfinite(ratio)]
        if len(ratio):
            factor = max(factor, ratio.max()) if above else min(factor, ratio.min())
    y = y * (factor * gap if above else factor / gap)
    right_angle = (x[0], y[1]) if above == (order > 0) else (x[1], y[0])
    return np.array([(x[0], y[0]), (x[1], y[1]), right_angle]), float(order)
