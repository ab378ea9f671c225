# SPDX-License-Identifier: LGPL-2.1-or-later
"""Markdown tables from studies; functions of what they are given."""

import numpy as np

from plotting import rates
from plotting.study import LEVELS, VARIANT

UNKNOWN = "–"
NORMS = ("error_energy", "error_h1", "error_stress", "error_multiplier")


def table(header, rows):
    """Markdown; columns whose cells are all numbers are set to the right."""
    if not rows:
        return "(nothing)\n"
    right = [all(is_number(row[i]) for row in rows) for i in range(len(header))]
    lines = [header, ["---:" if number else "---" for number in right], *rows]
    return "".join(f"| {' | '.join(map(str, line))} |\n" for line in lines)


def is_number(text):
    text = str(text).strip("*_ ")
    for unit in (" s", " %", " MB"):
        text = text.removesuffix(unit)
    if text == UNKNOWN:
        return True
    try:
        float(text)
    except ValueError:
        return False
    return True


def number(value, digits=3):
    """A few digits, without a power of ten where none is needed."""
    if value is None or not np.isfinite(value):
        return UNKNOWN
    text = f"{value:.{digits}g}"
    if "e" in text and 1e-5 < abs(value) < 1e7:
        value = float(text)
        text = f"{value:.0f}" if abs(value) >= 1 else f"{value:.7f}".rstrip("0")
    return text


def order(value):
    return UNKNOWN if value is None else f"{round(value, 2) + 0.0:.2f}"


def percent(value):
    known = value is not None and not np.isnan(value)
    return f"{number(100 * value, 2)} %" if known else UNKNOWN


def seconds(value):
    return f"{number(value, 2)} s"


def ladder_of(study, name, variant=None):
    """The ladder of that name, of the first variant if none is given, or None."""
    variant = variant or study.variants()[0]
    for ladder in study.ladders():
        if ladder.name == name and ladder.variant == variant:
            return ladder
    return None


def orders(study, name, variant=None):
    """The order at the fine end of a ladder, for each of NORMS, or None."""
    ladder = ladder_of(study, name, variant)
    if ladder is None:
        return [None] * len(NORMS)
    sizes = ladder.k if name == "time" else ladder.h
    return [
        rates.final_order(sizes, study[norm][ladder.rows]) if norm in study else None
        for norm in NORMS
    ]


def of_variant(study, name, variant):
    """The known values of a column in the runs of a variant."""
    if name not in study:
        return np.array([])
    values = study[name][rows_of(study, variant)]
    return values[rates.known(values)]


def rows_of(study, variant):
    variants = list(zip(*(study[name] for name in VARIANT)))
    return np.array([i for i, other in enumerate(variants) if other == variant])


CONVERGENCE_HEADER = (
    "scene",
    "law",
    "friction",
    "d",
    "mesh",
    "scheme",
    "h alone",
    "k alone",
    "h and k",
    "smallest error",
    "effectivity",
)


def convergence_rows(studies, facts):
    """Lines of the table of all manufactured solutions, one for each variant.

    studies  {ladder: the study that has it}
    facts    scene, law, friction, d, mesh
    """
    rows = []
    for variant in studies["both"].variants():
        errors, indices = (
            np.concatenate([of_variant(study, name, variant) for study in studies.values()])
            for name in ("error_energy", "effectivity")
        )
        rows.append(
            [
                *(facts[name] for name in ("scene", "law", "friction", "d", "mesh")),
                variant[VARIANT.index("scheme")],
                *(
                    " / ".join(map(order, orders(studies[name], name, variant)))
                    for name in ("space", "time", "both")
                ),
                percent(errors.min()) if len(errors) else UNKNOWN,
                f"{indices.min():.2f} to {indices.max():.2f}"
                if len(indices)
                else UNKNOWN,
            ]
        )
    return rows


ORDERS_HEADER = (
    "law",
    "d",
    "ways",
    "h and k: u",
    "stress",
    "multiplier",
    "k alone: u",
    "smallest error of u",
    "effectivity",
)


def orders_by_law(rows):
    """Lines of the page, one for each law and dimension, from convergence_rows(): the
    least and the largest order of all meshes, schemes and laws of friction."""
    groups = {}
    for row in rows:
        cells = dict(zip(CONVERGENCE_HEADER, row))
        groups.setdefault((cells["law"], cells["d"]), []).append(cells)

    def between(values, digits=2):
        known = [value for value in values if value is not None]
        if not known:
            return UNKNOWN
        least, largest = (f"{value:.{digits}f}" for value in (min(known), max(known)))
        return least if least == largest else f"{least} to {largest}"

    def orders_of(group, ladder, norm, least=-np.inf):
        texts = [cells[ladder].split(" / ")[NORMS.index(norm)] for cells in group]
        values = [float(text) for text in texts if text != UNKNOWN]
        return [value for value in values if value >= least]

    lines = []
    for (law, d), group in sorted(groups.items()):
        lines.append(
            [
                law,
                d,
                len(group),
                *(
                    between(orders_of(group, "h and k", norm))
                    for norm in ("error_energy", "error_stress", "error_multiplier")
                ),
                # Below, it is the error of the mesh that is left.
                between(orders_of(group, "k alone", "error_energy", least=0.5)),
                min(
                    (cells["smallest error"] for cells in group),
                    key=lambda text: float(text.split()[0]),
                ),
                between(
                    [
                        float(word)
                        for cells in group
                        for word in cells["effectivity"].split(" to ")
                        if word != UNKNOWN
                    ]
                ),
            ]
        )
    return lines


LOW_REGULARITY_HEADER = (
    "scene",
    "what is not smooth",
    "strategy",
    "scheme",
    "h alone",
    "k alone",
    "h and k",
    "smallest error",
)


def low_regularity_rows(name, why, study):
    """As convergence_rows(), for solutions that nobody knows."""
    facts = dict.fromkeys(("scene", "law", "friction", "d", "mesh"))
    rows = convergence_rows(dict.fromkeys(("space", "time", "both"), study), facts)
    return [
        [name, why, *variant[:2], *row[6:10]] for variant, row in zip(study.variants(), rows)
    ]


def without_other_norms(rows):
    """Lines of the page from low_regularity_rows(): orders in the energy norm alone,
    and none where the error is that of something else than the ladder."""

    def energy(cell):
        text = cell.split(" / ")[NORMS.index("error_energy")]
        return text if text != UNKNOWN and float(text) >= 0.5 else UNKNOWN

    return [[row[0], *row[2:4], *map(energy, row[4:7]), row[7]] for row in rows]


def offer(study, variant, tolerance, error):
    """The line of the price list of study.json for a variant, or None."""
    for offered in study.about.get("prices", ()):
        if (
            isinstance(offered, dict)
            and offered.get("error") == error
            and all(offered.get(name) == part for name, part in zip(VARIANT, variant))
            and abs((offered.get("tolerance") or 0.0) / tolerance - 1) < 1e-6
        ):
            return offered if offered.get("seconds") is not None else None
    return None


def price(study, variant, tolerance, error):
    """What an error of `tolerance` costs: {seconds, cells, steps, memory,
    measured}, or None.

    Measured where a run of the study is accurate enough, the cheapest of
    them; otherwise what the price list of the study predicts.
    """
    rows = rows_of(study, variant)
    best = rates.cheapest_within(
        tolerance, study["seconds_total"][rows], study[error][rows]
    )
    if best is not None:
        row = rows[best]
        return {
            "seconds": float(study["seconds_total"][row]),
            "cells": float(np.round(study["cells"][row])),  # mean of the steps
            "steps": float(study["steps"][row]),
            "memory": float(study["peak_memory_MB"][row]),
            "measured": True,
        }
    offered = offer(study, variant, tolerance, error)
    if offered is None:
        return None
    finest = max(rows, key=lambda row: study["dofs"][row])
    cells_per_dof = study["cells"][finest] / study["dofs"][finest]
    return {
        "seconds": offered["seconds"],
        "cells": round((offered.get("dofs") or np.nan) * cells_per_dof, -1),
        "steps": round(offered.get("steps") or 0) or None,
        "memory": offered.get("memory_MB"),
        "measured": False,
    }


# What nobody would run here: seconds, and the memory (MB) of a good workstation.
LONGEST = 3600
LARGEST = 16e3


def price_cell(found, is_cheapest):
    """Seconds bold where no other variant is cheaper, all italic if predicted."""
    if found is None:
        return UNKNOWN
    if not within_reach(found):
        return "*out of reach*"
    time = seconds(found["seconds"])
    rest = ", ".join(
        f"{number(found[name], digits)}{unit}"
        for name, digits, unit in (
            ("cells", 9, " cells"),
            ("steps", 9, " steps"),
        )
        if found[name] is not None and np.isfinite(found[name])
    )
    if is_cheapest:
        time = f"**{time}**"
    text = f"{time}: {rest}" if rest else time
    return text if found["measured"] else f"*{text}*"


def price_header(tolerances):
    return ("scene", *VARIANT, *(percent(tolerance) for tolerance in tolerances))


def best_seconds(prices):
    """The least of what was measured, or else of what is predicted."""
    prices = [price for price in prices if price]
    measured = [price for price in prices if price["measured"]]
    return min((price["seconds"] for price in measured or prices), default=None)


def within_reach(found):
    measured = found["measured"]
    return measured or found["seconds"] <= LONGEST and (found["memory"] or 0) <= LARGEST


def price_rows(name, study, tolerances, error):
    """A line for each strategy, of its cheapest scheme at the smallest errors, and a
    column for each tolerance."""
    variants = study.variants()
    found = [[price(study, variant, eps, error) for eps in tolerances] for variant in variants]
    cheapest = [best_seconds([line[i] for line in found]) for i in range(len(tolerances))]

    def at_smallest_errors(line):
        return [
            cell["seconds"] if cell and within_reach(cell) else np.inf
            for cell in reversed(line)
        ]

    strategy = VARIANT.index("strategy")
    lines = {}
    for variant, line in zip(variants, found):
        best = lines.get(variant[strategy])
        if best is None or at_smallest_errors(line) < at_smallest_errors(best[1]):
            lines[variant[strategy]] = variant, line
    return [
        [
            name,
            *variant,
            *(
                price_cell(cell, cell and cell["seconds"] == best)
                for cell, best in zip(line, cheapest)
            ),
        ]
        for variant, line in lines.values()
    ]


FIT_HEADER = (*VARIANT, "C_h", "p", "C_k", "q", "off by", "at worst")


def fit_rows(study, error):
    """C_h h^p + C_k k^q of each variant, and the factors by which it misses the
    runs, as far as they are known."""
    rows = []
    for variant in study.variants():
        fit = study.fit(variant, error)
        if fit:
            values = (fit.get(name) for name in ("C_h", "p", "C_k", "q"))
            deviation = fit.get("rms_of_log")
            rows.append(
                [
                    *variant,
                    *map(number, values),
                    number(None if deviation is None else np.exp(deviation)),
                    number(fit.get("worst_factor")),
                ]
            )
    return rows


KNOWN_TO_TOLERANCE_HEADER = (
    "scene",
    "law",
    "tolerance",
    "estimated",
    "true error",
    "of the tolerance",
    "cells",
    "steps",
    "seconds",
)


def estimate_of(columns):
    """The largest estimate of a run over the largest energy norm."""
    return columns["estimate_total"].max() / columns["energy_norm"].max()


def size_cells(columns):
    """Cells, steps and seconds of a run."""
    return (
        number(columns["cells"].max(), 9),
        number(columns["step"].max(), 9),
        seconds(columns["wall_total"][-1]),
    )


def error_of(columns):
    """The largest error of a run over the largest norm, where it is known."""
    return np.nanmax(columns["error_energy"]) / np.nanmax(columns["exact_energy"])


def known_to_tolerance_row(scene, law, tolerance, columns):
    """A run to a tolerance whose solution is known."""
    error = error_of(columns)
    return [
        scene,
        law,
        percent(tolerance),
        percent(estimate_of(columns)),
        percent(error),
        number(error / tolerance, 2),
        *size_cells(columns),
    ]


def in_groups(rows, n_columns):
    """{the first cells: the rows that have them}"""
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[:n_columns]), []).append(row)
    return groups


def span(texts):
    """From the first to the last, or the one that they are."""
    texts = list(texts)
    return texts[0] if texts[0] == texts[-1] else f"{texts[0]} to {texts[-1]}"


def known_by_scene(rows):
    """Lines of the page from known_to_tolerance_row(): one for each scene, with the size
    of the run of its first law to the smallest tolerance."""
    column = KNOWN_TO_TOLERANCE_HEADER.index
    percents = lambda row: float(row[column("tolerance")].split()[0])
    lines = []
    for (scene,), group in in_groups(rows, 1).items():
        first = [row for row in group if row[column("law")] == group[0][column("law")]]
        lines.append(
            [
                scene,
                "; ".join(dict.fromkeys(row[column("law")] for row in group)),
                span(row[column("tolerance")] for row in sorted(group, key=percents)[::-1]),
                span(sorted((row[column("of the tolerance")] for row in group), key=float)),
                *min(first, key=percents)[column("cells") :],
            ]
        )
    return lines


LONG_CREEP_HEADER = (
    "scene",
    "way",
    "cells",
    "steps",
    "true error",
    "estimated over true",
    "quantity",
    "its true error",
    "estimated over true",
)


LONG_CREEP_SHOWN = (
    "scene",
    "estimated over true",
    "true error of the run",
    "quantity",
    "estimated over true",
    "true error of the run",
)


def at_times(values):
    """The values at the ends of the phases."""
    return " / ".join(values)


def last(values):
    return values.split(" / ")[-1]


def creep_by_scene(rows):
    """Lines of the page from long_creep_row(), all at the last time: the least and the
    largest index of all ways to compute, and the errors of the runs to a tolerance."""
    way = LONG_CREEP_HEADER.index("way")
    lines = []
    for (scene,), group in in_groups(rows, 1).items():
        line = [scene]
        for run, error, index in (("to ", 4, 5), ("quantity to ", 7, 8)):
            indices = [last(row[index]) for row in group]
            known = sorted((i for i in indices if i != UNKNOWN), key=float)
            kept = [row for row in group if row[way].startswith(run)]
            line += [
                span(known) if known else UNKNOWN,
                ", ".join(
                    f"{last(row[error])} % ({row[way].removeprefix('quantity ')})"
                    for row in kept
                ),
            ]
        lines.append([*line[:3], group[0][6], *line[3:]])
    return lines


def long_creep_row(scene, way, quantity, columns, reference):
    """A run whose reference knows the ends of the last four phases: errors in per
    cent of the solution, and how much larger the estimates are."""
    known = np.flatnonzero(~np.isnan(columns["error_energy"]))[-4:]
    size = np.nanmax(columns["energy_norm"])
    error = columns["error_energy"][known]
    quotient = lambda a, b: number(a / b if b > 0 else np.nan, 2)
    quotients = lambda a, b: at_times(map(quotient, a, b))
    row = [
        scene,
        way,
        number(columns["cells"].max(), 9),
        number(columns["step"].max(), 9),
        at_times(number(100 * e, 2) for e in error / size),
        quotients(columns["estimate_total"][known], error),
    ]
    if not quantity:
        return row + [UNKNOWN] * 3
    true = [
        reference[quantity][np.argmin(abs(reference["t"] - t))]
        for t in columns["t"][known]
    ]
    of_quantity = abs(columns[quantity][known] - true)
    estimate = columns.get("quantity_total", np.full(columns["t"].size, np.nan))[known]
    largest = np.max(abs(reference[quantity]))
    return [
        *row,
        f"`{quantity}`",
        at_times(number(100 * e, 2) for e in of_quantity / largest),
        quotients(estimate, of_quantity),
    ]


TO_TOLERANCE_HEADER = (
    "scene",
    "tolerance",
    "estimated",
    "error",
    "cells",
    "rate",
    "steps",
    "$\\lambda$",
    "uniform",
    "meshes",
    "seconds",
    "uniform meshes",
    "times as long",
)
TO_TOLERANCE_SHOWN = (
    "scene",
    "tolerance",
    "estimated",
    "error",
    "cells",
    "steps",
    "seconds",
    "uniform meshes",
)


def smallest_tolerances(rows):
    """Lines of the page from to_tolerance_rows(): the two smallest of each scene."""
    shown = [TO_TOLERANCE_HEADER.index(name) for name in TO_TOLERANCE_SHOWN]
    return [
        [row[i] for i in shown]
        for lines in in_groups(rows, 1).values()
        for row in lines[-2:]
    ]


def uniform_multiplier(cells, study):
    """The error of the multiplier on uniform meshes of so many cells, where mesh
    and steps are refined together; nan beyond them."""
    rows = np.flatnonzero(
        (study["strategy"] == "uniform") & (study["ladder"] == "both")
    )
    curve = {
        study["cells"][row]: study["error_multiplier"][row]
        for row in rows
        if study["error_multiplier"][row] > 0
    }
    if not curve:
        return np.nan
    return float(rates.at(cells, np.array([*curve]), np.array([*curve.values()])))


def uniform_seconds(reached, study, targets, error):
    """What an error costs on uniform meshes: between the best runs of the study,
    and beyond them what it predicts for the errors `targets`, by a power of the
    error; nan beyond all of these."""
    variants = [variant for variant in study.variants() if variant[0] == "uniform"]
    rows = np.concatenate([rows_of(study, variant) for variant in variants])
    errors, times = study[error][rows], study["seconds_total"][rows]
    best = rates.efficient_frontier(times, errors)
    errors, times = list(errors[best]), list(times[best])
    for eps in sorted(targets, reverse=True):
        offers = [offer(study, variant, eps, error) for variant in variants]
        if eps < min(errors) and any(offers):
            errors.append(eps)
            times.append(min(offered["seconds"] for offered in offers if offered))
    return float(rates.at(reached, np.array(errors), np.array(times)))


def beside(own, other, is_measured):
    """Seconds of another method, and how many times one's own that is; italic if
    predicted."""
    if np.isnan(other):
        return UNKNOWN, UNKNOWN
    if other > LONGEST:
        cells = f"over {LONGEST} s", f"over {number(LONGEST / own, 2)}"
    else:
        cells = seconds(other), number(other / own, 2)
    return cells if is_measured else tuple(f"*{cell}*" for cell in cells)


def to_tolerance_rows(scene, study, targets, error, scheme):
    """The runs to a tolerance of a study, from large to small ones; the rate is
    that of the error in the number of cells, from the run before."""
    rows, before = [], None
    measured = np.nanmin(study[error][study["strategy"] == "uniform"])
    variants = [
        variant
        for variant in study.variants()
        if variant[:2] == ("tolerance", scheme)
    ]
    (of_runs,) = [rows_of(study, variant) for variant in variants]
    for row in sorted(of_runs, key=lambda row: -study["tolerance"][row]):
        reached, cells = study[error][row], study["cells"][row]
        if not np.isfinite(reached):  # the reference
            continue
        own = study["seconds_total"][row]
        rate = None
        if before is not None and cells > before[0]:
            rate = np.log(before[1] / reached) / np.log(cells / before[0])
        rows.append(
            [
                scene,
                percent(study["tolerance"][row]),
                percent(study["estimate_total"][row]),
                percent(reached),
                number(round(cells), 9),
                order(rate),
                number(study["steps"][row], 9),
                percent(study["error_multiplier"][row]),
                percent(uniform_multiplier(cells, study)),
                percent(
                    (study["seconds_set_up"][row] + study["seconds_estimate"][row])
                    / own
                ),
                seconds(own),
                *beside(
                    own,
                    uniform_seconds(reached, study, targets, error),
                    reached >= measured,
                ),
            ]
        )
        before = cells, reached
    return rows


REFERENCE_HEADER = (
    "case",
    "mesh and steps",
    "t",
    "quantity",
    "computed",
    "independent",
    "difference",
)


def reference_row(case, size, t, quantity, computed, independent):
    """The difference is relative."""
    difference = abs(computed / independent - 1)
    return [
        case,
        size,
        number(t),
        quantity,
        f"{computed:.7g}",
        f"{independent:.7g}",
        f"{difference:.1e}",
    ]


def by_case(rows):
    """Lines of the page from reference_row(): the largest difference of each case."""
    difference = lambda row: float(row[-1])
    return [
        [*group, len(lines), max(lines, key=difference)[-1]]
        for group, lines in in_groups(rows, 2).items()
    ]


def matched(first, second):
    """Pairs of rows of two studies with the same variant, ladder and levels."""

    def key(study, i):
        return (
            *(study[name][i] for name in (*VARIANT, "ladder")),
            *(study[name][i] for name in LEVELS),
        )

    rows = {key(second, i): i for i in range(len(second))}
    pairs = [(i, rows.get(key(first, i))) for i in range(len(first))]
    return [(i, j) for i, j in pairs if j is not None]


SAVING_HEADER = (
    "scene",
    "runs",
    "contact problem, fixed",
    "coupled",
    "whole run, fixed",
    "coupled",
    "time saved",
    "largest change of an error",
)


def saving_row(name, coupled, fixed):
    """What the coupled tolerance saves over the runs that both studies have,
    and by how much it changes their errors, relative to them."""
    pairs = matched(coupled, fixed)
    if not pairs:
        return [name, "0", *[UNKNOWN] * 6]
    mine, theirs = (list(rows) for rows in zip(*pairs))
    times = [
        float(np.nansum(study[column][rows]))
        for column in ("seconds_contact", "seconds_total")
        for study, rows in ((fixed, theirs), (coupled, mine))
    ]
    change = largest_change(coupled, mine, fixed, theirs)
    return [
        name,
        str(len(pairs)),
        *map(seconds, times),
        percent(1 - times[3] / times[2]),
        UNKNOWN if change is None else f"{percent(change[0])} ({change[1]})",
    ]


def largest_change(first, first_rows, second, second_rows):
    """(largest relative change of an error, its column) or None."""
    worst = None
    for name in NORMS:
        if name not in first or name not in second:
            continue
        a, b = first[name][first_rows], second[name][second_rows]
        usable = rates.known(a, b)
        if usable.any():
            change = float(np.max(np.abs(a[usable] / b[usable] - 1)))
            if worst is None or change > worst[0]:
                worst = change, name.removeprefix("error_")
    return worst


# Pieces of which the page shows less than was computed: the columns of the file
# accuracy_<piece>.csv, those of the page, and how the lines of the page follow.
SHORTENED = {
    "manufactured": (CONVERGENCE_HEADER, ORDERS_HEADER, orders_by_law),
    "low_regularity": (
        LOW_REGULARITY_HEADER,
        ("scene", "strategy", "scheme", "h alone", "k alone", "h and k", "smallest error"),
        without_other_norms,
    ),
    "known_to_tolerance": (
        KNOWN_TO_TOLERANCE_HEADER,
        ("scene", "laws", "tolerances", "true error over it", "cells", "steps", "seconds"),
        known_by_scene,
    ),
    "long_creep": (LONG_CREEP_HEADER, LONG_CREEP_SHOWN, creep_by_scene),
    "drawn": (
        LONG_CREEP_HEADER,
        LONG_CREEP_SHOWN[:3],
        lambda rows: [line[:3] for line in creep_by_scene(rows)],
    ),
    "to_tolerance": (TO_TOLERANCE_HEADER, TO_TOLERANCE_SHOWN, smallest_tolerances),
    "references": (
        REFERENCE_HEADER,
        ("case", "mesh and steps", "values", "largest difference"),
        by_case,
    ),
}


def shortened(piece, rows):
    """The table of the page."""
    _, header, shorten = SHORTENED[piece]
    return table(header, shorten(rows))
