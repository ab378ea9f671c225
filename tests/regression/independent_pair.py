# SPDX-License-Identifier: LGPL-2.1-or-later
"""An independent solver for two bodies that press on each other.

Two boxes of uniform Q1 cells in the plane, the upper one within the width of the
lower, meet with the laws of independent_contact.py.  The discretization is the
program's: jumps at the nodes of the upper box, with dual basis functions.  The way
to the answer is another one: the jumps that forces make are computed with each body
by itself, and the inverse of that is minimized by interior points; no displacement
is ever eliminated in favour of a jump.
"""

from types import SimpleNamespace

import numpy as np
from scipy.sparse import block_diag
from scipy.sparse.linalg import splu

from independent_contact import GAUSS, Body, evaluate, minimize

LAWS = "none", "tresca", "coupled"


def draw(seed):
    """A scene: what is drawn does not know what is difficult."""
    random = np.random.default_rng(seed)
    width, height = random.uniform(1, 2, 2)
    upper = random.uniform(0.3, 0.9) * width
    if seed % 4 == 3:  # everything equal: all nodes touch at once, and tie
        lower = SimpleNamespace(size=(1.0, 0.5), cells=(6, 3), E=1.0, nu=0.3)
        boxes, start, gap = [lower, lower], 0.0, "0"
    else:
        boxes = [
            SimpleNamespace(
                size=tuple(size),
                cells=tuple(random.integers(3, 9, 2)),
                E=random.uniform(0.5, 4),
                nu=random.uniform(0, 0.4),
            )
            for size in ((width, height), (upper, random.uniform(0.3, 1)))
        ]
        start = random.uniform(0, width - upper)
        gap = f"{random.uniform(0, 4e-3)}*sin({random.uniform(3, 12)}*x)^2"
    return SimpleNamespace(
        boxes=boxes,
        start=start,
        gap=gap,
        law=LAWS[seed % 3],
        mu=random.uniform(0.1, 0.5),
        bound=random.uniform(1e-4, 5e-3),
        top=f"{random.uniform(1e-3, 1e-2)}*sin(4*t); -0.01*sin(2*t) + 2e-3*t*x",
        steps=6,
        end=1.2,
    )


def entries(scene):
    """The scene as entries of a parameter file."""
    lower, upper = scene.boxes
    arguments = []
    for box, x, y in (lower, 0, 0), (upper, scene.start, lower.size[1]):
        end = x + box.size[0], y + box.size[1]
        arguments.append(
            f"{box.cells[0]}, {box.cells[1]} : {x!r}, {y!r} : {end[0]!r}, {end[1]!r}"
            " : true"
        )
    result = {
        "Dimension": 2,
        "Geometry/Generator": "subdivided_hyper_rectangle | subdivided_hyper_rectangle",
        "Geometry/Arguments": " | ".join(arguments),
        "Material/Volumetric integration": "full",
        "Time/Phases": f"{scene.end}: {scene.steps}",
        "Solver/Contact tolerance": 1e-10,
        "Output/Fields every": 0,
    }
    for n, box in enumerate(scene.boxes):
        result[f"Material {n}/Young's modulus"] = repr(box.E)
        result[f"Material {n}/Poisson's ratio"] = repr(box.nu)
    for n in 0, 1, 3, 20, 21:
        result[f"Boundary {n}/Role"] = "free"
    result["Boundary 2/Role"] = "clamped"
    result["Boundary 23/Role"] = "displacement"
    result["Boundary 23/Displacement"] = scene.top
    contact = {
        "Role": "contact",
        "Against": 3,
        "Contact law": "unilateral",
        "Gap": scene.gap,
        "Friction law": "coulomb" if scene.law == "coupled" else scene.law,
    }
    if scene.law == "tresca":
        contact["Friction bound"] = scene.bound
    if scene.law == "coupled":
        contact["Friction coefficient"] = scene.mu
    return {**result, **{f"Boundary 22/{name}": v for name, v in contact.items()}}


def dual_interpolation(at, opposite):
    """Nodes on a line: the integrals of their basis functions, and the matrix from
    values at those opposite to jumps."""
    area, rows = np.zeros(len(at)), np.zeros((len(at), len(opposite)))
    hats = np.eye(len(opposite))
    for e in range(len(at) - 1):
        a, b = at[e : e + 2]
        area[e : e + 2] += (b - a) / 2
        cuts = [a, *(x for x in opposite if a < x < b), b]
        for begin, end in zip(cuts, cuts[1:]):
            for x in begin + GAUSS * (end - begin):
                there = np.array([np.interp(x, opposite, hat) for hat in hats])
                phi = (b - x) / (b - a), (x - a) / (b - a)
                for i in 0, 1:
                    psi = 2 * phi[i] - phi[1 - i]
                    rows[e + i] += psi * there * (end - begin) / 2
    return area, rows / area[:, None]


def solve(scene):
    """The steps: the sums of forces of the upper body on the lower one (tangential,
    pressing), contact area, energy, and the largest pressure."""
    bodies = [Body(vars(box)) for box in scene.boxes]
    lower, upper = bodies
    A = block_diag([body.A for body in bodies]).tocsr()
    places = np.concatenate([lower.nodes, upper.nodes + (scene.start, lower.size[1])])
    here = np.flatnonzero(upper.on(2)) + len(lower.nodes)
    there = np.flatnonzero(lower.on(3))
    top = np.flatnonzero(upper.on(3)) + len(lower.nodes)
    area, Q = dual_interpolation(places[here, 0], places[there, 0])
    n = len(here)
    # (tangential, towards the lower body) of each node
    J = np.zeros((n, 2, len(places), 2))
    for d, sign in enumerate((1, -1)):
        J[range(n), d, here, d] = sign
        J[:, d, there, d] -= sign * Q
    J = J.reshape(2 * n, -1)

    held = np.zeros((len(places), 2), bool)
    held[: len(lower.nodes)][lower.on(2)] = held[top] = True
    I = np.flatnonzero(~held.ravel())
    lu = splu(A[I][:, I].tocsc())
    S = np.linalg.inv(J[:, I] @ lu.solve(np.ascontiguousarray(J[:, I].T)))
    S = (S + S.T) / 2

    before, p, steps = np.zeros((n, 1)), np.zeros(n), []
    for t in scene.end * np.arange(1, scene.steps + 1) / scene.steps:
        u = np.zeros(places.shape)
        for d, text in enumerate(scene.top.split(";")):
            u[top, d] = evaluate(text, places[top], t)
        u = u.ravel()
        u[I] = lu.solve(-(A @ u)[I])
        f = (S @ (J @ u)).reshape(n, 2)
        gap = evaluate(scene.gap, places[here], t)
        bound = scene.bound * area if scene.law == "tresca" else np.zeros(n)
        for _ in range(200):
            if scene.law == "coupled":
                bound = scene.mu * p
            V, q = minimize(S, f, gap, before, bound)
            change, p = abs(q[:, 1] - p).max(), q[:, 1]
            if scene.law != "coupled" or change <= 1e-13 * p.max():
                break
        else:
            raise AssertionError(f"the pressure still changes by {change}")
        u[I] -= lu.solve(J[:, I].T @ q.ravel())
        assert abs(J @ u - V.ravel()).max() <= 1e-12 * abs(u).max()
        before = V[:, :1]
        steps.append(
            SimpleNamespace(
                force=q.sum(axis=0),
                contact_area=area[p > 0].sum(),
                max_pressure=(p / area).max(),
                energy=u @ (A @ u) / 2,
            )
        )
    return steps
