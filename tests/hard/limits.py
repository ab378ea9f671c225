# SPDX-License-Identifier: LGPL-2.1-or-later
"""Limits of size: memory as announced, indices that do not suffice."""

import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from harness import EXECUTABLE, MPIRUN, scene_file
from suite import case

GIB = 2**30
PEAK = Path(__file__).with_name("peak.py")


class Process:
    """The program with what it took: peak of memory in bytes, seconds."""

    def __init__(self, scene, *options, ranks=1, allowed=0, **entries):
        command = [EXECUTABLE, *options, str(scene_file(f"hard/{scene}"))]
        for name, value in entries.items():
            command += ["--set", f"{name}={value}"]
        if ranks > 1:
            command = MPIRUN + ["-n", str(ranks)] + command
        start = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            peak = Path(folder) / "peak"
            process = subprocess.run(
                [sys.executable, PEAK, peak, str(allowed), *command],
                cwd=folder,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
            )
            self.peak = 1024 * int(peak.read_text())
        self.output = process.stdout
        self.returncode = process.returncode
        self.seconds = time.monotonic() - start

    def number(self, pattern):
        found = re.search(pattern, self.output)
        if not found:
            raise AssertionError(f"no {pattern} in:\n{self.output[-1000:]}")
        return float(found[1])


def one_step(report, dim, n, solver, most=None):
    """Peak against what --check announces, both in bytes."""
    cells = f"{2 * n}, {n}" if dim == 2 else ", ".join(3 * [str(n)])
    last = "2, 1" if dim == 2 else "1, 1, 1"
    entries = {
        "Geometry/Arguments": f"{cells} : {', '.join(dim * '0')} : {last} : true",
        "Solver/Linear solver": solver,
    }
    scene = f"large_{dim}d"
    check = Process(scene, "--check", **entries)
    announced = 1e9 * check.number(r"Memory: about ([.0-9]+) GB")
    unknowns = check.number(r"(\d+) degrees of freedom")
    what = f"{dim}D, {solver}, {unknowns / 1e6:.2g} million unknowns"
    result = Process(scene, **entries)
    if result.returncode != 0:
        raise AssertionError(f"{what}: {result.output[-1000:]}")
    report.figure(f"{what}: peak, GiB", result.peak / GIB, 0, most or float("inf"))
    # The documented factor.
    report.figure(f"{what}: peak / announced", result.peak / announced, 1 / 1.5, 1.5)
    report.figure(f"{what}: seconds", result.seconds)


@case(
    "Size",
    "Peak of memory within a factor 1.5 of what --check announces, up to the "
    "largest meshes that fit 16 GiB",
)
def memory(size, report):
    one_step(report, 2, size(140, 512), "direct")
    one_step(report, 2, size(140, 512), "multigrid")
    one_step(report, 3, size(16, 32), "direct")
    one_step(report, 3, size(16, 32), "multigrid")
    if size.full:
        one_step(report, 2, LARGEST[2], "multigrid", 16)
        one_step(report, 3, LARGEST[3], "multigrid", 16)


# Cells over the height that take just less than 16 GiB: 2470 bytes an unknown
# were measured in 2D, 5900 in 3D.
LARGEST = {2: 1300, 3: 96}

CELLS = "'Geometry/Arguments' = .* asks for .* cells; possible are"
COUNTS = "'Geometry/Arguments' = .* has to be 2 whole numbers of cells"
LEVELS = "refinements' = .* further ones at boundaries; together, 18 are possible"
NUMBERED = "refinements' = .* would make about .* unknowns, more than can be numbered"
RANKS = "would make about .* too much for {}, .* take at least {}"
MEMORY = "refinements' = .* would make about .* whose mesh alone takes .* GB"

BOX = " : 0, 0 : 2, 1 : true"
CUBE = " : 0, 0, 0 : 1, 1, 1 : true"
G, R, B = (
    "Geometry/Arguments", "Geometry/Global refinements", "Geometry/Boundary refinements"
)

# Dimension, entry, value, ranks, what is said.  46341^2 is next to 2^31, 65536^2
# is 2^32, which is 0 in 32 bits, 4294967297 there is 1.
REFUSED = (
    (2, G, "100000, 100000" + BOX, 1, CELLS),
    (2, G, "46341, 46341" + BOX, 1, CELLS),
    (2, G, "65536, 65536" + BOX, 1, CELLS),
    (2, G, "4294967297, 1" + BOX, 1, CELLS),
    (2, G, "1e3, 1" + BOX, 1, COUNTS),
    (2, G, "8" + BOX, 1, COUNTS),
    (3, G, "3000, 3000, 3000" + CUBE, 1, CELLS),
    (3, G, "1625, 1625, 1626" + CUBE, 1, CELLS),
    (2, R, 9, 1, NUMBERED),
    (2, R, 18, 1, NUMBERED),
    (2, R, 20, 1, LEVELS),
    (2, R, 30, 1, LEVELS),
    (3, R, 6, 1, NUMBERED),
    (3, R, 20, 1, LEVELS),
    (3, R, 30, 1, LEVELS),
    # 1.3e8 unknowns need 1.1e9 entries: numbered, but not by one rank
    (2, R, 6, 1, RANKS.format("one MPI rank", 3)),
    (3, R, 4, 1, RANKS.format("one MPI rank", 2)),
    (3, R, 5, 2, RANKS.format("2 MPI ranks", 16)),
    (2, B, "2: 18", 1, RANKS.format("one MPI rank", 4)),
    (3, B, "4: 12", 1, NUMBERED),
    (2, B, "2: 30", 1, LEVELS),
    (2, "Time/Phases", "1: 2000000000", 1, "'Time/Phases' has more than 1e9 steps"),
)


@case(
    "Size",
    "More cells, unknowns, entries or steps than indices or memory have room for "
    "are refused before memory is taken",
)
def index_limits(size, report):
    peak = seconds = 0
    # Every second one at the small size.
    cases = [(*refused, 0) for refused in REFUSED[:: size(2, 1)]]
    # As on a computer of 4 GiB.
    cases.append((2, R, 5, 1, MEMORY, 4 * GIB))
    for dim, entry, value, ranks, sentence, allowed in cases:
        result = Process(
            f"large_{dim}d", "--check", ranks=ranks, allowed=allowed, **{entry: value}
        )
        wrong = f"{dim}D, {entry} = {value}: code {result.returncode}, {result.output}"
        if result.returncode != 1 or not re.search(sentence, result.output):
            raise AssertionError(wrong.replace("\n", " "))
        if len(result.output.strip().splitlines()) != 1 and ranks == 1:
            raise AssertionError("more than a sentence: " + wrong)
        peak = max(peak, result.peak)
        seconds = max(seconds, result.seconds)
    report.figure("refused inputs", len(cases))
    # Libraries alone take 180 MB, the mesh before its refinement some more.
    report.figure("largest peak of memory until the refusal, GiB", peak / GIB, 0, 0.4)
    report.figure("longest time until the refusal, s", seconds)
