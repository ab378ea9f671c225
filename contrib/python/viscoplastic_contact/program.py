# SPDX-License-Identifier: LGPL-2.1-or-later
"""Running the program and its studies."""

import datetime
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from .results import Results
from .scene import value_text, write_scene
from .tables import (
    UserError,
    frame,
    read_effects,
    read_study_about,
    read_study_table,
)

# contrib/python/viscoplastic_contact of the sources, or the same below
# share/viscoplastic_contact of an installation.
TOP = Path(__file__).resolve().parents[3]


class RunError(UserError):
    """The program has refused or ended a run: its sentence, and its code."""

    def __init__(self, sentence, code):
        super().__init__(sentence)
        self.code = code


class StudyResults:
    """What a study found: columns over its runs, and study.json."""

    def __init__(self, directory):
        self.directory = Path(directory).resolve()
        self.columns = read_study_table(self.directory / "study.csv")
        self.about = read_study_about(self.directory / "study.json")

    def __getitem__(self, name):
        return self.columns[name]

    def frame(self):
        """One row a run, as a pandas.DataFrame."""
        return frame(self.columns)


def find_executable():
    """That of the environment variable VISCOPLASTIC_CONTACT, of the build or
    the installation that this module belongs to, or of the PATH."""
    for found in (
        os.environ.get("VISCOPLASTIC_CONTACT"),
        TOP / "build" / "viscoplastic_contact",
        TOP.parents[1] / "bin" / "viscoplastic_contact",
        shutil.which("viscoplastic_contact"),
    ):
        if found and os.access(found, os.X_OK):
            return Path(found)
    raise UserError(
        "there is no program viscoplastic_contact in the PATH; set the environment "
        "variable VISCOPLASTIC_CONTACT to where it is"
    )


def processor():
    """The model of the CPU and the number of cores this process may use."""
    model = "unknown processor"
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                model = line.split(":", 1)[1].strip()
                break
    except OSError:
        pass
    cores = len(os.sched_getaffinity(0))
    return f"{model}, {cores} core" + ("s" if cores != 1 else "")


def set_options(overrides):
    """{"Section/Entry": value} as options of the program."""
    return [
        word
        for name, value in (overrides or {}).items()
        for word in ("--set", f"{name}={value_text(value, name)}")
    ]


class Program:
    """The program, run on so many ranks.

    A scene is a parameter file, a list of them of which later ones override
    earlier ones, or a dictionary as scene.py describes it; overrides are
    {"Section/Entry": value}.
    """

    def __init__(self, executable=None, ranks=1, launcher=("mpirun",), environment=None):
        self.executable = Path(executable or find_executable()).resolve()
        if not os.access(self.executable, os.X_OK):
            raise UserError(f"there is no program {self.executable} to run")
        self.ranks = ranks
        self.launcher = list(launcher)
        # One thread a process: several would wait for each other.
        self.environment = environment or {"OMP_NUM_THREADS": "1", **os.environ}

    def command(self, *arguments):
        """The words of a call; arguments are those of the command line."""
        launcher = [*self.launcher, "-n", self.ranks] if self.ranks > 1 else []
        return list(map(str, [*launcher, self.executable, *arguments]))

    def alone(self):
        """The same on one rank."""
        return Program(self.executable, environment=self.environment)

    def call(self, *arguments, stdout=subprocess.PIPE):
        """What the program prints."""
        process = subprocess.run(
            self.command(*arguments),
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=stdout,
            stderr=subprocess.PIPE,
            text=True,
        )
        if process.returncode != 0:
            code = process.returncode
            raise RunError(sentence(process.stderr, code), code)
        return process.stdout

    def version(self):
        """The line of --version."""
        return self.call("--version").strip()

    def origin(self):
        """Where and when measurements are made: version, machine and date."""
        return f"{self.version()}; {processor()}; {datetime.date.today()}"

    def check(self, scene, overrides=None):
        """What --check prints: effects, size, solver and memory."""
        with tempfile.TemporaryDirectory() as directory:
            files = parameter_files(scene, directory)
            return self.call("--check", *files, *set_options(overrides))

    def run(self, scene, directory, overrides=None, restart=False, log=None):
        """The Results of a run, which go to this directory. With restart it goes
        on from a checkpoint if there is one; messages go to the file log."""
        self.compute(scene, directory, overrides, restart, log)
        return Results(directory)

    def study(self, scene, directory, overrides=None, log=None):
        """The StudyResults of a scene; what is finished is not repeated."""
        from .study.ladder import Study  # scipy takes time
        from .study.runs import StudyRuns

        console, words = self.of_study(scene, directory, overrides, log)
        Study(StudyRuns(self, *words), console).run()
        return StudyResults(Path(directory) / "study")

    def effects(self, scene, directory, overrides=None, log=None):
        """What leaving out each effect changes: effects.json."""
        from .study.effects import EffectsStudy

        console, words = self.of_study(scene, directory, overrides, log)
        EffectsStudy(self, *words, console).run()
        return read_effects(Path(directory) / "effects" / "effects.json")

    def of_study(self, scene, directory, overrides, log):
        """The console of a study, and its files and entries."""
        from .study.console import Console

        entries = {**(overrides or {}), "Output/Directory": Path(directory).resolve()}
        return Console(log=log), (
            parameter_files(scene, directory),
            [f"{name}={value_text(value, name)}" for name, value in entries.items()],
        )

    def compute(self, scene, directory, overrides, restart, log):
        directory = Path(directory).resolve()
        directory.mkdir(parents=True, exist_ok=True)
        arguments = [
            *parameter_files(scene, directory),
            *set_options({**(overrides or {}), "Output/Directory": directory}),
            *(["--restart=auto"] if restart else []),
        ]
        if log is None:
            self.call("--quiet", *arguments, stdout=subprocess.DEVNULL)
            return
        with open(log, "w", encoding="utf-8") as file:
            self.call(*arguments, stdout=file)


def parameter_files(scene, directory):
    """The files of a scene; that of a dictionary is written to the directory."""
    if isinstance(scene, dict):
        directory = Path(directory)
        directory.mkdir(parents=True, exist_ok=True)
        return [write_scene(scene, directory / "scene.prm")]
    return [scene] if isinstance(scene, (str, Path)) else list(scene)


def sentence(messages, code):
    """What the program says of itself among the messages of a run."""
    name = "viscoplastic_contact: "
    said = [line[len(name) :] for line in messages.splitlines() if line.startswith(name)]
    return said[-1] if said else messages.strip() or f"the program ended with code {code}"
