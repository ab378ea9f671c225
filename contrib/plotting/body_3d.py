# SPDX-License-Identifier: LGPL-2.1-or-later
"""The body in three dimensions."""

import itertools
import math

import numpy as np
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d import proj3d
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from . import style
from .body_base import DASHES, MANY, Body, is_cell_data, undeformed_key
from .faces import lies_on_contact
from .geometry import newell_normals, sharp_edges
from .units import Numbers, Ticks

VIEW = (22.0, -55.0)  # elevation and azimuth in degrees
BOX = list(itertools.product((False, True), repeat=3))  # corners of a box


class Body3D(Body):
    """Its surface, from an elevated point of view and without perspective."""

    def heading(self):
        """With what supports and moves the body, of which arrows show a part."""
        text = super().heading()
        if self.scale.supports:
            text += "\n" + self.scale.supports.caption(self.scale.length)
        return text

    LABELS = 1.2, 0.6  # inches beside and below the body for labels of axes
    FLAT = 0.75  # height over width with the color bar underneath

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
        self.color_bar(panel, up < self.FLAT * across)
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
            for text in map(self.scale.length.label, ("$x$", "$y$", "$z$"))
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
        colors = self.scale.shade.colors(values[visible])
        mesh_lines = (
            np.tile((1.0, 1.0, 1.0, 0.35), (len(colors), 1)) if few else colors
        )
        # The edges of the body are sorted by depth together with its faces,
        # as polygons without area, nearer to the viewer than these faces.
        edges, neighbors = sharp_edges(self.faces, self.vertex, self.body.points)
        shown = edges[visible[neighbors].any(axis=1)]
        lines = self.deformed[shown][:, (0, 1, 1, 0)]
        lengths = np.linalg.norm(lines[:, 1] - lines[:, 0], axis=1)
        lines += lengths[:, None, None] * towards_viewer
        black = np.tile((0.0, 0.0, 0.0, 1.0), (len(lines), 1))
        surface = Poly3DCollection(
            np.concatenate([polygons[visible], lines]),
            facecolors=np.concatenate([colors, black]),
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
            in_front = (flat > 0.0)[neighbors].any(axis=1)
            for chosen, order, alpha in ((in_front, 4, 0.9), (~in_front, 1, 0.5)):
                look = {"alpha": alpha, "zorder": order}
                # White under the dashes, on dark faces.
                axes.add_collection3d(
                    Line3DCollection(undeformed[chosen], colors="white", lw=1.8, **look)
                )
                axes.add_collection3d(
                    Line3DCollection(
                        undeformed[chosen],
                        colors=style.OUTLINE,
                        linewidths=0.9,
                        linestyles=DASHES,
                        **look,
                    )
                )
        self.draw_arrows(axes)
        for place, text in self.scale.labels:
            # Those on the contact face are for pictures of that.
            if len(place) == 3 and not lies_on_contact(place, self.contact, self.body):
                axes.text(*place, text, zorder=7, **style.LABEL)
        low, high = self.scale.low, self.scale.high
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_zlim(low[2], high[2])
        axes.set_box_aspect(high - low)
        for axis, length in zip(axes_of_space(axes), high - low):
            wanted = 2 + round(3 * length / (high - low).max())
            axis.set_major_locator(Ticks(self.scale.length.size, nbins=wanted))
            axis.set_major_formatter(Numbers(self.scale.length.size))
        axes.tick_params(labelsize="small", pad=1)
        axes.patch.set_visible(False)
        for artist in axes.collections:
            artist.set_clip_on(False)

    def draw_arrows(self, axes):
        """One on each piece that the scene moves, and one on each that it loads."""
        supports = self.scale.supports
        if not supports:
            return
        normals = newell_normals(self.body.points[self.faces])
        ids = supports.of(self.body.points[self.faces].mean(axis=1))
        for number in np.unique(ids):
            faces = self.faces[ids == number]
            places = self.body.points[faces].mean(axis=1)
            center = self.deformed[faces].mean(axis=(0, 1))
            arrow, color, pushes = supports.arrow(
                number, places, normals[ids == number], self.time
            )
            if arrow is not None:
                arrow = 0.2 * self.scale.size * arrow
                axes.quiver(
                    *(center - arrow if pushes else center),
                    *arrow,
                    color=color,
                    lw=2.5,
                    arrow_length_ratio=0.3,
                    zorder=6,
                    path_effects=style.visible_anywhere(4.5),
                )


def axes_of_space(axes):
    return axes.xaxis, axes.yaxis, axes.zaxis


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
