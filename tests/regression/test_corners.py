# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact pieces that meet at an angle.

Every scene has a displacement field that is linear in space and slips
everywhere, so the discrete answer is exact: a wrong normal, a lost constraint
or a wrong share of the bound at the corner shows at once.
"""

import numpy as np

from harness import TestCase, main, run
from runs import on_boundary, rotation, with_roles


class Corners(TestCase):
    def check_displacement(self, result, constant, gradient, center=0.0):
        """u(x,1) = constant + gradient (x - center), at every node."""
        fields = result.fields()
        dim = len(constant)
        x = fields.points[:, :dim] - center
        expected = np.asarray(constant) + x @ np.asarray(gradient).T
        # single precision in VTU
        self.assertClose(
            fields.point_data["displacement"][:, :dim], expected, absolute=2e-7
        )

    def test_90_degrees_coulomb(self):
        result = run("corner_coulomb_90_2d")
        self.check_displacement(result, (0.2, 0.4), ((-0.013, 0.039), (0.039, -0.143)))
        t = result["t"]
        # lower side of length 2: 0.03 t along x; left side: 0.03 t along y
        self.assertClose(result.vector("friction_force").T, 0.06 * t, absolute=1e-9)
        self.assertClose(result["slip_area"][1:], 4, absolute=1e-10)
        corner = np.outer(t, (0.2 + 0.013 - 0.039, 0.4 - 0.039 + 0.143))
        self.assertClose(result.vector("point0"), corner, absolute=1e-9)
        self.check_identities(result)

    def test_90_degrees_coulomb_that_sticks(self):
        """With a large coefficient the corner holds in both directions and
        its two multipliers are not unique; all identities remain."""
        result = run(
            "corner_coulomb_90_2d",
            {
                "Boundary 0/Friction coefficient": 50,
                "Boundary 1/Friction coefficient": 50,
            },
        )
        self.check_identities(result)
        self.assertClose(result["slip_area"][1:], 0, absolute=1e-10)
        corner = result.vector("point0")
        self.assertClose(corner, 0, absolute=1e-12, what="corner")

    def check_150(self, refinements):
        result = run(
            "corner_tresca_150_2d", {"Geometry/Global refinements": refinements}
        )
        root3 = np.sqrt(3)
        self.check_displacement(result, (0.1, 0.05), ((0.02, 0.05 * root3), (0, -0.03)))
        t = result["t"]
        self.assertClose(
            result.vector("point0"), np.outer(t, (0.1, 0.05)), absolute=1e-9
        )
        self.check_identities(result)
        return result

    def test_150_degrees_tresca(self):
        result = self.check_150(3)
        # Both sides have length 1; the corner holds no friction point, so its
        # share (half a cell of 1/8 on each side) is missing.  Slip is to the
        # right below and downwards on the left.
        bound = 0.25 / 13 * np.sqrt(3) * result["t"]
        share = 1 - 1 / 16
        direction = np.array([1, 0]) + np.array([np.sqrt(3) / 2, -0.5])
        self.assertClose(
            result.vector("friction_force"),
            np.outer(share * bound, direction),
            absolute=1e-9,
            what="friction force",
        )

    def test_150_degrees_with_one_cell(self):
        """One cell carries both normals of the obtuse corner."""
        self.check_150(0)

    def test_150_degrees_frictionless(self):
        """Uniform dilatation slides along both sides: u = x t, for which the
        outer sides need the pressure 2 (lambda + mu)."""
        pressure = 2 * (0.3 / 1.3 / 0.4 + 1 / 2.6) * 0.01
        corners = np.array([[1, 0], [0.25, 1.25], [-np.sqrt(3) / 2, 0.5]])
        overrides = {}
        for side, (a, b) in {1: (0, 1), 3: (1, 2)}.items():
            along = corners[b] - corners[a]
            normal = np.array([along[1], -along[0]]) / np.linalg.norm(along)
            force = pressure * normal
            overrides[f"Boundary {side}/Traction"] = (
                f"{force[0]:.17g}*t; {force[1]:.17g}*t"
            )
        for side in 0, 2:
            overrides[f"Boundary {side}/Friction law"] = "none"
            overrides[f"Boundary {side}/Foundation displacement"] = 0
        result = run("corner_tresca_150_2d", overrides)
        self.check_displacement(result, (0, 0), ((0.01, 0), (0, 0.01)))

    # The corners of corner_tresca_150_2d that the free sides join: the lower
    # one 1-2, and the upper one 2-3.
    FREE_SIDES = {1: ((1, 0), (0.25, 1.25)), 3: ((0.25, 1.25), (-np.sqrt(3) / 2, 0.5))}

    def test_each_side_has_the_reaction_of_its_own_direction(self):
        """Uniform dilatation as above, one side a symmetry plane. Both press
        along their normals only, also in the corner, where the force has two
        parts that are oblique to each other."""
        pressure = 2 * (0.3 / 1.3 / 0.4 + 1 / 2.6) * 0.01
        overrides = {
            "Geometry/Global refinements": 0,
            **on_boundary(2, Role="symmetry", Friction_bound=0, Friction_law="none"),
            "Boundary 2/Foundation displacement": 0,
            **on_boundary(0, Friction_law="none", Friction_bound=0),
            "Boundary 0/Foundation displacement": 0,
        }
        for side, (a, b) in self.FREE_SIDES.items():
            x, y = np.subtract(b, a) / np.linalg.norm(np.subtract(b, a))
            overrides[f"Boundary {side}/Traction"] = (
                f"{pressure * y:.17g}*t; {-pressure * x:.17g}*t"
            )
        result = run("corner_tresca_150_2d", overrides)
        force = pressure * result["t"]
        self.assertNotIn("Warning", result.stdout)
        for side, normal in (2, (0, -1)), (0, (-0.5, -np.sqrt(3) / 2)):
            self.assertClose(
                result.vector(f"reaction_{side}"),
                np.outer(force, normal),
                absolute=1e-11,
                what=f"reaction {side}",
            )

    def test_reactions_at_an_oblique_edge_3d(self):
        """The prism over this quadrilateral, turned: two oblique conditions
        along its edge, three at its corner."""
        pressure = 0.01 / (1 - 2 * 0.3)
        matrix = rotation(50, (1, -2, 2))
        corners = [(0, 0), (1, 0), (-np.sqrt(3) / 2, 0.5), (0.25, 1.25)]
        normals = {
            0: (-0.5, -np.sqrt(3) / 2, 0),
            2: (0, -1, 0),
            4: (0, 0, -1),
            5: (0, 0, 1),
        }
        for side, (a, b) in self.FREE_SIDES.items():
            x, y = np.subtract(b, a) / np.linalg.norm(np.subtract(b, a))
            normals[side] = (y, -x, 0)
        normals = {side: matrix @ normal for side, normal in normals.items()}
        overrides = {
            "Dimension": 3,
            "Geometry/Generator": "general_cell",
            "Geometry/Arguments": " ; ".join(
                f"{x:.17g}, {y:.17g}, {z}" for z in (0, 1) for x, y in corners
            ) + " : true",
            "Geometry/Global refinements": 1,
            "Geometry/Rotation angle": 50,
            "Geometry/Rotation axis": "1, -2, 2",
            "Time/Phases": "1: 2",
        }
        for side in 1, 3, 5:
            overrides[f"Boundary {side}/Role"] = "traction"
            overrides[f"Boundary {side}/Traction"] = "; ".join(
                f"{pressure * c:.17g}*t" for c in normals[side]
            )
        for side in 0, 2, 4:
            overrides[f"Boundary {side}/Role"] = "symmetry"
        result = run("prism", overrides, text="# a prism\n")
        a, b, c, d = (np.array(corner) for corner in corners)
        base = 0.5 * abs(np.cross(d - a, c - b))
        for side, area in (0, 1), (2, 1), (4, base):
            self.assertClose(
                result.vector(f"reaction_{side}"),
                np.outer(pressure * area * result["t"], normals[side]),
                absolute=1e-10,
                what=f"reaction {side}",
            )

    def check_edge(self, result, matrix):
        gradient = np.zeros((3, 3))
        gradient[2, :2] = 0.06, 0.08
        self.check_displacement(
            result, matrix @ (0, 0, 0.1), matrix @ gradient @ matrix.T
        )
        # On the edge of y = 0 with x = 1, which is held in z, there is no
        # friction in z: a sixth of that piece on three cells.  What is left
        # there is x, in which nothing moves, or nothing.
        force = np.outer((0.3 + 0.4 * 5 / 6) / 13 * result["t"], matrix[:, 2])
        self.assertClose(
            result.vector("friction_force"), force, absolute=1e-9, what="friction force"
        )
        self.assertClose(result["slip_area"][1:], 2 - 1 / 6, absolute=1e-10)
        self.check_identities(result)

    def test_90_degrees_edge_tresca_3d(self):
        self.check_edge(run("corner_tresca_90_3d"), np.eye(3))

    def test_90_degrees_edge_tresca_3d_turned(self):
        """The edge is oblique too.  Side x = 1 is held in all components,
        because a single one is not a Cartesian component any more."""
        matrix = rotation(50, (1, -2, 2))

        def turned(vector):
            return "; ".join(
                " + ".join(f"({c:.17g})*({v})" for c, v in zip(row, vector))
                for row in matrix
            )

        y = " + ".join(f"({c:.17g})*{v}" for c, v in zip(matrix[:, 1], "xyz"))
        result = run(
            "corner_tresca_90_3d",
            {
                "Geometry/Rotation angle": 50,
                "Geometry/Rotation axis": "1, -2, 2",
                "Boundary 1/Displacement": turned(("0", "0", f"t*(0.16 + 0.08*({y}))")),
                "Boundary 3/Traction": turned(("0", "0", "0.4/13*t")),
                "Boundary 4/Traction": turned(("-0.3/13*t", "-0.4/13*t", "0")),
                "Boundary 5/Traction": turned(("0.3/13*t", "0.4/13*t", "0")),
            },
        )
        self.check_edge(result, matrix)

    def test_90_degrees_edge_coulomb_3d(self):
        """Both planes press by lambda 0.08 t = 0.6/13 t, as the cube gets shorter
        along the edge but not across, and friction follows from these pressures,
        along the edge from both."""
        scene = {
            f"Boundary {i}/{name}": value
            for i, coefficient in ((0, 0.5), (2, 2 / 3))
            for name, value in (
                ("Contact law", "unilateral"),
                ("Friction law", "coulomb"),
                ("Friction coefficient", coefficient),
            )
        }
        scene["Boundary 1/Displacement"] = "0; free; t*(0.16 + 0.08*y - 0.08*z)"
        scene["Boundary 3/Traction"] = "0; -0.6/13*t; 0.4/13*t"
        scene["Boundary 4/Traction"] = "-0.3/13*t; -0.4/13*t; 1.4/13*t"
        scene["Boundary 5/Traction"] = "0.3/13*t; 0.4/13*t; -1.4/13*t"
        gradient = np.zeros((3, 3))
        gradient[2] = 0.06, 0.08, -0.08
        for ranks in 1, 3:
            with self.subTest(ranks=ranks):
                result = run("corner_tresca_90_3d", scene, ranks)
                self.check_displacement(result, (0, 0, 0.1), gradient)
                pressed = -0.6 / 13 * result["t"]
                for name in "contact_force_x", "contact_force_y":
                    # side x = 1 is held in x, on y = 0, too
                    self.assertClose(result[name], pressed, relative=1e-7, what=name)
                # Each foundation has the force along its own normal.
                for boundary, axis in ((0, 0), (2, 1)):
                    force = result.vector(f"contact_force_{boundary}")
                    expected = np.outer(pressed, np.eye(3)[axis])
                    self.assertClose(force, expected, absolute=1e-9)
                parts = [result.vector(f"friction_force_{i}") for i in (0, 2)]
                self.assertClose(parts[0][:, 2], -0.5 * pressed, absolute=1e-9)
                self.assertClose(
                    sum(parts), result.vector("friction_force"), absolute=1e-12
                )
                self.check_identities(result)
                # 7 on one rank, 8 on several: linear solves are loose in the meantime
                self.assertLessEqual(result["contact_iterations"].max(), 8)
                self.assertEqual(result["bound_iterations"].max(), 0)

    def test_cube_in_an_edge(self):
        """Pressed into an edge between two planes with friction and drawn along
        it: nodes of the edge stick, slip along it, or leave one plane; ranks and
        solvers agree."""
        boundary = {
            0: {"Role": "contact", "Contact law": "unilateral"},
            1: {"Role": "traction", "Traction": "-0.01*min(t, 1); 0; 0"},
            2: {"Role": "contact", "Contact law": "unilateral"},
            3: {"Role": "traction", "Traction": "0; -0.01*min(t, 1); 0"},
            4: {"Role": "free"},
            5: {
                "Role": "displacement",
                "Displacement": "free; free; 0.02*max(t - 1, 0)",
            },
        }
        for friction in 0.3, 1:
            for side in 0, 2:
                boundary[side]["Friction law"] = "coulomb"
                boundary[side]["Friction coefficient"] = friction
            results = [
                run(
                    "edge",
                    {
                        "Dimension": 3,
                        "Geometry/Generator": "subdivided_hyper_rectangle",
                        "Geometry/Arguments": "4, 4, 4 : 0, 0, 0 : 1, 1, 1 : true",
                        "Solver/Contact tolerance": 1e-10,
                        "Time/Phases": "1: 1, 2: 3",
                        **{
                            f"Boundary {i}/{name}": value
                            for i, entries in boundary.items()
                            for name, value in entries.items()
                        },
                    },
                    ranks,
                    text="",
                )
                for ranks in (1, 3)
            ]
            with self.subTest(friction=friction):
                for result in results:
                    self.check_identities(result)
                    self.assertLess(result["contact_iterations"].max(), 15)
                for name in "stored_energy", "friction_force_z", "friction_dissipation":
                    self.assertClose(
                        results[0][name], results[1][name], 1e-5, 1e-9, name
                    )

    def test_edge_of_a_soft_and_a_rigid_plane(self):
        """What sticks along the edge shares the force with the pressures, which is
        a matter of choice; steps and meshes that errors choose are not, nor what
        both planes hold together."""
        scene = {
            "Dimension": 3,
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "2, 2, 2 : 0, 0, 0 : 1, 1, 1 : true",
            **on_boundary(0, Contact_law="unilateral", Friction_coefficient=0.4),
            **on_boundary(1, Role="traction", Pressure="0.01*min(t, 1)"),
            **on_boundary(2, Contact_law="normal compliance", Compliance=20),
            "Boundary 2/Friction coefficient": 0.7,
            **on_boundary(3, Role="traction", Pressure="0.02*min(t, 1)"),
            **with_roles(free=[4], displacement=[5]),
            "Boundary 5/Displacement": "-0.01*min(t, 1); -0.015*min(t, 1);"
            "0.03*max(t - 1, 0)",
            "Time/Phases": "1: 2, 1.25: 1",
            "Step control/Tolerance": 0.15,
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Every n steps": 1,
            "Mesh refinement/Maximal level": 2,
            "Mesh refinement/Cell budget": 150,
            "Solver/Contact tolerance": 1e-10,
        }
        for side in 0, 2:
            scene[f"Boundary {side}/Role"] = "contact"
            scene[f"Boundary {side}/Friction law"] = "coulomb"
        alone, *others = [run("edge", scene, ranks, text="") for ranks in (1, 2)]
        self.assertGreater(alone["cells"][-1], 8 * alone["cells"][0])
        for result in alone, *others:
            self.check_identities(result)
            self.assertLess(result["contact_iterations"].max(), 20)
        for result in others:
            for name in "t", "cells":
                self.assertClose(result[name], alone[name], 1e-9, what=name)
            for name in (
                "stored_energy",
                "friction_dissipation",
                "friction_force_z",
                "contact_force_2_y",
                "reaction_5_x",
            ):
                self.assertClose(result[name], alone[name], 1e-6, what=name)

    PLATE = {
        "Dimension": 3,
        "Geometry/Arguments": "2, 3, 2 : -1, -1, 0 : 0, 1, 1e-4 : true",
        "Material/Young's modulus": 0.3288,
        "Boundary 0/Role": "displacement",
        "Boundary 0/Displacement":
            "0.002925*10^(2*sin(y))*0.5*(1-cos(4*pi*t)); free; "
            "-0.03889*10^(2*sin(x))*(1-exp(-5*t))",
        **on_boundary(5, Role="contact", Contact_law="unilateral"),
        **on_boundary(5, Friction_law="coulomb", Friction_coefficient=0.5),
        **on_boundary(1, Role="contact", Contact_law="unilateral"),
        **on_boundary(1, Friction_law="coulomb", Friction_coefficient=1),
        "Boundary 1/Gap": "if(y < 0.5, 0, 0.001495)",
        "Boundary 1/Foundation motion": "0; -0.01342*sin(2*pi*t); 0",
        **{f"Boundary {id}/Role": "free" for id in (2, 3, 4)},
        "Time/Phases": "0.08333333333333333: 1",
        "Error control/Error bar": "false",
        "Output/Fields every": 0,
    }

    def test_flat_plate_between_foundations(self):
        """A plate ten thousand times as long as thick, whose edge lies on two
        foundations with mu = 1: Newton's method jams, and what solves with
        given bounds find is taken. Rounding leaves 3e-9 of pressures, which no
        tolerance changes."""
        law = run("plate", self.PLATE, text="")
        self.check_identities(law, tolerance=1e-7)
        tight = {"Solver/Coulomb pressure": "fixed point", "Solver/Coulomb tolerance": 1e-10}
        bounds = run("plate", {**self.PLATE, **tight}, text="")
        for name in "strain_energy", "contact_force_x", "contact_force_z":
            self.assertClose(law[name][-1], bounds[name][-1], relative=1e-5, what=name)
        self.assertGreater(law["contact_force_x"][-1] ** 2, 0)

    def test_plates_as_flat_as_they_may_be(self):
        """A million times as long as thick: iterations on the face drown in
        rounding, factors take their place, and forces are as much smaller as
        the plate is thinner. (Without factors a step takes minutes or fails.)"""
        forces = []
        for thickness in 1e-5, 1e-6:
            plate = run(
                "plate",
                {
                    **self.PLATE,
                    "Geometry/Arguments": f"2, 3, 2 : -1, -1, 0 : 0, 1, {thickness}"
                    " : true",
                    "Geometry/Global refinements": 1,
                    "Solver/Coulomb pressure": "lagged",
                },
                text="",
            )
            self.assertLess(plate["contact_iterations"].max(), 100)
            forces.append(plate["contact_force_x"][-1] / thickness)
        self.assertClose(forces[1], forces[0], relative=1e-3)


if __name__ == "__main__":
    main()
