# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a study wrote: study.csv, one row a run, and study.json."""

import json
import re
from pathlib import Path

import numpy as np

from . import rates, style
from .results import LEVELS, VARIANT, UserError, read_study_about, read_study_table

TOLERANCE = "tolerance"  # the strategy of runs that choose meshes and steps

MOST = 4  # variants in a picture

LADDERS = {"space": "$h$ alone", "time": "$k$ alone", "both": "$h$ and $k$"}
ERRORS = {
    "error_energy": r"error of $u$ in the energy norm",
    "error_h1": r"error of $u$ in $H^1$",
    "error_stress": r"error of $\sigma$ in $L^2$",
    "error_multiplier": r"error of $\lambda$ on $\Gamma_3$",
    "estimate_total": r"estimated error of $u$ in the energy norm",
    "estimate_quantity": "estimated error of the quantity of interest",
    "quantities": "error of the worst quantity of interest",
}


class Ladder:
    """Runs of one variant that a study refines step by step, the coarsest first."""

    def __init__(self, study, variant, name, rows):
        self.variant = variant
        self.name = name
        self.rows = rows
        self.h = study["h"][rows]
        self.k = study.step_sizes()[rows]

    def sizes(self, axis):
        return self.h if axis == "h" else self.k


class Study:
    """A directory with a study.csv; columns are arrays over its rows."""

    def __init__(self, directory):
        self.directory = Path(directory).resolve()
        self.columns = read_study_table(self.directory / "study.csv")
        self.columns = with_worst_quantity(self.columns)
        self.about = read_study_about(self.directory / "study.json")
        self.name = str(self.about.get("scene") or self.directory.name)

    def __len__(self):
        return len(self["ladder"])

    def __contains__(self, name):
        return name in self.columns

    def __getitem__(self, name):
        if name not in self.columns:
            raise UserError(
                f'{self.directory / "study.csv"} has no column "{name}"; it has '
                + ", ".join(self.columns)
            )
        return self.columns[name]

    def chooses_steps(self):
        """Whether step control has chosen the steps of runs, to a tolerance."""
        return "step_tolerance" in self and rates.known(self["step_tolerance"]).any()

    def step_sizes(self):
        """What the part of the steps in errors is a power of: their tolerance, or
        the longest of them."""
        return self["step_tolerance" if self.chooses_steps() else "k"]

    def step_symbol(self):
        return r"\mathrm{TOL}" if self.chooses_steps() else "k"

    def ladder_label(self, name):
        label = LADDERS.get(name, name)
        return label.replace("$k$", f"${self.step_symbol()}$")

    def errors(self):
        """Columns of errors that are known for some run."""
        return [
            name
            for name in self.columns
            if (name in ERRORS or name.endswith("_error"))
            and rates.known(self[name]).any()
        ]

    def error(self, name=None):
        """The name of a column of errors: the one asked for, or the first."""
        found = self.errors()
        if name is None:
            if not found:
                raise UserError(
                    f"{self.directory / 'study.csv'} knows the error of no run, so "
                    "there is nothing to draw it over"
                )
            return found[0]
        if f"{name}_error" in self.columns:
            name = f"{name}_error"
        if name not in found:
            there = ", ".join(found) or "none"
            what = "is known for no run" if name in self else "does not exist"
            raise UserError(f'the error "{name}" {what}; there are: {there}')
        return name

    def variants(self):
        """The (strategy, scheme, history) that occur, in their order."""
        return list(dict.fromkeys(zip(*(self[name] for name in VARIANT))))

    def ladders(self):
        """All of them; of runs with the same levels the last one counts.

        On adaptive meshes h is what came out, hence the levels."""
        keys = list(zip(*(self[name] for name in (*VARIANT, "ladder"))))
        found = []
        for key in dict.fromkeys(keys):
            rows = {}
            for i, other in enumerate(keys):
                if other == key:
                    rows[tuple(self[name][i] for name in LEVELS)] = i
            rows = np.array([rows[levels] for levels in sorted(rows)])
            found.append(Ladder(self, key[:3], key[3], rows))
        return found

    def variant_label(self, variant):
        """What tells a variant from the others of this study, in words."""
        variants = self.variants()
        parts = [
            part
            for i, part in enumerate(variant)
            if len({other[i] for other in variants}) > 1
        ]
        return style.plain(", ".join(parts or variant[:2]))

    def groups(self, error=None):
        """The variants in groups that one picture can hold: first the best of each
        strategy, or where there is one strategy of each scheme, then the others."""
        variants = self.variants()
        if len(variants) <= MOST:
            return [variants]
        kind = next((i for i in (0, 1) if len({v[i] for v in variants}) > 1), 2)
        best = {}
        for variant in sorted(variants, key=lambda variant: self.price(variant, error)):
            best.setdefault(variant[kind], variant)
        first = [variant for variant in variants if variant in best.values()][:MOST]
        others = [variant for variant in variants if variant not in first]
        return [first, *(others[i : i + MOST] for i in range(0, len(others), MOST))]

    def price(self, variant, error):
        """The seconds for the smallest error that all variants of the strategy
        reach; infinite where errors are not known."""
        if error is None:
            return 0.0

        def runs(variant):
            rows = np.concatenate(
                [ladder.rows for ladder in self.ladders() if ladder.variant == variant]
            )
            return rows[rates.known(self["seconds_total"][rows], self[error][rows])]

        reached = [
            self[error][runs(other)].min(initial=np.inf)
            for other in self.variants()
            if other[0] == variant[0]
        ]
        reached = [value for value in reached if np.isfinite(value)]
        rows = runs(variant)
        if not reached or not len(rows):
            return np.inf
        seconds, errors = self["seconds_total"][rows], self[error][rows]
        cheapest = rates.cheapest_within(max(reached), seconds, errors)
        return np.inf if cheapest is None else seconds[cheapest]

    def looks(self, variants):
        """{variant: color and line} in a picture of some of them."""
        return {
            variant: {"color": color, "ls": "-"}
            for variant, color in zip(variants, style.SERIES)
        }

    def title(self, what, variants):
        """What a picture shows, and of which variants."""
        text = f"{style.plain(self.name)}: {what}"
        everything = self.variants()
        if len(variants) == len(everything):
            return text
        kinds = {variant[0] for variant in variants}
        if len(kinds) == len({variant[0] for variant in everything}) == len(variants):
            return f"{text}, best of each strategy"
        return f"{text}, {len(variants)} of {len(everything)} ways"

    def error_of_reference(self, error):
        """The estimated error of the run that others are compared with, relative,
        or None where it is not known."""
        run = self.about.get("reference_run")
        record = self.directory / str(run) / "run.json"
        if not run or error != "error_energy" or not record.exists():
            return None
        estimate = json.loads(record.read_text()).get("estimated_error", {})
        return estimate.get("relative")

    def fit(self, variant, error):
        """The fitted {C_h, p, C_k, q, ...} of study.json, or None."""
        for fit in self.about["fits"]:
            if isinstance(fit, dict) and fit.get("error") == error:
                if all(fit.get(name) == part for name, part in zip(VARIANT, variant)):
                    return fit
        return None


def error_label(name):
    """A label of an axis; all errors are relative."""
    if name in ERRORS:
        return f"relative {ERRORS[name]}"
    quantity = name.removesuffix("_error")
    match = re.fullmatch(r"(.*)_([xyz])", quantity)
    component = ""
    if match:
        quantity, component = match.group(1), f", ${match.group(2)}$"
    quantity = re.sub(r"^max_", "largest ", quantity).replace("_", " ")
    quantity = re.sub(r"^(point|reaction) ?(\d+)$", r"\1 \2", quantity)
    return f"relative error of the {style.plain(quantity)}{component}"


def with_worst_quantity(columns):
    """Columns and, before the errors of single quantities, the largest of
    them in each run."""
    names = [name for name in columns if name.endswith("_error")]
    if not names:
        return columns
    errors = np.array([columns[name] for name in names])
    worst = np.nanmax(np.where(np.isnan(errors), -np.inf, errors), axis=0)
    worst = np.where(np.isfinite(worst), worst, np.nan)
    first = next(i for i, name in enumerate(columns) if name == names[0])
    items = list(columns.items())
    return dict([*items[: first - 1], ("quantities", worst), *items[first - 1 :]])
