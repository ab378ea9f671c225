# SPDX-License-Identifier: LGPL-2.1-or-later
"""Laws from shared libraries: the example of the manual is built outside of the
source tree and held to the law `parsed`, which takes the same formula from the
parameter file; libraries that are refused."""

import json
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import law_example
from harness import EXECUTABLE, TestCase, main, run, run_program

# Where the package files of the build are.
PACKAGE = Path(EXECUTABLE).parent

GAROFALO = {
    "Material/Law": "garofalo",
    "Material/garofalo/Rate factor": "0.02*(1 + x)",
    "Material/garofalo/Stress scale": 0.1,
    "Material/garofalo/Stress cap": 10,
}
PARSED = {
    "Material/Law": "parsed",
    "Material/parsed/Strain rate": "0.02*sinh(sigma_eq/0.1)",
    "Material/parsed/Factor": "1 + x",
}


class Libraries(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = Path(tempfile.mkdtemp(prefix="law_library_"))
        cls.addClassCleanup(shutil.rmtree, cls.work, ignore_errors=True)

    def compile(self, name, text):
        """A library that does not know the program."""
        path = self.work / name
        subprocess.run(
            ["c++", "-shared", "-fPIC", "-x", "c++", "-", "-o", path],
            input=text,
            text=True,
            check=True,
        )
        return path

    def refused(self, libraries, *words):
        result = run(
            "slab", {"Additional shared libraries": libraries}, check=False
        )
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1, result.stderr)
        for word in words:
            self.assertIn(word, result.stderr)


class Example(Libraries):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        law_example.write_project(cls.work)
        cls.library = law_example.build(
            cls.work, f"-Dviscoplastic_contact_DIR={PACKAGE}"
        )
        cls.law = {"Additional shared libraries": cls.library, **GAROFALO}

    def assertSameRuns(self, one, other, relative):
        # Only one of them has a cap.
        columns = one.statistics.keys() - {"capped_volume"}
        self.assertEqual(columns, set(other.statistics))
        for name in ("stored_energy", "viscous_dissipation", "friction_force_x"):
            scale = abs(other[name]).max()
            self.assertGreater(scale, 0, name)
            self.assertClose(one[name], other[name], absolute=relative * scale, what=name)

    def test_is_the_formula_in_the_plane_on_adaptive_meshes_and_ranks(self):
        formula = run("slab_adaptive", PARSED)
        self.assertGreater(formula["viscous_dissipation"][-1], 1e-3)
        for ranks in (1, 2, 3):
            with self.subTest(ranks=ranks):
                law = run("slab_adaptive", self.law, ranks=ranks)
                self.assertSameRuns(law, formula, 1e-7)
        self.check_identities(law)
        self.assertEqual(law["capped_volume"].max(), 0)

    def test_is_the_formula_in_three_dimensions(self):
        short = {"Time/Phases": "0.5: 4", "Time/Stiffness policy": "backward Euler"}
        self.assertSameRuns(
            run("pad_adaptive", {**short, **self.law}),
            run("pad_adaptive", {**short, **PARSED}),
            1e-5,
        )

    def test_scene_of_the_page_runs_beside_its_library(self):
        """Relative to the parameter file, from anywhere; results name the
        library, and their parameter file is complete."""
        scene = self.work / "scene.prm"
        scene.write_text(
            law_example.scene_block()
            + "".join(
                f"subsection Boundary {i}\n  set Role = {role}\nend\n"
                for i, role in enumerate(["clamped", "traction", "free", "free"])
            )
            + "subsection Boundary 1\n  set Traction = 1e-3*t; 0\nend\n"
            + "subsection Time\n  set Phases = 1: 2\nend\n"
        )
        there = self.work / "elsewhere"
        there.mkdir()
        process = run_program([scene], 1, there)
        self.assertEqual(process.returncode, 0, process.stderr)
        results = there / "output" / "scene"
        record = (results / "parameters.prm").read_text()
        self.assertIn(f"set Additional shared libraries = {self.library}", record)
        info = json.loads((results / "run.json").read_text())
        self.assertEqual(info["shared_libraries"], [str(self.library)])
        again = run_program([results / "parameters.prm"], 1, there)
        self.assertEqual(again.returncode, 0, again.stderr)

        described = subprocess.run(
            [EXECUTABLE, "--describe", scene], stdout=subprocess.PIPE, text=True
        ).stdout
        self.assertIn("set Stress scale = 4e6", described)
        self.assertIn("Garofalo, Fundamentals", re.sub(r"\s+#\s+", " ", described))
        (there / "described.prm").write_text(described)
        again = run_program(["--check", there / "described.prm"], 1, there)
        self.assertEqual(again.returncode, 0, again.stderr)
        manual = subprocess.run(
            [EXECUTABLE, "--describe=markdown", scene],
            stdout=subprocess.PIPE,
            text=True,
        ).stdout
        self.assertIn("## Material/garofalo", manual)

    def test_restart_goes_on_with_the_law(self):
        changes = {**self.law, "Checkpoint/Every n steps": 8}
        whole = run("slab", changes)
        part = run("slab", {**changes, "Time/Phases": "1: 16"})
        process = run_program(
            [
                "--restart",
                part.directory.parent / "slab.prm",
                part.directory.parent / "overrides.prm",
                "--set",
                "Time/Phases=1: 16, 2: 16",
            ],
            1,
            part.directory.parent,
        )
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertClose(part["stored_energy"], whole["stored_energy"])

    def test_scenes_without_it_do_not_know_the_law(self):
        result = run("slab", GAROFALO, check=False)
        self.assertEqual(result.returncode, 1)
        self.assertIn("garofalo", result.stderr)

    def test_twice_the_same_law(self):
        self.refused(
            f"{self.library}, {self.library}", "'garofalo', which another law has"
        )


class Refused(Libraries):
    def test_missing(self):
        self.refused(
            "nowhere.so",
            "overrides.prm', line ",
            "'Additional shared libraries' is 'nowhere.so', but there is no such file",
        )
        self.refused("a.so,,b.so", "Additional shared libraries")

    def test_no_library(self):
        text = self.work / "text.so"
        text.write_text("no library\n" * 100)
        self.refused(text, "cannot be loaded", "invalid ELF header")

    def test_missing_symbol(self):
        path = self.compile(
            "unresolved.so", "void nowhere(); void f() { nowhere(); }"
        )
        self.refused(path, "undefined symbol", "built for this version")

    def test_library_without_laws(self):
        path = self.compile("other.so", "int f() { return 1; }")
        self.refused(path, "has no laws", "VISCOPLASTIC_LAW_LIBRARY is missing")

    def test_another_version(self):
        path = self.compile(
            "old.so",
            'extern "C" const char *viscoplastic_contact_law_interface()'
            ' { return "0.0.1-12345678"; }'
            'extern "C" void viscoplastic_contact_describe_laws() {}',
        )
        self.refused(path, "version 0.0.1-12345678", "build it again")


if __name__ == "__main__":
    main()
