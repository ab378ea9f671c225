# SPDX-License-Identifier: LGPL-2.1-or-later
"""The body, the contact face and the friction force in one picture."""

import matplotlib.pyplot as plt
import numpy as np

from . import style
from .body import Body2D, Body3D, Scale, make_body
from .contact import draw_utilisation
from .faces import planes

MOST_PLANES = 2


def scale(results, indices, options):
    return Scale(results, indices, "von_mises", options.magnification)


def draw(results, index, options, scale):
    body = make_body(results, index, scale)
    time = results.solution[index][0]
    curve = has_force_curve(results.statistics)
    if isinstance(body, Body2D):
        figure, axes, curve_axes = draw_2d(body, curve)
    else:
        figure, axes, curve_axes = draw_3d(body, curve, options.view)
    if curve:
        draw_force_curve(curve_axes, results.statistics, time)
    heading = style.title(results.name, time, body.magnification)
    figure.suptitle(heading, fontsize="large")
    if isinstance(body, Body3D):
        body.fill_panel(axes, options.view)
    return figure


def draw_2d(body, curve):
    height = float(np.clip(6.2 * body.aspect(), 2.2, 7.5))
    figure = plt.figure(
        figsize=(8.5, height + 1.2 + (2.1 if curve else 0.0)), layout="constrained"
    )
    grid = figure.add_gridspec(
        2 if curve else 1, 1, height_ratios=(height + 0.9, 1.6) if curve else (1,)
    )
    axes = figure.add_subplot(grid[0])
    body.draw(axes)
    body.colour_bar(figure, cax=style.beside(axes))
    return figure, axes, figure.add_subplot(grid[1]) if curve else None


def draw_3d(body, curve, view):
    found = []
    if body.contact is not None and "stick" in body.contact:
        found = planes(body.contact, body.body)
    shown = found[:MOST_PLANES]
    height = max(body.panel_height(5.2 if shown else 6.4, view), 3.3 * len(shown))
    figure = plt.figure(
        figsize=(
            12.0 if shown else 8.0,
            height + 0.5 + (2.2 if curve else 0.0),
        ),
        layout="constrained",
    )
    grid = figure.add_gridspec(
        2 if curve else 1,
        2 if shown else 1,
        width_ratios=(1.15, 1.0) if shown else (1,),
        height_ratios=(height, 1.7) if curve else (1,),
    )
    body_axes = figure.add_subplot(grid[0, 0], projection="3d", computed_zorder=False)
    body.colour_bar(
        figure, ax=body_axes, location="left", shrink=0.75, pad=0.02, aspect=28
    )
    body.draw(body_axes, view)
    if shown:
        panels = grid[0, 1].subgridspec(len(shown), 1, hspace=0.15)
        for i, plane in enumerate(shown):
            axes = figure.add_subplot(panels[i])
            draw_utilisation(figure, axes, plane, body.contact)
            if i == 0:
                title = "Contact face" if len(found) == 1 else "Contact faces"
                if len(found) > len(shown):
                    title += f" (the {len(shown)} largest of {len(found)})"
                title += " seen from the foundation, slipping nodes marked"
                axes.set_title(title, pad=24)
    return figure, body_axes, figure.add_subplot(grid[1, :]) if curve else None


def has_force_curve(statistics):
    return len(statistics.get("t", ())) > 1 and any(
        name.startswith("friction_force_") for name in statistics
    )


def draw_force_curve(axes, statistics, time):
    times = statistics["t"]
    forces = {
        axis: statistics[f"friction_force_{axis}"]
        for axis in "xyz"
        if f"friction_force_{axis}" in statistics
    }
    largest = max(np.abs(force).max(initial=0.0) for force in forces.values())
    for component, force in forces.items():
        # The component along a face's normal is zero all the time.
        if np.abs(force).max(initial=0.0) > 1e-9 * largest:
            axes.plot(
                times,
                force,
                color=style.COMPONENT[component],
                ls=style.DASHES[component],
                label=f"force ${component}$",
                marker="." if len(times) < 12 else None,
            )
    axes.axvline(time, color="black", lw=0.9, ls=":")
    axes.axhline(0.0, color="#aaaaaa", lw=0.6, zorder=0)
    axes.set_xlabel("time $t$")
    axes.set_ylabel("friction force\non the foundation")
    axes.margins(x=0.01)

    handles = axes.get_legend_handles_labels()[0]
    if "stick_area" in statistics and "slip_area" in statistics:
        slip = statistics["slip_area"]
        total = statistics["stick_area"] + slip
        share = np.divide(slip, total, out=np.zeros_like(slip), where=total > 0.0)
        other = axes.twinx()
        handles.append(
            other.fill_between(
                times,
                share,
                color=style.SLIP,
                alpha=0.2,
                lw=0,
                step="pre",
                label="slipping share",
            )
        )
        other.set_ylim(0.0, 1.05)
        other.set_ylabel("slipping share\nof the face")
        axes.set_zorder(other.get_zorder() + 1)
        axes.patch.set_visible(False)
    axes.legend(
        handles=handles,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncol=max(len(handles), 1),
        frameon=False,
        borderaxespad=0.1,
    )
