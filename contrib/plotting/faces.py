# SPDX-License-Identifier: LGPL-2.1-or-later
"""The contact boundary in flat pieces with coordinates of their own."""

import numpy as np
from scipy.spatial import cKDTree

from .geometry import newell_normals, weld
from .layout import is_flat
from .results import NoPicture
from .style import NO_FRICTION

SAME_DIRECTION = 1.0 - 1e-6
SAME_PLANE = 1e-4  # of the size: coordinates have single precision


def friction_state(contact):
    """SLIPPING, STICKING or NO_FRICTION at each point of the contact face."""
    if "stick" not in contact:
        return np.full(len(contact.points), NO_FRICTION)
    slipping = contact["stick"] < 0.5
    return np.where(contact["bound"] > 0.0, slipping.astype(int), NO_FRICTION)


def state_runs(states):
    """Runs of equal states along a piece: (state, first node, last node)."""
    changes = np.nonzero(np.diff(states))[0] + 1
    return [
        (states[run[0]], run[0], run[-1])
        for run in np.split(np.arange(len(states)), changes)
    ]


class Line:
    """A straight piece of a contact boundary in 2D, along its arc length.

    nodes   a point of the record for each node, in order
    s       their arc lengths from the first, `start`
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
        return vectors[self.nodes, :2] @ self.tangent

    def label(self):
        ends = [
            "({:.4g}, {:.4g})".format(*(point + 0.0))
            for point in (self.start, self.end)
        ]
        return "arc length $s$ from {} to {}".format(*ends)


def lines(contact):
    """The straight pieces of a contact boundary in 2D, the longest first.

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
    """The faces of the contact boundary in one plane, seen from the foundation.

    The horizontal axis points along an axis of space where one lies in the
    plane, the outward normal of the body towards the viewer.
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
        # Axes count along the axes of space, also where these point to the
        # left or down.
        self.reversed = []
        for i, direction in enumerate(self.directions):
            d = np.argmax(np.abs(direction))
            if direction[d] < -SAME_DIRECTION:
                self.directions[i] *= -1.0
                self.plane[:, i] *= -1.0
                self.reversed.append(i)
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

    def name(self):
        """Where the plane is: one coordinate, or its normal."""
        d = np.argmax(np.abs(self.normal))
        if abs(self.normal[d]) > SAME_DIRECTION:
            at = self.contact.points[self.cells].mean(axis=(0, 1))[d]
            return f"{'xyz'[d]} = {at + 0.0:.4g}"
        return "normal ({})".format(
            ", ".join(f"{component + 0.0:.2f}" for component in self.normal)
        )

    def project(self, vectors):
        return vectors @ self.directions.T

    def prepare(self, axes):
        """Limits, labels and orientation of the panel."""
        axes.set_aspect("equal")
        # The record may have points of other planes.
        place = self.plane[np.unique(self.cells)]
        margin = 0.04 * np.ptp(place, axis=0)
        (left, bottom), (right, top) = place.min(axis=0), place.max(axis=0)
        axes.set_xlim(left - margin[0], right + margin[0])
        axes.set_ylim(bottom - margin[1], top + margin[1])
        if 0 in self.reversed:
            axes.invert_xaxis()
        if 1 in self.reversed:
            axes.invert_yaxis()
        axes.set_xlabel(self.label(0))
        axes.set_ylabel(self.label(1))


def planes(contact, body):
    """The planes of the contact boundary, the largest first."""
    polygons = contact.points[contact.cells]
    centres = polygons.mean(axis=1)
    normals = newell_normals(polygons)
    # Faces are not oriented; the cell behind one says where outside is.
    cells = body.points[body.cells].mean(axis=1)
    _, nearest = cKDTree(cells).query(centres)
    inwards = ((centres - cells[nearest]) * normals).sum(axis=1) < 0.0
    normals[inwards] *= -1.0
    offsets = (centres * normals).sum(axis=1) / contact.size
    found = [
        Plane(contact, contact.cells[members], normal)
        for normal, members in groups(normals, offsets)
    ]
    return sorted(
        found, key=lambda plane: (-round(plane.area / contact.size**2, 3), plane.name())
    )


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
    return contact
