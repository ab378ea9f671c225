# SPDX-License-Identifier: LGPL-2.1-or-later
"""What can be seen of a mesh: its cells in two dimensions, its surface in three, and
fewer faces in their place where these are too many for a page."""

import numpy as np

from plotting.geometry import boundary_faces, sharp_edges, weld

from . import thinning

MOST_FACES = 20000


class Surface:
    """Faces of a record, numbered by the vertices that they share.

    vertices  a point of the record for each vertex
    faces     numbers of vertices: four of each face, or two in a line
    edges     pairs of vertices: the outline, in space where the surface has edges
    n_before  how many faces there were before they were thinned
    """

    def __init__(self, record, most=MOST_FACES, moved=None):
        outline, _, vertex = boundary_faces(record, record.size, moved)
        faces = record.cells
        if record.cells.shape[1] != 4:
            faces = outline
            outline, _ = sharp_edges(faces, vertex, record.points)
            outline, _ = sharp_edges(faces, vertex, record.points)
        self.set_up(record, faces, outline, vertex, most)

    @staticmethod
    def of_face(record, most=MOST_FACES):
        """The contact boundary."""
        self = Surface.__new__(Surface)
        vertex = weld(record.points, 1e-6 * record.size)
        self.set_up(record, record.cells, np.empty((0, 2), dtype=int), vertex, most)
        return self

    def set_up(self, record, faces, outline, vertex, most):
        # A point of each face has the values of its cell.
        self.corners = faces[:, 0]
        self.owner = np.arange(len(faces))  # the face that each has become, or -1
        self.n_before = len(faces)
        self.faces = vertex[faces]
        self.edges = vertex[outline].reshape(-1, 2)
        places = np.empty((vertex.max() + 1, 3))
        places[vertex] = record.points
        if len(faces) > most and faces.shape[1] == 4:
            self.replace(*thinning.merged(self.faces, most))
        if len(self.faces) > most:
            faces, self.edges, owner = thinning.clustered(
                self.faces, self.edges, places, most
            )
            self.replace(faces, owner)
        # Only the vertices that are left.
        used = np.unique(np.concatenate([self.faces.ravel(), self.edges.ravel()]))
        point = np.empty(len(places), dtype=int)
        point[vertex] = np.arange(len(vertex))
        self.vertices = point[used]
        self.faces = np.searchsorted(used, self.faces)
        self.edges = np.searchsorted(used, self.edges)

    def replace(self, faces, owner):
        self.faces = faces
        self.owner = np.where(self.owner >= 0, owner[self.owner], -1)

    def on_faces(self, values):
        """Values at points that are constant in cells, on the faces: means of those
        that a face stands for."""
        kept = self.owner >= 0
        sums = np.bincount(
            self.owner[kept], values[self.corners[kept]], minlength=len(self.faces)
        )
        return sums / np.bincount(self.owner[kept], minlength=len(self.faces))
