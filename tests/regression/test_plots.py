# SPDX-License-Identifier: LGPL-2.1-or-later
"""contrib/plot: its numbers on made-up data, its pictures on real results."""

import itertools
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace

import matplotlib.image
import meshio
import numpy as np

from harness import SOURCE, TestCase, main, run
from plot_process import plot, plot_afresh

sys.path.insert(0, str(SOURCE / "contrib"))

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from plotting import (
    contact,
    derived,
    efficiency,
    errors,
    faces,
    fields,
    geometry,
    history,
    hysteresis,
    overview,
    quantities,
    stick_slip,
    style,
)
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.quiver import Quiver, QuiverKey
from matplotlib.transforms import Bbox
from mpl_toolkits.mplot3d import proj3d
from plotting.body import tiles
from plotting.body_3d import VIEW, numbers_at
from plotting.body_base import MANY, field
from plotting.expression import evaluate
from plotting.faces import lines, planes, required, state_runs
from plotting.results import (
    NoPicture,
    Record,
    Results,
    UserError,
    by_numbers,
    read_parameters,
    read_statistics,
)
from plotting.units import Units

MANUFACTURED = SOURCE / "prm" / "verification" / "manufactured"


class Mesh:
    """What pictures use of a record."""

    rest = 0.0

    def __init__(self, points, cells, **data):
        self.points = np.array(points, dtype=float)
        self.cells = np.array(cells)
        self.data = {name: np.array(values, float) for name, values in data.items()}
        self.size = np.ptp(self.points, axis=0).max()

    def __contains__(self, name):
        return name in self.data

    def __getitem__(self, name):
        return self.data[name]


def polyline(corners):
    """Segments with points of their own, as a series has them."""
    corners = np.array([(*corner, 0) for corner in corners], float)
    points = np.stack([corners[:-1], corners[1:]], axis=1).reshape(-1, 3)
    return points, np.arange(len(points)).reshape(-1, 2)


def block(*extent, cells=(4, 2, 3), displacement=0.0):
    """Results of a body of that size, its stress from 1 to 100000."""
    dim = len(extent)
    lattice = np.array(list(itertools.product(*map(range, cells[:dim]))))
    square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
    if dim == 2:
        corners = square
    else:
        corners = np.array([(*corner, k) for k in (0, 1) for corner in square])
    points = (lattice[:, None] + corners).reshape(-1, dim) / cells[:dim] * extent
    points = np.pad(points, ((0, 0), (0, 3 - dim)))
    numbers = np.arange(len(points)).reshape(len(lattice), -1)
    stress = np.repeat(np.linspace(1, 1e5, len(lattice)), len(corners))
    moved = np.zeros_like(points)
    moved[:, 0] = displacement * points[:, 1]
    mesh = Mesh(points, numbers, von_mises=stress, displacement=moved)
    return SimpleNamespace(
        name="block",
        solution=[(0.0, Path())],
        statistics={},
        units={},
        body=lambda index: mesh,
        face=lambda index: None,
        boundary=lambda: None,
        dimension=lambda: dim,
        is_of_revolution=lambda: False,
        rest=0.0,
        opposite=False,
    )


def sliding_block():
    """Results of a cube on its base at three times: nothing slips, all slips by
    2e-5, by 3.6e-4; the mesh is refined before the last one."""
    slips, fine = (0.0, 2e-5, 3.6e-4), (False, False, True)
    bodies, faces = [], []
    for slip, is_fine in zip(slips, fine):
        mesh = block(1, 1, 1, cells=(8, 8, 2) if is_fine else (4, 4, 2)).body(0)
        mesh.data["displacement"][:, 0] = 100 * slip * mesh.points[:, 1]
        mesh.data["von_mises"] *= 1 + 1e4 * slip
        bodies.append(mesh)
        base = mesh.points[mesh.cells[:, :4]]
        base = base[(base[:, :, 2] == 0).all(axis=1)]
        n = base.shape[0] * base.shape[1]
        faces.append(
            Mesh(
                base.reshape(-1, 3),
                np.arange(n).reshape(-1, 4),
                slip=np.tile((slip, 0, 0), (n, 1)),
                traction=np.tile((-1 - 1e3 * slip, 0, 0), (n, 1)),
                bound=np.full(n, 1.0),
                stick=np.full(n, slip == 0.0),
                utilisation=np.full(n, 1.0),
                displacement=np.tile((slip, 0, 0), (n, 1)),
            )
        )
    return SimpleNamespace(
        name="block",
        directory=Path(),
        solution=[(float(i), Path()) for i in range(3)],
        contact=[(float(i), Path()) for i in range(3)],
        statistics={},
        units={},
        body=lambda index: bodies[index],
        face=lambda index: faces[index],
        boundary=lambda: None,
        dimension=lambda: 3,
        is_of_revolution=lambda: False,
        rest=0.0,
        opposite=False,
    )


def ranges(figure):
    """What numbers look like in a figure: axes, colors, arrows and their key."""
    found = []
    for axes in figure.axes:
        found += [*axes.get_xlim(), *axes.get_ylim()]
        for artist in axes.collections:
            if isinstance(artist, Quiver):
                found.append(artist.scale)
            elif artist.get_array() is not None:
                found += artist.get_clim()
    keys = figure.findobj(QuiverKey)
    return np.array(found), [key.text.get_text() for key in keys]


class Figures(TestCase):
    def setUp(self):
        style.set_up()

    def tearDown(self):
        plt.close("all")

    def draw(self, results, view=VIEW, mirror=None):
        options = SimpleNamespace(
            magnification=None, mirror=mirror, view=view, label=[], window=None
        )
        scale = fields.scale(results, [0], options, "von_mises")
        figure = fields.draw(results, 0, options, scale)
        figure.draw_without_rendering()
        return figure

    def boxes(self, texts):
        return [
            text.get_window_extent()
            for text in texts
            if text.get_visible() and text.get_text()
        ]

    def test_labels_in_three_dimensions(self):
        """Numbers and labels stay apart, one power of ten holds for all axes."""
        for extent in ((1, 1, 1), (0.03, 0.02, 0.008), (4, 1, 0.3), (0.1, 0.1, 1),
                       (4e-4, 1e-4, 5e-5), (2e6, 1e6, 3e5)):
            # the other views by bodies of unlike sides
            for view in (VIEW, (50, 200), (30, 120))[: 3 if extent[0] == 4 else 1]:
                figure = self.draw(block(*extent), view)
                labels = [t for t in figure.texts if t.get_text()[0] == "$"]
                self.assertEqual(len(labels), 3)
                powers = {label.get_text()[3:] for label in labels}
                self.assertEqual(len(powers), 1, powers)
                plain = 1e-2 <= max(extent) < 1e4
                self.assertEqual(powers == {""}, plain, powers)
                (axes,) = [a for a in figure.axes if a.name == "3d"]
                groups = [self.boxes([label]) for label in labels]
                for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
                    groups += [self.boxes([number]) for number in numbers_at(axis)]
                    self.assertEqual(axis.offsetText.get_text(), "")
                for these, those in itertools.combinations(groups, 2):
                    for a, b in itertools.product(these, those):
                        self.assertFalse(a.overlaps(b), (extent, view))
                self.assertGreaterEqual(sum(map(len, groups)), 3 + 5)

    def test_bodies_fill_their_panels(self):
        """Body, numbers and labels reach the edges of the panel, not beyond."""
        for extent in ((1, 1, 1), (4, 1, 0.3), (0.1, 0.1, 1), (0.1, 0.05, 0.012)):
            figure = self.draw(block(*extent))
            panel = figure.axes[0].get_window_extent()
            (axes,) = [a for a in figure.axes if a.name == "3d"]
            texts = [t for t in figure.texts if t.get_text()[0] == "$"]
            for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
                texts += numbers_at(axis)
            corners = np.array(list(itertools.product((0, 1), repeat=3))) * extent
            x, y, _ = proj3d.proj_transform(*corners.T, axes.get_proj())
            body = axes.transData.transform(np.column_stack([x, y]))
            body = Bbox([body.min(axis=0), body.max(axis=0)])
            share = Bbox.union([body, *self.boxes(texts)]).size / panel.size
            self.assertClose(share.max(), 1.0, absolute=0.05, what=extent)

    def test_frames_have_the_same_ranges(self):
        """A slip of 2e-5 is drawn shorter than one of 3.6e-4, whatever the mesh."""
        results = sliding_block()
        options = SimpleNamespace(
            magnification=None, mirror=None, view=VIEW, label=[], window=None
        )
        for module, n_arrows in ((overview, 1), (contact, 1), (fields, 0)):
            name = ["displacement"] if module is fields else []
            scale = module.scale(results, range(3), options, *name)
            of_first = None
            for i in range(3):
                figure = module.draw(results, i, options, scale)
                found, keys = ranges(figure)
                of_first = found if of_first is None else of_first
                self.assertClose(found, of_first, 1e-12, what=(module.__name__, i))
                arrows = figure.findobj(Quiver)
                self.assertEqual(len(arrows), n_arrows)
                for quiver in arrows:
                    drawn = np.hypot(quiver.U, quiver.V) / quiver.scale
                    # of the finest mesh, whose nodes are 1/8 apart; 2e-5 is
                    # 6 % of the largest
                    expected = (0.0, 2e-5 / 3.6e-4, 1.0)[i] / 8
                    self.assertClose(drawn.max(initial=0), expected, 1e-9)
                if module is overview:
                    self.assertEqual(keys, ["slip, at most 360 × $10^{-6}$"], f"frame {i}")
                plt.close(figure)

    def test_colors_reach_the_extremes_of_nodal_values(self):
        results = block(1.0, 0.5, displacement=0.1)
        scale = fields.scale(
            results,
            [0],
            SimpleNamespace(magnification=None, mirror=None, window=None, label=[]),
            "displacement_x",
        )
        self.assertClose((scale.shade.norm.vmin, scale.shade.norm.vmax), (0, 0.05), 1e-12)

    def test_height_of_pictures_in_the_plane(self):
        """No empty space about flat or tall bodies; labels fit the color bar."""
        for height in (0.1, 0.25, 0.46, 0.8):
            figure = self.draw(block(1.0, height))
            body, *bars = figure.axes
            legend = body.get_legend().get_window_extent()
            title = figure._suptitle.get_window_extent()
            self.assertGreater(title.y0, legend.y0)
            self.assertLess(title.y0 - legend.y1, 0.3 * figure.dpi)
            (bar,) = bars or body.child_axes
            underneath = height < 0.4
            self.assertEqual(bool(bars), underneath)
            if underneath:
                gap = body.xaxis.label.get_window_extent().y0
                gap -= bar.get_window_extent().y1
                self.assertLess(gap, 0.3 * figure.dpi)
            axis, along = (bar.xaxis, 0) if underneath else (bar.yaxis, 1)
            self.assertLess(
                axis.label.get_window_extent().size[along],
                bar.get_window_extent().size[along],
            )

    def test_halves_of_bodies_of_revolution(self):
        """Two where the section meets the axis, or where they are asked for; no line
        between them."""
        for begin, revolved, mirror, n_halves in (
            (0, True, None, 2),
            (0, True, False, 1),
            (1, True, None, 1),
            (1, True, True, 2),
            (0, False, None, 1),
        ):
            results = block(1.0, 0.5)
            results.is_of_revolution = lambda revolved=revolved: revolved
            results.body(0).points[:, 0] += begin
            axes = self.draw(results, mirror=mirror).axes[0]
            tiles_drawn = [c for c in axes.collections if isinstance(c, PolyCollection)]
            corners = [
                np.concatenate([path.vertices for path in drawn.get_paths()])
                for drawn in tiles_drawn
            ]
            self.assertEqual(len(corners), n_halves)
            self.assertClose(corners[-1][:, 0], corners[0][:, 0] * (3 - 2 * n_halves))
            low = begin if n_halves == 1 else -begin - 1
            # with a margin, so that edges are whole
            limits = low - 0.01, begin + 1.01
            self.assertClose(axes.get_xlim(), limits, absolute=1e-9)
            self.assertEqual("radius" in axes.get_xlabel(), revolved)
            outlines = [
                line
                for lines in axes.collections
                if isinstance(lines, LineCollection) and lines.get_linewidth()[0] == 1.0
                for line in lines.get_segments()
            ]
            self.assertEqual(len(outlines), n_halves)
            is_closed = [np.array_equal(line[0], line[-1]) for line in outlines]
            self.assertEqual(is_closed, [n_halves == 1 or begin == 1] * n_halves)
        with self.assertRaisesRegex(UserError, "is for bodies of revolution"):
            self.draw(block(1.0, 0.5), mirror=True)

    def test_no_hairlines_between_cells(self):
        """Rectangles beside cells that are nearly ones, of any size in pixels."""
        figure = plt.figure(figsize=(3, 3), dpi=100)
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_axis_off()
        n = 61
        x, y = np.meshgrid(np.linspace(-0.1, 1.1, n), np.linspace(-0.1, 1.1, n))
        x[:, ::3] += 1e-6 * np.arange(n)[:, None] ** 2
        place = np.stack([x, y], axis=-1)
        cells = np.stack(
            [place[:-1, :-1], place[:-1, 1:], place[1:, 1:], place[1:, :-1]], axis=2
        ).reshape(-1, 4, 2)
        self.assertGreater(len(cells), MANY)
        tiles(axes, cells, facecolors=[(0, 0, 0)])
        figure.canvas.draw()
        pixels = np.asarray(figure.canvas.buffer_rgba())[:, :, :3]
        self.assertLess(pixels.max(), 0.03 * 255)


class Numbers(TestCase):
    def test_rounding_is_that_of_components(self):
        """A component of rounding in its tensor is zero; fields whose names begin
        alike have nothing to do with each other."""

        class Body(dict):
            data = property(lambda self: self)

        body = Body(
            stress_xx=np.ones(2),
            stress_xy=np.full(2, 1e-9),
            creep_strain=np.ones(2),
            creep_rate=np.full(2, 1e-11),
        )
        self.assertEqual(field(body, "stress_xy").tolist(), [0.0, 0.0])
        self.assertEqual(field(body, "creep_rate").tolist(), [1e-11, 1e-11])
        moved = np.ones((2, 2))
        face = Body(displacement=moved, slip=1e-13 * moved, slip_rate=1e-12 * moved)
        required(SimpleNamespace(contact=[0], face=lambda index: face), 0)
        self.assertFalse(np.any([face["slip"], face["slip_rate"]]))

    def test_edges_once(self):
        """Cells have points of their own; those of an edge count as one."""
        mesh = block(2.0, 1.0, cells=(3, 2)).body(0)
        vertex = geometry.weld(mesh.points, 1e-6)
        edges = geometry.unique_edges(mesh.cells, vertex)
        self.assertEqual(len(edges), 3 * 3 + 4 * 2)
        ends = mesh.points[edges]
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        self.assertClose(lengths.sum(), 3 * 2.0 + 4 * 1.0, absolute=1e-12)

    def test_area_of_a_loop(self):
        """Clockwise in the (displacement, force) plane is work put in."""
        u = np.array([0, 0, 2, 2, 0.0])
        f = np.array([0, 3, 3, 0, 0.0])
        self.assertClose(hysteresis.work(u, f), 6, relative=1e-15)
        self.assertClose(hysteresis.work(u[::-1], f[::-1]), -6, relative=1e-15)
        self.assertClose(hysteresis.work(u[2:4], f[:2]), 0, absolute=1e-15)
        self.assertClose(hysteresis.work(u[1:3], f[:2]), 3, relative=1e-15)
        angle = np.linspace(0, 2 * np.pi, 401)
        area = hysteresis.work(5 * np.cos(angle), -3 * np.sin(angle))
        self.assertClose(area, 15 * np.pi, relative=1e-4)

    def test_last_cycle(self):
        angle = np.linspace(0, 4 * np.pi, 81)
        u, f = 1e-3 * np.sin(angle), 1e6 * np.cos(angle)
        self.assertEqual(hysteresis.last_cycle(u, f), 40)
        loading = np.linspace(0, 1, 11)
        self.assertIsNone(hysteresis.last_cycle(loading, loading**2))
        self.assertIsNone(hysteresis.last_cycle(0 * loading, 0 * loading))
        # a way in, then a cycle
        u, f = np.append([-5.0, -3.0], u[:41] * 1e3), np.append([-4.0, 0], f[:41] / 1e6)
        self.assertEqual(hysteresis.last_cycle(u, f), 2)

    def test_expressions_of_time(self):
        t = np.linspace(0, 2, 9)
        for text, values in (
            ("0.3*min(t, 2 - t)", 0.3 * np.minimum(t, 2 - t)),
            ("-1e-3*t^2", -1e-3 * t**2),
            ("if(t < 1 && t > 0.5, 1, -pi)", np.where((t < 1) & (t > 0.5), 1, -np.pi)),
            ("if(t <= 0.5 || t >= 1, sin(t), abs(-2))",
             np.where((t <= 0.5) | (t >= 1), np.sin(t), 2)),
            ("4", np.full(9, 4.0)),
            # as deal.II's FunctionParser, which these values are from
            ("(t < 1) + (t < 2)", np.where(t < 1, 2.0, t < 2)),
            ("-(t < 1)", -1.0 * (t < 1)),
            ("if(0.3, 1, 2) + if(-0.5, 10, 20)", np.full(9, 12.0)),
            ("rint(2.5) + rint(-1.5)", np.full(9, 2.0)),
            ("int(2.5) + 10*int(-0.5)", np.full(9, -7.0)),
            ("-2^2 + 2^3^2 + 2^-1", np.full(9, 508.5)),
            ("Pi - _pi + log(_e)", np.ones(9)),
            ("sum(1, t, 2) + avg(1, t)", 3.5 + 1.5 * t),
            ("cot(1)*csc(1)*sec(1)", np.full(9, np.sin(1) ** -2)),
            ("erfc(0) + asinh(t) - ln(t + sqrt(t^2 + 1))", np.ones(9)),
            ("1/(1/0) + exp(-1/0) + atan(10^400) + atan(1e200^2)", np.full(9, np.pi)),
        ):
            self.assertClose(evaluate(text, t), values, relative=1e-14, what=text)

    def test_expressions_that_are_refused(self):
        t = np.zeros(2)
        for text in ("x*t", "t t", "__import__('os')", "t.shape", "foo(t)", "free", "",
                     "e", "True", "abs(t, t)", "abs(t, out=t)", "atan2(t)", "min()",
                     "if(t, 1)", "9" * 400, "9" * 5000, "t\0"):
            with self.assertRaisesRegex(UserError, "expressions of t alone", msg=text):
                evaluate(text, t)
        for text in ("+".join(["t"] * 3000), "t" + "^t" * 2000, "-" * 200000 + "t"):
            with self.assertRaisesRegex(UserError, "too deeply") as caught:
                evaluate(text, t)
            self.assertLess(len(str(caught.exception)), 200)
        for text in ("1/0", "1/t", "0/t", "0^-1", "10^400", "1e400", "(-8)^(1/3)",
                     "exp(1000)", "sqrt(-1)", "log(t)", "if(t == 0, 1/t, 1)"):
            words = "has the value -?(inf|nan) at t = 0"
            with self.assertRaisesRegex(UserError, words, msg=text):
                evaluate(text, t)

    def test_pieces_of_a_line(self):
        """An oblique piece of unequal edges, one at an angle, a separate one."""
        a = polyline([(0, 0), (3, 4), (4.5, 6), (6, 8), (16, 8)])
        b = polyline([(20, 8), (22, 8)])
        points = np.concatenate([a[0], b[0]])
        cells = np.concatenate([a[1], b[1] + len(a[0])])
        # in any order and direction
        cells = cells[[3, 1, 4, 0, 2]]
        cells[[0, 3]] = cells[[0, 3]][:, ::-1]
        found = lines(Mesh(points, cells))
        self.assertEqual([len(line.nodes) for line in found], [4, 2, 2])
        self.assertClose(found[0].s, (0, 5, 7.5, 10), absolute=1e-12)
        self.assertClose(found[1].s, (0, 10), absolute=1e-12)
        self.assertClose(found[2].start, (20, 8), absolute=1e-12)
        along = np.tile([0.6, 0.8, 0], (len(points), 1))
        self.assertClose(found[0].component(along), 1, absolute=1e-12)
        self.assertClose(found[1].component(along), 0.6, absolute=1e-12)

    def test_curved_piece(self):
        """With contact that opens and closes an arc is one piece, a corner parts."""
        angles = np.linspace(0, np.pi / 2, 10)
        arc = [(np.cos(a), np.sin(a)) for a in angles]
        points, cells = polyline([*arc, (0, 3)])
        data = {"contact_pressure": np.zeros(len(points)), "gap": np.ones(len(points))}
        found = lines(Mesh(points, cells, **data))
        self.assertEqual([len(line.nodes) for line in found], [2, 10])
        chord = 2 * np.sin(np.pi / 36)
        # from the end with the smaller x
        self.assertClose(found[1].start, (0, 1), absolute=1e-12)
        self.assertClose(found[1].s, chord * np.arange(10), absolute=1e-12)
        around = np.column_stack([points[:, 1], -points[:, 0], 0 * points[:, 0]])
        self.assertClose(found[1].component(around)[1:-1], 1, absolute=1e-12)
        # without it each straight piece is one
        self.assertEqual(len(lines(Mesh(points, cells))), 10)

    def test_states_of_open_contact(self):
        from plotting.faces import friction_state

        points, cells = polyline([(i, 0) for i in range(3)])
        of = {"contact_pressure": (1, 0, 0, 0), "gap": (0, 0, 1, 1)}
        mesh = Mesh(points, cells, **of)
        none, open_ = style.NO_FRICTION, style.NO_CONTACT
        self.assertEqual(friction_state(mesh).tolist(), [none, none, open_, open_])
        friction = {"stick": (1, 0, 0, 1), "bound": (1, 0, 0, 1)}
        mesh = Mesh(points, cells, **of, **friction)
        sticks = style.STICKING
        self.assertEqual(friction_state(mesh).tolist(), [sticks, none, open_, sticks])
        # the last is held by something else that moves it, beside one that slips
        friction = {"stick": (1, 0, 0, 1), "bound": (1, 1, 0, 1)}
        for second, last in (0, sticks), (0.2, open_):
            rates = [(1e-12, 0, 0), (second, 0, 0), (0, 0, 0), (0.1, 0, 0)]
            mesh = Mesh(points, cells, **of, **friction, slip_rate=rates)
            self.assertEqual(
                friction_state(mesh).tolist(), [sticks, style.SLIPPING, open_, last]
            )
        # at its bound, and slower than what counts in the run
        mesh.rest = 0.05
        mesh.data["slip_rate"][1, 0] = 0.04
        self.assertEqual(friction_state(mesh).tolist(), [sticks, sticks, open_, sticks])
        # beside one that slips
        mesh.data["stick"][0], mesh.data["slip_rate"][0, 0] = 0, 0.1
        found = friction_state(mesh).tolist()
        self.assertEqual(found, [style.SLIPPING, sticks, open_, open_])

    def test_runs_of_states(self):
        self.assertEqual(
            [tuple(map(int, run)) for run in state_runs(np.array([1, 1, 0, -1, -1]))],
            [(1, 0, 1), (0, 2, 2), (-1, 3, 4)],
        )

    def test_resampling_keeps_the_measure(self):
        """A node stands for half its edges, on meshes of any size."""
        s = np.array([0, 0.5, 1, 1.125, 1.25, 2])
        slips = np.array([1, 1, 0, 1, 0, 0])
        count = stick_slip.columns_for([s / 2])
        centers = (np.arange(count) + 0.5) * 2 / count
        measure = stick_slip.resample(s, slips, centers).mean() * 2
        self.assertClose(measure, 0.25 + 0.5 + 0.125, absolute=2 * 2 / count)
        self.assertGreaterEqual(count, 2 * 2 / 0.125)

    def test_boundary_with_hanging_nodes(self):
        """One large square beside two small ones: no face between them."""
        square = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
        corners = [square, [1, 0] + square / 2, [1, 0.5] + square / 2]
        points = np.concatenate([np.column_stack([c, 0 * c[:, 0]]) for c in corners])
        mesh = Mesh(points, np.arange(12).reshape(3, 4))
        faces, owners, _ = geometry.boundary_faces(mesh, 1.5)
        ends = points[faces]
        lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        self.assertClose(lengths.sum(), 5, absolute=1e-12)
        self.assertEqual(sorted(np.bincount(owners)), [2, 2, 3])

    def test_planes_are_seen_from_outside(self):
        """The normal points out of the body; y is up, from whichever side."""
        bits = [(i, j, k) for k in (0, 1) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
        body = Mesh(bits, [range(8)])
        for cell, normal in (([0, 1, 2, 3], (0, 0, -1)), ([4, 5, 6, 7], (0, 0, 1))):
            (plane,) = planes(Mesh(bits, [cell]), body)
            self.assertClose(plane.normal, normal, absolute=1e-12)
            self.assertEqual((plane.label(0), plane.label(1)), ("$x$", "$y$"))
            self.assertEqual(plane.through_the_body, normal[2] < 0)
            self.assertClose(plane.directions, [(1, 0, 0), (0, 1, 0)], absolute=1e-12)
            self.assertClose(plane.area, 1, absolute=1e-12)

    def test_thinned_nodes_are_a_regular_pattern(self):
        x, y = np.meshgrid(np.arange(9.0), np.arange(5.0))
        place = np.column_stack([x.ravel(), y.ravel()])
        chosen = place[geometry.thinned(place, np.arange(45), 2.0)]
        expected = {(a, b) for a in range(0, 9, 2) for b in range(0, 5, 2)}
        self.assertEqual({tuple(map(int, p)) for p in chosen}, expected)

    def test_colors(self):
        """White is zero where signs differ; few huge values do not dim the rest."""
        signed = style.Shade(np.array([-1.0, 0.5, 0.2]), "test")
        self.assertEqual((signed.norm.vmin, signed.norm.vmax), (-1, 1))
        self.assertEqual(signed.extend, "neither")
        peaked = style.Shade(np.append(np.linspace(0, 1, 999), 50.0), "test")
        self.assertLess(peaked.norm.vmax, 1.01)
        self.assertEqual(peaked.extend, "max")
        # ten of a thousand values, in a minute of a day
        early = np.append(np.linspace(0, 1, 990), np.full(10, 50.0))
        minute = np.append(np.full(990, 1.0), np.full(10, 1 / 1440))
        for weights, most in ((None, 50.0), (minute, 1.0)):
            shade = style.Shade(early, "test", weights=weights)
            self.assertClose(shade.norm.vmax, most, relative=0.01)
        # one corner of a face of thirty nodes, and the middle of one of five
        for n, largest, expected in ((30, 9, 1), (5, 9, 9), (30, 1.4, 1.4)):
            values = np.append(np.linspace(0, 1, n), largest)
            found, _ = style.robust(values, **style.FEW)
            self.assertClose(found, expected, relative=0.1)
        for values in ([0.1, 1.0], [-1.0, -0.1]):
            shade = style.Shade(np.array(values), "test")
            dark, light = (
                sum(shade.colors(np.array([value]))[0, :3])
                for value in sorted(shade.ends(), key=abs)
            )
            self.assertLess(dark, light)
            self.assertIn(0.0, shade.ends())  # as a tenth is near
        uniform = style.Shade(np.full(5, 3.0), "test")
        self.assertLess(uniform.norm.vmin, 3)
        self.assertGreater(uniform.norm.vmax, 3)
        with self.assertRaisesRegex(UserError, "not finite"):
            style.Shade(np.array([1, np.nan]), "test")

    def folder(self, **files):
        """A directory with files of these contents, by name without its dot."""
        folder = tempfile.TemporaryDirectory(prefix="plots_")
        self.addCleanup(folder.cleanup)
        path = Path(folder.name)
        for name, content in files.items():
            content = content.encode() if isinstance(content, str) else content
            (path / name.replace("_", ".")).write_bytes(content)
        return path

    def test_statistics_of_a_run_in_progress(self):
        """A last row that is not complete yet does not count."""
        folder = self.folder(statistics_csv="step,t,E\n0,0,nan\n1,0.5,2\n2,0.7")
        table = read_statistics(folder / "statistics.csv")
        self.assertEqual(list(table), ["step", "t", "E"])
        self.assertClose(table["t"], (0, 0.5), absolute=0)
        for content in ("", "step,t\n", "step,t\n0"):
            folder = self.folder(statistics_csv=content)
            self.assertEqual(read_statistics(folder / "statistics.csv"), {})

    def test_damaged_files(self):
        for files, words in (
            ({"statistics_csv": "step,t\n0\n1,1\n"}, "row 1 has 1 values"),
            ({"statistics_csv": "step,t\n0,nan\n1,1\n"}, "times that are not finite"),
            ({"statistics_csv": b"step,t\n0,\xff\n"}, "statistics.csv cannot be read"),
            ({"solution_pvd": "<VTKFile><DataSet/></VTKFile>"}, "lacks its time"),
            ({"solution_pvd": "<V><DataSet timestep='x' file='y'/></V>"}, "lacks its"),
            ({"solution_pvd": "<V><DataSet timestep='inf' file='y'/></V>"}, "not finite"),
            ({"solution_pvd": "<V"}, "solution.pvd cannot be read"),
        ):
            with self.assertRaisesRegex(UserError, words):
                Results(self.folder(**files))
        folder = self.folder(parameters_prm=b"set A = \xff")
        with self.assertRaisesRegex(UserError, "parameters.prm cannot be read"):
            read_parameters(folder / "parameters.prm")

    def test_damaged_records(self):
        mesh = meshio.Mesh(
            np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float),
            [("quad", [(0, 1, 2, 3)])],
            point_data={"u": np.ones(4), "v": np.array([0, 1, np.inf, np.nan])},
        )
        folder = self.folder(
            bad_vtu="<VTKFile",
            other_vtu="<VTKFile type='ImageData'/>",
            empty_vtu="<VTKFile><Piece NumberOfCells=\"0\"/></VTKFile>",
            nobody_pvtu="<VTKFile><Piece/></VTKFile>",
            mixed_pvtu="<V><Piece Source='a.vtu'/><Piece Source='b.vtu'/></V>",
        )
        mesh.write(folder / "a.vtu")
        del mesh.point_data["u"]
        mesh.write(folder / "b.vtu")
        for name, words in (
            ("bad.vtu", "cannot be read"),
            ("other.vtu", "cannot be read"),
            ("empty.vtu", "contains no cells"),
            ("nobody.pvtu", "a piece has no file"),
            ("mixed.pvtu", "different fields"),
        ):
            with self.assertRaisesRegex(UserError, words):
                Record(folder / name)
        record = Record(folder / "a.vtu")
        self.assertClose(record["u"], 1, absolute=0)
        with self.assertRaisesRegex(NoPicture, '"v" in .* not finite'):
            record["v"]

    def test_parts_of_the_error_over_time(self):
        """In per cent of the largest norm, without those that nobody sees."""
        t = np.linspace(0.0, 1.0, 5)
        statistics = {
            "t": t,
            "energy_norm": 2.0 * t,
            "estimate_space": 0.06 * t,
            "estimate_time": 0.02 * t,
            "estimate_initial": 1e-9 + 0 * t,
            "estimate_total": 0.08 * t,
        }
        chosen = {
            panel.label: (panel, panel.chosen(statistics))
            for panel in errors.PANELS
            if panel.chosen(statistics)
        }
        self.assertEqual(list(chosen), ["error in the\nenergy norm"])
        panel, names = chosen["error in the\nenergy norm"]
        self.assertEqual(names, ["estimate_space", "estimate_time", "estimate_total"])
        figure, axes = plt.subplots()
        history.draw_panel(axes, panel, names, [("", statistics)], Units())
        tops = [line.get_ydata().max() for line in axes.get_lines()[:3]]
        self.assertClose(np.array(tops), np.array([3.0, 1.0, 4.0]), 1e-12)
        plt.close(figure)
        # The tolerance of a quantity is a share of its largest value.
        about = {"estimated_error_of_quantity": {"largest_value": 650.0}}
        results = SimpleNamespace(
            data={("Error control", "Tolerance"): "0.02"}, about=lambda: about
        )
        self.assertEqual(history.tolerance(results, history.QUANTITY), 13.0)
        self.assertIsNone(history.tolerance(results, history.ERROR))
        about.clear()
        self.assertEqual(history.tolerance(results, history.ERROR), 2.0)

    def test_labels_and_colors_of_panels(self):
        """Labels are no longer than their panel; lines differ."""
        names = "t", "slip_area", "contact_area", "contact_force_x"
        columns = dict.fromkeys(names, np.arange(3.0))
        figure, axes = plt.subplots()
        self.addCleanup(plt.close, figure)
        units, runs = Units({"length": "m", "stress": "Pa"}, 2), [("", columns)]
        history.draw_panel(axes, history.AREA, ["slip_area", "contact_area"], runs, units)
        self.assertEqual(len({line.get_color() for line in axes.get_lines()}), 2)
        history.draw_panel(axes, history.PANELS[1], ["contact_force_x"], runs, units)
        self.assertIn("\nexerted by the body\n[", axes.get_ylabel())

    def with_columns(self, **columns):
        """Results that have nothing but these columns."""
        text = ",".join(columns) + "\n"
        text += "".join(",".join(map(str, row)) + "\n" for row in zip(*columns.values()))
        return Results(self.folder(statistics_csv=text))

    def test_expressions_of_columns(self):
        """Values, and the units that follow: of forces, of energies over volumes."""
        results = self.with_columns(
            t=[0, 1, 2],
            friction_force_x=[0, 1, 3],
            contact_force_y=[0, -2, -4],
            stored_energy=[0, 1, 2],
            volume_body=[4, 4, 4],
            point0_x=[0, 0.5, 0.5],
        )
        for text, kind, last in (
            ("friction_force_x/contact_force_y", None, -0.75),
            ("abs(friction_force_x + contact_force_y)", "force", 1.0),
            ("stored_energy/volume_body", "stress", 0.5),
            ("friction_force_x*point0_x", "energy", 1.5),
            ("point0_x/t", "velocity", 0.25),
            ("sqrt(stored_energy)", "energy norm", 2**0.5),
        ):
            derived.add(results, text, 3)
            self.assertEqual(quantities.column(text)[1], kind, text)
            self.assertClose(results[text][-1], last, relative=1e-12)
        self.assertTrue(np.isnan(results["point0_x/t"][0]))
        results.units = {"length": "m"}
        self.assertEqual(derived.split("a+(b+c)/d+e", "+"), ["a", "(b+c)/d", "e"])
        for text, words in (
            ("friction_force_x - stored_energy", "terms of different units"),
            ("friction_force_z", 'no column "friction_force_z"'),
            ("friction_force_x/nothing", "the columns that --list"),
        ):
            with self.assertRaisesRegex(UserError, words):
                derived.add(results, text, 3)

    def test_columns_of_named_places(self):
        results = SimpleNamespace(
            names={
                "boundary 3": "roof",
                "boundary 4": "roof (left)",
                "boundary 5": "hall",
                "point 10": "crown",
            },
            statistics={"contact_force_4_x": None},
            parameters={(f"Boundary {n}", "Role"): "contact" for n in (3, 4)},
        )
        for text, expected in (
            ("reaction_y of hall", "reaction_5_y"),
            (
                "contact_force_x of roof (left)/reaction_x of hall",
                "contact_force_4_x/reaction_5_x",
            ),
            ("displacement_y of crown+point1_y", "point10_y+point1_y"),
            ("stress_xx of crown", "point10_stress_xx"),
            ("friction_force_x of roof", "friction_force_x"),  # the only one
            ("reaction_y of roofing", "reaction_y of roofing"),
        ):
            self.assertEqual(by_numbers(text, results), expected)

    def test_another_run_is_drawn_in_the_units_of_this_one(self):
        t, force = np.array([0.0, 1.0, 2.0]), np.array([0.0, 1.0, 3.0])
        runs = [
            self.with_columns(t=t, friction_force_x=force),
            self.with_columns(t=60 * t, friction_force_x=1000 * force),
        ]
        options = SimpleNamespace(
            columns=["friction_force_x"],
            overlay=[runs[1].directory],
            log_time=True,
            begin=None,
            until=None,
        )
        units = [("mm", "min", "MPa"), ("mm", "s", "kPa")]
        for run, (length, time, stress) in zip(runs, units):
            about = {"units": {"length": length, "time": time, "stress": stress}}
            (run.directory / "run.json").write_text(json.dumps(about))
        figure = history.draw(runs[0], options)
        first, other = figure.axes[0].get_lines()[:2]
        self.assertEqual(figure.axes[0].get_xscale(), "log")
        self.assertClose(first.get_xdata(), t[1:], absolute=0)
        self.assertClose(other.get_xdata(), t[1:], relative=1e-12)
        self.assertClose(other.get_ydata(), first.get_ydata(), relative=1e-12)
        labels = [text.get_text() for text in figure.axes[0].get_legend().get_texts()]
        self.assertEqual(labels, [run.name for run in runs])
        plt.close(figure)
        (runs[1].directory / "run.json").write_text("{}")
        with self.assertRaisesRegex(UserError, "have other units of length"):
            history.draw(runs[0], options)

    def test_ends_that_other_conditions_hold_look_as_the_face_beside_them(self):
        face = Mesh(
            [(0, 0, 0), (1, 0, 0), (1, 0, 0), (2, 0, 0)],
            [(0, 1), (2, 3)],
            stick=[1, 1, 1, 1],
            bound=[0, 1, 1, 1],
        )
        self.assertEqual(list(faces.friction_state(face)), [style.STICKING] * 4)
        face.data["bound"][1:3] = 0.0  # in the middle it is what it says
        expected = [style.NO_FRICTION] * 3 + [style.STICKING]
        self.assertEqual(list(faces.friction_state(face)), expected)

    def test_magnification(self):
        for largest, expected in ((0.0, 1), (0.5, 1), (1e-3, 50), (4e-6, 1e4),
                                  (1e-320, 1), (np.inf, 1)):
            self.assertClose(
                style.rounded_magnification(largest, 1.0), expected, relative=1e-12
            )


SMALL_SLAB = {"Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true"}


class Pictures(TestCase):
    def assertPicture(self, path):
        """A picture, not a blank page: some ink, several colors."""
        image = matplotlib.image.imread(path)
        self.assertGreater(min(image.shape[:2]), 100, path)
        # one number a color: unique rows take seconds to find
        colors = (image[:, :, :3] * 15).astype(int) @ (256, 16, 1)
        self.assertGreater(len(np.unique(colors)), 8, path)
        ink = (image[:, :, :3].min(axis=2) < 0.9).mean()
        self.assertGreater(ink, 0.01, path)

    def draw(self, result, *arguments, reason=None, plot=plot):
        """The pictures that contrib/plot says it has drawn, small ones."""
        process = plot(result.directory, *arguments, "--dpi", 50)
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertNotIn("Traceback", process.stderr)
        if reason is None:
            self.assertEqual(process.stderr, "")
        else:
            self.assertRegex(process.stderr, reason)
        paths = [result.directory / line for line in process.stdout.strip().split("\n")]
        for path in paths:
            self.assertTrue(path.exists(), path)
            if path.suffix == ".png":
                self.assertPicture(path)
        return {path.name for path in paths}

    def refuse(self, result, *arguments):
        process = plot(result.directory, *arguments)
        self.assertEqual(process.returncode, 1)
        self.assertNotIn("Traceback", process.stderr)
        self.assertEqual(process.stdout, "")
        return process.stderr

    def test_everything_in_two_dimensions(self):
        result = run(
            "slab",
            {
                **SMALL_SLAB,
                "Material/Law": "elastic",  # a picture fewer a component
                "Output/Fields every": 4,
                "Output/Lines": "0, 0 : 2, 0 : 33; 1, 0 : 1, 1 : 17",
                "Output/Line fields": "slip, stress",
            },
        )
        reason = "^Not drawn: efficiency: there is no exact solution.*$"
        names = self.draw(result, "--all", reason=reason)
        self.assertLessEqual(
            {"overview.png", "von_mises.png", "displacement_x.png", "stress_xy.png",
             "pressure.png", "contact.png", "history.png", "hysteresis.png",
             "stick-slip.png", "lines.png"},
            names,
        )
        self.assertEqual(self.draw(result, "lines", "--columns", "slip_x"), {"lines.png"})
        message = self.refuse(result, "lines", "--columns", "slip")
        self.assertIn("no line has the columns slip; there are displacement_x", message)
        self.assertNotIn("estimator.png", names)
        # the overview alone, as contrib/run wants it
        self.assertEqual(self.draw(result, plot=plot_afresh), {"results.png"})
        self.assertEqual(self.draw(result, "--step", 4), {"results_00004.png"})
        names = self.draw(result, "displacement_y", "--format", "pdf,svg", "--time", 1)
        self.assertEqual(names, {"displacement_y_00004.pdf", "displacement_y_00004.svg"})
        pdf = result.directory / "pictures" / "displacement_y_00004.pdf"
        self.assertEqual(pdf.read_bytes()[:4], b"%PDF")
        file = result.directory / "loop"
        self.assertEqual(self.draw(result, "hysteresis", "--output", file), {"loop.png"})
        source = f"results, {result.info['version']}, {result.info['git_revision']}, 20"
        self.assertIn(f"Source\0{source}".encode(), file.with_suffix(".png").read_bytes())

    def test_contact_that_opens(self):
        """A block on a bent foundation, with and without friction."""
        law = {
            "Boundary 2/Contact law": "unilateral",
            "Boundary 2/Gap": "0.05*(x - 1)^2",
            "Boundary 2/Friction law": "coulomb",
            "Boundary 2/Friction coefficient": 0.3,
            "Boundary 3/Role": "displacement",
            "Boundary 3/Displacement": "0.02*max(t - 1, 0); -0.02*min(t, 1)",
        }
        for friction in "coulomb", "none":
            with self.subTest(friction=friction):
                law["Boundary 2/Friction law"] = friction
                result = run("slab", {**SMALL_SLAB, **law, "Output/Fields every": 4})
                asked = ["contact"] + ["overview", "stick-slip"] * (friction != "none")
                self.assertEqual(len(self.draw(result, *asked)), len(asked))
        self.draw(result, "von_mises", "--window", "0,0,1,0.5", "--label", "0.5,0.2=here")
        columns = "contact_area,max_pressure,max_gap,contact_force_x+contact_force_y"
        self.draw(result, "history", "--columns", columns)

    def test_map_agrees_with_the_statistics(self):
        """The slipping part of each row of the stick-slip map is slip_area."""
        result = run("slab", {"Output/Fields every": 1})
        contact = result.series("contact")
        results = Results(result.directory)
        # Nothing is colored where nothing touches; outputs that are not steps are told.
        record = results.read(results.contact[1][1])
        for name in "contact_pressure", "bound":
            record.data[name] = np.zeros(len(record.points))
        record.data["gap"] = np.ones(len(record.points))
        results.read, results.contact = lambda path: record, results.contact[:4]
        results.dimension = lambda: 2
        anytime = SimpleNamespace(begin=None, until=None)
        figure = stick_slip.draw(results, anytime)
        self.addCleanup(plt.close, figure)
        self.assertIn("3 outputs of 32 steps", figure._suptitle.get_text())
        (rates,) = figure.axes[1].collections
        self.assertTrue(np.ma.getmaskarray(rates.get_array()).all())
        times = [time for time, _ in results.contact]
        later = SimpleNamespace(begin=times[1], until=times[3])
        self.assertEqual(stick_slip.outputs(results, later), results.contact[1:])
        from plotting.faces import friction_state

        results = Results(result.directory)
        self.assertEqual(len(contact), 33)
        for index in range(1, len(contact)):
            record = results.face(index)
            (line,) = lines(record)
            count = stick_slip.columns_for([line.s / line.length])
            centers = (np.arange(count) + 0.5) * line.length / count
            states = stick_slip.resample(
                line.s, friction_state(record)[line.nodes], centers
            )
            slipping = (states == style.SLIPPING).mean() * line.length
            self.assertClose(slipping, result["slip_area"][index], absolute=1e-6)

    def test_loop_of_the_coulomb_block(self):
        """The work of the plate is what friction dissipates and shear stores.

        tau^2/(2 mu) on area 2, tau = -0.04 at the end; the trapezoidal rule is
        exact but for the two steps in which the foot begins to slip, 2 % here.
        """
        result = run("coulomb_block_2d")
        found = hysteresis.displacements(Results(result.directory), result.statistics)
        u = found["boundary3_x"][0]
        t = result["t"]
        plate = 0.3 * np.where(t < 2, np.maximum(t - 1, 0), 3 - t)
        self.assertClose(u, plate, absolute=1e-12)
        work = hysteresis.work(u, result["friction_force_x"])
        stored = 2 * 0.04**2 / (2 / 2.6)
        dissipated = result["friction_dissipation"][-1]
        self.assertClose(work, dissipated + stored, relative=0.02)

    def test_three_dimensions_hanging_nodes_and_two_ranks(self):
        result = run(
            "pad_adaptive", {"Time/Phases": "0.5: 2", "Output/Fields every": 1}, ranks=2
        )
        wanted = "subdomain", "contact", "hysteresis"
        names = self.draw(result, "overview", *wanted, "--view", "30,120")
        self.assertLessEqual({f"{name}.png" for name in wanted}, names)
        self.assertIn("two-dimensional scenes", self.refuse(result, "stick-slip"))

    def test_adaptive_face_and_pieces_at_an_angle(self):
        result = run("slab_adaptive", {"Time/Phases": "1: 6", "Output/Fields every": 1})
        self.draw(result, "stick-slip", "contact", "estimator")
        result = run("corner_coulomb_90_2d", {"Output/Fields every": 1})
        self.draw(result, "contact", "stick-slip")
        self.draw(run("corner_tresca_90_3d"), "contact")

    def test_animation(self):
        from PIL import Image

        result = run("slab", {**SMALL_SLAB, "Output/Fields every": 16})
        names = self.draw(result, "contact", "von_mises", "--animate")
        self.assertEqual(names, {"contact.gif", "von_mises.gif"})
        frames = []
        with Image.open(result.directory / "pictures" / "contact.gif") as image:
            self.assertEqual(image.n_frames, 3)
            for i in range(3):
                image.seek(i)
                frames.append(np.asarray(image.convert("RGB")).astype(int))
        self.assertGreater(np.abs(frames[2] - frames[1]).max(), 100)
        self.assertIn("no animation", self.refuse(result, "history", "--animate"))

    def test_without_friction(self):
        result = run("elastic_frictionless")
        self.draw(result, "overview")
        self.assertIn("no friction", self.refuse(result, "stick-slip"))
        self.assertIn("nothing dissipates", self.refuse(result, "hysteresis"))

    def test_without_contact_and_with_the_ends_only(self):
        result = run(
            "cantilever_creep", {"Output/Fields every": 0, "Time/Phases": "0.13: 1"}
        )
        self.draw(result, "overview", "history")
        self.assertIn("without contact", self.refuse(result, "contact"))
        self.assertIn("without contact", self.refuse(result, "stick-slip"))
        result = run("slab", {**SMALL_SLAB, "Output/Fields every": 0})
        self.assertIn("has no 'Output/Lines'", self.refuse(result, "lines"))
        self.assertIn("'Output/Fields every = 1'", self.refuse(result, "stick-slip"))

    def test_efficiency(self):
        """Its numbers are those of the statistics."""
        result = run(
            "tresca_2d",
            {
                "Geometry/Global refinements": 1,
                "Error control/Tolerance": 0.1,
                "Material/Stress history": "quadrature points",
                "Output/Fields every": 100,
            },
            text=(MANUFACTURED / "tresca_2d.prm").read_text(),
        )
        self.draw(result, "efficiency")
        results = Results(result.directory)
        last = results.index()
        body = results.body(last)
        for field, column in (
            ("error_energy", "error_energy"),
            ("recovery", "estimate_recovery"),
            ("estimator", "estimate_space"),
        ):
            of_cells = efficiency.of_cells(body, field)
            self.assertClose(np.linalg.norm(of_cells), result[column][-1], 1e-6)
        quotient = result["estimate_recovery"].max() / result["error_energy"].max()
        self.assertClose(quotient, 1, absolute=0.2)

    def test_python_without_packages(self):
        """A sentence with the package to install, no traceback."""
        for command in "plot", "report":
            process = subprocess.run(
                [sys.executable, "-S", SOURCE / "contrib" / command, "."],
                capture_output=True,
                text=True,
            )
            self.assertEqual(process.returncode, 1)
            self.assertRegex(
                process.stderr, r"^Error: \S+ has no \w+ \(Debian: python3-\w+\); .*\n$"
            )

    def test_what_is_wrong(self):
        result = run("slab", {**SMALL_SLAB, "Output/Fields every": 0})
        for arguments, words in (
            (["--step", 7], "no output number 7; there are 0, 1"),
            (["vonmises"], 'no picture and no field "vonmises".*von_mises'),
            (["--columns", "energy"], 'no column "energy".*strain_energy'),
            (["hysteresis", "--force", "f"], 'no force "f".*friction_force_x'),
            (["hysteresis", "--displacement", "u"], 'no displacement "u".*point0_x'),
            (["history", "--columns", "t+slip_area"], "have not the same unit"),
            (["history", "--from", 9], "fewer than two rows"),
            (["history", "--output", result.directory / "none" / "a.png"], "No such file"),
        ):
            self.assertRegex(self.refuse(result, *arguments), words)
        directory = result.directory
        (directory / "solution.pvd").write_text("<VTKFile/>")
        self.assertIn("lists no files", self.refuse(result))
        (directory / "solution.pvd").unlink()
        self.draw(result, "history")
        self.assertIn("no solution.pvd", self.refuse(result, "von_mises"))
        (directory / "statistics.csv").write_text("step,t\n")
        self.assertIn("no directory of results", self.refuse(result))


if __name__ == "__main__":
    main()
