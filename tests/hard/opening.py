# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact that opens, with Coulomb's friction of the pressure of the step itself."""

from harness import run
from runs import on_boundary
from suite import case

GROUP = "Contact that opens"


def corrections(report, results, largest):
    report.figure(
        "corrections in a step, most",
        max(result["contact_iterations"].max() for result in results),
        largest=largest,
    )


@case(
    GROUP,
    "mu = 0 to 2 where the edge of a plate lifts off: two meshes agree, iterations "
    "about as without friction",
)
def edge_lift_off(size, report):
    n = size(32, 128)
    fines = []
    for friction in 0, 0.3, 1, 2:
        coarse, fine = (
            run(
                "literature/greco_plate",
                {
                    "Boundary 2/Friction coefficient": friction,
                    "Geometry/Arguments": f"{m}, {m} : 0, 0 : 0.04, 0.04 : true",
                    "Time/Phases": "1: 2",
                },
            )
            for m in (n // 2, n)
        )
        name = f"mu = {friction}"
        report.identities(fine, 1e-5)
        report.figure(
            f"{name}: change of the displacement of the corner by halving h",
            abs(coarse["point0_x"][-1] / fine["point0_x"][-1] - 1),
            largest=0.01,
        )
        fines.append(fine)
    corrections(report, fines, 15)


@case(
    GROUP,
    "a sharp edge in a half plane: half width P/(E* s), s the slope, to the cells "
    "there; friction makes it less and adds to the force",
)
def sharp_indenter(size, report):
    slope = 0.02
    results = []
    for friction in 0, 0.5, 2:
        result = run(
            "partial_slip_2d",
            {
                **on_boundary(4, Gap=f"{slope}*abs(x)", Foundation_motion=""),
                "Boundary 4/Friction coefficient": friction,
                "Geometry/Boundary refinements": f"4: {size(2, 4)}",
                "Material/Poisson's ratio": 0.3,
                "Solver/Coulomb pressure": "Newton",
                # one step, in which a lagged pressure has no friction at all
                "Time/Phases": "1: 1",
            },
        )
        name = f"mu = {friction}"
        width = -result["contact_force_y"][-1] * (1 - 0.3**2) / slope
        report.identities(result, 1e-8)
        report.figure(
            f"{name}: half width over P/(E* s)",
            result["contact_area"][-1] / 2 / width,
            least=0.9 if friction == 0 else 0.85,
            largest=1.02,
        )
        results.append(result)
        if friction > 0:
            report.figure(
                f"{name}: force that friction adds",
                result["contact_force_y"][-1] / results[0]["contact_force_y"][-1] - 1,
                least=0.005,
            )
    corrections(report, results, 15)


@case(
    GROUP,
    "a wedge in a groove, held by contact alone: friction carries mu/0.2 of what "
    "pressure carries; relieved to a hundredth of its load it leaves only for mu < "
    "0.2",
)
def wedge(size, report):
    results = []
    for friction in 0, 0.1, 0.3, 1, 2:
        result = run(
            "hard/wedge_2d",
            {
                **{f"Boundary {b}/Friction coefficient": friction for b in (0, 1)},
                "Geometry/Global refinements": size(4, 5),
            },
        )
        name = f"mu = {friction}"
        pressed, rubbed = result["contact_force_y"], result["friction_force_y"]
        report.identities(result, 1e-5)
        if friction < 1:
            report.figure(
                f"{name}: friction over pressure, error",
                abs(rubbed[4] - friction / 0.2 * pressed[4]) / abs(pressed[4]),
                largest=1e-9,
            )
        report.figure(
            f"{name}: pressure that stays, of the largest",
            pressed[-1] / pressed.min(),
            least=0.1 if friction > 0.2 else 0,
            largest=1 if friction > 0.2 else 0.04,
        )
        results.append(result)
    corrections(report, results, 8)


@case(
    GROUP,
    "ground of 1 to 10^12 times the stiffness of a cell: the answer tends to that "
    "on rigid ground as 1/c",
)
def stiff_ground(size, report):
    def plate(**contact):
        return run(
            "literature/greco_plate",
            {
                "Geometry/Arguments": "32, 32 : 0, 0 : 0.04, 0.04 : true",
                **{f"Boundary 2/{k.replace('_', ' ')}": v for k, v in contact.items()},
                "Solver/Contact tolerance": 1e-10,
            },
        )

    rigid = plate()
    cell = 1.3e11 / (0.04 / 32)
    misses, results = [], []
    for exponent in 0, 2, 4, 8, 12:
        soft = plate(Contact_law="normal compliance", Compliance=cell * 10.0**exponent)
        misses.append(abs(soft["point0_x"][-1] / rigid["point0_x"][-1] - 1))
        results.append(soft)
    corrections(report, results, 20)
    report.figure("difference at 10^2 over that at 10^4", misses[1] / misses[2], 90, 110)
    report.figure("difference at 10^12", misses[-1], largest=1e-8)


@case(
    GROUP,
    "a plate that touches just so and goes on by 10^-9 and twice that: twice the "
    "forces",
)
def grazing(size, report):
    results = []
    for friction in 0.3, 1:
        result = run(
            "partial_slip_2d",
            {
                **on_boundary(4, Gap=0, Foundation_displacement="-1e-9*max(0, t - 1)"),
                **on_boundary(4, Foundation_motion="", Friction_coefficient=friction),
                "Geometry/Boundary refinements": f"4: {size(1, 3)}",
                "Solver/Coulomb pressure": "Newton",
                "Time/Phases": "1: 1, 3: 2",
            },
        )
        name = f"mu = {friction}"
        force = result["contact_force_y"]
        report.figure(f"{name}: force at first contact", abs(force[1]), 0, 0)
        report.figure(f"{name}: force at the end over half way - 2",
                      abs(force[3] / force[2] - 2), largest=1e-6)
        results.append(result)
    corrections(report, results, 15)
