# SPDX-License-Identifier: LGPL-2.1-or-later
"""Pieces of HTML: text, formulas of labels, tables, pictures."""

import base64
import re
from html import escape

MINUS = "\N{MINUS SIGN}"
SYMBOLS = {
    **{r"\sigma": "σ", r"\varepsilon": "ε", r"\tau": "τ", r"\nu": "ν"},
    **{r"\rho": "ρ", r"\times": "×", r"\Vert": "‖", r"\pm": "±", r"\int": "∫"},
    **{r"\,": "\u2009", r"\$": "$", r"\mu": "μ", r"\lambda": "λ", r"\Gamma": "Γ"},
    **{r"\approx": "≈", r"\cdot": "·", r"\le": "≤", r"\ge": "≥", "-": MINUS},
}
PIECE = re.compile(
    r"(?P<script>[_^])"
    r"(?P<argument>\{(?:[^{}]|\{[^{}]*\})*\}|\\mathrm\{[^{}]*\}|\\?\w)"
    r"|\\(?:mathrm|text)\{(?P<upright>[^{}]*)\}"
    r"|\\dot\s*(?P<dotted>\\[a-z]+|\{\w\}|\w)"
    r"|\{(?P<group>[^{}]*)\}"
    r"|(?P<command>\\[A-Za-z]+|\\\W|-)"
    r"|(?P<letters>[A-Za-z]+)"
    r"|(?P<other>.)",
    re.DOTALL,
)


def formula(text):
    """HTML of a text with formulas in dollar signs, as labels of pictures have."""
    parts = re.split(r"(?<!\\)\$", text)
    inside = (
        mathematics(part) if i % 2 else escape(part) for i, part in enumerate(parts)
    )
    return "".join(inside).replace(r"\$", "$")


def value(unit, number, digits=4):
    """HTML of a number in a unit."""
    return formula(re.sub("^-", MINUS, unit.value(number, digits)))


def mathematics(text):
    """HTML of what stands between dollar signs; what it does not know stays."""
    found = []
    for piece in PIECE.finditer(text):
        kind, value = piece.lastgroup, piece.group(piece.lastgroup)
        if kind == "argument":
            tag = "sub" if piece.group("script") == "_" else "sup"
            inner = value[1:-1] if value.startswith("{") else value
            value = f"<{tag}>{mathematics(inner)}</{tag}>"
        elif kind == "upright":
            value = escape(value)
        elif kind == "dotted":
            # The dot is a character of its own behind the letter.
            value = mathematics(value.strip("{}")) + "\u0307"
        elif kind == "group":
            value = mathematics(value)
        elif kind == "command":
            value = escape(SYMBOLS.get(value, value.lstrip("\\")))
        elif kind == "letters":
            value = f"<i>{value}</i>"
        else:
            value = escape(value)
        found.append(value)
    return "".join(found)


def table(head, rows, numbers=()):
    """A table of cells that are HTML; columns of these numbers count to the right."""

    def line(cells, tag):
        marked = (
            f"<{tag}{' class=number' if i in numbers else ''}>{cell}</{tag}>"
            for i, cell in enumerate(cells)
        )
        return f"<tr>{''.join(marked)}</tr>\n"

    body = "".join(line(row, "td") for row in rows)
    return (
        f'<div class="wide"><table>\n<thead>{line(head, "th")}</thead>\n'
        f"<tbody>{body}</tbody></table></div>\n"
    )


def items(sentences):
    return "<ul>" + "".join(f"<li>{s}</li>\n" for s in sentences) + "</ul>\n"


def section(name, title, content):
    return f'<section id="{name}">\n<h2>{title}</h2>\n{content}</section>\n'


def folded_up(title, content):
    return f"<details><summary>{title}</summary>\n{content}</details>\n"


def listing(text):
    return f"<pre>{escape(text)}</pre>\n"


def picture(path, description):
    """A PNG, within the page."""
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    words = escape(description, quote=True)
    return f'<img alt="{words}" src="data:image/png;base64,{data}">\n'
