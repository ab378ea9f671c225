# SPDX-License-Identifier: LGPL-2.1-or-later
"""price.md: what contrib/price has said, as a page that contrib/report takes."""

import re
from pathlib import Path

from .runs import make_directory, replace_file
from .words import digits


def directory_of(scene):
    """Beside the results of the run that is priced."""
    return scene.directory + "price/"


def as_markdown(said):
    """Indented lines are points of a list, or options; others are paragraphs."""
    lines = []
    for line in said.splitlines():
        mark = re.match(r"  (--set )?", line)
        if not mark:
            lines += ["", line]
        elif mark[1]:
            lines += [] if lines[-1].startswith("    ") else [""]
            lines.append(f"    {line[2:]}")
        else:
            lines += [] if lines[-1].startswith("- ") else [""]
            lines.append(f"- {' '.join(line.split())}")
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip() + "\n"


def write_price(scene, eps, said, origin):
    make_directory(directory_of(scene))
    title = f"# Price of an error of {digits(eps)}: `{Path(scene.file).name}`"
    replace_file(
        directory_of(scene) + "price.md", f"{title}\n\n*{origin}*\n\n{as_markdown(said)}"
    )
