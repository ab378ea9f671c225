# SPDX-License-Identifier: LGPL-2.1-or-later
"""SLAB and HALF-CLAMPED BLOCK against an independent solver.

The independent solver uses the same discretization with a dense condensed
contact operator, so equal meshes give equal numbers: the tolerance 1e-4 leaves
room for the seven decimals of the table and nothing else.
"""

import numpy as np

from harness import TestCase, main, run

# n: {t: friction force, u_x(0,0), strain energy, stress norm, mean von Mises,
#        slipping length}
SLAB = {
    16: {
        1: (0.1281782, 0.1728337, 0.0312279, 0.2675133, 0.0952378, 1.21875),
        2: (-0.0097969, 0.1393841, 0.0069661, 0.0925598, 0.0271114, 0.28125),
    },
    32: {
        1: (0.1284801, 0.1724429, 0.0317950, 0.2693793, 0.0953943, 1.234375),
        2: (-0.0097815, 0.1404744, 0.0070095, 0.0927256, 0.0271553, 0.265625),
    },
    # for contrib/make_results
    64: {
        1: (0.1286070, 0.1721910, 0.0320548, 0.2701453, 0.0954231, 1.2421875),
        2: (-0.0097675, 0.1409966, 0.0070280, 0.0927533, 0.0271528, 0.2890625),
    },
}
COLUMNS = (
    "friction_force_x", "point0_x", "strain_energy", "stress_norm", "mean_von_mises"
)

# n: strain energy, u_x(1,0), friction force on x > 1/2, last stuck node, first
# slipping node
BLOCK = {
    32: (0.005715063, 0.0095272, 0.0079543, 0.65625, 0.6875),
    64: (0.005713638, 0.0094128, 0.0079544, 0.65625, 0.671875),
}


def slab(n, **more):
    return run(
        "slab",
        {
            "Geometry/Arguments": f"{2 * n}, {n} : 0, 0 : 2, 1 : true",
            "Time/Phases": f"1: {n}, 2: {n}",
            **more,
        },
    )


class Slab(TestCase):
    def check(self, result, n):
        for t, values in SLAB[n].items():
            step = result.row(t)
            for name, expected in zip(COLUMNS, values):
                # the tables end at the seventh decimal
                self.assertClose(
                    result[name][step],
                    expected,
                    relative=1e-4,
                    absolute=6e-8,
                    what=f"n = {n}, t = {t}, {name}",
                )
            # one node more or less is a tie
            self.assertClose(
                result["slip_area"][step], values[-1], absolute=1.01 / n, what="slip"
            )
            self.assertClose(
                result["slip_area"][step] + result["stick_area"][step],
                2,
                absolute=1e-10,
                what="stick and slip make up the face",
            )
        self.check_identities(result)

    def test_reference_values_16_cells_high(self):
        self.check(slab(16), 16)

    def test_reference_values_32_cells_high(self):
        self.check(slab(32), 32)

    def test_reference_values_with_multigrid(self):
        self.check(slab(16, **{"Solver/Linear solver": "multigrid"}), 16)

    def test_contact_iterations_stay_few(self):
        """The independent active set took 2 iterations on average and 4 at
        most; a method that cycles or creeps along the front takes many more,
        and ties may cost a few."""
        result = slab(32)
        self.assertLessEqual(result["contact_iterations"][1:].mean(), 5)
        self.assertLessEqual(result["contact_iterations"].max(), 15)

    def test_energy_balance_closes_with_the_step(self):
        """Work, stored energy and dissipation are sums by the trapezoidal
        rule, so the defect is of second order, and small: 5e-4 of the work for
        k = 1/16."""
        defects = []
        for n_steps in 16, 32, 64, 128:
            result = slab(16, **{"Time/Phases": f"1: {n_steps}, 2: {n_steps}"})
            defects.append(abs(result["energy_balance_defect"]).max())
            total = (
                result["stored_energy"]
                + result["viscous_dissipation"]
                + result["friction_dissipation"]
                + result["energy_balance_defect"]
            )
            work = result["external_work"]
            self.assertClose(total, work, absolute=1e-12, what="the sum")
            if n_steps == 16:
                self.assertLessEqual(defects[0], 1e-3 * work.max())
        # The front passes nodes in single steps: the order over three
        # halvings is sharp within a third.
        order = np.log2(defects[0] / defects[-1]) / 3
        self.assertClose(order, 2, absolute=0.35, what="order of the defect")

    def test_dissipation_is_real(self):
        """Friction and viscosity both take energy out."""
        result = slab(16)
        self.assertGreater(result["friction_dissipation"][-1], 1e-3)
        viscous = result["viscous_dissipation"]
        self.assertGreater(viscous[-1], 1e-3)
        self.assertGreaterEqual(np.diff(viscous).min(), 0)


class FrictionBounds(TestCase):
    """Extreme bounds are ordinary data."""

    def test_zero_bound_slides_freely(self):
        """rho = 0: no friction points, the same as friction law none."""
        zero = slab(16, **{"Boundary 2/Friction bound": 0})
        none = slab(16, **{"Boundary 2/Friction law": "none"})
        self.assertClose(zero["friction_force_x"], 0, absolute=0)
        for name in "point0_x", "strain_energy", "stress_norm":
            scale = abs(none[name]).max()
            self.assertClose(zero[name], none[name], absolute=1e-9 * scale, what=name)

    def test_huge_bound_holds(self):
        """rho = 1e10: all stick, the same as a clamped foot."""
        huge = slab(16, **{"Boundary 2/Friction bound": 1e10})
        held = slab(16, **{"Boundary 2/Role": "clamped"})
        self.assertClose(huge["slip_area"], 0, absolute=0)
        # the fast reaction of the clamped foot is minus the friction force
        self.assertClose(
            huge["friction_force_x"],
            -held["reaction_2_x"],
            absolute=1e-8 * abs(held["reaction_2_x"]).max(),
            what="friction force",
        )
        for name in "strain_energy", "stress_norm":
            scale = abs(held[name]).max()
            self.assertClose(huge[name], held[name], absolute=1e-8 * scale, what=name)

    def check_variant(self, overrides, values):
        """Against the independent solver, same mesh, steps and quadrature of
        the bound: smallest, largest and last friction force, displacement of
        the corner, friction dissipation, largest slipping length, energy."""
        result = slab(16, **overrides)
        self.check_identities(result)
        force = result["friction_force_x"]
        got = (
            force.min(),
            force.max(),
            force[-1],
            result["point0_x"][-1],
            result["friction_dissipation"][-1],
            result["slip_area"].max(),
            result["strain_energy"][-1],
        )
        # 1e-4 leaves room for another quadrature of a bound that is no
        # polynomial
        self.assertClose(got, values, relative=1e-4, absolute=1e-8)
        return result

    def test_bound_over_eight_orders_of_magnitude(self):
        """rho from 8e-8 to 8 along the face: the corner is held."""
        result = self.check_variant(
            {"Boundary 2/Friction bound": "8*10^(-4*x)"},
            (
                -0.0074978186,
                0.1188183937,
                -0.0074978186,
                0,
                0.00087704074,
                1.65625,
                0.00693209792,
            ),
        )
        self.assertGreater(result["stick_area"].min(), 0)

    def test_bound_that_jumps(self):
        """A bound of 0.02 on one half and 0.3 on the other; the slip stops
        one node behind the jump."""
        self.check_variant(
            {"Boundary 2/Friction bound": "if(x<1, 0.02, 0.3)"},
            (
                -0.00099026709,
                0.1068304071,
                -0.00099026709,
                0.1376120838,
                0.00528666508,
                1.09375,
                0.00779140003,
            ),
        )

    def test_repeated_reversal(self):
        """Eight reversals under a bound that varies: textbook active sets
        cycle here."""
        self.check_variant(
            {
                "Boundary 0/Traction": "0.3*sin(4*pi*t); 0",
                "Boundary 2/Friction bound": "0.05*(1.2 + sin(9*x))",
                "Time/Phases": "2: 96",
            },
            (
                -0.1130039848,
                0.1139166819,
                0.0279012520,
                -0.1123488366,
                0.1103785831,
                1.8125,
                0.00223047854,
            ),
        )


class HalfClampedBlock(TestCase):
    def check(self, n, **more):
        energy, corner, force, last_stuck, first_slipping = BLOCK[n]
        result = run(
            "half_clamped_block",
            {"Geometry/Arguments": f"{n}, {n} : 0, 0 : 1, 1 : true", **more},
        )
        self.check_identities(result)
        self.assertClose(result["strain_energy"][-1], energy, relative=1e-4)
        self.assertClose(result["point0_x"][-1], corner, relative=1e-4)
        # antisymmetric
        self.assertClose(result["friction_force_x"][-1], 0, absolute=1e-10)

        contact = result.fields("contact")
        nodes = contact.nodes()
        x = contact.points[nodes, 0]
        order = np.argsort(x)
        nodes, x = nodes[order], x[order]
        self.assertEqual(len(x), n + 1)
        self.assertClose(contact.points[:, 1:], 0, absolute=1e-12)
        weight = np.where((x == x[0]) | (x == x[-1]), 0.5, 1) / n
        traction = contact.point_data["traction"][nodes, 0]
        right = x > 0.5 + 1e-9
        # VTU may hold single precision
        self.assertClose(
            -(weight * traction)[right].sum(), force, relative=1e-4, what="force"
        )
        stick = contact.point_data["stick"][nodes] > 0.5
        self.assertClose(x[stick & right].max(), last_stuck, absolute=1e-6)
        self.assertClose(x[~stick & right].min(), first_slipping, absolute=1e-6)
        # slip outwards on both sides, and against the traction
        slip = contact.point_data["slip"][nodes, 0]
        self.assertTrue(np.all(slip[~stick] * (x[~stick] - 0.5) > 0))
        self.assertTrue(np.all(slip[~stick] * traction[~stick] < 0))

    def test_reference_values_32(self):
        self.check(32)

    def test_reference_values_64(self):
        self.check(64)

    def test_reference_values_with_multigrid(self):
        self.check(32, **{"Solver/Linear solver": "multigrid"})


if __name__ == "__main__":
    main()
