# SPDX-License-Identifier: LGPL-2.1-or-later
"""The reference cases of tests/regression, beside their independent values."""

import os
import sys

import numpy as np

from plotting.results import UserError

from . import program, tables

NAMES = {
    "friction_force_x": "friction force, x",
    "friction_force_y": "friction force, y",
    "point0_x": "displacement of the corner, x",
    "point0_y": "displacement of the corner, y",
    "strain_energy": "strain energy",
    "stress_norm": "norm of the stress",
    "mean_von_mises": "mean von Mises stress",
    "slip_area": "slipping length",
}


def load(runner):
    """The tests that hold the values; they run the program of `runner`."""
    os.environ.update(runner.environment)
    os.environ["VISCOPLASTIC_CONTACT"] = str(runner.executable)
    tests = str(program.SOURCE / "tests" / "regression")
    if tests not in sys.path:
        sys.path.insert(0, tests)
    import shear_layer
    import test_pad
    import test_slab

    return test_slab, test_pad, shear_layer


def rows(runner):
    slab, pad, layer = load(runner)
    try:
        return [
            *slab_rows(slab, max(slab.SLAB)),
            *block_rows(slab, max(slab.BLOCK)),
            *pad_rows(pad, max(pad.PAD)),
            *layer_rows(layer, 32, 80),
        ]
    except AssertionError as error:  # what the tests raise for a failed run
        raise UserError(f"a reference case failed: {error}") from error


def slab_rows(slab, n):
    result = slab.slab(n)
    rows = []
    for t, values in slab.SLAB[n].items():
        for name, value in zip((*slab.COLUMNS, "slip_area"), values):
            rows.append(
                tables.reference_row(
                    "SLAB",
                    f"{2 * n} x {n}, {2 * n} steps",
                    t,
                    NAMES[name],
                    result[name][result.row(t)],
                    value,
                )
            )
    return rows


def block_rows(slab, n):
    energy, corner, force, *_ = slab.BLOCK[n]
    result = slab.run(
        "half_clamped_block",
        {"Geometry/Arguments": f"{n}, {n} : 0, 0 : 1, 1 : true"},
    )
    contact = result.fields("contact")
    nodes = contact.nodes()
    x = contact.points[nodes, 0]
    weight = np.where((x == x.min()) | (x == x.max()), 0.5, 1) / n
    traction = contact.point_data["traction"][nodes, 0]
    right = -(weight * traction)[x > 0.5 + 1e-9].sum()
    return [
        tables.reference_row("HALF-CLAMPED BLOCK", f"{n} x {n}, 1 step", 1, *row)
        for row in (
            ("strain energy", result["strain_energy"][-1], energy),
            ("displacement of the corner, x", result["point0_x"][-1], corner),
            ("friction force on the right half", right, force),
        )
    ]


def pad_rows(pad, n):
    n_steps, *values = pad.PAD[n]
    result = pad.run(
        "pad",
        {
            "Geometry/Arguments": f"{n}, {n}, {n} : 0, 0, 0 : 1, 1, 1 : true",
            "Time/Phases": f"1.5: {n_steps}",
        },
    )
    return [
        tables.reference_row(
            "PAD",
            f"{n} x {n} x {n}, {n_steps} steps",
            1.5,
            NAMES[name],
            result[name][-1],
            value,
        )
        for name, value in zip(pad.COLUMNS, values)
    ]


def layer_rows(layer, n, n_steps):
    """The foot, against the closed form and against that of the scheme."""
    foot = layer.layer(n, n_steps)["point0_x"][-1]
    size = f"{n} x {n}, {n_steps} steps"
    scheme = float(layer.discrete_displacement(np.zeros(1), 1.0, n_steps)[0])
    return [
        tables.reference_row(
            "SHEAR LAYER", size, 1, "foot, closed form of the scheme", foot, scheme
        ),
        tables.reference_row("SHEAR LAYER", size, 1, "foot, closed form", foot, 0.31),
    ]
