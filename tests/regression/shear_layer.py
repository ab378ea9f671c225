# SPDX-License-Identifier: LGPL-2.1-or-later
"""The shear layer that slides: closed forms, those of the scheme, and its runs."""

import numpy as np

from harness import run

MU, THETA, BOUND, PUSH = 1 / 2.6, 1.3, 0.1, 0.4


def tau(y, t):
    return np.minimum(PUSH * t / 2, BOUND) - PUSH * t * y


def integral_of_tau(y, t):
    """int_0^t tau(y,s) ds."""
    kink = 2 * BOUND / PUSH
    early, late = np.minimum(t, kink), np.maximum(t - kink, 0)
    return PUSH / 4 * early**2 + BOUND * late - PUSH / 2 * t**2 * y


def strain(y, t):
    """The engineering shear strain of the closed form."""
    return (tau(y, t) + integral_of_tau(y, t) / THETA) / MU


def displacement(y, t):
    """u_x of the closed form: Simpson's rule is exact, the strain is linear."""
    middle = (y + 1) / 2
    return -(1 - y) / 6 * (strain(y, t) + 4 * strain(middle, t) + strain(1, t))


def discrete_displacement(y, t, n_steps):
    """u_x of the scheme after n_steps equal steps until t."""
    k = t / n_steps
    nodes = np.array([y, (y + 1) / 2, 1 + 0 * y])
    memory = sum(tau(nodes, i * k) for i in range(n_steps))
    gamma = (tau(nodes, t) + k / THETA * memory) / MU
    return -(1 - y) / 6 * (gamma[0] + 4 * gamma[1] + gamma[2])


def layer(n, n_steps, **more):
    return run(
        "shear_layer_2d",
        {
            "Geometry/Arguments": f"{n}, {n} : 0, 0 : 1, 1 : true",
            "Time/Phases": f"1: {n_steps}",
            **more,
        },
    )
