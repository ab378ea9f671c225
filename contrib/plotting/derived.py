# SPDX-License-Identifier: LGPL-2.1-or-later
"""Expressions of columns of statistics.csv, with the unit that follows from theirs."""

import math
import re

import numpy as np

from . import expression, quantities
from .results import UserError
from .units import KINDS, powers


# Terms that have different units.
MIXED = "mixed"


def split(text, separator):
    """The parts between separators that are not within brackets."""
    found, depth = [""], 0
    for character in text:
        depth += (character == "(") - (character == ")")
        if character == separator and depth == 0:
            found.append("")
        else:
            found[-1] += character
    return [part.strip() for part in found if part.strip()]


def add(results, text, dimension):
    """Make an expression a column of the results, unless it is one. Values that are
    not finite, as of a division by zero, are gaps."""
    if text in results.statistics:
        return
    if re.fullmatch(r"\w+", text):
        results.column(text)  # which says what there is
    statistics = results.statistics
    values = expression.of_columns(text, statistics)
    kinds = {name: quantities.column(name)[1] for name in statistics}
    kind = kind_of(text, kinds, dimension)
    if kind == MIXED and results.units:
        raise UserError(f'"{text}" has terms of different units')
    quantities.derived[text] = None if kind == MIXED else kind
    statistics[text] = values


def kind_of(text, kinds, dimension):
    """Of stress, length and time the powers in the unit of an expression, or the
    name of the kind, or MIXED: what becomes of values by chance where all columns are
    those of a scene with units half as large."""
    chance = np.random.default_rng(1)
    columns = {name: chance.uniform(0.5, 2.0, 20) for name in ["t", *kinds]}
    values, found = expression.of_columns(text, columns), []
    for base in range(3):
        scaled = {
            name: columns[name] * 2.0 ** (powers(kind, dimension)[base] if kind else 0)
            for name, kind in kinds.items()
        }
        ratios = expression.of_columns(text, {**columns, **scaled}) / values
        ratios = ratios[np.isfinite(ratios)]
        if not len(ratios):
            return None
        if np.ptp(ratios) > 1e-9 * np.abs(ratios).max():
            return MIXED
        found.append(round(math.log2(abs(ratios[0])), 6))
    found = tuple(found)
    if not any(found):
        return None
    named = [k for k in KINDS if powers(k, dimension) == found]
    return named[0] if named else found
