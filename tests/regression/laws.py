# SPDX-License-Identifier: LGPL-2.1-or-later
"""Laws of materials: the entries of scenes, and the formulas of doc/parameters.md with
full 3x3 tensors, which share nothing with the program."""

import numpy as np

IDENTITY = np.eye(3)


def dev(tensor):
    return tensor - np.trace(tensor) / 3 * IDENTITY


def norm(tensor):
    return np.sqrt(np.sum(tensor * tensor))


def isotropic(youngs_modulus, poissons_ratio):
    """E and its inverse as functions of tensors."""
    mu = youngs_modulus / (2 * (1 + poissons_ratio))
    bulk = youngs_modulus / (3 * (1 - 2 * poissons_ratio))
    return (
        lambda e: 2 * mu * dev(e) + bulk * np.trace(e) * IDENTITY,
        lambda s: dev(s) / (2 * mu) + np.trace(s) / (9 * bulk) * IDENTITY,
    )


E, E_INVERSE = isotropic(1, 0.25)
SOFT, _ = isotropic(0.4, 0.2)


def maxwell(stress, strain, x, t):
    return -E(dev(stress)) / (2 * 0.5)


def perzyna(stress, strain, x, t):
    radius = 0.02 + 0.3 * np.sqrt(2 / 3) * norm(dev(strain - E_INVERSE(stress)))
    size = norm(dev(stress))
    return -E(max(0, 1 - radius / size) * dev(stress)) / 0.8 if size else 0 * E(stress)


def zener(stress, strain, x, t):
    return -(stress - SOFT(strain)) / 0.7


def elastic_in_pressure(stress, strain, x, t):
    """zener with K_inf = K, mu_inf = mu/2."""
    return -(stress - isotropic(6 / 11, 4 / 11)[0](strain)) / 0.7


def power(equivalent):
    """A sigma^n, continued by its tangent beyond the cap of 0.03."""
    a, n, cap = 2000.0, 3.0, 0.03
    if equivalent <= cap:
        return a * equivalent**n
    return a * cap**n + a * n * cap ** (n - 1) * (equivalent - cap)


def flow(rate, stress):
    equivalent = np.sqrt(1.5) * norm(dev(stress))
    if equivalent == 0:
        return 0 * stress
    return -E(rate(equivalent) * 1.5 * dev(stress) / equivalent)


def norton(stress, strain, x, t):
    return flow(power, stress)


def parsed(stress, strain, x, t):
    """sinh creep with pressure, hardening and ageing."""
    pressure = -np.trace(stress) / 3
    creep = np.sqrt(2 / 3) * norm(dev(strain - E_INVERSE(stress)))
    return flow(
        lambda q: (1 + 0.5 * t) * 0.5 * np.sinh(8 * q)
        * np.exp(-pressure) / (1 + 5 * creep),
        stress,
    )


LAWS = {
    "maxwell": (maxwell, {"Viscosity": 0.5}),
    "perzyna": (
        perzyna, {"Yield radius": 0.02, "Hardening modulus": 0.3, "Viscosity": 0.8}
    ),
    "zener": (
        zener,
        {
            "Relaxation time": 0.7,
            "Long-term Young's modulus": 0.4,
            "Long-term Poisson's ratio": 0.2,
        },
    ),
    "norton": (norton, {"Rate factor": 2000, "Exponent": 3, "Stress cap": 0.03}),
    "parsed": (
        parsed,
        {
            "Strain rate": "0.5*sinh(8*sigma_eq)"
            "*exp(-p)/(1 + 5*eps_eq)",
            "Factor": "1 + 0.5*t",
        },
    ),
}


def displacement_gradient(t, dim):
    f = min(t, 2 - t)
    gradient = np.zeros((3, 3))
    gradient[:2, :2] = f * np.array([[0.1, 0.04], [0.02, -0.07]])
    if dim == 3:
        gradient[2] = f * np.array([0.03, 0, 0.05])
    return gradient


THREE = {
    "Dimension": 3,
    "Geometry/Arguments": "2, 2, 2 : 0, 0, 0 : 1, 1, 1 : false",
    "Boundary 0/Displacement": "min(t, 2 - t)*(0.1*x + 0.04*y); "
    "min(t, 2 - t)*(0.02*x - 0.07*y); min(t, 2 - t)*(0.03*x + 0.05*z)",
}

PERZYNA = {
    "Material/Law": "perzyna",
    "Material/perzyna/Yield radius": 0.12,
    "Material/perzyna/Viscosity": 0.02,
    "Boundary 0/Traction": "0.15*min(t, 1); 0",
}

NORTON = {
    "Material/Law": "norton",
    "Material/norton/Rate factor": 200,
    "Material/norton/Exponent": 3,
    "Material/norton/Stress cap": 1,
}

HARDENING = {**PERZYNA, "Material/perzyna/Hardening modulus": 0.3}


def pressure(k_r, k):
    """Yield stress and friction between grains: flow that depends on pressure
    but preserves volume, so that its tangent is far from symmetric. r is
    3 mu F."""
    return {
        "Material/Law": "parsed",
        "Material/parsed/Strain rate": "max(0, sigma_eq - max(0, 0.1 + p))",
        "Material/parsed/Factor": k_r / k / (3 / 2.6),
    }
