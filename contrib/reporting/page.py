# SPDX-License-Identifier: LGPL-2.1-or-later
"""The frame of a page: head, sections, what they show and the scripts that do."""

import base64
import json
from html import escape
from pathlib import Path

HERE = Path(__file__).resolve().parent
# Nothing is loaded: what a page needs stands in it.
FRAME = """\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="viscoplastic_contact, contrib/report">
<title>{title}</title>
<link rel="icon" href="data:,">
<style>
{style}</style>
</head>
<body>
<main>
<h1>{title}</h1>
{content}</main>
{scripts}</body>
</html>
"""


class Page:
    def __init__(self, title):
        self.title = title
        self.content = []
        self.scripts = []

    def add(self, section):
        self.content.append(section)

    def show_curves(self, curves):
        self.scripts += [as_data("curves-data", curves), script("curves.js")]

    def show_body(self, body):
        self.scripts += [
            as_data("body-data", body.data),
            '<script type="text/plain" id="body-numbers">'
            f"{body.numbers}</script>\n",
            script("vtk/vtk.min.js"),
            script("viewer.js"),
        ]

    def html(self):
        return FRAME.format(
            title=escape(self.title),
            style=(HERE / "page.css").read_text(encoding="utf-8"),
            content="".join(self.content),
            scripts="".join(self.scripts),
        )


def script(name):
    text = (HERE / name).read_text(encoding="utf-8")
    assert "</script" not in text
    return f"<script>\n{text}</script>\n"


def as_data(name, value):
    # JSON has no meaning for HTML but for what would end the element.
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    text = text.replace("<", "\\u003c")
    return f'<script type="application/json" id="{name}">{text}</script>\n'


def as_link(name, text):
    """A file to be saved from the page."""
    data = base64.b64encode(text.encode("utf-8")).decode("ascii")
    words = escape(name, quote=True)
    return f'<a download="{words}" href="data:text/plain;base64,{data}">{words}</a>'
