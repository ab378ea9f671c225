# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the closing words say of effects: what each cost, and which never acted."""

import re

from harness import TestCase, main, run
from runs import of_law, on_boundary

SMALL = {
    "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
    "Time/Phases": "0.7: 7",
    "Output/Fields every": 0,
}


class Bill(TestCase):
    def bill(self, *arguments):
        text = run(*arguments).stdout
        lines = re.findall(r"^  (\S.*?) +(\d+\.\d+) +(\d+) %", text, re.M)
        return {name: float(seconds) for name, seconds, _ in lines}

    def test_lines_are_those_of_the_scene(self):
        bare = self.bill("elastic_frictionless")
        self.assertIn("elasticity", bare)
        absent = {"friction", "viscosity", "backward Euler", "adaptivity", "pilot run"}
        self.assertEqual(absent & set(bare), set())
        full = self.bill("slab", {**SMALL, "Time/Scheme": "backward Euler"})
        self.assertLessEqual({"friction", "viscosity", "backward Euler"}, set(full))
        self.assertClose(
            sum(full.values()) - full["whole run"], full["whole run"], absolute=0.01
        )

    def test_friction_and_elasticity_share_the_solves(self):
        """Both parts are positive, and add up to the phase of the clock."""
        for solver in "direct", "multigrid":
            result = run(
                "slab",
                {
                    "Geometry/Arguments": "32, 16 : 0, 0 : 2, 1 : true",
                    "Solver/Linear solver": solver,
                    "Output/Fields every": 0,
                },
            )
            lines = re.findall(r"^  (\S+) +(\d+\.\d+) +\d+ %", result.stdout, re.M)
            seconds = {name: float(value) for name, value in lines}
            self.assertGreater(seconds["friction"], 0)
            self.assertGreater(seconds["elasticity"], 0)
            self.assertClose(
                seconds["friction"] + seconds["elasticity"],
                result["wall_contact"].sum(),
                absolute=0.005,
            )
            self.assertRegex(result.stdout, r"with it, solves take \d+(\.\d+)? times as long")


class NeverActed(TestCase):
    def check(self, scene, overrides, present, absent=(), ranks=1):
        text = re.sub(r"\s+", " ", run(scene, overrides, ranks).stdout)
        for words in present:
            self.assertIn(words, text)
        for words in absent:
            self.assertNotIn(words, text)

    def test_what_acts_is_not_named(self):
        self.check("conveyor_2d", SMALL, (), ("never acted",))
        self.check("slab", SMALL, (), ("never acted",), ranks=2)

    def test_yield_and_hardening(self):
        self.check(
            "slab",
            {**SMALL, **of_law("perzyna", Yield_radius=10, Hardening_modulus=1)},
            (
                "viscoplastic flow has never acted",
                "'Material/perzyna/Yield radius', so that no hardening",
            ),
            ("friction has never acted",),
        )

    def test_loads(self):
        """Zero at all times by their expressions, on every rank."""
        self.check(
            "slab",
            {
                **SMALL,
                "Boundary 0/Traction": "0*t; 0",
                **on_boundary(1, Role="traction", Traction="0.1*t*x; 0"),
                "Loads/Body force": "0; t - t",
            },
            (
                "load on boundary 0 has never acted: what 'Boundary 0/Traction' gives",
                "the body force has never acted: 'Loads/Body force'",
            ),
            ("load on boundary 1",),
            ranks=2,
        )

    def test_loads_where_displacements_are_given(self):
        """The support stays."""
        self.check(
            "slab",
            {
                **SMALL,
                **on_boundary(1, Role="displacement", Displacement="free; 0"),
                **on_boundary(1, Traction="0*t; 0", Pressure="0*t"),
            },
            ("what 'Boundary 1/Traction' and 'Boundary 1/Pressure' gives",),
            ("'Role' = free",),
        )

    def test_friction_without_bound(self):
        self.check(
            "slab",
            {**SMALL, "Boundary 2/Friction bound": 0},
            ("friction has never acted: its bound has been zero",),
            ("nothing has slipped",),
        )

    def test_friction_without_slip(self):
        self.check(
            "slab",
            {**SMALL, "Boundary 2/Friction bound": 10},
            ("friction has never acted: nothing has slipped", "'Friction law' = glued"),
        )
        self.check(
            "slab",
            {**SMALL, **on_boundary(2, Friction_bound=10, Contact_law="unilateral")},
            ("friction has never acted: nothing has slipped",),
            ("glued",),
        )

    def test_contact_that_is_not_reached(self):
        """Which a mesh may be too coarse for."""
        words = "'Role' = free gives the same", "a finer one may change"
        for cells, said, unsaid in ("64, 32", *words), ("2, 1", *words[::-1]):
            self.check(
                "slab",
                {
                    **SMALL,
                    "Geometry/Arguments": f"{cells} : 0, 0 : 2, 1 : true",
                    **on_boundary(2, Contact_law="unilateral", Friction_law="none"),
                    "Boundary 2/Gap": 10,
                    "Time/Phases": "1: 1",
                },
                ("has touched the foundation", said),
                (unsaid,),
            )

    def test_foundation_at_rest(self):
        self.check(
            "conveyor_2d",
            {
                **SMALL,
                "Boundary 2/Foundation motion": "0*t; 0",
                **on_boundary(0, Role="traction", Traction="0.1*t; 0"),
            },
            ("'Boundary 2/Foundation motion' can go",),
        )

    def test_a_mesh_that_never_changes(self):
        still = {
            **SMALL,
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Maximal level": 0,
        }
        words = "adaptivity has never acted"
        self.check("slab", still, (words,))
        self.check(
            "slab_adaptive",
            {"Time/Phases": "0.2: 2", "Mesh refinement/Every n steps": 1},
            (),
            (words,),
        )


if __name__ == "__main__":
    main()
