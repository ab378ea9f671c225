# SPDX-License-Identifier: LGPL-2.1-or-later
"""Compare two runs of one scene: meshes, active sets, numbers and fields.

Nothing is asserted here: compare() measures, tests bound what it finds.
"""

import dataclasses

import numpy as np

from harness import DEFECTS, EFFORT, lattice

# What vanishes or cancels is rounding of something else: each column (by the
# beginning of its name) or field is compared with the largest of its family.
COLUMN_FAMILIES = (
    ("friction_force_", "reaction_", "load_"),
    ("energy_norm", "estimate_", "error_energy", "error_memory"),
    ("stored_energy", "strain_energy", "external_work"),
    ("stored_energy", "viscous_dissipation", "friction_dissipation"),
    ("max_displacement", "max_slip", "point"),
)
FIELD_FAMILIES = {
    "slip": ("solution displacement",),
    "slip_rate": ("solution velocity",),
    "traction": ("contact bound",),
}

# Of a slip rate or a bound: how much may be rounding at a tie.
TIE = 1e-6


@dataclasses.dataclass
class Comparison:
    """What differs between two runs."""

    # {name: largest difference over the size of its family}
    columns: dict = dataclasses.field(default_factory=dict)
    fields: dict = dataclasses.field(default_factory=dict)
    # friction points, summed over the outputs; of them with another set but the
    # same solution, since they are at the bound and do not move; and the others
    n_points: int = 0
    n_ties: int = 0
    flips: list = dataclasses.field(default_factory=list)
    # what cannot be compared: names of columns, numbers of steps, meshes
    unlike: list = dataclasses.field(default_factory=list)

    def worst(self, kind):
        """(largest difference, name) of columns or fields"""
        found = getattr(self, kind).items()
        return max(((v, name) for name, v in found), default=(0.0, "none"))


def relative(one, other, size):
    """Largest difference over the size; equal infinities and nan are equal."""
    with np.errstate(invalid="ignore"):
        difference = np.where(one == other, 0.0, abs(other - one))
    difference = difference[~(np.isnan(one) & np.isnan(other))]
    if np.isnan(difference).any():
        return np.inf
    # where a whole family cancels, rounding of numbers of size one is left
    largest = max(0.0, difference.max(initial=0.0) - 1e-14)
    return largest / size if largest > 0 else 0.0


def largest(arrays):
    return max((abs(a[np.isfinite(a)]).max(initial=0.0) for a in arrays), default=0.0)


def family(name, names):
    """Columns with whose size the column of that name is compared."""
    for beginnings in COLUMN_FAMILIES:
        if name.startswith(beginnings):
            return [n for n in names if n.startswith(beginnings)]
    return [name]


def compare_columns(one, other, result):
    a, b = one.statistics, other.statistics
    if list(a) != list(b):
        result.unlike.append("columns")
        return
    if len(a["t"]) != len(b["t"]):
        result.unlike.append(f"steps: {len(a['t'])} and {len(b['t'])}")
        return
    for name in a:
        if name in EFFORT | DEFECTS or name.startswith("wall_"):
            continue
        if name == "velocity_variation":
            # the root of a sum of squares, whose rounding it magnifies
            size = largest([a[name]]) ** 2
            result.columns[name] = relative(a[name] ** 2, b[name] ** 2, size)
            continue
        size = largest([a[n] for n in family(name, a)])
        result.columns[name] = relative(a[name], b[name], size)


def corners(fields):
    """Indices of the corners of all cells in an order that does not depend on
    who wrote them, and their key: neighbors may disagree at a point."""
    points = fields.points[fields.cells]
    centers = np.broadcast_to(points.mean(axis=1)[:, None], points.shape)
    key = np.concatenate([lattice(centers), lattice(points)], axis=2)
    key = key.reshape(fields.cells.size, -1)
    order = np.lexsort(key.T)
    return order, key[order]


def values_at_corners(fields, order):
    values = {k: v[fields.cells.ravel()[order]] for k, v in fields.point_data.items()}
    cell = order // fields.cells.shape[1]
    values.update({k: v[cell] for k, v in fields.cell_data.items()})
    return values


def paired(one, other, name, result):
    """[(time, fields of one, fields of the other)], in the same order."""
    a, b = one.series(name), other.series(name)
    # lengths of steps that errors choose hold what the solves leave
    times = [np.array([time for time, _ in run]) for run in (a, b)]
    if len(a) != len(b) or not np.allclose(*times, rtol=1e-7, atol=0):
        result.unlike.append(f"times of {name}.pvd")
        return []
    pairs = []
    for index, (time, _) in enumerate(a):
        fields = one.fields(name, index), other.fields(name, index)
        (order, key), (other_order, other_key) = map(corners, fields)
        if not np.array_equal(key, other_key):
            result.unlike.append(f"mesh of {name} at t = {time:g}")
            return []
        pairs.append(
            (
                time,
                values_at_corners(fields[0], order),
                values_at_corners(fields[1], other_order),
            )
        )
    return pairs


def compare_fields(series, result):
    """series: {name: pairs}"""
    sizes = {
        f"{name} {key}": largest([a[key] for _, a, _ in pairs])
        for name, pairs in series.items()
        for key in (pairs[0][1] if pairs else {})
    }
    for label in sizes:
        name, key = label.split()
        if key in ("subdomain", "stick", "utilisation"):
            continue
        like = [label, *FIELD_FAMILIES.get(key, ())]
        if "stress_" in key:  # all components
            like = [n for n in sizes if n.startswith(label[: label.rindex("_")])]
        size = max(sizes[n] for n in like if n in sizes)
        result.fields[label] = max(
            relative(a[key], b[key], size) for _, a, b in series[name]
        )


def compare_sets(pairs, result):
    fastest = max((largest([a["slip_rate"]]) for _, a, _ in pairs), default=0.0)
    for time, *both in pairs:
        sticks, loads = ([v[key] for v in both] for key in ("stick", "utilisation"))
        rates = [np.linalg.norm(v["slip_rate"], axis=1) for v in both]
        result.n_points += len(sticks[0])
        differs = sticks[0] != sticks[1]
        tie = np.logical_and.reduce(
            [rate <= TIE * fastest for rate in rates]
            + [load >= 1 - TIE for load in loads]
        )
        result.n_ties += int((differs & tie).sum())
        result.flips += [
            f"t = {time:g}: stick {sticks[0][i]:g} and {sticks[1][i]:g}, "
            f"slip rate {rates[0][i]:.3g} and {rates[1][i]:.3g} of {fastest:.3g}, "
            f"utilisation {loads[0][i]:.8g} and {loads[1][i]:.8g}"
            for i in np.flatnonzero(differs & ~tie)
        ]


def compare_touching(pairs, result):
    """Where contact that opens is closed."""
    largest_pressure = max(largest([a["contact_pressure"]]) for _, a, _ in pairs)
    largest_gap = max(largest([a["gap"]]) for _, a, _ in pairs)
    for time, *both in pairs:
        pressures, gaps = (
            [v[key] for v in both] for key in ("contact_pressure", "gap")
        )
        result.n_points += len(gaps[0])
        differs = (pressures[0] > 0) != (pressures[1] > 0)
        tie = np.logical_and.reduce(
            [pressure <= TIE * largest_pressure for pressure in pressures]
            + [gap <= TIE * largest_gap for gap in gaps]
        )
        result.n_ties += int((differs & tie).sum())
        result.flips += [
            f"t = {time:g}: pressure {pressures[0][i]:.3g} and {pressures[1][i]:.3g}, "
            f"gap {gaps[0][i]:.3g} and {gaps[1][i]:.3g}"
            for i in np.flatnonzero(differs & ~tie)
        ]


def compare(one, other):
    """Measure what differs between two finished runs of one scene."""
    result = Comparison()
    compare_columns(one, other, result)
    names = ["solution", *["contact"] * (one.directory / "contact.pvd").exists()]
    series = {name: paired(one, other, name, result) for name in names}
    compare_fields(series, result)
    contact = series.get("contact")
    if contact and "contact_pressure" in contact[0][1]:
        compare_touching(contact, result)
        if result.n_ties > 0:
            result.columns.pop("contact_area", None)
    # contact that opens has these areas also where nothing has friction
    if "stick_area" in one.statistics and contact and "stick" in contact[0][1]:
        compare_sets(contact, result)
        if result.n_ties > 0:  # then these areas are matters of taste
            result.columns.pop("stick_area", None)
            result.columns.pop("slip_area", None)
    return result
