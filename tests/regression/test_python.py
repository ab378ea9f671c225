# SPDX-License-Identifier: LGPL-2.1-or-later
"""The Python module of contrib/python: scenes from dictionaries, runs and
refusals, results against what general readers find in the same files."""

import os
import re
import shutil
import sys
import tempfile
import types
from pathlib import Path
from unittest import mock

import numpy as np

from harness import MPIRUN, PROGRAM, SOURCE, Run, TestCase, main

sys.path.insert(0, str(SOURCE / "contrib" / "python"))

from viscoplastic_contact import (
    NotAvailable,
    Program,
    Results,
    RunError,
    UserError,
    read_parameters,
    scene_text,
    write_scene,
)

PAGE = SOURCE / "doc" / "python.md"


def page_scene():
    """The scene of the page."""
    block = re.search(r"^scene = (\{.*?^\})", PAGE.read_text(), re.M | re.S)
    return eval(block.group(1))


SHORT = {"Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true", "Time/Phases": "1: 4"}


class Scenes(TestCase):
    def test_dictionary_is_what_a_file_says(self):
        scene = {
            "Dimension": 2,
            "Geometry": {"Translation": (0.5, 1e-3), "Arguments": [8, 8]},
            "Material": {
                7: {"Young's modulus": np.float64(2), "norton": {"Exponent": 3}}
            },
            "Initial state": {"Equilibrate": True},
        }
        with tempfile.TemporaryDirectory() as directory:
            entries = read_parameters(write_scene(scene, f"{directory}/scene.prm"))
        self.assertEqual(
            entries,
            {
                ("Dimension",): "2",
                ("Geometry", "Translation"): "0.5; 0.001",
                ("Geometry", "Arguments"): "8, 8",
                ("Material 7", "Young's modulus"): "2.0",
                ("Material 7", "norton", "Exponent"): "3",
                ("Initial state", "Equilibrate"): "true",
            },
        )

    def test_values_that_would_be_something_else_are_refused(self):
        for value in ("a # b", "a\nb", "a\\"):
            with self.assertRaisesRegex(UserError, "'Loads/Body force' is"):
                scene_text({"Loads": {"Body force": value}})


class Runs(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = Path(tempfile.mkdtemp(prefix="python_"))
        cls.addClassCleanup(shutil.rmtree, cls.work, ignore_errors=True)
        cls.program = Program(PROGRAM, launcher=MPIRUN)
        cls.results = cls.program.run(page_scene(), cls.work / "block", overrides=SHORT)
        cls.read = Run(
            cls.results.directory, types.SimpleNamespace(returncode=0, stdout="", stderr="")
        )

    def test_columns(self):
        self.assertEqual(len(self.results["t"]), 5)
        self.assertGreater(self.results["friction_force_x"].max(), 0.01)
        for name, column in self.read.statistics.items():
            np.testing.assert_array_equal(self.results[name], column)
        np.testing.assert_array_equal(
            self.results.vector("point0"), self.read.vector("point0")
        )
        with self.assertRaisesRegex(UserError, 'no column "friction"; it has step, t'):
            self.results["friction"]

    def test_names_of_places(self):
        np.testing.assert_array_equal(
            self.results.vector("displacement of corner"), self.results.vector("point0")
        )
        self.assertIn("displacement_x of corner", self.results)
        self.assertEqual(self.results.names["boundary 2"], "floor")
        np.testing.assert_array_equal(
            self.results["friction_force_x of floor"], self.results["friction_force_x"]
        )
        with self.assertRaisesRegex(UserError, "places are floor, corner"):
            self.results["displacement_x of edge"]

    def test_fields(self):
        body, fields = self.results.body(), self.read.fields()
        np.testing.assert_array_equal(body.points, fields.points)
        np.testing.assert_array_equal(
            body["displacement"], fields.point_data["displacement"]
        )
        self.assertEqual(len(self.results.body(0).cells), 32)
        self.assertIn("slip", " ".join(self.results.face(-1).data))
        self.assertEqual(self.results.index(time=0.3), 1)

    def test_lines(self):
        """Those of the scene, not those that an earlier run has left there."""
        self.assertEqual(self.results.lines(), [])
        with self.assertRaisesRegex(UserError, "has 0 lines"):
            self.results.line()
        for lines in "0, 0 : 1, 0 : 3; 0, 0 : 0, 1 : 4", "0, 0 : 1, 0 : 3":
            results = self.program.run(
                page_scene(),
                self.work / "lines",
                overrides={**SHORT, "Output/Lines": lines, "Output/Line fields": "stress"},
            )
            self.assertEqual(len(results.lines()), lines.count(";") + 1)
        line = results.line()
        np.testing.assert_allclose(line["s"][-3:], [0, 0.5, 1])
        self.assertEqual(len(line["stress_xy"]), 3 * len(results.solution))
        named = {**SHORT, "Output/Lines": "side = 0, 0 : 0, 1 : 4; floor line = 0, 0 : 1, 0 : 3"}
        results = self.program.run(page_scene(), self.work / "lines", overrides=named)
        np.testing.assert_allclose(results.line("floor line")["s"][-3:], [0, 0.5, 1])
        with self.assertRaisesRegex(UserError, "name corner"):
            results.line("corner")

    def test_record(self):
        self.assertEqual(
            self.results.parameters["Material", "maxwell", "Viscosity"], "0.5"
        )
        self.assertEqual(self.results.info, self.read.info)

    def test_ranks_and_files(self):
        """A file, another one over it, and two ranks."""
        scene = write_scene(page_scene(), self.work / "file.prm")
        more = write_scene({"Time": {"Phases": "1: 2"}}, self.work / "more.prm")
        results = Program(PROGRAM, ranks=2, launcher=MPIRUN).run(
            [scene, more],
            self.work / "ranks",
            overrides={"Geometry/Arguments": SHORT["Geometry/Arguments"]},
            log=self.work / "log",
        )
        self.assertEqual(results.info["n_mpi_ranks"], 2)
        self.assertEqual(len(results["t"]), 3)
        self.assertIn("Results in", (self.work / "log").read_text())
        self.assertClose(
            results["stored_energy"][-1], self.results["stored_energy"][-1], relative=0.2
        )

    def test_restart_begins_where_there_is_no_checkpoint(self):
        overrides = {**SHORT, "Checkpoint/Every n steps": 2}
        scene, directory = page_scene(), self.work / "restarted"
        self.program.run(scene, directory, {**overrides, "Time/Phases": "1: 4"}, True)
        longer = {**overrides, "Time/Phases": "1: 4, 2: 4"}
        results = self.program.run(scene, directory, longer, restart=True)
        self.assertEqual(results["step"].tolist(), list(range(9)))

    def test_refusals_are_the_sentences_of_the_program(self):
        with self.assertRaises(RunError) as caught:
            self.program.run(
                page_scene(), self.work / "typo", {"Material/Law": "maxwel"}
            )
        self.assertEqual(caught.exception.code, 1)
        self.assertRegex(
            str(caught.exception), r"^--set 'Material/Law=maxwel': .*'maxwell'\?$"
        )
        with self.assertRaisesRegex(RunError, "no subsection 'Tyme'; did"):
            self.program.check({"Tyme": {"Phases": 1}})

    def test_check_computes_nothing(self):
        before = sorted(Path.cwd().iterdir())
        text = self.program.check(page_scene(), SHORT)
        self.assertIn("32 cells", text)
        self.assertEqual(sorted(Path.cwd().iterdir()), before)

    def test_study(self):
        overrides = {**SHORT, "Study/Levels": 3, "Study/Ladders": "space"}
        # no meshes of a million unknowns are timed for the price of small errors
        overrides["Study/Target errors"] = "0.3"
        study = self.program.study(page_scene(), self.work / "study", overrides)
        self.assertGreaterEqual(len(study["h"]), 2)
        self.assertTrue(study.about["fits"])

    def test_pandas_where_it_is_installed(self):
        made = mock.Mock()
        with mock.patch.dict(sys.modules, {"pandas": made}):
            self.results.frame()
        (columns,) = made.DataFrame.call_args.args
        np.testing.assert_array_equal(columns["t"], self.results["t"])
        with mock.patch.dict(sys.modules, {"pandas": None}):
            with self.assertRaisesRegex(UserError, "pandas is not installed"):
                self.results.frame()

    def test_what_is_not_there(self):
        with self.assertRaisesRegex(UserError, "there is no directory"):
            Results(self.work / "nowhere")
        bare = self.work / "bare"
        bare.mkdir()
        shutil.copy(self.results.directory / "statistics.csv", bare)
        with self.assertRaisesRegex(NotAvailable, "no solution.pvd"):
            Results(bare).body()


class Notebook(TestCase):
    def test_gives_what_it_shows(self):
        """Executed anew, it prints the same numbers and draws."""
        try:
            import nbformat
            from nbclient import NotebookClient
        except ImportError:
            self.skipTest("there is no nbclient")
        shown = nbformat.read(SOURCE / "doc" / "sweep.ipynb", 4)
        notebook = nbformat.read(SOURCE / "doc" / "sweep.ipynb", 4)
        environment = {
            "VISCOPLASTIC_CONTACT": PROGRAM,
            "PYTHONPATH": str(SOURCE / "contrib" / "python"),
            "PYTHONDONTWRITEBYTECODE": "1",
        }
        with tempfile.TemporaryDirectory() as directory:
            resources = {"metadata": {"path": directory}}
            with mock.patch.dict(os.environ, environment):
                NotebookClient(notebook, timeout=120, resources=resources).execute()

        def printed(book):
            outputs = [o for cell in book.cells for o in cell.get("outputs", ())]
            (text,) = (output["text"] for output in outputs if "text" in output)
            (picture,) = (o for o in outputs if "image/png" in o.get("data", {}))
            return np.array([line.split() for line in text.splitlines()[1:]], float)

        found, expected = printed(notebook), printed(shown)
        self.assertEqual(expected.shape, (10, 4))
        # by digits that are printed
        self.assertClose(found, expected, relative=1e-3, absolute=0.0015)


if __name__ == "__main__":
    main()
