#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a new mesh costs, in units of one plain linear solve on it.

The adaptive slab and pad of prm/verification on meshes of several sizes, new
ones after every step.  What a step took beyond its columns in statistics.csv is
the new mesh that it began with, and everything that is made anew on it.  A plain
solve is one by multigrid from zero to 1e-8 on a uniform mesh with about as many
unknowns, measured directly after (step_cost.py); both by the unknown.
"""

import argparse
import csv
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import step_cost
from step_cost import SOURCE, print_row

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
    meshes = []  # microseconds per degree of freedom
    for before, row in zip(rows[1:], rows[2:]):
        # Meshes on the way to the budget are left out.
        if row["cells"] == before["cells"] or row["cells"] < 0.8 * budget:
            continue
        in_step = sum(row[column] for column in STEP)
        seconds = row["wall_total"] - before["wall_total"] - in_step
        meshes.append(1e6 * seconds / row["dofs"])
    if not meshes:
        sys.exit("Error: the budget of cells is not reached; give more steps.")
    dim = int(case[0])
    # the slab has twice as many cells along its length as over its height
    n = 4 * max(1, round((budget / (4 - dim)) ** (1 / dim) / 4))
    plain = step_cost.measure(executable, work, dim, n, "multigrid", 4, "1e-8")
    mesh = statistics.median(meshes)
    unit = 1e6 * plain["plain s"] / plain["dofs"]
    return {
        "case": case,
        "cells": int(rows[-1]["cells"]),
        "dofs": int(rows[-1]["dofs"]),
        "meshes": len(meshes),
        "mesh us/dof": mesh,
        "plain us/dof": unit,
        "mesh/plain": mesh / unit,
    }


def main():
    parser = argparse.ArgumentParser(
        description="Measure the time of a new mesh over that of a plain solve."
    )
    parser.add_argument(
        "--budgets",
        type=int,
        nargs="+",
        default=[2000, 16000],
        help="numbers of cells (%(default)s)",
    )
    parser.add_argument("--steps", type=int, default=16, help="%(default)s")
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
        "mesh us/dof": "{:11.1f}",
        "plain us/dof": "{:12.2f}",
        "mesh/plain": "{:10.1f}",
    }
    print("case   cells    dofs meshes mesh us/dof plain us/dof mesh/plain", flush=True)
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
