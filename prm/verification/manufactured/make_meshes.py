#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Write the distorted meshes beside this script: the unit square in 4 x 4
quadrilaterals and the unit cube in 2 x 2 x 2 hexahedra, whose inner nodes, and
the ones within faces, are displaced by up to a fifth of the mesh width.

Boundary ids are those of a colorized subdivided_hyper_rectangle.
"""

import random
from itertools import product
from pathlib import Path

HERE = Path(__file__).resolve().parent


def mesh(dim, n, rng):
    walk = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = walk if dim == 2 else [(*w, z) for z in (0, 1) for w in walk]
    number, nodes = {}, []
    for x in product(range(n + 1), repeat=dim):
        number[x] = len(nodes)
        moved = [
            (c + (rng.uniform(-0.2, 0.2) if 0 < c < n else 0)) / n for c in x
        ]
        nodes.append(moved + [0.0] * (3 - dim))
    cells, faces = [], []
    for x in product(range(n), repeat=dim):
        at = {c: number[tuple(a + b for a, b in zip(x, c))] for c in corners}
        cells.append(list(at.values()))
        for axis, end in product(range(dim), (0, 1)):
            if x[axis] == (n - 1) * end:
                around = [(0,), (1,)] if dim == 2 else walk
                face = [w[:axis] + (end,) + w[axis:] for w in around]
                faces.append((2 * axis + end, [at[c] for c in face]))
    return nodes, cells, faces


def text(dim, nodes, cells, faces):
    types = {1: 1, 2: 3, 3: 5}
    elements = [(types[dim - 1], *face) for face in faces]
    elements += [(types[dim], 0, cell) for cell in cells]
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", len(nodes)]
    lines += [
        f"{i + 1} {x[0]:.6f} {x[1]:.6f} {x[2]:.6f}" for i, x in enumerate(nodes)
    ]
    lines += ["$EndNodes", "$Elements", len(elements)]
    for i, (kind, group, at) in enumerate(elements):
        words = [i + 1, kind, 2, group, group, *(n + 1 for n in at)]
        lines.append(" ".join(map(str, words)))
    return "\n".join(map(str, lines + ["$EndElements"])) + "\n"


if __name__ == "__main__":
    for dim, n in ((2, 4), (3, 2)):
        mesh_text = text(dim, *mesh(dim, n, random.Random(dim)))
        (HERE / f"distorted_{dim}d.msh").write_text(mesh_text)
