#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a new mesh costs, in units of one plain linear solve on it.

The adaptive slab and pad of prm/verification on meshes of several sizes, new
ones after every step.  One run gives both numbers: what a step took beyond its
columns in statistics.csv is the new mesh it began with, with everything that
is made anew on it; a plain solve is 12 linear iterations, which multigrid takes
from zero to 1e-8 (step_cost.py).
"""

import argparse
import csv
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from step_cost import SOURCE, print_row

PLAIN_ITERATIONS = 12
STEP = (
    "wall_rate",
    "wall_load",
    "wall_contact",
    "wall_balance",
    "wall_estimate",
    "wall_output",
)
SCENES = {"2d": "slab_adaptive", "3d": "pad_adaptive"}
CHANGES = {
    "Mesh refinement/Every n steps": 1,
    "Mesh refinement/Smallest share": 0,
    "Mesh refinement/Refinement fraction": 0.6,
    "Mesh refinement/Maximal level": 9,
    "Solver/Linear solver": "multigrid",
    "Solver/Contact tolerance": 1e-8,
    "Output/Fields every": 0,
}


def measure(executable, work, case, budget, n_steps):
    end = {"2d": 1, "3d": 0.8}[case]
    changes = {
        **CHANGES,
        "Time/Phases": f"{end}: {n_steps}",
        "Mesh refinement/Cell budget": budget,
        "Output/Directory": work,
    }
    command = [executable, "--quiet"]
    command.append(str(SOURCE / "prm" / "verification" / f"{SCENES[case]}.prm"))
    for entry, value in changes.items():
        command += ["--set", f"{entry}={value}"]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    if subprocess.run(command, env=environment, check=False).returncode != 0:
        sys.exit(f"Error: the run of {SCENES[case]} failed; the reason is above.")
    with open(work / "statistics.csv", newline="", encoding="utf-8") as table:
        rows = [
            {column: float(value) for column, value in row.items()}
            for row in csv.DictReader(table)
        ]
    meshes, iteration = [], []
    for before, row in zip(rows[1:], rows[2:]):
        # Meshes on the way to the budget are left out.
        if row["cells"] == before["cells"] or row["cells"] < 0.8 * budget:
            continue
        beyond = sum(row[column] for column in STEP)
        meshes.append(row["wall_total"] - before["wall_total"] - beyond)
        iteration.append(row["wall_contact"] / row["linear_iterations"])
    if not meshes:
        sys.exit("Error: the budget of cells is not reached; give more steps.")
    plain = PLAIN_ITERATIONS * statistics.median(iteration)
    return {
        "case": case,
        "cells": int(rows[-1]["cells"]),
        "dofs": int(rows[-1]["dofs"]),
        "meshes": len(meshes),
        "mesh s": statistics.median(meshes),
        "plain s": plain,
        "mesh/plain": statistics.median(meshes) / plain,
        "us/dof": 1e6 * statistics.median(meshes) / rows[-1]["dofs"],
    }


def main():
    parser = argparse.ArgumentParser(
        description="Measure the time of a new mesh over that of a plain solve."
    )
    parser.add_argument(
        "--budgets",
        type=int,
        nargs="+",
        default=[2000, 20000],
        help="numbers of cells (%(default)s)",
    )
    parser.add_argument("--steps", type=int, default=24, help="%(default)s")
    parser.add_argument(
        "--executable",
        default=str(SOURCE / "build" / "viscoplastic_contact"),
        help="the program (default: in build/)",
    )
    arguments = parser.parse_args()
    if not Path(arguments.executable).exists():
        sys.exit(f"Error: there is no {arguments.executable}; build it first.")
    columns = {
        "case": "{:4}",
        "cells": "{:7d}",
        "dofs": "{:7d}",
        "meshes": "{:6d}",
        "mesh s": "{:7.3f}",
        "plain s": "{:7.3f}",
        "mesh/plain": "{:10.1f}",
        "us/dof": "{:6.1f}",
    }
    print("case   cells    dofs meshes  mesh s plain s mesh/plain us/dof", flush=True)
    for case in SCENES:
        for budget in arguments.budgets:
            with tempfile.TemporaryDirectory() as work:
                row = measure(
                    arguments.executable,
                    Path(work) / "results",
                    case,
                    budget,
                    arguments.steps,
                )
            print_row(columns, row)


if __name__ == "__main__":
    main()
