# SPDX-License-Identifier: LGPL-2.1-or-later
"""The body over time as numbers for viewer.js: surfaces, displacements, and fields as
places in a scale of colors, which are 256."""

import base64

import matplotlib
import numpy as np

from plotting import quantities, style
from plotting.body_base import (
    available_fields,
    factor_of_contact,
    field,
    folded,
    is_cell_data,
)
from plotting.faces import friction_state
from plotting.units import Units

from .markup import formula, value
from .packed import Packed, levels
from .surface import Surface

MOST_FRAMES = 120
MOST_BYTES = 6_000_000  # before they are compressed, to a half or so
MOST_TEXT = 3_800_000  # characters of a page after that
FIRST = ("von_mises", "displacement", "creep_strain", "principal_stress", "pressure")
# Of vectors the size is shown, displacements aside, which the page has anyway.
NOT_SHOWN = ("subdomain", "displacement", "velocity_", "error_energy", "recovery")
ON_FACE = ("contact_pressure", "gap", "traction", "slip", "slip_rate", "utilisation")
ON_FACE += ("bound", "normal_traction", "friction_work")
MAPS = ("viridis", "viridis_r", "RdBu_r")


class Latest:
    """The surface of a record, made once for records in a row with the same mesh."""

    def __init__(self, make):
        self.make = make
        self.record = self.surface = None

    def __call__(self, record):
        before = self.record
        if before is None or not (
            np.array_equal(before.cells, record.cells)
            and np.array_equal(before.points, record.points)
        ):
            self.surface = self.make(record)
        self.record = record
        return self.surface


class Shown:
    """What is shown of the body or of the contact face at one time.

    points, moved  places of the vertices without, and their displacements
    values         of fields, at faces or vertices
    ends           of fields, the extreme values in all of the mesh
    lasting        for how long, beside the other times
    """

    lasting = 1.0

    def __init__(self, record, surface):
        self.surface = surface
        self.points = record.points[surface.vertices]
        self.moved = record["displacement"][surface.vertices]
        self.values, self.ends = {}, {}

    def add(self, name, values, on_faces=False):
        shown = values[self.surface.vertices]
        if on_faces:
            shown = self.surface.on_faces(values)
        self.values[name] = shown.astype(np.float32)
        self.ends[name] = float(values.min()), float(values.max())


def body_at(record, surface, names):
    shown = Shown(record, surface)
    for name in names:
        shown.add(name, field(record, name), is_cell_data(name))
    moved = record["displacement"]
    sizes = {"displacement": np.linalg.norm(moved, axis=1)}
    sizes.update((f"displacement_{axis}", u) for axis, u in zip("xyz", moved.T))
    for name, values in sizes.items():
        shown.ends[name] = float(values.min()), float(values.max())
    return shown


def face_at(record, surface):
    shown = Shown(record, surface)
    shown.states = friction_state(record)[surface.vertices]
    for name in ON_FACE:
        if name in record:
            values = record[name]
            if values.ndim == 2:
                values = np.linalg.norm(values, axis=1)
            shown.add(name, values)
    return shown


def names_of_interest(results):
    """Fields, those of most interest first, without those that are zero in the middle
    and at the end."""
    records = [results.body(i) for i in (len(results.solution) // 2, -1)]

    def order(name):
        return [not name.startswith(start) for start in FIRST]

    def is_something(name):
        there = [record for record in records if name in available_fields(record)]
        return any(np.any(field(record, name)) for record in there)

    found = [
        name
        for name in available_fields(records[-1])
        if not name.startswith(NOT_SHOWN) and is_something(name)
    ]
    return sorted(found, key=order)


def plan(first, last, n_outputs, names, dim, most):
    """Which outputs and fields fit into so many bytes, going by the surfaces of the
    first and the last output: all, or fewer of both."""
    cost = 2 * dim * len(last.vertices)
    if len(first.faces) != len(last.faces):
        cost *= 2  # the mesh changes, so that each time has places,
        cost += 2 * last.faces.size  # and faces of its own
    n_frames = min(n_outputs, MOST_FRAMES)
    n_fields = len(names)
    while n_frames * (cost + n_fields * len(last.faces)) > most:
        if n_fields > 6 or (n_fields > 3 and n_frames <= 10):
            n_fields -= 1
        elif n_frames > 3:
            n_frames -= 1
        else:
            break
    outputs = np.unique(np.linspace(0, n_outputs - 1, n_frames).round().astype(int))
    return [int(output) for output in outputs], names[:n_fields]


def fitting_body(results):
    """With as many outputs and fields as a page has room for."""
    most = MOST_BYTES
    body = Body(results, most)
    while len(body.numbers) > MOST_TEXT and most > 0.1 * MOST_BYTES:
        most /= 2
        body = Body(results, most)
    return body


class Body:
    """All that is shown.

    data     frames, fields and colors as viewer.js takes them
    numbers  its arrays, as text
    thinned  what has been left out for the size of the page, in words
    """

    def __init__(self, results, most=MOST_BYTES):
        results.index()  # or there is nothing to show
        self.results = results
        self.dim = results.dimension()
        self.units = Units.of(results)
        self.packed = Packed()
        names = names_of_interest(results)
        # Bodies that touch at first are told apart by where they go.
        end = results.body()

        def surface(record):
            same = np.array_equal(record.points, end.points)
            return Surface(record, moved=end["displacement"] if same else None)

        surface_of, surface_of_face = Latest(surface), Latest(Surface.of_face)
        last, first = surface_of(results.body()), surface_of(results.body(0))
        n_outputs = len(results.solution)
        outputs, self.names = plan(first, last, n_outputs, names, self.dim, most)
        self.frames, self.outputs = [], outputs
        for output in outputs:
            record = results.body(output)
            there = [name for name in self.names if name in available_fields(record)]
            frame = body_at(record, surface_of(record), there)
            frame.time = results.solution[output][0]
            contact = results.face(output)
            frame.face = contact and face_at(contact, surface_of_face(contact))
            self.frames.append(frame)
        self.thinned = list(self.omissions(names))
        self.data = self.describe()
        self.numbers = self.packed.text()

    def omissions(self, names):
        n_outputs = len(self.results.solution)
        if len(self.frames) < n_outputs:
            yield f"{len(self.frames)} of {n_outputs} outputs"
        if len(self.names) < len(names):
            yield f"{len(self.names)} of {len(names)} fields"
        most = max(self.frames, key=lambda frame: frame.surface.n_before).surface
        if len(most.faces) < most.n_before:
            what = "cells" if self.dim == 2 else "faces of the surface"
            yield f"{len(most.faces)} {what} in place of {most.n_before}"

    def magnification(self):
        """With which displacements show, as in pictures, and no cell folds over."""
        largest = max(
            range(len(self.frames)), key=lambda i: self.frames[i].ends["displacement"]
        )
        time = self.frames[largest].time
        record = self.results.body(self.results.index(time=time))
        size = self.frames[largest].ends["displacement"][1]
        factor = style.rounded_magnification(size, record.size)
        if self.results.opposite:
            ends = [self.results.face(self.outputs[i]) for i in (0, largest)]
            most = factor_of_contact(ends)
            factor = min(factor, max(most, 1.0))
        while factor > 1.0 and folded(record, factor).any():
            factor = max(style.next_smaller(factor), 1.0)
        return factor

    def describe(self):
        time = self.units.unit("time", [frame.time for frame in self.frames])
        parts = [*self.frames, *(frame.face for frame in self.frames if frame.face)]
        self.size = float(max(np.abs(part.moved).max() for part in parts)) or 1.0
        self.low = np.min([part.points.min(axis=0) for part in parts], axis=0)
        high = np.max([part.points.max(axis=0) for part in parts], axis=0)
        self.extent = float((high - self.low).max()) or 1.0
        times = np.array([frame.time for frame in self.frames])
        if len(times) > 1:
            for frame, lasting in zip(self.frames, np.gradient(times)):
                frame.lasting = max(lasting, 0.0)
                if frame.face:
                    frame.face.lasting = frame.lasting
        shades = {name: shade_of(name, self.frames) for name in self.names}
        on_face = self.shades_on_face()
        frames, bodies, faces = [], {}, {}
        for frame in self.frames:
            entry = self.pack(frame, bodies, shades)
            entry["t"] = frame.time
            entry["label"] = value(time, frame.time)
            entry["ends"] = frame.ends
            if frame.face:
                entry["face"] = self.pack(frame.face, faces, on_face)
                states = [list(style.STATE_COLORS).index(s) for s in frame.face.states]
                entry["face"]["states"] = self.packed.add("u1", states)
            frames.append(entry)
        first = self.frames[0]
        outline = {
            "points": self.places(first.points),
            "edges": self.packed.indices(first.surface.edges),
        }
        return {
            "dimension": self.dim,
            "frames": frames,
            "outline": outline,
            "displacement": self.size,
            "low": [float(value) for value in self.low],
            "extent": self.extent,
            "magnification": self.magnification(),
            "fields": {**self.of_displacement(), **self.legends(shades)},
            "faceFields": self.legends(on_face),
            "states": [
                {"name": style.STATE_NAMES[state], "color": color}
                for state, color in style.STATE_COLORS.items()
            ],
            "maps": {name: color_map(name) for name in MAPS},
        }

    def places(self, points):
        """From 0 to 65535 in a box around all of them, `dimension` numbers each."""
        share = (points - self.low)[:, : self.dim] / self.extent
        return self.packed.add("u2", np.rint(65535.0 * share))

    def pack(self, part, meshes, shades):
        """A frame or a face; meshes that several have are stored once."""
        key = id(part.surface)
        if key not in meshes:
            meshes[key] = {
                "points": self.places(part.points),
                "faces": self.packed.indices(part.surface.faces),
                "corners": part.surface.faces.shape[1],
            }
        # From -1 to 1 as 1 to 65535: zero is among them.
        moved = part.moved[:, : self.dim] / self.size
        return {
            **meshes[key],
            "moved": self.packed.add("u2", np.rint(32767.0 * moved) + 32768.0),
            "fields": {
                name: self.packed.add("u1", levels(values, *shades[name].ends()))
                for name, values in part.values.items()
            },
        }

    def shades_on_face(self):
        faces = [frame.face for frame in self.frames if frame.face]
        names = [n for n in ON_FACE if any(np.any(f.values.get(n, 0.0)) for f in faces)]
        for face in faces:
            face.values = {n: v for n, v in face.values.items() if n in names}
        return {name: shade_of(name, faces) for name in names}

    def of_displacement(self):
        """Its size and its components, which the page works out itself."""
        found = {}
        for number, axis in enumerate(["", *"xyz"[: self.dim]]):
            sizes = [np.linalg.norm(f.moved, axis=1) for f in self.frames]
            if axis:
                sizes = [f.moved[:, number - 1] for f in self.frames]
            name = f"displacement_{axis}" if axis else "displacement"
            values = np.concatenate(sizes)
            if np.any(values):
                shade = style.Shade(values, name)
                found[name] = {**self.legend(name, shade), "component": number - 1}
        return found

    def legends(self, shades):
        return {
            name: {**self.legend(name, shade), "onCells": is_cell_data(name)}
            for name, shade in shades.items()
        }

    def legend(self, name, shade):
        """The words, the unit and the ends of a scale of colors."""
        words, kind = quantities.field(name)
        if name == "estimator" and "quantity_total" in self.results.statistics:
            kind = None
        unit = self.units.unit(kind, shade.ends())
        low, high = (float(end) for end in shade.ends())
        return {
            "words": formula(words),
            "unit": formula(unit.text),
            "size": unit.size,
            "low": low,
            "high": high,
            "map": shade.map.name,
            "beyond": shade.extend,
        }


def shade_of(name, parts):
    """The colors of a field at all times: neither a corner nor the first minute of a
    year sets them."""
    parts = [part for part in parts if name in part.values]
    values = [part.values[name] for part in parts]
    weights = [np.full(len(v), part.lasting) for v, part in zip(values, parts)]
    values, weights = np.concatenate(values), np.concatenate(weights)
    return style.Shade(values, f'the field "{name}"', weights=weights, **style.FEW)


def color_map(name):
    """256 colors, three bytes each, as text."""
    colors = matplotlib.colormaps[name](np.arange(256), bytes=True)[:, :3]
    return base64.b64encode(colors.tobytes()).decode("ascii")
