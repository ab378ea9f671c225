# SPDX-License-Identifier: LGPL-2.1-or-later
"""Studies that nobody ran: errors and seconds follow known formulas.

    error   = C_h h^p + C_k k^q
    seconds = c dofs^a steps

so that what is made of a study can be compared with what was put in.
"""

import csv
import json

MODEL = {"C_h": 0.3, "p": 1.0, "C_k": 0.2, "q": 1.0}
PRICE = {"c": 2e-6, "a": 1.15}
PHASES = {  # parts of the total; the rest nobody measured
    "set_up": 0.1,
    "rate": 0.05,
    "tangent": 0.1,
    "load": 0.05,
    "contact": 0.4,
    "balance": 0.1,
    "estimate": 0.15,
    "output": 0.05,  # no part of it
    "errors": 0.05,
    "checkpoint": 0.01,
    "rest": 0.04,
}
ERRORS = {"energy": 1.0, "h1": 1.2, "stress": 0.8, "multiplier": 2.0}


def run(variant, ladder, level, h, k, model, dimension=2, known=ERRORS, effectivity=1.5):
    """One row of study.csv, as a dictionary."""
    strategy, scheme, history = variant
    cells = round(2 * h**-dimension)
    # an adaptive mesh of as many cells is as good as a finer uniform one
    gain = 0.5 if strategy == "adaptive" else 1.0
    dofs = dimension * round((1 + h**-1) ** dimension * 2)
    steps = round(2 / k)
    error = gain * model["C_h"] * h ** model["p"] + model["C_k"] * k ** model["q"]
    slower = 1.4 if strategy == "adaptive" else 1.0
    seconds = slower * PRICE["c"] * dofs ** PRICE["a"] * steps
    row = {
        "run": f"{strategy}_{scheme}_{history}_{ladder}_{level}".replace(" ", "_"),
        "strategy": strategy,
        "scheme": scheme,
        "history": history,
        "solver": "direct",
        "ladder": ladder,
        "tolerance": 0.5**level if strategy == "tolerance" else 0.0,
        "mesh_level": level if ladder != "time" else 1,
        "time_level": level if ladder != "space" else 1,
        "h": h,
        "k": k,
        "cells": cells,
        "dofs": dofs,
        "steps": steps,
        "seconds_total": seconds,
    }
    row |= {f"seconds_{name}": part * seconds for name, part in PHASES.items()}
    row |= {
        "peak_memory_MB": 60 + 2e-3 * dofs,
        "contact_iterations": 3 * steps,
        "linear_iterations": 5 * steps,
    }
    row |= {
        f"error_{name}": ERRORS[name] * error if name in known else "nan"
        for name in ERRORS
    }
    row |= {
        "estimate_space": effectivity * model["C_h"] * h ** model["p"],
        "estimate_time": effectivity * model["C_k"] * k ** model["q"],
        "estimate_algebraic": 0.01 * error,
        "estimate_initial": 0.0,
        "estimate_total": effectivity * error,
        "effectivity": effectivity if "energy" in known else "nan",
        "friction_force_x": 0.128 * (1 - 0.3 * error),
        "friction_force_x_error": 0.3 * error,
        "point0_x": 0.172 * (1 - 0.1 * error),
        "point0_x_error": 0.1 * error,
        "reaction_3_y": 0.0,
        "reaction_3_y_error": "nan",
    }
    return row


def rows(
    variants=(("uniform", "forward Euler", "cell means"),),
    ladders=("space", "time", "both"),
    levels=4,
    model=MODEL,
    h=1 / 8,
    k=1 / 10,
    **more,
):
    """The runs of a whole study; what a ladder keeps has its second size."""
    result = []
    for variant in variants:
        of_variant = model(variant) if callable(model) else model
        for ladder in ladders:
            for level in range(levels):
                half = 0.5**level
                keep = 0.5 ** min(levels - 1, 3)
                result.append(
                    run(
                        variant,
                        ladder,
                        level,
                        h * (keep if ladder == "time" else half),
                        k * (keep if ladder == "space" else half),
                        of_variant,
                        **more,
                    )
                )
    return result


def fit(variant, model=MODEL, error="error_energy"):
    gain = 0.5 if variant[0] == "adaptive" else 1.0
    return {
        "strategy": variant[0],
        "scheme": variant[1],
        "history": variant[2],
        "error": error,
        **model,
        "C_h": gain * model["C_h"],
        "rms_of_log": 0.01,
        "worst_factor": 1.5,
    }


def about(rows, scene="synthetic", model=MODEL, **more):
    """What study.json says of these runs."""
    variants = dict.fromkeys(
        (row["strategy"], row["scheme"], row["history"]) for row in rows
    )
    fits = [fit(variant, model(variant) if callable(model) else model) for variant in variants]
    return {
        "scene": scene,
        "version": "1.2.3",
        "ranks": 1,
        "machine": "Abacus 3000",
        "date": "2020-02-29T12:00:00Z",
        "reference": "exact",
        "fits": fits,
        "prices": [],
        **more,
    }


def write(directory, rows, about=None):
    """study.csv and study.json in a directory, which is made."""
    directory.mkdir(parents=True, exist_ok=True)
    with open(directory / "study.csv", "w", newline="") as file:
        table = csv.DictWriter(file, list(rows[0]))
        table.writeheader()
        table.writerows(rows)
    if about is not None:
        (directory / "study.json").write_text(json.dumps(about))
    return directory
