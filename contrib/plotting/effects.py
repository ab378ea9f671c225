# SPDX-License-Identifier: LGPL-2.1-or-later
"""What each effect of a scene changes, beside the error of its discretization,
and what it costs."""

import matplotlib.pyplot as plt
import numpy as np

from . import style
from .results import NoPicture, read_effects

VERDICTS = {
    "called for": style.SERIES[1],
    "as large as the error of this discretization": style.SERIES[4],
    "below the error of this discretization": style.SERIES[5],
    "never acted": "#bbbbbb",
}
SMALLEST = 1e-4  # of a change on the axis


def is_there(directory):
    return (directory / "effects.json").exists()


def read(directory):
    """The contents of effects.json."""
    return read_effects(directory / "effects.json")


def decisive(effect):
    """Change and error of the quantity that has decided."""
    found = effect["changes"][effect["decisive"]]
    return found["change"], found["error"]


def draw(about):
    effects = [effect for effect in about["effects"] if not effect["failure"]]
    if not effects:
        raise NoPicture("no effect could be left out")
    effects = effects[::-1]  # the first one on top
    rows = np.arange(len(effects))
    figure, (left, right) = plt.subplots(
        1,
        2,
        sharey=True,
        figsize=(11.0, 1.6 + 0.36 * len(effects)),
        width_ratios=(2, 1),
        layout="constrained",
    )
    colours = [VERDICTS[effect["verdict"]] for effect in effects]
    changes, errors = np.array([decisive(effect) for effect in effects]).T
    shown = 100 * np.maximum(changes, SMALLEST)
    left.barh(rows, shown - 100 * SMALLEST, left=100 * SMALLEST, color=colours)
    left.plot(
        100 * np.maximum(errors, SMALLEST),
        rows,
        "|",
        color="black",
        markersize=14,
        markeredgewidth=2,
        label="error of the discretization there",
    )
    for row, effect, x in zip(rows, effects, shown):
        if effect["verdict"] != "never acted":
            left.annotate(
                style.plain(effect["decisive"]),
                (x, row),
                xytext=(4, 0),
                textcoords="offset points",
                va="center",
                fontsize="x-small",
            )
    left.set_xscale("log")
    left.set_xlim(100 * SMALLEST, 20 * shown.max())
    left.set_yticks(
        rows,
        [
            style.plain(f'{effect["effect"]}: {effect["instead"]}')
            + ("" if effect["physical"] else " *")
            for effect in effects
        ],
        fontsize="small",
    )
    left.set_xlabel("largest change in proportion to its error [%]")
    saved = [
        100 * (1 - effect["seconds_without"] / effect["seconds_with"])
        for effect in effects
    ]
    right.barh(rows, saved, color=colours)
    right.axvline(0, color="black", linewidth=0.8)
    right.set_xlabel("part of the time that the effect costs [%]")
    handles = [
        plt.Rectangle((0, 0), 1, 1, color=colour)
        for verdict, colour in VERDICTS.items()
        if any(effect["verdict"] == verdict for effect in effects)
    ]
    labels = [
        verdict
        for verdict in VERDICTS
        if any(effect["verdict"] == verdict for effect in effects)
    ]
    line, label = left.get_legend_handles_labels()
    figure.legend(handles + line, labels + label, loc="outside lower center", ncols=3)
    star = "" if all(e["physical"] for e in effects) else " (*: of the discretization)"
    figure.suptitle(style.plain(f'{about["scene"]}: which effects it calls for') + star)
    return figure


def main(options):
    """Draw the picture; returns the exit code."""
    if options.pictures or options.all:
        raise UserError(f"{options.results} has one picture, which goes without a name")
    figure = draw(read(options.results))
    for suffix in options.formats:
        file = options.output or options.results / f"effects.{suffix}"
        figure.savefig(file, dpi=options.dpi, bbox_inches="tight", pad_inches=0.15)
        print(file)
    plt.close(figure)
    return 0
