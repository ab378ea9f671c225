# SPDX-License-Identifier: LGPL-2.1-or-later
"""The error over the seconds that it cost, and who is efficient."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D

from . import convergence, rates, style
from .results import NoPicture
from .study import error_label

MARKERS = {"both": "s", "space": "^", "time": "v"}
FRONTIER = "#f7e48f"
GAIN = 0.1  # a run of the frontier lowers the error by so much at least


def draw(study, error, variants=None):
    seconds, errors = study["seconds_total"], study[error]
    if not rates.known(seconds, errors).any():
        raise NoPicture(
            f"no run of {study.directory} has both a known {error} and a time"
        )
    variants = variants or study.groups(error)[0]
    figure, axes = plt.subplots(
        figsize=(7.6, 5.2 + 0.24 * (len(variants) + 1)), layout="constrained"
    )
    handles, names, drawn, looks = [], [], [], study.looks(variants)
    for variant in variants:
        ladders = [
            ladder
            for ladder in study.ladders()
            if ladder.variant == variant
            and rates.known(seconds[ladder.rows], errors[ladder.rows]).any()
        ]
        if not ladders:
            continue
        color, dashes = looks[variant]["color"], looks[variant]["ls"]
        # A curve through h and k refined together, which is what one does
        # for a better answer; the other runs show what unbalanced ones cost.
        through = [ladder for ladder in ladders if ladder.name == "both"] or ladders
        for ladder in ladders:
            rows = ladder.rows[rates.known(seconds[ladder.rows], errors[ladder.rows])]
            on_curve = ladder in through
            drawn.append(rows)
            axes.plot(
                seconds[rows],
                errors[rows],
                color=color,
                ls=dashes if on_curve else "none",
                lw=1.6,
                marker=MARKERS.get(ladder.name, "o"),
                ms=6 if on_curve else 5,
                mfc=color if on_curve else "white",
                zorder=3 if on_curve else 2.5,
            )
            names.append(ladder.name)
        handles.append(
            Line2D([], [], lw=2.5, label=study.variant_label(variant), **looks[variant])
        )
    # Of the runs drawn, and without those that gain next to nothing.
    drawn = np.unique(np.concatenate(drawn)) if drawn else np.array([], dtype=int)
    best = rates.efficient_frontier(seconds[drawn], errors[drawn], GAIN)
    frontier = rates.without_detours(seconds, errors, drawn[best])
    axes.plot(
        seconds[frontier],
        errors[frontier],
        color=FRONTIER,
        lw=6,
        solid_joinstyle="round",
        marker="o",
        ms=14,
        mec="none",
        zorder=1,
    )
    for name in dict.fromkeys(names):
        handles.append(
            Line2D(
                [],
                [],
                color=style.OUTLINE,
                ls="none",
                marker=MARKERS.get(name, "o"),
                mfc=style.OUTLINE if name == "both" else "white",
                label=study.ladder_label(name) + " refined",
            )
        )
    handles.append(
        Line2D([], [], color=FRONTIER, lw=6, label="efficient frontier")
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(0.08)
    axes.grid(True, which="major", color="#dddddd", lw=0.6)
    axes.set_axisbelow(True)
    convergence.mark_reference(axes, study.error_of_reference(error), "left")
    style.numbers_on_logarithmic_axis(axes.xaxis)
    style.numbers_on_logarithmic_axis(axes.yaxis, 100)
    axes.set_xlabel(f"wall time [s]{machine(study)}")
    axes.set_ylabel(f"{error_label(error)} [%]")
    axes.legend(
        handles=handles,
        loc="upper center",
        bbox_to_anchor=(0.5, -0.13),
        ncol=2,
        frameon=False,
        fontsize=8.5,
        labelspacing=0.3,
    )
    figure.suptitle(study.title("what accuracy costs", variants), fontsize="large")
    return figure


def machine(study):
    """Ranks and processor, as far as study.json says."""
    ranks = study.about.get("ranks")
    parts = []
    if ranks:
        parts.append(f"{ranks} MPI rank" + ("s" if ranks != 1 else ""))
    if study.about.get("machine"):
        parts.append(style.plain(str(study.about["machine"])))
    return f"   ({', '.join(parts)})" if parts else ""
