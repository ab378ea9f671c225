# SPDX-License-Identifier: LGPL-2.1-or-later
"""Manufactured solutions: the orders of the theorems, for every law.

The scenes of prm/verification/manufactured give u and sigma, and the program
makes the data that they solve.  Errors are what the theorems bound: the largest
over the times t_n, of u in the energy and the H1 norm, of the stress in L2 and
of the multiplier on Gamma_3.  (5.14) and (5.20) promise first order for
solutions as smooth as these; the h^(3/4) of (5.13) is a lower bound for less
smooth ones, and shows nowhere.

The measured orders are printed: run the file by itself to see them.
"""

import re
import sys

import numpy as np

from harness import SOURCE, TestCase, main, run

LAWS = ("maxwell", "zener", "perzyna", "perzyna_hardening", "norton", "parsed")
NORMS = ("energy", "h1", "stress", "multiplier")
MANUFACTURED = SOURCE / "prm" / "verification" / "manufactured"


def as_ring(text):
    """The same solution in the section of a ring, 1 < r < 2: other data."""
    text = re.sub(r"#.*", "", text)
    text = re.sub(r"\bx\b", "(x-1)", text)
    text = text.replace("4, 4 : 0, 0 : 1, 1", "4, 4 : 1, 0 : 2, 1")
    return text.replace(
        "subsection Geometry", "subsection Geometry\nset Plane model = axisymmetric"
    )


def errors(scene, law, level, n_steps, overrides=None, ranks=1, change=str):
    """Largest errors over the run, relative to the largest norms."""
    text = change((MANUFACTURED / f"{scene}.prm").read_text())
    if law != "maxwell":  # which the scenes have themselves
        text = text.replace("set Law             = maxwell", "")
        text += (MANUFACTURED / f"law_{law}.prm").read_text()
    overrides = {
        "Geometry/Global refinements": level,
        "Time/Phases": f"1: {n_steps}",
        "Output/Fields every": 0,
        # A quarter of the run; test_error_bar.py compares it with these errors.
        "Error control/Error bar": "false",
        **(overrides or {}),
    }
    result = run(scene, overrides, text=text, ranks=ranks)
    return {
        norm: result[f"error_{norm}"].max() / result[f"exact_{norm}"].max()
        for norm in NORMS
    }


def slipping_bodies(dim, law, level):
    """Two bodies whose tractions at y = 1 meet and of which the upper one slips where
    x > 1/2, by max(x - 1/2, 0)^3, which takes no traction with it; the friction bound
    is that of the solution there, and more elsewhere. 4 cells meet 6. In space the
    same at any z."""
    m, size = "max(x - 0.5, 0)", "0.01*t"
    upper = "if(y > 1, 1, 0)"
    third = dim == 3
    u = [
        f"{size}*(x^2*y + y^2 + {upper}*{m}^3)",
        f"{size}*(x*y^2 - 13*y - {upper}*{m}^2*(y - 1))",
        *["0"] * third,
    ]
    xx, yy, zz, xy = (
        f"{size}*(8*x*y - 13 + {upper}*8*{m}^2)",
        f"{size}*(8*x*y - 39)",
        f"{size}*(4*x*y - 13 + {upper}*2*{m}^2)",
        f"{size}*(x^2 + 2*y + y^2 - {upper}*2*{m}*(y - 1))",
    )
    force = [
        f"-{size}*(10*y + 2 + {upper}*14*{m})",
        f"-{size}*(10*x - {upper}*2*(y - 1)*if(x > 0.5, 1, 0))",
        *["0"] * third,
    ]
    cells = (4, 4), (6, 6)
    boxes = []
    for (nx, ny), y in zip(cells, (0, 1)):
        boxes.append(
            f"{nx}, {ny}{', 2' if third else ''} : 0, {y}{', 0' if third else ''} : "
            f"1, {y + 1}{', 0.5' if third else ''} : true"
        )
    result = {
        "Dimension": dim,
        "Geometry/Generator": "subdivided_hyper_rectangle | subdivided_hyper_rectangle",
        "Geometry/Arguments": " | ".join(boxes),
        "Geometry/Global refinements": level,
        "Loads/Body force": "; ".join(force),
        "Exact solution/Data": "scene",
        "Exact solution/Displacement": "; ".join(u),
        "Exact solution/Stress": "; ".join([xx, yy, zz, xy, *["0", "0"] * third]),
        "Material/Volumetric integration": "full",
        "Time/Phases": "1: 1",
        "Output/Fields every": 0,
        "Error control/Error bar": "true",
        "Solver/Contact tolerance": 1e-8,
    }
    for n in 0, 1:
        result[f"Material {n}/Young's modulus"] = 2.5
        result[f"Material {n}/Poisson's ratio"] = 0.25
    for n in 0, 20:
        for side, sign in (0, "-"), (1, ""):
            result[f"Boundary {n + side}/Role"] = "traction"
            result[f"Boundary {n + side}/Traction"] = "; ".join(
                [f"{sign}{xx}", f"{sign}{xy}", *["0"] * third]
            )
        for side in (4, 5) if third else ():
            result[f"Boundary {n + side}/Role"] = "symmetry"
    result["Boundary 2/Role"] = "clamped"
    result["Boundary 23/Role"] = "displacement"
    result["Boundary 23/Displacement"] = "; ".join(u)
    result["Boundary 3/Role"] = "free"
    more = "(1 + max(0.5 - x, 0))"
    contact = {
        "Role": "contact",
        "Against": 3,
        "Friction law": law,
        "Contact law": "bilateral" if law == "tresca" else "unilateral",
        "Friction bound": f"{size}*(x^2 + 3)*{more}",
        "Friction coefficient": f"(x^2 + 3)/(39 - 8*x)*{more}",
    }
    contact.pop("Friction coefficient" if law == "tresca" else "Friction bound")
    return {**result, **{f"Boundary 22/{name}": v for name, v in contact.items()}}


class Ladders(TestCase):
    def ladder(self, name, runs, expected, ratio=2):
        """Errors of runs of which each divides what is refined by the ratio; the
        order between the last two is more than what is expected."""
        for norm, least in expected.items():
            values = np.array([run[norm] for run in runs])
            orders = np.log(values[:-1] / values[1:]) / np.log(ratio)
            print(
                f"{name}, {norm}: errors",
                " ".join(f"{v:.2e}" for v in values),
                "orders",
                " ".join(f"{v:.2f}" for v in orders),
                file=sys.stderr,
            )
            self.assertGreater(orders[-1], least, f"{name}: order in {norm}")

    def in_space(self, name, scene, law, **more):
        """On 4^3 and 6^3 cells."""
        runs = []
        for n in 4, 6:
            cells = {"Geometry/Arguments": f"{n}, {n}, {n} : 0, 0, 0 : 1, 1, 1 : true"}
            runs.append(errors(scene, law, 0, 4 * n, {**cells, **more}))
        self.ladder(f"{scene} {law} {name}", runs, IN_SPACE, 1.5)


# The refinements of the runs that are compared; one more below them is cheap,
# but is judged by nothing.
LEVELS = (1, 2)

# First order is reached from either side: 0.9 leaves room for what is left of
# the coarse meshes.  The multiplier is a trace, for which the theory has no
# rate; 0.5 is that of a trace of an H1 function.
BOTH = {"energy": 0.9, "h1": 0.9, "stress": 0.9, "multiplier": 0.5}
# On such coarse meshes the orders still grow.
IN_SPACE = {"energy": 0.85, "h1": 0.85, "stress": 0.85, "multiplier": 0.5}


class MeshAndSteps2D(Ladders):
    """h and k halved together, all laws, both laws of friction."""

    def check(self, scene, law):
        runs = [errors(scene, law, g, 8 * 2**g) for g in LEVELS]
        self.ladder(f"{scene} {law}", runs, BOTH)

    def test_tresca(self):
        for law in (*LAWS, "elastic"):
            with self.subTest(law):
                self.check("tresca_2d", law)

    def test_coulomb(self):
        for law in (*LAWS, "elastic"):
            with self.subTest(law):
                self.check("coulomb_2d", law)


class Rings(Ladders):
    """Bodies of revolution, all laws."""

    def test_all_laws(self):
        for number, law in enumerate((*LAWS, "elastic")):
            scene = ("tresca_2d", "coulomb_2d")[number % 2]
            with self.subTest(law):
                runs = [errors(scene, law, g, 8 * 2**g, change=as_ring) for g in LEVELS]
                self.ladder(f"ring, {scene} {law}", runs, BOTH)


class MeshAndSteps3D(Ladders):
    """The front moves and the slip behind it turns."""

    def test_all_laws(self):
        for number, law in enumerate(LAWS):
            scene = ("tresca_3d", "coulomb_3d")[number % 2]
            with self.subTest(law):
                self.in_space("", scene, law)


class OneAtATime(Ladders):
    """h alone with small steps, k alone on a fine mesh."""

    def test_mesh(self):
        # Steps so small that halving h still halves the error.
        for scene in ("tresca_2d", "coulomb_2d"):
            with self.subTest(scene):
                runs = [errors(scene, "maxwell", g, 128) for g in LEVELS]
                expected = {"energy": 0.9, "h1": 0.9, "stress": 0.9}
                self.ladder(f"{scene} h", runs, expected)

    def test_steps(self):
        # The error of the mesh is what the last order lacks.
        for scene in ("tresca_2d", "coulomb_2d"):
            with self.subTest(scene):
                runs = [errors(scene, "maxwell", 4, n) for n in (6, 12)]
                self.ladder(f"{scene} k", runs, {"energy": 0.9, "h1": 0.9})


class Meshes(Ladders):
    """Distorted and locally refined meshes, hanging nodes on Gamma_3, and
    both stress histories."""

    def check(self, name, scene, overrides, expected=BOTH):
        runs = [errors(scene, "perzyna", g, 8 * 2**g, overrides) for g in LEVELS]
        self.ladder(f"{scene} {name}", runs, expected)

    def test_distorted(self):
        self.check(
            "distorted",
            "tresca_2d",
            {"Geometry/File": MANUFACTURED / "distorted_2d.msh"},
        )
        self.check(
            "distorted",
            "coulomb_3d",
            {"Geometry/File": MANUFACTURED / "distorted_3d.msh"},
            IN_SPACE,
        )

    def test_locally_refined(self):
        self.check("refined", "tresca_2d", {"Geometry/Boundary refinements": "0: 1"})
        refined = {"Geometry/Boundary refinements": "0: 1"}
        self.in_space("refined", "tresca_3d", "perzyna", **refined)

    def test_histories(self):
        for integration in ("full", "mean dilatation"):
            self.check(
                f"history at quadrature points, {integration}",
                "coulomb_2d",
                {
                    "Material/Stress history": "quadrature points",
                    "Material/Volumetric integration": integration,
                },
            )


class Ranks(Ladders):
    def test_ranks(self):
        for scene, level in (("tresca_2d", 2), ("coulomb_3d", 1)):
            alone = errors(scene, "norton", level, 20)
            together = errors(scene, "norton", level, 20, ranks=3)
            for norm in NORMS:
                # The tolerance of the scene is 1e-10.
                self.assertClose(together[norm], alone[norm], 1e-7, what=norm)


SLAB = {
    "Geometry/Arguments": "4, 2 : 0, 0 : 2, 1 : true",
    "Geometry/Global refinements": 1,
    "Time/Phases": "1: 8, 2: 8",
    "Output/Fields every": 0,
}


class ReferenceRuns(TestCase):
    """Differences to a finer run where nothing exact is known."""

    def compare(self, scene, reference, overrides, ranks=1):
        directory = reference.directory
        return run(
            scene,
            {**overrides, "Exact solution/Reference directory": directory},
            ranks=ranks,
        )

    def test_a_run_does_not_differ_from_itself(self):
        # Also on other numbers of ranks, and where the mesh has hanging nodes
        # on Gamma_3; the fields go through files in double precision.
        pad = {
            "Geometry/Arguments": "2, 2, 2 : 0, 0, 0 : 1, 1, 1 : true",
            "Geometry/Global refinements": 1,
            "Geometry/Boundary refinements": "0: 1",
            "Time/Phases": "1: 4, 1.5: 2",
            "Output/Fields every": 0,
        }
        for scene, overrides in (("slab", SLAB), ("pad", pad)):
            for ranks in (1, 2):
                fields = {**overrides, "Output/Reference fields": "true"}
                reference = run(scene, fields, ranks=3 - ranks)
                result = self.compare(scene, reference, overrides, ranks)
                ends = np.flatnonzero(~np.isnan(result["error_energy"]))
                self.assertEqual(len(ends), 2, "an error at each end of a phase")
                for norm in NORMS:
                    # The contact tolerance of both scenes is 1e-10.
                    error = result[f"error_{norm}"][ends]
                    exact = result[f"exact_{norm}"][ends]
                    self.assertGreater(exact.min(), 0)
                    self.assertLess((error / exact).max(), 1e-7, norm)

    def test_differences_fall_like_errors(self):
        fine = {
            **SLAB,
            "Geometry/Global refinements": 5,
            "Time/Phases": "1: 64, 2: 64",
            "Output/Reference fields": "true",
        }
        reference = run("slab", fine)
        errors = []
        for level in (1, 2, 3):
            result = self.compare(
                "slab",
                reference,
                {
                    **SLAB,
                    "Geometry/Global refinements": level,
                    "Time/Phases": f"1: {4 * 2**level}, 2: {4 * 2**level}",
                },
            )
            errors.append(np.nanmax(result["error_energy"]))
        orders = np.log2(np.divide(errors[:-1], errors[1:]))
        # Tangential stress is singular where clamped and free sides meet.
        self.assertGreater(orders.min(), 0.6)
        self.assertLess(orders.max(), 1.2)


class Refused(TestCase):
    def refused(self, scene, overrides, *words):
        file = MANUFACTURED / f"{scene}.prm"
        text = file.read_text() if file.exists() else None
        self.assertRefused(run(scene, overrides, text=text, check=False), *words)

    def test_what_follows_must_not_be_given(self):
        for path in ("Boundary 0/Traction", "Loads/Body force"):
            self.refused("tresca_2d", {path: "1; 0"}, path, "Exact solution/Data")
        self.refused("coulomb_2d", {"Boundary 2/Normal stress": -1}, "Normal stress")
        self.refused("tresca_2d", {"Initial state/Equilibrate": "true"}, "Equilibrate")

    def test_solutions_that_are_none(self):
        self.refused(
            "tresca_2d",
            {"Boundary 2/Friction bound": "0.07"},
            "'Boundary 2'",
            "friction bound",
            "tangential stress",
        )
        self.refused("tresca_2d", {"Boundary 2/Friction bound": "0.2"}, "oppose")
        self.refused(
            "tresca_2d", {"Boundary 0/Role": "clamped"}, "'Boundary 0'", "clamped"
        )
        self.refused("tresca_2d", {"Boundary 0/Role": "symmetry"}, "'Boundary 0'")
        self.refused("tresca_2d", {"Boundary 2/Friction law": "none"}, "no friction")

    def test_expressions(self):
        self.refused(
            "tresca_2d", {"Exact solution/Displacement": ""}, "Displacement' is missing"
        )
        self.refused("tresca_2d", {"Exact solution/Stress": ""}, "Stress' is missing")
        self.refused("tresca_2d", {"Exact solution/Stress": "1; 2; 3"}, "4 components")
        self.refused(
            "tresca_2d",
            {"Exact solution/Displacement": "sqrt(t)*(1-y)*0.1; 0"},
            "no time derivative",
        )
        self.refused(
            "tresca_2d",
            {"Exact solution/Displacement": "y*(1-y)/(x-0.4375); 0"},
            "Exact solution/Displacement",
        )

    def test_references(self):
        missing = {"Exact solution/Reference directory": "nowhere"}
        self.refused("slab", {**SLAB, **missing}, "nowhere", "Reference fields")
        self.refused("tresca_2d", missing, "both given")
        reference = run("slab", {**SLAB, "Output/Reference fields": "true"})
        there = {"Exact solution/Reference directory": reference.directory}
        other = {**SLAB, "Time/Phases": "0.5: 4, 1: 4", **there}
        self.refused("slab", other, "phase 1", "t = 1", "t = 0.5")
        file = reference.directory / "reference_2.bin"
        file.write_bytes(file.read_bytes()[:1000])
        self.refused("slab", {**SLAB, **there}, "reference_2.bin")


class TwoBodies(TestCase):
    def test_slip_along_the_interface(self):
        """First order of all errors on meshes that do not match, with an error bar
        that is right about it."""
        for dim, law, levels, ranks in (
            (2, "tresca", (1, 3), 1),
            (2, "coulomb", (1, 3), 3),
            (3, "tresca", (0, 2), 2),
            (3, "coulomb", (0, 2), 1),
        ):
            with self.subTest(dim=dim, law=law):
                coarse, fine = (
                    run("pair", slipping_bodies(dim, law, level), ranks, text="")
                    for level in levels
                )
                # measured: 1.00, 1.00 and 1.12 to 1.21
                for norm in "energy", "stress", "multiplier":
                    column = f"error_{norm}"
                    order = np.log2(coarse[column][-1] / fine[column][-1]) / 2
                    self.assertGreater(order, 0.99)
                # the nodes on either side of where it begins
                area = 2 ** (dim - 2) * fine["slip_area"][-1]
                self.assertClose(area, 0.5, absolute=0.07)
                effectivity = fine["estimate_space"][-1] / fine["error_energy"][-1]
                self.assertGreater(effectivity, 1)
                self.assertLess(effectivity, 1.1)


if __name__ == "__main__":
    main()
