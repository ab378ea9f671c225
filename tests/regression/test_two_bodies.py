# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact between two bodies that deform: exact states, and the limits in which
they are one."""

import tempfile
from pathlib import Path

import numpy as np

from harness import COUPLED, TestCase, main, run, scene_file
from runs import Job, on_boundary, with_roles

SOLVERS = ("direct", "multigrid", "algebraic multigrid")
TIGHT = {"Solver/Contact tolerance": 1e-12}


class Blocks(TestCase):
    """two_blocks_2d and _3d: a constant pressure passes the interface as it is."""

    def check(self, dim, ranks=1, is_round=False, **more):
        more = {path.replace("_", " "): value for path, value in more.items()}
        result = run(f"two_blocks_{dim}d", {**TIGHT, **more}, ranks=ranks)
        self.check_identities(result, 1e-12)
        p, close = 0.01, {"absolute": 1e-12}
        down = "xyz"[dim - 1]
        moduli = [(1, 0.3), (2, 0.2)]
        area = 1
        if is_round:
            area = np.pi
        elif dim == 2:
            moduli = [(E / (1 - nu**2), nu / (1 - nu)) for E, nu in moduli]
        self.assertClose(
            result[f"point0_{down}"][-1], -sum(p / E for E, nu in moduli), **close
        )
        E, nu = moduli[1]
        self.assertClose(result["point0_x"][-1], nu * p / E, **close)
        self.assertClose(result["max_pressure"][-1], p, **close)
        self.assertClose(result[f"contact_force_{down}"][-1], p * area, **close)
        self.assertLess(result["estimate_space"][-1], 1e-12)
        # its second point is on the interface
        warned = "Warning: 'Output/Points': point 1 lies in both bodies"
        self.assertEqual(warned in result.stdout, dim == 2)
        return result

    def test_plane(self):
        for solver in SOLVERS:
            self.check(2, **{"Solver/Linear solver": solver})
        for law in ("bilateral", "normal compliance"):
            with self.subTest(law):
                result = run(
                    "two_blocks_2d",
                    {
                        **TIGHT,
                        "Boundary 3/Contact law": law,
                        "Boundary 3/Compliance": "0 " if law == "bilateral" else 0.5,
                    },
                )
                # the compliance gives way by p/c
                more = 0 if law == "bilateral" else 0.02
                self.assertClose(result["point0_y"][-1], -0.0139 - more, absolute=1e-12)

    def test_hanging_nodes(self):
        """On either side, and on ranks that do not have both."""
        for dim, sides in ((2, "0: 1, 22: 2"), (3, "0: 1"), (3, "22: 1, 2: 1")):
            for ranks, solver in ((1, "direct"), (2, "multigrid"), (3, "multigrid")):
                if dim == 3 and ranks == 2:
                    continue
                with self.subTest(dim=dim, sides=sides, ranks=ranks):
                    self.check(
                        dim,
                        ranks,
                        **{
                            "Geometry/Boundary refinements": sides,
                            "Solver/Linear solver": solver,
                        },
                    )

    def test_bodies_of_revolution(self):
        for sides, ranks, solver in (
            ("", 1, "direct"),
            ("0: 1, 22: 2", 2, "multigrid"),
            ("23: 1, 3: 1", 3, "algebraic multigrid"),
        ):
            self.check(
                2,
                ranks,
                is_round=True,
                **{
                    "Geometry/Plane model": "axisymmetric",
                    "Geometry/Boundary refinements": sides,
                    "Solver/Linear solver": solver,
                },
            )

    def test_three_bodies_on_a_foundation(self):
        """Two pairs, one with the points on the lower side, the other on the upper."""
        nu = 0.25
        third = {
            "Geometry/Generator": " | ".join(["subdivided_hyper_rectangle"] * 3),
            "Geometry/Arguments": "7, 6 : 0, 0 : 1, 1 : true | "
            "5, 4 : 0, 1 : 1, 2 : true | 6, 3 : 0, 2 : 1, 3 : true",
            "Material 2/Young's modulus": 4,
            "Material 2/Poisson's ratio": nu,
            **on_boundary(2, Role="contact", Contact_law="unilateral"),
            "Boundary 2/Friction law": "none",
            **on_boundary(23, Role="free", Pressure=""),
            **with_roles(symmetry=[40], free=[41]),
            **on_boundary(42, Role="contact", Against=23, Contact_law="unilateral"),
            "Boundary 42/Friction law": "none",
            **on_boundary(43, Role="traction", Pressure="0.01*t"),
            "Output/Points": "1, 3",
        }
        for ranks in 1, 3:
            result = run("two_blocks_2d", {**TIGHT, **third}, ranks=ranks)
            down = 0.0139 + 0.01 * (1 - nu**2) / 4
            self.assertClose(result["point0_y"][-1], -down, absolute=1e-12)
            self.assertClose(result["max_pressure"][-1], 0.01, absolute=1e-12)

    def test_mesh_file(self):
        """Bodies in one file, which share no nodes."""
        nodes, elements = [], []
        for body, (n, m, bottom) in enumerate(((7, 6, 0), (5, 4, 1))):
            first = len(nodes) + 1
            nodes += [(i / n, bottom + j / m) for j in range(m + 1) for i in range(n + 1)]

            def at(i, j, first=first, n=n):
                return first + i + j * (n + 1)

            sides = (
                [(at(0, j), at(0, j + 1)) for j in range(m)],
                [(at(n, j), at(n, j + 1)) for j in range(m)],
                [(at(i, 0), at(i + 1, 0)) for i in range(n)],
                [(at(i, m), at(i + 1, m)) for i in range(n)],
            )
            for side, lines in enumerate(sides):
                elements += [(1, 20 * body + side, line) for line in lines]
            elements += [
                (3, body, (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)))
                for j in range(m)
                for i in range(n)
            ]
        lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", len(nodes)]
        lines += [f"{k} {x!r} {y!r} 0" for k, (x, y) in enumerate(nodes, 1)]
        lines += ["$EndNodes", "$Elements", len(elements)]
        lines += [
            f"{k} {kind} 2 {tag} {tag} {' '.join(map(str, corners))}"
            for k, (kind, tag, corners) in enumerate(elements, 1)
        ]
        lines.append("$EndElements")
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "bodies.msh"
            file.write_text("\n".join(map(str, lines)) + "\n")
            self.check(
                2,
                **{
                    "Geometry/File": file,
                    "Geometry/Generator": "",
                    "Geometry/Arguments": "",
                },
            )

    def test_what_holds_a_node_beside_contact_stays(self):
        """The side x = 0 is held below the interface and comes out above it."""
        for dim in 2, 3:
            middle = "0.5, " * (dim - 2)
            result = run(
                f"two_blocks_{dim}d",
                {
                    **TIGHT,
                    "Geometry/Boundary refinements": "0: 1",
                    **with_roles(free=[20], symmetry=[21]),
                    "Output/Points": f"0, {middle}0.99; 0, {middle}1.01",
                },
            )
            self.assertLess(abs(result["point0_x"][-1]), 1e-15)
            self.assertLess(result["point1_x"][-1], -5e-4)
            self.assertClose(
                result[f"contact_force_{'xyz'[dim - 1]}"][-1], 0.01, absolute=1e-11
            )

    def test_turned(self):
        for dim, ranks in ((2, 1), (3, 3)):
            result = run(
                f"two_blocks_{dim}d",
                {
                    **TIGHT,
                    "Geometry/Rotation angle": 30,
                    "Geometry/Boundary refinements": "0: 1",
                    "Output/Points": "",
                },
                ranks=ranks,
            )
            self.assertClose(result["max_pressure"][-1], 0.01, absolute=1e-12)
            straight = 0.0139 if dim == 2 else 0.015
            self.assertGreater(result["max_displacement"][-1], straight)
            self.assertLess(result["estimate_space"][-1], 1e-12)

    def test_turned_by_a_right_angle(self):
        """What the supports prescribe beside bilateral contact is not coupled,
        whatever direction that has."""
        result = run(
            "two_blocks_2d",
            {
                **TIGHT,
                "Geometry/Rotation angle": 90,
                "Boundary 3/Contact law": "bilateral",
                "Output/Points": "-2, 1; -1, 0.5",
            },
        )
        self.assertClose(result["point0_x"][-1], 0.0139, absolute=1e-12)

    def test_distorted_faces(self):
        """Quadrilaterals whose sides are not parallel: linear functions pass exactly,
        pressures to the error of quadrature."""
        result = run(
            "two_blocks_3d",
            {
                **TIGHT,
                "Geometry/Coordinates": "x + 0.4*x*(1 - x)*y; y + 0.4*y*(1 - y)*x; z",
            },
        )
        self.assertNotIn("has nothing opposite", result.stdout)
        self.assertClose(result["contact_force_z"][-1], 0.01, absolute=1e-11)
        # measured: 2e-5
        self.assertClose(result["max_pressure"][-1], 0.01, 1e-3)
        self.assertClose(result["point0_z"][-1], -0.015, 1e-3)


GLUED = {**on_boundary(3, Contact_law="bilateral", Friction_law="glued")}
SIDE_BY_SIDE = "6, 4 : 0, 0 : 1, 1 : true | 6, 4 : 0, 1 : 1, 2 : true"


class Limits(TestCase):
    """What two bodies have in common with one."""

    def pair_and_one(self, cells, height, load, **more):
        """Two glued blocks of these cells and this height each, and one of both."""
        n, m = cells
        common = {**TIGHT, **with_roles(free=[0], clamped=[2]), **more}
        two = run(
            "two_blocks_2d",
            {
                **common,
                **GLUED,
                "Geometry/Arguments": f"{n}, {m} : 0, 0 : 1, {height} : true | "
                f"{n}, {m} : 0, {height} : 1, {2 * height} : true",
                "Boundary 20/Role": common["Boundary 0/Role"],
                **{f"Boundary 23/{name}": value for name, value in load.items()},
            },
        )
        one = run(
            "one_block",
            {
                "Geometry/Material ids": f"if(y < {height}, 0, 1)",
                **common,
                "Geometry/Generator": "subdivided_hyper_rectangle",
                "Geometry/Arguments": f"{n}, {2 * m} : 0, 0 : 1, {2 * height} : true",
                **on_boundary(3, Role="traction", Contact_law="not given", Against=""),
                **{f"Boundary 3/{name}": value for name, value in load.items()},
            },
            text="\n\n".join(self.parts_of_one_body()),
        )
        return two, one

    def test_glued_bodies_are_one(self):
        """On meshes that match, to rounding, also in flow."""
        two, one = self.pair_and_one(
            (6, 4),
            1,
            {"Pressure": "0.01*t*(1 + x)", "Traction": "0.01*t; 0"},
            **{
                "Material 0/Law": "maxwell",
                "Material 0/maxwell/Viscosity": 2,
                "Time/Phases": "2: 4",
            },
        )
        for column in ("point0_x", "point0_y", "point1_x", "strain_energy"):
            scale = abs(one[column]).max()
            self.assertClose(two[column], one[column], absolute=1e-10 * scale)
        self.assertGreater(abs(one["point0_x"]).max(), 0.05)

    def test_iterations(self):
        """Of glued bodies as many as of one."""
        for solver in SOLVERS[1:]:
            common = {
                "Solver/Linear solver": solver,
                "Geometry/Global refinements": 2,
                "Time/Phases": "1: 1",
            }
            results = self.pair_and_one((8, 8), 1, {"Pressure": "0.01*t*x"}, **common)
            two, one = (result["linear_iterations"][-1] for result in results)
            self.assertLessEqual(abs(two - one), 3)

    def test_stages_beside_contact(self):
        """What comes and goes away from the interface does so as in one body."""
        for stage in "Removed at", "Added at":
            two, one = self.pair_and_one(
                (6, 4),
                1,
                {"Pressure": 0, "Traction": "0.002*t; 0"},
                **{
                    "Geometry/Material ids": "if(y < 1, 0, if(y < 1.5, 1, 2))",
                    "Material/Stress history": "quadrature points",
                    "Material 2/Young's modulus": 3,
                    "Material 2/Poisson's ratio": 0.25,
                    "Material 2/Law": "maxwell",
                    "Material 2/maxwell/Viscosity": 2,
                    f"Material 2/{stage}": 1,
                    "Loads/Body force": "0; -0.01",
                    "Initial state/Equilibrate": "true",
                    "Time/Phases": "1: 2, 2: 2",
                    "Output/Points": "0.5, 1.5; 0.5, 0.75",
                },
            )
            columns = "point0_x", "point0_y", "point1_y", "strain_energy"
            for column in (*columns, "construction_energy", "load_y"):
                scale = abs(one[column]).max()
                self.assertClose(two[column], one[column], absolute=1e-9 * scale)
            self.assertGreater(abs(one["construction_energy"][-1]), 0)
        for ranks in 1, 2:
            result = run(
                "two_blocks_2d",
                {
                    **TIGHT,
                    "Geometry/Material ids": "if(y < 1, 0, if(y < 1.5, 1, 2))",
                    "Geometry/Boundary refinements": "0: 1",
                    "Material 2/Young's modulus": 3,
                    "Material 2/Poisson's ratio": 0.25,
                    "Material 2/Removed at": 1,
                    "Loads/Body force": "0; -0.01",
                    "Boundary 23/Pressure": 0,
                    "Initial state/Equilibrate": "true",
                    "Time/Phases": "1: 1, 2: 1",
                    "Output/Points": "",
                },
                ranks=ranks,
            )
            self.assertClose(
                result["contact_force_y"], [0.01, 0.01, 0.005], absolute=1e-8
            )

    def test_glue_in_the_error_bar(self):
        """Layers of one cell, whose tractions meet at the glue alone: it counts like
        any face between two cells, also for a force."""
        two, one = self.pair_and_one(
            (8, 1),
            0.125,
            {"Pressure": 0, "Traction": "0.01*t*sin(pi*x); 0"},
            **{
                "Output/Points": "0.3, 0.25",
                "Boundary 0/Role": "symmetry",
                "Error control/Error bar": "true",
                "Error control/Quantity": "reaction_2_x",
            },
        )
        for column in ("estimate_space", "quantity_total"):
            self.assertClose(two[column][-1], one[column][-1], relative=0.05)

    def test_what_holds_bodies_is_the_pressure_of_contact(self):
        """Where nothing opens, the error bar of bilateral contact, whose pressure is
        a reaction, is that of unilateral contact, where it is a multiplier; that of a
        point, too. With hanging nodes, on ranks."""
        for dim, contact, top, column, ranks in (
            (2, 3, 23, "point0_y", 1), (3, 5, 25, "point0_z", 3)
        ):
            bilateral, unilateral = (
                run(
                    f"two_blocks_{dim}d",
                    {
                        **TIGHT,
                        f"Boundary {contact}/Contact law": law,
                        f"Boundary {top}/Pressure": "0.01*t*(1 + x)",
                        "Geometry/Boundary refinements": "0: 1",
                        "Error control/Error bar": "true",
                        "Error control/Quantity": column,
                    },
                    ranks=ranks,
                )
                for law in ("bilateral", "unilateral")
            )
            for name in ("estimate_space", "quantity_total"):
                self.assertClose(bilateral[name][-1], unilateral[name][-1], 1e-6)

    @staticmethod
    def parts_of_one_body():
        """The sections of the scene without those of the upper block."""
        return [
            part
            for part in scene_file("two_blocks_2d").read_text().split("\n\n")
            if not part.startswith(("# the upper", "subsection Boundary 2"))
            or part.startswith("subsection Boundary 2\n")
        ]

    def test_equal_bodies_meet_like_one_on_a_rigid_plane(self):
        """By symmetry, with friction that has nothing to do; contact opens."""
        equal = {
            **TIGHT,
            **on_boundary(3, Friction_law="coulomb", Friction_coefficient=0.5),
            "Material 1/Young's modulus": 1,
            "Material 1/Poisson's ratio": 0.3,
        }
        way = "0.02*t*(1 - 2*x)"
        two = run(
            "two_blocks_2d",
            {
                **equal,
                "Geometry/Arguments": SIDE_BY_SIDE,
                **on_boundary(2, Role="displacement", Displacement=f"free; {way}"),
                **on_boundary(23, Role="displacement", Displacement=f"free; -{way}"),
            },
        )
        one = run(
            "one_block",
            {
                **equal,
                "Boundary 3/Friction law": "none",
                "Geometry/Generator": "subdivided_hyper_rectangle",
                "Geometry/Arguments": "6, 4 : 0, 0 : 1, 1 : true",
                "Geometry/Material ids": "0",
                **on_boundary(2, Role="displacement", Displacement=f"free; {way}"),
                "Boundary 3/Against": "",
                "Output/Points": "0.5, 1; 0.5, 1",
            },
            text="\n\n".join(
                part
                for part in self.parts_of_one_body()
                if not part.startswith("subsection Material 1")
            ),
        )
        scale = one["contact_force_y"][-1]
        self.assertClose(
            two["contact_force_y"], one["contact_force_y"], 0, 1e-9 * scale
        )
        self.assertClose(two["contact_area"], one["contact_area"], absolute=1e-12)
        self.assertLess(one["contact_area"][-1], 0.9)
        self.assertClose(two["max_pressure"], one["max_pressure"], 1e-8)
        self.assertClose(two["friction_dissipation"], 0, absolute=1e-10 * scale)
        self.assertClose(two["strain_energy"], 2 * one["strain_energy"], 1e-9)

    def test_layers_flow_in_series(self):
        """Displacements add up, those of layers by themselves being known."""
        flow = {
            **TIGHT,
            "Boundary 23/Pressure": 0.01,
            "Initial state/Equilibrate": "true",
            "Time/Phases": "3: 6",
        }
        for n, viscosity in ((0, 1), (1, 4)):
            flow[f"Material {n}/Law"] = "maxwell"
            flow[f"Material {n}/maxwell/Viscosity"] = viscosity
        both = run("two_blocks_2d", flow)
        # the lower block beside one that is rigid
        lower = both["point1_y"]
        self.assertClose(both["max_pressure"], 0.01, absolute=1e-12)
        single = run(
            "two_blocks_2d",
            {**flow, "Material 1/Law": "elastic", "Material 1/Young's modulus": 1e6},
        )
        self.assertClose(single["point0_y"], lower, absolute=1e-7)
        self.assertGreater(-lower[-1], 1.5 * -lower[0])

    def test_rigid_motions_meet_no_resistance(self):
        """A body that is glued to one that turns follows without stress."""
        for dim, ranks in ((2, 1), (3, 3)):
            base, law = (2, 3) if dim == 2 else (4, 5)
            turn = "0.01*t*(y - 0.3); -0.01*t*x"
            changes = {
                **on_boundary(law, Contact_law="bilateral", Friction_law="glued"),
                f"Boundary {base}/Role": "displacement",
                f"Boundary {base}/Displacement": turn
                + (" + 0.02*t*z; -0.02*t*y" if dim == 3 else ""),
                "Geometry/Boundary refinements": "0: 1",
            }
            for side in (0, 2, 20, 22):
                if side != base and (dim == 3 or side != 22):
                    changes[f"Boundary {side}/Role"] = "free"
            top = 23 if dim == 2 else 25
            changes[f"Boundary {top}/Role"] = "free"
            result = run(f"two_blocks_{dim}d", {**TIGHT, **changes}, ranks=ranks)
            self.assertGreater(result["max_displacement"][-1], 0.01)
            # of strains to the tolerance of the solve
            self.assertLess(result["strain_energy"][-1], 1e-17)


class Stages(TestCase):
    """Faces in contact that come or go."""

    def stages(self, dim, ranks, **more):
        """The upper block, which has the contact, comes or goes at t = 1."""
        lower, upper, top = (3, 22, 23) if dim == 2 else (5, 24, 25)
        side = "0.5, " * (dim - 1)
        contact = {"Role": "contact", "Against": lower, "Contact law": "unilateral",
                   "Friction law": "coulomb", "Friction coefficient": 0.3}  # fmt: skip
        return run(
            f"two_blocks_{dim}d",
            {
                **TIGHT,
                **on_boundary(lower, Role="free", Against=""),
                **{f"Boundary {upper}/{k}": v for k, v in contact.items()},
                f"Boundary {top}/Pressure": 0,
                "Loads/Body force": "0; " * (dim - 1) + "-0.01",
                "Initial state/Equilibrate": "true",
                "Time/Phases": "1: 1, 2: 2",
                "Output/Points": f"{side}1e-9; {side}0.5",
                **more,
            },
            ranks=ranks,
        )

    def test_stages_of_contact(self):
        """A body that comes rests on the other one with its weight from then on, and
        takes it along when it goes; with hanging nodes, on ranks."""
        for dim, ranks, solver in (
            (2, 1, "direct"), (2, 2, "multigrid"), (3, 3, "algebraic multigrid")
        ):
            down = "xyz"[dim - 1]
            common = {
                "Solver/Linear solver": solver,
                "Geometry/Boundary refinements": "22: 1" if dim == 2 else "24: 1",
            }
            # nobody is there before, nor after
            always = self.stages(dim, ranks, **common)
            weight = always[f"contact_force_{down}"][-1]
            self.assertClose(weight, -0.01, absolute=1e-10)
            comes, goes = (
                self.stages(dim, ranks, **{**common, f"Material 1/{when}": 1})
                for when in ("Added at", "Removed at")
            )
            for result, is_there in ((comes, (0, 0, 1, 1)), (goes, (1, 1, 0, 0))):
                there = np.array(is_there)
                self.assertClose(
                    result[f"contact_force_{down}"], weight * there, absolute=1e-10
                )
                self.assertClose(result["contact_area"], there, absolute=1e-12)
                # what is added once floated in that instant: 0.05
                self.check_identities(result, 1e-8)
            # the lower block knows no more than the force, and a little of friction
            alone, loaded = (comes[f"point1_{down}"][0], always[f"point1_{down}"][-1])
            self.assertClose(goes[f"point1_{down}"][-1], alone, absolute=1e-7)
            self.assertClose(comes[f"point1_{down}"][-1], loaded, relative=0.02)
            self.assertGreater(abs(loaded / alone), 1.5)

    def test_stages_of_a_part(self):
        """The left half of the upper block, or what it rests on there."""
        for ids, forces, area in (
            ("if(y < 1, 0, if(x < 0.5, 2, 1))", (-0.01, -0.005), 1 / 2),
            # with the node between them, which belongs to neither
            ("if(y < 1, if(x < 0.5 && y > 0.8, 2, 0), 1)", (-0.01, -0.01), 7 / 16),
        ):
            part = {
                "Geometry/Arguments": "10, 10 : 0, 0 : 1, 1 : true | "
                "8, 8 : 0, 1 : 1, 2 : true",
                "Geometry/Material ids": ids,
                "Material 2/Young's modulus": 2,
                "Material 2/Poisson's ratio": 0.2,
            }
            for when, order, ranks in (("Removed at", 1, 1), ("Added at", -1, 3)):
                result = self.stages(2, ranks, **part, **{f"Material 2/{when}": 1})
                # an absent cell weighs on the others with its stiffness
                self.assertClose(
                    result["contact_force_y"][1:3], forces[::order], absolute=1e-7
                )
                self.assertClose(
                    result["contact_area"][1:3], (1, area)[::order], absolute=1e-12
                )
                self.check_identities(result, 1e-7)

    def test_stages_of_contact_on_changing_meshes(self):
        """Cells and forces are the same on ranks, and nothing is said of a face whose
        body has not come."""
        results = [
            self.stages(
                2,
                ranks,
                **{
                    "Material 1/Added at": 1,
                    "Boundary 23/Pressure": "0.01*max(t - 1, 0)*(1 + x)",
                    "Mesh refinement/Strategy": "residual",
                    "Mesh refinement/Every n steps": 1,
                    "Mesh refinement/Cell budget": 400,
                },
            )
            for ranks in (1, 3)
        ]
        self.assertNotIn("nothing slips or opens", results[0].stdout)
        self.assertGreater(len(set(results[0]["cells"])), 2)
        self.assertClose(results[1]["cells"], results[0]["cells"])
        for result in results:
            # the weight, and a mean pressure of 0.015
            self.assertClose(result["contact_force_y"][-1], -0.025, absolute=1e-8)


class Slip(TestCase):
    """A block that is pressed on a larger one and pushed along it."""

    @staticmethod
    def slide(secondary=22, ranks=1, **more):
        primary = 25 - secondary
        more = {path.replace("_", " "): value for path, value in more.items()}
        return run(
            "two_blocks_2d",
            {
                "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true | "
                "5, 4 : 0.5, 1 : 1.5, 2 : true",
                **with_roles(free=[0], clamped=[2]),
                **on_boundary(primary, Role="free", Against=""),
                **on_boundary(secondary, Role="contact", Against=primary),
                f"Boundary {secondary}/Contact law": "unilateral",
                f"Boundary {secondary}/Friction law": "coulomb",
                f"Boundary {secondary}/Friction coefficient": 0.3,
                **with_roles(free=[20], displacement=[23]),
                "Boundary 23/Displacement": "0.01*max(t - 1, 0); -0.01*min(t, 1)",
                "Time/Phases": "1: 2, 2: 5",
                "Solver/Contact tolerance": 1e-9,
                **more,
            },
            ranks=ranks,
        )

    def test_on_changing_meshes_and_ranks(self):
        adaptive = {
            "Geometry/Global refinements": 1,
            "Geometry/Boundary refinements": "22: 1",
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Every n steps": 2,
            "Material 0/Law": "maxwell",
            "Material 0/maxwell/Viscosity": 5,
        }
        results = [self.slide(ranks=ranks, **adaptive) for ranks in (1, 3)]
        for result in results:
            self.check_identities(result, 1e-9)
            self.assertGreater(result["slip_area"][-1], 0)
            self.assertClose(result["cells"], results[0]["cells"])
            for column in "contact_force_y", "friction_force_x", "stored_energy":
                expected = results[0][column]
                self.assertClose(
                    result[column], expected, absolute=1e-7 * abs(expected).max()
                )
        self.assertGreater(len(set(results[0]["cells"])), 1)

    def test_either_side_may_have_the_points(self):
        """What that changes falls with the mesh."""
        changes = []
        for n in range(3):
            # the lower block may have nodes with nothing opposite
            results = [
                self.slide(side, **{"Geometry/Global refinements": n})
                for side in (22, 3)
            ]
            self.assertNotIn("has nothing opposite", results[0].stdout)
            self.assertIn("of boundary 3 has nothing opposite", results[1].stdout)
            forces = [result.vector("contact_force")[-1][1] for result in results]
            changes.append(abs(sum(forces)))
        # measured: 2.1e-3, 8.8e-4, 3.6e-4
        self.assertLess(changes[2], 0.6 * changes[1])

    def test_a_slide_by_more_than_a_face(self):
        """Is told: what lies opposite stays what it was at first."""
        far = {"Boundary 23/Displacement": "0.4*max(t - 1, 0); -0.01*min(t, 1)"}
        self.assertRegex(
            self.slide(**far).stdout,
            # by nearly 0.4, beside faces of 0.2
            r"Note: at t = 2 two bodies have slid along each other by 1\.9 times the",
        )

    def test_fields_on_the_other_side(self):
        """A constant pressure is that on either side; vectors are the reverse."""
        for ranks in 1, 2:
            faces = [
                run(
                    "two_blocks_3d", {**TIGHT, "Output/Fields every": 1}, ranks=ranks
                ).fields(series)
                for series in ("contact", "opposite")
            ]
            self.assertNotEqual(*(len(face.points) for face in faces))
            for face in faces:
                pressure = face.point_data["contact_pressure"]
                self.assertClose(pressure, 0.01, absolute=1e-8)
        moved = self.slide(
            **{
                "Output/Fields every": 1,
                "Boundary 22/Friction coefficient": 0.01,
                "Boundary 23/Displacement": "0.1*max(t - 1, 0); -0.01*min(t, 1)",
            }
        )
        here, there = (moved.fields(series) for series in ("contact", "opposite"))
        x = there.points[:, 0]
        inside, outside = (x > 0.9) & (x < 1.1), (x < 0.2) | (x > 1.8)
        slip = here.point_data["slip"][:, 0].mean()
        self.assertGreater(slip, 0.09)
        self.assertClose(there.point_data["slip"][inside, 0], -slip, 0.05)
        for field in "slip", "contact_pressure", "stick":
            self.assertEqual(abs(there.point_data[field][outside]).max(), 0)

    def test_estimates_of_quantities_between_the_bodies(self):
        """Their duals are of the jump: the errors against a finer mesh, and the same
        on ranks."""
        finest = self.slide(**{"Geometry/Global refinements": 4})
        # measured: 1.2 and 1.4, 1.7 and 1.9, 1.05 and 0.8
        for name, least, ranks in (
            ("contact_force_y", 1, (1, 1)),
            ("friction_force_x", 1, (1, 2)),
            ("friction_dissipation", 0.7, (3, 1)),
        ):
            for n in 1, 2:
                result = self.slide(
                    ranks=ranks[n - 1],
                    **{
                        "Geometry/Global refinements": n,
                        "Error control/Error bar": "true",
                        "Error control/Quantity": name,
                    },
                )
                error = abs(result[name][-1] - finest[name][-1])
                estimate = result["quantity_total"][-1]
                self.assertGreater(estimate, least * error)
                self.assertLess(estimate, 2.2 * error)

    def test_hertz(self):
        """Two parabolic bodies that do not match: the width of contact and the
        pressure of two cylinders of radii 2 and 4, by the force."""
        profiles = "x; if(y < 0.25, y - (1 + y)*x^2/4, y - 0.5 + (1.5 - y)*x^2/8)"
        result = run(
            "two_blocks_2d",
            {
                "Geometry/Arguments": "64, 32 : -1, -1 : 1, 0 : true | "
                "48, 24 : -1, 0.5 : 1, 1.5 : true",
                "Geometry/Coordinates": profiles,
                **with_roles(free=[0], clamped=[2]),
                "Boundary 3/Foundation normal": "0, 1",
                "Boundary 20/Role": "free",
                **on_boundary(23, Role="displacement", Displacement="0; -0.02*t"),
                "Output/Points": "",
            },
        )
        force = result["contact_force_y"][-1]
        modulus, radius = 1 / ((1 - 0.3**2) / 1 + (1 - 0.2**2) / 2), 1 / (1 / 2 + 1 / 4)
        pressure = np.sqrt(force * modulus / np.pi / radius)
        width = 2 * np.sqrt(4 * force * radius / np.pi / modulus)
        # measured: 0.4 % more, for bodies that are 7 widths deep
        self.assertClose(result["max_pressure"][-1], pressure, 0.01)
        self.assertClose(result["contact_area"][-1], width, absolute=2 / 64)


# Of two cylinders of the radii 2 and 4, with cells that get smaller towards the middle.
GRADED = "(0.3*x + 0.7*x^3)"
PARABOLAS = (
    f"{GRADED}; if(y < 0.25, y - (1 + y)*{GRADED}^2/4, "
    f"y - 0.5 + (1.5 - y)*{GRADED}^2/8)"
)


class Reference(TestCase):
    def test_multipliers_are_compared_on_their_own_body(self):
        """Against its own fields a run has no error; the other body has the
        multipliers with the other sign."""
        scene = {
            **on_boundary(3, Friction_law="coulomb", Friction_coefficient=0.3),
            "Boundary 20/Role": "free",
            **on_boundary(23, Role="displacement", Displacement="0.003*t; -0.01*t"),
            "Boundary 23/Pressure": 0,
            "Output/Points": "",
        }
        first = run("two_blocks_2d", {**scene, "Output/Reference fields": "true"})
        again = run(
            "two_blocks_2d",
            {**scene, "Exact solution/Reference directory": first.directory},
        )
        self.assertLess(again["error_multiplier"][-1], 1e-15)


class Known(TestCase):
    """Contact of two elastic bodies, as it is known in closed form."""

    def test_cattaneo_and_mindlin(self):
        """Equal cylinders, pressed and then sheared: the half width of what sticks
        is a (1 - Q/mu P)^{1/2}, exact for any Poisson's ratio."""
        friction = 0.3
        result = run(
            "two_blocks_2d",
            {
                "Geometry/Arguments": "64, 32 : -1, -1 : 1, 0 : true | "
                "56, 24 : -1, 0.5 : 1, 1.5 : true",
                "Geometry/Coordinates": PARABOLAS,
                "Material 1/Young's modulus": 1,
                "Material 1/Poisson's ratio": 0.3,
                **with_roles(free=[0], clamped=[2]),
                **on_boundary(3, Foundation_normal="0, 1", Friction_law="coulomb"),
                "Boundary 3/Friction coefficient": friction,
                **with_roles(free=[20], displacement=[23]),
                "Boundary 23/Displacement": "0.004*max(t - 1, 0); -0.01*min(t, 1)",
                "Output/Points": "",
                "Time/Phases": "1: 1, 2: 4",
            },
        )
        self.check_identities(result, COUPLED)
        force, shear = result["contact_force_y"][1:], result["friction_force_x"][1:]
        modulus, radius = 1 / (2 * (1 - 0.3**2)), 1 / (1 / 2 + 1 / 4)
        width = 2 * np.sqrt(4 * force * radius / np.pi / modulus)
        # to the width of a cell in the middle, of 8 there
        cell = 0.3 * 2 / 56
        self.assertClose(result["contact_area"][1:], width, absolute=0.5 * cell)
        sticks = width * np.sqrt(1 - abs(shear) / friction / force)
        self.assertClose(result["stick_area"][1:], sticks, absolute=2 * cell)
        self.assertLess(sticks[-1], 0.5 * width[-1])

    def test_hertz_of_balls(self):
        """Of radii 2 and 4, as bodies of revolution."""
        result = run(
            "two_blocks_2d",
            {
                "Geometry/Plane model": "axisymmetric",
                "Geometry/Arguments": "40, 40 : 0, -1 : 1, 0 : true | "
                "36, 30 : 0, 0.5 : 1, 1.5 : true",
                "Geometry/Coordinates": PARABOLAS,
                "Boundary 2/Role": "clamped",
                "Boundary 3/Foundation normal": "0, 1",
                **on_boundary(23, Role="displacement", Displacement="0; -0.01*t"),
                "Output/Points": "",
            },
        )
        force = result["contact_force_y"][-1]
        modulus = 1 / ((1 - 0.3**2) / 1 + (1 - 0.2**2) / 2)
        width = (3 * force / 4 / modulus / (1 / 2 + 1 / 4)) ** (1 / 3)
        pressure = 3 * force / 2 / np.pi / width**2
        # measured: 0.3 % and 6 %, of which the last ring of nodes has 0.01/a
        self.assertClose(result["max_pressure"][-1], pressure, 0.01)
        self.assertClose(result["contact_area"][-1], np.pi * width**2, 0.1)

    def test_edge_of_an_elastic_punch(self):
        """The pressure of a quarter plane on a half plane of the same material, without
        friction, grows like r^-0.226 towards the edge (Dundurs and Lee, J. Elasticity
        2, 1972)."""
        finer = "1 - (1 - x)^3", "1 + (x - 1)^3"
        result = run(
            "two_blocks_2d",
            {
                "Geometry/Arguments": "160, 80 : 0, -1 : 2, 0 : true | "
                "100, 100 : 0, 0 : 1, 1 : true",
                "Geometry/Coordinates": f"if(x < 1, {finer[0]}, {finer[1]}); y^3",
                "Material 1/Young's modulus": 1,
                "Material 1/Poisson's ratio": 0.3,
                "Boundary 2/Role": "clamped",
                **on_boundary(3, Role="free", Against="", Contact_law="not given"),
                "Boundary 3/Friction law": "not given",
                **on_boundary(22, Role="contact", Against=3, Contact_law="unilateral"),
                "Boundary 22/Friction law": "none",
                **on_boundary(23, Role="displacement", Displacement="free; -0.01*t"),
                "Output/Points": "",
                "Output/Fields every": 1,
            },
        )
        face = result.fields("contact")
        distance = 1 - face.points[:, 0]
        pressure = face.point_data["contact_pressure"]
        # away from the edge the body's size counts, -0.212 ten times farther
        of = (distance > 3e-4) & (distance < 3e-3)
        slope = np.polyfit(np.log(distance[of]), np.log(pressure[of]), 1)[0]
        self.assertClose(slope, -0.226, absolute=0.006)

    def test_rates_of_glued_meshes_that_do_not_match(self):
        """Errors of the energy halve with the mesh, 3 to 4 and 2 to 1, and the error
        bar is right about them: against a mesh that is 4 and 8 times finer."""
        load = {
            **GLUED,
            **with_roles(symmetry=[1, 21], clamped=[2]),
            "Boundary 23/Pressure": "0.01*t*(1 + cos(pi*x))",
            "Error control/Error bar": "true",
        }
        for n, m in (4, 3), (4, 8):
            load[
                "Geometry/Arguments"
            ] = f"{n}, {n} : 0, 0 : 1, 1 : true | {m}, {m} : 0, 1 : 1, 2 : true"
            finest = run(
                "two_blocks_2d",
                {
                    **load,
                    "Geometry/Global refinements": 3,
                    "Output/Reference fields": "true",
                },
            )
            errors = []
            for level in range(2):
                result = run(
                    "two_blocks_2d",
                    {
                        **load,
                        "Geometry/Global refinements": level,
                        "Exact solution/Reference directory": finest.directory,
                    },
                )
                errors.append(result["error_energy"][-1])
                effectivity = result["estimate_space"][-1] / errors[-1]
                # measured: 1.09 to 1.17, of which the reference has 0.03
                self.assertGreater(effectivity, 1)
                self.assertLess(effectivity, 1.25)
            self.assertGreater(np.log2(errors[0] / errors[1]), 0.9)


class Refused(TestCase):
    refused_scene = ("two_blocks_2d", {}, None)

    def test_overlap(self):
        """Doubted by --check."""
        for gap, is_told in ((-0.3, True), (-0.01, False)):
            overlap = {"Boundary 3/Gap": gap, "Initial state/Equilibrate": "true"}
            with Job("two_blocks_2d", overlap) as job:
                words = " ".join(job.run("--check").stdout.split())
            sentence = "foundations in contact overlap by 0.3, 13 % of the size"
            (self.assertIn if is_told else self.assertNotIn)(sentence, words)

    def test_sentences(self):
        for changes, sentence in (
            ({"Boundary 3/Against": "seabed"}, "is no boundary of the scene"),
            ({"Boundary 3/Against": 23}, "Nothing of boundary 23 lies opposite"),
            ({"Boundary 22/Role": "symmetry"}, "must have the role free"),
            ({"Boundary 3/Against": 1}, "has nodes in common with boundary 1"),
            (
                {
                    **on_boundary(3, Friction_law="tresca", Friction_bound=1),
                    "Boundary 3/Foundation motion": "t; 0",
                },
                "another body is there",
            ),
            ({"Boundary 3/Role": "free"}, "are not connected"),
            (
                {"Material 1/Removed at": 0.5, "Time/Phases": "0.5: 1, 1: 1"},
                "the whole of a body that another one is 'Against'",
            ),
            ({"Boundary 20/Role": "free"}, "of one of the 2 bodies"),
        ):
            with self.subTest(sentence):
                self.refused(changes, sentence)


if __name__ == "__main__":
    main()
