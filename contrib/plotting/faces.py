# SPDX-License-Identifier: LGPL-2.1-or-later
"""The contact boundary in flat pieces with coordinates of their own."""

import numpy as np
from scipy.spatial import cKDTree

from .geometry import chains, newell_normals, weld
from .layout import is_flat
from .results import NoPicture
from .style import NO_CONTACT, NO_FRICTION
from .units import Unit, show

SAME_DIRECTION = 1.0 - 1e-6
SMOOTH = np.cos(np.radians(30.0))  # of two faces of a curved piece
SAME_PLANE = 1e-4  # of the size: coordinates have single precision


def friction_state(contact):
    """SLIPPING, STICKING, NO_FRICTION or, where an open face has no bound either,
    NO_CONTACT at each point of the contact face."""
    states = np.full(len(contact.points), NO_FRICTION)
    if is_unilateral(contact):
        is_open = (contact["contact_pressure"] <= 0.0) & (contact["gap"] > 0.0)
        states[is_open] = NO_CONTACT
    if "stick" not in contact:
        return states
    sticking = contact["stick"] >= 0.5
    slipping = ~sticking
    moved = np.zeros(len(slipping), bool)
    if "slip_rate" in contact:
        rate = np.linalg.norm(contact["slip_rate"], axis=1)
        slipping &= rate >= contact.rest  # and not at its bound, at rest
        # What another condition moves along the face only sticks across that. Without
        # slip rates are rounding.
        largest = rate[slipping].max(initial=0.0)
        # (hanging nodes have means of their neighbors.)
        moved = (contact["stick"] > 0.999) & (largest > 0.0) & (rate > 1e-6 * largest)
    has_friction = (contact["bound"] > 0.0) & ~moved
    states = np.where(has_friction, slipping.astype(int), states)
    return states if contact.cells.shape[1] != 2 else with_held_ends(contact, states)


def with_held_ends(contact, states):
    """The states in the plane, where an end of the face at which symmetry or another
    condition holds the node, so that it has no friction, looks as the node beside it.
    """
    vertex = weld(contact.points, 1e-6 * contact.size)
    first, second = contact.cells.T
    ends = np.bincount(vertex[contact.cells].ravel()) == 1
    result = states.copy()
    for node, other in (first, second), (second, first):
        held = ends[vertex[node]] & (states[node] == NO_FRICTION)
        held &= contact["bound"][other] > 0.0
        result[node[held]] = states[other[held]]
    return result


def is_unilateral(contact):
    """Whether there is contact that opens and closes."""
    return "contact_pressure" in contact


def state_runs(states):
    """Runs of equal states along a piece: (state, first node, last node)."""
    changes = np.nonzero(np.diff(states))[0] + 1
    return [
        (states[run[0]], run[0], run[-1])
        for run in np.split(np.arange(len(states)), changes)
    ]


class Line:
    """A straight piece of a contact boundary in 2D, along its arc length.

    nodes    a point of the record for each node, in order
    s        their arc lengths from the first, `start`
    tangent  one, or one for each node
    """

    def __init__(self, contact, cells, tangent):
        along = contact.points[:, :2] @ tangent
        cells = cells.copy()
        backwards = along[cells[:, 0]] > along[cells[:, 1]]
        cells[backwards] = cells[backwards][:, ::-1]
        cells = cells[np.argsort(along[cells].mean(axis=1))]
        self.tangent = tangent
        self.nodes = np.append(cells[:, 0], cells[-1, 1])
        self.s = along[self.nodes] - along[self.nodes[0]]
        self.start, self.end = contact.points[self.nodes[[0, -1]], :2]
        self.length = self.s[-1]

    def component(self, vectors):
        """The component along the piece at its nodes."""
        return (vectors[self.nodes, :2] * self.tangent).sum(axis=1)

    def label(self, length):
        """What its arc length is, in a unit."""
        ends = [
            "({:.4g}, {:.4g})".format(*(point / length.size + 0.0))
            for point in (self.start, self.end)
        ]
        return "arc length $s$ from {} to {}".format(*ends)


class Curve(Line):
    """A curved piece: straight ones that meet smoothly."""

    def __init__(self, contact, nodes):
        self.nodes = nodes
        corners = contact.points[nodes, :2]
        steps = np.diff(corners, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        self.s = np.append(0.0, np.cumsum(lengths))
        directions = steps / lengths[:, None]
        around = np.concatenate([directions[:1], directions, directions[-1:]])
        tangents = around[1:] + around[:-1]
        self.tangent = tangents / np.linalg.norm(tangents, axis=1)[:, None]
        self.start, self.end = corners[[0, -1]]
        self.length = self.s[-1]


def curves(contact, pieces):
    """The pieces, with those that meet smoothly put together."""
    vertex = weld(contact.points, 1e-6 * contact.size)
    normals = [np.array([-piece.tangent[1], piece.tangent[0]]) for piece in pieces]
    found = []
    for members in smooth(normals, [vertex[piece.nodes] for piece in pieces]):
        if len(members) == 1:
            found.append(pieces[members[0]])
            continue
        nodes = np.concatenate([pieces[i].nodes for i in members])
        point = dict(zip(vertex[nodes], nodes))
        edges = [
            edge
            for i in members
            for edge in zip(vertex[pieces[i].nodes], vertex[pieces[i].nodes][1:])
        ]
        for chain in chains(edges):
            here = np.array([point[v] for v in chain])
            way = contact.points[here[-1], :2] - contact.points[here[0], :2]
            backwards = way[np.argmax(np.abs(way) > 1e-3 * contact.size)] < 0.0
            found.append(Curve(contact, here[::-1] if backwards else here))
    return found


def smooth(normals, vertices):
    """Sets of pieces that meet at small angles, as lists of their numbers."""
    label = list(range(len(normals)))

    def of(i):
        while label[i] != i:
            i = label[i]
        return i

    at = {}
    for i, places in enumerate(vertices):
        for v in np.unique(places):
            at.setdefault(v, []).append(i)
    for meeting in at.values():
        for n, i in enumerate(meeting):
            for j in meeting[:n]:
                if abs(normals[i] @ normals[j]) > SMOOTH:
                    label[of(i)] = of(j)
    sets = {}
    for i in range(len(normals)):
        sets.setdefault(of(i), []).append(i)
    return list(sets.values())


def lines(contact):
    """The straight pieces of a contact boundary in 2D, the longest first; with
    contact that opens and closes curved ones, too.

    The order depends on the boundary only, not on the mesh of the moment.
    """
    size = contact.size
    ends = contact.points[contact.cells][:, :, :2]
    directions = ends[:, 1] - ends[:, 0]
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    leading = np.argmax(np.abs(directions) > 1e-3, axis=1)
    directions *= np.sign(directions[np.arange(len(leading)), leading])[:, None]
    middles = ends.mean(axis=1)
    offsets = directions[:, 0] * middles[:, 1] - directions[:, 1] * middles[:, 0]
    offsets /= size
    found = []
    for tangent, members in groups(directions, offsets):
        members = members[np.argsort(middles[members] @ tangent)]
        low, high = np.sort(ends[members] @ tangent, axis=1).T
        gaps = np.nonzero(low[1:] > high[:-1] + 1e-5 * size)[0] + 1
        for part in np.split(members, gaps):
            found.append(Line(contact, contact.cells[part], tangent))
    if is_unilateral(contact):
        found = curves(contact, found)
    return sorted(
        found,
        key=lambda line: (
            -round(line.length / size, 3),
            *np.round(line.start / size, 3),
            *np.round(line.end / size, 3),
        ),
    )


def groups(directions, offsets):
    """Members of each set of equal direction and offset: (direction, indices)."""
    found = []
    for i, (direction, offset) in enumerate(zip(directions, offsets)):
        for other in found:
            same = direction @ other[0] > SAME_DIRECTION
            if same and abs(offset - other[1]) < SAME_PLANE:
                other[2].append(i)
                break
        else:
            found.append((direction, offset, [i]))
    return [(direction, np.array(members)) for direction, _, members in found]


class Plane:
    """The faces of the contact boundary in one plane.

    The horizontal axis points along an axis of space where one lies in the
    plane.  Axes count to the right and upwards along those of space: so some
    planes are seen from the foundation, with the outward normal of the body
    towards the viewer, the others through the body.
    """

    def __init__(self, contact, cells, normal):
        self.contact = contact
        self.cells = cells
        order = sorted(range(3), key=lambda d: (round(abs(normal[d]), 6), d))
        first = min(order[:2])
        u = np.eye(3)[first] - normal[first] * normal
        u /= np.linalg.norm(u)
        self.directions = np.array([u, np.cross(normal, u)])
        self.plane = contact.points @ self.directions.T
        self.through_the_body = False
        for i, direction in enumerate(self.directions):
            d = np.argmax(np.abs(direction))
            if direction[d] < -SAME_DIRECTION:
                self.directions[i] *= -1.0
                self.plane[:, i] *= -1.0
                self.through_the_body = not self.through_the_body
        polygons = self.plane[cells]
        following = np.roll(polygons, -1, axis=1)
        twice = (
            polygons[:, :, 0] * following[:, :, 1]
            - polygons[:, :, 1] * following[:, :, 0]
        )
        self.area = 0.5 * np.abs(twice.sum(axis=1)).sum()
        self.normal = normal

    def vertex(self):
        """A number for each point of the record, equal at the same place."""
        return weld(self.contact.points, 1e-6 * self.contact.size)

    def aspect(self):
        """Height over width."""
        width, height = np.ptp(self.plane[np.unique(self.cells)], axis=0)
        return height / width

    def is_flat(self):
        return is_flat(self.aspect())

    def label(self, i):
        for component, name in zip(self.directions[i], "xyz"):
            if component > SAME_DIRECTION:
                return f"${name}$"
        return "along ({})".format(
            ", ".join(f"{component + 0.0:.2f}" for component in self.directions[i])
        )

    def view(self):
        side = "through the body" if self.through_the_body else "from the foundation"
        return f"seen {side}"

    def name(self, length):
        """Where the plane is: one coordinate in a unit, or its normal."""
        d = np.argmax(np.abs(self.normal))
        if abs(self.normal[d]) > SAME_DIRECTION:
            at = self.contact.points[self.cells].mean(axis=(0, 1))[d]
            return f"${'xyz'[d]}$ = {length.value(at + 0.0)}"
        return "normal ({})".format(
            ", ".join(f"{component + 0.0:.2f}" for component in self.normal)
        )

    def project(self, vectors):
        return vectors @ self.directions.T

    def holds(self, place):
        """Whether a point of space lies in the plane."""
        here = self.contact.points[self.cells[0, 0]]
        return abs((place - here) @ self.normal) < SAME_PLANE * self.contact.size

    def prepare(self, axes, length, beside=0.0):
        """Limits and labels of the panel, with room for arrows so long."""
        axes.set_aspect("equal")
        # The record may have points of other planes.
        place = self.plane[np.unique(self.cells)]
        margin = np.maximum(0.04 * np.ptp(place, axis=0), beside)
        (left, bottom), (right, top) = place.min(axis=0), place.max(axis=0)
        axes.set_xlim(left - margin[0], right + margin[0])
        axes.set_ylim(bottom - margin[1], top + margin[1])
        show(axes.xaxis, self.label(0), length)
        show(axes.yaxis, self.label(1), length)


def lies_on_contact(place, contact, body):
    """Whether a point of space lies in a plane of the contact boundary."""
    return contact is not None and any(
        plane.holds(place) for plane in planes(contact, body)
    )


def planes(contact, body):
    """The planes of the contact boundary, the largest first."""
    polygons = contact.points[contact.cells]
    centers = polygons.mean(axis=1)
    normals = newell_normals(polygons)
    # Faces are not oriented; the cell behind one says where outside is.
    cells = body.points[body.cells].mean(axis=1)
    _, nearest = cKDTree(cells).query(centers)
    inwards = ((centers - cells[nearest]) * normals).sum(axis=1) < 0.0
    normals[inwards] *= -1.0
    offsets = (centers * normals).sum(axis=1) / contact.size
    parts = groups(normals, offsets)
    if is_unilateral(contact):
        parts = surfaces(contact, normals, polygons, parts)
    found = [
        Plane(contact, contact.cells[members], normal) for normal, members in parts
    ]
    return sorted(
        found,
        key=lambda plane: (
            -round(plane.area / contact.size**2, 3),
            plane.name(Unit(1.0, "")),
        ),
    )


def surfaces(contact, normals, polygons, parts):
    """The parts, with those that meet smoothly put together, as seen along the
    mean of their normals."""
    vertex = weld(contact.points, 1e-6 * contact.size)
    corners = [vertex[contact.cells[members]] for _, members in parts]
    areas = np.linalg.norm(
        np.cross(polygons[:, 2] - polygons[:, 0], polygons[:, 3] - polygons[:, 1]),
        axis=1,
    )
    found = []
    for together in smooth([normal for normal, _ in parts], corners):
        members = np.concatenate([parts[i][1] for i in together])
        mean = areas[members] @ normals[members]
        size = np.linalg.norm(mean)
        if len(together) == 1 or size <= 1e-3 * areas[members].sum():
            found += [parts[i] for i in together]
        else:
            found.append((mean / size, members))
    return found


def required(results, index):
    """The contact boundary, or the sentence that says that there is none."""
    if not results.contact:
        raise NoPicture(
            f"{results.directory} has no contact.pvd: a scene without contact"
        )
    contact = results.face(index)
    if contact is None:
        raise NoPicture(
            f"contact.pvd has no entry for t = {results.solution[index][0]:g}"
        )
    slip, moved = contact["slip"], contact["displacement"]
    if np.abs(slip).max(initial=0.0) < 1e-9 * np.abs(moved).max(initial=0.0):
        for name in ("slip", "slip_rate"):  # rounding
            contact.data[name] = 0.0 * contact[name]
    return contact
