#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Write the mesh files beside this script, one body in each of the formats.

two_materials.*: (0,2) x (0,1) in 2n x n squares, material 10 for x < 1 and 20
beyond, boundary 1 bottom, 2 right, 3 top, 4 left.
two_materials_3d.*: the same times (0,1) in z in 2n x n x n cubes, boundary 5 at
z = 0 and 6 at z = 1.
"""

from itertools import product
from pathlib import Path

HERE = Path(__file__).resolve().parent


def box(dim, n):
    """Nodes, cells and faces [(id, nodes in the order of a walk around)]."""
    number, nodes = {}, []
    for x in product(*(range(m + 1) for m in (2 * n, n, n)[:dim])):
        number[x] = len(nodes)
        nodes.append([c / n for c in x] + [0.0] * (3 - dim))
    walk = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = walk if dim == 2 else [(*w, z) for z in (0, 1) for w in walk]
    cells, faces = [], []
    ids = [(4, 2), (1, 3), (5, 6)]  # at the lower and upper end of each axis
    for x in product(*(range(m) for m in (2 * n, n, n)[:dim])):
        at = {c: number[tuple(a + b for a, b in zip(x, c))] for c in corners}
        cells.append((10 if x[0] < n else 20, list(at.values())))
        for axis, end in product(range(dim), (0, 1)):
            if x[axis] == (2 * n - 1 if axis == 0 else n - 1) * end:
                around = [(0,), (1,)] if dim == 2 else walk
                face = [w[:axis] + (end,) + w[axis:] for w in around]
                faces.append((ids[axis][end], [at[c] for c in face]))
    faces.sort(key=lambda face: face[0])
    return nodes, cells, faces


def line(*words):
    return " ".join(str(word) for word in words) + "\n"


def elements(dim, cells, faces):
    """[(type, id, nodes)], the faces first, as meshers write them."""
    return [(dim - 1, *face) for face in faces] + [(dim, *cell) for cell in cells]


def msh2(dim, nodes, cells, faces):
    types = {1: 1, 2: 3, 3: 5}
    everything = elements(dim, cells, faces)
    text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
    text += line("$Nodes") + line(len(nodes))
    for i, x in enumerate(nodes):
        text += line(i + 1, *x)
    text += line("$EndNodes") + line("$Elements") + line(len(everything))
    for i, (d, group, at) in enumerate(everything):
        text += line(i + 1, types[d], 2, group, group, *(n + 1 for n in at))
    return text + line("$EndElements")


def msh4(dim, nodes, cells, faces):
    types = {1: 1, 2: 3, 3: 5}
    everything = elements(dim, cells, faces)
    groups = sorted({(d, group) for d, group, _ in everything})
    text = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n"
    text += line(0, *(sum(d == e for e, _ in groups) for d in (1, 2, 3)))
    for d, group in groups:
        # number of the entity, its bounds, its group, what bounds it
        text += line(group + 100, *[0] * 3, *[2] * 3, 1, group, 0)
    text += "$EndEntities\n$Nodes\n" + line(1, len(nodes), 1, len(nodes))
    text += line(dim, 110, 0, len(nodes))
    text += "".join(line(i + 1) for i in range(len(nodes)))
    text += "".join(line(*x) for x in nodes)
    text += "$EndNodes\n$Elements\n"
    text += line(len(groups), len(everything), 1, len(everything))
    number = 0
    for group in groups:
        members = [at for d, i, at in everything if (d, i) == group]
        text += line(group[0], group[1] + 100, types[group[0]], len(members))
        for at in members:
            number += 1
            text += line(number, *(n + 1 for n in at))
    return text + line("$EndElements")


def ucd(dim, nodes, cells, faces):
    names = {1: "line", 2: "quad", 3: "hex"}
    everything = elements(dim, cells, faces)
    text = line("# two materials") + line(len(nodes), len(everything), 0, 0, 0)
    for i, x in enumerate(nodes):
        text += line(i + 1, *x)
    for i, (d, group, at) in enumerate(everything):
        text += line(i + 1, group, names[d], *(n + 1 for n in at))
    return text


def vtk(dim, nodes, cells, faces):
    types = {1: 3, 2: 9, 3: 12}
    everything = elements(dim, cells, faces)
    text = "# vtk DataFile Version 3.0\ntwo materials\nASCII\n"
    text += "DATASET UNSTRUCTURED_GRID\n" + line("POINTS", len(nodes), "double")
    text += "".join(line(*x) for x in nodes)
    size = sum(1 + len(at) for _, _, at in everything)
    text += line("CELLS", len(everything), size)
    text += "".join(line(len(at), *at) for _, _, at in everything)
    text += line("CELL_TYPES", len(everything))
    text += "".join(line(types[d]) for d, _, _ in everything)
    text += line("CELL_DATA", len(everything)) + "SCALARS MaterialID int 1\n"
    text += "LOOKUP_TABLE default\n"
    return text + "".join(line(group) for _, group, _ in everything)


def abaqus(dim, nodes, cells, faces):
    """Boundaries as surfaces of elements, materials by sections."""

    def row(*words):
        return ", ".join(str(word) for word in words) + "\n"

    text = "*HEADING\ntwo materials\n** as ABAQUS writes it\n*NODE\n"
    for i, x in enumerate(nodes):
        text += row(i + 1, *x[:dim])
    text += row("*ELEMENT", "TYPE=" + ("CPE4" if dim == 2 else "C3D8"))
    for i, (_, at) in enumerate(cells):
        text += row(i + 1, *(n + 1 for n in at))
    for group in (10, 20):
        text += row("*ELSET", f"ELSET=BLOCK-{group}")
        members = [i + 1 for i, cell in enumerate(cells) if cell[0] == group]
        for i in range(0, len(members), 8):
            text += row(*members[i : i + 8])
        text += row("*SOLID SECTION", f"ELSET=BLOCK-{group}", f"MATERIAL=M-{group}")
    sides = [(0, 1), (1, 2), (2, 3), (3, 0)]
    if dim == 3:
        sides = [(0, 1, 2, 3), (4, 5, 6, 7)] + [
            (a, b, b + 4, a + 4) for a, b in sides
        ]
    for group in sorted({face[0] for face in faces}):
        text += row("*SURFACE", "TYPE=ELEMENT", f"NAME=SURF-{group}")
        wanted = {frozenset(at) for i, at in faces if i == group}
        for i, (_, at) in enumerate(cells):
            for s, side in enumerate(sides):
                if frozenset(at[n] for n in side) in wanted:
                    text += row(i + 1, f"S{s + 1}")
    return text


def texts():
    """{name of the file: its text}"""
    formats = {
        "_2.msh": msh2,
        "_4.msh": msh4,
        ".ucd": ucd,
        ".vtk": vtk,
        ".inp": abaqus,
    }
    return {
        name + suffix: write(dim, *box(dim, n))
        for suffix, write in formats.items()
        for dim, name, n in ((2, "two_materials", 2), (3, "two_materials_3d", 1))
    }


def main():
    for name, text in texts().items():
        (HERE / name).write_text(text)


if __name__ == "__main__":
    main()
