# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact that opens and closes, and friction of the pressure that comes out.

Small scenes against independent solvers of the same discretization
(independent_contact.py, of two bodies independent_pair.py), which share no algorithm
with the program.
"""

import functools

import numpy as np

import independent_contact
import independent_pair
from harness import TestCase, main, run
from runs import elastic_moduli, of_law, on_boundary, with_roles

CONTACT_LAWS = {
    "none": {"Friction law": "none"},
    "tresca": {"Friction law": "tresca"},
    "lagged": {"Friction law": "coulomb"},
    "coupled": {"Friction law": "coulomb"},
}


def entries_of(scene):
    entries = independent_contact.parameters(scene)
    boundary = f"Boundary {2 * len(scene['cells']) - 2}"
    law = scene["law"]
    contact = {"Contact law": "unilateral", "Gap": scene["gap"], **CONTACT_LAWS[law]}
    if "compliance" in scene:
        contact["Contact law"] = "normal compliance"
        contact["Compliance"], contact["Compliance exponent"] = scene["compliance"]
    if law == "tresca":
        contact["Friction bound"] = scene["bound"]
    if law in ("lagged", "coupled"):
        contact["Friction coefficient"] = scene["mu"]
    if law == "lagged":
        entries["Solver/Coulomb pressure"] = "lagged"
    if law == "coupled":
        entries["Solver/Coulomb tolerance"] = 1e-11
    return {
        **entries,
        **{f"{boundary}/{name}": value for name, value in contact.items()},
        "Material/Volumetric integration": "full",
        "Solver/Contact tolerance": 1e-10,
    }


@functools.cache
def known_steps(name):
    """The steps of the independent solver, once for all that is compared with them."""
    return independent_contact.solve(independent_contact.SCENES[name])


class Reference(TestCase):
    def check(self, name, ranks=1, **more):
        scene = independent_contact.SCENES[name]
        entries = {**entries_of(scene), **more}
        result = run(name.replace(" ", "_"), entries, ranks, text="")
        steps = known_steps(name)
        self.assertEqual(len(steps), len(result["t"]) - 1)
        dim = len(scene["cells"])
        normal = "xyz"[dim - 1]
        size = max(step.normal_force for step in steps)
        energy = max(step.energy for step in steps)
        length = max(abs(step.u).max() for step in steps)
        tolerance = 1e-8 if ranks == 1 else 1e-6
        for i, step in enumerate(steps, start=1):
            with self.subTest(t=step.t):
                force = -result[f"contact_force_{normal}"][i]
                self.assertLess(abs(force - step.normal_force), tolerance * size)
                for d in range(dim - 1):
                    self.assertLess(
                        abs(
                            result[f"friction_force_{'xyz'[d]}"][i]
                            - step.tangential_force[d]
                        ),
                        tolerance * size,
                    )
                self.assertAlmostEqual(result["contact_area"][i], step.contact_area)
                self.assertLess(
                    abs(result["strain_energy"][i] - step.energy), tolerance * energy
                )
                self.assertLess(result["force_balance_defect"][i], 1e-6)
                pressure = step.p / step.area
                self.assertLess(
                    abs(result["max_pressure"][i] - pressure.max()),
                    10 * tolerance * size / step.area.min(),
                )
                for point, node in ("point0", 0), ("point1", len(step.p) - 1):
                    for d in range(dim):
                        u = result[f"{point}_{'xyz'[d]}"][i]
                        self.assertClose(
                            u, step.u[node, d], absolute=tolerance * length, what=point
                        )
                opening = step.gap - step.u[: len(step.p), -1] * -1
                gap = max(opening.max(), 0)
                self.assertLess(abs(result["max_gap"][i] - gap), 1e-8)
                if step.compliance:
                    depth = max(-opening.min(), 0)
                    self.assertLess(abs(result["max_penetration"][i] - depth), 1e-8)
        return result

    def test_frictionless(self):
        self.check("opening")
        self.check("opening", ranks=2)

    def test_tresca(self):
        self.check("rough")

    def test_tresca_in_space(self):
        self.check("turning tresca")
        self.check("turning tresca", ranks=3)

    def test_lagged_pressure(self):
        self.check("lagged")
        self.check("steep")

    def test_moving_foundation(self):
        self.check("moving")

    def test_fixed_point(self):
        result = self.check("coupled")
        self.assertLess(max(result["contraction"]), 0.6)
        self.assertGreater(max(result["contraction"]), 0.05)

    NEWTON = {"Solver/Coulomb pressure": "Newton", "Solver/Coulomb tolerance": 1}

    def test_newton(self):
        """The same answers without a fixed point, at the price of given bounds."""
        for name, ranks in (("coupled", 1), ("soft rough", 1), ("coupled", 2)):
            with self.subTest(name, ranks=ranks):
                result = self.check(name, ranks, **self.NEWTON)
                self.assertEqual(max(result["bound_iterations"]), 0)
                self.assertLess(max(result["contraction"]), 0.6)
                self.assertLess(np.mean(result["contact_iterations"][1:]), 6)

    def test_newton_in_space(self):
        self.check("turning coulomb", **self.NEWTON)
        self.check("turning coulomb", ranks=3, **self.NEWTON)
        self.check("soft turning", **self.NEWTON)

    def test_compliance(self):
        self.check("soft")
        self.check("soft rough")

    def test_compliance_in_space(self):
        self.check("soft turning")
        self.check("soft turning", ranks=3)

    def test_bodies_of_revolution(self):
        for name, ranks in (
            *(("pillar", 1), ("tube", 1), ("tube", 2), ("tube of means", 1)),
            *(("pillar that creeps", 1), ("soft tube", 1)),
        ):
            with self.subTest(name, ranks=ranks):
                self.check(name, ranks, **{"Solver/Contact tolerance": 1e-12})

    def test_fixed_point_in_space(self):
        self.check("turning coulomb")
        self.check("turning coulomb", ranks=2)


class Held(TestCase):
    """A block that nothing but its foundation holds: statics says the rest."""

    BLOCK = {
        "Geometry/Generator": "subdivided_hyper_rectangle",
        "Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true",
        "Material/Law": "elastic",
        **on_boundary(0, Role="traction", Traction="0.004*max(0, t - 0.3); 0"),
        "Boundary 1/Role": "free",
        **on_boundary(2, Role="contact", Contact_law="unilateral", Gap=0.1),
        **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
        **on_boundary(3, Role="traction", Traction="0; -0.01*(x - 0.4)*min(1, 5*t)"),
        "Time/Phases": "1: 5",
    }

    def run_block(self, changes=None, ranks=1, check=True):
        return run("block", {**self.BLOCK, **(changes or {})}, ranks, "", check)

    def test_tilted_by_its_load(self):
        """It falls onto the foundation and is lifted at one end. The pressure
        has the resultant and the moment of the loads."""
        for changes, ranks in (
            ({}, 1),
            ({"Solver/Linear solver": "multigrid"}, 2),
            ({"Boundary 2/Gap": "5 + 0.3*x"}, 1),
        ):
            with self.subTest(changes=changes):
                result = self.run_block(changes, ranks)
                push = 0.004 * (1 - 0.3)
                weight = 0.01 * ((2 - 0.4) ** 2 - 0.4**2) / 2
                self.assertClose(result["contact_force_y"][-1], -weight, relative=1e-5)
                self.assertClose(result["friction_force_x"][-1], push, relative=1e-5)
                self.assertGreater(result["max_gap"][-1], 0.01)
                face = result.fields("contact")
                x, first = np.unique(face.points[:, 0], return_index=True)
                pressure = face.point_data["contact_pressure"][first]
                h = np.diff(x).max()
                area = np.full(len(x), h)
                area[[0, -1]] /= 2
                moment = (area * pressure * x).sum()
                # of the load about the origin, and of the push at half the height
                load = 0.01 * (2**3 / 3 - 0.4 * 2**2 / 2) + push * 0.5
                self.assertClose(moment, load, relative=1e-4)

    def test_space(self):
        """On two ranks with hanging nodes on the foundation."""
        block = {
            **{key: value for key, value in self.BLOCK.items()},
            "Dimension": 3,
            "Geometry/Arguments": "2, 2, 1 : 0, 0, 0 : 2, 2, 1 : true",
            "Boundary 0/Traction": "0.002*max(0, t - 0.3); 0; 0",
            "Boundary 2/Role": "free",
            **on_boundary(3, Role="traction", Traction="0; -0.001*max(0, t - 0.3); 0"),
            **on_boundary(4, Role="contact", Contact_law="unilateral"),
            **on_boundary(4, Gap="0.05*(x^2 + y^2)", Friction_law="coulomb"),
            "Boundary 4/Friction coefficient": 0.5,
            **on_boundary(5, Role="traction", Traction="0; 0; -0.01*min(1, 5*t)"),
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Maximal level": 2,
        }
        for name in ("Contact law", "Gap", "Friction law", "Friction coefficient"):
            block.pop(f"Boundary 2/{name}")
        result = run("block", block, 2, "")
        self.assertGreater(result["cells"][-1], 4)
        self.assertLess(result["cells"][-1], 4 * 8**2)
        area = 2 * 1
        expected = [0.002 * 0.7 * area, -0.001 * 0.7 * area]
        for name, value in zip("xy", expected):
            self.assertClose(result[f"friction_force_{name}"][-1], value, relative=1e-5)
        self.assertClose(result["contact_force_z"][-1], -0.01 * 4, relative=1e-5)

    def test_lifted_in_its_middle(self):
        """A long strip on its foundation, so soft in bending that the load lifts
        a part of it: what holds it is the weight of the ends."""
        strip = {
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "40, 2 : -10, 0 : 10, 0.5 : true",
            "Material/Young's modulus": 1000,
            "Material/Law": "elastic",
            **with_roles(free=[0, 1]),
            **on_boundary(2, Role="contact", Contact_law="unilateral"),
            **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
            **on_boundary(3, Role="traction", Traction="0; 0.001*exp(-(x/2)^2)*t"),
            "Loads/Body force": "0; -0.0005*min(1, 10*t)",
            "Solver/Coulomb pressure": "fixed point",
            "Time/Phases": "1: 4",
        }
        for ranks, solver in ((1, "direct"), (2, "multigrid")):
            with self.subTest(solver=solver):
                entries = {**strip, "Solver/Linear solver": solver}
                result = run("strip", entries, ranks, text="")
                lift = 0.001 * 2 * np.sqrt(np.pi)  # but for the tails
                self.assertClose(
                    result["contact_force_y"][-1], lift - 0.005, relative=1e-3
                )
                self.assertGreater(result["max_gap"][-1], 1e-4)
                self.assertLess(result["contact_area"][-1], 18)
                gap = result.fields("contact")
                x, first = np.unique(gap.points[:, 0], return_index=True)
                opening = gap.point_data["gap"][first]
                self.assertClose(opening, opening[::-1], absolute=1e-5)

    def test_lifted_against_its_weight(self):
        """Weitsman's beam: by its force and by its lift, which follow each
        other. What touches down is not as thin as in the theory."""
        coarse, fine = "96, 4", "192, 8"
        mesh = lambda cells: {"Geometry/Arguments": f"{cells} : 0, 0 : 6, 0.25 : true"}
        by_force = run("lifted_beam_2d", mesh(coarse))
        t, lift = by_force["t"], by_force["point0_y"]
        self.assertClose(by_force["contact_force_y"], by_force["load_y"], 1e-5)
        self.assertClose(np.diff(by_force["contact_area"][1:]), -1, absolute=1e-9)
        self.assertClose(6 - by_force["contact_area"][1:], 4 * t[1:], absolute=0.2)
        theory = 0.004 * (4 * t) ** 4 / (72 * 1000 * 0.25**3 / 12)
        self.assertClose(lift[-1], theory[-1], relative=0.02)
        finer = run("lifted_beam_2d", mesh(fine))["point0_y"]
        self.assertClose(finer[-1], theory[-1], relative=0.01)
        ranks = run("lifted_beam_2d", {"Solver/Linear solver": "multigrid"}, 3)
        self.assertClose(ranks["point0_y"], lift, absolute=1e-4 * lift[-1])

        by_lift = run(
            "lifted_beam_2d",
            {
                **mesh(coarse),
                **on_boundary(0, Displacement=f"0; {lift[-1]!r}*t^4", Traction="0; 0"),
            },
        )
        self.assertClose(by_lift["reaction_0_y"][-1], 2 / 3 * 0.016, relative=2e-3)
        areas = by_lift["contact_area"][-1], by_force["contact_area"][-1]
        self.assertClose(*areas, absolute=1e-9)

    def test_ground_softer_than_the_body(self):
        """It sinks in by p/c, to a tenth of its size."""
        for stiffness, load in ((1e-5, 1e-6), (1, 0.01)):
            with self.subTest(stiffness=stiffness):
                result = self.run_block(
                    {
                        "Boundary 0/Role": "free",
                        "Boundary 2/Contact law": "normal compliance",
                        **on_boundary(2, Compliance=stiffness, Gap=0),
                        "Material/Poisson's ratio": 0,
                        "Boundary 3/Traction": f"0; -{load}*t",
                    }
                )
                self.assertClose(
                    result["max_penetration"][-1], load / stiffness, relative=1e-5
                )

    def test_beds_as_soft_as_they_may_be(self):
        """A stiff block sinks in by p/c."""
        for stiffness in (2e-6, 4e-9):  # c h / E
            for solver in "direct", "multigrid":
                with self.subTest(stiffness=stiffness, solver=solver):
                    ranks = 2 if solver == "multigrid" and stiffness < 1e-8 else 1
                    compliance = 12000 * stiffness / 0.25
                    block = {
                        "Geometry/Arguments": "32, 4 : 0, 0 : 8, 1 : true",
                        **elastic_moduli(12000, 0),
                        "Boundary 0/Role": "symmetry",
                        "Boundary 2/Contact law": "normal compliance",
                        **on_boundary(2, Compliance=compliance, Friction_law="none"),
                        "Boundary 2/Gap": 0,
                        "Boundary 3/Traction": f"0; -{0.2 * compliance}*t",
                        "Solver/Linear solver": solver,
                        "Time/Phases": "1: 1",
                    }
                    entries = {**self.BLOCK, **block}
                    for name in (
                        "Boundary 0/Traction", "Boundary 2/Friction coefficient"
                    ):
                        entries.pop(name)
                    result = run("bed", entries, ranks, "")
                    self.assertClose(result["max_penetration"][-1], 0.2, relative=1e-6)
                    self.assertClose(
                        result["contact_force_y"][-1],
                        -8 * 0.2 * compliance,
                        relative=1e-6,
                    )

    def test_soft_bed_that_moves(self):
        """A slab lies seven thousand times its length deep in its bed (drawn by
        contrib/fuzz): rounding of that way makes no forces in the slab."""
        bed = {
            "Geometry/Arguments": "2, 1 : 0, 0 : 1, 0.141 : true",
            "Geometry/Boundary ids": "if(id == 3 && x > 0.5, 7, id)",
            **elastic_moduli(0.7094, -0.5),
            **of_law("maxwell", Viscosity=5.416),
            "Boundary 0/Role": "symmetry",
            **on_boundary(1, Role="traction", Traction="-2.895e-06; 0"),
            **on_boundary(2, Role="contact", Friction_law="none"),
            "Boundary 2/Contact law": "normal compliance",
            "Boundary 2/Compliance": "1.539e-08*(1 + x^2)",
            "Boundary 2/Gap": "7.04e-06*cos(7*x) - 0.0001269*sin(20*t)",
            "Boundary 3/Role": "free",
            **on_boundary(7, Role="traction", Traction="0; -0.0001106"),
            "Initial state/Equilibrate": "true",
            "Loads/Body force": "0; -0.0006672",
            "Time/Phases": "0.5: 1, 1.5: 5, 1.75: 8",
            "Time/Scheme": "Heun",
            "Solver/Linear solver": "direct",
            "Solver/Contact tolerance": 1e-8,
        }
        result = run("bed", bed, text="")
        self.assertLess(result["contact_iterations"].max(), 20)
        self.assertClose(
            result["contact_force_y"],
            np.full(15, -0.0006672 * 0.141 - 0.0001106 / 2),
            relative=1e-6,
        )

    def test_more_friction_than_the_pressure_before_allows(self):
        """The push of each step is held by the pressure of that step alone."""
        for steps in (2, 3):
            with self.subTest(steps=steps):
                result = self.run_block(
                    {
                        "Boundary 0/Traction": "0.005*t; 0",
                        "Boundary 2/Gap": 0,
                        "Boundary 3/Traction": "0; -0.01*t",
                        "Solver/Coulomb pressure": "fixed point",
                        "Time/Phases": f"1: {steps}",
                    }
                )
                self.assertClose(
                    result["friction_force_x"], 0.005 * result["t"], relative=1e-5
                )

    def test_nearly_incompressible(self):
        result = self.run_block(
            {
                "Boundary 0/Role": "free",
                "Boundary 2/Gap": 0,
                "Boundary 3/Traction": "0; -0.01*t",
                "Material/Poisson's ratio": 0.49999,
                "Material/Young's modulus": 1,
            }
        )
        self.assertClose(result["contact_force_y"][-1], -0.02, relative=1e-4)

    def test_nearly_incompressible_slabs(self):
        """Nodes that are brought to contact with the bulk at rest make much of
        the residual; multigrid and the direct solver agree all the same."""
        slab = {
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Global refinements": 1,
            **with_roles(symmetry=[0], free=[1]),
            **on_boundary(2, Role="contact", Contact_law="unilateral"),
            "Boundary 2/Friction law": "tresca",
            "Boundary 2/Friction bound": "0.0031*(x < 0.3 ? 1 : 0.05)",
            "Boundary 2/Gap": "0.000655*(x - 0.5)^2",
            "Boundary 2/Foundation displacement": "-0.0025*t",
            **on_boundary(3, Role="traction", Traction="0; -0.0009*t^2"),
            "Solver/Contact tolerance": 1e-8,
            "Time/Phases": "0.5: 2",
        }
        for ratio, cells, height in ((0.499, 13, 0.0379), (0.4999, 13, 0.08)):
            with self.subTest(ratio=ratio):
                entries = {
                    **slab,
                    "Geometry/Arguments": f"{cells}, 1 : 0, 0 : 1, {height} : true",
                    "Material/Poisson's ratio": ratio,
                    "Material/Young's modulus": "1.7*(1 + x^2)",
                }
                direct, multigrid = (
                    run("slab", {**entries, "Solver/Linear solver": name}, text="")
                    for name in ("direct", "multigrid")
                )
                for name in "strain_energy", "max_pressure", "contact_area":
                    self.assertClose(
                        multigrid[name][-1], direct[name][-1], relative=1e-4
                    )

    def test_slender_and_nearly_incompressible(self):
        """Bending that is 1e5 times softer than the springs of the method: steps
        learn from each other."""
        strip = {
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "7, 2 : 0, 0 : 1, 0.0351 : true",
            "Geometry/Global refinements": 1,
            **elastic_moduli(0.6748, 0.4999),
            **with_roles(symmetry=[0], free=[1]),
            **on_boundary(2, Role="contact", Contact_law="unilateral"),
            **on_boundary(2, Friction_law="none", Gap=2.4e-5),
            "Boundary 3/Role": "traction",
            "Boundary 3/Traction": "0; -4.3e-7*t*(x > 0.1429 ? 1 : 0)",
            "Time/Phases": "1: 1",
        }
        for solver in "direct", "multigrid":
            with self.subTest(solver=solver):
                found = run("strip", {**strip, "Solver/Linear solver": solver}, text="")
                # 12 of 14 cells, as the traction is taken at their points
                self.assertClose(
                    found["contact_force_y"][-1], -4.3e-7 * 6 / 7, relative=1e-6
                )
                self.assertLess(found["contact_iterations"][-1], 60)

    def test_nearly_incompressible_on_a_soft_bed(self):
        """As soft as the springs of the method where the bulk is stiff (drawn by
        contrib/fuzz): steps that learn are not settled as rigid bodies are."""
        slab = {
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "2, 1 : 0, 0 : 1, 0.238 : true",
            "Geometry/Global refinements": 1,
            **elastic_moduli(2.358, 0.4999),
            **with_roles(symmetry=[0], free=[1]),
            **on_boundary(2, Role="contact", Contact_law="normal compliance"),
            "Boundary 2/Compliance": "0.4795*(1.5 + sin(7*x))",
            **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.2),
            "Boundary 2/Gap": "0.001237*x^2",
            **on_boundary(3, Role="traction", Traction="0; -0.002582*t"),
            "Time/Phases": "1: 2",
            "Solver/Contact tolerance": 1e-8,
        }
        for solver in "direct", "multigrid":
            with self.subTest(solver=solver):
                found = run("slab", {**slab, "Solver/Linear solver": solver}, text="")
                self.assertClose(found["contact_force_y"][-1], -0.002582, relative=1e-6)
                self.assertLess(found["contact_iterations"].max(), 40)

    def test_stiff_part_that_comes_down_on_one_node_after_the_other(self):
        """The first node that meets the floor ends a correction at once, with the
        rest still to come: bent to the floor, a body as stiff would store more than
        its fall sets free, and the node alone would rise again."""
        scene = {
            "Dimension": 3,
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "5, 1, 2 : 0, 0, 0 : 1, 0.204, 0.204 : true",
            "Geometry/Material ids": "if(x > 0.2, 2, 1)",
            "Material 1/Young's modulus": 0.8573,
            "Material 1/Poisson's ratio": -0.5,
            "Material 1/Law": "maxwell",
            "Material 1/maxwell/Viscosity": "0.008126*(2 + x^2)",
            "Material 2/Young's modulus": 0.8888e5,
            **with_roles(symmetry=[0, 2], free=[1, 3]),
            **on_boundary(4, Role="contact", Contact_law="unilateral"),
            **on_boundary(4, Gap="7.707e-5*x^2 - 1.061e-4*t^2", Friction_law="tresca"),
            "Boundary 4/Friction bound": "3.861e-5*abs(sin(7*t))",
            "Boundary 5/Role": "free",
            "Loads/Body force": "0; 0; -0.0002962*min(4*t, 1)",
            "Time/Phases": "0.02: 4",
            "Time/Stiffness policy": "backward Euler",
            "Error control/Tolerance": 0.3,
            "Step control/Smallest step": 0.005,
            "Mesh refinement/Cell budget": 60,
        }
        result = run("stiff_part", scene, text="")
        self.check_identities(result, tolerance=1e-5, balance=1e-2)
        self.assertLess(result["contact_iterations"].max(), 30)

    def test_relieved_of_all_loads(self):
        """The error is relative to what there was, not to the nothing that is
        left, and so are the bounds of friction."""
        for more in (
            {},
            {"Solver/Linear solver": "multigrid"},
            {"Solver/Coulomb pressure": "fixed point"},
        ):
            with self.subTest(more):
                relieved = {"Boundary 3/Pressure": "0.01*min(t, 2 - t)", **more}
                result = run("hard/wedge_2d", relieved)
                self.assertLessEqual(result["algebraic_error"].max(), 1e-5)
                self.assertNotIn("rounding leaves", result.stdout)
                self.assertLess(
                    result["max_pressure"][-1], 1e-5 * result["max_pressure"].max()
                )

    def test_belt_below_a_body_without_load(self):
        """Where nothing presses, nothing is carried along; and the pressure of
        the step before is told to be that."""
        belt = {
            "Boundary 0/Role": "free",
            **on_boundary(2, Gap=0, Foundation_motion="t; 0"),
            "Boundary 3/Traction": "0; -0.01*max(0, t - 0.6)",
        }
        # The step in which contact begins has no friction yet of the pressure of
        # the step before.
        for pressure, carried in ("lagged", 0.2), ("fixed point", 0.4):
            with self.subTest(pressure=pressure):
                result = self.run_block({**belt, "Solver/Coulomb pressure": pressure})
                still = result["t"] < 0.7
                self.assertLess(result["max_displacement"][still].max(), 1e-12)
                self.assertClose(result["max_displacement"][-1], carried, relative=0.05)
                if pressure == "fixed point":
                    continue
                self.assertClose(result["bound_lag"][-2:], [1, 0.5], absolute=1e-6)
                self.assertRegex(
                    " ".join(result.stdout.split()),
                    "miss those of the pressure of their step by 67 % on average",
                )

    def test_refusals(self):
        for changes, message in (
            ({"Boundary 3/Traction": "0; 0.01*t"}, "No contact force balances"),
            # beyond mu times the weight
            (
                {
                    "Boundary 0/Traction": "0.01*max(0, t - 0.3); 0",
                    "Boundary 3/Traction": "0; -0.01*min(1, 5*t)",
                },
                "Step 5 .*No contact force balances",
            ),
            # no friction in the first step
            (
                {
                    "Boundary 0/Traction": "0.001*t; 0",
                    "Solver/Coulomb pressure": "lagged",
                },
                "= Newton has",
            ),
            # which no pressure of its own could give
            (
                {
                    "Boundary 0/Traction": "0.011*t; 0",
                    "Solver/Coulomb pressure": "fixed point",
                },
                r"translation along \(0.958, 0.287\)",
            ),
            # stiffness that is lost in rounding
            (
                {
                    "Geometry/Material ids": "if(y < 0.5, 1, 2)",
                    "Material 1/Young's modulus": 1,
                    "Material 2/Young's modulus": 1e11,
                },
                "differs so much from place to place",
            ),
            (
                {"Boundary 2/Friction law": "none"},
                "leave a rigid motion free: translation along x",
            ),
            (
                {"Boundary 2/Friction coefficient": 0},
                "leave a rigid motion free: translation along x",
            ),
        ):
            with self.subTest(message=message):
                stderr = self.run_block(changes, check=False).stderr
                self.assertRegex(" ".join(stderr.split()), message)
        # which the law in its own step has
        found = self.run_block(
            {"Boundary 0/Traction": "0.001*t; 0", "Solver/Coulomb pressure": "Newton"}
        )
        self.assertClose(found["friction_force_x"][-1], 0.001, relative=1e-5)

    def test_no_load_at_all(self):
        """Squeezed by a plate, and at rest in the end: balance without loads."""
        result = self.run_block(
            {
                "Boundary 0/Role": "free",
                "Boundary 2/Gap": 0,
                "Boundary 3/Role": "displacement",
                "Boundary 3/Displacement": "free; -0.01*min(2*t, 1)",
                "Solver/Coulomb pressure": "fixed point",
            }
        )
        self.assertLess(result["contact_force_y"][-1], -0.02)
        self.assertClose(
            result["contact_force_y"][-1], result["reaction_3_y"][-1], relative=1e-6
        )

    def test_carried_without_strain(self):
        """By its foundation, up: rounding is no part of a solution that is none."""
        result = run(
            "carried",
            {
                "Geometry/Generator": "subdivided_hyper_rectangle",
                "Geometry/Arguments": "4, 2 : 0, 0 : 2, 1 : true",
                **{f"Boundary {b}/Role": "free" for b in (0, 1, 3)},
                **on_boundary(2, Role="contact", Contact_law="unilateral"),
                **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
                "Boundary 2/Foundation displacement": "-1e-3*t",
                "Time/Phases": "1: 4",
                "Solver/Contact tolerance": 1e-8,
            },
            text="",
        )
        self.assertClose(result["max_displacement"][-1], 1e-3, relative=1e-6)
        self.assertLess(result["algebraic_error"].max(), 1e-8)
        self.assertNotIn("Warning", result.stdout)


class WherePiecesMeet(TestCase):
    """What one condition moves at a corner, friction of the other piece holds."""

    WEDGE = {
        "Geometry/Generator": "general_cell",
        "Geometry/Arguments": "0, 0; 1, 0; 0.2, 1; 1.2, 1 : true",
        "Geometry/Global refinements": 2,
        "Material/Law": "elastic",
        **with_roles(clamped=[1], free=[2]),
        "Time/Phases": "1: 4",
    }

    def test_oblique_to_a_moving_plane(self):
        """At the acute corner the slip is a part of the motion that the plane
        leaves free."""
        for foundation in "-0.02*t", "0.02*sin(9*t)":
            for solver in "direct", "multigrid":
                with self.subTest(foundation=foundation, solver=solver):
                    result = run(
                        "wedge",
                        {
                            **self.WEDGE,
                            **on_boundary(0, Role="contact", Friction_law="coulomb"),
                            "Boundary 0/Friction coefficient": 0.8,
                            "Boundary 0/Normal stress": "-0.01*t",
                            **on_boundary(3, Role="contact", Friction_law="none"),
                            "Boundary 3/Foundation displacement": foundation,
                            "Solver/Contact tolerance": 1e-10,
                            "Solver/Linear solver": solver,
                        },
                        text="",
                    )
                    self.check_identities(result, 1e-10, balance=1e-7)
                    self.assertGreater(result["slip_area"].max(), 0)

    def test_estimate_of_what_is_exact(self):
        """Pressed into a corner, and into a groove beside a plane of symmetry:
        uniform stresses, which leave nothing to be estimated."""
        corner = {
            "Material/Law": "elastic",
            **{
                f"Boundary {id}/{name}": value
                for id in (0, 2)
                for name, value in (
                    ("Role", "contact"),
                    ("Contact law", "unilateral"),
                    ("Friction law", "none"),
                )
            },
            **on_boundary(1, Role="traction", Pressure="0.02*t"),
            **on_boundary(3, Role="traction", Pressure="0.01*t"),
            "Time/Phases": "1: 2",
        }
        groove = {
            **corner,
            "Geometry/Generator": "general_cell",
            "Geometry/Arguments": "0, 0; 1, 1; 0, 2; 1, 2 : true",
            "Geometry/Global refinements": 2,
            "Boundary 0/Role": "symmetry",
            "Boundary 1/Pressure": "0.02*t",
            "Boundary 3/Pressure": "0.02*t",
        }
        for name in "Contact law", "Friction law":
            groove.pop(f"Boundary 0/{name}")
        for scene in corner, groove:
            result = run("exact", scene, text="")
            self.assertLess(
                result["estimate_space"][-1], 1e-9 * result["energy_norm"][-1]
            )

    def test_fixed_point_at_an_edge(self):
        """It cannot begin with stick where the foundation of the other piece
        moves along."""
        entries = {
            "Dimension": 3,
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "2, 2, 3 : 0, 0, 0 : 2, 1, 0.5 : true",
            "Material/Law": "elastic",
            "Material/Poisson's ratio": 0,
            **on_boundary(0, Role="contact", Contact_law="unilateral"),
            **on_boundary(0, Friction_law="coulomb", Friction_coefficient=0.3),
            **{f"Boundary {id}/Role": "free" for id in (1, 2, 3)},
            **on_boundary(4, Role="contact", Contact_law="unilateral"),
            **on_boundary(4, Friction_law="tresca", Friction_bound=2e-5),
            "Boundary 4/Foundation displacement": "-2e-4*t",
            **on_boundary(5, Role="displacement", Displacement="4e-5*t; 1e-4*t; -2e-4*t"),
            "Solver/Coulomb pressure": "fixed point",
            "Solver/Contact tolerance": 1e-9,
            "Time/Phases": "1: 3",
        }
        result = run("edge", entries, text="")
        self.check_identities(result, 1e-9, balance=1e-6)
        self.assertLess(result["contact_force_z"][-1], 0)

    def test_pushed_along_a_piece_that_holds(self):
        """The foundation below lifts the corner, however much the wall resists:
        the force there is that of the wall's friction at its node."""
        bound, push = 500.0, 1e-4
        for dim in 2, 3:
            with self.subTest(dim=dim):
                n = 4
                sides = ", ".join(["1"] * dim)
                below, top = 2 * dim - 2, 2 * dim - 1
                entries = {
                    "Dimension": dim,
                    "Geometry/Generator": "subdivided_hyper_rectangle",
                    "Geometry/Arguments": f"{', '.join([str(n)] * dim)} : "
                    f"{', '.join(['0'] * dim)} : {sides} : true",
                    "Material/Law": "elastic",
                    **on_boundary(0, Role="contact", Friction_law="tresca"),
                    "Boundary 0/Friction bound": bound,
                    "Boundary 1/Role": "free",
                    **on_boundary(below, Role="contact", Contact_law="unilateral"),
                    **on_boundary(below, Friction_law="none", Gap=f"-{push}*t"),
                    f"Boundary {top}/Role": "free",
                    "Time/Phases": "1: 2",
                    "Solver/Contact tolerance": 1e-8,
                }
                if dim == 3:
                    entries["Boundary 2/Role"] = "symmetry"
                    entries["Boundary 3/Role"] = "symmetry"
                result = run("pushed", entries, text="")
                self.check_identities(result, 1e-8, balance=1e-6)
                resists = bound / n / 2  # of the nodes at the corner
                self.assertClose(
                    result["friction_dissipation"][-1], resists * push, relative=1e-4
                )
                force = -result[f"contact_force_{'xyz'[dim - 1]}"][-1]
                self.assertClose(force, resists, relative=1e-4)


class FixedPoint(TestCase):
    """Coulomb's law in its own step, where that is hard to find."""

    def test_friction_that_holds_what_would_press(self):
        """Without friction the foundation, which moves, presses; with the
        friction of that pressure it would not touch: bounds that just follow
        the pressure swing between both."""
        result = run(
            "swinging",
            {
                "Geometry/Generator": "subdivided_hyper_rectangle",
                "Geometry/Arguments": "18, 2 : 0, 0 : 1, 1 : true",
                **elastic_moduli("1.7*exp(-y^2)", 0.499),
                "Material/Law": "elastic",
                "Boundary 0/Role": "traction",
                "Boundary 0/Pressure": "0.004*10^(2*sin(y))*(1-exp(-5*t))",
                **with_roles(symmetry=[1], clamped=[2]),
                **on_boundary(3, Role="contact", Contact_law="unilateral"),
                **on_boundary(3, Friction_law="coulomb", Friction_coefficient=3),
                "Boundary 3/Gap": 0.0066,
                "Boundary 3/Foundation motion": "-0.47*10^(2*sin(x))*sqrt(t); 0",
                "Solver/Contact tolerance": 1e-10,
                "Solver/Coulomb pressure": "fixed point",
                "Time/Phases": "1: 3",
            },
            text="",
        )
        self.check_identities(result, 1e-8, balance=1e-6)
        self.assertGreater(result["contact_area"].max(), 0)


class AtRest(TestCase):
    """Where nothing happens, or nothing but what bilateral contact does."""

    def test_forces_beside_stresses_that_balance_each_other(self):
        """Of stresses that were there before, and of a body that nothing
        touches, resultants are rounding, or what a tolerance leaves."""
        ring = {
            "Geometry/Generator": "concentric_hyper_shells",
            "Geometry/Arguments": "0,0:0.125:0.25:2:0.0:8:true",
            "Material/Young's modulus": 7.8e14,
            **of_law("maxwell", Viscosity=1e14),
            **with_roles(clamped=[0, 1]),
            "Initial state/Stress": "0; 1e13; 0; 0",
            "Time/Phases": "1: 3",
            "Time/Scheme": "backward Euler",
        }
        lies = {
            "Geometry/Generator": "truncated_cone",
            "Geometry/Arguments": "1:0.5:1",
            "Geometry/Global refinements": 1,
            **of_law("maxwell", Viscosity=3),
            "Boundary 0/Role": "free",
            **on_boundary(1, Role="contact", Contact_law="normal compliance"),
            **on_boundary(1, Compliance=4, Friction_law="tresca"),
            "Boundary 1/Friction bound": "0.002*(1 + 0.5*sin(3*y))",
            "Boundary 2/Role": "free",
            "Initial state/Equilibrate": "true",
            "Initial state/Reset displacement": "true",
            "Initial state/Stress": "0; 0; 0.01; 0",
            "Time/Phases": "1: 3",
        }
        for name, scene in ("ring", ring), ("lies", lies):
            with self.subTest(scene=name):
                result = run(name, scene, text="")
                self.assertLess(result["force_balance_defect"].max(), 1e-6)

    BLOCK = {
        "Dimension": 3,
        "Geometry/Generator": "subdivided_hyper_rectangle",
        "Geometry/Arguments": "2, 2, 2 : 0, 0, 0 : 1, 1, 1 : true",
        **{f"Boundary {face}/Role": "free" for face in range(4)},
        **on_boundary(4, Role="contact", Contact_law="unilateral"),
        **on_boundary(4, Friction_law="coulomb", Friction_coefficient=0.3),
        "Boundary 5/Role": "clamped",
        "Time/Phases": "1: 4",
    }

    def run_block(self, changes, ranks=1):
        return run("block", {**self.BLOCK, **changes}, ranks, text="")

    def test_pushed_without_load(self):
        """By a foundation, far beside what strains: forces of rounding of the way
        are no load that the error of a step could be measured by."""
        scene = {
            "Geometry/Generator": "half_hyper_ball",
            "Geometry/Arguments": "0, 0 : 1",
            "Geometry/Global refinements": 1,
            **elastic_moduli(2.261, -0.5),
            **of_law("maxwell", Viscosity="0.005894*(1 + t)"),
            "Boundary 0/Friction law": "coulomb",
            "Boundary 0/Friction coefficient": "0.3*exp(-y^2)*abs(sin(7*t))",
            "Boundary 0/Gap": "0.007404*abs(x - 0.4) - 0.009272*sin(4*t)",
            "Boundary 0/Foundation normal": "1, -0.3",
            "Boundary 1/Friction law": "tresca",
            "Boundary 1/Friction bound": "0.009248*abs(x - 0.4)",
            "Boundary 1/Gap": "0.002976 + 0.01441*t^2",
            "Solver/Coulomb pressure": "lagged",
            "Time/Scheme": "backward Euler",
            "Time/Phases": "0.1: 2",
            "Error control/Tolerance": 0.3,
            "Step control/Smallest step": 0.005,
            "Mesh refinement/Cell budget": 200,
        }
        for side in 0, 1:
            scene[f"Boundary {side}/Role"] = "contact"
            scene[f"Boundary {side}/Contact law"] = "unilateral"
        result = run("pushed", scene, text="")
        self.assertLess(result["algebraic_error"].max(), 1.01e-5)
        self.assertNotIn("rounding leaves an error", result.stdout)

    def test_foundation_that_slides_below(self):
        """It touches without load: pressures of rounding are no bounds."""
        for pressure in "lagged", "fixed point":
            result = self.run_block(
                {
                    "Boundary 4/Foundation motion": "t; 0.1*t^2; 0",
                    "Solver/Coulomb pressure": pressure,
                }
            )
            # of a foundation that moves by 1
            self.assertLess(max(result["max_displacement"]), 1e-13)
            self.assertEqual(max(result["contact_area"]), 0.0)

    def test_foundation_that_is_not_reached(self):
        """No bound is left of the stick that a fixed point begins with, also in
        steps without change."""
        for pressure in "lagged", "fixed point":
            result = self.run_block(
                {
                    "Boundary 4/Gap": 0.1,
                    **on_boundary(0, Role="traction", Traction="0.01*min(2*t, 1); 0; 0"),
                    "Solver/Coulomb pressure": pressure,
                },
                ranks=2,
            )
            self.assertGreater(result["unchanged"][-1], 0)
            self.assertEqual(max(result["stick_area"]), 0.0)
            bound = result.fields("contact").point_data["bound"]
            self.assertEqual(abs(bound).max(), 0.0)
            self.assertIn("unilateral contact has never acted", result.stdout)

    def test_foundation_that_is_always_touched(self):
        result = self.run_block(
            {
                "Boundary 4/Friction law": "none",
                **on_boundary(5, Role="displacement", Displacement="0; 0; -0.01*(1 + t)"),
                "Initial state/Equilibrate": "true",
            }
        )
        self.assertEqual(min(result["contact_area"]), 1.0)
        self.assertIn("unilateral contact has never opened", result.stdout)

    def test_stages(self):
        """A column whose upper half is taken away, pressed to its foundation by
        its weight: as in bilateral contact."""
        contact = {
            **on_boundary(2, Role="contact", Friction_law="tresca", Friction_bound=0.3),
            "Material 1/Law": "maxwell",
            "Material 1/maxwell/Viscosity": 100,
            "Solver/Contact tolerance": 1e-11,
        }
        bilateral = run("excavated_column", contact)
        result = run(
            "excavated_column", {**contact, "Boundary 2/Contact law": "unilateral"}
        )
        for name in ("point0_x", "point0_y", "stored_energy", "friction_force_x"):
            size = abs(bilateral[name]).max()
            self.assertClose(
                result[name], bilateral[name], absolute=1e-7 * size, what=name
            )
        self.assertClose(
            result["contact_force_y"][1:], -bilateral["reaction_2_y"][1:], relative=1e-7
        )


class Refused(TestCase):
    """Sentences that say what is wrong, and what would be right."""

    PLATE = {
        "Geometry/Generator": "subdivided_hyper_rectangle",
        "Geometry/Arguments": "4, 2 : 0, 0 : 2, 1 : true",
        **with_roles(free=[0, 1]),
        **on_boundary(2, Role="contact", Contact_law="unilateral", Friction_law="none"),
        **on_boundary(3, Role="displacement", Displacement="0; -0.01*t"),
        "Time/Phases": "1: 2",
    }

    refused_scene = ("plate", PLATE, "")

    def test_laws_that_do_not_go_together(self):
        law, friction = "Boundary 2/Contact law", "Boundary 2/Friction law"
        coefficient = "Boundary 2/Friction coefficient"
        self.refused(
            {law: "bilateral", friction: "coulomb", coefficient: 1},
            "'Friction law' = coulomb needs a pressure",
        )
        self.refused({law: "given normal stress"}, "use the role traction")
        self.refused({friction: "glued"}, "what is glued cannot open")
        self.refused({friction: "coulomb"}, f"'{coefficient}' is missing")
        self.refused({law: "unilatral"}, "Contact law", "unilateral")
        self.refused(
            {friction: "coulomb", coefficient: "-0.1"},
            f"'{coefficient}' is -0.1",
            "must not be negative",
        )
        self.refused({"Boundary 3/Displacement": "free; free"}, "prescribes nothing")

    def test_lost_in_rounding(self):
        """Flat cells: the error that stays is told, and is what the same scene in
        another unit of stress differs by; flatter ones leave no digits."""
        plate = {
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "8, 2 : 0, 0 : 1, 1e-4 : true",
            "Material/Poisson's ratio": 0.3,
            **on_boundary(0, Role="contact", Contact_law="unilateral"),
            **on_boundary(0, Friction_law="none", Gap=0.0076),
            **with_roles(clamped=[1], traction=[2]),
            **on_boundary(3, Role="contact", Friction_law="coulomb"),
            "Boundary 3/Friction coefficient": 20,
            "Solver/Contact tolerance": 1e-14,
            "Time/Phases": "2: 2",
        }

        def in_unit(unit, **more):
            entries = {
                **plate,
                "Material/Young's modulus": 0.93 * unit,
                "Boundary 2/Traction": f"{0.0082 * unit}*t; 0",
                "Boundary 3/Normal stress": f"{0.009 * unit}*t",
            }
            return run("flat", {**entries, **more}, text="", check=not more)

        results = {unit: in_unit(unit) for unit in (1, 3, 7)}
        # the first step comes to rest above its tolerance, the second below
        for row in 1, 2:
            norms = [results[unit]["energy_norm"][row] / unit**0.5 for unit in results]
            spread = (max(norms) - min(norms)) / norms[0]
            for result in results.values():
                self.assertIn("rounding leaves an error of the solver", result.stdout)
                error = result["algebraic_error"][row]
                self.assertLess(error, 1e-3)
                self.assertLess(spread, 2 * error)
                self.assertLess(error, 10 * spread)

        flatter = {"Geometry/Arguments": "8, 2 : 0, 0 : 1, 5e-6 : true"}
        self.assertRefused(in_unit(1, **flatter), "rounding alone makes", "less flat")
        # which a solver that has converged does not know by itself
        converged = {**flatter, "Solver/Contact tolerance": 1e-8}
        self.assertRefused(
            in_unit(1, **converged), "Rounding alone makes 0.00957", "less flat"
        )

    def test_forces_beside_rounding(self):
        """The edge of a sheet with cells 300 000 times as wide as thick is pressed:
        what rounding leaves of the solution is no reason to take these forces
        for rounding. They were lost in two of these steps."""
        sheet = {
            "Dimension": 3,
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": "4, 6, 4 : -1, -1, 0 : 0, 1, 1e-6 : true",
            "Material/Young's modulus": 0.3288,
            "Boundary 0/Role": "displacement",
            "Boundary 0/Displacement": "0.002925*10^(2*sin(y))*0.5*(1-cos(4*pi*t)); "
            "0; -0.03889*10^(2*sin(x))*(1-exp(-5*t))",
            **on_boundary(1, Role="contact", Contact_law="unilateral"),
            **on_boundary(1, Friction_law="none", Gap="if(y < 0.5, 0, 0.001495)"),
            **{f"Boundary {b}/Role": "free" for b in (2, 3, 4)},
            **on_boundary(5, Role="contact", Contact_law="unilateral"),
            "Boundary 5/Friction law": "none",
            "Time/Phases": "0.25: 3",
        }
        result = run("sheet", sheet, text="")
        self.assertGreater(result["algebraic_error"].max(), 1e-5)
        self.assertLess(result["force_balance_defect"].max(), 2e-3)
        self.assertClose(
            result["contact_force_x"], result["reaction_0_x"], relative=2e-3
        )

    def test_slab_that_a_soft_floor_hardly_holds(self):
        """It was refused, and before that ended with forces that were rounding."""
        slab = {
            "Geometry/Arguments": "2, 1 : 0, 0 : 1, 0.154 : true",
            "Geometry/Global refinements": 1,
            "Geometry/Boundary refinements": "0: 1",
            "Geometry/Boundary ids": "if(id == 3 && x > 0.5, 7, id)",
            **elastic_moduli(0.7543, 0.4999),
            **of_law("norton", Stress_cap=0.001003),
            "Boundary 0/Role": "free",
            **on_boundary(1, Role="traction", Traction="1.903e-05*t; 0"),
            **on_boundary(2, Role="contact", Contact_law="normal compliance"),
            **on_boundary(2, Compliance="2718*(1 + x^2)", Compliance_exponent=1.5),
            **on_boundary(2, Friction_law="coulomb", Friction_coefficient="abs(x - 0.4)"),
            "Boundary 2/Gap": "0.0002983*x^2",
            "Boundary 3/Role": "free",
            **on_boundary(7, Role="traction", Traction="0; 0.000202*t"),
            "Loads/Body force": "0; -0.006558*t",
            "Time/Phases": "0.25: 5, 0.5: 8, 0.75: 4",
            "Step control/Tolerance": 0.3,
            "Step control/Event tolerance": 0.5,
        }
        for ranks in 1, 2:
            result = run("slab", slab, ranks=ranks, text="")
            weight, lift = 0.006558 * 0.154, 0.5 * 0.000202
            self.assertClose(
                result["contact_force_y"], (lift - weight) * result["t"], relative=1e-5
            )
            self.assertClose(
                result["friction_force_x"],
                1.903e-05 * 0.154 * result["t"],
                relative=3e-4,
            )

    def test_foundations(self):
        normal = "Boundary 2/Foundation normal"
        self.refused({normal: "0, 1"}, "points into the body")
        self.refused({normal: "0, 0, -1"}, "needs 2 components", "has 3")
        self.refused({normal: "0, 0"}, "is zero; give a direction")
        self.refused(
            {
                "Geometry/Generator": "hyper_ball",
                "Geometry/Arguments": "0, 0 : 1 : false",
                "Geometry/Global refinements": 2,
                "Geometry/Boundary ids": "if(y < -abs(x), 2, if(y > abs(x), 3, x > 0))",
            },
            "is not flat",
            "or the foundation a 'Foundation normal'",
        )
        self.refused(
            {"Boundary 2/Gap": "-0.01"},
            "the body is inside of the foundation of unilateral contact, by 0.01",
            "set 'Initial state/Equilibrate'",
        )

    def test_a_rim_all_around(self):
        """Its normals cancel, but some of it faces the foundation."""
        rim = {
            **self.PLATE,
            "Geometry/Generator": "hyper_shell",
            "Geometry/Arguments": "0, 0 : 0.5 : 1 : 8 : true",
            **on_boundary(0, Role="displacement", Displacement="0; -0.01*t"),
            **on_boundary(1, Role="contact", Contact_law="unilateral"),
            **on_boundary(1, Friction_law="none", Gap="y + 1", Foundation_normal="0, -1"),
        }
        for name in list(rim):
            if name.startswith(("Boundary 2", "Boundary 3")):
                del rim[name]
        result = run("rim", rim, text="")
        self.assertLess(result["contact_force_y"][-1], -1e-4)
        self.assertLess(result["contact_area"][-1], 1.0)

    def test_fields_without_unilateral_contact(self):
        self.refused(
            {
                "Boundary 2/Contact law": "bilateral",
                "Output/Points": "0, 0",
                "Output/Point fields": "gap",
            },
            "there is no `gap' where no boundary has unilateral contact",
        )


class Pairs(TestCase):
    def test_drawn(self):
        """Two bodies whose meshes do not match; each fourth scene has ties."""
        openings = 0
        for seed in range(12):
            scene = independent_pair.draw(seed)
            with self.subTest(seed, law=scene.law):
                result = run("pair", independent_pair.entries(scene), text="")
                steps = independent_pair.solve(scene)
                forces = np.array([step.force for step in steps])
                columns = {"contact_force_y": -forces[:, 1]}
                if scene.law != "none":
                    columns["friction_force_x"] = forces[:, 0]
                for name in "contact_area", "max_pressure":
                    columns[name] = [getattr(step, name) for step in steps]
                columns["strain_energy"] = [step.energy for step in steps]
                for name, expected in columns.items():
                    # measured: 7e-12
                    scale = abs(forces if "force" in name else np.array(expected)).max()
                    self.assertClose(result[name][1:], expected, absolute=1e-8 * scale)
                areas = columns["contact_area"]
                openings += min(areas) < 0.999 * max(areas)
        self.assertGreater(openings, 2)


if __name__ == "__main__":
    main()
