# SPDX-License-Identifier: LGPL-2.1-or-later
"""How far the quantities of runs are apart, over time."""

from dataclasses import dataclass
from math import hypot, inf

import numpy as np

from .record import unit_of, vector_name
from .words import exact


@dataclass
class QuantityChange:
    """The largest difference of all times over the largest size, and the same for the
    error of the discretization."""

    quantity: str
    change: float = 0.0
    error: float = 0.0


def at_times_of(table, other, column):
    """The column of another table at the times of this one, linear between its rows;
    zero without it."""
    if column not in other:
        return np.zeros(len(table["t"]))
    return np.interp(table["t"], other["t"], other[column])


def differences(table, terms):
    """For each quantity the largest size of the sum of it and of the terms, pairs of
    another table and a sign, over the largest size of the quantity."""
    quantities = {}  # the columns of each
    for column in table:
        if unit_of(column):
            quantities.setdefault(vector_name(column), []).append(column)

    def largest_sum(columns, terms):
        values = np.array([table[column] for column in columns])
        for other, sign in terms:
            values += sign * np.array([at_times_of(table, other, c) for c in columns])
        # NaN does not win.
        return float(np.fmax.reduce(np.sqrt((values**2).sum(axis=0)), initial=0.0))

    sizes = {name: largest_sum(columns, []) for name, columns in quantities.items()}
    result = []
    for name, columns in quantities.items():
        change, unit = largest_sum(columns, terms), unit_of(name)
        # Under another contact law the normal force is a reaction or data.
        if name == "contact_force" and any(columns[0] not in t for t, _ in terms):
            change = 0.0
        # Energies are parts of one balance: beside all of it a dissipation can be
        # negligible.
        share = 1.0 if unit == "energy" else 1e-3
        most = max(size for other, size in sizes.items() if unit_of(other) == unit)
        size = max(sizes[name], share * most)
        result.append(QuantityChange(name, change / size if size > 0.0 else 0.0))
    return result


def changes_between(table, other):
    """The differences between the quantities of two runs, at the times of the first
    and linear in between in the second, relative to the largest value of the first, or to
    a thousandth of what others of the same kind reach, if that is larger; energies are to
    the largest of them. The slipping area is none of them: it jumps from point to point,
    in time, too. What a run has no column for is zero, but for the force of unilateral
    contact, which then is not compared."""
    return differences(table, [(other, -1.0)])


def interactions(table, first, second, joint):
    """By how much two changes do not add up, for each quantity: the largest
    |q - q_first - q_second + q_both| over the largest size, as above."""
    return differences(table, [(first, -1.0), (second, -1.0), (joint, 1.0)])


def largest_of(table, column):
    """The largest value of a column, where it has values; 0 without any."""
    values = table.get(column, np.zeros(0))
    return float(max(values[np.isfinite(values)], default=0.0))


def error_of_iterations(table, other):
    """Up to where the error of the iterations of both runs explains a change: ten
    times its largest bound, but not more than 1e-4."""
    bound = max(largest_of(t, "algebraic_error") for t in (table, other))
    # It is one in energy, quantities may have larger ones. Linear iterations are as
    # exact as the lower limit; more than the upper one is a change, even if iterations
    # that ended early may explain it.
    return min(max(10.0 * max(bound, 0.0), 1e-8), 1e-4)


def piecewise_linear(times, values):
    """The function that is linear between these values, and constant before and
    linear after them, as an expression of t. Points on a line between others are left
    out."""
    tolerance = 1e-9 * max(map(abs, values))
    # As a sum of ramps. What is left out is followed, so that it cannot pile up: the
    # slope after a new node leads from the sum so far to the value.
    text, slope = exact(values[0]), 0.0
    node, at_node = times[0], values[0]
    for i in range(1, len(times)):
        if abs(at_node + slope * (times[i] - node) - values[i]) <= tolerance:
            continue
        at_node += slope * (times[i - 1] - node)
        node = times[i - 1]
        new_slope = (values[i] - at_node) / (times[i] - node)
        text += f"+({exact(new_slope - slope)})*max(0,t-{exact(node)})"
        slope = new_slope
    return text


def contact_force_of(table):
    """The size of the force of unilateral contact as an expression of t, linear
    between the steps; empty without such contact."""
    names = [f"contact_force_{axis}" for axis in "xyz"]
    columns = [map(float, table[name]) for name in names if name in table]
    if not columns:
        return ""
    return piecewise_linear(
        [float(t) for t in table["t"]], [hypot(*row) for row in zip(*columns)]
    )


def bound(error):
    """An error that is not known may be anything."""
    return error if np.isfinite(error) else inf
