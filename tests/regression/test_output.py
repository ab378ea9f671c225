# SPDX-License-Identifier: LGPL-2.1-or-later
"""VTU series, statistics and records, read back by independent readers."""

import os
import resource
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from harness import EXECUTABLE, MPIRUN, PROGRAM, TestCase, as_prm, main, run, scene_file

STATISTICS_2D = [
    "step",
    "t",
    "k",
    "cells",
    "dofs",
    "step_limit",
    "k_r",
    "critical_cell_x",
    "critical_cell_y",
    "tension_area",
    "contact_iterations",
    "linear_iterations",
    "unchanged",
    "duality_gap",
    "algebraic_error",
    "stick_area",
    "slip_area",
    "friction_force_x",
    "friction_force_y",
    "reaction_2_x",
    "reaction_2_y",
    "reaction_3_x",
    "reaction_3_y",
    "load_x",
    "load_y",
    "force_balance_defect",
    "max_utilisation",
    "max_stick_slip",
    "max_slip",
    "slip_misalignment",
    "stored_energy",
    "strain_energy",
    "viscous_dissipation",
    "friction_dissipation",
    "external_work",
    "energy_balance_defect",
    "max_displacement",
    "max_von_mises",
    "mean_von_mises",
    "stress_norm",
    "point0_x",
    "point0_y",
    "energy_norm",
    "estimate_space",
    "estimate_time",
    "estimate_history",
    "estimate_friction",
    "estimate_algebraic",
    "estimate_initial",
    "estimate_total",
    "time_indicator",
    "velocity_variation",
    "wall_rate",
    "wall_load",
    "wall_contact",
    "wall_balance",
    "wall_estimate",
    "wall_output",
    "wall_total",
]

# VTU may hold single precision
SINGLE = 1e-6


class Slab(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.result = run("slab")

    def test_columns_and_steps(self):
        self.assertEqual(list(self.result.statistics), STATISTICS_2D)
        self.assertClose(self.result["step"], np.arange(33))
        self.assertClose(self.result["t"], np.linspace(0, 2, 33), absolute=1e-14)
        self.assertClose(self.result["k"][1:], 1 / 16, absolute=1e-14)
        self.assertClose(self.result["cells"], 512)
        self.assertClose(self.result["dofs"], 2 * 33 * 17)
        # 2/r of forward Euler, r = mu/eta
        self.assertClose(self.result["step_limit"][1:], 2.6, relative=1e-12)

    def test_forces_are_in_balance_by_their_signs(self):
        """Loads, reactions and minus the friction force act on the body; the
        reaction of the foundation is normal."""
        r = self.result
        total = (
            r.vector("load")
            + r.vector("reaction_2")
            + r.vector("reaction_3")
            - r.vector("friction_force")
        )
        self.assertClose(total, 0, absolute=1e-9)
        push = 0.3 * np.minimum(r["t"], 2 - r["t"])
        self.assertClose(r["load_x"], push, absolute=1e-12)
        self.assertClose(r["reaction_2_x"], 0, absolute=1e-12)

    def test_series_times(self):
        for name in "solution", "contact":
            times = [time for time, _ in self.result.series(name)]
            self.assertClose(times, (0, 0.5, 1, 1.5, 2), absolute=1e-12, what=name)
            for _, record in self.result.series(name):
                self.assertTrue(record.exists(), record)

    def test_solution_fields(self):
        fields = self.result.fields("solution", 2)
        step = self.result.row(1)
        self.assertEqual(set(fields.point_data), {"displacement", "velocity"})
        components = [f"{s}_{c}" for s in ("stress", "irreversible_stress")
                      for c in ("xx", "yy", "zz", "xy")]
        self.assertEqual(set(fields.cell_data), {*components, "von_mises", "subdomain"})
        for data in fields.point_data, fields.cell_data:
            for name, values in data.items():
                self.assertTrue(np.all(np.isfinite(values)), name)
        for values in fields.point_data.values():
            self.assertEqual(values.shape[1], 3)
            self.assertClose(values[:, 2], 0)

        self.assertEqual(len(fields.cells), self.result["cells"][step])
        largest = np.linalg.norm(fields.point_data["displacement"], axis=1).max()
        self.assertClose(
            largest, self.result["max_displacement"][step], relative=SINGLE
        )
        xx, yy, zz, xy = (fields.cell_data[c] for c in components[:4])
        mises = np.sqrt(
            ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2
        )
        self.assertClose(
            fields.cell_data["von_mises"], mises, absolute=SINGLE * mises.max()
        )
        self.assertClose(
            mises.mean(), self.result["mean_von_mises"][step], relative=SINGLE
        )
        self.assertClose(
            mises.max(), self.result["max_von_mises"][step], relative=SINGLE
        )
        norm = np.sqrt(np.mean(xx**2 + yy**2 + zz**2 + 2 * xy**2) * 2)
        self.assertClose(norm, self.result["stress_norm"][step], relative=SINGLE)

        # z is deviatoric for this law
        trace = sum(fields.cell_data[c] for c in components[4:7])
        self.assertClose(trace, 0, absolute=SINGLE * mises.max())

    def test_stress_is_elastic_stress_plus_z(self):
        """sigma = E eps(u) + z with the mean strain of the cell, formed here
        from the displacement at its corners."""
        fields = self.result.fields("solution", 2)
        x = fields.points[fields.cells][:, :, :2]
        u = fields.point_data["displacement"][fields.cells][:, :, :2]
        low, high = x.min(axis=1), x.max(axis=1)
        size = high - low
        sign = np.where(x > (low + high)[:, None, :] / 2, 1, -1)
        gradient = np.einsum("cvi,cvj->cij", u, sign) / 2 / size[:, None, :]
        strain = (gradient + gradient.transpose(0, 2, 1)) / 2
        lame, mu = 0.3 / 1.3 / 0.4, 1 / 2.6
        trace = strain[:, 0, 0] + strain[:, 1, 1]
        elastic = {
            "xx": lame * trace + 2 * mu * strain[:, 0, 0],
            "yy": lame * trace + 2 * mu * strain[:, 1, 1],
            "zz": lame * trace,
            "xy": 2 * mu * strain[:, 0, 1],
        }
        scale = abs(fields.cell_data["stress_xx"]).max()
        for name, value in elastic.items():
            z = fields.cell_data[f"irreversible_stress_{name}"]
            # differences of single-precision displacements over h = 1/16
            self.assertClose(
                fields.cell_data[f"stress_{name}"], value + z, absolute=2e-5 * scale
            )

    def test_contact_fields(self):
        wanted = {
            "traction",
            "bound",
            "utilisation",
            "slip",
            "slip_rate",
            "stick",
            "displacement",
        }
        for index, (time, _) in enumerate(self.result.series("contact")):
            contact = self.result.fields("contact", index)
            step = self.result.row(time)
            self.assertLessEqual(wanted, set(contact.point_data))
            for name, values in contact.point_data.items():
                self.assertTrue(np.all(np.isfinite(values)), name)
            # all of the foundation and nothing else
            self.assertClose(contact.points[:, 1:], 0, absolute=1e-12)
            self.assertEqual(len(contact.cells), 32)
            nodes = contact.nodes()
            nodes = nodes[np.argsort(contact.points[nodes, 0])]
            data = {name: v[nodes] for name, v in contact.point_data.items()}
            weight = np.full(33, 1 / 16)
            weight[[0, -1]] /= 2

            # lumped weights: the sum is the force, opposite to lambda
            force = (weight[:, None] * data["traction"]).sum(axis=0)
            scale = abs(self.result["friction_force_x"]).max()
            self.assertClose(
                force[0],
                -self.result["friction_force_x"][step],
                absolute=SINGLE * scale,
            )
            self.assertClose(data["traction"][:, 1:], 0, absolute=SINGLE * scale)
            self.assertClose(data["bound"], 0.08, absolute=SINGLE)
            size = np.linalg.norm(data["traction"], axis=1)
            self.assertClose(data["utilisation"], size / 0.08, absolute=10 * SINGLE)
            self.assertLessEqual(data["utilisation"].max(), 1 + SINGLE)
            self.assertEqual(set(np.unique(data["stick"])) - {0, 1}, set())
            if step > 0:
                self.assertClose(
                    (weight * data["stick"]).sum(),
                    self.result["stick_area"][step],
                    absolute=SINGLE,
                )
            # a foundation at rest: the slip since the start is the tangential
            # displacement
            self.assertClose(
                data["slip"][:, 0],
                data["displacement"][:, 0],
                absolute=SINGLE * abs(data["displacement"]).max(),
            )
            # friction opposes the rate of slip, which vanishes at stick
            rate = data["slip_rate"][:, 0]
            self.assertTrue(np.all(rate * data["traction"][:, 0] <= 1e-12))
            self.assertClose(rate[data["stick"] > 0.5], 0, absolute=1e-9)

    def test_both_series_agree_on_the_foundation(self):
        solution = self.result.fields("solution", 2)
        contact = self.result.fields("contact", 2)
        bottom = {
            round(float(p[0]), 6): u
            for p, u in zip(solution.points, solution.point_data["displacement"])
            if abs(p[1]) < 1e-9
        }
        for point, u in zip(contact.points, contact.point_data["displacement"]):
            self.assertClose(u, bottom[round(float(point[0]), 6)], absolute=SINGLE)

    def test_run_record(self):
        info = self.result.info
        self.assertLessEqual(
            {
                "program",
                "version",
                "git_revision",
                "dealii_version",
                "n_mpi_ranks",
                "dimension",
                "effects",
                "costs",
                "date",
            },
            set(info),
        )
        costs = info["costs"]
        self.assertGreater(costs["seconds"]["contact"], 0.0)
        self.assertGreater(costs["memory_before_MB"], 10.0)
        self.assertGreater(costs["peak_memory_MB"], costs["memory_before_MB"])
        self.assertEqual(costs["solver"], "direct")
        self.assertEqual(costs["solver_demand"]["dofs"], self.result["dofs"][-1])
        self.assertEqual(info["program"], "viscoplastic_contact")
        self.assertEqual(info["n_mpi_ranks"], 1)
        self.assertEqual(info["dimension"], 2)
        self.assertTrue(info["effects"])

    def test_recorded_parameters_repeat_the_run(self):
        """parameters.prm is complete: running it gives the same numbers."""
        text = (self.result.directory / "parameters.prm").read_text()
        again = run("again", text=text)
        self.assertEqual(list(again.statistics), list(self.result.statistics))
        for name, column in self.result.statistics.items():
            if not name.startswith("wall_"):
                self.assertClose(again[name], column, absolute=0, what=name)


class Choices(TestCase):
    SMALL = {"Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true"}

    def times(self, **more):
        result = run("slab", {**self.SMALL, **more})
        return [time for time, _ in result.series("solution")]

    def test_only_the_ends(self):
        times = self.times(**{"Output/Fields every": 0})
        self.assertClose(times, (0, 2), absolute=1e-12)

    def test_every_five_steps_and_the_last(self):
        times = self.times(**{"Output/Fields every": 5})
        self.assertClose(times, np.r_[np.arange(0, 32, 5), 32] / 16, absolute=1e-12)

    def test_time_interval(self):
        """Every 0.5: the steps of 1/16 meet these times."""
        times = self.times(**{"Output/Fields interval": 0.5})
        self.assertClose(times, (0, 0.5, 1, 1.5, 2), absolute=1e-12)

    def test_several_points(self):
        result = run("slab", {**self.SMALL, "Output/Points": "0, 0; 2, 0.5; 1, 1"})
        for name in "point0", "point1", "point2":
            self.assertIn(f"{name}_x", result.statistics)
        # the third is glued
        self.assertClose(result.vector("point2"), 0, absolute=1e-15)
        self.assertGreater(abs(result["point1_x"]).max(), 0)

    def test_forces_on_two_parts_of_a_plane(self):
        """The node between them counts by halves: all slips, at one bound."""
        bound, scene = 1e-3, {**self.SMALL, "Boundary 2/Friction bound": 1e-3}
        scene["Geometry/Boundary ids"] = "if(id == 2 && x > 0.5, 4, id)"
        scene["Boundary 4/Role"] = "contact"
        scene["Boundary 4/Friction law"] = "tresca"
        scene["Boundary 4/Friction bound"] = bound
        for ranks in 1, 3:
            result = run("slab", scene, ranks)
            (row,) = np.flatnonzero(np.isclose(result["t"], 1))
            self.assertEqual(result["stick_area"][row], 0)
            for boundary, length in ((2, 0.5), (4, 1.5)):
                force = result[f"friction_force_{boundary}_x"][row]
                self.assertClose(force, bound * length, relative=1e-12)
            self.assertGreater(result["max_slip"][row], 0)
            self.assertNotIn("contact_force_2_x", result.statistics)

    def test_nothing_is_left_of_an_earlier_run(self):
        """Outputs that are more, or of more ranks, or of contact, or of lines, go; what
        somebody else has put there stays."""
        with tempfile.TemporaryDirectory() as place:
            scene = {**self.SMALL, "Output/Directory": place}
            lines = "0, 0 : 2, 0 : 3; 0, 1 : 2, 1 : 3; 1, 0 : 1, 1 : 3"

            def files(ranks=1, **more):
                run("slab", {**scene, **more}, ranks)
                return {path.name for path in Path(place).iterdir()}

            before = files(3, **{"Output/Fields every": 1, "Output/Lines": lines})
            self.assertLessEqual({"solution_00032.2.vtu", "line_2.csv"}, before)
            foreign = {"solution_of_mine.vtu", "line_4.csv", "contact_1.pvtu"}
            foreign.add("contact.xdmf")  # the program has none but of the body
            for name in foreign:
                (Path(place) / name).write_text("mine\n")
            # of two bodies, of a body of revolution
            for name in "opposite.pvd", "opposite_00001.0.vtu", "revolved_00000.pvtu":
                (Path(place) / name).write_text("of this program\n")
            after = files(**{"Output/Fields every": 16, "Output/Lines": lines[:15]})
            self.assertLessEqual(foreign, after)
            expected = {"parameters.prm", "run.json", "statistics.csv", "line_0.csv"}
            expected |= {"boundary_00000.0.vtu", "boundary_00000.pvtu"}
            for series in "solution", "contact":
                expected.add(f"{series}.pvd")
                for n in range(3):
                    expected |= {f"{series}_{n:05}.{e}" for e in ("pvtu", "0.vtu")}
            self.assertEqual(after - foreign, expected)
            roles = {f"Boundary {i}/Role": "clamped" for i in range(4)}
            run("square", {"Output/Directory": place, **roles}, text="")
            free = [path.name for path in Path(place).glob("contact*")]
            self.assertEqual(set(free), {"contact.xdmf", "contact_1.pvtu"})

    def test_default_directory_is_named_after_the_scene(self):
        result = run("slab", {**self.SMALL, "Output/Directory": ""})
        directory = result.directory.parent / "output" / "slab"
        self.assertTrue((directory / "statistics.csv").exists())


class ThreeDimensions(TestCase):
    def test_pad_fields(self):
        result = run("pad", {"Geometry/Arguments": "4, 4, 4 : 0, 0, 0 : 1, 1, 1 : true",
                             "Time/Phases": "0.75: 10"})
        fields = result.fields()
        for c in "xx", "yy", "zz", "xy", "xz", "yz":
            self.assertIn(f"stress_{c}", fields.cell_data)
            self.assertIn(f"irreversible_stress_{c}", fields.cell_data)
        self.assertEqual(fields.cells.shape, (64, 8))
        s = fields.cell_data
        mises = np.sqrt(
            (
                (s["stress_xx"] - s["stress_yy"]) ** 2
                + (s["stress_yy"] - s["stress_zz"]) ** 2
                + (s["stress_zz"] - s["stress_xx"]) ** 2
            )
            / 2
            + 3 * (s["stress_xy"] ** 2 + s["stress_xz"] ** 2 + s["stress_yz"] ** 2)
        )
        self.assertClose(s["von_mises"], mises, absolute=SINGLE * mises.max())

        contact = result.fields("contact")
        self.assertEqual(contact.cells.shape, (16, 4))
        self.assertClose(contact.points[:, 2], 0, absolute=1e-12)
        nodes = contact.nodes()
        self.assertEqual(len(nodes), 25)
        x = contact.points[nodes]
        edge = lambda v: np.where((v < 1e-9) | (v > 1 - 1e-9), 0.5, 1)
        weight = edge(x[:, 0]) * edge(x[:, 1]) / 16
        force = (weight[:, None] * contact.point_data["traction"][nodes]).sum(axis=0)
        expected = -result.vector("friction_force")[-1]
        self.assertClose(force, expected, absolute=SINGLE * abs(expected).max())


class Unwritable(TestCase):
    """What cannot be written is named in one sentence, and the run fails: a disk
    without space (/dev/full, or a limit on the size of files), and what is no
    file in the place of a result."""

    SMALL = {
        "Geometry/Arguments": "4, 2 : 0, 0 : 2, 1 : true",
        "Time/Phases": "1: 4, 2: 4",
        "Output/Fields every": 2,
        "Output/Lines": "0, 0 : 2, 0 : 3",
    }

    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.work = Path(place.name)

    def call(self, *arguments, ranks=1, stdout=subprocess.PIPE, limit=None, **overrides):
        (self.work / "small.prm").write_text(as_prm({**self.SMALL, **overrides}))
        command = [PROGRAM if limit is None else EXECUTABLE, *arguments]
        if ranks > 1:
            command = MPIRUN + ["-n", str(ranks)] + command

        def set_limit():
            if limit is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        return subprocess.run(
            command,
            cwd=self.work,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            stdout=stdout,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            preexec_fn=set_limit,
        )

    def fails(self, sentence, *arguments, **more):
        scene = [str(scene_file("slab")), "small.prm"]
        process = self.call(*scene, *arguments, **more)
        self.assertEqual(process.returncode, 1, f"{sentence}: {process.stderr}")
        sentences = [
            line
            for line in process.stderr.splitlines()
            if line.startswith("viscoplastic_contact: ")
        ]
        if more.get("ranks", 1) == 1:
            self.assertEqual(process.stderr.splitlines(), sentences, sentence)
        self.assertEqual(len(sentences), 1, process.stderr)
        self.assertRegex(sentences[0], sentence)
        self.assertLess(len(sentences[0]), 200)

    def test_full_disk(self):
        self.fails("parameters.prm' cannot be written: File too large", limit=3000)
        # A run of many steps: its table outgrows what has been written before.
        many = {"Time/Phases": "2: 200", "Output/Fields every": 0, "Output/Lines": ""}
        self.fails("'.*statistics.csv' failed; is the disk full", limit=60000, **many)

    def test_places_of_results(self):
        for name in (
            "parameters.prm",
            "run.json",
            "statistics.csv",
            "line_0.csv",
            "solution.pvd",
            "contact.pvd",
            "boundary_00000.pvtu",
            "solution_00000.pvtu",
            "contact_00000.0.vtu",
            "solution_00004.0.vtu",
        ):
            with self.subTest(name=name):
                results = self.work / name.replace(".", "_")
                results.mkdir()
                (results / name).symlink_to(self.work / "other")
                self.fails(
                    f"'{results}/{name}' cannot be written: it is a symbolic link",
                    **{"Output/Directory": results},
                )
        self.assertFalse((self.work / "other").exists())

    def test_pipe(self):
        """Nobody reads it: a run that opened it would wait for ever."""
        os.mkfifo(self.work / "statistics.csv")
        self.fails(
            "statistics.csv' cannot be written: it is a pipe",
            **{"Output/Directory": self.work},
        )

    def test_results_of_another_rank(self):
        (self.work / "solution_00001.1.vtu").symlink_to("/dev/full")
        self.fails("solution_00001.1.vtu", ranks=2, **{"Output/Directory": self.work})

    def test_messages(self):
        """The results are complete."""
        self.fails("The log file '/dev/full'.*disk full", "--log", "/dev/full")
        self.assertTrue((self.work / "output/slab/solution_00004.pvtu").exists())
        with open("/dev/full", "w") as full:
            self.fails("the standard output.*disk full", stdout=full)
            process = self.call("--describe", stdout=full)
            self.assertEqual(process.returncode, 1)
            self.assertRegex(process.stderr, "^visco.*the standard output.*full")


class Foreign(TestCase):
    """What somebody else keeps under the names of results."""

    def test_is_not_overwritten(self):
        for name in "parameters.prm", "run.json", "statistics.csv":
            with tempfile.TemporaryDirectory() as place:
                file = Path(place) / name
                file.write_text("mine\n")
                overrides = {"Output/Directory": place}
                result = run("slab", {**Choices.SMALL, **overrides}, check=False)
                self.assertEqual(result.returncode, 1, name)
                self.assertRegex(result.stderr, f"would overwrite '{file}'")
                self.assertEqual([p.name for p in Path(place).iterdir()], [name])
                self.assertEqual(file.read_text(), "mine\n")


if __name__ == "__main__":
    main()
