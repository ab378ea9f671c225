# SPDX-License-Identifier: LGPL-2.1-or-later
"""Published cases (prm/verification/literature, where their sources are): the
values that others give, found with the settings that one writes down first."""

import json
import re

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk

from harness import TestCase, main, run
from runs import on_boundary


class Published(TestCase):
    def test_plate_with_friction(self):
        """GRECO: three digits are given, and other programs differ in the last."""
        plate = run("literature/greco_plate")
        published = 2.86, 2.72, 2.28, 1.98, 1.54
        for i, value in enumerate(published):
            self.assertClose(1e5 * plate[f"point{i}_x"][-1], value, absolute=0.01)
        # two of the points have lifted off
        self.assertGreater(plate["point1_y"][-1], 1e-7)
        self.assertClose(plate["point2_y"][-1], 0, absolute=1e-15)

    def test_thick_cylinder_in_creep(self):
        """NAFEMS: the steady state, up to the error of 16 cells across the wall,
        0.9 % with half of them and of second order."""
        cylinder = run("literature/thick_cylinder_creep")
        self.assertClose(cylinder["point0_velocity_x"][-1], 5.190, relative=3e-3)
        table = np.genfromtxt(
            cylinder.directory / "line_0.csv", delimiter=",", names=True
        )
        last, other = table["stress_yy"][-2:]  # one cell apart
        self.assertClose(last + 0.5 * (last - other), 250.4, relative=3e-3)

    def test_cavity_in_salt(self):
        """The steady closure of a ring of finite size; 24 cells across it leave an
        error of 0.7 %, 36 of 0.3 %."""
        cavity = run("literature/salt_cavity")
        p, n, rate, radius = 15, 3, 6e-6, 10
        strength = np.sqrt(3) * p / n / (1 - radius ** (-2 / n))
        closure = np.sqrt(3) / 2 * rate * strength**n
        self.assertClose(cavity["point0_velocity_x"][-1], -closure, relative=0.01)

    def test_slab_on_a_bed_that_does_not_pull(self):
        """Weitsman's beam; that its load is spread, and shear, leave 5 %."""
        slab = run("literature/slab_on_bed")
        bed, load = 50e6, 2e6
        bending = 30e9 / (1 - 0.2**2) * 0.25**3 / 12
        wave = (bed / 4 / bending) ** 0.25
        self.assertClose(slab["contact_force_y"][-1], -0.5 * load, relative=1e-7)
        self.assertClose(slab["contact_area"][-1], np.pi / 2 / wave, relative=0.03)
        depth = load * wave / 2 / bed * (1 + np.cosh(np.pi)) / np.sinh(np.pi)
        self.assertClose(slab["max_penetration"][-1], depth, relative=0.05)

    def test_contact_patch(self):
        """Taylor and Papadopoulos: a constant pressure passes between two bodies and
        goes on beside them, with the points on either side."""
        other_way = {
            "Boundary 22/Role": "free",
            **on_boundary(4, Role="contact", Against=22, Contact_law="unilateral"),
            "Boundary 4/Friction law": "none",
        }
        for changes in {}, other_way:
            patch = run("literature/contact_patch", changes)
            self.assertClose(patch["max_pressure"][-1], 0.01, absolute=1e-12)
            for point, depth in (0, 2), (1, 1):
                self.assertClose(
                    patch[f"point{point}_y"][-1],
                    -depth * 0.01 * (1 - 0.3**2),
                    absolute=1e-12,
                )
            self.assertLess(patch["estimate_space"][-1], 1e-12)

    def test_roller_on_block(self):
        """NAFEMS: Hertz's pressure and width between two bodies; friction changes
        the pressure by little."""
        roller = run("literature/roller_on_block")
        pressure = roller["max_pressure"][-1]
        self.assertClose(roller["contact_force_y"][-1], -17500, relative=1e-7)
        self.assertClose(pressure, 3585.37, relative=3e-3)
        self.assertClose(roller["contact_area"][-1], 6.21, absolute=12 / 48)
        rough = run(
            "literature/roller_on_block",
            {
                **on_boundary(22, Friction_law="coulomb", Friction_coefficient=0.1),
                "Time/Phases": "1: 5",
            },
        )["max_pressure"][-1]
        self.assertGreater(rough, pressure)
        self.assertLess(rough, 1.03 * pressure)

    def test_roller_on_a_stiff_plate(self):
        """MOOSE, modules/contact/test/tests/pdass_problems/cylinder_friction.i: half of
        a cylinder of radius 3 pressed by 0.006 onto a plate 10 000 times as stiff, with
        the friction coefficient 0.4. The file of results has the pressure at the nodes,
        0.25 degrees apart; by large strains."""
        angle = "(1.4835*(0.08*x + 0.92*x^3))"
        roller = {
            "Geometry/Arguments": "40, 6 : 0, -1 : 1, 0 : true | 48, 40 : 0, 1 : 1, 2 : true",
            "Geometry/Coordinates": f"if(y < 0.5, 0.4*x + 4.6*x^3, 3*sin{angle}); "
            "if(y < 0.5, 1 + 0.2*y + 0.8*y^3, "
            f"4 - 3*cos{angle}*(1 - 0.05*(y - 1) - 0.95*(y - 1)^3))",
            "Material 0/Young's modulus": 1e10,
            "Material 0/Poisson's ratio": 0,
            "Material 1/Young's modulus": 1e6,
            **on_boundary(23, Role="displacement", Displacement="0; -0.006*t"),
            "Time/Phases": "1: 3",
        }
        friction = {**on_boundary(22, Friction_law="coulomb", Friction_coefficient=0.4)}
        smooth, rough = (
            run("literature/roller_on_block", {**roller, **more})
            for more in ({}, friction)
        )
        theirs = [18314.63, 18088.35, 17412.93, 16285.27, 14682.57, 12505.79, 7990.11]
        self.assertClose(rough["max_pressure"][-1], theirs[0], relative=0.01)
        # of a half: measured 1.0 % less
        force = (sum(theirs) - theirs[0] / 2) * 3 * np.radians(0.25)
        self.assertClose(-rough["contact_force_y"][-1], force, relative=0.015)
        # friction counts
        self.assertLess(smooth["max_pressure"][-1], 0.95 * rough["max_pressure"][-1])

    def test_stacked_blocks(self):
        """MOOSE, modules/contact/test/tests/3d-mortar-contact/frictional-mortar-3d.i: a
        cube of 3^3 cells on a plate of 10 x 10 x 2 that is clamped around and ten times
        as stiff, pressed by 1e-3 with the friction coefficient 0.4. The files of results
        have the friction at the nodes of the cube: the corners stick, nodes at the edges
        slip, the middle is free. Its cells have the mean volumetric strain, too; strains
        are 2e-3 there, of finite deformations."""
        result = run(
            "two_blocks_3d",
            {
                "Geometry/Arguments": "10, 10, 2 : -0.5, -0.5, -0.3 : 0.5, 0.5, -0.25 : "
                "true | 3, 3, 3 : -0.25, -0.25, -0.25 : 0.25, 0.25, 0.25 : true",
                "Material/Volumetric integration": "mean dilatation",
                "Material 0/Young's modulus": 1e5,
                "Material 0/Poisson's ratio": 0,
                "Material 1/Young's modulus": 1e4,
                "Material 1/Poisson's ratio": 0,
                **{f"Boundary {n}/Role": "clamped" for n in range(4)},
                **{f"Boundary {n}/Role": "free" for n in (4, 5, 20, 22)},
                "Boundary 5/Against": "",
                **on_boundary(24, Role="contact", Against=5, Contact_law="unilateral"),
                **on_boundary(24, Friction_law="coulomb", Friction_coefficient=0.4),
                "Boundary 25/Role": "displacement",
                "Boundary 25/Displacement": "0; 0; -0.25*sin(2*pi*0.025/40)*t",
                "Output/Points": "",
                "Output/Fields every": 1,
            },
        )
        face = result.fields("contact")
        for x, friction, error in (
            ((-1 / 4, -1 / 4), (4.8648, 4.8707), 0.006),
            ((-1 / 4, -1 / 12), (2.8776, 0.8545), 0.002),
            ((-1 / 12, -1 / 12), (0, 0), 0),
        ):
            place = abs(face.points[:, :2] - x).sum(axis=1).argmin()
            found = face.point_data["traction"][place, :2]
            # measured: 0.005 and 0.001 of them
            self.assertClose(found, friction, absolute=error * np.linalg.norm(friction))
            sticks = face.point_data["stick"][place]
            self.assertEqual(sticks, 1 if x[1] == -1 / 4 else 0)

    def test_punch_with_friction(self):
        """Spence: between two points of friction, and what the closed form leaves
        out (0.006)."""
        nu = 0.45
        coupling = (1 - 2 * nu) / (2 * (1 - nu))
        for friction in 0.07, 0.1:
            with self.subTest(friction=friction):
                punch = run(
                    "literature/punch_with_friction",
                    {"Boundary 4/Friction coefficient": friction},
                )
                stuck = brentq(
                    lambda c: ellipk(1 - c**2) / ellipk(c**2) - coupling / friction,
                    1e-6,
                    1 - 1e-6,
                )
                area = punch["stick_area"]
                self.assertClose(area[-1], stuck, absolute=0.02)
                self.assertClose(area[1], area[-1], relative=1e-12)
                self.assertClose(
                    punch["friction_force_x"][-1] / punch["friction_force_x"][1],
                    2,
                    relative=1e-4,
                )

    def test_slip_zone(self):
        """Weertman: all slips are less by the half cell at each end that the bond
        holds, 1.5 %; pressures are right to 2e-4 in the middle."""
        zone = run("literature/slip_zone")
        nu, friction, excess = 0.2, 1, 0.05e-3
        stiffness = 4 / (2 * (1 + nu)) * (1 - nu) / (3 - 4 * nu)
        coupling = (1 - 2 * nu) / (2 * (1 - nu))
        a = np.arctan2(1, friction * coupling) / np.pi
        table = np.genfromtxt(zone.directory / "line_0.csv", delimiter=",", names=True)
        table = table[(table["t"] == 2) & (abs(table["x"]) < 0.6)]
        x = table["x"]
        slip = excess / stiffness * np.sin(np.pi * a) * (1 - x) ** a
        slip *= (1 + x) ** (1 - a)
        ratio = table["displacement_x"] / slip
        self.assertClose(ratio, 0.982, absolute=0.004)
        slope = slip * ((1 - a) / (1 + x) - a / (1 - x))
        self.assertClose(
            table["contact_pressure"],
            1e-3 + coupling * stiffness * slope,
            relative=1e-3,
        )

    def test_leaning_bar(self):
        """Klarbring: where slip cannot balance, the run says that the body jumps,
        when and where."""
        warning = "may have several solutions, and the body may jump in it: slip loses"
        for friction in 0.2, 1:
            with self.subTest(friction=friction):
                bar = run(
                    "literature/leaning_bar",
                    {"Boundary 2/Friction coefficient": friction},
                )
                p, q = -bar["contact_force_y"], abs(bar["friction_force_x"])
                pushed = slice(bar.row(1) + 1, bar.row(2) + 1)
                last = np.flatnonzero(p > 1e-12)[-1]
                if friction < 0.5:
                    self.assertLess(bar["contraction"].max(), 1)
                    self.assertNotIn(warning, bar.stdout)
                    self.assertLess(
                        p[last] - p[last + 1], 2.1 * (p[last - 1] - p[last])
                    )
                    continue
                critical = np.diff(q[pushed]) / np.diff(p[pushed])
                self.assertClose(critical, 0.5, absolute=0.1)
                self.assertGreater(q[last] / p[last], 0.8 * friction)
                self.assertGreater(p[last] - p[last + 1], 3 * (p[last - 1] - p[last]))
                self.assertGreater(bar["contraction"][last + 1], 1)
                t = f"{bar['t'][last + 1]:.6g}"
                self.assertIn(f"the step to t = {t} {warning}", bar.stdout)
                self.assertNotIn("from another start", bar.stdout)
                record = json.loads((bar.directory / "run.json").read_text())
                self.assertRegex(
                    " ".join(record["doubtful_steps"]),
                    r"most at \([0-9.]+ 0\) \(friction coefficient: 1 at most\)",
                )

    def test_several_solutions(self):
        """Klarbring's two nodes, pushed on while the plane goes down in one step:
        the foot slips with all of its friction, though the bar as it was made
        would not touch the plane any more, and that is said."""
        friction = 1.2
        bar = run(
            "literature/leaning_bar",
            {
                "Boundary 2/Friction coefficient": friction,
                "Boundary 2/Foundation motion": "0.01*min(max(t - 1, 0), 1)"
                " + 0.0118*max(t - 2, 0); 0",
                "Geometry/Global refinements": 0,
                "Solver/Contact tolerance": 1e-10,
                "Time/Phases": "2: 4, 2.334: 1",
            },
        )
        self.check_identities(bar)
        p, q = -bar["contact_force_y"][-1], abs(bar["friction_force_x"][-1])
        self.assertGreater(p, 1e-4)
        self.assertClose(q, friction * p, relative=1e-9)
        plane = -0.001 + 0.005 * (bar["t"][-1] - 2)
        self.assertGreater(plane, 0)  # so u = 0 is a solution, too
        at_least = bar["max_displacement"][-1] / bar["max_displacement"].max()
        found = re.search(
            r"another solution, whose displacement differs by ([0-9.]+) of", bar.stdout
        )
        self.assertGreater(float(found[1]), 0.99 * at_least)

    def test_jump_with_few_corrections(self):
        """With too few for it, the jump is found on the way from smaller
        coefficients, and said; with one, no step in which the foot slips is."""

        def bar(iterations):
            more = {"Solver/Maximal contact iterations": iterations}
            return run("literature/leaning_bar", more, check=False)

        self.assertRegex(
            bar(3).stdout,
            "the step to t = 2.9[0-9]* may have several solutions, and the body may "
            "jump in it: from the last step no solution was found, but one along "
            "those for smaller friction coefficients",
        )
        self.assertRefused(
            bar(1),
            "t = 2.0",
            "Coulomb's law with the pressure of the step itself may have no solution",
            "friction and pressure fit worst at (",
            "None was found on the way from smaller coefficients",
        )


if __name__ == "__main__":
    main()
