# SPDX-License-Identifier: LGPL-2.1-or-later
"""Meshes from files: a scene gives the same results as with the generator,
whatever the format, and no file makes the program crash or hang."""

import os
import random
import re
import runpy
import shutil
import subprocess
import tempfile
from pathlib import Path

from harness import PROGRAM, SOURCE, TestCase, as_prm, main, run, scene_file
from runs import on_boundary, with_roles

MESHES = SOURCE / "prm" / "verification" / "meshes"
FORMATS = "_2.msh", "_4.msh", ".ucd", ".vtk", ".inp"

SHORT = {
    "Geometry/Arguments": "4, 2 : 0, 0 : 2, 1 : true",
    "Geometry/Global refinements": 1,
    "Time/Phases": "1: 4, 2: 4",
    "Output/Fields every": 0,
}

# From the ids of the files (1 bottom, 2 right, 3 top, 4 left, 5 and 6 in z) to
# those of the generator.
IDS = {
    2: "if(id == 1, 2, if(id == 2, 1, if(id == 3, 3, 0)))",
    3: "if(id > 4, id - 1, if(id == 1, 2, if(id == 2, 1, if(id == 3, 3, 0))))",
}


class Same(TestCase):
    def check_same(self, result, expected):
        self.assertEqual(result.statistics.keys(), expected.statistics.keys())
        for name in "friction_dissipation", "strain_energy", "max_displacement":
            self.assertGreater(expected[name][-1], 0)
            self.assertClose(result[name], expected[name], 1e-10, 1e-14, name)
        for name in "reaction", "friction_force":
            for axis in "xy":
                column = f"{name}_{axis}"
                if column in expected.statistics:
                    self.assertClose(
                        result[column], expected[column], 1e-10, 1e-12, column
                    )

    def test_slab_in_all_formats(self):
        expected = run("slab", SHORT)
        for suffix in FORMATS:
            with self.subTest(suffix):
                file = {
                    "Geometry/File": MESHES / f"two_materials{suffix}",
                    "Geometry/Boundary ids": IDS[2],
                }
                self.check_same(run("slab", {**SHORT, **file}), expected)
                if suffix == "_4.msh":
                    self.check_same(run("slab", {**SHORT, **file}, ranks=2), expected)

    def test_elements_of_rings(self):
        """Of ABAQUS, for bodies of revolution and nothing else."""
        rings = {
            **SHORT,
            "Geometry/Plane model": "axisymmetric",
            "Geometry/Translation": "1, 0",
            "Output/Points": "",
        }
        file = {"Geometry/Boundary ids": IDS[2]}
        with tempfile.NamedTemporaryFile("w", suffix=".inp") as mesh:
            text = (MESHES / "two_materials.inp").read_text()
            mesh.write(text.replace("CPE4", "CAX4R", 1))
            mesh.flush()
            file["Geometry/File"] = mesh.name
            self.check_same(run("slab", {**rings, **file}), run("slab", rings))
            for model in "strain", "generalized strain":
                process = run(
                    "slab", {**SHORT, **file, "Geometry/Plane model": model}, check=False
                )
                self.assertRefused(
                    process,
                    "this element is a CAX4R, which is axisymmetric, and "
                    f"'Geometry/Plane model' is {model}",
                )

    def test_shear_layer_in_3d(self):
        text = as_prm(
            {
                "Dimension": "3",
                **with_roles(free=[0, 1]),
                **on_boundary(2, Role="contact", Friction_law="tresca"),
                "Boundary 2/Friction bound": "0.02",
                **on_boundary(3, Role="displacement", Displacement="0.1*t; -0.01*t; 0"),
                **with_roles(free=[4, 5]),
            }
        )
        short = {
            "Geometry/Arguments": "2, 1, 1 : 0, 0, 0 : 2, 1, 1 : true",
            "Geometry/Global refinements": 1,
            "Geometry/Boundary refinements": "2: 1",
            "Solver/Contact tolerance": 1e-12,
            "Time/Phases": "1: 2",
        }
        expected = run("box", short, text=text)
        for suffix in "_4.msh", ".inp":
            file = {
                "Geometry/File": MESHES / f"two_materials_3d{suffix}",
                "Geometry/Boundary ids": IDS[3],
            }
            self.check_same(run("box", {**short, **file}, text=text), expected)

    def test_files_are_those_of_the_script(self):
        for name, text in runpy.run_path(MESHES / "make_meshes.py")["texts"]().items():
            self.assertEqual((MESHES / name).read_text(), text, name)

    def test_file_beside_the_scene(self):
        """The name is relative to the parameter file, not to where we are."""
        with tempfile.TemporaryDirectory() as work:
            place = Path(work) / "scene"
            place.mkdir()
            shutil.copy(MESHES / "two_materials_4.msh", place / "mesh.msh")
            (place / "slab.prm").write_text(scene_file("slab").read_text())
            overrides = {
                **SHORT,
                "Geometry/File": "mesh.msh",
                "Geometry/Boundary ids": IDS[2],
                "Output/Directory": Path(work) / "results",
            }
            (place / "overrides.prm").write_text(as_prm(overrides))
            subprocess.run(
                [PROGRAM, "scene/slab.prm", "scene/overrides.prm"],
                cwd=work,
                check=True,
                capture_output=True,
            )
            self.assertTrue((Path(work) / "results" / "statistics.csv").exists())


class Converted(TestCase):
    """contrib/convert_mesh by itself: what it refuses, and how."""

    SCRIPT = runpy.run_path(SOURCE / "contrib" / "convert_mesh")

    @staticmethod
    def text(suffix, dimension=2):
        return (MESHES / f"two_materials{'_3d' * (dimension == 3)}{suffix}").read_text()

    def convert(self, text, suffix):
        with tempfile.NamedTemporaryFile("w", suffix=suffix) as file:
            file.write(text)
            file.flush()
            return self.SCRIPT["convert"](Path(file.name))

    def refused(self, text, suffix, reason):
        with self.assertRaises(self.SCRIPT["Refused"]) as refused:
            self.convert(text, suffix)
        self.assertIn(reason, str(refused.exception))

    def damaged(self, suffix, old, new, reason):
        text = self.text(suffix)
        self.assertIn(old, text)
        self.refused(text.replace(old, new, 1), suffix, reason)

    def test_formats_agree(self):
        for dimension in 2, 3:
            ucd, vtk, abaqus = (
                self.convert(self.text(suffix, dimension), suffix)
                for suffix in (".ucd", ".vtk", ".inp")
            )
            for mesh in vtk, abaqus:
                self.assertEqual(mesh.points.tolist(), ucd.points.tolist())

            def cells(mesh, dimension=dimension):
                kind = "quad" if dimension == 2 else "hexahedron"
                ids = mesh.get_cell_data("gmsh:physical", kind)
                return mesh.get_cells_type(kind).tolist(), ids.tolist()

            self.assertEqual(cells(vtk), cells(ucd))
            self.assertEqual(cells(abaqus), cells(ucd))

    def test_other_dialects(self):
        """Words in lower case, line ends of Windows, pixels and voxels."""
        for suffix in ".ucd", ".vtk", ".inp":
            text = self.text(suffix)
            changed = text.replace("\n", "\r\n")
            changed = changed.lower() if suffix == ".inp" else changed
            expected, mesh = self.convert(text, suffix), self.convert(changed, suffix)
            self.assertEqual(mesh.points.tolist(), expected.points.tolist())
            for block, other in zip(mesh.cells, expected.cells):
                self.assertEqual(block.data.tolist(), other.data.tolist())
        for dimension, kind, nodes in (
            (2, 8, [0, 1, 3, 2]), (3, 11, [0, 1, 3, 2, 4, 5, 7, 6])
        ):
            n = 2**dimension
            text = "# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\n"
            text += f"POINTS {n} float\n"
            for i in range(n):
                text += f"{i % 2 / 10} {i // 2 % 2 / 10} {i // 4 / 10}\n"
            text += f"CELLS 1 {n + 1}\n{n} {' '.join(map(str, range(n)))}\n"
            mesh = self.convert(f"{text}CELL_TYPES 1\n{kind}\n", ".vtk")
            self.assertEqual([block.data.tolist() for block in mesh.cells], [[nodes]])
            # of single precision, but as it is written
            self.assertEqual(mesh.points.max(), 0.1)

    def test_other_cells(self):
        self.refused(
            "*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n*ELEMENT, TYPE=CPE3\n1, 1, 2, 3\n",
            ".inp",
            "as abaqus: line 6: this element is a CPE3; only quadrilaterals and hexahedra",
        )
        self.refused(
            "*NODE\n" + "".join(f"{i}, {i}, 0\n" for i in range(1, 9)) +
            "*ELEMENT, TYPE=CPE8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n",
            ".inp",
            "this element is a CPE8, with 8 nodes, of which some are between its "
            "corners; make the mesh of first order (in Gmsh, set Mesh.ElementOrder = 1)",
        )

    def test_numbers_beyond_measure(self):
        for number in (
            "-99999999999999999999999", "99999999999999999999999", "1000000000001"
        ):
            reason = f"expected the number of a node, found '{number}"
            self.damaged(".inp", "\n1, 0.0", f"\n{number}, 0.0", reason)
            # meshio takes any number for that of a node
            self.damaged(".ucd", "\n1 0.0", f"\n{number} 0.0", "as ucd: there is no node 1")

    def test_contradictions(self):
        inp = self.text(".inp")
        loop = "*ELSET, ELSET=B\n1\n" + 8 * ("B" + 30 * ",B" + "\n")
        self.refused(inp + loop, ".inp", "the set 'B' contains itself")
        self.damaged(".inp", "1, S4", "1, S7", "elements and one of their faces S1, S2")
        self.damaged(".inp", "1, S4", "1, S5", "a cell has no face 5")
        self.damaged(".inp", "\n1, 2, 3, 4\n", "\n1, 2, 3, 400\n", "there is no element 400")
        self.damaged(".inp", "1, 4, 5, 2", "1, 4, 5, 99", "there is no node 99")
        self.damaged(".inp", "\n2, 0.0", "\n1, 0.0", "line 6: the node 1 is there twice")
        self.refused("*HEADING\n", ".inp", "as abaqus: it has no nodes")
        self.refused("*NODE\n1, 0, 0\n", ".inp", "as abaqus: it has no elements")
        self.damaged(".ucd", "quad 1 4 5 2", "quad 1 4 5 99", "there is no node 99")
        self.damaged(".ucd", "1 1 line", "1 -1 line", "the id -1 is not between 0 and 999999999")
        self.damaged(".vtk", "ASCII", "BINARY", "as vtk: meshio refuses it")
        self.damaged(".vtk", "4 0 3 4 1", "4 0 3 4 77", "there is no node 77")
        self.damaged(".vtk", "4 0 3 4 1", "3 0 3 4", "as vtk: meshio refuses it")
        # Python's own words are not for users.
        self.damaged(".ucd", " quad ", " quod ", "(it does not know 'quod')")
        self.damaged(".ucd", "quad 1 ", "quad 1, ", "(expected a number, found '1,')")
        self.damaged(".ucd", " 10 quad", f" {10**40} quad", "an id is not between 0 and")
        self.damaged(".vtk", "CELLS 20", "CELLS 21", "20 cells, but line CELLS says 21")

    def test_files_that_end_too_early(self):
        """Wherever a file is cut, it is refused or has all its cells; ABAQUS files
        are complete before their sets."""
        for suffix in ".ucd", ".vtk", ".inp":
            text = self.text(suffix)
            n = len(self.convert(text, suffix).get_cells_type("quad"))
            for size in range(1, len(text), 3):
                with self.subTest(f"{suffix} cut at {size}"):
                    try:
                        mesh = self.convert(text[:size], suffix)
                    except self.SCRIPT["Refused"]:
                        continue
                    if suffix != ".inp":
                        self.assertEqual(len(mesh.get_cells_type("quad")), n)
                        self.assertGreater(size, len(text) / 2)

    def test_memory(self):
        """A count beyond all measure takes no memory."""
        with tempfile.TemporaryDirectory() as work:
            file = Path(work) / "mesh.vtk"
            size = "99999999999999"
            file.write_text(re.sub(r"(CELLS 20) \d+", rf"\1 {size}", self.text(".vtk")))
            result = subprocess.run(
                [SOURCE / "contrib" / "convert_mesh", file], capture_output=True, text=True
            )
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"^\S+mesh.vtk: cannot be read as vtk: [^\n]*\n$")
        self.assertEqual(result.stdout, "")

    def test_python_without_meshio(self):
        with tempfile.TemporaryDirectory() as work:
            (Path(work) / "meshio.py").write_text("import no_such_module\n")
            file = MESHES / "two_materials.vtk"
            overrides = {"Geometry/File": file, "Geometry/Boundary ids": IDS[2]}
            environment = {**os.environ, "PYTHONPATH": work}
            (Path(work) / "overrides.prm").write_text(as_prm(overrides))
            result = subprocess.run(
                [PROGRAM, "--check", scene_file("slab"), f"{work}/overrides.prm"],
                env=environment,
                capture_output=True,
                text=True,
            )
        self.assertEqual(result.returncode, 1)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
        self.assertIn(f"The mesh file '{file}' cannot be converted", result.stderr)
        self.assertIn("run contrib/convert_mesh", result.stderr)


class Refused(TestCase):
    """Files that are no meshes: exit code 1 and one sentence."""

    def refused(self, text, suffix, *names, ranks=1, dimension=2):
        with tempfile.TemporaryDirectory() as work:
            file = Path(work) / f"mesh{suffix}"
            file.write_bytes(text if isinstance(text, bytes) else text.encode())
            overrides = {
                "Geometry/File": file,
                "Geometry/Boundary ids": IDS[2],
                "Time/Phases": "1: 1",
            }
            result = run("slab", overrides, check=False, ranks=ranks)
        self.assertEqual(result.returncode, 1, result.stderr)
        ours = [line for line in result.stderr.splitlines() if str(file) in line]
        self.assertEqual(len(ours), 1, f"not one sentence: {result.stderr}")
        if ranks == 1:
            self.assertEqual(len(result.stderr.strip().splitlines()), 1)
        for name in names:
            self.assertRegex(ours[0], f"(?is){name}")
        self.assertFalse(result.directory.exists(), "something was written")

    def test_files_that_are_no_meshes(self):
        good = {s: (MESHES / f"two_materials{s}").read_text() for s in FORMATS}
        msh = good["_2.msh"]
        for ranks in 1, 2:
            with self.subTest(ranks=ranks):
                self.refused(" \n", ".msh", "is empty", ranks=ranks)
                noise = random.Random(1).randbytes(3000)
                self.refused(noise, ".msh", "line 1: expected .MeshFormat", ranks=ranks)
                # truncated within a section: nothing to wait for
                cut = msh[: msh.index("$EndNodes")]
                self.refused(cut, ".msh", "the file ends where", ranks=ranks)
                self.refused(
                    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n",
                    ".msh",
                    "the file ends where .EndPhysicalNames should be",
                    ranks=ranks,
                )
        self.refused("# a comment", ".ucd", "as ucd: meshio refuses it")
        self.refused(
            good[".vtk"].replace("4 0 3 4 1", "4 0 3 4000000 1"), ".vtk", "no node 4000000"
        )
        triangle = "3 1 0 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n1 0 tri 1 2 3\n"
        self.refused(triangle, ".inp", "line 12: .* triangle", ranks=2)
        # copies of itself, which double with each
        loop = "*ELSET, ELSET=B\n1\n" + 8 * ("B" + 30 * ",B" + "\n")
        self.refused(good[".inp"] + loop, ".inp", "the set 'B' contains itself")
        solid = (MESHES / "two_materials_3d_4.msh").read_text()
        self.refused(solid, ".msh", "hexahedra, and 'Dimension' is 2")

    def test_generators_without_measure(self):
        for generator, arguments in {
            "hyper_cross": "-1, 0, 0, 0 : true",
            "hyper_shell": "0, 0 : 0.5 : 1 : -8 : true",
            "subdivided_hyper_cube": "100000 : 0 : 1 : true",
        }.items():
            with self.subTest(generator):
                entries = {
                    "Geometry/Generator": generator,
                    "Geometry/Arguments": arguments,
                }
                result = run("slab", entries, check=False)
                self.assertEqual(result.returncode, 1)
                self.assertEqual(len(result.stderr.strip().splitlines()), 1)
                self.assertIn(f"{arguments} asks for", result.stderr)

    def test_no_file(self):
        for name in "/nowhere/mesh.msh", str(MESHES):
            result = run("slab", {"Geometry/File": name}, check=False)
            self.assertEqual(result.returncode, 1)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1)
            self.assertIn(name, result.stderr)


if __name__ == "__main__":
    main()
