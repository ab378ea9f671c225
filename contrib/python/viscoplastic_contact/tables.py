# SPDX-License-Identifier: LGPL-2.1-or-later
"""What studies wrote: study.csv, one row a run, study.json, effects.json."""

import csv
import json
import re

import numpy as np

VARIANT = ("strategy", "scheme", "history")  # what tells one variant of the method
TEXT = ("run", *VARIANT, "solver", "ladder")
LEVELS = ("mesh_level", "time_level")
NEEDED = (*VARIANT, "ladder", *LEVELS, "h", "k", "seconds_total")
COEFFICIENTS = ("C_h", "p", "C_k", "q", "m")  # of a fit


class UserError(Exception):
    """Something the user can mend; its text is the whole message."""


class RunError(UserError):
    """The program has refused or ended a run: its sentence, its code, and the name of
    a signal that came meanwhile."""

    def __init__(self, sentence, code, signal=""):
        super().__init__(sentence)
        self.code, self.signal = code, signal


def without_unit(name):
    """The name of a column or a field, which a unit may follow: `t [day]'."""
    return re.sub(r"\s*\[[^\]]*\]$", "", name.strip())


def frame(columns):
    """Columns as a pandas.DataFrame."""
    try:
        import pandas
    except ImportError:
        raise UserError(
            "pandas is not installed; without it the columns are NumPy arrays"
        ) from None
    return pandas.DataFrame(columns)


def read_effects(path):
    """The contents of effects.json."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UserError(f"{path} cannot be read: {error}") from error


def read_study_table(path):
    """The columns of study.csv: texts, and numbers with nan for unknown."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file, skipinitialspace=True) if row]
    except FileNotFoundError:
        raise UserError(f"there is no file {path}") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise UserError(f"{path} cannot be read: {error}") from error
    if len(rows) < 2:
        raise UserError(f"{path} has no runs")
    names = [without_unit(name) for name in rows[0]]
    missing = [name for name in NEEDED if name not in names]
    if missing:
        raise UserError(f"{path} lacks the columns " + ", ".join(missing))
    if len(set(names)) < len(names):
        raise UserError(f"{path} is damaged: two of its columns have the same name")
    columns = {name: [] for name in names}
    for number, row in enumerate(rows[1:], start=1):
        if len(row) != len(names):
            raise UserError(
                f"{path} is damaged: its run {number} has {len(row)} values, "
                f"where the first line names {len(names)}"
            )
        for name, text in zip(names, row):
            columns[name].append(value(path, number, name, text.strip()))
    return {name: np.array(column) for name, column in columns.items()}


def value(path, number, name, text):
    if name in TEXT:
        return text
    try:
        return float(text) if text else np.nan
    except ValueError:
        raise UserError(
            f'{path} is damaged: its run {number} has "{text}" for {name}, which '
            "is no number"
        ) from None


def read_study_about(path):
    """study.json; a study in progress has none yet."""
    if not path.exists():
        return {"fits": []}
    try:
        about = json.loads(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise UserError(f"{path} cannot be read: {error}") from error
    if not isinstance(about, dict):
        raise UserError(f"{path} cannot be read: it is no JSON object")
    fits = about["fits"] = about.get("fits") or []
    if not isinstance(fits, list) or not all(map(can_be_drawn, fits)):
        raise UserError(f"{path} is damaged: its fits have no numbers")
    return about


def can_be_drawn(fit):
    """Whether the coefficients of a fit are numbers, or not there."""
    return not isinstance(fit, dict) or all(
        isinstance(fit.get(name), (int, float, type(None))) for name in COEFFICIENTS
    )
