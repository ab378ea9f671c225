# SPDX-License-Identifier: LGPL-2.1-or-later
"""Springs on boundaries, supports at points and edges: exact states and limits."""

import re

import numpy as np

from harness import TestCase, main, run
from runs import of_law, on_boundary

SOLVERS = ("direct", "multigrid", "algebraic multigrid")
E, NU = 1.0, 0.3
MU, BULK = E / 2 / (1 + NU), E / 3 / (1 - 2 * NU)


class BlockOnSprings(TestCase):
    """springs_block_2d and _3d: uniform states."""

    def check(self, dim, ranks=1, **more):
        more = {path.replace("_", " "): value for path, value in more.items()}
        result = run(
            f"springs_block_{dim}d",
            {"Solver/Contact tolerance": 1e-13, **more},
            ranks=ranks,
        )
        p = 0.1 * result["t"]
        area = 2.0 if dim == 2 else 1.0
        down = "xyz"[dim - 1]
        # plane strain is as stiff as a body with other moduli
        young, ratio = (E / (1 - NU**2), NU / (1 - NU)) if dim == 2 else (E, NU)
        close = {"absolute": 1e-9 * p.max()}
        foot = -p / 0.5
        self.assertClose(result[f"point0_{down}"], foot, **close)
        self.assertClose(result[f"point1_{down}"], foot - p / young, **close)
        wide = 2.0 if dim == 2 else 1.0
        self.assertClose(result["point1_x"], wide * ratio * p / young, **close)
        self.assertClose(result["spring_energy"], area * p * p, **close)
        self.assertClose(result["strain_energy"], area * p * p / 2 / young, **close)
        self.assertClose(
            result["stored_energy"],
            result["spring_energy"] + result["strain_energy"],
            **close,
        )
        self.assertClose(result["energy_balance_defect"], 0, **close)
        number = 2 if dim == 2 else 4
        self.assertClose(result[f"reaction_{number}_{down}"], area * p, **close)
        self.assertClose(result["reaction_point0_x"], 0, **close)
        if dim == 3:
            self.assertClose(result.vector("reaction_edge0"), 0, **close)
        self.assertLess(result["force_balance_defect"].max(), 1e-9)
        self.assertNotIn("carries a force", result.stdout)
        return result

    def test_plane(self):
        for solver in SOLVERS:
            self.check(2, **{"Solver/Linear solver": solver})

    def test_space(self):
        for solver in SOLVERS:
            self.check(3, **{"Solver/Linear solver": solver})

    def test_ranks(self):
        for ranks, solver in (2, "multigrid"), (3, "algebraic multigrid"):
            self.check(3, ranks, **{"Solver/Linear solver": solver})

    def test_turned(self):
        """Springs along their normals, whatever these are, and components of
        supports along the axes: a block that is turned by 30 degrees."""
        angle = np.radians(30)
        c, s = np.cos(angle), np.sin(angle)
        result = run(
            "springs_block_2d",
            {
                "Geometry/Rotation angle": 30,
                "Output/Points": f"0, 0; {2 * c - s!r}, {2 * s + c!r}",
            },
        )
        # Along the foot the point holds what the springs leave free.
        self.assertClose(result["spring_energy"][-1], 0.02, 1e-9)
        self.assertClose(result["reaction_2_x"][-1], -0.2 * s, 1e-9)
        self.assertClose(result["reaction_2_y"][-1], 0.2 * c, 1e-9)

    def test_maxwell_in_series(self):
        """The top is moved; the springs and the body share that, and the body
        relaxes."""
        eta, rate, k_n = 0.5, 0.1, 0.5
        base = {
            **of_law("maxwell", Viscosity=eta),
            "Boundary 3/Role": "displacement",
            **on_boundary(3, Displacement=f"free; -{rate}*min(t, 0.5)", Pressure=""),
            "Time/Phases": "0.5: 10, 2: 15",
        }
        for scheme in "forward Euler", "backward Euler", "Heun":
            with self.subTest(scheme):
                result = run("springs_block_2d", {**base, "Time/Scheme": scheme})
                states = self.recursion(result["t"], scheme, eta, rate, k_n)
                self.assertClose(
                    result["point0_y"], states[:, 0], absolute=1e-9, what="foot"
                )
                self.assertClose(
                    result["point1_x"], 2 * states[:, 1], absolute=1e-9, what="width"
                )
                self.assertClose(
                    result["reaction_2_y"], -2 * k_n * states[:, 0], absolute=1e-9
                )
                self.assertLess(abs(result["energy_balance_defect"]).max(), 1e-9)

    def recursion(self, times, scheme, eta, rate, k_n):
        """(displacement of the foot, strain along it) at all times."""

        def hooke(strain):
            return (BULK - 2 / 3 * MU) * strain.sum() + 2 * MU * strain

        def flow(stress):
            return -MU / eta * (stress - stress.mean())

        def equilibrium(z, t):
            """sigma_xx = 0, sigma_yy = k u and the height of the body is 1."""
            top = -rate * min(t, 0.5)

            def residual(u, width):
                stress = hooke(np.array([width, top - u, 0.0])) + z
                return np.array([stress[0], stress[1] - k_n * u])

            start = residual(0.0, 0.0)
            columns = [residual(1.0, 0.0) - start, residual(0.0, 1.0) - start]
            u, width = np.linalg.solve(np.column_stack(columns), -start)
            return u, width, hooke(np.array([width, top - u, 0.0])) + z

        z, states = np.zeros(3), [(0.0, 0.0)]
        stress = np.zeros(3)
        for old, t in zip(times, times[1:]):
            k = t - old
            if scheme == "backward Euler":
                # linear: a fixed point converges for k MU/eta < 1
                new = stress
                for _ in range(200):
                    new = equilibrium(z + k * flow(new), t)[2]
                z = z + k * flow(new)
            elif scheme == "Heun":
                predicted = equilibrium(z + k * flow(stress), t)[2]
                z = z + k / 2 * (flow(stress) + flow(predicted))
            else:
                z = z + k * flow(stress)
            u, width, stress = equilibrium(z, t)
            states.append((u, width))
        return np.array(states)

    def test_limits(self):
        """Ever stiffer springs clamp, or hold the normal, at first order."""

        def foot(**more):
            more = {f"Boundary 2/{k.replace('_', ' ')}": v for k, v in more.items()}
            return run("springs_block_2d", {"Supports/Points": "", **more})

        def top(result):
            return result.vector("point1")[-1]

        for limit, entries in (
            ("clamped", ("Normal_stiffness", "Tangential_stiffness")),
            ("displacement", ("Normal_stiffness",)),
        ):
            more = {"Role": limit}
            if limit == "displacement":
                # sliding: the same, but nothing held along the foot but by springs
                more = {
                    "Role": limit,
                    "Displacement": "free; 0",
                    "Normal_stiffness": 0,
                    "Tangential_stiffness": 1,
                }
                entries, rest = ("Normal_stiffness",), {"Tangential_stiffness": 1}
            else:
                rest = {}
            exact = top(foot(**more))
            errors = [
                np.linalg.norm(top(foot(**rest, **dict.fromkeys(entries, k))) - exact)
                for k in (1e3, 1e4, 1e6)
            ]
            self.assertClose(errors[1] / errors[0], 0.1, absolute=0.005, what=limit)
            self.assertClose(errors[2] / errors[1], 0.01, absolute=0.0005, what=limit)


class Solvers(TestCase):
    def test_iterations_do_not_grow(self):
        """Springs as the only support, soft ones and stiff ones, with a load
        that they have to hold against turning."""
        for dim, levels in (2, (5, 6)), (3, (2, 3)):
            foot = 2 if dim == 2 else 4
            for solver in SOLVERS[1:]:
                for stiffness in 1e-4, 1e4:
                    counts = []
                    for level in levels:
                        result = run(
                            f"springs_block_{dim}d",
                            {
                                "Geometry/Global refinements": level,
                                "Geometry/Boundary refinements": "",
                                "Supports/Points": "",
                                "Supports/Edges": "",
                                "Solver/Linear solver": solver,
                                f"Boundary {foot}/Normal stiffness": stiffness,
                                f"Boundary {foot}/Tangential stiffness": stiffness,
                                f"Boundary {foot + 1}/Pressure": "0.1*t*(1 + x)",
                                "Time/Phases": "1: 1",
                            },
                        )
                        counts.append(result["linear_iterations"][-1])
                    what = f"{dim}D, {solver}, {stiffness}"
                    self.assertLessEqual(max(counts), 16, what)
                    self.assertLessEqual(counts[1], counts[0] + 2, what)


class Strip(TestCase):
    """springs_strip_2d: Airy's function."""

    @staticmethod
    def displacement(k_n):
        """The exact (u_x, u_y) as expressions."""
        a = float(np.pi / 2)

        def derivatives(y):
            """f, f', f'', f''' as rows over (A, B, C, D)."""
            c, s = np.cosh(a * y), np.sinh(a * y)
            return np.array(
                [
                    [c, y * c, s, y * s],
                    [a * s, c + a * y * s, a * c, s + a * y * c],
                    [
                        a**2 * c,
                        2 * a * s + a**2 * y * c,
                        a**2 * s,
                        2 * a * c + a**2 * y * s,
                    ],
                    [
                        a**3 * s,
                        3 * a**2 * c + a**3 * y * s,
                        a**3 * c,
                        3 * a**2 * s + a**3 * y * c,
                    ],
                ]
            )

        def along(f):
            return ((1 - NU) * f[2] + NU * a**2 * f[0]) / (2 * MU * a)

        def up(f):
            rest = ((1 - NU) * f[3] + NU * a**2 * f[1]) / (2 * MU * a)
            return -(a * f[1] / MU - rest) / a

        top, foot = derivatives(1.0), derivatives(0.0)
        rows = [top[0], top[1], foot[1], -(a**2) * foot[0] - k_n * up(foot)]
        # sigma_yy = -a^2 f cos = -cos at the top.
        A, B, C, D = map(float, np.linalg.solve(rows, [1 / a**2, 0, 0, 0]))
        ay, x = f"({a!r}*y)", f"({a!r}*x)"
        c, s = f"cosh{ay}", f"sinh{ay}"
        f0 = f"(({A!r}+{B!r}*y)*{c}+({C!r}+{D!r}*y)*{s})"
        f1 = (f"(({a * A + D!r}+{a * B!r}*y)*{s}+({B + a * C!r}+{a * D!r}*y)*{c})")
        f2 = (
            f"(({a**2 * A + 2 * a * D!r}+{a**2 * B!r}*y)*{c}"
            f"+({2 * a * B + a**2 * C!r}+{a**2 * D!r}*y)*{s})"
        )
        f3 = (
            f"(({a**3 * A + 3 * a**2 * D!r}+{a**3 * B!r}*y)*{s}"
            f"+({3 * a**2 * B + a**3 * C!r}+{a**3 * D!r}*y)*{c})"
        )
        u_x = f"t*sin{x}*({(1 - NU)!r}*{f2}+{NU * a**2!r}*{f0})/{2 * MU * a!r}"
        u_y = (
            f"-t*cos{x}/{a!r}*({a / MU!r}*{f1}"
            f"-({(1 - NU)!r}*{f3}+{NU * a**2!r}*{f1})/{2 * MU * a!r})"
        )
        return f"{u_x}; {u_y}"

    def test_orders_and_estimate(self):
        for k_n in 1.0, 1e4:
            errors, ratios = [], []
            for level in 2, 3:
                result = run(
                    "springs_strip_2d",
                    {
                        "Boundary 2/Normal stiffness": k_n,
                        "Exact solution/Displacement": self.displacement(k_n),
                        "Geometry/Global refinements": level,
                        "Error control/Error bar": "true",
                    },
                )
                errors.append(result["error_energy"][-1])
                ratios.append(result["estimate_space"][-1] / errors[-1])
                # The exact displacement is that of these springs.
                self.assertLess(errors[-1], 0.2 * result["exact_energy"][-1])
            self.assertClose(errors[0] / errors[1], 2.0, absolute=0.1, what=f"{k_n}")
            # measured: 1.06 to 1.13
            for ratio in ratios:
                self.assertGreater(ratio, 1.0)
                self.assertLess(ratio, 1.2)

    def test_open_end(self):
        """Where springs begin, tractions are large, and so are residuals: the
        estimate keeps its ratio to the error from soft springs to those that are
        a plane of symmetry."""

        def strip(level, more):
            changes = {
                "Error control/Error bar": "true",
                "Geometry/Global refinements": level,
            }
            return run("springs_strip_2d", {**changes, **more})

        for k_n in 1.0, 100.0, 1e4:
            springs = {"Boundary 2/Normal stiffness": f"if(x > 1, {k_n}, 0)"}
            coarse, fine = strip(2, springs), strip(5, springs)
            # Of the loads' work the error lacks its own energy.
            lost = fine["stored_energy"][-1] - coarse["stored_energy"][-1]
            ratio = coarse["estimate_space"][-1] / np.sqrt(2 * lost)
            self.assertGreater(ratio, 1.0, f"{k_n}")
            self.assertLess(ratio, 2.0, f"{k_n}")
        stiff = strip(2, {"Boundary 2/Normal stiffness": "if(x > 1, 1e8, 0)"})
        plane = {
            "Geometry/Boundary ids": "if(id == 2 && x > 1, 4, id)",
            **on_boundary(2, Normal_stiffness="", Role="free"),
            "Boundary 4/Role": "symmetry",
        }
        self.assertClose(
            stiff["estimate_space"][-1],
            strip(2, plane)["estimate_space"][-1],
            relative=1e-6,
        )


class Beam(TestCase):
    def test_hetenyi(self):
        """A thin beam on Winkler's foundation, more exactly on finer meshes."""
        k, lam = 4e-4 / 12 / (1 - NU**2), 0.1
        x = np.array([0, 5, 10, 20, 30])
        theory = 1e-4 * lam / 2 / k * np.exp(-lam * x)
        theory *= np.cos(lam * x) + np.sin(lam * x)
        errors = []
        for level in 1, 2, 3:
            result = run(
                "springs_beam_2d",
                {"Geometry/Global refinements": level, "Supports/Points": ""},
            )
            w = np.array([-result[f"point{i}_y"][-1] for i in range(len(x))])
            errors.append(abs(w - theory).max() / theory[0])
            self.assertClose(result["reaction_2_y"][-1], 0.5e-4, 1e-8)
        self.assertLess(errors[1], 0.5 * errors[0])
        self.assertLess(errors[2], 0.03)


class FreeBlock(TestCase):
    """supports_block_3d: loads in balance, held at three points."""

    def check(self, ranks=1, **more):
        result = run(
            "supports_block_3d", {"Solver/Contact tolerance": 1e-13, **more}, ranks
        )
        sigma = np.array([[0.1, 0.02, 0], [0.02, -0.05, 0.03], [0, 0.03, 0]])
        strain = (sigma - NU / (1 + NU) * np.trace(sigma) * np.eye(3)) * (1 + NU) / E
        # u_y = u_z = 0 along the x axis, u_y = 0 along the z axis.
        gradient = strain.copy()
        for i, j in (1, 0), (2, 0), (1, 2):
            gradient[i, j], gradient[j, i] = 0.0, 2 * strain[i, j]
        for number, x in enumerate(((1, 0, 0), (0, 2, 0), (1, 2, 1))):
            self.assertClose(
                result.vector(f"point{number}")[-1], gradient @ x, absolute=1e-10
            )
        for name in "point0", "point1", "point2":
            self.assertClose(result.vector(f"reaction_{name}"), 0, absolute=1e-10)
        deviator = sigma - np.trace(sigma) / 3 * np.eye(3)
        mises = np.sqrt(1.5) * np.linalg.norm(deviator)
        for what in "max", "mean":
            self.assertClose(result[f"{what}_von_mises"][-1], mises, 1e-9)
        self.assertNotIn("carries a force", result.stdout)
        return result

    def test_solvers(self):
        for solver in SOLVERS:
            self.check(**{"Solver/Linear solver": solver})

    def test_ranks(self):
        for ranks, solver in (2, "multigrid"), (3, "algebraic multigrid"):
            self.check(ranks, **{"Solver/Linear solver": solver})

    def test_force_at_a_point(self):
        """Loads that are not in balance: the points carry them, and a note says
        what that means."""
        result = run("supports_block_3d", {"Boundary 5/Traction": "0; 0; -0.1*t"})
        total = sum(result.vector(f"reaction_point{i}")[-1] for i in range(3))
        self.assertClose(total, -result.vector("load")[-1], absolute=1e-10)
        self.assertIn("carries a force", " ".join(result.stdout.split()))

    def test_strains_at_a_point(self):
        """Refined again and again they are large, which is not flow without end."""
        text = """
        set Dimension = 2
        subsection Geometry
          set Arguments = 4, 4 : 0, 0 : 1, 1 : true
        end
        subsection Loads
          set Body force = 0; -0.0004
        end
        subsection Initial state
          set Equilibrate = true
        end
        subsection Supports
          set Points = 0, 1: y
        end
        subsection Boundary 0
          set Role = symmetry
        end
        subsection Mesh refinement
          set Strategy = residual
          set Maximal level = 14
        end
        """
        free = "subsection Boundary {}\nset Role = free\nend\n"
        text += "".join(map(free.format, (1, 2, 3))) + "subsection Time\nset Phases = 1: 30\nend\n"
        said = " ".join(run("hanging", {}, text=text).stdout.split())
        self.assertRegex(said, r"a point alone carries force.* at x = \(\S+e-\d+ 1\)\)")
        self.assertNotIn("flow without end", said)

    def test_maxwell_on_changing_meshes(self):
        """What holds nothing also holds nothing of a body that flows, whose mesh
        changes."""
        result = run(
            "supports_block_3d",
            {
                **of_law("maxwell", Viscosity=1),
                "Mesh refinement/Strategy": "kelly",
                "Mesh refinement/Every n steps": 1,
                "Time/Phases": "1: 4",
            },
        )
        for name in "point0", "point1", "point2":
            self.assertClose(result.vector(f"reaction_{name}"), 0, absolute=1e-9)
        self.assertLess(abs(result["energy_balance_defect"]).max(), 1e-9)


class Refused(TestCase):
    def refuses(self, pattern, scene="springs_block_2d", **more):
        changes = {k.replace("_", " "): v for k, v in more.items()}
        self.refused(changes, re.compile(pattern), scene=scene)

    def test_supports(self):
        key = "Supports/Points"
        for text, words in {
            "0.3, 0: x": r"no vertex .* \(0.3 0\); the nearest one is at \(0 0\)",
            "0, 0: w": "holds 'w', but components are x and y",
            "0, 0: z": "holds 'z', but components are x and y",
            "0, 0:": "holds nothing",
            "0, 0": "holds nothing",
            "0: x": "Supports/Points",
            "0, nan: x": "Supports/Points",
        }.items():
            self.refuses(words, **{key: text})
        for text, words in {
            "2: x": "names one boundary",
            "2, 9: x": "there is no boundary 9",
            "0, 1: x": "do not meet",
            "a, b: x": "is no boundary id",
        }.items():
            self.refuses(words, **{"Supports/Edges": text})

    def test_springs(self):
        foot = "Boundary 2/"
        self.refuses(
            "Normal stiffness' is -[0-9.]+ at x = ", **{foot + "Normal stiffness": "x - 3"}
        )
        self.refuses("lost in rounding", **{foot + "Normal stiffness": 1e-18})
        self.refuses("depends on time", **{foot + "Normal stiffness": "1 + t"})
        self.refuses(
            "leave a rigid motion free: translation along x", **{"Supports/Points": ""}
        )
        self.refuses(
            "leave a rigid motion free: translation along y and rotation about z",
            **{foot + "Normal stiffness": 0, foot + "Tangential stiffness": 0},
        )

    def test_support_beside_contact(self):
        """What meets conditions of a boundary is said."""
        result = run(
            "springs_block_2d", {"Boundary 0/Role": "clamped", "Time/Phases": "1: 1"}
        )
        words = " ".join((result.stdout + result.stderr).split())
        self.assertRegex(words, r"support at the point \(0 0\) is on boundary 0")
        self.assertClose(result["reaction_point0_x"], 0, absolute=0.0)


if __name__ == "__main__":
    main()
