# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact pieces: pressures that change their sign, corners and edges where
pieces meet, hanging nodes on the face."""

import numpy as np

from friction import GROUP, TOLERANCE, check_homogeneous, corrections, scene, slider
from suite import case


def given_pressure(t):
    return (abs(t - 1) - 1 if t < 3 else max(0, 4 - t)) / 10


@case(
    GROUP,
    "the given normal stress changes its sign in time or along the face, or "
    "vanishes: bound mu abs(S)",
)
def pressure_changes_sign(size, report):
    n, steps = size((16, 16), (128, 64))
    phases = ", ".join(f"{i}: {steps}" for i in range(1, 6))
    result = scene(
        "pressure_sign_2d",
        **{
            "Geometry/Arguments": f"{n}, {n // 2} : 0, 0 : 2, 1 : true",
            "Time/Phases": phases,
        },
    )
    report.identities(result, 1e-10)
    place, force = slider(
        result["t"],
        lambda t: np.array([0.2 * np.sin(2.5 * t), 0]),
        0.5,
        lambda t: 0.4 * abs(given_pressure(t)),
    )
    report.figure(
        "error of the foot",
        max(abs(result[f"point{p}_x"] - place[:, 0]).max() for p in range(3)),
        largest=TOLERANCE,
    )
    report.figure(
        "error of the force, relative",
        abs(result["friction_force_x"] - 2 * force[:, 0]).max() / 0.08,
        largest=TOLERANCE,
    )
    without = (result["t"] >= 4) | (abs(result["t"] - 2) < 1e-12)
    report.figure(
        "force where S = 0", abs(result["friction_force_x"][without]).max(), 0, 1e-16
    )
    for cells in n, n + 1:  # the change of sign at a node, and inside a face
        result = scene(
            "pressure_sign_2d",
            **{
                "Geometry/Arguments": f"{cells}, {n // 2} : 0, 0 : 2, 1 : true",
                "Boundary 0/Role": "free",
                "Boundary 1/Role": "free",
                "Boundary 2/Normal stress": "0.2*(x - 1)*min(t, 1)",
                "Material/Poisson's ratio": 0.3,
                "Time/Phases": phases,
            },
        )
        report.identities(result, 1e-10)
        odd = abs(result["point0_x"] - result["point2_x"]).max()
        even = abs(result["point0_y"] + result["point2_y"]).max()
        report.figure(
            f"S = 0.2 (x - 1) on {cells} faces: defect of the symmetry",
            max(odd, even),
            largest=TOLERANCE,
        )
        report.figure("slip area, largest", result["slip_area"].max(), least=1)


def kite(angle, refinements):
    """Entries of corner_2d.prm for another angle, and the bisector."""
    half = np.radians(angle) / 2
    e = np.array([np.cos(half), np.sin(half)])
    d = np.array([-e[1], e[0]])
    ends = np.array([[1, 0], [np.cos(2 * half), np.sin(2 * half)]])
    corners = np.array([[0, 0], *ends, (np.cos(half) + 0.7) * e])
    push, shear = "0.2*sin(2*pi*t)", "0.1*sin(3*pi*t)"

    def points(rows):
        return "; ".join(", ".join(f"{x:.17g}" for x in row) for row in rows)

    def traction(sign):
        return "; ".join(
            f"{a:.17g}*{push} + {sign * b:.17g}*{shear}" for a, b in zip(e, d)
        )

    return e, d, {
        "Geometry/Arguments": points(corners) + " : true",
        "Geometry/Global refinements": refinements,
        "Boundary 1/Traction": traction(1),
        "Boundary 3/Traction": traction(-1),
        "Output/Points": points([(0, 0), *ends]),
    }


@case(
    GROUP,
    "two pieces meet at 30 to 170 degrees: the answer has the symmetry of the data, "
    "the corner stays",
)
def corners_2d(size, report):
    refinements = size(3, 6)
    for angle in size((90, 150), (30, 90, 120, 150, 170)):
        for law in "tresca", "coulomb":
            e, d, entries = kite(angle, refinements)
            if law == "coulomb":
                # Friction does not hold a body: the outer sides are moved.
                moved = "; ".join(
                    f"0.1*sin(2*pi*t)*({a:.17g} + {b:.17g}*({d[0]:.17g}*x + {d[1]:.17g}*y))"
                    for a, b in zip(e, d)
                )
                for side in 1, 3:
                    entries[f"Boundary {side}/Role"] = "displacement"
                    entries[f"Boundary {side}/Displacement"] = moved
                for side in 0, 2:
                    entries[f"Boundary {side}/Friction law"] = "coulomb"
                    entries[f"Boundary {side}/Friction coefficient"] = 0.5
                    entries[f"Boundary {side}/Normal stress"] = "-0.1*min(8*t, 1)"
            result = scene("corner_2d", **entries)
            report.identities(result, 1e-10)
            force, left, right = (
                result.vector(name) for name in ("friction_force", "point1", "point2")
            )
            report.figure(
                f"{angle} degrees, {law}: force across the bisector, relative",
                abs(force @ d).max() / abs(force @ e).max(),
                largest=TOLERANCE,
            )
            report.figure(
                "displacements, defect of the symmetry, relative",
                max(abs((left - right) @ e).max(), abs((left + right) @ d).max())
                / abs(left).max(),
                largest=TOLERANCE,
            )
            if law == "tresca":
                corner = abs(result.vector("point0")).max()
                report.figure("displacement of the corner", corner, 0, 0)
            slip = result["slip_area"][1:]
            report.figure("slip area, smallest and largest apart", np.ptp(slip), least=0.1)
            corrections(report, result)


@case(GROUP, "three foundations meet in edges and a corner: x, y and z stay equal")
def edges_and_corner_3d(size, report):
    n = size(4, 12)
    for law in "tresca", "coulomb":
        entries = {"Geometry/Arguments": f"{n}, {n}, {n} : 0, 0, 0 : 1, 1, 1 : true"}
        for side in 0, 2, 4:
            entries[f"Boundary {side}/Friction law"] = law
            if law == "coulomb":
                entries[f"Boundary {side}/Friction coefficient"] = 0.5
                entries[f"Boundary {side}/Normal stress"] = "-0.05*min(8*t, 1)"
        result = scene("three_foundations_3d", **entries)
        report.identities(result, 1e-10)
        force = result.vector("friction_force")
        report.figure(
            f"{law}: components of the force apart, relative",
            np.ptp(force, axis=1).max() / abs(force).max(),
            largest=TOLERANCE,
        )
        points = [np.roll(result.vector(f"point{p}"), -p, axis=1) for p in range(3)]
        report.figure(
            "displacements of three equal points apart, relative",
            np.ptp(points, axis=0).max() / abs(points[0]).max(),
            largest=TOLERANCE,
        )
        report.figure(
            "slip area, smallest and largest apart", np.ptp(result["slip_area"][1:]), 0.5
        )
        corrections(report, result)


ADAPTIVE = {
    "Geometry/Boundary refinements": "",
    "Mesh refinement/Strategy": "residual",
    "Mesh refinement/Maximal level": 2,
}


@case(
    GROUP,
    "hanging nodes on the face: radial return of homogeneous shear all the same; "
    "adaptive meshes stay in a uniform state",
)
def hanging_nodes(size, report):
    fixed = scene(
        "hanging_nodes_3d",
        **{
            "Geometry/Boundary refinements": size("6: 2", "6: 4"),
            "Time/Phases": size("1: 2, 2: 16", "1: 2, 3: 64"),
        },
    )
    report.identities(fixed, 1e-10)
    report.figure("fixed mesh, cells", fixed["cells"][-1])
    check_homogeneous(report, fixed, 3)
    corrections(report, fixed)

    # What is left of the estimate is no reason to change the mesh.
    uniform = scene(
        "hanging_nodes_3d",
        **ADAPTIVE,
        **{
            "Mesh refinement/Cell budget": size(600, 3000),
            "Time/Phases": size("1: 2, 2: 16", "1: 2, 3: 64"),
        },
    )
    changes = (np.diff(uniform["cells"]) != 0).sum()
    report.figure("changes of an adaptive mesh in the uniform state", changes, 0, 0)


@case(
    GROUP,
    "an adapted mesh under slip that turns: identities, and nearer to a finer mesh "
    "than the one it began with",
)
def hanging_nodes_adaptive(size, report):
    bound = "0.1*exp(-40*((x + 0.3)^2 + (y + 0.3)^2))"
    common = {
        **{f"Boundary {side}/Role": "free" for side in range(4)},
        "Boundary 4/Friction bound": bound,
        "Boundary 6/Friction bound": bound,
        "Boundary 5/Displacement": "0.05*sin(2*pi*t); 0.05*(1 - cos(2*pi*t)); 0",
        "Geometry/Boundary refinements": "",
        "Geometry/Global refinements": 1,
        "Material/Poisson's ratio": 0.3,
        "Time/Phases": f"1: {size(16, 32)}",
    }
    coarse = scene("hanging_nodes_3d", **common)
    fine = scene("hanging_nodes_3d", **{**common, "Geometry/Global refinements": 2})
    adapted = scene(
        "hanging_nodes_3d",
        **{**common, **ADAPTIVE, "Mesh refinement/Cell budget": size(600, 1000)},
    )
    contact = adapted.fields("contact")
    sizes = np.ptp(contact.points[contact.cells], axis=1).max(axis=1)
    report.figure("cells at the end", adapted["cells"][-1])
    report.figure("largest face over the smallest", sizes.max() / sizes.min(), least=1.99)
    for result in coarse, fine, adapted:
        report.identities(result, 1e-10)
    dissipation = [r["friction_dissipation"][-1] for r in (coarse, adapted, fine)]
    report.figure(
        "distance of the dissipation from the finer mesh, of that of the first mesh",
        abs(dissipation[1] - dissipation[2]) / abs(dissipation[0] - dissipation[2]),
        largest=1,
    )
    corrections(report, coarse, fine, adapted)
