# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bodies of drawn scenes: meshes of a few cells, from deal.II's generators."""

import math
from dataclasses import dataclass, field


@dataclass
class Body:
    """A coarse mesh: pieces says of each boundary id whether it is flat,
    planes are its cuts in x along faces of cells, points lie inside, outwards
    goes out of the body at some of its boundaries, and sides are those of a box."""

    generator: str
    arguments: str
    cells: int
    pieces: dict
    planes: list = field(default_factory=list)
    points: list = field(default_factory=list)
    ids: str = ""
    outwards: dict = field(default_factory=dict)
    sides: list = field(default_factory=list)


def flat(*ids):
    return {id: True for id in ids}


def curved(*ids):
    return {id: False for id in ids}


def box(scene, cells, sides):
    """A box of so many cells along its sides."""
    n = ", ".join(map(str, cells))
    corners = [scene.point(*corner) for corner in ([0] * scene.dim, sides)]
    inside = lambda: [side * scene.random.random() for side in sides]
    return Body(
        "subdivided_hyper_rectangle",
        " : ".join([n, *corners, "true"]),
        math.prod(cells),
        flat(*range(2 * scene.dim)),
        [sides[0] * i / cells[0] for i in range(1, cells[0])],
        [inside(), inside()],
        sides=sides,
        outwards={
            2 * axis + end: [(2 * end - 1) * (i == axis) for i in range(scene.dim)]
            for axis in range(scene.dim)
            for end in (0, 1)
        },
    )


def slab(scene):
    """A slab, a beam, or a column: up to forty times as long as thick, of cells
    that are up to twenty times as long as thick."""
    slenderness = round(scene.spread(0.3, 1.6), 1)
    cells = [1] * scene.dim
    cells[0] = max(2, round(slenderness / scene.random.choice((1, 2, 2, 4, 20))))
    cells[0] = min(cells[0], 40 if scene.dim == 2 else 10)
    cells[-1] = scene.random.choice((1, 1, 2))
    sides = [1.0] * scene.dim
    sides[-1] = float(f"{1 / slenderness:.3g}")
    if scene.dim == 3:
        sides[1] = scene.random.choice((1.0, sides[2]))
    if scene.chance(0.2):
        cells.reverse()
        sides.reverse()
    return box(scene, cells, sides)


def draw(scene):
    pick, flat_sides = scene.random.choice, flat(*range(2 * scene.dim))
    count = lambda most: scene.random.randint(1, most)
    kinds = ("box",) * 4 + ("slab", "L", "cell", "half shell", "quarter shell", "shell")
    kinds += ("hole", "half ball", "quarter ball")
    kinds += () if scene.dim == 2 else ("cylinder", "cone")
    kind = pick(kinds)
    radii = f"{scene.length(0.5)} : {scene.length(1)}"
    origin = scene.point(*[0] * scene.dim)
    if kind == "box":
        cells = [count(6 if scene.dim == 2 else 3) for _ in range(scene.dim)]
        return box(scene, cells, [pick((1, 1, 2, 0.5, 0.1)) for _ in cells])
    if kind == "slab":
        return slab(scene)
    if kind == "L":
        # in 3D deal.II tells no faces apart
        at = lambda axis, x: f"abs({axis} - {scene.length(x)}) < {scene.length(1e-6)}"
        planes = [at(axis, x) for x in (0, 1, 0.5) for axis in "xyz"]
        ids = "8"
        for id in range(7, -1, -1):
            ids = f"if({planes[id]}, {id}, {ids})"
        return Body(
            "hyper_L",
            f"0 : {scene.length(1)} : true",
            2**scene.dim - 1,
            flat(*range(6 if scene.dim == 2 else 9)),
            [0.5],
            ids="" if scene.dim == 2 else ids,
        )
    if kind == "cell":
        # an affine image of the cube, so that all faces are flat
        edges = [
            [(i == j) + scene.random.randint(-40, 40) / 100 for j in range(scene.dim)]
            for i in range(scene.dim)
        ]
        corners = []
        for n in range(2**scene.dim):
            chosen = [edge for i, edge in enumerate(edges) if n >> i & 1]
            corners.append([sum(e[j] for e in chosen) for j in range(scene.dim)])
        text = "; ".join(scene.point(*corner) for corner in corners)
        return Body("general_cell", f"{text} : true", 1, flat_sides)
    if kind == "half shell" and scene.dim == 2:
        n = pick((2, 3, 4))
        arguments = f"{origin} : {radii} : {n} : true"
        pieces = curved(0, 1) | flat(2, 3)
        outwards = {0: (-1, 0), 1: (1, 0)}
        return Body("half_hyper_shell", arguments, n, pieces, outwards=outwards)
    if kind in ("half shell", "quarter shell"):
        pieces = curved(0, 1) | flat(*range(2, scene.dim + 2))
        n = 3
        arguments = f"{origin} : {radii} : {n} : true"
        outwards = {0: [-1] * scene.dim, 1: [1] * scene.dim}
        return Body("quarter_hyper_shell", arguments, n, pieces, outwards=outwards)
    if kind == "shell":
        n = pick((6, 8)) if scene.dim == 2 else 6
        arguments = f"{origin} : {radii} : {n} : true"
        return Body("hyper_shell", arguments, n, curved(0, 1))
    if kind == "hole" and scene.dim == 2:
        lengths = " : ".join(map(scene.length, (0.4, 1, 0.5, 0.5, 0.5, 0.5)))
        arguments = f"{lengths} : {origin} : 0 : 1 : {scene.length(1)} : 2 : true"
        pieces = flat(0, 1, 2, 3) | curved(4)
        return Body("plate_with_a_hole", arguments, 24, pieces)
    if kind in ("hole", "half ball"):
        n = 4 if scene.dim == 2 else 6
        arguments = f"{origin} : {scene.length(1)}"
        outwards = {0: [1] + [0] * (scene.dim - 1)}
        pieces = curved(0) | flat(1)
        return Body("half_hyper_ball", arguments, n, pieces, outwards=outwards)
    if kind == "quarter ball":
        near = f"abs({{}}) < {scene.length(1e-6)}"
        ids = f"if({near.format('x')}, 1, if({near.format('y')}, 2, 3))"
        ids = f"if(id == 0, 0, {ids})"
        pieces = curved(0) | flat(*range(1, scene.dim + 1))
        n = 3 if scene.dim == 2 else 4
        arguments = f"{origin} : {scene.length(1)}"
        outwards = {0: [1] * scene.dim}
        return Body(
            "quarter_hyper_ball", arguments, n, pieces, ids=ids, outwards=outwards
        )
    if kind == "cylinder":
        return Body("cylinder", radii, 10, curved(0) | flat(1, 2))
    arguments = f"{scene.length(0.6)} : {scene.length(0.4)} : {scene.length(1)}"
    return Body("truncated_cone", arguments, 5, curved(0) | flat(1, 2))
