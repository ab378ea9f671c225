# SPDX-License-Identifier: LGPL-2.1-or-later
"""What `cmake --install` copies works without the source tree: program, package
files, law library, scripts, manual page, completion."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import law_example
from harness import EXECUTABLE, SOURCE, TestCase, main

BUILD = Path(EXECUTABLE).parent


def version_of_project():
    text = (SOURCE / "CMakeLists.txt").read_text()
    return re.search(r"^project\(\w+ .* VERSION ([\d.]+)\)", text, re.M).group(1)


class Version(TestCase):
    def test_comes_from_one_place(self):
        version = version_of_project()
        said = subprocess.run(
            [EXECUTABLE, "--version"], stdout=subprocess.PIPE, text=True
        ).stdout
        self.assertTrue(said.startswith(f"viscoplastic_contact {version} "), said)
        changes = (SOURCE / "CHANGELOG.md").read_text()
        newest = re.search(r"^## ([\d.]+)", changes, re.M).group(1)
        self.assertEqual(newest, version)


class Installation(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = Path(tempfile.mkdtemp(prefix="installation_"))
        cls.addClassCleanup(shutil.rmtree, cls.work, ignore_errors=True)
        first = cls.work / "first"
        # The targets are there, or this would not run.
        subprocess.run(
            ["cmake", "--install", BUILD, "--prefix", first],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        # Wherever it was installed, it may be moved.
        cls.prefix = first.rename(cls.work / "moved")
        cls.share = cls.prefix / "share" / "viscoplastic_contact"
        cls.program = cls.prefix / "bin" / "viscoplastic_contact"

    def call(self, *command, code=0, cwd=None, **variables):
        process = subprocess.run(
            list(map(str, command)),
            cwd=cwd or self.work,
            env={**os.environ, "OMP_NUM_THREADS": "1", **variables},
            capture_output=True,
            text=True,
        )
        self.assertEqual(process.returncode, code, process.stdout + process.stderr)
        return process.stdout

    def test_texts_name_what_is_installed(self):
        self.assertIn(str(self.share / "doc" / "index.md"), self.help())
        guide = subprocess.run(
            [self.program], cwd=SOURCE, capture_output=True, text=True
        ).stderr
        self.assertIn(str(self.share / "prm/demos/salt_pillar_2d.prm"), guide)

    def help(self):
        return self.call(self.program, "--help", cwd=SOURCE)

    def test_law_of_the_manual_is_found_by_find_package(self):
        project = self.work / "law"
        project.mkdir()
        law_example.write_project(project)
        library = law_example.build(project, f"-DCMAKE_PREFIX_PATH={self.prefix}")
        with open(project / "build" / "CMakeCache.txt") as cache:
            self.assertIn(str(self.prefix), cache.read())
        text = self.call(
            self.program,
            "--describe",
            SOURCE / "prm" / "verification" / "slab.prm",
            "--set",
            f"Additional shared libraries={library}",
        )
        self.assertIn("subsection garofalo", text)
        # nothing of the source tree
        self.call("cmake", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", project / "build")
        commands = (project / "build" / "compile_commands.json").read_text()
        self.assertIn(str(self.prefix / "include"), commands)
        self.assertNotIn(str(SOURCE / "include"), commands)

    def test_package_has_the_version(self):
        project = self.work / "version"
        project.mkdir()
        major, minor, _ = version_of_project().split(".")
        for wanted, code in ((f"{major}.{minor}", 0), (f"{major}.{int(minor) + 1}", 1)):
            (project / "CMakeLists.txt").write_text(
                "cmake_minimum_required(VERSION 3.13.4)\n"
                "project(version LANGUAGES CXX)\n"
                f"find_package(viscoplastic_contact {wanted} REQUIRED)\n"
                'message(STATUS "found ${viscoplastic_contact_EXECUTABLE}")\n'
            )
            text = self.call(
                "cmake",
                "-S",
                project,
                "-B",
                project / wanted,
                f"-DCMAKE_PREFIX_PATH={self.prefix}",
                code=code,
            )
            if code == 0:
                self.assertIn(f"found {self.program}", text)

    def test_mesh_files_of_others_are_converted(self):
        """By the script that was installed."""
        script = self.share / "contrib" / "convert_mesh"
        self.assertIn("convert_mesh", self.call(sys.executable, script, "--help"))

    def test_reports_are_made_by_what_was_installed(self):
        contrib = self.share / "contrib"
        (self.work / "study").mkdir()
        (self.work / "study" / "study.md").write_text("# Study\n")
        page = self.call(sys.executable, contrib / "report", self.work / "study").strip()
        self.assertIn("<h2>Study</h2>", Path(page).read_text())
        for name in ("viewer.js", "curves.js", "page.css", "vtk/vtk.min.js"):
            self.assertTrue((contrib / "reporting" / name).exists(), name)
        self.assertFalse((contrib / "reporting" / "vtk" / "node_modules").exists())

    def test_python_module_runs_the_installed_program(self):
        text = self.call(
            sys.executable,
            "-c",
            "import viscoplastic_contact as v; print(v.Program().executable)",
            PYTHONPATH=str(self.share / "contrib" / "python"),
            VISCOPLASTIC_CONTACT="",
            PYTHONDONTWRITEBYTECODE="1",
        )
        self.assertEqual(text.strip(), str(self.program.resolve()))

    def test_installed_commands_make_studies(self):
        """With the program beside them: nothing is built."""
        contrib = self.share / "contrib"
        self.assertIn("contrib/price", self.call(contrib / "effects", "-h"))
        text = self.call(
            contrib / "price",
            "0.4",
            SOURCE / "prm" / "verification" / "manufactured" / "tresca_2d.prm",
            "--check",
            "--set=Geometry/Global refinements=0",
            "--set=Time/Phases=1: 2",
            f"--set=Output/Directory={self.work / 'price'}",
            VISCOPLASTIC_CONTACT="",
            PYTHONDONTWRITEBYTECODE="1",
        )
        self.assertIn("Error 0.4: h = ", text)

    def test_manual_page_has_all_options(self):
        page = self.prefix / "share" / "man" / "man1" / "viscoplastic_contact.1"
        text = page.read_text()
        for option in re.findall(r"^  (?:-h, )?(--[a-z]+)", self.help(), re.M):
            self.assertIn(option.replace("-", "\\-"), text)
        self.assertIn(version_of_project(), text)
        if not shutil.which("groff"):
            self.skipTest("there is no groff to format the page")
        process = subprocess.run(
            ["groff", "-man", "-Tascii", "-P-cbou", "-ww", page], capture_output=True, text=True
        )
        self.assertEqual(process.stderr, "")
        for part in ("NAME", "SYNOPSIS", "OPTIONS", "--set", "Exit codes"):
            self.assertIn(part, process.stdout)

    def complete(self, *words):
        """What bash offers for the last word."""
        script = (
            'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); '
            'COMP_LINE="$*"; COMP_POINT=${#COMP_LINE}; compopt() { :; }; '
            '_viscoplastic_contact; printf "%s\\n" "${COMPREPLY[@]}"'
        )
        completion = (
            self.prefix / "share/bash-completion/completions/viscoplastic_contact"
        )
        return self.call(
            "bash",
            "-c",
            script,
            "bash",
            completion,
            self.program,
            *words,
            cwd=SOURCE / "prm" / "verification",
        ).splitlines()

    def test_completion(self):
        self.assertIn("slab.prm", self.complete("sl"))
        self.assertIn("--restart=auto", self.complete("--re"))
        self.assertEqual(self.complete("--che"), ["--check", "--check=json"])
        self.assertEqual(
            self.complete("slab.prm", "--set", "Time/Ph"), ["Time/Phases="]
        )
        self.assertEqual(
            self.complete("--set", "Step\\ control/Tol"), ["Step\\ control/Tolerance="]
        )
        self.assertIn(
            "Material/maxwell/Viscosity=", self.complete("--set", "'Material/maxwell/")
        )
        # of the scene, whose boundaries have numbers
        self.assertIn(
            "Boundary\\ 2/Friction\\ bound=",
            self.complete("slab.prm", "--set", "Boundary\\ 2/"),
        )


if __name__ == "__main__":
    main()
