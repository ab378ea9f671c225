# SPDX-License-Identifier: LGPL-2.1-or-later
"""One, two and three MPI ranks give the same results.

Ranks change the order of sums and, through `automatic`, the linear solver;
both are below the contact tolerance 1e-10 of the scenes, in which forces and
displacements agree to some 1e-8.  Steps where a tie is decided by rounding are
not among the scenes.
"""

import unittest

import numpy as np

from harness import DEFECTS, EFFORT, TestCase, lattice, main, run

AGREE = 1e-7


class Ranks(TestCase):
    def compare(self, scene, overrides=None, ranks=(2, 3)):
        alone = run(scene, overrides)
        self.check_identities(alone)
        for n in ranks:
            several = run(scene, overrides, ranks=n)
            self.assertEqual(list(several.statistics), list(alone.statistics))
            self.assertEqual(int(several.info["n_mpi_ranks"]), n)
            self.check_identities(several)
            for name, column in alone.statistics.items():
                if name in EFFORT | DEFECTS or name.startswith("wall_"):
                    continue
                # a component that vanishes has only its vector as a scale
                scale = abs(column).max()
                if name[-2:] in ("_x", "_y", "_z"):
                    scale = abs(alone.vector(name[:-2])).max()
                self.assertClose(
                    several[name],
                    column,
                    # forces that cancel have rounding as their size
                    absolute=AGREE * scale + 1e-14,
                    what=f"{scene}, {n} ranks, {name}",
                )
            self.compare_fields(alone.fields(), several.fields())
            if "friction_force_x" in alone.statistics:
                self.compare_fields(alone.fields("contact"), several.fields("contact"))

    def compare_fields(self, one, many):
        """Point data at equal points, cell data at equal cells."""

        def key(points):
            return np.lexsort(lattice(points).T)

        def unique(fields):
            nodes = fields.nodes()
            return nodes[key(fields.points[nodes])]

        a, b = unique(one), unique(many)
        self.assertEqual(len(a), len(b))
        for name, values in one.point_data.items():
            scale = abs(values).max()
            # single precision in VTU
            self.assertClose(
                many.point_data[name][b],
                values[a],
                absolute=1e-6 * scale + 1e-12,
                what=name,
            )
        centre = lambda fields: fields.points[fields.cells].mean(axis=1)
        a, b = key(centre(one)), key(centre(many))
        for name, values in one.cell_data.items():
            if name == "subdomain":
                continue
            self.assertClose(
                many.cell_data[name][b],
                values[a],
                absolute=1e-6 * abs(values).max() + 1e-12,
                what=name,
            )

    def test_slab(self):
        self.compare("slab")

    def test_slab_adaptive(self):
        self.compare("slab_adaptive", {"Time/Phases": "1: 8, 2: 8"})

    def test_pad(self):
        self.compare(
            "pad",
            {
                "Geometry/Arguments": "6, 6, 6 : 0, 0, 0 : 1, 1, 1 : true",
                "Time/Phases": "1.5: 10",
            },
        )

    def test_pad_adaptive(self):
        self.compare("pad_adaptive", {"Time/Phases": "1.5: 10"})

    def test_cantilever_with_quadrature_points(self):
        self.compare(
            "cantilever_creep",
            {"Time/Phases": "2.6: 10", "Solver/Contact tolerance": 1e-10},
        )

    def test_more_ranks_than_contact_faces(self):
        """A foundation of two faces, most ranks without any."""
        self.compare("corner_tresca_150_2d", {"Geometry/Global refinements": 1})

    def test_ranks_without_cells(self):
        """Two cells on three ranks, with an irreversible stress."""
        self.compare("slab", {"Geometry/Arguments": "2, 1 : 0, 0 : 2, 1 : true",
                              "Time/Phases": "1: 4"})

    def test_corner_across_ranks(self):
        self.compare("corner_coulomb_90_2d")

    def test_edge_across_ranks(self):
        self.compare("corner_tresca_90_3d")


if __name__ == "__main__":
    main()
