#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What ranks hold and tell each other, counted, and what follows for many ranks.

Counts depend neither on the machine nor on what else it does, so that more ranks
than cores may be counted; seconds are predicted from them. By itself this
compares the prediction with runs on a cluster (doc/cluster.md).
"""

import argparse
import csv
import math
import re
import statistics
import tempfile
from pathlib import Path

import step_cost

STEPS = 4
PARTS = ("mesh", "numbers", "spaces", "matrix", "multigrid")
# Cells over the height of the slab and along an edge of the pad, and ranks: the
# largest mesh on ever more of them, and smaller ones with as many cells a rank.
CASES = {
    2: ((22, 1), (44, 4), (88, 1), (88, 2), (88, 4), (88, 8), (88, 16)),
    3: ((8, 1), (16, 8), (16, 1), (16, 2), (16, 4), (16, 16)),
}


def count(program, scene, n_ranks, *options):
    """What the rank with most counted, and the rows of statistics.csv."""
    command = [*step_cost.launcher(n_ranks), str(program), "--quiet", str(scene)]
    output, _ = step_cost.run(command + list(options))
    counted = re.search(r"^counted (.*)$", output, re.MULTILINE).group(1).split()
    return [float(number) for number in counted], step_cost.read_rows(scene.parent)


def measure(build, dim, n, n_ranks):
    with tempfile.TemporaryDirectory() as work:
        scene = Path(work) / "scene.prm"
        scene.write_text(step_cost.scene(dim, n, "multigrid", STEPS, "1e-8", work))
        phases = re.search(r"Phases = (.*?),", scene.read_text()).group(1)
        # What the plain steps before the front count is taken off.
        program = build / "count_messages"
        before, _ = count(program, scene, n_ranks, "--set", f"Time/Phases={phases}")
        after, rows = count(program, scene, n_ranks)
        output, _ = step_cost.run(
            [*step_cost.launcher(n_ranks), str(build / "kernels"), str(dim), str(scene)]
        )
    held = {}
    for line in output.splitlines():
        name, first, _, kept = line.split()
        held[name] = float(kept) if name in PARTS else float(first)
    plain = rows[3 : step_cost.N_PLAIN + 1 : 2]
    steps = rows[step_cost.N_PLAIN + 1 :]
    messages, sent, reductions, _, _ = (
        (b - a) / len(steps) for a, b in zip(before, after)
    )
    dofs = rows[0]["dofs"]
    return {
        "case": f"{dim}D",
        "ranks": n_ranks,
        "dofs": int(dofs),
        "fullest": held["dofs"] * n_ranks / dofs,
        "face dofs": int(held["face"]),
        "plain its": statistics.median(row["linear_iterations"] for row in plain),
        "its a step": statistics.mean(row["linear_iterations"] for row in steps),
        "sets a step": statistics.mean(row["contact_iterations"] for row in steps),
        "messages": messages,
        "kB": 1e-3 * sent,
        "partners": int(after[4]),
        "reductions": reductions,
        **{f"{part} B/dof": held[part] / held["dofs"] for part in PARTS},
    }


def rows_of(name):
    file = Path(__file__).resolve().parent / "results" / f"{name}.csv"
    with open(file, newline="") as table:
        return list(csv.DictReader(table))


# Ranks that one has to tell something, at most.
PARTNERS = {2: 8, 3: 26}


def step_seconds(case, size, counted, n_dofs, n_ranks, triad, latency, bandwidth):
    """A step on n_ranks: what one rank does, by the dof and GB/s of memory, with
    the messages, bytes and reductions that were counted. Messages go to all
    neighbors on each level of multigrid, bytes by the surface of a part,
    reductions in log2 stages."""
    dim = int(case[0])
    its = float(size["its a step"])
    work = float(size["step/plain, load"]) / (1e6 * float(size["plain Mdof/s"]))
    seconds = work * n_dofs / n_ranks * triad
    if n_ranks == 1:
        return seconds
    by_iteration = {
        name: float(counted[name]) / float(counted["its a step"])
        for name in ("messages", "kB", "reductions")
    }
    levels = 1 + math.log2(n_dofs / float(counted["dofs"])) / dim / 4
    partners = min(n_ranks - 1, PARTNERS[dim]) / float(counted["partners"])
    here, there = n_dofs / n_ranks, float(counted["dofs"]) / float(counted["ranks"])
    surface = (here / there) ** (1 - 1 / dim)
    return seconds + its * (
        latency * by_iteration["messages"] * levels * partners
        + 1e3 * by_iteration["kB"] * surface / bandwidth
        + latency * by_iteration["reductions"] * math.log2(n_ranks)
    )


def predicted(case, latency, bandwidth, triad):
    """Seconds of a step, as a function of the dofs and the number of ranks, with
    this triad a rank in GB/s (none: that of the tables)."""
    size = [row for row in rows_of("sizes") if row["case"] == case][-1]
    counted = max(
        (row for row in rows_of("counts") if row["case"] == case),
        key=lambda row: int(row["ranks"]),
    )
    share = float(rows_of("ranks")[0]["triad GB/s"]) / triad if triad else 1.0

    def seconds(n_dofs, n_ranks):
        return step_seconds(
            case, size, counted, n_dofs, n_ranks, share, latency, bandwidth
        )

    return int(size["dofs"]), seconds


def predict():
    for n_ranks in (4**i for i in range(6)):
        row = {"ranks": n_ranks}
        # Of one rank alone nothing follows.
        for case in sorted({r["case"] for r in rows_of("counts") if r["partners"] > "0"}):
            n, seconds = predicted(case, 2e-6, 1e10, None)
            weak = seconds(50000, 1) / seconds(50000 * n_ranks, n_ranks)
            row[f"{case}: s a step of {n} dofs"] = seconds(n, n_ranks)
            row[f"{case}: speed-up"] = seconds(n, 1) / seconds(n, n_ranks)
            row[f"{case}: efficiency with 50000 dofs a rank"] = weak
        yield {k: v if k == "ranks" else f"*{v:.3g}*" for k, v in row.items()}


def main():
    parser = argparse.ArgumentParser(
        description="Compare runs of step_cost.py --scene with the prediction."
    )
    parser.add_argument("results", nargs="+", help="directories that end in -RANKS")
    parser.add_argument("--triad", type=float, help="GB/s a rank (as in the tables)")
    parser.add_argument("--latency", type=float, default=2e-6, help="s (%(default)s)")
    parser.add_argument("--bandwidth", type=float, default=1e10, help="B/s (%(default)s)")
    options = parser.parse_args()
    print("ranks     dofs  its a step  s a step  predicted")
    for directory in sorted(options.results, key=lambda d: int(d.rsplit("-", 1)[1])):
        n_ranks = int(directory.rsplit("-", 1)[1])
        steps = step_cost.read_rows(directory)[step_cost.N_PLAIN + 2 :]
        n_dofs = int(steps[0]["dofs"])
        case = "3D" if "load_z" in steps[0] else "2D"
        _, seconds = predicted(
            case, options.latency, options.bandwidth, options.triad
        )
        its = statistics.mean(row["linear_iterations"] for row in steps)
        print(
            f"{n_ranks:5} {n_dofs:8} {its:11.1f} "
            f"{step_cost.over_plain(steps, 1.0):9.3g} {seconds(n_dofs, n_ranks):10.3g}"
        )


if __name__ == "__main__":
    main()
