# SPDX-License-Identifier: LGPL-2.1-or-later
"""What each effect of a scene changes, beside the error of its discretization,
and what it costs."""

import matplotlib.pyplot as plt
import numpy as np

from . import style
from .results import NoPicture, UserError, read_effects

VERDICTS = {
    "called for": style.SERIES[1],
    "as large as the error of this discretization": style.SERIES[4],
    "below the error of this discretization": style.SERIES[5],
    "never acted": "#888888",
    "only watches": "#888888",
}
KINDS = {"problem": "", "discretization": " *", "observation": " *"}
SMALLEST = 1e-4  # of a change on the axis
NOTHING = ("never acted", "only watches")


def is_there(directory):
    return (directory / "effects.json").exists()


def read(directory):
    """The contents of effects.json."""
    return read_effects(directory / "effects.json")


def decisive(effect):
    """Change and error of the quantity that has decided; an error that is not
    known is not drawn."""
    found = effect["changes"][effect["decisive"]]
    error = found["error"]
    return found["change"], np.nan if error is None else error


def draw_changes(axes, rows, effects, colors):
    changes, errors = np.array([decisive(effect) for effect in effects]).T
    shown = 100 * np.maximum(changes, SMALLEST)
    idle = np.array([effect["verdict"] in NOTHING for effect in effects])
    errors = np.where(idle, np.nan, errors)
    axes.barh(rows, shown - 100 * SMALLEST, left=100 * SMALLEST, color=colors)
    axes.plot(
        100 * np.maximum(errors, SMALLEST),
        rows,
        "|",
        color="black",
        markersize=12,
        markeredgewidth=2,
        label="error of that quantity",
    )
    for row, effect, x, error in zip(rows, effects, shown, errors):
        nothing = effect["verdict"] in NOTHING
        start = 100 * SMALLEST if nothing else x
        # Not on the mark of the error.
        if not nothing and start < 100 * error < 8 * start:
            start = 100 * error
        axes.annotate(
            effect["verdict"] if nothing else style.plain(effect["decisive"]),
            (start, row),
            xytext=(5, 0),
            textcoords="offset points",
            va="center",
            fontsize="x-small",
            fontstyle="italic" if nothing else "normal",
        )
    axes.set_xscale("log")
    axes.set_xlim(100 * SMALLEST, 60 * max(shown.max(), 1.0))
    axes.set_yticks(
        rows,
        [
            style.plain(f'{effect["effect"]}: {effect["instead"]}')
            + KINDS[effect["kind"]]
            for effect in effects
        ],
        fontsize="small",
    )
    axes.set_xlabel("change of the quantity named, the largest for its error [%]")
    style.numbers_on_logarithmic_axis(axes.xaxis)


def draw_costs(axes, rows, effects, colors):
    """The seconds that an effect takes, with what is chance."""
    of_scene = np.array([effect["with"]["seconds"] for effect in effects])
    without = np.array([effect["without"]["seconds"] for effect in effects])
    chance = sum(
        np.array([effect[which]["seconds_chance"] for effect in effects])
        for which in ("with", "without")
    )
    axes.barh(
        rows,
        100 * (1 - without / of_scene),
        xerr=100 * chance / of_scene,
        color=colors,
        error_kw={"elinewidth": 1, "capsize": 2},
    )
    axes.axvline(0, color="black", linewidth=0.8)
    axes.set_xlabel("cost, share of the run [%]")


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
        figsize=(11.0, 1.8 + 0.3 * len(effects)),
        width_ratios=(2, 1),
        layout="constrained",
    )
    colors = [VERDICTS[effect["verdict"]] for effect in effects]
    draw_changes(left, rows, effects, colors)
    draw_costs(right, rows, effects, colors)
    right.tick_params(left=False)
    found = {effect["verdict"] for effect in effects}
    labels = [verdict for verdict in VERDICTS if verdict in found - set(NOTHING)]
    handles = [plt.Rectangle((0, 0), 1, 1, color=VERDICTS[label]) for label in labels]
    line, label = left.get_legend_handles_labels()
    title = style.plain(f'{about["scene"]}: what each effect changes and costs')
    if any(KINDS[effect["kind"]] for effect in effects):
        title += " (*: of the discretization)"
    figure.suptitle(title)
    # Below all axes: the layout leaves no room for it, the file does.
    figure.legend(
        handles + line,
        labels + label,
        loc="upper center",
        bbox_to_anchor=(0.5, 0.0),
        ncols=2,
    )
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
