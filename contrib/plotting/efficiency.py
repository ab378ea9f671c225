# SPDX-License-Identifier: LGPL-2.1-or-later
"""Estimated over true errors of the cells, where the exact solution is known."""

import matplotlib.pyplot as plt
import numpy as np

from . import style
from .results import NoPicture

ESTIMATES = {
    "estimator": (r"residuals, $C\,\eta_K$", style.SERIES[0], "o"),
    "recovery": (r"recovered strain", style.SERIES[1], "x"),
}


def draw(results, options):
    index = results.index(options.step, options.time)
    time = results.solution[index][0]
    body = results.body(index)
    if "error_energy" not in body:
        raise NoPicture("there is no exact solution, so no true error of cells")
    true = of_cells(body, "error_energy")
    figure, axes = plt.subplots(figsize=(6.6, 6.0), layout="constrained")
    values = [true]
    for name, (label, colour, marker) in ESTIMATES.items():
        # With a quantity of interest cells are estimated by what they do to it.
        of_quantity = "quantity_total" in results.statistics
        if name not in body or (name == "estimator" and of_quantity):
            continue
        estimated = of_cells(body, name)
        if name == "estimator":
            estimated = estimated * constant(results, time)
        values.append(estimated)
        quotient = np.linalg.norm(estimated) / np.linalg.norm(true)
        axes.plot(
            true,
            estimated,
            marker,
            ms=4,
            mfc="none",
            mew=0.8,
            alpha=0.6,
            color=colour,
            label=f"{label}: {quotient:.3g} times the error of all cells",
        )
    known = np.concatenate(values)
    known = known[known > 1e-12 * known.max(initial=0.0)]
    if not len(known):
        raise NoPicture(f"at t = {time:g} there are no errors")
    ends = np.array([known.min(), known.max()])
    axes.plot(ends, ends, color=style.OUTLINE, lw=1)
    for factor in (0.2, 5.0):
        axes.plot(ends, factor * ends, color=style.OUTLINE, lw=0.7, ls=(0, (5, 3)))
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(*ends * (0.7, 1.4))
    axes.set_ylim(*ends * (0.7, 1.4))
    axes.set_xlabel(r"true error of a cell in the energy norm")
    axes.set_ylabel("estimated error of the cell (dashed: a factor of five)")
    axes.legend(loc="upper left", fontsize=9)
    axes.set_title(f"{style.plain(results.name)}   t = {time:.4g}")
    return figure


def of_cells(body, name):
    """Fields of cells have the same value at all of their points."""
    return body[name][body.cells[:, 0]]


def constant(results, time):
    """C of the residual estimator, by the statistics of that step."""
    statistics = results.statistics
    for name in ("t", "estimator", "estimate_space"):
        if name not in statistics:
            return 1.0
    row = int(np.abs(statistics["t"] - time).argmin())
    return statistics["estimate_space"][row] / statistics["estimator"][row]
