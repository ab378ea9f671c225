# SPDX-License-Identifier: LGPL-2.1-or-later
"""The documents keep pace with the program.

Excerpts of code occur in the files they name, links and named files exist, and
so do the entries of the parameter file that are mentioned.
"""

import re
import subprocess
import unittest
from pathlib import Path

from harness import EXECUTABLE, SOURCE, main

PAGES = sorted(
    [SOURCE / "README.md", SOURCE / "LICENSES.md"]
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
        [EXECUTABLE, "--describe"], stdout=subprocess.PIPE, text=True, check=True
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
            for folder in ("source", "include", "tests", "benchmarks", "doc")
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
                section = re.sub(r"^(Boundary|Material) \S+$", r"\1", path[0]) if path else ""
                if section not in sections:
                    continue
                n_entries += 1
                with self.subTest(page=page.name, entry=name):
                    self.assertIn(entry.strip(), known.get("/".join([section] + path[1:]), {}))
            # set Entry = value, in blocks and in running text
            for entry in re.findall(
                r"^\s*set +([^=\n]+?) *=", page.read_text(), re.M
            ) + re.findall(r"`set +([^=`]+?) *=", prose):
                n_entries += 1
                with self.subTest(page=page.name, set=entry):
                    self.assertIn(entry, names | {"Name"})
        self.assertGreater(n_entries, 20)


if __name__ == "__main__":
    main()
