# SPDX-License-Identifier: LGPL-2.1-or-later
"""What pictures of the body have in common: a field, its colors, the outline."""

import re

import numpy as np
from matplotlib.lines import Line2D
from scipy.spatial import cKDTree

from . import quantities, style
from .geometry import boundary_faces, corner_volumes
from .layout import add_color_bar
from .results import NoPicture
from .supports import Supports
from .units import Units

DASHES = (0, (5, 3))
MANY = 3000  # cells beyond which mesh lines would hide the colors

CELL_DATA = (
    *("stress_", "irreversible_", "strain_", "creep_", "principal_stress_", "history_"),
    *("von_mises", "pressure", "estimator", "error_energy", "recovery", "subdomain"),
)


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
    shade          the colors of the field
    units, length, time, unit
                   units in general, of axes, of times and of the field
    supports       what the scene prescribes on the boundary, or None
    of_revolution  whether the body is one, and
    mirrored       whether the section of a body of revolution has its other half
    """

    def __init__(self, results, indices, name, options):
        self.name = name
        self.labels = options.label
        self.window = options.window
        bodies = [results.body(index) for index in indices]
        faces = []
        if results.opposite:
            faces = [(results.face(0), results.face(index)) for index in indices]
        self.magnification = options.magnification or self.chosen_magnification(
            bodies, faces
        )
        self.low, self.high = np.full(3, np.inf), np.full(3, -np.inf)
        values = []
        for body in bodies:
            deformed = body.points + self.magnification * body["displacement"]
            for points in (body.points, deformed):
                self.low = np.minimum(self.low, points.min(axis=0))
                self.high = np.maximum(self.high, points.max(axis=0))
            # What is drawn lies between the extremes of each cell.
            of_cells = field(body, name)[body.cells]
            values += [of_cells.min(axis=1), of_cells.max(axis=1)]
        # The third stress, around the axis, is that of zz.
        self.axes = "$x$", "$y$"
        self.of_revolution = results.is_of_revolution()
        if self.of_revolution:
            self.axes = "$x$, radius", "$y$, along the axis"
        on_axis = self.low[0] < 1e-6 * self.size
        self.mirrored = self.of_revolution and (
            on_axis if options.mirror is None else options.mirror
        )
        if options.mirror and not self.mirrored:
            raise NoPicture("--mirror is for bodies of revolution")
        self.shade = style.Shade(np.concatenate(values), f'the field "{name}"')
        self.units = Units.of(results)
        kind = quantities.field(name)[1]
        if name == "estimator" and "quantity_total" in results.statistics:
            kind = None  # cells are estimated by what they do to a quantity
        self.unit = self.units.unit(kind, self.shade.ends())
        self.length = self.units.unit("length", [self.low, self.high])
        self.time = self.units.unit("time", [time for time, _ in results.solution])
        self.supports = Supports(results, self.units) if results.boundary() else None

    @property
    def size(self):
        return (self.high - self.low).max()

    def chosen_magnification(self, bodies, faces):
        """With which the deformation shows, folds no cell over and draws no body over
        another one."""
        largest = max(
            np.linalg.norm(body["displacement"], axis=1).max(initial=0.0)
            for body in bodies
        )
        factor = style.rounded_magnification(largest, max(body.size for body in bodies))
        most = min(map(factor_of_contact, faces), default=np.inf)
        while factor > 1.0 and (
            factor > most or any(folded(body, factor).any() for body in bodies)
        ):
            factor = max(style.next_smaller(factor), 1.0)
        return factor


def factor_of_contact(faces):
    """How much larger displacements may be drawn until two bodies with a gap between
    them at first, the face then and now, meet: 1 where they do."""
    before, now = faces
    if before is None or now is None or "gap" not in now:
        return np.inf
    _, nearest = cKDTree(before.points).query(now.points)
    gap = before["gap"][nearest]
    closed = np.where(gap > 1e-9 * now.size, 1.0 - now["gap"] / np.where(gap, gap, 1.0), 0.0)
    return 1.0 / max(closed.max(initial=0.0), 1e-300)


def folded(body, magnification):
    """Of each cell whether the displacement, drawn so large, turns a corner of
    it inside out."""
    before = corner_volumes(body.points, body.cells)
    deformed = body.points + magnification * body["displacement"]
    after = corner_volumes(deformed, body.cells)
    return (after * np.sign(before) <= 0.0).any(axis=1)


class Body:
    def __init__(self, results, index, scale):
        self.body = results.body(index)
        self.contact = results.face(index)
        self.rest = results.rest
        self.time = results.solution[index][0]
        self.name = results.name
        self.scale = scale
        self.magnification = scale.magnification
        self.deformed = self.moved(self.body)
        self.at_points = field(self.body, scale.name)
        self.values = self.at_points[self.body.cells].mean(axis=1)
        self.faces, self.owners, self.vertex = boundary_faces(self.body, self.body.size)

    def moved(self, record):
        return record.points + self.magnification * record["displacement"]

    def heading(self):
        """The title of a picture: what, when, and how large displacements are."""
        what = quantities.in_titles(quantities.field(self.scale.name)[0])
        time = self.scale.time.value(self.time)
        text = style.title(self.name, what, time, self.magnification)
        n_folded = np.count_nonzero(folded(self.body, self.magnification))
        if n_folded:
            text += f"\nWarning: this factor folds {n_folded} cells over"
        return text

    def color_bar(self, axes, flat):
        shade, unit = self.scale.shade, self.scale.unit
        name, _ = quantities.field(self.scale.name)
        separator = " " if flat else "\n"
        label = style.range_label(shade, name, self.at_points, unit, separator)
        add_color_bar(axes, shade.mappable(), label, unit, flat, extend=shade.extend)


def undeformed_key():
    return Line2D([], [], color=style.OUTLINE, lw=1.0, ls=DASHES, label="undeformed")
