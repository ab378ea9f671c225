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
    size, limit = unit.size, None
    if is_share:
        # Per cent of the largest value of another column.
        size = max(history.finite(statistics[panel.share_of]).max(), 1e-300) / 100.0
    if panel in ERRORS:
        limit = tolerance(results, panel, size)
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


def tolerance(results, panel, size):
    """The line that the error had to stay below, in the unit of the panel, if the
    scene has set one."""
    try:
        value = float(results.data.get(("Error control", "Tolerance"), 0.0))
    except ValueError:
        return None
    of_quantity = "estimated_error_of_quantity" in info(results)
    if not value > 0.0 or of_quantity != (panel is history.QUANTITY):
        return None
    if panel is history.ERROR:
        return 100.0 * value
    return value * info(results)["estimated_error_of_quantity"]["largest_value"] / size


def info(results):
    """run.json, or nothing where it is missing."""
    if not (results.directory / "run.json").exists():
        return {}
    about = results.info
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
