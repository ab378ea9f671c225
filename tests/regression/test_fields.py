# SPDX-License-Identifier: LGPL-2.1-or-later
"""The fields of `Output/Additional fields' in uniform states, whose strains,
rates and stresses follow from recursions in Python."""

import numpy as np

from harness import TestCase, main, run

ALL = (
    "total strain, irreversible strain, creep strain, creep rate, principal stresses, "
    "normal traction"
)
YOUNG, POISSON, VISCOSITY, STEP = 2.0, 0.3, 0.8, 0.25
MU = YOUNG / 2 / (1 + POISSON)
BULK = YOUNG / 3 / (1 - 2 * POISSON)
# Fields have single precision.
SINGLE = 2e-7


def dev(tensor):
    return tensor - np.trace(tensor) / 3 * np.eye(3)


def hooke(strain):
    return 2 * MU * dev(strain) + BULK * np.trace(strain) * np.eye(3)


def compliance(stress):
    return dev(stress) / (2 * MU) + np.trace(stress) / (9 * BULK) * np.eye(3)


def equivalent(strain):
    """sqrt(2/3 e:e) of the deviator: 1 for (1, -1/2, -1/2)."""
    return np.sqrt(2 / 3) * np.linalg.norm(dev(strain))


class Uniform(TestCase):
    """A body between walls that stretch it, on a frictionless foundation."""

    # Of u = t (a x, b y, c z).
    STRETCH = {2: (0.02, -0.01), 3: (0.02, -0.01, 0.03)}

    def scene(self, dim, initial=None, **more):
        axes = "xyz"[:dim]
        drive = "; ".join(f"{e}*t*{a}" for e, a in zip(self.STRETCH[dim], axes))
        scene = {
            "Dimension": dim,
            "Geometry/Generator": "subdivided_hyper_rectangle",
            "Geometry/Arguments": f"{', '.join('2' * dim)} : {', '.join('0' * dim)} : "
            f"{', '.join('1' * dim)} : true",
            "Material/Young's modulus": YOUNG,
            "Material/Poisson's ratio": POISSON,
            "Material/Law": "maxwell",
            "Material/maxwell/Viscosity": VISCOSITY,
            "Time/Phases": f"{4 * STEP}: 4",
            "Output/Additional fields": ALL,
        }
        for i in range(2 * dim):
            scene[f"Boundary {i}/Role"] = "displacement"
            scene[f"Boundary {i}/Displacement"] = drive
        del scene["Boundary 2/Displacement"]
        scene["Boundary 2/Role"] = "contact"
        scene["Boundary 2/Friction law"] = "none"
        if initial is not None:
            entries = [initial[0, 0], initial[1, 1], initial[2, 2]] + [0] * (2 * dim - 3)
            scene["Initial state/Stress"] = "; ".join(map(str, entries))
        return {**scene, **more}

    def expected(self, dim, initial):
        """[(strain, z, creep, stress)] of the initial state and each step."""
        initial = np.zeros((3, 3)) if initial is None else initial
        z, stress, states = initial.copy(), initial.copy(), []
        for n in range(5):
            if n > 0:
                z = z - STEP * MU / VISCOSITY * dev(stress)
            stretch = np.array(self.STRETCH[dim] + (0,) * (3 - dim))
            strain = np.diag(stretch * n * STEP)
            stress = hooke(strain) + z
            states.append((strain, z, compliance(initial - z), stress))
        return states

    def check(self, dim, initial=None, ranks=1, **more):
        result = run("fields", self.scene(dim, initial, **more), text="", ranks=ranks)
        components = ["xx", "yy", "zz", "xy", "xz", "yz"][: 4 if dim == 2 else 6]
        for n, (strain, z, creep, stress) in enumerate(self.expected(dim, initial)):
            body = result.fields(index=n).cell_data
            for name, tensor in ("strain", strain), ("irreversible_strain", -compliance(z)):
                for c in components:
                    value = tensor["xyz".index(c[0]), "xyz".index(c[1])]
                    self.assertClose(
                        body[f"{name}_{c}"], value, SINGLE, SINGLE, f"{name}_{c} {n}"
                    )
            rate = dev(stress) / (2 * VISCOSITY)
            for name, value in (
                ("creep_strain", equivalent(creep)), ("creep_rate", equivalent(rate))
            ):
                self.assertClose(body[name], value, SINGLE, 1e-9, f"{name} {n}")
            for i, value in enumerate(sorted(np.diag(stress), reverse=True)):
                name = f"principal_stress_{i + 1}"
                self.assertClose(body[name], value, SINGLE, SINGLE, name)
            face = result.fields("contact", index=n).point_data["normal_traction"]
            self.assertClose(face, stress[1, 1], SINGLE, SINGLE, "normal_traction")
        return result

    def test_in_two_and_three_dimensions(self):
        self.check(2)
        self.check(3, ranks=2)

    def test_from_an_initial_stress(self):
        """What the initial stress has of irreversible strain has not crept."""
        initial = np.diag([0.03, -0.05, 0.04])
        result = self.check(2, initial, ranks=3)
        first = result.fields(index=0).cell_data
        self.assertGreater(abs(first["irreversible_strain_xx"]).min(), 1e-3)
        self.assertEqual(abs(first["creep_strain"]).max(), 0)

    def test_on_unequal_cells(self):
        for ranks in 1, 2:
            self.check(
                2,
                np.diag([0.03, -0.05, 0.04]),
                ranks=ranks,
                **{
                    "Geometry/Generator": "general_cell",
                    "Geometry/Arguments": "0, 0 ; 1, 0 ; -0.1, 0.7 ; 1.2, 1.1 : true",
                    "Geometry/Global refinements": 2,
                    "Material/Stress history": "quadrature points",
                },
            )

    def test_elastic(self):
        """Nothing creeps, and nothing is irreversible."""
        result = run("fields", self.scene(2, **{"Material/Law": "elastic"}), text="")
        body = result.fields().cell_data
        for name in "creep_strain", "creep_rate", "irreversible_strain_xx":
            self.assertEqual(abs(body[name]).max(), 0, name)

    def test_only_what_is_asked_for(self):
        def names(fields):
            scene = self.scene(2, **{"Output/Additional fields": fields})
            scene["Time/Phases"] = "1: 4"
            result = run("fields", scene, text="")
            body, face = result.fields(), result.fields("contact")
            return {*body.cell_data, *body.point_data, *face.point_data}

        plain = names("")
        self.assertEqual(names("creep rate") - plain, {"creep_rate"})
        self.assertEqual(
            names("normal traction, creep strain") - plain,
            {"normal_traction", "creep_strain"},
        )
        self.assertNotIn("strain_xx", plain)


class FrictionWork(TestCase):
    """Its integral is the dissipation, also on meshes that are refined."""

    def test_integral(self):
        for ranks in 1, 2:
            result = run(
                "slab_adaptive",
                {
                    "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
                    "Time/Phases": "1: 6, 2: 6",
                    "Mesh refinement/Coarsening fraction": 0,
                    "Output/Fields every": 3,
                    "Output/Additional fields": "friction work",
                },
                ranks=ranks,
            )
            self.assertGreater(result["cells"][-1], result["cells"][0])
            largest = 0.0
            for i, (time, _) in enumerate(result.series("contact")):
                face = result.fields("contact", index=i)
                work = face.point_data["friction_work"][face.cells]
                self.assertGreaterEqual(work.min(), 0)
                lengths = abs(np.diff(face.points[face.cells][:, :, 0], axis=1)[:, 0])
                integral = (lengths * work.mean(axis=1)).sum()
                expected = result["friction_dissipation"][result.row(time)]
                self.assertClose(integral, expected, 1e-6, 1e-12, f"t = {time}")
                largest = max(largest, integral)
            self.assertGreater(largest, 1e-3)


if __name__ == "__main__":
    main()
