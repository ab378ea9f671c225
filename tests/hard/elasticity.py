# SPDX-License-Identifier: LGPL-2.1-or-later
"""Hard cases of the elastic part: the bilinear form and its moduli."""

import numpy as np

from forms import Box, answer, smallest_eigenvalue
from harness import run
from suite import case

E, NU = 1.0, 0.3
MU, BULK = E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU))

FORMS = "full", "mean dilatation"


@case(
    "Elasticity",
    "The form does not lose coercivity with h: loads that alternate from node to "
    "node have the answer of the stable forms, and at most 1/c of their energy, c "
    "the smallest eigenvalue of the form",
)
def hourglass(size, report):
    sizes = size((4, 8, 16), (4, 8, 16, 32))
    naive = {}
    for n in sizes:
        box = Box(n, 2)
        naive[n] = smallest_eigenvalue(
            box.matrix(MU, BULK, "one-point"), box.matrix(MU, BULK)
        )
        report.figure(f"DGQ(0) form over full form, n = {n}", naive[n])
    # The trap itself: if this did not fall like h^2, the loads would be no test.
    order = np.log2(naive[n // 2] / naive[n])
    report.figure("its order in h", order, 1.9, 2.1)

    # 2 mu for the full form, where (E e, e) >= 2 mu (e, e).  For mean dilatation
    # there is no such formula; it falls from 0.602 to 0.598.
    least = {"full": 2 * MU, "mean dilatation": 0.59}
    for kind in FORMS:
        constants = [
            smallest_eigenvalue(box.matrix(MU, BULK, kind), box.matrix(0.5, 1 / 3))
            for box in (Box(n, 2) for n in sizes)
        ]
        report.figure(
            f"smallest eigenvalue over n, {kind}",
            min(constants),
            least[kind] * (1 - 1e-9),
        )
        for dim, n_cells in (2, sizes), (3, size((3, 6), (3, 6, 12))):
            ratios = np.array([checkerboard(n, dim, kind) for n in n_cells])
            what = f"{kind}, {dim}D"
            report.figure(
                f"answer of the program over that of the form - 1, {what}",
                abs(ratios[:, 0] - 1).max(),
                0,
                1e-8,
            )
            report.figure(
                f"energy over that of (eps, eps), largest over n, {what}",
                ratios[:, 1].max(),
                0,
                1 / least[kind],
            )
    # What a program with that form would show: beyond the bounds above.  In 3D
    # it is singular.
    report.figure(
        "energy over that of (eps, eps) of the DGQ(0) form, largest over n, 2D",
        naive_ratio(max(sizes)),
        5,
    )


def naive_ratio(n):
    box = Box(n, 2)
    load = checkerboard_load(box)
    return (load @ answer(box.matrix(MU, BULK, "one-point"), load)) / (
        load @ answer(box.matrix(0.5, 1 / 3), load)
    )


def checkerboard_load(box):
    return box.load(lambda x: np.prod(np.cos(box.n * np.pi * x), axis=1))


def checkerboard(n, dim, kind):
    """The energies that a checkerboard load excites: of the program over the
    form in Python, and over (eps, eps).

    There are no identities to check: the resultant of the load is rounding.
    """
    box = Box(n, dim)
    load = checkerboard_load(box)

    def energy(*form):
        return load @ answer(box.matrix(*form), load)

    def each(entry):
        return ", ".join(dim * [str(entry)])

    force = "*".join(f"cos({n}*pi*{x})" for x in "xyz"[:dim])
    result = run(
        "hard/hourglass",
        {
            "Dimension": dim,
            "Geometry/Arguments": f"{each(n)} : {each(0)} : {each(1)} : false",
            "Geometry/Boundary ids": f"if({'xyz'[dim - 1]} > 0.999999, 1, 0)",
            "Material/Volumetric integration": kind,
            "Loads/Body force": f"t*{force}" + (dim - 1) * "; 0",
            "Output/Points": each(0),
        },
    )
    program = 2 * result["strain_energy"][-1]
    return program / energy(MU, BULK, kind), program / energy(0.5, 1 / 3)


RATIOS = (0.3, 0.49, 0.499, 0.4999, 0.49999)  # Poisson's


@case(
    "Elasticity",
    "Poisson's ratio from 0.3 to 0.49999: by default the error relative to a volume "
    "preserving exact solution is that at 0.3, and of first order",
)
def incompressible(size, report):
    def error(n, nu, **more):
        result = run(
            "hard/incompressible",
            {
                "Geometry/Arguments": f"{n}, {n} : 0, 0 : 1, 1 : true",
                "Material/Poisson's ratio": nu,
                **more,
            },
        )
        if "direct (CHOLMOD)" not in result.stdout:
            raise AssertionError(f"nu = {nu}: automatic is not the direct solver")
        return result["error_h1"][-1] / result["exact_h1"][-1]

    sizes = size((8, 16), (8, 16, 32, 64, 128))
    errors = {n: [error(n, nu) for nu in RATIOS] for n in sizes}
    n = max(sizes)
    report.figure(f"relative error in H1, nu = 0.3, n = {n}", errors[n][0])
    report.figure(
        "largest error over nu / error at 0.3, largest over n",
        max(max(values) / values[0] for values in errors.values()),
        0,
        1.02,
    )
    order = np.log2(errors[n // 2][-1] / errors[n][-1])
    report.figure("order in h, nu = 0.49999", order, 0.95, 1.05)
    # That this solution locks where it may: what a program without mean
    # dilatation would show.
    full = {"Material/Volumetric integration": "full"}
    report.figure(
        "error at 0.49999 / error at 0.3, full integration, n = 16",
        error(16, RATIOS[-1], **full) / error(16, RATIOS[0], **full),
        5,
    )


@case(
    "Elasticity",
    "the same with friction: errors against a four times finer mesh and iterations "
    "of the active set as at 0.3; `automatic` takes the direct solver",
)
def incompressible_slab(size, report):
    n = size(16, 32)

    def slab(n, nu, **more):
        result = run(
            "hard/incompressible_slab",
            {
                "Geometry/Arguments": f"{2 * n}, {n} : 0, 0 : 2, 1 : true",
                "Material/Poisson's ratio": nu,
                **more,
            },
        )
        report.identities(result, 1e-8)
        forced = "Solver/Linear solver" in more
        if forced == ("direct (CHOLMOD)" in result.stdout):
            raise AssertionError(f"nu = {nu}: the solver is not as expected")
        return result

    def error(coarse, fine):
        """Over the whole course, since single times may agree by chance."""
        names = "external_work", "stored_energy", "friction_dissipation"
        return max(
            abs(coarse[name] - fine[name]).max() / abs(fine[name]).max()
            for name in names
        )

    errors, iterations, most, linear, difference = [], [], [], [], []
    for nu in RATIOS:
        coarse, fine = slab(n, nu), slab(4 * n, nu)
        errors.append(error(coarse, fine))
        iterations.append(coarse["contact_iterations"][1:].mean())
        most.append(coarse["contact_iterations"].max())
        multigrid = slab(n, nu, **{"Solver/Linear solver": "multigrid"})
        linear.append(multigrid["linear_iterations"][1:].mean())
        difference.append(error(multigrid, coarse))
    locked = slab(n, nu, **{"Material/Volumetric integration": "full"})

    report.figure(f"error in energies, nu = 0.3, n = {n} against {4 * n}", errors[0])
    report.figure(
        "largest error over nu / error at 0.3", max(errors) / errors[0], 0, 1.2
    )
    report.figure(
        "the same at 0.49999, full integration", error(locked, fine) / errors[0], 5
    )
    report.figure("active-set iterations a step at 0.3", iterations[0])
    report.figure("the same, largest over nu", max(iterations), 0, iterations[0] + 0.5)
    report.figure("in one step, largest over nu", max(most), 0, 10)
    for nu, count in zip(RATIOS, linear):
        report.figure(f"multigrid iterations a step, nu = {nu}", count)
    report.figure(
        "multigrid against direct, energies, largest over nu", max(difference), 0, 1e-6
    )


@case(
    "Elasticity",
    "Stiffnesses that differ by 10^6, either way: the answer tends to that of a "
    "rigid or missing part; both solvers agree",
)
def contrast(size, report):
    n = size(16, 64)

    def block(modulus, solver="automatic"):
        result = run(
            "hard/contrast",
            {
                "Geometry/Arguments": f"{2 * n}, {n} : 0, 0 : 2, 1 : true",
                "Material 2/Young's modulus": modulus,
                "Solver/Linear solver": solver,
            },
        )
        # The norm of the motion that gives the resultant is that of the stiffer
        # part, to which the tolerance in the energy norm is relative.
        stiffest = max(modulus, 1) if solver == "multigrid" else 1
        report.identities(result, 1e-8 * np.sqrt(stiffest))
        return result

    def difference(one, other):
        return max(
            abs(one[name] - other[name]).max() / abs(one[name]).max()
            for name in ("point0_x", "external_work", "friction_force_x")
        )

    plain = block(1)["contact_iterations"][1:]
    report.figure("active-set iterations a step, one material", plain.mean())
    for name, sign in ("stiff", 1), ("soft", -1):
        near, far = block(10.0 ** (5 * sign)), block(10.0 ** (6 * sign))
        report.figure(f"10^6 against 10^5, {name} part", difference(far, near), 0, 1e-4)
        report.figure(
            f"10^5 against 10^3 over 10^6 against 10^4, {name} part",
            difference(near, block(10.0 ** (3 * sign)))
            / difference(far, block(10.0 ** (4 * sign))),
            # the distance from the limit is of first order in the ratio
            9,
            11,
        )
        report.figure(
            f"active-set iterations a step, {name} part",
            far["contact_iterations"][1:].mean(),
            0,
            plain.mean() + 1,
        )
        multigrid = block(10.0 ** (6 * sign), "multigrid")
        report.figure(
            f"multigrid against direct, {name} part",
            difference(far, multigrid),
            0,
            # the tolerance, relative to the energy of the stiff part
            1e-8 * 1e3,
        )
        report.figure(
            f"multigrid iterations a step, {name} part",
            multigrid["linear_iterations"][1:].mean(),
        )


def fibres(strength):
    """2 mu I + lambda 1 x 1 + F a x a in Voigt's form, for fibres at 30 degrees."""
    a = np.array([0.75, 0.25, 0, 0, 0, np.sqrt(3) / 4])
    one = np.array([1, 1, 1, 0, 0, 0])
    lame = BULK - 2 * MU / 3
    matrix = np.diag(MU * np.array([2, 2, 2, 1, 1, 1]))
    matrix = matrix + lame * np.outer(one, one) + strength * np.outer(a, a)
    return "; ".join(", ".join(f"{v:.17g}" for v in row) for row in matrix)


@case(
    "Elasticity",
    "Fibres at an angle to the mesh, up to 10^4 times as stiff as the rest: errors "
    "and active-set iterations as without them",
)
def anisotropic(size, report):
    strengths = 0, 1e2, 1e4

    def error(n, strength, displacement):
        result = run(
            "hard/anisotropic",
            {
                "Geometry/Arguments": f"{n}, {n} : 0, 0 : 1, 1 : true",
                "Material/Voigt matrix": fibres(strength),
                "Exact solution/Data": "solution",
                "Exact solution/Displacement": displacement,
                "Boundary 0/Traction": "",
                "Boundary 1/Role": "traction",
                "Boundary 2/Role": "traction",
                "Boundary 3/Role": "displacement",
                "Time/Phases": "1: 1",
                "Output/Points": "",
            },
        )
        return result["error_energy"][-1] / result["exact_energy"][-1]

    n = size(16, 64)
    general = "t*sin(2*x + y); t*cos(x - 2*y)"
    errors = [error(n, strength, general) for strength in strengths]
    report.figure(f"relative error in energy without fibres, n = {n}", errors[0])
    report.figure(
        "largest error over strengths / error without",
        max(errors) / errors[0],
        0,
        # the best approximation of the stretch of the fibres alone
        2,
    )
    order = np.log2(error(n // 2, strengths[-1], general) / errors[-1])
    # On coarse meshes the errors are smaller than without fibres.
    report.figure("order in h, 10^4", order, 0.8, 1.1)
    # of the distance across the fibres only: no stretch along them
    across = "sin(2*(-x/2 + sqrt(3)/2*y))"
    along = f"t*sqrt(3)/2*{across}; t/2*{across}"
    locking = [error(n, strength, along) for strength in strengths]
    report.figure(
        "motion without stretch of the fibres: error at 10^4 / error without",
        locking[-1] / locking[0],
    )

    def slab(strength):
        result = run(
            "hard/anisotropic",
            {
                "Geometry/Arguments": f"{2 * n}, {n} : 0, 0 : 2, 1 : true",
                "Material/Voigt matrix": fibres(strength),
            },
        )
        report.identities(result, 1e-8)
        return result["contact_iterations"][1:].mean()

    counts = [slab(strength) for strength in strengths]
    report.figure("active-set iterations a step without fibres", counts[0])
    report.figure("the same, largest over strengths", max(counts), 0, counts[0] + 0.5)
