# SPDX-License-Identifier: LGPL-2.1-or-later
"""Time integration: backward Euler and Heun against recursions, limits, orders.

The recursions are written from the formulas of doc/method.md and share nothing
with the program: the implicit equation is solved here by Newton's method with
differences.
"""

import numpy as np
from scipy.integrate import solve_ivp

from harness import TestCase, main, run
from laws import (
    E,
    HARDENING,
    LAWS,
    NORTON,
    PERZYNA,
    SOFT,
    THREE,
    dev,
    displacement_gradient,
    norm,
    pressure,
)
from runs import EVERY_STEP, Job, without_wall_times
from shear_layer import MU, THETA, layer, tau
from rank_comparison import Comparison, compare_columns

COMPONENTS = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))

BACKWARD = {"Time/Scheme": "backward Euler"}
HEUN = {"Time/Scheme": "Heun"}
POINTS = {"Material/Stress history": "quadrature points"}


def law_entries(name):
    entries = {f"Material/{name}/{entry}": v for entry, v in LAWS[name][1].items()}
    return {"Material/Law": name, **entries}


def pack(tensor):
    return np.array([tensor[i, j] for i, j in COMPONENTS])


def unpack(vector):
    tensor = np.zeros((3, 3))
    for value, (i, j) in zip(vector, COMPONENTS):
        tensor[i, j] = tensor[j, i] = value
    return tensor


def backward_euler(law, z_old, strain, t, k):
    """z with z = z_old + k G(E eps + z, eps), by continuation in k."""

    def newton(z, step):
        def residual(x):
            rate = law(E(strain) + unpack(x), strain, None, t)
            return x - pack(z_old) - step * pack(rate)

        size = norm(E(strain)) + norm(z_old)
        for _ in range(60):
            value = residual(z)
            matrix = np.zeros((6, 6))
            for i in range(6):
                h = 1e-7 * size * np.eye(6)[i]
                matrix[:, i] = (residual(z + h) - residual(z - h)) / (2e-7 * size)
            change = np.linalg.solve(matrix, -value)
            damping = 1.0
            while np.linalg.norm(residual(z + damping * change)) > np.linalg.norm(
                value
            ):
                damping /= 2
                if damping < 1e-6:
                    break
            z = z + max(damping, 1e-6) * change
            if np.linalg.norm(change) < 1e-14 * size:
                return z
        return z

    z = pack(z_old)
    for share in 1e-3, 1e-2, 0.1, 0.4, 1:
        z = newton(z, share * k)
    return unpack(z)


def strain_at(t, dim, course):
    """min(t, 2 - t) of test_materials replaced by another course."""
    gradient = displacement_gradient(1.0, dim) * course(t)
    return 0.5 * (gradient + gradient.T)


def recursion(scheme, law, times, dim, course):
    """Strains and stresses of the uniform body."""
    strains = [strain_at(t, dim, course) for t in times]
    z, stresses = np.zeros((3, 3)), [E(strains[0])]
    for n in range(1, len(times)):
        k = times[n] - times[n - 1]
        if scheme == "backward Euler":
            z = backward_euler(law, z, strains[n], times[n], k)
        else:
            rate = law(stresses[-1], strains[n - 1], None, times[n - 1])
            predicted = E(strains[n]) + z + k * rate
            z = z + k / 2 * (rate + law(predicted, strains[n], None, times[n]))
        stresses.append(E(strains[n]) + z)
    return np.array(strains), np.array(stresses)


def driven_by(course, dim):
    """The displacement of the whole boundary, as in uniform_strain.prm."""
    rows = THREE["Boundary 0/Displacement"].split(";")
    if dim == 2:
        rows = rows[0], rows[1]
    return {
        "Boundary 0/Displacement": ";".join(
            row.replace("min(t, 2 - t)", course) for row in rows
        )
    }


def orders(errors):
    return np.log2(np.divide(errors[:-1], errors[1:]))


def order_of(coarse, fine):
    """Between runs of which one has four times the steps of the other."""
    return np.log2(coarse / fine) / 2


class UniformStrain(TestCase):
    def check(
        self, scheme, name, dim, course=None, text="min(t, 2 - t)", law=None, **more
    ):
        result = run(
            "uniform_strain",
            {
                "Time/Scheme": scheme,
                "Output/Fields every": 0,
                **(THREE if dim == 3 else {}),
                **law_entries(name),
                **driven_by(text, dim),
                **more,
            },
        )
        strain, stress = recursion(
            scheme,
            law or LAWS[name][0],
            result["t"],
            dim,
            course or (lambda t: min(t, 2 - t)),
        )
        scale = np.abs(stress).max()
        self.assertClose(
            result["stress_norm"],
            [norm(s) for s in stress],
            absolute=1e-9 * scale,
            what=f"{scheme}, {name}, {dim}D: norm of the stress",
        )
        self.assertClose(
            result["max_von_mises"],
            [np.sqrt(1.5) * norm(dev(s)) for s in stress],
            absolute=1e-9 * scale,
            what=f"{scheme}, {name}, {dim}D: von Mises stress",
        )
        work = abs(result["external_work"]).max()
        self.assertClose(
            result["energy_balance_defect"], 0, absolute=1e-10 * work, what="energy"
        )
        return result, strain, stress

    def test_backward_euler(self):
        for name in LAWS:
            for dim in 2, 3:
                with self.subTest(f"{name} {dim}D"):
                    self.check("backward Euler", name, dim)

    def test_heun(self):
        for name in LAWS:
            for dim in 2, 3:
                with self.subTest(f"{name} {dim}D"):
                    self.check("Heun", name, dim)

    def test_at_the_quadrature_points(self):
        for scheme in "backward Euler", "Heun":
            for name in LAWS:
                with self.subTest(f"{scheme} {name}"):
                    self.check(scheme, name, 2, **POINTS)

    def test_constant_tangents_take_one_newton_iteration(self):
        """Also where the times of the steps round differently: their matrix is
        that of k to ten digits, which serves for this tolerance."""
        for name in "maxwell", "zener":
            result, _, _ = self.check(
                "backward Euler",
                name,
                2,
                **{"Time/Phases": "2: 30", "Solver/Contact tolerance": 1e-10},
            )
            self.assertEqual(set(result["newton_iterations"][1:]), {1})

    def test_a_thousand_times_the_limit(self):
        """Loaded in one step, then held for two: the state is the relaxed one.
        Without a first step of its own, since the law of 'norton' is stiff
        where the stress is high only."""
        relaxed = {
            "maxwell": lambda e, s: norm(dev(s)),
            "zener": lambda e, s: norm(s - SOFT(e)),
            "perzyna": lambda e, s: norm(dev(s))
            - 0.02
            - 0.3 * np.sqrt(2 / 3) * norm(dev(e) - dev(s) * 1.25),
            "norton": lambda e, s: norm(dev(s)) - 0.004,
        }
        # 2/r of the first three; for norton at the elastic stress, 0.03 or more
        limit = {"maxwell": 2.5, "zener": 1.4, "perzyna": 1.6, "norton": 0.5}
        for name, distance in relaxed.items():
            with self.subTest(name):
                k = 500 * limit[name]  # 1000/r
                result, strain, stress = self.check(
                    "backward Euler",
                    name,
                    3,
                    course=lambda t: min(t / k, 1),
                    text=f"min(t/{k}, 1)",
                    **{"Time/Phases": f"{3 * k}: 3"},
                )
                first = norm(E(strain[1]))
                # the residual stress of three steps is that of 1/(1 + k r)^n
                self.assertLess(
                    distance(strain[-1], stress[-1]),
                    1e-3 * first,
                    f"{name} is not relaxed",
                )
                if name != "norton":
                    self.assertGreater((result["k"] / result["step_limit"])[1:].min(), 499)

    def test_orders_with_a_smooth_course(self):
        """Against the differential equation, solved to 1e-11."""
        course = lambda t: np.sin(2 * t)
        for name in "maxwell", "zener", "norton", "parsed", "perzyna":
            law = LAWS[name][0]

            def slope(t, y):
                strain = strain_at(t, 2, course)
                return pack(law(E(strain) + unpack(y), strain, None, t))

            # not beyond t = 0.9: afterwards perzyna would meet its yield
            # surface again
            solution = solve_ivp(
                slope, (0, 0.9), np.zeros(6), rtol=1e-11, atol=1e-13, max_step=1e-2
            )
            exact = norm(E(strain_at(0.9, 2, course)) + unpack(solution.y[:, -1]))
            for scheme, expected, tolerance in (
                ("forward Euler", 1, 0.15),
                ("backward Euler", 1, 0.15),
                ("Heun", 2, 0.3),
            ):
                errors = []
                for n in 40, 160:
                    result = run(
                        "uniform_strain",
                        {
                            "Output/Fields every": 0,
                            "Time/Scheme": scheme,
                            **law_entries(name),
                            **driven_by("sin(2*t)", 2),
                            "Time/Phases": f"0.9: {n}",
                        },
                    )
                    errors.append(abs(result["stress_norm"][-1] - exact) / exact)
                measured = order_of(*errors)
                print(f"{name}, {scheme}: errors {errors}, order {measured}")
                # the onset of flow of perzyna is a kink within a step
                self.assertClose(
                    measured, expected, absolute=tolerance, what=f"{name}, {scheme}"
                )


class ShearLayer(TestCase):
    """Here the stress follows from the loads, and z is a quadrature of it."""

    def discrete(self, y, n, weights):
        k = 1 / n
        nodes = np.array([y, (y + 1) / 2, 1 + 0 * y])
        memory = sum(w * tau(nodes, i * k) for i, w in enumerate(weights))
        gamma = (tau(nodes, 1.0) + k / THETA * memory) / MU
        return -(1 - y) / 6 * (gamma[0] + 4 * gamma[1] + gamma[2])

    def check(self, scheme, n, weights):
        result = layer(8, n, **{"Time/Scheme": scheme})
        self.check_identities(result)
        fields = result.fields()
        self.assertClose(
            fields.point_data["displacement"][:, 0],
            self.discrete(fields.points[:, 1], n, weights),
            absolute=1e-7,  # single precision
            what=f"{scheme}: sum",
        )
        self.assertClose(
            result["point0_x"][-1],
            self.discrete(np.array(0.0), n, weights),
            absolute=1e-9,
            what=f"{scheme}: foot",
        )
        return abs(result["point0_x"][-1] - 0.31)

    def test_backward_euler_is_the_right_sum(self):
        errors = [self.check("backward Euler", n, [0] + n * [1]) for n in (20, 40, 80)]
        print(f"backward Euler: errors {errors}, orders {orders(errors)}")
        self.assertClose(orders(errors), 1, absolute=0.05, what="order")

    def test_heun_is_the_trapezoidal_sum(self):
        """Exact where the onset of slip, t* = 1/2, is the end of a step; with
        the kink within a step of second order all the same."""
        trapezoid = lambda n: [0.5] + (n - 1) * [1] + [0.5]
        self.assertLess(self.check("Heun", 20, trapezoid(20)), 1e-9)
        errors = [self.check("Heun", n, trapezoid(n)) for n in (11, 33, 99)]
        order = np.log(np.divide(errors[:-1], errors[1:])) / np.log(3)
        print(f"Heun over a kink: errors {errors}, orders {order}")
        self.assertClose(order, 2, absolute=0.05, what="order")

    def test_a_thousand_times_the_limit(self):
        """Loads held from t = 1 on: steady flow at the rate tau/eta, exactly,
        in two steps of 1000 theta."""
        held = "min(0.2*min(t, 1), 0.1) - 0.4*min(t, 1)*y"
        result = layer(
            8,
            20,
            **{
                **BACKWARD,
                "Loads/Body force": "0.4*min(t, 1); 0",
                "Boundary 0/Traction": f"0; -({held})",
                "Boundary 1/Traction": f"0; {held}",
                "Time/Phases": f"1: 20, {1 + 2000 * THETA}: 2",
            },
        )
        self.check_identities(result)
        nodes = np.array([0, 0.5, 1])
        gamma_rate = tau(nodes, 1.0) / MU / THETA
        speed = -(gamma_rate[0] + 4 * gamma_rate[1] + gamma_rate[2]) / 6
        got = np.diff(result["point0_x"][-3:]) / (1000 * THETA)
        # what the tolerance of 1e-10 leaves after 1000 relaxation times
        self.assertClose(got, speed, relative=1e-6, what="speed of the foot")
        self.assertClose(result["friction_force_x"][-1], 0.1, absolute=1e-8)


class Slab(TestCase):
    """Friction and flow together, a front that moves and a reversal."""

    def slab(self, scheme, n_steps, ranks=1, **more):
        result = run(
            "slab",
            {
                "Time/Scheme": scheme,
                "Time/Phases": f"1: {n_steps}, 2: {n_steps}",
                **more,
            },
            ranks=ranks,
        )
        self.check_identities(result)
        return result

    def test_orders_of_all_schemes(self):
        """To the same solution: the friction force, the energies and the
        corner at t = 1 and 2 against 256 steps of Heun, on a mesh that is coarse
        enough for many steps."""
        mesh = {"Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true"}
        names = (
            "friction_force_x",
            "point0_x",
            "stored_energy",
            "viscous_dissipation",
            "friction_dissipation",
        )
        for law, entries in ("maxwell", mesh), ("norton", {**NORTON, **mesh}):
            fine = self.slab("Heun", 256, **entries)
            scale = {name: abs(fine[name]).max() for name in names}
            for scheme in "forward Euler", "Heun", "backward Euler":
                errors = []
                for n in 16, 64:
                    result = self.slab(scheme, n, **entries)
                    errors.append(
                        max(
                            abs(result[name][result.row(t)] - fine[name][fine.row(t)])
                            / scale[name]
                            for name in names
                            for t in (1, 2)
                        )
                    )
                measured = order_of(*errors)
                print(f"{law}, {scheme}: errors {errors}, order {measured}")
                order = 2 if scheme == "Heun" else 1
                self.assertClose(measured, order, absolute=0.2, what=f"{law}, {scheme}")

    def test_three_times_the_limit(self):
        """Refused with forward Euler and Heun, tame with backward Euler: as
        with small steps of forward Euler."""
        steps = {"Time/Phases": "1: 6, 2: 6"}  # 0.17, and 2/r = 0.052
        for scheme in "forward Euler", "Heun":
            refused = run(
                "slab", {**PERZYNA, **steps, "Time/Scheme": scheme}, check=False
            )
            self.assertEqual(refused.returncode, 1)
            self.assertRegex(
                refused.stderr,
                rf"exceeds the stability limit 2/r = 0.052 of {scheme}, which is "
                r"that of the cell at x = \([0-9.]+, [0-9.]+\); take more steps in "
                "'Time/Phases', or set 'Time/Stiffness policy' or 'Time/Scheme' = "
                "backward Euler",
            )
        coarse = self.slab("backward Euler", 6, **PERZYNA)
        self.assertGreater((coarse["k"] / coarse["step_limit"])[1:].min(), 3)
        fine = self.slab("forward Euler", 200, **PERZYNA)
        for name in "point0_x", "max_displacement", "friction_force_x":
            scale = abs(fine[name]).max()
            self.assertClose(
                coarse[name][-1], fine[name][-1], absolute=0.05 * scale, what=name
            )

    def test_newton_iterations_stay_few(self):
        for law, entries in ("norton", NORTON), ("perzyna", PERZYNA):
            for history in "cell means", "quadrature points":
                result = self.slab(
                    "backward Euler",
                    16,
                    **entries,
                    **{"Material/Stress history": history},
                )
                count = result["newton_iterations"][1:]
                print(f"{law}, {history}: {count.mean()} iterations, {count.max()}")
                self.assertLess(count.mean(), 8)
                self.assertLess(count.max(), 20)

    def compare(self, one, other, allowed=1e-6):
        """All columns that do not tell how the numbers were found."""
        result = Comparison()
        compare_columns(one, other, result)
        self.assertEqual(result.unlike, [])
        for name, difference in result.columns.items():
            if not name.startswith(("newton_", "estimate_", "time_indicator")):
                self.assertLess(difference, allowed, name)

    def test_ranks(self):
        for entries, ranks in ({}, 2), (NORTON, 2), (HARDENING, 3):
            self.compare(
                self.slab("backward Euler", 2, **entries),
                self.slab("backward Euler", 2, ranks=ranks, **entries),
            )
        self.compare(self.slab("Heun", 8), self.slab("Heun", 8, ranks=2))

    def test_multigrid(self):
        direct = self.slab("backward Euler", 8, **NORTON)
        multigrid = self.slab(
            "backward Euler", 8, **NORTON, **{"Solver/Linear solver": "multigrid"}
        )
        self.compare(direct, multigrid)


def hardening(k_r, k, modulus=0.1):
    return {
        **PERZYNA,
        "Material/perzyna/Hardening modulus": modulus,
        "Material/perzyna/Viscosity": (2 / 2.6 + np.sqrt(2 / 3) * modulus) * k / k_r,
        "Boundary 0/Traction": "0.3*min(t, 2 - t); 0",
    }


class NonSymmetric(TestCase):
    """Laws without a potential, where the symmetric part of the tangent alone
    is not enough."""

    COARSE = {"Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true"}

    def slab(self, entries, steps=4, ranks=1, **more):
        result = run(
            "slab",
            {
                **BACKWARD,
                **self.COARSE,
                "Time/Phases": f"1: {steps}, 2: {steps}",
                **entries,
                **more,
            },
            ranks=ranks,
        )
        self.check_identities(result)
        return result

    def test_iterations_stay_few(self):
        """The iteration with the symmetric part fails for `pressure' from k =
        10/r on, and takes up to 15 iterations for `hardening'."""
        for law in pressure, hardening:
            for k_r in 1, 10, 100, 1000:
                with self.subTest(f"{law.__name__}, k r = {k_r}"):
                    count = self.slab(law(k_r, 0.25))["newton_iterations"][1:]
                    print(f"{law.__name__}, k r = {k_r}: {count.mean()}, {count.max()}")
                    self.assertLess(count.mean(), 6)
                    self.assertLess(count.max(), 11)

    def test_as_small_steps_of_forward_euler(self):
        """At k = 100/r, against 60 times as many steps below 2/r."""
        for law in pressure, hardening:
            with self.subTest(law.__name__):
                entries = law(100, 1 / 8)
                coarse = self.slab(entries, steps=8)
                fine = self.slab(entries, steps=480, **{"Time/Scheme": "forward Euler"})
                self.assertGreater((coarse["k"] / coarse["step_limit"]).max(), 49)
                for name in "point0_x", "friction_force_x", "stored_energy":
                    for t in 1, 2:
                        scale = abs(fine[name]).max()
                        # 0.0042 is the largest, of point0_x with hardening
                        self.assertClose(
                            coarse[name][coarse.row(t)],
                            fine[name][fine.row(t)],
                            absolute=0.005 * scale,
                            what=f"{law.__name__}, {name} at t = {t}",
                        )

    def test_gmres_only_where_it_is_needed(self):
        """With the direct solver each Newton iteration counts one linear
        iteration, and GMRES its own."""
        for entries in {**PERZYNA}, NORTON:
            result = self.slab(entries)
            self.assertEqual(
                list(result["linear_iterations"]), list(result["newton_iterations"])
            )
        result = self.slab(pressure(10, 0.25))
        self.assertGreater(
            result["linear_iterations"].sum(), 3 * result["newton_iterations"].sum()
        )

    def test_ranks_and_multigrid(self):
        entries = {**pressure(10, 0.25), "Time/Phases": "1: 4, 1.5: 2"}
        one = self.slab(entries)
        for ranks in 1, 3:
            with self.subTest(f"{ranks} ranks"):
                other = self.slab(
                    entries, ranks=ranks, **{"Solver/Linear solver": "multigrid"}
                )
                Slab.compare(self, one, other)

    def test_in_3d_with_hanging_nodes_on_two_ranks(self):
        """Where slip turns, on a foundation with hanging nodes."""
        law = pressure(20, 0.1)
        law["Material/parsed/Strain rate"] = "max(0, sigma_eq - max(0, 0.025 + p))"
        for history in "cell means", "quadrature points":
            more = {
                **BACKWARD,
                **law,
                "Time/Phases": "0.4: 3",
                "Material/Stress history": history,
            }
            one = run("pad_adaptive", more)
            self.check_identities(one)
            self.assertGreater(one["cells"][-1], one["cells"][0])
            self.assertLess(one["newton_iterations"].max(), 11)
            Slab.compare(self, one, run("pad_adaptive", more, ranks=2))


class Adaptive(TestCase):
    """Hanging nodes, also on the face with friction, in 3D."""

    def test_ranks_and_histories(self):
        for scheme in "backward Euler", "Heun":
            for history in "cell means", "quadrature points":
                more = {
                    "Time/Scheme": scheme,
                    "Time/Phases": "0.6: 4",
                    "Material/Stress history": history,
                    **(NORTON if scheme == "backward Euler" else {}),
                }
                one = run("pad_adaptive", more)
                self.check_identities(one)
                self.assertGreater(one["cells"][-1], one["cells"][0])
                Slab.compare(self, one, run("pad_adaptive", more, ranks=2))


class Turning(TestCase):
    def test_turning_slip_is_of_first_order(self):
        """In 3D the direction of the force is that of the mean velocity of the
        step: first order in k for every scheme, here without any flow, where
        Heun's would have no error otherwise."""
        errors = {}
        fine = run("pad", {**HEUN, "Time/Phases": "1.5: 160"})
        for scheme in "forward Euler", "Heun", "backward Euler":
            errors[scheme] = []
            for n in 10, 20, 40:
                result = run("pad", {"Time/Scheme": scheme, "Time/Phases": f"1.5: {n}"})
                self.check_identities(result)
                errors[scheme].append(
                    np.linalg.norm(
                        result.vector("friction_force")[-1]
                        - fine.vector("friction_force")[-1]
                    )
                )
            print(f"turning, {scheme}: {errors[scheme]}, {orders(errors[scheme])}")
        order = np.log2(errors["Heun"][0] / errors["Heun"][-1]) / 2
        self.assertClose(order, 1, absolute=0.4, what="Heun where slip turns")


class Restart(TestCase):
    """As if the run had not stopped, to the bit."""

    def check(self, scene, overrides, ranks=1):
        with Job(scene, {**overrides, **EVERY_STEP}) as job:
            job.run(ranks=ranks)
            whole = without_wall_times(job.results / "statistics.csv")
            job.forget_after(3)
            job.run("--restart", ranks=ranks)
            self.assertEqual(whole, without_wall_times(job.results / "statistics.csv"))

    def test_all_schemes(self):
        steps = {
            "Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true",
            "Time/Phases": "1: 4, 2: 3",
        }
        for scheme, entries, ranks in (
            (BACKWARD, {}, 1),
            (BACKWARD, NORTON, 1),
            (BACKWARD, NORTON, 2),
            (HEUN, {}, 1),
            (HEUN, {}, 2),
        ):
            with self.subTest(f"{scheme} {entries} {ranks}"):
                self.check("slab", {**steps, **entries, **scheme}, ranks)

    def test_adaptive(self):
        self.check(
            "pad_adaptive", {**BACKWARD, **NORTON, "Time/Phases": "0.5: 5"}, ranks=2
        )


if __name__ == "__main__":
    main()
