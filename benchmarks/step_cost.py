#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a time step costs, in units of one plain linear solve.

One run gives both numbers, so that a busy or slow machine changes neither
their ratio nor the verdict.  It begins with steps that are plain solves: the
foundation holds whatever the load is, and the load alternates between 1 and
1/2 so that the extrapolated start 2 u_{n-1} - u_{n-2} of every other step is
zero.  Then the foundation gets its friction bound and a stick-slip front
crosses it under load and unload.

The first plain solve contains the set-up of the multigrid preconditioner and
is left out, and so is the first step of the front, where the load jumps; later
set-ups count as part of the steps that make them.  Output of fields is not
counted.
"""

import argparse
import csv
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1]

N_PLAIN = 7
SOLVERS = {
    "direct": "direct",
    "multigrid": "multigrid",
    "algebraic": "algebraic multigrid",
}
WORK = ("wall_rate", "wall_load", "wall_contact", "wall_balance")

SCENE = """
set Dimension = {dim}

subsection Geometry
  set Generator = subdivided_hyper_rectangle
  set Arguments          = {cells} : {lower} : {upper} : true
  set Global refinements = {refinements}
end

subsection Material
  set Young's modulus        = 1
  set Poisson's ratio        = 0.3
  set Law                    = maxwell
  set Volumetric integration = full
  subsection maxwell
    set Viscosity = 0.5
  end
end

subsection Boundary 0
  set Role     = traction
  set Traction = {traction}
end
{free}
subsection Boundary {foundation}
  set Role           = contact
  set Friction law   = tresca
  set Friction bound = if(t < {begin} + {k}/2, 1e10, {bound})
end

subsection Boundary {top}
  set Role = clamped
end

subsection Time
  set Phases = {begin}: {n_plain}, {middle}: {half}, {end}: {half}
end

subsection Solver
  set Linear solver     = {solver}
  set Contact tolerance = {tolerance}
end

subsection Output
  set Directory    = {directory}
  set Fields every = 0
end
"""


def launcher(ranks):
    if ranks == 1:
        return []
    return ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks)]


def scene(dim, n, solver, n_steps, tolerance, directory):
    """SLAB in 2D, PAD in 3D (see prm/verification), behind plain steps; n is
    halved while it is even, for meshes to coarsen to."""
    refinements = (n & -n).bit_length() - 1
    n >>= refinements
    half = n_steps // 2
    length = 2.0 if dim == 2 else 1.5
    k = length / (2 * half)
    begin = N_PLAIN * k
    s = f"(t - {begin!r})"
    # nothing at t = 0, then 1 after odd numbers of steps, 1/2 after even ones
    plain = f"if(t < {k!r}/2, 0, 0.1*(0.75 - 0.25*cos(pi*t/{k!r})))"

    def load(later):
        return f"if(t < {begin!r} + {k!r}/2, {plain}, {later})"

    if dim == 2:
        traction = f"{load(f'0.3*min({s}, 2 - {s})')}; 0"
    else:
        traction = (
            f"{load(f'0.05*sin(pi*{s}/2)')}; {load(f'0.03*(1 - cos(pi*{s}))')}; 0"
        )
    free = "".join(
        f"\nsubsection Boundary {i}\n  set Role = free\nend\n"
        for i in ([1] if dim == 2 else [1, 2, 3])
    )
    return SCENE.format(
        dim=dim,
        refinements=refinements,
        cells=f"{2 * n}, {n}" if dim == 2 else f"{n}, {n}, {n}",
        lower=", ".join(["0"] * dim),
        upper="2, 1" if dim == 2 else "1, 1, 1",
        traction=traction,
        free=free,
        foundation=2 if dim == 2 else 4,
        top=3 if dim == 2 else 5,
        begin=repr(begin),
        k=repr(k),
        bound=0.08 if dim == 2 else 0.03,
        n_plain=N_PLAIN,
        middle=repr(begin + length / 2),
        end=repr(begin + length),
        half=half,
        solver=solver,
        tolerance=tolerance,
        directory=directory,
    )


def run(command):
    """Standard output of a command that must succeed, and the most memory in MB
    that a process of it has had."""
    with tempfile.TemporaryFile("w+") as output:
        process = subprocess.Popen(
            command, env={**os.environ, "OMP_NUM_THREADS": "1"}, stdout=output
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            sys.exit(f"Error: {' '.join(command)} failed; the reason is above.")
        output.seek(0)
        return output.read(), usage.ru_maxrss / 1024


def over_plain(rows, unit):
    """Mean seconds of steps without output over those of a plain solve."""
    return statistics.mean(sum(row[column] for column in WORK) for row in rows) / unit


def read_rows(directory):
    with open(Path(directory) / "statistics.csv", newline="", encoding="utf-8") as table:
        return [
            {column: float(value) for column, value in row.items()}
            for row in csv.DictReader(table)
        ]


def measure(executable, work, dim, n, solver, n_steps, tolerance, ranks=1):
    name = f"{dim}d_{solver}"
    file = work / f"{name}.prm"
    file.write_text(
        scene(dim, n, SOLVERS[solver], n_steps, tolerance, work / name),
        encoding="utf-8",
    )
    output, memory = run([*launcher(ranks), executable, str(file)])
    rows = read_rows(work / name)
    # Numbers 3, 5, 7 start from zero, as number 1, which sets up as well.
    plain = rows[3 : N_PLAIN + 1 : 2]
    steps = rows[N_PLAIN + 2 :]
    unit = statistics.median(row["wall_contact"] for row in plain)
    cost = [sum(row[column] for column in WORK) / unit for row in steps]
    set_up = re.search(r"^ *set-up +(\S+) ", output, re.MULTILINE)
    middle = len(steps) // 2
    face = rows[1]["stick_area"]
    return {
        "case": f"{dim}D {solver}",
        "dofs": int(rows[0]["dofs"]),
        "set-up s": float(set_up.group(1)) if set_up else float("nan"),
        "plain s": unit,
        "plain its": statistics.median(row["linear_iterations"] for row in plain),
        "mean": statistics.mean(cost),
        "median": statistics.median(cost),
        "max": max(cost),
        "load": over_plain(steps[:middle], unit),
        "reversal": over_plain(steps[middle:], unit),
        "peak MB": memory,
        "contact": sum(row["wall_contact"] for row in steps) / len(steps) / unit,
        "its": statistics.mean(row["linear_iterations"] for row in steps),
        "sets": statistics.mean(row["contact_iterations"] for row in steps),
        "sets max": max(row["contact_iterations"] for row in steps),
        "slip max": max(row["slip_area"] for row in steps) / face,
    }


def print_row(columns, row):
    """columns: {name: format}"""
    words = (form.format(row[name]) for name, form in columns.items())
    print(" ".join(words), flush=True)


def main():
    parser = argparse.ArgumentParser(
        description="Measure the time of a step over that of a plain linear solve."
    )
    parser.add_argument(
        "cases",
        nargs="*",
        metavar="CASE",
        help="2d- or 3d-, then direct, multigrid or algebraic (default: all)",
    )
    parser.add_argument(
        "--n2", type=int, default=352, help="cells over the height, 2D (%(default)s)"
    )
    parser.add_argument(
        "--n3", type=int, default=32, help="cells along an edge, 3D (%(default)s)"
    )
    parser.add_argument(
        "--steps", type=int, default=32, help="steps of the front (%(default)s)"
    )
    parser.add_argument(
        "--tolerance", default="1e-8", help="contact tolerance (%(default)s)"
    )
    parser.add_argument(
        "--executable",
        default=str(SOURCE / "build" / "viscoplastic_contact"),
        help="the program (default: in build/)",
    )
    parser.add_argument(
        "--scene",
        nargs=3,
        metavar=("DIM", "N", "DIRECTORY"),
        help="print the scene of a case with multigrid, and no more",
    )
    arguments = parser.parse_args()
    if arguments.scene:
        dim, n, directory = arguments.scene
        print(
            scene(
                int(dim),
                int(n),
                "multigrid",
                arguments.steps,
                arguments.tolerance,
                directory,
            )
        )
        return
    known = [f"{dim}d-{solver}" for dim in (2, 3) for solver in SOLVERS]
    for case in arguments.cases:
        if case not in known:
            parser.error(f"{case} is no case; the cases are {', '.join(known)}")
    if arguments.steps < 4:
        parser.error("the front needs at least 4 steps")
    if not Path(arguments.executable).exists():
        sys.exit(f"Error: there is no {arguments.executable}; build it first.")

    columns = {
        "case": "{:14}",
        "dofs": "{:8d}",
        "set-up s": "{:8.2f}",
        "plain s": "{:8.3f}",
        "plain its": "{:9.0f}",
        "mean": "{:6.2f}",
        "median": "{:6.2f}",
        "max": "{:6.2f}",
        "contact": "{:7.2f}",
        "its": "{:6.1f}",
        "sets": "{:6.2f}",
        "sets max": "{:8.0f}",
        "slip max": "{:8.2f}",
    }
    header = []
    for name, form in columns.items():
        width = int(re.search(r"\d+", form).group())
        header.append(f"{name:<{width}}" if name == "case" else f"{name:>{width}}")
    print(" ".join(header), flush=True)
    with tempfile.TemporaryDirectory() as work:
        for case in arguments.cases or known:
            dim, solver = int(case[0]), case[3:]
            row = measure(
                arguments.executable,
                Path(work),
                dim,
                arguments.n2 if dim == 2 else arguments.n3,
                solver,
                arguments.steps,
                arguments.tolerance,
            )
            print_row(columns, row)


if __name__ == "__main__":
    main()
