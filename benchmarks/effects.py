# SPDX-License-Identifier: LGPL-2.1-or-later
"""What each effect adds to a bare elastic scene.

The bare scene is a block (2D, 3D) that is pushed at one end and held at the
top, between symmetry planes, without error estimate, fields and checkpoints.
Each effect is a set of entries more. Effects that need others name them, and are
measured beside the scene with these. A run and the one beside it take turns, so
that a busy machine slows both.
"""

import csv
import statistics
import tempfile
from pathlib import Path

import step_cost

SIZES = {2: (128, 64), 3: (16, 16, 16)}
STEPS = 16

BARE = """
set Dimension = {dim}

subsection Geometry
  set Generator = subdivided_hyper_rectangle
  set Arguments          = {cells} : {lower} : {upper} : true
  set Global refinements = 3
end

subsection Material
  set Young's modulus        = 1
  set Poisson's ratio        = 0.3
  set Law                    = elastic
  set Volumetric integration = full
end

subsection Boundary 0
  set Role     = traction
  set Traction = 0.1*t{zeros}
end

subsection Boundary 1
  set Role = free
end
{sides}
subsection Boundary {foundation}
  set Role = symmetry
end

subsection Boundary {top}
  set Role = clamped
end

subsection Time
  set Phases = 1: {steps}
end

subsection Solver
  set Linear solver     = multigrid
  set Contact tolerance = 1e-8
end

subsection Error control
  set Error bar = false
end

subsection Mesh refinement
  set Strategy = none
end

subsection Output
  set Fields every = 0
end
"""


def bare(dim):
    zeros, ones = ", ".join(dim * ["0"]), ", ".join([*(dim - 1) * ["1"], "1"])
    sides = ""
    if dim == 3:
        sides = "".join(
            f"\nsubsection Boundary {i}\n  set Role = symmetry\nend\n" for i in (2, 3)
        )
    return BARE.format(
        dim=dim,
        # three refinements make the levels of multigrid
        cells=", ".join(str(n // 8) for n in SIZES[dim]),
        lower=zeros,
        upper="2, 1" if dim == 2 else ones,
        zeros=(dim - 1) * "; 0",
        sides=sides,
        foundation=2 * (dim - 1),
        top=2 * (dim - 1) + 1,
        steps=STEPS,
    )


def effects(dim):
    """(name, entries, name of the scene that it is added to)"""
    foot = f"Boundary {2 * (dim - 1)}"
    vector = (dim - 1) * "; 0"
    return [
        # Entries of what is not there.
        (
            "absent effects",
            {
                f"{foot}/Friction bound": 0.01,
                f"{foot}/Foundation motion": f"t{vector}",
                "Material/perzyna/Yield radius": 0.001,
                "Loads/Body force": f"0{vector}",
                "Mesh refinement/Every n steps": 2,
            },
            "bare",
        ),
        (
            "friction",
            {
                f"{foot}/Role": "contact",
                f"{foot}/Friction law": "tresca",
                f"{foot}/Friction bound": 0.01,
            },
            "bare",
        ),
        ("moving foundation", {f"{foot}/Foundation motion": f"0.1*t{vector}"}, "friction"),
        ("maxwell", {"Material/Law": "maxwell", "Material/maxwell/Viscosity": 2}, "bare"),
        (
            "zener",
            {"Material/Law": "zener", "Material/zener/Relaxation time": 4},
            "bare",
        ),
        (
            "perzyna, half of it flows",
            {
                "Material/Law": "perzyna",
                "Material/perzyna/Yield radius": 0.02,
                "Material/perzyna/Viscosity": 4,
            },
            "bare",
        ),
        (
            "perzyna, nothing flows",
            {"Material/Law": "perzyna", "Material/perzyna/Yield radius": 10},
            "bare",
        ),
        (
            "norton",
            {
                "Material/Law": "norton",
                "Material/norton/Rate factor": 0.1,
                "Material/norton/Stress cap": 10,
            },
            "bare",
        ),
        (
            "parsed",
            {"Material/Law": "parsed", "Material/parsed/Factor": 0.1},
            "bare",
        ),
        ("Heun", {"Time/Scheme": "Heun"}, "maxwell"),
        ("backward Euler", {"Time/Scheme": "backward Euler"}, "maxwell"),
        (
            "history at quadrature points",
            {"Material/Stress history": "quadrature points"},
            "maxwell",
        ),
        ("mean dilatation", {"Material/Volumetric integration": "mean dilatation"}, "bare"),
        (
            "body force",
            {
                "Loads/Body force": f"0.01{vector}",
                "Initial state/Equilibrate": "true",
            },
            "bare",
        ),
        ("body force of t", {"Loads/Body force": f"0.01*t{vector}"}, "bare"),
        ("error bar", {"Error control/Error bar": "true"}, "bare"),
        (
            "adaptivity",
            {
                "Mesh refinement/Strategy": "residual",
                # about as many cells as without
                "Mesh refinement/Cell budget": 8192 if dim == 2 else 4096,
                "Mesh refinement/Maximal level": 4,
            },
            "bare",
        ),
        ("fields at every step", {"Output/Fields every": 1}, "bare"),
        ("checkpoints at every step", {"Checkpoint/Every n steps": 1}, "bare"),
    ]


def run(executable, dim, entries):
    """Seconds of a run, its largest memory in MB, degrees of freedom."""
    with tempfile.TemporaryDirectory() as work:
        scene = Path(work) / "scene.prm"
        scene.write_text(bare(dim))
        words = [str(executable), "--quiet", str(scene)]
        for entry, value in {**entries, "Output/Directory": work + "/results"}.items():
            words += ["--set", f"{entry}={value}"]
        output, memory = step_cost.run(words)
        with open(Path(work) / "results" / "statistics.csv", newline="") as table:
            rows = list(csv.DictReader(table))
    return float(rows[-1]["wall_total"]), memory, int(rows[-1]["dofs"])


def measure(executable, dim, repetitions=3):
    """A row for each effect."""
    entries_of, ratio_of, memory_of = {"bare": {}}, {"bare": 1.0}, {}
    for name, more, base in effects(dim):
        entries_of[name] = {**entries_of[base], **more}
        runs = {base: [], name: []}
        for _ in range(repetitions):
            for scene in runs:
                runs[scene].append(run(executable, dim, entries_of[scene]))
        ratios = [
            with_it[0] / without[0]
            for without, with_it in zip(runs[base], runs[name])
        ]
        for scene in runs:
            memory_of[scene] = statistics.median(memory for _, memory, _ in runs[scene])
        ratio_of[name] = ratio_of[base] * statistics.median(ratios)
        yield {
            "effect": name,
            "case": f"{dim}D",
            "dofs": runs[name][0][2],
            "beside": base,
            "seconds": statistics.median(seconds for seconds, _, _ in runs[name]),
            "over that": statistics.median(ratios),
            "spread": max(ratios) - min(ratios),
            "over bare": ratio_of[name],
            "MB": memory_of[name],
            "MB more": memory_of[name] - memory_of[base],
        }
