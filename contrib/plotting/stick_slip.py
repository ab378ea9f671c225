# SPDX-License-Identifier: LGPL-2.1-or-later
"""Stick, slip and slip rate of a 2D face over arc length and time."""

import math

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import ListedColormap

from . import style
from .contact import MOST_PIECES, node_intervals
from .faces import friction_state, lines
from .layout import number_bar
from .results import NoPicture
from .units import Units, show

FEWEST_TIMES = 3
FINEST = 2000  # columns of the map


def columns_for(nodes):
    """Cells of the map over a unit length for the finest mesh of the run.

    nodes: for each time the arc lengths of the nodes, divided by the length.
    """
    smallest = min(np.diff(s).min() for s in nodes)
    return int(np.clip(np.ceil(2.0 / smallest), 50, FINEST))


def resample(s, values, centers):
    """Values of nodes at s where each holds half way to its neighbors."""
    ends = node_intervals(s)
    index = np.searchsorted(ends[1:-1], centers, side="right")
    return values[index]


def outputs(results, options):
    """(time, file) of the outputs in the time that was asked for."""
    begin = -math.inf if options.begin is None else options.begin
    until = math.inf if options.until is None else options.until
    return [(time, path) for time, path in results.contact if begin <= time <= until]


def draw(results, options):
    if not results.contact:
        raise NoPicture(
            f"{results.directory} has no contact.pvd: a scene without contact"
        )
    shown = outputs(results, options)
    if len(shown) < FEWEST_TIMES:
        raise NoPicture(
            f"contact.pvd lists only {len(shown)} times there; a map over time "
            "needs more: run the scene with 'Output/Fields every = 1'"
        )
    first = results.read(results.contact[0][1])
    if first.cells.shape[1] != 2:
        raise NoPicture(
            "maps over arc length and time are for two-dimensional scenes; in three "
            "dimensions draw contact, with --animate"
        )
    if "stick" not in first:
        raise NoPicture("the scene has no friction, so nothing sticks or slips")
    edges = np.array([time for time, _ in shown])
    pieces = []  # for each piece of the face: s, states and rates at each time
    # The first output belongs to no step in that time.
    for _, path in shown[1:]:
        contact = results.read(path)
        states, rates = friction_state(contact), contact["slip_rate"]
        for i, line in enumerate(lines(contact)):
            if i == len(pieces):
                pieces.append((line, []))
            here = states[line.nodes]
            # What moves past a foundation that it does not touch does not slip.
            rate = np.where(here == style.NO_CONTACT, np.nan, line.component(rates))
            pieces[i][1].append((line.s, here, rate))
    pieces = [piece for piece in pieces if len(piece[1]) == len(edges) - 1]
    drawn = pieces[:MOST_PIECES]
    until = math.inf if options.until is None else options.until
    t = np.asarray(results.statistics.get("t", ()))
    steps = np.count_nonzero((t > edges[0]) & (t <= until))
    return draw_maps(results, edges, drawn, len(pieces) - len(drawn), steps)


def draw_maps(results, times, pieces, left_out, steps):
    figure, panels = plt.subplots(
        2,
        len(pieces),
        figsize=(max(7.6, 4.4 * len(pieces) + 1.0), 7.6),
        sharex="col",
        sharey=True,
        squeeze=False,
        layout="constrained",
    )
    states_map = ListedColormap(
        [
            style.STATE_COLORS[state]
            for state in sorted(style.STATE_COLORS)
        ]
    )
    units = Units.of(results)
    length = units.unit("length", [line.length for line, _ in pieces])
    occurring, maps = [], []
    for (line, found), (upper, lower) in zip(pieces, panels.T):
        count = columns_for([s / line.length for s, _, _ in found])
        ends = np.linspace(0.0, line.length, count + 1)
        centers = 0.5 * (ends[1:] + ends[:-1])
        # A state is that of the step that ends at the time of the output.
        states = np.array([resample(s, state, centers) for s, state, _ in found])
        rates = np.array([np.interp(centers, s, rate) for s, _, rate in found])
        upper.pcolormesh(
            ends, times, states, cmap=states_map, vmin=-2.5, vmax=1.5, rasterized=True
        )
        maps.append((lower, ends, rates))
        lower.set_facecolor(style.OPEN)
        show(lower.xaxis, line.label(length), length)
        occurring.append(np.unique(states))
    everything = np.concatenate([[0.0], *(rates.ravel() for _, _, rates in maps)])
    # The first minute of a year is a line.
    lasting = [np.repeat(np.diff(times), rates.shape[1]) for _, _, rates in maps]
    lasting = np.concatenate([[0.0], *lasting])
    there = np.isfinite(everything)
    everything = everything[there]
    shade = style.Shade(everything, "the slip rate", weights=lasting[there], **style.FEW)
    rate = units.unit("velocity", shade.ends())
    for lower, ends, rates in maps:
        lower.pcolormesh(
            ends, times, rates, cmap=shade.map, norm=shade.norm, rasterized=True
        )
    for row in panels:
        show(row[0].yaxis, "time $t$", units.unit("time", times))
    handles = style.state_legend(np.concatenate(occurring))
    panels[0, -1].legend(
        handles=handles,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncol=len(handles),
        frameon=False,
    )
    bar = figure.colorbar(
        shade.mappable(), extend=shade.extend, ax=panels[1].tolist(), pad=0.02
    )
    words = r"slip rate of the body $\dot{s}_\tau$"
    number_bar(bar, style.range_label(shade, words, everything, rate, "\n"), rate)
    heading = style.title(results.name, "where and when the contact face slips")
    if left_out:
        heading += f" (the {MOST_PIECES} longest of {MOST_PIECES + left_out} pieces)"
    if steps > len(times) - 1:
        heading += f"\n{len(times) - 1} outputs of {steps} steps ('Output/Fields every')"
    figure.suptitle(heading, fontsize="large")
    return figure
