# SPDX-License-Identifier: LGPL-2.1-or-later
"""A given temperature: thermal strain in every plane model, rates by Arrhenius,
what laws, energies, estimates and changes of the mesh know of it."""

import itertools
import re
import tempfile

import numpy as np

from harness import TestCase, main, run
from runs import (
    EVERY_STEP,
    Job,
    boundaries,
    elastic_moduli,
    of_law,
    on_boundary,
    with_roles,
    without_wall_times,
)

E, NU, ALPHA = 200.0, 0.3, 1e-3
AXIS = {"Geometry/Plane model": "axisymmetric"}


def body(temperature, arguments, *roles, **more):
    """A colorized box of an elastic material that expands."""
    dim = len(arguments.split(":")[0].split(","))
    return {
        "Dimension": dim,
        "Geometry/Arguments": arguments + " : true",
        **elastic_moduli(E, NU),
        "Material/Thermal expansion": ALPHA,
        "Temperature/Value": temperature,
        "Time/Phases": "1: 2",
        "Solver/Contact tolerance": 1e-12,
        "Output/Fields every": 0,
        **boundaries(*roles),
        **more,
    }


def compute(entries, ranks=1, **more):
    return run("temperature", entries, ranks=ranks, text="", **more)


def said(result):
    """What the run has printed, in one line."""
    return " ".join((result.stdout + result.stderr).split())


SQUARE = ("4, 3 : 0, 0 : 1, 1", "symmetry", "free", "symmetry", "free")
CUBE = ("3, 2, 2 : 0, 0, 0 : 1, 1, 1", *3 * ("symmetry", "free"))


class Uniform(TestCase):
    """What is heated everywhere alike meets closed forms to rounding."""

    # T - T(0), and with the factor of the displacements and the stress zz of
    # plane strain
    heat = "293 + 100*t"
    distorted = {
        2: "x + 0.3*x*(x - 0.5)*(1 - x)*y; y*(1 + 0.2*(1 - y)*x)",
        3: "x + 0.3*x*(x - 0.5)*(1 - x)*y; y*(1 + 0.2*(1 - y)*x); z",
    }

    def check(self, shape, factor, zz, ranks=1, **more):
        dim = 3 if shape is CUBE else 2
        u = "; ".join(f"{factor * ALPHA * 100}*{x}*t" for x in "xyz"[:dim])
        stress = f"0; 0; {zz}*t; 0" + (dim == 3) * "; 0; 0"
        result = compute(
            body(
                self.heat,
                *shape,
                **{
                    "Geometry/Coordinates": self.distorted[dim],
                    "Geometry/Boundary refinements": "0: 1, 2: 1",
                    "Exact solution/Displacement": u,
                    "Exact solution/Stress": stress,
                    **more,
                },
            ),
            ranks,
        )
        scale = E * ALPHA * 100
        self.assertLess(result["error_energy"][-1] / result["exact_energy"][-1], 1e-11)
        self.assertLess(result["error_stress"][-1], 1e-11 * scale)
        # The energy that heat gives is what the stress zz stores.
        stored = 0.5 * zz**2 / E
        self.assertLess(abs(result["stored_energy"][-1] - stored), 1e-10 * scale)
        if "Material/Law" not in more:
            self.assertLess(abs(result["thermal_work"][-1] - stored), 1e-10 * scale)
        self.assertLess(abs(result["energy_balance_defect"]).max(), 1e-10 * scale)
        if "error_bar" in result.statistics:
            self.assertLess(result["estimate_space"][-1], 1e-9)
        return result

    def test_free_expansion(self):
        for ranks, more in (
            (1, {}),
            (2, {"Material/Stress history": "cell means"}),
            (3, {"Material/Volumetric integration": "mean dilatation"}),
        ):
            with self.subTest(ranks=ranks):
                self.check(CUBE, 1, 0, ranks, **more)
                self.check(SQUARE, 1, 0, ranks, **AXIS, **more)
                self.check(SQUARE, 1 + NU, -E * ALPHA * 100, ranks, **more)

    def test_free_expansion_of_what_flows(self):
        """The strain that laws know is that without the temperature: no stress
        comes from it, of whatever law and scheme."""
        laws = {
            "maxwell": {"Viscosity": 50},
            "zener": {
                "Relaxation time": 0.5,
                "Long-term Young's modulus": 100,
                "Long-term Poisson's ratio": 0.2,
            },
            "perzyna": {"Yield radius": 1e-3, "Viscosity": 10, "Hardening modulus": 5},
        }
        for (law, entries), scheme in itertools.product(
            laws.items(), ("forward Euler", "backward Euler", "Heun")
        ):
            with self.subTest(law=law, scheme=scheme):
                self.check(
                    SQUARE,
                    1,
                    0,
                    **AXIS,
                    **{
                        "Material/Law": law,
                        **{f"Material/{law}/{k}": v for k, v in entries.items()},
                        "Time/Scheme": scheme,
                        "Time/Phases": "1: 10",
                    },
                )

    def test_between_walls(self):
        """-E alpha dT of a bar, over 1 - nu in plane strain and of a disc, over
        1 - 2 nu of what is held everywhere."""
        held = "symmetry"
        for shape, factor, model in (
            (("3, 2, 2 : 0, 0, 0 : 1, 1, 1", held, held, held, "free", held, "free"),
             1, {}),
            (("4, 3 : 0, 0 : 1, 1", held, held, held, "free"), 1 / (1 - NU), {}),
            (("4, 3 : 0, 0 : 1, 1", held, held, held, "free"), 1 / (1 - NU), AXIS),
            (("4, 3 : 0, 0 : 1, 1", held, held, held, held), 1 / (1 - 2 * NU), {}),
        ):  # fmt: skip
            with self.subTest(factor=factor, **model):
                result = compute(
                    body(
                        self.heat,
                        *shape,
                        **model,
                        **{
                            "Output/Points": "0.3, 0.3" + (len(shape) == 7) * ", 0.3",
                            "Output/Point fields": "stress, temperature",
                        },
                    )
                )
                found = result["point0_stress_xx"][-1]
                wanted = -factor * E * ALPHA * 100
                self.assertLess(abs(found / wanted - 1), 1e-10)
                self.assertLess(abs(result["point0_temperature"][-1] - 393), 1e-9)
                self.assertLess(
                    abs(result["thermal_work"] - result["stored_energy"]).max(),
                    1e-10 * result["stored_energy"][-1],
                )

    def test_reference_temperature(self):
        """Where there has been thermal strain before t = 0, the initial state has
        its stress: in equilibrium if it is that of a body between walls, else to
        be brought there."""
        walls = ("4, 3 : 0, 0 : 1, 1", *4 * ["symmetry"])
        result = compute(
            body("393", *walls, **{"Temperature/Reference temperature": 293})
        )
        wanted = 1.5 * (E * ALPHA * 100) ** 2 / E / (1 - 2 * NU)
        self.assertLess(abs(result["stored_energy"] / wanted - 1).max(), 1e-10)
        free = body(
            "393", *SQUARE, **{"Temperature/Reference temperature": 293}, **AXIS
        )
        self.assertIn("Equilibrate", compute(free, check=False).stderr)
        result = compute({**free, "Initial state/Equilibrate": "true"})
        self.assertLess(abs(result["stored_energy"]).max(), 1e-10)
        self.assertLess(
            abs(result["max_displacement"] / (ALPHA * 100 * 2**0.5) - 1).max(), 1e-9
        )

    def test_initial_stress_beside_it(self):
        """A body between walls under an initial stress, heated and cooled: the
        stress is the sum of both, of each at its time."""
        result = compute(
            body(
                "293 + 100*sin(pi*t)",
                "4, 3 : 0, 0 : 1, 1",
                *4 * ["symmetry"],
                **{
                    "Initial state/Stress": "-3; -5; -2; 0",
                    "Output/Points": "0.3, 0.3",
                    "Output/Point fields": "stress, irreversible stress",
                },
            )
        )
        middle = -5 - E * ALPHA * 100 / (1 - 2 * NU)
        self.assertLess(abs(result["point0_stress_yy"][1] / middle - 1), 1e-10)
        self.assertLess(abs(result["point0_stress_yy"][-1] / -5 - 1), 1e-9)
        # of which the temperature has no part
        for row in 1, -1:
            self.assertLess(
                abs(result["point0_irreversible_stress_yy"][row] / -5 - 1), 1e-9
            )


class Cylinder(TestCase):
    """A long cylinder between a hot inner and a cold outer face: T falls like
    ln r. Timoshenko and Goodier, Theory of Elasticity, section 135."""

    a, b, T = 1.0, 2.0, 100.0

    def solution(self, r):
        """u_r, sigma_r, sigma_theta, sigma_z as expressions of r."""
        a, b, log = self.a, self.b, np.log(self.b / self.a)
        c = E * ALPHA * self.T / (2 * (1 - NU) * log)
        part = a**2 / (b**2 - a**2) * log
        radial = f"({c}*(-ln({b}/{r}) - {part}*(1 - {b * b}/{r}^2)))"
        hoop = f"({c}*(1 - ln({b}/{r}) - {part}*(1 + {b * b}/{r}^2)))"
        axial = f"({NU}*({radial} + {hoop}) - {E * ALPHA}*{self.temperature(r)})"
        strain = f"(({hoop} - {NU}*({radial} + {axial}))/{E} + {ALPHA}*{self.temperature(r)})"
        return f"{r}*{strain}", radial, hoop, axial

    def temperature(self, r):
        return f"({self.T / np.log(self.b / self.a)}*ln({self.b}/{r}))"

    def ring(self, n):
        u, radial, hoop, axial = self.solution("x")
        return body(
            f"t*{self.temperature('x')}",
            f"{n}, {n} : {self.a}, 0 : {self.b}, 1",
            *("free", "free", "symmetry", "symmetry"),
            **AXIS,
            **{
                "Time/Phases": "1: 1",
                "Exact solution/Displacement": f"t*{u}; 0",
                # z goes around the axis
                "Exact solution/Stress": f"t*{radial}; t*{axial}; t*{hoop}; 0",
            },
        )

    def section(self, n):
        """A quarter, in plane strain."""
        r = "sqrt(x^2 + y^2)"
        u, radial, hoop, axial = self.solution(r)
        along, across = f"x/{r}", f"y/{r}"
        return {
            **body(
                f"t*{self.temperature(r)}",
                "1, 1 : 0, 0 : 1, 1",
                *("free", "free", "symmetry", "symmetry"),
            ),
            "Geometry/Generator": "quarter_hyper_shell",
            "Geometry/Arguments": f"0, 0 : {self.a} : {self.b} : 3 : true",
            "Geometry/Global refinements": n,
            "Time/Phases": "1: 1",
            "Exact solution/Displacement": f"t*{u}*{along}; t*{u}*{across}",
            "Exact solution/Stress": f"t*({radial}*({along})^2 + {hoop}*({across})^2); "
            f"t*({radial}*({across})^2 + {hoop}*({along})^2); t*{axial}; "
            f"t*({radial} - {hoop})*{along}*{across}",
        }

    def check(self, scene, sizes):
        errors, estimates = [], []
        u = self.solution(f"{self.a}")[0].replace("ln", "np.log").replace("^", "**")
        exact = eval(u)
        for n in sizes:
            result = compute(
                {
                    **scene(n),
                    "Output/Points": f"{self.a}, 0",
                    "Error control/Quantity": "point0_x",
                }
            )
            errors.append(result["error_energy"][-1])
            estimates.append(result["estimate_space"][-1])
            # The product with the dual solution, and what is told of it.
            error = exact - result["point0_x"][-1]
            # measured: 1.03, 1.01, 1.00 (ring); 0.99, 0.93, 0.92 (section)
            self.assertClose(result["quantity_correction"][-1] / error, 1, absolute=0.12)
            self.assertClose(result["quantity_total"][-1] / abs(error), 2, absolute=0.15)
        rate = np.log2(errors[-2] / errors[-1])
        self.assertGreater(rate, 0.95)
        self.assertLess(rate, 1.1)
        effectivity = np.array(estimates) / errors
        self.assertGreater(effectivity.min(), 0.95, effectivity)
        self.assertLess(effectivity.max(), 1.6, effectivity)
        self.assertLess(errors[-1], 0.1 * result["exact_energy"][-1])

    def test_ring(self):
        self.check(self.ring, (4, 8, 16))

    def test_mean_dilatation(self):
        """Equations and residuals know the mean of the temperature in a cell, which
        moves the inner face to a fortieth of the error of full integration."""
        result = compute(
            {
                **self.ring(8),
                "Material/Volumetric integration": "mean dilatation",
                "Output/Points": f"{self.a}, 0",
                "Error control/Quantity": "point0_x",
            }
        )
        u = self.solution(f"{self.a}")[0].replace("ln", "np.log").replace("^", "**")
        error = eval(u) - result["point0_x"][-1]
        # measured: 0.38, and 13.8 of residuals that take the temperature at faces
        self.assertClose(result["quantity_correction"][-1] / error, 0.4, absolute=0.4)
        effectivity = result["estimate_space"][-1] / result["error_energy"][-1]
        self.assertClose(effectivity, 1, absolute=0.05)

    def test_mean_dilatation_in_creep(self):
        """The bar of a point knows that the equations see the mean of the thermal
        pressure, of which creep takes nothing."""
        coarse, fine = (
            compute(
                {
                    **self.ring(n),
                    "Exact solution/Displacement": "",
                    "Exact solution/Stress": "",
                    "Geometry/Arguments": f"{n}, 1 : 1, 0 : 2, {1 / n} : true",
                    **of_law("norton", Rate_factor=1e-6, Exponent=3, Stress_cap=100),
                    "Time/Scheme": "backward Euler",
                    "Time/Phases": "1: 8",
                    "Output/Points": f"{self.a}, 0",
                    "Error control/Quantity": "point0_x",
                }
            )
            for n in (8, 64)
        )
        error = abs(fine["point0_x"][-1] - coarse["point0_x"][-1])
        # measured: 5.7, and 38 without the thermal pressure; 4.3 and 37 of it space
        self.assertGreater(coarse["quantity_total"][-1], 0.7 * error)
        self.assertLess(coarse["quantity_total"][-1], 8 * error)

    def test_section(self):
        self.check(self.section, (2, 3, 4))

    def test_adaptive(self):
        """To a tolerance, on meshes that change while the body is heated: what
        the temperature gives comes from the data on every mesh."""
        scene = {
            **self.ring(2),
            "Temperature/Value": f"t*{self.temperature('x')}",
            "Time/Phases": "1: 4",
            "Error control/Tolerance": 0.04,
            "Solver/Contact tolerance": 1e-10,
        }
        results = [compute(scene, ranks) for ranks in (1, 2)]
        for result in results:
            self.assertLess(
                result["error_energy"][-1], 0.04 * result["exact_energy"][-1]
            )
            self.assertGreater(result["cells"][-1], 16)
        for name in "cells", "stored_energy", "thermal_work", "error_energy":
            a, b = (result[name] for result in results)
            self.assertLess(abs(a - b).max(), 1e-7 * abs(a).max(), name)

    def test_new_meshes(self):
        """Carry what has flowed, here nothing, and take what expands from the data."""
        scene = {
            **self.ring(2),
            "Exact solution/Displacement": "",
            "Exact solution/Stress": "",
            **of_law("maxwell", Viscosity=1e20),
            "Time/Phases": "1: 4",
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Every n steps": 1,
            "Output/Additional fields": "irreversible strain",
        }
        for ranks in 1, 3:
            result = compute(scene, ranks)
            self.assertGreater(len(set(result["cells"])), 2)
            fields = result.fields().cell_data
            for component in "xx", "yy", "zz", "xy":
                strain = abs(fields[f"irreversible_strain_{component}"]).max()
                self.assertLess(strain, 1e-12 * ALPHA * self.T, component)


class Arrhenius(TestCase):
    """Q in J/mol: one law at another temperature is the law with other
    parameters."""

    Q, R, LAW = 54e3, 8.314462618, 323.15

    def factor(self, T):
        return np.exp(-self.Q / self.R * (1 / T - 1 / self.LAW))

    laws = {
        # what is multiplied by the factor, or divided by it, and the others
        "norton": ("Rate factor", 2.0, True, {"Exponent": 3, "Stress cap": 10}),
        "maxwell": ("Viscosity", 3.0, False, {}),
        "zener": (
            *("Relaxation time", 0.7, False),
            {"Long-term Young's modulus": 1, "Long-term Poisson's ratio": 0.3},
        ),
        "perzyna": (
            *("Viscosity", 2.0, False), {"Yield radius": 0.1, "Hardening modulus": 0.5}
        ),
    }

    def scene(self, law, parameter, **more):
        return {
            "Dimension": 2,
            "Geometry/Arguments": "4, 4 : 0, 0 : 1, 1 : true",
            "Material/Young's modulus": 5,
            "Material/Law": law,
            f"Material/{law}/{self.laws[law][0]}": parameter,
            **{f"Material/{law}/{k}": v for k, v in self.laws[law][3].items()},
            **boundaries(
                "clamped",
                {"Role": "traction", "Traction": "0.3*t; 0.1"},
                "free",
                "free",
            ),
            "Initial state/Equilibrate": "true",
            "Time/Phases": "1: 8",
            "Output/Fields every": 0,
            **more,
        }

    def test_all_laws(self):
        """Given by activation energy, and as an expression of T."""
        warm = 333.15
        f = self.factor(warm)
        for (law, (name, value, grows, _)), scheme in zip(
            self.laws.items(), ("Heun", "backward Euler", "forward Euler", "Heun")
        ):
            with self.subTest(law=law):
                scaled = compute(self.scene(law, value * f if grows else value / f,
                                            **{"Time/Scheme": scheme}))  # fmt: skip
                activated = {
                    "Temperature/Value": warm,
                    "Material/Activation energy": self.Q,
                    "Material/Law temperature": self.LAW,
                }
                of_T = f"exp({-self.Q / self.R}*(1/T - 1/{self.LAW}))"
                for entries in (
                    self.scene(law, value, **{"Time/Scheme": scheme}, **activated),
                    self.scene(
                        law,
                        f"{value}{'*' if grows else '/'}{of_T}",
                        **{"Time/Scheme": scheme, "Temperature/Value": warm},
                    ),
                ):
                    result = compute(entries)
                    for column in "max_displacement", "viscous_dissipation":
                        a, b = scaled[column], result[column]
                        self.assertLess(abs(a - b).max(), 1e-9 * abs(a).max(), column)
                    self.assertLess(abs(scaled["k_r"] - result["k_r"]).max(),
                                    1e-9 * scaled["k_r"].max())  # fmt: skip

    def test_creep_of_a_bar(self):
        """Under a stress sigma a bar creeps at A sigma^n times the factor of its
        temperature, also of one that changes."""
        A, n, sigma = 1e-3, 3, 1.5
        result = compute(
            {
                "Dimension": 3,
                "Geometry/Arguments": "1, 1, 1 : 0, 0, 0 : 1, 1, 1 : true",
                "Material/Young's modulus": 1e3,
                **of_law("norton", Rate_factor=A, Exponent=n, Stress_cap=100),
                "Material/Activation energy": self.Q,
                "Material/Law temperature": self.LAW,
                "Temperature/Value": "if(t > 0.5, 343, 303)",
                **boundaries(
                    "symmetry",
                    {"Role": "traction", "Traction": f"{sigma}; 0; 0"},
                    *("symmetry", "free", "symmetry", "free"),
                ),
                "Initial state/Equilibrate": "true",
                "Time/Phases": "0.5: 3, 1: 3",
                "Time/Scheme": "backward Euler",
                "Solver/Contact tolerance": 1e-12,
                "Output/Points": "1, 0, 0",
                "Output/Fields every": 0,
            }
        )
        u = result["point0_x"]
        self.assertLess(abs(u[0] / (sigma / 1e3) - 1), 1e-9)
        for first, T in ((0, 303), (3, 343)):
            rate = (u[first + 3] - u[first]) / 0.5
            self.assertLess(abs(rate / (A * sigma**n * self.factor(T)) - 1), 1e-7, T)

    def test_limit_follows_the_hottest_place(self):
        scene = self.scene(
            "maxwell",
            3,
            **{
                "Temperature/Value": "323.15 + 20*x*t",
                "Material/Activation energy": self.Q,
                "Material/Law temperature": self.LAW,
                "Output/Fields every": 0,
            },
        )
        result = compute(scene)
        # that of the samples nearest to x = 1, at the beginning of each step
        place = 1 - 0.25 * (0.5 - 0.5 / 3**0.5)
        T = 323.15 + 20 * place * result["t"][:-1]
        limit = result["step_limit"][1:]
        self.assertLess(abs(limit / limit[0] * self.factor(T) - 1).max(), 1e-9)

    def test_infinite_law_temperature(self):
        """exp(-Q/(R T)), as creep laws are often written."""
        T = 350.0
        results = [
            compute(
                self.scene(
                    "norton",
                    value,
                    **{
                        "Temperature/Value": T,
                        "Material/Activation energy": 10 * self.R,
                        "Material/Law temperature": "infinite",
                    }
                    if energy
                    else {},
                )
            )["max_displacement"]
            for value, energy in ((2, True), (2 * np.exp(-10 / T), False))
        ]
        self.assertLess(abs(results[0] / results[1] - 1).max(), 1e-12)

    def test_parsed(self):
        """T beside the stress in the rate of a parsed law."""
        entries = self.scene("norton", 2)
        parsed = {k: v for k, v in entries.items() if "norton" not in k}
        parsed |= {
            **of_law("parsed", Strain_rate="2*T/300*min(sigma_eq, 10)^3"),
            "Temperature/Value": 300,
        }
        a, b = compute(entries), compute(parsed)
        for column in "max_displacement", "viscous_dissipation":
            self.assertLess(
                abs(a[column] - b[column]).max(), 1e-7 * abs(a[column]).max()
            )


class Pipe(TestCase):
    """prm/verification/hot_pipe.prm, in MPa, mm and h."""

    def test_check(self):
        """The law relaxes the thermal stress in the heat that makes it."""
        with Job("hot_pipe") as job:
            said = job.run("--check").stdout
        line = re.search(r"within \|sigma\|/\|G\| = (\S+) to (\S+) h", said)
        inner, outer = (723.15 + 100 * np.log(200 / r) / np.log(2) for r in (106, 194))
        quotient = np.exp(110e3 / 8.314 * (1 / outer - 1 / inner))
        self.assertClose(float(line[2]) / float(line[1]), quotient, relative=0.1)

    def test_check_of_later_times(self):
        """Too cold around 0.35 h, which no step ends at."""
        cold = "720 K*(1 - 2*if(abs(t/(1 h) - 0.35) < 0.04, 1, 0))"
        with Job("hot_pipe", {"Temperature/Value": cold}) as job:
            process = job.run("--check", code=1)
        self.assertIn("'Temperature/Value' is -720 at", said(process))
        self.assertIn("t = 0.32", said(process))

    def test_creep(self):
        result = run("hot_pipe")
        # Heated within an hour it is nearly elastic.
        a, b, r, T = 100.0, 200.0, 143.75, 100.0
        c = 160e3 * 1.3e-5 * T / (2 * 0.7 * np.log(2))
        part = a**2 / (b**2 - a**2) * np.log(2)
        hoop = c * (1 - np.log(b / r) - part * (1 + b**2 / r**2))
        row = result.row(1)
        self.assertLess(abs(result["point0_stress_zz"][row] - hoop), 0.01 * c)
        # Rates are those of stress and temperature there.
        xx, yy, zz, xy = (
            result[f"point0_stress_{name}"][row:] for name in ("xx", "yy", "zz", "xy")
        )
        mises = np.sqrt(
            ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2
        )
        hot = result["point0_temperature"][row:]
        self.assertLess(abs(hot - 723.15 - T * np.log(b / r) / np.log(2)).max(), 0.2)
        factor = np.exp(-110e3 / 8.314462618 * (1 / hot - 1 / 723.15))
        rate = 1e-6 * (mises / 100) ** 4 * factor
        self.assertLess(abs(result["point0_creep_rate"][row:] / rate - 1).max(), 0.05)
        # What no load holds creeps away.
        self.assertLess(mises[-1], 0.5 * mises[0])
        self.assertLess(
            abs(result["energy_balance_defect"]).max(),
            1e-5 * result["thermal_work"].max(),
        )


class Times(TestCase):
    heated = body(
        "300 + 100*min(t, 0.3) + if(t > 0.7, 20, 0)",
        "6, 6 : 0, 0 : 1, 1",
        *("clamped", "free", "free", "free"),
        **{
            **of_law("maxwell", Viscosity=100),
            "Time/Phases": "1: 10",
            "Time/Scheme": "backward Euler",
            "Step control/Tolerance": 0.02,
            "Solver/Contact tolerance": 0,
        },
    )

    def test_kinks_and_jumps(self):
        """Steps end where the temperature has a kink, and around its jump."""
        result = compute(self.heated)
        times = result["t"]
        self.assertLess(abs(times - 0.3).min(), 1e-9)
        steps = np.diff(times)
        short = steps[(times[1:] > 0.699) & (times[1:] < 0.7001)].min()
        self.assertLess(short, 1e-5)
        self.assertIn("Temperature/Value", result.stdout + result.stderr)
        work = abs(result["thermal_work"]).max()
        self.assertLess(abs(result["energy_balance_defect"]).max(), 1e-6 * work)
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as table:
            table.write("t,oven\n0,300\n0.37,400\n0.61,400\n1,320\n")
            table.flush()
            times = compute({**self.heated, "Temperature/Value": "oven(t)",
                             "Table 1/File": table.name})["t"]  # fmt: skip
        self.assertLess(len(times), 20)
        for kink in 0.37, 0.61:
            self.assertLess(abs(times - kink).min(), 1e-9)

    def test_restart(self):
        """A run that goes on from a checkpoint, on meshes that change, is the run,
        bit by bit: of the temperature nothing is stored."""
        more = {
            "Mesh refinement/Strategy": "residual",
            "Geometry/Arguments": "4, 2 : 100, 0 : 200, 50 : true",
            "Time/Phases": "1: 4, 100: 4",
            **EVERY_STEP,
        }
        with Job("hot_pipe", more) as whole:
            cells = whole.run()["cells"]
            self.assertGreater(np.ptp(cells[2:]), 0)
            with Job("hot_pipe", more, copy_of=whole) as resumed:
                resumed.forget_after(3)
                resumed.run("--restart")
                self.assertEqual(
                    *(
                        without_wall_times(job.results / "statistics.csv")
                        for job in (whole, resumed)
                    )
                )

    def test_stages(self):
        """What is added later expands from the temperature of that time, and what is
        left without a part of the body as before: free but for the plane strain."""
        for dim, event, ranks in (
            (2, "Added", 1),
            (2, "Added", 2),
            (2, "Removed", 1),
            (3, "Added", 1),
            (3, "Removed", 2),
        ):
            plain = body(
                "20 + 100*t",
                "4, 2 : 0, 0 : 2, 1" if dim == 2 else "4, 2, 2 : 0, 0, 0 : 2, 1, 1",
                *("symmetry", "free", "symmetry", "free", "symmetry", "free")[: 2 * dim],
            )
            scene = {
                name.replace("Material/", f"Material {number}/"): value
                for name, value in plain.items()
                for number in (0, 1)
            }
            scene |= {
                "Geometry/Material ids": "if(x > 1, 1, 0)",
                "Geometry/Boundary refinements": "3: 1",
                f"Material 1/{event} at": 0.5,
                "Time/Phases": "0.5: 2, 1: 2",
            }
            stress = E * ALPHA * np.array([100, 50])
            with self.subTest(event, dim=dim, ranks=ranks):
                result = compute(scene, ranks)
                fields = result.fields()
                found = fields.cell_data["von_mises"]
                middle = fields.points[fields.cells].mean(axis=1)
                expected = stress[(middle[:, 0] > 1).astype(int)] * (dim == 2)
                self.assertEqual((middle[:, 0] > 1).any(), event == "Added")
                self.assertClose(found, expected, absolute=1e-5 * stress[0])
                defect = abs(result["energy_balance_defect"]).max()
                self.assertLess(defect, 1e-10 * max(1, result["thermal_work"][-1]))

    def test_at_rest(self):
        """A temperature that stays leaves the body as it is."""
        scene = body("300 + 10*x", *SQUARE, **{"Time/Phases": "1: 3"})
        result = compute(
            {**scene, "Temperature/Reference temperature": 300,
             "Initial state/Equilibrate": "true"}
        )  # fmt: skip
        self.assertGreater(result["max_displacement"][0], 0)
        self.assertTrue(result["unchanged"][1:].all())


class Contact(TestCase):
    """A block that is heated between two rigid platens."""

    def block(self, friction, **more):
        platen = {"Role": "contact", "Contact law": "unilateral", "Gap": 0, **friction}
        return body(
            "300 + 100*t",
            "8, 8 : 0, 0 : 1, 1",
            *("symmetry", "free", platen, platen),
            **{"Time/Phases": "1: 12", **more},
        )

    def test_friction(self):
        none = compute(self.block({"Friction law": "none"}))
        pressure = E * ALPHA * 100 / (1 - NU)
        self.assertLess(abs(none["contact_force_y"][-1]), 1e-9 * pressure)
        self.assertLess(abs(none["stored_energy"][-1] / (pressure**2 * (1 - NU) / E) - 1),
                        1e-9)  # fmt: skip
        # Glued, and friction that is as good as that.
        glued = compute(
            {
                **body(
                    "300 + 100*t",
                    "8, 8 : 0, 0 : 1, 1",
                    *("symmetry", "free", "clamped", "clamped"),
                ),
                "Time/Phases": "1: 12",
            }
        )
        sticking, slipping = (
            compute(self.block({"Friction law": "coulomb", "Friction coefficient": mu}))
            for mu in (50, 0.2)
        )
        self.assertLess(
            abs(sticking["stored_energy"][-1] / glued["stored_energy"][-1] - 1), 2e-2
        )
        self.assertGreater(slipping["friction_dissipation"][-1], 0)
        stored = [r["stored_energy"][-1] for r in (none, slipping, sticking)]
        self.assertEqual(stored, sorted(stored))
        # Heat pays for slip.
        self.assertLess(
            abs(slipping["energy_balance_defect"][-1]),
            0.1 * slipping["friction_dissipation"][-1],
        )
        self.assertGreater(slipping["thermal_work"][-1], slipping["stored_energy"][-1])

    def test_two_bodies(self):
        """Two glued bodies of two materials, which expand differently, are the
        one body of these materials."""
        hot = {
            f"Material {i}/{name}": value
            for i, alpha in ((0, ALPHA), (1, 3 * ALPHA))
            for name, value in (
                ("Young's modulus", E),
                ("Poisson's ratio", NU),
                ("Thermal expansion", alpha),
            )
        }
        common = {
            "Dimension": 2,
            "Temperature/Value": "300 + 50*t*(1 + y)",
            "Time/Phases": "1: 2",
            "Solver/Contact tolerance": 1e-12,
            "Output/Fields every": 0,
            **hot,
        }
        one = compute(
            {
                **common,
                "Geometry/Arguments": "6, 12 : 0, 0 : 1, 2 : true",
                "Geometry/Material ids": "y > 1",
                **boundaries("symmetry", "free", "symmetry", "free"),
            }
        )
        box = "subdivided_hyper_rectangle"
        two = compute(
            {
                **common,
                "Geometry/Generator": f"{box} | {box}",
                "Geometry/Arguments": "6, 6 : 0, 0 : 1, 1 : true | "
                "6, 6 : 0, 1 : 1, 2 : true",
                **boundaries("symmetry", "free", "symmetry", "free"),
                **with_roles(symmetry=[20], free=[21]),
                **on_boundary(22, Role="contact", Against=3, Contact_law="bilateral"),
                "Boundary 22/Friction law": "glued",
                "Boundary 23/Role": "free",
            }
        )
        for name in "stored_energy", "thermal_work", "max_displacement":
            self.assertLess(abs(one[name][-1] / two[name][-1] - 1), 1e-8, name)


class Refusals(TestCase):
    creep = {**of_law("norton", Stress_cap=10), "Material/Activation energy": 5e4}

    def refused(self, *words, **entries):
        scene = body("300", *SQUARE)
        result = compute({**scene, **entries}, check=False)
        self.assertNotEqual(result.returncode, 0)
        for word in words:
            self.assertIn(word, said(result))

    def test_sentences(self):
        self.refused("Thermal expansion", "give 'Temperature/Value'",
                     **{"Temperature/Value": ""})  # fmt: skip
        self.refused("has no `Value'", **{"Temperature/Value": "",
                     "Temperature/Reference temperature": 300})  # fmt: skip
        self.refused("needs the temperature for which", **self.creep)
        self.refused("add 273.15 to degrees Celsius", **self.creep,
                     **{"Temperature/Value": "20 - 30*t",
                        "Material/Law temperature": 300})  # fmt: skip
        self.refused("is not positive", **{**self.creep,
                     "Material/Law temperature": -3})  # fmt: skip
        self.refused("law of the temperature T", **{
            "Temperature/Value": "", "Material/Thermal expansion": "",
            "Material/Law": "maxwell", "Material/maxwell/Viscosity": "T"})  # fmt: skip
        self.refused("makes no data for a body with a temperature", **{
            "Exact solution/Displacement": "0; 0", "Exact solution/Stress": "0;0;0;0",
            "Exact solution/Data": "solution"})  # fmt: skip

    def test_warnings(self):
        cold = compute({**body("20", *SQUARE), **self.creep,
                        "Material/Law temperature": 20})  # fmt: skip
        self.assertIn("degrees Celsius", said(cold))
        idle = compute({**body("20", *SQUARE), "Material/Thermal expansion": 0})
        self.assertIn("'Temperature/Value' has no effect",
                      said(idle))  # fmt: skip


if __name__ == "__main__":
    main()
