# SPDX-License-Identifier: LGPL-2.1-or-later
"""A rotated and translated scene gives the rotated answer.

Only rounding and the solver tolerance tell the two runs apart: the contact
tolerance is 1e-10 in the energy norm, so forces and displacements agree to
some 1e-8 of their maximum.
"""

import unittest

import numpy as np

from harness import DEFECTS, EFFORT, TestCase, main, run

AGREE = 1e-7


def rotation(degrees, axis=None):
    """Rotation matrix: about z in 2D, about axis in 3D (Rodrigues)."""
    angle = np.radians(degrees)
    if axis is None:
        return np.array(
            [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        )
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def expressions(matrix, components):
    """The rotated vector of expressions, in parameter-file form."""
    return "; ".join(
        " + ".join(
            f"({entry:.17g})*({text})" for entry, text in zip(row, components)
        )
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
                "Boundary 0/Traction": expressions(
                    matrix, ("0.3*min(t, 2 - t)", "0")
                ),
                "Output/Points": "-3, 0.7",
            },
        )
        self.compare(straight, turned, matrix)

    def test_coulomb_block_by_30_degrees(self):
        """Given normal stress on an oblique line, which moves normally."""
        matrix = rotation(30)
        pressure = "0.1*min(t, 1)"
        tau = (
            "min(min(1.5/13*max(0, t-1), 0.04), max(0.04 - 1.5/13*(t-2), -0.04))"
        )
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
                "Boundary 1/Traction": expressions(
                    matrix, (f"-3/7*{pressure}", tau)
                ),
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


if __name__ == "__main__":
    main()
