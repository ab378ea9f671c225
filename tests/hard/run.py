# SPDX-License-Identifier: LGPL-2.1-or-later
"""Run hard cases: python3 run.py [--full] [--list] [--page FILE] [NAME ...].

Names are of cases or of files of them; without names all are run.  Ends with
`N passed, N failed`, and with code 1 unless all have passed.
"""

import argparse
import importlib
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "contrib" / "python"))

from suite import CASES, Size, page, run_case, write_csv
from viscoplastic_contact import Program

# The order is that of the page.
MODULES = (
    "elasticity",
    "cells",
    "creep",
    "friction",
    "contact_pieces",
    "opening",
    "time_steps",
    "step_control",
    "limits",
)


def load():
    here = Path(__file__).resolve().parent
    for module in MODULES:
        if (here / f"{module}.py").exists():
            importlib.import_module(module)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--full", action="store_true", help="the full sizes")
    parser.add_argument("--list", action="store_true", help="names, and nothing else")
    parser.add_argument("--page", metavar="FILE.md", help="write a page, and FILE.csv")
    arguments = parser.parse_args()
    load()
    if arguments.list:
        print("\n".join(CASES))
        return 0
    unknown = [name for name in arguments.names if name not in (*CASES, *MODULES)]
    if unknown:
        parser.error(f"there is no case {', '.join(unknown)}; --list names all")
    chosen = {*arguments.names} or CASES
    cases = [c for c in CASES.values() if {c.name, c.function.__module__} & {*chosen}]

    size = Size(arguments.full)
    outcomes = []
    for case in cases:
        outcome = run_case(case, size)
        outcomes.append(outcome)
        print(f"{case.name}: {'passed' if outcome.passed else 'FAILED'}", end="")
        print(f" in {outcome.seconds:.1f} s  {outcome.failure}", flush=True)
        for figure in outcome.figures:
            mark = "" if figure.holds else "  BROKEN"
            print(f"  {figure.name}: {figure.value:.6g} ({figure.bounds}){mark}")
        if arguments.page:  # also what a run that is ended has found
            Path(arguments.page).write_text(page(outcomes, Program().origin()))
            write_csv(Path(arguments.page).with_suffix(".csv"), outcomes)
    n_passed = sum(outcome.passed for outcome in outcomes)
    print(f"{n_passed} passed, {len(outcomes) - n_passed} failed")
    return 0 if n_passed == len(outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
