# SPDX-License-Identifier: LGPL-2.1-or-later
"""The folders are the architecture: a room includes none below it.

The rooms and their order are those of the table in doc/tutorial.md.
"""

import re
import unittest
from fnmatch import fnmatchcase

from harness import SOURCE

HEADERS = SOURCE / "include" / "viscoplastic_contact"
SOURCES = SOURCE / "source"
INCLUDE = re.compile(r"#include <viscoplastic_contact/(\w+)/[\w/]+\.h>")


def rooms():
    text = (SOURCE / "doc" / "tutorial.md").read_text()
    section = text.split("### Rooms", 1)[1].split("\n### ", 1)[0]
    return re.findall(r"^\| `(\w+)` \|", section, re.M)


class Rooms(unittest.TestCase):
    def test_each_folder_is_a_room_and_each_room_a_folder(self):
        for place in (HEADERS, SOURCES):
            folders = {path.name for path in place.iterdir() if path.is_dir()}
            self.assertEqual(folders, set(rooms()), place)

    def test_only_the_main_program_stands_outside(self):
        self.assertEqual([path.name for path in SOURCES.glob("*.*")], ["main.cc"])
        self.assertEqual(list(HEADERS.glob("*.h")), [])

    def test_each_source_is_in_the_library(self):
        text = (SOURCE / "CMakeLists.txt").read_text()
        (library,) = re.findall(r"^set\(\w+_SOURCES\n([^)]*)\)", text, re.M)
        files = [path for path in SOURCES.rglob("*.cc") if path.name != "main.cc"]
        self.assertEqual(
            sorted(re.findall(r"source/\S+\.cc", library)),
            sorted(str(path.relative_to(SOURCE)) for path in files),
        )

    def test_each_unit_test_is_an_entry_of_ctest(self):
        unit = SOURCE / "tests" / "unit"
        entries = re.findall(
            r'^ *unit_test\(\w+\s+"([^"]+)"', (unit / "CMakeLists.txt").read_text(), re.M
        )
        filters = [one for entry in entries for one in entry.split(":")]
        suites = {
            (suite, kind == "TYPED_")
            for path in unit.glob("*.cc")
            for kind, suite in re.findall(
                r"^ *(TYPED_|)TEST(?:_F)?\((\w+),", path.read_text(), re.M
            )
        }
        self.assertGreater(len(suites), 40)
        for suite, is_typed in sorted(suites):
            name = suite + ("/0.Test" if is_typed else ".Test")
            self.assertTrue(any(fnmatchcase(name, one) for one in filters), suite)

    def test_no_room_includes_one_below_it(self):
        order = rooms()
        self.assertGreater(len(order), 10)
        n_includes = 0
        for place in (HEADERS, SOURCES):
            for file in sorted(place.rglob("*.*")):
                room = file.relative_to(place).parts[0]
                if room == "main.cc":
                    continue
                for other in INCLUDE.findall(file.read_text()):
                    n_includes += 1
                    self.assertLessEqual(
                        order.index(other),
                        order.index(room),
                        f"{file.relative_to(SOURCE)} includes {other}",
                    )
        self.assertGreater(n_includes, 300)

    def test_no_files_include_each_other(self):
        """A header and its source count as one, and so do the kernels' templates."""

        def unit(path):
            return re.sub(r"_implementation$", "", path)

        includes = {}
        for place in (HEADERS, SOURCES):
            for file in place.rglob("*.*"):
                name = unit(str(file.relative_to(place).with_suffix("")))
                found = re.findall(
                    r"#include <viscoplastic_contact/([\w/]+)\.h>", file.read_text()
                )
                includes.setdefault(name, set()).update(set(map(unit, found)) - {name})
        # Those that include nothing that is left go, until only cycles are left.
        while True:
            ends = {name for name, others in includes.items() if not others & set(includes)}
            if not ends:
                break
            for name in ends:
                del includes[name]
        self.assertEqual(sorted(includes), [])

    def test_the_figure_shows_who_uses_whom(self):
        """Each arrow is an include, and each include an arrow or a path."""
        text = (SOURCE / "doc" / "figures" / "rooms.dot").read_text()
        arrows = set(re.findall(r"^  (\w+) -> (\w+);", text, re.M))
        self.assertEqual({room for arrow in arrows for room in arrow}, set(rooms()))
        uses = {
            (file.relative_to(place).parts[0], other)
            for place in (HEADERS, SOURCES)
            for file in place.rglob("*.*")
            for other in INCLUDE.findall(file.read_text())
            if file.parent != SOURCES
        }
        uses = {(room, other) for room, other in uses if room != other}
        reached = set(arrows)
        for middle in reversed(rooms()):
            reached |= {
                (room, other)
                for room, via in reached
                for start, other in reached
                if via == start == middle
            }
        self.assertEqual(arrows - uses, set(), "arrows without an include")
        self.assertEqual(uses - reached, set(), "includes without an arrow")


if __name__ == "__main__":
    unittest.main()
