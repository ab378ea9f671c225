# SPDX-License-Identifier: LGPL-2.1-or-later
"""Time integration: backward Euler and Heun against recursions, limits, orders.

The recursions are written from the formulas of doc/method.md and share nothing
with the program: the implicit equation is solved here by Newton's method with
differences.
"""

import math
import re
import unittest

import numpy as np

from harness import TestCase, main, run
from test_materials import LAWS, THREE, E, dev, displacement_gradient, norm

COMPONENTS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))

# Laws that a recursion in Python can follow at any step size; r of each at the
# stresses of the scene, for choosing steps.
BACKWARD = {"Time/Scheme": "backward Euler"}
HEUN = {"Time/Scheme": "Heun"}
POINTS = {"Material/Stress history": "quadrature points"}


def law_entries(name):
    entries = {f"Material/{name}/{entry}": v for entry, v in LAWS[name][1].items()}
    return {"Material/Law": name, **entries}


def pack(tensor):
    return np.array([tensor[i, j] for i, j in COMPONENTS])


def unpack(vector):
    tensor = np.zeros((3, 3))
    for value, (i, j) in zip(vector, COMPONENTS):
        tensor[i, j] = tensor[j, i] = value
    return tensor


def backward_euler(law, z_old, strain, t, k):
    """z with z = z_old + k G(E eps + z, eps), by continuation in k."""

    def newton(z, step):
        def residual(x):
            rate = law(E(strain) + unpack(x), strain, None, t)
            return x - pack(z_old) - step * pack(rate)

        size = norm(E(strain)) + norm(z_old)
        for _ in range(60):
            value = residual(z)
            matrix = np.zeros((6, 6))
            for i in range(6):
                h = 1e-7 * size * np.eye(6)[i]
                matrix[:, i] = (residual(z + h) - residual(z - h)) / (2e-7 * size)
            change = np.linalg.solve(matrix, -value)
            damping = 1.0
            while np.linalg.norm(residual(z + damping * change)) > np.linalg.norm(
                value
            ):
                damping /= 2
                if damping < 1e-6:
                    break
            z = z + max(damping, 1e-6) * change
            if np.linalg.norm(change) < 1e-14 * size:
                return z
        return z

    z = pack(z_old)
    for share in 1e-3, 1e-2, 0.1, 0.4, 1:
        z = newton(z, share * k)
    return unpack(z)


def recursion(scheme, law, times, dim):
    """Strains and stresses of the uniform body."""
    strains = []
    for t in times:
        gradient = displacement_gradient(t, dim)
        strains.append(0.5 * (gradient + gradient.T))
    z, stresses = np.zeros((3, 3)), [E(strains[0])]
    for n in range(1, len(times)):
        k = times[n] - times[n - 1]
        if scheme == "backward Euler":
            z = backward_euler(law, z, strains[n], times[n], k)
        else:
            rate = law(stresses[-1], strains[n - 1], None, times[n - 1])
            predicted = E(strains[n]) + z + k * rate
            z = z + k / 2 * (rate + law(predicted, strains[n], None, times[n]))
        stresses.append(E(strains[n]) + z)
    return np.array(strains), np.array(stresses)


def orders(errors):
    return np.log2(np.divide(errors[:-1], errors[1:]))


class UniformStrain(TestCase):
    def check(self, scheme, name, dim, **more):
        result = run(
            "uniform_strain",
            {
                "Time/Scheme": scheme,
                **(THREE if dim == 3 else {}),
                **law_entries(name),
                **more,
            },
            ranks=1,
        )
        strain, stress = recursion(scheme, LAWS[name][0], result["t"], dim)
        scale = np.abs(stress).max()
        self.assertClose(
            result["stress_norm"],
            [norm(s) for s in stress],
            absolute=1e-9 * scale,
            what=f"{scheme}, {name}, {dim}D: norm of the stress",
        )
        self.assertClose(
            result["max_von_mises"],
            [np.sqrt(1.5) * norm(dev(s)) for s in stress],
            absolute=1e-9 * scale,
            what=f"{scheme}, {name}, {dim}D: von Mises stress",
        )
        work = abs(result["external_work"]).max()
        self.assertClose(
            result["energy_balance_defect"], 0, absolute=1e-10 * work, what="energy"
        )
        return result, stress

    def test_backward_euler(self):
        for name in LAWS:
            for dim in 2, 3:
                with self.subTest(f"{name} {dim}D"):
                    self.check("backward Euler", name, dim)

    def test_heun(self):
        for name in LAWS:
            for dim in 2, 3:
                with self.subTest(f"{name} {dim}D"):
                    self.check("Heun", name, dim)

    def test_at_the_quadrature_points(self):
        for scheme in "backward Euler", "Heun":
            for name in LAWS:
                with self.subTest(f"{scheme} {name}"):
                    self.check(scheme, name, 2, **POINTS)

    def test_backward_euler_at_a_thousand_times_the_limit(self):
        """k = 1000/r and more: the state is the relaxed one."""
        for name in "maxwell", "perzyna", "zener", "norton":
            with self.subTest(name):
                result, stress = self.check(
                    "backward Euler", name, 3, **{"Time/Phases": "1: 1, 4000: 3"}
                )
                beyond = result["k"][2:] / result["step_limit"][2:]
                self.assertGreater(beyond.max(), 500 if name != "norton" else 10)


if __name__ == "__main__":
    main()
