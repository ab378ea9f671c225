# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fields along the lines of `Output/Lines' at some times."""

import re

import matplotlib
import matplotlib.pyplot as plt
import numpy as np

from . import quantities, style
from .results import NoPicture
from .units import Units

MOST_TIMES = 6
MOST_PANELS = 12  # of a line
PLACE = ("step", "t", "s", "x", "y", "z")


def some_times(times):
    """Indices of at most MOST_TIMES of these times, spread over them as evenly as they
    allow, the first and last too."""
    times = np.asarray(times)
    if len(times) <= MOST_TIMES:
        return range(len(times))
    wanted = np.linspace(times[0], times[-1], MOST_TIMES)
    return np.unique(np.abs(times[:, None] - wanted).argmin(axis=0))


def tables(line):
    """The columns of a line as arrays (time, point)."""
    starts = np.flatnonzero(np.diff(line["step"], prepend=line["step"][0] - 1))
    n_points = np.diff(np.append(starts, len(line["step"])))
    # A run may be writing the last time just now.
    whole = int((n_points == n_points[0]).sum())
    return {
        name: column[: whole * n_points[0]].reshape(whole, n_points[0])
        for name, column in line.items()
    }


def chosen(line, wanted):
    """The columns to draw: those that are wanted, or all that are not zero."""
    # A line that meets the foundation in a point has nothing to show of it.
    found = [
        name
        for name in line
        if name not in PLACE and np.isfinite(line[name][0]).sum() > 1
    ]
    if wanted:
        return [name for name in found if name in wanted]
    sizes = {name: np.nanmax(np.abs(line[name]), initial=0.0) for name in found}

    def group(name):
        """Components have the size of their tensor."""
        return re.sub("_([xyz]+|[123])$", "", name)

    largest = {}
    for name in found:
        largest[group(name)] = max(largest.get(group(name), 0.0), sizes[name])
    return [
        name for name in found if sizes[name] > 1e-9 * largest[group(name)]
    ][:MOST_PANELS]


def draw(results, options):
    lines = [tables(line) for line in results.lines()]
    if not lines:
        raise NoPicture("the scene has no 'Output/Lines', so there is no line_0.csv")
    wanted = [chosen(line, options.columns) for line in lines]
    if not any(wanted):
        if not options.columns:
            raise NoPicture("nothing but zero along the lines")
        raise NoPicture(
            "no line has the columns " + ", ".join(options.columns) + "; there are "
            + ", ".join(name for name in lines[0] if name not in PLACE)
        )
    # All lines have the same columns.
    rows = [name for name in lines[0] if any(name in names for names in wanted)]
    figure, panels = plt.subplots(
        len(rows),
        len(lines),
        figsize=(5.6 * len(lines) + 1.4, 1.9 * len(rows) + 1.0),
        squeeze=False,
        sharex="col",
        layout="constrained",
    )
    units = Units.of(results)
    length = units.unit("length", [np.ptp(abscissa(line)[0]) for line in lines])
    for i, (line, names) in enumerate(zip(lines, wanted)):
        panels[0, i].set_title(quantities.place("line", i))
        for axes, name in zip(panels[:, i], rows):
            if name in names:
                draw_panel(axes, line, name, units, length)
            else:
                axes.axis("off")
        shown = [axes for axes, name in zip(panels[:, i], rows) if name in names]
        if shown:
            shown[-1].set_xlabel(length.label(abscissa(line)[1]))
            shown[-1].tick_params(labelbottom=True)
    last = max(i for i, names in enumerate(wanted) if names)
    panels[rows.index(wanted[last][0]), last].legend(
        loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, handlelength=1.4
    )
    figure.suptitle(style.plain(results.name), fontsize="large")
    return figure


def draw_panel(axes, line, name, units, length):
    times = some_times(line["t"])
    time = units.unit("time", line["t"])
    words, kind = quantities.field(name)
    unit = units.unit(kind, line[name][np.isfinite(line[name])])
    colors = matplotlib.colormaps["viridis"]
    along = abscissa(line)[0]
    for i, row in enumerate(times):
        axes.plot(
            along[row] / length.size,
            line[name][row] / unit.size,
            color=colors(0.9 * i / max(len(times) - 1, 1)),
            label=f"$t$ = {time.value(line['t'][row, 0])}",
        )
    axes.axhline(0.0, color="#aaaaaa", lw=0.6, zorder=0)
    axes.set_ylabel(unit.label(words), fontsize="small")


def abscissa(line):
    """What a line is drawn over, and words for it: the coordinate that changes if
    there is but one."""
    changing = [axis for axis in "xyz" if axis in line and np.ptp(line[axis][0]) > 0.0]
    if len(changing) == 1:
        return line[changing[0]], f"${changing[0]}$"
    return line["s"], f"length $s$ from {place(line, 0)} to {place(line, -1)}"


def place(line, point):
    """A point of a line as text."""
    axes = [axis for axis in "xyz" if axis in line]
    return "(" + ", ".join(f"{line[axis][0, point]:.4g}" for axis in axes) + ")"
