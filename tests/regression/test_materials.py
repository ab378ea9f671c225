# SPDX-License-Identifier: LGPL-2.1-or-later
"""Materials: each law against its recursion, layers, anisotropy.

The recursions are written here from the formulas of doc/parameters.md and
doc/method.md, with full 3x3 tensors, and share nothing with the program.
"""

import re
import numpy as np

from harness import TestCase, main, run
from runs import of_law
from laws import (
    E,
    E_INVERSE,
    IDENTITY,
    LAWS,
    SOFT,
    THREE,
    dev,
    displacement_gradient,
    elastic_in_pressure,
    norm,
)


class UniformStrain(TestCase):
    def expected(self, law, times, dim, initial):
        """Strain and stress at each time."""
        strains = []
        for t in times:
            gradient = displacement_gradient(t, dim)
            strains.append(0.5 * (gradient + gradient.T))
        z = np.array(initial, float)
        stresses = [E(strains[0]) + z]
        for n in range(1, len(times)):
            z = z + (times[n] - times[n - 1]) * law(
                stresses[-1], strains[n - 1], None, times[n - 1]
            )
            stresses.append(E(strains[n]) + z)
        return np.array(strains), np.array(stresses)

    def check(self, name, dim, law=None, initial=np.zeros((3, 3)), **more):
        """law, if given, is what `more` makes of the law of that name."""
        overrides = {"Material/Law": name, **(THREE if dim == 3 else {})}
        for entry, value in LAWS[name][1].items():
            overrides[f"Material/{name}/{entry}"] = value
        result = run("uniform_strain", {**overrides, **more})
        strain, stress = self.expected(law or LAWS[name][0], result["t"], dim, initial)
        scale = np.abs(stress).max()
        self.assertClose(
            result["stress_norm"],
            [norm(s) for s in stress],
            absolute=1e-10 * scale,
            what=f"{name}: norm of the stress",
        )
        self.assertClose(
            result["max_von_mises"],
            [np.sqrt(1.5) * norm(dev(s)) for s in stress],
            absolute=1e-10 * scale,
            what=f"{name}: von Mises stress",
        )
        fields = result.fields()
        for i, j in ((0, 0), (1, 1), (2, 2), (0, 1)):
            component = "stress_" + "xyz"[i] + "xyz"[j]
            self.assertClose(  # single precision
                fields.cell_data[component],
                stress[-1][i, j],
                absolute=1e-6 * scale,
                what=f"{name}: {component}",
            )
        # The law mattered.
        elastic = np.array([E(e) + initial for e in strain])
        self.assertGreater(np.abs(stress - elastic).max(), 0.1 * scale)
        # Work of the stress = stored energy + dissipation, exactly.
        work = np.zeros(len(stress))
        for n in range(1, len(stress)):
            work[n] = work[n - 1] + np.sum(
                0.5 * (stress[n] + stress[n - 1]) * (strain[n] - strain[n - 1])
            )
        self.assertClose(
            result["external_work"],
            work,
            absolute=1e-10 * np.abs(work).max(),
            what="work",
        )
        self.assertClose(
            result["energy_balance_defect"],
            0,
            absolute=1e-10 * np.abs(work).max(),
            what="balance of energy",
        )
        # Not monotone step by step: the explicit rate is that of the old
        # stress, which the step may turn. What an initial stress does has
        # either sign.
        if not np.any(initial):
            self.assertGreater(result["viscous_dissipation"][-1], 0.1 * work.max())
        return result, strain, stress

    def test_each_law_in_plane_strain(self):
        for name in LAWS:
            with self.subTest(name):
                self.check(name, 2)

    def test_each_law_in_three_dimensions(self):
        for name in LAWS:
            with self.subTest(name):
                self.check(name, 3)

    def test_each_law_at_the_quadrature_points(self):
        for name in LAWS:
            with self.subTest(name):
                self.check(name, 2, **{"Material/Stress history": "quadrature points"})

    def test_no_unknown(self):
        """A single cell: every displacement is prescribed, and nothing is left to
        solve for, whatever the solver."""
        for solver in "direct", "multigrid":
            for scheme in "forward Euler", "backward Euler":
                more = {
                    "Geometry/Arguments": "1, 1 : 0, 0 : 1, 1 : false",
                    "Solver/Linear solver": solver,
                    "Time/Scheme": scheme,
                }
                with self.subTest(**{"solver": solver, "scheme": scheme}):
                    if scheme == "forward Euler":
                        self.check("maxwell", 2, **more)
                    else:
                        run("uniform_strain", {"Material/Law": "maxwell", **more})

    def test_zener_stores_energy_in_both_branches(self):
        """1/2 E_inf eps:eps + 1/2 (E - E_inf)^-1 q:q with
        q = sigma - E_inf eps."""
        result, strain, stress = self.check("zener", 2)
        mu = 1 / 2.5 - 0.4 / 2.4
        bulk = 1 / 1.5 - 0.4 / 1.8
        stored = []
        for e, s in zip(strain, stress):
            q = s - SOFT(e)
            over = dev(q) / (2 * mu) + np.trace(q) / (9 * bulk) * IDENTITY
            stored.append(0.5 * np.sum(SOFT(e) * e) + 0.5 * np.sum(over * q))
        self.assertClose(result["stored_energy"], stored, absolute=1e-12)

    def test_zener_with_initial_stress(self):
        """In modes that do not relax elastically it decays all the same, with
        the energy that it has in other laws."""
        more = {
            "Material/zener/Long-term Young's modulus": "6/11",
            "Material/zener/Long-term Poisson's ratio": "4/11",
        }
        # In equilibrium with no loads but for rounding, which is all that the
        # residual is compared with.
        more["Initial state/Equilibrate"] = "true"
        pressure = -0.1 * IDENTITY
        result, strain, stress = self.check(
            "zener",
            2,
            elastic_in_pressure,
            pressure,
            **more,
            **{"Initial state/Stress": "-0.1; -0.1; -0.1; 0"},
        )
        mu = 1 / 2.5 / 2  # of each spring
        stored = []
        for e, s in zip(strain, stress):
            q = dev(s - 2 * mu * e)
            stored.append(
                mu * norm(dev(e)) ** 2
                + norm(q) ** 2 / (4 * mu)
                + 0.5 * (np.trace(s) / 3) ** 2 * 1.5
            )
        self.assertClose(result["stored_energy"], stored, absolute=1e-12)

        # No mode relaxes, and the stress has shear.
        more["Material/zener/Long-term Young's modulus"] = 1
        more["Material/zener/Long-term Poisson's ratio"] = 0.25
        initial = np.array([[0.05, 0.02, 0], [0.02, -0.1, 0], [0, 0, 0.01]])
        result, strain, stress = self.check(
            "zener",
            2,
            lambda stress, strain, x, t: -(stress - E(strain)) / 0.7,
            initial,
            **more,
            **{"Initial state/Stress": "0.05; -0.1; 0.01; 0.02"},
        )
        self.assertClose(
            result["stored_energy"],
            [0.5 * np.sum(E_INVERSE(s) * s) for s in stress],
            absolute=1e-12,
        )

    def test_norton_says_where_its_cap_is_reached(self):
        result, _, stress = self.check("norton", 2)
        beyond = [np.sqrt(1.5) * norm(dev(s)) > 0.03 for s in stress]
        # the rate of a step is that of its beginning
        self.assertClose(result["capped_volume"][1:], np.array(beyond[:-1], float))
        self.assertTrue(any(beyond) and not all(beyond))
        self.assertIn("0.03", result.stdout)
        uncapped = run(
            "uniform_strain",
            {**of_law("norton", Rate_factor=1, Exponent=3, Stress_cap=10)},
        )
        self.assertClose(uncapped["capped_volume"], 0)


class Layers(TestCase):
    def foot(self, result, viscosity, mu_upper=1 / 2.4, rows=4):
        """u_x(0): shear strains of the rows of cells, half of them elastic."""
        t = result["t"]
        tau = 0.1 * np.minimum(t, 2 - t)
        h = 1 / (2 * rows)
        lower = 0.5 * tau / (2 / 2.6)
        upper = np.zeros(len(t))
        for row in range(rows):
            y = 0.5 + (row + 0.5) * h
            creep = 0.0
            for n in range(len(t)):
                if n > 0:
                    creep += (t[n] - t[n - 1]) * tau[n - 1] / viscosity(y, t[n - 1])
                upper[n] += h * (tau[n] / mu_upper + creep)
        return -(lower + upper), -upper

    def check(self, viscosity=lambda y, t: 0.5, ranks=1, **more):
        result = run("layers", more, ranks=ranks)
        bottom, middle = self.foot(result, viscosity)
        self.assertClose(result["point0_x"], bottom, absolute=1e-9, what="foot")
        self.assertClose(result["point1_x"], middle, absolute=1e-9, what="interface")
        self.assertClose(result["max_von_mises"],
                         np.sqrt(3) * 0.1 * np.minimum(result["t"], 2 - result["t"]),
                         absolute=1e-9)
        return result

    def test_elastic_and_viscous(self):
        result = self.check()
        self.assertIn("viscoplastic flow of Material 2 (maxwell", result.stdout)
        self.assertNotIn("flow of Material 1", result.stdout)

    def test_viscosity_that_depends_on_position(self):
        self.check(
            lambda y, t: 0.5 * (1 + y),
            **{"Material 2/maxwell/Viscosity": "0.5*(1 + y)"},
        )

    def test_viscosity_that_depends_on_time(self):
        self.check(
            lambda y, t: 0.5 / (1 + t),
            **{"Material 2/maxwell/Viscosity": "0.5/(1 + t)"},
        )

    def test_viscosity_that_depends_on_both(self):
        self.check(
            lambda y, t: 0.5 * (1 + y) / (1 + t),
            **{"Material 2/maxwell/Viscosity": "0.5*(1 + y)/(1 + t)"},
        )

    def test_on_two_ranks(self):
        self.check(ranks=2)

    def test_on_an_adaptive_mesh_at_the_quadrature_points(self):
        """Refined cells keep their material. The shear strain of rows is
        exact whatever the mesh, if the viscosity is uniform."""
        result = self.check(
            **{
                "Mesh refinement/Strategy": "kelly",
                "Mesh refinement/Every n steps": 3,
                "Mesh refinement/Maximal level": 2,
                "Material/Stress history": "quadrature points",
            }
        )
        self.assertGreater(result["cells"][-1], result["cells"][0])

    def test_voigt_matrix_of_an_isotropic_body(self):
        """E = 2, nu = 0.3 as a matrix."""
        lam, mu = 2 * 0.3 / 1.3 / 0.4, 2 / 2.6
        rows = [
            [lam + 2 * mu * (i == j) if i < 3 and j < 3 else mu * (i == j)
             for j in range(6)]
            for i in range(6)
        ]
        matrix = "; ".join(", ".join(f"{v:.17g}" for v in row) for row in rows)
        result = self.check(
            **{
                "Material 1/Voigt matrix": matrix,
                "Material 1/Young's modulus": 1,
                "Material 1/Poisson's ratio": 0.3,
            }
        )
        self.assertIn("anisotropic elasticity of Material 1", result.stdout)


class ManyMaterials(TestCase):
    """Simple shear of a row of 300 cells, each of a material of its own; the
    first one creeps, and no other, such as that with the id 256."""

    def test_only_the_first_creeps(self):
        text = """
            set Dimension = 2
            subsection Geometry
              set Generator    = subdivided_hyper_rectangle
              set Arguments    = 300, 1 : 0, 0 : 300, 1 : true
              set Material ids = floor(x)
            end
            subsection Boundary 0
              set Role = clamped
            end
            subsection Boundary 1
              set Role     = traction
              set Traction = 0; 0.001*t
            end
            subsection Boundary 2
              set Role     = traction
              set Traction = -0.001*t; 0
            end
            subsection Boundary 3
              set Role     = traction
              set Traction = 0.001*t; 0
            end
            subsection Time
              set Phases = 1: 4
            end
            subsection Solver
              set Contact tolerance = 1e-12
            end
            subsection Output
              set Points = 1, 0; 256, 0; 257, 0
            end
            subsection Material 0
              set Law = maxwell
              subsection maxwell
                set Viscosity = 0.5
              end
            end
            """
        for material in range(1, 300):
            text += f"""
            subsection Material {material}
              set Young's modulus = 1
            end
            """
        result = run("row", text=text)
        t = result["t"]
        elastic = 0.001 * t * 2.6
        creep = 0.25 * np.cumsum(np.append(0, 0.001 * t[:-1])) / 0.5
        first = result["point0_y"]
        late = result["point2_y"] - result["point1_y"]
        self.assertGreater(creep[-1], 0.2 * elastic[-1])
        self.assertClose(first, elastic + creep, absolute=1e-9, what="first")
        self.assertClose(late, elastic, absolute=1e-9, what="with the id 256")


class Refused(TestCase):
    """Each wrong datum of a material gives one sentence, and no results."""

    refused_scene = ("uniform_strain", {}, None)

    def refused(self, *arguments, **options):
        process = super().refused(*arguments, **options)
        self.assertFalse(process.directory.exists(), "results were written")

    def test_long_term_modulus_beyond_the_elastic_one(self):
        self.refused(
            {"Material/Law": "zener",
             "Material/zener/Long-term Young's modulus": 1.2},
            re.compile(
                r"'Material/zener/Long-term Young's modulus' = 1\.2 with Poisson's ratio "
                r"0\.3 makes the body stiffer in the long term than at once, at x = "
                r".*: Young's modulus is 1; it must not be below the long-term one"
            ),
        )

    def test_long_term_modulus_beyond_the_elastic_one_somewhere(self):
        """Where E falls below it, at x > 1/2."""
        self.refused(
            {"Material/Law": "zener",
             "Material/Young's modulus": "1.2 - x",
             "Material/zener/Long-term Young's modulus": 0.5},
            re.compile(r"stiffer in the long term than at once, at x = \(0\.60"),
        )

    def test_long_term_modulus_beyond_the_elastic_one_at_a_quadrature_point(self):
        """E_inf > 1 for x > 0.83: not at the first point of a cell; beside a
        parameter that depends on time, too."""
        for time in ("1", "1 + t"):
            with self.subTest(time):
                self.refused(
                    {"Material/Law": "zener",
                       "Material/Stress history": "quadrature points",
                       "Material/zener/Long-term Young's modulus": "0.5 + 0.6*x",
                       "Material/zener/Long-term Poisson's ratio": 0.25,
                       "Material/zener/Relaxation time": time},
                    re.compile(r"stiffer in the long term than at once, at x = \(0\.89"),
                )

    def test_negative_viscosity(self):
        self.refused(
            {"Material/Law": "maxwell", "Material/maxwell/Viscosity": -2},
            "'Material/maxwell/Viscosity' is -2; it must be positive",
        )

    def test_viscosity_that_becomes_negative(self):
        """Named with its place and time: after t = 1 in the second column.
        The run has begun, so its results up to then are there."""
        result = run(
            "uniform_strain",
            {"Material/Law": "maxwell",
             "Material/maxwell/Viscosity": "if(x > 0.5 && t > 0.95, -1, 1)"},
            check=False,
        )
        self.assertEqual(result.returncode, 1)
        self.assertRegex(
            result.stderr,
            r"'Material/maxwell/Viscosity' is -1 at x = \(0\.60.* .*, t = 1; it must be "
            "positive",
        )

    def test_poissons_ratio_of_an_incompressible_body(self):
        self.refused(
            {"Material/Poisson's ratio": 0.5},
            re.compile(r"'Material/Poisson's ratio' is 0\.5; it must be .* smaller than 0\.5"),
        )

    def test_youngs_modulus_of_zero_somewhere(self):
        self.refused(
            {"Material/Young's modulus": "x - 0.25"},
            re.compile(r"'Material/Young's modulus' is 0 at x = \(0\.25 .*; it must be positive"),
        )

    def test_indefinite_voigt_matrix(self):
        matrix = np.diag([1.0, 1, 1, 1, 1, 1])
        matrix[0, 1] = matrix[1, 0] = 1.5
        self.refused(
            {**Anisotropy.NO_MODULI,
             "Material/Voigt matrix": Anisotropy.text(matrix)},
            re.compile("'Material/Voigt matrix'.*smallest eigenvalue.* is -0.5,"),
        )

    def test_plane_strain_with_coupling_out_of_the_plane(self):
        matrix = np.diag([1.0, 1, 1, 1, 1, 1])
        matrix[0, 4] = matrix[4, 0] = 0.2
        self.refused(
            {**Anisotropy.NO_MODULI,
             "Material/Voigt matrix": Anisotropy.text(matrix)},
            "'Material/Voigt matrix': the entry in row 1, column 5 couples "
            "deformations in the plane with shear out of it",
        )

    def test_laws_without_a_cap(self):
        for law in ("norton", "lubby2"):
            self.refused(
                {"Material/Law": law}, f"'Material/{law}/Stress cap' is not given"
            )

    def test_negative_creep_rate(self):
        self.refused(
            {"Material/Law": "parsed",
             "Material/parsed/Strain rate": "0.1 - sigma_eq - 0.2"},
            re.compile(
                r"'Material/parsed/Strain rate' is -0\.1 at sigma_eq = 0, .*it must be "
                "zero or positive"
            ),
        )

    def test_material_id_without_material(self):
        self.refused(
            {"Geometry/Material ids": "if(y < 0.5, 1, 3)"},
            "material id 3, but there is no `subsection Material 3'",
            scene="layers",
        )

    def test_elasticity_beside_numbered_materials(self):
        """A modulus that nobody would use."""
        self.refused(
            {"Material/Young's modulus": 5},
            "'Material/Young's modulus' cannot be set beside 'Material 1'",
            scene="layers",
        )

    def test_material_that_no_cell_has(self):
        """Told, not refused: expressions may leave one out; its law is not
        even made."""
        result = run(
            "layers", {"Material 7/Law": "maxwell", "Material 7/maxwell/Viscosity": -1}
        )
        self.assertRegex(result.stdout, "Warning: 'Material 7' is not used")

    def test_first_step_beyond_the_stability_limit(self):
        """2/r = 2 eta/mu = 2.5."""
        self.refused(
            {"Material/Law": "maxwell", "Time/Phases": "6: 2"},
            re.compile(r"Step 1 \(t = 3\): the time step 3 exceeds the stability limit 2/r = 2\.5 of"),
        )


class Anisotropy(TestCase):
    """Uniform strain of an orthotropic body: sigma = C eps."""

    MATRIX = np.array(
        [
            [3.0, 0.8, 0.6, 0, 0, 0],
            [0.8, 2.0, 0.5, 0, 0, 0],
            [0.6, 0.5, 1.2, 0, 0, 0],
            [0, 0, 0, 0.5, 0, 0],
            [0, 0, 0, 0, 0.7, 0],
            [0, 0, 0, 0, 0, 0.9],
        ]
    )

    # The matrix takes the place of the moduli, whose entries must then have
    # their defaults.
    NO_MODULI = {"Material/Young's modulus": 1, "Material/Poisson's ratio": 0.3}

    @classmethod
    def text(cls, matrix):
        return "; ".join(", ".join(f"{v:.17g}" for v in row) for row in matrix)

    def check(self, matrix, dim):
        result = run(
            "uniform_strain",
            {
                **(THREE if dim == 3 else {}),
                **self.NO_MODULI,
                "Material/Voigt matrix": self.text(matrix),
                "Time/Phases": "1: 2",
            },
        )
        e = displacement_gradient(1, dim)
        e = 0.5 * (e + e.T)
        engineering = np.array(
            [e[0, 0], e[1, 1], e[2, 2], 2 * e[1, 2], 2 * e[0, 2], 2 * e[0, 1]]
        )
        stress = matrix @ engineering
        fields = result.fields()
        names = ["xx", "yy", "zz"] + (["yz", "xz"] if dim == 3 else []) + ["xy"]
        places = [0, 1, 2] + ([3, 4] if dim == 3 else []) + [5]
        for name, place in zip(names, places):
            self.assertClose(
                fields.cell_data[f"stress_{name}"],
                stress[place],
                absolute=1e-6 * np.abs(stress).max(),
                what=name,
            )
        self.assertClose(
            result["stored_energy"][-1], 0.5 * stress @ engineering, relative=1e-10
        )

    def test_orthotropic_in_plane_strain(self):
        self.check(self.MATRIX, 2)

    def test_orthotropic_in_three_dimensions(self):
        self.check(self.MATRIX, 3)

    def test_monoclinic(self):
        """Shear in the plane couples to the normal stresses."""
        matrix = self.MATRIX.copy()
        matrix[0, 5] = matrix[5, 0] = 0.3
        matrix[2, 5] = matrix[5, 2] = -0.2
        self.check(matrix, 2)
        matrix[3, 4] = matrix[4, 3] = 0.1
        self.check(matrix, 3)

    def test_creep_of_an_orthotropic_body(self):
        """Maxwell with G = -E dev sigma/(2 eta)."""
        result = run(
            "uniform_strain",
            {
                **self.NO_MODULI,
                "Material/Voigt matrix": self.text(self.MATRIX),
                **of_law("maxwell", Viscosity=2),
            },
        )

        def apply(e):
            s = self.MATRIX @ np.array(
                [e[0, 0], e[1, 1], e[2, 2], 2 * e[1, 2], 2 * e[0, 2], 2 * e[0, 1]]
            )
            return np.array(
                [[s[0], s[5], s[4]], [s[5], s[1], s[3]], [s[4], s[3], s[2]]]
            )

        t = result["t"]
        z = np.zeros((3, 3))
        norms = [0.0]
        stress = np.zeros((3, 3))
        for n in range(1, len(t)):
            z = z - (t[n] - t[n - 1]) * apply(dev(stress)) / 4
            gradient = displacement_gradient(t[n], 2)
            stress = apply(0.5 * (gradient + gradient.T)) + z
            norms.append(norm(stress))
        self.assertClose(result["stress_norm"], norms, absolute=1e-10, what="stress")


if __name__ == "__main__":
    main()
