# SPDX-License-Identifier: LGPL-2.1-or-later
"""Running the program and its studies."""

import os
import subprocess
import sys
from pathlib import Path

from plotting.results import UserError, read_statistics
from plotting.study import Study

SOURCE = Path(__file__).resolve().parents[2]


def build():
    """Build as contrib/run does; returns the executable."""
    script = (
        'source "$0/contrib/setup" && configure >&2 && '
        "build viscoplastic_contact >&2 && "
        'printf "%s" "$build_directory/viscoplastic_contact"'
    )
    process = subprocess.run(
        ["bash", "-c", script, SOURCE], stdout=subprocess.PIPE, text=True
    )
    if process.returncode != 0:
        raise UserError("the program could not be built; the reason is above")
    return Path(process.stdout)


def environment():
    """That of contrib/run: one thread a process, the kernels of the machine."""
    script = 'source "$0/contrib/setup" && prepare_environment && env -0'
    process = subprocess.run(
        ["bash", "-c", script, SOURCE], stdout=subprocess.PIPE, text=True
    )
    if process.returncode != 0:
        return {**os.environ, "OMP_NUM_THREADS": "1"}
    lines = (line.partition("=") for line in process.stdout.split("\0") if line)
    return {name: value for name, _, value in lines}


def set_options(overrides):
    return [
        word
        for name, value in overrides.items()
        for word in ("--set", f"{name}={value}")
    ]


class Program:
    """The executable, and the directory below which its results go."""

    def __init__(self, executable, directory):
        self.executable = Path(executable).resolve()
        self.directory = Path(directory).resolve()
        if not os.access(self.executable, os.X_OK):
            raise UserError(f"there is no program {self.executable} to run")
        self.environment = environment()

    def version(self):
        process = subprocess.run(
            [self.executable, "--version"], stdout=subprocess.PIPE, text=True
        )
        return process.stdout.strip().splitlines()[0] if process.stdout else ""

    def run(self, name, files, overrides):
        """The columns of statistics.csv of a run."""
        results = self.directory / name
        results.mkdir(parents=True, exist_ok=True)
        print(f"Run in {results}", file=sys.stderr, flush=True)
        process = subprocess.run(
            [
                self.executable,
                *files,
                *set_options({**overrides, "Output/Directory": results}),
            ],
            cwd=self.directory,
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        if process.returncode != 0:
            raise UserError(
                f"the run in {results} ended with code {process.returncode}: "
                f"{process.stderr.strip()}"
            )
        return read_statistics(results / "statistics.csv")

    def study(self, name, files, overrides):
        """The study of a scene, which may consist of several parameter files;
        runs that are finished are not repeated."""
        results = self.directory / name
        results.mkdir(parents=True, exist_ok=True)
        scene = " ".join(file.stem for file in files)
        print(f"Study of {scene} in {results}", file=sys.stderr, flush=True)
        command = [
            self.executable,
            "study",
            *files,
            *set_options({**overrides, "Output/Directory": results}),
        ]
        log = results / "study.log"
        with open(log, "w") as file:
            process = subprocess.run(
                command,
                cwd=self.directory,
                env=self.environment,
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=subprocess.PIPE,
                text=True,
            )
        if process.returncode != 0:
            raise UserError(
                f"the study of {scene} ended with code {process.returncode}: "
                f"{process.stderr.strip()} (its messages are in {log})"
            )
        return Study(results / "study")


def processor():
    """The model of the CPU and the number of cores this process may use."""
    model = "unknown processor"
    try:
        with open("/proc/cpuinfo") as file:
            for line in file:
                if line.startswith("model name"):
                    model = line.split(":", 1)[1].strip()
                    break
    except OSError:
        pass
    cores = len(os.sched_getaffinity(0))
    return f"{model}, {cores} core" + ("s" if cores != 1 else "")
