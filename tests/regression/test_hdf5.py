# SPDX-License-Identifier: LGPL-2.1-or-later
"""Fields of the body in HDF5 (`Output/Fields in HDF5'): those of VTU, to the bit.

Read by VTK's reader of XDMF, which is ParaView's; skipped (exit code 77) without it.
"""

import importlib.util
import sys
from pathlib import Path

import numpy as np

from harness import SOURCE, TestCase, main, run, without_unit
from runs import EVERY_STEP, Job

sys.path.insert(0, str(SOURCE / "contrib" / "python"))

from viscoplastic_contact.results import Record, Results
from viscoplastic_contact.tables import UserError

IN_HDF5 = {"Output/Fields in HDF5": "true"}
SLAB = {
    "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
    "Time/Phases": "1: 4, 2: 4",
    "Output/Fields every": 2,
}
HAS_H5PY = importlib.util.find_spec("h5py") is not None


def outputs(directory):
    """(time, {name: values at the vertices of each cell}) in solution.xdmf."""
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    reader = vtk.vtkXdmfReader()
    reader.SetFileName(str(directory / "solution.xdmf"))
    reader.UpdateInformation()
    key = vtk.vtkStreamingDemandDrivenPipeline.TIME_STEPS()
    result = []
    for time in reader.GetOutputInformation(0).Get(key):
        reader.UpdateTimeStep(time)
        grid = reader.GetOutputDataObject(0)
        cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
        width = cells.size // grid.GetNumberOfCells()
        data = {"points": vtk_to_numpy(grid.GetPoints().GetData())[cells]}
        for is_nodal, arrays in (True, grid.GetPointData()), (False, grid.GetCellData()):
            for array in map(arrays.GetArray, range(arrays.GetNumberOfArrays())):
                values = vtk_to_numpy(array)
                data[array.GetName()] = values[cells] if is_nodal else values.repeat(width)
        result.append((time, data))
    return result


def of_record(record):
    """The same of one time as contrib/python reads it."""
    order = record.cells.ravel()
    values = {name: values[order] for name, values in record.data.items()}
    return {"points": record.points[order], **values}


def files(directory, pattern):
    return sorted(path.name for path in directory.glob(pattern))


def meshes(names):
    return [name for name in names if name.startswith("mesh_")]


class SameAsVtu(TestCase):
    def assertSame(self, scene, overrides, ranks=1):
        """The names of the files in HDF5, and what is in them."""
        runs = [run(scene, {**overrides, **more}, ranks) for more in ({}, IN_HDF5)]
        vtu, hdf5 = (each.directory for each in runs)
        expected, found = Results(vtu), outputs(hdf5)
        self.assertEqual([t for t, _ in found], [t for t, _ in expected.solution])
        for index, (time, data) in enumerate(found):
            data = {without_unit(name): values for name, values in data.items()}
            both = [data]
            if HAS_H5PY:
                both.append(of_record(Results(hdf5).body(index)))
            values = of_record(Record(expected.solution[index][1]))
            for other in both:
                self.assertEqual(other.keys(), values.keys())
                for name, array in values.items():
                    what = f"{scene} on {ranks} ranks at {time}: {name}"
                    np.testing.assert_array_equal(array.squeeze(), other[name], what)
        self.assertEqual(files(hdf5, "solution_*.*vtu"), [])
        self.assertEqual(files(hdf5, "*.part"), [])
        for name in "contact", "boundary":
            self.assertEqual(files(hdf5, f"{name}*"), files(vtu, f"{name}*"))
        if HAS_H5PY:
            self.assertEqual(Results(hdf5).index(step=1), 1)
        else:
            with self.assertRaisesRegex(UserError, "has no h5py"):
                Results(hdf5).body()
        return sorted(path.name for path in hdf5.iterdir()), found

    def test_mesh_that_stays(self):
        """Units are in the names, and not in those of data sets."""
        units = {"Units/Length": "m", "Units/Time": "day", "Units/Stress": "MPa"}
        for ranks in 1, 3:
            names, found = self.assertSame("slab", {**SLAB, **units}, ranks)
            self.assertEqual(meshes(names), ["mesh_00000.h5"])
            self.assertLessEqual({"velocity [m/day]", "subdomain"}, found[0][1].keys())

    def test_in_space_with_hanging_nodes(self):
        for ranks in 1, 2:
            names, found = self.assertSame(
                "pad_adaptive", {"Time/Phases": "1.5: 6"}, ranks
            )
            self.assertEqual(meshes(names)[0], "mesh_00000.h5")
            sizes = {len(data["points"]) for _, data in found}
            self.assertGreater(len(sizes), 1)
            self.assertGreaterEqual(len(meshes(names)), len(sizes))

    def test_material_that_goes(self):
        names, found = self.assertSame("excavated_column", {}, 2)
        self.assertEqual(len(meshes(names)), 2)
        self.assertGreater(len(found[0][1]["points"]), len(found[-1][1]["points"]))

    def test_two_bodies(self):
        names, _ = self.assertSame("two_blocks_2d", {})
        self.assertEqual(meshes(names), ["mesh_00000.h5"])
        self.assertIn("opposite_00000.0.vtu", names)


class Interrupted(TestCase):
    def test_restart(self):
        """What came after the checkpoint is gone from the list, and comes again."""
        with Job("slab", {**SLAB, **IN_HDF5, **EVERY_STEP}) as reference:
            reference.run()
            with Job("slab", reference.overrides, reference) as job:
                job.forget_after(5)
                # One that the run after the checkpoint will not write.
                for ending in "xml", "h5":
                    old = job.results / f"solution_00004.{ending}"
                    (job.results / f"solution_00005.{ending}").write_bytes(old.read_bytes())
                job.run("--restart")
                pairs = list(zip(outputs(job.results), outputs(reference.results)))
                self.assertEqual(len(pairs), 5)
                for (t, data), (expected_t, expected) in pairs:
                    self.assertEqual(t, expected_t)
                    for name in expected:
                        np.testing.assert_array_equal(data[name], expected[name])
                for name in files(reference.results, "solution_*.h5"):
                    first, again = (
                        (place.results / name).read_bytes() for place in (reference, job)
                    )
                    self.assertEqual(first, again, name)
                # It writes the mesh again.
                self.assertEqual(
                    files(job.results, "mesh_*"), ["mesh_00000.h5", "mesh_00003.h5"]
                )
                self.assertEqual(files(job.results, "solution_00005*"), [])
                job.forget_after(5)
                del job.overrides["Output/Fields in HDF5"]
                refused = job.run("--restart", code=1)
                self.assertIn("Output/Fields in HDF5", refused.stderr)

    def test_nothing_is_left_of_the_other_format(self):
        with Job("slab", SLAB) as job:
            job.run(ranks=2)
            job.overrides.update(IN_HDF5)
            job.run()
            in_hdf5 = files(job.results, "[ms]*_0*") + files(job.results, "solution.*")
            self.assertEqual(
                in_hdf5,
                ["mesh_00000.h5"]
                + [f"solution_0000{n}.{e}" for n in range(5) for e in ("h5", "xml")]
                + ["solution.xdmf"],
            )
            job.overrides["Output/Fields in HDF5"] = "false"
            job.run()
            self.assertEqual(files(job.results, "*.h5"), [])
            self.assertEqual(files(job.results, "solution*x*ml*"), [])
            self.assertEqual(len(files(job.results, "solution*vtu")), 10)

    def test_files_that_cannot_be_written(self):
        for ranks in 1, 2:
            with Job("slab", {**SLAB, **IN_HDF5}) as job:
                job.results.mkdir()
                (job.results / "solution_00001.h5").symlink_to("/dev/full")
                process = job.run(code=1, ranks=ranks)
                self.assertRegex(process.stderr, "solution_00001.h5.*symbolic link")


if __name__ == "__main__":
    if importlib.util.find_spec("vtk") is None:
        print("Skipped: no VTK for Python (Debian: python3-paraview)")
        sys.exit(77)
    main()
