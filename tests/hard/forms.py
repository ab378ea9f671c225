# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bilinear forms of elasticity on a box of equal cells, computed independently.

The unit cube in n^dim cells, clamped at the upper end of its last coordinate.
All cells have the same matrix, so that a few lines are enough.
"""

import itertools

import numpy as np
import scipy.linalg
import scipy.sparse
import scipy.sparse.linalg


def gauss(n, dim):
    """Points in the unit cell and their weights."""
    x, w = np.polynomial.legendre.leggauss(n)
    points = np.array(list(itertools.product((x + 1) / 2, repeat=dim)))
    weights = np.array([np.prod(c) for c in itertools.product(w / 2, repeat=dim)])
    return points, weights


def shape(point, corner):
    return np.prod([x if c else 1 - x for x, c in zip(point, corner)])


def gradient(point, corner):
    result = np.empty(len(point))
    for d in range(len(point)):
        factors = [x if c else 1 - x for x, c in zip(point, corner)]
        factors[d] = 1 if corner[d] else -1
        result[d] = np.prod(factors)
    return result


class Box:
    def __init__(self, n, dim):
        self.n, self.dim = n, dim
        self.corners = list(itertools.product((0, 1), repeat=dim))
        nodes = np.arange((n + 1) ** dim).reshape(dim * (n + 1,))
        cells = [
            nodes[tuple(slice(c, c + n) for c in corner)].ravel()
            for corner in self.corners
        ]
        nodes_of_cell = np.stack(cells, axis=1)
        # of each cell: corner by corner, component by component
        self.dofs = (
            nodes_of_cell[:, :, None] * dim + np.arange(dim)[None, None, :]
        ).reshape(len(nodes_of_cell), -1)
        self.n_dofs = nodes.size * dim
        clamped = nodes[..., n].ravel()
        self.free = np.setdiff1d(
            np.arange(self.n_dofs), (clamped[:, None] * dim + np.arange(dim)).ravel()
        )
        self.lower_corners = (
            np.stack(np.meshgrid(*dim * [np.arange(n)], indexing="ij"), axis=-1)
            .reshape(-1, dim)
            .astype(float)
        )

    def strains(self, points):
        """[point, dof of the cell] of the tensors of all shape functions."""
        tensors = np.zeros((len(points), len(self.corners) * self.dim, 3, 3))
        for q, point in enumerate(points):
            for i, corner in enumerate(self.corners):
                slope = self.n * gradient(point, corner)
                for c in range(self.dim):
                    e = np.zeros((3, 3))
                    e[c, : self.dim] = slope
                    tensors[q, i * self.dim + c] = (e + e.T) / 2
        return tensors

    def matrix(self, mu, bulk, kind="full"):
        """2 mu dev eps : dev eps + bulk tr eps tr eps on the free unknowns.

        kind: full, mean dilatation, or one-point, which is what a stress that
        is constant in each cell makes of it.
        """
        points, weights = gauss(1 if kind == "one-point" else 2, self.dim)
        strain = self.strains(points)
        trace = np.trace(strain, axis1=2, axis2=3)
        deviator = strain - trace[..., None, None] / 3 * np.eye(3)
        if kind == "mean dilatation":
            trace = np.broadcast_to(weights @ trace, trace.shape)
        cell = 2 * mu * np.einsum("q,qiab,qjab", weights, deviator, deviator)
        cell += bulk * np.einsum("q,qi,qj", weights, trace, trace)
        cell /= self.n**self.dim
        rows = np.repeat(self.dofs, self.dofs.shape[1], axis=1).ravel()
        columns = np.tile(self.dofs, (1, self.dofs.shape[1])).ravel()
        values = np.tile(cell.ravel(), len(self.dofs))
        full = scipy.sparse.csc_matrix(
            (values, (rows, columns)), shape=2 * (self.n_dofs,)
        )
        return full[self.free][:, self.free]

    def load(self, force):
        """Of a body force in the direction of x, by two points a direction."""
        points, weights = gauss(2, self.dim)
        result = np.zeros(self.n_dofs)
        for point, weight in zip(points, weights):
            values = weight / self.n**self.dim * force(
                (self.lower_corners + point) / self.n
            )
            for i, corner in enumerate(self.corners):
                np.add.at(
                    result, self.dofs[:, i * self.dim], values * shape(point, corner)
                )
        return result[self.free]


def smallest_eigenvalue(a, b):
    """min a(v, v)/b(v, v)."""
    if a.shape[0] < 300:
        return scipy.linalg.eigh(
            a.toarray(), b.toarray(), eigvals_only=True, subset_by_index=(0, 0)
        )[0]
    return scipy.sparse.linalg.eigsh(
        a, 1, b, sigma=0, tol=1e-8, return_eigenvectors=False
    )[0]


def answer(a, load):
    return scipy.sparse.linalg.spsolve(a, load)
