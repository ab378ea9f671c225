#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A filter for Doxygen: each header belongs to the group of its room.

What a room is for is said once, in the table of doc/tutorial.md.  Line numbers
stay as they are.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def purpose(room):
    table = (ROOT / "doc" / "tutorial.md").read_text()
    row = re.search(rf"^\| `{room}` \| (.*?) \|", table, re.M)
    return re.sub(r"[$`]", "", row.group(1)) if row else ""


def main():
    file = Path(sys.argv[1]).resolve()
    source = file.read_text()
    parts = file.relative_to(ROOT).parts
    if parts[0] == "include":
        room = parts[2]
        group = f"/** @addtogroup room_{room} {room}: {purpose(room)} */ /** @{{ */"
        source = source.replace(
            "namespace Viscoplastic\n{", f"namespace Viscoplastic\n{{ {group}", 1
        ).replace("} // namespace Viscoplastic", "/** @} */ } // namespace Viscoplastic")
    sys.stdout.write(source)


main()
