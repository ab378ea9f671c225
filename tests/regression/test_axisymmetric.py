# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bodies of revolution (`Geometry/Plane model` = axisymmetric): closed forms with
rates, the same bodies in plane strain and in 3D, and the discrete identities.

Manufactured solutions for all laws and both laws of friction are in
test_manufactured.py."""

import numpy as np
from scipy.integrate import solve_ivp

from harness import TestCase, main, run
from runs import boundaries, elastic_moduli, of_law, on_boundary

RING = {"Dimension": 2, "Geometry/Plane model": "axisymmetric"}


def box(cells, corners, *roles, **more):
    """A box (r and z of its corners), sides inside, outside, below, above."""
    return {
        **RING,
        "Geometry/Arguments": f"{cells} : {corners} : true",
        "Time/Phases": "1: 1",
        "Solver/Contact tolerance": 1e-12,
        "Output/Fields every": 0,
        **boundaries(*roles),
        **more,
    }


def pressed(pressure):
    return {"Role": "traction", "Pressure": f"{pressure}*t"}


def compute(entries, ranks=1):
    return run("ring", entries, ranks=ranks, text="")


def error(result, norm="energy"):
    return result[f"error_{norm}"][-1] / result[f"exact_{norm}"][-1]


class Patch(TestCase):
    """A constant stress with equal radial and hoop parts is met to rounding, on a
    distorted mesh with hanging nodes, on the axis and beside it."""

    def check(self, inside, ranks=1, **more):
        E, nu, radial, axial = 1, 0.3, 0.2, -0.5
        u_r = (radial - nu * (radial + axial)) / E
        u_z = (axial - 2 * nu * radial) / E
        corners = f"{0 if inside == 'symmetry' else 0.5}, 0 : 1, 1"
        result = compute(
            box(
                "3, 3",
                corners,
                inside,
                pressed(-radial),
                "symmetry",
                pressed(-axial),
                **{
                    # straight where roles ask for it
                    "Geometry/Coordinates": "x + 0.3*x*(x - 0.5)*(1 - x)*y; "
                    "y*(1 + 0.2*(1 - y)*x)",
                    "Geometry/Boundary refinements": "0: 1, 2: 1",
                    "Exact solution/Displacement": f"{u_r}*x*t; {u_z}*y*t",
                    "Material/Poisson's ratio": nu,
                    **more,
                },
            ),
            ranks,
        )
        self.assertLess(error(result), 1e-12)
        self.assertLess(error(result, "stress"), 1e-12)
        self.assertLess(result["force_balance_defect"].max(), 1e-11)
        r = 0 if inside == "symmetry" else 0.5
        energy = 0.5 * (2 * radial * u_r + axial * u_z) * np.pi * (1 - r**2)
        self.assertClose(result["stored_energy"][-1], energy, relative=1e-12)
        self.assertClose(
            result["reaction_2_y"][-1], -axial * np.pi * (1 - r**2), relative=1e-11
        )
        return result

    def test_on_the_axis(self):
        self.check("symmetry")
        self.check("symmetry", **{"Material/Volumetric integration": "mean dilatation"})

    def test_beside_the_axis(self):
        self.check(pressed(-0.2))

    def test_ranks(self):
        self.check("symmetry", 3)


class Lame(TestCase):
    """Thick cylinder and sphere under internal pressure: first order, and the
    estimate is the error, also that of the displacement of the inner wall."""

    NU = 0.3
    POINT = {"Output/Points": "1, 0", "Error control/Quantity": "point0_x"}

    def check_ladder(self, ladder, displacement):
        errors = [error(result) for result in ladder]
        self.assertGreater(np.log2(errors[0] / errors[1]), 0.97)
        stresses = [error(result, "stress") for result in ladder]
        self.assertGreater(np.log2(stresses[0] / stresses[1]), 0.95)
        for result in ladder:
            effectivity = result["estimate_total"][-1] / result["error_energy"][-1]
            self.assertGreater(effectivity, 0.8)
            self.assertLess(effectivity, 2)
            # measured: 1.00 to 1.03; 0.12 where the dual load is a force at a
            # point of the loaded wall, which residuals take for an error
            error_of_point = displacement - result["point0_x"][-1]
            signed = result["quantity_correction"][-1] / error_of_point
            self.assertGreater(signed, 0.9)
            self.assertLess(signed, 1.1)

    def cylinder(self, **more):
        # u = A r + B/r by p = 1 inside, nothing outside, no strain along z
        inner, outer, nu = 1, 2, self.NU
        more = {**self.POINT, **more}
        share = inner**2 / (outer**2 - inner**2)
        A = (1 + nu) * (1 - 2 * nu) * share
        B = (1 + nu) * share * outer**2
        return compute(
            box(
                "4, 2",
                f"{inner}, 0 : {outer}, 0.5",
                pressed(1),
                "free",
                "symmetry",
                "symmetry",
                **{
                    "Exact solution/Displacement": f"t*({A}*x + {B}/x); 0",
                    "Material/Poisson's ratio": nu,
                    **more,
                },
            )
        )

    def sphere(self, **more):
        inner, outer, nu = 1, 2, self.NU
        more = {**self.POINT, **more}
        share = inner**3 / (outer**3 - inner**3)
        A = (1 - 2 * nu) * share
        B = (1 + nu) / 2 * share * outer**3
        size = f"({A} + {B}/sqrt(x^2 + y^2)^3)"
        return compute(
            {
                **RING,
                "Geometry/Generator": "quarter_hyper_shell",
                "Geometry/Arguments": f"0, 0 : {inner} : {outer} : 4 : true",
                **boundaries(pressed(1), "free", "symmetry", "symmetry"),
                "Time/Phases": "1: 1",
                "Output/Fields every": 0,
                "Exact solution/Displacement": f"t*{size}*x; t*{size}*y",
                "Material/Poisson's ratio": nu,
                **more,
            }
        )

    def test_cylinder(self):
        self.check_ladder(
            [self.cylinder(**{"Geometry/Global refinements": g}) for g in (2, 3)],
            displacement=1.43 / 0.75,
        )

    def test_sphere(self):
        self.check_ladder(
            [self.sphere(**{"Geometry/Global refinements": g}) for g in (3, 4)],
            displacement=0.8,
        )

    def test_finer_run(self):
        """A finer run in the place of the solution."""
        unknown = {"Exact solution/Displacement": ""}
        fine = self.cylinder(
            **{
                "Geometry/Global refinements": 4,
                "Output/Reference fields": "true",
                **unknown,
            }
        )
        coarse = {
            "Geometry/Global refinements": 1,
            "Material/Volumetric integration": "mean dilatation",
        }
        known = self.cylinder(**coarse)
        compared = self.cylinder(
            **coarse,
            **unknown,
            **{"Exact solution/Reference directory": fine.directory},
        )
        for norm in "energy", "h1", "stress":
            self.assertClose(
                error(compared, norm), error(known, norm), relative=0.05, what=norm
            )


class Creep(TestCase):
    """Spheres of linear laws over time, and the steady states of power-law creep
    (Bailey)."""

    RATE, N = 3.125e-14, 5
    STEEL = {
        **elastic_moduli(2e5, 0.3),
        **of_law("norton", Rate_factor=RATE, Exponent=N, Stress_cap=1000),
        "Initial state/Equilibrate": "true",
        "Time/Scheme": "backward Euler",
        "Time/Phases": "1: 10, 10: 10",
        "Output/Points": "100, 0",
        "Output/Point fields": "velocity",
    }

    def check_wall(self, law, bulk, shear, **more):
        """The displacement of the inner wall of a sphere, of second order in mesh and
        steps together. The stress is Lame's at all times, whatever the moduli, and
        its mean and its deviator strain by the equation of the law. A modulus is
        (at once, in the long term, relaxation time)."""
        inner, outer = 1, 2
        share = inner**3 / (outer**3 - inner**3)

        def pressure(t):
            return 1 + np.sin(3 * t) / 2

        def strain(modulus, t):
            # M e' = p' + (p - M_inf e)/theta
            M, long, theta = modulus

            def rate(t, e):
                return (1.5 * np.cos(3 * t) + (pressure(t) - long * e) / theta) / M

            start, exact = [pressure(0) / M], {"rtol": 1e-10, "atol": 1e-12}
            return solve_ivp(rate, (0, t[-1]), start, t_eval=t, **exact).y[0]

        errors = []
        for refinements, steps in (3, 20), (4, 40):
            sphere = compute(
                {
                    **RING,
                    "Geometry/Generator": "quarter_hyper_shell",
                    "Geometry/Arguments": f"0, 0 : {inner} : {outer} : 4 : true",
                    "Geometry/Global refinements": refinements,
                    **boundaries(
                        {"Role": "traction", "Pressure": "1 + sin(3*t)/2"},
                        "free",
                        "symmetry",
                        "symmetry",
                    ),
                    "Material/Poisson's ratio": 0.3,
                    "Material/Law": law,
                    "Material/Volumetric integration": "full",
                    "Initial state/Equilibrate": "true",
                    "Time/Scheme": "Heun",
                    "Time/Phases": f"2: {steps}",
                    "Output/Points": "1, 0",
                    "Output/Fields every": 0,
                    **{f"Material/{law}/{name}": value for name, value in more.items()},
                }
            )
            t = sphere["t"]
            known = share * (
                strain(bulk, t) / 3 + (outer / inner) ** 3 / 4 * strain(shear, t)
            )
            self.assertGreater(known[-1], 1.5 * known[0])
            errors.append(abs(sphere["point0_x"] - known).max() / abs(known).max())
        # measured: 0.0032 (maxwell), 0.0022 (zener); rates of 1.98
        self.assertLess(errors[1], 0.005)
        self.assertGreater(np.log2(errors[0] / errors[1]), 1.8)

    def test_maxwell_sphere(self):
        K, G, viscosity = 1 / 1.2, 1 / 2.6, 0.8
        self.check_wall(
            "maxwell", (K, K, 1), (G, 0, viscosity / G), Viscosity=viscosity
        )

    def test_zener_sphere(self):
        """Of which the bulk modulus relaxes, too, in another proportion."""
        more = {
            "Relaxation time": 0.7,
            "Long-term Young's modulus": 0.4,
            "Long-term Poisson's ratio": 0.2,
        }
        bulk, shear = (1 / 1.2, 0.4 / 1.8, 0.7), (1 / 2.6, 0.4 / 2.4, 0.7)
        self.check_wall("zener", bulk, shear, **more)

    def test_cylinder(self):
        """As literature/thick_cylinder_creep, a quarter of which is in plane strain
        there."""
        cylinder = compute(
            box(
                "16, 1",
                "100, 0 : 200, 10",
                {"Role": "traction", "Pressure": 200},
                "free",
                "symmetry",
                "symmetry",
                **self.STEEL,
                **{
                    "Solver/Contact tolerance": 1e-8,
                    "Output/Lines": "196.875, 5 : 190.625, 5 : 2",
                    "Output/Line fields": "stress",
                },
            )
        )
        self.assertClose(cylinder["point0_velocity_x"][-1], 5.190, relative=3e-3)
        table = np.genfromtxt(
            cylinder.directory / "line_0.csv", delimiter=",", names=True
        )
        last, other = table["stress_zz"][-2:]  # one cell apart
        self.assertClose(last + 0.5 * (last - other), 250.4, relative=3e-3)

    def test_sphere(self):
        sphere = compute(
            {
                **RING,
                "Geometry/Generator": "quarter_hyper_shell",
                "Geometry/Arguments": "0, 0 : 100 : 200 : 4 : true",
                "Geometry/Global refinements": 4,
                **boundaries(
                    {"Role": "traction", "Pressure": 200},
                    "free",
                    "symmetry",
                    "symmetry",
                ),
                **self.STEEL,
                "Output/Fields every": 0,
            }
        )
        n = self.N
        strength = 3 * 200 / (2 * n) / (100 ** (-3 / n) - 200 ** (-3 / n))
        velocity = 0.5 * self.RATE * strength**n / 100**2
        self.assertClose(sphere["point0_velocity_x"][-1], velocity, relative=0.01)

    def test_closure_of_borehole_and_cavern(self):
        """The steady velocity of the wall in rock that ends after 1e6 and 1e3 radii,
        which is 3e-4 and 3e-3 of it; rings grow with r, by
        the same factor on finer meshes. Second order."""
        rate, n, p = 6e-6, 3, 15
        rock = {
            **elastic_moduli(25000, 0.25),
            **of_law("norton", Rate_factor=rate, Exponent=n, Stress_cap=60),
            "Initial state/Stress": "-20; -20; -20; 0",
            "Time/Scheme": "backward Euler",
            "Time/Phases": "1: 4, 100: 6, 1e4: 6, 1e6: 6, 1e8: 6",
            "Output/Points": "1, 0",
            "Output/Point fields": "velocity",
        }
        sides = (
            {"Role": "traction", "Pressure": f"20 - {p}*min(t, 1)"},
            {"Role": "traction", "Pressure": 20},
            *("symmetry", "symmetry"),
        )
        for meshes, shape, known, ends in (
            (
                *(("48, 1", "96, 1"), "1e6^x; y"),
                np.sqrt(0.75) ** (n + 1) * (2 * p / n) ** n,
                1e6 ** (-2 / n),
            ),
            (
                *(("30, 10", "60, 20"), "1e3^x*cos(pi/2*y); 1e3^x*sin(pi/2*y)"),
                0.5 * (3 * p / 2 / n) ** n,
                1e3 ** (-3 / n),
            ),
        ):
            with self.subTest(shape):
                errors = []
                for cells in meshes:
                    more = {"Geometry/Coordinates": shape}
                    hole = compute(box(cells, "0, 0 : 1, 1", *sides, **rock, **more))
                    closure = -hole["point0_velocity_x"][-1] / rate
                    errors.append(1 - closure * (1 - ends) ** n / known)
                # measured: 0.045, 0.011; 0.083, 0.021
                self.assertLess(errors[1], 0.025)
                self.assertGreater(np.log2(errors[0] / errors[1]), 1.9)


class Contact(TestCase):
    def test_hertz(self):
        """The ball of the disc in hertz_disc_2d, by all solvers."""
        forces = []
        for solver in "direct", "multigrid", "algebraic multigrid":
            ball = run(
                "hertz_disc_2d",
                {
                    "Geometry/Plane model": "axisymmetric",
                    "Solver/Linear solver": solver,
                    "Output/Fields every": 0,
                },
            )
            forces.append(ball["contact_force_y"][-1])
        self.assertClose(forces, forces[0], relative=1e-8)
        force, modulus = abs(forces[0]), 1 / (1 - 0.3**2)
        radius = (0.75 * force / modulus) ** (1 / 3)
        # of cells of a tenth of it
        self.assertClose(
            np.sqrt(ball["contact_area"][-1] / np.pi), radius, relative=0.05
        )
        self.assertClose(
            ball["max_pressure"][-1], 1.5 * force / np.pi / radius**2, relative=0.02
        )
        self.assertLess(ball["force_balance_defect"].max(), 1e-9)

    def test_indenters(self):
        """Punch, ball, cone and a pressure on a circle, of one force and radius, on
        which what is given far away depends (Sneddon, Hertz, Boussinesq)."""

        def indent(refinements, ids="x < 1", **more):
            return run(
                "literature/indenter",
                {
                    "Geometry/Global refinements": refinements,
                    "Geometry/Boundary ids": f"if(id == 2 && {ids}, 4, id)",
                    **{f"Boundary 4/{k.replace('_', ' ')}": v for k, v in more.items()},
                    "Output/Points": "0, 0; 1, 0",
                    "Output/Fields every": 1,
                },
            )

        modulus = 1 / (1 - 0.3**2)
        punches = [indent(n) for n in (1, 2, 3)]
        force = np.array([-punch["contact_force_y"][-1] for punch in punches])
        errors = force / (0.02 * modulus) - 1
        # measured: 0.146, 0.066, 0.031
        self.assertClose(np.log2(errors[:-1] / errors[1:]), 1.1, absolute=0.1)
        face = punches[-1].fields("contact")
        r, pressure = face.points[:, 0], face.point_data["contact_pressure"]
        inner = r < 0.7
        known = 0.01 * modulus / np.pi / np.sqrt(1 - r[inner] ** 2)
        # measured: 0.03 to 0.045; the node at the edge carries more
        self.assertClose(pressure[inner], known, relative=0.05)

        balls = [
            indent(n, "x < 2", Gap="0.0075*x^2", Foundation_displacement="-0.015*t")
            for n in (1, 2, 3)
        ]
        r = np.linspace(0, 2, 2001)
        known = 0.03 * modulus / np.pi * np.sqrt(np.maximum(1 - r**2, 0))
        errors = []
        for ball in balls:
            face = ball.fields("contact")
            order = np.argsort(face.points[:, 0])
            pressure = np.interp(
                r, face.points[order, 0], face.point_data["contact_pressure"][order]
            )
            errors.append(
                (
                    -ball["contact_force_y"][-1] / (0.02 * modulus) - 1,
                    np.sqrt((r * (pressure - known) ** 2).sum() / (r * known**2).sum()),
                    np.sqrt(ball["contact_area"][-1] / np.pi) - 1,
                )
            )
        # measured: 0.035, 0.010, 0.0028; 0.21, 0.10, 0.048; 0.32, 0.16, 0.079, a cell
        for rate in np.log2(np.divide(errors[:-1], errors[1:])):
            self.assertClose(rate[0], 1.85, absolute=0.1, what="force")
            self.assertClose(rate[1:], 1.05, absolute=0.15, what="pressure, radius")
        self.assertLess(errors[-1][0], 0.003)

        # twice as deep as the punch
        cone = indent(3, "x < 2", Gap="0.04/pi*x", Foundation_displacement="-0.02*t")
        # measured: 0.003; the radius to a cell
        self.assertClose(-cone["contact_force_y"][-1], 0.02 * modulus, relative=0.004)
        self.assertClose(np.sqrt(cone["contact_area"][-1] / np.pi), 1, absolute=0.125)

        circle = indent(
            3,
            Role="traction",
            Contact_law="not given",
            Pressure=f"{0.02 * modulus / np.pi}*t",
            Foundation_displacement="",
            Gap="",
        )
        deep = 0.04 / np.pi
        self.assertClose(circle["point0_y"][-1], deep, relative=2e-3)
        self.assertClose(circle["point1_y"][-1], deep * 2 / np.pi, relative=0.015)

    def test_boussinesq(self):
        """A force at a point of the surface, which a hole of radius 1 leaves out:
        first order, and the estimate is the error."""
        size, far = f"{1.3 / 2 / np.pi}*t", "sqrt(x^2 + y^2)"
        moved = {
            "Role": "displacement",
            "Displacement": (
                f"{size}*(x*y/{far}^3 - 0.4*x/({far}*({far} + y))); "
                f"{size}*(1.4/{far} + y^2/{far}^3)"
            ),
        }
        errors = []
        for refinements in 2, 3:
            shell = compute(
                {
                    **RING,
                    "Geometry/Generator": "quarter_hyper_shell",
                    "Geometry/Arguments": "0, 0 : 1 : 2 : 4 : true",
                    "Geometry/Global refinements": refinements,
                    **boundaries(moved, moved, "symmetry", "free"),
                    "Time/Phases": "1: 1",
                    "Output/Fields every": 0,
                    "Exact solution/Displacement": moved["Displacement"],
                }
            )
            errors.append(error(shell))
            # measured: 1.04, 1.02
            effectivity = shell["estimate_total"][-1] / shell["error_energy"][-1]
            self.assertClose(effectivity, 1.03, absolute=0.05)
        # measured: 0.145, 0.073
        self.assertClose(np.log2(errors[0] / errors[1]), 1, absolute=0.05)

    def test_beds(self):
        """A solid cylinder pressed onto beds of all kinds: a uniform state, on the
        axis, too."""
        pressure, stiffness, nu = 0.1, 2, 0.3
        for name, bed, depth in (
            (
                "contact_force_y",
                {
                    "Contact law": "normal compliance",
                    "Compliance": stiffness,
                    "Friction law": "none",
                },
                pressure / stiffness,
            ),
            (
                "contact_force_y",
                {
                    "Contact law": "unilateral",
                    "Friction law": "coulomb",
                    "Friction coefficient": 0,
                },
                0,
            ),
            (
                "reaction_2_y",
                {"Role": "traction", "Normal stiffness": stiffness},
                pressure / stiffness,
            ),
        ):
            with self.subTest(name, bed=bed):
                block = compute(
                    box(
                        "4, 4",
                        "0, 0 : 1, 1",
                        "symmetry",
                        "free",
                        {"Role": "contact", **bed},
                        pressed(pressure),
                        **{
                            "Output/Points": "0, 1; 1, 0",
                            "Geometry/Boundary refinements": "2: 1, 0: 1",
                        },
                    )
                )
                self.assertClose(abs(block[name][-1]), pressure * np.pi, relative=1e-9)
                self.assertClose(
                    block["point0_y"][-1], -depth - pressure, relative=1e-9
                )
                self.assertClose(block["point1_x"][-1], nu * pressure, relative=1e-9)

    def test_ball_in_space(self):
        """A ball that creeps, on a plane with Coulomb friction, is that in 3D up to
        the error of its coarse mesh."""
        creep = {
            **of_law("maxwell", Viscosity=1),
            **on_boundary(4, Friction_law="coulomb", Friction_coefficient=0.1),
            "Time/Phases": "1: 4",
            "Solver/Contact tolerance": 1e-8,
            "Output/Fields every": 0,
        }
        ball = run(
            "hertz_disc_2d",
            {
                "Geometry/Plane model": "axisymmetric",
                "Geometry/Global refinements": 4,
                "Boundary 1/Displacement": "free; 0.03*t",
                **creep,
            },
        )
        quarter = run("hertz_ball_3d", {"Geometry/Global refinements": 2, **creep})
        for column, other, error in (
            ("contact_force_y", "contact_force_z", 0.01),
            ("stored_energy", "stored_energy", 0.015),
            ("viscous_dissipation", "viscous_dissipation", 0.03),
            ("friction_dissipation", "friction_dissipation", 0.15),
        ):
            self.assertClose(
                4 * quarter[other][-1], ball[column][-1], relative=error, what=column
            )

    def test_ring_that_slips(self):
        """A flat ring between plates, of which one has friction, is driven outwards:
        the mean of u_r over its thickness solves an ordinary equation,
        sigma_r' + (sigma_r - sigma_t)/r = g/h."""
        height, friction, pressure, nu = 0.1, 0.01, 0.5, 0.3
        ring = compute(
            box(
                "32, 4",
                f"1, 0 : 2, {height}",
                pressed(pressure),
                "free",
                {
                    "Role": "contact",
                    "Friction law": "tresca",
                    "Friction bound": friction,
                },
                "symmetry",
                **{
                    "Output/Integrals": "boundary 0: displacement; "
                    "boundary 1: displacement",
                },
            )
        )
        lame, mu = nu / (1 + nu) / (1 - 2 * nu), 1 / (2 + 2 * nu)
        stiff = lame + 2 * mu
        C = friction / height / (3 * stiff)

        def row(r):
            # sigma_r of A r + B/r
            return [stiff + lame, (lame - stiff) / r**2]

        def rest(r):
            return (2 * stiff + lame) * C * r

        A, B = np.linalg.solve([row(1), row(2)], [-pressure - rest(1), -rest(2)])
        for i, r in enumerate((1, 2)):
            mean = (
                ring[f"integral_boundary_{i}_displacement_x"][-1]
                / ring[f"area_boundary_{i}"][-1]
            )
            self.assertClose(mean, A * r + B / r + C * r**2, relative=1e-3)
        area = np.pi * 3
        self.assertClose(ring["slip_area"][-1], area, relative=1e-12)
        work = ring["friction_dissipation"][-1]
        self.assertGreater(work, 0)
        self.assertLess(ring["energy_balance_defect"].max(), 1e-10)


class Scenes(TestCase):
    """Wrong scenes, units, and what is the same as elsewhere."""

    def test_refusals(self):
        scene = box("2, 2", "0, 0 : 1, 1", "symmetry", "free", "symmetry", "free")
        for changes, *sentences in (
            ({"Geometry/Translation": "-0.5, 0"}, "The mesh crosses the axis"),
            ({"Boundary 0/Role": "free"}, "Boundary 0 lies on the axis", "u_r = 0"),
            ({"Boundary 2/Role": "free"}, "rigid motion free: translation along y"),
            (
                {"Dimension": 3, "Geometry/Arguments": "2, 2, 2 : 0, 0, 0 : 1, 1, 1"},
                "is that of meshes in 2D",
            ),
            (
                {"Geometry/Plane model": "strain", "Output/Revolved angle": 90},
                "'Output/Revolved angle' is for bodies of revolution",
            ),
        ):
            with self.subTest(changes):
                process = run("ring", {**scene, **changes}, text="", check=False)
                self.assertRefused(process, *sentences)

    def test_units(self):
        """Of whole bodies, not on a unit of depth."""
        units = {"Length": "m", "Time": "s", "Stress": "Pa"}
        result = compute(
            box(
                "2, 2",
                "0, 0 : 1, 1",
                "symmetry",
                "free",
                "symmetry",
                pressed(1),
                **{f"Units/{name}": value for name, value in units.items()},
                **{"Material/Young's modulus": 1},
                **{"Output/Integrals": "boundary 3: stress vector"},
            )
        )
        header = (result.directory / "statistics.csv").read_text().splitlines()[0]
        for label in (
            *("load_y [N]", "stored_energy [J]", "area_boundary_3 [m^2]"),
            "integral_boundary_3_stress_vector_y [N]",
        ):
            self.assertIn(label, header)

    def test_surface_in_space(self):
        """Closed, or with the section at its two ends; on ranks and with hanging nodes,
        around what is there in the present stage."""
        solid = box(
            "2, 2",
            "0, 0 : 2, 1",
            "symmetry",
            pressed(0.1),
            "symmetry",
            "free",
            **{
                "Geometry/Material ids": "if(x < 1, 1, 0)",
                "Geometry/Boundary refinements": "3: 1",
                "Material 0/Young's modulus": 1,
                "Material 1/Young's modulus": 1,
                "Material 1/Removed at": 0.5,
                "Time/Phases": "0.5: 1, 1: 1",
                "Output/Fields every": 1,
            },
        )
        # A circle of 36 straight pieces, or three quarters of it of 27.
        around = 72 * np.sin(np.pi / 36)
        for angle, section, ranks in (360, 0, 1), (270, 2, 1), (270, 2, 3):
            result = run(
                "ring", {**solid, "Output/Revolved angle": angle}, ranks=ranks, text=""
            )
            self.assertClose([t for t, _ in result.series("revolved")], [0, 0.5, 1])
            for index, inner in (0, 0), (-1, 1):
                fields = result.fields("revolved", index)
                a, b, d, c = (fields.points[fields.cells[:, i]] for i in (0, 1, 3, 2))
                area = np.linalg.norm(np.cross(c - a, d - b), axis=1).sum() / 2
                # rims, the rings below and above
                rims = around * (2 + inner)
                rings = around * np.cos(np.pi / 36) * (4 - inner)
                expected = angle / 360 * (rims + rings) + section * (2 - inner)
                self.assertClose(area, expected, relative=1e-6)
            radius = np.hypot(fields.points[:, 0], fields.points[:, 2])
            u = fields.point_data["displacement"]
            # Turned with the section, z upwards.
            sides = fields.points[:, [0, 2]] / radius[:, None]
            along = u[:, 0] * sides[:, 0] + u[:, 2] * sides[:, 1]
            across = u[:, 0] * sides[:, 1] - u[:, 2] * sides[:, 0]
            self.assertLess(abs(across).max(), 1e-6)
            outside = radius > 1.9
            self.assertClose(along[outside], along[outside][0], relative=0.05)
            self.assertLess(along[outside].max(), -0.1)
            self.assertGreater(u[fields.points[:, 1] > 0.9, 1].min(), 0.01)

    def test_far_from_the_axis(self):
        """A thin ring is a body in plane strain, all around: under the given normal
        stress of Coulomb's law, with a material that is excavated, and on meshes
        that follow a front of slip, with hanging nodes."""
        radius = 1e6
        for scene in "coulomb_block_2d", "excavated_column", "slab_adaptive":
            with self.subTest(scene):
                plane, ring = (
                    run(
                        scene,
                        {"Output/Fields every": 0, "Output/Points": "", **changes},
                    )
                    for changes in (
                        {},
                        {
                            "Geometry/Plane model": "axisymmetric",
                            "Geometry/Translation": f"{radius}, 0",
                        },
                    )
                )
                for column in (
                    *("strain_energy", "stored_energy", "external_work"),
                    *(c for c in ("friction_dissipation",) if c in plane.statistics),
                ):
                    size = abs(plane[column]).max()
                    self.assertClose(
                        ring[column] / (2 * np.pi * radius),
                        plane[column],
                        absolute=1e-5 * size,
                        what=column,
                    )

    def test_effort(self):
        """The round pillar takes the iterations of the long one."""
        for solver in "multigrid", "algebraic multigrid":
            long, round = (
                run(
                    "salt_pillar_2d",
                    {
                        "Geometry/Plane model": model,
                        "Geometry/Arguments": "16, 8 : 0, 0 : 6, 3 : true",
                        "Geometry/Global refinements": 2,
                        "Solver/Linear solver": solver,
                        "Time/Phases": "2.592e6: 12",
                        "Output/Fields every": 0,
                    },
                )["linear_iterations"].sum()
                for model in ("strain", "axisymmetric")
            )
            self.assertLess(round, 1.15 * long, solver)


class CreepTest(TestCase):
    """The sample of prm/verification/round_sample.prm."""

    def strain(self, result, t):
        step = np.argmin(abs(result["t"] - t))
        return (result["point1_y"][step] - result["point0_y"][step]) / 100

    def test_friction_lies_between_none_and_glue(self):
        found = {
            law: run("round_sample", {"Boundary 2/Friction law": law, **more})
            for law, more in (
                ("none", {}),
                ("coulomb", {}),
                ("glued", {"Boundary 2/Contact law": "bilateral"}),
            )
        }
        # sigma/E, and sigma^5 over the hour of loading and ten days
        uniform = 15 / 25e3 + 1e-4 / 24 * (1 / 6 + 240)
        self.assertClose(self.strain(found["none"], 241), uniform, relative=3e-4)
        held = self.strain(found["coulomb"], 241) / uniform
        self.assertLess(held, 0.95)
        self.assertGreater(held, self.strain(found["glued"], 241) / uniform + 0.02)
        self.assertIn("nothing presses the body", found["coulomb"].stdout)
        self.assertNotIn("nothing presses", found["glued"].stdout)
        # Once nothing presses it, it stays where it is (it went up by 6e-4 a step).
        rest = found["coulomb"]["t"] >= 242
        for column in "max_gap", "point0_y", "point2_x":
            at_rest = found["coulomb"][column][rest]
            self.assertClose(at_rest, at_rest[0], absolute=1e-5, what=column)
        self.assertLess(found["coulomb"]["max_gap"][-1], 1e-3)


if __name__ == "__main__":
    main()
