# SPDX-License-Identifier: LGPL-2.1-or-later
"""Tables of a run: its results, the parts of its error, its balances."""

from html import escape

import numpy as np

from plotting import history
from plotting.quantities import column
from plotting.units import plain_number

from .markup import folded_up, formula, items, table, value

# Panels of the history that say something of the method, not of the body.
OF_THE_METHOD = ("iterations", "step size", "cells", "estimate\nof the mesh")
OF_THE_METHOD += (history.ERROR.label, history.QUANTITY.label, "relative error")
PARTS = {
    "space": "mesh",
    "history": "mesh, in the history",
    "time": "time steps",
    "friction": "friction bounds and turns",
    "transfer": "changes of the mesh",
    "algebraic": "iterations",
    "initial": "initial data",
    "total": "sum",
}


def data(value, words):
    """A number as people read it; the page has all of its digits, too."""
    return f'<data value="{float(value)!r}">{words}</data>'


def quantities(results, units):
    """The columns of the statistics that describe the body: at the end, and where
    they are largest. Those that pictures do not show are folded up."""
    statistics = results.statistics
    if not len(statistics.get("t", ())):
        return "<p>There is no statistics.csv with rows.</p>\n"
    panels = history.those_with_something(history.PANELS, statistics)
    of_body = [names for panel, names in panels if panel.label not in OF_THE_METHOD]
    main = [name for names in of_body for name in names]
    more = [
        name
        for name, values in statistics.items()
        if name not in main and history.finite(values).any()
    ]
    rest = columns(statistics, more, units)
    return columns(statistics, main, units) + folded_up(
        "All other columns of statistics.csv", rest
    )


def columns(statistics, names, units):
    time = units.unit("time", statistics["t"])
    rows = []
    for name in names:
        words, kind = column(name)
        values = statistics[name]
        unit = units.unit(kind, history.finite(values))
        at = int(np.argmax(np.abs(np.where(np.isfinite(values), values, 0.0))))
        rows.append(
            [
                f'<span title="{escape(name)}">{formula(words)}</span>',
                data(values[-1], value(unit, but_rounding(values[-1], values[at]))),
                data(values[at], value(unit, values[at])),
                data(statistics["t"][at], value(time, statistics["t"][at]))
                # An instant in pictures; what slips into equilibrium has slipped.
                + " (initial equilibrium)" * (name == "slip_area" and at == 0),
            ]
        )
    head = ["quantity", "at the end", "largest in size", "at <i>t</i> ="]
    return table(head, rows, (1, 2, 3))


def but_rounding(number, largest):
    return 0.0 if abs(number) < 1e-12 * abs(largest) else number


def errors(results, about, units):
    """The estimated errors by their parts."""
    text = ""
    time = units.unit("time", results.statistics.get("t", []))
    for key, size, what in (
        ("estimated_error", "largest_energy_norm", "the energy norm of the solution"),
        ("estimated_error_of_quantity", "largest_value", "its largest value"),
    ):
        found = about.get(key)
        if not found:
            continue
        of, kind = "the solution in the energy norm", "energy norm"
        if "quantity" in found:
            words, kind = column(found["quantity"])
            of = formula(words)
        unit = units.unit(kind, found["total"])
        at = data(found["t"], value(time, found["t"]))

        def shown(number):
            return data(number, value(unit, number))

        text += (
            f"<p>Of {of}, largest at <i>t</i> = {at}; shares are those of {what}, "
            f"{shown(found[size])}.</p>\n"
        )
        rows = [
            [words, shown(found[part]), percent(found[part] / (found[size] or np.inf))]
            for part, words in PARTS.items()
            if found.get(part) or part in ("space", "total")
        ]
        text += table(["part", "error", "share"], rows, (1, 2))
    if not text:
        return (
            "<p>The run has no error bar (<code>Error control/Error bar</code>), or "
            "has not ended.</p>\n"
        )
    return text + tolerance(results, about)


def percent(share):
    return f"{plain_number(100.0 * share, 2)} %"


def tolerance(results, about):
    """Whether the tolerance has been kept, if there is one."""
    try:
        wanted = float(results.data.get(("Error control", "Tolerance"), 0.0))
    except ValueError:
        return ""
    if not wanted > 0.0:
        return ""
    found = about.get("estimated_error_of_quantity") or about["estimated_error"]
    words = data(wanted, f"{short(100.0 * wanted)} %")
    verdict = "has been kept"
    if found["relative"] > wanted:
        verdict = "has <b>not</b> been kept"
    elif "prescribed_jump" in about:
        verdict = (
            "has been met by the estimate alone: prescribed displacements jump, and no "
            "error bar tells the true error"
        )
    return f"<p>The tolerance of {words} {verdict}.</p>\n"


def short(value):
    return formula(plain_number(value, 4))


def balances(results, units):
    """How well forces and energies balance."""
    statistics = results.statistics
    lines = []
    for name, words in (
        ("force_balance_defect", "loads, reactions and contact forces, of the largest"),
        ("algebraic_error", "equations of the steps, bound on their relative error"),
    ):
        # The initial state need not be one of equilibrium.
        values = np.abs(history.finite(statistics.get(name, np.array([]))[1:]))
        if len(values):
            lines.append(f"{words}: at most {data(values.max(), short(values.max()))}")
    defect = statistics.get("energy_balance_defect")
    if defect is not None and len(defect):
        names = ["external_work", "stored_energy", "viscous_dissipation"]
        names += ["friction_dissipation"]
        size = max(np.abs(statistics[n]).max() for n in names if n in statistics)
        unit = units.unit("energy", defect[-1:])
        text = f"energy: {data(defect[-1], value(unit, defect[-1], 3))} at the end"
        if size > 0.0:
            share = plain_number(100.0 * abs(defect[-1]) / size, 2)
            text += f", {share} % of the largest energy or work"
        text += "; it goes to zero with the time steps"
        if "construction_energy" in statistics:
            text += (
                ", but for what slips or opens at once where materials come or go"
            )
        lines.append(text)
    return items(lines) if lines else "<p>The run has left no balances.</p>\n"
