# SPDX-License-Identifier: LGPL-2.1-or-later
"""A field on the deformed body, in two and in three dimensions."""

import itertools
import math
import re

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d import proj3d
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from . import style
from .faces import friction_state, lines, state_runs
from .geometry import (
    boundary_faces,
    chains,
    newell_normals,
    sharp_edges,
    unique_edges,
)
from .layout import add_colour_bar, is_flat
from .results import NoPicture

DASHES = (0, (5, 3))
MANY = 3000  # cells beyond which mesh lines would hide the colours
VIEW = (22.0, -55.0)  # elevation and azimuth in degrees
BOX = list(itertools.product((False, True), repeat=3))  # corners of a box

CELL_DATA = ("stress_", "irreversible_", "strain_", "creep_", "principal_stress_",
             "von_mises", "pressure", "estimator", "error_energy", "recovery", "subdomain")


def available_fields(body):
    """Names that field() knows, those of most interest first."""
    axes = "xy" if body.cells.shape[1] == 4 else "xyz"
    names = []
    for name in sorted(body.data, key=order):
        names.append(name)
        if body.data[name].ndim == 2:
            names += [f"{name}_{axis}" for axis in axes]
        if name == "stress_zz":
            names.append("pressure")
    return names


# The end of the name of a component of a tensor, or of a principal value.
COMPONENT = re.compile("[xyz][xyz]|[123]")


def order(name):
    first = ("von_mises", "displacement", "velocity", "stress_", "irreversible_")
    return [not name.startswith(start) for start in first], name


def field(body, name):
    """Values of a field at the points of the record."""
    stem, _, axis = name.rpartition("_")
    if name in body and body[name].ndim == 2:
        return np.linalg.norm(body[name], axis=1)
    if name in body:
        if not COMPONENT.fullmatch(axis):
            return body[name]
        group = [
            body[other]
            for other in body.data
            if other.rpartition("_")[0] == stem
            and COMPONENT.fullmatch(other.rpartition("_")[2])
        ]
        return without_rounding(body[name], group)
    if name == "pressure" and "stress_zz" in body:
        return -sum(body[f"stress_{c}"] for c in ("xx", "yy", "zz")) / 3.0
    if stem in body and axis in ("x", "y", "z") and body.data[stem].ndim == 2:
        return without_rounding(body[stem][:, "xyz".index(axis)], [body[stem]])
    raise NoPicture(
        f'there is no picture and no field "{name}"; the fields are '
        + ", ".join(available_fields(body))
    )


def without_rounding(values, group):
    """Zero for a component that vanishes but for rounding in its tensor."""
    largest = max((np.abs(other).max() for other in group), default=0.0)
    return np.where(np.abs(values).max() > 1e-7 * largest, values, 0.0)


def is_cell_data(name):
    return name.startswith(CELL_DATA)


class Scale:
    """What a picture and all frames of an animation have in common.

    magnification  of the displacement
    low, high      corners of the box that holds all deformed bodies
    shade          the colours of the field
    """

    def __init__(self, results, indices, name, magnification=None):
        largest, size = 0.0, 0.0
        for index in indices:
            body = results.body(index)
            size = max(size, body.size)
            displacement = np.linalg.norm(body["displacement"], axis=1)
            largest = max(largest, displacement.max(initial=0.0))
        self.magnification = magnification or style.rounded_magnification(largest, size)
        self.low, self.high = np.full(3, np.inf), np.full(3, -np.inf)
        values = []
        for index in indices:
            body = results.body(index)
            deformed = body.points + self.magnification * body["displacement"]
            for points in (body.points, deformed):
                self.low = np.minimum(self.low, points.min(axis=0))
                self.high = np.maximum(self.high, points.max(axis=0))
            # What is drawn lies between the extremes of each cell.
            of_cells = field(body, name)[body.cells]
            values += [of_cells.min(axis=1), of_cells.max(axis=1)]
        self.name = name
        self.shade = style.Shade(np.concatenate(values), f'the field "{name}"')


class Body:
    def __init__(self, body, contact, scale):
        self.body = body
        self.contact = contact
        self.scale = scale
        self.magnification = scale.magnification
        self.deformed = body.points + self.magnification * body["displacement"]
        self.at_points = field(body, scale.name)
        self.values = self.at_points[body.cells].mean(axis=1)
        self.faces, self.owners, self.vertex = boundary_faces(body, body.size)

    def colour_bar(self, axes, flat):
        shade = self.scale.shade
        name = style.field_label(self.scale.name)
        label = style.range_label(shade, name, self.at_points, " " if flat else "\n")
        add_colour_bar(axes, shade.mappable(), label, flat, extend=shade.extend)


class Body2D(Body):
    def draw(self, axes):
        cells = self.body.cells
        points = self.deformed[:, :2]
        if is_cell_data(self.scale.name):
            polygons = tiles(
                axes,
                points[cells],
                array=self.values,
                cmap=self.scale.shade.map,
                norm=self.scale.shade.norm,
            )
            # Else vector files grow huge.
            polygons.set_rasterized(len(cells) > MANY)
        else:
            shaded(axes, points, cells, self.at_points, self.scale.shade)
        draw_mesh(axes, points, cells, self.vertex)
        of_vertex = np.empty((self.vertex.max() + 1, 2))
        of_vertex[self.vertex] = self.body.points[:, :2]
        axes.add_collection(
            LineCollection(
                [of_vertex[chain] for chain in chains(self.vertex[self.faces])],
                colors=style.OUTLINE,
                linewidths=0.9,
                linestyles=DASHES,
                zorder=3,
            )
        )
        handles = []
        if self.contact is not None:
            states = friction_state(self.contact)
            self.draw_contact(axes, states)
            handles = style.state_legend(states)
        axes.set_aspect("equal")
        low, high = self.scale.low, self.scale.high
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_xlabel("$x$")
        axes.set_ylabel("$y$")
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        # Off the body, whose edges often run along the axes.
        for side in ("left", "bottom"):
            axes.spines[side].set_position(("outward", 10))
        style.legend_above(axes, [*handles, undeformed_key()])
        self.colour_bar(axes, is_flat(self.aspect()))

    def draw_contact(self, axes, states):
        contact = self.contact
        place = contact.points + self.magnification * contact["displacement"]
        place = place[:, :2]
        # A state belongs to a node and to half the edges beside it.
        pieces, runs, colours = [], [], []
        for line in lines(contact):
            corners = place[line.nodes]
            pieces.append(corners)
            middles = 0.5 * (corners[1:] + corners[:-1])
            ends = np.concatenate([corners[:1], middles, corners[-1:]])
            for state, first, last in state_runs(states[line.nodes]):
                inner = corners[first : last + 1]
                runs.append(np.concatenate([ends[[first]], inner, ends[[last + 1]]]))
                colours.append(style.STATE_COLOURS[state])
        for paths, width, colour, cap, order in (
            (pieces, 7.5, "black", "projecting", 4),
            (runs, 5.0, colours, "butt", 5),
        ):
            axes.add_collection(
                LineCollection(
                    paths,
                    colors=colour,
                    linewidths=width,
                    capstyle=cap,
                    zorder=order,
                    clip_on=False,
                )
            )

    def aspect(self):
        """Height over width."""
        extent = self.scale.high - self.scale.low
        return extent[1] / extent[0]

    def panel_height(self, width):
        """Inches that the body needs in a panel so many inches wide."""
        return float(np.clip(width * self.aspect(), 0.4, 7.5))


def tiles(axes, polygons, **colours):
    """Polygons without background between neighbours.

    Each has an edge in its own colour, since two edges that cover a part of
    the same pixels do not hide what is behind; and corners are not rounded to
    pixels, as matplotlib does with rectangles only, not with their neighbours.
    """
    collection = PolyCollection(
        polygons, edgecolors="face", linewidths=0.8, snap=False, **colours
    )
    return axes.add_collection(collection)


def draw_mesh(axes, points, cells, vertex, colour=(1, 1, 1, 0.4)):
    """Mesh lines, where they do not hide the colours."""
    if len(cells) <= MANY:
        lines = points[unique_edges(cells, vertex)]
        axes.add_collection(
            LineCollection(lines, colors=[colour], linewidths=0.3, snap=False)
        )


def shaded(axes, points, cells, values, shade):
    """Nodal values on quadrilaterals: four triangles about each centre."""
    centres = points[cells].mean(axis=1)
    number = len(points) + np.arange(len(cells))
    triangles = np.concatenate(
        [
            np.column_stack([cells[:, i], cells[:, (i + 1) % 4], number])
            for i in range(4)
        ]
    )
    image = axes.tripcolor(
        *np.concatenate([points, centres]).T,
        triangles,
        np.concatenate([values, values[cells].mean(axis=1)]),
        shading="gouraud",
        cmap=shade.map,
        norm=shade.norm,
    )
    image.set_rasterized(True)
    return image


def undeformed_key():
    return Line2D([], [], color=style.OUTLINE, lw=0.9, ls=DASHES, label="undeformed")


class Body3D(Body):
    """Its surface, from an elevated point of view and without perspective."""

    LABELS = 1.2, 0.6  # inches beside and below the body for labels of axes
    FLAT = 0.75  # height over width with the colour bar underneath

    def panel_height(self, width, view):
        """Inches that the body needs in a panel so many inches wide."""
        across, up = self.projected(view)
        beside, below = self.LABELS
        return float(np.clip((width - beside) * up / across, 1.0, 4.5)) + below

    def projected(self, view):
        """Width and height of the body's box on the screen, over its diagonal."""
        elevation, azimuth = map(math.radians, view)
        extent = self.scale.high - self.scale.low
        extent = extent / np.linalg.norm(extent)
        right = np.array([-math.sin(azimuth), math.cos(azimuth), 0.0])
        up = np.array(
            [
                -math.sin(elevation) * math.cos(azimuth),
                -math.sin(elevation) * math.sin(azimuth),
                math.cos(elevation),
            ]
        )
        return np.abs(right) @ extent, np.abs(up) @ extent

    def add_panel(self, figure, cell, view):
        """Axes without content for the layout, to be filled by fill_panel."""
        panel = figure.add_subplot(cell)
        panel.set_axis_off()
        across, up = self.projected(view)
        self.colour_bar(panel, up < self.FLAT * across)
        style.legend_above(panel, [undeformed_key()])
        return panel

    def fill_panel(self, panel, view):
        """Draw the body as large as its panel, once all of the figure is there.

        matplotlib scales a box by its diagonal to fit into a square and puts
        labels at distances that are shares of the box.  So the body and the
        numbers at its axes are drawn, measured, and drawn larger; the labels
        are placed here.
        """
        figure = panel.figure
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        available = panel.get_window_extent()
        axes = figure.add_axes(
            panel.get_position(), projection="3d", computed_zorder=False
        )
        self.draw(axes, view)
        labels = [
            figure.text(0, 0, text, ha="center", va="center")
            for text in axis_labels(axes)
        ]
        zoom, gap = 1.0, 6.0
        for last in (False, False, False, False, True):
            axes.set_box_aspect(self.scale.high - self.scale.low, zoom=zoom)
            axes.draw(figure.canvas.get_renderer())
            body = self.on_screen(axes)
            numbers = [
                [number.get_window_extent() for number in numbers_at(axis)]
                for axis in axes_of_space(axes)
            ]
            for axis, label, boxes in zip(axes_of_space(axes), labels, numbers):
                place_label(axes, axis, label, boxes, body, gap)
            if last:
                break
            if touching(axes):
                gap = 10.0
            everything = Bbox.union(
                [body, *sum(numbers, []), *(l.get_window_extent() for l in labels)]
            )
            around = everything.size - body.size
            zoom *= min((available.size - around) / body.size)
            shift = available.min + available.max - everything.min - everything.max
            shift = figure.transFigure.inverted().transform(0.5 * shift)
            axes.set_position(axes.get_position(original=True).translated(*shift))
        for number in touching(axes):
            number.set_visible(False)

    def on_screen(self, axes):
        """The rectangle that the body's box covers."""
        corners = np.array(
            [np.where(bits, self.scale.high, self.scale.low) for bits in BOX]
        )
        x, y, _ = proj3d.proj_transform(*corners.T, axes.get_proj())
        drawn = axes.transData.transform(np.column_stack([x, y]))
        return Bbox([drawn.min(axis=0), drawn.max(axis=0)])

    def draw(self, axes, view=VIEW):
        axes.set_proj_type("ortho")
        axes.view_init(*view)
        elevation, azimuth = map(math.radians, view)
        towards_viewer = np.array(
            [
                math.cos(elevation) * math.cos(azimuth),
                math.cos(elevation) * math.sin(azimuth),
                math.sin(elevation),
            ]
        )
        # Only the faces turned to the viewer: fewer polygons for the
        # painter's algorithm to put into the wrong order.
        polygons = self.deformed[self.faces]
        visible = newell_normals(polygons) @ towards_viewer > 0.0
        few = np.count_nonzero(visible) <= MANY
        if is_cell_data(self.scale.name):
            values = self.values[self.owners]
        else:
            values = self.at_points[self.faces].mean(axis=1)
        colours = self.scale.shade.colours(values[visible])
        mesh_lines = (
            np.tile((1.0, 1.0, 1.0, 0.35), (len(colours), 1)) if few else colours
        )
        # The edges of the body are sorted by depth together with its faces,
        # as polygons without area, nearer to the viewer than these faces.
        edges, neighbours = sharp_edges(self.faces, self.vertex, self.body.points)
        shown = edges[visible[neighbours].any(axis=1)]
        lines = self.deformed[shown][:, (0, 1, 1, 0)]
        lengths = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
        lines += lengths[:, None, None] * towards_viewer
        black = np.tile((0.0, 0.0, 0.0, 1.0), (len(lines), 1))
        surface = Poly3DCollection(
            np.concatenate([polygons[visible], lines]),
            facecolors=np.concatenate([colours, black]),
            edgecolors=np.concatenate([mesh_lines, black]),
            linewidths=0.6,  # one for all: it is not sorted with the rest
            zorder=2,
        )
        surface.set_rasterized(not few)
        surface.set_snap(False)
        axes.add_collection3d(surface)
        if len(edges):
            undeformed = self.body.points[edges]
            flat = newell_normals(self.body.points[self.faces]) @ towards_viewer
            in_front = (flat > 0.0)[neighbours].any(axis=1)
            for chosen, order, alpha in ((in_front, 4, 0.9), (~in_front, 1, 0.5)):
                axes.add_collection3d(
                    Line3DCollection(
                        undeformed[chosen],
                        colors=style.OUTLINE,
                        linewidths=0.8,
                        linestyles=DASHES,
                        alpha=alpha,
                        zorder=order,
                    )
                )
        low, high = self.scale.low, self.scale.high
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_zlim(low[2], high[2])
        axes.set_box_aspect(high - low)
        limits = matplotlib.rcParams["axes.formatter.limits"]
        power = math.floor(math.log10(max(abs(low).max(), abs(high).max())))
        for axis, length in zip(axes_of_space(axes), high - low):
            wanted = 2 + round(3 * length / (high - low).max())
            axis.get_major_locator().set_params(nbins=wanted)
            # The same power of ten at all axes.
            formatter = axis.get_major_formatter()
            if limits[0] < power < limits[1]:
                formatter.set_scientific(False)
            else:
                formatter.set_powerlimits((power, power))
        axes.tick_params(labelsize="small", pad=1)
        axes.patch.set_visible(False)
        for artist in axes.collections:
            artist.set_clip_on(False)


def axes_of_space(axes):
    return axes.xaxis, axes.yaxis, axes.zaxis


def axis_labels(axes):
    """Names of the axes with the power of ten that their numbers lack.

    matplotlib would put the power where the label is.
    """
    texts = []
    for name, axis in zip("xyz", axes_of_space(axes)):
        formatter = axis.get_major_formatter()
        formatter.set_locs(axis.get_majorticklocs())
        power = formatter.get_offset()
        texts.append(f"${name}$  ({power})" if power else f"${name}$")
        axis.offsetText.set_visible(False)
    return texts


def numbers_at(axis):
    """The numbers that are drawn at an axis."""
    low, high = sorted(axis.get_view_interval())
    return [
        tick.label1
        for tick in axis.get_major_ticks()
        if low <= tick.get_loc() <= high and tick.label1.get_text()
    ]


def touching(axes):
    """Numbers too close to others of any axis, where these remain."""
    margin = 1.5 * axes.figure.dpi / 72.0
    kept, found = [], []
    for number in itertools.chain(*map(numbers_at, axes_of_space(axes))):
        box = number.get_window_extent().padded(margin)
        if any(box.overlaps(other) for other in kept):
            found.append(number)
        else:
            kept.append(box)
    return found


def place_label(axes, axis, label, numbers, body, gap):
    """Put a label outside the numbers of its axis, at the middle.

    The next time they are drawn the numbers, too, are at a distance from the
    axis, `gap` points, that does not depend on the shape of the body.
    """
    points = axes.figure.dpi / 72.0
    ends = axes.transData.transform(axis.line.get_xydata())
    along = ends[1] - ends[0]
    if not numbers or np.linalg.norm(along) < points:  # seen from its end
        label.set_visible(False)
        return
    middle = ends.mean(axis=0)
    outwards = np.array([-along[1], along[0]]) / np.linalg.norm(along)
    if outwards @ (middle - 0.5 * (body.min + body.max)) < 0.0:
        outwards = -outwards

    def half(box):
        return 0.5 * np.abs(outwards) @ box.size

    def distance(box):
        return outwards @ (0.5 * (box.min + box.max) - middle)

    outermost = max(distance(box) + half(box) for box in numbers)
    place = outermost + 3.0 * points + half(label.get_window_extent())
    label.set_position(
        axes.figure.transFigure.inverted().transform(middle + place * outwards)
    )
    # matplotlib moves numbers by `pad` and eight more shares of the box.
    pad = axis.get_major_ticks()[0].get_pad()
    wanted = gap * points + max(half(box) for box in numbers)
    found = max(distance(box) for box in numbers)
    if found > 0.0:
        axis.set_tick_params(pad=(pad + 8.0) * wanted / found - 8.0)


def make_body(results, index, scale):
    body = results.body(index)
    kind = Body2D if body.cells.shape[1] == 4 else Body3D
    return kind(body, results.face(index), scale)
