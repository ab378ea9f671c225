# SPDX-License-Identifier: LGPL-2.1-or-later
"""How the program behaves towards its user: options, parameter files over
parameter files, what it prints where, and that it describes itself."""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from harness import EXECUTABLE, MPIRUN, PROGRAM, SOURCE, TestCase, main, scene_file

SLAB = str(scene_file("slab"))
SMALL = ["--set", "Geometry/Arguments=4, 2 : 0, 0 : 2, 1 : true"]
SHORT = SMALL + ["--set", "Time/Phases=1: 4", "--set", "Output/Fields every=0"]


class Manners(TestCase):
    def setUp(self):
        self.work = Path(tempfile.mkdtemp(prefix="manners_"))
        self.addCleanup(shutil.rmtree, self.work, ignore_errors=True)

    def call(self, *arguments, code=0, cwd=None, launcher=()):
        process = subprocess.run(
            [*launcher, PROGRAM, *map(str, arguments)],
            cwd=cwd or self.work,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
        )
        self.assertEqual(
            process.returncode, code, f"{arguments}:\n{process.stdout}{process.stderr}"
        )
        return process

    def column(self, directory, name):
        rows = [
            line.split(",")
            for line in (directory / "statistics.csv").read_text().splitlines()
        ]
        i = [title.strip() for title in rows[0]].index(name)
        return [float(row[i]) for row in rows[1:]]


class Options(Manners):
    def test_no_argument(self):
        """A guide instead of an error, but no success either: a script that
        lost its scene must not go on."""
        process = self.call(code=2)
        for part in ("--check", "--describe", "--help", "salt_pillar_2d.prm", "doc/"):
            self.assertIn(part, process.stderr)
        self.assertNotIn("rror", process.stderr)
        # what it says can be done
        demo = re.search(r"^ +viscoplastic_contact (\S+)$", process.stderr, re.M)
        self.assertTrue((self.work / demo.group(1)).exists(), demo.group(1))

    def test_scripts_take_a_program_that_is_there(self):
        """Then nothing is built; what is built, otherwise, tells how far it is."""
        setup = self.work / "setup"
        text = (SOURCE / "contrib" / "setup").read_text()
        setup.write_text(text[: text.index("\nset_up\n")].replace("-ge 60", "-ge 0"))

        def run(commands, program, code=0):
            process = subprocess.run(
                ["bash", "-c", f'source "{setup}"; python=true; {commands}'],
                env={**os.environ, "VISCOPLASTIC_CONTACT": program},
                capture_output=True,
                text=True,
            )
            self.assertEqual(process.returncode, code, process.stderr)
            return process

        process = run("configure() { exit 9; }; provide_program", str(EXECUTABLE))
        self.assertEqual(process.stdout, f"Using {EXECUTABLE}; nothing is built.\n")
        process = run("provide_program", "nowhere", code=1)
        self.assertIn("is 'nowhere', which is no program", process.stderr)
        built = "configure() { :; }; build() { :; }; provide_program"
        shown = run(f"{built}; echo $VISCOPLASTIC_CONTACT", "").stdout
        self.assertTrue(shown.endswith("build/viscoplastic_contact\n"), shown)
        compiler = "compiler() { echo '[1/2] a file'; echo more; return $1; }; "
        log = self.work / "log"
        shown = run(f'{compiler}quietly Building "{log}" compiler 0', "").stdout
        self.assertEqual(shown, "[1/2] a file\n")
        self.assertEqual(log.read_text(), "[1/2] a file\nmore\n")
        process = run(f'{compiler}quietly Building "{log}" compiler 1', "", code=1)
        self.assertIn("more\nError: Building failed", process.stderr)

    def test_help(self):
        text = self.call("--help").stdout
        for option in (
            "--set", "--check", "--describe", "--quiet", "--log", "--version", "--help"
        ):
            self.assertIn(option, text)
        self.assertLessEqual(max(map(len, text.splitlines())), 80)
        self.assertEqual(self.call("-h").stdout, text)
        self.assertEqual(list(self.work.iterdir()), [])

    def test_version(self):
        text = self.call("--version").stdout
        self.assertRegex(text, r"^viscoplastic_contact \d+\.\d+\.\d+ \(.+\), deal\.II 9")
        self.assertEqual(len(text.splitlines()), 1)

    def test_one_voice_in_parallel(self):
        text = self.call("--version", launcher=[*MPIRUN, "-n", "2"]).stdout
        self.assertEqual(len(text.splitlines()), 1)

    def test_wrong_arguments(self):
        """Code 2 and one sentence with the nearest option."""
        process = self.call("--chekc", SLAB, code=2)
        self.assertIn("did you mean --check?", process.stderr)
        self.assertEqual(len(process.stderr.splitlines()), 1)


class Description(Manners):
    def test_is_a_scene(self):
        """What --describe prints is read, checked and computed."""
        text = self.call("--describe").stdout
        self.assertLessEqual(max(map(len, text.splitlines())), 78)
        (self.work / "all.prm").write_text(text)
        self.assertIn("The scene is valid.", self.call("--check", "all.prm").stdout)
        self.call("all.prm")
        self.assertTrue((self.work / "output/all/statistics.csv").exists())

    def test_is_a_scene_in_three_dimensions(self):
        (self.work / "all.prm").write_text(self.call("--describe").stdout)
        changes = (
            "Dimension=3",
            "Geometry/Arguments=2, 2, 2 : 0, 0, 0 : 1, 1, 1 : true",
            "Boundary 4/Role=free",
            "Boundary 5/Role=free",
        )
        sets = [word for change in changes for word in ("--set", change)]
        self.assertIn("valid", self.call("--check", "all.prm", *sets).stdout)

    def test_knows_what_the_record_knows(self):
        """The entries of parameters.prm are those that are described."""
        self.call(SLAB, *SHORT)
        record = (self.work / "output/slab/parameters.prm").read_text()
        described = self.call("--describe").stdout

        def entries(text):
            lines = map(str.strip, text.splitlines())
            names = [line.split("=")[0] for line in lines if line.startswith("set ")]
            return {name.strip() for name in names}

        self.assertEqual(entries(record), entries(described))
        # each with its default in a comment before it
        blocks = re.findall(r"((?:^ *#.*\n)+)^ *set (.*?) *=", described, re.M)
        self.assertLessEqual(entries(record), {f"set {name}" for _, name in blocks})
        for comment, name in blocks:
            self.assertIn("Default:", comment, name)

    def test_of_a_scene_is_that_scene(self):
        """With the values of all numbered sections and of their laws."""
        scene = str(scene_file("layers"))
        records = []
        text = self.call("--describe", scene, "--set", "Time/Phases=1: 1").stdout
        (self.work / "described.prm").write_text(text)
        self.assertRegex(text, r"# Unit: stress\.\n.*\n +set Young's modulus")
        for name, *options in (
            (scene, "--set", "Time/Phases=1: 1"),
            ("described.prm",),
        ):
            self.call(name, *options, "--set", "Output/Directory=results")
            records.append((self.work / "results/parameters.prm").read_text())
        self.assertEqual(*records)

    def test_the_manual_is_up_to_date(self):
        written = SOURCE / "doc" / "parameters.md"
        made = subprocess.run(
            [SOURCE / "contrib" / "make_parameters"],
            env={**os.environ, "VISCOPLASTIC_CONTACT": PROGRAM},
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
        self.assertEqual(
            written.read_text(),
            made.stdout,
            "doc/parameters.md is not what the program knows; renew it by "
            "contrib/make_parameters > doc/parameters.md",
        )


class Check(Manners):
    def test_says_what_is_to_come_and_does_nothing(self):
        text = self.call("--check", SLAB).stdout
        for part in (
            "Effects:",
            "maxwell",
            "512 cells",
            "degrees of freedom",
            "Steps: 32 until t = 2",
            "Linear solver: direct",
            "Memory: about",
        ):
            self.assertIn(part, text)
        self.assertTrue(text.endswith("The scene is valid.\n"))
        self.assertEqual(list(self.work.iterdir()), [])

    def test_advice_on_ranks(self):
        """Of long runs: how many gain, and from how many on more lose."""
        for ranks, refinements, steps, words in (
            (1, 3, 200, r"Ranks: \d+ are .* 0\.\d+ of the time of 1, more than 107 "),
            (1, 0, 200, ""),
            (3, 0, 20000, "Ranks: .*more than 1 to lose again"),
        ):
            sets = f"Geometry/Global refinements={refinements}", f"Time/Phases=1: {steps}"
            text = self.call(
                "--check",
                scene_file("coulomb_pad_3d"),
                *[word for change in sets for word in ("--set", change)],
                launcher=[*MPIRUN, "-n", str(ranks)] if ranks > 1 else [],
            ).stdout
            self.assertRegex(text, words or "The scene is valid")
            self.assertEqual("Ranks: " in text, words != "")

    def test_stability_limit(self):
        """Of a linear law it is known before a state is: 2 eta/mu = 2.6."""
        known = ("Initial state/Equilibrate=true",)
        unknown = ("Material/Law=norton", "Material/norton/Stress cap=1")
        for changes, words in (
            ((), "2/r of the initial state: 2.6\n"),
            (known, "2/r before the initial state is brought into equilibrium: 2.6; "),
            (unknown, "2/r: none without stress; r grows with the stress"),
        ):
            sets = [word for change in changes for word in ("--set", change)]
            text = self.call("--check", SLAB, *SMALL, *sets).stdout
            self.assertIn("Stability limit " + words, text)
            self.assertEqual(text.count("Stability limit"), 1)

    def test_foundation_that_withdraws(self):
        """Of a shrink fit with the wrong sign."""
        for distance, is_told in ("0.001", True), ("-0.001", False):
            sets = f"Foundation displacement={distance}", "Gap=0"
            sets = [word for text in sets for word in ("--set", f"Boundary 1/{text}")]
            text = self.call("--check", scene_file("shrink_fit_2d"), *sets).stdout
            words = "'Boundary 1/Foundation displacement' is never negative"
            self.assertEqual(words in text, is_told)

    def test_loads_that_pull_the_body_off(self):
        """A weight with the wrong sign, of a body that nothing but the floor holds."""
        scene = """
            subsection Geometry
              set Arguments = 4, 4 : 0, 0 : 1, 1 : true
            end
            subsection Boundary 0
              set Role = free
            end
            subsection Boundary 1
              set Role = traction
              set Traction = 0.001; 0
            end
            subsection Boundary 2
              set Role                 = contact
              set Contact law          = unilateral
              set Friction law         = coulomb
              set Friction coefficient = 0.5
            end
            subsection Boundary 3
              set Role = free
            end"""
        (self.work / "weight.prm").write_text(scene)
        held = "Boundary 0/Role=clamped"
        for weight, more, is_told in (
            ("0.01", (), True),
            ("0.01*(t - 0.5)", (), True),
            ("-0.01", (), False),
            ("0.01", ("--set", held), False),
        ):
            force = f"Loads/Body force=0; {weight}"
            text = self.call(
                "--check", "weight.prm", "--set", "Initial state/Equilibrate=true",
                "--set", force, *more,
            ).stdout
            self.assertEqual("pull the body off its foundation" in text, is_told)

    def test_refuses_what_a_run_refuses(self):
        process = self.call(
            "--check", SLAB, "--set", "Material/Young's modulus=-1", code=1
        )
        self.assertIn("Young", process.stderr)
        self.assertEqual(list(self.work.iterdir()), [])

    def test_of_later_times(self):
        """A coefficient that becomes negative within the only step, after t = 1.57; a
        foundation that comes far into the body."""
        for name, value, code, sentence in (
            ("Friction coefficient", "0.2*sin(2*t)", 1, "0), t = 1.58; it must not be"),
            ("Gap", "-0.5*t", 0, "foundations in contact overlap by 1, 45 % of"),
        ):
            entries = {
                "Contact law": "unilateral",
                "Friction law": "coulomb",
                "Friction coefficient": 0.2,
                name: value,
            }
            sets = [f"Boundary 2/{name}={value}" for name, value in entries.items()]
            sets.append("Time/Phases=2: 1")
            options = [word for entry in sets for word in ("--set", entry)]
            process = self.call("--check", SLAB, *options, code=code)
            self.assertIn(sentence, " ".join((process.stdout + process.stderr).split()))


class Files(Manners):
    def phases(self):
        record = (self.work / "output/slab/parameters.prm").read_text()
        return re.search(r"set Phases += (.*?) *(?:#|$)", record, re.M).group(1)

    def test_later_files_and_assignments_override(self):
        (self.work / "b.prm").write_text("subsection Time\nset Phases = 1: 2\nend\n")
        (self.work / "c.prm").write_text("subsection Time\nset Phases = 1: 3\nend\n")
        self.call(SLAB, "b.prm", "c.prm", *SMALL)
        self.assertEqual(self.phases(), "1: 3")
        self.call(SLAB, "c.prm", "b.prm", *SMALL)
        self.assertEqual(self.phases(), "1: 2")
        assignments = ["--set", "Time/Phases=1: 5", "--set", "Time/Phases=1: 6"]
        self.call(*assignments, SLAB, "b.prm", *SMALL)
        self.assertEqual(self.phases(), "1: 6")
        self.assertEqual(len(self.column(self.work / "output/slab", "t")), 7)

    def test_paths_follow_their_files(self):
        """An included file is found from anywhere."""
        folder = self.work / "scenes" / "parts"
        folder.mkdir(parents=True)
        shutil.copy(SLAB, folder / "base.prm")
        (folder / "mesh.prm").write_text("include base.prm\n")
        (folder.parent / "scene.prm").write_text("include parts/mesh.prm\n")
        self.call("scenes/scene.prm", *SHORT)
        self.assertTrue((self.work / "output/scene/statistics.csv").exists())


class Voice(Manners):
    def test_lines_when_not_on_a_terminal(self):
        text = self.call(SLAB, *SHORT).stdout
        self.assertNotIn("\r", text)
        self.assertNotIn("\033", text)
        steps = re.findall(r"^Step (\d+)/4  t = \S+  k = 0\.25  cells 8  contact "
                           r"iterations \d+  slipping \d+ %(?: at \S+)?  error estimate "
                           r"\S+ %  "
                           r"elapsed \S+ s  left", text, re.M)
        self.assertEqual(steps, ["1", "2", "3", "4"])

    def test_long_runs_do_not_flood(self):
        """Some 200 lines for 1000 steps; the last step is among them."""
        arguments = (*SMALL, "--set", "Time/Phases=1: 1000",
                     "--set", "Output/Fields every=0")
        text = self.call(SLAB, *arguments).stdout
        lines = [line for line in text.splitlines() if line.startswith("Step ")]
        self.assertEqual(len(lines), 201)
        self.assertIn("1000/1000", lines[-1])
        self.assertEqual(len(self.column(self.work / "output/slab", "t")), 1001)

    def test_time_left_where_steps_are_chosen(self):
        text = self.call(
            SLAB,
            *SMALL,
            *("--set", "Output/Fields every=0"),
            *("--set", "Step control/Tolerance=1e-2"),
            *("--set", "Step control/Landing times=0.3001, 0.7, 0.7001, 1.5, 1.5001"),
        ).stdout
        lines = re.findall(r"^Step (\d+)  t = .*  left (\S+ \S+)$", text, re.M)
        n_steps = int(re.search(r"^Steps: (\d+) accepted", text, re.M).group(1))
        steps = [int(n) for n, _ in lines]
        self.assertEqual(steps, sorted(set(steps)))
        self.assertGreater(len(steps), 20)
        self.assertEqual((steps[0], steps[-1], lines[-1][1]), (1, n_steps, "0 s"))

    def test_all_steps_of_a_verbose_run(self):
        process = self.call(
            "--log", "log", "--verbose", "--set", "Time/Phases=1: 60", SLAB
        )
        for text in process.stdout, (self.work / "log").read_text():
            self.assertEqual(len(re.findall(r"^Step +\d+/60", text, re.M)), 60)

    def test_quiet(self):
        process = self.call("--quiet", SLAB, *SHORT)
        self.assertEqual(process.stdout + process.stderr, "")
        self.assertTrue((self.work / "output/slab/statistics.csv").exists())
        # but errors are told
        process = self.call("--quiet", SLAB, "--set", "Dimension=7", code=1)
        self.assertIn("Dimension", process.stderr)

    def test_log(self):
        """The log holds what is printed, also if nothing is printed."""
        process = self.call(SLAB, *SHORT, "--log", "log.txt")
        times = re.compile(
            r"\d+\.\d{3} +\d+ %|(?:elapsed|left) \S+ \S+|take \S+ times as long"
        )
        log = (self.work / "log.txt").read_text()
        self.assertEqual(times.sub("", log), times.sub("", process.stdout))
        self.call("--quiet", SLAB, *SHORT, "--log=log.txt")
        self.assertEqual(
            times.sub("", (self.work / "log.txt").read_text()), times.sub("", log)
        )
        process = self.call(SLAB, "--set", "Dimension=7", "--log=log.txt", code=1)
        self.assertIn("'Dimension' is '7'", (self.work / "log.txt").read_text())

    def test_closing_words(self):
        """They agree with the last row of the table, also where a name is longer than
        its column, and end with the place of the results."""
        top = "the glued upper side of the slab"
        text = self.call(SLAB, *SHORT, "--set", f"Boundary 3/Name={top}").stdout
        results = self.work / "output/slab"
        self.assertEqual(text.splitlines()[-1], "Results in output/slab/")

        def words(name):
            return re.search(rf"^  {name} +(?!of )(.*)$", text, re.M).group(1)

        for name, column in (
            ("external work", "external_work"),
            ("stored energy", "stored_energy"),
            ("viscous dissipation", "viscous_dissipation"),
            ("friction dissipation", "friction_dissipation"),
            ("energy balance defect", "energy_balance_defect"),
        ):
            self.assertClose(
                float(words(name)),
                self.column(results, column)[-1],
                relative=1e-4,
                absolute=1e-12,
                what=name,
            )
        for name, column in (
            ("friction force", "friction_force"), (f"reaction of {top}", "reaction_3")
        ):
            for value, axis in zip(words(name).split(";"), "xy"):
                self.assertClose(
                    float(value),
                    self.column(results, f"{column}_{axis}")[-1],
                    relative=1e-4,
                    absolute=1e-12,
                    what=name,
                )
        for name, column in (
            ("displacement", "max_displacement"),
            ("von Mises stress", "max_von_mises"),
            ("slipping area", "slip_area"),
        ):
            self.assertClose(
                float(words(name).split()[0]),
                max(self.column(results, column)),
                relative=1e-4,
                what=name,
            )
        slips = zip(self.column(results, "max_slip"), self.column(results, "k"))
        fastest = max(slip / k for slip, k in slips if k > 0)
        self.assertClose(float(words("slip rate").split()[0]), fastest, relative=1e-4)
        # The loaded side moves most.
        self.assertRegex(words("displacement"), r"at t = 1, x = \(0 0\.5\)$")
        self.assertRegex(words("von Mises stress"), r"at t = 1, x = \(\S+ \S+\)$")
        # effects add up to the run
        phases = re.findall(r"^  (\S.*?) +(\d+\.\d+) +\d+ %", text, re.M)
        seconds = {name: float(value) for name, value in phases}
        self.assertClose(
            sum(value for name, value in seconds.items() if name != "whole run"),
            seconds["whole run"],
            absolute=0.02,
        )
        for effect in ("set-up", "viscosity", "elasticity", "friction", "fields"):
            self.assertIn(effect, seconds)

    def test_remarks_are_repeated_at_the_end(self):
        """Here: a law that has passed its cap, which is also in the table."""
        process = self.call(
            SLAB,
            *SHORT,
            "--set",
            "Material/Law=norton",
            "--set",
            "Material/norton/Rate factor=0.01",
            "--set",
            "Material/norton/Stress cap=0.01",
        )
        self.assertEqual(len(re.findall("the cap of a law", process.stdout)), 2)
        self.assertRegex(process.stdout, "volume beyond the cap +[0-9.]+ at t = ")
        self.assertGreater(max(self.column(self.work / "output/slab", "capped_volume")), 0)


del Manners  # has no tests of its own

if __name__ == "__main__":
    main()
