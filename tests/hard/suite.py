# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a hard case is, how it is judged and how the results are shown.

A case is a function of a Size that runs scenes and reports figures through the
Report it is given: each figure has a name, a value and the bounds between which
it must lie, so that a table can show how near the bound is.  A module of cases
registers them with the decorator case(); run.py runs them.
"""

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
        parts = [f">= {self.least:.6g}"] * (self.least > -math.inf)
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


def number(value):
    return f"{value:.4g}"


def table(outcomes, size):
    """The results as the page doc/hard_cases.md."""
    text = [
        "# Hard cases",
        "",
        "Written by `contrib/hard`; do not edit. Every scene is in",
        "[prm/verification/hard](../prm/verification/hard) or beside it; its first lines say",
        "what is hard about it and what must hold. A figure with a bound is asserted;",
        "`reported` ones are shown only. More of contact that opens is among the",
        "regressions: `test_opening.py`, `test_unilateral.py`, `test_compliance.py`.",
        "",
        "Sizes: " + ("full (`contrib/hard`)." if size.full else "small (CTest)."),
    ]
    for group in dict.fromkeys(o.case.group for o in outcomes):
        text += ["", f"## {group}", "", "| case | must hold | figure | value | bound |"]
        text += ["|---|---|---|---|---|"]
        for outcome in (o for o in outcomes if o.case.group == group):
            first = f"{outcome.case.name} ({outcome.seconds:.1f} s)", outcome.case.holds
            rows = [
                (f.name, number(f.value), f.bounds + ("" if f.holds else " **broken**"))
                for f in outcome.figures
            ]
            if outcome.failure:
                rows.append(("**failed**", "", outcome.failure))
            for row in rows:
                text.append("| " + " | ".join(first + row).replace("\n", " ") + " |")
                first = "", ""
    return "\n".join(text) + "\n"
