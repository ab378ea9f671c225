# SPDX-License-Identifier: LGPL-2.1-or-later
"""Force over displacement: the loop and its area, which is work."""

import re

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize

from . import style
from .expression import evaluate
from .history import window
from .layout import number_bar
from .quantities import column, place
from .results import NoPicture, UserError
from .units import Units, show

CLOSED = 0.01  # of the extents of the loop


def work(displacement, force):
    """The integral of F dU along the path, by the trapezoidal rule.

    For a closed path it is the area inside, positive clockwise.
    """
    return float(np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(displacement)))


def last_cycle(displacement, force):
    """The index where the last closed cycle begins, or None.

    The path is closed where it comes back to its last point after having left
    its neighborhood.
    """
    points = np.column_stack(
        [
            values / (np.ptp(values) or 1.0)
            for values in (np.asarray(displacement), np.asarray(force))
        ]
    )
    distance = np.linalg.norm(points - points[-1], axis=1)
    away = np.nonzero(distance > 0.2)[0]
    if len(away) == 0:
        return None
    near = np.nonzero(distance[: away[-1]] < CLOSED)[0]
    return int(near[-1]) if len(near) else None


def displacements(results, statistics):
    """What a force may be drawn over: {name: (values, label)}.

    Points come from the statistics; prescribed displacements and motions of
    foundations are expressions of the parameter file, those of t alone.
    """
    found = {}
    t = statistics["t"]
    entries = results.data
    for key, text in entries.items():
        match = re.fullmatch(r"Boundary (\d+)", key[0])
        if not match or len(key) != 2 or not text:
            continue
        role = entries.get((key[0], "Role"))
        if (role, key[1]) == ("displacement", "Displacement"):
            name, symbol = f"boundary{match.group(1)}", "displacement of {}"
        elif (role, key[1]) == ("contact", "Foundation motion"):
            name, symbol = (
                f"foundation{match.group(1)}",
                "motion of the foundation at {}",
            )
        else:
            continue
        for axis, component in zip("xyz", text.split(";")):
            if component.strip() == "free":
                continue
            try:
                values = evaluate(component, t)
            except UserError:
                continue
            found[f"{name}_{axis}"] = values, (
                f"{symbol.format(place('boundary', match.group(1)))}, $U_{axis}$"
            )
    return {**found, **columns(r"point\d+_[xyz]|axial_strain", statistics)}


def forces(statistics):
    pattern = r"(friction|contact)_force_(\d+_)?[xyz]|reaction_\d+_[xyz]|axial_force"
    return columns(pattern, statistics)


def columns(pattern, statistics):
    """Those whose names match, with their labels."""
    names = [name for name in statistics if re.fullmatch(pattern, name)]
    return {name: (statistics[name], column(name)[0]) for name in names}


def direction(name):
    """Force and displacement make work where they have the same."""
    return "axial" if name.startswith("axial") else name[-1]


def partners(name, found):
    """Those that make work per unit depth with a force or displacement: the axial
    force, that of the whole section, with the axial strain alone."""
    is_axial = direction(name) == "axial"
    return {n: f for n, f in found.items() if (direction(n) == "axial") == is_axial}


def choose(name, found, what, preference):
    """The one that was asked for, otherwise the one that moves most."""
    if name is not None:
        if name not in found:
            raise UserError(
                f'there is no {what} "{name}"; there are ' + ", ".join(found)
            )
        return name
    moving = [name for name in found if np.ptp(found[name][0]) > 0.0]
    if not moving:
        return None
    largest = max(np.ptp(found[name][0]) for name in moving)
    moving = [name for name in moving if np.ptp(found[name][0]) > 1e-6 * largest]
    return max(moving, key=lambda name: (preference(name), np.ptp(found[name][0])))


def draw(results, options):
    if not results.statistics:
        raise NoPicture(f"{results.directory} has no statistics.csv with rows")
    statistics = window(results.statistics, options)
    if not (options.force or options.displacement or dissipates(statistics)):
        raise NoPicture(
            "nothing dissipates in the scene, neither friction nor a law, so a force "
            "over a displacement has no loop; --force and --displacement draw it"
        )
    possible_forces = forces(statistics)
    possible_displacements = displacements(results, statistics)
    if not possible_forces:
        raise NoPicture(
            "statistics.csv has neither friction forces nor reactions: no loop to draw"
        )
    if not possible_displacements:
        raise NoPicture(
            "there is no displacement to draw a force over: neither points "
            "('Output/Points') nor displacements that the scene prescribes as "
            "expressions of t"
        )
    if options.displacement:
        possible_forces = partners(options.displacement, possible_forces)
    moving = {
        direction(name) for name, (u, _) in possible_displacements.items() if np.ptp(u) > 0.0
    }
    force = choose(
        options.force,
        possible_forces,
        "force",
        lambda name: (
            direction(name) in moving,
            name.startswith("friction"),
            drives(name, possible_displacements),
            direction(name) == "axial",
        ),
    )
    if force is None:
        raise NoPicture("no force changes in that time: no loop to draw")
    possible_displacements = partners(force, possible_displacements)
    displacement = choose(
        options.displacement,
        possible_displacements,
        "displacement",
        lambda name: (
            direction(name) == direction(force),
            drives(force, [name]),
            name.startswith(("boundary", "foundation")),
        ),
    )
    if displacement is None:
        raise NoPicture("no displacement changes in that time: no loop to draw")
    for name, found in (
        (force, possible_forces),
        (displacement, possible_displacements),
    ):
        if not np.isfinite(found[name][0]).all():
            raise NoPicture(
                f"{name} is not finite at all of that time: no loop to draw"
            )
    return draw_loop(
        results,
        statistics["t"],
        possible_displacements[displacement],
        possible_forces[force],
        plane=not any(name.endswith("_z") for name in possible_forces)
        and not results.is_of_revolution(),
        is_axial=direction(force) == "axial",
        # What moves the body works on it; a foundation is moved by it.
        whose="by" if displacement.startswith("foundation") else "on",
    )


def dissipates(statistics):
    """Whether the scene has an effect that takes energy, so that a path differs on
    the way back."""
    return any(name.endswith("_dissipation") for name in statistics)


def drives(force, names):
    """Whether a reaction belongs to one of the prescribed displacements."""
    match = re.fullmatch(r"reaction_(\d+)_([xyz])", force)
    return bool(match) and f"boundary{match.group(1)}_{match.group(2)}" in names


def draw_loop(results, t, displacement, force, plane, is_axial, whose):
    """plane: in plane strain forces are those on a unit of thickness; is_axial: the
    force of the whole section over the strain, the displacement of such a unit;
    whose: `by' the body, negative where it dissipates, or `on' it."""
    (u, u_label), (f, f_label) = displacement, force
    units = Units.of(results)
    time = units.unit("time", results.statistics["t"])
    energy = units.unit("energy", np.ptp(u) * np.ptp(f))
    figure, axes = plt.subplots(figsize=(7.6, 5.6), layout="constrained")
    begin = last_cycle(u, f)
    of = r"N\,d\varepsilon_{zz}" if is_axial else r"F\,dU"
    if begin is not None:
        axes.fill(u[begin:], f[begin:], color=style.SERIES[5], alpha=0.2, lw=0)
        area = (
            rf"loop area $\oint {of}$ = {energy.value(work(u[begin:], f[begin:]))}: "
            f"work {whose} the body per cycle{' and unit depth' if plane else ''}"
        )
        if begin > 0:
            area += f" (from $t$ = {time.value(t[begin])})"
    else:
        area = (
            rf"open path, $\int {of}$ = {energy.value(work(u, f))}: "
            f"work {whose} the body{' per unit depth' if plane else ''}"
            f" ($t$ = {time.value(t[0])} to {time.value(t[-1])})"
        )
    points = np.column_stack([u, f])
    path = LineCollection(
        np.stack([points[:-1], points[1:]], axis=1),
        array=t[1:],
        norm=Normalize(t[0], t[-1]),
        cmap="viridis",
        linewidths=2.0,
        capstyle="round",
    )
    axes.add_collection(path)
    axes.plot(u, f, color="none")  # the legend avoids lines, not collections
    axes.plot(u[0], f[0], "o", ms=7, mfc="white", mec="black", label="start")
    axes.plot(u[-1], f[-1], "s", ms=6, color="black", label="end")
    axes.axhline(0.0, color="#aaaaaa", lw=0.6, zorder=0)
    axes.axvline(0.0, color="#aaaaaa", lw=0.6, zorder=0)
    axes.margins(0.06)
    axes.autoscale_view()
    kinds = (None, "section force") if is_axial else ("length", "force")
    show(axes.xaxis, u_label, units.unit(kinds[0], u))
    show(axes.yaxis, f_label, units.unit(kinds[1], f))
    axes.legend(loc="best")
    axes.set_title(area, pad=10)
    bar = figure.colorbar(path, ax=axes, pad=0.02)
    number_bar(bar, time.label("time $t$"), time)
    what = "axial force over axial strain" if is_axial else "force over displacement"
    figure.suptitle(style.title(results.name, what), fontsize="large")
    return figure
