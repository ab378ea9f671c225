# SPDX-License-Identifier: LGPL-2.1-or-later
"""Meshes without physics: welding, boundary faces, edges, choice of nodes."""

import math

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

# The faces of a hexahedron in VTK's numbering, seen from outside
# counterclockwise.
HEXAHEDRON_FACES = (
    (0, 4, 7, 3),
    (1, 2, 6, 5),
    (0, 1, 5, 4),
    (3, 7, 6, 2),
    (0, 3, 2, 1),
    (4, 5, 6, 7),
)
QUADRILATERAL_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0))


def weld(points, tolerance):
    """A number for each point, equal for points at the same place."""
    tree = cKDTree(points)
    pairs = tree.query_pairs(tolerance, output_type="ndarray")
    graph = coo_matrix(
        (np.ones(len(pairs), dtype=bool), (pairs[:, 0], pairs[:, 1])),
        shape=(len(points), len(points)),
    )
    return connected_components(graph, directed=False)[1]


def boundary_faces(record, size, moved=None):
    """The faces (edges in 2D) of cells on the boundary of the body.

    Returns the point numbers of each, the cell it belongs to, and a number for each
    point, equal for those at the same place that move alike: bodies may touch.  A
    face on the boundary belongs to one cell.  So does a face between cells of
    different size, but there the vertex hanging on the large face and its
    corners span the small ones.

    moved  displacements that tell bodies apart; those of the record by default
    """
    if record.cells.shape[1] == 4:
        local_faces, diagonals = QUADRILATERAL_EDGES, ((0, 1),)
    else:
        local_faces, diagonals = HEXAHEDRON_FACES, ((0, 2), (1, 3))
    if moved is None:
        moved = getattr(record, "data", {}).get("displacement", np.zeros(0))
    places, largest = record.points, np.abs(moved).max(initial=0.0)
    if largest > 0.0:  # to 1e-5 of the largest
        places = np.column_stack([places, moved * (0.1 * size / largest)])
    vertex = weld(places, 1e-6 * size)

    faces = np.concatenate([record.cells[:, face] for face in local_faces])
    owners = np.tile(np.arange(len(record.cells)), len(local_faces))
    keys = np.sort(vertex[faces], axis=1)
    _, first, count = np.unique(
        keys, axis=0, return_index=True, return_counts=True
    )
    single = first[count == 1]
    faces, owners = faces[single], owners[single]

    corners = vertex[faces]
    by_diagonal = {}
    for i, face in enumerate(corners):
        for a, b in diagonals:
            by_diagonal[frozenset((face[a], face[b]))] = i

    where = np.unique(faces.ravel())
    tree = cKDTree(record.points[where])
    centers = record.points[faces].mean(axis=1)
    distance, nearest = tree.query(centers)
    extent = np.linalg.norm(
        record.points[faces[:, 0]]
        - record.points[faces[:, diagonals[0][1]]],
        axis=1,
    )
    interior = np.zeros(len(faces), dtype=bool)
    for i in np.nonzero(distance < 0.25 * extent)[0]:
        hanging = vertex[where[nearest[i]]]
        children = [
            by_diagonal.get(frozenset((corner, hanging)))
            for corner in corners[i]
        ]
        if None not in children:
            interior[[i, *children]] = True
    return faces[~interior], owners[~interior], vertex


def unique_edges(cells, vertex):
    """The edges of quadrilaterals, pairs of points, each edge once."""
    edges = np.concatenate([cells[:, edge] for edge in QUADRILATERAL_EDGES])
    _, first = np.unique(np.sort(vertex[edges], axis=1), axis=0, return_index=True)
    return edges[first]


def chains(edges):
    """The polylines that edges, pairs of vertices, make up.

    Dashes start afresh with every line: a line for each edge of a fine mesh
    would be a solid one.
    """
    neighbors = {}
    for a, b in edges:
        neighbors.setdefault(a, []).append(b)
        neighbors.setdefault(b, []).append(a)
    # Open chains from their ends first, then the closed ones.
    starts = sorted(neighbors, key=lambda vertex: len(neighbors[vertex]) == 2)
    found = []
    for start in starts:
        while neighbors[start]:
            chain = [start]
            while neighbors[chain[-1]]:
                following = neighbors[chain[-1]].pop()
                neighbors[following].remove(chain[-1])
                chain.append(following)
            found.append(chain)
    return found


def newell_normals(polygons):
    """Unit normals of (not quite plane) polygons, shape (n, corners, 3)."""
    following = np.roll(polygons, -1, axis=1)
    normals = np.cross(polygons, following).sum(axis=1)
    return normals / np.maximum(
        np.linalg.norm(normals, axis=1, keepdims=True), 1e-300
    )


def sharp_edges(faces, vertex, points, angle=30.0):
    """Edges where the boundary has a corner: their points, their two faces."""
    normals = newell_normals(points[faces])
    meeting = {}
    for i, face in enumerate(faces):
        for a, b in zip(face, np.roll(face, -1)):
            key = frozenset((vertex[a], vertex[b]))
            meeting.setdefault(key, []).append((i, (a, b)))
    edges, neighbors = [], []
    limit = math.cos(math.radians(angle))
    for found in meeting.values():
        if len(found) == 2:
            i, j = found[0][0], found[1][0]
            if normals[i] @ normals[j] < limit:
                edges.append(found[0][1])
                neighbors.append((i, j))
    return np.array(edges).reshape(-1, 2), np.array(neighbors).reshape(-1, 2)


def thinned(place, nodes, distance):
    """Some of the nodes, in no direction closer to each other than `distance`.

    Row by row, so that those of a regular mesh are a regular pattern.
    """
    rows = np.round(place[nodes] / (1e-3 * distance))
    kept = np.empty((0, 2))
    chosen = []
    for node in nodes[np.lexsort((rows[:, 0], rows[:, 1]))]:
        off = np.abs(kept - place[node]).max(axis=1, initial=0.0)
        if not len(kept) or off.min() > 0.999 * distance:
            kept = np.vstack([kept, place[node]])
            chosen.append(node)
    return np.array(chosen, dtype=int)


def corner_volumes(points, cells):
    """The (signed) area or volume that the edges span at each corner of a cell,
    shape (cells, corners)."""
    corners = points[cells]
    if cells.shape[1] == 4:
        ahead = np.roll(corners, -1, axis=1) - corners
        behind = np.roll(corners, 1, axis=1) - corners
        return ahead[:, :, 0] * behind[:, :, 1] - ahead[:, :, 1] * behind[:, :, 0]
    beside = [
        [4 * (i // 4) + (i + 1) % 4, 4 * (i // 4) + (i + 3) % 4, (i + 4) % 8]
        for i in range(8)
    ]
    edges = corners[:, beside] - corners[:, :, None]
    return np.linalg.det(edges)
