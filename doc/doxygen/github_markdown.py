#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A filter for Doxygen: the documents are written for GitHub's Markdown.

GitHub and Doxygen 1.9 differ in formulas, in the anchors of headings, and in
what a link to a file that is no page means.  Line numbers stay as they are, so
that Doxygen's warnings name the right ones.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

# What is not prose, longest first, and headings.
PARTS = re.compile(
    r"^(?:```math|\$\$)\n(?P<display>[\s\S]*?)^(?:```|\$\$)$"
    r"|(?P<code>^```[\s\S]*?^```$|^ {4}.*$)"
    r"|^(?P<heading>\#+ .*)$"
    r"|!\[(?P<caption>[^\]]*)\]\((?P<image>[^)\s]+)\)"
    r"|(?<!!)\[(?P<text>[^\]]*)\]\((?P<target>[^)\s]+)\)"
    r"|(?P<span>`[^`]+`)"
    r"|\$(?P<inline>[^$]+)\$",
    re.M,
)


def anchor(heading):
    """What GitHub calls a heading in links."""
    heading = re.sub(r"[^\w\- ]", "", heading.lstrip("#").strip().lower())
    return heading.replace(" ", "-")


def label(file, name):
    """Unique among the pages: there is more than one README.md."""
    stem = "_".join(file.relative_to(ROOT).with_suffix("").parts)
    return re.sub(r"\W", "_", f"{stem}_{name}")


def convert_link(text, target, file):
    if re.match(r"[a-z]+:", target):
        return f"[{text}]({target})"
    path, _, heading = target.partition("#")
    page = (file.parent / path).resolve() if path else file
    if page.suffix != ".md":
        return text  # a file of the repository, not one of the pages
    return f"[{text}](@ref {label(page, heading or 'page')})"


def convert(source, file):
    has_title = False

    def replace(match):
        nonlocal has_title
        if match["display"] is not None:
            return f"\\f[\n{match['display']}\\f]"
        if match["inline"] is not None:
            return f"\\f${match['inline']}\\f$"
        if match["heading"] is not None:
            name = anchor(match["heading"]) if has_title else "page"
            has_title = True
            return f"{match['heading']} {{#{label(file, name)}}}"
        if match["image"] is not None:
            # Doxygen wants images in one line; the lines follow empty.
            caption = " ".join(match["caption"].split())
            lines = "\n" * match["caption"].count("\n")
            return f"![{caption}]({Path(match['image']).name}){lines}"
        if match["text"] is not None:
            return convert_link(match["text"], match["target"], file)
        return match[0]

    return PARTS.sub(replace, source)


if __name__ == "__main__":
    name = Path(sys.argv[1]).resolve()
    sys.stdout.write(convert(name.read_text(encoding="utf-8"), name))
