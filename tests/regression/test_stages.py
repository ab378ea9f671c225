# SPDX-License-Identifier: LGPL-2.1-or-later
"""Initial states from which displacements count, and materials that are added
or removed."""

import re
import tempfile
from pathlib import Path

import numpy as np

from harness import TestCase, as_prm, main, run, run_program, scene_file
from runs import on_boundary, with_roles

# An absent material has a stiffness of 1e-6 of its own, and with it this
# influence on the rest, relative to displacements and energies.
ABSENT = 1e-5
ROUNDING = 1e-10

ADDED = {"Material 2/Removed at": "", "Material 2/Added at": 1}
# The lower block alone.
ALONE = {
    "Geometry/Arguments": "2, 2 : 0, 0 : 1, 1 : true",
    "Geometry/Material ids": "1",
    "Material 2/Removed at": "",
}
IN_3D = {
    "Dimension": 3,
    "Geometry/Arguments": "2, 2, 4 : 0, 0, 0 : 1, 1, 2 : true",
    "Geometry/Material ids": "if(z > 1, 2, 1)",
    "Loads/Body force": "0; 0; -2",
    **with_roles(symmetry=[2], clamped=[4], free=[5]),
    "Output/Points": "1, 1, 1; 0, 0, 0.5",
}
ALONE_IN_3D = {
    **IN_3D,
    **ALONE,
    "Geometry/Arguments": "2, 2, 2 : 0, 0, 0 : 1, 1, 1 : true",
}
# Cells of several sizes in both blocks, and between them.
HANGING = {"Geometry/Boundary refinements": "0: 1"}
FRICTION = {**on_boundary(2, Role="contact", Friction_law="tresca", Friction_bound=0.3)}
CREEP = {
    "Material 1/Law": "maxwell",
    "Material 1/maxwell/Viscosity": 100,
    "Solver/Contact tolerance": 1e-12,
}


def check(overrides):
    """What --check prints."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "overrides.prm"
        file.write_text(as_prm(overrides))
        arguments = ["--check", scene_file("excavated_column"), file]
        return run_program(arguments, 1, Path(folder)).stdout


def column(overrides, ranks=1):
    return run("excavated_column", overrides, ranks)


def check_points(test, whole, alone):
    """They end at the same places."""
    for name in ("point0", "point1"):
        expected = alone.vector(name)[-1]
        test.assertClose(
            whole.vector(name)[-1],
            expected,
            absolute=ABSENT * abs(expected).max(),
            what=name,
        )


class Removed(TestCase):
    """What is left is as if it had always been alone."""

    def compare(self, whole, alone):
        check_points(self, whole, alone)
        for name in ("stored_energy", "max_von_mises", "estimate_space"):
            self.assertClose(whole[name][-1], alone[name][-1], ABSENT, what=name)
        self.assertClose(whole["load_y"][0], 2 * whole["load_y"][-1], ROUNDING)
        self.assertClose(whole["energy_balance_defect"], 0, absolute=1e-12)

    def test_in_2d(self):
        alone = column(ALONE)
        whole = column({})
        self.compare(whole, alone)
        self.assertIn("From t = 1 on without Material 2\n", whole.stdout)
        self.assertEqual(len(whole.fields(index=-1).cells), 16)
        self.assertEqual(len(whole.fields(index=0).cells), 32)
        # What goes takes its energy with it, and the rest springs back.
        energy = whole["construction_energy"]
        self.assertEqual(energy[:3].tolist(), [0, 0, 0])
        self.assertLess(energy[-1], -whole["stored_energy"][-1])

    def test_initial_stress_goes_with_the_material(self):
        stress = {"Initial state/Stress": "-0.3; -1; 0.2; 0.1"}
        self.compare(column(stress), column({**ALONE, **stress}))

    def test_creep_begins_with_the_stress_that_is_left(self):
        """The explicit step after the removal is from a body that has given way."""
        creep = {
            "Material 1/Law": "maxwell",
            "Material 1/maxwell/Viscosity": "if(t < 0.5, 1e9, 100)",
            "Time/Phases": "1: 1, 2: 1",
        }
        self.compare(column(creep), column({**ALONE, **creep}))

    def test_with_hanging_nodes_and_multigrid_on_ranks(self):
        multigrid = {**HANGING, "Solver/Linear solver": "multigrid"}
        tolerance = {"Solver/Contact tolerance": 1e-12}
        alone = column({**ALONE, **multigrid, **tolerance})
        for ranks in (1, 3):
            self.compare(column({**multigrid, **tolerance}, ranks), alone)

    def test_in_3d(self):
        alone = run("excavated_column", {**ALONE_IN_3D, **HANGING})
        whole = run("excavated_column", {**IN_3D, **HANGING}, ranks=2)
        for name in ("point0", "point1"):
            self.assertClose(
                whole.vector(name)[-1],
                alone.vector(name)[-1],
                absolute=ABSENT * abs(alone.vector(name)[-1]).max(),
                what=name,
            )
        name = "estimate_space"
        self.assertClose(whole[name][-1], alone[name][-1], ABSENT, what=name)

    def test_where_the_body_creeps_and_rubs(self):
        """Ranks agree, on meshes that change; fluid under its own weight."""
        overrides = {
            **CREEP,
            **FRICTION,
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Every n steps": 1,
        }
        reference = column(overrides)
        self.check_identities(reference, 1e-12)
        result = column(overrides, 3)
        for name in ("point0", "point1", "friction_force"):
            scale = abs(reference.vector(name)).max()
            self.assertClose(
                result.vector(name),
                reference.vector(name),
                absolute=1e-8 * scale,
                what=name,
            )


class Beside(TestCase):
    """What stages leave alone, and what they take away."""

    def test_what_held_the_removed_alone_does_not_hold_the_rest(self):
        # 7: the upper half of the right side
        held = {
            "Geometry/Boundary ids": "if(x > 0.999 && y > 1, 7, id)",
            "Boundary 7/Role": "clamped",
        }
        for ranks in (1, 2):
            whole = column({**held, **HANGING}, ranks)
            alone = column({**ALONE, **HANGING})
            check_points(self, whole, alone)
            # of a weight of 2
            self.assertClose(whole.vector("reaction_7")[-1], 0, absolute=2 * ABSENT)

    def test_a_fill_that_is_not_loaded_moves_nothing(self):
        """Nor does it change how the rest is discretized, by its nu > 0.4."""
        fill = {
            **ADDED,
            "Material/Stress history": "quadrature points",
            "Material 2/Poisson's ratio": 0.45,
            "Loads/Body force": "0; if(y > 1, 0, -2)",
        }
        result = column(fill)
        for name in ("point0", "point1"):
            u = result.vector(name)
            self.assertClose(u, u[0], absolute=1e-9, what=name)
        self.assertNotIn("Warning", result.stdout)
        result = column({**fill, "Material/Stress history": "cell means"})
        self.assertIn("some within coarse cells", result.stdout)

    def test_points_and_integrals_know_what_is_absent(self):
        overrides = {
            "Geometry/Material ids": "if(x < 0.5, 2, 1)",
            "Boundary 0/Role": "free",
            "Output/Points": "0.5, 0.6; 0.51, 0.6; 0.2, 0.6",
            "Output/Point fields": "stress",
            "Output/Integrals": (
                "body: energies; material 2: stress; boundary 0: displacement"
            ),
        }
        result = column(overrides)
        on_wall, behind, gone = (result[f"point{i}_stress_yy"] for i in range(3))
        self.assertClose(on_wall[-1], behind[-1], relative=1e-12)
        self.assertGreater(abs(on_wall[-1]), 0.1)
        self.assertTrue(np.isfinite(gone[:3]).all() and np.isnan(gone[-1]))
        for name, before, after in [
            ("volume_body", 2, 1),
            ("volume_material_2", 1, 0),
            ("area_boundary_0", 2, 0),
        ]:
            self.assertClose(result[name][[0, -1]], [before, after], absolute=1e-12)

    def test_check_says_what_materials_are(self):
        for overrides in {}, ADDED:
            units = {"Units/Length": "m", "Units/Time": "s", "Units/Stress": "MPa"}
            printed = check({**overrides, **units, "Loads/Body force": "0; -0.02"})
            self.assertRegex(printed, r"Material 1: E = 100 MPa, nu = 0.25, elastic")
            self.assertRegex(printed, r"Material 2: E = 200 MPa, nu = 0.3, elastic")
            self.assertNotRegex(printed, "inf|strain of about")
        # mu = 200/2.6: the limit is 2 eta/mu. What is there is elastic.
        creep = {"Material 2/Law": "maxwell", "Material 2/maxwell/Viscosity": 1000}
        printed = check({**ADDED, **creep})
        self.assertRegex(printed, r"it relaxes stress within .* = \S+; stability limit")
        self.assertIn("limit 2/r there, once it is added: 26\n", printed)
        self.assertNotIn("Stability limit", printed)


class Added(TestCase):
    """What comes has no stress yet; its weight moves the whole column."""

    def compare(self, extra, ranks=1, weight="0; if(y > 1, -2, 0)"):
        # At quadrature points the stress that is zero is so to rounding; a
        # material without flow would have none of its own there.
        common = {
            "Material/Stress history": "quadrature points",
            "Solver/Contact tolerance": 1e-12,
            **extra,
        }
        both = run("excavated_column", {**common, **ADDED}, ranks)
        of_weight = run(
            "excavated_column",
            {**common, "Material 2/Removed at": "", "Loads/Body force": weight},
        )
        for name in ("point0", "point1"):
            u = both.vector(name)
            expected = of_weight.vector(name)[-1]
            self.assertClose(
                u[-1] - u[0], expected, absolute=ABSENT * abs(expected).max(), what=name
            )
        self.assertClose(both["energy_balance_defect"], 0, absolute=1e-12)

    def test_in_2d(self):
        self.compare(HANGING)
        self.compare({"Solver/Linear solver": "multigrid"}, ranks=2)

    def test_in_3d(self):
        self.compare(IN_3D, weight="0; 0; if(z > 1, -2, 0)")


class Reset(TestCase):
    """Displacements that count from the initial equilibrium."""

    def test_new_meshes_are_no_displacement(self):
        result = column(
            {
                "Material 2/Removed at": "",
                "Initial state/Reset displacement": "true",
                "Mesh refinement/Strategy": "residual",
                "Mesh refinement/Every n steps": 1,
                "Solver/Contact tolerance": 1e-12,
            }
        )
        self.assertGreater(result["cells"][-1], result["cells"][0])
        self.assertLess(result["max_displacement"].max(), 1e-9)

    def compare(self, extra, ranks=1):
        common = {**extra, "Output/Additional fields": "total strain"}
        plain = run("excavated_column", common)
        common["Initial state/Reset displacement"] = "true"
        reset = run("excavated_column", common, ranks)
        for name in ("point0", "point1"):
            u = plain.vector(name)
            self.assertClose(
                reset.vector(name), u - u[0], absolute=1e-9 * abs(u).max(), what=name
            )
        self.assertEqual(reset["max_displacement"][0], 0)
        for name in ("max_von_mises", "stored_energy", "external_work"):
            self.assertClose(
                reset[name], plain[name], absolute=1e-9 * abs(plain[name]).max()
            )
        return plain, reset

    def test_in_2d(self):
        plain, reset = self.compare({**FRICTION, **CREEP, **HANGING}, ranks=2)
        self.assertIn("which counts in all displacements", plain.stdout)
        self.assertIn("displacements count from there", reset.stdout)

    def test_strains(self):
        plain, reset = self.compare({**CREEP, "Material 2/Removed at": ""})
        for index in (0, -1):
            fields, first = plain.fields(index=index), plain.fields(index=0)
            for name in ("strain_xx", "strain_yy", "strain_xy"):
                self.assertClose(
                    reset.fields(index=index).cell_data[name],
                    fields.cell_data[name] - first.cell_data[name],
                    absolute=1e-7,  # single precision
                    what=name,
                )

    def test_in_3d(self):
        self.compare(IN_3D)


class Refused(TestCase):
    refused_scene = ("excavated_column", {}, None)

    def test_what_cannot_be(self):
        for overrides, pattern in [
            # The rest hangs on what held the removed alone.
            (
                {
                    "Geometry/Boundary ids": "if(y > 1 && y < 1.999, 7, id)",
                    **with_roles(clamped=[7], free=[2, 0]),
                },
                "rigid motion free from t = 1 on",
            ),
            ({"Time/Phases": "3: 6"}, "'Material 2/Removed at' = 1 is not the end"),
            ({"Material 2/Removed at": 0}, "is not a time after the beginning"),
            ({"Material 2/Added at": 2}, "is not later than 'Added at' = 2"),
            ({"Material 1/Removed at": 1}, "leave no material from t = 1 on"),
            (
                {"Boundary 2/Role": "free", "Boundary 3/Role": "clamped"},
                "rigid motion free from t = 1 on.*translation along y",
            ),
            (
                {"Boundary 3/Role": "traction", "Boundary 3/Normal stiffness": 1},
                "Boundary 3 has springs and a part in 'Material 2'",
            ),
            (
                {
                    **ADDED,
                    "Material 2/Law": "zener",
                    "Material 2/zener/Long-term Young's modulus": 50,
                    "Material 2/zener/Long-term Poisson's ratio": 0.3,
                },
                "depends on the total strain",
            ),
            # A slice in the middle leaves two parts.
            (
                {"Geometry/Material ids": "if(abs(y - 1) < 0.5, 2, 1)"},
                "rigid motion free of one of the 2 parts of the body from t = 1 on",
            ),
        ]:
            with self.subTest(overrides):
                self.refused(overrides, re.compile(pattern))

    def test_a_reset_of_nothing(self):
        result = run(
            "excavated_column",
            {
                "Initial state/Equilibrate": "false",
                "Initial state/Reset displacement": "true",
                "Loads/Body force": "0; -2*t",
            },
        )
        self.assertIn("Reset displacement' changes nothing", result.stdout)


if __name__ == "__main__":
    main()
