# SPDX-License-Identifier: LGPL-2.1-or-later
"""Parameter files: values, names and syntax that nobody means."""

from case import NUMBERS, TEXTS, Case, mangle, mangle_lines, mangle_tokens
from scenes import SCENES, as_prm

# Entries with values that make no sense in any of the scenes that has them.
NONSENSE = {
    "Dimension": "0 1 4 -2 2.5 two 1e9",
    "Geometry/Generator": "hyper_doughnut ../x 1",
    "Geometry/Arguments": "4 x nan,nan:0,0:1,1:true 2,1:0,0:0,0:true -2,1:0,0:2,1:true "
    "0,0:0,0:1,1:true 1e9,1e9:0,0:1,1:true 2,1:0,0:nan,1:true 2,1:0,0:inf,1:true",
    "Geometry/Global refinements": "-1 31 1000 nan 4294967296",
    "Geometry/Flatness tolerance": "-1 nan x",
    "Material/Young's modulus": "0 -1 nan inf 1/0 x-1 t -1e-300 0/0",
    "Material/Poisson's ratio": "0.5 0.6 1 -1 -2 nan 1e308 t soft",
    "Material/Law": "burgers 1 max",
    "Material/maxwell/Viscosity": "0 -1 -0.5 nan 1/0 x-5 0/0",
    "Material/zener/Relaxation time": "0 -1 nan",
    "Material/perzyna/Hardening modulus": "-1 nan -0.001",
    "Material/perzyna/Viscosity": "0 -1 nan",
    "Material/perzyna/Yield radius": "-1 nan",
    "Material/norton/Stress cap": "0 -1 nan",
    "Material/norton/Exponent": "0 0.5 -3 nan",
    "Material/norton/Rate factor": "-1 nan",
    "Material/parsed/Strain rate": "-sigma_eq q 1/eps_eq nan sqrt(-1)",
    "Material/parsed/Factor": "-1 nan q",
    "Material/Voigt matrix": "1 x nan 0,0;0,0",
    "Material 0/Law": "burgers",
    "Material 1/Young's modulus": "-1 0 x-5 nan",
    "Boundary 0/Role": "glue",
    "Boundary 0/Traction": "1 1;2;3;4 nan;0;0 q;0 1,5;0 (;0 ;; inf;inf;inf",
    "Boundary 0/Pressure": "nan q 1;1 (",
    "Boundary 2/Friction law": "kinetic",
    "Boundary 2/Friction bound": "-1 -0.001 nan 0.5-2*t x-1 q 1/0 -1e-300 0,08 0.1;0.1",
    "Boundary 4/Friction coefficient": "-1 nan -0.001 q",
    "Boundary 4/Normal stress": "nan q 1;1",
    "Boundary 5/Displacement": "nan;0;0 1 q;q;q free;free",
    "Boundary 9/Role": "free clamped",
    "Boundary left/Role": "free",
    "Boundary -1/Role": "free",
    "Boundary 99999999999/Role": "free",
    "Time/Phases": "0 x -1:1 1:0 1:-1 nan:1 inf:1 1:1,0.5:1 1:2:3 1e999:1 1:3000000000 "
    "1:1,1:1 1:1.5",
    "Time/Scheme": "leapfrog",
    "Solver/Contact tolerance": "1 -1 nan inf 1e-30",
    "Solver/Maximal contact iterations": "-1 x nan",
    "Solver/Linear solver": "magic",
    "Mesh refinement/Strategy": "magic",
    "Mesh refinement/Refinement fraction": "-0.1 1.1 nan",
    "Mesh refinement/Minimal level": "-1 99",
    "Mesh refinement/Cell budget": "-1 x",
    "Output/Points": "nan,nan 5,5 1 1,2,3,4 x,y inf,0",
    "Output/Fields every": "-1 x",
    "Checkpoint/Keep": "-1 0 x",
    "Checkpoint/Wall time interval": "-1 nan",
    "Checkpoint/Wall time limit": "-1 nan",
    "Loads/Body force": "1 nan;0 q;q",
    "Initial state/Stress": "1 nan;0;0;0 q;0;0;0",
    "Initial state/Equilibrate": "maybe",
}

# Entries that belong to a part that only some scenes have: elsewhere a wrong
# value is either refused as well or not used at all.
OF_PARTS = ("Material/", "Material 0/", "Material 1/", "Boundary 4/", "Boundary 5/")


def texts_of(entries):
    return {"scene.prm": as_prm(entries).encode()}


def case(random, context):
    name = random.choice(sorted(SCENES))
    entries = dict(SCENES[name])
    action = random.choice(
        ("nonsense", "nonsense", "value", "value", "value", "name", "bytes", "lines")
        + ("tokens", "shape", "several", "include", "sense")
    )
    return globals()[f"{action}_case"](random, context, name, entries)


def nonsense_case(random, context, name, entries):
    """A value that is known to be wrong."""
    paths = [
        path
        for path in sorted(NONSENSE)
        if path in entries or not path.startswith(OF_PARTS)
    ]
    path = random.choice(paths)
    value = random.choice(NONSENSE[path].split())
    if path.startswith("Boundary 2/") and "Boundary 2/Friction law" not in entries:
        path = "Dimension"
        value = "4"
    entries[path] = value
    return Case(
        texts_of(entries),
        ["--check", "scene.prm"] if random.random() < 0.7 else ["scene.prm"],
        nonsense=f"'{path}' = {value} in the scene {name}",
    )


def value_case(random, context, name, entries):
    """Any value for any entry."""
    path = random.choice(context.entries + sorted(entries) * 3)
    value = random.choice(NUMBERS + list(TEXTS))
    if random.random() < 0.2:
        value = random.choice(NUMBERS) + random.choice(";:, *") + random.choice(NUMBERS)
    # What asks for much work is not wrong.
    checks = path.startswith(("Time/", "Geometry/", "Mesh refinement/"))
    entries[path] = value
    arguments = ["scene.prm"] if random.random() < 0.4 and not checks else None
    return Case(
        texts_of(entries),
        arguments or ["--check", "scene.prm"],
        told=[f"{path} = {value[:40]}"],
    )


def several_case(random, context, name, entries):
    """Entries of other scenes among those of this one."""
    other = SCENES[random.choice(sorted(SCENES))]
    for path in random.sample(sorted(other), random.randint(1, 5)):
        entries[path] = other[path]
    for path in random.sample(sorted(entries), random.randint(0, 3)):
        del entries[path]
    return Case(texts_of(entries), ["scene.prm"])


def name_case(random, context, name, entries):
    """A name that does not exist, of a section or an entry."""
    path = random.choice(sorted(entries))
    parts = path.split("/")
    i = random.randrange(len(parts))
    letter = random.randrange(len(parts[i]) + 1)
    noise = random.choice(("q", "Z", "?", "  ", "é", "\\", "'", "x" * 200, "%s"))
    parts[i] = parts[i][:letter] + noise + parts[i][letter:]
    wrong = "/".join(parts)
    entries = {wrong if key == path else key: entries[key] for key in entries}
    # blanks around a name or before a number are none of it
    blank = noise.isspace()
    return Case(
        texts_of(entries),
        ["--check", "scene.prm"],
        nonsense="" if blank or noise == "\\" else f"no entry '{wrong[:60]}'",
    )


def bytes_case(random, context, name, entries):
    files = texts_of(entries)
    files["scene.prm"] = mangle(random, files["scene.prm"])
    nonsense = "a NUL byte" if b"\0" in files["scene.prm"] else ""
    return Case(files, ["--check", "scene.prm"], nonsense=nonsense)


def lines_case(random, context, name, entries):
    text = mangle_lines(random, as_prm(entries))
    return Case({"scene.prm": text.encode()}, ["--check", "scene.prm"])


def tokens_case(random, context, name, entries):
    text = mangle_tokens(random, as_prm(entries), NUMBERS + list(TEXTS))
    return Case({"scene.prm": text.encode()}, ["--check", "scene.prm"])


def shape_case(random, context, name, entries):
    """Syntax beyond all measure."""
    text = as_prm(entries)
    n = random.choice((10, 100, 1000, 20000))
    text, nonsense = random.choice(
        (
            (text + "subsection a\n" * n, "subsections without end"),
            (text + "end\n" * n, "ends without subsection"),
            (text + "set Dimension = 2\n" * n, "an entry twice"),
            (text + "set " * n + "\n", "no `='"),
            (text + "set a" + "=" * n + "\n", "an unknown entry"),
            (text + "\\\n" * n, ""),
            (text + "#" + "x" * n * 10 + "\n", ""),
            (text.replace("2", "2" * n), ""),
            (text.replace("end", "END" + " " * n), ""),
            ("\n" * n + text, ""),
            (text + "include scene.prm\n" * n, "a file that includes itself"),
            (text + "set " + "x" * n * 10 + " = 1\n", "an unknown entry"),
        )
    )
    return Case({"scene.prm": text.encode()}, ["--check", "scene.prm"], nonsense)


def include_case(random, context, name, entries):
    text = as_prm(entries)
    files, nonsense = random.choice(
        (
            ({"scene.prm": b"include a.prm\n", "a.prm": b"include scene.prm\n"}, "loop"),
            ({"scene.prm": b"include /dev/zero\n"}, "a device"),
            ({"scene.prm": b"include .\n"}, "a directory"),
            ({"scene.prm": b"include nothing\n"}, "no such file"),
            ({"scene.prm": b"include " + b"x" * 5000 + b"\n"}, "a name too long"),
            ({"scene.prm": b"include a.prm\n", "a.prm": text.encode()}, ""),
            ({"scene.prm": b"include a.prm\n" * 1500, "a.prm": b""}, "too many files"),
        )
    )
    return Case(
        files,
        ["--check", "scene.prm"],
        nonsense=nonsense,
        sense="" if nonsense else "the scene is included",
    )


def sense_case(random, context, name, entries):
    """Other ways to write the same: these must not be refused."""
    text = as_prm(entries)
    text = random.choice(
        (
            lambda: text.replace("\n", "\r\n"),
            lambda: "\ufeff" + text,
            lambda: text.replace("set ", "SET ").replace("end\n", "END\n"),
            lambda: text.replace("=", "  =\t  "),
            lambda: text.replace("\n", "   # 2 = 3; subsection\n"),
            lambda: "\n".join("   " + line for line in text.split("\n")),
            lambda: text.replace(" = ", " = \\\n"),
            lambda: text.rstrip("\n"),
        )
    )()
    return Case(
        {"scene.prm": text.encode()},
        ["scene.prm"] if random.random() < 0.3 else ["--check", "scene.prm"],
        sense=f"the scene {name} in another way of writing",
    )
