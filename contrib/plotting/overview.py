# SPDX-License-Identifier: LGPL-2.1-or-later
"""The body, the contact face and the friction force in one picture."""

import matplotlib.pyplot as plt
import numpy as np

from . import quantities, style
from .body import Body2D, make_body
from .body_base import Scale
from .contact import Arrows, draw_utilisation, named_plane
from .faces import planes
from .history import is_rounding
from .layout import cell, fit_rows
from .units import Unit, show

MOST_PLANES = 2


def scale(results, indices, options):
    """That of the body, and of the arrows on the contact face if there are any."""
    found = Scale(results, indices, "von_mises", options)
    found.arrows = Arrows()
    if results.dimension() == 3:
        for index in indices:
            contact = results.face(index)
            if has_friction(contact):
                found.arrows.extend(contact, results.body(index))
    return found


def has_friction(contact):
    return contact is not None and "stick" in contact


def draw(results, index, options, scale):
    body = make_body(results, index, scale)
    heading = body.heading()
    curve = None
    if has_force_curve(results.statistics):
        curve = results.statistics, body
    if isinstance(body, Body2D):
        return draw_2d(body, heading, curve)
    return draw_3d(body, heading, curve, options.view)


def draw_2d(body, heading, curve):
    figure, grid = begin(8.5, heading, curve)
    axes = figure.add_subplot(grid[0])
    body.draw(axes)
    fit_rows(grid, axes, lambda size: body.panel_height(size[0]))
    return figure


def draw_3d(body, heading, curve, view):
    found = []
    if has_friction(body.contact):
        found = planes(body.contact, body.body)
    shown = found[:MOST_PLANES]
    figure, grid = begin(
        12.0 if shown else 8.5, heading, curve, (1.15, 1.0) if shown else (1.0,)
    )
    panel = body.add_panel(figure, grid[0, 0], view)
    faces = []
    if shown:
        column = grid[0, 1].subgridspec(
            len(shown),
            1,
            hspace=0.15,  # for the keys of the arrows
            height_ratios=[plane.aspect() for plane in shown],
        )
        arrows = body.scale.arrows
        for plane, place, length in zip(shown, column, arrows.lengths):
            faces.append(figure.add_subplot(place))
            draw_utilisation(faces[-1], plane, body, arrows.longest, length)
        scale = body.scale
        title = f"Contact face {named_plane(shown[0], scale.supports, scale.length)}"
        if len(found) > len(shown):
            title = f"Contact faces (the {len(shown)} largest of {len(found)})"
        elif len(shown) > 1:
            title = "Contact faces"
        faces[0].set_title(f"{title}, {shown[0].view()}; dots: slip", pad=24)

    def needed(size):
        cells = [cell(axes) for axes in faces]
        around = size[1] - sum(height for _, height in cells)
        heights = [width * plane.aspect() for (width, _), plane in zip(cells, shown)]
        return max(body.panel_height(size[0], view), around + min(sum(heights), 5.5))

    fit_rows(grid, panel, needed)
    body.fill_panel(panel, view)
    return figure


def begin(width, heading, curve, columns=(1.0,)):
    """A figure with a grid for panels, above the friction force if there is any."""
    figure = plt.figure(figsize=(width, 8.0), layout="constrained")
    figure.suptitle(heading, fontsize="large")
    heights = (4.0, 1.6) if curve else (4.0,)
    grid = figure.add_gridspec(
        len(heights), len(columns), width_ratios=columns, height_ratios=heights
    )
    if curve:
        draw_force_curve(figure.add_subplot(grid[1, :]), *curve)
    return figure, grid


def has_force_curve(statistics):
    forces = forces_of("friction", statistics), forces_of("contact", statistics)
    return len(statistics.get("t", ())) > 1 and any(
        force.any() for kind in forces for force in kind.values()
    )


def forces_of(kind, statistics):
    """By axis the components of the friction or contact force."""
    return {
        axis: statistics[f"{kind}_force_{axis}"]
        for axis in "xyz"
        if f"{kind}_force_{axis}" in statistics
    }


def draw_force_curve(axes, statistics, body):
    times, units = statistics["t"], body.scale.units
    kind, forces = "friction", forces_of("friction", statistics)
    pressed = forces_of("contact", statistics)
    largest = max(np.abs(force).max(initial=0.0) for force in forces.values())
    if pressed and (
        largest == 0.0
        or is_rounding("friction_force", largest, statistics)
        or (quantities.of_interest or "").startswith("contact_force")
    ):
        kind, forces = "contact", pressed
        largest = max(np.abs(force).max(initial=0.0) for force in forces.values())
    # Around an axis radial forces balance each other; their sum is that of sizes.
    words = {axis: f"force, ${axis}$" for axis in "xyz"}
    if body.scale.of_revolution:
        words = {"x": "radial force, added up around the axis", "y": "along the axis"}
    for component, force in forces.items():
        # The component along a face's normal is zero all the time.
        if np.abs(force).max(initial=0.0) > 1e-9 * largest:
            axes.plot(
                times,
                force,
                color=style.COMPONENT[component],
                ls=style.DASHES[component],
                label=words[component],
                marker="." if len(times) < 12 else None,
            )
    axes.axvline(body.time, color="black", lw=0.9, ls=":")
    axes.axhline(0.0, color="#aaaaaa", lw=0.6, zorder=0)
    show(axes.xaxis, "time $t$", units.unit("time", times))
    unit = units.unit("force", largest)
    show(axes.yaxis, f"{kind} force\nexerted by the body", unit)
    axes.margins(x=0.01)
    # A number beside the ends of the curve, where one is near.
    low, high = axes.get_ylim()
    near = 0.12 * (high - low)
    ticks = axes.yaxis.get_major_locator().tick_values(low, high)
    ticks = [tick for tick in ticks if low - near < tick < high + near]
    axes.set_ylim(min([low, *ticks]), max([high, *ticks]))

    handles = axes.get_legend_handles_labels()[0]
    has_areas = "stick_area" in statistics and "slip_area" in statistics
    if kind == "friction" and has_areas:
        slip = statistics["slip_area"]
        total = statistics["stick_area"] + slip
        moves = statistics["max_slip"] > body.rest * statistics["k"]
        share = np.divide(
            slip, total, out=np.zeros_like(slip), where=moves & (total > 0.0)
        )
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
        show(other.yaxis, "slipping share of\nwhat touches", Unit(0.01, "%"))
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
