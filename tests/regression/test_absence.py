# SPDX-License-Identifier: LGPL-2.1-or-later
"""An effect that a scene does not have leaves no trace."""

import numpy as np

from harness import TestCase, main, run

FRICTION = {
    "contact_iterations",
    "duality_gap",
    "algebraic_error",
    "stick_area",
    "slip_area",
    "friction_force_x",
    "max_utilisation",
    "max_stick_slip",
    "max_slip",
    "slip_misalignment",
    "friction_dissipation",
}


class ElasticFrictionless(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.result = run("elastic_frictionless", {"Solver/Linear solver": "direct"})

    def test_uniform_solution(self):
        result = self.result
        lame, mu = 0.3 / 1.3 / 0.4, 1 / 2.6
        load = np.minimum(result["t"], 1)
        strain = (0.1 + 0.02 * lame) / (lame + 2 * mu) * load
        self.assertClose(result["point0_x"], 2 * strain, absolute=1e-10)
        self.assertClose(result["point0_y"], 0.02 * load, absolute=1e-10)
        self.check_identities(result)

    def test_one_linear_solve_per_changed_load(self):
        """Four steps with a growing load, four with a load at rest."""
        iterations = self.result["linear_iterations"][1:]
        self.assertClose(iterations, (1, 1, 1, 1, 0, 0, 0, 0))

    def test_one_linear_solve_per_changed_displacement(self):
        """The same where only a moving boundary loads the body."""
        result = run(
            "half_clamped_block",
            {
                "Boundary 2/Friction law": "none",
                "Boundary 3/Displacement": "0; -0.1*min(t, 1)",
                "Time/Phases": "1: 2, 2: 2",
                "Solver/Linear solver": "direct",
            },
        )
        self.assertClose(result["linear_iterations"][1:], (1, 1, 0, 0))

    def test_no_traces_of_friction_viscosity_adaptivity(self):
        columns = set(self.result.statistics)
        self.assertEqual(columns & FRICTION, set())
        self.assertEqual(columns & {"viscous_dissipation", "estimator"}, set())
        self.assertIn("reaction_2_y", columns)
        fields = self.result.fields()
        names = set(fields.cell_data)
        self.assertFalse([n for n in names if n.startswith("irreversible")])
        self.assertNotIn("estimator", names)

    def test_without_contact_no_contact_series(self):
        """The foundation at rest replaced by a symmetry plane."""
        result = run("elastic_frictionless", {"Boundary 2/Role": "symmetry"})
        self.assertFalse((result.directory / "contact.pvd").exists())
        self.assertFalse(list(result.directory.glob("contact_*")))


class Effects(TestCase):
    """The run begins by naming its effects, and records them."""

    def check(self, scene, present, absent, **more):
        result = run(scene, more)
        recorded = " ".join(result.info["effects"]).lower()
        head = result.stdout[:2000].lower()
        for where, text in ("run.json", recorded), ("the beginning", head):
            for word in present:
                self.assertIn(word, text, f"{scene}: {where}")
        for word in absent:
            self.assertNotIn(word, recorded, f"{scene}: run.json")

    def test_elastic_frictionless(self):
        self.check("elastic_frictionless", (), ("maxwell", "tresca", "coulomb"))

    def test_viscous_tresca(self):
        self.check(
            "slab",
            ("maxwell", "tresca"),
            ("coulomb", "perzyna", "refine", "adaptive"),
            **{"Time/Phases": "0.1: 1"},
        )

    def test_elastic_coulomb(self):
        self.check("coulomb_block_2d", ("coulomb",), ("maxwell", "perzyna", "tresca"))

    def test_perzyna_without_contact(self):
        self.check(
            "perzyna_compression_2d",
            ("perzyna",),
            ("tresca", "coulomb"),
            **{"Time/Phases": "0.1: 1"},
        )

    def test_columns_follow_the_effects(self):
        viscous = run("perzyna_compression_2d", {"Time/Phases": "0.1: 1"})
        self.assertEqual(set(viscous.statistics) & FRICTION, set())
        self.assertIn("viscous_dissipation", viscous.statistics)
        elastic = run("coulomb_block_2d", {"Time/Phases": "0.1: 1"})
        self.assertLessEqual(FRICTION, set(elastic.statistics))
        self.assertNotIn("viscous_dissipation", elastic.statistics)


if __name__ == "__main__":
    main()
