# SPDX-License-Identifier: LGPL-2.1-or-later
"""Units on the axes of pictures, and the supports and loads in them."""

import json
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import matplotlib
import numpy as np

from harness import SOURCE, TestCase, main, run
from plot_process import plot

sys.path.insert(0, str(SOURCE / "contrib"))
matplotlib.use("Agg")

import matplotlib.pyplot as plt
from plotting import history, hysteresis, overview, quantities, style
from plotting.body_base import Scale, factor_of_contact, folded
from plotting.geometry import corner_volumes
from plotting.results import NoPicture, Results, UserError, read_statistics
from plotting.supports import Supports, draw_body_force
from plotting.units import DAY, Unit, Units, show
from viscoplastic_contact.tables import without_unit

SI = {"length": "m", "time": "s", "stress": "Pa"}


class Square(dict):
    """A record of one cell."""

    cells = np.arange(4)[None]
    size = 1.0
    data = property(lambda self: self)

    def __init__(self, points, fields):
        super().__init__(fields)
        self.points = points


class Handy(TestCase):
    """The multiple of a unit that numbers of some size are shown in."""

    def test_multiples(self):
        year = 365.25 * DAY
        for declared, dim, kind, largest, text, size in (
            (SI, 3, "stress", 9.8e6, "MPa", 1e6),
            (SI, 3, "stress", 400.0, "Pa", 1),
            (SI, 3, "length", 0.12, "mm", 1e-3),
            (SI, 3, "length", 6.0, "m", 1),
            (SI, 3, "time", 180.0, "s", 1),
            (SI, 3, "time", 0.011, "ms", 1e-3),
            (SI, 3, "time", 3.4e7, "days", DAY),
            (SI, 3, "time", 5 * year, "years", year),
            (SI, 2, "force", 9.1e7, "MN/m", 1e6),
            (SI, 3, "force", 3.4e3, "N", 1),
            (SI, 3, "force", 3.4e4, "kN", 1e3),
            (SI, 2, "energy", 5.4, "J/m", 1),
            (SI, 3, "area", 6e-4, "mm²", 1e-6),
            (SI, 3, "area", 3e7, "km²", 1e6),
            (SI, 3, "force", 9.3e13, "TN", 1e12),
            (SI, 2, "force density", 2.5e4, "kN/m³", 1e3),
            (SI, 3, "velocity", 2e-5, "µm/s", 1e-6),
            (SI, 2, "energy norm", 0.5, "(J/m)$^{1/2}$", 1),
            (SI, 2, "rate norm", 0.5, "(J/m/s)$^{1/2}$", 1),
            (SI, 2, "root of section force", 0.5, "(N)$^{1/2}$", 1),
            # what follows from other units: MPa mm^2 = N, MPa mm = kN/m
            ({"length": "mm", "time": "s", "stress": "MPa"}, 3, "force", 20.0, "N", 1),
            # as the program prints them
            ({"length": "mm", "time": "s", "stress": "MPa"}, 2, "force", 20.0, "N/mm", 1),
            ({"length": "mm", "time": "h", "stress": "MPa"}, 2, "energy", 20.0, "mJ/mm", 1),
            ({"length": "mm", "time": "h", "stress": "MPa"}, 2, "energy", 2e4, "J/mm", 1e3),
            ({"length": "mm", "time": "h", "stress": "MPa"}, 3, "velocity", 2.0, "mm/h", 1),
            ({"length": "m", "time": "day", "stress": "MPa"}, 2, "velocity", 3e-6, "µm/day", 1e-6),
            ({"length": "mm", "time": "day", "stress": "MPa"}, 3, "time", 40.0, "day", 1),
            # no unit of the system: as the scene has it, in powers of ten
            ({"length": "in", "stress": "psi"}, 3, "force", 12.0, "psi in$^{2}$", 1),
            ({"length": "in", "stress": "psi"}, 3, "stress", 2e5, "$10^{3}$ psi", 1e3),
            ({}, 3, "stress", 9.8e6, "$10^{6}$", 1e6),
            ({}, 3, "stress", 0.4, "", 1),
            # not all that it needs is declared
            ({"length": "m"}, 3, "force", 3.0, "", 1),
            (SI, 3, None, 2e-5, "$10^{-6}$", 1e-6),
        ):
            duration = largest if kind == "time" else 10.0
            unit = Units(declared, dim, duration).unit(kind, [0.0, -largest])
            self.assertEqual(unit.text, text, (kind, largest))
            self.assertClose(unit.size, size, relative=1e-12, what=(kind, largest))

    def test_days_in_words(self):
        words = [Unit(1.0, "day").value(number) for number in (1.0, 242.9)]
        self.assertEqual(words, ["1 day", "242.9 days"])
        self.assertEqual(Unit(1e-18, "$10^{-18}$ mJ").value(0.0), "0 mJ")
        self.assertEqual(Unit(1.0, "day").label("time"), "time [day]")

    def test_slow_things_go_by_the_year(self):
        units = Units(SI, 2, 400 * DAY)
        unit = units.unit("velocity", [1.2e-3 / (365.25 * DAY)])
        self.assertEqual(unit.value(1.2e-3 / (365.25 * DAY)), "1.2 mm/year")

    def test_numbers_on_axes(self):
        """Round in the unit, with no power of ten beside them."""
        style.set_up()
        figure, (axes, other) = plt.subplots(2)
        self.addCleanup(plt.close, figure)
        axes.plot([0, 400 * DAY], [-9e7, 0])
        units = Units(SI, 2, 400 * DAY)
        show(axes.xaxis, "time", units.unit("time", [400 * DAY]))
        show(axes.yaxis, "force", units.unit("force", [9e7]))
        other.plot([0, 1], [0, 5e6])
        show(other.yaxis, "cells", Units().unit(None, []))
        figure.canvas.draw()
        self.assertEqual(other.yaxis.offsetText.get_text(), "")
        self.assertEqual(other.yaxis.get_ticklabels()[-2].get_text()[-3:], "000")
        self.assertEqual(axes.get_xlabel(), "time [days]")
        self.assertEqual(axes.get_ylabel(), "force [MN/m]")
        for axis, expected in (
            (axes.xaxis, ["0", "100", "200", "300", "400"]),
            (axes.yaxis, ["−80", "−60", "−40", "−20", "0"]),
        ):
            self.assertEqual(axis.offsetText.get_text(), "")
            texts = [label.get_text() for label in axis.get_ticklabels()]
            self.assertLessEqual(set(expected), set(texts))

    def test_ticks_over_the_whole_range(self):
        for low, high, factor in ((3e-3, 0.4, 100.0), (1e-14, 1e-2, 1.0), (2e4, 3e9, 1 / DAY)):
            figure, axes = plt.subplots()
            self.addCleanup(plt.close, figure)
            axes.set_yscale("log")
            axes.set_ylim(low, high)
            style.numbers_on_logarithmic_axis(axes.yaxis, factor)
            ticks = axes.yaxis.get_major_locator()()
            self.assertLess(ticks[0] / low, 10.1)
            self.assertGreater(ticks[-1] / high, 1 / 10.1)

    def test_every_column_and_field_has_words(self):
        self.assertEqual(
            quantities.column("reaction_3_y"),
            ("reaction of boundary 3 on the body, $y$", "force"),
        )
        named = {"boundary 3": "roof", "point 1": "crown"}
        with mock.patch.object(quantities, "names_of_places", named):
            self.assertIn("reaction of roof", quantities.column("reaction_3_y")[0])
            self.assertIn("displacement of crown", quantities.column("point1_x")[0])
            self.assertIn("displacement of point 0", quantities.column("point0_x")[0])
            self.assertTrue(quantities.column("point1_stress_xx")[0].endswith("at crown"))
            self.assertEqual(history.label("reaction_3_x"), "roof, $x$")
        with mock.patch.object(quantities, "of_interest", "point1_x"):
            self.assertEqual(quantities.column("quantity_total")[1], "length")
            self.assertEqual(quantities.column("estimator")[1], "root of length")
        self.assertEqual(quantities.column("t")[1], "time")
        self.assertEqual(quantities.field("stress_yy")[1], "stress")
        self.assertIn("tension positive", quantities.field("stress_yy")[0])
        self.assertNotIn("tension", quantities.field("stress_xy")[0])
        for name in (*quantities.SCALARS, "stress_xx", "velocity", "displacement_x"):
            title = quantities.in_titles(quantities.field(name)[0])
            self.assertEqual(title.count("$") % 2, 0, title)

    def test_suffixes(self):
        for name, bare in (
            ("t [day]", "t"),
            ("von_mises [MPa]", "von_mises"),
            ("estimate_total [(J/m)^(1/2)]", "estimate_total"),
            ("plain", "plain"),
        ):
            self.assertEqual(without_unit(name), bare)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "statistics.csv"
            path.write_text("step,t [day],load_x [N/m]\n0,0,1\n1,2,3\n")
            self.assertEqual(list(read_statistics(path)), ["step", "t", "load_x"])


class Folding(TestCase):
    def test_bodies_are_not_drawn_over_each_other(self):
        """A gap of 5 that closes to 2 at one node of two: 5/3 times at most."""
        points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
        before, now = Square(points, {}), Square(points[::-1], {})
        before["gap"], now["gap"] = np.array([5.0, 0.0]), np.array([0.0, 2.0])
        self.assertClose(factor_of_contact((before, now)), 5 / 3, relative=1e-12)
        now["gap"] = np.array([0.0, 0.0])
        self.assertClose(factor_of_contact((before, now)), 1, relative=1e-12)
        now["gap"] = np.array([0.0, 5.0])
        self.assertGreater(factor_of_contact((before, now)), 1e300 / 1e10)

    def test_volumes_of_corners(self):
        """Of a brick all are its volume, with the sign of its orientation."""
        square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
        brick = np.array([(*p, z) for z in (0, 1) for p in square]) * (2, 3, 5)
        volumes = np.abs(corner_volumes(brick, np.arange(8)[None]))
        self.assertClose(volumes, 30, absolute=1e-12)
        flat = np.pad(square * (2, 3), ((0, 0), (0, 1)))
        self.assertClose(corner_volumes(flat, np.arange(4)[None]), 6, absolute=1e-12)

    def body(self, shift):
        """A square whose upper right corner moves to the left."""
        points = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
        moved = np.zeros_like(points)
        moved[2, 0] = -shift
        data = {"displacement": moved, "von_mises": np.ones(4)}
        return Square(points, {"displacement": moved, "von_mises": np.ones(4)})

    def test_folded_cells(self):
        body = self.body(0.001)
        self.assertFalse(folded(body, 900).any())
        self.assertTrue(folded(body, 1100).all())

    def test_magnification_stops_before(self):
        """A corner that goes half as far as others would allow."""
        body = self.body(0.002)
        results = SimpleNamespace(
            name="square",
            solution=[(0.0, Path())],
            statistics={},
            units={},
            body=lambda index: body,
            boundary=lambda: None,
            dimension=lambda: 2,
            is_of_revolution=lambda: False,
            opposite=False,
        )
        options = SimpleNamespace(magnification=None, mirror=None, window=None, label=[])
        self.assertEqual(Scale(results, [0], "von_mises", options).magnification, 20)
        body.points *= 0.02  # of a body of the same size
        chosen = Scale(results, [0], "von_mises", options).magnification
        self.assertEqual(chosen, 5)  # 10 would be on the edge


class Supported(TestCase):
    """Supports and loads at their places, by what the program writes."""

    def assertIds(self, results, expected):
        """expected: {id: function of the centers that vanishes on it}"""
        found = Supports(results, Units.of(results))
        self.assertEqual(set(found.numbers), set(expected))
        for number, zero in expected.items():
            centers = found.centers[found.numbers == number]
            self.assertClose(zero(*centers.T), 0, absolute=1e-6)
        return found

    def test_slab(self):
        """Ids are those of the sides, on two ranks, also of cells refined later."""
        result = run("slab_adaptive", {"Time/Phases": "1: 8"}, ranks=2)
        results = Results(result.directory)
        sides = {
            0: lambda x, y, z: x,
            1: lambda x, y, z: x - 2,
            2: lambda x, y, z: y,
            3: lambda x, y, z: y - 1,
        }
        found = self.assertIds(results, sides)
        lengths = [np.sum(found.extents[found.numbers == i]) for i in range(4)]
        self.assertClose(lengths, (1, 1, 2, 2), absolute=1e-6)
        near_a_corner = np.array([(0, 1e-4, 0), (1e-4, 0, 0), (2, 1 - 1e-4, 0)])
        self.assertEqual(found.of(near_a_corner).tolist(), [0, 2, 1])
        self.assertEqual([found.role(i) for i in (2, 3)], ["contact", "clamped"])
        load = found.traction(0, np.array([(0, 0.5)]), np.array([(-1, 0)]), 0.5)
        self.assertClose(load, [(0.15, 0)], absolute=1e-9)

    def test_loads_with_units_of_their_own(self):
        overrides = {
            **{"Units/Length": "m", "Units/Time": "s", "Units/Stress": "Pa"},
            "Boundary 0/Traction": "3e-4 kPa*(t/(1 s)); 0",
            "Time/Phases": "1: 2",
        }
        result = run("slab", overrides)
        results = Results(result.directory)
        entry = "Boundary 0", "Traction"
        self.assertEqual(results.parameters[entry], "3e-4 kPa*(t/(1 s)); 0")
        load = Supports(results, Units.of(results)).traction(
            0, np.array([(0, 0.5)]), np.array([(-1, 0)]), 0.5
        )
        self.assertClose(load, [(0.15, 0)], absolute=1e-9)

    def test_walls_that_a_removal_lays_bare(self):
        result = run("excavated_column")
        results = Results(result.directory)
        found = Supports(results, Units.of(results))
        # the fresh top in the middle, and beside the held axis
        fresh = np.array([(0.5, 1, 0), (0.125, 1, 0)])
        self.assertEqual(found.of(fresh).tolist(), [-1, -1])
        self.assertEqual(found.role(-1), "free")

    def test_faces_of_unequal_size(self):
        """A face of a refined mesh belongs to that which holds it, not to a small
        neighbor whose center is nearer."""
        points = np.array([(0, 0, 0), (4, 0, 0), (4, 0, 0), (4.1, 0, 0)], float)
        record = Square(points, {"boundary_id": np.array([3.0, 3.0, 5.0, 5.0])})
        record.cells = np.array([(0, 1), (2, 3)])
        results = SimpleNamespace(boundary=lambda: record, data={})
        found = Supports(results, Units())
        places = np.array([(3.9, 0, 0), (4.02, 0, 0), (0.1, 0, 0)])
        self.assertEqual(found.of(places).tolist(), [3, 5, 3])

    def test_what_expressions_say(self):
        """Loads and velocities at places and times; a table is not understood."""
        record = Square(np.zeros((2, 3)), {"boundary_id": np.zeros(2)})
        record.cells = np.array([(0, 1)])
        parameters = {
            ("Loads", "Body force"): "0; -2*t*x",
            ("Boundary 0", "Role"): "traction",
            ("Boundary 0", "Traction"): "t; 3*y",
            ("Boundary 0", "Pressure"): "10",
            ("Boundary 1", "Role"): "displacement",
            ("Boundary 1", "Displacement"): "free; 5*t",
            ("Boundary 2", "Role"): "contact",
            ("Boundary 2", "Friction law"): "tresca",
            ("Boundary 2", "Foundation motion"): "4*t; 0",
            ("Boundary 2", "Foundation displacement"): "-3*t",
            ("Boundary 3", "Role"): "traction",
            ("Boundary 3", "Traction"): "wind(t); 0",
            ("Boundary 4", "Role"): "contact",
            ("Boundary 4", "Contact law"): "unilateral",
            ("Boundary 4", "Friction law"): "coulomb",
            ("Boundary 4", "Gap"): "7 + 2*t*x",
            ("Boundary 4", "Foundation displacement"): "-3*t",
            ("Boundary 0", "Normal stiffness"): "2*x",
            ("Boundary 2", "Tangential stiffness"): "1",
            ("Boundary 3", "Tangential stiffness"): "0",
            ("Supports", "Points"): "0, 0: x y; 2, 0.5: y",
        }
        results = SimpleNamespace(boundary=lambda: record, data=parameters)
        found = Supports(results, Units(duration=2.0))
        places, normals = np.array([(0.5, 2.0)]), np.array([(0.0, 1.0)])
        self.assertClose(found.body_force(places, 2.0), [(0, -2)], absolute=1e-12)
        # of two cells, in the legend
        record.points = np.array([(1.0, 0, 0), (3.0, 0, 0)])
        record.cells = np.array([[0], [1]])
        body = SimpleNamespace(
            body=record,
            deformed=record.points,
            time=0.5,
            scale=SimpleNamespace(size=1.0),
        )
        figure, axes = plt.subplots()
        self.addCleanup(plt.close, figure)
        (key,) = draw_body_force(axes, body, found)
        self.assertEqual(key.get_label(), "body force, 1 to 3")
        load = found.traction(0, places, normals, 2.0)
        self.assertClose(load, [(2, 6 - 10)], absolute=1e-12)
        # only where the role uses them
        self.assertEqual([i for i in range(5) if found.has_springs(i)], [0])
        self.assertClose(found.points(), [(0, 0), (2, 0.5)])
        for number, expected in ((1, (0, 5)), (2, (4, -3)), (4, (0, 1 - 3))):
            velocity = found.velocity(number, places, normals, 1.0)
            self.assertClose(velocity, [expected], absolute=1e-8)
        with self.assertRaises(UserError):
            found.traction(3, places, normals, 1.0)
        self.assertEqual(found.arrow(3, places, normals, 1.0), (None, None, False))
        self.assertEqual([found.role(n) for n in (2, 4)], ["contact", "unilateral"])

    def test_pad(self):
        result = run("pad", {"Time/Phases": "1.5: 6"})
        results = Results(result.directory)
        found = Supports(results, Units.of(results))
        self.assertEqual(len(np.unique(found.numbers)), 6)
        self.assertClose(np.sum(found.extents**2), 6, absolute=1e-6)
        self.assertIn("foundation", found.caption(Units().unit("length", [1.0])))

    def test_pictures_with_units(self):
        """Symbols outside of the body, units from run.json, in all pictures."""
        result = run(
            "coulomb_block_2d", {"Output/Fields every": 1, "Time/Phases": "1: 2, 3: 4"}
        )
        record = result.directory / "run.json"
        about = json.loads(record.read_text())
        about["units"] = {"length": "m", "time": "day", "stress": "MPa"}
        record.write_text(json.dumps(about))
        results = Results(result.directory)
        options = SimpleNamespace(magnification=None, mirror=None, window=None, label=[([0.0, 0.0], "here")])
        style.set_up()
        scale = overview.scale(results, [3], options)
        figure = overview.draw(results, 3, options, scale)
        self.addCleanup(plt.close, figure)
        figure.canvas.draw()
        curve, _, body = figure.axes[:3]
        self.assertEqual(curve.get_xlabel(), "time $t$ [day]")
        keys = [text.get_text() for text in body.get_legend().get_texts()]
        self.assertIn("foundation, prescribed displacement", keys)
        self.assertIn("here", [text.get_text() for text in body.texts])
        # the plate moves to the right
        arrows = [text for text in body.texts if getattr(text, "arrow_patch", None)]
        self.assertEqual(len(arrows), 1)
        self.assertGreater(arrows[0].xy[0], arrows[0].xyann[0])
        low, high = body.get_ylim()
        self.assertLess(low, scale.low[1])
        self.assertGreater(high, scale.high[1])
        pictures = "contact", "history", "hysteresis", "stick-slip"
        process = plot(result.directory, *pictures, "--dpi", 50)
        self.assertEqual((process.returncode, process.stderr), (0, ""))
        process = plot(result.directory, "--units", "m,s")
        self.assertEqual(process.returncode, 2)

    def test_no_loop_without_dissipation(self):
        statistics = {"t": np.arange(3.0), "reaction_1_x": np.arange(3.0)}
        results = SimpleNamespace(statistics=statistics)
        options = SimpleNamespace(
            begin=None, until=None, log_time=False, force=None, displacement=None
        )
        with self.assertRaisesRegex(NoPicture, "nothing dissipates"):
            hysteresis.draw(results, options)
        # Of a section in generalized plane strain: its force over its strain.
        for name in "point0_x", "axial_strain", "axial_force", "viscous_dissipation":
            statistics[name] = np.arange(3.0)
        results.data, results.name, results.solution = {}, "bar", []
        results.units, results.is_of_revolution = SI, lambda: False
        figure = hysteresis.draw(results, options)
        self.addCleanup(plt.close, figure)
        axes = figure.axes[0]
        words = axes.get_xlabel(), axes.get_ylabel()
        self.assertEqual(words, (r"axial strain $\varepsilon_{zz}$", "axial force $N$ [N]"))
        self.assertIn("= 2 J/m: work on the body per unit depth", axes.get_title())
        # A foundation that drags it: what is negative is dissipated.
        statistics["friction_force_x"] = -np.arange(3.0)
        belt = {"Role": "contact", "Foundation motion": "t; 0"}
        results.data = {("Boundary 2", name): text for name, text in belt.items()}
        figure = hysteresis.draw(results, options)
        self.addCleanup(plt.close, figure)
        title = figure.axes[0].get_title()
        self.assertIn("= -2 J/m: work by the body per unit depth", title)

    def test_loops_are_of_a_force_and_what_it_acts_on(self):
        """A block on boundary 2, pulled at its end 0, where the first point is."""
        corners = [[0, 0], [0, 1], [2, 0], [2, 1], [0, 0], [2, 0], [0, 1], [2, 1]]
        edges = Square(
            np.column_stack([corners, np.zeros(8)]),
            {"boundary_id": np.repeat([0, 1, 2, 3], 2)},
        )
        edges.cells, edges.size = np.arange(8).reshape(4, 2), 2.0
        t = np.linspace(0.0, 1.0, 5)
        names = ["friction_force_x", "load_x", "reaction_3_x", "point0_x", "point1_x"]
        results = SimpleNamespace(
            statistics={"t": t, "friction_dissipation": t, **dict.fromkeys(names, t)},
            data={
                ("Boundary 0", "Traction"): "t; 0",
                ("Boundary 3", "Pressure"): "5",
                ("Boundary 2", "Role"): "contact",
                ("Output", "Points"): "grip = 0, 0.5; 1, 1",
            },
            boundary=lambda: edges,
            dimension=lambda: 2,
        )

        def pair(force=None, displacement=None):
            options = SimpleNamespace(force=force, displacement=displacement)
            statistics = results.statistics
            return hysteresis.pair(
                results,
                options,
                hysteresis.forces(statistics),
                hysteresis.displacements(results, statistics),
            )

        self.assertEqual(pair(), ("load_x", "point0_x"))
        self.assertEqual(pair("reaction_3_x"), ("reaction_3_x", "point1_x"))
        with self.assertRaisesRegex(NoPicture, "what it acts on is known"):
            pair("friction_force_x")
        both = "friction_force_x", "point0_x"
        self.assertEqual(pair(*both), both)
        # Two ends with a load; a point on the floor.
        results.data["Boundary 1", "Pressure"] = "5"
        results.data["Output", "Points"] = "corner = 0, 0; 1, 1"
        self.assertEqual(pair(), ("friction_force_x", "point0_x"))
        # Between bodies both sides move.
        results.data["Boundary 2", "Against"] = "table"
        self.assertEqual(pair(), ("reaction_3_x", "point1_x"))


if __name__ == "__main__":
    main()
