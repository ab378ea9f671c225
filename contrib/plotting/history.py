# SPDX-License-Identifier: LGPL-2.1-or-later
"""The main columns of the statistics over time."""

import math
import re
import textwrap

import matplotlib.pyplot as plt
import numpy as np

from . import derived, quantities, style
from .results import NoPicture, Results, UserError, by_numbers
from .units import Unit, Units, powers, show, si


class Panel:
    """One diagram: columns that share a unit.

    label       words at its axis
    columns     names, or patterns of names, of the statistics
    logarithmic values of many orders of magnitude, drawn by their size
    steps       a value holds for a step, not for an instant
    changing    to be left out where nothing changes
    share_of    a column: values are given in per cent of its largest one
    """

    def __init__(
        self,
        label,
        columns,
        logarithmic=False,
        steps=False,
        changing=False,
        share_of=None,
    ):
        self.label = label
        self.columns = columns
        self.logarithmic = logarithmic
        self.steps = steps
        self.changing = changing
        self.share_of = share_of

    def chosen(self, statistics):
        """Those of its columns that say something: not zero at all times."""
        found = [
            name
            for pattern in self.columns
            for name in statistics
            if re.fullmatch(pattern, name)
        ]
        sizes = {
            name: np.abs(finite(statistics[name])).max(initial=0.0) for name in found
        }
        largest = max(sizes.values(), default=0.0)
        if largest <= 0.0:
            return []
        if is_rounding(self.columns[0], largest, statistics):
            return []
        if self.changing and not any(np.ptp(statistics[name]) for name in found):
            return []
        # Against rounding in components that vanish by symmetry.
        threshold = 0.0 if self.logarithmic or self.steps else 1e-9 * largest
        if self.share_of is not None:
            # What nobody could see in the picture.
            threshold = 1e-3 * largest
        return [name for name in found if sizes[name] > threshold]


# Of the largest force in a run; forces below it are of the solver's tolerance.
NOISE = 1e-5


def is_rounding(name, size, statistics):
    """Whether a gap is nothing beside the displacements, a friction force beside all
    forces, or the work of an axial force beside the energy that is stored."""

    def largest(name):
        return np.abs(finite(statistics.get(name, np.zeros(1)))).max(initial=0.0)

    if name == "axial_force":
        return 0.0 < size * largest("axial_strain") < 1e-9 * largest("stored_energy")
    if name.startswith("friction_force"):
        forces = r"(contact_force|load|reaction)_\w+"
        others = [largest(other) for other in statistics if re.fullmatch(forces, other)]
        return size < NOISE * max(others, default=0.0)
    return name == "max_gap" and size < 1e-9 * largest("max_displacement")


AREA = Panel(
    "part of\nthe face", ["slip_area", "stick_area", "contact_area"], steps=True
)
STEP_SIZE = Panel("step size", ["k", "step_limit"], logarithmic=True, steps=True)
CELLS = Panel("cells", ["cells"], steps=True, changing=True)
ERROR = Panel(
    "error in the\nenergy norm",
    [
        "error_energy",
        *(
            f"estimate_{part}"
            for part in ("space", "time", "friction", "transfer", "initial", "total")
        ),
    ],
    share_of="energy_norm",
)
QUANTITY = Panel(
    "error of the\nquantity of interest",
    ["quantity_correction", "quantity_space", "quantity_time", "quantity_total"],
)

PANELS = (
    Panel("friction force\nexerted by the body", ["friction_force_(\\d+_)?[xyz]"]),
    Panel("contact force\nexerted by the body", ["contact_force_(\\d+_)?[xyz]"]),
    Panel("axial force", ["axial_force"]),
    Panel("axial strain", ["axial_strain"]),
    Panel("reactions\non the body", ["reaction_(point|edge)?\\d+_[xyz]"]),
    Panel("loads on the body", ["load_[xyz]"]),
    AREA,
    Panel("contact pressure", ["max_pressure"]),
    Panel("gap", ["max_gap"]),
    Panel(
        "energy",
        [
            "external_work",
            "thermal_work",
            "stored_energy",
            "viscous_dissipation",
            "friction_dissipation",
            "adaptation_energy",
            "construction_energy",
        ],
    ),
    Panel("displacement", ["max_displacement", "point\\d+_[xyz]"]),
    Panel("stress", ["max_von_mises", "mean_von_mises"]),
    Panel("capped volume", ["capped_volume"], steps=True),
    Panel(
        "iterations",
        ["contact_iterations", "linear_iterations", "bound_iterations"],
        steps=True,
    ),
    STEP_SIZE,
    CELLS,
    Panel("estimate\nof the mesh", ["estimator"]),
    ERROR,
    QUANTITY,
    Panel(
        "relative error",
        ["algebraic_error", "force_balance_defect"],
        logarithmic=True,
        steps=True,
    ),
)

NAMES = {
    "error_energy": "true error",
    "estimate_space": "mesh",
    "estimate_time": "time steps",
    "estimate_friction": "slip that turns or rests",
    "estimate_transfer": "new meshes",
    "estimate_initial": "initial data",
    "estimate_total": "all",
    "quantity_correction": "with its sign",
    "quantity_space": "mesh",
    "quantity_time": "time steps",
    "quantity_total": "all",
    "contact_iterations": "contact",
    "linear_iterations": "linear",
    "bound_iterations": "of the bounds",
    "contact_area": "touches",
    "max_pressure": "largest",
    "max_gap": "largest",
    "slip_area": "slips",
    "stick_area": "sticks",
    "k": "step $k$",
    "step_limit": "limit $2/r$",
    "algebraic_error": "algebraic",
    "force_balance_defect": "force balance",
    "max_von_mises": "largest von Mises",
    "mean_von_mises": "mean von Mises",
}


COLORS = {
    "slip_area": style.SLIP,
    "stick_area": style.OUTLINE,
    "contact_area": style.SERIES[0],
}


def label(name):
    """A short name of a column for a legend."""
    if name in NAMES:
        return NAMES[name]
    match = re.fullmatch(r"(friction_force|contact_force|load)_([xyz])", name)
    if match:
        return f"${match.group(2)}$"
    match = re.fullmatch(r"(?:friction|contact)_force_(\d+)_([xyz])", name)
    if match:
        where = quantities.place("boundary", match.group(1))
        return f"on {where}, ${match.group(2)}$"
    match = re.fullmatch(r"reaction_(point|edge)(\d+)_([xyz])", name)
    if match:
        return f"support {match.group(1)} {match.group(2)}, ${match.group(3)}$"
    match = re.fullmatch(r"(reaction|point)_?(\d+)_([xyz])", name)
    if match:
        what = "boundary" if match.group(1) == "reaction" else "point"
        return f"{quantities.place(what, match.group(2))}, ${match.group(3)}$"
    return quantities.plain(re.sub("^max_", "largest ", name).replace("_", " "))


def finite(values):
    return values[np.isfinite(values)]


def window(statistics, options):
    """The rows between the times that were asked for."""
    t = statistics.get("t", np.array([]))
    chosen = np.ones(len(t), dtype=bool)
    slack = 1e-9 * np.abs(t).max(initial=0.0)
    if options.begin is not None:
        chosen &= t >= options.begin - slack
    if options.until is not None:
        chosen &= t <= options.until + slack
    if options.log_time:
        chosen &= t > 0.0
    if chosen.sum() < 2:
        raise NoPicture(
            "statistics.csv has fewer than two rows in that time: no history to draw"
        )
    return {name: column[chosen] for name, column in statistics.items()}


class Overlay:
    """Another run over this one: its name and rows, in the units of this one."""

    def __init__(self, results, options, of):
        self.name = results.name
        if results.name == of.name:
            self.name = f"{results.directory.parent.name}/{results.name}"
        mine, units = Units.of(of), Units.of(results)
        factors = {}
        for name in ("length", "time", "stress"):
            here, there = (u.declared.get(name) for u in (mine, units))
            both = [si(name, text) for text in (here, there) if text]
            if (here is None) != (there is None) or None in both and here != there:
                raise UserError(
                    f"{of.name} and {results.name} have other units of {name}: one "
                    "cannot be drawn over the other"
                )
            factors[name] = (
                both[1] / both[0] if len(both) == 2 and here != there else 1.0
            )
        # The columns are scaled, expressions of them are not anymore.
        self.statistics = {
            name: values
            * factor_of(quantities.column(name)[1], factors, mine.dimension)
            for name, values in window(results.statistics, options).items()
        }


def factor_of(kind, factors, dimension):
    exponents = powers(kind, dimension) if kind else (0, 0, 0)
    sizes = [factors[name] for name in ("stress", "length", "time")]
    return math.prod(size**power for size, power in zip(sizes, exponents))


def draw(results, options):
    others = [Results(directory) for directory in options.overlay]
    # Columns that are joined by + share a panel.
    named = (by_numbers(group, results) for group in options.columns or [])
    groups = [derived.split(group, "+") for group in named]
    for run in (results, *others):
        dimension = Units.of(run).dimension
        for name in sum(groups, []):
            derived.add(run, name, dimension)
    statistics = window(results.statistics, options)
    others = [Overlay(run, options, results) for run in others]
    if options.columns:
        panels = [
            (alone(group[0]), group) if len(group) == 1 else together(group)
            for group in groups
        ]
        names = sum(groups, [])[:2]
        labels = [quantities.column(name)[0] for name in names]
        what = ", ".join(map(quantities.in_titles, labels))
        if len(sum(groups, [])) > len(names):
            one = panels[0][0].label if len(panels) == 1 else "some quantities"
            what = f"{one} over time"
        return draw_panels(results, panels, statistics, what, options, others)
    panels = those_with_something(PANELS, statistics)
    what = "forces, energies, errors over time"
    return draw_panels(results, panels, statistics, what, options, others)


def alone(name):
    """A panel for one column, whose label says all of it."""
    words, _ = quantities.column(name)
    return Panel(textwrap.fill(words, 22), [name], steps=name.endswith("_area"))


def together(names):
    """A panel for several columns of one kind, and these."""
    kinds = {quantities.column(name)[1] for name in names}
    if len(kinds) > 1:
        raise UserError(f"{'+'.join(names)}: these columns have not the same unit")
    words = quantities.in_titles(quantities.column(names[0])[0])
    return Panel(words.split(" of ")[0], []), names


def those_with_something(panels, statistics):
    """Panels with the columns that they show."""
    chosen = [(panel, panel.chosen(statistics)) for panel in panels]
    return [(panel, names) for panel, names in chosen if names]


def draw_panels(results, panels, statistics, what, options, others=()):
    units = Units.of(results)
    time = units.unit("time", results.statistics["t"])
    columns = 1 if len(panels) < 4 else 2
    rows = -(-len(panels) // columns)
    figure = plt.figure(
        figsize=(8.0 if columns == 1 else 13.0, 1.9 * rows + 0.8),
        layout="constrained",
    )
    grid = figure.add_gridspec(rows, columns)
    for i, (panel, names) in enumerate(panels):
        row, column = divmod(i, columns)
        alone = i == len(panels) - 1 and column == 0  # takes the whole row
        axes = figure.add_subplot(grid[row, :] if alone else grid[row, column])
        runs = [("", statistics)]
        if others:
            runs = [(results.name, statistics)]
            runs += [(other.name, other.statistics) for other in others]
        draw_panel(axes, panel, names, runs, units)
        draw_tolerance(axes, tolerance(results, panel))
        ends = [run["t"] for _, run in runs]
        if options.log_time:
            axes.set_xscale("log")
            axes.set_xlim(min(t.min() for t in ends), max(t.max() for t in ends))
            style.numbers_on_logarithmic_axis(axes.xaxis, 1.0 / time.size)
            axes.set_xlabel(time.label("time $t$"))
        else:
            axes.set_xlim(*padded(np.concatenate(ends)))
            show(axes.xaxis, "time $t$", time)
        if row < rows - 1:
            axes.set_xlabel("")
        if row < rows - 1 and (row < rows - 2 or len(panels) % columns == 0):
            axes.tick_params(labelbottom=False)
    figure.suptitle(style.title(results.name, what), fontsize="large")
    return figure


def place_legend(axes, handles, labels):
    axes.legend(
        handles,
        labels,
        loc="center left",
        bbox_to_anchor=(1.0, 0.5),
        frameon=False,
        handlelength=1.4,
    )


def tolerance(results, panel):
    """What the error had to stay below, if the scene has set that: in per cent of the
    energy norm, or a number beside the quantity of interest."""
    try:
        share = float(results.data.get(("Error control", "Tolerance"), 0.0))
    except ValueError:
        return None
    of_quantity = results.about().get("estimated_error_of_quantity")
    if not share > 0.0 or panel is not (QUANTITY if of_quantity else ERROR):
        return None
    if of_quantity:
        return share * (of_quantity["largest_value"] or np.nan)
    return 100.0 * share


def draw_tolerance(axes, limit):
    if limit is not None and np.isfinite(limit):
        axes.axhline(limit, color="#222222", lw=1.0, ls=":", label="tolerance")
        handles, labels = axes.get_legend_handles_labels()
        if axes.get_legend():
            place_legend(axes, handles, labels)


def padded(t):
    margin = 0.01 * np.ptp(t)
    return t.min() - margin, t.max() + margin


def unit_of(panel, names, statistics, units):
    """The unit that the columns of a panel share."""
    if panel.share_of in statistics:
        return Unit(1.0, "%")
    kind = quantities.column(names[0])[1]
    values = np.concatenate([finite(statistics[name]) for name in names])
    if panel.logarithmic:
        # The limit of the first steps may be that of nothing at all.
        values = values[values > 0.0]
        if kind is None:
            return Unit(1.0, "")
        return units.unit(kind, [np.median(values)] if len(values) else [])
    return units.unit(kind, values)


def draw_panel(axes, panel, names, runs, units):
    """Runs are (name, statistics), of which the first one says what is drawn, and
    the others are dashed; without others it has no name."""
    statistics = runs[0][1]
    for number, (run, of_run) in enumerate(runs):
        shown = [name for name in names if name in of_run]
        draw_run(axes, panel, names, shown, of_run, run, number)
    unit = unit_of(panel, names, statistics, units)
    if panel.logarithmic:
        axes.set_yscale("log")
        style.numbers_on_logarithmic_axis(axes.yaxis, 1.0 / unit.size)
        axes.set_ylabel(unit.label(panel.label))
    else:
        counted = "iterations" in panel.label or "cells" in panel.label
        if panel.steps:
            axes.set_ylim(bottom=0.0)
        else:
            axes.axhline(0.0, color="#aaaaaa", lw=0.6, zorder=0)
        show(axes.yaxis, panel.label, unit, integer=counted)
    # Longer lines run into the labels of the panels above and below.
    words = axes.get_ylabel()
    if max(map(len, words.split("\n"))) > 20:
        axes.set_ylabel(words.replace(" [", "\n["))
    if len(names) > 1 or panel.columns != names or len(runs) > 1:
        place_legend(axes, *axes.get_legend_handles_labels())


def draw_run(axes, panel, names, shown, statistics, run, number):
    """The lines of one run; with a name they are the run's."""
    t = statistics["t"]
    few = len(t) < 12
    scale = 1.0
    if panel.share_of in statistics:
        scale = 100.0 / max(finite(statistics[panel.share_of]).max(), 1e-300)
    for name in shown:
        i = names.index(name)
        values = scale * statistics[name].astype(float)
        dashes = ("-", "--", ":", "-.")[(i // 7 + number) % 4]
        color = COLORS.get(name, style.SERIES[i % 7])
        if panel.logarithmic:
            values = np.where(np.isfinite(values) & (values > 0.0), values, np.nan)
        if name == "step_limit" and "k" in names:
            # At first it may be that of nothing at all.
            values = np.where(values < 1e3 * statistics["k"].max(), values, np.nan)
        if name == "slip_area" and number == 0:
            axes.fill_between(t, values, step="pre", color=style.SLIP, alpha=0.2, lw=0)
        axes.plot(
            t,
            values,
            color=color,
            ls=dashes,
            lw=1.4,
            marker="." if few else None,
            drawstyle="steps-pre" if panel.steps else "default",
            label=(
                quantities.plain(run)
                if run and len(names) == 1
                else f"{label(name)}, {quantities.plain(run)}"
                if run
                else label(name)
            ),
        )
