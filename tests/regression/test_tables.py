# SPDX-License-Identifier: LGPL-2.1-or-later
"""Data from tables: columns of CSV files as functions in expressions, against
the same functions written as formulas; kinks and jumps; what is refused."""

import shutil
import tempfile
from pathlib import Path

from harness import TestCase, as_prm, main, run, run_program, scene_file

# 0.3 min(t, 2 - t), the load of the slab, and a factor in place.
LOAD = "# measured\nt,force, other\n0,0,5\n1,0.3,6\n\n2,0,7\n"
TABLE = {"Boundary 0/Traction": "force(t); 0"}


class Tables(TestCase):
    def setUp(self):
        self.work = Path(tempfile.mkdtemp(prefix="tables_"))
        self.addCleanup(shutil.rmtree, self.work, ignore_errors=True)

    def table(self, text=LOAD, name="load.csv"):
        (self.work / name).write_text(text)
        return self.work / name

    def assertSameRun(self, one, other, names=("stored_energy", "friction_force_x")):
        self.assertEqual(one["step"].tolist(), other["step"].tolist())
        for name in names:
            scale = abs(other[name]).max()
            self.assertGreater(scale, 0, name)
            self.assertClose(one[name], other[name], absolute=1e-9 * scale, what=name)


class Formulas(Tables):
    def test_load_in_the_plane_on_ranks_and_adaptive_meshes(self):
        small = {"Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true", "Time/Phases": "1: 6, 2: 6"}
        changes = {"Table 1/File": self.table(), **TABLE, **small}
        formula = run("slab_adaptive", small)
        self.assertGreater(formula["cells"][-1], formula["cells"][0])
        for ranks in (1, 3):
            with self.subTest(ranks=ranks):
                table = run("slab_adaptive", changes, ranks=ranks)
                for name in ("stored_energy", "friction_force_x"):
                    scale = abs(formula[name]).max()
                    self.assertClose(
                        table[name], formula[name], absolute=1e-6 * scale, what=name
                    )

    def test_longest_name(self):
        name = "f" * 100
        table = self.table(LOAD.replace("force", name))
        changes = {"Table 1/File": table, "Boundary 0/Traction": f"{name}(t); 0"}
        self.assertSameRun(run("slab", changes), run("slab"))

    def test_materials_and_bounds_in_place(self):
        """Argument x, y or what an expression makes of them; blanks between
        name and parenthesis; constants beyond the rows."""
        self.table("s,stiff,bound\n0,1,0.06\n1,2,0.09\n", "place.csv")
        scene = self.work / "scene.prm"
        scene.write_text(scene_file("slab").read_text())
        (self.work / "more.prm").write_text(
            "subsection Table 4\n set File = place.csv\n set Outside = constant\nend\n"
            + as_prm(
                {
                    "Material/Young's modulus": "2 - stiff(1 - y) + stiff(-1)",
                    "Boundary 2/Friction bound": "bound (x/2)",
                }
            )
        )
        run_program([scene, self.work / "more.prm"], 1, self.work, code=0)
        record = self.work / "output" / "scene" / "parameters.prm"
        self.assertIn(f"set File          = {self.work}/place.csv", record.read_text())
        # complete, and read from anywhere
        table = run("slab", text=record.read_text())
        self.assertEqual(
            [(one["section"], one["file"]) for one in table.info["tables"]],
            [("Table 4", f"{self.work}/place.csv")],
        )
        formula = run(
            "slab",
            {
                "Material/Young's modulus": "1 + y",
                "Boundary 2/Friction bound": "0.06 + 0.03*x/2",
            },
        )
        self.assertSameRun(table, formula)

    def test_three_dimensions(self):
        short = {"Time/Phases": "0.5: 4"}
        traction = "0.1*t; 0.05*t*(1 + z); 0"
        formula = run("pad_adaptive", {**short, "Boundary 0/Traction": traction})
        self.table("t,a\n0,0\n10,1\n")
        self.table("z,b\n-1,0\n1,0.1\n", "place.csv")
        table = run(
            "pad_adaptive",
            {
                **short,
                "Table 1/File": self.work / "load.csv",
                "Table 2/File": self.work / "place.csv",
                "Boundary 0/Traction": "a(t); t*b(z); 0",
            },
        )
        self.assertSameRun(table, formula, ("stored_energy",))


class Times(Tables):
    CONTROL = {
        "Step control/Tolerance": 0.05,
        "Output/Fields every": 0,
        "Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true",
    }

    def test_steps_end_at_kinks(self):
        changes = {
            **self.CONTROL,
            "Table 1/File": self.table("t,force\n0,0\n0.61,0.3\n0.611,0.2\n2,0\n"),
            # rows at the same times
            "Table 2/File": self.table("t,b\n0,0\n0.61,1\n2,1\n", "other.csv"),
            **TABLE,
        }
        result = run("slab", changes)
        for kink in (0.61, 0.611):
            self.assertLess(min(abs(result["t"] - kink)), 1e-8, kink)

    def test_steps_avoid_jumps(self):
        table = self.table("t,force\n0,0\n0.613,0.1\n2,0.1\n")
        result = run(
            "slab",
            {
                **self.CONTROL,
                "Table 1/File": table,
                "Table 1/Interpolation": "constant",
                "Boundary 0/Traction": "0.1*t + force(t); 0",
            },
        )
        formula = run(
            "slab",
            {**self.CONTROL, "Boundary 0/Traction": "0.1*t + if(t < 0.613, 0, 0.1); 0"},
        )
        # just before and just after
        for side in (-1, 1):
            self.assertLess(min(abs(result["t"] - 0.613 - side * 5e-7)), 1e-8)
        self.assertSameRun(result, formula)


class Restart(Tables):
    def go_on(self, part, *more):
        directory = part.directory.parent
        files = [directory / "slab.prm", directory / "overrides.prm"]
        sets = ["--set", "Time/Phases=1: 16, 2: 16"]
        return run_program(["--restart", *files, *sets, *more], 1, directory)

    def test_goes_on_with_the_same_table_only(self):
        table = self.table()
        changes = {"Table 1/File": table, **TABLE, "Checkpoint/Every n steps": 16}
        whole = run("slab", changes)
        part = run("slab", {**changes, "Time/Phases": "1: 16"})
        table.write_text(LOAD.replace("2,0,7", "2,0.1,7"))
        process = self.go_on(part)
        self.assertEqual(process.returncode, 1, process.stdout)
        self.assertIn("'Table 1/Checksum of the file' is", process.stderr)
        # elsewhere, but the same
        moved = self.table(name="moved.csv")
        process = self.go_on(part, "--set", f"Table 1/File={moved}")
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertClose(part["stored_energy"], whole["stored_energy"])


class Refused(Tables):
    def refused(self, text, *words, changes=None):
        table = {"Table 1/File": self.table(text)}
        super().refused({**table, **(changes or TABLE)}, *words)

    def test_tables(self):
        where = f"'{self.work}/load.csv', line "
        self.refused("", where + "0: the table ends with 0 rows")
        self.refused("t,force\n0,1\n", "ends with 1 rows of numbers; it needs two")
        self.refused(f"t,{'f' * 50_000}\n0,1\n", "' is no name of a column", "at most 100")
        self.refused("t\n0\n1\n", where + "1: there is one column")
        self.refused("0,1\n1,2\n", where + "1: '0' is no name of a column")
        self.refused("t,force\n0,1\n1\n", where + "3: there are 1 values")
        self.refused("t,force\n0,1\n1,2,3\n", where + "3: there are 3 values")
        self.refused("t,force\n0,1\n# x\n1,a\n", where + "4: 'a' in the column 'force'")
        self.refused("t,force\n0,1\n1,inf\n", "no finite number")
        self.refused("t,force\n0,1\n1,nan\n", "no finite number")
        self.refused("t,force\n0,1\n0,2\n", where + "3: '0' in the column 't' is not")
        self.refused("t,sin\n0,1\n1,2\n", "the column 'sin'", "know already")
        self.refused("t,force,force\n0,1,1\n1,2,2\n", "the column 'force'", "already")

    def test_expressions(self):
        for wrong in ("forces(t); 0", "force; 0", "force(t, 1); 0"):
            changes = {"Boundary 0/Traction": wrong}
            self.refused(LOAD, "cannot be parsed", changes=changes)
        self.refused(
            LOAD.replace("2,0,7", "1.5,0.1,7"),
            "'force(t)' of 'Boundary 0/Traction'",
            "'force' of 'Table 1' has no value at 1.5",
            "'t' goes from 0 to 1.5",
        )

    def test_files(self):
        for file in ("nowhere.csv", self.work):
            result = run("slab", {"Table 1/File": file, **TABLE}, check=False)
            self.assertEqual(result.returncode, 1)
            words = "'Table 1/File' is" if file == "nowhere.csv" else "cannot be read"
            self.assertIn(words, result.stderr)


if __name__ == "__main__":
    main()
