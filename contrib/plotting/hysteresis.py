# SPDX-License-Identifier: LGPL-2.1-or-later
"""Force over displacement: the loop and its area, which is work."""

import re

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize

from . import style
from .expression import evaluate
from .history import NOISE, window
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
    pattern = r"((friction|contact)_force(_\d+)?|reaction_\d+|load)_[xyz]|axial_force"
    return columns(pattern, statistics)


def columns(pattern, statistics):
    """Those whose names match, with their labels."""
    names = [name for name in statistics if re.fullmatch(pattern, name)]
    return {name: (statistics[name], column(name)[0]) for name in names}


def direction(name):
    """Force and displacement make work where they have the same."""
    return "axial" if name.startswith("axial") else name[-1]


def acts_on(force, results):
    """The boundary that a force acts on, as its number, or the `section'; None where
    several share it, or where the other side is a body, which moves, too."""
    if direction(force) == "axial":
        return "section"
    entries, axis = results.data, "xyz".index(direction(force))
    alone = re.search(r"_(\d+)_[xyz]$", force)
    if force.startswith("load"):
        if not is_zero(entries.get(("Loads", "Body force"), ""), axis):
            return None
        found = {
            section
            for (section, *_), text in entries.items()
            if section.startswith("Boundary") and is_loaded(results, section, axis)
        }
    elif alone:
        found = {f"Boundary {alone.group(1)}"}
    else:
        found = {key[0] for key, text in entries.items() if text == "contact"}
    if len(found) != 1:
        return None
    (section,) = found
    if not force.startswith(("load", "reaction")) and entries.get((section, "Against")):
        return None
    return int(section.split()[-1])


def is_zero(text, axis):
    """Whether a vector of expressions has no such component."""
    component = [part.strip() for part in text.split(";")][axis : axis + 1]
    return component in ([], [""], ["0"], ["free"])


def is_loaded(results, section, axis):
    """Whether a boundary has a load along an axis: pressures act along the normal."""
    if not is_zero(results.data.get((section, "Traction"), ""), axis):
        return True
    if results.data.get((section, "Pressure"), "") in ("", "0"):
        return False
    faces = results.boundary()
    of_it = faces["boundary_id"][faces.cells[:, 0]] == int(section.split()[-1])
    extents = np.ptp(faces.points[faces.cells[of_it]], axis=(0, 1))
    flat = np.nonzero(extents[: results.dimension()] < 1e-6 * faces.size)[0]
    return len(flat) == 0 or axis in flat


def is_moved(displacement, boundary, results):
    """Whether it is that of a boundary: its own, or that of a point on it."""
    if boundary == "section" or displacement.startswith("axial"):
        return boundary == "section" and displacement.startswith("axial")
    kind, number = re.fullmatch(r"([a-z]+)(\d+)_[xyz]", displacement).groups()
    if kind != "point":
        return int(number) == boundary
    places = results.data.get(("Output", "Points"), "").split(";")
    places = [place.rpartition("=")[2] for place in places if place.strip()]
    try:
        place = np.array([float(x) for x in places[int(number)].split(",")])
    except (IndexError, ValueError):
        return False
    faces = results.boundary()
    if faces is None:
        return False
    corners = faces.points[faces.cells][:, :, : len(place)]
    near = 1e-6 * faces.size
    holds = (corners.min(axis=1) <= place + near) & (corners.max(axis=1) >= place - near)
    numbers = faces["boundary_id"][faces.cells[:, 0]]
    return bool((numbers[holds.all(axis=1)] == boundary).any())


def pair(results, options, found_forces, found_displacements):
    """A force and the displacement of what it acts on, by name: those asked for, of
    the others the pair that makes most work."""
    for name, found, what in (
        (options.force, found_forces, "force"),
        (options.displacement, found_displacements, "displacement"),
    ):
        if name is not None and name not in found:
            raise UserError(f'there is no {what} "{name}"; there are ' + ", ".join(found))
    if options.force and options.displacement:
        return options.force, options.displacement

    def moving(found, wanted):
        spans = {name: np.ptp(values) for name, (values, _) in found.items()}
        least = NOISE * max(spans.values(), default=0.0)
        return {n: s for n, s in spans.items() if s > least and wanted in (None, n)}

    pairs = {
        (force, displacement): (
            # What the scene prescribes rather than what a point does.
            not displacement.startswith("point"),
            force.startswith("friction"),
            span * way,
        )
        for force, span in moving(found_forces, options.force).items()
        for displacement, way in moving(found_displacements, options.displacement).items()
        if direction(force) == direction(displacement)
        and is_moved(displacement, acts_on(force, results), results)
    }
    if not pairs:
        raise NoPicture(
            "no force changes where the displacement of what it acts on is known: no "
            "loop to draw; --force and --displacement together draw any two"
        )
    return max(pairs, key=pairs.get)


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
    force, displacement = pair(results, options, possible_forces, possible_displacements)
    for name, found in (
        (force, possible_forces),
        (displacement, possible_displacements),
    ):
        if not np.isfinite(found[name][0]).all():
            raise NoPicture(
                f"{name} is not finite at all of that time: no loop to draw"
            )
    whose = ""
    if direction(force) == direction(displacement) and is_moved(
        displacement, acts_on(force, results), results
    ):
        # Friction and contact forces are those that the body exerts.
        whose = "by" if force.startswith(("friction", "contact")) else "on"
    return draw_loop(
        results,
        statistics["t"],
        possible_displacements[displacement],
        possible_forces[force],
        plane=not any(name.endswith("_z") for name in possible_forces)
        and not results.is_of_revolution(),
        is_axial=direction(force) == "axial",
        whose=whose,
    )


def dissipates(statistics):
    """Whether the scene has an effect that takes energy, so that a path differs on
    the way back."""
    return any(name.endswith("_dissipation") for name in statistics)


def draw_loop(results, t, displacement, force, plane, is_axial, whose):
    """plane: in plane strain forces are those on a unit of thickness; is_axial: the
    force of the whole section over the strain, the displacement of such a unit;
    whose: work `by' the body, negative where it dissipates, or `on' it; empty where
    the force does not act on what moves."""
    (u, u_label), (f, f_label) = displacement, force
    units = Units.of(results)
    time = units.unit("time", results.statistics["t"])
    energy = units.unit("energy", np.ptp(u) * np.ptp(f))
    figure, axes = plt.subplots(figsize=(7.6, 5.6), layout="constrained")
    begin = last_cycle(u, f)
    of = r"N\,d\varepsilon_{zz}" if is_axial else r"F\,dU"
    if begin is not None:
        axes.fill(u[begin:], f[begin:], color=style.SERIES[5], alpha=0.2, lw=0)
        area = rf"loop area $\oint {of}$ = {energy.value(work(u[begin:], f[begin:]))}"
        if whose:
            area += f": work {whose} the body per cycle{' and unit depth' if plane else ''}"
        if begin > 0:
            area += f" (from $t$ = {time.value(t[begin])})"
    else:
        area = rf"open path, $\int {of}$ = {energy.value(work(u, f))}"
        if whose:
            area += f": work {whose} the body{' per unit depth' if plane else ''}"
        area += f" ($t$ = {time.value(t[0])} to {time.value(t[-1])})"
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
