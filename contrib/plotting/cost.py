# SPDX-License-Identifier: LGPL-2.1-or-later
"""Where the seconds of each run of a study go."""

import matplotlib.pyplot as plt
import numpy as np

from . import rates, style
from .results import NoPicture
from .study import TOLERANCE

# Columns in the order of a step: what they are, and their colors.  Those that
# are not here are drawn, too, under their own names.
PHASES = {
    "seconds_set_up": ("set-up", style.SERIES[5]),
    "seconds_rate": ("rate $G$", style.SERIES[2]),
    "seconds_tangent": ("tangent", "#f0e442"),
    "seconds_load": ("loads", style.SERIES[4]),
    "seconds_contact": ("contact problem", style.SERIES[0]),
    "seconds_balance": ("balances", style.SERIES[3]),
    "seconds_estimate": ("error estimate", style.SERIES[1]),
    "seconds_checkpoint": ("checkpoints", "#8c510a"),
}
OTHER = "#777777"
REST = ("rest", "#cccccc")
# What a study does not count as time of the run, and what is left of it.
NO_PHASES = ("seconds_total", "seconds_output", "seconds_errors", "seconds_rest")
MOST_RUNS = 24


def look(name):
    """Words and color of a part of the time."""
    if name == "rest":
        return REST
    if name in PHASES:
        return PHASES[name]
    return style.plain(name.removeprefix("seconds_").replace("_", " ")), OTHER


def phases(names):
    """Those of the columns that are seconds of a phase, in the order of a step."""
    found = [name for name in names if name.startswith("seconds_")]
    known = [name for name in PHASES if name in found]
    return known + [name for name in found if name not in (*PHASES, *NO_PHASES)]


def shares(columns, total):
    """{phase: its part of the total}, the remainder as "rest".

    Phases that nobody measured are left out; parts are nan where the total is
    not positive.
    """
    total = np.asarray(total, dtype=float)
    total = np.where(rates.known(total), total, np.nan)
    found = {}
    for name in phases(columns):
        if np.nan_to_num(columns[name]).max(initial=0.0) > 0.0:
            found[name] = np.nan_to_num(columns[name]) / total
    rest = 1.0 - sum(found.values(), np.zeros_like(total))
    # Clocks of phases may add up to a little more than that of the whole.
    found["rest"] = np.maximum(rest, 0.0)
    return found


def chosen(study, variants):
    """Rows to draw, and a remark: all, each run in the first of its ladders, or where
    they are many of each variant the finest with h and k refined."""
    ladders = [ladder for ladder in study.ladders() if ladder.variant in variants]
    timed = {
        ladder: ladder.rows[rates.known(study["seconds_total"][ladder.rows])]
        for ladder in ladders
    }
    rows = np.concatenate(list(timed.values()))
    runs = study["run"][rows]
    rows = rows[[i for i, run in enumerate(runs) if run not in runs[:i]]]
    if len(rows) <= MOST_RUNS:
        return rows, ""
    names = {ladder.name for ladder in ladders}
    kept = "both" if "both" in names else ladders[0].name
    ladders = [ladder for ladder in ladders if ladder.name == kept]
    each = max(1, MOST_RUNS // len(ladders))
    few = np.concatenate([timed[ladder][-each:] for ladder in ladders])
    return few, f" ({len(few)} of {len(rows)} runs)"


def draw(study, error=None, variants=None):
    variants = variants or study.groups(error)[0]
    rows, remark = chosen(study, variants)
    if not len(rows):
        raise NoPicture(f"no run of {study.directory} has a time")
    parts = shares(
        {name: study[name][rows] for name in phases(study.columns)},
        study["seconds_total"][rows],
    )
    seconds = study["seconds_total"][rows]
    figure, (left, right) = plt.subplots(
        1,
        2,
        figsize=(12.0, 0.27 * len(rows) + 2.2),
        width_ratios=(1.7, 1.0),
        sharey=True,
        layout="constrained",
    )
    place, heads, labels = positions(study, rows)
    begin = np.zeros(len(rows))
    for name, part in parts.items():
        left.barh(
            place,
            100 * part,
            left=100 * begin,
            height=0.8,
            color=look(name)[1],
            label=look(name)[0],
        )
        begin = begin + part
    left.set_xlim(0, 100)
    left.set_xlabel("share of the time [%]")
    left.set_yticks(place, labels, fontsize=8.5)
    left.set_ylim(place.max() + 0.7, -0.7)
    for at, text in heads:
        left.text(0.5, at, text, fontsize=9, weight="bold", va="center")
    left.legend(
        loc="lower center",
        bbox_to_anchor=(0.5, 1.0),
        ncol=len(parts) if len(parts) <= 6 else -(-len(parts) // 2),
        frameon=False,
        columnspacing=1.2,
        handlelength=1.2,
    )
    low = 10.0 ** np.floor(np.log10(seconds.min()) - 0.15)
    right.barh(place, seconds - low, left=low, height=0.8, color="#999999")
    right.set_xscale("log")
    # to the right of the longest bar there is room for its numbers
    right.set_xlim(low, seconds.max() * (seconds.max() / low) ** 0.85)
    decades = np.arange(np.log10(low), np.ceil(np.log10(seconds.max())) + 0.5)
    right.set_xticks(10.0**decades)
    right.minorticks_off()
    for at, row in zip(place, rows):
        right.annotate(
            facts(study, row),
            (study["seconds_total"][row], at),
            (4, 0),
            textcoords="offset points",
            va="center",
            fontsize=8,
        )
    right.set_xlabel("wall time [s]")
    right.tick_params(axis="y", left=False, labelleft=False)
    right.spines[["top", "right"]].set_visible(False)
    figure.suptitle(
        study.title(f"cost of each run by phase{remark}", variants),
        fontsize="large",
    )
    return figure


def positions(study, rows):
    """Where the bars go: a headline before those of each variant and ladder.

    Returns the place of each bar, (place, text) of the headlines, and the
    labels of the bars.
    """
    place, heads, labels = [], [], []
    at, before = 0.0, None
    k = "TOL" if study.chooses_steps() else "k"
    names = {"space": "h alone", "time": f"{k} alone", "both": f"h and {k}"}
    for row in rows:
        variant = tuple(study[name][row] for name in ("strategy", "scheme", "history"))
        group = variant, study["ladder"][row]
        if group != before:
            ladder = f": {names.get(group[1], group[1])}"
            if variant[0] == TOLERANCE:
                ladder = ""
            heads.append((at, study.variant_label(variant) + ladder))
            at += 1.0
            before = group
        place.append(at)
        labels.append(size(study, row))
        at += 1.0
    return np.array(place), heads, labels


def size(study, row):
    if study["strategy"][row] == TOLERANCE:
        return f"{100 * study['tolerance'][row]:.3g} %"
    step = style.short(study.step_sizes()[row])
    return f"$h$ = {style.short(study['h'][row])}, ${study.step_symbol()}$ = {step}"


def facts(study, row):
    """Time, unknowns and memory of a run, as far as they are known."""
    text = f"{study['seconds_total'][row]:.3g} s"
    if "dofs" in study and rates.known(study["dofs"][row]):
        text += f", {study['dofs'][row]:.0f} dofs"
    if "peak_memory_MB" in study and rates.known(study["peak_memory_MB"][row]):
        text += f", {study['peak_memory_MB'][row]:.0f} MB"
    return text
