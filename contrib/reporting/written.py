# SPDX-License-Identifier: LGPL-2.1-or-later
"""The page of a study, of prices or of effects: what these have written in Markdown,
with their pictures within the page."""

import re
from html import escape

from plotting.results import UserError

from .markup import listing, picture, table
from .page import Page

TITLES = {
    "study": "Study: what accuracy costs",
    "price": "Price: what an error costs",
    "effects": "What each effect changes",
}
INLINE = re.compile(
    r"`(?P<code>[^`]+)`"
    r"|!\[(?P<words>[^\]]*)\]\((?P<file>[^)]+)\)"
    r"|\[(?P<link>[^\]]*)\]\([^)]*\)"
    r"|\*\*(?P<bold>.+?)\*\*"
    r"|(?<![\w*])\*(?P<italic>[^*\s](?:[^*]*[^*\s])?)\*(?![\w*])"
)


def kind_of(directory):
    """"study", "price" or "effects", or None: the directory holds none of them."""
    for kind in TITLES:
        if (directory / f"{kind}.md").exists():
            return kind
    return None


def has_run(directory):
    """Whether the directory of a price has the run, too, for which that has been paid."""
    price = directory / "price.md"
    return price.exists() and "The prediction:" in price.read_text(encoding="utf-8")


def page(directory):
    kind = kind_of(directory)
    found = Page(f"{directory.resolve().parent.name}: {kind}")
    found.add(content(directory))
    return found


def content(directory):
    path = directory / f"{kind_of(directory)}.md"
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(f"{path} cannot be read: {error}") from error
    more = "".join(
        picture(path, path.stem)
        for path in sorted(directory.glob("*.png"))
        if f"({path.name})" not in text
    )
    return html(text, directory) + more


def html(text, directory):
    """The Markdown that the program's studies write: headings, paragraphs, lists,
    tables, indented listings and pictures."""
    blocks = re.split(r"\n\s*\n", text.strip("\n"))
    return "".join(block(part, directory) for part in blocks if part.strip())


def block(text, directory):
    lines = text.strip("\n").split("\n")
    if re.match(r"#+ ", lines[0]):
        hashes, title = lines[0].split(" ", 1)
        # The title of the page is the only one of the first level.
        level = min(len(hashes) + 1, 6)
        rest = "\n".join(lines[1:])
        head = f"<h{level}>{inline(title, directory)}</h{level}>\n"
        return head + (block(rest, directory) if rest.strip() else "")
    if all(line.startswith("    ") for line in lines):
        return listing("\n".join(line[4:] for line in lines))
    if lines[0].startswith("|") and re.fullmatch(r"[|:\- ]+", "".join(lines[1:2])):
        rows = [cells(line, directory) for line in [lines[0], *lines[2:]]]
        return table(rows[0], rows[1:])
    if re.match(r"[-*] ", lines[0]):
        points = re.split(r"^[-*] ", text.strip("\n"), flags=re.MULTILINE)[1:]
        inside = "".join(f"<li>{inline(point, directory)}</li>\n" for point in points)
        return f"<ul>\n{inside}</ul>\n"
    return f"<p>{inline(text, directory)}</p>\n"


def cells(line, directory):
    found = [cell.strip() for cell in line.strip().strip("|").split("|")]
    # Numbers with their units, "14 +- 18 %", are not torn apart.
    short = re.compile(r"[-+]?\d.{0,20}")
    found = [re.sub(" ", "\u00a0", c) if short.fullmatch(c) else c for c in found]
    return [inline(cell, directory) for cell in found]


def inline(text, directory):
    found, at = [], 0
    for match in INLINE.finditer(text):
        found.append(escape(text[at : match.start()]))
        found.append(element(match, directory))
        at = match.end()
    return "".join([*found, escape(text[at:])])


def element(match, directory):
    kind = match.lastgroup
    if kind == "code":
        return f"<code>{escape(match['code'])}</code>"
    if kind == "file":
        path = directory / match["file"]
        if path.suffix != ".png" or not path.exists():
            return escape(match["words"])
        return picture(path, match["words"])
    if kind == "link":
        return escape(match["link"])
    tag = {"bold": "b", "italic": "i"}[kind]
    return f"<{tag}>{inline(match[kind], directory)}</{tag}>"
