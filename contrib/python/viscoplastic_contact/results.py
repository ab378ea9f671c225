# SPDX-License-Identifier: LGPL-2.1-or-later
"""What a run wrote: records of a series, statistics, parameters."""

import csv
import json
import re
import sys
import xml.etree.ElementTree as ElementTree
from functools import cached_property
from pathlib import Path

import numpy as np

from .tables import UserError, frame, without_unit


class NotAvailable(UserError):
    """What these results do not have; the text says why."""


class Record:
    """One time of a series: points, cells and point data of all its pieces, and
    below which slip rate it counts as at `rest`.

    deal.II writes each cell with vertices of its own, and a quantity constant
    on a cell as point data with that value at all of them.
    """

    def __init__(self, path, rest=0.0):
        self.rest = rest
        self.path = path
        if path.suffix == ".xml":
            self.points, self.cells, self.data = read_hdf5(path)
            return
        # Not needed by who reads numbers alone, and slow to start.
        import meshio

        points, cells, data = [], [], []
        n_points = 0
        for piece in pieces(path):
            if is_empty(piece):
                continue
            try:
                # meshio.read() would end the program where it cannot read.
                mesh = meshio.vtu.read(piece)
            except OSError:
                raise
            except Exception as error:  # whatever a damaged file provokes
                raise UserError(f"{piece} cannot be read: {error!r}") from error
            points.append(np.asarray(mesh.points, dtype=float))
            for block in mesh.cells:
                cells.append(np.asarray(block.data) + n_points)
            data.append(
                {without_unit(name): field for name, field in mesh.point_data.items()}
            )
            n_points += len(mesh.points)
        if not points:
            raise UserError(f"{path} contains no cells")
        if len({block.shape[1] for block in cells}) > 1:
            raise UserError(f"{path} mixes cells of different shapes")
        self.points = np.concatenate(points)
        self.cells = np.concatenate(cells)
        if any(piece.keys() != data[0].keys() for piece in data):
            raise UserError(f"the pieces of {path} have different fields")
        self.data = {
            name: np.concatenate([np.asarray(piece[name]) for piece in data])
            for name in data[0]
        }

    def __contains__(self, name):
        return name in self.data

    def __getitem__(self, name):
        if name not in self.data:
            raise UserError(
                f'{self.path} has no "{name}", only: ' + ", ".join(sorted(self.data))
            )
        values = self.data[name].astype(float)
        if not np.isfinite(values).all():
            raise NotAvailable(f'"{name}" in {self.path} has values that are not finite')
        return values

    @property
    def size(self):
        return np.ptp(self.points, axis=0).max()


def parse_xml(path):
    try:
        return ElementTree.parse(path).getroot()
    except (OSError, ElementTree.ParseError) as error:
        raise UserError(f"{path} cannot be read: {error}") from error


def pieces(path):
    if path.suffix != ".pvtu":
        return [path]
    sources = [piece.get("Source") for piece in parse_xml(path).iter("Piece")]
    if None in sources:
        raise UserError(f"{path} is damaged: a piece has no file")
    return [path.parent / source for source in sources]


def read_hdf5(path):
    """Points, cells and data as Record has them, of one time of solution.xdmf."""
    try:
        import h5py
    except ModuleNotFoundError as error:
        raise UserError(
            f"{path} is in HDF5, and {sys.executable} has no h5py (Debian: "
            "python3-h5py); without 'Output/Fields in HDF5' none is needed"
        ) from error

    def values(element):
        file, name = element.find("DataItem").text.split(":")
        with h5py.File(path.parent / file, "r") as data:
            return data[name][()]

    grid = parse_xml(path)
    try:
        cells, nodes = values(grid.find("Topology")), values(grid.find("Geometry"))
        data = {}
        for field in grid.iter("Attribute"):
            is_nodal, found = field.get("Center") == "Node", values(field)
            data[without_unit(field.get("Name"))] = (
                found[cells.ravel()] if is_nodal else found.repeat(cells.shape[1])
            )
    except (AttributeError, IndexError, KeyError, OSError, ValueError) as error:
        raise UserError(f"{path} cannot be read: {error!r}") from error
    points = np.zeros((cells.size, 3))
    points[:, : nodes.shape[1]] = nodes[cells.ravel()]
    return points, np.arange(cells.size).reshape(cells.shape), data


def is_empty(vtu):
    """Whether a rank had nothing to write; meshio stumbles over such files."""
    with open(vtu, "rb") as file:
        start = file.read(4096)
    return re.search(rb'<Piece [^>]*NumberOfCells="0"', start) is not None


def series(path):
    """The (time, file) pairs of a .pvd file, or of a .xdmf file."""
    root = parse_xml(path)
    try:
        found = [
            (float(item.attrib["timestep"]), path.parent / item.attrib["file"])
            for item in root.iter("DataSet")
        ]
        for item in root.iter("{http://www.w3.org/2001/XInclude}include"):
            file = path.parent / item.attrib["href"]
            found.append((float(parse_xml(file).find("Time").attrib["Value"]), file))
    except (AttributeError, KeyError, ValueError) as error:
        raise UserError(
            f"{path} is damaged: an entry lacks its time or its file"
        ) from error
    if not np.isfinite([time for time, _ in found]).all():
        raise UserError(f"{path} is damaged: it has times that are not finite")
    if not found:
        raise UserError(f"{path} lists no files")
    return found


def number(path):
    """The number in solution_00012.pvtu."""
    match = re.search(r"_(\d+)\.(p?vtu|xml)$", path.name)
    return int(match.group(1)) if match else None


def read_statistics(path):
    """The columns of statistics.csv that are numbers, by name without unit.

    The last row may be one that a run is just writing, or was when it ended.
    """
    if not path.exists():
        return {}
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file, skipinitialspace=True) if row]
    except (UnicodeDecodeError, csv.Error) as error:
        raise UserError(f"{path} cannot be read: {error}") from error
    if len(rows) > 1 and len(rows[-1]) < len(rows[0]):
        del rows[-1]
    columns = {}
    if len(rows) < 2:
        return columns
    for number, row in enumerate(rows[1:], start=1):
        if len(row) != len(rows[0]):
            raise UserError(
                f"{path} is damaged: its row {number} has {len(row)} values, where "
                f"the first line names {len(rows[0])}"
            )
    for name, *values in zip(*rows):
        try:
            columns[without_unit(name)] = np.array([float(value) for value in values])
        except ValueError:
            continue
    if not np.isfinite(columns.get("t", ())).all():
        raise UserError(f"{path} is damaged: it has times that are not finite")
    return columns


def read_parameters(path):
    """The entries of parameters.prm: {("Section", ..., "Entry"): value}."""
    entries, sections = {}, []
    if not path.exists():
        return entries
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise UserError(f"{path} cannot be read: {error}") from error
    for line in text.splitlines():
        line = line.split("#")[0].strip()
        if line.startswith("subsection "):
            sections.append(line.split(None, 1)[1].strip())
        elif line == "end":
            del sections[-1:]
        elif line.startswith("set ") and "=" in line:
            name, value = line[4:].split("=", 1)
            entries[(*sections, name.strip())] = value.strip()
    return entries


def by_numbers(text, results):
    """Columns as a scene names their places, "reaction_y of roof" and "stress_xx of
    crown", as statistics.csv does: reaction_3_y, point0_stress_xx. Forces of the only
    boundary in contact have no number there."""

    def force(match):
        numbered = f"{match[1]}_{number}_{match[2]}"
        is_contact = results.parameters.get((f"Boundary {number}", "Role")) == "contact"
        is_only = is_contact and numbered not in results.statistics
        return f"{match[1]}_{match[2]}" if is_only else numbered

    # Longer names first: they may contain others.
    for place, name in sorted(results.names.items(), key=lambda item: -len(item[1])):
        kind, number = place.rsplit(" ", 1)
        of = rf" of {re.escape(name)}(?!\w)"
        if kind == "boundary":
            forces = r"\b(reaction|friction_force|contact_force)_([xyz])"
            text = re.sub(forces + of, force, text)
        elif kind == "point":
            text = re.sub(rf"\b(?:displacement_)?(\w+){of}", rf"point{number}_\1", text)
    return text


class Results:
    """A directory of results: results["friction_force_x"] is a column of
    statistics.csv, body() and face() are fields. What nobody asks for is not
    read. Places have their numbers or what the scene calls them."""

    def __init__(self, directory):
        directory = Path(directory)
        self.directory = directory.resolve()
        self.name = self.directory.name
        if not self.directory.is_dir():
            raise UserError(f"there is no directory {directory}")
        in_hdf5 = self.parameters.get(("Output", "Fields in HDF5")) == "true"
        solution = self.directory / f"solution.{'xdmf' if in_hdf5 else 'pvd'}"
        self.statistics = read_statistics(self.directory / "statistics.csv")
        if not solution.exists() and not self.statistics:
            raise UserError(
                f"{self.directory} holds neither a solution.pvd nor a "
                "statistics.csv with rows, so it is no directory of results "
                "(nor is it a study: there is no study.csv)"
            )
        self.solution = series(solution) if solution.exists() else []
        contact = self.directory / "contact.pvd"
        self.contact = series(contact) if contact.exists() else []
        # Whether bodies touch each other.
        self.opposite = (self.directory / "opposite.pvd").exists()
        self.records = {}

    def __getitem__(self, name):
        return self.column(name)

    def __contains__(self, name):
        return by_numbers(name, self) in self.statistics

    @property
    def parameters(self):
        """{("Section", ..., "Entry"): value} of all entries, as texts."""
        return read_parameters(self.directory / "parameters.prm")

    @property
    def data(self):
        """The same with all numbers in the units of the scene, also where the
        scene has written others."""
        result = dict(self.parameters)
        for path, text in self.about().get("entries_with_units", {}).items():
            result[tuple(path.split("/"))] = text
        return result

    @property
    def info(self):
        """What run.json says: version, ranks, effects, estimated errors."""
        path = self.directory / "run.json"
        try:
            return json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            raise UserError(f"{path} cannot be read: {error}") from error

    def about(self):
        """The same, or nothing where there is no run.json."""
        return self.info if (self.directory / "run.json").exists() else {}

    @cached_property
    def units(self):
        """The units of length, time and stress that the scene declares, as
        {"length": "m", ...}; empty where it declares none."""
        return self.about().get("units") or {}

    @cached_property
    def names(self):
        """What the scene calls its places, as {"boundary 3": "roof", ...}."""
        return self.about().get("names", {})

    def vector(self, prefix):
        """The columns prefix_x, prefix_y(, prefix_z) as one array (step, axis);
        vector("point0") is the displacement of the first of `Output/Points',
        vector("reaction of roof") a force."""
        words, of, place = prefix.partition(" of ")
        names = [f"{words}_{axis}{of}{place}" for axis in "xyz"]
        found = [name for name in names if name in self]
        return np.stack([self.column(name) for name in found or names], axis=1)

    def lines(self):
        """What has been recorded along each line of `Output/Lines': the columns of
        line_0.csv and so on, by name, one time after the other."""
        # Files of an earlier run may be beside them.
        given = self.parameters.get(("Output", "Lines"), "").split(";")
        paths = [
            self.directory / f"line_{number}.csv"
            for number in range(sum(bool(line.strip()) for line in given))
        ]
        return [line for line in map(read_statistics, paths) if line]

    def line(self, number=0):
        """One of them, by its number or its name."""
        found = self.lines()
        places = {name: place for place, name in self.names.items()}
        kind, _, named = places.get(number, "").partition(" ")
        number = int(named) if kind == "line" else number
        if number not in range(len(found)):
            raise NotAvailable(
                f"{self.directory} has {len(found)} lines ('Output/Lines'), none with "
                f"the number or name {number}"
            )
        return found[number]

    def frame(self):
        """The statistics as a pandas.DataFrame."""
        return frame(self.statistics)

    @cached_property
    def rest(self):
        """The slip rate with which a point slips in all of the run by a millionth of
        what the fastest points slip in all steps together."""
        slips, times = (self.statistics.get(name, ()) for name in ("max_slip", "t"))
        if len(slips) < 2 or len(times) < 2:
            return 0.0
        return 1e-6 * np.sum(slips[1:]) / (times[-1] - times[0])

    def read(self, path):
        """A record; those read last are kept, for pictures of the same time."""
        if path not in self.records:
            while len(self.records) >= 4:
                del self.records[next(iter(self.records))]
            self.records[path] = Record(path, self.rest)
        return self.records[path]

    def index(self, step=None, time=None):
        """An output: the last, number `step`, the nearest to `time`."""
        if not self.solution:
            raise NotAvailable(f"{self.directory} has no solution.pvd: no fields")
        if step is not None:
            for i, (_, path) in enumerate(self.solution):
                if number(path) == step:
                    return i
            numbers = ", ".join(str(number(path)) for _, path in self.solution)
            raise UserError(f"there is no output number {step}; there are {numbers}")
        if time is not None:
            times = np.array([t for t, _ in self.solution])
            return int(np.argmin(np.abs(times - time)))
        return len(self.solution) - 1

    def body(self, index=-1):
        """Points, cells and fields of the body at an output, default the last."""
        self.index()
        record = self.read(self.solution[index][1])
        if record.cells.shape[1] not in (4, 8):
            raise UserError(
                f"{record.path} has cells with {record.cells.shape[1]} vertices; "
                "only quadrilaterals and hexahedra can be drawn"
            )
        return record

    def face(self, index=-1):
        """The contact boundary at the time of an output, or None."""
        time, path = self.solution[index]
        if not self.contact:
            return None
        # Several outputs may share a time in files of other programs.
        nearest = min(
            self.contact,
            key=lambda item: (abs(item[0] - time), number(item[1]) != number(path)),
        )
        if abs(nearest[0] - time) > 1e-9 * max(abs(time), abs(nearest[0])):
            return None
        return self.read(nearest[1])

    def boundary(self):
        """The faces of the boundary at the first output with their `boundary_id',
        or None in results of versions that did not write them."""
        path = self.directory / "boundary_00000.pvtu"
        return self.read(path) if path.exists() else None

    def dimension(self):
        return 2 if self.body(0).cells.shape[1] == 4 else 3

    def is_of_revolution(self):
        """Whether the plane mesh is the section of a body of revolution, whose
        forces and energies are those of the whole ring."""
        return self.parameters.get(("Geometry", "Plane model")) == "axisymmetric"

    def column(self, name):
        column = by_numbers(name, self)
        if column not in self.statistics:
            places = f"; places are {', '.join(self.names.values())}" if self.names else ""
            raise UserError(
                f'statistics.csv has no column "{name}"; it has '
                + ", ".join(self.statistics)
                + places
            )
        return self.statistics[column]
