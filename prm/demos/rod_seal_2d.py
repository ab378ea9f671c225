#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Write the mesh of rod_seal_2d.prm: quadrilaterals in Gmsh's format 4.1.

    rod_seal_2d.py [--lip N] [--backing N] [--height N] [--straight] FILE.msh

The section of the seal, in meters, pressure on the left, the rod below:

       5 mm   +-----5-----+--5--+
               \\          |     |       materials: 1 elastomer, 2 backing
                |         |     |
                4    1    |  2  3       boundaries: 1 foot of the lip,
                |         |     |       2 foot of the backing, 3 back,
               /          |     |       4 outline under pressure, 5 top
          0   +-----1-----+--2--+
              0           4    6.5 mm

The outline 4 is an arc about (-4, 3.5) mm; with --straight it is the line
x = 0, for which the answer to a pressure is known.  Any Gmsh geometry with
these physical ids would do; this script has the advantage of needing nothing.
"""

import argparse
import math

LIP, BACKING, HEIGHT = 4e-3, 2.5e-3, 5e-3
CENTRE = (-4e-3, 3.5e-3)
RADIUS = math.hypot(*CENTRE)  # the arc begins at the origin

CURVES = {1: "lip foot", 2: "backing foot", 3: "back", 4: "outline", 5: "top"}
SURFACES = {1: "elastomer", 2: "backing"}
LINE, QUADRILATERAL = 1, 3  # Gmsh's element types


def outline(y, straight):
    """x where the body begins at this height."""
    if straight:
        return 0.0
    x = CENTRE[0] + math.sqrt(RADIUS**2 - (y - CENTRE[1]) ** 2)
    return round(x, 12)  # exactly 0 at the tip


def make(n_lip, n_backing, n_height, straight):
    """Points, and lists of elements by (dimension, physical id)."""
    n_x = n_lip + n_backing
    points = []
    for j in range(n_height + 1):
        y = HEIGHT * j / n_height
        left = outline(y, straight)
        for i in range(n_lip + 1):
            points.append((left + (LIP - left) * i / n_lip, y))
        for i in range(1, n_backing + 1):
            points.append((LIP + BACKING * i / n_backing, y))

    def node(i, j):
        return 1 + j * (n_x + 1) + i

    def row(j, columns):
        return [(node(i, j), node(i + 1, j)) for i in columns]

    def column(i):
        return [(node(i, j), node(i, j + 1)) for j in range(n_height)]

    def block(columns):
        return [
            (node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1))
            for j in range(n_height)
            for i in columns
        ]

    lip, backing = range(n_lip), range(n_lip, n_x)
    return points, {
        (1, 1): row(0, lip),
        (1, 2): row(0, backing),
        (1, 3): column(n_x),
        (1, 4): column(0),
        (1, 5): row(n_height, range(n_x)),
        (2, 1): block(lip),
        (2, 2): block(backing),
    }


def write(file, points, elements):
    def section(name, lines):
        print(f"${name}", *lines, f"$End{name}", sep="\n", file=file)

    names = [(1, tag, name) for tag, name in CURVES.items()]
    names += [(2, tag, name) for tag, name in SURFACES.items()]
    section("MeshFormat", ["4.1 0 8"])
    section(
        "PhysicalNames",
        [len(names), *(f'{d} {tag} "{name}"' for d, tag, name in names)],
    )

    # Each physical group is one entity of the same number; entities carry
    # the box around them.
    entities = [f"0 {len(CURVES)} {len(SURFACES)} 0"]
    for (_, tag), cells in elements.items():
        corners = [points[n - 1] for cell in cells for n in cell]
        box = [
            f"{f(p[0] for p in corners):.9g} {f(p[1] for p in corners):.9g} 0"
            for f in (min, max)
        ]
        entities.append(f"{tag} {box[0]} {box[1]} 1 {tag} 0")
    section("Entities", entities)

    n = len(points)
    section(
        "Nodes",
        [
            f"1 {n} 1 {n}",
            f"2 1 0 {n}",
            *range(1, n + 1),
            *(f"{x:.9g} {y:.9g} 0" for x, y in points),
        ],
    )

    n = sum(len(cells) for cells in elements.values())
    lines, number = [f"{len(elements)} {n} 1 {n}"], 0
    for (dimension, tag), cells in elements.items():
        kind = LINE if dimension == 1 else QUADRILATERAL
        lines.append(f"{dimension} {tag} {kind} {len(cells)}")
        for cell in cells:
            number += 1
            lines.append(" ".join(map(str, (number, *cell))))
    section("Elements", lines)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--lip", type=int, default=24, help="cells along the lip")
    parser.add_argument("--backing", type=int, default=14, help="... the backing")
    parser.add_argument("--height", type=int, default=24, help="... the height")
    parser.add_argument("--straight", action="store_true")
    parser.add_argument("file", metavar="FILE.msh")
    arguments = parser.parse_args()
    mesh = make(
        arguments.lip, arguments.backing, arguments.height, arguments.straight
    )
    with open(arguments.file, "w", encoding="ascii") as file:
        write(file, *mesh)


if __name__ == "__main__":
    main()
