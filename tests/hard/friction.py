# SPDX-License-Identifier: LGPL-2.1-or-later
"""Friction: bounds of every size, ties, reversals, turning, rest, active sets.

Bounds on figures: TOLERANCE is what a contact tolerance of 1e-10 leaves of
displacements and forces of the size of 0.1 to 1, ten times over for the
accumulation in slip; where two runs must agree they do so to twice that.
"""

import numpy as np

from harness import run
from runs import on_boundary
from suite import case

GROUP = "Friction"
TOLERANCE = 1e-9


def scene(name, **overrides):
    return run(f"hard/{name}", overrides)


def difference(one, other, columns):
    """Largest difference of columns, each relative to its largest value."""
    return max(
        abs(one[c] - other[c]).max() / max(abs(other[c]).max(), 1e-300) for c in columns
    )


def vector_difference(one, other):
    return np.abs(np.subtract(one, other)).max()


def corrections(report, *runs, largest=7):
    """An independent active set with the same safeguards needed at most 7."""
    report.figure(
        "corrections of the active set in a step, most",
        max(r["contact_iterations"].max() for r in runs),
        largest=largest,
    )


def slider(times, drive, modulus, bound):
    """A slider on a spring, by radial return: its places and forces."""
    place, force = [np.zeros(2)], [np.zeros(2)]
    for t in times[1:]:
        trial = modulus * (drive(t) - place[-1])
        size = np.linalg.norm(trial)
        force.append(trial * min(1, bound(t) / size) if size > 0 else trial)
        place.append(drive(t) - force[-1] / modulus)
    return np.array(place), np.array(force)


def round_the_circle(t):
    """The path of the plate in turning_3d.prm and hanging_nodes_3d.prm."""
    angle = 2 * np.pi * max(0, t - 1)
    return np.array([min(t, 1) * np.cos(angle), np.sin(angle)])


def box(cells):
    return {"Geometry/Arguments": f"{cells} : -0.5, -0.5, 0 : 0.5, 0.5, 1 : true"}


# ---------------------------------------------------------------- bounds


@case(
    GROUP,
    "slip falls as the bound grows over 24 decades, between the limits without "
    "friction and glued",
)
def bounds_of_every_size(size, report):
    runs = {}
    for exponent in range(-12, 13, size(3, 1)):
        g = 0.3 * 10.0**exponent  # the load is 0.3
        runs[g] = scene("bounds_2d", **{"Boundary 2/Friction bound": repr(g)})
        report.identities(runs[g], 1e-10)
    slip = np.array([r["friction_dissipation"][-1] / g for g, r in runs.items()])
    report.figure("runs", len(runs))
    # 1e-9: a point that hardly slips does so within the contact tolerance
    report.figure(
        "largest rise of the total slip with the bound, relative",
        np.diff(slip).max() / slip.max(),
        largest=TOLERANCE,
    )
    tiny, huge = runs[min(runs)], runs[max(runs)]
    none = scene("bounds_2d", **{"Boundary 2/Friction law": "none"})
    glued = scene("bounds_2d", **{"Boundary 2/Friction law": "glued"})
    columns = "point0_x", "stored_energy", "stress_norm"
    report.figure(
        "friction force at 1e-12 of the load, of the bound, minus 1",
        abs(tiny["friction_force_x"][-1] / (2 * min(runs)) - 1),
        largest=TOLERANCE,
    )
    report.figure(
        "bound 1e-12 of the load against no friction, relative",
        difference(tiny, none, columns),
        largest=TOLERANCE,
    )
    report.figure(
        "bound 1e12 of the load against glued, relative",
        difference(huge, glued, columns[1:]),
        largest=TOLERANCE,
    )
    report.figure("slip area at bound 1e12", huge["slip_area"].max(), 0, 0)
    corrections(report, *runs.values())


@case(GROUP, "patches of bound 0 and 1e12 are patches without friction and glued ones")
def bound_discontinuous(size, report):
    n = size(16, 64)
    mesh = {
        "Geometry/Arguments": f"{2 * n}, {n} : 0, 0 : 2, 1 : true",
        "Time/Phases": "2: 16",
    }
    jumps = scene(
        "bounds_2d",
        **mesh,
        **{"Boundary 2/Friction bound": "if(sin(4*pi*x) > 0, 0, 3e11)"},
    )
    patches = scene(
        "bounds_2d",
        **mesh,
        **{
            "Geometry/Boundary ids": "if(id == 2 && sin(4*pi*x) < 0, 4, id)",
            "Boundary 2/Friction law": "none",
            **on_boundary(4, Role="contact", Friction_law="glued"),
        },
    )
    report.identities(jumps, 1e-10)
    report.figure(
        "jumping bound against pieces of their own, relative",
        difference(jumps, patches, ("point0_x", "stored_energy", "stress_norm")),
        largest=TOLERANCE,
    )
    inside = scene(
        "bounds_2d",
        **mesh,
        **{"Boundary 2/Friction bound": "0.3*if(sin(9.3*x) > 0, 1e-12, 1e12)"},
    )
    report.identities(inside, 1e-10)
    squares = scene(
        "turning_3d",
        **box("8, 8, 4" if not size.full else "16, 16, 8"),
        **{
            "Boundary 4/Friction bound": "0.03*if(sin(6*x)*sin(6*y) > 0, 1e-12, 1e12)",
            "Time/Phases": "1: 1, 2: 8",
        },
    )
    report.identities(squares, 1e-10)
    report.figure(
        "bounds 1e-12 and 1e12 in squares, 3D: area that slips",
        squares["slip_area"][1:].min(),
        0.2,
        0.5,  # half of the face less the nodes on the border, which hold
    )
    corrections(report, jumps, inside, squares)


@case(GROUP, "a bound of zero on one half of the face is a piece without friction")
def bound_zero_on_part(size, report):
    n = size(16, 64)
    mesh = {
        "Geometry/Arguments": f"{2 * n}, {n} : 0, 0 : 2, 1 : true",
        "Time/Phases": "1: 16, 2: 16",
    }
    zero = scene(
        "bounds_2d", **mesh, **{"Boundary 2/Friction bound": "if(x < 1, 0, 0.05)"}
    )
    piece = scene(
        "bounds_2d",
        **mesh,
        **{
            "Geometry/Boundary ids": "if(id == 2 && x < 1, 4, id)",
            "Boundary 2/Friction bound": 0.05,
            **on_boundary(4, Role="contact", Friction_law="none"),
        },
    )
    report.identities(zero, 1e-10)
    report.figure(
        "against a piece without friction, relative",
        difference(
            zero, piece, ("point0_x", "friction_force_x", "stored_energy", "stress_norm")
        ),
        largest=TOLERANCE,
    )
    report.figure("steps that slip", (zero["slip_area"] > 1).sum(), least=5)
    corrections(report, zero)


# ---------------------------------------------------------------- ties, reversals


def tie_drive(t):
    times = 0, 1, 2, 3, 4, 5, 6, 7
    tiny = 1e-9
    places = 0, 1, 1, 1 + tiny, 2 + tiny, tiny, tiny, tiny - 1
    return np.array([0.1 * np.interp(t, times, places), 0])


@case(
    GROUP,
    "the whole face reaches the bound at once and goes on by 1e-9: all points slip "
    "or none, the force is the bound",
)
def tie_of_the_whole_face(size, report):
    n = size(16, 128)
    result = scene(
        "tie_2d", **{"Geometry/Arguments": f"{2 * n}, {n} : 0, 0 : 2, 1 : true"}
    )
    report.identities(result, 1e-10)
    t = result["t"]
    place, force = slider(t, tie_drive, 0.5, lambda t: 0.05)
    report.figure("friction points", 2 * n + 1)
    report.figure(
        "error of the foot",
        max(abs(result[f"point{p}_x"] - place[:, 0]).max() for p in range(3)),
        largest=TOLERANCE,
    )
    at_bound = (t >= 1) & (t <= 4)
    report.figure(
        "force between t = 1 and 4, of the bound, minus 1",
        abs(result["friction_force_x"][at_bound] / 0.1 - 1).max(),
        largest=TOLERANCE,
    )
    tied = ((t >= 1) & (t <= 2)) | ((t >= 5) & (t <= 6))
    slip_area = result["slip_area"][~tied]
    some = np.minimum(slip_area, 2 - slip_area) > 1e-12
    report.figure("steps away from the tie in which some points slip", some.sum(), 0, 0)
    report.figure("steps in which all slip", (slip_area > 1).sum(), least=10)
    corrections(report, result)


def loops(result, column, steps):
    """One row a period; the initial state is left out."""
    return result[column][1:].reshape(-1, steps)


def check_reversals(size, report, solid):
    n_periods, steps, n = size(20, 100), 24, size(8, 32)
    result = scene(
        "reversals_2d",
        **{
            "Geometry/Arguments": f"{2 * n}, {n} : 0, 0 : 2, 1 : true",
            "Time/Phases": f"{n_periods}: {n_periods * steps}",
            **solid,
        },
    )
    report.identities(result, 1e-10)
    report.figure("reversals", 2 * n_periods)
    for column, name in ("point0_x", "displacement"), ("friction_force_x", "force"):
        loop = loops(result, column, steps)
        report.figure(
            f"last period against the one before, {name}, relative",
            abs(loop[-1] - loop[-2]).max() / abs(loop).max(),
            largest=TOLERANCE,
        )
    increments = np.diff(result["friction_dissipation"])
    report.figure("smallest friction dissipation of a step", increments.min(), least=0)
    corrections(report, result)
    return result, steps


@case(
    GROUP,
    "200 reversals, elastic: the loop closes from the second period on, and "
    "friction dissipates its area",
)
def reversals_elastic(size, report):
    result, steps = check_reversals(size, report, {})
    loop = loops(result, "point0_x", steps)
    report.figure(
        "second period against the last, displacement, relative",
        abs(loop[1] - loop[-1]).max() / abs(loop).max(),
        largest=TOLERANCE,
    )
    dissipation, work, defect = (
        np.diff(result[c][::steps])[-1]
        for c in ("friction_dissipation", "external_work", "energy_balance_defect")
    )
    report.figure(
        "work less dissipation in the last period, of the dissipation",
        abs(work - dissipation) / dissipation,
        # the time error of friction: points begin to slip within a step, in
        # which the multiplier changes by at most a 24th of its range
        largest=0.02,
    )
    report.figure(
        "of which not in the energy balance defect",
        abs(work - dissipation - defect) / dissipation,
        largest=1e-7,  # cumulative sums are written with 12 digits
    )


@case(GROUP, "200 reversals of a standard linear solid: the loop closes after the "
             "transient")
def reversals_viscous(size, report):
    # 20 periods are 40 retardation times, of twice the relaxation time.
    solid = {"Material/Law": "zener", "Material/zener/Relaxation time": 0.25}
    result, _ = check_reversals(size, report, solid)
    viscous = np.diff(result["viscous_dissipation"])
    report.figure("smallest viscous dissipation of a step", viscous.min(), least=0)


# ---------------------------------------------------------------- turning, rest


@case(
    GROUP,
    "slip turns through 720 degrees: a quarter turn later everything is the same, "
    "turned; the force is at the bound",
)
def slip_direction_turns(size, report):
    per_quarter = size(6, 18)
    result = scene(
        "turning_3d",
        **box(size("4, 4, 4", "12, 12, 12")),
        **{"Time/Phases": f"1: 1, 3: {8 * per_quarter}"},
    )
    report.identities(result, 1e-10)
    force = result.vector("friction_force")[:, :2]
    later = force[per_quarter:]
    turned = force[:-per_quarter] @ np.array([[0, 1], [-1, 0]])
    at_last = result["t"][per_quarter:] > 2.5 - 1e-9
    report.figure(
        "force in the last half turn against that of a quarter turn earlier, relative",
        abs(later - turned)[at_last].max() / 0.07,
        largest=TOLERANCE,
    )
    # int 0.03 (1 + 8 r^2) = 0.07, exact by two Gauss points; the directions
    # differ a little from point to point
    report.figure(
        "sum of the forces, of that of the bounds, smallest",
        np.linalg.norm(force[1:], axis=1).min() / 0.07,
        0.95,
        1 + 1e-9,
    )
    report.figure("area that slips, smallest", result["slip_area"][1:].min(), 1 - 1e-9)
    report.figure("force not along the slip", result["slip_misalignment"].max(), 0, 1e-8)
    corrections(report, result)


HELD = {
    key: value
    for side in range(4)
    for key, value in {
        **on_boundary(side, Role="displacement", Displacement="free; free; 0"),
    }.items()
} | {"Material/Poisson's ratio": 0}


def check_homogeneous(report, result, points):
    place, force = slider(result["t"], round_the_circle, 0.5, lambda t: 0.03)
    report.figure(
        "error of the foot",
        max(
            vector_difference(result.vector(f"point{p}")[:, :2], place)
            for p in range(points)
        ),
        largest=TOLERANCE,
    )
    found = result.vector("friction_force")[:, :2]
    report.figure(
        "error of the force, relative",
        vector_difference(found, force) / 0.03,
        largest=TOLERANCE,
    )
    at_bound = np.linalg.norm(found[1:], axis=1) / 0.03
    report.figure(
        "force, of the bound, minus 1", abs(at_bound - 1).max(), largest=TOLERANCE
    )


@case(GROUP, "homogeneous shear that turns by 5 to 90 degrees a step: radial return")
def radial_return(size, report):
    for steps in size((8, 48), (8, 16, 48, 144)):
        result = scene(
            "turning_3d",
            **HELD,
            **box(size("3, 3, 3", "10, 10, 10")),
            **{"Boundary 4/Friction bound": 0.03, "Time/Phases": f"1: 1, 3: {steps}"},
        )
        report.identities(result, 1e-10)
        report.figure("degrees a step", 720 / steps)
        check_homogeneous(report, result, 1)
        corrections(report, result)


def check_rest(report, result, since, columns, settling=0):
    """`settling` steps may still slip by what the tolerance left before."""
    first = result.row(since)
    report.figure("steps of rest", len(result["t"]) - 1 - first)
    change = TOLERANCE if settling else 0
    for column in columns:
        values = result[column][first:]
        report.figure(f"change of {column} in all of them", np.ptp(values), 0, change)
    slips = result["slip_area"][first + 1 :] > 0
    report.figure("steps of rest in which a point slips", slips.sum(), 0, settling)
    report.figure("after so many steps none does", slips.nonzero()[0].max(initial=-1) + 1,
                  0, settling)
    # Measured on the displacement: zero on some processors, on others the last
    # digit of it.
    stuck = result["max_stick_slip"][first:].max()
    last_digit = np.finfo(float).eps * result["max_displacement"][first:].max()
    report.figure("largest slip of a stuck point", stuck, 0, last_digit)
    dissipation = np.ptp(result["friction_dissipation"][first:])
    report.figure("friction dissipation", dissipation, 0, change)


@case(GROUP, "at constant load nothing creeps, though points rest at their bound in "
             "either direction")
def hold_in_stick(size, report):
    result = scene("hold_2d", **{"Time/Phases": f"1: 16, 2: 16, 10: {size(500, 10000)}"})
    report.identities(result, 1e-10)
    slip = result["slip_area"]
    report.figure("slip area while pushed", slip[result.row(1)], least=1)
    report.figure("slip area while released", slip[result.row(2)], least=0.01)
    check_rest(report, result, 2, ("point0_x", "point1_x", "friction_force_x"))


@case(GROUP, "the same in 3D after full slip, where every point rests at its bound")
def hold_in_stick_3d(size, report):
    result = scene(
        "turning_3d",
        **{
            "Boundary 5/Displacement": "min(t, 1); 0.3*min(t*t, 1); 0",
            "Time/Phases": f"1: 8, 10: {size(100, 2000)}",
        },
    )
    report.identities(result, 1e-10)
    report.figure("slip area while pushed", result["slip_area"][result.row(1)], 1 - 1e-9)
    check_rest(
        report, result, 1, ("point0_x", "point0_y", "friction_force_x"), settling=10
    )


# ---------------------------------------------------------------- active sets


@case(GROUP, "corrections of the active set at onset, full slip and reversal stay few "
             "on finer meshes")
def active_sets(size, report):
    for n in size((16, 32), (16, 32, 64, 128)):
        runs = [
            run(
                "slab",
                {
                    "Geometry/Arguments": f"{2 * n}, {n} : 0, 0 : 2, 1 : true",
                    "Boundary 0/Traction": "0.3*2/pi*asin(sin(pi/2*t)); 0",
                    "Boundary 2/Friction bound": bound,
                    "Time/Phases": f"4: {4 * steps}",
                    "Error control/Error bar": "false",
                    "Output/Fields every": 0,
                },
            )
            for bound in (0.08, 0.03, 0.005)
            for steps in (n // 2, n)
        ]
        report.figure("cells over the height", n)
        for result in runs:
            report.identities(result, 1e-10)
        corrections(report, *runs)
        mean = max(r["contact_iterations"][1:].mean() for r in runs)
        report.figure("mean of the worst run", mean, largest=3)
