# SPDX-License-Identifier: LGPL-2.1-or-later
"""A field on the deformed body, in two and in three dimensions."""

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Rectangle

from . import style, supports
from .body_3d import Body3D
from .body_base import DASHES, MANY, Body, is_cell_data, undeformed_key
from .faces import friction_state, lines, state_runs
from .geometry import chains, unique_edges
from .layout import is_flat
from .units import show


class Body2D(Body):
    def draw(self, axes):
        cells = self.body.cells
        points = self.deformed[:, :2]
        for half in self.halves(points):
            if is_cell_data(self.scale.name):
                polygons = tiles(
                    axes,
                    half[cells],
                    array=self.values,
                    cmap=self.scale.shade.map,
                    norm=self.scale.shade.norm,
                )
                # Else vector files grow huge.
                polygons.set_rasterized(len(cells) > MANY)
            else:
                shaded(axes, half, cells, self.at_points, self.scale.shade)
            draw_mesh(axes, half, cells, self.vertex)
        of_vertex = np.empty((self.vertex.max() + 1, 2))
        of_vertex[self.vertex] = self.body.points[:, :2]
        faces = self.vertex[self.faces[~self.on_axis(self.faces)]]
        outline = [of_vertex[chain] for chain in chains(faces)]
        outline = [half for line in outline for half in self.halves(line)]
        # White under the dashes: they cross dark cells and light ones.
        for look in (
            {"colors": "white", "linewidths": 1.8},
            {"colors": style.OUTLINE, "linewidths": 1.0, "linestyles": DASHES},
        ):
            axes.add_collection(
                LineCollection(outline, zorder=3, clip_on=False, **look)
            )
        if self.scale.mirrored:
            axes.axvline(0.0, color=style.OUTLINE, lw=0.6, ls="-.", zorder=2)
        handles = []
        if self.contact is not None:
            states = friction_state(self.contact)
            self.draw_contact(axes, states)
            handles = style.state_legend(states)
        handles.append(undeformed_key())
        if self.scale.supports:
            handles += supports.draw(axes, self, self.scale.supports)
        for place, text in self.scale.labels:
            axes.text(*place[:2], text, **style.LABEL)
        axes.set_aspect("equal")
        low, high = self.limits()
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        if self.scale.window:
            self.draw_whole(axes, outline)
        for axis, label in zip((axes.xaxis, axes.yaxis), self.scale.axes):
            show(axis, label, self.scale.length)
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
        # Off the body, whose edges often run along the axes.
        for side in ("left", "bottom"):
            axes.spines[side].set_position(("outward", 10))
        style.legend_above(axes, handles)
        self.color_bar(axes, is_flat(self.aspect()))

    def halves(self, points):
        """Places in the section, and in the other half of a body of revolution."""
        return [points, points * (-1, 1)] if self.scale.mirrored else [points]

    def on_axis(self, faces):
        """Of each face whether it lies where a mirrored section meets its other half."""
        near = np.abs(self.body.points[faces, 0]) < 1e-6 * self.body.size
        return self.scale.mirrored & near.all(axis=1)

    def draw_contact(self, axes, states):
        contact = self.contact
        place = self.moved(contact)[:, :2]
        # A state belongs to a node and to half the edges beside it.
        pieces, runs, colors = [], [], []
        for line in lines(contact):
            for corners in self.halves(place[line.nodes]):
                pieces.append(corners)
                middles = 0.5 * (corners[1:] + corners[:-1])
                ends = np.concatenate([corners[:1], middles, corners[-1:]])
                for state, first, last in state_runs(states[line.nodes]):
                    inner = corners[first : last + 1]
                    runs.append(np.concatenate([ends[[first]], inner, ends[[last + 1]]]))
                    colors.append(style.STATE_COLORS[state])
        for paths, width, color, cap, order in (
            (pieces, 7.5, "black", "projecting", 4),
            (runs, 5.0, colors, "butt", 5),
        ):
            axes.add_collection(
                LineCollection(
                    paths,
                    colors=color,
                    linewidths=width,
                    capstyle=cap,
                    zorder=order,
                    clip_on=False,
                )
            )

    def draw_whole(self, axes, outline):
        """The whole body in a corner, with the window; nothing beyond the latter."""
        for artist in axes.get_children():
            if artist is not axes.patch and artist not in axes.spines.values():
                artist.set_clip_on(True)
        low, high = self.limits()
        for text in axes.texts:
            place = np.array(getattr(text, "xy", text.get_position()))  # of annotations
            text.set_visible(all(low <= place) and all(place <= high))
        whole = axes.inset_axes([0.72, 0.7, 0.26, 0.28])
        whole.add_collection(LineCollection(outline, colors=style.OUTLINE, linewidths=0.8))
        whole.add_patch(Rectangle(low, *(high - low), fill=False, ec="#d55e00", lw=1.2))
        whole.autoscale_view()
        whole.set_aspect("equal")
        whole.set_xticks([])
        whole.set_yticks([])

    def limits(self):
        """Corners of what is drawn: the body with its supports and loads."""
        if self.scale.window:
            return np.array(self.scale.window)
        # A little more, so that what ends there is seen to end.
        beside = 0.01 * self.scale.size
        low, high = self.scale.low[:2] - beside, self.scale.high[:2] + beside
        if self.scale.supports:
            below, above = supports.reach(self.scale.supports, self.scale)
            low, high = low - below, high + above
        if self.scale.mirrored:
            low[0] = -high[0]
        return low, high

    def aspect(self):
        """Height over width."""
        low, high = self.limits()
        return (high[1] - low[1]) / (high[0] - low[0])

    def panel_height(self, width):
        """Inches that the body needs in a panel so many inches wide."""
        return float(np.clip(width * self.aspect(), 0.4, 7.5))


def tiles(axes, polygons, **colors):
    """Polygons without background between neighbors.

    Each has an edge in its own color, since two edges that cover a part of
    the same pixels do not hide what is behind; and corners are not rounded to
    pixels, as matplotlib does with rectangles only, not with their neighbors.
    """
    collection = PolyCollection(
        polygons, edgecolors="face", linewidths=0.8, snap=False, **colors
    )
    return axes.add_collection(collection)


def draw_mesh(axes, points, cells, vertex, color=(1, 1, 1, 0.4)):
    """Mesh lines, where they do not hide the colors."""
    if len(cells) <= MANY:
        lines = points[unique_edges(cells, vertex)]
        axes.add_collection(
            LineCollection(lines, colors=[color], linewidths=0.3, snap=False)
        )


def shaded(axes, points, cells, values, shade):
    """Nodal values on quadrilaterals: four triangles about each center."""
    centers = points[cells].mean(axis=1)
    number = len(points) + np.arange(len(cells))
    triangles = np.concatenate(
        [
            np.column_stack([cells[:, i], cells[:, (i + 1) % 4], number])
            for i in range(4)
        ]
    )
    image = axes.tripcolor(
        *np.concatenate([points, centers]).T,
        triangles,
        np.concatenate([values, values[cells].mean(axis=1)]),
        shading="gouraud",
        cmap=shade.map,
        norm=shade.norm,
    )
    image.set_rasterized(True)
    return image


def make_body(results, index, scale):
    kind = Body2D if results.dimension() == 2 else Body3D
    return kind(results, index, scale)
