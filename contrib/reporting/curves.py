# SPDX-License-Identifier: LGPL-2.1-or-later
"""The panels of `contrib/plot history` as numbers for curves.js."""

import math

import numpy as np

from plotting import history, style
from plotting.units import Units

from .markup import formula

MOST_ROWS = 1500
ERRORS = (history.ERROR, history.QUANTITY)


def curves(results):
    """{"time": ..., "panels": [...]}, and how many rows of the statistics it shows;
    None where there is but one time."""
    statistics = results.statistics
    if len(statistics.get("t", ())) < 2:
        return None
    units = Units.of(results)
    rows = some_rows(len(statistics["t"]))
    time = units.unit("time", statistics["t"])
    panels = [
        panel_data(results, panel, names, units, rows)
        for panel, names in history.those_with_something(history.PANELS, statistics)
    ]
    return {
        "time": {
            "label": formula(time.label("time $t$")),
            "size": time.size,
            "values": numbers(statistics["t"][rows], time.size),
        },
        "panels": sorted(panels, key=lambda panel: not panel["isError"]),
        "rows": [len(rows), len(statistics["t"])],
    }


def some_rows(n):
    return np.unique(np.linspace(0, n - 1, min(n, MOST_ROWS)).round().astype(int))


def panel_data(results, panel, names, units, rows):
    statistics = results.statistics
    unit = history.unit_of(panel, names, statistics, units)
    is_share = panel.share_of in statistics
    size, limit = unit.size, history.tolerance(results, panel)
    if is_share:
        # Per cent of the largest value of another column.
        size = max(history.finite(statistics[panel.share_of]).max(), 1e-300) / 100.0
    if panel is history.QUANTITY and limit is not None:
        limit = limit / size if math.isfinite(limit) else None
    return {
        "title": formula(panel.label.replace("\n", " ")),
        "unit": formula(unit.text),
        "logarithmic": panel.logarithmic,
        "steps": panel.steps,
        "isError": panel in ERRORS,
        "limit": limit,
        "lines": [
            {
                "name": formula(history.label(name)),
                "column": name,
                "color": style.SERIES[i % 7],
                "values": numbers(statistics[name][rows], size, panel.logarithmic),
            }
            for i, name in enumerate(names)
        ],
    }


def info(results):
    """run.json, or nothing where it is missing."""
    about = results.about()
    for key in ("estimated_error", "estimated_error_of_quantity"):
        errors = about.get(key, {})
        for part, value in errors.items():
            if value is None:  # of what is not finite
                errors[part] = math.nan
    return about


def numbers(values, size, is_logarithmic=False):
    """Six digits of each, None for what cannot be drawn."""
    good = np.isfinite(values)
    if is_logarithmic:
        good &= values > 0.0
    return [
        float(f"{value / size:.6g}") if fine else None
        for value, fine in zip(values.tolist(), good.tolist())
    ]
