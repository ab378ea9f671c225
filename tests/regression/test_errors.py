# SPDX-License-Identifier: LGPL-2.1-or-later
"""Bad input is refused: a non-zero exit code and one sentence on the error
stream that names what is wrong.  No stack trace, no partial result that looks
like an answer."""

import subprocess
import tempfile
from pathlib import Path

from harness import MPIRUN, PROGRAM, TestCase, main, run, run_program, scene_file
from runs import elastic_moduli, on_boundary, with_roles

SMALL = {"Geometry/Arguments": "4, 2 : 0, 0 : 2, 1 : true", "Time/Phases": "1: 4, 2: 4"}


class Refused(TestCase):
    def refused(self, *names, scene="slab", text=None, ranks=1, **overrides):
        """The run fails with one sentence that contains every name (regular
        expressions, case ignored)."""
        overrides = {**(SMALL if scene == "slab" else {}), **overrides}
        result = run(scene, overrides, text=text, ranks=ranks, check=False)
        self.check(result.returncode, result.stderr, names, ranks)
        return result

    def check(self, returncode, message, names, ranks=1):
        self.assertNotEqual(returncode, 0, "the run was accepted")
        self.assertGreater(returncode, 0, f"killed by a signal: {message}")
        for name in names:
            self.assertRegex(message, f"(?is){name}")
        for trace in "Stacktrace", "An error occurred in line", "terminate called":
            self.assertNotIn(trace, message)
        if ranks == 1:
            lines = [line for line in message.splitlines() if line.strip()]
            self.assertEqual(len(lines), 1, f"not one sentence: {message}")

    # The parameter file

    def test_missing_file(self):
        with tempfile.TemporaryDirectory() as work:
            process = subprocess.run(
                [PROGRAM, str(Path(work) / "absent.prm")],
                capture_output=True,
                text=True,
            )
        self.check(process.returncode, process.stderr, ["absent.prm"])

    def refused_text(self, text, *names, more=()):
        """A scene of this text, in which `slab` is included, is refused."""
        with tempfile.TemporaryDirectory() as work:
            scene = Path(work) / "scene.prm"
            scene.write_text(text.replace("SLAB", str(scene_file("slab"))))
            process = run_program([scene, *more], 1, Path(work))
            self.check(process.returncode, process.stderr, names)
            # nothing half written, but what a server of runs prints
            left = {file.name for file in Path(work).iterdir()} - {"stdout", "stderr"}
            self.assertEqual(left, {"scene.prm"})

    # Entries of the slab, and words of the sentence.
    ENTRIES = (
        (
            {"Output/Additional fields": "total strain, stain"},
            "'Output/Additional fields' is 'total strain, stain'; it must be names "
            "separated by commas, each one of total strain, irreversible strain, ",
        ),
        (
            {"Material/Law": "bingham"},
            "Material/Law' is 'bingham'",
            "one of elastic, maxwell",
        ),
        ({"Material/Law": "Maxwel"}, "did you mean 'maxwell'"),
        ({"Material/Poisson's ratio": "soft"}, "Poisson", "soft"),
        (
            {"Solver/Contact tolerance": 1},
            "'Solver/Contact tolerance' is '1'; it must be a number from "
            r"0 to 0\.1\.$",
        ),
        ({"Dimension": 4}, "'Dimension' is '4'; it must be a whole number from 2 to 3"),
        (
            {"Geometry/Arguments": "4, 2"},
            "subdivided_hyper_rectangle' refuses the arguments '4, 2'",
        ),
        ({"Boundary 7/Role": "clamped"}, "boundary 7"),
        ({"Boundary 3/Role": "glue"}, "Role", "glue"),
        ({"Boundary 0/Traction": "1; 2; 3"}, "Traction"),
        ({"Geometry/Generator": "hyper_doughnut"}, "hyper_doughnut"),
        ({"Output/Points": "5, 5"}, "Points", "5"),
        ({"Material/Poisson's ratio": 0.5}, "Poisson", "0.5"),
        ({"Material/Young's modulus": -1}, "Young"),
        ({"Material/Young's modulus": "x - 1"}, "Young"),
        ({"Material/maxwell/Viscosity": -0.5}, "Viscosity"),
        ({"Boundary 2/Friction bound": -0.1}, "Friction bound"),
        ({"Boundary 2/Friction bound": "0.5 - t"}, "Friction bound"),
        ({"Boundary 3/Role": "free"}, "rigid"),
        ({"Initial state/Stress": "0.1; 0; 0; 0"}, "compatib|equilibr"),
        (
            {
                "Initial state/Stress": "0; 0; 0; 0.09",
                "Boundary 0/Traction": "0; -0.09",
                **on_boundary(1, Role="traction", Traction="0; 0.09"),
            },
            "compatib|equilibr",
        ),
        ({"Time/Phases": "1: 4, 0.5: 4"}, "Phases"),
        (
            {"Boundary 2/Friction bound": "if(x=1, 0.1, 0.2)"},
            r"Friction bound' has a single '='",
        ),
        ({"Boundary 2/Friction bound": "0.1; 0.2"}, "more than one component"),
        ({"Boundary 0/Traction": ""}, "'Boundary 0/Traction' is missing"),
        ({"Output/Points": "nan, 0"}, "Points.*2 finite numbers"),
        (
            {"Geometry/Rotation angle": 30, **with_roles(free=[0], symmetry=[3])},
            r"translation along \(0\.866, 0\.5\)",
        ),
        ({"Boundary 0/Traction": "sqrt(-1 - t); 0"}, "Traction"),
        ({"Loads/Body force": "q*t; 0"}, "Body force"),
    )

    def test_entries(self):
        for entries, *words in self.ENTRIES:
            with self.subTest(entries):
                self.refused(*words, **entries)

    # Texts in which `slab' is included, and the sentence.
    TEXTS = (
        (
            "include SLAB\nsubsection Material\n  set Viscosity = 1\nend\n",
            r"line 3: .*'Viscosity' belongs to 'Material/maxwell'",
        ),
        (
            "include SLAB\n\nsubsection Lods\nend\n",
            r"scene\.prm', line 3: there is no subsection 'Lods'; "
            r"did you mean 'Loads'\?$",
        ),
        (
            "subsection Boundary 3\n  set Role = free\nend\n"
            "subsection Boundary 3\n  set Role = clamped\nend\n",
            r"'Boundary 3/Role' is set twice in '.*scene\.prm', in lines 2 and 5",
        ),
        (
            "include SLAB\nsubsection Time\n  set Phases = 1: 1\n",
            r"scene\.prm', line 2: the subsection 'Time' has no `end'\.$",
        ),
        ("set Dimension 2", "line 1: 'set Dimension 2' is no statement"),
        ("solid cube\n", "line 1: 'solid cube' is no statement"),
        ("\ninclude common.prm", r"line 2: the included file '.*common\.prm' does"),
        (
            "include SLAB\nsubsection Geometry\n  set File = part.msh\nend\n",
            r"line 3: 'Geometry/File' is 'part\.msh', but there is no such file",
        ),
        (
            "subsection Boundary left\nend\n",
            "'left' in the subsection 'Boundary left' is no id",
        ),
        (
            "include SLAB\nsubsection Material 1\n  set Law = elastic\nend\n",
            "'Material/.*' cannot be set beside 'Material 1'",
        ),
        (f"include {'x' * 5000}\n", r"x{100}\.\.\.' does not exist"),
    )

    def test_texts(self):
        for text, *words in self.TEXTS:
            with self.subTest(text):
                self.refused_text(text, *words)

    def test_unknown_entry(self):
        """File, line, and the nearest name."""
        self.refused_text(
            "include SLAB\nsubsection Material\n  set Youngs modulus = 1\nend\n",
            r"scene\.prm', line 3: 'Material' has no entry 'Youngs modulus'; "
            r"did you mean 'Young's modulus'\?$",
        )

    def test_unknown_name_in_an_expression(self):
        """File, line, and what may be used; of ids and a law, too."""
        for section, entry, value, variables in (
            ("Boundary 0", "Traction", "0.3*q; 0", "x, y and t"),
            ("Geometry", "Boundary ids", "q", "x, y and id"),
        ):
            self.refused_text(
                f"include SLAB\nsubsection {section}\n  set {entry} = {value}\nend\n",
                rf"scene\.prm', line 3: the expression '.*q' of '{section}/{entry}' "
                rf"cannot be parsed: there is no 'q'; its variables are {variables}, and pi",
            )
        self.refused_text(
            "include SLAB\n",
            r"--set 'Material/maxwell/Viscosity=eta': the expression 'eta'.* no 'eta'; ",
            more=["--set", "Material/maxwell/Viscosity=eta"],
        )

    def test_dots_between_names(self):
        self.refused_text(
            "include SLAB\n",
            r"--set 'Time\.Phases=1: 4': there is no entry 'Time\.Phases' outside of "
            r"subsections; did you mean 'Time/Phases'\?$",
            more=["--set", "Time.Phases=1: 4"],
        )
        self.refused_text(
            "include SLAB\nset Boundary 0.Traction = 0; 0\n",
            r"line 2: .*; did you mean 'Boundary 0/Traction'\?$",
        )

    def test_wrong_assignment_on_the_command_line(self):
        for argument, name in (
            ("Time/Phase=1: 2", "'Time' has no entry 'Phase'; did you mean 'Phases'"),
            ("Time/Phases", "there is no `='"),
            ("Boundary 2/Role=glue", "'Boundary 2/Role' is 'glue'"),
        ):
            self.refused_text(
                "include SLAB\n", f"--set '{argument}': .*{name}", more=["--set", argument]
            )

    def test_unknown_option(self):
        self.refused_text(
            "include SLAB\n",
            r"There is no option '--chekc'; did you mean --check\?$",
            more=["--chekc"],
        )

    def test_unwritable_log(self):
        self.refused_text(
            "include SLAB\n",
            "The log file 'nowhere/log' cannot be written",
            more=["--log", "nowhere/log"],
        )

    # Boundary roles

    def test_boundary_without_a_role(self):
        text = """
            set Dimension = 2
            subsection Geometry
              set Generator = subdivided_hyper_rectangle
              set Arguments = 2, 2 : 0, 0 : 1, 1 : true
            end
            subsection Boundary 3
              set Role = clamped
            end
            subsection Boundary 0
              set Role = free
            end
            subsection Boundary 1
              set Role = free
            end
            subsection Time
              set Phases = 1: 1
            end
        """
        self.refused("boundary", "2", "role", scene="roles", text=text)

    def test_nonsense_in_entries_that_the_role_does_not_use(self):
        for entry, value, name in (
            ("Boundary 1/Traction", "1; 2; 3", "needs 2 components"),
            ("Boundary 1/Displacement", "0", "needs 2 components"),
            ("Boundary 1/Friction bound", "-5*", "cannot be parsed"),
            ("Boundary 1/Foundation motion", "garbage(", "needs 2 components"),
            ("Boundary 2/Normal stress", "q", "cannot be parsed"),
        ):
            with self.subTest(entry=entry):
                self.refused(f"'{entry}'.*{name}", **{entry: value})

    def test_entries_that_the_role_does_not_use_are_named(self):
        """Variants of a scene keep what they do not need; the user is told."""
        leftovers = {
            **on_boundary(1, Role="free", Traction="1; 1", Friction_law="tresca"),
            "Boundary 2/Normal stress": -1,
            "Time/Phases": "0.1: 1",
        }
        result = run("slab", {**SMALL, **leftovers})
        bare = run("slab", {**SMALL, "Time/Phases": "0.1: 1",
                            "Boundary 1/Role": "free",
                            "Boundary 1/Displacement": ""})
        self.assertNotIn("is not used", bare.stdout)
        for column in "strain_energy", "max_displacement":
            self.assertClose(result[column], bare[column], what=column)
        for sentence in (
            "Warning: 'Boundary 1/Traction' is not used by the role free.",
            "Warning: 'Boundary 1/Friction law' is not used by the role free.",
            "Warning: 'Boundary 2/Normal stress' is not used by the role "
            "contact with the friction law tresca.",
        ):
            self.assertIn(sentence, result.stdout)

    def test_curved_contact_piece(self):
        self.refused(
            "flat|curved|plane",
            "0",
            **{
                "Geometry/Generator": "hyper_shell",
                "Geometry/Arguments": "0, 0 : 0.5 : 1 : 12 : true",
                **on_boundary(0, Role="contact", Friction_law="tresca"),
                "Boundary 0/Friction bound": 0.1,
                "Boundary 1/Role": "clamped",
            },
            scene="ring",
            text="set Dimension = 2\n",
        )

    # Physics

    def test_stiffness_beside_which_forces_are_rounding(self):
        scene = {
            "Geometry/Arguments": "8, 8 : 0, 0 : 1, 1 : true",
            "Geometry/Material ids": "if(y < 0.5, 1, 2)",
            "Material 1/Young's modulus": 1,
            **with_roles(free=[0, 1], clamped=[2]),
            **on_boundary(3, Role="traction", Traction="0; -0.05*t"),
            "Time/Phases": "1: 2",
        }
        softer = {**scene, "Material 2/Young's modulus": 1e8}
        result = run("tower", softer, text="")
        self.assertClose(result["reaction_2_y"][-1], 0.05, relative=1e-5)
        stiffer = {**scene, "Material 2/Young's modulus": 1e13}
        self.refused("forces miss the loads", scene="tower", text="", **stiffer)

    def test_pulled_off_its_foundation(self):
        """What could hold the body is beyond any strain: a foundation far above,
        which a force along the lower one would have to press it against."""
        sections = {
            "Geometry/Arguments": "2, 2 : 0, 0 : 1, 0.5 : true",
            **elastic_moduli(1.338, 0.499),
            "Material/Volumetric integration": "full",
            **with_roles(free=[0], traction=[1]),
            "Boundary 1/Pressure": "-0.02084*sqrt(1 + y*y)*0.5*(1 - cos(4*pi*t))",
            **on_boundary(2, Role="contact", Contact_law="unilateral"),
            **on_boundary(2, Friction_law="coulomb", Friction_coefficient=1),
            "Boundary 2/Foundation displacement": "0.002759*t",
            "Boundary 2/Foundation motion":
                "0.006722*if(x > 0.5, 0.2, 1)*(1 - exp(-5*t)); -0.09702*abs(sin(7*t))",
            **on_boundary(3, Role="contact", Contact_law="normal compliance"),
            **on_boundary(3, Compliance=9.244, Friction_law="tresca"),
            **on_boundary(3, Friction_bound="0.00109*(y < 0.3)", Gap=52.68),
            "Error control/Error bar": "false",
            "Solver/Contact tolerance": 1e-3,
            "Time/Phases": "1: 12",
        }
        self.refused("times the size of the body", scene="pulled", text="", **sections)

    def test_negative_friction_coefficient(self):
        self.refused(
            "Friction coefficient",
            scene="coulomb_block_2d",
            **{"Boundary 2/Friction coefficient": -0.4},
        )

    def test_friction_does_not_hold_a_body(self):
        """Given normal stress: nothing but friction holds the slab."""
        self.refused(
            "rigid",
            **{
                "Boundary 3/Role": "free",
                **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
                "Boundary 2/Normal stress": "-t",
            },
        )

    def test_body_free_to_rotate(self):
        """Held at x = 0 and y = 0 as planes, but here both are symmetry
        planes of one direction only."""
        self.refused(
            "rigid",
            **{
                "Boundary 3/Role": "free",
                **on_boundary(1, Role="displacement", Displacement="free; 0"),
                "Boundary 2/Role": "free",
            },
        )

    def test_the_end_of_a_thin_sheet_holds_it(self):
        """However thin it is: 1e-6 of its length is no rounding."""
        sheet = {
            "Geometry/Arguments": "4, 2 : 0, 0 : 1, 1e-6 : true",
            "Material/Poisson's ratio": 0,
            "Boundary 0/Role": "clamped",
            **on_boundary(1, Role="traction", Traction="0.01*t; 0"),
            **with_roles(free=[2, 3]),
            "Time/Phases": "1: 1",
        }
        result = run("sheet", sheet, text="")
        self.assertClose(result["max_displacement"][-1], 0.01, relative=1e-3)

    def test_incompatible_initial_load(self):
        """A load that is there at t = 0 with zero initial stress."""
        self.refused(
            r"equilibrium .* it is largest at x = \(0 0\.5\), on boundary 0;",
            **{"Boundary 0/Traction": "0.3; 0"},
        )
        # on several ranks the same, also if one of them does not see the faces
        self.refused(
            r"largest at x = \(0 0\.5\), on boundary 0;",
            ranks=3,
            **{"Boundary 0/Traction": "0.3; 0"},
        )
        self.refused("largest at .* inside of the body", **{"Loads/Body force": "1; 0"})

    def test_compatible_initial_stress_is_accepted(self):
        """The counterpart: friction may carry a shear below its bound, here
        0.05 of 0.08, balanced by tractions on the sides; this is no error."""
        result = run(
            "slab",
            {
                **SMALL,
                "Initial state/Stress": "0; 0; 0; 0.05",
                "Boundary 0/Traction": "0; -0.05",
                **on_boundary(1, Role="traction", Traction="0; 0.05"),
                "Time/Phases": "0.1: 1",
            },
        )
        self.assertClose(result["friction_force_x"][0], 0.1, absolute=1e-9)

    def test_step_beyond_the_stability_limit(self):
        """2/r = 2.6; the message names the limit."""
        self.refused("step", r"2\.6", **{"Time/Phases": "3: 1"})

    def test_step_below_the_stability_limit_is_accepted(self):
        run("slab", {**SMALL, "Time/Phases": "2.5: 1"})

    def test_decimal_comma(self):
        """muParser would take the last number."""
        self.refused(
            r"Friction bound' has a comma outside of parentheses",
            **{"Boundary 2/Friction bound": "0,08"},
        )

    def test_random_numbers(self):
        for expression in "0.1*rand()", "0.1 + 0*rand_seed(3)":
            self.refused(
                r"Friction bound' has random numbers \('rand",
                **{"Boundary 2/Friction bound": expression},
            )

    def test_comparisons_are_no_assignments(self):
        run("slab", {**SMALL, "Time/Phases": "0.1: 1",
                     "Boundary 2/Friction bound":
                         "if(x >= 1 && x != 2 || x == 0, 0.08, max(0.08, 0.08))"})

    def test_contact_without_friction_law(self):
        """Also frictionless contact has to be asked for."""
        self.refused(
            "'Boundary 2/Friction law' is missing; it must be none, tresca",
            **{"Boundary 2/Friction law": "not given"},
        )

    def test_friction_law_without_its_data(self):
        self.refused(
            "'Boundary 2/Friction bound' is missing; the friction law tresca",
            **{"Boundary 2/Friction bound": ""},
        )
        self.refused(
            "'Boundary 2/(Friction coefficient|Normal stress)' is missing",
            **{"Boundary 2/Friction law": "coulomb"},
        )

    def test_expression_that_loses_its_value(self):
        """Fine at t = 0, NaN after t = 0.5."""
        self.refused("Traction", **{"Boundary 0/Traction": "t*sqrt(0.5 - t); 0"})

    def test_long_expressions_are_not_repeated(self):
        for text in "q*" + "1 + " * 75000 + "t; 0", "q" * 300000 + "; 0", "1;" * 9999:
            result = self.refused("Body force", **{"Loads/Body force": text})
            self.assertLess(len(result.stderr), 500)

    def test_constant_without_value(self):
        """Also where nobody asks for it: what does not change does not move."""
        self.refused(
            "'Boundary 2/Foundation motion' has the value -?nan",
            **{"Boundary 2/Foundation motion": "0/0; 0"},
        )

    def test_words_of_libraries_become_sentences(self):
        for text in "1 +", "sin(", "()":
            self.refused(
                r"Body force' cannot be parsed: .*[a-z0-9\"]\.$",
                **{"Loads/Body force": f"{text}; 0"},
            )
        result = self.refused(
            r"separated by colons and of the types .* documents\.$",
            **{"Geometry/Arguments": "4 : nan"},
        )
        self.assertNotIn("Tuple", result.stderr)

    def test_long_blanks_in_a_list(self):
        """They took a stack as deep as they are long."""
        result = self.refused(
            "Boundary refinements' = .* consists of `boundary id: times'",
            **{"Geometry/Boundary refinements": "2" + 300000 * " " + ": 1"},
        )
        self.assertLess(len(result.stderr), 500)

    def test_numbers_beyond_all_measure(self):
        """Squares of what is finite need not be."""
        self.refused(
            r"largest force of the run is 2.5e\+299; it must lie between.*other units",
            **{
                "Geometry/Arguments": "2, 1 : 0, 0 : 2, 1 : true",
                "Boundary 0/Traction": "0; 1e300*t",
            },
        )

    def test_too_many_steps(self):
        """More than the type of their number holds: 5032704 after wrapping."""
        self.refused(
            "'Time/Phases' has more than 1e9 steps",
            **{"Time/Phases": "1: 2000000000, 2: 2000000000, 3: 300000000"},
        )
        self.refused(
            r"'Time/Phases' has more than 1e9 steps up to '2: 1'",
            **{"Time/Phases": "1: 1000000000, 2: 1"},
        )

    def test_exhausted_contact_iterations(self):
        """Not converged is an error, never a result."""
        self.refused(
            "iterations",
            **{
                "Geometry/Arguments": "32, 16 : 0, 0 : 2, 1 : true",
                "Time/Phases": "1: 1",
                "Solver/Maximal contact iterations": 1,
            },
        )

    # The machine

    def test_unwritable_output(self):
        """The place of the directory is taken by a file."""
        with tempfile.NamedTemporaryFile() as file:
            self.refused(
                Path(file.name).name, **{"Output/Directory": f"{file.name}/results"}
            )

    def test_ranks_that_fail_together(self):
        """They end by themselves, with one sentence: nothing of an abort."""
        for wrong in "Dimension=7", "Boundary 0/Traction=0.3; 0":
            process = subprocess.run(
                [*MPIRUN, "-q", "-n", "3", PROGRAM, str(scene_file("slab"))]
                + ["--set", wrong],
                capture_output=True,
                text=True,
            )
            self.assertEqual(process.returncode, 1)
            self.assertRegex(process.stderr, r"\Aviscoplastic_contact: [^\n]*\n\Z")

    def test_a_rank_that_fails_alone(self):
        """Others wait for it: it speaks and ends them all."""
        slab = str(scene_file("slab"))
        process = subprocess.run(
            [*MPIRUN, "-n", "1", PROGRAM, slab, ":"]
            + ["-n", "1", PROGRAM, slab, "--set", "Dimension=7"],
            capture_output=True,
            text=True,
            timeout=60,
        )
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("viscoplastic_contact: --set 'Dimension=7'", process.stderr)

    def test_every_rank_ends(self):
        """An error found by all ranks or by one ends all of them."""
        self.refused(
            "Friction bound",
            ranks=3,
            **{"Boundary 2/Friction bound": "if(x>1.5, 0.5 - t, 1)"},
        )


if __name__ == "__main__":
    main()
