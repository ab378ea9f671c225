# SPDX-License-Identifier: LGPL-2.1-or-later
"""Where the seconds of a run went, as bars."""

from plotting import style
from plotting.units import plain_number

from .tables import data

# Parts of the clock of a run (run_summary.h): what they are paid for, and their colors.
PHASES = {
    "pilot run": ("pilot run of the tolerance", "#8c510a"),
    "set-up": ("set-up: spaces, matrix, factorization or multigrid", style.SERIES[5]),
    "rate": ("viscosity: flow of the law in all cells", style.SERIES[2]),
    "tangent": ("backward Euler: matrices of the steps", "#f0e442"),
    "load": ("data: loads, friction bounds, foundations", style.SERIES[4]),
    "contact": ("elasticity: linear solves, as without friction", style.SERIES[0]),
    "friction": ("friction: active set", "#999933"),
    "balance": ("balances: energies, reactions, statistics", style.SERIES[3]),
    "estimate": ("error estimate", style.SERIES[1]),
    "adaptation": ("adaptivity: new meshes with their set-up", "#35978f"),
    "output": ("fields, for ParaView and for this page", "#888888"),
    "errors": ("comparison with an exact solution or a reference", "#bf812d"),
    "checkpoint": ("checkpoints", "#c7a26b"),
}
REST = ("rest: mesh, initial state, progress", "#cccccc")


def total(results):
    """Seconds of the whole run, restarts included, or None."""
    seconds = results.statistics.get("wall_total", ())
    return float(seconds[-1]) if len(seconds) else None


def bars(results, about):
    seconds, whole = about.get("costs", {}).get("seconds"), total(results)
    if not seconds or not whole:
        return "<p>The run has left no costs.</p>\n"
    friction = about["costs"].get("friction_seconds", 0.0)
    if friction > 0.0:
        seconds = {**seconds, "contact": seconds["contact"] - friction}
        seconds["friction"] = friction
    # The last fields may be written after the last row of the statistics.
    known = sum(seconds.values())
    whole = max(whole, known)
    parts = [(*PHASES.get(name, (name, "#888888")), seconds[name]) for name in seconds]
    order = [words for words, _ in PHASES.values()]
    place = {words: i for i, words in enumerate(order)}
    parts.sort(key=lambda part: place.get(part[0], len(order)))
    resumed = is_resumed(results, about["costs"]["seconds"])
    rest = "rest, and all before the last restart" if resumed else REST[0]
    parts.append((rest, REST[1], whole - known))
    rows = "".join(row(*part, whole) for part in parts if part[2] > 0.0)
    return (
        f'<div class="bars" role="list">\n{rows}</div>\n'
        f"<p>The whole run took {data(whole, plain_number(whole, 4))} s.</p>\n"
    )


def row(words, color, seconds, whole):
    share = 100.0 * seconds / whole
    return (
        f'<div role="listitem"><span>{words}</span><span class="bar">'
        f'<i style="width:{share:.2f}%;background:{color}"></i></span>'
        f"<span class=number>{data(seconds, plain_number(seconds, 3))} s</span>"
        f"<span class=number>{share:.0f} %</span></div>\n"
    )


def is_resumed(results, seconds):
    """Whether the parts are those of the time after a restart: then the statistics,
    which go on, have more."""
    column = results.statistics.get("wall_contact")
    if column is None or "contact" not in seconds:
        return False
    return column.sum() > 1.02 * seconds["contact"] + 0.01
