# SPDX-License-Identifier: LGPL-2.1-or-later
"""Units of a scene: numbers with units give what the same numbers without give,
and results say in which units they are."""

import csv
import re
import sys
import tempfile
from fnmatch import fnmatch
from pathlib import Path

import numpy as np

from harness import (
    DEFECTS,
    EFFORT,
    SOURCE,
    TestCase,
    as_prm,
    main,
    run,
    run_program,
    scene_file,
)
from runs import elastic_moduli, of_law, on_boundary

sys.path.insert(0, str(SOURCE / "contrib" / "python"))

from test_contact_data import WALL
from viscoplastic_contact.results import Results

# Rock salt that creeps and slips, in meters, days and megapascals.
SALT = """
subsection Units
  set Length = m
  set Time   = day
  set Stress = MPa
end
subsection Geometry
  set Arguments    = 8, 4 : 0, 0 : 4 m, 200 cm : true
  set Boundary ids = if(id == 2 && x > 3 m, 4, id)
end
subsection Material
  set Young's modulus = 25 GPa*(1 + x/(40 m))
  set Poisson's ratio = 0.25
  set Law             = norton
  subsection norton
    set Rate factor = 3.65e-5 MPa^-3/year
    set Exponent    = 3
    set Stress cap  = 30 MPa
  end
end
subsection Loads
  set Body force = 0; -2200 kg/m^3*9.81 m/s^2
end
subsection Initial state
  set Equilibrate = true
end
subsection Boundary 0
  set Role     = traction
  set Traction = 6 MPa*min(t, 10 days)/(10 day); 0
end
subsection Boundary 1
  set Role     = traction
  set Pressure = 22 kN/m^3*(2 m - y)
end
subsection Boundary 2
  set Role           = contact
  set Friction law   = tresca
  set Friction bound = 700 kPa
end
subsection Boundary 3
  set Role = clamped
end
subsection Boundary 4
  set Role         = displacement
  set Displacement = free; -2 mm/year*t
end
subsection Time
  set Phases = 240 h: 3, 0.25 year: 5
  set Scheme = backward Euler
end
subsection Solver
  set Contact tolerance = 1e-11
end
subsection Output
  set Points            = 0, 0; 100 cm, 50 cm
  set Additional fields = creep rate, principal stresses, friction work, normal traction
end
"""

DAY, YEAR = 86400, 365.25 * 86400

# The same in the SI, without units.
PLAIN = {
    "Geometry/Arguments": "8, 4 : 0, 0 : 4, 2 : true",
    "Geometry/Boundary ids": "if(id == 2 && x > 3, 4, id)",
    **elastic_moduli("25e9*(1 + x/40)", "0.25"),
    **of_law("norton", Rate_factor=repr(3.65e-5 * 1e-18 / YEAR), Exponent=3),
    "Material/norton/Stress cap": 30e6,
    "Loads/Body force": "0; -2200*9.81",
    "Initial state/Equilibrate": "true",
    **on_boundary(0, Role="traction", Traction=f"6e6*min(t, {10 * DAY})/{10 * DAY}; 0"),
    **on_boundary(1, Role="traction", Pressure="22e3*(2 - y)"),
    **on_boundary(2, Role="contact", Friction_law="tresca", Friction_bound=700e3),
    "Boundary 3/Role": "clamped",
    **on_boundary(4, Role="displacement", Displacement=f"free; -2e-3/{YEAR}*t"),
    "Time/Phases": f"{10 * DAY}: 3, {YEAR / 4}: 5",
    "Time/Scheme": "backward Euler",
    "Solver/Contact tolerance": 1e-11,
    "Output/Points": "0, 0; 1, 0.5",
    "Output/Additional fields": "creep rate, principal stresses, friction work, "
    "normal traction",
}

# What a unit of the scene has of the SI, in plane strain.
SIZES = {
    "day": DAY,
    "m": 1.0,
    "m^2": 1.0,
    "MPa": 1e6,
    "MPa*m": 1e6,
    "MN/m": 1e6,
    "MJ/m": 1e6,
    "(MJ/m)^0.5": 1e3,
    "(MJ/m/day)^0.5": (1e6 / DAY) ** 0.5,
    "1/day": 1 / DAY,
    "m/day": 1 / DAY,
}

# The units that doc/results.md has in words, in plane strain, and in three
# dimensions in millimeters, seconds and megapascals.
UNITS_OF_WORDS = {
    "": "",
    "1": "",
    "s": "s",
    "time": "day",
    "length": "m",
    "area": "m",
    "volume": "m^2",
    "force": "MN/m",
    "energy": "MJ/m",
    "energy^½": "(MJ/m)^0.5",
    "(energy/time)^½": "(MJ/m/day)^0.5",
    "stress": "MPa",
    "stress × volume^½": "MPa*m",
}

UNITS_IN_SPACE = {
    **UNITS_OF_WORDS,
    "time": "s",
    "length": "mm",
    "area": "mm^2",
    "volume": "mm^3",
    "force": "N",
    "energy": "mJ",
    "energy^½": "(mJ)^0.5",
    "(energy/time)^½": "(mJ/s)^0.5",
    "stress × volume^½": "MPa*mm^1.5",
}


def header(result):
    """{column: unit} of the first line of statistics.csv."""
    with open(result.directory / "statistics.csv", newline="") as file:
        names = next(csv.reader(file))
    return dict(
        re.fullmatch(r"([^ ]+)(?: \[(.+)\])?", name).groups("") for name in names
    )


def documented_units():
    """{column: words} of the table in doc/results.md, components as `_x'."""
    page = (SOURCE / "doc" / "results.md").read_text()
    table = page.split("\n## statistics.csv\n")[1].split("\n## ")[0]
    units = {}
    for names, words in re.findall(r"^\| (`[^|]*) \| ([^|]*)\|", table, re.M):
        for name in re.findall(r"`([a-z][^`]*)`", names):
            units[name] = words.strip()
    return units


def documented_name(column):
    name = re.sub(r"_[xyz]$", "_x", column)
    name = re.sub(r"^(|reaction_)(point|edge)\d+", r"\1\2<i>", name)
    return re.sub(r"^(reaction|friction_force|contact_force)_\d+", r"\1_<id>", name)


class Labels(TestCase):
    def test_change_no_number(self):
        """In three dimensions on adaptive meshes and two ranks."""
        short = {"Time/Phases": "0.2: 2"}
        units = {"Units/Length": "mm", "Units/Time": "s", "Units/Force": "N"}
        bare = run("pad_adaptive", short, ranks=2)
        labeled = run("pad_adaptive", {**short, **units}, ranks=2)
        documented = documented_units()
        for column, unit in header(labeled).items():
            words = documented[documented_name(column)].removesuffix(" (`residual`)")
            self.assertEqual(unit, UNITS_IN_SPACE[words], column)
            if not column.startswith("wall_"):
                self.assertTrue(np.array_equal(labeled[column], bare[column]), column)
        self.assertIn("estimator", labeled.statistics)
        for series in ("solution", "contact"):
            mine, theirs = labeled.fields(series), bare.fields(series)
            for name, values in theirs.point_data.items():
                self.assertTrue(np.array_equal(mine.point_data[name], values), name)
            for name, values in theirs.cell_data.items():
                self.assertTrue(np.array_equal(mine.cell_data[name], values), name)
        self.assertEqual(labeled.info["units"]["stress"], "MPa")


class Same(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene = run("salt", text=SALT)
        cls.plain = run("salt", PLAIN, text="")

    def compare(self, column, values, expected, size, what):
        scale = abs(expected).max() if column not in DEFECTS else np.inf
        self.assertClose(values * size, expected, absolute=1e-7 * scale, what=what)

    def test_numbers(self):
        """The scene flows, slips and sticks, so that all of its data count."""
        units = header(self.scene)
        self.assertEqual(set(self.plain.statistics), set(units))
        for column, unit in units.items():
            if column in EFFORT or column.startswith("wall_"):
                continue
            values, expected = self.scene[column], self.plain[column]
            if column == "step_limit":
                values, expected = values[1:], expected[1:]
            self.compare(column, values, expected, SIZES[unit] if unit else 1, column)
        slip = self.scene["slip_area"]
        self.assertGreater(slip.max(), 0.5)
        self.assertLess(slip.min(), 0.5)
        work = self.scene["external_work"][-1]
        self.assertGreater(self.scene["viscous_dissipation"][-1], 0.05 * work)
        self.assertGreater(self.scene["friction_dissipation"][-1], 0.01 * work)

    def test_columns_say_their_units(self):
        documented = documented_units()
        for column, unit in header(self.scene).items():
            words = documented[documented_name(column)]
            self.assertEqual(unit, UNITS_OF_WORDS[words], column)
        self.assertEqual(set(header(self.plain).values()), {""})

    def test_fields_say_their_units(self):
        """In their names, since ParaView shows these."""
        for series, vectors in (("solution", 2), ("contact", 4)):
            (_, record) = self.scene.series(series)[-1]
            labels = dict(
                re.findall(r'Name="([a-z_0-9]+)(?: \[(.+?)\])?"', record.read_text())
            )
            text = record.read_text()
            self.assertEqual(text.count('NumberOfComponents="3"'), vectors + 1)
            mine, theirs = self.scene.fields(series), self.plain.fields(series)
            for fields, expected in (
                (mine.point_data, theirs.point_data), (mine.cell_data, theirs.cell_data)
            ):
                self.assertEqual(set(fields), set(expected))
                for name, values in fields.items():
                    size = SIZES[labels[name]] if labels[name] else 1
                    largest = abs(expected[name]).max()
                    self.assertClose(
                        values * size,
                        expected[name],
                        absolute=1e-5 * largest,
                        what=name,
                    )
            if series == "solution":
                self.assertEqual(labels["creep_rate"], "1/day")
                self.assertEqual(labels["velocity"], "m/day")
                self.assertEqual(labels["subdomain"], "")
            else:
                self.assertEqual(labels["friction_work"], "MPa*m")
                self.assertEqual(labels["stick"], "")

    def test_words_and_record(self):
        self.assertEqual(
            self.scene.info["units"], {"length": "m", "time": "day", "stress": "MPa"}
        )
        self.assertNotIn("units", self.plain.info)
        self.assertRegex(self.scene.stdout, r"(?m)^At t = 91.312 day:$")
        self.assertRegex(
            self.scene.stdout, r"Step 1/8  t = 3\.3333 day  k = 3\.33 day  "
        )
        self.assertRegex(self.scene.stdout, r"friction force +\S+; \S+ MN/m\n")
        self.assertRegex(
            self.scene.stdout,
            r"von Mises stress +\S+ MPa at t = \S+ day, x = \(.*\) m\n",
        )
        # What is small has a handy multiple, as in pictures.
        found = re.search(r"  displacement +(\S+) mm at t", self.scene.stdout)
        largest = 1e3 * self.scene["max_displacement"].max()
        self.assertClose(float(found[1]), largest, relative=1e-4)
        for unit in ("day", "MPa", "MN"):
            self.assertNotIn(unit, self.plain.stdout)
        # The record of the run is the scene, word by word, and repeats it.
        record = (self.scene.directory / "parameters.prm").read_text()
        self.assertRegex(record, r"set Phases +=\s240 h: 3, 0.25 year: 5 ")
        self.assertRegex(record, r"set Rate factor += 3.65e-5 MPa\^-3/year ")
        again = run("record", text=record)
        for column in again.statistics:
            if not column.startswith("wall_"):
                self.assertTrue(
                    np.array_equal(again[column], self.scene[column]), column
                )

    def test_read_by_python(self):
        results = Results(self.scene.directory)
        self.assertEqual(set(results.statistics), set(self.scene.statistics))
        self.assertClose(results["t"], self.scene["t"])
        self.assertClose(
            results.vector("friction_force"), self.scene.vector("friction_force")
        )
        self.assertIn("von_mises", results.body())
        self.assertIn("slip_rate", results.face())
        self.assertEqual(results.info["units"]["stress"], "MPa")

    def test_ranks(self):
        several = run("salt", text=SALT, ranks=2)
        self.assertEqual(header(several), header(self.scene))
        for column, unit in header(several).items():
            if not unit or column in EFFORT or column.startswith("wall_"):
                continue
            values, expected = several[column][1:], self.scene[column][1:]
            self.compare(column, values, expected, 1, column)


# Columns and their units in words, as powers of stress, length and time; the
# numbers of what is per thickness in plane strain are those of d = 2.
POWERS_OF_WORDS = {
    "": lambda d: (0, 0, 0),
    "1": lambda d: (0, 0, 0),
    "time": lambda d: (0, 0, 1),
    "length": lambda d: (0, 1, 0),
    "area": lambda d: (0, d - 1, 0),
    "volume": lambda d: (0, d, 0),
    "force": lambda d: (1, d - 1, 0),
    "force of a section": lambda d: (1, 2, 0),
    "energy": lambda d: (1, d, 0),
    "energy^½": lambda d: (0.5, d / 2, 0),
    "(energy/time)^½": lambda d: (0.5, d / 2, -0.5),
    "stress": lambda d: (1, 0, 0),
    "stress × volume^½": lambda d: (1, d / 2, 0),
}

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"


class Scaled:
    """A scene in other units: stress, length and time by these factors."""

    def __init__(self, stress, length, time):
        self.sizes = stress, length, time
        self.sizes_of_names = {
            **dict.fromkeys("xyz", length),
            "t": time,
            "v": length / time,
            "sigma_eq": stress,
            "p": stress,
        }

    def power(self, powers):
        return float(np.prod([size**power for size, power in zip(self.sizes, powers)]))

    def scene(self, described):
        """The file that `--describe' prints for a scene, in which each entry has
        its unit in the comment before it."""
        lines, comment = [], ""
        self.has_counts = "set Generator = subdivided" in described
        self.is_shell = "set Generator = quarter_hyper_shell" in described
        exponent = {"n": 1.0, "m": 1.0}
        # Where materials have numbers, the one without is not used.
        if re.search(r"(?m)^subsection Material \d", described):
            described = re.sub(r"(?ms)^subsection Material\n.*?^end\n", "", described)
        for line in re.sub(r"\\\n *", "", described).splitlines():
            word = line.strip()
            if word.startswith("#"):
                comment += " " + word[1:].strip()
                continue
            entry = re.fullmatch(r"set (.*?) =\s*(.*)", word)
            if entry:
                unit = re.search(r".*Unit: ([^.]*)\.", comment)
                lines.append((entry[1], entry[2], unit[1] if unit else ""))
            else:
                lines.append((word, None, None))
            comment = ""
        text = []
        for i, (name, value, unit) in enumerate(lines):
            if value is None:
                text.append(name)
                continue
            # The exponents stand beside what they are those of.
            for other in ("Exponent", "Compliance exponent"):
                near = [row[1] for row in lines[i : i + 3] if row[0] == other]
                if near:
                    exponent["n"] = exponent["m"] = float(near[0])
            text.append(f"set {name} = {self.value(name, value, unit, exponent)}")
        return "\n".join(text) + "\n"

    def value(self, name, value, unit, exponent):
        powers = {
            "": (0, 0, 0),
            "1": (0, 0, 0),
            "seconds": (0, 0, 0),
            "length": (0, 1, 0),
            "time": (0, 0, 1),
            "1/time": (0, 0, -1),
            "stress": (1, 0, 0),
            "1/stress": (-1, 0, 0),
            "force": (1, 2, 0),  # of a whole section
            "stress times time": (1, 0, 1),
            "force per volume": (1, -1, 0),
            "stress/length": (1, -1, 0),
            "1/(stress^n time)": (-exponent["n"], 0, -1),
            "stress/length^m": (1, -exponent["m"], 0),
            "temperature": (0, 0, 0),
            "1/temperature": (0, 0, 0),
            "energy/mol": (1, 3, 0),
            "energy/(mol temperature)": (1, 3, 0),
        }[unit]
        if not value or not unit:
            return value
        factor = self.power(powers)

        def number(text):
            return repr(float(text) * factor)

        if name == "Phases":
            return re.sub(rf"({NUMBER})( *:)", lambda m: number(m[1]) + m[2], value)
        if name == "Arguments":
            # Numbers of cells come first, of each body, or after the radii.
            bodies = []
            for body in value.split("|"):
                parts = body.split(":")
                counts = 0 if self.has_counts else 3 if self.is_shell else None
                bodies.append(
                    ":".join(
                        part
                        if i == counts
                        else re.sub(NUMBER, lambda m: number(m[0]), part)
                        for i, part in enumerate(parts)
                    )
                )
            return "|".join(bodies)
        if name in ("Points", "Lines", "Translation", "Landing times", "Voigt matrix"):
            return re.sub(NUMBER, lambda m: number(m[0]), value)
        return "; ".join(self.expression(part, factor) for part in value.split(";"))

    def expression(self, text, factor):
        text = text.strip()
        if not text or text == "free":
            return text
        if re.fullmatch(NUMBER, text):
            return repr(float(text) * factor)
        names = "|".join(self.sizes_of_names)
        text = re.sub(
            rf"\b({names})\b",
            lambda match: f"({match[0]}/{self.sizes_of_names[match[0]]!r})",
            text,
        )
        return text if factor == 1 else f"{factor!r}*({text})"


# Scenes with all laws of materials, contact and friction, shortened. The
# iterations go on to rounding: what is left of them is not in proportion.
EXACT = {"Solver/Contact tolerance": 1e-12, "Output/Fields every": 0}
ADAPTIVE = {"Mesh refinement/Every n steps": 2}
SHORT = (
    ("slab_adaptive", {"Time/Phases": "0.5: 4", **ADAPTIVE}),
    ("pad_adaptive", {"Time/Phases": "0.2: 2", "Mesh refinement/Every n steps": 1}),
    ("conveyor_2d", {"Time/Phases": "0.5: 3", "Material/Law": "zener"}),
    ("conveyor_3d", {"Time/Phases": "0.5: 2"}),
    ("partial_slip_2d", {"Time/Phases": "1: 1, 1.5: 2", "Geometry/Global refinements": 2}),
    ("soft_ground_3d", {"Time/Phases": "0.5: 2"}),
    ("perzyna_compression_2d", {"Time/Phases": "0.5: 4"}),
    (
        "perzyna_compression_2d",
        {
            **of_law("norton", Rate_factor=3, Exponent=2.5, Stress_cap=10),
            "Step control/Tolerance": 0.03,
            "Time/Scheme": "Heun",
        },
    ),
    (
        "perzyna_compression_2d",
        {
            **of_law("parsed", Strain_rate="sinh(sigma_eq)*exp(-p)/(1 + eps_eq)"),
            "Time/Scheme": "backward Euler",
            "Time/Phases": "0.5: 4",
        },
    ),
    (
        "slab_adaptive",
        {
            "Error control/Tolerance": 0.2,
            "Time/Phases": "0.5: 4",
            "Output/Points": "0, 0",
        },
    ),
    (
        "coulomb_block_3d",
        {
            "Solver/Linear solver": "multigrid",
            "Boundary 4/Slip rate factor": "1/(1 + v)",
        },
    ),
    ("springs_block_2d", {"Boundary 2/Tangential stiffness": "0.1 + 0.2*x"}),
    ("supports_block_3d", {}),
    ("rubbing_2d", {}),
    ("junction_2d", {}),
    ("excavated_column", {}),
    (
        "hot_pipe",
        {
            # that of the units which are changed here
            "Temperature/Gas constant": 8314.462618,
            "Time/Phases": "1: 2, 100: 2",
            "Output/Point fields": "",
        },
    ),
    ("crowned_floor_2d", {"Output/Point fields": ""}),
    ("corner_coulomb_90_2d", {}),
    ("corner_tresca_150_2d", {}),
    ("conveyor_3d", WALL),
    (
        "conveyor_3d",
        {
            **WALL,
            "Solver/Coulomb pressure": "fixed point",
            **on_boundary(1, Friction_law="coulomb", Contact_law="normal compliance"),
            **on_boundary(1, Friction_bound="", Friction_coefficient=0.2, Compliance=3),
            "Boundary 1/Gap": -0.005,
        },
    ),
)

# Of the other scenes of prm/verification, those whose text does not scale number by
# number, or whose rounding does not scale.
LEFT_OUT = {
    "manufactured/*": "exact solutions are formulas with units of their own",
    "hard/drawn_ring_2d": "a number of cells behind the lengths",
    "hard/drawn_slab_3d": "as drawn, with a column that is never finite",
    "hard/drawn_strip_2d": "two steps are longer than the stability limit",
    "hard/incompressible": "exact solution",
    "hard/large_*": "slab and pad, in more cells",
    "hard/slivers": "exact solution",
    "tilted_plane_2d": "exact solution",
    "hard/anisotropic": "--describe gives the Voigt matrix and the moduli",
    "hard/norton_cylinder": "a number of cells behind the lengths",
    "literature/thick_cylinder_creep": "numbers of points in Lines",
    "literature/slip_zone": "numbers of points in Lines",
    "literature/salt_cavity": "a velocity of a point, whose words have an index",
    "layers": "several samples have the largest rate",
    "passenger_2d": "a rigid motion, whose variation is rounding",
}


class OtherUnits(TestCase):
    """Stresses, lengths and times in units without a meaning: the same answer."""

    def compare(self, known, result, dimension, scaled):
        self.assertEqual(len(known["t"]), len(result["t"]))
        documented = documented_units()
        columns = {}
        for column in known.statistics:
            if column not in EFFORT | DEFECTS and not column.startswith("wall_"):
                words = documented[documented_name(column)].removesuffix(
                    " (`residual`)"
                )
                columns.setdefault(POWERS_OF_WORDS[words](dimension), []).append(column)
        # What is zero has no size but that of others.
        sizes = [
            known[name].max() for name in ("max_von_mises", "max_displacement", "t")
        ]
        for powers, names in columns.items():
            finite = {name: np.isfinite(known[name]) for name in names}
            scale = max(abs(known[name][finite[name]]).max() for name in names)
            scale = max(scale, np.prod(np.power(sizes, powers)))
            for name in names:
                here = finite[name]
                # The time error is kept in single precision.
                of_time = name.split("_")[-1] in ("time", "total")
                self.assertClose(
                    result[name][here] / scaled.power(powers),
                    known[name][here],
                    absolute=(1e-8 if of_time else 1e-9) * scale,
                    what=name,
                )

    def check(self, scene, more, **sizes):
        scaled = Scaled(**sizes)
        with tempfile.TemporaryDirectory() as work:
            (Path(work) / "more.prm").write_text(as_prm({**EXACT, **more}))
            files = scene_file(scene), "more.prm"
            process = run_program(("--describe", *files), 1, Path(work))
        self.assertEqual(process.returncode, 0, process.stderr)
        described = re.sub(r" +# default: .*", "", process.stdout)
        described = re.sub(r"(?m)^( *set .*?) +=", r"\1 =", described)
        dimension = int(re.search(r"set Dimension = (\d)", described)[1])
        if re.search(r"set Plane model = axisymmetric", described):
            dimension = 3  # forces and energies of whole bodies
        known = run("known", text=described)
        result = run("scaled", text=scaled.scene(described))
        self.compare(known, result, dimension, scaled)
        return known, result

    def test_scenes(self):
        for scene, more in SHORT:
            with self.subTest(scene, more=more):
                self.check(scene, more, stress=1.7e6, length=3.1e-3, time=7.3e4)

    def test_all_other_scenes(self):
        """Two steps of each."""
        folder = SOURCE / "prm" / "verification"
        done = {scene for scene, _ in SHORT}
        n_scenes = 0
        for path in sorted(folder.rglob("*.prm")):
            scene = str(path.relative_to(folder).with_suffix(""))
            if scene in done or any(fnmatch(scene, name) for name in LEFT_OUT):
                continue
            text = path.read_text()
            end, n_steps = re.search(r"set Phases *= ([^:]*): *(\d+)", text).groups()
            n = min(int(n_steps), 2)
            more = {"Time/Phases": f"{float(end) * n / int(n_steps)!r}: {n}"}
            levels = re.search(r"set Global refinements *= *(\d+)", text)
            if levels and int(levels[1]) > 0:
                more["Geometry/Global refinements"] = 0
            with self.subTest(scene):
                self.check(scene, more, stress=1.7e6, length=3.1e-3, time=7.3e4)
            n_scenes += 1
        self.assertGreater(n_scenes, 45)


class Work(TestCase):
    """The program in a directory of its own."""

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.work = Path(directory.name)
        (self.work / "salt.prm").write_text(SALT)

    def program(self, *arguments, code=0):
        process = run_program(arguments, 1, self.work)
        self.assertEqual(process.returncode, code, process.stderr)
        return process

    def test_restart(self):
        """Into the same table; not with other units."""
        table = self.work / "output" / "salt" / "statistics.csv"
        every = ["--set", "Checkpoint/Every n steps=1"]
        self.program("salt.prm", *every)
        whole = table.read_text().splitlines()
        self.program("salt.prm", *every, "--set", "Time/Phases=240 h: 3")
        self.program("--restart", "salt.prm", *every)
        rows = table.read_text().splitlines()
        self.assertEqual(rows[0], whole[0])
        self.assertEqual(len(rows), len(whole))
        kept = [i for i, name in enumerate(whole[0].split(",")) if "wall" not in name]
        for row, expected in zip(rows, whole):
            row, expected = row.split(","), expected.split(",")
            self.assertEqual([row[i] for i in kept], [expected[i] for i in kept])
        refused = self.program(
            "--restart", "salt.prm", *every, "--set", "Units/Stress=kPa", code=1
        )
        self.assertIn("'Units/Stress' is kPa (was MPa)", refused.stderr)

    def test_check(self):
        """Materials with a time, and doubts about powers of ten."""
        said = self.program("--check", "salt.prm").stdout
        # 1/(E A sigma^2) but for Poisson's ratio and the deviator: 6 MPa or,
        # since nothing moves as far, what moves first.
        line = re.search(
            r"Material: E = 25156 to 27344 MPa, nu = 0.25, norton with Rate "
            r"factor = 3.65e-5 MPa\^-3/year, Exponent = 3, Stress cap = 30 MPa; at (\S+) "
            r"MPa, (.*), it relaxes stress within \|sigma\|/\|G\| = (\S+) to (\S+) day",
            said,
        )
        self.assertEqual(line.group(2), "the traction of boundary 0")
        stress, shortest, longest = (float(line.group(i)) for i in (1, 3, 4))
        self.assertEqual(stress, 6)
        for modulus, time in (
            (25e3 * (1 + 0.25 / 40), longest), (25e3 * (1 + 3.75 / 40), shortest)
        ):
            # |G| = 3 mu A sigma^3 (2/3)^(1/2)
            flow = 3 * modulus / 2.5 * (3.65e-5 / 365.25) * 6**3 * (2 / 3) ** 0.5
            self.assertClose(time, 6 / flow, 1e-3)
        self.assertIn("until t = 91.3125 day", said)
        # the floor and the wall that goes down, where they meet
        self.assertEqual(re.findall("Warning: (.{18})", said), ["what is prescribed"])
        for entries, words in (
            (["Material/Young's modulus=25 GPa*1e6"], "(2.5e+16 Pa in the SI); known"),
            (["Material/Young's modulus=25"], "a strain of about 24 % with"),
            (["Material/Young's modulus=2.5e-4"], "(250 Pa in the SI)"),
            (
                ["Material/norton/Rate factor=3.65e10 MPa^-3/year"],
                "times shorter than the run; look at the units of its parameters.",
            ),
        ):
            text = self.program(
                "--check",
                "salt.prm",
                *(word for entry in entries for word in ("--set", entry)),
            ).stdout
            self.assertIn(words, text)
            self.assertIn("The scene is valid, with the remarks above.", text)

    def test_default_material(self):
        """Means nothing in units; without, it is doubted where there are loads."""
        for given, missing in (
            (re.sub(r"set Young.*", "", SALT), "Material/Young's modulus"),
            (re.sub(r"set Rate factor.*", "", SALT), "Material/norton/Rate factor"),
        ):
            (self.work / "salt.prm").write_text(given)
            self.assertIn(
                f"'{missing}' is not given; its default, 1, means nothing in the units",
                self.program("--check", "salt.prm", code=1).stderr,
            )
        (self.work / "salt.prm").write_text(
            "subsection Boundary 0\n set Role = traction\n set Traction = -6*t; 0\nend\n"
            "subsection Boundary 1\n set Role = clamped\nend\n"
            "subsection Boundary 2\n set Role = free\nend\n"
            "subsection Boundary 3\n set Role = free\nend\n"
        )
        self.assertIn(
            "Warning: 'Material/Young's modulus' is not given, so that it is 1, its "
            "default, beside 6, the traction of boundary 0.",
            self.program("--check", "salt.prm").stdout,
        )
        at_rest = "".join(
            f"subsection Boundary {i}\n set Role = {'clamped' if i < 1 else 'free'}\nend\n"
            for i in range(4)
        )
        (self.work / "rest.prm").write_text(at_rest)
        self.assertNotIn("Warning", self.program("--check", "rest.prm").stdout)

    def test_refusals(self):
        """With file and line, or the words of the command line."""
        said = self.program(
            "salt.prm", "--set", "Boundary 2/Friction bound=700 kpa", code=1
        ).stderr
        self.assertIn("there is no unit 'kpa'; did you mean 'kPa'?", said)
        # Errors that come later quote what was written, too.
        said = self.program(
            "salt.prm", "--set", "Boundary 2/Friction bound=7 kg/(m s^2)*q", code=1
        ).stderr
        self.assertIn(
            "expression '7 kg/(m s^2)*q' of 'Boundary 2/Friction bound'", said
        )
        # The unit would be that of the exponent.
        for value in "10^8 Pa", "2*10^8 Pa", "pow(10, 8 Pa)":
            said = self.program(
                "salt.prm", "--set", f"Boundary 2/Friction bound={value}", code=1
            ).stderr
            self.assertIn("an exponent is a stress", said)
        text = SALT.replace("22 kN/m^3*(2 m - y)", "22 kN/m^2*(2 m - y)")
        line = text[: text.index("kN/m^2")].count("\n") + 1
        (self.work / "salt.prm").write_text(text)
        self.assertIn(
            f"'salt.prm', line {line}: 'Boundary 1/Pressure' is '22 kN/m^2*(2 m - y)'; "
            "'22 kN/m^2*(2 m - y)' is a force per length, but it must be a stress.",
            self.program("salt.prm", code=1).stderr,
        )
        (self.work / "salt.prm").write_text(SALT.replace("  set Time   = day\n", ""))
        self.assertIn(
            "'Units' has no Time; give `Length', `Time' and `Stress'",
            self.program("salt.prm", code=1).stderr,
        )


if __name__ == "__main__":
    main()
