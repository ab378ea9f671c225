# SPDX-License-Identifier: LGPL-2.1-or-later
"""Friction bounds that depend on the slip rate of the step before."""

import numpy as np

from harness import TestCase, main, run
from runs import elastic_moduli, on_boundary, with_roles


def factor(v):
    return 0.5 + 0.5 * np.exp(-v / 0.1)


# A plate that is held above a foundation which slides at 0.1 and then at 0.3.
PLATE = {
    "Geometry/Generator": "subdivided_hyper_rectangle",
    "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
    **elastic_moduli(1, 0.3),
    "Material/Law": "elastic",
    **with_roles(free=[0, 1]),
    **on_boundary(2, Role="contact", Slip_rate_factor="0.5 + 0.5*exp(-v/0.1)"),
    "Boundary 2/Foundation motion": "if(t < 1, 0.1*t, 0.3*t - 0.2); 0",
    "Boundary 3/Role": "clamped",
    "Time/Phases": "1: 12, 2: 10",
}
TRESCA = {"Boundary 2/Friction law": "tresca", "Boundary 2/Friction bound": 0.01}
# by the pressure of a plate that comes down
COULOMB = {
    **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.5),
    **on_boundary(3, Role="displacement", Displacement="0; -0.01*min(1, 10*t)"),
}
UNILATERAL = {**COULOMB, "Boundary 2/Contact law": "unilateral"}
SOFT = {
    **COULOMB,
    **on_boundary(2, Contact_law="normal compliance", Compliance=3),
    "Boundary 2/Compliance exponent": 1.5,
}
GIVEN = {
    **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.5),
    "Boundary 2/Normal stress": -0.02,
    "Initial state/Equilibrate": "true",
}
ADAPTIVE = {"Mesh refinement/Strategy": "residual", "Mesh refinement/Maximal level": 2}


class SlipRate(TestCase):
    def test_steady_slip(self):
        """Two steps of equal slip, and the bound is that of its rate."""
        for name, scene, ranks in (
            ("tresca", TRESCA, 1),
            ("tresca on meshes", {**TRESCA, **ADAPTIVE}, 3),
            ("given pressure", GIVEN, 2),
            ("lagged", {**UNILATERAL, "Solver/Coulomb pressure": "lagged"}, 1),
            ("coupled", UNILATERAL, 2),
            ("compliance", SOFT, 2),
        ):
            with self.subTest(scene=name):
                result = run("plate", {**PLATE, **scene}, ranks, text="")
                force = -result["friction_force_x"]
                normal = 0.02
                if "contact_force_y" in result.statistics:
                    normal = -0.5 * result["contact_force_y"]
                ratio = force[1:] / np.broadcast_to(normal, force.shape)[1:]
                # more than at the first speed, and that of the last
                self.assertGreater(ratio[:4].max(), 1.05 * factor(0.1))
                self.assertClose(ratio[-1], factor(0.3), relative=1e-4)
                self.assertEqual(result["slip_area"][-1], 2.0)

    def test_without_friction_at_rest(self):
        """What does not resist at rest is not at rest for ever."""
        name = "Boundary 2/Slip rate factor"
        for scene in TRESCA, UNILATERAL:
            result = run("plate", {**PLATE, **scene, name: "v/(0.1 + v)"}, text="")
            normal = 0.02
            if "contact_force_y" in result.statistics:
                normal = -0.5 * result["contact_force_y"][-1]
            force = -result["friction_force_x"][-1]
            self.assertClose(force, 0.75 * normal, relative=1e-2)

    def test_space(self):
        """With a direction that turns, on hanging nodes."""
        changes = {
            "Boundary 4/Slip rate factor": "0.5 + 0.5*exp(-v/0.1)",
            "Boundary 4/Foundation motion": "0.2*cos(pi*t); 0.2*sin(pi*t); 0",
            "Boundary 5/Traction": "0; 0; 0",
            "Boundary 4/Friction bound": 0.002,
            "Time/Phases": "2: 12",
        }
        result = run("pad_adaptive", changes, ranks=2)
        force = np.hypot(result["friction_force_x"], result["friction_force_y"])
        speed = 0.2 * np.pi
        # of an area of 1; the body follows a little
        self.assertClose(force[-1], 0.002 * factor(speed), relative=0.02)

    def test_first_order_in_the_step(self):
        """The rate is that of the step before."""
        smooth = {
            **TRESCA,
            "Boundary 2/Friction bound": 0.002,
            "Boundary 2/Foundation motion": "0.1*t + 0.1*t^2; 0",
        }
        forces = []
        for steps in 20, 40, 80:
            result = run(
                "plate", {**PLATE, **smooth, "Time/Phases": f"1: {steps}"}, text=""
            )
            forces.append(-result["friction_force_x"][-1])
        changes = np.diff(forces)
        orders = np.log2(changes[:-1] / changes[1:])
        self.assertLess(abs(orders - 1).max(), 0.1, (forces, orders))

    def test_refusals(self):
        name = "Boundary 2/Slip rate factor"
        for value, sentence in (
            ("1 - 20*v", f"'{name}' is -"),
            ("1 + t", "only the slip rate v is known"),
            ("1 + x", "x"),
        ):
            scene = {**PLATE, **TRESCA, name: value}
            self.assertRefused(run("plate", scene, text="", check=False), sentence)


if __name__ == "__main__":
    main()
