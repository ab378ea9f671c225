# SPDX-License-Identifier: LGPL-2.1-or-later
"""The shear layer: closed form, orders in h and k, 2D and 3D.

The scheme reproduces the layer at the nodes in space, and in time it replaces
the integral of tau by its left Riemann sum.  Three levels of truth follow: the
closed form, the discrete closed form (equal to solver tolerance), and the
orders of convergence.
"""

import numpy as np

from harness import TestCase, main, run
from shear_layer import (
    BOUND,
    MU,
    PUSH,
    discrete_displacement,
    displacement,
    layer,
    strain,
    tau,
)


def nodal_error(result):
    fields = result.fields()
    u = fields.point_data["displacement"]
    return abs(u[:, 0] - displacement(fields.points[:, 1], 1)).max()


def energy_error(result):
    """(int mu (u_x,y - gamma)^2)^(1/2) by three Gauss points in y."""
    fields = result.fields()
    y = fields.points[fields.cells][:, :, 1]
    u = fields.point_data["displacement"][fields.cells][:, :, 0]
    low, high = y.argmin(axis=1), y.argmax(axis=1)
    cell = np.arange(len(y))
    y0, y1 = y[cell, low], y[cell, high]
    gradient = (u[cell, high] - u[cell, low]) / (y1 - y0)
    error = 0
    for point, weight in zip(
        (-np.sqrt(0.6), 0, np.sqrt(0.6)), (5 / 18, 8 / 18, 5 / 18)
    ):
        at = (y0 + y1) / 2 + point * (y1 - y0) / 2
        error += weight * (gradient - strain(at, 1)) ** 2
    return np.sqrt(MU * np.mean(error))


def stress_error(result):
    """L2 error of the shear stress, constant in the cells; tau is linear."""
    fields = result.fields()
    y = fields.points[fields.cells][:, :, 1]
    middle, height = y.mean(axis=1), y.max(axis=1) - y.min(axis=1)
    at_middle = fields.cell_data["stress_xy"] - tau(middle, 1)
    return np.sqrt(np.mean(at_middle**2 + PUSH**2 * height**2 / 12))


class ClosedForm(TestCase):
    def test_self_check_of_the_formulas(self):
        """The foot displacement of the closed form is 0.31."""
        self.assertClose(displacement(0.0, 1.0), 0.31, absolute=1e-12)

    def test_foot_displacement(self):
        """u_x(0,1) = 0.31 up to the Riemann sum, 0.1 k."""
        result = layer(16, 200)
        foot = result["point0_x"][-1]
        self.assertClose(foot, 0.31, absolute=1.02 * 0.1 / 200, what="foot")
        self.check_identities(result)

    def test_sticks_before_and_slips_after_the_threshold(self):
        """All of the face sticks for t < 0.5 and slips for t > 0.5; at
        t = 0.5 itself rounding may decide."""
        result = layer(8, 20)
        before, after = result["t"] < 0.5 - 1e-9, result["t"] > 0.5 + 1e-9
        self.assertClose(result["stick_area"][before], 1, absolute=1e-12)
        self.assertClose(result["slip_area"][after], 1, absolute=1e-12)
        # friction force: the bound times the length, or half the push
        force = np.minimum(PUSH * result["t"] / 2, BOUND)
        self.assertClose(result["friction_force_x"], force, absolute=1e-9)
        self.check_identities(result)


class Orders(TestCase):
    def test_first_order_in_h_and_k_together(self):
        """Nodal errors of the reference solver, three digits each, which are
        0.1125 k; the energy norm adds the error in space."""
        reference = [5.63e-3, 2.81e-3, 1.41e-3, 7.03e-4]
        nodal, energy, stress = [], [], []
        for level, expected in enumerate(reference):
            result = layer(8 * 2**level, 20 * 2**level)
            self.check_identities(result)
            nodal.append(nodal_error(result))
            energy.append(energy_error(result))
            stress.append(stress_error(result))
            # half a unit of the third digit
            self.assertClose(nodal[-1], expected, relative=0.004, what="nodal error")
        for name, errors in ("nodal", nodal), ("energy", energy), ("stress", stress):
            orders = np.log2(np.divide(errors[:-1], errors[1:]))
            self.assertClose(orders, 1, absolute=0.01, what=f"order, {name} error")

    def test_first_order_in_k_alone(self):
        """On one mesh the nodal error is 0.1125 k, without a floor."""
        for n_steps in 10, 20, 40, 80, 160:
            error = nodal_error(layer(4, n_steps))
            # VTU may hold single precision: 1e-7 of displacements up to 0.5
            self.assertClose(error, 0.1125 / n_steps, absolute=1e-7)

    def test_first_order_in_h_alone(self):
        """With k = 1/320 the error in time is under 1 % of that in space and
        adds in squares, so the orders are 1 within 0.001."""
        results = [layer(n, 320) for n in (4, 8, 16)]
        for measure in energy_error, stress_error:
            errors = [measure(result) for result in results]
            orders = np.log2(np.divide(errors[:-1], errors[1:]))
            self.assertClose(orders, 1, absolute=0.005, what=measure.__name__)


class Discrete(TestCase):
    """Against the discrete closed form the only error is the solver's: 1e-10
    relative in energy, some 1e-9 in displacements of size one."""

    def check(self, result, n_steps, length):
        t = result["t"]
        for step in range(1, len(t)):
            foot = discrete_displacement(0.0, t[step], step)
            self.assertClose(result["point0_x"][step], foot, absolute=1e-8)
        force = length * np.minimum(PUSH * t / 2, BOUND)
        self.assertClose(result["friction_force_x"], force, absolute=1e-9)
        fields = result.fields()
        u = fields.point_data["displacement"]
        expected = discrete_displacement(fields.points[:, 1], 1.0, n_steps)
        # single precision in VTU
        self.assertClose(u[:, 0], expected, absolute=1e-7, what="u_x")
        self.assertClose(u[:, 1:], 0, absolute=1e-7, what="u_y, u_z")
        self.check_identities(result)

    def test_plane_strain(self):
        self.check(layer(8, 20), 20, 1)

    def test_three_dimensions(self):
        self.check(run("shear_layer_3d"), 20, 0.5 * 0.25)

    def test_multigrid_finds_the_same(self):
        for scene, area in ("shear_layer_2d", 1), ("shear_layer_3d", 0.125):
            self.check(run(scene, {"Solver/Linear solver": "multigrid"}), 20, area)

    def test_mean_dilatation_and_quadrature_points_change_nothing(self):
        """The layer does not change its volume, and its strain is constant in
        each cell, so every variant of the scheme is the same here."""
        for variant in (
            {"Material/Volumetric integration": "mean dilatation"},
            {"Material/Stress history": "quadrature points"},
        ):
            self.check(layer(8, 20, **variant), 20, 1)


if __name__ == "__main__":
    main()
