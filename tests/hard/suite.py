# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a hard case is, how it is judged and how the results are shown.

A case is a function of a Size that runs scenes and reports figures through the
Report it is given: each figure has a name, a value and the bounds between which
it must lie, so that a table can show how near the bound is.  A module of cases
registers them with the decorator case(); run.py runs them.
"""

import csv
import dataclasses
import math
import sys
import time
import traceback
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "regression"))

CASES = {}  # name: Case, in the order of the table


@dataclasses.dataclass(frozen=True)
class Size:
    """How much of a case to run: the small size is for every change."""

    full: bool

    def __call__(self, small, full):
        return full if self.full else small


@dataclasses.dataclass(frozen=True)
class Figure:
    name: str
    value: float
    least: float
    largest: float

    @property
    def holds(self):
        return self.least <= self.value <= self.largest  # false for nan

    @property
    def bounds(self):
        if self.least == self.largest:
            return f"= {self.least:.6g}"
        # Of a norm, zero is no bound but the best there can be.
        is_norm = self.least == 0 and self.largest < math.inf
        parts = [f">= {self.least:.6g}"] * (self.least > -math.inf and not is_norm)
        parts += [f"<= {self.largest:.6g}"] * (self.largest < math.inf)
        return ", ".join(parts) or "reported"


class Report:
    """Collects the figures of one case."""

    def __init__(self):
        self.figures = []

    def figure(self, name, value, least=-math.inf, largest=math.inf):
        """A number and where it must lie; without bounds it is only shown."""
        self.figures.append(Figure(name, float(value), least, largest))

    def identities(self, run, tolerance, balance=None):
        """The discrete identities of every step (regression/harness.py)."""
        from harness import TestCase

        TestCase().check_identities(run, tolerance, balance)


@dataclasses.dataclass(frozen=True)
class Case:
    name: str
    group: str
    holds: str
    function: object


def case(group, holds):
    """Register a function as a case: `holds` is the sentence of the table that
    says what must hold, the function's name is that of the case."""

    def register(function):
        if function.__name__ in CASES:
            raise ValueError(f"two cases have the name {function.__name__}")
        CASES[function.__name__] = Case(function.__name__, group, holds, function)
        return function

    return register


@dataclasses.dataclass
class Outcome:
    case: Case
    figures: list
    failure: str  # empty unless something other than a figure went wrong
    seconds: float

    @property
    def passed(self):
        return not self.failure and all(f.holds for f in self.figures)


def run_case(one, size):
    report, failure, start = Report(), "", time.monotonic()
    try:
        one.function(size, report)
        if not report.figures:
            failure = "the case reported no figure"
    except Exception as error:  # a case that fails must not end the others
        traceback.print_exc()
        failure = str(error).strip().splitlines()[0] if str(error).strip() else repr(error)
    return Outcome(one, report.figures, failure, time.monotonic() - start)


def page(outcomes, origin):
    """The results as doc/hard_cases.md: a line for each case."""
    text = [
        "# Hard cases",
        "",
        "Scenes at the edge of what the method stands, and what holds in each: written by",
        "`contrib/hard`. The scenes are in",
        "[prm/verification/hard](../prm/verification/hard) or beside it; what was measured",
        "and the bounds are in [hard_cases.csv](hard_cases.csv).",
        "",
        f"*{origin}*",
    ]
    for group in dict.fromkeys(o.case.group for o in outcomes):
        text += ["", f"## {group}", "", "| case | holds |", "|---|---|"]
        for outcome in (o for o in outcomes if o.case.group == group):
            broken = "" if outcome.passed else f"**broken {outcome.failure}** "
            holds = (broken + outcome.case.holds).replace("\n", " ")
            text.append(f"| `{outcome.case.name}` | {holds} |")
    return "\n".join(text) + "\n"


def write_csv(path, outcomes):
    """All figures, a row each."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(("group", "case", "figure", "value", "least", "largest"))
        for outcome in outcomes:
            for f in outcome.figures:
                bounds = ("" if math.isinf(b) else f"{b:.6g}" for b in (f.least, f.largest))
                case = outcome.case.group, outcome.case.name
                table.writerow((*case, f.name, f"{f.value:.6g}", *bounds))
