# SPDX-License-Identifier: LGPL-2.1-or-later
"""Supports and loads: what the scene prescribes on each piece of the boundary.

The program writes where each boundary is; its role and the expressions of its
data are in parameters.prm.  What these say with words of their own, tables or
formulas of other programs, is not drawn.
"""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D
from matplotlib.markers import CARETUP
from matplotlib.patches import Patch
from scipy.spatial import cKDTree

from . import quantities, style
from .expression import evaluate
from .faces import is_unilateral
from .geometry import chains
from .results import UserError

INK = "#333333"
LOAD = style.SERIES[0]
MOTION = style.SERIES[2]
HATCHED = {
    "clamped": "clamped",
    "displacement": "prescribed displacement",
    "contact": "foundation",
    "unilateral": "contact that may open",
}
# Lengths in shares of the body's size.
REACH = {"symmetry": 0.025, "clamped": 0.025, "traction": 0.085}  # of symbols
REACH_OVER_GAP = 0.085
REACH_AT_REST, REACH_OF_ARROWS = 0.035, 0.1  # of what may move
GAP = {"contact": 0.012, "unilateral": 0.012}  # beside the bar of stick and slip
FARTHEST = 0.055  # where a foundation is drawn from the body
HATCH = 0.016
SPACING = 0.016
ROLLER = 0.009
SPRING = 0.04
LONGEST = 0.07  # of arrows


class Supports:
    def __init__(self, results, units):
        boundary = results.boundary()
        corners = boundary.points[boundary.cells]
        self.centers = corners.mean(axis=1)
        self.extents = np.ptp(corners, axis=1).max(axis=1)
        self.numbers = boundary["boundary_id"][boundary.cells[:, 0]].astype(int)
        self.tree = cKDTree(self.centers)
        self.parameters = results.data
        self.units = units
        self.axes = "xy" if boundary.cells.shape[1] == 2 else "xyz"

    def of(self, centers):
        """The boundary that each face belongs to, by its center: that of the face
        of the first mesh which holds it; none, -1, where a material has gone."""
        distance, near = self.tree.query(centers, k=min(8, len(self.centers)))
        distance, near = np.atleast_2d(distance), np.atleast_2d(near)
        held = np.argmin(distance / self.extents[near], axis=1)
        row = np.arange(len(near))
        # A finer face has its center within, a coarser one at a corner; faces of
        # a curved boundary are a little beside.
        reach = 0.6 if len(self.axes) == 2 else 0.75
        is_there = distance[row, held] <= reach * self.extents[near[row, held]]
        return np.where(is_there, self.numbers[near[row, held]], -1)

    def name(self, centers):
        """What the scene calls the boundary that most of these faces belong to, or
        nothing."""
        numbers, counts = np.unique(self.of(centers), return_counts=True)
        found = quantities.names_of_places.get(f"boundary {numbers[counts.argmax()]}")
        return quantities.plain(found) if found else None

    def role(self, number):
        """That of the scene; loaded pieces are not free, and contact may be
        unilateral; another body is no support."""
        role = self.parameters.get((f"Boundary {number}", "Role"), "free")
        if self.parameters.get((f"Boundary {number}", "Against"), "").strip():
            return "free"
        held = "", "not given", "bilateral", "given normal stress"
        if role == "contact" and self.entry(number, "Contact law") not in held:
            return "unilateral"
        return "traction" if role == "free" and self.is_loaded(number) else role

    def is_loaded(self, number):
        return bool(self.entry(number, "Pressure") or self.entry(number, "Traction"))

    def has_springs(self, number):
        return self.role(number) in ("traction", "displacement") and any(
            self.entry(number, f"{name} stiffness") for name in ("Normal", "Tangential")
        )

    def points(self):
        """The places of `Supports/Points'."""
        text = self.parameters.get(("Supports", "Points"), "")
        places = [part.partition(":")[0] for part in text.split(";") if part.strip()]
        try:
            return np.array([[float(x) for x in place.split(",")] for place in places])
        except ValueError:  # with units
            return np.zeros((0, len(self.axes)))

    def entry(self, number, name):
        text = self.parameters.get((f"Boundary {number}", name), "").strip()
        return "" if text == "0" else text

    def vector(self, number, name, places, time):
        """An entry with components at some places, zero where there is none."""
        return self.components(self.entry(number, name), places, time)

    def body_force(self, places, time):
        text = self.parameters.get(("Loads", "Body force"), "")
        return self.components(text.strip(), places, time)

    def components(self, text, places, time):
        values = np.zeros((len(places), len(self.axes)))
        for i, component in enumerate(text.split(";") if text else ()):
            if component.strip() not in ("free", ""):
                values[:, i] = self.scalar(component, places, time)
        return values

    def scalar(self, text, places, time):
        return evaluate(text, np.full(len(places), time), **dict(zip("xyz", places.T)))

    def traction(self, number, places, normals, time):
        """The load on a unit of area, without that on held components."""
        values = self.vector(number, "Traction", places, time)
        pressure = self.entry(number, "Pressure")
        if pressure:
            values -= self.scalar(pressure, places, time)[:, None] * normals
        return values

    def velocity(self, number, places, normals, time):
        """How fast what is prescribed there moves, over the last moment."""
        moment = min(1e-4 * self.units.duration, time)
        if moment <= 0.0:
            return np.zeros((len(places), len(self.axes)))

        def place(t):
            if self.role(number) == "displacement":
                return self.vector(number, "Displacement", places, t)
            values = self.vector(number, "Foundation motion", places, t)
            for name in self.distances(number):
                text = self.entry(number, name)
                if text:
                    values += self.scalar(text, places, t)[:, None] * normals
            return values

        return (place(time) - place(time - moment)) / moment

    def distances(self, number):
        """The entries that say how far a foundation is along the normal."""
        if self.role(number) == "unilateral":
            return "Gap", "Foundation displacement"
        # With a given pressure the foundation is wherever the body goes.
        if self.entry(number, "Friction law") == "coulomb":
            return ()
        return ("Foundation displacement",)

    def arrow(self, number, places, normals, time):
        """(direction, color, whether it pushes) of what moves or loads a boundary
        in the mean; no direction where nothing does."""
        role = self.role(number)
        nothing = None, None, False
        try:
            if role == "displacement":
                mean = self.velocity(number, places, normals, time).mean(axis=0)
            elif role == "traction":
                mean = self.traction(number, places, normals, time).mean(axis=0)
            else:
                return nothing
        except UserError:
            return nothing
        size = np.linalg.norm(mean)
        if size <= 0.0:
            return nothing
        pushes = role == "traction" and mean @ normals.mean(axis=0) < 0.0
        return mean / size, MOTION if role == "displacement" else LOAD, pushes

    def reach(self, number):
        """How far the symbols of a boundary stick out, in shares of the size."""
        role = self.role(number)
        if role == "unilateral" and not self.entry(number, "Foundation motion"):
            return REACH_OVER_GAP
        moved = role == "displacement" or any(
            self.entry(number, name)
            for name in ("Foundation motion", "Foundation displacement")
        )
        return REACH.get(role, REACH_OF_ARROWS if moved else REACH_AT_REST)

    def caption(self, length):
        """Where what is prescribed, for pictures in space."""
        found = []
        for number in np.unique(self.numbers):
            role = self.role(number)
            if role == "free":
                continue
            centers = self.centers[self.numbers == number]
            flat = np.ptp(centers, axis=0) < 1e-6 * np.ptp(self.centers, axis=0).max()
            place = quantities.place("boundary", number)
            if flat.any() and place == f"boundary {number}":
                d = int(np.argmax(flat))
                at = centers[0, d] + 0.0
                place = f"${'xyz'[d]}$ = {length.value(at)}"
            what = HATCHED.get(role, role)
            if self.has_springs(number):
                bare = role == "traction" and not self.is_loaded(number)
                what = "springs" if bare else f"{what} and springs"
            text = f"{place}: {what}"
            if text not in found:  # pieces of one face
                found.append(text)
        for point in self.points():
            found.append(f"held at ({', '.join(f'{x:g}' for x in point)})")
        if self.parameters.get(("Loads", "Body force"), "").strip():
            found.append("body force")
        return "; ".join(found)


class Piece:
    """A part of one boundary in two dimensions, a polyline on the deformed body.

    corners, outwards          its places, and the normals between them
    before, outwards_before    where they come from: of the mesh, which loads go by
    """

    def __init__(self, corners, before, outwards, outwards_before):
        self.corners, self.before = corners, before
        self.outwards, self.outwards_before = outwards, outwards_before
        steps = np.linalg.norm(np.diff(corners, axis=0), axis=1)
        self.s = np.append(0.0, np.cumsum(steps))

    def places(self, spacing):
        """Arc lengths about so far apart."""
        n = max(1, round(self.s[-1] / spacing))
        return (np.arange(n) + 0.5) * self.s[-1] / n

    def at(self, spacing, values):
        """Values of its corners at the points of sample()."""
        return np.interp(self.places(spacing), self.s, values)

    def segments(self, spacing):
        """Between which corners the points of sample() are."""
        at = self.places(spacing)
        return np.clip(np.searchsorted(self.s, at) - 1, 0, len(self.outwards) - 1)

    def normals_before(self, spacing):
        """The normals of the mesh at the points of sample()."""
        return self.outwards_before[self.segments(spacing)]

    def sample(self, spacing):
        """Points along it about so far apart, their normals, whence they come."""
        at = self.places(spacing)
        place, before = (
            np.column_stack([np.interp(at, self.s, values) for values in points.T])
            for points in (self.corners, self.before)
        )
        return place, self.outwards[self.segments(spacing)], before


def pieces(body, ids, number):
    """The pieces of a boundary."""
    faces = body.faces[ids == number]
    owners = body.owners[ids == number]
    n_vertices = body.vertex.max() + 1
    place, before = np.empty((n_vertices, 2)), np.empty((n_vertices, 2))
    place[body.vertex] = body.deformed[:, :2]
    before[body.vertex] = body.body.points[:, :2]
    centers = body.deformed[body.body.cells[owners]].mean(axis=1)[:, :2]
    inside = dict(zip(map(frozenset, body.vertex[faces]), centers))
    for chain in chains(body.vertex[faces]):
        corners = place[chain]
        normals, normals_before = right_of(corners), right_of(before[chain])
        for i, edge in enumerate(zip(chain, chain[1:])):
            if (corners[i] - inside[frozenset(edge)]) @ normals[i] < 0.0:
                normals[i] *= -1.0
                normals_before[i] *= -1.0
        yield Piece(corners, before[chain], normals, normals_before)


def right_of(corners):
    """The unit normals to the right of a polyline."""
    along = np.diff(corners, axis=0)
    normals = np.column_stack([along[:, 1], -along[:, 0]])
    return normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]


def reach(supports, scale):
    """How far symbols stick out of the body on each side: (low, high)."""
    low, high = np.zeros(2), np.zeros(2)
    middle = 0.5 * (scale.low + scale.high)[:2]
    extent = np.maximum(0.5 * (scale.high - scale.low)[:2], 1e-300)
    for number in np.unique(supports.numbers):
        if supports.role(number) != "free":
            centers = supports.centers[supports.numbers == number][:, :2]
            place = ((centers - middle) / extent).mean(axis=0)
            spread = np.ptp(centers, axis=0) / extent
            sticks_out = supports.reach(number) * scale.size
            for d in range(2):
                # On this side, or all around.
                everywhere = spread[d] > 1.5 and spread[1 - d] > 1.5
                if place[d] > 0.3 or everywhere:
                    high[d] = max(high[d], sticks_out)
                if place[d] < -0.3 or everywhere:
                    low[d] = max(low[d], sticks_out)
    return low, high


def draw(axes, body, supports):
    """Symbols outside the body; returns their keys."""
    size, time = body.scale.size, body.time
    centers = body.body.points[body.faces].mean(axis=1)
    ids = np.where(body.on_axis(body.faces), -1, supports.of(centers))
    hatched, rollers, pushed, lines, springs = [], [], [], [], []
    for number in np.unique(ids):
        role = supports.role(number)
        if role == "free":
            continue
        for piece in pieces(body, ids, number):
            if role == "unilateral":
                found = foundation(piece, supports, number, body)
                if len(found):
                    hatched.append(HATCHED[role])
                    lines += found
            elif role in HATCHED:
                found = hatching(piece, size, GAP.get(role, 0.0))
                # In a small hole the lines would cross.
                if np.ptp(found[:, 0], axis=0).max() > 6 * HATCH * size:
                    hatched.append(HATCHED[role])
                    lines.append(found)
            elif role == "symmetry":
                place, normals, _ = piece.sample(4 * SPACING * size)
                rollers.append(place + ROLLER * size * normals)
            if supports.has_springs(number):
                springs.append(spring_symbols(piece, size))
            try:
                if role == "traction" or (
                    role == "displacement" and supports.is_loaded(number)
                ):
                    pushed.append(load(piece, supports, number, size, time))
                if role in ("displacement", "contact", "unilateral"):
                    draw_motion(axes, piece, supports, number, size, time)
            except UserError:
                pass  # an expression of more than place and time
    handles = []
    if lines:
        axes.add_collection(
            LineCollection(np.concatenate(lines), colors=INK, linewidths=0.8, zorder=3)
        )
        label = ", ".join(dict.fromkeys(hatched))
        handles.append(Patch(fc="white", ec=INK, lw=0.0, hatch="/////", label=label))
    if springs:
        axes.add_collection(
            LineCollection(np.concatenate(springs), colors=INK, linewidths=0.8, zorder=3)
        )
        look = {"ls": "none", "marker": r"$\wr$", "ms": 10, "color": INK}
        handles.append(Line2D([], [], label="springs", **look))
    points = supports.points()
    if len(points):
        _, nodes = cKDTree(body.body.points[:, :2]).query(points)
        look = {"ls": "none", "marker": CARETUP, "ms": 9, "mfc": "white", "mec": INK}
        axes.plot(*body.deformed[nodes, :2].T, zorder=4, **look)
        handles.append(Line2D([], [], label="held points", **look))
    if rollers:
        look = {"ls": "none", "marker": "o", "ms": 4, "mfc": "white", "mec": INK}
        axes.plot(*np.concatenate(rollers).T, zorder=3, **look)
        handles.append(Line2D([], [], label="symmetry", **look))
    if pushed:
        handles += draw_loads(axes, pushed, body.scale)
    return handles + draw_body_force(axes, body, supports)


def hatching(piece, size, gap):
    """Short oblique lines beside a piece."""
    place, normals, _ = piece.sample(SPACING * size)
    along = np.column_stack([-normals[:, 1], normals[:, 0]])
    begin = place + gap * size * normals
    return np.stack([begin, begin + HATCH * size * (normals - along)], axis=1)


def spring_symbols(piece, size):
    """Zigzag lines from a piece to the ground."""
    place, normals, _ = piece.sample(4 * SPACING * size)
    along = np.column_stack([-normals[:, 1], normals[:, 0]])
    out = np.array([0, 0.25, 0.35, 0.5, 0.65, 0.75, 1, 1, 1]) * SPRING * size
    aside = np.array([0, 0, 1, -1, 1, 0, 0, -1, 1]) * 0.2 * SPRING * size
    corners = place[:, None] + out[:, None] * normals[:, None]
    corners = corners + aside[:, None] * along[:, None]
    return np.stack([corners[:, :-1], corners[:, 1:]], axis=2).reshape(-1, 2, 2)


def foundation(piece, supports, number, body):
    """The face of a foundation that the body may leave, where it is near the body,
    and short oblique lines behind it. The gap is as large as displacements are."""
    size, contact = body.scale.size, body.contact
    place, normals, before = piece.sample(SPACING * size)
    normal = supports.entry(number, "Foundation normal")
    if normal:
        normal = np.array([float(component) for component in normal.split(",")])
    else:
        # That of the flat piece, before it was deformed.
        along = piece.before[-1] - piece.before[0]
        normal = np.array([along[1], -along[0]])
        normal *= np.sign(normals.mean(axis=0) @ normal) or 1.0
    normal = normal / np.linalg.norm(normal)
    gap = np.zeros(len(place))
    if contact is not None and is_unilateral(contact):
        _, nearest = cKDTree(contact.points[:, :2]).query(piece.before)
        gap = piece.at(SPACING * size, contact["gap"][nearest])
    away = body.magnification * gap
    near = away <= FARTHEST * size
    face = place + (away + GAP["unilateral"] * size)[:, None] * normal
    along = np.array([-normal[1], normal[0]])
    segments = np.stack([face[:-1], face[1:]], axis=1)[near[:-1] & near[1:]]
    strokes = np.stack([face, face + HATCH * size * (normal - along)], axis=1)[near]
    return [part for part in (segments, strokes) if len(part)]


def load(piece, supports, number, size, time):
    """Places of arrows, their normals and their loads."""
    spacing = 4 * SPACING * size
    place, normals, before = piece.sample(spacing)
    given = supports.traction(number, before, piece.normals_before(spacing), time)
    return place, normals, given


def draw_loads(axes, loads, scale):
    """Arrows that push at the body with their heads and pull with their tails."""
    place, normals, force = map(np.concatenate, zip(*loads))
    largest = np.linalg.norm(force, axis=1).max(initial=0.0)
    if largest <= 0.0:
        return []
    arrows = LONGEST * scale.size * force / largest
    pushes = (force * normals).sum(axis=1) < 0.0
    axes.quiver(
        *np.where(pushes[:, None], place - arrows, place).T,
        *arrows.T,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        color=LOAD,
        width=0.0035,
        headwidth=5,
        headlength=6,
        headaxislength=5.5,
        minlength=0.0,
        zorder=3,
    )
    unit = scale.units.unit("stress", largest)
    return [load_key(f"load, at most {unit.value(largest)}", r"$\rightarrow$")]


def load_key(label, marker):
    """What the legend says of a load."""
    return Line2D([], [], label=label, color=LOAD, marker=marker, ms=14, ls="none")


def draw_body_force(axes, body, supports):
    """An arrow in the middle of the body for the mean force on a unit of volume."""
    before, deformed = (
        points[body.body.cells].mean(axis=1)[:, :2]
        for points in (body.body.points, body.deformed)
    )
    try:
        forces = supports.body_force(before, body.time)
    except UserError:  # an expression of more than place and time
        return []
    middle, force = deformed.mean(axis=0), forces.mean(axis=0)
    if np.linalg.norm(force) <= 0.0:
        return []
    sizes = np.linalg.norm(forces, axis=1)
    axes.quiver(
        *middle,
        *(LONGEST * body.scale.size * force / np.linalg.norm(force)),
        angles="xy",
        scale_units="xy",
        scale=1.0,
        pivot="mid",
        color=LOAD,
        edgecolor="white",
        linewidth=0.8,
        width=0.006,
        zorder=4,
    )
    unit = supports.units.unit("force density", sizes)
    least, largest = unit.value(sizes.min()), unit.value(sizes.max())
    label = f"body force {largest}"
    if least != largest:
        label = f"body force, {least} to {largest}"
    return [load_key(label, r"$\Rightarrow$")]


def draw_motion(axes, piece, supports, number, size, time):
    """An arrow that shows which way and how fast a piece is moved."""
    place, normals, before = piece.sample(piece.s[-1])
    velocity = supports.velocity(number, before, normals, time)[0]
    speed = np.linalg.norm(velocity)
    if speed <= 0.0:
        return
    arrow = LONGEST * size * velocity / speed
    middle = place[0] + 0.045 * size * normals[0]
    if abs(arrow @ normals[0]) > 0.5 * np.linalg.norm(arrow):
        middle = place[0] + 0.055 * size * normals[0]
    axes.annotate(
        "",
        middle + 0.5 * arrow,
        middle - 0.5 * arrow,
        arrowprops={"arrowstyle": "-|>", "color": MOTION, "lw": 2.0},
        annotation_clip=False,
        zorder=6,
    )
    text = supports.units.unit("velocity", speed).value(speed, 3)
    # Right of the body, before the color bar, there is no room beside the arrow.
    beside = ((1, 0), (4, 0), "left", "center"), ((0, 1), (0, 5), "center", "bottom")
    side, offset, ha, va = beside[int(normals[0, 0] > 0.5)]
    axes.annotate(
        text,
        middle + 0.5 * np.abs(arrow) * side,
        offset,
        textcoords="offset points",
        color=MOTION,
        fontsize="small",
        ha=ha,
        va=va,
        annotation_clip=False,
        zorder=6,
        path_effects=style.visible_anywhere(),
    )
