# SPDX-License-Identifier: LGPL-2.1-or-later
"""The folders are the architecture: a room includes none below it.

The rooms and their order are those of the table in doc/tutorial.md.
"""

import re
import unittest

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


if __name__ == "__main__":
    unittest.main()
