# SPDX-License-Identifier: LGPL-2.1-or-later
"""The error over mesh width and time step, with observed orders."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from . import rates, style
from .results import NoPicture
from .study import MOST, TOLERANCE, error_label

# What is refined along each axis; "both" belongs to both.
AXES = {
    "h": ("space", "mesh width $h$"),
    "k": ("time", "time step $k$"),
}
FIT = "fit, where it is within 10 %"
FLAT = 0.2  # an order below says that the error is that of something else
ALONE = {"lw": 1.7, "marker": "o"}
BOTH = {"lw": 1.0, "marker": "s", "mfc": "white"}


def draw(study, error, variants=None):
    variants = variants or study.groups(error)[0]
    panels = []
    for axis, (alone, label) in AXES.items():
        ladders = [
            ladder
            for ladder in study.ladders()
            if ladder.variant in variants
            and ladder.name in (alone, "both")
            # steps to a tolerance are of all sizes
            and (axis == "h" or ladder.variant[0] != TOLERANCE)
            and rates.known(ladder.sizes(axis), study[error][ladder.rows]).any()
        ]
        if len(ladders) > MOST:  # one each
            only = {l.variant for l in ladders if l.name == alone}
            ladders = [l for l in ladders if l.name == alone or l.variant not in only]
        if ladders:
            panels.append((axis, label, ladders))
    if not panels:
        raise NoPicture(f"no run of {study.directory} has a known {error}")
    figure, all_axes = plt.subplots(
        1,
        len(panels),
        figsize=(5.9 * len(panels) + 0.6, 4.9 + 0.22 * len(variants)),
        sharey=True,
        squeeze=False,
        layout="constrained",
    )
    least = study.error_of_reference(error) or 0.0
    for axes, (axis, label, ladders) in zip(all_axes[0], panels):
        draw_panel(axes, study, error, axis, ladders, variants, least)
        if axis == "k" and study.chooses_steps():
            label = rf"tolerance of the steps, ${study.step_symbol()}$"
        axes.set_xlabel(label)
    for axes in all_axes[0]:
        mark_reference(axes, study.error_of_reference(error))
        style.numbers_on_logarithmic_axis(axes.xaxis)
        style.numbers_on_logarithmic_axis(axes.yaxis, 100)
    all_axes[0, 0].set_ylabel(f"{error_label(error)} [%]")
    figure.suptitle(study.title("convergence", variants), fontsize="large")
    return figure


def mark_reference(axes, error, side="right"):
    """Gray where differences to the reference say more of its own error."""
    low, high = axes.get_ylim()
    if error is None or error <= low:
        return
    axes.axhspan(low, error, color="#e4e4e4", zorder=0.5, lw=0)
    axes.annotate(
        "below the estimated error of the reference",
        (0.98 if side == "right" else 0.02, error),
        (0, -3),
        xycoords=axes.get_yaxis_transform(),
        textcoords="offset points",
        ha=side,
        va="top",
        fontsize=8.5,
        color="#444444",
    )
    axes.set_ylim(low, high)


def curve(study, error, axis, ladder):
    """Sizes and errors of the runs of a ladder whose error is known."""
    sizes, errors = ladder.sizes(axis), study[error][ladder.rows]
    usable = rates.known(sizes, errors)
    return sizes[usable], errors[usable], ladder.rows[usable]


def draw_panel(axes, study, error, axis, ladders, variants, least):
    """Orders are those of errors above that of the reference, `least'."""
    curves, orders, fitted = [], {}, False
    looks = study.looks(variants)
    for ladder in ladders:
        sizes, errors, rows = curve(study, error, axis, ladder)
        look = looks[ladder.variant]
        kind = BOTH if ladder.name == "both" else ALONE
        axes.plot(sizes, errors, ms=6, **look, **kind)
        fit = study.fit(ladder.variant, error)
        if fit:
            good = rates.fits(fit, study["h"][rows], study["k"][rows], errors)
            # The finest runs in a row that it fits.
            rows = rows[np.logical_and.accumulate(good[::-1])[::-1]]
            if len(rows) > 1:
                draw_fit(axes, fit, axis, study, rows, look["color"])
                fitted = True
        curves.append((sizes, errors))
        known = errors > least
        order = rates.final_order(sizes[known], errors[known])
        if order is not None and order < FLAT:
            order = None
        orders.setdefault(ladder.variant, {})[ladder.name] = order
    axes.set_xscale("log")
    axes.set_yscale("log")
    draw_triangles(axes, curves, least)
    legend(axes, study, ladders, orders, fitted, looks)
    axes.grid(True, which="major", color="#dddddd", lw=0.6)
    axes.set_axisbelow(True)
    axes.margins(0.08)


def draw_fit(axes, fit, axis, study, rows, color):
    """The fit between the coarsest and the finest run, at their h and k."""
    share = np.linspace(0.0, 1.0, 60)
    h, k = (
        np.exp(np.interp(share * (len(rows) - 1), range(len(rows)), np.log(sizes)))
        for sizes in (study["h"][rows], study.step_sizes()[rows])
    )
    axes.plot(
        h if axis == "h" else k,
        rates.predicted_error(fit, h, k),
        color=color,
        ls=":",
        lw=2.2,
        alpha=0.65,
        zorder=1.5,
    )


def draw_triangles(axes, curves, least):
    """The order at the fine end of the lowest curve that falls, and of the highest
    where it differs."""
    known = [(sizes[errors > least], errors[errors > least]) for sizes, errors in curves]
    segments = [
        list(zip(sizes[-2:], errors[-2:]))
        for sizes, errors in known
        if len(sizes) > 1
        and rates.differ(sizes[-1], sizes[-2])
        and (rates.final_order(sizes, errors) or 0.0) >= FLAT
    ]
    if not segments:
        return
    lowest = min(segments, key=lambda segment: segment[-1][1])
    highest = max(segments, key=lambda segment: segment[-1][1])
    _, order = draw_triangle(axes, lowest, curves, above=False)
    other = rates.slope_triangle(highest, curves, above=True)[1]
    if highest is not lowest and abs(other - order) > 0.1:
        draw_triangle(axes, highest, curves, above=True)


def order_text(order):
    return f"{round(order, 2) + 0.0:.2f}"  # no -0.00


def draw_triangle(axes, segment, curves, above):
    corners, order = rates.slope_triangle(segment, curves, above)
    axes.fill(*corners.T, facecolor="#eeeeee", edgecolor="#444444", lw=0.9)
    (x0, y0), (x1, y1), (xr, yr) = corners
    middle = np.sqrt(x0 * x1), np.sqrt(y0 * y1)
    small = {"fontsize": 8.5, "color": "#222222", "textcoords": "offset points"}
    right, up = xr == x1, yr == max(y0, y1)
    axes.annotate(
        "1",
        (middle[0], yr),
        (0, 3 if up else -3),
        ha="center",
        va="bottom" if up else "top",
        **small,
    )
    axes.annotate(
        order_text(order),
        (xr, middle[1]),
        (3 if right else -3, 0),
        ha="left" if right else "right",
        va="center",
        **small,
    )
    # Room for the numbers, which autoscaling does not see.
    axes.plot([x0, x1], [min(y0, y1) / 1.3, max(y0, y1) * 1.3], ls="none")
    return corners, order


def legend(axes, study, ladders, orders, fitted, looks):
    """Below the panel: a line for each variant with its orders, then the looks."""
    handles = []
    for variant, found in orders.items():
        texts = [
            f"{order_text(order)} ({study.ladder_label(name)})"
            for name, order in found.items()
            if order is not None
        ]
        text = study.variant_label(variant)
        if texts:
            text += ": order " + ", ".join(texts)
        handles.append(Line2D([], [], lw=2.5, label=text, **looks[variant]))
    names = list(dict.fromkeys(ladder.name for ladder in ladders))
    for name in names:
        kind = BOTH if name == "both" else ALONE
        text = study.ladder_label(name) + fixed_size(study, ladders, name)
        handles.append(
            Line2D([], [], color=style.OUTLINE, ms=6, label=text, **kind)
        )
    if fitted:
        handles.append(
            Line2D([], [], color=style.OUTLINE, ls=":", lw=2.2, label=FIT)
        )
    axes.legend(
        handles=handles,
        loc="upper center",
        bbox_to_anchor=(0.5, -0.15),
        frameon=False,
        fontsize=8.5,
        handlelength=2.4,
        labelspacing=0.3,
    )


def fixed_size(study, ladders, name):
    """The size that a ladder keeps, if all of that name keep the same."""
    axis = {"space": "k", "time": "h"}.get(name)
    if axis is None:
        return ""
    sizes = np.concatenate(
        [ladder.sizes(axis) for ladder in ladders if ladder.name == name]
    )
    if np.ptp(sizes) > 1e-9 * sizes.max():
        return ""
    symbol = study.step_symbol() if axis == "k" else axis
    return f", ${symbol}$ = {style.short(sizes[0])}"
