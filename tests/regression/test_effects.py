# SPDX-License-Identifier: LGPL-2.1-or-later
"""Studies of effects: what each simplification changes and costs, and whether
the verdict is the right one."""

import contextlib
import csv
import dataclasses
import io
import json
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest.mock
from pathlib import Path

import numpy as np

from harness import (
    PROGRAM,
    SOURCE,
    TestCase,
    as_prm,
    main,
    run_study,
    scene_file,
    study_command,
    study_environment,
)
from runs import Folder
from test_study import VERIFICATION

sys.path.insert(0, str(SOURCE / "contrib"))

from plotting import effects as picture
from plotting.command import main as plot
from plotting.results import read_statistics
from viscoplastic_contact import Program
from viscoplastic_contact.scene import set_options
from viscoplastic_contact.study import effects
from viscoplastic_contact.study.effects_report import percent
from viscoplastic_contact.study.scene import Scene
from viscoplastic_contact.study.variants import (
    DISCRETIZATION,
    OBSERVATION,
    PROBLEM,
    effect_variants,
)
from viscoplastic_contact.study.words import Console

SLAB = {
    "Geometry__Arguments": "16, 8 : 0, 0 : 2, 1 : true",
    "Time__Phases": "1: 8, 2: 8",
    "Study__Budget": 1e5,
}
# Enough for verdicts that are far from their limits.
FEW_CELLS = {
    **SLAB,
    "Geometry__Arguments": "8, 4 : 0, 0 : 2, 1 : true",
    "Time__Phases": "1: 4, 2: 4",
}


class Case(Folder):
    """Its effects, by what is left out and what is instead."""

    def __init__(self, scene, **overrides):
        super().__init__(scene, **overrides)
        self.effects = self.results / "effects"

    def about(self):
        return json.loads((self.effects / "effects.json").read_text())

    def verdicts(self):
        return {
            (effect["effect"], effect["instead"]): effect["verdict"]
            for effect in self.about()["effects"]
        }

    def finished(self):
        return {
            file: file.stat().st_mtime_ns
            for file in self.effects.glob("*/study/*/result.json")
        }


SQUARE = """
set Dimension = 2
subsection Boundary 0
set Role = traction
set Traction = 0.3*t; 0
end
subsection Boundary 1
set Role = traction
set Traction = 0; 0
end
subsection Boundary 2
set Name = foot
set Role = contact
set Friction law = tresca
set Friction bound = 0.08 + 0*x
end
subsection Boundary 3
set Role = displacement
set Displacement = free; -t
end
"""


class Variants(TestCase):
    """What can be left out of a scene, as "effect: instead (overrides)"."""

    @classmethod
    def setUpClass(cls):
        environment = study_environment()
        cls.program = Program(
            environment["VISCOPLASTIC_CONTACT"], environment=environment
        )

    def of(self, text, kind=PROBLEM, force=""):
        with tempfile.TemporaryDirectory() as work:
            file = Path(work) / "scene.prm"
            file.write_text(text)
            scene = Scene(self.program, [file], [], means=True)
            found = [
                variant
                for variant in effect_variants(scene, 2.0, force)
                if variant.kind == kind
            ]
            # They make a scene; later entries override earlier ones.
            entries = [entry for variant in found for entry in variant.overrides]
            self.program.call("--describe", *set_options(entries), file)
            return found

    def words(self, text, kind=PROBLEM):
        """With long numbers rounded, as means are."""
        lines = (
            f"{variant.effect}: {variant.instead} ({','.join(variant.overrides)})"
            for variant in self.of(text, kind)
        )
        return [
            re.sub(r"\d+\.\d{9,}", lambda m: f"{float(m.group()):.9g}", line)
            for line in lines
        ]

    def test_of_an_elastic_scene(self):
        self.assertEqual(
            self.words(SQUARE),
            [
                "traction on Boundary 0: none (Boundary 0/Traction=0; 0)",
                "traction on Boundary 0 over time: its mean (Boundary 0/Traction=0.15; 0,"
                "Initial state/Equilibrate=true)",
                "friction on foot: none (Boundary 2/Friction bound=0)",
                "slip on foot: never (Boundary 2/Friction bound=1e6*(0.08 + 0*x))",
                "friction bound on foot over space: its mean (Boundary 2/Friction "
                "bound=0.08)",
                "displacement on Boundary 3: none (Boundary 3/Displacement=free; 0)",
                "displacement on Boundary 3 over time: its mean (Boundary 3/Displacement="
                "free; -0.5,Initial state/Equilibrate=true)",
            ],
        )
        self.assertEqual(
            self.words(SQUARE, DISCRETIZATION),
            [
                "volumetric integration (automatic): full (Material/Volumetric "
                "integration=full)"
            ],
        )
        self.assertEqual(
            self.words(SQUARE, OBSERVATION),
            [
                "error bar: none, and a fixed tolerance (Error control/Error bar=false)",
                "fields and checkpoints: none ()",
            ],
        )

    def test_pressure_that_is_given_instead(self):
        contact = (
            "set Role = contact\nset Contact law = unilateral\n"
            "set Friction law = coulomb\nset Friction coefficient = 0.3\nend\n"
        )
        half = (
            "set Dimension = 2\nsubsection Geometry\n"
            "set Arguments = 4, 2 : 0, 0 : 2, 1 : true\nend\n"
            "subsection Boundary 0\nset Role = clamped\nend\n"
            "subsection Boundary 1\nset Role = free\nend\n"
            f"subsection Boundary 2\n{contact}"
            "subsection Boundary 3\n"
        )
        free = "set Role = free\nend\n"

        def given(text, force):
            found = [
                v.overrides
                for v in self.of(text, force=force)
                if v.effect.startswith("computed pressure")
            ]
            return found[0] if found else []

        found = given(half + free, "3*t")
        self.assertEqual(found[0], "Boundary 2/Contact law=given normal stress")
        force, area = found[1].split("/Normal stress=")[1].split(")/")
        self.assertEqual(force, "-(3*t")
        self.assertClose(float(area), 2.0, 1e-12)
        self.assertEqual(
            found[2:], ["Boundary 2/Gap=", "Boundary 2/Foundation displacement=0"]
        )
        # Bounds 10^6 times the step's own pressure may have no solution.
        never = next(v for v in self.of(half + free) if v.instead == "never")
        self.assertEqual(
            never.overrides,
            [
                "Boundary 2/Friction coefficient=1e6*(0.3)",
                "Solver/Coulomb pressure=lagged",
            ],
        )
        # The force is not known, or belongs to two pieces.
        self.assertEqual(given(half + free, ""), [])
        self.assertEqual(given(half + contact, "3*t"), [])

    def test_of_the_discretization(self):
        text = SQUARE + (
            "subsection Material\nset Law = maxwell\n"
            "set Volumetric integration = full\nend\n"
            "subsection Mesh refinement\nset Strategy = kelly\nend\n"
            "subsection Step control\nset Tolerance = 0.1\nend\n"
        )
        self.assertEqual(
            self.words(text, DISCRETIZATION),
            [
                "volumetric integration (full): mean dilatation (Material/Volumetric "
                "integration=mean dilatation)",
                "stress history (quadrature points): cell means (Material/Stress "
                "history=cell means)",
                "time scheme (forward Euler): backward Euler (Time/Scheme="
                "backward Euler)",
                "time scheme (forward Euler): Heun (Time/Scheme=Heun)",
                "step control: the steps of the phases (Step control/Tolerance=0)",
                "adaptive mesh: the first mesh (Mesh refinement/Strategy=none)",
            ],
        )

    def test_of_laws(self):
        def first(law):
            return self.words(f"{SQUARE}subsection Material\n{law}end\n")[:-7]

        elastic = "viscous flow: elastic (Material/Law=elastic)"
        self.assertEqual(first("set Law = maxwell\n"), [elastic])
        self.assertEqual(
            first(
                "set Law = perzyna\nsubsection perzyna\nset Hardening modulus = 2\nend\n"
            ),
            [elastic, "hardening: none (Material/perzyna/Hardening modulus=0)"],
        )
        # 3 s^2 at s = 2 is 6 times that, linear
        self.assertEqual(
            first(
                "set Law = norton\nsubsection norton\nset Rate factor = 3\n"
                "set Exponent = 2\nset Stress cap = 9\nend\n"
            ),
            [
                elastic,
                "power of the flow law: 1, same rate at the mean stress (Material/norton/"
                "Exponent=1,Material/norton/Rate factor=2*(3))",
            ],
        )
        self.assertEqual(
            first(
                "set Law = zener\nsubsection zener\n"
                "set Long-term Young's modulus = 0.25\nend\n"
            ),
            [
                "relaxation: elastic at once (Material/Law=elastic)",
                "relaxation: elastic with the long-term moduli (Material/Law=elastic,"
                "Material/Voigt matrix=,Material/Young's modulus=0.25,Material/Poisson's "
                "ratio=0.3)",
            ],
        )
        # Expressions: no power that could be matched, but means.
        self.assertEqual(
            first(
                "set Young's modulus = 1 + 2*x\nset Law = norton\nsubsection norton\n"
                "set Exponent = 2 + 2*t\nset Stress cap = 9\nend\n"
            ),
            [
                elastic,
                "Young's modulus over space: its mean (Material/Young's modulus=2)",
                "exponent over time: its mean (Material/norton/Exponent=3)",
            ],
        )

    def test_of_several_materials(self):
        found = self.words(
            SQUARE.replace(
                "subsection Boundary 0",
                "subsection Geometry\nset Material ids = if(x < 0.5, 0, 7)\nend\n"
                "subsection Boundary 0",
            )
            + "subsection Material 0\nend\nsubsection Material 7\n"
            "set Young's modulus = 5\nset Law = maxwell\nend\n"
        )
        self.assertEqual(len(found), 9)
        self.assertEqual(
            found[:2],
            [
                "viscous flow of Material 7: elastic (Material 7/Law=elastic)",
                "different materials: Material 0 everywhere (Material 7/Law=elastic,"
                "Material 7/Young's modulus=1)",
            ],
        )

    def test_of_two_bodies(self):
        """Either of them rigid; the pressure between them cannot be given."""
        found = {
            (variant.effect, variant.instead): variant.overrides
            for variant in self.of(
                scene_file("salt_pillar_rock_2d").read_text(), force="1e6*t"
            )
        }
        overrides = found["deformation of sandstone", "rigid"]
        self.assertIn("Material 1/Young's modulus=1e4*(15e9)", overrides)
        self.assertIn(
            "Material 0/Law=elastic", found["deformation of rock salt", "rigid"]
        )
        self.assertNotIn("computed pressure on seam", [effect for effect, _ in found])

    def test_temperature(self):
        """Left out as a whole, in each of what it does, and by its means."""
        hot = scene_file("hot_pipe").read_text()
        self.assertEqual(
            [f"{found.effect}: {found.instead}" for found in self.of(hot)],
            [
                "viscous flow: elastic",
                "power of the flow law: 1, same rate at the mean stress",
                "thermal expansion: none",
                "activation energy: none",
                "temperature: none",
                "temperature over space: its mean",
                "temperature over time: its mean",
            ],
        )
        cold = hot.replace("set Activation energy = 110 kJ/mol", "")
        found = [found.effect for found in self.of(cold)]
        self.assertNotIn("temperature", found)
        self.assertIn("thermal expansion", found)

    def test_anisotropy(self):
        found = self.words(
            SQUARE + "subsection Material\nset Voigt matrix = 3, 1, 1, 0, 0, 0; "
            "1, 3, 1, 0, 0, 0; 1, 1, 3, 0, 0, 0; 0, 0, 0, 1, 0, 0; 0, 0, 0, 0, 1, 0; "
            "0, 0, 0, 0, 0, 1\nend\n"
        )
        self.assertEqual(
            found[0],
            "anisotropy: the nearest isotropic stiffness (Material/Voigt matrix=,"
            "Material/Young's modulus=2.5,Material/Poisson's ratio=0.25)",
        )


class Effects(TestCase):
    def test_of_the_slab(self):
        with Case(VERIFICATION / "slab.prm", **SLAB) as scene:
            process = scene.run("effects", code=0)
            verdicts = scene.verdicts()
            for effect in (
                ("viscous flow", "elastic"),
                ("traction on Boundary 0", "none"),
                ("friction on Boundary 2", "none"),
                ("slip on Boundary 2", "never"),
                ("traction on Boundary 0 over time", "its mean"),
            ):
                self.assertEqual(verdicts.pop(effect), "called for", effect)
            # nu = 0.3 and little flow: both are as good as their alternatives.
            for effect in (
                ("volumetric integration (full)", "mean dilatation"),
                ("stress history (cell means)", "quadrature points"),
            ):
                self.assertEqual(
                    verdicts.pop(effect), "below the error of this discretization"
                )
            for effect, verdict in verdicts.items():
                self.assertNotEqual(verdict, "cannot be left out", effect)

            about = scene.about()
            self.assertTrue(about["finished"])
            for effect in about["effects"]:
                self.check_changes(scene, effect)
            # The two largest, once more from the tables.
            both = about["interaction"]
            names = {effect["effect"]: effect for effect in about["effects"]}
            for part in (both["first"], both["second"]):
                self.assertEqual(names[part["effect"]]["verdict"], "called for")
            self.check_interaction(scene, both)

            # Most were settled on the coarser mesh, the rest on the scene's.
            levels = {e["effect"]: e["level"] for e in about["effects"]}
            self.assertEqual(levels["traction on Boundary 0"], -1)
            self.assertEqual(levels["volumetric integration (full)"], 0)
            self.assertEqual(about["left_out"], "")
            for watching in ("error bar", "fields and checkpoints"):
                self.assertEqual(names[watching]["verdict"], "only watches")
                self.assertEqual(names[watching]["level"], -1)
            fields = names["fields and checkpoints"]
            self.assertGreater(fields["with"]["seconds"], 0.0)
            written = scene.effects / "fields_and_checkpoints__none" / "study"
            self.assertTrue(list(written.rglob("*.vtu")))

            # A table of at most 100 columns.
            for line in process.stdout.splitlines():
                if line.startswith("  "):
                    self.assertLessEqual(len(line), 100, line)
            with open(scene.effects / "effects.csv", newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual(
                len(rows), sum(len(e["changes"]) for e in about["effects"])
            )
            text = (scene.effects / "effects.md").read_text()
            self.assertIn("| viscous flow | elastic | called for |", text)

            # The same command does nothing again.
            before = scene.finished()
            self.assertEqual(scene.run("effects").returncode, 0)
            self.assertEqual(scene.finished(), before)

    def table(self, scene, effect):
        """That of the run without an effect, or with all."""
        directory = scene.effects / "scene"
        level = effect["level"]
        if "effect" in effect:
            name = f'{effect["effect"]}__{effect["instead"]}'
            directory = scene.effects / "".join(c if c.isalnum() else "_" for c in name)
        steps = effect.get("steps", level)
        (file,) = (directory / "study").glob(
            f"uniform*_h{level}_k{steps}/statistics.csv"
        )
        return read_statistics(file)

    def size(self, table, column):
        """What changes are relative to: energies to the largest of them."""
        energies = ("friction_dissipation", "viscous_dissipation")
        energies += ("stored_energy", "external_work")
        names = energies if column in energies else (column,)
        return max(np.abs(table[name]).max() for name in names if name in table)

    def check_changes(self, scene, effect):
        """Once more from the tables of both runs."""
        if effect["verdict"] in ("never acted", "only watches"):
            return
        of_scene = self.table(scene, {"level": effect["level"]})
        other = self.table(scene, effect)
        for column in ("viscous_dissipation", "stored_energy", "max_von_mises"):
            difference = of_scene[column] - other.get(column, 0.0)
            size = self.size(of_scene, column)
            found = effect["changes"][column]["change"]
            self.assertClose(found, np.abs(difference).max() / size, 1e-9, 1e-12)
        # That of the steps and that of the mesh, which may have other signs.
        level = effect["level"]
        longer = self.table(scene, {"level": level, "steps": level - 1})
        coarser = self.table(scene, {"level": level - 1})
        column = "stored_energy"
        errors = (
            np.abs(finer - rougher[column]).max() / self.size(rougher, column)
            for finer, rougher in (
                (of_scene[column][::2], longer), (longer[column], coarser)
            )
        )
        self.assertClose(effect["changes"][column]["error"], sum(errors), 1e-9, 1e-12)
        distance = effect["changes"]["energy_norm"]
        self.assertClose(
            distance["change"],
            np.nanmax(other["error_energy"]) / of_scene["energy_norm"].max(),
            1e-9,
            1e-12,
        )
        self.assertGreater(distance["error"], 0.0)

    def check_interaction(self, scene, both):
        column = both["quantity"]
        runs = [{"level": both["joint"]["level"]}]
        runs += [both[which] for which in ("first", "second", "joint")]
        tables = [self.table(scene, run) for run in runs]
        names = [name for name in tables[0] if name in (column, f"{column}_x")]
        names += [f"{column}_y"] if f"{column}_y" in tables[0] else []
        values = [
            np.array([np.atleast_1d(t.get(n, 0 * t["t"])) for n in names])
            for t in tables
        ]
        rest = values[0] - values[1] - values[2] + values[3]
        size = np.linalg.norm(values[0], axis=0).max()
        if len(names) == 1:
            size = self.size(tables[0], names[0])
        found = np.linalg.norm(rest, axis=0).max() / size
        self.assertClose(both["interaction"], found, 1e-9, 1e-12)
        self.assertEqual(both["interact"], found > 4 * both["error"])
        self.assertIn("interact" if both["interact"] else "add up", both["words"])

    def test_of_what_never_acts(self):
        with Case(
            VERIFICATION / "slab.prm",
            **FEW_CELLS,
            Boundary_2__Friction_bound="10",
            Material__Law="perzyna",
            Material__perzyna__Yield_radius="100",
        ) as scene:
            alone = scene.run()
            self.assertIn("viscoplastic flow has never acted", alone.stdout)
            self.assertRegex(
                alone.stdout, r"friction has never acted: .* at most \d+\.\d+ % of"
            )
            scene.run("effects", code=0)
            verdicts = scene.verdicts()
            self.assertEqual(verdicts["viscous flow", "elastic"], "never acted")
            self.assertEqual(verdicts["slip on Boundary 2", "never"], "never acted")
            self.assertEqual(verdicts["friction on Boundary 2", "none"], "called for")

    def test_of_two_bodies(self):
        """What it costs that one of them is rigid."""
        with Case(
            VERIFICATION / "two_blocks_2d.prm",
            Study__Budget=1e5,
            Error_control__Quantity="contact_force_y",
        ) as scene:
            scene.run("effects", code=0)
            (effect,) = [
                effect
                for effect in scene.about()["effects"]
                if effect["effect"] == "deformation of Material 1"
            ]
            self.assertEqual(effect["verdict"], "called for")
            changes = effect["changes"]
            # u_y of the top is -p sum (1 - nu^2)/E
            self.assertClose(changes["point0"]["change"], 0.0048 / 0.0139, relative=0.1)
            self.assertNotIn("energy_norm", changes)
            # Bilateral contact does not have the quantity, and needs no other.
            failures = [effect["failure"] for effect in scene.about()["effects"]]
            self.assertEqual(set(failures), {""})
            self.assertEqual(percent(14362.59), "14 000 times")

    def test_what_cannot_be_left_out(self):
        """Steps that only backward Euler can take."""
        with Case(
            VERIFICATION / "slab.prm",
            **FEW_CELLS,
            Material__maxwell__Viscosity=0.01,
            Time__Scheme="backward Euler",
        ) as scene:
            scene.run("effects", code=0)
            about = scene.about()
            (failed,) = [
                effect
                for effect in about["effects"]
                if effect["instead"] == "forward Euler"
            ]
            self.assertEqual(failed["verdict"], "cannot be left out")
            self.assertIn("stability limit", failed["failure"])
            figure = picture.draw(about)
            self.assertEqual(
                len(figure.axes[0].get_yticks()),
                sum(not effect["failure"] for effect in about["effects"]),
            )
            errors = io.StringIO()
            with contextlib.redirect_stderr(errors):
                self.assertNotEqual(plot([str(scene.effects), "loop"]), 0)
            self.assertIn("one picture, which goes without a name", errors.getvalue())

    def test_what_takes_too_long(self):
        """Is ended, and says nothing; nor do numbers that no solver stands."""
        with Folder(VERIFICATION / "slab.prm", **SLAB) as scene:
            study = effects.EffectsStudy(
                Program(PROGRAM), scene.arguments(), [], Console()
            )
            self.assertTrue(study.compute_scene(0))
            (never,) = (v for v in effect_variants(study.scene, 1.0, "") if v.is_extreme)
            wrong = dataclasses.replace(
                never, effect="other", overrides=["Boundary 2/Friction bound=no number"]
            )
            for variant, least, failure in (
                (never, 0.0, "not computed: it takes more"), (wrong, 10.0, "no number")
            ):
                with unittest.mock.patch.multiple(
                    effects, MOST_TIMES=1e-3, LEAST_LIMIT=least
                ):
                    result = study.compare(variant, 0)
                self.assertIn(failure, result.failure)
                self.assertEqual(result.verdict, "could not be computed")

    def test_to_a_tolerance(self):
        with Case(
            VERIFICATION / "slab.prm",
            Geometry__Arguments="8, 4 : 0, 0 : 2, 1 : true",
            Error_control__Tolerance=0.3,
            Study__Budget=1e5,
        ) as scene:
            scene.run("effects", code=0)
            verdicts = scene.verdicts()
            self.assertEqual(verdicts["friction on Boundary 2", "none"], "called for")

    def test_refused(self):
        for sentence, arguments in (
            ("required: scene.prm", ["effects"]),
            ("unrecognized arguments: --check", ["effects", "--check", "a.prm"]),
            ("unrecognized arguments: --restart", ["effects", "--restart", "a.prm"]),
            ("relative error from 1e-6 to 0.5", ["price", "few", "a.prm"]),
            ("relative error from 1e-6 to 0.5", ["price", "2", "a.prm"]),
        ):
            with tempfile.TemporaryDirectory() as work:
                process = run_study(arguments, 1, Path(work))
            self.assertEqual(process.returncode, 2, process.stderr)
            self.assertIn(sentence, process.stderr)
            self.assertEqual(process.stderr.count("\n"), 1, process.stderr)

    def test_after_signal(self):
        with Case(VERIFICATION / "slab.prm", **SLAB) as scene:
            process = subprocess.Popen(
                study_command(*scene.arguments("effects")),
                cwd=scene.work,
                env=study_environment(),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
            )
            # Beyond the runs of the scene itself.
            while len(scene.finished()) < 8 and process.poll() is None:
                time.sleep(0.02)
            process.send_signal(signal.SIGTERM)
            _, stderr = process.communicate()
            # Between runs a signal just ends it.
            self.assertIn(process.returncode, (3, -signal.SIGTERM), stderr)
            if process.returncode == 3:
                self.assertIn("SIGTERM has ended the study of effects", stderr)

    def test_steps_by_their_error(self):
        """Step control: coarser levels have larger tolerances."""
        with Case(
            VERIFICATION / "slab.prm", **FEW_CELLS, Step_control__Tolerance=0.05
        ) as scene:
            scene.run("effects", code=0)
            verdicts = scene.verdicts()
            self.assertEqual(verdicts["friction on Boundary 2", "none"], "called for")
            self.assertIn(("step control", "the steps of the phases"), verdicts)
            steps = [
                len(self.table(scene, {"level": level})["t"]) for level in (-2, -1)
            ]
            self.assertLess(steps[0], steps[1])

    def test_in_space_on_adaptive_meshes(self):
        """Without friction, with moduli and loads that are no constants."""
        entries = {
            "Dimension": 3,
            "Geometry/Arguments": "4, 2, 2 : 0, 0, 0 : 2, 1, 1 : true",
            "Material/Young's modulus": "1 + 5*x",
            "Boundary 0/Role": "clamped",
            "Boundary 1/Role": "traction",
            "Boundary 1/Traction": "0.01*t*(1 + y); 0; 0",
            **{f"Boundary {i}/Role": "free" for i in range(2, 6)},
            "Time/Phases": "1: 4",
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Every n steps": 2,
        }
        with tempfile.TemporaryDirectory() as work:
            beam = Path(work) / "beam.prm"
            beam.write_text(as_prm(entries))
            with Case(beam, Study__Budget=1e5) as scene:
                scene.run("effects", code=0)
                verdicts = scene.verdicts()
                for effect in (
                    ("traction on Boundary 1", "none"),
                    ("Young's modulus over space", "its mean"),
                ):
                    self.assertEqual(verdicts[effect], "called for", effect)
                self.assertIn(("adaptive mesh", "the first mesh"), verdicts)
                over_time = ("traction on Boundary 1 over time", "its mean")
                self.assertEqual(verdicts[over_time], "called for")
                changes = scene.about()["effects"][0]["changes"]
                self.assertNotIn("friction_force", changes)
                for quantity in ("reaction_0", "max_displacement", "max_von_mises"):
                    self.assertIn(quantity, changes)

    def test_of_a_budget_that_ends(self):
        """A second is enough for the first run, not for all; two ranks."""
        with Case(VERIFICATION / "slab.prm", Study__Budget=1) as scene:
            process = scene.run("effects", ranks=2, code=0)
            about = scene.about()
            self.assertTrue(about["finished"])
            self.assertEqual(about["ranks"], 2)
            self.assertIn("'Study/Budget'", about["left_out"])
            self.assertIn(
                " ".join(about["left_out"].split()), " ".join(process.stdout.split())
            )


if __name__ == "__main__":
    main()
