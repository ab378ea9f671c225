# SPDX-License-Identifier: LGPL-2.1-or-later
"""Mesh files: those of prm/verification/meshes and of the demos, damaged."""

import re
from pathlib import Path

from case import NUMBERS, Case, mangle, mangle_lines, mangle_tokens
from scenes import PLANE, SOLID, as_prm

PRM = Path(__file__).resolve().parents[2] / "prm"
MESHES = sorted((PRM / "verification" / "meshes").glob("two_materials*.*"))
LARGE = PRM / "demos" / "rod_seal_2d.msh"

# From the ids of the files (1 bottom, 2 right, 3 top, 4 left, 5 and 6 in z) to
# those of the scenes.
IDS = {
    2: "if(id == 1, 2, if(id == 2, 1, if(id == 3, 3, 0)))",
    3: "if(id > 4, id - 1, if(id == 1, 2, if(id == 2, 1, if(id == 3, 3, 0))))",
}

# What mesh files are made of.
WORDS = (
    "$Nodes $EndNodes $Elements $EndElements $Entities $EndEntities $MeshFormat "
    "$PhysicalNames $Periodic $Comments CELLS CELL_TYPES CELL_DATA POINT_DATA SCALARS "
    "FIELD POINTS DATASET LOOKUP_TABLE OFFSETS CONNECTIVITY quad hex tri line pt *NODE "
    "*ELEMENT *ELSET *SURFACE *INSTANCE *ASSEMBLY *END GENERATE TYPE=C3D8 TYPE=CPS4 "
    "ELSET=1 2.2 4.1 4.0 3 0 1 2 7 8 9 12 15 -1"
).split()


def scene_of(dimension, name):
    entries = dict(PLANE if dimension == 2 else SOLID)
    del entries["Geometry/Generator"], entries["Geometry/Arguments"]
    entries["Geometry/File"] = name
    entries["Geometry/Boundary ids"] = IDS[dimension]
    if dimension == 3:
        for i, role in ((2, "symmetry"), (4, "contact"), (5, "displacement")):
            entries[f"Boundary {i}/Role"] = role
    return as_prm(entries).encode()


def numbers_in(text):
    """Where numbers stand that are not part of a name."""
    return [m.span() for m in re.finditer(r"(?<![\w.$*])-?\d+(\.\d*)?(?![\w.])", text)]


def with_number(random, text, choices):
    spans = numbers_in(text)
    if not spans:
        return text
    begin, end = random.choice(spans)
    return text[:begin] + random.choice(choices) + text[end:]


def case(random, context):
    path = LARGE if random.random() < 0.03 else random.choice(MESHES)
    text = path.read_text()
    dimension = 3 if "_3d" in path.stem else 2
    name = f"mesh{path.suffix}"
    nonsense = sense = ""
    action = random.choice(
        ("bytes", "lines", "tokens", "tokens", "number", "number", "number", "cut")
        + ("splice", "not finite", "repeated", "far", "dimension", "nothing")
    )
    if action == "bytes":
        text = mangle(random, text.encode())
    elif action == "lines":
        text = mangle_lines(random, text)
    elif action == "tokens":
        text = mangle_tokens(random, text, NUMBERS + WORDS)
    elif action == "number":
        for _ in range(random.choice((1, 1, 2, 4))):
            text = with_number(random, text, NUMBERS + ["3", "4", "5", "9", "12", "100"])
    elif action == "cut":
        i = random.randrange(len(text))
        text = text[:i]
        if i < len(text) / 2 or not text.strip():
            nonsense = f"a file that ends after {i} bytes"
    elif action == "splice":
        other = random.choice(MESHES).read_text()
        i, j = random.randrange(len(text)), random.randrange(len(other))
        text = text[:i] + other[j:]
    elif action == "not finite":
        # coordinates are what has a decimal point in these files, or is in a
        # list of nodes; a number that is not finite is wrong anywhere
        version = text.index("\n", 30)
        spans = [s for s in numbers_in(text) if s[0] > version]
        begin, end = random.choice(spans)
        text = text[:begin] + random.choice(("nan", "inf", "-inf", "1e999")) + text[end:]
        # words that the readers skip may be anything
        skipped = path.suffix in (".vtk", ".inp") or "ucd" in path.suffix
        nonsense = "" if skipped else "a number that is not finite"
    elif action == "repeated":
        # all of the file or of a part of it, many times
        n = random.choice((2, 10, 200))
        i = random.randrange(len(text))
        j = min(len(text), i + random.choice((10, 100, 1000)))
        text = random.choice((text * n, text[:j] + text[i:j] * n + text[j:]))
    elif action == "far":
        # a mesh that is there, but of a size beyond or below all measure
        factor = random.choice(("e300", "e-300", "e200", "e-200", "e160", "e-160", "e30"))
        text = re.sub(r"(?<![\w.])(\d+\.\d+)(?![\w.])", rf"\g<1>{factor}", text)
    elif action == "dimension":
        dimension = 5 - dimension
        nonsense = "a mesh of another dimension"
    else:
        sense = "a good mesh"
        if random.random() < 0.5:
            text = text.replace("\n", "\r\n")
    data = text if isinstance(text, bytes) else text.encode()
    if path == LARGE:
        nonsense = nonsense and "a damaged mesh"
        sense = ""
    arguments = ["scene.prm"] if random.random() < 0.2 else ["--check", "scene.prm"]
    return Case(
        {"scene.prm": scene_of(dimension, name), name: data},
        arguments,
        nonsense=nonsense,
        sense=sense,
        told=[f"{path.name}: {action}"],
    )
