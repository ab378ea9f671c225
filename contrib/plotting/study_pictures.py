# SPDX-License-Identifier: LGPL-2.1-or-later
"""The pictures of a study, which is a directory with a study.csv."""

import sys

import matplotlib.pyplot as plt

from . import convergence, cost, work_precision
from .results import NoPicture, UserError
from .study import Study

PICTURES = {
    "convergence": convergence,
    "work-precision": work_precision,
    "cost": cost,
}
WITHOUT_ERRORS = ("cost",)


def is_study(directory):
    return (directory / "study.csv").exists() or (directory / "study.json").exists()


def refuse_options(options):
    """Options that have a meaning only for results of one run."""
    for given, name in (
        (options.step is not None, "--step"),
        (options.time is not None, "--time"),
        (options.begin is not None, "--from"),
        (options.until is not None, "--until"),
        (options.animate, "--animate"),
        (options.columns, "--columns"),
        (options.paraview, "--paraview"),
    ):
        if given:
            raise UserError(
                f"{options.results} holds a study, for whose pictures {name} has "
                "no meaning"
            )


def describe(study):
    lines = ["pictures: " + ", ".join(PICTURES), "errors: " + ", ".join(study.errors())]
    return "\n".join([*lines, "columns: " + ", ".join(study.columns)])


def path(study, options, name, error, number, suffix):
    if options.output:
        return options.output
    stem = name.replace("-", "_")
    if error is not None:
        stem += f"_{error}"
    if number > 1:
        stem += f"_{number}"
    return study.directory / f"{stem}.{suffix}"


def draw(study, options, name, error):
    """A picture, with --all one for each group of variants; `error` is None for the
    usual one."""
    known = study.errors()
    shown = study.error(error) if name not in WITHOUT_ERRORS or known else None
    groups = study.groups(shown)
    for number, variants in enumerate(groups if options.all else groups[:1], start=1):
        figure = PICTURES[name].draw(study, shown, variants)
        for suffix in options.formats:
            file = path(study, options, name, error and shown, number, suffix)
            figure.savefig(file, dpi=options.dpi, bbox_inches="tight", pad_inches=0.15)
            print(file)
        plt.close(figure)


def main(options):
    """Draw what was asked for; returns the exit code."""
    refuse_options(options)
    options.pictures = [name.replace("_", "-") for name in options.pictures]
    for name in options.pictures:
        if name not in PICTURES:
            raise UserError(
                f'there is no picture "{name}" of a study; there are '
                + ", ".join(PICTURES)
            )
    study = Study(options.results)
    if options.list:
        print(describe(study))
        return 0
    failed = drawn = 0
    for name in options.pictures or PICTURES:
        errors = [None] if name in WITHOUT_ERRORS else options.error or [None]
        for error in errors:
            try:
                draw(study, options, name, error)
                drawn += 1
            except NoPicture as reason:
                print(f"Not drawn: {name}: {reason}", file=sys.stderr)
                failed += 1
    return 1 if not drawn or (failed and options.pictures) else 0
