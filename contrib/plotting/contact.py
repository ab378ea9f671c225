# SPDX-License-Identifier: LGPL-2.1-or-later
"""The contact face: traction, slip, and where it sticks.

In two dimensions curves over the arc length of each straight piece, in three
dimensions each plane as seen from the foundation.
"""

import itertools
import math

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from scipy.spatial import cKDTree

from . import style
from .body import draw_mesh, shaded, tiles
from .faces import friction_state, lines, planes, required, state_runs
from .geometry import thinned
from .layout import add_colour_bar

MOST_PIECES = 4


class Arrows:
    """How long arrows of slip are: the same in all planes and all frames.

    longest  the largest slip
    lengths  of its arrow in each plane, less than what is between two arrows
             on the finest mesh
    """

    def __init__(self):
        self.longest = 0.0
        self.lengths = []

    def extend(self, contact, body):
        """Take account of a face in three dimensions at one more time."""
        size = np.linalg.norm(contact["slip"], axis=1).max(initial=0.0)
        self.longest = max(self.longest, size)
        found = [length_of_arrows(plane) for plane in planes(contact, body)]
        pairs = itertools.zip_longest(self.lengths, found, fillvalue=np.inf)
        self.lengths = [min(pair) for pair in pairs]


class Scale:
    """Ranges that all frames of an animation share.

    largest  sizes of vectors, by name
    limits   in two dimensions (lowest, highest) of their tangential components
    arrows   those of the slip in three dimensions
    """

    def __init__(self, results, indices):
        self.arrows = Arrows()
        self.largest = {"traction": 0.0, "slip": 0.0, "slip_rate": 0.0}
        self.limits = {name: (0.0, 0.0) for name in self.largest}
        for index in indices:
            contact = required(results, index)
            for name in self.largest:
                if name in contact:
                    size = np.linalg.norm(contact[name], axis=1).max(initial=0.0)
                    self.largest[name] = max(self.largest[name], size)
            if contact.cells.shape[1] == 2:
                self.extend_limits(contact)
            else:
                self.arrows.extend(contact, results.body(index))

    def extend_limits(self, contact):
        for line in lines(contact):
            for name in self.largest:
                if name in contact:
                    values = line.component(contact[name])
                    if name == "traction":
                        bound = contact["bound"][line.nodes]
                        values = np.concatenate([values, bound, -bound])
                    low, high = self.limits[name]
                    self.limits[name] = min(low, values.min()), max(high, values.max())


def scale(results, indices, options):
    return Scale(results, indices)


def draw(results, index, options, scale):
    contact = required(results, index)
    heading = style.title(results.name, results.solution[index][0])
    if contact.cells.shape[1] == 2:
        figure, left_out = draw_lines(contact, scale)
    else:
        figure, left_out = draw_planes(contact, results.body(index), scale)
    if "stick" not in contact:
        heading += "   (no friction)"
    if left_out:
        heading += f"   (the {MOST_PIECES} largest of {MOST_PIECES + left_out} pieces)"
    figure.suptitle(heading, fontsize="large")
    return figure


# ------------------------------------------------------- two dimensions


def draw_lines(contact, scale):
    found = lines(contact)
    shown = found[:MOST_PIECES]
    friction = "traction" in contact
    n_rows = 3 if friction else 2
    columns = len(shown)
    figure, panels = plt.subplots(
        n_rows,
        columns,
        figsize=(max(8.0, 4.3 * columns), 2.3 * n_rows + 1.0),
        sharex="col",
        sharey="row",
        squeeze=False,
        layout="constrained",
    )
    for line, column in zip(shown, panels.T):
        if friction:
            draw_traction(column[0], contact, line)
        for axes, name in zip(column[-2:], ("slip", "slip_rate")):
            axes.plot(line.s, line.component(contact[name]), color=style.SERIES[0])
        for axes in column:
            axes.axhline(0.0, color="#aaaaaa", lw=0.6, zorder=0)
            axes.margins(x=0.0)
            if friction:
                mark_slipping(axes, contact, line)
        column[-1].set_xlabel(line.label())
    first = panels[:, 0]
    if friction:
        first[0].set_ylabel("tangential\n" r"traction $\tau$")
    first[-2].set_ylabel("slip since $t=0$\n" r"$s_\tau$")
    first[-1].set_ylabel("slip rate\n" r"$\dot{s}_\tau$")
    for axes, name in zip(first, ("traction", "slip", "slip_rate")[-n_rows:]):
        low, high = scale.limits[name]
        if high > low:
            axes.set_ylim(low - 0.08 * (high - low), high + 0.08 * (high - low))
    if friction:
        occurring = friction_state(contact)
        handles = [
            Line2D([], [], color=style.SERIES[0], label="traction on the body"),
            Line2D([], [], color="black", ls="--", lw=1.0, label=r"bound $\pm\rho$"),
            *(SHADES[state] for state in SHADES if (occurring == state).any()),
        ]
        panels[0, -1].legend(
            handles=handles,
            loc="lower right",
            bbox_to_anchor=(1.0, 1.02),
            borderaxespad=0.0,
            ncol=len(handles),
            frameon=False,
        )
    return figure, len(found) - len(shown)


def draw_traction(axes, contact, line):
    axes.plot(line.s, line.component(contact["traction"]), color=style.SERIES[0])
    bound = contact["bound"][line.nodes]
    for sign in (1.0, -1.0):
        axes.plot(line.s, sign * bound, color="black", ls="--", lw=1.0)


SHADES = {
    style.SLIPPING: Patch(facecolor=style.SLIP, alpha=0.2, label="slip"),
    style.STICKING: Patch(facecolor="white", edgecolor="black", lw=0.6, label="stick"),
    style.NO_FRICTION: Patch(
        facecolor=style.FRICTIONLESS, alpha=0.5, label="no friction"
    ),
}


def node_intervals(s):
    """Ends of the intervals that belong to nodes: half way to the next."""
    return np.concatenate([s[:1], 0.5 * (s[1:] + s[:-1]), s[-1:]])


def mark_slipping(axes, contact, line):
    """Shade what slips; a state belongs to a node and half its edges."""
    states = friction_state(contact)[line.nodes]
    ends = node_intervals(line.s)
    for state, first, last in state_runs(states):
        if state != style.STICKING:
            axes.axvspan(
                ends[first],
                ends[last + 1],
                color=style.STATE_COLOURS[state],
                alpha=SHADES[state].get_alpha(),
                lw=0,
                zorder=0,
            )


# ----------------------------------------------------- three dimensions


def draw_planes(contact, body, scale):
    found = planes(contact, body)
    shown = found[:MOST_PIECES]
    friction = "stick" in contact
    columns = 3 if friction else 1
    aspect = shown[0].aspect()
    if shown[0].is_flat():
        height = max(4.4 * aspect, 0.4) + 1.7
    else:
        height = min(3.6 * aspect, 5.0) + 1.1
    figure, panels = plt.subplots(
        len(shown),
        columns,
        figsize=(5.4 * columns if friction else 6.4, height * len(shown) + 0.5),
        squeeze=False,
        layout="constrained",
    )
    figure.get_layout_engine().set(wspace=0.06)
    slips = style.Shade([0.0, scale.largest["slip"] or 1.0], "slip")
    tractions = style.Shade([0.0, scale.largest["traction"] or 1.0], "traction")
    tractions.map = matplotlib.colormaps["cividis"]
    for plane, row, length in zip(shown, panels, scale.arrows.lengths):
        axes = row[0]
        values = np.linalg.norm(contact["slip"], axis=1)
        shaded(axes, plane.plane, plane.cells, values, slips)
        add_arrows(axes, plane, contact, scale.arrows.longest, length, "white")
        plane.prepare(axes)
        add_colour_bar(
            axes, slips.mappable(), r"slip since $t=0$ $|s_\tau|$", plane.is_flat()
        )
        axes.set_title(f"{plane.name()}, seen from the foundation", pad=10)
        if not friction:
            continue
        axes = row[1]
        values = np.linalg.norm(contact["traction"], axis=1)
        shaded(axes, plane.plane, plane.cells, values, tractions)
        plane.prepare(axes)
        add_colour_bar(
            axes,
            tractions.mappable(),
            r"tangential traction $|\sigma_\tau|$",
            plane.is_flat(),
        )
        axes = row[2]
        states = draw_states(axes, plane, contact)
        plane.prepare(axes)
        style.legend_above(axes, style.state_legend(states))
    return figure, len(found) - len(shown)


def draw_states(axes, plane, contact):
    """Each node colours the quarters of the faces that it belongs to."""
    states = friction_state(contact)
    corners = plane.plane[plane.cells]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    centres = corners.mean(axis=1)
    for i in range(4):
        quarters = np.stack(
            [corners[:, i], middles[:, i], centres, middles[:, i - 1]], axis=1
        )
        colours = [style.STATE_COLOURS[state] for state in states[plane.cells[:, i]]]
        tiles(axes, quarters, facecolors=colours)
    draw_mesh(axes, plane.plane, plane.cells, plane.vertex(), (0, 0, 0, 0.5))
    return states[np.unique(plane.cells)]


def nodes_with_arrows(plane):
    """Some nodes: arrows at every one of a fine mesh would be a black mass."""
    nodes = one_of_each(plane)
    extent = np.ptp(plane.plane[nodes], axis=0).max()
    return thinned(plane.plane, nodes, extent / 14.0), extent


def length_of_arrows(plane):
    """Of the longest, in the units of the plane: no arrow reaches the next."""
    chosen, extent = nodes_with_arrows(plane)
    spacing = extent / 14.0
    if len(chosen) > 1:
        place = plane.plane[chosen]
        spacing = cKDTree(place).query(place, k=2)[0][:, 1].min()
    return min(spacing, extent / 8.0)


def add_arrows(axes, plane, contact, longest, length, colour):
    """Arrows of the slip at some nodes; one of `longest` has that length."""
    if longest <= 0.0:
        return None
    chosen, _ = nodes_with_arrows(plane)
    slip = plane.project(contact["slip"])
    chosen = chosen[np.linalg.norm(slip[chosen], axis=1) > 0.02 * longest]
    arrows = axes.quiver(
        *plane.plane[chosen].T,
        *slip[chosen].T,
        angles="xy",
        scale_units="xy",
        scale=longest / length,
        color=colour,
        width=0.006,
        zorder=4,
    )
    return arrows


def one_of_each(plane):
    """One copy of each node of the plane."""
    used = np.unique(plane.cells)
    _, first = np.unique(plane.vertex()[used], return_index=True)
    return used[first]


def draw_utilisation(axes, plane, contact, longest, length):
    """The panel of the overview: utilisation, slipping nodes, slip.

    longest, length  the largest slip of all, and how long its arrow is
    """
    utilisation = contact["utilisation"]
    faces = tiles(
        axes,
        plane.plane[plane.cells],
        array=utilisation[plane.cells].mean(axis=1),
        cmap=matplotlib.colormaps["cividis"],
        norm=Normalize(0.0, 1.0),
    )
    draw_mesh(axes, plane.plane, plane.cells, plane.vertex())
    nodes = one_of_each(plane)
    slipping = nodes[friction_state(contact)[nodes] == style.SLIPPING]
    axes.plot(
        *plane.plane[slipping].T,
        ls="none",
        marker="o",
        ms=float(np.clip(60.0 / math.sqrt(max(len(nodes), 1)), 1.0, 4.0)),
        color=style.SLIP,
        mec="none",
    )
    arrows = add_arrows(axes, plane, contact, longest, length, "black")
    if arrows is not None:
        axes.quiverkey(
            arrows,
            0.94,
            1.05,
            longest,
            f"slip, at most {style.short(longest)}",
            labelpos="W",
            fontproperties={"size": "small"},
        )
    plane.prepare(axes)
    add_colour_bar(axes, faces, "utilisation of the bound", plane.is_flat())
