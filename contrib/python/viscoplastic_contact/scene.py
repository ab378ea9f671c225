# SPDX-License-Identifier: LGPL-2.1-or-later
"""Parameter files from nested dictionaries.

    {"Dimension": 2,
     "Geometry": {"Arguments": "8, 8 : 0, 0 : 1, 1 : true"},
     "Boundary": {0: {"Role": "clamped"},
                  1: {"Role": "traction", "Traction": ("0.3*t", 0)}}}

A dictionary is a subsection; one with numbers for its names is a series of
subsections, `Boundary 0', `Boundary 1'. Values are texts, numbers, True and
False; a tuple is a vector, whose components have semicolons between them, and
a list has commas.
"""

from pathlib import Path

from .tables import UserError


def value_text(value, path):
    """A value as a parameter file has it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return "; ".join(value_text(item, path) for item in value)
    if isinstance(value, list):
        return ", ".join(value_text(item, path) for item in value)
    if isinstance(value, float):
        text = repr(float(value))  # NumPy's numbers too
    else:
        text = str(value).strip()
    # What would end the value, or begin a comment.
    if any(character in text for character in "#\n\r") or text.endswith("\\"):
        raise UserError(
            f"'{path}' is {text!r}; a value cannot contain '#' or line breaks, nor "
            "end with a backslash"
        )
    return text


def lines(entries, path, margin):
    for name, value in entries.items():
        where = f"{path}/{name}" if path else str(name)
        if not isinstance(value, dict):
            yield f"{margin}set {name} = {value_text(value, where)}".rstrip()
            continue
        is_series = value and all(isinstance(number, int) for number in value)
        sections = (
            {f"{name} {number}": below for number, below in value.items()}
            if is_series
            else {name: value}
        )
        for section, below in sections.items():
            if not isinstance(below, dict):
                raise UserError(f"'{section}' is {below!r}, but needs a dictionary")
            yield f"{margin}subsection {section}"
            yield from lines(below, where, margin + "  ")
            yield f"{margin}end"


def scene_text(scene):
    """The text of the parameter file."""
    return "\n".join(lines(scene, "", "")) + "\n"


def set_options(overrides):
    """{"Section/Entry": value}, or texts `Section/Entry=value', as options of the
    program."""
    if isinstance(overrides, dict):
        overrides = [f"{name}={value_text(v, name)}" for name, v in overrides.items()]
    return [word for text in overrides or () for word in ("--set", text)]


def write_scene(scene, path):
    """Write the parameter file; returns its path."""
    path = Path(path)
    path.write_text(scene_text(scene), encoding="utf-8")
    return path
