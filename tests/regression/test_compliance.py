# SPDX-License-Identifier: LGPL-2.1-or-later
"""A foundation that gives way: p = c (u_n - g)_+^m.

Against closed forms; an independent solver has it in test_unilateral.py.
"""

import numpy as np

from harness import TestCase, lattice, main, run
from runs import elastic_moduli, of_law, on_boundary, with_roles

# The stress of confined compression by 1 for E = 1 and nu = 0.3.
CONFINED = (1 - 0.3) / ((1 + 0.3) * (1 - 2 * 0.3))
ADAPTIVE = {"Mesh refinement/Strategy": "residual", "Mesh refinement/Maximal level": 3}
DEPTH = 0.05  # by which the bar is pressed, less the gap


def bar(dim, compliance, exponent, **more):
    """A bar between walls, pressed onto ground of which a half has hanging nodes,
    with an own boundary id of the same law."""
    bottom, top = 2 * dim - 2, 2 * dim - 1
    half = 2 * dim
    entries = {
        "Dimension": dim,
        "Geometry/Generator": "subdivided_hyper_rectangle",
        "Geometry/Arguments": {
            2: "4, 2 : 0, 0 : 2, 1 : true",
            3: "2, 2, 2 : 0, 0, 0 : 2, 1, 1 : true",
        }[dim],
        "Geometry/Boundary ids": f"if(id == {bottom} && x > 1, {half}, id)",
        "Geometry/Boundary refinements": f"{half}: 1",
        **elastic_moduli(1, 0.3),
        "Material/Law": "elastic",
        f"Boundary {top}/Role": "displacement",
        f"Boundary {top}/Displacement": "0; " * (dim - 1) + "-0.06*t",
        "Time/Phases": "1: 4",
        "Solver/Contact tolerance": 1e-11,
    }
    for side in range(bottom):
        entries[f"Boundary {side}/Role"] = "symmetry"
    for piece in bottom, half:
        entries[f"Boundary {piece}/Role"] = "contact"
        entries[f"Boundary {piece}/Contact law"] = "normal compliance"
        entries[f"Boundary {piece}/Compliance"] = compliance
        entries[f"Boundary {piece}/Compliance exponent"] = exponent
        entries[f"Boundary {piece}/Gap"] = "0.02 - 0.01*t"
        entries[f"Boundary {piece}/Friction law"] = "none"
    return {**entries, **more}


def penetration(compliance, exponent):
    """w of c w^m = M (depth - w), by bisection."""
    low, high = 0.0, DEPTH
    for _ in range(100):
        w = 0.5 * (low + high)
        force = CONFINED * (DEPTH - w)
        low, high = (w, high) if compliance * w**exponent < force else (low, w)
    return w


class ByHand(TestCase):
    def test_bar(self):
        """From ground as soft as the bar to some that might as well be rigid."""
        for dim, compliance, exponent, ranks, solver in (
            (2, 2, 1, 1, "direct"),
            (2, 300, 2, 1, "direct"),
            (2, 20, 1.5, 2, "multigrid"),
            (2, 1e6, 1, 1, "multigrid"),
            (2, 1e12, 1, 1, "direct"),
            (3, 1e10, 3, 1, "direct"),
            (3, 20, 1.5, 3, "multigrid"),
        ):
            with self.subTest(dim=dim, compliance=compliance, exponent=exponent):
                scene = bar(dim, compliance, exponent)
                scene["Solver/Linear solver"] = solver
                result = run("bar", scene, ranks, text="")
                w = penetration(compliance, exponent)
                pressure = CONFINED * (DEPTH - w)
                self.assertClose(result["max_pressure"][-1], pressure, relative=1e-8)
                self.assertClose(
                    result["max_penetration"][-1], w, relative=1e-8, absolute=1e-18
                )
                self.assertClose(
                    -result[f"contact_force_{'xyz'[dim - 1]}"][-1],
                    2 * pressure,
                    relative=1e-8,
                )
                # its slope is known to the linear systems
                self.assertLess(max(result["contact_iterations"]), 6)
                energy = 2 * compliance * w ** (exponent + 1) / (exponent + 1)
                self.assertClose(
                    result["stored_energy"][-1] - result["strain_energy"][-1],
                    energy,
                    absolute=1e-8 * result["stored_energy"][-1],
                )
                self.assertClose(
                    result["energy_balance_defect"][-1],
                    0,
                    absolute=1e-8 * result["stored_energy"][-1],
                )

    def test_block_that_floats(self):
        """Held by nothing but its ground, at the depth of its weight; let go, it
        comes back."""
        for compliance, exponent, ranks in (4, 1, 1), (4, 2, 2), (0.01, 1, 1):
            scene = bar(2, compliance, exponent)
            scene.update(
                {
                    "Boundary 3/Role": "traction",
                    "Boundary 3/Traction": "0; -0.01*min(2*t, 1)*(t < 1.5) - 1e-4",
                    "Time/Phases": "1: 2, 2: 1",
                    "Initial state/Equilibrate": "true",
                }
            )
            scene.pop("Boundary 3/Displacement")
            with self.subTest(compliance=compliance, exponent=exponent):
                result = run("block", scene, ranks, text="")
                for row, load in (1, 0.0101), (-1, 1e-4):
                    self.assertClose(
                        result["max_penetration"][row],
                        (load / compliance) ** (1 / exponent),
                        relative=1e-4,
                    )

    def test_slab_that_sinks_far(self):
        """Two materials on ground that is 1e-7 times as stiff, or less: the way
        of the slab is that of its weight, and rounding of what its stiffness
        makes of the way is no force."""
        weight, exponent = 0.002135 * 0.189 + 0.0004237, 1.5
        for compliance, solver, ranks in (
            (2.065e-4, "direct", 1), (2.065e-4, "multigrid", 2), (2e-10, "direct", 1)
        ):
            scene = {
                "Dimension": 2,
                "Geometry/Generator": "subdivided_hyper_rectangle",
                "Geometry/Arguments": "2, 1 : 0, 0 : 1, 0.189 : true",
                "Geometry/Global refinements": 3,
                **elastic_moduli("if(x < 0.5, 0.4447, 222.2)", "if(x < 0.5, 0, 0.3)"),
                "Loads/Body force": "0; -0.002135*(1 + t)",
                **with_roles(symmetry=[0], free=[1]),
                **on_boundary(2, Role="contact", Contact_law="normal compliance"),
                **on_boundary(2, Compliance=compliance, Compliance_exponent=exponent),
                "Boundary 2/Friction law": "none",
                **on_boundary(3, Role="traction", Traction="0; -0.0004237*(1 + t)"),
                "Initial state/Equilibrate": "true",
                "Time/Phases": "1: 2",
                "Solver/Linear solver": solver,
            }
            with self.subTest(compliance=compliance, solver=solver):
                result = run("slab", scene, ranks, text="")
                for row, load in (0, weight), (-1, 2 * weight):
                    self.assertClose(
                        -result["contact_force_y"][row], load, relative=1e-7
                    )
                    self.assertClose(
                        result["max_penetration"][row],
                        (load / compliance) ** (1 / exponent),
                        relative=1e-4,
                    )


class Limit(TestCase):
    def test_rigid_foundation(self):
        """The difference to a rigid foundation is of the order 1/c."""
        plate = {
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true",
            **elastic_moduli(1, 0.3),
            **of_law("maxwell", Viscosity=2),
            **with_roles(free=[0, 1]),
            **on_boundary(2, Role="contact", Contact_law="unilateral"),
            **on_boundary(2, Gap="0.004*(x - 1)^2", Friction_law="coulomb"),
            "Boundary 2/Friction coefficient": 0.3,
            "Boundary 3/Role": "displacement",
            "Boundary 3/Displacement": "0.02*sin(3*t); -0.02*sin(2*t)",
            "Time/Phases": "1: 8",
            "Solver/Contact tolerance": 1e-10,
        }
        rigid = run("plate", plate, text="")
        differences = []
        for compliance in 1e3, 1e4, 1e5:
            soft = run(
                "plate",
                {
                    **plate,
                    "Boundary 2/Contact law": "normal compliance",
                    "Boundary 2/Compliance": compliance,
                },
                text="",
            )
            self.check_identities(soft)
            differences.append(
                max(
                    abs(soft[name] - rigid[name]).max() / abs(rigid[name]).max()
                    for name in ("contact_force_y", "friction_force_x")
                )
            )
        orders = np.log10(np.divide(differences[:-1], differences[1:]))
        self.assertLess(differences[-1], 1e-3)
        self.assertLess(abs(orders - 1).max(), 0.1, differences)


    def test_new_meshes(self):
        """Interpolation at new nodes over a curved gap makes penetrations, but
        no energy."""
        plate = {
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
            "Material/Law": "elastic",
            **with_roles(free=[0, 1]),
            **on_boundary(2, Role="contact", Contact_law="unilateral"),
            **on_boundary(2, Gap="0.02*(x - 1)^2", Friction_law="coulomb"),
            "Boundary 2/Friction coefficient": 0.3,
            **on_boundary(3, Role="displacement", Displacement="0.01*t; -0.02*t"),
            "Time/Phases": "1: 8",
            **ADAPTIVE,
        }
        soft = {**on_boundary(2, Contact_law="normal compliance", Compliance=1e7)}
        rigid = run("plate", plate, text="")
        result = run("plate", {**plate, **soft}, text="")
        self.assertGreater(result["cells"][-1], 2 * result["cells"][0])
        size = rigid["stored_energy"][-1]
        for name in "adaptation_energy", "stored_energy", "energy_balance_defect":
            self.assertLess(abs(result[name] - rigid[name]).max(), 1e-3 * size, name)


class Seam(TestCase):
    def test_beside_a_rigid_foundation(self):
        """Where both meet, nodes have two obstacles and one bound of friction."""
        for hard, soft in ("2", "4"), ("4", "2"):
            contact = {"Friction law": "coulomb", "Friction coefficient": 0.3}
            contact.update({"Role": "contact", "Foundation motion": "0.2*t; 0"})
            scene = {
                "Geometry/Generator": "subdivided_hyper_rectangle",
                "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
                "Geometry/Boundary ids": "if(id == 2 && x > 1, 4, id)",
                "Material/Law": "elastic",
                **with_roles(free=[0, 1], displacement=[3]),
                "Boundary 3/Displacement": "0; -0.01*min(1, 5*t)",
                "Time/Phases": "1: 10",
                f"Boundary {hard}/Contact law": "unilateral",
                **on_boundary(soft, Contact_law="normal compliance", Compliance=3),
            }
            for piece in hard, soft:
                for name, value in contact.items():
                    scene[f"Boundary {piece}/{name}"] = value
            with self.subTest(hard=hard):
                result = run("plate", scene, text="")
                self.assertEqual(result["slip_area"][-1], 2.0)
                self.assertClose(
                    result["friction_force_x"][-1],
                    0.3 * result["contact_force_y"][-1],
                    relative=1e-3,
                )
                # Neither do the residuals count the pressure twice.
                scene[f"Boundary {soft}/Compliance"] = 1e9
                seam = run("plate", scene, text="")
                scene[f"Boundary {soft}/Contact law"] = "unilateral"
                rigid = run("plate", scene, text="")
                self.assertClose(
                    seam["estimate_space"][1:],
                    rigid["estimate_space"][1:],
                    relative=1e-4,
                )


class EverySolution(TestCase):
    """p = c (u_n - g)_+^m at each node, whatever else acts."""

    def check(self, changes, ranks=1):
        result = run("soft_ground_3d", changes, ranks)
        face = result.fields("contact")
        x, y, _ = face.points.T
        gap, pressure = (face.point_data[n] for n in ("gap", "contact_pressure"))
        inner = abs(x - 1) > 1e-9  # the nodes of both laws have their mean
        # hanging nodes have that of their neighbors
        corners = face.points[face.cells]
        middles = (corners + np.roll(corners, 1, axis=1)) / 2
        hanging = set(map(tuple, lattice(middles.reshape(-1, 3))))
        inner &= [tuple(p) not in hanging for p in lattice(face.points)]
        depth = np.maximum(-gap, 0)
        for piece, law in (x < 1, 5 * depth), (x > 1, 150 * depth**2):
            here = inner & piece
            size = pressure[here].max()
            self.assertGreater(size, 0)
            # as far as numbers in the files go
            self.assertLess(abs(pressure - law)[here].max(), 1e-6 * size)
        self.assertLess(max(result["force_balance_defect"]), 1e-8)
        return result

    def test_forward_euler(self):
        """New meshes come into equilibrium with multigrid as with factors."""
        multigrid = self.check({}, 2)
        direct = run("soft_ground_3d", {"Solver/Linear solver": "direct"})
        for name in "strain_energy", "contact_force_z":
            self.assertClose(multigrid[name], direct[name], 1e-8, 1e-12)

    def test_backward_euler(self):
        """Also where tangents are not symmetric."""
        law = {
            "Time/Scheme": "backward Euler",
            "Time/Phases": "1: 3",
            "Mesh refinement/Strategy": "none",
            "Boundary 5/Displacement": "0.02*t; 0.01*t^2; -0.03*t + 0.01*t*x",
        }
        self.check(law)
        norton = {"Rate factor": 1e3, "Exponent": 3, "Stress cap": 1}
        parsed = {"Strain rate": "0.5*sigma_eq*(1 - 2*p)"}
        for name, entries in ("norton", norton), ("parsed", parsed):
            material = {f"Material/{name}/{key}": v for key, v in entries.items()}
            self.check({**law, "Material/Law": name, **material})


class Refused(TestCase):
    refused_scene = ("bar", bar(2, 2, 1), "")

    def test_sentences(self):
        law, compliance = "Boundary 2/Contact law", "Boundary 2/Compliance"
        self.refused({compliance: ""}, f"'{compliance}' is missing")
        self.refused({compliance: "x - 1"}, "at x = (", "must not be negative")
        self.refused({compliance: "1 + t"}, "depends on time")
        self.refused({compliance + " exponent": 0.5}, "Compliance exponent")
        self.refused({"Boundary 2/Friction law": "glued"}, "cannot open")
        unused = run("bar", {**bar(2, 2, 1), law: "unilateral"}, text="")
        self.assertIn(f"'{compliance}'", unused.stdout + unused.stderr)

    def test_loads_beyond_the_end_of_the_ground(self):
        """By a millionth of its length: nothing holds the body, but it came to
        rest where rounding was its strain energy, which was negative."""
        pillar = {
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "2, 2 : 0, 0 : 0.0758, 1 : true",
            "Geometry/Boundary ids": "if(id == 2 && x > 0.0379, 7, id)",
            "Geometry/Global refinements": 2,
            **elastic_moduli(1.521, 0.499),
            **{f"Boundary {side}/Role": "free" for side in (0, 1, 7)},
            **on_boundary(2, Role="contact", Contact_law="normal compliance"),
            **on_boundary(2, Compliance=14, Compliance_exponent=1.5),
            **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
            "Boundary 3/Role": "traction",
            "Initial state/Equilibrate": "true",
            "Time/Phases": "1: 2",
        }
        for slope in 1e-5, 1e-6, 1e-7:
            load = f"0; -0.02472*(1 + {slope}*(x - 0.0379)/0.0379)"
            beyond = {**pillar, "Boundary 3/Traction": load}
            result = run("pillar", beyond, text="", check=False)
            self.assertRefused(result, "No contact force balances", "rotation about z")
        # at its very end
        result = run("pillar", {**pillar, "Boundary 3/Traction": "0; -0.02472"}, text="")
        self.assertClose(result["contact_force_y"], -0.02472 * 0.0758, relative=1e-6)
        self.assertGreater(result["strain_energy"].min(), 0)


class Notes(TestCase):
    """What is said of foundations that press by almost nothing, or too much."""

    PRESSED = {
        "Geometry/Arguments": "4, 2 : 0, 0 : 2, 1 : true",
        **with_roles(free=[0, 1]),
        **on_boundary(2, Role="contact", Friction_law="none"),
        **on_boundary(3, Role="displacement", Displacement="0; -0.02*t"),
        "Time/Phases": "1: 4",
    }

    def pressed(self, law, check=True, **more):
        more = {f"Boundary 2/{name.replace('_', ' ')}": more[name] for name in more}
        scene = {**self.PRESSED, "Boundary 2/Contact law": law, **more}
        return run("pressed", scene, text="", check=check)

    def test_a_pressure_below_rounding(self):
        ground = {"Compliance": 1, "Compliance_exponent": 20, "Gap": "0.01 + 0.001*x"}
        result = self.pressed("normal compliance", **ground)
        self.assertClose(result["max_penetration"][-1], 0.01, 1e-9)
        self.assertNotIn("never acted", result.stdout)

    def test_a_gap_that_closes_between_nodes(self):
        """Nodes are at multiples of 1/2."""
        for law in "unilateral", "normal compliance":
            gap = "0.1 - 0.095*exp(-100*(x - 0.9)^2)"
            more = {"Compliance": 1} if law != "unilateral" else {}
            result = self.pressed(law, Gap=gap, **more)
            self.assertEqual(result["contact_area"].max(), 0)
            self.assertIn("closed between the nodes", result.stdout)
            self.assertNotIn("free gives the same", result.stdout)
        open_gap = self.pressed("unilateral", Gap=0.1)
        self.assertIn("free gives the same", open_gap.stdout)
        closed = self.pressed("unilateral", Gap=0.012)  # at t = 0.6
        self.assertIn("First touch between t = 0.5 and 0.75\n", closed.stdout)

    def test_a_stiffness_that_no_number_resolves(self):
        gap = "0.01*(x - 1)^2"
        result = self.pressed("normal compliance", check=False, Compliance=1e20, Gap=gap)
        self.assertRefused(result, "times as stiff as the body", "its limit")
        self.assertNotIn("raise", result.stderr)


if __name__ == "__main__":
    main()
