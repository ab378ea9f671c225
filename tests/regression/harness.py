# SPDX-License-Identifier: LGPL-2.1-or-later
"""Run the program on a scene and read what it wrote.

The regression tests treat the program as a user does: a parameter file goes
in, an exit code, statistics.csv and VTU series come out.  Everything is read
with general readers (csv, json, xml, meshio), so that a file only our own code
could read would fail here.

The executable is taken from the environment variable VISCOPLASTIC_CONTACT,
otherwise from build/ beside prm/.  Results go to temporary directories; set
KEEP_RESULTS to a directory to keep them.
"""

import atexit
import csv
import json
import multiprocessing
import os
import re
import runpy
import shutil
import subprocess
import sys
import tempfile
import unittest
import weakref
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "server"))

import program_server

EXECUTABLE = os.environ.get(
    "VISCOPLASTIC_CONTACT", str(SOURCE / "build" / "viscoplastic_contact")
)
# The program for many runs (tests/server), or none, and what stands for the program
# where a test is not about its process.
SERVER = os.environ.get("VISCOPLASTIC_CONTACT_SERVER")
PROGRAM = program_server.CLIENT if SERVER else EXECUTABLE
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none"]

# The algebraic error at which iterations stop at the latest where a scene leaves
# that to the error bar (doc/error_bar.md).
COUPLED = 1e-5

# Columns that tell how the numbers were found: they may differ from run to
# run and from rank count to rank count.
EFFORT = {
    "contact_iterations",
    "linear_iterations",
    "newton_iterations",
    "duality_gap",
    "algebraic_error",
    "bound_iterations",
    "contraction",
    "estimate_algebraic",
}

# Fields that have one value a cell.
CELL_DATA = (
    *("stress_", "irreversible_stress_", "von_mises", "estimator", "subdomain"),
    *("strain_", "irreversible_strain_", "creep_", "principal_stress_", "temperature"),
    "history_",
)

# Columns that are errors of the solution of one step, compared with bounds,
# not with each other.
DEFECTS = {
    "force_balance_defect",
    "max_utilisation",
    "max_stick_slip",
    "slip_misalignment",
    "energy_balance_defect",
}


def scene_file(name):
    """The parameter file of that name in prm/verification or prm/demos, e.g.
    `slab' or `hard/hold_2d'."""
    (file,) = (SOURCE / "prm").glob(f"[vd]*/{name}.prm")
    return file


def as_prm(overrides):
    """Parameter-file text of {"Section/Subsection/Entry": value}."""
    text = []
    for path, value in overrides.items():
        *sections, entry = path.split("/")
        text += [f"subsection {name}" for name in sections]
        text.append(f"set {entry} = {value}")
        text += ["end"] * len(sections)
    return "\n".join(text) + "\n"


def lattice(points):
    """Points as integers on a fine lattice, to recognize equal ones.

    VTU coordinates have single precision.  The offset keeps dyadic fractions
    and thirds of the unit, where mesh points lie, away from the jumps.
    """
    return np.floor(np.asarray(points, float) * 2**16 + 0.31).astype(int)


def without_unit(name):
    """"t" of "t [day]", as columns and fields are called in scenes with units."""
    return re.sub(r" \[[^]]*\]$", "", name)


def has_points(vtu):
    piece = next(xml.parse(vtu).getroot().iter("Piece"))
    return int(piece.attrib["NumberOfPoints"]) > 0


class Fields:
    """One output time of a VTU series, all pieces joined."""

    def __init__(self, pieces):
        offset, points, cells = 0, [], []
        for piece in pieces:
            points.append(piece.points)
            if len({block.type for block in piece.cells}) != 1:
                raise AssertionError("more than one cell type in a VTU file")
            cells += [block.data + offset for block in piece.cells]
            offset += len(piece.points)
        self.point_data, self.cell_data = {}, {}
        if not pieces:  # no face of a contact is there at this time
            self.points, self.cells = np.empty((0, 3)), np.empty((0, 0), int)
            return
        self.points = np.concatenate(points).astype(float)
        self.cells = np.concatenate(cells)
        for label in pieces[0].point_data:
            values = np.concatenate([p.point_data[label] for p in pieces])
            values = values.astype(float)
            name = without_unit(label)
            if not name.startswith(CELL_DATA):
                self.point_data[name] = values
                continue
            # deal.II writes one copy of each point a cell, and cell data as
            # point data that are constant in the cell
            values = values[self.cells]
            if not np.array_equal(values.min(axis=1), values.max(axis=1)):
                raise AssertionError(f"{name} is not constant in the cells")
            self.cell_data[name] = values[:, 0]

    def nodes(self):
        """Indices of one copy of each point: faces and cells repeat them."""
        _, first = np.unique(lattice(self.points), axis=0, return_index=True)
        return first


class Run:
    """A finished run: exit code, messages and, if it succeeded, results."""

    def __init__(self, directory, process):
        self.directory = directory
        self.returncode = process.returncode
        self.stdout = process.stdout
        self.stderr = process.stderr

    def __getitem__(self, column):
        return self.statistics[column]

    @property
    def statistics(self):
        """{column without unit: array over steps}, in file order."""
        if not hasattr(self, "_statistics"):
            with open(self.directory / "statistics.csv", newline="") as file:
                rows = list(csv.reader(file))
            width = len(rows[0])
            if any(len(row) != width for row in rows):
                raise AssertionError("statistics.csv has rows of unequal length")
            table = np.array([[float(v) for v in row] for row in rows[1:]])
            names = [without_unit(name.strip()) for name in rows[0]]
            self._statistics = dict(zip(names, table.T))
        return self._statistics

    def row(self, t):
        """Index of the step that ends at time t."""
        index = int(np.argmin(abs(self["t"] - t)))
        if abs(self["t"][index] - t) > 1e-9 * max(1, abs(t)):
            raise AssertionError(f"no step ends at t = {t}")
        return index

    def vector(self, prefix):
        """Columns prefix_x, prefix_y(, prefix_z) as one array (step, axis)."""
        axes = [a for a in "xyz" if f"{prefix}_{a}" in self.statistics]
        return np.stack([self[f"{prefix}_{a}"] for a in axes], axis=1)

    def series(self, name):
        """[(time, pvtu file)] as listed in name.pvd."""
        root = xml.parse(self.directory / f"{name}.pvd").getroot()
        return [
            (float(e.attrib["timestep"]), self.directory / e.attrib["file"])
            for e in root.iter("DataSet")
        ]

    def fields(self, name="solution", index=-1):
        """The fields of one entry of a series, default the last."""
        record = self.series(name)[index][1]
        files = [
            record.parent / e.attrib["Source"]
            for e in xml.parse(record).getroot().iter("Piece")
        ]
        import meshio  # takes longer than all other imports, and few tests need it

        # It cannot read files without points, which ranks without a face of the
        # contact write.
        return Fields([meshio.read(file) for file in files if has_points(file)])

    @property
    def info(self):
        return json.loads((self.directory / "run.json").read_text())


def expect(process, code):
    """A process that has to have ended with this code, unless it is None."""
    if code is not None and process.returncode != code:
        raise AssertionError(
            f"{process.args} ended with code {process.returncode}:\n"
            f"{process.stderr[-3000:]}"
        )
    return process


def run_program(arguments, ranks, work, code=None):
    """The finished program as a subprocess.CompletedProcess; that of a server
    where there is one, which takes no arguments with blanks. `code': see
    expect()."""
    if SERVER and not any(re.search(r"\s", str(word)) for word in arguments):
        ended_with = server(ranks).run(work, arguments)
        words = [
            (work / name).read_text(errors="replace") for name in ("stdout", "stderr")
        ]
        process = subprocess.CompletedProcess(arguments, ended_with, *words)
    else:
        process = subprocess.run(
            [*launcher(ranks), PROGRAM, *map(str, arguments)],
            cwd=work,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            errors="replace",
        )
    return expect(process, code)


def study_command(*arguments):
    """The words of contrib/study, effects or price after it has been built."""
    return [sys.executable, "-m", "viscoplastic_contact.study", *map(str, arguments)]


def study_environment():
    """What contrib/study gives to its runs, for tests on few cores."""
    return {
        **os.environ,
        "OMP_NUM_THREADS": "1",
        "PYTHONPATH": str(SOURCE / "contrib" / "python"),
        "PYTHONDONTWRITEBYTECODE": "1",
        "VISCOPLASTIC_CONTACT": PROGRAM,
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
        "OMPI_MCA_hwloc_base_binding_policy": "none",
    }


def forked(command, task, work=None):
    """A task in a fork of this process, which has loaded what takes long to load, as
    the subprocess.CompletedProcess of a command that does the same."""
    command = list(map(str, command))
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:

        def run_it():
            with open(os.devnull) as nothing:
                for number, file in enumerate((nothing, out, err)):
                    os.dup2(file.fileno(), number)
            os.chdir(work or ".")
            sys.argv = command
            task()

        sys.stdout.flush()
        sys.stderr.flush()
        process = multiprocessing.get_context("fork").Process(target=run_it)
        process.start()
        process.join()
        streams = []
        for file in out, err:
            file.seek(0)
            streams.append(file.read())
    return subprocess.CompletedProcess(command, process.exitcode, *streams)


def run_study(arguments, ranks, work, code=None):
    """A study, effects or price as a subprocess.CompletedProcess."""
    package = str(SOURCE / "contrib" / "python")
    if package not in sys.path:
        sys.path.insert(0, package)
    from viscoplastic_contact.study import effects, ladder, pricing  # noqa: F401

    def task():
        os.environ.update(study_environment())
        runpy.run_module(
            "viscoplastic_contact.study", run_name="__main__", alter_sys=True
        )

    command = ["study", arguments[0], "-n", ranks, *arguments[1:]]
    return expect(forked(command, task, work), code)


def launcher(ranks):
    """The command that starts so many ranks; nothing for one."""
    return [*MPIRUN, "-n", str(ranks)] if ranks > 1 else []


_servers = {}


def server(ranks):
    """The program, started at its first run; no limits but an hour."""
    if ranks not in _servers or _servers[ranks].has_ended():
        _servers[ranks] = program_server.Server(
            [*launcher(ranks), PROGRAM, "--serve"],
            3600,
            3600,
            0,
            {**os.environ, "OMP_NUM_THREADS": "1"},
        )
        atexit.register(_servers[ranks].close)
    return _servers[ranks]


def run(scene, overrides=None, ranks=1, text=None, check=True):
    """Run the program.

    scene      name of a file in prm/verification or prm/demos, without .prm
    overrides  {"Section/Entry": value}, in a second parameter file: later
               files override earlier ones
    text       the whole parameter file instead of a scene
    check      fail unless the program succeeds
    """
    keep = os.environ.get("KEEP_RESULTS")
    if keep:
        Path(keep).mkdir(parents=True, exist_ok=True)
    if text is None:
        text = scene_file(scene).read_text()
    scene = Path(scene).name
    work = Path(tempfile.mkdtemp(prefix=f"{scene}_", dir=keep))

    overrides = {"Output/Directory": work / "results", **(overrides or {})}
    files = work / f"{scene}.prm", work / "overrides.prm"
    files[0].write_text(text)
    files[1].write_text(as_prm(overrides))

    process = run_program(files, ranks, work)
    result = Run(work / "results", process)
    if not keep:
        # results live as long as the Run
        weakref.finalize(result, shutil.rmtree, work, ignore_errors=True)
    expect(process, 0 if check else None)
    return result


class TestCase(unittest.TestCase):
    """unittest with comparisons of numbers and the discrete identities."""

    longMessage = True

    def assertClose(self, value, expected, relative=0.0, absolute=0.0, what=""):
        """abs(value - expected) <= relative abs(expected) + absolute."""
        value, expected = np.asarray(value, float), np.asarray(expected, float)
        with np.errstate(invalid="ignore"):
            defect = abs(value - expected) - relative * abs(expected) - absolute
        defect = np.where(value == expected, 0, defect)  # infinities
        if not np.all(defect <= 0):
            worst = np.unravel_index(
                np.nanargmax(np.where(np.isnan(defect), np.inf, defect)),
                np.shape(defect),
            )
            shape = np.shape(defect)
            got = np.broadcast_to(value, shape)[worst]
            wanted = np.broadcast_to(expected, shape)[worst]
            self.fail(
                f"{what}: {got:.10g} is not {wanted:.10g} "
                f"(difference {got - wanted:.3g}, allowed "
                f"{relative * abs(wanted) + absolute:.3g}, at index {worst})"
            )

    # What refused() changes: a scene, entries of it, and the text of one that is no
    # file.
    refused_scene = ("slab", {}, None)

    def refused(self, changes, *sentences, ranks=1, scene=None):
        """The finished run of the scene with these changes, which is refused."""
        name, entries, text = self.refused_scene
        if scene is not None:
            name, text = scene, None
        process = run(name, {**entries, **changes}, ranks, text, check=False)
        self.assertRefused(process, *sentences, ranks=ranks)
        return process

    def assertRefused(self, process, *sentences, ranks=1):
        """The run of run(..., check=False) has ended with code 1 and one sentence
        that contains these texts, or what matches these patterns."""
        self.assertEqual(process.returncode, 1, process.stdout)
        self.assertNotIn("Stacktrace", process.stderr)
        if ranks == 1:
            lines = process.stderr.strip().splitlines()
            self.assertEqual(len(lines), 1, process.stderr)
        words = " ".join(process.stderr.split())
        for sentence in sentences:
            if isinstance(sentence, re.Pattern):
                self.assertRegex(words, sentence)
            else:
                self.assertIn(sentence, words)

    def check_identities(self, result, tolerance=1e-10, balance=None):
        """The discrete identities that hold at every step of every scene.

        tolerance is the scene's `Contact tolerance`, a bound on the relative
        error in the energy norm.  The resultant of the remaining residual is
        of the same relative size: at most seven times the tolerance was seen,
        in a slender body, hence 100, unless `balance` says otherwise.
        """
        stats = result.statistics
        for name, column in stats.items():
            # no limit to the step where nothing flows
            if name != "step_limit":
                self.assertTrue(np.all(np.isfinite(column)), f"{name} is not finite")

        # The first row is the initial state: nothing was solved there unless
        # the scene asked for equilibrium.
        self.assertLessEqual(
            stats["force_balance_defect"][1:].max(),
            100 * tolerance if balance is None else balance,
            "force balance",
        )
        if "friction_dissipation" not in stats:
            return

        self.assertLessEqual(
            stats["algebraic_error"].max(), tolerance, "algebraic error"
        )
        # A sum of terms that are not negative, up to rounding.
        energy = max(stats["strain_energy"].max(), stats["stored_energy"].max())
        self.assertGreaterEqual(
            stats["duality_gap"].min(), -1e-14 * energy, "duality gap"
        )
        # The multiplier is clipped to its ball: only rounding is left.
        self.assertLessEqual(stats["max_utilisation"].max(), 1 + 1e-12)
        # A sticking node does not move at all: its increment is constrained.
        self.assertLessEqual(
            stats["max_stick_slip"].max(),
            tolerance * stats["max_displacement"].max(),
            "slip at sticking nodes",
        )
        # The force is set along the slip.  Directions are compared for slips
        # above 1e-7 of the displacement, which rounding turns by 1e-9.
        self.assertLessEqual(
            stats["slip_misalignment"].max(), 1e-8, "force not along the slip"
        )
        # Rounding of the sum is the only way down.
        dissipation = stats["friction_dissipation"]
        self.assertGreaterEqual(
            np.diff(dissipation).min(), -1e-14 * dissipation.max(), "dissipation"
        )


def main():
    unittest.main(verbosity=2)
