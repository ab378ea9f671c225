# SPDX-License-Identifier: LGPL-2.1-or-later
"""Running the program and its studies."""

import os
import subprocess
import sys
from pathlib import Path

from plotting.results import UserError  # also makes the module below known
from plotting.study import Study

import viscoplastic_contact
from viscoplastic_contact.program import RunError

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


class Program(viscoplastic_contact.Program):
    """The program, and the directory below which its results go."""

    def __init__(self, executable, directory):
        super().__init__(executable, environment=environment())
        self.directory = Path(directory).resolve()

    def run(self, name, files, overrides):
        """The columns of statistics.csv of a run."""
        results = self.directory / name
        print(f"Run in {results}", file=sys.stderr, flush=True)
        try:
            return super().run(files, results, overrides).statistics
        except RunError as error:
            raise UserError(
                f"the run in {results} ended with code {error.code}: {error}"
            ) from error

    def study(self, name, files, overrides):
        """The study of a scene, which may consist of several parameter files;
        runs that are finished are not repeated."""
        results = self.directory / name
        results.mkdir(parents=True, exist_ok=True)
        scene = " ".join(file.stem for file in files)
        print(f"Study of {scene} in {results}", file=sys.stderr, flush=True)
        log = results / "study.log"
        try:
            super().study(files, results, overrides, log)
        except RunError as error:
            raise UserError(
                f"the study of {scene} ended with code {error.code}: {error} "
                f"(its messages are in {log})"
            ) from error
        return Study(results / "study")
