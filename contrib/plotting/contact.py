# SPDX-License-Identifier: LGPL-2.1-or-later
"""The contact face: pressure, gap, traction, slip, and where it sticks.

In two dimensions curves over the arc length of each straight piece, in three
dimensions each plane as seen from the foundation.
"""

import itertools
import math

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.transforms import offset_copy
from scipy.spatial import cKDTree

from . import style
from .body import draw_mesh, shaded, tiles
from .faces import friction_state, is_unilateral, lines, planes, required, state_runs
from .geometry import thinned
from .layout import add_color_bar
from .results import UserError
from .supports import MOTION, Supports
from .units import Unit, Units, show

MOST_PIECES = 4
# White where the body touches.
COLORS = {"traction": "cividis", "contact_pressure": "cividis", "gap": "YlGnBu"}


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

    shades   colors of sizes of vectors and of numbers in three dimensions, by name
    limits   in two dimensions (lowest, highest) of their tangential components that
             axes show, and `extremes' those of all
    arrows   those of the slip in three dimensions
    units    of the numbers
    """

    KINDS = {
        "contact_pressure": "stress",
        "gap": "length",
        "traction": "stress",
        "slip": "length",
        "slip_rate": "velocity",
    }

    def __init__(self, results, indices):
        self.units = Units.of(results)
        self.time = self.units.unit("time", [time for time, _ in results.solution])
        bodies = [results.body(index).points for index in indices]
        self.length = self.units.unit("length", np.concatenate(bodies))
        self.supports = Supports(results, self.units) if results.boundary() else None
        self.arrows = Arrows()
        self.values = {name: [np.zeros(1)] for name in self.KINDS}
        self.displacement = 0.0
        for index in indices:
            contact = required(results, index)
            moved = sizes(contact["displacement"]).max(initial=0.0)
            self.displacement = max(self.displacement, moved)
            if contact.cells.shape[1] == 2:
                self.extend_lines(contact)
            else:
                self.arrows.extend(contact, results.body(index))
                for name in self.values:
                    if name in contact:
                        self.values[name].append(sizes(contact[name]))
        self.limits, self.extremes, self.shades = {}, {}, {}
        for name, values in self.values.items():
            values = np.concatenate(values)
            self.extremes[name] = values.min(), values.max()
            # A corner must not flatten the rest.
            low, high = (
                style.robust(side, **style.FEW)[0] for side in (-values, values)
            )
            self.limits[name] = -low, high
            self.shades[name] = style.Shade(values, name, **style.FEW)
            self.shades[name].map = matplotlib.colormaps[COLORS.get(name, "viridis")]

    def has_gap(self):
        """Whether there is one beside the rounding of displacements."""
        return self.extremes["gap"][1] > 1e-9 * self.displacement

    def unit(self, name):
        return self.units.unit(self.KINDS[name], self.limits[name])

    def extend_lines(self, contact):
        for line in lines(contact):
            for name in self.values:
                if name in contact:
                    self.values[name].append(along(line, contact[name]))
                    if name == "traction":
                        bound = contact["bound"][line.nodes]
                        self.values[name] += [bound, -bound]


def sizes(values):
    """Of vectors their lengths."""
    return values if values.ndim == 1 else np.linalg.norm(values, axis=1)


def along(line, values):
    """What a piece has of a field: numbers, or the component along it."""
    return values[line.nodes] if values.ndim == 1 else line.component(values)


def scale(results, indices, options):
    return Scale(results, indices)


def draw(results, index, options, scale):
    contact = required(results, index)
    time = scale.time.value(results.solution[index][0])
    shown = ["pressure"] if is_unilateral(contact) else []
    shown += ["gap"] if "gap" in contact and scale.has_gap() else []
    shown += ["traction"] if "stick" in contact else []
    what = "slip of the contact face"
    if shown:
        what = f"{', '.join(shown)} and {what}"
    if "stick" not in contact:
        what += ", which has no friction,"
    heading = style.title(results.name, what, time)
    if contact.cells.shape[1] == 2:
        figure, left_out = draw_lines(contact, scale)
    else:
        figure, left_out = draw_planes(contact, results.body(index), scale)
        if planes(contact, results.body(index))[0].is_flat():
            heading += "\n"
    if left_out:
        heading += f" (the {MOST_PIECES} largest of {MOST_PIECES + left_out} pieces)"
    figure.suptitle(heading, fontsize="large")
    return figure


# ------------------------------------------------------- two dimensions


def draw_lines(contact, scale):
    found = lines(contact)
    shown = found[:MOST_PIECES]
    has_states = "traction" in contact or is_unilateral(contact)
    friction = "traction" in contact
    names = ["contact_pressure"] if is_unilateral(contact) else []
    names += ["gap"] if "gap" in contact and scale.has_gap() else []
    names += ["traction"] if friction else []
    names += ["slip", "slip_rate"]
    n_rows = len(names)
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
        for axes, name in zip(column, names):
            axes.plot(line.s, along(line, contact[name]), color=style.SERIES[0])
            if name == "traction":
                draw_bound(axes, contact, line)
            axes.axhline(0.0, color="#aaaaaa", lw=0.6, zorder=0)
            axes.margins(x=0.0)
            if has_states:
                mark_states(axes, contact, line)
        show(column[-1].xaxis, line.label(scale.length), scale.length)
        ends = contact.points[line.nodes]
        name = scale.supports and scale.supports.name(0.5 * (ends[1:] + ends[:-1]))
        if name:
            column[0].set_title(name, loc="left")
    first = panels[:, 0]
    words = {
        "contact_pressure": "contact pressure\n$p$",
        "gap": "gap that is left\n$g_n-u_n$",
        "traction": "tangential traction\n" r"on the body $\tau$",
        "slip": "slip of the body\n" r"since $t=0$, $s_\tau$",
        "slip_rate": "slip rate of\n" r"the body $\dot{s}_\tau$",
    }
    for axes, name in zip(first, names):
        low, high = scale.limits[name]
        beyond = [
            f"{which} {style.short(end / scale.unit(name).size, 3)}"
            for which, end, shown in zip(
                ("at least", "at most"), scale.extremes[name], (low, high)
            )
            if end != shown
        ]
        text = words[name] + (f"\n({', '.join(beyond)})" if beyond else "")
        show(axes.yaxis, text, scale.unit(name))
        if high > low:
            axes.set_ylim(low - 0.08 * (high - low), high + 0.08 * (high - low))
        else:
            axes.set_yticks([0.0])
    if has_states:
        occurring = friction_state(contact)
        handles = [SHADES[state] for state in SHADES if (occurring == state).any()]
        if friction:
            handles[:0] = [
                Line2D([], [], color=style.SERIES[0], label="traction on the body"),
                Line2D(
                    [], [], color="black", ls="--", lw=1.0, label=r"bound $\pm\rho$"
                ),
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


def draw_bound(axes, contact, line):
    bound = contact["bound"][line.nodes]
    # None where symmetry or another condition holds an end.
    for end, beside in ((0, 1), (-1, -2)):
        node = line.nodes[end]
        touches = not is_unilateral(contact) or contact["contact_pressure"][node] > 0.0
        if touches and bound[end] == 0.0 and bound[beside] > 0.0:
            bound[end] = np.nan
    for sign in (1.0, -1.0):
        axes.plot(line.s, sign * bound, color="black", ls="--", lw=1.0)


SHADES = {
    style.SLIPPING: Patch(facecolor=style.SLIP, alpha=0.2, label="slip"),
    style.STICKING: Patch(facecolor="white", edgecolor="black", lw=0.6, label="stick"),
    style.NO_FRICTION: Patch(
        facecolor=style.FRICTIONLESS, alpha=0.5, label="no friction"
    ),
    style.NO_CONTACT: Patch(facecolor=style.OPEN, alpha=0.5, label="no contact"),
}


def node_intervals(s):
    """Ends of the intervals that belong to nodes: half way to the next."""
    return np.concatenate([s[:1], 0.5 * (s[1:] + s[:-1]), s[-1:]])


def mark_states(axes, contact, line):
    """Shade all but what sticks; a state belongs to a node and half its edges."""
    states = friction_state(contact)[line.nodes]
    ends = node_intervals(line.s)
    for state, first, last in state_runs(states):
        if state != style.STICKING:
            axes.axvspan(
                ends[first],
                ends[last + 1],
                color=style.STATE_COLORS[state],
                alpha=SHADES[state].get_alpha(),
                lw=0,
                zorder=0,
            )


# ----------------------------------------------------- three dimensions


def draw_planes(contact, body, scale):
    found = planes(contact, body)
    shown = found[:MOST_PIECES]
    friction = "stick" in contact
    # Rows of panels for each plane: of friction, and of what acts along the normal.
    rows = [["slip", "traction", "states"] if friction else ["slip"]]
    if is_unilateral(contact):
        normal = ["contact_pressure", *(["gap"] if scale.has_gap() else [])]
        rows = [normal, ["slip", "states"], ["traction"]]
        if not friction:
            rows = [[*normal, "slip"]]
        elif len(normal) == 1:
            rows = [[*normal, "traction"], ["slip", "states"]]
    columns = max(map(len, rows))
    aspect = shown[0].aspect()
    if shown[0].is_flat():
        height = max(4.4 * aspect, 0.4) + 1.7
    else:
        height = min(3.6 * aspect, 5.0) + 1.1
    figure, panels = plt.subplots(
        len(rows) * len(shown),
        columns,
        figsize=(
            5.4 * columns if columns > 1 else 6.4,
            height * len(rows) * len(shown) + 0.5,
        ),
        squeeze=False,
        layout="constrained",
    )
    figure.get_layout_engine().set(wspace=0.06)
    words = {
        "slip": r"slip since $t=0$, $|s_\tau|$",
        "traction": r"tangential traction $|\sigma_\tau|$",
        "contact_pressure": "contact pressure $p$",
        "gap": "gap that is left $g_n-u_n$",
    }
    panels = iter(panels)
    for plane, length in zip(shown, scale.arrows.lengths):
        for i, names in enumerate(rows):
            row = next(panels)
            for axes in row[len(names) :]:
                axes.axis("off")
            for axes, name in zip(row, names):
                if name == "states":
                    states = draw_states(axes, plane, contact)
                    plane.prepare(axes, scale.length, length)
                    style.legend_above(axes, style.state_legend(states))
                    continue
                values, shade = sizes(contact[name]), scale.shades[name]
                shaded(axes, plane.plane, plane.cells, values, shade)
                if name == "slip":
                    add_arrows(axes, plane, contact, scale.arrows.longest, length)
                plane.prepare(axes, scale.length, length)
                unit = scale.unit(name)
                flat, extend = plane.is_flat(), shade.extend
                separator = " " if flat else "\n"
                label = style.range_label(shade, words[name], values, unit, separator)
                add_color_bar(axes, shade.mappable(), label, unit, flat, extend=extend)
            if i == 0:
                name = named_plane(plane, scale.supports, scale.length)
                row[0].set_title(f"{name}, {plane.view()}", pad=10)
    return figure, len(found) - len(shown)


def named_plane(plane, supports, length):
    """Where a plane is, and what the scene calls its boundary."""
    centers = plane.contact.points[plane.cells].mean(axis=1)
    name = supports and supports.name(centers)
    return f"{name}, {plane.name(length)}" if name else plane.name(length)


def draw_states(axes, plane, contact):
    """Each node colors the quarters of the faces that it belongs to."""
    states = friction_state(contact)
    corners = plane.plane[plane.cells]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    centers = corners.mean(axis=1)
    for i in range(4):
        quarters = np.stack(
            [corners[:, i], middles[:, i], centers, middles[:, i - 1]], axis=1
        )
        colors = [style.STATE_COLORS[state] for state in states[plane.cells[:, i]]]
        tiles(axes, quarters, facecolors=colors)
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


def add_arrows(axes, plane, contact, longest, length):
    """Arrows of the slip at some nodes; one of `longest` has that length.  Black
    with a white border: they lie on dark and on light colors."""
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
        color="black",
        edgecolor="white",
        linewidth=0.6,
        width=0.007,
        zorder=4,
    )
    return arrows


def one_of_each(plane):
    """One copy of each node of the plane."""
    used = np.unique(plane.cells)
    _, first = np.unique(plane.vertex()[used], return_index=True)
    return used[first]


# Dark where there is nothing, pale at the bound, but not as the page: under dots in the
# color of slip and under black arrows.
UTILISATION = ListedColormap(matplotlib.colormaps["bone"](np.linspace(0.2, 0.88, 256)))


def draw_utilisation(axes, plane, body, longest, length):
    """The panel of the overview: utilisation, slipping nodes, slip.

    longest, length  the largest slip of all, and how long its arrow is
    """
    contact, scale = body.contact, body.scale
    utilisation = contact["utilisation"]
    faces = tiles(
        axes,
        plane.plane[plane.cells],
        array=utilisation[plane.cells].mean(axis=1),
        cmap=UTILISATION,
        norm=Normalize(0.0, 1.0),
    )
    draw_mesh(axes, plane.plane, plane.cells, plane.vertex(), (0.5, 0.5, 0.5, 0.5))
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
    arrows = add_arrows(axes, plane, contact, longest, length)
    if arrows is not None:
        text = scale.units.unit("length", longest).value(longest, 3)
        axes.quiverkey(
            arrows,
            0.94,
            1.05,
            longest,
            f"slip, at most {text}",
            labelpos="W",
            fontproperties={"size": "small"},
        )
    for place, text in scale.labels:
        if len(place) == 3 and plane.holds(place):
            axes.text(*plane.project(place), text, zorder=6, **style.LABEL)
    plane.prepare(axes, scale.length, length)
    draw_foundation_motion(axes, plane, body)
    unit = Unit(0.01, "%")
    label = unit.label("traction over its bound")
    add_color_bar(axes, faces, label, unit, plane.is_flat())


def draw_foundation_motion(axes, plane, body):
    """Above the panel an arrow that shows how a moving foundation goes by."""
    supports = body.scale.supports
    if not supports:
        return
    centers = plane.contact.points[plane.cells].mean(axis=1)
    number = supports.of(centers[:1])[0]
    normals = np.tile(plane.normal, (len(centers), 1))
    try:
        velocity = supports.velocity(number, centers, normals, body.time).mean(axis=0)
    except UserError:  # an expression of more than place and time
        return
    speed = np.linalg.norm(plane.project(velocity))
    if speed <= 0.0:
        return
    tail, tip = (
        offset_copy(axes.transAxes, axes.figure, *way, units="points")
        for way in np.outer((-10.0, 10.0), plane.project(velocity) / speed)
    )
    axes.annotate(
        "",
        (0.06, 1.055),
        (0.06, 1.055),
        xycoords=tip,
        textcoords=tail,
        arrowprops={"arrowstyle": "-|>", "color": MOTION, "lw": 2.0},
    )
    text = supports.units.unit("velocity", speed).value(speed, 3)
    axes.text(
        0.12,
        1.055,
        f"foundation, {text}",
        transform=axes.transAxes,
        color=MOTION,
        fontsize="small",
        va="center",
    )
