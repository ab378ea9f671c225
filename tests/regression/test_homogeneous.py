# SPDX-License-Identifier: LGPL-2.1-or-later
"""Uniform states with known answers: Coulomb sliders and Perzyna flow.

The fields lie in the finite element space, so the program must reproduce the
answer of the scheme to solver tolerance.
"""

import numpy as np

from harness import TestCase, main, run


class CoulombBlock(TestCase):
    def test_slider_that_goes_and_returns(self):
        """2D: stick, slip, stick on the way back, slip the other way."""
        result = run("coulomb_block_2d", {"Output/Additional fields": "friction work"})
        mu, p_wave = 1 / 2.6, 0.3 / 1.3 / 0.4 + 2 / 2.6
        tau, foot, slip_work, area = [0.0], [0.0], [0.0], [None]
        t = result["t"]
        for time in t[1:]:
            drive = 0.3 * min(max(0, time - 1), 3 - time)
            bound = 0.04 * min(time, 1)
            trial = mu * (drive - foot[-1])
            force = np.clip(trial, -bound, bound)
            tau.append(force)
            foot.append(drive - force / mu)
            # per unit area; the face has length 2
            slip_work.append(slip_work[-1] + 2 * force * (foot[-1] - foot[-2]))
            area.append(2.0 if abs(trial) > bound else 0.0)
        pressure = 0.1 * np.minimum(t, 1)
        tau, foot = np.array(tau), np.array(foot)

        self.assertClose(result["point0_x"], foot, absolute=1e-9, what="foot")
        self.assertClose(
            result["point0_y"], pressure / p_wave, absolute=1e-9, what="rise"
        )
        self.assertClose(
            result["friction_force_x"], 2 * tau, absolute=1e-10, what="force"
        )
        self.assertClose(
            result["friction_dissipation"], slip_work, absolute=1e-9, what="slip work"
        )
        energy = pressure**2 / p_wave + tau**2 / mu
        self.assertClose(result["strain_energy"], energy, absolute=1e-10)
        self.assertClose(result["slip_area"][1:], area[1:], absolute=1e-12)
        # both phases of slip occur: at 0.04 to the right, then to the left
        self.assertIn(2.0, area[1:])
        self.assertClose([tau.max(), tau.min()], [0.04, -0.04], absolute=1e-15)
        self.check_identities(result)

        contact = result.fields("contact")
        self.assertClose(contact.point_data["traction"][:, 0], -tau[-1], absolute=1e-8)
        self.assertClose(contact.point_data["bound"], 0.04, absolute=1e-8)
        self.assertClose(
            contact.point_data["friction_work"], slip_work[-1] / 2, 1e-6, 1e-9
        )
        # accumulated slip: from zero to the end position
        self.assertClose(contact.point_data["slip"][:, 0], foot[-1], absolute=1e-8)

    def check_turning(self, **more):
        more["Output/Additional fields"] = "friction work"
        result = run("coulomb_block_3d", more)
        mu = 0.5
        foot, tau, work = [np.zeros(2)], [np.zeros(2)], [0.0]
        t = result["t"]
        for time in t[1:]:
            s = np.pi / 2 * max(0, time - 1)
            drive = 0.3 * np.array([np.sin(s), 1 - np.cos(s)])
            bound = 0.04 * min(time, 1)
            trial = mu * (drive - foot[-1])
            force = trial * min(1, bound / max(np.linalg.norm(trial), 1e-300))
            foot.append(drive - force / mu)
            tau.append(force)
            work.append(work[-1] + force @ (foot[-1] - foot[-2]))
        foot, tau = np.array(foot), np.array(tau)
        for point in "point0", "point1":
            got = result.vector(point)
            self.assertClose(got[:, :2], foot, absolute=1e-8, what=f"{point}")
            self.assertClose(got[:, 2], 0.1 * np.minimum(t, 1), absolute=1e-9)
        self.assertClose(
            result.vector("friction_force")[:, :2], tau, absolute=1e-9, what="force"
        )
        self.assertClose(result["friction_dissipation"], work, absolute=1e-8)
        self.assertClose(
            result.fields("contact").point_data["friction_work"],
            work[-1],
            absolute=1e-7,
        )
        # the force has turned by nearly 180 degrees
        first = tau[np.argmax(np.linalg.norm(tau, axis=1) > 0.0399)]
        self.assertLess(tau[-1] @ first, -0.8 * 0.04**2)
        self.check_identities(result)

    def test_slip_direction_that_turns(self):
        """3D: radial return, step by step, while the drive turns by 180
        degrees."""
        self.check_turning()

    def test_slip_direction_that_turns_with_multigrid(self):
        self.check_turning(**{"Solver/Linear solver": "multigrid"})


class Perzyna(TestCase):
    E, NU, RADIUS, VISCOSITY = 1.0, 0.3, 0.1, 0.2
    MU = E / 2 / (1 + NU)
    LAMBDA = E * NU / (1 + NU) / (1 - 2 * NU)

    def hooke(self, strain):
        return self.LAMBDA * strain.sum() + 2 * self.MU * strain

    def rate(self, stress):
        """G for the principal values: the return to the ball is deviatoric."""
        deviator = stress - stress.mean()
        norm = np.linalg.norm(deviator)
        excess = max(0, 1 - self.RADIUS / norm) if norm > 0 else 0
        return -2 * self.MU / self.VISCOSITY * excess * deviator

    def strain_for(self, irreversible, shortening, free):
        """Principal strains; the listed ones follow from zero stress."""
        strain = np.array(shortening, float)
        matrix = self.LAMBDA + 2 * self.MU * np.eye(3)
        given = [i for i in range(3) if i not in free]
        rhs = -irreversible - matrix[:, given] @ strain[given]
        strain[free] = np.linalg.solve(matrix[np.ix_(free, free)], rhs[free])
        return strain

    def history(self, times, axis, free):
        """Stress, strain, and the history of the viscous work rate."""
        z = np.zeros(3)
        stress, strain = [np.zeros(3)], [np.zeros(3)]
        for old, new in zip(times[:-1], times[1:]):
            z = z + (new - old) * self.rate(stress[-1])
            shortening = np.zeros(3)
            shortening[axis] = -0.3 * min(new, 1)
            strain.append(self.strain_for(z, shortening, free))
            stress.append(self.hooke(strain[-1]) + z)
        return np.array(stress), np.array(strain)

    def mises(self, stress):
        deviator = stress - stress.mean(axis=1, keepdims=True)
        return np.sqrt(1.5) * np.linalg.norm(deviator, axis=1)

    def compare(self, result, stress, strain, names):
        # default contact tolerance; no contact here, so the direct solver's
        # rounding is all
        for component, name in enumerate(names):
            if name:
                self.assertClose(
                    result[name], strain[:, component], absolute=1e-9, what=name
                )
        for name in "max_von_mises", "mean_von_mises":
            self.assertClose(result[name], self.mises(stress), absolute=1e-9, what=name)
        self.assertClose(
            result["stress_norm"], np.linalg.norm(stress, axis=1), absolute=1e-9
        )
        fields = result.fields()
        for component, name in enumerate(("stress_xx", "stress_yy", "stress_zz")):
            # single precision
            self.assertClose(
                fields.cell_data[name], stress[-1, component], absolute=1e-7, what=name
            )
        irreversible = stress[-1] - self.hooke(strain[-1])
        self.assertClose(
            fields.cell_data["irreversible_stress_zz"], irreversible[2], absolute=1e-7
        )
        self.check_identities(result)

    def test_plane_strain_recursion(self):
        result = run("perzyna_compression_2d")
        stress, strain = self.history(result["t"], axis=1, free=[0])
        self.compare(result, stress, strain, ("point0_x", "point0_y", None))
        # relaxed to the yield surface: 3 units of time at a rate of 3.85
        self.assertClose(
            result["max_von_mises"][-1], np.sqrt(1.5) * self.RADIUS, relative=1e-4
        )
        # plane strain is not plane stress
        self.assertLess(stress[-1, 2], -0.01)

    def test_three_dimensional_recursion(self):
        result = run("perzyna_compression_3d")
        stress, strain = self.history(result["t"], axis=2, free=[0, 1])
        self.compare(result, stress, strain, ("point0_x", "point0_y", "point0_z"))
        fields = result.fields()
        self.assertClose(
            fields.cell_data["stress_zz"], -np.sqrt(1.5) * self.RADIUS, relative=1e-4
        )

    def test_first_order_against_the_differential_equation(self):
        """At t = 1, flow in full course."""
        fine = np.linspace(0, 1, 20001)
        exact = self.history(fine, axis=1, free=[0])[1][-1][0]
        errors = []
        for n_steps in 10, 20, 40:
            result = run("perzyna_compression_2d", {"Time/Phases": f"1: {n_steps}"})
            errors.append(abs(result["point0_x"][-1] - exact))
        orders = np.log2(np.divide(errors[:-1], errors[1:]))
        # the error has a second-order part: 10 % of the order at k = 1/10
        self.assertClose(orders, 1, absolute=0.15, what="order in k")

    def test_energy_goes_where_it_should(self):
        """Work in = stored + viscous dissipation, up to the first-order error
        of the scheme; nothing leaks while the plate rests."""
        result = run("perzyna_compression_2d")
        work = result["external_work"]
        balance = result["stored_energy"] + result["viscous_dissipation"]
        self.assertClose(balance, work, absolute=0.1 * work.max())
        self.assertClose(
            result["energy_balance_defect"],
            work - balance,
            absolute=1e-9,
            what="the defect is the difference",
        )
        rest = result["t"] > 1
        self.assertClose(np.diff(work[rest]), 0, absolute=1e-12)
        self.assertGreater(np.diff(result["viscous_dissipation"])[1:].min(), -1e-14)


if __name__ == "__main__":
    main()
