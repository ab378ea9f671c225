# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs in directories of their own, and parts of scenes that several files use."""

import csv
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from harness import (
    EXECUTABLE,
    SOURCE,
    Run,
    as_prm,
    launcher,
    run,
    run_program,
    run_study,
    scene_file,
)

EVERY_STEP = {"Checkpoint/Every n steps": 1, "Checkpoint/Keep": 1000}


def memory():
    """Where checkpoints need not wait for a disk, if there is room; else nothing."""
    folder = "/dev/shm"
    if os.access(folder, os.W_OK) and shutil.disk_usage(folder).free > 1 << 30:
        return folder


class Job:
    """A scene in a directory of its own, to be run several times."""

    place = memory()

    def __init__(self, scene, overrides=None, copy_of=None):
        prefix = f"restart_{Path(scene).name}_"
        self.work = Path(tempfile.mkdtemp(prefix=prefix, dir=self.place))
        self.results = self.work / "results"
        self.checkpoints = self.results / "checkpoint"
        self.scene = scene
        self.overrides = dict(overrides or {})
        if copy_of is not None:
            shutil.copytree(copy_of.results, self.results)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.work, ignore_errors=True)

    def arguments(self, *options, **overrides):
        file = self.work / f"{Path(self.scene).name}.prm"
        file.write_text(scene_file(self.scene).read_text())
        variant = self.work / "overrides.prm"
        variant.write_text(
            as_prm(
                {
                    "Output/Directory": self.results,
                    **self.overrides,
                    **{k.replace("__", "/"): v for k, v in overrides.items()},
                }
            )
        )
        return [*options, str(file), str(variant)]

    def start(self, *options, ranks=1, program=EXECUTABLE, **arguments):
        return subprocess.Popen(
            [*launcher(ranks), program, *self.arguments(*options)],
            cwd=self.work,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            **arguments,
        )

    def run(self, *options, code=0, ranks=1, overrides=None):
        process = run_program(
            self.arguments(*options, **(overrides or {})), ranks, self.work
        )
        if code is not None and process.returncode != code:
            raise AssertionError(
                f"{self.scene} {options}: exit code {process.returncode}, not "
                f"{code}:\n{process.stdout[-1000:]}\n{process.stderr[-3000:]}"
            )
        return Run(self.results, process)

    def steps(self):
        """Those of checkpoints that are finished, with a manifest."""
        manifests = self.checkpoints.glob("step_*/manifest.txt")
        return sorted(int(path.parent.name[5:]) for path in manifests)

    def step(self, n):
        return self.checkpoints / f"step_{n:06}"

    def forget_after(self, n):
        """As if the run had been killed before the next checkpoint."""
        for later in self.steps():
            if later > n:
                shutil.rmtree(self.step(later))


def without_wall_times(file):
    rows = [line.split(",") for line in file.read_text().splitlines()]
    keep = [i for i, name in enumerate(rows[0]) if not name.startswith("wall_")]
    return [[row[i] for i in keep] for row in rows]


TEXTS = "run,strategy,scheme,history,solver,ladder".split(",")


class Folder:
    """A working directory with a scene and what runs leave there."""

    def __init__(self, scene, **overrides):
        self.work = Path(tempfile.mkdtemp(prefix="study_"))
        self.scene = scene
        self.variant = self.work / "overrides.prm"
        self.results = self.work / "results"
        self.study = self.results / "study"
        self.overrides = {"Output/Directory": self.results}
        self.set(**overrides)

    def set(self, **overrides):
        self.overrides.update(
            {k.replace("__", "/").replace("_", " "): v for k, v in overrides.items()}
        )
        self.variant.write_text(as_prm(self.overrides))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.work, ignore_errors=True)

    def arguments(self, *arguments):
        return [*arguments, str(self.scene), str(self.variant)]

    def run(self, *arguments, ranks=1, code=None):
        """Of the scene, or study, effects and price; `code': see expect()."""
        is_study = arguments and arguments[0] in ("study", "effects", "price")
        call = run_study if is_study else run_program
        return call(self.arguments(*arguments), ranks, self.work, code)

    def rows(self):
        with open(self.study / "study.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        return [
            {k: v if k in TEXTS else float(v) for k, v in row.items()} for row in rows
        ]

    def ladder(self, name, **choice):
        rows = [
            row
            for row in self.rows()
            if row["ladder"] == name and all(row[k] == v for k, v in choice.items())
        ]
        return sorted(rows, key=lambda row: row["mesh_level"] + row["time_level"])

    def finished(self):
        """{run: what tells its result.json from another one}"""
        return {
            file.parent.name: (file.stat().st_ino, file.stat().st_mtime_ns)
            for file in self.study.glob("*/result.json")
        }


def manufactured(name, law=None, **overrides):
    """A scene of prm/verification/manufactured, perhaps with another law."""
    folder = SOURCE / "prm" / "verification" / "manufactured"
    text = (folder / f"{name}.prm").read_text()
    if law is not None:
        text = text.replace(
            text[text.index("  set Law ") : text.index("end\n\n# the sides")], ""
        )
        text += (folder / f"law_{law}.prm").read_text()
    return run(name, {"Output/Fields every": 0, **overrides}, text=text)


def boundaries(*roles):
    """Entries of the boundaries 0, 1, ..., each a role or a dictionary."""
    return {
        f"Boundary {i}/{name}": value
        for i, role in enumerate(roles)
        for name, value in ({"Role": role} if isinstance(role, str) else role).items()
    }


def on_boundary(number, **values):
    """Entries of one boundary; _ is a blank of their names."""
    return {
        f"Boundary {number}/{name.replace('_', ' ')}": value
        for name, value in values.items()
    }


def with_roles(**boundaries):
    """Entries of {role: numbers of boundaries}."""
    return {
        f"Boundary {number}/Role": role
        for role, numbers in boundaries.items()
        for number in numbers
    }


def of_law(name, **parameters):
    """Entries of a law and its parameters; _ is a blank of their names."""
    return {
        "Material/Law": name,
        **{
            f"Material/{name}/{parameter.replace('_', ' ')}": value
            for parameter, value in parameters.items()
        },
    }


def elastic_moduli(youngs_modulus, poissons_ratio):
    return {
        "Material/Young's modulus": youngs_modulus,
        "Material/Poisson's ratio": poissons_ratio,
    }


def entries(boundaries, values):
    """The same entries of several boundaries."""
    return {
        f"Boundary {side}/{name}": value
        for side in boundaries
        for name, value in values.items()
    }


def rotation(degrees, axis=None):
    """Rotation matrix: about z in 2D, about axis in 3D (Rodrigues)."""
    angle = np.radians(degrees)
    if axis is None:
        return np.array(
            [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        )
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
