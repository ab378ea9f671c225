# SPDX-License-Identifier: LGPL-2.1-or-later
"""Laws from shared libraries: the example of the manual is built outside of the
source tree and held to the law `parsed`, which takes the same formula from the
parameter file; libraries that are refused."""

import json
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

import law_example
from harness import EXECUTABLE, PROGRAM, SOURCE, TestCase, main, run, run_program
from runs import of_law

# Where the package files of the build are.
PACKAGE = Path(EXECUTABLE).parent

GAROFALO = {
    **of_law("garofalo", Rate_factor="0.02*(1 + x)", Stress_scale=0.1, Stress_cap=10),
}
PARSED = {**of_law("parsed", Strain_rate="0.02*sinh(sigma_eq/0.1)", Factor="1 + x")}

# Laws that do what their names say.
MISBEHAVING = r"""
#include <viscoplastic_contact/laws/law_library.h>

#include <cstdlib>
#include <iostream>
#include <limits>

namespace Viscoplastic
{
  class Misbehaving : public ViscoplasticLaw
  {
  public:
    explicit Misbehaving(const std::string &name)
      : ViscoplasticLaw({})
      , name(name)
    {
      if (name == "throws_when_made")
        throw 3;
      if (name == "exits_when_made")
        std::exit(0);
    }

    ~Misbehaving()
    {
      if (name == "counts")
        std::cout << n_cells << " cells, " << n_points << " points" << std::endl;
    }

    void
    flow(const LawStates &states, Flow *result) const override
    {
      ++n_cells;
      ViscoplasticLaw::flow(states, result);
    }

    SymmetricTensor<2, 3>
    rate(const SymmetricTensor<2, 3> &stress,
         const SymmetricTensor<2, 3> &,
         const Stiffness &,
         const LawPoint &point) const override
    {
      ++n_points;
      if (name == "throws_in_a_run" && point.t > 0.)
        throw 3;
      if (name == "exits_in_a_run" && point.t > 0.)
        std::exit(0);
      return -factor(point) * stress;
    }

    Tangents
    tangents(const SymmetricTensor<2, 3> &,
             const SymmetricTensor<2, 3> &,
             const Stiffness &,
             const LawPoint &point) const override
    {
      Tangents tangents;
      tangents.stress = -factor(point) * identity_tensor<3>();
      return tangents;
    }

    double
    relaxation_rate(const SymmetricTensor<2, 3> &,
                    const SymmetricTensor<2, 3> &,
                    const Stiffness &,
                    const LawPoint &point) const override
    {
      return name == "nan_limit"      ? std::numeric_limits<double>::quiet_NaN() :
             name == "negative_limit" ? -1. :
                                        factor(point);
    }

    bool
    depends_on_temperature() const override
    {
      return name == "warms_up";
    }

    bool
    deviatoric_flow() const override
    {
      return false;
    }

  private:
    double
    factor(const LawPoint &point) const
    {
      return name == "warms_up" ? 1e-5 * point.temperature : 1e-3;
    }

    const std::string    name;
    mutable unsigned int n_cells = 0, n_points = 0;
  };

  LawDescription
  describe(const std::string &name)
  {
    LawDescription law;
    law.name    = name;
    law.help    = "A law that misbehaves.";
    law.declare = [](ParameterHandler &) {};
    law.make    = [name](const LawSection &) {
      return std::make_unique<Misbehaving>(name);
    };
    return law;
  }
} // namespace Viscoplastic

using Viscoplastic::describe;
VISCOPLASTIC_LAW_LIBRARY(describe("throws_when_made"),
                         describe("exits_when_made"),
                         describe("throws_in_a_run"),
                         describe("exits_in_a_run"),
                         describe("nan_limit"),
                         describe("negative_limit"),
                         describe("counts"),
                         describe("warms_up"))
"""


class Libraries(TestCase):
    @classmethod
    def setUpClass(cls):
        cls.work = Path(tempfile.mkdtemp(prefix="law_library_"))
        cls.addClassCleanup(shutil.rmtree, cls.work, ignore_errors=True)

    def compile(self, name, text):
        """A library that does not know the program."""
        path = self.work / name
        subprocess.run(
            ["c++", "-shared", "-fPIC", "-x", "c++", "-", "-o", path],
            input=text,
            text=True,
            check=True,
        )
        return path

    def refused(self, libraries, *words, ranks=1, **changes):
        changes = {"Additional shared libraries": libraries, **changes}
        super().refused(changes, *words, ranks=ranks)


class Example(Libraries):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        law_example.write_project(cls.work)
        (cls.work / "misbehaving.cc").write_text(MISBEHAVING)
        with open(cls.work / "CMakeLists.txt", "a") as project:
            project.write(
                "viscoplastic_contact_add_law_library(misbehaving misbehaving.cc)\n"
            )
        cls.law_file = law_example.build(
            cls.work, f"-Dviscoplastic_contact_DIR={PACKAGE}"
        )
        cls.law = {"Additional shared libraries": cls.law_file, **GAROFALO}

    def assertSameRuns(self, one, other, relative):
        # Only one of them has a cap.
        columns = one.statistics.keys() - {"capped_volume"}
        self.assertEqual(columns, set(other.statistics))
        for name in ("stored_energy", "viscous_dissipation", "friction_force_x"):
            scale = abs(other[name]).max()
            self.assertGreater(scale, 0, name)
            self.assertClose(one[name], other[name], absolute=relative * scale, what=name)

    def test_is_the_formula_in_the_plane_on_adaptive_meshes_and_ranks(self):
        formula = run("slab_adaptive", PARSED)
        self.assertGreater(formula["viscous_dissipation"][-1], 1e-3)
        for ranks in (1, 3):
            with self.subTest(ranks=ranks):
                law = run("slab_adaptive", self.law, ranks=ranks)
                self.assertSameRuns(law, formula, 1e-7)
        self.check_identities(law)
        self.assertEqual(law["capped_volume"].max(), 0)

    def test_is_the_formula_in_three_dimensions(self):
        short = {"Time/Phases": "0.5: 4", "Time/Stiffness policy": "backward Euler"}
        self.assertSameRuns(
            run("pad_adaptive", {**short, **self.law}),
            run("pad_adaptive", {**short, **PARSED}),
            1e-5,
        )

    def test_scene_of_the_page_runs_beside_its_library(self):
        """Relative to the parameter file, from anywhere; results name the
        library, and their parameter file is complete."""
        scene = self.work / "scene.prm"
        scene.write_text(
            law_example.scene_block()
            + "".join(
                f"subsection Boundary {i}\n  set Role = {role}\nend\n"
                for i, role in enumerate(["clamped", "traction", "free", "free"])
            )
            + "subsection Boundary 1\n  set Traction = 1e-3*t; 0\nend\n"
            + "subsection Time\n  set Phases = 1: 2\nend\n"
        )
        there = self.work / "elsewhere"
        there.mkdir()
        run_program([scene], 1, there, code=0)
        results = there / "output" / "scene"
        record = (results / "parameters.prm").read_text()
        self.assertIn(f"set Additional shared libraries = {self.law_file}", record)
        info = json.loads((results / "run.json").read_text())
        self.assertEqual(info["shared_libraries"], [str(self.law_file)])
        run_program([results / "parameters.prm"], 1, there, code=0)

        described = subprocess.run(
            [PROGRAM, "--describe", scene], stdout=subprocess.PIPE, text=True
        ).stdout
        self.assertRegex(described, "set Stress scale += 4e6")
        self.assertIn("Garofalo, Fundamentals", re.sub(r"\s+#\s+", " ", described))
        (there / "described.prm").write_text(described)
        run_program(["--check", there / "described.prm"], 1, there, code=0)
        manual = subprocess.run(
            [SOURCE / "contrib" / "make_parameters", scene],
            env={**os.environ, "VISCOPLASTIC_CONTACT": PROGRAM},
            stdout=subprocess.PIPE,
            text=True,
        ).stdout
        self.assertIn("## Material/garofalo", manual)

    def test_restart_goes_on_with_the_law(self):
        changes = {**self.law, "Checkpoint/Every n steps": 8}
        whole = run("slab", changes)
        part = run("slab", {**changes, "Time/Phases": "1: 16"})
        process = run_program(
            [
                "--restart",
                part.directory.parent / "slab.prm",
                part.directory.parent / "overrides.prm",
                "--set",
                "Time/Phases=1: 16, 2: 16",
            ],
            1,
            part.directory.parent, code=0)
        self.assertClose(part["stored_energy"], whole["stored_energy"])

    def test_laws_that_misbehave(self):
        """A run that ends early never looks like one that has succeeded."""
        for law, sentence, ranks in (
            ("throws_when_made", "something has been thrown that is no std::exc", 1),
            ("exits_when_made", "exit() has been called while running the scene", 1),
            ("throws_in_a_run", "something has been thrown that is no std::exc", 2),
            ("exits_in_a_run", "exit() has been called while running the scene", 1),
            ("exits_in_a_run", "exit() has been called while running the scene", 2),
            ("nan_limit", "The relaxation rate is nan at x = (", 1),
            ("negative_limit", "The relaxation rate is -1 at x = (", 2),
        ):
            with self.subTest(law=law, ranks=ranks):
                library = self.law_file.with_name("misbehaving.so")
                self.refused(library, sentence, ranks=ranks, **{"Material/Law": law})

    def test_temperature(self):
        """A law that asks for it in its own code, at a constant 100 K and one that
        grows with time."""
        library = self.law_file.with_name("misbehaving.so")
        warm = {"Additional shared libraries": library, "Material/Law": "warms_up"}
        self.refused(
            library, "is a law of the temperature T", **{"Material/Law": "warms_up"}
        )
        plain = run("slab", {**warm, "Material/Law": "counts"})
        same = run("slab", {**warm, "Temperature/Value": 100})
        for name in "stored_energy", "viscous_dissipation", "max_displacement":
            self.assertClose(same[name], plain[name], relative=1e-12, what=name)
        hot = run("slab", {**warm, "Temperature/Value": "100*(1 + t)"}, ranks=2)
        # that at the beginning of each step
        limit = hot["step_limit"][1:] * (1 + hot["t"][:-1])
        self.assertClose(limit, plain["step_limit"][1:], relative=1e-10)

    def test_a_step_evaluates_a_law_once(self):
        """At each point of each cell, G at the end of a step is that at the start
        of the next one, of its balance and of its estimate."""
        library = self.law_file.with_name("misbehaving.so")
        for history, n_points in (("cell means", 1), ("quadrature points", 4)):
            with self.subTest(history=history):
                result = run(
                    "slab",
                    {
                        "Additional shared libraries": library,
                        "Material/Law": "counts",
                        "Material/Stress history": history,
                    },
                )
                cells, points = re.search(
                    r"(\d+) cells, (\d+) points", result.stdout
                ).groups()
                n_cells = result["cells"][0] * len(result["step"])
                self.assertEqual(int(cells), n_cells)
                self.assertEqual(int(points), n_points * n_cells)

    def test_scenes_without_it_do_not_know_the_law(self):
        result = run("slab", GAROFALO, check=False)
        self.assertEqual(result.returncode, 1)
        self.assertIn("garofalo", result.stderr)

    def test_twice_the_same_law(self):
        self.refused(
            f"{self.law_file}, {self.law_file}", "'garofalo', which another law has"
        )


class Refused(Libraries):
    def test_missing(self):
        self.refused(
            "nowhere.so",
            "overrides.prm', line ",
            "'Additional shared libraries' is 'nowhere.so', but there is no such file",
        )
        self.refused("a.so,,b.so", "Additional shared libraries")

    def test_no_library(self):
        text = self.work / "text.so"
        text.write_text("no library\n" * 100)
        self.refused(text, "cannot be loaded", "invalid ELF header")

    def test_missing_symbol(self):
        path = self.compile(
            "unresolved.so", "void nowhere(); void f() { nowhere(); }"
        )
        self.refused(path, "undefined symbol", "built for this version")

    def test_library_without_laws(self):
        path = self.compile("other.so", "int f() { return 1; }")
        self.refused(path, "has no laws", "VISCOPLASTIC_LAW_LIBRARY is missing")

    def test_ends_while_it_is_loaded(self):
        path = self.compile(
            "exits.so", "#include <cstdlib>\nstruct A { A() { std::exit(0); } } a;"
        )
        self.refused(path, "exit() has been called while loading", str(path))
        path = self.compile("throws.so", "struct A { A() { throw 3; } } a;")
        self.refused(path, "where none can be caught", str(path))
        path = self.compile(
            "throws_later.so",
            'extern "C" const char *viscoplastic_contact_law_interface() { throw 3; }'
            'extern "C" void viscoplastic_contact_describe_laws() {}',
        )
        self.refused(path, "overrides.prm', line ", "that is no std::exception")

    def test_another_version(self):
        path = self.compile(
            "old.so",
            'extern "C" const char *viscoplastic_contact_law_interface()'
            ' { return "0.0.1-12345678"; }'
            'extern "C" void viscoplastic_contact_describe_laws() {}',
        )
        self.refused(path, "version 0.0.1-12345678", "build it again")


if __name__ == "__main__":
    main()
