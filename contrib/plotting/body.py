# SPDX-License-Identifier: LGPL-2.1-or-later
"""A field on the deformed body, in two and in three dimensions."""

import itertools
import math

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d import proj3d
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from . import style
from .faces import friction_state, lines, state_runs
from .geometry import boundary_faces, chains, newell_normals, sharp_edges
from .results import NoPicture

DASHES = (0, (5, 3))
MANY = 3000  # cells beyond which mesh lines would hide the colours
VIEW = (22.0, -55.0)  # elevation and azimuth in degrees
BOX = list(itertools.product((False, True), repeat=3))  # corners of a box

CELL_DATA = ("stress_", "irreversible_stress_", "von_mises", "pressure", "estimator",
             "subdomain")


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


def order(name):
    first = ("von_mises", "displacement", "velocity", "stress_", "irreversible_")
    return [not name.startswith(start) for start in first], name


def field(body, name):
    """Values of a field at the points of the record."""
    stem, _, axis = name.rpartition("_")
    if name in body and body[name].ndim == 2:
        return np.linalg.norm(body[name], axis=1)
    if name in body:
        group = [body[other] for other in body.data if other.rpartition("_")[0] == stem]
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
            values.append(field(body, name)[body.cells].mean(axis=1))
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

    def colour_bar(self, figure, **options):
        return style.add_colour_bar(
            figure,
            self.scale.shade,
            style.field_label(self.scale.name),
            self.values,
            **options,
        )


class Body2D(Body):
    def draw(self, axes):
        cells = self.body.cells
        points = self.deformed[:, :2]
        few = len(cells) <= MANY
        if is_cell_data(self.scale.name):
            polygons = PolyCollection(
                points[cells],
                array=self.values,
                cmap=self.scale.shade.map,
                norm=self.scale.shade.norm,
                # Without edges in the face's colour hairlines of background
                # shine through between the cells.
                edgecolors=(1, 1, 1, 0.25) if few else "face",
                linewidths=0.3,
            )
            polygons.set_rasterized(not few)  # else vector files grow huge
            axes.add_collection(polygons)
        else:
            shaded(axes, points, cells, self.at_points, self.scale.shade)
            if few:
                axes.add_collection(
                    PolyCollection(
                        points[cells],
                        facecolors="none",
                        edgecolors=(1, 1, 1, 0.25),
                        linewidths=0.3,
                    )
                )
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

    LABELS = 1.3  # inches for the labels of the axes

    def panel_height(self, width, view):
        """Inches that the body needs in a panel so many inches wide."""
        across, up = self.projected(view)
        return float(np.clip((width - self.LABELS) * up / across, 1.2, 5.0)) + 1.1

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

    def fill_panel(self, axes, view):
        """Enlarge the body to its panel, once all of the figure is there.

        matplotlib scales a box by its diagonal to fit into a square; bodies
        that are flat on the screen may be larger.
        """
        figure = axes.figure
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        cell = axes.get_position(original=True)
        width, height = figure.get_size_inches() * (cell.width, cell.height)
        corners = np.array(
            [np.where(bits, self.scale.high, self.scale.low) for bits in BOX]
        )
        x, y, _ = proj3d.proj_transform(*corners.T, axes.get_proj())
        drawn = np.ptp(axes.transData.transform(np.column_stack([x, y])), axis=0)
        drawn /= figure.dpi
        zoom = min((width - self.LABELS) / drawn[0], (height - 0.9) / drawn[1])
        axes.set_box_aspect(self.scale.high - self.scale.low, zoom=zoom)
        axes.patch.set_visible(False)
        for artist in axes.collections:
            artist.set_clip_on(False)

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
        for axis, length in zip("xyz", high - low):
            # matplotlib moves labels by shares of the other extents.
            others = np.delete(high - low, "xyz".index(axis)).max()
            pad = min(12.0 * (high - low).max() / others - 8.0, 30.0)
            getattr(axes, f"set_{axis}label")(f"${axis}$", labelpad=pad)
            wanted = 2 + round(3 * length / (high - low).max())
            axes.locator_params(axis=axis, nbins=wanted)
        axes.tick_params(labelsize="small", pad=1)
        axes.legend(handles=[undeformed_key()], loc="upper right", frameon=False)


def make_body(results, index, scale):
    body = results.body(index)
    kind = Body2D if body.cells.shape[1] == 4 else Body3D
    return kind(body, results.face(index), scale)
