# SPDX-License-Identifier: LGPL-2.1-or-later
"""Running the program and its studies."""

import ctypes
import datetime
import os
import shutil
import signal
import subprocess
import tempfile
from pathlib import Path

from .results import Results
from .scene import set_options, write_scene
from .tables import (
    RunError,
    UserError,
    frame,
    read_effects,
    read_study_about,
    read_study_table,
)

# contrib/python/viscoplastic_contact of the sources, or the same below
# share/viscoplastic_contact of an installation.
TOP = Path(__file__).resolve().parents[3]


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

    def process(self, stdout):
        """What processes have in common."""
        null, pipe = subprocess.DEVNULL, subprocess.PIPE
        streams = {"stdin": null, "stdout": stdout, "stderr": pipe, "text": True}
        return {"env": self.environment, **streams}

    def call(self, *arguments, stdout=subprocess.PIPE):
        """What the program prints."""
        process = subprocess.run(self.command(*arguments), **self.process(stdout))
        check_end(process.returncode, process.stderr)
        return process.stdout

    def launch(self, *arguments, stdout=subprocess.DEVNULL, limit=None):
        """A call that passes on the signals SIGINT and SIGTERM that come meanwhile, at
        which the program ends after a checkpoint, and ends it after so many seconds as
        a limit: then raises subprocess.TimeoutExpired. Returns the name of the first
        signal; empty without one."""
        received = []
        process = subprocess.Popen(
            self.command(*arguments),
            start_new_session=True,
            preexec_fn=die_with_parent,
            **self.process(stdout),
        )

        def forward(number, _):
            received.append(signal.Signals(number).name)
            process.send_signal(number)

        before = {n: signal.signal(n, forward) for n in (signal.SIGINT, signal.SIGTERM)}
        try:
            _, messages = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            process.terminate()
            process.communicate()
            if not received:
                raise
            messages = ""
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
        check_end(process.returncode, messages, *received[:1])
        return "".join(received[:1])

    @staticmethod
    def processor():
        """The model of the CPU and the number of cores this process may use."""
        model = "unknown processor"
        try:
            lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
            names = [line for line in lines if line.startswith("model name")]
            model = names[0].split(":", 1)[1].strip() if names else model
        except OSError:
            pass
        cores = len(os.sched_getaffinity(0))
        return f"{model}, {cores} core" + ("s" if cores != 1 else "")

    def version(self):
        """The line of --version."""
        return self.call("--version").strip()

    def origin(self):
        """Where and when measurements are made: version, machine and date."""
        return f"{self.version()}; {self.processor()}; {datetime.date.today()}"

    def check(self, scene, overrides=None):
        """What --check prints: effects, size, solver and memory."""
        with tempfile.TemporaryDirectory() as directory:
            files = parameter_files(scene, directory)
            return self.call("--check", *files, *set_options(overrides))

    def run(self, scene, directory, overrides=None, restart=False, log=None):
        """The Results of a run, which go to this directory. With restart it goes
        on from a checkpoint if there is one; messages go to the file log."""
        directory = Path(directory).resolve()
        directory.mkdir(parents=True, exist_ok=True)
        arguments = [
            *parameter_files(scene, directory),
            *set_options({**(overrides or {}), "Output/Directory": directory}),
            *(["--restart=auto"] if restart else []),
        ]
        if log is None:
            self.call("--quiet", *arguments, stdout=subprocess.DEVNULL)
        else:
            with open(log, "w", encoding="utf-8") as file:
                self.call(*arguments, stdout=file)
        return Results(directory)

    def study(self, scene, directory, overrides=None, log=None):
        """The StudyResults of a scene; what is finished is not repeated."""
        from .study.ladder import Study  # scipy takes time
        from .study.runs import StudyRuns
        from .study.words import Console

        words = self.of_study(scene, directory, overrides)
        Study(StudyRuns(self, *words), Console(log=log)).run()
        return StudyResults(Path(directory) / "study")

    def effects(self, scene, directory, overrides=None, log=None):
        """What leaving out each effect changes: effects.json."""
        from .study.effects import EffectsStudy
        from .study.words import Console

        words = self.of_study(scene, directory, overrides)
        EffectsStudy(self, *words, Console(log=log)).run()
        return read_effects(Path(directory) / "effects" / "effects.json")

    def of_study(self, scene, directory, overrides):
        """The files and entries of a study."""
        entries = {**(overrides or {}), "Output/Directory": Path(directory).resolve()}
        return parameter_files(scene, directory), set_options(entries)[1::2]


def parameter_files(scene, directory):
    """The files of a scene; that of a dictionary is written to the directory."""
    if isinstance(scene, dict):
        directory = Path(directory)
        directory.mkdir(parents=True, exist_ok=True)
        return [write_scene(scene, directory / "scene.prm")]
    return [scene] if isinstance(scene, (str, Path)) else list(scene)


def die_with_parent():
    """In a new process: what nobody waits for any more ends. Linux only."""
    try:
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
    except (OSError, AttributeError):
        pass


def check_end(code, messages, *received):
    """Raise what the program says of itself among its messages, unless it has done
    what it should."""
    name = "viscoplastic_contact: "
    if code != 0:
        lines = messages.splitlines()
        said = [line[len(name) :] for line in lines if line.startswith(name)]
        sentence = said[-1] if said else messages.strip()
        raise RunError(
            sentence or f"the program ended with code {code}", code, *received
        )
