# SPDX-License-Identifier: LGPL-2.1-or-later
"""Contact that opens and closes where that is hard, and what it must be then.

Lagged       friction with the pressure of the step before is of first order
Closed       contact that is never open is bilateral
HardCases    grazing, closing all at once, opening again and again, large
             coefficients of friction, jumps, reversals, a single node

Where nothing is known about the numbers the conditions of contact are: in each
node and step pressure and gap are not negative, and one of them is zero; the
friction is at most mu times the pressure, and against the slip; the pressures
add up to the force; forces balance; in elastic bodies without friction work is
energy. Fields of outputs have single precision, hence 1e-6 where they are
compared.
"""

import tempfile

import numpy as np

from harness import DEFECTS, EFFORT, TestCase, main, run
from runs import elastic_moduli, entries, of_law, on_boundary

# rubbing_2d.prm in space: a block of 4 x 4 x 3 cells that turns as it slides
IN_SPACE = {
    "Dimension": 3,
    "Geometry/Arguments": "4, 4, 3 : 0, 0, 0 : 1, 1, 0.5 : true",
    **entries(range(4), {"Role": "free"}),
    **entries(
        [4],
        {
            "Role": "contact",
            "Contact law": "unilateral",
            "Gap": "0.01*((x - 0.4)^2 + (y - 0.6)^2)",
            "Friction law": "coulomb",
            "Friction coefficient": 0.4,
        },
    ),
    "Boundary 5/Role": "displacement",
    "Boundary 5/Displacement": "0.02*min(t, 2 - t); 0.01*sin(pi*t); -0.01*min(2*t, 1)",
    "Time/Phases": "1: 8, 1.5: 4",
    "Solver/Contact tolerance": 1e-10,
}
PLANE, SPACE = (2, "rubbing_2d", 2, 3), (3, "rubbing_3d", 4, 5)
FRICTIONLESS = {"Friction law": "none"}
LAGGED = {"Solver/Coulomb pressure": "lagged"}


def rub(place, contact, plate=None, more=None, ranks=1, check=True):
    """The block with other entries of the foundation and another path of the plate:
    2 or 3 components."""
    dim, name, below, above = place
    changes = {} if dim == 2 else dict(IN_SPACE)
    changes.update(entries([below], contact))
    if plate:
        changes[f"Boundary {above}/Displacement"] = plate
    changes.update(more or {})
    return run(name, changes, ranks, "" if dim == 3 else None, check)


class Contact(TestCase):
    def check_contact(self, result, friction=None, lagged=False, normal="y"):
        """The conditions of contact in all outputs. friction: the largest mu;
        lagged: whether it is that of the pressure of the step before."""
        force = abs(result[f"contact_force_{normal}"])
        largest = result["max_pressure"].max()
        size = result["max_displacement"].max()
        before = None
        for i in range(len(result["t"])):
            fields = result.fields("contact", i)
            nodes = fields.nodes()
            p = fields.point_data["contact_pressure"][nodes]
            gap = fields.point_data["gap"][nodes]
            what = f"t = {result['t'][i]:g}"
            self.assertGreaterEqual(p.min(), 0, what)
            self.assertGreaterEqual(gap.min(), -1e-7 * size, what)
            both = (p > 1e-6 * largest) & (gap > 1e-7 * size)
            self.assertEqual(np.count_nonzero(both), 0, what)
            if i > 0:
                self.assertClose(p.max(), result["max_pressure"][i], 1e-6, 1e-30, what)
                self.assertClose(gap.max(), result["max_gap"][i], 1e-6, 1e-7 * size)
            self.assertGreaterEqual(force[i], 0, what)
            self.assertEqual(force[i] > 0, result["contact_area"][i] > 0, what)
            if friction is not None and i > 0:
                q = np.linalg.norm(fields.point_data["traction"][nodes], axis=1)
                excess = q - friction * (before if lagged else p)
                self.assertLessEqual(excess.max(), 1e-5 * friction * largest, what)
            before = p
        # a rigid motion has forces of rounding alone
        defects = result["force_balance_defect"][force > 0]
        self.assertLessEqual(defects.max(initial=0), 1e-7)

    def check_work(self, result):
        work = abs(result["external_work"]).max()
        self.assertLess(abs(result["energy_balance_defect"]).max(), 1e-9 * work)


class Lagged(Contact):
    def test_first_order_in_the_step(self):
        """Against 32 steps with the pressure of the step, 0.0148 and 1e-5 from that
        of 64. Measured: errors of 4.5e-3, 2.2e-3 and 1.0e-3, orders 1.05, 1.10."""

        def force(steps, **more):
            return rub(PLANE, {}, more={"Time/Phases": f"0.5: {steps}", **more})[
                "friction_force_x"
            ][-1]

        exact = force(32, **{"Solver/Coulomb tolerance": 1e-9})
        errors = [abs(force(steps, **LAGGED) - exact) for steps in (4, 8, 16)]
        self.assertGreater(errors[-1], 0.02 * exact)
        for coarse, fine in zip(errors, errors[1:]):
            order = np.log2(coarse / fine)
            self.assertGreater(order, 0.8)
            self.assertLess(order, 1.3)


class Closed(Contact):
    """Bilateral contact is what remains where the contact never opens."""

    def check(self, place, plate, foundation):
        dim, _, below, _ = place
        normal = "xyz"[dim - 1]
        body = {**of_law("maxwell", Viscosity=0.5), "Time/Phases": "1: 8, 1.5: 8"}
        tresca = {"Friction law": "tresca", "Friction bound": 0.05, **foundation}
        open_ = rub(place, {**tresca, "Gap": 0}, plate, body)
        bilateral = {"Contact law": "bilateral", **tresca, "Gap": ""}
        closed = rub(place, bilateral, plate, body)
        area = 2 if dim == 2 else 1
        self.assertClose(open_["contact_area"][1:], area, relative=1e-12)
        self.assertLess(open_["max_gap"].max(), 1e-15)
        self.assertEqual(closed["tension_area"].max(), 0)
        n_columns = 0
        for name, column in closed.statistics.items():
            if name in EFFORT | DEFECTS or name.startswith("wall"):
                continue
            # what contact that opens has under another name, or not at all
            if name.startswith(("estimate", f"reaction_{below}", "tension_area")):
                continue
            size = abs(column).max()
            n_columns += 1
            self.assertClose(open_[name], column, 0, 1e-8 * size + 1e-15, name)
        self.assertGreater(n_columns, 15)
        # The force on the foundation is what holds the body there.
        self.assertClose(
            -open_[f"contact_force_{normal}"],
            closed[f"reaction_{below}_{normal}"],
            relative=1e-8,
        )
        for name in "displacement", "stress_xy", "von_mises":
            fields = [result.fields() for result in (open_, closed)]
            u, v = ({**f.point_data, **f.cell_data}[name].reshape(-1) for f in fields)
            self.assertLess(abs(u - v).max(), 1e-6 * abs(v).max(), name)
        self.check_identities(open_)
        self.assertGreater(open_["slip_area"].max(), 0.1)
        return open_

    def test_plane(self):
        plate = "0.1*sin(pi*t); -0.3*min(8*t, 1)"
        self.check(PLANE, plate, {})

    def test_plane_on_a_moving_foundation(self):
        foundation = {
            "Friction bound": 0.02,
            "Foundation displacement": "0.02*t*x",
            "Foundation motion": "t; 0",
        }
        self.check(PLANE, "0.1*sin(pi*t); -0.3*min(8*t, 1)", foundation)

    def test_space(self):
        plate = "0.05*sin(pi*t); 0.05*(1 - cos(pi*t)); -0.3*min(8*t, 1)"
        self.check(SPACE, plate, {})


class Greco(Contact):
    """The plate of the GRECO benchmark, mu = 1: pressed from the left and from
    above, symmetric on the right."""

    PLATE = {
        "Dimension": 2,
        "Geometry/Generator": "subdivided_hyper_rectangle",
        "Geometry/Arguments": "64, 64 : 0, 0 : 0.04, 0.04 : true",
        **elastic_moduli(1.3e11, 0.2),
        **on_boundary(0, Role="traction", Pressure="15e7*min(t, 1)"),
        "Boundary 1/Role": "symmetry",
        **on_boundary(2, Role="contact", Contact_law="unilateral"),
        **on_boundary(2, Friction_law="coulomb", Friction_coefficient=1),
        **on_boundary(3, Role="traction", Pressure="5e7*min(t, 1)"),
        "Output/Points": "0, 0; 0.00125, 0; 0.005, 0; 0.0075, 0; 0.01125, 0",
        "Solver/Coulomb pressure": "Newton",
    }

    def test_displacements(self):
        """The limit is extrapolated from 128 and 256 cells a side."""
        for cells, steps, ranks, error in (
            (256, 1, 1, 1e-4), (64, 5, 1, 4e-4), (64, 1, 2, 4e-4)
        ):
            with self.subTest(cells=cells, steps=steps, ranks=ranks):
                size = "0, 0 : 0.04, 0.04 : true"
                more = {
                    "Time/Phases": f"1: {steps}",
                    "Geometry/Arguments": f"{cells}, {cells} : {size}",
                }
                result = run("greco", {**self.PLATE, **more}, ranks, text="")
                moved = [result[f"point{i}_x"][-1] for i in range(5)]
                # the limit, and what the literature says
                for i, (limit, other) in enumerate(
                    zip(
                        (2.8604e-5, 2.7227e-5, 2.2869e-5, 1.9808e-5, 1.5414e-5),
                        (2.86e-5, 2.72e-5, 2.28e-5, 1.98e-5, 1.54e-5),
                    )
                ):
                    self.assertLess(abs(moved[i] / limit - 1), error)
                    self.assertLess(abs(moved[i] / other - 1), 5e-3)
                # 41 with a fixed point; then the load grows in proportion
                self.assertLess(result["contact_iterations"][1], 14)
                self.assertEqual(result["contact_iterations"][2:].sum(), 0)

    def test_price(self):
        """By multigrid, against bounds that are given, those that have come out: at
        most 1.5 times the corrections, and 1.5 times the linear iterations that given
        bounds took (55) before each of their sets cost a cycle less. Measured: 12 for
        12, 78 for 46."""
        multigrid = {
            **self.PLATE,
            "Geometry/Arguments": "8, 8 : 0, 0 : 0.04, 0.04 : true",
            "Geometry/Global refinements": 4,
            "Solver/Linear solver": "multigrid",
            "Time/Phases": "1: 1",
        }
        law = run("greco", multigrid, text="")
        fields = law.fields("contact")
        nodes = fields.nodes()
        x, bound = fields.points[nodes, 0], fields.point_data["bound"][nodes]
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as table:
            table.write("x, bound\n")
            for i in np.argsort(x):
                table.write(f"{x[i]:.9g}, {bound[i]:.9g}\n")
            table.flush()
            given = {
                "Table 1/File": table.name,
                "Table 1/Outside": "constant",
                **on_boundary(2, Friction_law="tresca", Friction_bound="bound(x)*t"),
            }
            tresca = run("greco", {**multigrid, **given}, text="")
        self.assertClose(tresca["point0_x"][-1], law["point0_x"][-1], relative=1e-3)
        corrections = "contact_iterations"
        self.assertLess(law[corrections].sum(), 1.5 * tresca[corrections].sum())
        self.assertLess(law["linear_iterations"].sum(), 1.5 * 55)
        self.assertLess(tresca["linear_iterations"].sum(), 50)


class HardCases(Contact):
    def check_both(self, check, contact, plate, more=None, ranks=(1, 1)):
        """check(place, normal, result) of the plane and of space; plate: the path
        along the normal and those along the face, the last in space alone."""
        down, *along = plate
        for place, n in zip((PLANE, SPACE), ranks):
            dim = place[0]
            path = "; ".join([*along[: dim - 1], down])
            with self.subTest(dim=dim, contact=contact):
                check(place, "xyz"[dim - 1], rub(place, contact, path, more, n))

    def test_grazing(self):
        """The plate holds the body just there, then goes down by next to
        nothing: twice as far is twice the force, also with friction of the
        pressure of the step, since the first loading is proportional."""

        def check(place, normal, result):
            force = -result[f"contact_force_{normal}"]
            self.assertEqual(abs(force[:3]).max(), 0)
            self.assertGreater(force[3], 1e-10)
            self.assertClose(force[4], 2 * force[3], relative=1e-6)
            if result["friction_dissipation"][-1] == 0:
                self.check_work(result)
            self.assertLessEqual(result["contact_iterations"].max(), 10)
            self.assertLess(result["force_balance_defect"][3:].max(), 1e-7)

        plate = "-1e-9*max(0, t - 1)", "0", "0"
        more = {"Time/Phases": "1: 2, 3: 2", "Solver/Coulomb tolerance": 1e-9}
        for friction in FRICTIONLESS, {}:
            self.check_both(check, {"Gap": 0, **friction}, plate, more)

    def test_closing_all_at_once(self):
        """A flat plate: all nodes come to touch in one step, and from then on
        contact is bilateral."""
        plate = "-0.01*t", "0", "0"
        more = {"Time/Phases": "1: 5"}
        bilateral = {
            "Contact law": "bilateral",
            "Gap": "",
            "Foundation displacement": "0.004*min(5*t, 1)",
            **FRICTIONLESS,
        }

        def check(place, normal, result):
            self.check_contact(result, normal=normal)
            self.check_work(result)
            area = result["contact_area"] / (2 if place is PLANE else 1)
            # t = 0.4 is a tie
            self.assertClose(area[[1, 3, 4, 5]], [0, 1, 1, 1], absolute=1e-12)
            self.assertLess(abs(result[f"contact_force_{normal}"][:3]).max(), 1e-15)
            self.assertLessEqual(result["contact_iterations"].max(), 10)
            path = "; ".join([*["0"] * (place[0] - 1), plate[0]])
            closed = rub(place, bilateral, path, more)
            for name in "stored_energy", "max_von_mises":
                self.assertClose(
                    result[name][3:], closed[name][3:], relative=1e-8, what=name
                )

        self.check_both(check, {"Gap": 0.004, **FRICTIONLESS}, plate, more)

    def test_opening_again_and_again(self):
        """Five cycles of an elastic body: without friction each is as the first,
        with friction as the second."""
        plate = "-0.015*sin(2*pi*t)", "0.02*sin(4*pi*t)", "0.01*sin(2*pi*t)"

        def check(place, normal, result):
            force = result[f"contact_force_{normal}"]
            size = abs(force).max()
            cycles = force[1:].reshape(5, 8)
            self.check_contact(result, self.mu, False, normal)
            self.assertLess(abs(cycles[1:] - cycles[1]).max(), 1e-8 * size)
            self.assertEqual(np.count_nonzero(force[5:8]), 0)
            self.assertEqual(np.count_nonzero(force[1:4]), 3)
            dissipation = result["friction_dissipation"]
            loops = np.diff(dissipation[::8])
            self.assertGreaterEqual(np.diff(dissipation).min(), 0)
            if self.mu == 0:
                self.check_work(result)
                self.assertLess(abs(cycles[0] - cycles[1]).max(), 1e-8 * size)
                self.assertEqual(dissipation[-1], 0)
            else:
                self.assertGreater(loops.min(), 0)
                self.assertClose(loops[1:], loops[1], relative=1e-7)

        for self.mu in 0, 0.4, 1:
            contact = {"Friction coefficient": self.mu}
            self.check_both(check, contact, plate, {"Time/Phases": "5: 40"})

    def test_coefficients_of_friction(self):
        """With the pressure of the step before any; with that of the step the
        fixed point contracts more slowly the larger they are (by 0.17 to 0.28 in
        the plane, 0.72 in space)."""
        for mu in 0, 0.5, 2:
            contact = {"Friction coefficient": mu}
            for place in PLANE, SPACE:
                normal = "xyz"[place[0] - 1]
                with self.subTest(mu=mu, dim=place[0]):
                    result = rub(place, contact, more=LAGGED)
                    self.check_contact(result, mu, True, normal)
                    self.check_identities(result)
                    coupled = rub(place, contact)
                    self.check_contact(coupled, mu, False, normal)
                    self.check_identities(coupled)
                    self.assertLess(coupled["contraction"].max(), 0.9)
                    if mu == 0:
                        energy = rub(place, FRICTIONLESS)["stored_energy"]
                        for one in result, coupled:
                            self.assertClose(one["stored_energy"], energy, 1e-9)
                    else:
                        self.assertGreater(coupled["contraction"].max(), 0.05)

    def test_no_fixed_point(self):
        """mu = 4 in space: found, or said in a sentence, and the pressure of the
        step before goes on."""
        contact = {"Friction coefficient": 4}
        result = rub(SPACE, contact, check=False)
        if result.returncode:
            self.assertRegex(result.stderr, "The fixed point of Coulomb's law is not")
            self.assertRegex(result.stderr, "'Solver/Coulomb pressure' = lagged")
        else:
            self.check_contact(result, 4, False, "z")
        self.check_contact(rub(SPACE, contact, more=LAGGED), 4, True, "z")

    def test_friction_along_an_obstacle(self):
        """At the corner of two pieces the friction of one acts along the normal
        of the other: a wall with a given pressure or bilateral, beside a
        foundation that opens."""
        walls = (
            {"Friction law": "coulomb", "Normal stress": "-0.01*t"},
            {"Friction law": "tresca", "Friction bound": 0.001},
        )
        for wall in walls:
            for friction in FRICTIONLESS, {}:
                with self.subTest(wall=wall["Friction law"], **friction):
                    more = entries([0], {"Role": "contact", **wall})
                    if wall["Friction law"] == "coulomb":
                        more["Boundary 0/Friction coefficient"] = 0.3
                    # not check_contact: the corner has the friction of both
                    result = rub(PLANE, friction, more=more)
                    self.check_identities(result)
                    self.assertGreater(-result["contact_force_y"][-1], 0.01)

    def test_ranks_without_contact(self):
        """Four ranks, of which one has no node of the foundation."""
        one, four = (rub(PLANE, {}, ranks=n) for n in (1, 4))
        for name in "contact_force_y", "friction_force_x", "stored_energy":
            size = abs(one[name]).max()
            # the tolerance of the fixed point is 1e-6
            self.assertLess(abs(one[name] - four[name]).max(), 1e-5 * size, name)

    def test_jumps_on_ranks(self):
        """Pressure and coefficient that jump: the body is pressed and let go from
        one step to the next. In the plane on two ranks."""
        plate = (
            "if(t < 0.45, -0.01*min(8*t, 1), if(t < 0.95, -0.05, 0.001))",
            "0.02*t",
            "0.01*t",
        )

        def check(place, normal, result):
            self.check_contact(result, 0.8, False, normal)
            force = -result[f"contact_force_{normal}"]
            self.assertGreater(force[result.row(0.5)], 3 * force[result.row(0.375)])
            # The friction of the step that opens is still that of the pressure
            # before, and holds a sheared body down.
            self.assertEqual(abs(force[result.row(1.125) :]).max(), 0)
            self.assertLessEqual(result["contact_iterations"].max(), 20)

        contact = {"Friction coefficient": "if(x < 0.5, 0.2, 0.8)"}
        more = {"Time/Phases": "1.5: 12"}
        self.check_both(check, contact, plate, more, ranks=(2, 1))

    def test_price_of_reversal_and_turn(self):
        """Load, slip to one side and back, in space in a circle: with the pressure
        of the step at most 1.5 times what bounds of the same size take that are
        given, those of the pressure before. Measured: 0.80, 0.98 and 1.14 of the
        corrections, 0.90, 1.00 and 1.38 of the linear iterations."""
        push = "0.05*if(t < 0.5, 0, if(t < 1, t - 0.5, 1.5 - t))"
        turn = "0.02*(1 - cos(2*pi*max(0, t - 0.5))); 0.02*sin(2*pi*max(0, t - 0.5))"
        flow = {
            **of_law("perzyna", Yield_radius=0.003),
            "Time/Scheme": "backward Euler",
        }
        for place, along, down, refinements, mu, body in (
            (PLANE, push, -0.02, 2, 0.4, {}),
            (PLANE, push, -0.02, 1, 0.4, flow),
            (SPACE, turn, -0.01, 1, 0.6, {}),
        ):
            with self.subTest(dim=place[0], **body):
                newton, lagged = (
                    rub(
                        place,
                        {"Friction coefficient": mu},
                        f"{along}; {down}*min(2*t, 1)",
                        {
                            "Geometry/Global refinements": refinements,
                            "Solver/Linear solver": "multigrid",
                            "Solver/Contact tolerance": 1e-8,
                            "Time/Phases": "0.5: 4, 1.5: 12",
                            **body,
                            **pressure,
                        },
                    )
                    for pressure in ({}, LAGGED)
                )
                self.assertGreater(newton["slip_area"].max(), 0.5)
                for name in "contact_iterations", "linear_iterations":
                    self.assertLess(newton[name].sum(), 1.5 * lagged[name].sum(), name)

    def test_opening_as_it_turns_back(self):
        """The plate rises while it reverses, until nothing is left."""

        def check(place, normal, result):
            self.check_contact(result, 0.4, self.lagged, normal)
            force = -result[f"contact_force_{normal}"]
            self.assertGreater(force[result.row(1)], 0)
            self.assertEqual(force[-1], 0)
            self.assertEqual(result["friction_force_x"][-1], 0)
            energy = result["stored_energy"]
            self.assertLess(abs(energy[-1]), 1e-12 * energy.max())

        plate = "-0.02*min(4*t, 1) + 0.06*max(0, t - 0.75)", "0.05*min(t, 2 - t)", "0"
        more = {"Time/Phases": "1: 16, 1.5: 16"}
        for self.lagged in True, False:
            pressure = LAGGED if self.lagged else {}
            self.check_both(check, {}, plate, {**more, **pressure})

    def test_single_node(self):
        """The curved body of hertz_disc_2d.prm, pressed by less than the
        gap at the next node: a spring."""
        result = run(
            "hertz_disc_2d",
            {
                "Geometry/Global refinements": 4,
                "Boundary 1/Displacement": "free; 3e-5*t",
                "Time/Phases": "3: 3",
            },
        )
        self.check_contact(result)
        self.check_work(result)
        p = result.fields("contact").point_data["contact_pressure"]
        self.assertEqual(len(np.unique(p[p > 0])), 1)
        force = abs(result["contact_force_y"])
        self.assertGreater(force[1], 0)
        self.assertClose(force[3] - force[2], force[2] - force[1], relative=1e-6)


if __name__ == "__main__":
    main()
