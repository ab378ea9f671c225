# SPDX-License-Identifier: LGPL-2.1-or-later
"""Hooks of MkDocs: the pages are written for GitHub's Markdown, which differs from
Python's in formulas, anchors and lists."""

import re
from html import escape
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]

FORMULA = re.compile(
    r"(?P<keep>^```(?!math)[^\n]*\n[\s\S]*?^```$|^ {4}.*$|`[^`\n]+`)"
    r"|^(?:```math|\$\$)\n(?P<display>[\s\S]*?)^(?:```|\$\$)$"
    r"|\$(?P<inline>[^$]+)\$",
    re.M,
)
PLACE = "formula%dhere"
LINK = re.compile(r"(?<!!)\[(?P<text>[^\]]*)\]\((?P<target>[^)\s]+)\)")
formulas = {}


def anchor(heading, _=None):
    """What GitHub calls a heading in links."""
    heading = re.sub(r"<[^>]*>", "", heading)
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def without_formulas(text, kept):
    """The Markdown with a word for each formula, which are added to the list."""

    def replace(match):
        if match["keep"]:
            return match[0]
        kind = "display" if match["display"] else "inline"
        kept.append((kind, match[kind].strip()))
        word = PLACE % (len(kept) - 1)
        return f"\n{word}\n" if kind == "display" else word

    return FORMULA.sub(replace, text)


def with_wide_lists(text):
    """What belongs to a point of a list is indented by four, not two or three."""
    lines, points, fenced = [], [], False
    for line in text.split("\n"):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        indent = len(line) - len(line.lstrip())
        if line.strip() and not fenced:
            while points and indent < points[-1]:
                points.pop()
        more = sum(4 - (b - a) for a, b in zip([0, *points], points))
        lines.append(" " * more + line if line.strip() and more > 0 else line)
        point = re.match(r"( *)([-*]|\d+\.) +", line)
        if point and not fenced and (not points or indent >= points[-1]):
            points.append(len(point[0]))
    return "\n".join(lines)


def on_page_markdown(markdown, page, **_):
    kept = formulas[page.file.src_path] = []
    folder = (SOURCE / page.file.src_path).parent

    def link(match):
        # Directories of the repository are none of the site.
        return match["text"] if (folder / match["target"]).is_dir() else match[0]

    return with_wide_lists(LINK.sub(link, without_formulas(markdown, kept)))


def on_page_content(html, page, **_):
    def formula(match):
        kind, tex = formulas[page.file.src_path][int(match[1])]
        return f'<span class="tex {kind}">{escape(tex)}</span>'

    word = re.compile(PLACE.replace("%d", r"(\d+)"))
    page.title = word.sub(formula, page.title or "")
    return word.sub(formula, html)
