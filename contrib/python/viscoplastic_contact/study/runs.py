# SPDX-License-Identifier: LGPL-2.1-or-later
"""The runs of one scene on other meshes and with other steps, each in a directory
of its own below that of the study. A finished run leaves result.json there, which
is written at once (a file is renamed) and last of all: a run is finished if that
file exists and belongs to the same scene, program and number of ranks."""

import fcntl
import json
import os
import subprocess
import zlib
from pathlib import Path

from ..scene import set_options
from ..tables import RunError, UserError
from .analysis import cost_of_run
from .record import RunKey, from_json, make_record, read_table, to_json
from .scene import Scene
from .words import seconds_in_words

# What runs of a study go without.
NO_OUTPUTS = (
    *("Output/Fields every=0", "Output/Fields interval=0", "Output/Point fields="),
    *("Output/Lines=", "Output/Line fields=", "Output/Integrals="),
    *("Checkpoint/Every n steps=0", "Checkpoint/Wall time interval=0"),
)


class Interrupted(RunError):
    """A signal has ended a study."""

    def __init__(self, signal, what):
        super().__init__(f"{signal} has ended {what}; the same command goes on.", 3)


class Failure(UserError):
    """A scene could not be computed, and why."""


class TooSlow(Failure):
    """A run was ended for its time."""


def make_directory(path):
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
    except OSError:
        raise UserError(
            f"The results directory '{path}' cannot be written; change "
            "'Output/Directory' or its permissions."
        ) from None


def replace_file(path, text):
    """Write a file at once: others see the old one or the new one."""
    part = Path(f"{path}.part")
    try:
        with open(part, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except OSError as error:
        raise UserError(f"'{path}' cannot be written: {error.strerror}.") from error


def lock(path):
    """A file that keeps other processes out, until it is closed, be it by the end of the
    process; who closes it removes it first. None where there are no locks to be had."""
    try:
        while True:
            file = open(path, "a")
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # Somebody may have removed it meanwhile: then it is made again.
            if path.exists() and os.path.samestat(os.fstat(file.fileno()), path.stat()):
                return file
            file.close()
    except BlockingIOError:
        file.close()
        raise UserError(
            f"Another run is writing into '{path.parent}/'; wait until it has ended, "
            "or choose another 'Output/Directory' and 'Checkpoint/Directory'."
        ) from None
    except OSError:
        return None


class StudyRuns:
    """The runs of the scene that files and overrides (`Section/Entry=value') give.

    With may_subdivide, runs divide given steps beyond the stability limit where the
    scene does; otherwise they have the given steps, or fail. With outputs they write
    fields and checkpoints as the scene does. Reference is the key of the run with whose
    fields those of all others are compared, if any; records of runs that have been
    compared with another one, or none, do not count as finished."""

    lock = None

    def __init__(
        self, program, files, overrides, scene=None, may_subdivide=False, outputs=False
    ):
        self.program = program
        self.files, self.overrides = [str(file) for file in files], list(overrides)
        self.scene = scene or Scene(program, self.files, self.overrides)
        self.directory = self.scene.directory + "study/"
        self.may_subdivide, self.has_outputs = may_subdivide, outputs
        self.reference = None

    def lock_directory(self):
        """Make the directory of the study, and keep other studies out of it."""
        make_directory(self.directory)
        path = Path(self.directory) / "viscoplastic_contact.lock"
        self.lock = self.lock or lock(path)

    def __del__(self):
        if self.lock:
            Path(self.lock.name).unlink(missing_ok=True)
            self.lock.close()

    def name(self, key):
        return self.scene.name(key)

    def place(self, key):
        return self.directory + self.name(key)

    def table(self, key):
        """The statistics of a run."""
        return read_table(Path(self.place(key)) / "statistics.csv")

    def is_compared(self, key):
        """Whether a run is compared with the reference."""
        return self.reference not in (None, key) and not key.is_timing

    def entries_of(self, key):
        """What is set for a run. Raises UserError for a mesh that is too coarse."""
        scene, place = self.scene, self.place(key)
        result = scene.discretization(
            key, scene.phases_of(key), scene.step_tolerance(key), self.may_subdivide
        )
        result += [
            f"Output/Directory={place}",
            f"Output/Reference fields={str(key == self.reference).lower()}",
            "Checkpoint/Wall time limit=0",
            f"Checkpoint/Directory={place}/checkpoint",
        ]
        # A scene without one of its effects may lack what it records.
        if not self.has_outputs:
            result += NO_OUTPUTS
        if self.is_compared(key):
            place = self.place(self.reference)
            result.append(f"Exact solution/Reference directory={place}")
        return result

    def stamp(self, key, entries):
        """What tells a run from those of other scenes and programs."""
        about, reference = self.scene.about, "Exact solution/Reference directory"
        knows_reference = self.reference is not None and not key.is_timing
        values = {**self.scene.values, **dict(entry.split("=", 1) for entry in entries)}
        text = f"{about['files']}\n"
        for path, value in sorted(values.items()):
            is_other = path.startswith(("Output/", "Study/", "Checkpoint/"))
            if knows_reference and path == reference:
                is_other = True
            if self.has_outputs and path.startswith("Output/Fields"):
                is_other = False
            if not is_other or path in ("Output/Points", "Output/Reference fields"):
                text += f"{path}={value}\n"
        if knows_reference:
            text += self.name(self.reference)
        return {
            "ranks": str(self.program.ranks),
            "revision": about["revision"],
            "scene": str(zlib.crc32(text.encode())),
            "version": about["version"],
        }

    def find(self, key):
        """The record of a run that is finished. One that is damaged or belongs to
        something else does not count."""
        expected = self.stamp(key, self.entries_of(key))
        path = Path(self.place(key)) / "result.json"
        try:
            record = from_json(path.read_text(encoding="utf-8"), path)
        except (OSError, UserError, UnicodeDecodeError):
            return None  # the run is made again
        record.stamp.pop("overrides", None)
        # Levels count from a tolerance that may have changed, names do not.
        has_key = record.key == key
        if key.variant.strategy == "tolerance":
            has_key = record.key.variant == key.variant and record.name == self.name(key)
        record.key = key
        return record if has_key and record.stamp == expected else None

    def make(self, key, what, limit=None):
        """The record of a run, which goes on from a checkpoint that a signal has left.
        Raises Failure: TooSlow where it takes more than so many seconds as a limit;
        and Interrupted, whose sentence says what a signal has ended."""
        entries = self.entries_of(key)
        stamp, place = self.stamp(key, entries), Path(self.place(key))
        # What has been left of the same run goes on, of another one goes.
        begun = "".join(f"{name} {value}\n" for name, value in sorted(stamp.items()))
        make_directory(place)
        (place / "result.json").unlink(missing_ok=True)
        mark = place / "begun"
        goes_on = mark.exists() and mark.read_text(errors="replace") == begun
        replace_file(mark, begun)
        try:
            signal = self.program.launch(
                *("--quiet", "--log", place / "log.txt"),
                *(["--restart=auto"] if goes_on else []),
                *self.files,
                *set_options(self.overrides + entries),
                limit=limit,
            )
        except subprocess.TimeoutExpired:
            raise TooSlow(f"It takes more than {limit:.3g} s.") from None
        except RunError as error:
            if error.signal:
                raise Interrupted(error.signal, what) from None
            raise Failure(str(error)) from None
        record = self.record_of(key, place)
        if record is None:  # there was nothing left to compute
            mark.unlink()
            return self.make(key, what, limit)
        record.name, record.stamp = self.name(key), dict(stamp)
        record.stamp["overrides"] = "; ".join(self.overrides + entries)
        replace_file(place / "result.json", to_json(record))
        if signal:
            raise Interrupted(signal, what)
        found = self.find(key)
        if found is None:
            raise UserError(f"'{place}/result.json' has changed since it was written.")
        return found

    def record_of(self, key, place):
        """The numbers of a run in a directory of results; None if what it has cost is
        not there."""
        scene, strategy = self.scene, key.variant.strategy
        about = json.loads((place / "run.json").read_text(encoding="utf-8"))
        if about.get("costs") is None:
            return None
        record = make_record(
            key,
            read_table(place / "statistics.csv"),
            about["costs"],
            self.is_compared(key),
            # its column, whatever names of places the scene has
            about.get("estimated_error_of_quantity", {}).get("quantity", ""),
        )
        numbers = record.numbers
        # Of a uniform mesh with as many cells.
        share = scene.n_cells / numbers["cells"]
        numbers["h"] = scene.h * share ** (1.0 / scene.dimension)
        if strategy == "tolerance":
            numbers["tolerance"] = scene.tolerance(key)
            return record
        numbers["set_ups"] = scene.n_set_ups(
            strategy, numbers["steps"], scene.planned_steps(key)
        )
        if scene.has_step_control:
            numbers["step_tolerance"] = scene.step_tolerance(key)
        return record

    def make_timings(self, records, mesh_level, seconds, what, console):
        """Yield the records of runs of one method variant on finer meshes than those of
        its records: each with half of the mesh width of the one before, up to the mesh
        level, and with as many steps as a record has and half of the seconds left allow.
        Prices of long runs go by these instead of by extrapolation, and learn of solvers
        that small meshes do not have. They end where the next one would take too much.
        For what see make()."""
        first, times = records[0].key, [record.key.time_level for record in records]
        finest, known = max(record.key.mesh_level for record in records), list(records)
        for level in range(finest + 1, mesh_level + 1):
            # Long steps take more iterations than those of the run that is priced.
            for time in range(max(times), min(times) - 1, -1):
                key = RunKey(first.variant, level, time, is_timing=True)
                cost, record = cost_of_run(self.scene, known, key), self.find(key)
                if record or cost[0] <= 0.5 * seconds:
                    break
            if not record:
                if not is_affordable(cost, seconds):
                    return
                about = seconds_in_words(cost[0])
                console.status(f"Timing run {self.name(key)}, about {about}")
                try:
                    record = self.make(key, what)
                except Failure:  # what fails tells nothing
                    return
            seconds -= record.number("seconds_total")
            known.append(record)
            yield record


def is_affordable(cost, seconds):
    """Whether seconds and memory of a run, as cost_of_run() has them, are no more than
    so many seconds and half of the memory of this machine."""
    memory = 0.5e-6 * os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGESIZE")
    return cost[0] <= seconds and cost[1] <= memory


def seconds_of(records):
    return sum(record.number("seconds_total") for record in records)


def seconds_for_timing(spent, price):
    """As many as the runs have taken that there are, or a tenth of those of the run that
    is to be priced, but one at least."""
    return max(1.0, spent, price / 10.0)
