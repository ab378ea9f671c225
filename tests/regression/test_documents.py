# SPDX-License-Identifier: LGPL-2.1-or-later
"""The documents keep pace with the program.

Excerpts of code occur in the files they name, links and named files exist, and
so do the entries of the parameter file that are mentioned.
"""

import ast
import csv
import importlib.machinery
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path

import numpy as np

from harness import PROGRAM, SOURCE, Run, TestCase, main, run

sys.path.insert(0, str(SOURCE / "contrib"))
from results_page import page as accuracy
from results_page import pieces, tables

PAGES = sorted(
    [
        SOURCE / name
        for name in ("README.md", "LICENSES.md", "CHANGELOG.md", "CONTRIBUTING.md")
    ]
    + list((SOURCE / "doc").glob("*.md"))
    + list((SOURCE / "benchmarks").glob("*.md"))
)
# Explains how to add what is not there, and is tested by tests/unit.
EXAMPLE = SOURCE / "doc" / "adding_a_law.md"
FOLDERS = r"(?:source|include|prm|doc|tests|contrib|benchmarks|\.ci)/"
# Files of which the repository holds all that exist.
OWN_FILE = re.compile(rf"{FOLDERS}[\w./-]*\w|[\w-]+\.(?:cc|py)")


def prose_and_blocks(page):
    """The text of a page without fenced blocks, and those as (line, language,
    text)."""
    prose, blocks, block = [], [], None
    for number, line in enumerate(page.read_text().splitlines(), start=1):
        prose.append("")
        if block is not None:
            if line.strip() == "```":
                blocks.append((block[0], block[1], "\n".join(block[2])))
                block = None
            else:
                block[2].append(line)
        elif line.startswith("```"):
            block = (number, line[3:].strip(), [])
        else:
            prose[-1] = line
    return "\n".join(prose), blocks


def squeezed(text):
    return re.sub(r"\s+", "", text)


def anchors(page):
    """What GitHub calls the headings of a page."""
    prose, _ = prose_and_blocks(page)
    result = set()
    for heading in re.findall(r"^#+ (.*)$", prose, re.M):
        name = re.sub(r"[^\w\- ]", "", heading.strip().lower())
        result.add(name.replace(" ", "-"))
    return result


def entries():
    """{section: {entry, ...}} as the program describes them; the numbers of
    numbered sections are left out."""
    text = subprocess.run(
        [PROGRAM, "--describe"], stdout=subprocess.PIPE, text=True, check=True
    ).stdout
    result, path = {}, []
    for line in text.splitlines():
        line = line.strip()
        if line.startswith("subsection "):
            name = line[len("subsection ") :].strip()
            path.append(re.sub(r"^(Boundary|Material) \S+$", r"\1", name))
        elif line == "end":
            path.pop()
        elif line.startswith("set "):
            entry = line[len("set ") :].split("=")[0].strip()
            result.setdefault("/".join(path), set()).add(entry)
    return result


class Documents(unittest.TestCase):
    def test_excerpts_occur_in_the_file_named_last_before_them(self):
        n_excerpts = 0
        for page in PAGES:
            if page == EXAMPLE:
                continue
            prose, blocks = prose_and_blocks(page)
            for line, language, text in blocks:
                if language not in ("cpp", "prm", "geo"):
                    continue
                before = "\n".join(prose.splitlines()[:line])
                names = [
                    name
                    for name in re.findall(r"`([^`\s]+)`", before)
                    if "/" in name and OWN_FILE.fullmatch(name)
                ]
                with self.subTest(page=page.name, line=line):
                    self.assertTrue(names, "no file is named before the excerpt")
                    source = squeezed((SOURCE / names[-1]).read_text())
                    position = 0
                    for part in re.split(r"^\s*(?://|#) \.\.\.$", text, flags=re.M):
                        position = source.find(squeezed(part), position)
                        self.assertGreaterEqual(
                            position, 0, f"not in {names[-1]}:\n{part}"
                        )
                n_excerpts += 1
        self.assertGreater(n_excerpts, 20)

    def test_equations_stand_in_the_lines_that_the_tutorial_names(self):
        text = (SOURCE / "doc" / "tutorial.md").read_text()
        section = text.split("### From the paper to the code", 1)[1]
        rows = re.findall(
            r"^\| (.*?) \| .* \| `([^`]+)` \| `([^`]+)` \|$",
            section.split("\n### ", 1)[0],
            re.M,
        )
        self.assertGreater(len(rows), 10)
        for label, name, code in rows:
            with self.subTest(equation=label, file=name):
                lines = (SOURCE / name).read_text().splitlines()
                found = [
                    number
                    for number in range(len(lines))
                    if squeezed("".join(lines[number : number + 3])).find(
                        squeezed(code)
                    )
                    != -1
                ]
                self.assertTrue(found, f"not in {name}: {code}")
                if label.startswith("("):
                    near = range(found[0] - 12, found[-1] + 3)
                    self.assertTrue(
                        any(
                            label in lines[number]
                            for number in near
                            if 0 <= number < len(lines)
                        ),
                        f"{name} does not name {label} near that line",
                    )

    def test_links_lead_somewhere(self):
        link = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
        n_links = 0
        for page in PAGES:
            prose, _ = prose_and_blocks(page)
            for target in link.findall(re.sub(r"`[^`]*`", "", prose)):
                if re.match(r"[a-z]+:", target):
                    continue
                path, _, anchor = target.partition("#")
                file = (page.parent / path).resolve() if path else page
                with self.subTest(page=page.name, link=target):
                    self.assertTrue(file.exists(), "no such file")
                    if anchor:
                        self.assertIn(anchor, anchors(file))
                n_links += 1
        self.assertGreater(n_links, 50)

    def test_named_files_exist(self):
        basenames = {
            file.name
            for folder in ("source", "include", "prm", "tests", "benchmarks", "doc")
            for file in (SOURCE / folder).rglob("*")
        }
        n_names = 0
        for page in PAGES:
            prose, _ = prose_and_blocks(page)
            for name in re.findall(r"`([^`\s]+)`", prose):
                if not OWN_FILE.fullmatch(name) or page == EXAMPLE:
                    continue
                n_names += 1
                with self.subTest(page=page.name, name=name):
                    if "/" in name:
                        self.assertTrue((SOURCE / name).exists(), "no such file")
                    else:
                        self.assertIn(name, basenames)
        self.assertGreater(n_names, 20)

    def test_entries_exist(self):
        known = entries()
        sections = {section.split("/")[0] for section in known} - {""}
        names = set().union(*known.values())
        n_entries = 0
        for page in PAGES:
            if page == EXAMPLE:
                continue
            prose, blocks = prose_and_blocks(page)
            # `Section/Entry', also with a number, a value, or in quotes
            quoted = re.findall(r"`'?([^`'=]+(?:'s [^`'=]+)?)'?(?: ?=[^`]*)?'?`", prose)
            for name in quoted:
                *path, entry = name.strip().split("/")
                path = [re.sub(r"^(Boundary|Material) \S+$", r"\1", p) for p in path]
                if not path or path[0] not in sections:
                    continue
                n_entries += 1
                with self.subTest(page=page.name, entry=name):
                    self.assertIn(" ".join(entry.split()), known.get("/".join(path), {}))
            # set Entry = value, in blocks and in running text
            for entry in re.findall(
                r"^\s*set +([^=\n]+?) *=", page.read_text(), re.M
            ) + re.findall(r"`set +([^=`]+?) *=", prose):
                n_entries += 1
                with self.subTest(page=page.name, set=entry):
                    self.assertIn(entry, names | {"Name"})
        self.assertGreater(n_entries, 20)


class Approximations(unittest.TestCase):
    """The table of what the program approximates by itself."""

    def test_each_names_its_entry_and_where_its_error_counts(self):
        text = (SOURCE / "doc/error_bar.md").read_text()
        table = text.split("## 4 What the program approximates by itself")[1].split("##")[0]
        rows = [line.split("|")[1:-1] for line in table.splitlines() if line[:1] == "|"][2:]
        self.assertGreater(len(rows), 15)
        known = entries()
        columns = set(re.findall(r"`estimate_(\w+)`", (SOURCE / "doc/results.md").read_text()))
        for what, entry, error in rows:
            with self.subTest(approximation=what.strip()):
                *path, name = entry.strip(" `").split("/")
                path = [re.sub(r"^(Boundary|Material) \S+$", r"\1", p) for p in path]
                self.assertIn(name, known["/".join(path)])
                counted = re.findall(r"`(\w+)`", error)
                self.assertLessEqual(set(counted), columns)
                if not counted:
                    self.assertRegex(error, "none|not counted|data|counted, and")


def rows_of(file):
    with open(file, newline="", encoding="utf-8") as text:
        return list(csv.reader(text))


def tables_of(text):
    """The tables of a page, or a part of one, as lists of rows of cells."""
    found = re.findall(r"(?:^\|.*\|\n)+", text, re.M)
    return [
        [
            [cell.strip() for cell in line.strip("|").split("|")]
            for i, line in enumerate(lines.splitlines())
            if i != 1
        ]
        for lines in found
    ]


class Quoted(TestCase):
    """Numbers of pages that are in a file, too: both say the same."""

    DOC = SOURCE / "doc"

    def test_accuracy(self):
        parts = accuracy.parts_of((self.DOC / "accuracy.md").read_text())
        for piece in tables.SHORTENED:
            with self.subTest(piece=piece):
                rows = pieces.read_rows(self.DOC, piece)
                self.assertIn(tables.shortened(piece, rows), parts[piece])

    def test_effects_of_the_gallery(self):
        path = str(SOURCE / "contrib" / "make_gallery")
        loader = importlib.machinery.SourceFileLoader("make_gallery", path)
        spec = importlib.util.spec_from_loader(loader.name, loader)
        gallery = importlib.util.module_from_spec(spec)
        loader.exec_module(gallery)
        effects = gallery.read_effects()
        parts = re.findall(
            r"<!-- effects (\w+) -->\n(.*?)<!-- end -->",
            (self.DOC / "gallery.md").read_text(),
            re.S,
        )
        self.assertEqual([name for name, _ in parts], list(effects))
        for name, text in parts:
            with self.subTest(scene=name):
                self.assertEqual(text, gallery.effects_in_words(effects[name]) + "\n")

    def test_hard_cases(self):
        _, *rows = rows_of(self.DOC / "hard_cases.csv")
        shown = re.findall(r"^\| `(\w+)` \| ", (self.DOC / "hard_cases.md").read_text(), re.M)
        self.assertGreater(len(shown), 30)
        self.assertEqual(shown, list(dict.fromkeys(case for _, case, *_ in rows)))
        for group, case, figure, value, least, largest in rows:
            with self.subTest(case=case, figure=figure):
                self.assertGreaterEqual(float(value), float(least or "-inf"))
                self.assertLessEqual(float(value), float(largest or "inf"))

    def test_benchmarks(self):
        folder = SOURCE / "benchmarks"
        sections = (folder / "results.md").read_text().split("\n## ")[1:]
        self.assertEqual(len(sections), len(list((folder / "results").glob("*.csv"))))
        for section in sections:
            name = section.splitlines()[0].lower()
            rows = rows_of(folder / "results" / f"{name}.csv")
            (shown,) = tables_of(section)
            self.assertEqual(shown[0], rows[0])
            self.assertEqual(len(shown), len(rows))
            for cells, values in zip(shown[1:], rows[1:]):
                for column, cell, value in zip(rows[0], cells, values):
                    with self.subTest(table=name, row=cells[0], column=column):
                        if cell == "-":
                            self.assertEqual(value, "nan")
                        elif value != cell:
                            self.assertClose(float(cell), float(value), relative=5.1e-3)


class Readme(TestCase):
    def test_its_scene_keeps_its_tolerance(self):
        _, blocks = prose_and_blocks(SOURCE / "README.md")
        scene, console = (text for _, _, text in blocks)
        result = run("block", text=scene)
        kept = "The tolerance of 5 % has been kept."
        self.assertIn(kept, result.stdout)
        self.assertIn(kept, console)
        force = re.search(r"friction force +([0-9.]+);", console)[1]
        self.assertClose(
            result["friction_force_x"][-1], float(force), relative=1e-3, what="README"
        )
        # Its lines are those of today, numbers and places aside.
        lines = {line[:26] for line in result.stdout.splitlines()}
        for line in console.split("This scene paid")[0].strip().splitlines():
            if line.strip() != "...":
                self.assertIn(line[:26], lines)


class Columns(unittest.TestCase):
    def test_each_is_in_the_table_of_results(self):
        rows = (SOURCE / "source/results/statistics_row.cc").read_text()
        table = (SOURCE / "doc/results.md").read_text().split("## statistics.csv")[1]
        known = set(re.findall(r"`_?(\w+?)(?:_x)?`", table.split("\n## ")[0]))
        names = re.findall(r'(?:row\.add(?:_vector)?|add_\w+)\(\s*"(\w+)",', rows)
        self.assertGreater(len(names), 50)
        self.assertEqual(set(names) - known, set())


class Registration(unittest.TestCase):
    def test_every_test_is_an_entry_of_ctest(self):
        """By its class or, if entries have single ones of that, by its name."""
        folder = SOURCE / "tests" / "regression"
        entries = re.sub(
            r"foreach\(group\s([^)]*)\)(.*?)endforeach",
            lambda loop: "".join(loop[2].replace("${group}", g) for g in loop[1].split()),
            (folder / "CMakeLists.txt").read_text(),
            flags=re.DOTALL,
        )
        listed = set(re.findall(r"\btest_\w+(?:\.\w+)+", entries))
        missing = [
            name
            for file in sorted(folder.glob("test_*.py"))
            for node in ast.parse(file.read_text()).body
            if isinstance(node, ast.ClassDef)
            and f"{file.stem}.{node.name}" not in listed
            for part in node.body
            if getattr(part, "name", "").startswith("test_")
            and (name := f"{file.stem}.{node.name}.{part.name}") not in listed
        ]
        self.assertEqual(missing, [])

    def test_every_file_of_hard_cases_is_an_entry_of_ctest(self):
        folder = SOURCE / "tests" / "hard"
        files = {
            file.stem for file in folder.glob("*.py") if "\n@case" in file.read_text()
        }
        listed = re.search(
            r"foreach\(file ([^)]*)\)", (folder / "CMakeLists.txt").read_text()
        )[1].split()
        self.assertEqual(files, {*listed})


class OwnScene(TestCase):
    """doc/own_scene.md: what it lets the reader do, and what it says comes
    out."""

    FOLDER = SOURCE / "doc" / "own_scene"
    PAGE = SOURCE / "doc" / "own_scene.md"

    def program(self, *arguments):
        """Run in a directory that holds the files of the page."""
        return subprocess.run(
            [PROGRAM, *arguments],
            cwd=self.work,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
        )

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="own_scene_")
        self.addCleanup(folder.cleanup)
        self.work = Path(folder.name)
        for file in self.FOLDER.iterdir():
            shutil.copy(file, self.work)

    def block_after(self, text):
        """What stands indented after this text, without the indentation."""
        page = self.PAGE.read_text()
        self.assertEqual(page.count(text), 1, text)
        block = re.search(r"(?:^    .*\n)+", page[page.index(text) :], re.M)
        return textwrap.dedent(block[0])

    def test_scene_is_made_of_the_excerpts(self):
        prose, blocks = prose_and_blocks(self.PAGE)
        # The second scene is a demo, of which the page shows parts.
        end = prose[: prose.index("\n## 12 ")].count("\n") + 1
        quoted = [
            squeezed(text)
            for line, language, text in blocks
            if language == "prm" and line < end
        ]
        scene = (self.FOLDER / "foot.prm").read_text()
        scene = squeezed(re.sub(r"^#.*$", "", scene, flags=re.M))
        for text in quoted:
            self.assertEqual(scene.count(text), 1, text)
            scene = scene.replace(text, "")
        self.assertEqual(scene, "", "not in the page")

    def test_check_prints_what_the_page_shows(self):
        shown = self.block_after("The finished mesh and scene give")
        command, *lines = shown.splitlines()
        self.assertEqual(command, "$ viscoplastic_contact --check foot.prm")
        process = self.program(*command.split()[2:])
        self.assertEqual(process.returncode, 0, process.stderr)
        printed = process.stdout.splitlines()
        for line in lines:
            if not line.startswith("Memory"):
                self.assertIn(line, printed)

    def test_forgotten_role_is_refused_as_the_page_shows(self):
        scene = (self.FOLDER / "foot.prm").read_text()
        sides = re.compile(r"^subsection Boundary 4\n.*?^end\n", re.M | re.S)
        without, n = sides.subn("", scene)
        self.assertEqual(n, 1)
        (self.work / "foot.prm").write_text(without)
        process = self.program("--check", "foot.prm")
        self.assertEqual(process.returncode, 1)
        shown = self.block_after("says so:")
        self.assertIn(squeezed(shown), squeezed(process.stderr))

    def test_run_gives_what_the_page_says(self):
        process = self.program("foot.prm")
        self.assertEqual(process.returncode, 0, process.stderr)
        result = Run(self.work / "output" / "foot", process)
        weight = result["t"] >= 1
        self.assertClose(result["contact_force_y"][weight], -24, relative=1e-6)
        force = result["friction_force_x"]
        self.assertClose(abs(force).max(), 7.2, relative=1e-6)
        # iterations stop at 1e-5 in the energy norm
        self.assertClose(result["reaction_3_x"], force, absolute=1e-4 * 7.2)
        # the summary, digit by digit
        shown = self.block_after("ends with a summary")
        summary = dict(re.findall(r"^ *(.*?)  +(.*)$", shown, re.M))
        self.assertGreater(len(summary), 5)
        for name, value in summary.items():
            with self.subTest(name=name):
                self.assertRegex(result.stdout, rf"{name} +{re.escape(value)}\n")
        # the row of the table, the loop, and the end that lifts off
        page = self.PAGE.read_text()
        row = re.search(r"^\| 1 \| 240 \| (.*) \|$", page, re.M)[1].split(" | ")
        last = [
            result["friction_dissipation"][-1],
            result["viscous_dissipation"][-1],
            force[-1],
            result["max_von_mises"].max(),
        ]
        for value, text in zip(last, row):
            digits = len(text.partition(".")[2])
            self.assertClose(value, float(text), absolute=0.6 * 10**-digits)
        cycle = slice(result.row(21), result.row(31) + 1)
        friction = result["friction_dissipation"][cycle]
        self.assertClose(friction[-1] - friction[0], 5.33, absolute=0.006)
        bolt = 0.4 * np.sin(2 * np.pi * (result["t"][cycle] - 1) / 10)
        work = np.trapz(result["reaction_3_x"][cycle], bolt)
        self.assertClose(work, 5.5, absolute=0.006)
        self.assertClose(120 - result["contact_area"][weight].min(), 9, absolute=0.5)
        self.assertClose(result["max_gap"].max(), 0.027, absolute=5e-4)
        self.assertClose(result["max_pressure"].max(), 0.47, absolute=0.005)

    def test_variant_of_two_files(self):
        (self.work / "stiff.prm").write_text(self.block_after("`stiff.prm`:"))
        process = self.program(
            "foot.prm", "stiff.prm", "--quiet", "--set", "Output/Directory=stiff"
        )
        self.assertEqual(process.returncode, 0, process.stderr)
        record = (self.work / "stiff" / "parameters.prm").read_text()
        self.assertRegex(record, r"set Young's modulus *= 40 MPa")


if __name__ == "__main__":
    main()
