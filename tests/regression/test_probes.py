# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fields at points, along lines and integrated: in uniform states, whose values
are known, and against the outputs of fields where they are not uniform."""

import csv
import math
import re

import numpy as np

import test_fields
from harness import TestCase, main, run
from runs import Job, on_boundary, with_roles, without_wall_times

BODY_FIELDS = (
    "velocity, stress, von Mises stress, irreversible stress, total strain, "
    "irreversible strain, creep strain, creep rate, principal stresses"
)
# That deal.II gives the cells of boxes whose sides it numbers.
MATERIAL = {2: 3, 3: 7}


def read_line(result, i=0):
    """{column: array (time, point)} of a file of a line."""
    with open(result.directory / f"line_{i}.csv", newline="") as file:
        rows = list(csv.reader(file))
    table = np.array([[float(v) for v in row] for row in rows[1:]])
    n_points = int((table[:, 0] == table[0, 0]).sum())
    table = table.reshape(-1, n_points, len(rows[0]))
    return {name: table[:, :, c] for c, name in enumerate(rows[0])}


def components(dim):
    return ["xx", "yy", "zz", "xy", "xz", "yz"][: 4 if dim == 2 else 6]


def component(tensor, name):
    return tensor["xyz".index(name[0]), "xyz".index(name[1])]


class Uniform(TestCase):
    """u = t (a x, b y, c z) on meshes with hanging nodes."""

    known = test_fields.Uniform()

    POINTS = {
        2: [(0.3, 0.4), (0.5, 0.5), (1, 0), (0.625, 0), (0.75, 0.25)],
        3: [(0.3, 0.4, 0.2), (0.5, 0.5, 0.5), (1, 0, 1), (0.625, 0, 0.25)],
    }
    LINES = {2: "0, 0 : 1, 1 : 7; 0, 0 : 1, 0 : 5", 3: "0, 0, 0 : 1, 0, 1 : 5"}

    def scene(self, dim, initial):
        points = "; ".join(", ".join(map(str, x)) for x in self.POINTS[dim])
        return self.known.scene(
            dim,
            initial,
            **{
                "Geometry/Boundary refinements": "1: 1",
                "Output/Additional fields": "",
                "Output/Fields every": 2,
                "Output/Points": points,
                "Output/Point fields": BODY_FIELDS + ", slip, normal traction",
                "Output/Lines": self.LINES[dim],
                "Output/Line fields": "stress, slip",
                "Output/Integrals": "boundary 1: displacement, stress vector, normal "
                "traction, stress; boundary 2: slip, normal traction; material "
                f"{MATERIAL[dim]}: stress, creep strain; body: displacement, velocity",
                "Solver/Contact tolerance": 1e-12,
            },
        )

    def check(self, dim, initial=None, ranks=1):
        result = run("probes", self.scene(dim, initial), text="", ranks=ranks)
        rates = np.array(self.known.STRETCH[dim])
        states = self.known.expected(dim, initial)

        def close(value, expected, what):
            """To the twelve digits of the files."""
            what = f"{what}, {dim}D on {ranks}"
            self.assertClose(value, expected, 1e-11, 1e-12, what)

        for n, (strain, z, creep, stress) in enumerate(states):
            values = {name: column[n] for name, column in result.statistics.items()}
            t = n * test_fields.STEP
            rate = test_fields.dev(stress) / (2 * test_fields.VISCOSITY)
            dev = test_fields.dev(stress)
            expected = {
                "von_mises": math.sqrt(1.5) * np.linalg.norm(dev),
                "creep_strain": test_fields.equivalent(creep),
                "creep_rate": test_fields.equivalent(rate),
            }
            for i, value in enumerate(sorted(np.diag(stress), reverse=True)):
                expected[f"principal_stress_{i + 1}"] = value
            for name, tensor in (
                ("stress", stress),
                ("irreversible_stress", z),
                ("strain", strain),
                ("irreversible_strain", -test_fields.compliance(z)),
            ):
                for c in components(dim):
                    expected[f"{name}_{c}"] = component(tensor, c)
            for i, x in enumerate(self.POINTS[dim]):
                for name, value in expected.items():
                    close(values[f"point{i}_{name}"], value, f"point{i}_{name} {n}")
                for d, axis in enumerate("xyz"[:dim]):
                    close(values[f"point{i}_{axis}"], t * rates[d] * x[d], "u")
                    if n > 0:
                        velocity = rates[d] * x[d]
                        close(values[f"point{i}_velocity_{axis}"], velocity, "v")
                # Fields of the foundation, which is y = 0, where there is one.
                self.assertEqual(f"point{i}_slip_x" in values, x[1] == 0)
                if x[1] == 0:
                    close(values[f"point{i}_slip_x"], t * rates[0] * x[0], "slip")
                    close(values[f"point{i}_slip_y"], 0, "slip")
                    close(values[f"point{i}_normal_traction"], stress[1, 1], "normal")
            self.check_integrals(dim, values, t * rates, creep, stress, close)
        for i in range(self.LINES[dim].count(";") + 1):
            self.check_line(result, i, dim, rates, states, close)
        return result

    def check_integrals(self, dim, values, stretch, creep, stress, close):
        """Over the unit square or cube and its faces."""
        material = f"material_{MATERIAL[dim]}"
        for name in "area_boundary_1", "area_boundary_2", f"volume_{material}":
            close(values[name], 1, name)
        close(values["volume_body"], 1, "volume")
        center = np.full(dim, 0.5)
        face = np.array([1, *center[1:]])
        for d, axis in enumerate("xyz"[:dim]):
            body = values[f"integral_body_displacement_{axis}"]
            close(body, stretch[d] * center[d], f"body {axis}")
            wall = values[f"integral_boundary_1_displacement_{axis}"]
            close(wall, stretch[d] * face[d], f"wall {axis}")
            force = values[f"integral_boundary_1_stress_vector_{axis}"]
            close(force, stress[d, 0], f"force {axis}")
            slip = values[f"integral_boundary_2_slip_{axis}"]
            close(slip, stretch[d] * center[d] if d != 1 else 0, f"slip {axis}")
        close(values["integral_boundary_1_normal_traction"], stress[0, 0], "wall")
        close(values["integral_boundary_2_normal_traction"], stress[1, 1], "foundation")
        close(
            values[f"integral_{material}_creep_strain"],
            test_fields.equivalent(creep),
            "creep",
        )
        for c in components(dim):
            for place in "boundary_1", material:
                value = values[f"integral_{place}_stress_{c}"]
                close(value, component(stress, c), f"{place} {c}")

    def check_line(self, result, i, dim, rates, states, close):
        """Steps 0, 2 and 4, whose fields are written."""
        line = read_line(result, i)
        begin, end, n_points = self.LINES[dim].split(";")[i].split(":")
        begin, end = (np.array([float(v) for v in x.split(",")]) for x in (begin, end))
        share = np.linspace(0, 1, int(n_points))
        self.assertEqual(line["step"][:, 0].tolist(), [0, 2, 4])
        for row, n in enumerate([0, 2, 4]):
            stress = states[n][3]
            close(line["t"][row], n * test_fields.STEP, "t")
            close(line["s"][row], share * np.linalg.norm(end - begin), "s")
            for d, axis in enumerate("xyz"[:dim]):
                x = begin[d] + share * (end - begin)[d]
                close(line[axis][row], x, axis)
                u = n * test_fields.STEP * rates[d] * x
                close(line[f"displacement_{axis}"][row], u, f"u_{axis}")
            for c in components(dim):
                close(line[f"stress_{c}"][row], component(stress, c), c)
            on_foundation = line["y"][row] == 0
            slip = line["slip_x"][row]
            np.testing.assert_array_equal(np.isfinite(slip), on_foundation)
            x = line["x"][row][on_foundation]
            u = n * test_fields.STEP * rates[0] * x
            close(slip[on_foundation], u, "slip")

    def test_in_the_plane(self):
        initial = np.diag([0.03, -0.05, 0.04])
        for ranks in 1, 3:
            self.check(2, initial, ranks)

    def test_in_space(self):
        for ranks in 1, 2:
            self.check(3, ranks=ranks)

    def test_nothing_without_being_asked(self):
        scene = self.known.scene(2, **{"Output/Points": "0.3, 0.4"})
        result = run("probes", scene, text="")
        self.assertFalse(list(result.directory.glob("line_*")))
        names = [name for name in result.statistics if name.startswith("point")]
        self.assertEqual(names, ["point0_x", "point0_y"])
        for name in result.statistics:
            self.assertFalse(name.startswith(("integral_", "area_", "volume_")), name)


class Outputs(TestCase):
    """Values along lines are those of the fields that are written, on meshes that
    change, and the same on all numbers of ranks."""

    SMALL = {
        "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
        "Time/Phases": "1: 6, 2: 6",
        "Output/Fields every": 3,
    }
    SCENE = {
        **SMALL,
        "Output/Lines": "0, 0 : 2, 0 : 33; 0.1, 0.05 : 1.9, 0.95 : 19; "
        "0.25, 0.25 : 1.75, 0.25 : 7",
        "Output/Line fields": "stress, von Mises stress, slip, slip rate, traction, "
        "bound, utilisation, stick, friction work, normal traction",
        "Output/Points": "0, 0; 0.25, 0.25",
        "Output/Point fields": "stress",
        "Output/Integrals": "boundary 2: traction, stick, friction work, bound; "
        "boundary 0: stress vector; body: von Mises stress, energies",
        "Output/Additional fields": "friction work, normal traction",
    }

    def test_lines(self):
        results = [run("slab_adaptive", self.SCENE, ranks=n) for n in (1, 3)]
        first = results[0]
        self.assertGreater(first["cells"][-1], 2 * first["cells"][0])
        for index in range(len(first.series("solution"))):
            self.compare_with_fields(first, index)
        for result in results[1:]:
            for i in range(3):
                line, same = read_line(first, i), read_line(result, i)
                self.assertEqual(list(line), list(same))
                for name, values in line.items():
                    finite = np.isfinite(values)
                    np.testing.assert_array_equal(np.isfinite(same[name]), finite)
                    size = abs(values[finite]).max(initial=1e-3)
                    self.assertClose(
                        same[name][finite], values[finite], 0, 1e-7 * size, name
                    )
            for name in first.statistics:
                if name.startswith(("point", "integral_", "area_", "volume_")):
                    size = abs(first[name]).max()
                    self.assertClose(result[name], first[name], 0, 1e-7 * size, name)

    def compare_with_fields(self, result, index):
        """All cells are rectangles."""
        body, face = result.fields(index=index), result.fields("contact", index=index)
        corners = body.points[body.cells][:, :, :2]
        low, high, center = corners.min(axis=1), corners.max(axis=1), corners.mean(axis=1)
        between = 0
        for i in range(3):
            line = {name: values[index] for name, values in read_line(result, i).items()}
            for p, x in enumerate(np.stack([line["x"], line["y"]], axis=1)):
                (here,) = np.nonzero(np.all((low <= x + 1e-6) & (high >= x - 1e-6), axis=1))
                between += len(here) > 1
                cell = min(here, key=lambda c: tuple(np.round(center[c], 6)))
                for name in "stress_xx", "stress_xy", "stress_zz", "von_mises":
                    expected = body.cell_data[name][cell]
                    self.assertClose(line[name][p], expected, 2e-7, 1e-8, f"{name} {x}")
                share = (x - low[cell]) / (high[cell] - low[cell])
                nodes = body.cells[cell]
                at = np.abs(corners[cell] - low[cell]) > 1e-6
                weights = np.where(at, share, 1 - share).prod(axis=1)
                expected = weights @ body.point_data["displacement"][nodes][:, :2]
                got = [line["displacement_x"][p], line["displacement_y"][p]]
                self.assertClose(got, expected, 1e-5, 1e-7, f"u {x}")
        self.assertGreater(between, 15)

        # Along the foundation, between its nodes.
        line = {name: values[index] for name, values in read_line(result, 0).items()}
        ends = face.points[face.cells][:, :, 0]
        for p, x in enumerate(line["x"]):
            inside = (ends.min(axis=1) <= x + 1e-6) & (ends.max(axis=1) >= x - 1e-6)
            (here,) = np.nonzero(inside)
            f = min(here, key=lambda f: ends[f].mean())
            share = (x - ends[f, 0]) / (ends[f, 1] - ends[f, 0])
            nodes = face.cells[f]
            for name in face.point_data:
                values = face.point_data[name][nodes]
                expected = (1 - share) * values[0] + share * values[1]
                if expected.ndim == 0:
                    got = line[name][p]
                else:
                    expected = expected[:2]
                    got = [line[f"{name}_x"][p], line[f"{name}_y"][p]]
                self.assertClose(got, expected, 1e-5, 1e-7, f"{name} {x}")

    def test_integrals_are_what_the_other_columns_say(self):
        result = run(
            "slab",
            {
                "Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true",
                "Output/Integrals": self.SCENE["Output/Integrals"],
            },
        )
        self.assertClose(result["area_boundary_2"], 2, 1e-12)
        self.assertClose(result["volume_body"], 2, 1e-12)
        self.assertClose(
            result["integral_body_von_mises"], 2 * result["mean_von_mises"], 1e-10, 1e-12
        )
        self.assertClose(
            result["integral_boundary_2_friction_work"],
            result["friction_dissipation"],
            1e-9,
            1e-12,
        )
        self.assertClose(
            result["integral_boundary_2_traction_x"],
            -result["friction_force_x"],
            1e-9,
            1e-12,
        )
        # No other condition holds a node of the foundation.
        self.assertClose(
            result["integral_boundary_2_stick"], result["stick_area"], 1e-9, 1e-12
        )
        self.assertLess(result["stick_area"].min(), 1)


class Energies(TestCase):
    """The parts of materials add up to the energies of the body, which other tests
    know, whatever the discretization, the law and the mesh."""

    def check(self, scene, overrides, materials, ranks=1, exact=1e-11):
        places = [*(f"material {i}" for i in materials), "body"]
        integrals = "; ".join(f"{place}: energies, stress" for place in places)
        result = run(scene, {"Output/Integrals": integrals, **overrides}, ranks=ranks)
        for name in "stored_energy", "viscous_dissipation":
            expected = result[name]
            size = abs(expected).max()
            self.assertGreater(size, 0)
            self.assertClose(result[f"{name}_body"], expected, 0, exact * size, name)
            parts = [result[f"{name}_material_{i}"] for i in materials]
            self.assertClose(sum(parts), expected, 0, exact * size, name)
            for part in parts:
                self.assertGreater(abs(part).max(), 0)
                self.assertLess(abs(part).max(), size * (1 + exact))
        return result

    def test_of_layers(self):
        """An elastic one below a Maxwell fluid, both of half the height, under the
        same uniform shear."""
        integrals = "material 1: energies, stress; material 2: energies; body: energies"
        for ranks in 1, 3:
            result = run("layers", {"Output/Integrals": integrals}, ranks=ranks)
            tau = 0.1 * np.minimum(result["t"], 2 - result["t"])
            mu = {1: 2 / 2.6, 2: 1 / 2.4}
            for i in 1, 2:
                self.assertClose(result[f"volume_material_{i}"], 0.5, 1e-13)
                stored = result[f"stored_energy_material_{i}"]
                self.assertClose(stored, 0.25 * tau**2 / mu[i], 0, 1e-9)
            flow = 0.125 * tau[:-1] / 0.5
            dissipated = np.cumsum(0.5 * flow * (tau[:-1] + tau[1:]) / 2)
            for place in "material_2", "body":
                found = result[f"viscous_dissipation_{place}"]
                self.assertClose(found[1:], dissipated, 0, 1e-9, place)
                self.assertEqual(found[0], 0)
            self.assertEqual(abs(result["viscous_dissipation_material_1"]).max(), 0)
            self.assertClose(result["integral_material_1_stress_xy"], 0.5 * tau, 0, 1e-9)

    def test_of_histories_and_laws(self):
        for overrides in (
            {},
            {"Material/Stress history": "quadrature points"},
            {"Material/Volumetric integration": "full", "Material/Law": "zener"},
        ):
            self.check("cantilever_creep", overrides, (3,), exact=1e-9)

    def test_on_changing_meshes(self):
        """What has been dissipated on earlier meshes stays."""
        self.check("slab_adaptive", Outputs.SMALL, (3,), ranks=2, exact=1e-9)


class Restart(TestCase):
    def test_files_go_on(self):
        """A run that is interrupted and goes on leaves the files of one that is
        not, bit by bit, with every step or some."""
        for every_step in "true", "false":
            overrides = {
                **Outputs.SCENE,
                "Output/Lines every step": every_step,
                "Checkpoint/Every n steps": 1,
                "Checkpoint/Keep": 100,
            }
            for ranks in (1, 2) if every_step == "true" else (1,):
                with Job("slab_adaptive", overrides) as job:
                    job.run(ranks=ranks)
                    files = {
                        path.name: path.read_bytes()
                        for path in job.results.glob("line_*.csv")
                    }
                    self.assertEqual(len(files), 3)
                    steps = {
                        row.split(b",")[0] for row in files["line_0.csv"].split(b"\n")[1:-1]
                    }
                    self.assertEqual(len(steps), 13 if every_step == "true" else 5)
                    table = without_wall_times(job.results / "statistics.csv")
                    job.forget_after(4)
                    # Killed within a row.
                    with open(job.results / "line_1.csv", "ab") as file:
                        file.write(b"13,2.1")
                    job.run("--restart", ranks=ranks)
                    for name, content in files.items():
                        self.assertEqual((job.results / name).read_bytes(), content, name)
                    self.assertEqual(
                        without_wall_times(job.results / "statistics.csv"), table
                    )

    def test_what_is_refused(self):
        with Job("slab", {"Output/Lines": "0, 0 : 2, 0 : 5", "Checkpoint/Every n steps": 4,
                          "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true"}) as job:
            job.run()
            for entry, value in (
                ("Output/Lines", "0, 0 : 2, 0 : 6"),
                ("Output/Line fields", "stress"),
                ("Output/Point fields", "stress"),
                ("Output/Integrals", "body: stress"),
            ):
                process = job.run("--restart", code=1, overrides={entry: value})
                self.assertIn(f"'{entry}' is {value}", process.stderr)
            (job.results / "line_0.csv").unlink()
            job.forget_after(28)
            process = job.run("--restart", code=1)
            self.assertIn("are not in", process.stderr)
            self.assertIn("line_0.csv", process.stderr)
            # A foreign file stays.
            (job.results / "line_0.csv").write_text("my notes\n")
            process = job.run(code=1)
            self.assertIn("line_0.csv', which this program has not", process.stderr)
            self.assertEqual((job.results / "line_0.csv").read_text(), "my notes\n")


class Curved(TestCase):
    def test_points_next_to_a_hole_that_meshes_round_off(self):
        """A point within the first, coarse mesh may be outside of finer ones."""
        result = run(
            "probes",
            {
                "Dimension": 2,
                "Geometry/Generator": "quarter_hyper_shell",
                "Geometry/Arguments": "0, 0 : 1 : 2 : 2 : true",
                # On the chord of the inner arc from 0 to 45 degrees.
                "Output/Points": "0.854, 0.353",
                "Output/Point fields": "stress",
                **on_boundary(0, Role="traction", Pressure="t"),
                **with_roles(free=[1], symmetry=[2, 3]),
                "Time/Phases": "1: 4",
                "Mesh refinement/Strategy": "residual",
                "Mesh refinement/Refinement fraction": 0.9,
                "Mesh refinement/Maximal level": 4,
                "Error control/Error bar": "false",
            },
            text="",
        )
        self.assertGreater(result["cells"][-1], 10 * result["cells"][0])
        # Radial under the pressure 1 at the rim, where the arc is.
        values = {name: column[-1] for name, column in result.statistics.items()}
        e = np.array([0.854, 0.353]) / math.hypot(0.854, 0.353)
        stress = np.array(
            [[values["point0_stress_xx"], values["point0_stress_xy"]],
             [values["point0_stress_xy"], values["point0_stress_yy"]]]
        )
        self.assertClose(e @ stress @ e, -1, 0.2)


class Refused(TestCase):
    """Each with a sentence that says what is allowed."""

    def refuses(self, sentence, **entries):
        overrides = {f"Output/{k.replace('_', ' ')}": v for k, v in entries.items()}
        cells = {"Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true"}
        result = self.refused({**cells, **overrides}, re.compile(sentence))
        self.assertFalse((result.directory / "statistics.csv").exists())

    def test_places(self):
        self.refuses(
            r"'Output/Points': the point \(2.5 0.5\) does not lie in the body; the "
            r"nearest place that does is \(2 0.5\)",
            Points="1, 0.5; 2.5, 0.5",
        )
        self.refuses(
            r"'Output/Lines': the point \(2.5 1.5\) does not .* place .* is \(2 1\)",
            Lines="1, 0 : 2.5, 1.5 : 2",
        )
        for line, why in (
            ("0, 0 : 1, 0", "is no line; write `begin : end : number of points'"),
            ("0, 0 : 1, 0 : 1", "points from 2 to 100000, not '1'"),
            ("0, 0 : 1, 0 : many", "points from 2 to 100000, not 'many'"),
            ("0, 0 : 1, 0, 0 : 3", "it needs 2 finite numbers"),
            ("0, 0 : 0, 0 : 3", "begins where it ends"),
        ):
            self.refuses(f"'Output/Lines'.*{why}", Lines=line)

    def test_fields(self):
        self.refuses("'Output/Point fields'.*'strain'", Points="1, 0.5", Point_fields="strain")
        self.refuses(
            "'Output/Point fields': `slip' is a field of boundaries with the role "
            "contact, and none of 'Output/Points' is on one",
            Points="1, 0.5",
            Point_fields="slip",
        )
        self.refuses(
            "'Output/Line fields': `stick' .* none of 'Output/Lines' has a point on one",
            Lines="0, 0.5 : 1, 0.5 : 3",
            Line_fields="stick",
        )

    def test_integrals(self):
        for text, why in (
            ("boundary 7: stress", "there is no boundary 7; the mesh has the ids 0, 1, 2, 3"),
            ("material 4", "no cell has the material id 4; the mesh has the material ids 3"),
            ("boundary: stress", "'boundary' is no place to integrate over"),
            ("face 2: stress", "'face 2' is no place"),
            ("body 1: stress", "'body 1' is no place"),
            ("boundary x: stress", "'boundary x' is no place"),
            ("body: stres", r"there is no field 'stres'; did you mean stress\?"),
            ("body: slip", "`slip' is a field of boundaries, and body is none"),
            ("boundary 0: traction", "boundary 0 has no `traction', which takes friction"),
            ("boundary 0: slip", "boundary 0 has no `slip', which takes the role contact"),
            ("body: stress; body: velocity", "has body twice"),
        ):
            self.refuses(f"'Output/Integrals'.*{why}", Integrals=text)

    def test_what_has_no_effect_is_told(self):
        result = run("slab", {"Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
                              "Output/Points": "",
                              "Output/Point fields": "stress",
                              "Output/Line fields": "stress"})
        for what in "Point", "Line":
            self.assertIn(f"'Output/{what} fields' is not used", result.stdout)


if __name__ == "__main__":
    main()
