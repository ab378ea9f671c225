# SPDX-License-Identifier: LGPL-2.1-or-later
"""Estimated over true errors of the cells, where the exact solution is known."""

import matplotlib.pyplot as plt
import numpy as np

from . import style
from .results import NoPicture
from .units import Units

ESTIMATES = {
    "estimator": ("estimate", style.SERIES[0]),
    "recovery": (r"recovered strain", style.SERIES[1]),
}
MOST_POINTS = 2000  # of an estimate; of more cells some are drawn


def draw(results, options):
    index = results.index(options.step, options.time)
    time = results.solution[index][0]
    body = results.body(index)
    if "error_energy" not in body:
        raise NoPicture("there is no exact solution, so no true error of cells")
    true = of_cells(body, "error_energy")
    figure, axes = plt.subplots(figsize=(6.6, 6.0), layout="constrained")
    values = [true]
    # Ordered by place, every n-th cell would be a pattern.
    order = np.random.default_rng(0).permutation(len(true))[:MOST_POINTS]
    for name, (label, color) in ESTIMATES.items():
        # With a quantity of interest cells are estimated by what they do to it.
        of_quantity = "quantity_total" in results.statistics
        if name not in body or (name == "estimator" and of_quantity):
            continue
        estimated = of_cells(body, name)
        values.append(estimated)
        quotient = np.linalg.norm(estimated) / np.linalg.norm(true)
        axes.plot(
            true[order],
            estimated[order],
            "o",
            ms=2.5,
            mec="none",
            alpha=0.5,
            color=color,
            label=f"{label}: {quotient:.3g} times the error of all cells",
        )
    known = np.concatenate(values)
    known = known[known > 1e-12 * known.max(initial=0.0)]
    if not len(known):
        raise NoPicture(f"at t = {time:g} there are no errors")
    ends = np.array([known.min(), known.max()])
    axes.plot(ends, ends, color=style.OUTLINE, lw=1)
    for factor, label in ((0.2, "a factor of five"), (5.0, None)):
        look = {"color": style.OUTLINE, "lw": 0.8, "ls": (0, (5, 3))}
        axes.plot(ends, factor * ends, label=label, **look)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(*ends * (0.7, 1.4))
    axes.set_ylim(*ends * (0.7, 1.4))
    units = Units.of(results)
    unit = units.unit("energy norm", known)
    axes.set_xlabel(unit.label("true error of a cell in the energy norm"))
    axes.set_ylabel(unit.label("estimated error of the cell"))
    axes.legend(loc="lower right", fontsize="small")
    for axis in axes.xaxis, axes.yaxis:
        style.numbers_on_logarithmic_axis(axis, 1.0 / unit.size)
    time = units.unit("time", [t for t, _ in results.solution]).value(time)
    what = "estimated and true errors of the cells"
    figure.suptitle(style.title(results.name, what, time), fontsize="large")
    return figure


def of_cells(body, name):
    """Fields of cells have the same value at all of their points."""
    return body[name][body.cells[:, 0]]
