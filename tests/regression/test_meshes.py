# SPDX-License-Identifier: LGPL-2.1-or-later
"""Meshes from files: a scene gives the same results as with the generator,
whatever the format, and no file makes the program crash or hang."""

import random
import runpy
import shutil
import subprocess
import tempfile
from pathlib import Path

from harness import EXECUTABLE, SOURCE, TestCase, as_prm, main, run, scene_file

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

    def test_shear_layer_in_3d(self):
        boundaries = """
            subsection Boundary 0
              set Role = free
            end
            subsection Boundary 1
              set Role = free
            end
            subsection Boundary 2
              set Role           = contact
              set Friction law   = tresca
              set Friction bound = 0.02
            end
            subsection Boundary 3
              set Role         = displacement
              set Displacement = 0.1*t; -0.01*t; 0
            end
            subsection Boundary 4
              set Role = free
            end
            subsection Boundary 5
              set Role = free
            end
        """
        text = "set Dimension = 3\n" + boundaries
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
                [EXECUTABLE, "scene/slab.prm", "scene/overrides.prm"],
                cwd=work,
                check=True,
                capture_output=True,
            )
            self.assertTrue((Path(work) / "results" / "statistics.csv").exists())


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
        self.refused("# a comment", ".ucd", "the file ends where")
        self.refused(
            good[".vtk"].replace("4 0 3 4 1", "4 0 3 4000000 1"), ".vtk", "no node 4000000"
        )
        triangle = "3 1 0 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n1 0 tri 1 2 3\n"
        self.refused(triangle, ".inp", "line 5: .* triangle", ranks=2)
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
