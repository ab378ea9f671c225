# SPDX-License-Identifier: LGPL-2.1-or-later
"""Hard cases of steps that are refused, divided, dropped and chosen."""

import re

import numpy as np
from suite import case

from harness import run
from test_step_control import DroppedSteps

STICK_SLIP = "coulomb_block_2d"


@case(
    "Step control",
    "three times beyond 2/r: refused with limit and cell, divided, or backward "
    "Euler; never unstable",
)
def stiff_steps(size, report):
    mesh = {"Geometry/Arguments": f"{size(16, 64)}, {size(8, 32)} : 0, 0 : 2, 1 : true"}
    scene = "hard/stiff_slab_2d"
    refused = run(scene, {**mesh, "Time/Stiffness policy": "refuse"}, check=False)
    limit = re.search(r"stability limit 2/r = (\S+) of .* cell at x = ", refused.stderr)
    report.figure("exit code when refused", refused.returncode, 1, 1)
    report.figure("2/r in that sentence", float(limit[1]), 0.0519, 0.0521)
    fine = run(scene, {**mesh, "Time/Phases": "1: 200, 2: 200"})
    asked = run(scene, {**mesh, "Time/Phases": "1: 24, 2: 24"})
    divided = run(scene, {**mesh, "Time/Stiffness policy": "subdivide"})
    implicit = run(scene, mesh)

    def difference(one, other):
        return max(
            abs(one[name][-1] - other[name][-1]) / abs(other[name]).max()
            for name in ("max_displacement", "friction_force_x")
        )

    report.figure("k r of the steps asked for", implicit["k_r"][1:].max(), 3)
    report.figure("k r when divided", divided["k_r"][1:].max(), 0, 2 * (1 + 1e-9))
    report.figure(
        "divided, against the same steps given", difference(divided, asked), 0, 1e-9
    )
    report.figure("divided, against 200 steps", difference(divided, fine), 0, 0.05)
    report.figure(
        "backward Euler, against 200 steps", difference(implicit, fine), 0, 0.05
    )


@case(
    "Step control",
    "a jump nobody announced and 1000 relaxation times: tolerance kept, few steps",
)
def jump(size, report):
    scene = "hard/jump_2d"
    tolerance = size(0.02, 0.005)
    entries = {"Step control/Tolerance": tolerance}
    unknown = run(scene, entries)
    known = run(scene, {**entries, "Step control/Landing times": "0.537"})
    n = size(1, 4)
    fine = run(
        scene,
        {
            "Time/Phases": f"0.537: {200 * n}, 2: {500 * n}, 10: {400 * n}, 1000: 400",
            "Step control/Tolerance": 0,
        },
    )
    for name, result in ("not listed", unknown), ("listed", known):
        error = max(
            abs(result[column][-1] - fine[column][-1]) / abs(fine[column]).max()
            for column in ("max_displacement", "stored_energy", "viscous_dissipation")
        )
        report.figure(f"jump {name}: error/tolerance", error / tolerance, 0, 2)
        report.figure(
            f"jump {name}: time estimate/tolerance",
            result["estimate_time"].max() / result["energy_norm"].max() / tolerance,
            0,
            2,
        )
        report.figure(f"jump {name}: steps", len(result["t"]) - 1, 0, 12 / tolerance)
        report.figure(
            f"jump {name}: longest over shortest step",
            result["k"].max() / result["k"][1:].min(),
            1e3,
        )


@case(
    "Step control",
    "a dropped step leaves nothing: the accepted steps given one by one give the "
    "same bits",
)
def dropped_steps(size, report):
    entries = {
        "Geometry/Arguments": f"{size(8, 32)}, {size(4, 16)} : 0, 0 : 2, 1 : true",
        "Output/Fields every": 0,
        "Step control/Tolerance": 0.05,
    }
    for solver in "direct", "multigrid":
        result = DroppedSteps().same_as_given_steps(
            "slab", {**entries, "Solver/Linear solver": solver}
        )
        report.figure(f"{solver}: dropped steps", result["rejected"].sum(), 1)
        report.figure(
            f"{solver}: accepted steps, equal bit by bit", len(result["t"]) - 1, 1
        )


@case(
    "Step control",
    "onset and return of slip of a block at known times, found to the tolerance asked",
)
def slip_events(size, report):
    tolerance = size(1e-4, 1e-7)
    result = run(
        STICK_SLIP,
        {
            "Time/Phases": "1: 2, 2: 4, 4: 4",
            "Step control/Tolerance": 0.01,
            "Step control/Largest step": 0.3,
            "Step control/Event tolerance": tolerance,
            "Step control/Smallest step": 0.1 * tolerance,
        },
    )
    t, k = result["t"], result["k"]
    for name, exact, phase in (
        ("onset", 1 + 0.104 / 0.3, 1), ("return", 3 - 0.092 / 0.3, 2)
    ):
        found = int(np.argmax((result["slip_area"] > 1) & (t > exact - 0.1)))
        report.figure(
            f"{name}: time error/tolerance", (t[found] - exact) / (tolerance * phase),
            -1e-6 / tolerance * 1e-3, 1,
        )
        report.figure(f"{name}: step/tolerance", k[found] / (tolerance * phase), 0, 1.001)
    report.figure("accepted steps", len(t) - 1, 0, size(80, 120))
    report.figure("dropped steps", result["rejected"].sum(), 1)
