# SPDX-License-Identifier: LGPL-2.1-or-later
"""Errors of quantities of interest, by duality."""

import functools
import re

import numpy as np

from harness import TestCase, main, run
from runs import (
    EVERY_STEP,
    Job,
    elastic_moduli,
    manufactured,
    of_law,
    on_boundary,
    with_roles,
    without_wall_times,
)

# What cell means leave out of the history is known without its sign only.
POINTS = {"Material/Stress history": "quadrature points"}
WORK = "friction_dissipation"
# Of runs that others are compared with nobody asks for it, a third of their time.
NO_BAR = {"Error control/Error bar": "false"}
COARSE_SLAB = {
    **POINTS,
    "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
    "Output/Fields every": 0,
    "Solver/Contact tolerance": 0,
}

# A pad of zener (relaxation time 1) that is pressed on a belt, which moves and stops.
PAD = {
    "Geometry/Arguments": "10, 2 : 0, 0 : 100, 20 : true",
    **elastic_moduli(200, 0.35),
    "Material/Law": "zener",
    "Material/zener/Long-term Young's modulus": 100,
    "Material/zener/Long-term Poisson's ratio": 0.35,
    "Material/zener/Relaxation time": 1,
    **{f"Boundary {id}/Role": "free" for id in (0, 1)},
    **on_boundary(2, Role="contact", Contact_law="unilateral", Friction_law="coulomb"),
    "Boundary 2/Friction coefficient": 0.4,
    "Boundary 2/Foundation motion": "5*max(0, min(t - 1, 2)); 0",
    **on_boundary(3, Role="displacement", Displacement="0; free", Pressure="min(t, 1)"),
    "Output/Fields every": 0,
}


def slide(arguments, law, motion="0.1*t; 0", foundation=None, **more):
    """A block, lowered on a belt that runs, or on another body that does."""
    dim = arguments.split(":")[0].count(",") + 1
    first = 20 if foundation else 0
    floor = f"Boundary {first + 2 * dim - 2}"
    scene = {
        "Dimension": dim,
        "Geometry/Arguments": arguments,
        "Material/Law": law,
        "Material/norton/Rate factor": 300,
        "Material/norton/Stress cap": 0.1,
        **{f"Boundary {first + id}/Role": "free" for id in range(2 * dim - 2)},
        f"{floor}/Role": "contact",
        f"{floor}/Contact law": "unilateral",
        f"{floor}/Friction law": "coulomb",
        f"{floor}/Friction coefficient": 0.4,
        f"Boundary {first + 2 * dim - 1}/Role": "displacement",
        f"Boundary {first + 2 * dim - 1}/Displacement": "0; " * (dim - 1)
        + "-0.02*min(t, 1)",
        "Time/Phases": "1: 5, 10: 20",
        "Output/Fields every": 0,
        **more,
    }
    if not foundation:
        return {**scene, f"{floor}/Foundation motion": motion + "; 0" * (dim - 2)}
    return {
        **scene,
        "Geometry/Generator": "subdivided_hyper_rectangle | subdivided_hyper_rectangle",
        "Geometry/Arguments": f"{foundation} | {arguments}",
        **{f"Boundary {id}/Role": "free" for id in range(2 * dim)},
        f"Boundary {2 * dim - 2}/Role": "displacement",
        f"Boundary {2 * dim - 2}/Displacement": motion,
        f"{floor}/Against": 2 * dim - 1,
    }


def of(column, tolerance=0, **more):
    return {
        "Error control/Quantity": column,
        "Error control/Tolerance": tolerance,
        **more,
    }


@functools.lru_cache
def fine_slab(law, **more):
    """The slab as accurately as its quantities are compared with it."""
    overrides = {**POINTS, "Geometry/Global refinements": 2, "Material/Law": law}
    overrides["Time/Phases"] = "1: 128, 2: 128"
    return run("slab", {**overrides, **more, **NO_BAR})


class Estimated(TestCase):
    """Signs and sizes of the errors on a given mesh."""

    def check(self, coarse, fine, column, band, safety=2):
        """The correction, over the times of the coarse run, against the error."""
        common = np.isin(np.round(fine["t"], 9), np.round(coarse["t"], 9))
        error = fine[column][common] - coarse[column]
        correction = coarse["quantity_correction"]
        worst = np.abs(error).argmax()
        quotient = correction[worst] / error[worst]
        self.assertGreater(quotient, band[0], column)
        self.assertLess(quotient, band[1], column)
        # Of the mesh it is taken safety times, and the parts are a bound.
        self.assertClose(
            coarse["quantity_total"],
            sum(coarse[f"quantity_{part}"] for part in ("space", "time", "other")),
            relative=1e-10,
        )
        self.assertTrue(
            np.all(
                coarse["quantity_total"] * (1 + 1e-9)
                >= np.abs(correction) - 1e-12 * np.abs(coarse[column]).max()
            )
        )
        # The largest bound is one of the largest error, and not by far.
        quotient = coarse["quantity_total"].max() / np.abs(error).max()
        self.assertGreater(quotient, 1.0, column)
        self.assertLess(quotient, 2 * safety, column)

    def test_of_a_moving_front(self):
        for column in ("friction_force_x", "reaction_3_x", "reaction_2_y", "point0_x"):
            coarse = run("slab", of(column, **POINTS, **{"Output/Fields every": 0}))
            self.check(coarse, fine_slab("maxwell"), column, (0.8, 1.5))

    def test_of_backward_euler(self):
        """Its own matrices are no help for the dual problem of a(.,.). The errors of the
        mesh and of its steps differ in sign, so that each is compared with its own."""
        column = "reaction_2_y"
        coarse = run("slab", of(column, **POINTS, **{"Time/Scheme": "backward Euler"}))
        steps = run("slab", {**POINTS, "Time/Phases": "1: 128, 2: 128", **NO_BAR})
        fine = fine_slab("maxwell")
        self.check(coarse, fine, column, (0.5, 1.5))

        def at_one(result, name=column):
            return result[name][np.isclose(result["t"], 1)][0]

        mesh = at_one(coarse, "quantity_space") / 2
        time = at_one(coarse, "quantity_time")
        # measured: 0.98 (0.75 by residuals alone) and 0.73
        self.assertClose(mesh, at_one(fine) - at_one(steps), 0.15)
        self.assertClose(time, at_one(coarse) - at_one(steps), 0.3)
        self.assertClose(at_one(coarse, "quantity_correction"), mesh - time, 1e-6)

    def test_of_long_steps_under_a_growing_load(self):
        """A power of the stress is not linear within steps of backward Euler."""
        bar = {
            "Geometry/Arguments": "1, 1 : 0, 0 : 1, 1 : true",
            "Material/Young's modulus": 100,
            **of_law("norton", Rate_factor=0.01, Exponent=5, Stress_cap=100),
            **{f"Boundary {id}/Role": "symmetry" for id in (0, 2)},
            "Boundary 1/Role": "free",
            **on_boundary(3, Role="traction", Traction="0; 4*t"),
            "Time/Scheme": "backward Euler",
            "Time/Phases": "1: 4",
            "Output/Fields every": 0,
            "Output/Points": "1, 1",
        }
        column = "point0_y"
        result = run("bar", of(column, **bar), text="")
        fine = run("bar", {**bar, "Time/Phases": "1: 800"}, text="")
        error = np.abs(fine[column][::200] - result[column])[1:]
        quotients = result["quantity_time"][1:] / error
        # measured: 0.98 to 1.02; as if G was linear in steps, 0.61 to 0.83
        self.assertGreater(quotients.min(), 0.95)
        self.assertLess(quotients.max(), 1.05)

    def test_of_steps_at_the_limit_of_stability(self):
        """Where k r = 2 Heun's method relaxes nothing, and no rate changes."""
        bar = {
            "Geometry/Arguments": "1, 1 : 0, 0 : 1, 1 : true",
            "Material/Young's modulus": 100,
            **of_law("zener", Relaxation_time=1),
            "Material/zener/Long-term Young's modulus": 40,
            "Material/zener/Long-term Poisson's ratio": 0.3,
            **{f"Boundary {id}/Role": "symmetry" for id in (0, 2)},
            **with_roles(free=[1], displacement=[3]),
            "Boundary 3/Displacement": "free; -0.01*min(10*t, 1)",
            "Time/Scheme": "Heun",
            "Output/Fields every": 0,
        }
        column = "reaction_3_y"
        fine = run("bar", {**bar, "Time/Phases": "0.1: 40, 8.1: 1600"}, text="")
        for steps in 5, 10, 20:
            phases = {"Time/Phases": f"0.1: 4, 8.1: {steps}"}
            result = run("bar", of(column, **bar, **phases), text="")
            exact = np.interp(result["t"], fine["t"], fine[column])
            error = np.abs(result[column] - exact).max()
            # measured: 0.9 to 1.4; without the error of the prediction at most 0.5,
            # and 0.002 at the limit
            self.assertGreater(result["quantity_time"].max(), 0.8 * error)
            self.assertLess(result["quantity_time"].max(), 2 * error)
        kept = run("bar", of(column, 0.05, **bar, **{"Time/Phases": "0.1: 3, 8.1: 4"}), text="")
        self.assertIn("has been kept", kept.stdout)
        exact = np.interp(kept["t"], fine["t"], fine[column])
        size = np.abs(exact).max()
        self.assertLess(np.abs(kept[column] - exact).max(), 0.05 * size)

    def test_in_space(self):
        """A clamped block without friction, linear in every respect."""
        scene = {
            "Geometry/Arguments": "4, 4, 4 : 0, 0, 0 : 1, 1, 1 : true",
            "Boundary 4/Role": "free",
            "Time/Phases": "1.5: 3",
            "Material/Law": "elastic",
        }
        cells = {"Geometry/Arguments": "12, 12, 12 : 0, 0, 0 : 1, 1, 1 : true"}
        level = {"Geometry/Global refinements": 0}
        fine = run("coulomb_pad_3d", {**scene, **cells, **level, **NO_BAR})
        column = "point0_x"
        coarse = run("coulomb_pad_3d", of(column, **scene, **level))
        self.check(coarse, fine, column, (0.5, 1.2))

    def test_of_contact_that_opens(self):
        """The force on a foundation, rigid or not; on a given mesh and to a
        tolerance. What touches is taken as found."""
        scene = {
            "Material/Law": "elastic",
            **on_boundary(0, Role="free", Traction=""),
            **on_boundary(2, Contact_law="unilateral", Friction_law="none"),
            "Boundary 2/Friction bound": "",
            **on_boundary(3, Role="displacement", Displacement="0; -0.08*t"),
            "Time/Phases": "1: 2",
        }
        soft = {**on_boundary(2, Contact_law="normal compliance", Compliance=2)}
        column = "contact_force_y"
        for more in {}, soft:
            with self.subTest(more):
                more = {**scene, **more}
                coarse = run("slab", {**COARSE_SLAB, **of(column, **more)})
                fine = run("slab", {**more, "Geometry/Global refinements": 2, **NO_BAR})
                self.check(coarse, fine, column, (0.8, 1.2))
                kept = run("slab", {**COARSE_SLAB, **of(column, 0.002, **more)})
                error = (kept[column] - fine[column])[-1] / fine[column][-1]
                self.assertLess(abs(error), 0.002)
                self.assertGreater(abs(error), 0.0002)
                self.assertGreater(kept["cells"][-1], coarse["cells"][-1])

    def test_where_pieces_meet(self):
        """A clamped face beside a plane of symmetry: the force at the corner goes to
        one of them, half a cell of the other included."""

        def layer(n, sides, **more):
            corners = ", ".join(["0"] * len(n)), ", ".join(["4"] + ["1"] * len(n[1:]))
            scene = {
                "Dimension": len(n),
                "Geometry/Generator": "subdivided_hyper_rectangle",
                "Geometry/Arguments": f"{', '.join(map(str, n))} : {corners[0]} : "
                f"{corners[1]} : true",
                **with_roles(symmetry=[0], traction=[1]),
                "Boundary 1/Traction": "; ".join(["0.1*t"] + ["0"] * len(n[1:])),
                **{f"Boundary {id}/Role": role for id, role in sides.items()},
                "Time/Phases": "1: 1",
                **more,
            }
            return run("layer", scene, text="")

        for n, sides in (
            ((8, 2), {2: "clamped", 3: "free"}),
            ((8, 2, 2), {2: "symmetry", 3: "free", 4: "clamped", 5: "free"}),
        ):
            fine = layer([4 * i for i in n], sides, **NO_BAR)
            for column in f"reaction_{2 * len(n) - 2}_x", "reaction_0_x":
                with self.subTest(dim=len(n), column=column):
                    coarse = layer(n, sides, **of(column))
                    error = (fine[column] - coarse[column])[-1]
                    quotient = coarse["quantity_correction"][-1] / error
                    # without the corner: 0.58 to 0.59
                    self.assertGreater(quotient, 0.8)
                    self.assertLess(quotient, 1.7)

    def test_of_time_steps(self):
        """Few steps on a fine mesh, until all of the face slips."""
        overrides = {"Geometry/Global refinements": 3}
        coarse = manufactured(
            "tresca_2d",
            **of("friction_force_x", **overrides, **{"Time/Phases": "1: 10"}),
        )
        steps = {"Time/Phases": "1: 80"}
        fine = manufactured("tresca_2d", **overrides, **steps, **NO_BAR)
        common = np.isin(np.round(fine["t"], 9), np.round(coarse["t"], 9))
        error = (fine["friction_force_x"][common] - coarse["friction_force_x"])[1:6]
        self.assertTrue(np.all(error < 0))
        quotient = coarse["quantity_correction"][1:6] / error
        # measured: from 0.985; the defect of a step relaxes for all of it
        self.assertGreater(quotient.min(), 0.95)
        self.assertLess(quotient.max(), 1.4)

    def test_of_the_work_of_friction(self):
        """A sum over the steps: of a front that moves on, and of slip that
        turns, slows down and comes to rest."""
        column = "friction_dissipation"
        scene = {"Material/Law": "elastic", "Time/Phases": "1: 16"}
        fine = run("slab", {**scene, "Geometry/Global refinements": 2, **NO_BAR})
        self.check(run("slab", of(column, **scene)), fine, column, (0.8, 1.4))

        def pad(n, **overrides):
            cells = f"{n}, {n}, {n} : 0, 0, 0 : 1, 1, 1 : true"
            scene = {"Material/Law": "elastic", "Time/Phases": "1.5: 12"}
            return run("pad", {**scene, "Geometry/Arguments": cells, **overrides})

        self.check(pad(4, **of(column)), pad(12, **NO_BAR), column, (0.8, 1.4))

    def test_of_work_of_points_that_come_to_rest(self):
        """One after another, as a slab of maxwell is sheared to and fro."""
        column = "friction_dissipation"

        def slab(n, **more):
            cells = f"{6 * n}, {n} : 0, 0 : 0.12, 0.02 : true"
            steps = {"Time/Phases": "60: 80", "Time/Scheme": "Heun"}
            return run("sheared_slab_2d", {"Geometry/Arguments": cells, **steps, **more})

        coarse = slab(2, **of(column))
        error = coarse[column][-1] - slab(8, **NO_BAR)[column][-1]
        # measured: 1.3; 0.57 if what rests took its share by its bounds
        self.assertClose(coarse["quantity_space"][-1] / error, 1.3, 0, 0.3)

    def test_of_work_under_a_growing_bound(self):
        """What a step does is taken with the bound at its end."""
        scene = {
            "Boundary 2/Friction bound": "0.02 + 0.08*t",
            "Material/Law": "elastic",
        }
        column = "friction_dissipation"
        coarse = run("slab", of(column, **scene, **{"Time/Phases": "1: 8"}))
        fine = run("slab", {**scene, "Time/Phases": "1: 128", **NO_BAR})
        common = np.isin(np.round(fine["t"], 9), np.round(coarse["t"], 9))
        error = (fine[column][common] - coarse[column])[-1]
        self.assertLess(error, 0)
        mesh = run("slab", of(column, **scene, **{"Time/Phases": "1: 128"}))
        correction = coarse["quantity_correction"][-1] - mesh["quantity_correction"][-1]
        self.assertClose(correction, error, 0.2)

    def test_of_work_under_computed_pressure(self):
        """What slides on feels the error of the pressure as long as it has slid."""
        plane, body = "6, 3 : 0, 0 : 2, 1 : true", "6, 2 : -1, -1 : 3, 0 : true"
        cube = "2, 2, 2 : 0, 0, 0 : 1, 1, 1 : true"
        bed = {"Boundary 2/Contact law": "normal compliance", "Boundary 2/Compliance": 2}
        hanging = {"Geometry/Boundary refinements": "1: 1"}
        # measured: 1.0, 0.94, 0.74 and 1.3; 0.02 to 0.1 of the present step alone
        for name, scene, ranks in (
            ("plane", slide(plane, "norton"), 1),
            ("bed", slide(plane, "zener", **bed), 2),
            ("body", slide(plane, "elastic", foundation=body), 1),
            ("turns", slide(cube, "zener", "0.1*t; 0.03*t^2", **hanging), 3),
        ):
            with self.subTest(name):
                coarse = run("slide", of(WORK, **scene), ranks, text="")
                fine = {**scene, **NO_BAR, "Geometry/Global refinements": 2}
                fine = run("slide", fine, text="")[WORK][-1]
                error = abs(fine - coarse[WORK][-1])
                quotient = coarse["quantity_space"][-1] / 2 / error
                self.assertGreater(quotient, 0.65)
                self.assertLess(quotient, 1.5)
                # measured: 0.03; 0.5 by energy norms
                self.assertLess(coarse["quantity_other"][-1], 0.1 * error)

    def test_of_points_that_have_come_to_rest(self):
        """A block on a belt that starts, stops and turns back: what is wrong of
        where points stick no residual of later steps tells."""
        belt = {
            "Geometry/Arguments": "12, 6 : 0, 0 : 60, 30 : true",
            **elastic_moduli(20, 0.45),
            "Material/Law": "zener",
            "Material/zener/Long-term Young's modulus": 12,
            "Material/zener/Long-term Poisson's ratio": 0.46,
            "Material/zener/Relaxation time": 1.5,
            **{f"Boundary {id}/Role": "free" for id in (0, 1)},
            **on_boundary(2, Role="contact", Contact_law="unilateral"),
            **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.5),
            "Boundary 2/Foundation motion": "2*(min(max(t - 1, 0), 3) - max(t - 6, 0)); 0",
            **on_boundary(3, Role="displacement", Displacement="0; free"),
            "Boundary 3/Pressure": "0.3*min(t, 1)",
            "Time/Scheme": "Heun",
            "Time/Phases": "1: 5, 4: 6, 6: 10, 7: 10",
            "Output/Fields every": 0,
        }
        column = "friction_force_x"
        result = run("belt", of(column, **belt), text="")
        fine = run("belt", {**belt, "Geometry/Global refinements": 1}, text="")
        turns = result["t"] > 6.35
        error = (fine[column] - result[column])[turns]
        quotients = result["quantity_correction"][turns] / error
        # measured: 0.75 to 1.36; without what is settled at rest -1.0 to 0.38, and
        # 1.2 to 1.9 when that did not relax and counted steps with the wrong sign
        self.assertGreater(quotients.min(), 0.7)
        self.assertLess(quotients.max(), 1.6)
        self.assertTrue(np.all(result["quantity_total"][turns] >= np.abs(error)))

    def test_of_long_steps_before_rest(self):
        """Slip begins early in a step; when the belt stops the force is that of the
        bound, and later feels where the pad has come to rest."""
        column = "friction_force_x"

        def pad(phases, **more):
            return run("pad", {**PAD, "Time/Phases": phases, **more}, text="")

        fine = pad("1: 50, 3: 400, 6: 300", **{"Time/Scheme": "Heun"}, **NO_BAR)
        for scheme in "forward Euler", "Heun":
            with self.subTest(scheme):
                result = pad("1: 3, 3: 6, 6: 9", **of(column), **{"Time/Scheme": scheme})
                exact = np.interp(result["t"], fine["t"], fine[column])
                error = np.abs(exact - result[column])
                counts = (result["t"] > 3.01) & (error > 0.005 * 40)
                self.assertGreater(counts.sum(), 5)
                quotients = result["quantity_time"][counts] / error[counts]
                # measured: 1.0 to 1.4 (0.92 to 1.13 with four times as many steps)
                self.assertGreater(quotients.min(), 0.7)
                self.assertLess(quotients.max(), 1.5)

    def test_of_steps_that_move_what_relaxes(self):
        """Errors of creep move the body, that changes stresses and the bounds of friction,
        and these make it creep."""
        squeezed = {
            "Geometry/Arguments": "4, 4 : 0, 0 : 1, 1 : true",
            "Material/Young's modulus": 100,
            **of_law("maxwell", Viscosity=25),
            **{f"Boundary {id}/Role": "symmetry" for id in (0, 2)},
            **with_roles(free=[1], displacement=[3]),
            "Boundary 3/Displacement": "0; -0.01*(1 - cos(2*pi*t))",
            "Time/Phases": "2: 16",
        }
        norton = {
            **squeezed,
            **of_law("norton", Rate_factor=0.01, Exponent=3, Stress_cap=100),
        }
        pad = {
            **PAD,
            **of_law("maxwell", Viscosity=50),
            "Boundary 2/Foundation motion": "2*sin(pi*t/2); 0",
            "Boundary 3/Pressure": "min(10*t, 1)",
            "Output/Points": "0, 0",
            "Time/Phases": "8: 32",
        }
        relaxing = {
            **pad,
            "Material/maxwell/Viscosity": 5,
            "Boundary 2/Friction coefficient": 0.5,
            "Boundary 2/Foundation motion": "3*sin(2*pi*t); 0",
            "Time/Phases": "3: 48",
        }
        # measured: 1.15, 1.7, 1.0 and 1.0; when forces and points did not feel that
        # 0.41, 0.59, 0.69 and 0.50
        for scene, column in (
            (squeezed, "reaction_0_x"),
            (norton, "reaction_3_x"),
            (pad, "point0_x"),
            (relaxing, "point0_y"),
        ):
            with self.subTest(column):
                scene = {**scene, "Time/Scheme": "backward Euler", "Output/Fields every": 0}
                result = run("steps", of(column, **scene), text="")
                end, steps = scene["Time/Phases"].split(": ")
                fine = {"Time/Phases": f"{end}: {16 * int(steps)}"}
                fine = run("steps", {**scene, **fine, **NO_BAR}, text="")
                error = np.abs(fine[column][::16] - result[column]).max()
                self.assertGreater(result["quantity_time"].max(), 0.75 * error)
                self.assertLess(result["quantity_time"].max(), 2 * error)

    def test_of_slip_that_came_from_another_mesh(self):
        """Points that slipped there have a direction, but no slip here."""
        pad = {
            "Geometry/Arguments": "3, 3, 2 : 0, 0, 0 : 1, 1, 1 : true",
            "Boundary 0/Role": "free",
            **on_boundary(4, Contact_law="unilateral", Normal_stress=0),
            "Boundary 5/Role": "displacement",
            "Boundary 5/Displacement": "0.02*t; 0; -0.05*min(2*t, 1)",
            "Time/Scheme": "backward Euler",
            "Time/Phases": "0.5: 4, 1: 4",
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Every n steps": 5,
            "Solver/Contact tolerance": 1e-10,
        }
        column = "friction_force_x"
        bars = [
            run("coulomb_pad_3d", of(column, **pad, **{"Solver/Linear solver": solver}))[
                "quantity_total"
            ]
            for solver in ("direct", "multigrid")
        ]
        # before, multigrid met values that are not finite
        self.assertClose(bars[0][1:], bars[1][1:], 1e-4)

    def test_of_flow_that_has_ended(self):
        """A body that hardens until nothing flows: what has crept stays as it is."""
        law = of_law("perzyna", Yield_radius=0.01, Viscosity=0.3, Hardening_modulus=0.1)
        scene = slide("6, 3 : 0, 0 : 2, 1 : true", "perzyna", **law)
        result = run("slide", of(WORK, **scene), text="")
        fine = {**scene, **NO_BAR, "Geometry/Global refinements": 2}
        error = run("slide", fine, text="")[WORK][-1] - result[WORK][-1]
        quotient = result["quantity_space"][-1] / abs(error)
        # measured: 1.0; with tangents of the elastic body 5.4
        self.assertGreater(quotient, 0.7)
        self.assertLess(quotient, 2)

    def test_costs_nothing_without(self):
        plain = run("slab", COARSE_SLAB)
        self.assertFalse(any("quantity" in name for name in plain.statistics))
        self.assertNotIn("Estimated error of", plain.stdout)


class Kept(TestCase):
    """Runs to a tolerance of the quantity."""

    def check(self, column, tolerance, law="maxwell"):
        # Full integration, as the scene has it, locks: its error is not known to 1 %.
        automatic = {"Material/Volumetric integration": "automatic"}
        scene = {**COARSE_SLAB, **automatic, "Material/Law": law}
        result = run("slab", of(column, tolerance, **scene))
        steps = {"Time/Scheme": "Heun", "Time/Phases": "1: 48, 2: 48"}
        fine = fine_slab(law, **automatic, **steps)
        size = np.abs(fine[column]).max()
        exact = np.interp(result["t"], fine["t"], fine[column])
        error = np.abs(exact - result[column]).max() / size
        estimate = result["quantity_total"].max() / np.abs(result[column]).max()
        self.assertLess(estimate, tolerance)
        self.assertLess(error, tolerance, column)
        # measured: from 0.166 of it (the work of friction in creep)
        self.assertGreater(error, tolerance / 8, column)
        self.assertIn(f"Estimated error of {column}", result.stdout)
        self.assertIn("has been kept", result.stdout)
        return result

    def test_of_what_a_force_feels_later(self):
        """While a pad slips its friction feels no time step; when it stops it does."""
        steps = {"Time/Phases": "1: 5, 3: 10, 4: 5"}
        result = run("pad", of("friction_force_x", 0.02, **PAD, **steps), text="")
        # before: 4.2 %, of it 3.6 by time steps
        self.assertIn("has been kept", result.stdout)
        finer = {"Geometry/Global refinements": 3, "Time/Phases": "1: 10, 3: 60, 4: 60"}
        fine = run("pad", {**PAD, **finer, "Time/Scheme": "Heun"}, text="")
        force = np.interp(result["t"], fine["t"], fine["friction_force_x"])
        stops = result["t"] > 3.01
        error = np.abs(force - result["friction_force_x"])[stops]
        self.assertLess(error.max(), 0.02 * 40)
        self.assertTrue(np.all(error < result["quantity_total"][stops]))

    def test_forces_and_displacements(self):
        for column in "friction_force_x", "reaction_3_x", "point0_x":
            result = self.check(column, 0.01)
            # The energy norm to 1 % takes 30 000 cells here.
            self.assertLess(result["cells"].max(), 600)

    def test_elastic(self):
        self.check("reaction_2_y", 0.01, "elastic")

    def test_work_of_friction(self):
        for law in "elastic", "maxwell":
            self.check("friction_dissipation", 0.01, law)

    def test_work_under_computed_pressure(self):
        perzyna = of_law("perzyna", Yield_radius=0.01, Viscosity=0.3)
        # measured: 0.3 and 1.0 %, 66 and 234 cells; of norton 2 % when past slip did
        # not feel the pressure, of perzyna 8667 cells when errors of strain were
        # expected to lead far beyond the yield surface
        for law, tolerance, cells in (("norton", 0.01, 150), ("perzyna", 0.03, 600)):
            with self.subTest(law):
                scene = slide("6, 3 : 0, 0 : 2, 1 : true", law, **perzyna)
                scene["Material/Law"] = law
                result = run("slide", of(WORK, tolerance, **scene), text="")
                fine = {"Geometry/Global refinements": 2, "Time/Phases": "1: 40, 10: 90"}
                fine = {**scene, **fine, **NO_BAR, "Time/Scheme": "Heun"}
                exact = run("slide", fine, text="")[WORK][-1]
                self.assertClose(result[WORK][-1], exact, tolerance)
                self.assertLess(result["cells"].max(), cells)
                self.assertIn("has been kept", result.stdout)

    def test_work_of_which_errors_have_settled(self):
        """No mesh removes what a coarser one has left: the run begins again."""
        push = "0.05*max(0, min(t - 1, 1)); 0"
        scene = slide("5, 4 : 0, 0 : 1.4, 1 : true", "zener", push)
        scene["Time/Phases"] = "1: 4, 2: 4"
        result = run("slide", of(WORK, 0.02, **scene), text="")
        # of meshes of 900 to 7000 cells; measured: 0.1 of it, 299 cells (1514 when
        # the rest was to be made ten times smaller instead)
        self.assertClose(result[WORK][-1], 2.04e-4, 0.02)
        self.assertLess(result["cells"].max(), 600)
        self.assertIn("has been kept", result.stdout)

    def test_friction_of_bodies_that_cease_to_flow(self):
        """Single cells flow on, whose errors a friction force feels ever more."""
        law = of_law("perzyna", Yield_radius=0.01, Viscosity=0.3)
        column = "friction_force_x"

        def friction(cells, **more):
            scene = slide(f"{cells} : 0, 0 : 2, 1 : true", "perzyna", **law)
            return run("slide", {**scene, **more}, text="")

        finer = {"Time/Phases": "1: 40, 10: 90", "Time/Scheme": "Heun"}
        fine = friction("24, 12", **finer, **NO_BAR)
        # measured: 0.8 and 0.1 of it. 1.34 and 1.09 when what the law takes beyond its
        # tangents made the estimate smaller, also by unloading where flow has ended,
        # and when an estimate served on while little flowed
        for cells, tolerance in ("4, 2", 0.05), ("6, 3", 0.03):
            with self.subTest(cells):
                result = friction(cells, **of(column, tolerance))
                force = np.interp(result["t"], fine["t"], fine[column])
                error = np.abs(force - result[column]).max()
                self.assertLess(error, tolerance * np.abs(force).max())
                self.assertIn("has been kept", result.stdout)

    def test_force_under_a_bound_that_jumps_within_a_face(self):
        """All points slip at the kink: the force is the integral of the bound."""
        exact, tolerance = 0.3 * 0.01 + 0.7 * 0.04, 0.03
        entries = {"Time/Phases": "1: 8", "Mesh refinement/Strategy": "automatic"}
        points = {"Material/Stress history": "quadrature points"}
        result = run(
            "kinked_load_2d",
            {**entries, **points, **of("friction_force_x", tolerance)},
        )
        self.assertIn("has been kept", result.stdout)
        error = max(result["friction_force_x"]) / exact - 1
        self.assertLess(abs(error), tolerance)

    def test_slip_that_comes_to_rest_in_a_step(self):
        """A load that slackens while the bound grows, the same at all points:
        the force is that of the bound until all is at rest."""
        scene = {
            **COARSE_SLAB,
            "Geometry/Arguments": "8, 8 : 0, 0 : 1, 1 : true",
            "Boundary 0/Traction": "0.2*sin(3*t); 0",
            "Boundary 2/Friction bound": "0.08*min(2*t, 1)",
            "Time/Phases": "0.5: 4",
        }
        result = run("slab", of("friction_force_x", 0.02, **scene))
        fine = {**scene, "Geometry/Global refinements": 2, "Time/Phases": "0.5: 200"}
        fine = run("slab", fine)["friction_force_x"]
        self.assertClose(result["friction_force_x"][-1], fine[-1], 0.02)
        self.assertIn("has been kept", result.stdout)

    def test_work_under_a_bound_that_grows(self):
        """Bounds that grow within the first steps are all of the error: once the
        budget is used up, later steps cannot be short enough."""
        scene = {
            **COARSE_SLAB,
            "Geometry/Arguments": "8, 8 : 0, 0 : 1, 1 : true",
            "Material/Law": "elastic",
            "Boundary 0/Traction": "0.2*sin(3*t); 0",
            "Boundary 2/Friction bound": "0.08*min(2*t, 1)",
            **on_boundary(3, Displacement="0.2*sin(4*pi*t); 0", Role="displacement"),
            "Time/Phases": "0.5: 4, 1.5: 4",
        }
        result = run("slab", of("friction_dissipation", 0.03, **scene))
        fine = {**scene, "Geometry/Global refinements": 1, "Time/Phases": "1.5: 900"}
        fine = run("slab", fine)["friction_dissipation"][-1]
        self.assertClose(result["friction_dissipation"][-1], fine, 0.03)
        self.assertIn("has been kept", result.stdout)
        self.assertLess(len(result["t"]), 250)

    def test_slip_that_turns_on_new_meshes(self):
        """Neither what the body does on a new mesh to come into equilibrium nor the
        energy norm of turns times that of a singular dual solution asks for steps."""
        result = run(
            "turning",
            of(
                "point0_x",
                0.08,
                **{
                    "Dimension": 3,
                    "Geometry/Arguments": "4, 4, 4 : 0, 0, 0 : 1, 1, 1 : true",
                    **of_law("maxwell", Viscosity=0.5),
                    "Boundary 0/Role": "traction",
                    "Boundary 0/Traction": "0.06*sin(3*t)*y; 0.04*t; 0",
                    **{f"Boundary {id}/Role": "free" for id in (1, 2, 3)},
                    **on_boundary(4, Role="contact", Friction_law="tresca"),
                    "Boundary 4/Friction bound": "0.01*(1 + x)",
                    "Boundary 5/Role": "clamped",
                    "Time/Phases": "0.5: 4, 1: 4",
                    "Output/Points": "0, 0, 0",
                    "Output/Fields every": 0,
                },
            ),
            text="",
        )
        self.assertIn("has been kept", result.stdout)
        # measured: 49; without a new mesh's slip being left out and with norms
        # alone, hundreds
        self.assertLess(len(result["t"]), 70)

    def test_refines_where_the_quantity_feels_it(self):
        point = run("slab", of("point0_x", 0.005, **COARSE_SLAB))
        force = run("slab", of("friction_force_x", 0.005, **COARSE_SLAB))
        self.assertNotEqual(point["cells"].max(), force["cells"].max())

    def test_on_1_2_3_ranks(self):
        # By default iterations leave up to a twentieth of the estimate, and an estimate
        # that differs by a per cent asks for other cells.
        scene = {
            **COARSE_SLAB,
            "Time/Phases": "1: 8",
            "Solver/Linear solver": "multigrid",
            "Solver/Contact tolerance": 1e-10,
        }
        for column, tolerance, ranks in (
            ("reaction_3_x", 0.01, 3), ("friction_dissipation", 0.02, 2)
        ):
            one = run("slab", of(column, tolerance, **scene))
            several = run("slab", of(column, tolerance, **scene), ranks)
            self.assertGreater(one["cells"][-1], 2 * 32)
            self.assertEqual(list(several["cells"]), list(one["cells"]))
            # Steps are chosen by the dual problem, which is solved to 1e-6,
            # and each begins where the one before has ended.
            self.assertClose(several["t"], one["t"], 5e-3)
            # Where signs cancel, what is left is as inexact as its parts.
            bars = one["quantity_total"]
            difference = several["quantity_total"] - bars
            self.assertLess(np.abs(difference).max(), 1e-2 * bars.max())

    def test_survives_restart(self):
        pressed = {
            "Boundary 2/Contact law": "unilateral",
            "Boundary 2/Friction law": "coulomb",
            "Boundary 2/Friction coefficient": 0.5,
            "Boundary 3/Role": "displacement",
            "Boundary 3/Displacement": "0; -0.1*min(t, 1)",
        }
        sheared = {
            "Geometry/Arguments": "12, 2 : 0, 0 : 0.12, 0.02 : true",
            "Time/Phases": "60: 80",
            "Time/Scheme": "Heun",
        }
        for name, last, scene in (
            ("slab", None, {**COARSE_SLAB, **of("reaction_3_x", 0.005)}),
            ("slab", None, {**COARSE_SLAB, **of("friction_dissipation", 0.005)}),
            ("slab", None, {**COARSE_SLAB, **pressed, **of("friction_dissipation", 0.06)}),
            # Points come to rest in the step after it.
            ("sheared_slab_2d", 16, {**sheared, **of("friction_dissipation")}),
        ):
            scene = {**scene, **EVERY_STEP}
            with Job(name, scene) as job:
                reference = job.run()
                rows = without_wall_times(reference.directory / "statistics.csv")
                with Job(name, scene, copy_of=job) as again:
                    again.forget_after(last or job.steps()[-6])
                    result = again.run("--restart")
                    self.assertEqual(
                        without_wall_times(result.directory / "statistics.csv"), rows
                    )


class LongCreep(TestCase):
    """The friction force of a strip that is pressed unevenly on a rough foundation and
    creeps for 800 relaxation times: it forgets what has relaxed, of strain and of
    steps."""

    COLUMN = "friction_force_x"
    SCENE = {
        "Geometry/Arguments": "16, 4 : 0, 0 : 4, 1 : true",
        "Material/Young's modulus": 100,
        **of_law("maxwell", Viscosity=1.5),
        **with_roles(symmetry=[0], free=[1]),
        **on_boundary(2, Role="contact", Contact_law="unilateral"),
        **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
        **on_boundary(3, Role="traction", Pressure="min(20*t, 1)*(1 + 0.3*x)"),
        "Time/Scheme": "backward Euler",
        "Time/Phases": "0.05: 6, 0.3: 6, 3: 6, 30: 6",
        "Output/Fields every": 0,
    }

    @classmethod
    def strip(cls, **overrides):
        return run("strip", {**cls.SCENE, **overrides}, text="")

    @classmethod
    def setUpClass(cls):
        cls.fine = cls.strip(**{"Geometry/Global refinements": 2})[cls.COLUMN]

    def test_estimate(self):
        result = self.strip(**of(self.COLUMN))
        error = np.abs(result[self.COLUMN] - self.fine)
        ends = [6, 12, 18, 24]
        quotient = result["quantity_space"][ends] / error[ends]
        # measured: 1.1 to 2; with all of the strain, up to 800
        self.assertGreater(quotient.min(), 0.7)
        self.assertLess(quotient.max(), 3)
        self.assertLess(result["quantity_time"][-1], 0.1 * error[-1])

    def test_time_errors_of_a_solid_fade(self):
        """In equilibrium G is zero and tells nothing of how fast errors relax."""
        law = {
            "Material/Law": "zener",
            "Material/zener/Long-term Young's modulus": 50,
            "Material/zener/Relaxation time": 0.04,
        }
        result = self.strip(**law, **of(self.COLUMN))
        # before: 3e-4 of the force, and all of the largest in the energy norm
        size = np.abs(result[self.COLUMN]).max()
        self.assertLess(result["quantity_time"][-1], 1e-5 * size)
        energy = result["estimate_time"]
        self.assertGreater(energy.max(), 1e-3 * result["energy_norm"].max())
        self.assertLess(energy[-1], 1e-3 * energy.max())

    def test_to_a_tolerance(self):
        result = self.strip(**of(self.COLUMN, 0.05))
        self.assertIn("has been kept", result.stdout)
        self.assertClose(result[self.COLUMN][-1], self.fine[-1], 0.05)
        # before, thousands of steps, none of which was the last
        self.assertLess(len(result["t"]), 200)


class KeptTangents(TestCase):
    """Tangents of creep serve while their compliances change by less than a tenth, and
    the mesh part of an estimate while little happens, also in a run that goes on from a
    checkpoint."""

    SCENE = {
        **of("point0_x"),
        # hanging nodes, and straight sides that err like the cells
        "Geometry/Global refinements": 1,
        "Geometry/Boundary refinements": "1: 1",
        "Time/Scheme": "backward Euler",
        "Time/Phases": "0.001: 5, 0.01: 15",
        "Output/Fields every": 0,
    }

    def test_estimate(self):
        kept = {}
        for ranks in (1, 2):
            overrides = {
                **self.SCENE,
                "Checkpoint/Every n steps": 1,
                "Checkpoint/Keep": 7,
            }
            with Job("hard/norton_cylinder", overrides) as job:
                result = job.run(ranks=ranks)
                rows = without_wall_times(job.results / "statistics.csv")
                kept[ranks] = result["quantity_space"]
                # by turns: two steps change the state by more than 9 %
                share = result["estimate_space"][1:] / result["energy_norm"][1:]
                in_proportion = np.abs(np.diff(share)) < 1e-9 * share[1:]
                found = list(np.flatnonzero(in_proportion) + 2)
                self.assertEqual(found, [14, 16, 18, 20])
                # the next one is in proportion (15), or made anew (14)
                for kept_to in 15, 14:
                    job.forget_after(kept_to)
                    job.run("--restart", ranks=ranks)
                    self.assertEqual(
                        without_wall_times(job.results / "statistics.csv"), rows
                    )
                if ranks == 1:
                    job.forget_after(14)
                    # other data, though they say the same, have other tangents
                    result = job.run(
                        "--restart", overrides={"Material/norton/Rate factor": "2/2"}
                    )
                    anew = result["quantity_space"][15:]
        self.assertClose(kept[2][1:], kept[1][1:], 1e-5)
        difference = np.abs(kept[1][15:] / anew - 1).max()
        self.assertLess(difference, 1e-6)  # measured: 6e-8
        self.assertGreater(difference, 1e-10)


class PointInCreep(TestCase):
    """A point of a body that creeps adds up what the mesh makes wrong of its rates:
    at 1 (norton), 10, 100 and 1000 relaxation times against a mesh four times as fine
    with the same steps."""

    SCENE = {
        "Time/Scheme": "backward Euler",
        "Time/Phases": "0.001: 3, 0.01: 3, 0.1: 3, 1: 3",
        "Output/Fields every": 0,
    }

    def check(self, level=2, **law):
        def cylinder(refinements, **more):
            overrides = {**self.SCENE, **law, **more}
            overrides["Geometry/Global refinements"] = refinements
            return run("hard/norton_cylinder", overrides)

        result = cylinder(level, **of("point0_x"))
        error = np.abs(cylinder(4)["point0_x"] - result["point0_x"])
        ends = [3, 6, 9, 12]
        quotient = result["quantity_space"][ends] / error[ends]
        # measured: 1.6 to 2.0; from strains of the elastic body, without signs, 0.9
        # and 6.6 at the end
        self.assertGreater(quotient.min(), 0.7)
        self.assertLess(quotient.max(), 3)
        return (result["quantity_correction"] / error)[ends]

    def test_linear(self):
        law = {"Material/Law": "maxwell", "Material/maxwell/Viscosity": 0.5}
        signed = self.check(**law)
        # measured: 1.26 at most, 1.09 to 1.15 of it from cells (0.97 to 1.03 with means by
        # volume, which do not meet linear strains beside hanging nodes), the rest from
        # straight sides; 0.11 where planes of symmetry are boundaries
        self.assertGreater(signed.min(), 0.85)
        self.assertLess(signed.max(), 1.35)

    def test_power_law(self):
        signed = self.check(**{"Material/norton/Exponent": 5})
        # measured: 1.11, 1.06 and 1.06 (of it 0.06 are errors of the fine mesh); 0.9
        # where planes of symmetry are boundaries
        self.assertGreater(signed[1:].min(), 0.95)
        self.assertLess(signed[1:].max(), 1.2)

    def test_beside_a_finer_layer(self):
        """Straight sides and coarse cells err in opposite directions."""
        signed = self.check(
            level=1,
            **{"Material/norton/Exponent": 5, "Geometry/Boundary refinements": "0: 1"},
        )
        # measured: 1.06 to 1.02, the bar 2.1; without sides 1.66 to 1.62, and 3.7 where
        # their size is added
        self.assertGreater(signed[1:].min(), 0.95)
        self.assertLess(signed[1:].max(), 1.2)

    def test_in_space(self):
        """A hollow sphere of 2 cells through its wall, between planes of symmetry."""
        x = "x/sqrt(x*x + y*y + z*z)"

        def sphere(refinements, **more):
            scene = {
                **self.SCENE,
                "Dimension": 3,
                "Time/Phases": "0.001: 4, 0.01: 4",
                "Geometry/Arguments": "0, 0, 0 : 1 : 2 : 3 : true",
                "Geometry/Global refinements": refinements,
                "Material/norton/Exponent": 5,
                "Boundary 0/Traction": f"{x}; y{x[1:]}; z{x[1:]}",
                "Boundary 4/Role": "symmetry",
                "Output/Points": "1, 0, 0",
            }
            return run("hard/norton_cylinder", {**scene, **more})

        result = sphere(1, **of("point0_x"))
        error = (sphere(3)["point0_x"] - result["point0_x"])[1:]
        # measured: 0.6 to 1.2, 1.4 to 2.5; where planes of symmetry are boundaries -0.5
        # to 0.5, from 0.55
        signed = result["quantity_correction"][1:] / error
        self.assertGreater(signed.min(), 0.4)
        self.assertLess(signed.max(), 1.4)
        quotient = result["quantity_space"][1:] / error
        self.assertGreater(quotient.min(), 1)
        self.assertLess(quotient.max(), 3)

    def test_corners(self):
        """The strains of a cantilever at its clamped corners, which make most of the
        error, are not linear; those of its bending by a power law change sign."""

        def cantilever(refinements, **more):
            overrides = {**self.SCENE, "Geometry/Global refinements": refinements}
            return run("cantilever_creep", {**overrides, **more})

        # measured: 0.82 and 0.69, the bar 1.6 and 1.4 of the error (norton on a mesh twice
        # as wide: 0.56 and 1.1); with linear strains extrapolated everywhere -0.06, with
        # the other sign of what the power law takes beyond its tangents 1.6
        maxwell = {"Time/Phases": "1.3: 2, 13: 2, 130: 2, 1300: 2"}
        norton = {
            "Time/Phases": "1: 2, 10: 2, 100: 2, 1000: 2",
            **of_law("norton", Rate_factor=1e4, Exponent=3, Stress_cap=0.1),
        }
        for law in maxwell, norton:
            fine, finer = (
                cantilever(2 + more, **law)["point0_y"][-1] for more in (1, 2)
            )
            coarse = cantilever(2, **law, **of("point0_y"))
            # of the order of h, as corners have it
            error = finer + (finer - fine) - coarse["point0_y"][-1]
            signed = coarse["quantity_correction"][-1] / error
            with self.subTest(law):
                self.assertGreater(signed, 0.6)
                self.assertLess(signed, 1.2)
                bar = coarse["quantity_total"][-1] / abs(error)
                self.assertGreater(bar, 1)
                self.assertLess(bar, 2)

    def test_reaction(self):
        """The force on a pillar that a roof squeezes for 1000 relaxation times: what
        has crept counts with the tangents of the law, as for a point."""
        pillar = {
            **self.SCENE,
            "Time/Phases": "4e6: 6, 4e7: 6, 4e8: 6, 4e9: 6",
            "Geometry/Arguments": "12, 6 : 0, 0 : 6, 3 : true",
            "Solver/Contact tolerance": 0,
        }
        column = "reaction_2_y"
        result = run("salt_pillar_2d", {**pillar, **of(column)})
        fine = run("salt_pillar_2d", {**pillar, "Geometry/Global refinements": 2})
        error = (fine[column] - result[column])[-1]
        # measured: 1.9 and 0.97; by residuals 0.6 and -0.16
        self.assertGreater(result["quantity_space"][-1] / abs(error), 1.5)
        self.assertClose(result["quantity_correction"][-1], error, 0.2)

    def test_elastic(self):
        """What takes the place of a force at a point of the loaded wall."""
        elastic = {"Material/Law": "elastic", "Time/Phases": "1: 1"}
        share, nu = 1 / 3 / 1000, 0.3
        known = (1 + nu) * share * (1 - 2 * nu + 4)
        for refinements in 2, 3:
            result = run(
                "hard/norton_cylinder",
                {
                    "Geometry/Global refinements": refinements,
                    "Solver/Contact tolerance": 1e-12,
                    **elastic,
                    **of("point0_x"),
                },
            )
            error = known - result["point0_x"][-1]
            # measured: 1.08, 1.05; without 0.23, 0.19
            self.assertClose(result["quantity_correction"][-1], error, 0.15)

    def test_mean_dilatation(self):
        """Nearly incompressible: what residuals say is too little."""
        nu = 0.4999
        known = (1 + nu) / 3 / 1000 * (1 - 2 * nu + 4)
        for refinements in 2, 3:
            result = run(
                "hard/norton_cylinder",
                {
                    "Geometry/Global refinements": refinements,
                    "Material/Law": "elastic",
                    "Material/Poisson's ratio": nu,
                    "Solver/Contact tolerance": 1e-12,
                    "Time/Phases": "1: 1",
                    **of("point0_x"),
                },
            )
            error = known - result["point0_x"][-1]
            # measured: 2.2, 2.3; by residuals alone 0.54, 0.53
            self.assertGreater(result["quantity_space"][-1] / error, 0.7)
            self.assertLess(result["quantity_space"][-1] / error, 3)
            # measured: 1.11, 1.22 (1.02, 1.06 without straight sides, but 1.9 beside
            # a finer layer, 1.4 with them); by residuals 0.18, 0.17
            self.assertClose(result["quantity_correction"][-1], error, 0.3)

    def test_hot(self):
        """A dual solution that is singular beside a smooth state, also where this begins
        to creep and where its stress has relaxed."""

        def pipe(refinements, **more):
            return run(
                "hot_pipe",
                {
                    "Geometry/Global refinements": refinements,
                    "Material/Law": "elastic",
                    "Material/Volumetric integration": "mean dilatation",
                    "Output/Points": "100, 0",
                    "Solver/Contact tolerance": 1e-12,
                    "Time/Phases": "1: 1",
                    **more,
                },
            )

        hot = "100 K*min(t/(1 h), 1)*ln(200 mm/x)/ln(2)*(1 + 0.5*cos(pi*y/(200 mm)))"
        relaxed = {
            "Geometry/Arguments": "8, 4 : 100, 0 : 200, 200 : true",
            "Temperature/Value": "723.15 K + " + hot,
            **of_law("maxwell", Viscosity="1e6 MPa*h"),
            "Time/Phases": "1: 2, 1000: 6",
        }
        # measured: 0.82; 23 by half of the sizes, and 16 by signed sums, where the
        # dual solution is not extrapolated at its singular point
        # 1.1; 7.5 where half of the sizes counts from a hundredth of a relaxation
        # time on
        # 1.1; 40 where strains are recovered for pressures that have relaxed
        for more in {}, {"Material/Law": "norton", "Time/Phases": "1: 4"}, relaxed:
            with self.subTest(**more):
                result = pipe(0, **{**more, **of("point0_x")})
                error = pipe(2, **more)["point0_x"][-1] - result["point0_x"][-1]
                self.assertGreater(result["quantity_space"][-1] / abs(error), 0.7)
                self.assertLess(result["quantity_space"][-1] / abs(error), 3)


class EachKind(TestCase):
    """A block between a rough foundation and a rigid head, of 8 x 8 cells against
    32 x 32 with the same steps, at 1, 10 and 1000 relaxation times."""

    BLOCK = {
        "Geometry/Arguments": "8, 8 : 0, 0 : 1, 1 : true",
        "Material/Young's modulus": 100,
        **of_law("norton", Rate_factor=0.01, Exponent=3, Stress_cap=100),
        **with_roles(symmetry=[0], free=[1]),
        **on_boundary(2, Role="contact", Contact_law="unilateral"),
        **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
        **on_boundary(3, Role="displacement", Displacement="0; -0.01*t"),
        "Time/Scheme": "backward Euler",
        "Time/Phases": "1: 8, 10: 6, 1000: 12",
        "Output/Fields every": 0,
        "Output/Points": "1, 0",
    }
    ENDS = (8, 14, 26)

    @staticmethod
    @functools.lru_cache
    def fine(**more):
        refined = {**EachKind.BLOCK, **more, "Geometry/Global refinements": 2}
        return run("block", refined, text="")

    def check(self, column, least, largest, **more):
        with self.subTest(column):
            result = run("block", {**self.BLOCK, **more, **of(column)}, text="")
            error = np.abs(self.fine(**more)[column] - result[column])
            quotients = (result["quantity_space"] / error)[[*self.ENDS]]
            self.assertGreater(quotients.min(), least)
            self.assertLess(quotients.max(), largest)
            return result

    def test_in_creep(self):
        # measured: 1.3 to 1.6, 2.9 to 4.4, up to 4, 1.3 to 2.3; the reaction meets the
        # head, whose corner is known and counts twice, against a reference that has a
        # quarter of it (without it 0.57 to 1, by chance); by residuals alone
        # the work of friction, 1.4 to 1.8, had 0.013 at the end
        self.check("contact_force_y", 0.7, 3)
        self.check("friction_force_x", 0.7, 5)
        self.check("reaction_0_x", 0.5, 5)
        self.check("point0_x", 0.7, 3)
        self.check("friction_dissipation", 0.7, 3)

    def test_without_friction(self):
        """The dual solution of the elastic body is linear and has no error, but the
        law is not linear."""
        sides = {
            **on_boundary(1, Role="traction", Pressure="min(20*t, 1)*sin(3*y)"),
            "Boundary 2/Friction law": "none",
            "Boundary 3/Displacement": "free; -0.01*t",
        }
        # measured: 2 to 2.3; by residuals 1e-14
        self.check("contact_force_y", 0.7, 3, **sides)

    def test_of_stress_that_relaxes(self):
        """At constant strain forces forget what the mesh has made wrong of them, but
        work that has been done stays as it is, under bounds that fall, too."""
        held = {"Boundary 3/Displacement": "0; -0.01*min(20*t, 1)"}
        # measured: 0.69 to 1.3; as if creep had been steady 190 at the end;
        # 1.8; with the bounds of the step alone 0.007
        self.check("reaction_3_y", 0.6, 3, **held)
        self.check("friction_dissipation", 0.7, 3, **held)
        # measured: 2.5 at the end, when the node on the plane of symmetry carries what
        # slips beside it (0.61 without); of slip that came to rest 11 times the force
        # where that does not fade; 5.3 of an error at t = 10 that is by chance a third
        # of those before and after (4.3 when remainders in doubt could reduce it)
        column = "friction_force_x"
        result = self.check(column, 0.7, 5.5, **held)
        self.assertLess(result["quantity_other"][-1], 0.2 * result[column][-1])


class BetweenTwoPlanes(TestCase):
    """A ring that is squeezed between two rough planes, whose forces cancel."""

    SEAL = {
        **POINTS,
        "Geometry/Plane model": "axisymmetric",
        "Geometry/Arguments": "4, 4 : 20, 0 : 25, 5 : true",
        **elastic_moduli(12, 0.4),
        **with_roles(free=[0, 1]),
        **{
            f"Boundary {side}/{entry}": value
            for side in (2, 3)
            for entry, value in (
                ("Role", "contact"),
                ("Contact law", "unilateral"),
                ("Friction law", "coulomb"),
                ("Friction coefficient", 0.2),
            )
        },
        **on_boundary(3, Name="top", Gap="-0.2*t"),
        "Time/Phases": "1: 4",
        "Output/Fields every": 0,
    }

    def test_of_one_plane(self):
        """As that of half the ring on a plane of symmetry, whose only contact it is."""
        half = {
            **{k: v for k, v in self.SEAL.items() if k[:10] != "Boundary 3"},
            "Geometry/Arguments": "4, 2 : 20, 0 : 25, 2.5 : true",
            "Boundary 2/Gap": "-0.1*t",
            "Boundary 3/Role": "symmetry",
        }
        fine = {**self.SEAL, "Geometry/Global refinements": 3}
        fine = run("seal", fine, text="")
        more = {"Geometry/Global refinements": 1}
        for quantity, column, of_half in (
            ("contact_force_y of top", "contact_force_3_y", "contact_force_y"),
            ("friction_force_2_x", "friction_force_2_x", "friction_force_2_x"),
        ):
            with self.subTest(quantity):
                coarse = run("seal", {**self.SEAL, **more, **of(quantity)}, text="")
                known = run("half", {**half, **more, **of(of_half)}, text="")
                self.assertClose(
                    coarse["quantity_space"][1:], known["quantity_space"][1:], 1e-8
                )
                error = fine[column][-1] - coarse[column][-1]
                # measured: 1.7, 2.7
                quotient = coarse["quantity_space"][-1] / abs(error)
                self.assertGreater(quotient, 0.7)
                self.assertLess(quotient, 3)
                kept = run("seal", {**self.SEAL, **of(quantity, 0.02)}, text="")
                self.assertIn("has been kept", kept.stdout)
                self.assertClose(kept[column][-1], fine[column][-1], 0.02)

    def test_of_two_pieces_of_a_floor(self):
        """Which share nodes, beside hanging ones: corrections add up to that of both."""
        for dim, force in (2, "contact_force"), (3, "friction_force"):
            floor, top = 2 * dim - 2, 2 * dim - 1
            up, sides = "yz"[dim - 2], "0" if dim == 2 else "if(y < 0.5, 2, 3)"
            scene = {
                "Dimension": dim,
                "Geometry/Arguments": "2, 2, 2 : 0, 0, 0 : 1, 1, 1 : true"
                if dim == 3
                else "4, 4 : 0, 0 : 1, 1 : true",
                "Geometry/Boundary ids": f"if({up} < 1e-9, if(x < 0.5, {floor}, 9), "
                f"if({up} > 1 - 1e-9, {top}, if(x < 1e-9, 0, "
                f"if(x > 1 - 1e-9, 1, {sides}))))",
                "Geometry/Boundary refinements": f"{floor}: 1",
                "Material/Young's modulus": 10,
                **{f"Boundary {side}/Role": "free" for side in range(floor)},
                **on_boundary(1, Role="traction", Traction="-0.2*t" + "; 0" * (dim - 1)),
                f"Boundary {top}/Role": "displacement",
                f"Boundary {top}/Displacement": "0.02*t" + "; 0" * (dim - 2) + "; -0.05*t",
                "Time/Phases": "1: 2",
                "Output/Fields every": 0,
                "Solver/Contact tolerance": 1e-11,
            }
            for side, coefficient in (floor, 0.1), (9, 0.2):
                scene[f"Boundary {side}/Role"] = "contact"
                scene[f"Boundary {side}/Contact law"] = "unilateral"
                scene[f"Boundary {side}/Friction law"] = "coulomb"
                scene[f"Boundary {side}/Friction coefficient"] = coefficient
            axis = "y" if dim == 2 else "x"
            both, *parts = (
                run("floor", {**scene, **of(f"{force}_{part}{axis}")}, ranks, text="")
                for part, ranks in (("", 1), (f"{floor}_", 2), ("9_", 3))
            )
            added = sum(part["quantity_correction"] for part in parts)
            self.assertClose(added, both["quantity_correction"], 1e-6, what=force)
            for part in parts:
                self.assertGreater(abs(part["quantity_correction"][-1]), 1e-4)

    def test_of_the_work_of_friction(self):
        """Which is too large by 1/n in n steps; a note tells what it is, from 5 % on."""
        for steps, is_told in (4, True), (16, True), (24, False):
            seal = {**self.SEAL, "Time/Phases": f"1: {steps}"}
            result = run("seal", seal, text="")
            told = re.search(r"by the balance of energy rather (\S+):", result.stdout)
            self.assertEqual(bool(told), is_told)
            exact = result["friction_dissipation"][-1] * steps / (steps + 1)
            if told:
                self.assertClose(float(told[1]), exact, relative=6e-3)

    def test_of_both(self):
        """Nothing but rounding, of which no part can be kept."""
        result = run("seal", {**self.SEAL, **of("contact_force_y", 0.02)}, text="")
        self.assertIn("'contact_force_y' is zero throughout", result.stdout)
        self.assertNotIn("has been kept", result.stdout)

    def test_zero_by_symmetry(self):
        """What vanishes by symmetry takes no shorter steps, though its dual solution does not."""
        fault = {
            "Geometry/Arguments": "12, 4 : 0, 0 : 30, 10 : true",
            **elastic_moduli(60, 0.25),
            "Material/Law": "maxwell",
            "Material/maxwell/Viscosity": 3000,
            **with_roles(free=[0, 1]),
            **on_boundary(2, Role="contact", **{"Friction law": "tresca"}),
            "Boundary 2/Friction bound": "0.004+0.006*exp(-((x-15)/4)^2)",
            **on_boundary(3, Role="displacement", Displacement="3e-5*t; 0"),
            "Time/Phases": "100: 20, 400: 30",
            "Output/Fields every": 0,
            **of("reaction_3_y", 0.1),
        }
        result = run("fault", fault, text="")
        self.assertIn("'reaction_3_y' is zero throughout", result.stdout)
        self.assertEqual(len(result["t"]), 51)  # those of the phases


class OnTheBoundary(TestCase):
    """What a mesh misses on the boundary is known, though no residual feels it."""

    def compare(self, column, exact, ranks=1, band=(0.97, 1.05), **overrides):
        coarse = {"Output/Fields every": 0, "Time/Phases": "1: 2", **overrides}
        result = run("boundary", {**coarse, **of(column)}, ranks, text="")
        error = exact - abs(result[column][-1])
        self.assertGreater(error, 1e-3 * exact)
        self.assertClose(result["quantity_space"][-1] / error, np.mean(band), 0,
                         np.ptp(band) / 2, column)

    def test_held_beside_a_belt(self):
        """The node at the end of the belt has no friction point."""
        for dim, arguments, force in (
            (2, "10, 5 : 0, 0 : 100, 50 : true", 40),
            (3, "8, 4, 4 : 0, 0, 0 : 100, 50, 50 : true", 2000),
        ):
            free = "; free" * (dim - 1)
            bottom, top = f"Boundary {2 * dim - 2}", f"Boundary {2 * dim - 1}"
            belt = {
                "Dimension": dim,
                "Geometry/Arguments": arguments,
                "Material/Young's modulus": 200,
                "Boundary 0/Role": "free",
                **on_boundary(1, Role="displacement", Displacement="0" + free),
                **with_roles(symmetry=[2], free=[3]),
                f"{bottom}/Role": "contact",
                f"{bottom}/Contact law": "unilateral",
                f"{bottom}/Friction law": "coulomb",
                f"{bottom}/Friction coefficient": 0.25,
                f"{bottom}/Foundation motion": "20*t" + "; 0" * (dim - 1),
                f"{top}/Role": "traction",
                f"{top}/Pressure": "1.6*t",
            }
            hanging = {"Geometry/Boundary refinements": "1: 1"}
            with self.subTest(dim=dim):
                self.compare("friction_force_x", force, **belt)
                kept = run("belt", {**belt, **of("friction_force_x", 0.005)}, text="")
                self.assertIn("has been kept", kept.stdout)
                self.assertClose(kept["friction_force_x"][-1], -force, 0.005)
                self.compare("reaction_1_x", force, 3, **belt, **hanging)
                # bounds at the ends of two steps
                work = force * 20 * 0.75
                self.compare("friction_dissipation", work, 1, (1, 1.3), **belt)

    def test_held_on_another_body(self):
        """The same between two bodies, where slip is relative."""
        for dim, arguments, ranks in (
            (2, "6, 2 : -1, -1 : 5, 0 : true | 8, 2 : 0, 0 : 4, 1 : true", 1),
            (
                3,
                "5, 3, 2 : -1, -1, -1 : 5, 2, 0 : true | "
                "6, 2, 2 : 0, 0, 0 : 4, 1, 1 : true",
                2,
            ),
        ):
            face, free = 2 * dim - 1, "; free" * (dim - 1)
            pair = {
                "Dimension": dim,
                "Geometry/Generator": " | ".join(2 * ["subdivided_hyper_rectangle"]),
                "Geometry/Arguments": arguments,
                "Geometry/Boundary refinements": "21: 1",
                "Material/Young's modulus": 1000,
                **{f"Boundary {id}/Role": "free" for id in range(2 * dim)},
                **{f"Boundary {20 + id}/Role": "free" for id in range(2 * dim)},
                f"Boundary {face - 1}/Role": "displacement",
                f"Boundary {face - 1}/Displacement": "0.1*t" + "; 0" * (dim - 1),
                **on_boundary(20, Role="displacement", Displacement="0" + free),
                **on_boundary(20 + face, Role="traction", Pressure="t"),
                **on_boundary(19 + face, Role="contact", Against=face),
                f"Boundary {19 + face}/Contact law": "unilateral",
                f"Boundary {19 + face}/Friction law": "coulomb",
                f"Boundary {19 + face}/Friction coefficient": 0.25,
            }
            with self.subTest(dim=dim):
                self.compare("reaction_20_x", 1, ranks, (0.9, 1.2), **pair)

    def test_both_held_by_symmetry(self):
        """Meshes that do not match: what their mortar makes of two strains is no
        slip."""

        def blocks(refinements, **more):
            return run(
                "two_blocks_2d",
                {
                    "Geometry/Global refinements": refinements,
                    "Material 1/Young's modulus": 20,
                    "Boundary 3/Role": "free",
                    **on_boundary(22, Role="contact", Against=3),
                    **on_boundary(22, Contact_law="unilateral", Friction_law="coulomb"),
                    "Boundary 22/Friction coefficient": 0.3,
                    **more,
                },
            )

        result = blocks(0, **of("friction_force_x"))
        error = blocks(2)["friction_force_x"][-1] - result["friction_force_x"][-1]
        # measured: 4.5; 29 with the bound of the node at the corner
        self.assertGreater(result["quantity_space"][-1] / abs(error), 0.7)
        self.assertLess(result["quantity_space"][-1] / abs(error), 6)

    def test_bounds_that_jump_within_faces(self):
        """All of the floor slips beneath a stiff block."""
        pressure, jump = 5, "if(x < 30, 0.004, 0.001)"
        for dim, arguments, ranks in (
            (2, "4, 2 : 0, 0 : 100, 50 : true", 1),
            (3, "4, 2, 2 : 0, 0, 0 : 100, 50, 50 : true", 2),
        ):
            area = 100 * 50 ** (dim - 2)
            exact = pressure * area * (0.3 * 0.004 + 0.7 * 0.001)
            floor, top = f"Boundary {2 * dim - 2}", f"Boundary {2 * dim - 1}"
            block = {
                "Dimension": dim,
                "Geometry/Arguments": arguments,
                "Material/Young's modulus": 5000,
                "Material/Poisson's ratio": 0,
                **with_roles(free=range(2 * dim - 2)),
                f"{floor}/Role": "contact",
                f"{top}/Role": "displacement",
                f"{top}/Displacement": "10*max(0, t - 0.5)"
                + "; 0" * (dim - 2)
                + "; -0.1*min(t, 0.5)",
            }
            laws = {
                "tresca": {f"{floor}/Friction bound": f"{pressure}*{jump}"},
                "coulomb": {
                    f"{floor}/Contact law": "unilateral",
                    f"{floor}/Friction coefficient": jump,
                },
            }
            for law, entries in laws.items():
                scene = {**block, f"{floor}/Friction law": law, **entries}
                for column, value in (
                    ("friction_force_x", exact),
                    (f"reaction_{2 * dim - 1}_x", exact),
                    ("friction_dissipation", 5 * exact),
                ):
                    with self.subTest(dim=dim, law=law):
                        self.compare(column, value, ranks, (1.8, 2.1), **scene)

    def test_straight_sides(self):
        """Shells: what statics says of sections and forces holds for the body, not
        for cells. Their dual solutions are uniform."""
        area = np.pi / 4
        shell = {
            "Geometry/Generator": "quarter_hyper_shell",
            "Geometry/Global refinements": 1,
            "Material/Young's modulus": 1000,
            **with_roles(free=[0, 1], symmetry=[2, 3]),
        }
        plane = {**shell, "Geometry/Arguments": "0, 0 : 50 : 80 : 2 : true"}
        solid = {
            **shell,
            "Dimension": 3,
            "Geometry/Arguments": "0, 0, 0 : 50 : 80 : 0 : true",
            "Boundary 4/Role": "symmetry",
        }
        self.compare(
            "axial_force",
            area * (80**2 - 50**2),
            **plane,
            **{
                "Geometry/Plane model": "generalized strain",
                "Loads/Axial strain": "1e-3*t",
            },
        )
        self.compare(
            "reaction_3_y",
            2 * np.pi / 3 * (80**3 - 50**3),
            **plane,
            **{"Geometry/Plane model": "axisymmetric", "Loads/Body force": "0; -t"},
        )
        self.compare(
            "reaction_2_x",
            10 * area * 50**2,
            2,
            **{**solid, "Boundary 0/Role": "traction", "Boundary 0/Pressure": "10*t"},
        )
        self.compare(
            "reaction_4_z",
            0.5 * np.pi * 80**2,
            3,
            **{**solid, **on_boundary(1, Role="traction", Traction="0; 0; -t")},
        )


class Refused(TestCase):
    def test_unknown_columns(self):
        for column in "friction_force_z", "max_displacement", "point1_x":
            self.refused(of(column), f"'{column}' is none of the quantities")
        named = of("friction_force_3_x", **{"Boundary 3/Name": "top"})
        self.refused(named, "'friction_force_x of top' is none", "reaction_y of top")
        self.refused({"Error control/Tolerance": 1}, "1 % is 0.01")

    def test_without_estimate(self):
        self.refused(
            of("reaction_3_x", **{"Error control/Error bar": "false"}),
            "'Error control/Quantity' needs the estimate of the error",
        )
        self.refused(
            of("reaction_3_x", **{"Mesh refinement/Strategy": "kelly"}),
            "'Error control/Quantity' refines by residuals",
        )


if __name__ == "__main__":
    main()
