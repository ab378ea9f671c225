# SPDX-License-Identifier: LGPL-2.1-or-later
"""An independent solver for contact that opens and closes.

A box of uniform Q1 cells, or the ring that it is a section of, fully integrated,
elastic or Maxwell with one history value a cell or at each Gauss point, meets a
rigid foundation at y = 0 (z = 0 in space): u_n <= g at
every node of that face, or p = int c phi (u_n - g)_+^m, with no friction, Tresca friction or Coulomb friction
whose pressure is that of the step before or that of the step itself.  The
discretization is the program's, so equal scenes give equal numbers.

The way to them has nothing in common with the program's: the stiffness is
condensed onto the face, an interior point method minimizes the convex energy,
a semismooth Newton method takes its result to rounding (and from a rigid
foundation to softer and softer ones), and the conditions of optimality are
asserted in the uncondensed system.

A scene is a dictionary.  Its expressions are muParser's with x, y, z and t;
components are separated by `;'.  Faces are numbered as in the program: 0, 1 for
x, then 2, 3 for y and 4, 5 for z.  Its entries:

size, cells     lengths of the box and numbers of cells
inner           inner radius of a body of revolution; with 0 u_r = 0 on the axis
E, nu           isotropic material; 1 and 0.3 unless given
viscosity       eta of `maxwell'; elastic without it
history         `quadrature points' or `cell means', the latter unless given
top             displacement of the face opposite to the foundation, `free'
                where a component is not prescribed
tractions       {face: traction}; the other faces are free
gap             g(x, t)
compliance      (c, m) of a foundation that gives way
law             `none', `tresca', `lagged' or `coupled', the last two being
                Coulomb's
bound           bound of `tresca', per area; it holds without contact, too
mu              coefficient of `lagged' and `coupled'
phases          as Time/Phases: `end: steps', separated by commas
"""

import itertools
import re
from types import SimpleNamespace

import numpy as np
from scipy.linalg import block_diag
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import splu

PLATE = {"size": (2, 1), "cells": (16, 8)}
SOFT = {**PLATE, "viscosity": 0.5}
PILLAR = {"size": (1, 1), "cells": (8, 8), "inner": 0, "history": "quadrature points"}
TUBE = {**PILLAR, "inner": 0.5, "viscosity": 0.5}
PAD = {"size": (1, 1, 0.5), "cells": (4, 4, 3)}
TURN = "0.02*(1 - cos(pi*t)); 0.02*sin(pi*t); "
PRESSED = {"top": "0.03*sin(pi*t); -0.02*min(2*t, 1)", "gap": "0.001*x"}
ROUGH = {"gap": "0.002*sin(9*x)^2"}

SCENES = {
    # pressed, tilted to both sides and lifted
    "opening": {
        **PLATE, "gap": "0.004", "law": "none", "phases": "1.9: 8",
        "top": "0; 0.03*(x - 1)*sin(2*pi*t) - 0.02*sin(pi*t)",
    },
    # a side pushed and pulled; in the end friction without contact
    "rough": {
        **SOFT, **ROUGH, "law": "tresca", "bound": "0.002*(1 + x)",
        "top": "0.01*sin(pi*t); -0.006*min(t, 2 - t)",
        "tractions": {0: "0.03*sin(2*pi*t); 0"}, "phases": "1: 5, 1.8: 4",
    },
    "lagged": {**SOFT, **PRESSED, "law": "lagged", "mu": "0.3", "phases": "1: 5, 2: 5"},
    "steep": {
        **PLATE, **ROUGH, "cells": (12, 8), "law": "lagged", "mu": "1",
        "top": "0.05*t; -0.02*min(4*t, 1)",
        "tractions": {1: "0; 0.03*t"}, "phases": "1: 8",
    },
    "coupled": {
        **SOFT, **PRESSED, "law": "coupled", "mu": "0.3", "phases": "1: 5, 2: 5",
    },
    # the foundation comes up below a body that is held
    "moving": {
        **SOFT, "top": "0; 0", "gap": "0.05 - 0.1*t + 0.02*x", "law": "lagged",
        "mu": "0.3 + 0.2*x", "phases": "1.2: 8",
    },
    "soft": {
        **SOFT, **PRESSED, "law": "lagged", "mu": "0.3", "phases": "1: 5, 2: 5",
        "compliance": ("2 + x", 1),
    },
    "soft rough": {
        **PLATE, **ROUGH, "law": "coupled", "mu": "0.3 + 0.2*x", "phases": "1.8: 9",
        "top": "0.01*sin(pi*t); -0.006*min(t, 2 - t)", "compliance": ("300", 2),
    },
    # bodies of revolution, on the axis and beside it
    "pillar": {
        **PILLAR, "gap": "0.004 + 0.02*x", "law": "none", "phases": "1.5: 6",
        "top": "free; 0.01*(1 - 3*x)*sin(2*pi*t) - 0.02*sin(pi*t)",
        "tractions": {1: "0.01*t; 0"},
    },
    "tube": {
        **TUBE, **ROUGH, "law": "tresca", "bound": "0.002*(1 + x)",
        "top": "0.01*sin(pi*t); -0.006*min(t, 2 - t)",
        "tractions": {0: "0.03*sin(2*pi*t); 0"}, "phases": "1: 5, 1.8: 4",
    },
    "tube of means": {
        **TUBE, **PRESSED, "history": "cell means", "law": "lagged", "mu": "0.3",
        "phases": "1: 4, 2: 4",
    },
    "pillar that creeps": {
        **PILLAR, "viscosity": 0.5, "gap": "0.02*x^2", "law": "coupled",
        "mu": "0.1 + 0.2*x", "phases": "1: 4, 2: 4",
        "top": "0.03*x*sin(pi*t); -0.02*min(2*t, 1)",
    },
    "soft tube": {
        **TUBE, **PRESSED, "law": "coupled", "mu": "0.3", "phases": "1: 4, 2: 4",
        "compliance": ("2 + x", 1.5),
    },
    # in space the friction turns with the motion
    "turning tresca": {
        **PAD, "top": TURN + "-0.004*sin(pi*t)", "gap": "0.002*(x^2 + y^2)",
        "law": "tresca", "bound": "0.008*(1 + x)", "phases": "1.5: 8",
    },
    "turning coulomb": {
        **PAD, "viscosity": 0.5, "top": TURN + "-0.02*min(3*t, 1) + 0.01*t",
        "gap": "0.002*sin(9*x)^2 + 0.003*y", "law": "coupled", "mu": "0.3 + 0.3*x",
        "phases": "1.5: 8",
    },
    "soft turning": {
        **PAD, "viscosity": 0.5, "top": TURN + "-0.02*min(3*t, 1) + 0.01*t",
        "gap": "0.002*sin(9*x)^2 + 0.003*y", "law": "coupled", "mu": "0.3 + 0.3*x",
        "phases": "1.5: 8", "compliance": ("20", 1.5),
    },
}

MATH = {name: getattr(np, name) for name in ("sin", "cos", "exp", "sqrt", "where")}
MATH.update(min=np.minimum, max=np.maximum, abs=np.abs, pi=np.pi, __builtins__={})
GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3)
# Row of the strain that holds du_j/dx_i and du_i/dx_j.
SHEAR = {frozenset((0, 1)): 3, frozenset((1, 2)): 4, frozenset((0, 2)): 5}

# Largest defect of the conditions of optimality, relative to the largest sum of
# magnitudes in a row of equilibrium, the largest displacement or their product.
TOLERANCE = 1e-12


def evaluate(text, points, t):
    """The value of a muParser expression at each point."""
    text = re.sub(r"\bif\s*\(", "where(", str(text).replace("^", "**")).strip()
    values = eval(text, MATH, {"t": t, **dict(zip("xyz", points.T))})
    return np.broadcast_to(np.asarray(values, float), len(points))


def times(scene):
    """The ends of the steps."""
    start, ends = 0.0, []
    for phase in scene["phases"].split(","):
        end, steps = map(float, phase.split(":"))
        ends += list(np.linspace(start, end, int(steps) + 1)[1:])
        start = end
    return ends


def parameters(scene):
    """The scene as entries of a parameter file, without gap and friction."""
    dim = len(scene["cells"])
    begin = np.zeros(dim)
    begin[0] = scene.get("inner", 0)
    end = begin + scene["size"]
    numbers = [", ".join(map(str, n)) for n in (scene["cells"], begin, end)]
    ends = [begin, np.append(end[:-1], 0)]
    entries = {
        "Dimension": dim,
        "Geometry/Generator": "subdivided_hyper_rectangle",
        "Geometry/Arguments": " : ".join([*numbers, "true"]),
        "Material/Young's modulus": scene.get("E", 1),
        "Material/Poisson's ratio": scene.get("nu", 0.3),
        "Material/Volumetric integration": "full",
        "Time/Phases": scene["phases"],
        # the first and the last node on the foundation
        "Output/Points": "; ".join(", ".join(map(str, point)) for point in ends),
        f"Boundary {2 * dim - 2}/Role": "contact",
        f"Boundary {2 * dim - 1}/Role": "displacement",
        f"Boundary {2 * dim - 1}/Displacement": scene["top"],
    }
    if "viscosity" in scene:
        entries["Material/Law"] = "maxwell"
        entries["Material/Stress history"] = scene.get("history", "cell means")
        entries["Material/maxwell/Viscosity"] = scene["viscosity"]
    for face in range(2 * dim - 2):
        entries[f"Boundary {face}/Role"] = "free"
    for face, traction in scene.get("tractions", {}).items():
        entries[f"Boundary {face}/Role"] = "traction"
        entries[f"Boundary {face}/Traction"] = traction
    if "inner" in scene:
        entries["Geometry/Plane model"] = "axisymmetric"
    if scene.get("inner") == 0:
        entries["Boundary 0/Role"] = "symmetry"
    return entries


def corners(dim):
    """The corners of the unit cell, x fastest, as rows."""
    return np.array([c[::-1] for c in itertools.product((0, 1), repeat=dim)])


def factors(point):
    """One-dimensional factors (corner, axis) of the basis functions."""
    return np.where(corners(len(point)) == 1, point, 1 - np.asarray(point))


class Body:
    """Nodes, stiffness, history and loads of a box."""

    def __init__(self, scene):
        self.cells, self.size = np.array(scene["cells"]), np.array(scene["size"])
        self.dim = dim = len(self.cells)
        self.h, self.inner = self.size / self.cells, scene.get("inner")
        E, nu = scene.get("E", 1), scene.get("nu", 0.3)
        self.mu = E / (2 * (1 + nu))
        self.viscosity = scene.get("viscosity", np.inf)
        self.tractions = scene.get("tractions", {})

        self.grid = np.indices(self.cells[::-1] + 1)[::-1].reshape(dim, -1).T
        self.nodes = self.grid * self.h
        self.nodes[:, 0] += self.inner or 0
        self.stride = np.cumprod([1, *(self.cells[:-1] + 1)])
        first = np.flatnonzero((self.grid < self.cells).all(axis=1))
        self.begin = self.nodes[first]
        cell_nodes = first[:, None] + corners(dim) @ self.stride
        dofs = cell_nodes[:, :, None] * dim + np.arange(dim)
        self.cell_dofs = dofs.reshape(len(first), -1)

        # Stress and strain have the components xx, yy, zz, xy, yz, zx also in
        # the plane; shear strains are doubled.
        self.D = self.mu * np.diag([2.0, 2, 2, 1, 1, 1])
        self.D[:3, :3] += 2 * self.mu * nu / (1 - 2 * nu)
        # strain: (cell, Gauss point, strain, dof), volume: (cell, Gauss point)
        gauss = [np.array(q) for q in itertools.product(GAUSS, repeat=dim)]
        strain = np.stack([self.strains(q) for q in gauss], axis=1)
        volume = np.stack([self.extent(self.begin + q * self.h) for q in gauss], 1)
        volume *= self.h.prod() / len(gauss)
        K = np.einsum("cq,cqsi,st,cqtj->cij", volume, strain, self.D, strain)
        rows = np.repeat(self.cell_dofs, K.shape[1], axis=1).ravel()
        columns = np.tile(self.cell_dofs, (1, K.shape[1])).ravel()
        self.A = coo_matrix((K.ravel(), (rows, columns))).tocsr()
        # The same of the samples of the history.
        if scene.get("history", "cell means") == "cell means":
            whole = volume.sum(axis=1, keepdims=True)
            strain = np.einsum("cq,cqsi->csi", volume / whole, strain)[:, None]
            volume = whole
        self.sampled, self.volume = strain, volume
        # What does not move has a row of its own.
        self.moves = np.ones(self.nodes.shape)
        if self.inner == 0:
            self.moves[self.on(0), 0] = 0
        self.moves = self.moves.ravel()
        moving = diags(self.moves)
        self.A = (moving @ self.A @ moving + diags(1 - self.moves)).tocsr()

    def extent(self, points):
        """What a section counts for at each point."""
        return np.ones(len(points)) if self.inner is None else 2 * np.pi * points[:, 0]

    def strains(self, point):
        """The matrices (cell, strain, dof) from nodal displacements of each cell to
        its strain at a point of the unit cell."""
        B = np.zeros((len(self.begin), 6, 2**self.dim, self.dim))
        for i, j in itertools.product(range(self.dim), repeat=2):
            slope = np.delete(factors(point), i, axis=1).prod(axis=1) / self.h[i]
            slope *= 2 * corners(self.dim)[:, i] - 1
            B[:, i if i == j else SHEAR[frozenset((i, j))], :, j] = slope
        if self.inner is not None:
            radius = self.begin[:, :1] + point[0] * self.h[0]
            B[:, 2, :, 0] = factors(point).prod(axis=1) / radius
        return B.reshape(*B.shape[:2], -1)

    def rate(self, u, z):
        """G at the stress of each sample: plane strain keeps the stress out of the
        plane."""
        strain = np.einsum("cqsi,ci->cqs", self.sampled, u.ravel()[self.cell_dofs])
        stress = strain @ self.D + z
        stress[..., :3] -= stress[..., :3].mean(axis=-1, keepdims=True)
        return -self.mu / self.viscosity * stress

    def on(self, face):
        """The nodes of a face as a mask."""
        return self.grid[:, face // 2] == face % 2 * self.cells[face // 2]

    def integral(self, face):
        """Quadrature points of a face and the matrix from values there to
        integrals against the basis functions of all nodes."""
        axes = np.delete(np.arange(self.dim), face // 2)
        inside = (self.grid < self.cells)[:, axes].all(axis=1)
        first = np.flatnonzero(self.on(face) & inside)
        points, columns = [], []
        for q in itertools.product(GAUSS, repeat=self.dim - 1):
            shift = np.zeros(self.dim)
            shift[axes] = q * self.h[axes]
            points.append(self.nodes[first] + shift)
            columns.append(np.zeros((len(self.nodes), len(first))))
            weights = factors(q).prod(axis=1) * self.h[axes].prod() / 2 ** len(axes)
            weights = np.outer(weights, self.extent(points[-1]))
            for step, weight in zip(corners(len(axes)) @ self.stride[axes], weights):
                columns[-1][first + step, np.arange(len(first))] = weight
        return np.concatenate(points), np.concatenate(columns, axis=1)

    def load(self, t, z):
        """The forces of tractions and irreversible stress."""
        force = np.zeros_like(self.nodes)
        for face, traction in self.tractions.items():
            points, integral = self.integral(face)
            values = [evaluate(c, points, t) for c in traction.split(";")]
            force += integral @ np.stack(values, axis=1)
        force = force.ravel()
        stress = np.einsum("cq,cqsi,cqs->ci", self.volume, self.sampled, z)
        np.subtract.at(force, self.cell_dofs, stress)
        return self.moves * force


def interior_point(S, f, gap, before, rho):
    """Roughly minimize V.SV/2 - f.V + sum of rho |V_t - before| over V_n <= gap.

    V is (node, component) with the normal one last.  Unknown beside it are the
    gap y left and the pressure p of each node, the friction force rho l with
    V_t - before = k l, and h = (1 - l.l)/2.  In the end p y = rho k h = 0; y, p,
    h and k stay positive on the way.  Yields V and (friction, p) again and again,
    each better than the last until rounding stops that.
    """
    n, dim = len(gap), before.shape[1] + 1
    rubs = rho > 0
    rho = rho[rubs][:, None]
    guess = np.linalg.solve(S + 1e-3 * np.diag(S.diagonal()), f.ravel())
    length = max(abs(guess).max(), abs(gap).max(), abs(before).max(), 1e-14)
    force = max(abs(f).max(), length * 0.1 * S.diagonal().min(), rho.max(initial=0))
    V = np.concatenate([before, np.minimum(gap - length, 0)[:, None]], axis=1)
    l = np.zeros_like(before[rubs])
    positive = [np.full(n, length), np.full(n, force)]
    positive += [np.full((len(l), 1), 0.5), np.full((len(l), 1), length)]
    index = np.arange(n * dim).reshape(n, dim)
    normal, rubbing = index[:, -1], index[rubs, :-1]

    def dot(a, b):
        return (a * b).sum(axis=1, keepdims=True)

    for _ in range(100):
        y, p, h, k = positive
        q = np.zeros((n, dim))
        q[rubs, :-1], q[:, -1] = rho * l, p
        work = ((p * y).sum() + (rho * k * h).sum()) / (n + len(k))
        if work < 1e-6 * force * length:
            yield V, q
        beside = V[rubs, :-1] - before[rubs] - k * l
        ball = h + (dot(l, l) - 1) / 2
        target = 0.15 * work
        push = (target + p * (V[:, -1] - gap)) / y
        center = (target / rho - k * h + k * ball) / h
        # the inverse of k (1 + l l^T / h), without cancellation
        turned = l[:, ::-1] * (-1, 1) if dim == 3 else 0 * l
        inverse = h[:, :, None] * np.eye(dim - 1)
        inverse = inverse + turned[:, :, None] * turned[:, None, :]
        inverse /= (k * (h + dot(l, l)))[:, :, None]
        pull = np.einsum("cij,cj->ci", inverse, beside - l * center)
        H, right = S.copy(), f - q - (S @ V.ravel()).reshape(n, dim)
        H[normal, normal] += p / y
        H[rubbing[:, :, None], rubbing[:, None, :]] += rho[:, :, None] * inverse
        right[:, -1] -= push
        right[rubs, :-1] -= rho * pull
        dV = np.linalg.solve(H, right.ravel()).reshape(n, dim)
        dl = np.einsum("cij,cj->ci", inverse, dV[rubs, :-1]) + pull
        changes = [gap - y - V[:, -1] - dV[:, -1], push + p / y * dV[:, -1]]
        changes += [-ball - dot(l, dl), center + k * dot(l, dl) / h]
        ends = [-v[c < 0] / c[c < 0] for v, c in zip(positive, changes)]
        step = min(1, 0.99 * min(e.min(initial=2) for e in ends))
        V, l = V + step * dV, l + step * dl
        positive = [v + step * c for v, c in zip(positive, changes)]


def newton(S, f, gap, before, rho, V, q, compliance=None, enough=TOLERANCE):
    """Take V and the forces q = (friction, p) to rounding, or return None:
    semismooth Newton on the projections of q + r (V - given) onto the balls and
    the half line, or where a foundation gives way on its law."""
    n, dim = V.shape
    rho = rho[:, None]
    given = np.column_stack([before, gap])
    r = S.diagonal().reshape(n, dim).mean(axis=1, keepdims=True)
    scale = abs(S).max() * max(abs(V).max(), abs(given).max()) + abs(f).max()
    best, identity, result = np.inf, np.eye(n * dim), None
    for iteration in range(60 if compliance else 20):
        trial = q + r * (V - given)
        size = np.linalg.norm(trial[:, :-1], axis=1)[:, None]
        slips = (size > rho) | (rho == 0)
        size = np.where(slips & (size > 0), size, np.inf)
        ratio = np.where(slips, rho / size, 1)
        e = trial[:, :-1] / size
        slope = np.zeros((n, dim, dim))
        slope[:, :-1, :-1] = np.eye(dim - 1) - e[:, :, None] * e[:, None, :]
        slope[:, :-1, :-1] *= ratio[:, :, None]
        slope[:, -1, -1] = trial[:, -1] > 0
        normal, of_V, of_q = trial[:, -1].clip(0), slope * r[:, :, None], slope
        if compliance:
            c, m = compliance
            depth = (V[:, -1] - gap).clip(0)
            normal, of_q = c * depth**m, slope.copy()
            of_V[:, -1, -1] = np.where(depth > 0, c * m * depth ** (m - 1), 0)
            of_q[:, -1, -1] = 0
        projected = np.column_stack([ratio * trial[:, :-1], normal])
        residual = (S @ V.ravel()).reshape(n, dim) + q - f
        defect = max(abs(residual).max(), abs(q - projected).max()) / scale
        if defect >= best and best < 1e-13:
            break
        if defect < best:
            # what is held is held exactly
            touched = (trial[:, -1] > 0) & (compliance is None)
            held = np.repeat(~slips, dim - 1, axis=1), touched
            held = np.column_stack(held)
            best, result = defect, (np.where(held, given, V), projected)
        of_V, of_q = block_diag(*of_V), block_diag(*of_q)
        matrix = [[S, identity], [-of_V, identity - of_q]]
        right = np.concatenate([-residual.ravel(), (projected - q).ravel()])
        try:
            dV, dq = np.linalg.solve(np.block(matrix), right).reshape(2, n, dim)
        except np.linalg.LinAlgError:
            break
        # shorter steps break cycles
        step = 0.6 if 15 <= iteration < 40 else 1
        V, q = V + step * dV, q + step * dq
    return result if best < enough else None


def minimize(*problem, compliance=None):
    """V and (friction, p) to rounding."""
    for V, q in interior_point(*problem):
        result = newton(*problem, V, q)
        if result is not None:
            break
    else:
        raise AssertionError("the minimization did not converge")
    if compliance:
        c, m = compliance
        softest = newton(*problem, *result, compliance)
        if softest is None:
            for stiffer in 4.0 ** np.arange(12, -1, -1):
                softer = newton(*problem, *result, (stiffer * c, m), 1e-3)
                result = softer or result
            softest = newton(*problem, *result, compliance)
        assert softest, "the softest foundation did not converge"
        return softest
    return result


def verify(body, load, free, step):
    """Assert the conditions of optimality in the uncondensed system."""
    n, u, p, friction = len(step.p), step.u.ravel(), step.p, step.friction
    residual = (body.A @ u - load).reshape(step.u.shape)
    residual[:n, :-1] += friction
    residual[:n, -1] -= p
    force = max((abs(body.A) @ abs(u)).max(), abs(load).max(), 1e-14)
    length = max(abs(u).max(), abs(step.gap).max(), 1e-14)
    left = step.gap + step.u[:n, -1]
    slip = np.linalg.norm(step.increment, axis=1)
    dissipation = (friction * step.increment).sum(axis=1)
    defects = {
        "equilibrium": abs(residual.ravel()[free]).max() / force,
        "pressure": -p.min() / force,
        "bound": (np.linalg.norm(friction, axis=1) - step.bound).max() / force,
        "slip": abs(step.bound * slip - dissipation).max() / force / length,
    }
    if step.compliance:
        c, m = step.compliance
        defects["compliance"] = abs(p - c * (-left).clip(0) ** m).max() / force
    else:
        defects["gap"] = -left.min() / length
        defects["complementarity"] = abs(p * left).max() / force / length
    assert max(defects.values()) <= TOLERANCE, defects


def solve(scene):
    """The steps of a scene, the initial state not among them.

    Each has t, u (node, component; x fastest, the foundation's face first),
    gap, p, bound and friction (minus the tangential force on the body) of the
    face's nodes, increment (of their tangential displacement), area (the
    integrals of their basis functions), the sums normal_force and
    tangential_force, contact_area (of nodes with p > 0), energy (the strain
    energy) and iterations of the coupled pressure.
    """
    body = Body(scene)
    dim, A, nodes = body.dim, body.A, body.nodes
    top, law = body.on(2 * dim - 1), scene["law"]
    points, integral = body.integral(2 * dim - 2)
    n = body.on(2 * dim - 2).sum()
    integral = integral[:n]
    area = integral.sum(axis=1)

    components = [c.strip() for c in scene["top"].split(";")]
    held = np.outer(top, [c != "free" for c in components]).ravel()
    C = np.arange(n * dim)
    I = np.setdiff1d(np.flatnonzero(~held), C)
    lu = splu(A[I][:, I].tocsc())
    extension = -lu.solve(A[I][:, C].toarray())
    sign = np.tile([1.0] * (dim - 1) + [-1], n)  # the foundation is below
    S = A[C][:, C].toarray() + A[C][:, I] @ extension
    S = sign[:, None] * (S + S.T) / 2 * sign

    compliance = scene.get("compliance")
    if compliance:
        compliance = integral @ evaluate(compliance[0], points, 0), compliance[1]

    u, z, p = np.zeros_like(nodes), np.zeros((*body.volume.shape, 6)), np.zeros(n)
    steps, start = [], 0.0
    for t in times(scene):
        z = z + (t - start) * body.rate(u, z)
        load = body.load(t, z)
        whole = np.zeros_like(u)
        for i, c in enumerate(components):
            if c != "free":
                whole[top, i] = evaluate(c, nodes[top], t)
        whole = whole.ravel()
        right = load - A @ whole
        f = (sign * (right[C] + extension.T @ right[I])).reshape(n, dim)
        gap = evaluate(scene["gap"], nodes[:n], t)
        bound, before = np.zeros(n), u[:n, :-1]
        for iterations in range(1, 201):
            if law == "tresca":
                bound = integral @ evaluate(scene["bound"], points, t)
            elif law != "none":
                bound = integral @ evaluate(scene["mu"], points, t) / area * p
            V, q = minimize(S, f, gap, before, bound, compliance=compliance)
            change, p = abs(q[:, -1] - p).max(), q[:, -1]
            if law != "coupled" or change <= 1e-13 * p.max():
                break
        else:
            raise AssertionError(f"the pressure still changes by {change}")

        whole[C] = sign * V.ravel()
        whole[I] = lu.solve(right[I]) + extension @ whole[C]
        u, start = whole.reshape(u.shape), t
        steps.append(
            SimpleNamespace(
                t=t, u=u, gap=gap, p=p, bound=bound, friction=q[:, :-1],
                compliance=compliance,
                increment=u[:n, :-1] - before, area=area, iterations=iterations,
                normal_force=p.sum(), tangential_force=q[:, :-1].sum(axis=0),
                contact_area=area[p > 0].sum(), energy=whole @ (A @ whole) / 2,
            )
        )
        verify(body, load, ~held, steps[-1])
    return steps
