# SPDX-License-Identifier: LGPL-2.1-or-later
"""Studies of effects: what each simplification changes and costs, and whether
the verdict is the right one."""

import csv
import json
import sys
import tempfile
from pathlib import Path

import numpy as np

from harness import SOURCE, TestCase, main, run_program
from test_study import VERIFICATION, Folder

sys.path.insert(0, str(SOURCE / "contrib"))

from plotting import effects as picture
from plotting.results import read_statistics

SLAB = {
    "Geometry__Arguments": "16, 8 : 0, 0 : 2, 1 : true",
    "Time__Phases": "1: 8, 2: 8",
    "Study__Budget": 100,
}


class Scene(Folder):
    """Its effects, by what is left out and what is instead."""

    def __init__(self, scene, **overrides):
        super().__init__(scene, **overrides)
        self.effects = self.results / "effects"

    def about(self):
        return json.loads((self.effects / "effects.json").read_text())

    def verdicts(self):
        return {
            (effect["effect"], effect["instead"]): effect["verdict"]
            for effect in self.about()["effects"]
        }

    def finished(self):
        return {
            file: file.stat().st_mtime_ns
            for file in self.effects.glob("*/study/*/result.json")
        }


class Effects(TestCase):
    def test_of_the_slab(self):
        with Scene(VERIFICATION / "slab.prm", **SLAB) as scene:
            process = scene.run("effects")
            self.assertEqual(process.returncode, 0, process.stderr)
            verdicts = scene.verdicts()
            for effect in (
                ("viscous flow", "elastic"),
                ("traction on Boundary 0", "none"),
                ("friction on Boundary 2", "none"),
                ("slip on Boundary 2", "never"),
            ):
                self.assertEqual(verdicts.pop(effect), "called for", effect)
            # nu = 0.3, steps of an eighth: all as good as each other
            for effect, verdict in verdicts.items():
                self.assertNotEqual(verdict, "called for", effect)
                self.assertNotEqual(verdict, "cannot be left out", effect)

            about = scene.about()
            self.assertTrue(about["finished"])
            for effect in about["effects"]:
                self.check_changes(scene, effect)
            joint = about["together"]
            names = {effect["effect"]: effect for effect in about["effects"]}
            self.assertIn(" and ", joint["effect"])
            for part in joint["effect"].split(" and "):
                self.assertEqual(names[part]["verdict"], "called for")

            # Most were settled on the coarser mesh, the rest on the scene's.
            levels = {e["effect"]: e["level"] for e in about["effects"]}
            self.assertEqual(levels["traction on Boundary 0"], -1)
            self.assertEqual(levels["error bar"], 0)
            with open(scene.effects / "effects.csv", newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(len(rows), len(about["effects"]))
            text = (scene.effects / "effects.md").read_text()
            self.assertIn("| viscous flow | elastic | called for |", text)

            # The same command does nothing again.
            before = scene.finished()
            self.assertEqual(scene.run("effects").returncode, 0)
            self.assertEqual(scene.finished(), before)
            self.assertEqual(scene.verdicts().keys() - verdicts.keys(), {
                ("viscous flow", "elastic"),
                ("traction on Boundary 0", "none"),
                ("friction on Boundary 2", "none"),
                ("slip on Boundary 2", "never"),
            })

    def check_changes(self, scene, effect):
        """Once more from the tables of both runs."""
        if effect["verdict"] == "never acted":
            return
        name = f"uniform_h{effect['level']}_k{effect['level']}/statistics.csv"
        own = "".join(c if c.isalnum() else "_" for c in effect["effect"])
        instead = "".join(c if c.isalnum() else "_" for c in effect["instead"])
        of_scene = read_statistics(scene.effects / "scene" / "study" / name)
        (file,) = (scene.effects / f"{own}__{instead}" / "study").glob(
            f"uniform*_h{effect['level']}_k{effect['level']}/statistics.csv"
        )
        other = read_statistics(file)
        for column in ("viscous_dissipation", "stored_energy"):
            difference = of_scene[column] - other.get(column, 0.0)
            size = np.abs(of_scene[column]).max()
            found = effect["changes"][column]["change"]
            self.assertClose(found, np.abs(difference).max() / size, 1e-9, 1e-12)

    def test_of_what_never_acts(self):
        with Scene(
            VERIFICATION / "slab.prm",
            **SLAB,
            Boundary_2__Friction_bound="10",
            Material__Law="perzyna",
            Material__perzyna__Yield_radius="100",
        ) as scene:
            alone = scene.run()
            self.assertIn("viscoplastic flow has never acted", alone.stdout)
            self.assertRegex(
                alone.stdout, r"friction has never acted: .* at most \d+\.\d+ % of"
            )
            process = scene.run("effects", ranks=2)
            self.assertEqual(process.returncode, 0, process.stderr)
            verdicts = scene.verdicts()
            self.assertEqual(verdicts["viscous flow", "elastic"], "never acted")
            self.assertEqual(verdicts["slip on Boundary 2", "never"], "never acted")
            self.assertEqual(verdicts["friction on Boundary 2", "none"], "called for")

    def test_what_cannot_be_left_out(self):
        """Steps that only backward Euler can take."""
        with Scene(
            VERIFICATION / "slab.prm",
            **SLAB,
            Material__maxwell__Viscosity=0.01,
            Time__Scheme="backward Euler",
        ) as scene:
            process = scene.run("effects")
            self.assertEqual(process.returncode, 0, process.stderr)
            about = scene.about()
            (failed,) = [
                effect
                for effect in about["effects"]
                if effect["instead"] == "forward Euler"
            ]
            self.assertEqual(failed["verdict"], "cannot be left out")
            self.assertIn("stability limit", failed["failure"])
            figure = picture.draw(about)
            self.assertEqual(
                len(figure.axes[0].get_yticks()),
                sum(not effect["failure"] for effect in about["effects"]),
            )

    def test_to_a_tolerance(self):
        with Scene(
            VERIFICATION / "slab.prm",
            Geometry__Arguments="8, 4 : 0, 0 : 2, 1 : true",
            Error_control__Tolerance=0.05,
            Study__Budget=100,
        ) as scene:
            process = scene.run("effects")
            self.assertEqual(process.returncode, 0, process.stderr)
            verdicts = scene.verdicts()
            self.assertEqual(verdicts["friction on Boundary 2", "none"], "called for")

    def test_refused(self):
        for sentence, arguments in (
            ("no parameter file", ["effects"]),
            ("exclude each other", ["effects", "--check", "a.prm"]),
            ("exclude each other", ["effects", "--price", "0.1", "a.prm"]),
            ("without --restart", ["effects", "--restart", "a.prm"]),
        ):
            with tempfile.TemporaryDirectory() as work:
                process = run_program(arguments, 1, Path(work))
            self.assertEqual(process.returncode, 2, process.stderr)
            self.assertIn(sentence, process.stderr)
        with Scene(
            VERIFICATION / "slab.prm", **SLAB, Step_control__Tolerance=0.01
        ) as scene:
            process = scene.run("effects")
            self.assertEqual(process.returncode, 1)
            self.assertIn("'Step control/Tolerance' = 0", process.stderr)


if __name__ == "__main__":
    main()
