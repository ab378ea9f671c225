# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pressure on faces: it acts along the normals of the mesh, so that uniform and
lithostatic states are exact on polygons and on curved bodies."""

import runpy
import tempfile
from pathlib import Path

import numpy as np

from harness import SOURCE, TestCase, main, run

MESHES = runpy.run_path(
    SOURCE / "prm" / "verification" / "meshes" / "make_meshes.py", run_name="meshes"
)

# Deviations of rounding, relative to stresses and lengths of order one.
ROUNDING = 1e-12
# Of the divergence of stresses by differences.
DERIVATIVE = 1e-8


def drift(dim):
    """(0,4)^2 around a polygon of eight unequal sides, in 3D times (0,2) around
    a hole that narrows with z, whose walls are not plane: 1 the hole, 2 right,
    3 top, 4 left, 5 bottom, 6 and 7 in z. As make_meshes.py has bodies."""
    corners = [(4, 2), (4, 4), (2, 4), (0, 4), (0, 2), (0, 0), (2, 0), (4, 0)]
    radii = [1.0, 0.8, 1.1, 0.9, 0.7, 1.0, 1.2, 0.85]
    sides = [2, 3, 3, 4, 4, 5, 5, 2]
    n_layers, n_levels = 2, 1 if dim == 2 else 3

    def node(i, layer, level):
        return (level * (n_layers + 1) + layer) * 8 + i % 8

    nodes, cells, faces = [], [], []
    for level in range(n_levels):
        for layer in range(n_layers + 1):
            for i in range(8):
                angle = np.pi / 4 * i
                direction = np.array([np.cos(angle), np.sin(angle)])
                inner = 2 + radii[i] * (1 - 0.15 * level) * direction
                share = layer / n_layers
                x = (1 - share) * inner + share * np.array(corners[i])
                nodes.append([*map(float, x), float(level)])

    def add(face_id, *at):
        """A face between the same two nodes on all levels, or in 2D the nodes."""
        if dim == 2:
            faces.append((face_id, [node(*a, 0) for a in at]))
        for level in range(n_levels - 1):
            low, high = ([node(*a, level + up) for a in at] for up in (0, 1))
            faces.append((face_id, low + high[::-1]))

    for i in range(8):
        add(1, (i, 0), (i + 1, 0))
        add(sides[i], (i, n_layers), (i + 1, n_layers))
        for layer in range(n_layers):
            around = [(i, layer), (i, layer + 1), (i + 1, layer + 1), (i + 1, layer)]
            rings = [[node(*a, level) for a in around] for level in range(n_levels)]
            if dim == 2:
                cells.append((1, rings[0]))
                continue
            cells += [(1, low + high) for low, high in zip(rings, rings[1:])]
            faces += [(6, rings[0]), (7, rings[-1])]
    faces.sort(key=lambda face: face[0])
    return nodes, cells, faces


def boundaries(roles):
    return {
        f"Boundary {i}/{name}": value
        for i, entries in roles.items()
        for name, value in entries.items()
    }


def pressed(pressure):
    return {"Role": "traction", "Pressure": pressure}


SYMMETRY = {"Role": "symmetry"}


class Rock(TestCase):
    """A drift, a polygon from a mesh file, in rock under its own weight."""

    DEPTH = "(3 - 0.5*y)"

    def scene(self, dim, pressure, **more):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        file = Path(folder.name) / "drift.msh"
        file.write_text(MESHES["msh2"](dim, *drift(dim)))
        roles = {i: pressed(pressure) for i in (1, 2, 3)}
        roles.update({4: SYMMETRY, 5: SYMMETRY})
        if dim == 3:
            roles.update({6: SYMMETRY, 7: pressed(pressure)})
        minus = f"-({pressure})"
        return {
            "Dimension": dim,
            "Geometry/File": file,
            "Material/Law": "maxwell",
            "Initial state/Stress": "; ".join([minus] * 3 + ["0"] * (2 * dim - 3)),
            "Time/Phases": "1: 4",
            "Output/Fields every": 0,
            **boundaries(roles),
            **more,
        }

    def lithostatic(self, dim, **more):
        """Stresses that vary within cells: all of them at quadrature points."""
        return self.scene(
            dim,
            self.DEPTH,
            **{
                "Loads/Body force": "0; -0.5" + (dim - 2) * "; 0",
                "Material/Volumetric integration": "full",
                "Material/Stress history": "quadrature points",
                **more,
            },
        )

    def check_at_rest(self, scene, ranks):
        result = run("drift", scene, ranks=ranks, text="")
        self.assertLess(result["max_displacement"].max(), ROUNDING)
        self.assertClose(result["max_von_mises"], 0, absolute=10 * ROUNDING)
        # The stress is there: the walls that hold the body feel it.
        self.assertGreater(abs(result["reaction_4_x"][-1]), 5)
        return result

    def test_lithostatic_stress_is_at_rest(self):
        for dim, ranks in (2, 1), (2, 3), (3, 2):
            with self.subTest(dim=dim, ranks=ranks):
                result = self.check_at_rest(self.lithostatic(dim), ranks)
                # and has no error, though it grows with depth in each cell
                for name in ("estimate_space", "estimate_initial"):
                    self.assertLess(result[name].max(), DERIVATIVE, name)

    def test_on_meshes_that_change(self):
        """What little moves the mesh, a millionth of the pressure, is all that moves
        the rock."""
        adaptive = {
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Smallest share": 0,
            "Mesh refinement/Maximal level": 2,
            "Boundary 1/Pressure": f"(1 + 1e-6*t)*{self.DEPTH}",
        }
        for dim, ranks in (2, 1), (2, 3), (3, 2):
            with self.subTest(dim=dim, ranks=ranks):
                result = run(
                    "drift", self.lithostatic(dim, **adaptive), ranks=ranks, text=""
                )
                self.assertLess(result["max_displacement"].max(), 2e-5)
                self.assertGreater(abs(result["reaction_4_x"][-1]), 5)
                self.assertGreater(result["cells"][-1], 2 * result["cells"][0])

    def test_uniform_pressure_suits_any_history(self):
        for dim in 2, 3:
            self.check_at_rest(self.scene(dim, "3"), 1)

    def test_without_it_the_walls_are_refused(self):
        scene = self.lithostatic(2, **{"Boundary 1/Pressure": f"0.99*{self.DEPTH}"})
        result = run("drift", scene, text="", check=False)
        self.assertEqual(result.returncode, 1)
        self.assertIn("equilibrium", result.stderr)

    def test_excavation_pulls_the_wall_inwards(self):
        """The pressure of a drift goes: by symmetry of the linear problem half
        of it gives half of the way in."""
        ways = []
        for left in 0.5, 0.0:
            scene = self.scene(
                2,
                "3",
                **{
                    "Material/Law": "elastic",
                    "Boundary 1/Pressure": f"3*(1 - {1 - left}*t)",
                    "Output/Points": "2, 3.1; 2, 0.8",
                },
            )
            result = run("drift", scene, text="")
            ways.append([result["point0_y"][-1], result["point1_y"][-1]])
            # The work of the pressure is in the account of energies.
            self.assertClose(result["energy_balance_defect"], 0, absolute=1e-10)
        self.assertLess(ways[1][0], -0.1)
        self.assertGreater(ways[1][1] - ways[1][0], 1)
        self.assertClose(2 * np.array(ways[0]), ways[1], 1e-10)


class Curved(TestCase):
    """A quarter of a shell, an eighth in 3D, under one pressure all around:
    u = -p/(3K) x, in the plane -p (1+nu)(1-2nu)/E x, on any mesh."""

    def test_uniform_compression(self):
        poisson = 0.3
        for dim, ranks, flat, more in (
            (2, 1, (2, 3), ""),
            (2, 3, (2, 3), "0: 1"),
            (3, 1, (2, 3, 4), "1: 1"),
            (3, 2, (2, 3, 4), "0: 2"),
        ):
            arguments = f"{', '.join(['0'] * dim)} : 1 : 2 : 0 : true"
            roles = {i: pressed("0.2*min(t, 1)") for i in (0, 1)}
            roles.update({i: SYMMETRY for i in flat})
            result = run(
                "shell",
                {
                    "Dimension": dim,
                    "Geometry/Generator": "quarter_hyper_shell",
                    "Geometry/Arguments": arguments,
                    "Geometry/Global refinements": 1,
                    "Geometry/Boundary refinements": more,
                    "Material/Poisson's ratio": poisson,
                    "Time/Phases": "2: 2",
                    "Solver/Contact tolerance": 1e-13,
                    "Output/Points": ", ".join(["0"] * (dim - 1) + ["1.5"]),
                    **boundaries(roles),
                },
                text="",
                ranks=ranks,
            )
            shrink = 0.2 * (1 - 2 * poisson) * (1 + poisson if dim == 2 else 1)
            self.assertClose(
                result["max_displacement"][1:], 2 * shrink, absolute=10 * ROUNDING
            )
            stress = result.fields().cell_data["stress_xx"]
            self.assertClose(stress, -0.2, absolute=1e-7)  # single precision

    def test_initial_stress_in_balance(self):
        """Also where cells of different size meet on a curved boundary."""
        for dim, generator, arguments, more, pieces, ranks in (
            (2, "hyper_shell", "0, 0 : 1 : 2 : 8 : true", "0: 2", (0,), 1),
            (3, "cylinder", "1 : 2", "1: 1", (0, 2), 1),
            (3, "hyper_shell", "0, 0, 0 : 1 : 2 : 12 : true", "0: 1", (0,), 3),
        ):
            roles = {i: pressed("1") for i in pieces}
            roles[1] = {"Role": "clamped"}
            with self.subTest(generator=generator, dim=dim):
                result = run(
                    "curved",
                    {
                        "Dimension": dim,
                        "Geometry/Generator": generator,
                        "Geometry/Arguments": arguments,
                        "Geometry/Global refinements": 1,
                        "Geometry/Boundary refinements": more,
                        "Material/Law": "maxwell",
                        "Initial state/Stress": "; ".join(
                            ["-1"] * 3 + ["0"] * (2 * dim - 3)
                        ),
                        "Time/Phases": "1: 1",
                        **boundaries(roles),
                    },
                    text="",
                    ranks=ranks,
                )
                self.assertLess(result["max_displacement"].max(), ROUNDING)

    def test_lame(self):
        """A ring under inner pressure, u_r = A r + B/r, to second order."""
        E, nu, p, a, b = 1.0, 0.3, 0.1, 1.0, 2.0
        A = (1 + nu) * (1 - 2 * nu) / E * p * a**2 / (b**2 - a**2)
        B = (1 + nu) / E * p * a**2 * b**2 / (b**2 - a**2)
        errors = []
        for refinements in 2, 3:
            result = run(
                "ring",
                {
                    "Geometry/Generator": "quarter_hyper_shell",
                    "Geometry/Arguments": "0, 0 : 1 : 2 : 0 : true",
                    "Geometry/Global refinements": refinements,
                    "Output/Points": "1, 0; 2, 0",
                    "Time/Phases": "1: 1",
                    **boundaries(
                        {
                            0: pressed(f"{p}*t"),
                            1: {"Role": "free"},
                            2: SYMMETRY,
                            3: SYMMETRY,
                        }
                    ),
                },
                text="",
            )
            got = [result["point0_x"][-1], result["point1_x"][-1]]
            errors.append(np.abs(np.array(got) - [A * a + B / a, A * b + B / b]))
        self.assertLess(errors[1].max(), 5e-3 * B)
        self.assertLess(errors[1].max(), 0.3 * errors[0].max())


class Flat(TestCase):
    """On flat faces pressure is the traction -p nu, whatever else there is."""

    ROLES = {
        0: {"Role": "traction", "Traction": "0.1*t; 0.02*t"},
        1: {"Role": "traction"},
        2: {"Role": "contact", "Friction law": "tresca", "Friction bound": 0.05},
        # What is held takes no load, what is free does.
        3: {"Role": "displacement", "Displacement": "0.1*t; free"},
    }
    BOX = {
        "Geometry/Generator": "subdivided_hyper_rectangle",
        "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
        "Material/Law": "maxwell",
        "Time/Phases": "1: 5",
        "Output/Fields every": 0,
        "Mesh refinement/Strategy": "residual",
        "Mesh refinement/Every n steps": 2,
    }

    def compare(self, pressures, tractions, **more):
        scenes = [
            {**self.BOX, **boundaries(self.ROLES), **boundaries(loads), **more}
            for loads in (pressures, tractions)
        ]
        got, expected = (run("flat", scene, text="", ranks=1) for scene in scenes)
        self.assertGreater(expected["cells"][-1], expected["cells"][0])
        self.assertGreater(expected["friction_dissipation"][-1], 0)
        self.assertGreater(expected["external_work"][-1], 0)
        return got, expected

    def test_along_axes_bit_for_bit(self):
        p = "0.2*t*(1 + x)"
        got, expected = self.compare(
            {0: {"Pressure": p}, 1: {"Pressure": p}, 3: {"Pressure": p}},
            {
                0: {"Traction": f"0.1*t - (-1)*({p}); 0.02*t"},
                1: {"Traction": f"-({p}); 0"},
                3: {"Traction": f"1; -({p})"},
            },
        )
        for name, column in expected.statistics.items():
            if not name.startswith("wall_"):
                self.assertClose(got[name], column, 1e-13, 1e-15, name)


if __name__ == "__main__":
    main()
