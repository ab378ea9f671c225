# SPDX-License-Identifier: LGPL-2.1-or-later
"""Numbers and tables for people."""

from math import isfinite


def digits(value, n=3):
    """A number with n significant digits, as in 0.0123 or 1.2e-05; large ones with
    all digits before the point."""
    # 1.2e+05 is for programs.
    if 10.0**n - 0.5 <= abs(value) < 1e9:
        return str(round(value))
    return f"{value:.{n}g}"


def number_or_dash(value, n=3):
    return digits(value, n) if isfinite(value) else "-"


def seconds_in_words(seconds):
    """Small ones with two digits."""
    if seconds < 100.0:
        return digits(seconds, 2) + " s"
    if seconds < 6000.0:
        return f"{seconds / 60.0:.0f} min"
    if seconds < 172800.0:
        return f"{seconds / 3600.0:.1f} h"
    return f"{seconds / 86400.0:.1f} d"


def exact(value):
    """A number as a text that gives the same number."""
    return f"{value:.17g}"


def table_row(cells):
    return "".join(["|", *(f" {cell} |" for cell in cells), "\n"])


def table_head(cells):
    return table_row(cells) + table_row(["---"] * len(cells))
