# SPDX-License-Identifier: LGPL-2.1-or-later
"""Laws with history variables: burgers and lubby2 against closed forms and an
ordinary differential equation of one point; what steps, meshes, checkpoints and ranks
do to the history."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.signal import residue

from harness import TestCase, main, run
from runs import EVERY_STEP, Job, elastic_moduli, on_boundary, without_wall_times

E, NU = 1.0, 0.25
MU = E / (2 + 2 * NU)
BURGERS = {"Maxwell viscosity": 6.0, "Kelvin modulus": 0.5, "Kelvin viscosity": 0.2}
LUBBY2 = {
    **BURGERS,
    "Maxwell viscosity exponent": -8.0,
    "Kelvin modulus exponent": -5.0,
    "Kelvin viscosity exponent": -6.0,
    "Stress cap": 1.0,
}
# Pressed, held, let go and left alone.
LOAD = "0.1*max(0, min(1, min(4*t, 4*(2 - t))))"


def load(t):
    return 0.1 * max(0.0, min(1.0, 4 * t, 4 * (2 - t)))


def phases(n):
    return f"0.25: {n}, 1.75: {3 * n}, 2: {n}, 3: {2 * n}"


def material(law, values):
    return {
        **elastic_moduli(E, NU),
        "Material/Law": law,
        **{f"Material/{law}/{entry}": value for entry, value in values.items()},
    }


def pressed(model, law, values, n, **more):
    """A block on a platen without friction, with hanging nodes there."""
    box = "2, 2, 2 : 0, 0, 0 : 1, 1, 1" if model == "3d" else "2, 2 : 0, 0 : 1, 1"
    dim = 3 if model == "3d" else 2
    top, bottom = 2 * dim - 1, 2 * dim - 2
    points = "1, 1, 1; 1, 1, 0" if dim == 3 else "1, 1; 1, 0"
    scene = {
        "Dimension": dim,
        "Geometry/Arguments": box + " : true",
        "Geometry/Boundary refinements": f"{bottom}: 1",
        **{f"Boundary {i}/Role": "symmetry" if i % 2 == 0 else "free"
           for i in range(bottom)},
        **on_boundary(bottom, Role="contact", Contact_law="unilateral", Gap=0),
        f"Boundary {bottom}/Friction law": "none",
        **on_boundary(top, Role="traction", Pressure=LOAD),
        "Output/Points": points,
        "Output/Fields every": 0,
        # Without stress lubby2 has a kink, and Newton's method some trouble.
        "Solver/Contact tolerance": 1e-9 if law == "lubby2" else 1e-11,
        "Time/Phases": phases(n),
        **material(law, values),
        **more,
    }  # fmt: skip
    if model == "axisymmetric":
        scene["Geometry/Plane model"] = model
    return scene


def compute(scene, ranks=1, **more):
    return run("history", scene, ranks=ranks, text="", **more)


def height(result):
    """What it has changed by: without load the body lies anywhere on the platen."""
    last = "z" if "point0_z" in result.statistics else "y"
    return result[f"point0_{last}"] - result[f"point1_{last}"]


def point(values, plane, times):
    """What the height of a block under LOAD has changed by; the creep of `doc' with
    the stress zz of plane strain as one more unknown."""
    v = {**dict.fromkeys(LUBBY2, 0.0), "Stress cap": np.inf, **values}

    def rates(stress, e):
        s = stress - stress.mean()
        q = min(np.sqrt(1.5 * s @ s), v["Stress cap"])
        scale = {
            name: v[name] * np.exp(v[name + " exponent"] * q)
            for name in ("Maxwell viscosity", "Kelvin modulus", "Kelvin viscosity")
        }
        kelvin = s - 2 * scale["Kelvin modulus"] * e
        kelvin /= 2 * scale["Kelvin viscosity"]
        return s / (2 * scale["Maxwell viscosity"]) + kelvin, kelvin

    def right_side(t, y):
        slope = (load(t + 1e-9) - load(t - 1e-9)) / 2e-9
        creep, kelvin = rates(np.array([0, -load(t), y[0]]), y[1:4])
        zz = -NU * slope - E * creep[2] if plane else 0.0
        return [zz, *kelvin, creep[1]]

    y, result = np.zeros(5), []
    for begin, end in ((0, 0.25), (0.25, 1.75), (1.75, 2), (2, 3)):
        inside = times[(times >= begin - 1e-9) & (times < end - 1e-9)]
        ode = solve_ivp(right_side, (begin, end), y, rtol=1e-11, atol=1e-13,
                        t_eval=[*np.clip(inside, begin, end), end])  # fmt: skip
        result.extend(ode.y[:, :-1].T)
        y = ode.y[:, -1]
    result = np.array([*result, y])
    stress = np.array([-load(t) for t in times])
    return (stress - NU * result[:, 0]) / E + result[:, 4]


class OnePoint(TestCase):
    """Creep under a load that goes away, and what comes back."""

    def errors(self, model, law, values, scheme, *counts, **more):
        for n in counts:
            result = compute(
                pressed(model, law, values, n, **{"Time/Scheme": scheme, **more})
            )
            if law == "burgers" and scheme == "backward Euler":
                self.assertEqual(result["newton_iterations"].max(), 1)  # linear
            exact = point(values, model == "plane", result["t"])
            yield abs(height(result) - exact).max() / abs(exact).max()

    def check_order(self, model, law, values, scheme, order, largest, **more):
        coarse, fine = self.errors(model, law, values, scheme, 8, 16, **more)
        self.assertLess(fine, largest, (model, law, scheme))
        self.assertClose(np.log2(coarse / fine), order, absolute=0.25, what=scheme)

    def test_orders_of_burgers(self):
        for model in "plane", "axisymmetric":
            self.check_order(model, "burgers", BURGERS, "forward Euler", 1, 0.03)
            self.check_order(model, "burgers", BURGERS, "backward Euler", 1, 0.03)
            self.check_order(model, "burgers", BURGERS, "Heun", 2, 1e-3)

    def test_orders_of_lubby2(self):
        points = {"Material/Stress history": "quadrature points"}
        for model, more in (("plane", {}), ("axisymmetric", points)):
            self.check_order(model, "lubby2", LUBBY2, "backward Euler", 1, 0.03, **more)
            self.check_order(model, "lubby2", LUBBY2, "Heun", 2, 2e-3, **more)

    def test_three_dimensions(self):
        """The scheme's own solution is that of rings."""
        for law, values, scheme, small in (
            ("burgers", BURGERS, "Heun", 1e-10),
            ("lubby2", LUBBY2, "backward Euler", 3e-5),
        ):
            ring, box = (
                height(
                    compute(pressed(model, law, values, 2, **{"Time/Scheme": scheme}))
                )
                for model in ("axisymmetric", "3d")
            )
            self.assertClose(box, ring, absolute=small * abs(ring).max())

    def test_recovery(self):
        """What is left in the end is the strain of the Maxwell body and what of the
        Kelvin body has not come back yet; energies balance."""
        result = compute(
            pressed("axisymmetric", "burgers", BURGERS, 32, **{"Time/Scheme": "Heun"})
        )
        u, t = height(result), result["t"]
        # 1/3 of the deviator of a uniaxial stress, over 1.75 of full load
        steady = -0.1 * 1.75 / (3 * BURGERS["Maxwell viscosity"])
        tau = BURGERS["Kelvin viscosity"] / BURGERS["Kelvin modulus"]
        rest = u - steady
        after = t >= 2 - 1e-9
        self.assertGreater(rest[after][0] / steady, 3)
        self.assertClose(
            rest[after], rest[after][0] * np.exp(-(t[after] - 2) / tau), 2e-3, 1e-6
        )
        self.assertLess(
            abs(result["energy_balance_defect"]).max(),
            1e-3 * result["viscous_dissipation"][-1],
        )
        # The spring of the Kelvin body does the work of coming back.
        self.assertLess(result["stored_energy"][-1], 0.02 * result["stored_energy"].max())
        self.assertTrue((np.diff(result["viscous_dissipation"]) > -1e-12).all())

    def test_relaxation(self):
        """At constant strain the stress is a sum of two exponentials."""
        scene = {
            "Geometry/Arguments": "2, 2 : 0, 0 : 1, 1 : false",
            **on_boundary(0, Role="displacement", Displacement="0.1*y; 0"),
            "Initial state/Equilibrate": "true",
            "Time/Phases": "1: 64",
            "Output/Fields every": 64,
            "Output/Points": "0.5, 0.5",
            "Output/Point fields": "history",
            **material("burgers", BURGERS),
        }
        eta_m, g, eta_k = BURGERS.values()
        matrix = np.array([[-MU / eta_m - MU / eta_k, 2 * MU * g / eta_k],
                           [0.5 / eta_k, -g / eta_k]])  # fmt: skip
        values, vectors = np.linalg.eig(matrix)
        shares = np.linalg.solve(vectors, [0.1 * MU, 0])
        for scheme, largest in ("Heun", 4e-4), ("backward Euler", 2e-2):
            result = compute({**scene, "Time/Scheme": scheme})
            stress, kelvin = (vectors * shares) @ np.exp(np.outer(values, result["t"]))
            self.assertClose(
                result["max_von_mises"] / np.sqrt(3), stress, relative=largest
            )
            small = largest * kelvin.max()
            self.assertClose(result["point0_history_xy"], kelvin, absolute=small)
            field = result.fields().cell_data["history_xy"]
            self.assertClose(field, kelvin[-1], absolute=small)


class Estimate(TestCase):
    def test_time_steps(self):
        """The estimate of the time steps is the error, and goes with it where the
        strain comes to an end, of which z by itself knows nothing."""
        values = {**BURGERS, "Maxwell viscosity": 1e6, "Kelvin viscosity": 0.1}
        for scheme in "forward Euler", "backward Euler", "Heun":
            result = compute(
                pressed("axisymmetric", "burgers", values, 8, **{"Time/Scheme": scheme})
            )
            estimate, t = result["estimate_time"], result["t"]
            # The strain of the error is uniaxial and without change of volume.
            error = abs(height(result) - point(values, False, t))
            error *= np.sqrt(3 * MU * np.pi)
            ratio = estimate / np.maximum(error, 1e-300)
            counts = (t >= 0.25) & (error > 0.4 * error.max())
            self.assertGreater(counts.sum(), 5)
            self.assertGreater(ratio[counts].min(), 0.5, scheme)
            self.assertLess(ratio[counts].max(), 2.5, scheme)
            held = np.argmin(abs(t - 1.75))
            self.assertLess(estimate[held], 0.05 * estimate.max(), scheme)

    def test_rejected_steps(self):
        """Steps that are chosen, of which those dropped leave nothing."""
        more = {"Time/Scheme": "backward Euler", "Step control/Tolerance": 0.02}
        result = compute(pressed("axisymmetric", "burgers", BURGERS, 1, **more))
        self.assertGreater(result["rejected"].sum(), 5)
        exact = point(BURGERS, False, result["t"])
        error = abs(height(result) - exact).max()
        self.assertLess(error, 0.01 * abs(exact).max())  # measured: 0.006


class Scenes(TestCase):
    """Bodies that are not uniform, with friction."""

    LIKE_ZENER = {"Maxwell viscosity": 1e300, "Kelvin modulus": 0.6,
                  "Kelvin viscosity": 0.7}  # fmt: skip
    # The same moduli in series, and their relaxation time.
    mu = 1 / (1 / MU + 1 / 0.6)
    bulk = E / (3 - 6 * NU)
    ZENER = {
        "Long-term Young's modulus": 9 * bulk * mu / (3 * bulk + mu),
        "Long-term Poisson's ratio": (3 * bulk - 2 * mu) / (6 * bulk + 2 * mu),
        "Relaxation time": 0.7 / (MU + 0.6),
    }

    def against_zener(self, scene, more, columns, tolerance):
        """Without the Maxwell dashpot."""
        more = {
            "Material/Volumetric integration": "mean dilatation",
            "Output/Fields every": 0,
            **more,
        }
        kelvin, zener = (
            run(scene, {**more, **material(law, values)})
            for law, values in (("burgers", self.LIKE_ZENER), ("zener", self.ZENER))
        )
        for name in columns:
            size = abs(zener[name]).max()
            self.assertGreater(size, 0)
            self.assertClose(
                kelvin[name], zener[name], absolute=tolerance * size, what=f"{scene} {name}"
            )

    def test_zener_as_special_case(self):
        """On any scheme, but for the iterations."""
        for scheme in "forward Euler", "Heun", "backward Euler":
            more = {
                "Time/Scheme": scheme,
                "Solver/Contact tolerance": 1e-11,
                "Geometry/Global refinements": 1,
            }
            columns = "friction_dissipation", "viscous_dissipation", "stored_energy"
            self.against_zener("slab", more, ("max_displacement", *columns), 1e-7)

    def test_thick_cylinder(self):
        """Under a pressure inside, without strain along the axis, radial and hoop
        stresses are those of elasticity at all times (Lame), so that
        u_r = (A r/(K + mu/3) + B/(mu r))/2 with mu = 1/J in the transformed time."""
        moduli = {"Maxwell viscosity": 4.0, "Kelvin modulus": 0.6,
                  "Kelvin viscosity": 0.3}  # fmt: skip
        eta, mu_k, eta_k = moduli.values()
        bulk, t = E / (3 - 6 * NU), 2.0
        A, B = 1 / 3, 4 / 3  # of radii 1 and 2 and a pressure of 1
        # J = top/bottom, and 1/(K + mu/3) = 3 J/(3 K J + 1), of a step at t = 0
        bottom = np.polymul([eta, 0], [eta_k, mu_k])
        top = np.polyadd(bottom / MU, [eta + eta_k, mu_k])
        whole = np.polyadd(3 * bulk * top, bottom)
        residues, poles, _ = residue(3 * top, np.polymul(whole, [1, 0]))
        dilation = (residues @ np.exp(poles * t)).real
        compliance = 1 / MU + t / eta + (1 - np.exp(-t * mu_k / eta_k)) / mu_k
        errors = []
        for n in 1, 2:
            ring = compute(
                {
                    "Dimension": 2,
                    "Geometry/Plane model": "axisymmetric",
                    "Geometry/Arguments": f"{8 * n}, 1 : 1, 0 : 2, 0.25 : true",
                    **{f"Boundary {i}/Role": "symmetry" for i in (2, 3)},
                    **on_boundary(0, Role="traction", Pressure=1),
                    "Boundary 1/Role": "free",
                    "Initial state/Equilibrate": "true",
                    "Time/Scheme": "Heun",
                    "Time/Phases": f"{t}: {16 * n}",
                    "Output/Points": "1, 0; 2, 0",
                    "Output/Fields every": 0,
                    **material("burgers", moduli),
                }
            )
            known = [(A * r * dilation + B / r * compliance) / 2 for r in (1, 2)]
            found = [ring[f"point{i}_x"][-1] for i in (0, 1)]
            errors.append(max(abs(np.divide(found, known) - 1)))
        # measured: 1.32e-3, 3.2e-4
        self.assertLess(errors[1], 4e-4)
        self.assertGreater(np.log2(errors[0] / errors[1]), 1.9)

    ADAPTIVE = {"Mesh refinement/Cell budget": 500, "Time/Phases": "1.5: 8"}

    def restarted(self, scene, more, t):
        """A run, which is the same when it goes on one step after t."""
        with Job(scene, {**EVERY_STEP, **more}) as whole:
            done = whole.run()
            rows = without_wall_times(whole.results / "statistics.csv")
            whole.forget_after(1 + int(np.argmin(abs(done["t"] - t))))
            whole.run("--restart")
            again = without_wall_times(whole.results / "statistics.csv")
            self.assertEqual(again, rows)
            return done

    def test_restart_on_changing_meshes_and_ranks(self):
        """Bit by bit, of each scheme; and ranks agree."""
        for scheme, law in (
            ("Heun", material("burgers", BURGERS)),
            ("backward Euler", material("lubby2", LUBBY2)),
        ):
            more = {
                **self.ADAPTIVE,
                **law,
                "Mesh refinement/Cell budget": 150,
                "Time/Scheme": scheme,
            }
            done = self.restarted("pad_adaptive", more, 0.56)
            self.assertGreater(np.ptp(done["cells"]), 0)
            other = run("pad_adaptive", more, ranks=2)
            for column in "max_displacement", "viscous_dissipation", "cells":
                self.assertClose(other[column], done[column], 1e-6, 1e-12, column)

    def test_transfer(self):
        """On meshes that change, the history goes where z goes: creep is that of
        zener, which keeps its memory in z."""
        columns = "max_displacement", "friction_dissipation"
        self.against_zener("pad_adaptive", self.ADAPTIVE, columns, 2e-3)  # 8e-4

    def test_stages(self):
        """A material that comes while the other creeps begins without history, and
        what is restarted then goes on with it."""
        law = material("burgers", BURGERS)
        both = {
            name.replace("Material/", f"Material {i}/"): law[name]
            for i in (1, 2)
            for name in law
            if "'s" not in name
        }
        more = {
            "Material 2/Removed at": "",
            "Material 2/Added at": 1,
            "Time/Scheme": "backward Euler",
            **both,
        }
        done = self.restarted("excavated_column", more, 1)
        self.assertGreater(done["viscous_dissipation"][-1], 0)


class Refusals(TestCase):
    refused_scene = ("slab", {}, None)

    def test_parameters(self):
        for law, entry, value, sentence in (
            ("burgers", "Kelvin viscosity", "-1", "is -1; it must be positive."),
            ("burgers", "Maxwell viscosity", "0", "is 0; it must be positive."),
            ("lubby2", "Kelvin modulus exponent", "1", "is 1; it must be zero or neg"),
        ):
            values = {**(BURGERS if law == "burgers" else LUBBY2), entry: value}
            self.refused(material(law, values), f"'Material/{law}/{entry}' {sentence}")

    def test_no_history(self):
        scene = {"Output/Points": "1, 1", "Output/Point fields": "history"}
        self.refused(scene, "'Output/Point fields': there is no `history' where no law")

    def test_exact_solution(self):
        law = material("burgers", BURGERS)
        self.refused(law, "history variables", scene="manufactured/tresca_2d")


if __name__ == "__main__":
    main()
