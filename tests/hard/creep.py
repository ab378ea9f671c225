# SPDX-License-Identifier: LGPL-2.1-or-later
"""Hard cases of the laws: stiff, endless, at their limits."""

import re

import numpy as np

from harness import run
from suite import case

CREEP = "Laws"
POINTS = {"Material/Stress history": "quadrature points"}
MEANS = {"Material/Stress history": "cell means"}
FULL_INTEGRATION = {"Material/Volumetric integration": "full"}


def speed(result, column="point0_y", last=1):
    """Of the step that many before the end."""
    u, t = result[column], result["t"]
    return (u[-last] - u[-last - 1]) / (t[-last] - t[-last - 1])


@case(
    CREEP,
    "Creep to 1000 relaxation times: at the quadrature points the velocity of the "
    "incompressible fluid, with any steps and scheme; of cell means the program "
    "says that they lock",
)
def long_creep(size, report):
    theta = 1.3
    n = size(4, 16)

    def cantilever(**more):
        result = run(
            "hard/long_creep",
            {"Geometry/Arguments": f"{4 * n}, {n} : 0, 0 : 4, 1 : true", **more},
        )
        if "Material/Law" not in more:
            # Relative to u, which grows to 700 times the elastic one while the
            # forces stay as they are.  Not of the fluid, which is a reference
            # whose condition is that of nu = 0.499999.
            report.identities(result, 1e-8)
        return result

    # The fluid on the same mesh, up to the ratio mu/lambda.
    fluid = cantilever(
        **{
            "Material/Law": "elastic",
            "Material/Young's modulus": 1.5,
            "Material/Poisson's ratio": 0.499999,
            "Time/Phases": "1: 1",
        }
    )["point0_y"][-1]
    tip = cantilever(**{"Time/Phases": f"{1000 * theta}: 1000"})["point0_y"][-1]
    for name, scheme, steps in (
        ("backward Euler, k = 10 theta", "backward Euler", 100),
        ("backward Euler, k = 100 theta", "backward Euler", 10),
        ("forward Euler, k = theta", "forward Euler", 1000),
    ):
        result = cantilever(
            **{"Time/Scheme": scheme, "Time/Phases": f"{1000 * theta}: {steps}"}
        )
        report.figure(
            f"{name}: velocity of the tip / that of the fluid - 1",
            speed(result) / fluid - 1,
            -1e-4,
            1e-4,
        )
        report.figure(
            f"{name}: tip at 1000 theta / that of backward Euler, k = theta, - 1",
            result["point0_y"][-1] / tip - 1,
            # the transient takes a few theta of the 1000
            -5e-3,
            5e-3,
        )
        report.figure(
            f"{name}: energy balance defect / work",
            abs(result["energy_balance_defect"]).max()
            / abs(result["external_work"]).max(),
            0,
            1e-3,
        )
    locked = cantilever(**MEANS)
    if "Stress history" not in locked.stdout:
        raise AssertionError("the program does not advise against cell means")
    report.figure(
        f"cell means, {n} cells over the height: velocity / that of the fluid",
        speed(locked) / fluid,
    )
    report.figure(
        "the same: tip at 1000 theta / that of quadrature points",
        locked["point0_y"][-1] / tip,
    )
    # What is elastic takes over from what flows: slower and slower.
    report.figure(
        "cell means: velocity of the last step / of the one before",
        speed(locked) / speed(locked, last=2),
        0,
        1 + 1e-6,
    )


@case(
    CREEP,
    "Viscosities that differ by 10^8 in one body: displacements to solver tolerance; "
    "forward Euler refuses and names its limit",
)
def viscosity_range(size, report):
    n, steps = size(16, 128), 20
    mu, k = 1 / 2.6, 2 / steps
    center = (np.arange(n) + 0.5) / n
    eta = 10 ** (8 * center - 4)
    tau = 0.1 * np.minimum(k * np.arange(steps + 1), 1)
    shear = tau[-1] / mu + k * tau[1:].sum() / eta
    layers = {"Geometry/Arguments": f"4, {n} : 0, 0 : 1, 1 : true"}
    for solver in "direct", "multigrid":
        result = run("hard/viscosity_range", {**layers, "Solver/Linear solver": solver})
        report.identities(result, 1e-11)
        for point, y in enumerate((0, 0.25, 0.5, 0.75)):
            exact = -shear[center > y].sum() / n
            report.figure(
                f"{solver}: relative error at y = {y}, where u = {-exact:.3g}",
                abs(result[f"point{point}_x"][-1] / exact - 1),
                0,
                # 1e-12 of the energy is at the upper points, where the
                # displacement is a hundredth of that of the foot
                1e-8,
            )
    refused = run(
        "hard/viscosity_range", {**layers, "Time/Scheme": "forward Euler"}, check=False
    )
    limit = re.search(r"exceeds the stability limit 2/r = ([-+.e0-9]+)", refused.stderr)
    if refused.returncode != 1 or not limit:
        raise AssertionError(f"forward Euler was not refused: {refused.stderr}")
    report.figure(
        "limit that forward Euler names / 2 eta/mu of the softest row - 1",
        float(limit[1]) / (2 * eta[0] / mu) - 1,
        -1e-3,
        1e-3,
    )


@case(
    CREEP,
    "Perzyna without hardening at the limit load: rest below it, steady flow beyond "
    "it, no explosion at large steps",
)
def limit_load(size, report):
    n = size(8, 32)
    beam = 0.01  # k h^2/(2 L) of a slender beam

    def cantilever(load, **more):
        result = run(
            "hard/limit_load",
            {
                "Geometry/Arguments": f"{4 * n}, {n} : 0, 0 : 4, 1 : true",
                "Boundary 1/Traction": f"0; -{load}*min(t, 1)",
                **more,
            },
        )
        report.identities(result, 1e-8)
        return result

    elastic = abs(cantilever(1e-6)["point0_y"][-1]) / 1e-6
    steady = {}
    for share in 0.5, 0.8, 1, 1.1, 1.2, 1.5, 2:
        result = cantilever(share * beam)
        steady[share] = speed(result)
        name = f"load {share} of the limit of a beam"
        report.figure(
            f"{name}: tip at t = 2600 / elastic tip",
            abs(result["point0_y"][-1]) / (elastic * share * beam),
        )
        if share <= 0.8:
            report.figure(
                f"{name}: creep in the last step / elastic tip",
                abs(steady[share]) * 130 / (elastic * share * beam),
                0,
                1e-6,
            )
        elif share >= 1.2:
            report.figure(
                f"{name}: change of the velocity in the last half",
                speed(result, last=10) / steady[share] - 1,
                -0.02,
                0.02,
            )
            report.figure(
                f"{name}: largest step over the explicit limit",
                (result["k"] / result["step_limit"])[1:].max(),
                50,
            )
            report.figure(
                f"{name}: Newton iterations a step", result["newton_iterations"][1:].mean()
            )
            if "times the size of the body" not in result.stdout:
                raise AssertionError(f"{name}: the program does not say so")
    # Far beyond the limit the flow is that of a fluid with an offset of the
    # load: the velocity goes down to zero near the limit load.
    onset = 1.5 - 0.5 * steady[1.5] / (steady[2] - steady[1.5])
    report.figure("load / limit of a beam at which flow begins", onset, 1, 1.3)


@case(
    CREEP,
    "Norton's law with n from 1 to 10: the steady velocity of a thick cylinder; "
    "Newton iterations do not grow with n",
)
def norton_cylinder(size, report):
    level = size(2, 4)
    errors, iterations, most = {}, {}, {}

    def cylinder(n, level):
        # the same velocity for all n: A from the exact solution
        a, b, velocity = 1, 2, 1
        strength = np.sqrt(3) / n / (a ** (-2 / n) - b ** (-2 / n))
        factor = 2 * velocity * a / np.sqrt(3) / strength**n
        result = run(
            "hard/norton_cylinder",
            {
                "Geometry/Global refinements": level,
                "Material/norton/Exponent": n,
                "Material/norton/Rate factor": factor,
            },
        )
        report.identities(result, 1e-8)
        return result, abs(speed(result, "point0_x") / velocity - 1)

    for n in size((1, 3, 10), (1, 2, 3, 5, 7, 10)):
        result, errors[n] = cylinder(n, level)
        _, coarse = cylinder(n, level - 1)
        # At a given load the velocity is a power of the load: n times the error
        report.figure(
            f"n = {n}: relative error of the velocity",
            errors[n],
            0,
            n * size(0.01, 0.001),
        )
        report.figure(f"n = {n}: order in h", np.log2(coarse / errors[n]), 1.5)
        count = result["newton_iterations"][1:]
        iterations[n], most[n] = count.mean(), count.max()
        report.figure(f"n = {n}: Newton iterations a step", iterations[n], 0, 6)
        report.figure(f"n = {n}: in one step", most[n], 0, 20)
        report.figure(
            f"n = {n}: largest step over the explicit limit",
            (result["k"] / result["step_limit"])[1:].max(),
        )


COURSES = "point0_x", "external_work", "viscous_dissipation", "friction_dissipation"


def difference(one, other, names=COURSES):
    return max(abs(one[n] - other[n]).max() / abs(other[n]).max() for n in names)


@case(
    CREEP,
    "Perzyna under friction: H -> 0 has the limit H = 0, and without yield limit it "
    "is Maxwell's law",
)
def no_hardening(size, report):
    n = size(8, 32)

    for scheme in "forward Euler", "backward Euler":
        for history in size((POINTS,), (MEANS, POINTS)):
            (place,) = history.values()
            what = f"{scheme}, {place}"

            def slab(**more):
                result = run(
                    "hard/yield_slab",
                    {
                        "Geometry/Arguments": f"{2 * n}, {n} : 0, 0 : 2, 1 : true",
                        "Time/Scheme": scheme,
                        **history,
                        **more,
                    },
                )
                report.identities(result, 1e-11)
                return result

            def hardening(modulus):
                return slab(**{"Material/perzyna/Hardening modulus": modulus})

            none = slab()
            small = [difference(hardening(h), none) for h in (1e-3, 1e-5)]
            report.figure(f"{what}: H = 1e-5 against H = 0", small[1], 0, 1e-5)
            report.figure(
                f"{what}: order in H", np.log10(small[0] / small[1]) / 2, 0.9, 1.1
            )
            maxwell = slab(**{"Material/Law": "maxwell"})
            fluid = slab(**{"Material/perzyna/Yield radius": 0})
            report.figure(
                f"{what}: k_Y = H = 0 against maxwell",
                difference(fluid, maxwell),
                0,
                1e-9,
            )


@case(
    CREEP,
    "Zener with E_inf -> 0: in the end the elastic answer of E_inf; E_inf = 0 is "
    "the limit",
)
def zener_soft(size, report):
    n = size(4, 16)
    base = {
        "Geometry/Arguments": f"{4 * n}, {n} : 0, 0 : 4, 1 : true",
        **FULL_INTEGRATION,
    }

    def zener(modulus, end, steps, **more):
        result = run(
            "hard/long_creep",
            {
                **base,
                "Material/Law": "zener",
                "Material/zener/Relaxation time": 1.3,
                "Material/zener/Long-term Young's modulus": modulus,
                "Material/zener/Long-term Poisson's ratio": 0.3,
                "Time/Phases": f"{end}: {steps}",
                **more,
            },
        )
        report.identities(result, 1e-10 + rounding(modulus) / 100)
        return result

    def rounding(modulus):
        """The stress is the difference of E eps, which is E/E_inf times as large
        in the end, and z: it has that many digits less, and those that the
        condition of a slender body takes."""
        return 5e-12 / max(modulus, 1e-8) * (n / 4) ** 2

    elastic = zener(1, 1, 1)["point0_y"][-1]
    for modulus in size((1e-1, 1e-4, 1e-8), (1e-1, 1e-2, 1e-4, 1e-6, 1e-8)):
        # retardation time theta E/E_inf; 40 of them in 400 steps
        result = zener(modulus, 40 * 1.3 / modulus, 400)
        report.figure(
            f"E_inf = {modulus}: last tip * E_inf/E / elastic tip - 1",
            abs(result["point0_y"][-1] * modulus / elastic - 1),
            0,
            1e-8 + rounding(modulus),
        )
        report.figure(
            f"E_inf = {modulus}: force balance defect",
            result["force_balance_defect"][1:].max(),
            0,
            1e-8 + rounding(modulus),
        )
    none, small = zener(0, 130, 100), zener(1e-8, 130, 100)
    report.figure(
        "E_inf = 1e-8 against 0 until 100 theta",
        difference(small, none, ("point0_y", "external_work", "viscous_dissipation")),
        0,
        # the stress that E_inf takes over: t/theta * E_inf/E, twice in energies
        2e-6,
    )
    # Without E_inf: du/dt = u_elastic/theta.
    report.figure(
        "E_inf = 0: tip at 100 theta / (1 + 100) elastic tips - 1",
        none["point0_y"][-1] / (101 * elastic) - 1,
        -1e-8,
        1e-8,
    )
