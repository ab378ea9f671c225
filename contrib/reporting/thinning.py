# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fewer faces in place of many. Both ways return the new faces and, for each of the
old ones, the new one that stands for it, -1 where none does."""

import numpy as np


def merged(faces, most):
    """Four faces that a larger one was divided into become that one again, as often as
    it takes and is possible. Refined cells, and their faces on a boundary, follow each
    other in the files of the program."""
    owner = np.arange(len(faces))
    while len(faces) > most:
        starts, parents = families(faces)
        if not len(starts):
            break
        leader = np.arange(len(faces))
        for child in range(1, 4):
            leader[starts + child] = starts
        faces = faces.copy()
        faces[starts] = parents
        kept, new = np.unique(leader, return_inverse=True)
        faces, owner = faces[kept], new.ravel()[owner]
    return faces, owner


def families(faces):
    """Where four faces in a row make up a larger one, and the corners of these."""
    n = len(faces) - 3
    if n < 1:
        return np.empty(0, dtype=int), np.empty((0, 4), dtype=int)
    four = np.stack([faces[i : n + i] for i in range(4)], axis=1)
    # The middle is a corner of all four: in which place of the first?
    common = np.array(
        [(four == four[:, :1, k : k + 1]).any(axis=2).all(axis=1) for k in range(4)]
    )
    good = common.sum(axis=0) == 1
    middle = four[np.arange(n), 0, common.argmax(axis=0)]
    # From the middle around each face: edge, corner of the large face, edge.
    place = (four == middle[:, None, None]).argmax(axis=2)

    def around(step):
        return np.take_along_axis(four, (place + step)[..., None] % 4, axis=2)[..., 0]

    edge, corner, next_edge = around(1), around(2), around(3)
    parents = np.empty((n, 4), dtype=int)
    at = np.zeros(n, dtype=int)
    seen = np.zeros((n, 4), dtype=bool)
    rows = np.arange(n)
    for i in range(4):
        parents[:, i] = corner[rows, at]
        seen[rows, at] = True
        follows = edge == next_edge[rows, at][:, None]
        good &= follows.sum(axis=1) == 1
        at = follows.argmax(axis=1)
    good &= seen.all(axis=1)
    starts, free = [], 0
    for start in np.nonzero(good)[0]:
        if start >= free:
            starts.append(start)
            free = start + 4
    starts = np.array(starts, dtype=int)
    return starts, parents[starts]


def clustered(faces, edges, places, most):
    """The vertices in each cell of a lattice become one of them, the lattice as coarse
    as it takes: for meshes that are fine from the start. Returns the edges, too."""
    used = np.unique(faces)
    place = places[used] - places[used].min(axis=0)
    size = place.max()
    on_edges = np.zeros(len(places), dtype=bool)
    on_edges[edges] = True
    from_middle = np.linalg.norm(place - 0.5 * place.max(axis=0), axis=1)
    n = 4.0 * np.sqrt(most)
    stands_for = np.arange(len(places))
    while True:
        cells = np.floor(place / size * n + 0.5).astype(int)
        _, cluster = np.unique(cells, axis=0, return_inverse=True)
        cluster = cluster.ravel()
        # Of each cell the vertex that keeps the shape: on an edge, far outside.
        order = np.lexsort((-from_middle, ~on_edges[used], cluster))
        _, first = np.unique(cluster[order], return_index=True)
        stands_for[used] = used[order[first]][cluster]
        new = stands_for[faces]
        distinct = np.sort(new, axis=1)
        n_corners = 1 + (np.diff(distinct, axis=1) > 0).sum(axis=1)
        kept = np.nonzero(n_corners >= min(3, faces.shape[1]))[0]
        _, first, which = np.unique(
            distinct[kept], axis=0, return_index=True, return_inverse=True
        )
        if len(first) <= most:
            break
        n *= 0.9
    owner = np.full(len(faces), -1)
    owner[kept] = which.ravel()
    edges = np.unique(np.sort(stands_for[edges], axis=1), axis=0)
    return new[kept[first]], edges[edges[:, 0] != edges[:, 1]], owner
