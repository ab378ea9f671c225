# SPDX-License-Identifier: LGPL-2.1-or-later
"""A rotated and translated scene gives the rotated answer, and one in other
units the same answer.

Only rounding and the solver tolerance tell the two runs apart: the contact
tolerance is 1e-10 in the energy norm, so forces and displacements agree to
some 1e-8 of their maximum.
"""

import numpy as np

from harness import DEFECTS, EFFORT, TestCase, main, run
from runs import on_boundary, rotation

AGREE = 1e-7


def expressions(matrix, components):
    """The rotated vector of expressions, in parameter-file form."""
    return "; ".join(
        " + ".join(f"({entry:.17g})*({text})" for entry, text in zip(row, components))
        for row in matrix
    )


class Rotated(TestCase):
    def compare(self, straight, turned, matrix, skip=()):
        """All statistics; vectors are rotated first.  skip: steps in which
        a tie is decided by rounding."""
        axes = "xyz"[: len(matrix)]
        keep = np.setdiff1d(np.arange(len(straight["t"])), skip)
        ordinary = [
            name
            for name in straight.statistics
            if name not in EFFORT | DEFECTS
            and not name.startswith("wall_")
            and not name.endswith(tuple(f"_{a}" for a in axes))
        ]
        self.assertIn("strain_energy", ordinary)
        for name in ordinary:
            a, b = straight[name][keep], turned[name][keep]
            # an estimate of zero is rounding, of the size of the solution
            of = "energy_norm" if name.startswith("estimate_") else name
            scale = abs(straight[of]).max()
            self.assertClose(b, a, absolute=AGREE * scale, what=name)
        # the critical cell is a place, and one of many equal ones
        vectors = {
            name[:-2] for name in straight.statistics if name.endswith("_x")
        } - {"critical_cell"}
        self.assertIn("friction_force", vectors)
        for name in vectors:
            a, b = straight.vector(name) @ matrix.T, turned.vector(name)
            self.assertClose(
                b[keep], a[keep], absolute=AGREE * abs(a).max() + 1e-14, what=name
            )
        self.check_identities(turned)

    def test_shear_layer_2d_by_30_degrees(self):
        straight = run("shear_layer_2d")
        turned = run("shear_layer_rotated_2d")
        tie = [straight.row(0.5)]
        self.compare(straight, turned, rotation(30), tie)

    def test_shear_layer_3d_about_an_oblique_axis(self):
        straight = run("shear_layer_3d")
        turned = run("shear_layer_rotated_3d")
        tie = [straight.row(0.5)]
        self.compare(straight, turned, rotation(40, (1, 2, 3)), tie)

    def test_slab_by_117_degrees(self):
        """A moving front, so that the active set matters."""
        matrix = rotation(117)
        straight = run("slab")
        turned = run(
            "slab",
            {
                "Geometry/Rotation angle": 117,
                "Geometry/Translation": "-3, 0.7",
                "Boundary 0/Traction": expressions(matrix, ("0.3*min(t, 2 - t)", "0")),
                "Output/Points": "-3, 0.7",
            },
        )
        self.compare(straight, turned, matrix)

    def test_coulomb_block_by_30_degrees(self):
        """Given normal stress on an oblique line, which moves normally."""
        matrix = rotation(30)
        pressure = "0.1*min(t, 1)"
        tau = ("min(min(1.5/13*max(0, t-1), 0.04), max(0.04 - 1.5/13*(t-2), -0.04))")
        drive = "0.3*min(max(0, t-1), 3-t)"
        straight = run("coulomb_block_2d")
        foot = matrix @ (1, 0)
        turned = run(
            "coulomb_block_2d",
            {
                "Geometry/Rotation angle": 30,
                "Boundary 0/Traction": expressions(
                    matrix, (f"3/7*{pressure}", f"-{tau}")
                ),
                "Boundary 1/Traction": expressions(matrix, (f"-3/7*{pressure}", tau)),
                "Boundary 3/Displacement": expressions(matrix, (drive, "0")),
                "Output/Points": f"{foot[0]:.17g}, {foot[1]:.17g}",
            },
        )
        self.compare(straight, turned, matrix)

    def test_pad_about_an_oblique_axis(self):
        """Slip directions turn in an oblique contact plane."""
        matrix = rotation(65, (2, -1, 1))
        coarse = {"Geometry/Arguments": "5, 5, 5 : 0, 0, 0 : 1, 1, 1 : true"}
        straight = run("pad", coarse)
        turned = run(
            "pad",
            {
                **coarse,
                "Geometry/Rotation angle": 65,
                "Geometry/Rotation axis": "2, -1, 1",
                "Geometry/Translation": "1, 2, 3",
                "Boundary 0/Traction": expressions(
                    matrix, ("0.05*sin(pi*t/2)", "0.03*(1 - cos(pi*t))", "0")
                ),
                "Output/Points": "1, 2, 3",
            },
        )
        self.compare(straight, turned, matrix)

    def test_coulomb_in_an_edge(self):
        """Two foundations, of which one gives way, press by what comes out and hold
        the edge by the friction of both; their faces have hanging nodes. On 2 and 3
        ranks as on one, in few corrections."""
        matrix = rotation(65, (2, -1, 1))

        def edge(path, ranks=1, **more):
            foot = {
                "Role": "contact",
                "Friction law": "coulomb",
                "Friction coefficient": 0.4,
            }
            soft = {"Contact law": "normal compliance", "Compliance": 20}
            sides = {
                0: {**foot, "Contact law": "unilateral"},
                1: {"Role": "traction", "Pressure": "0.01*min(t, 1)"},
                2: {**foot, **soft, "Friction coefficient": 0.7},
                3: {"Role": "traction", "Pressure": "0.02*min(t, 1)"},
                4: {"Role": "free"},
                5: {"Role": "displacement", "Displacement": path},
            }
            scene = {
                "Dimension": 3,
                "Geometry/Generator": "subdivided_hyper_rectangle",
                "Geometry/Arguments": "3, 3, 2 : 0, 0, 0 : 1, 1, 1 : true",
                "Geometry/Boundary refinements": "0: 1",
                "Time/Phases": "1: 2, 1.5: 4",
                "Solver/Contact tolerance": 1e-10,
                "Output/Fields every": 0,
                **more,
            }
            for side, entries in sides.items():
                for name, value in entries.items():
                    scene[f"Boundary {side}/{name}"] = value
            return run("edge", scene, ranks, text="")

        path = "-0.01*min(t, 1)", "-0.015*min(t, 1)", "0.03*max(t - 1, 0)"
        straight = edge("; ".join(path))
        self.assertGreater(straight["stick_area"][-1], 0.5)
        self.assertGreater(straight["slip_area"][-1], 0.5)
        # 6, 7, 7, 7, 7, 6 whatever the processor; 14 to 22 where rounding of shared
        # forces stalls them, and with the pressures of springs shared as if they held
        # the node 10 to 11 each.
        self.assertLess(straight["contact_iterations"].max(), 10)
        turned = edge(
            expressions(matrix, path),
            3,
            **{
                "Geometry/Rotation angle": 65,
                "Geometry/Rotation axis": "2, -1, 1",
                "Geometry/Translation": "1, 2, 3",
            },
        )
        for result in straight, turned:
            result.statistics.pop("max_gap", None)  # rounding: all touches
        self.compare(straight, turned, matrix)


def friction_scene(
    dimension, stress=1.0, length=1.0, time=1.0, load=1.0, law="maxwell", ramp="t"
):
    """A block that is pushed over its foundation, in units of its own: what is
    1 elsewhere is `stress', `length' and `time' here. Loads and bounds of
    friction are `load' times as large."""
    sides = range(2 * dimension)
    foot, top = sides[-2:]
    ramp = ramp.replace("t", f"(t/{time})")
    force = load * stress
    return {
        "Dimension": dimension,
        "Geometry/Arguments": {
            2: f"16, 8 : 0, 0 : {2 * length}, {length} : true",
            3: f"3, 3, 3 : 0, 0, 0 : {length}, {length}, {length} : true",
        }[dimension],
        "Material/Young's modulus": stress,
        "Material/Law": law,
        "Material/maxwell/Viscosity": 0.5 * stress * time,
        **{f"Boundary {side}/Role": "free" for side in sides},
        "Boundary 0/Role": "traction",
        "Boundary 0/Traction": f"{0.3 * force}*{ramp}; {0.1 * force}*{ramp}^2"
        + "; 0" * (dimension - 2),
        f"Boundary {top}/Role": "clamped",
        **on_boundary(foot, Role="contact", Friction_law="tresca"),
        f"Boundary {foot}/Friction bound": 0.08 * force,
        "Time/Phases": f"{time}: 4",
        "Solver/Contact tolerance": 1e-10,
        "Output/Fields every": 0,
    }


class Units(TestCase):
    """Numbers far from 1, up to those whose squares vanish."""

    def block(self, dimension, more=None, check=True, **units):
        scene = {**friction_scene(dimension, **units), **(more or {})}
        return run("block", scene, text="", check=check)

    def compare(self, known, result, dimension, stress=1, length=1, time=1, load=1):
        force = load * stress * length ** (dimension - 1)
        energy = force * load * length
        unit = {
            "t": time,
            "stick_area": length ** (dimension - 1),
            "slip_area": length ** (dimension - 1),
            "friction_force_x": force,
            f"reaction_{2 * dimension - 1}_x": force,
            "max_utilisation": 1,
            "stored_energy": energy,
            "external_work": energy,
            "friction_dissipation": energy,
            "max_displacement": load * length,
            "max_von_mises": load * stress,
            "stress_norm": load * stress * length ** (dimension / 2),
            "estimate_total": np.sqrt(energy),
        }
        unit = {name: unit[name] for name in unit if name in known.statistics}
        for name, size in unit.items():
            self.assertClose(
                result[name] / size,
                known[name],
                absolute=AGREE * abs(known[name]).max(),
                what=name,
            )
        self.check_identities(result)

    def test_stress_length_and_time(self):
        known = {dimension: self.block(dimension) for dimension in (2, 3)}
        self.assertGreater(known[2]["slip_area"][-1], 0)
        self.assertGreater(known[3]["slip_area"][-1], 0)
        for dimension, solver, units in (
            (2, "direct", (1e-60, 1e-9, 1e-9)),
            (2, "multigrid", (1e60, 1e-9, 1e9)),
            (3, "multigrid", (1e-60, 1e6, 1e9)),
            (3, "direct", (1e60, 1e6, 1e-9)),
        ):
            with self.subTest(f"{dimension}D, {solver}, {units}"):
                units = dict(zip(("stress", "length", "time"), units))
                more = {"Solver/Linear solver": solver}
                result = self.block(dimension, more, **units)
                self.compare(known[dimension], result, dimension, **units)

    def test_multigrid_without_friction(self):
        """Where nothing but the preconditioner says how large an error is."""
        more = {
            "Solver/Linear solver": "multigrid",
            **on_boundary(2, Friction_law="none", Friction_bound=""),
        }
        known = self.block(2, more)
        for stress in 1e-60, 1e-30, 1e60:
            with self.subTest(stress):
                result = self.block(2, more, stress=stress)
                self.compare(known, result, 2, stress=stress)

    def test_loads(self):
        """Where energies are no longer numbers, the run is refused, at the ends
        of the range as well as far beyond."""
        known = self.block(2)
        for load in 1e-110, 1e110:
            with self.subTest(load):
                self.compare(known, self.block(2, load=load), 2, load=load)
        for solver, load in (
            ("direct", 1e-125),
            ("multigrid", 1e-157),
            ("direct", 1e-170),
            ("multigrid", 1e-300),
            ("direct", 1e125),
            ("multigrid", 1e157),
        ):
            with self.subTest(f"{solver}, {load}"):
                more = {"Solver/Linear solver": solver}
                result = self.block(2, more, check=False, load=load)
                self.assertEqual(result.returncode, 1)
                self.assertRegex(result.stderr, "must lie between .*other units")

    def test_ramps_that_begin_with_almost_nothing(self):
        """Their first steps are solved, whatever squares of them are: in
        proportion they are those of other runs."""
        elastic = {"law": "elastic"}
        for solver in "direct", "multigrid":
            with self.subTest(solver):
                more = {"Solver/Linear solver": solver, "Time/Phases": "1e-20: 1, 1: 3"}
                ramp = self.block(2, more, ramp="t^8", **elastic)
                known = self.block(2, more, ramp="t", load=1e20, **elastic)
                for name in "reaction_3_x", "max_displacement", "max_von_mises":
                    self.assertClose(ramp[name][1], 1e-160 * known[name][1], 1e-7)
                self.assertGreater(ramp["slip_area"][-1], 0)
                self.check_identities(ramp)

    def test_bounds_that_are_almost_nothing(self):
        """On a part of the face, beside ordinary ones."""
        for dimension, foot in (2, 2), (3, 4):
            with self.subTest(f"{dimension}D"):
                name = f"Boundary {foot}/Friction bound"
                for_bound = [
                    self.block(dimension, {name: f"if(x < 0.5, {bound}, 0.08)"})
                    for bound in ("1e-300", "0")
                ]
                self.compare(for_bound[1], for_bound[0], dimension)


if __name__ == "__main__":
    main()
