# SPDX-License-Identifier: LGPL-2.1-or-later
"""One rank and several (two to four) give the same active sets and the same numbers.

Every scene of prm/ is here, shortened. One rank has the direct solver wherever
`automatic' chooses it, several have multigrid. A scene that is added to prm/ and
not to SCENES or ELSEWHERE fails test_no_scene_is_missing.

The contact tolerance of all runs is at most 1e-10 of the energy norm. Forces and
displacements then agree to some 1e-8, and stresses of single cells and the
fields, which VTU keeps in single precision, to some 1e-7.
"""

import dataclasses
import re
import sys

from harness import SOURCE, TestCase, main, run, scene_file
from runs import Job, on_boundary
from rank_comparison import compare

# Three have a neighbor on either side, four meet at a point. Where a scene has nothing
# beyond others but what acts at a point, two suffice: on two cores they take a third of
# the time of three.
TWO, THREE, FOUR, RANKS = (1, 2), (1, 3), (1, 4), (1, 3, 4)
AGREE = 1e-7  # of the largest value of a column
AGREE_IN_FIELDS = 1e-6  # of the largest value of a field

MANUFACTURED = SOURCE / "prm" / "verification" / "manufactured"


def cells(*numbers, to, colorize="true"):
    """Arguments of subdivided_hyper_rectangle from the origin."""
    origin = ", ".join("0" for _ in numbers)
    numbers = ", ".join(map(str, numbers))
    return {"Geometry/Arguments": f"{numbers} : {origin} : {to} : {colorize}"}


def phases(text):
    return {"Time/Phases": text}


def refined(n):
    return {"Geometry/Global refinements": n}


@dataclasses.dataclass(frozen=True)
class Scene:
    """How to shorten a scene, and what is known of it."""

    changes: dict = dataclasses.field(default_factory=dict)
    ranks: tuple = TWO
    law: str = ""  # the file is a material to go after the scene tresca_2d
    ties: bool = False  # the whole face reaches its bound at once


# By group, each a test of its own for CTest; names are files in prm/.
SCENES = {
    "plane": {
        # more than the 2000 unknowns that multigrid leaves to its coarsest level
        "verification/slab": Scene(
            {**cells(48, 24, to="2, 1"), **phases("1: 3, 2: 3")},
            ranks=THREE,
        ),
        "verification/conveyor_2d": Scene(phases("1: 3, 2: 3"), ranks=THREE),
        "verification/coulomb_block_2d": Scene(phases("1: 1, 2: 2, 4: 4")),
        "verification/half_clamped_block": Scene(refined(1)),
        "verification/junction_2d": Scene(refined(1)),
        "verification/kinked_load_2d": Scene(refined(1)),
        "verification/passenger_2d": Scene(ranks=THREE),
        "verification/elastic_frictionless": Scene(),
        "verification/springs_beam_2d": Scene(refined(0)),
        "verification/springs_block_2d": Scene(refined(1)),
        # loads that do not cancel
        "verification/springs_strip_2d": Scene({"Boundary 3/Pressure": "t*x"}),
        "verification/two_blocks_2d": Scene(
            {"Boundary 23/Pressure": "0.01*t*x"}, ranks=THREE
        ),
        "verification/shrink_fit_2d": Scene(
            {"Boundary 21/Role": "traction", "Boundary 21/Pressure": "1e-4*t*x"},
            ranks=THREE,
        ),
    },
    "corners": {
        "verification/corner_coulomb_90_2d": Scene(ranks=FOUR),
        "verification/corner_singularity_2d": Scene(phases("1: 4"), ranks=FOUR),
        "verification/corner_tresca_150_2d": Scene(),
        "verification/corner_tresca_90_3d": Scene(ranks=FOUR),
        **{
            f"verification/shear_layer_{name}": Scene(phases("1: 7"))
            for name in ("2d", "3d")
        },
        **{
            # A step ends when slip begins: which points stick then also decides
            # whether an estimate is made anew.
            f"verification/shear_layer_rotated_{name}": Scene(
                {**phases("1: 6"), "Error control/Error bar": "false"}, ties=True
            )
            for name in ("2d", "3d")
        },
    },
    "space": {
        "verification/pad": Scene({**cells(9, 9, 9, to="1, 1, 1"), **phases("1.5: 3")}),
        "verification/conveyor_3d": Scene(phases("1.5: 8"), ranks=FOUR),
        "verification/coulomb_block_3d": Scene(phases("1: 1, 3: 5")),
        "verification/coulomb_pad_3d": Scene(phases("0.5: 2, 1.5: 4"), ranks=THREE),
        "verification/springs_block_3d": Scene(),
        "verification/two_blocks_3d": Scene(
            {"Boundary 25/Pressure": "0.01*t*x"}, ranks=FOUR
        ),
    },
    "adaptive": {
        "verification/slab_adaptive": Scene(phases("1: 6, 2: 6"), ranks=THREE),
        "verification/pad_adaptive": Scene(
            {**phases("1.5: 6"), "Mesh refinement/Cell budget": 400},
            ranks=FOUR,
        ),
    },
    "opening": {
        "verification/hertz_2d": Scene(refined(3), ranks=THREE),
        "verification/hertz_disc_2d": Scene(refined(4)),
        "verification/hertz_3d": Scene(
            {**phases("1: 2"), "Mesh refinement/Cell budget": 1200},
            ranks=THREE,
        ),
        "verification/hertz_ball_3d": Scene(
            {**refined(2), "Geometry/Boundary refinements": ""},
            ranks=THREE,
        ),
        "verification/indentation_3d": Scene({**refined(0), **phases("0.1: 1, 2: 3")}),
        "verification/lifted_beam_2d": Scene(phases("1: 2")),
        "verification/hot_pipe": Scene(phases("1: 2, 500: 4")),
        # Unloaded, nothing decides who sticks.
        "verification/round_sample": Scene(phases("241: 2")),
        "verification/partial_slip_2d": Scene(
            {**refined(2), **phases("1: 1, 3: 2"), "Solver/Coulomb tolerance": 1e-10}
        ),
        "verification/flat_punch_2d": Scene(
            {**phases("1: 3"), "Mesh refinement/Cell budget": 400},
            ranks=THREE,
        ),
        "verification/rubbing_2d": Scene(phases("1: 4, 1.5: 2")),
        "verification/soft_ground_3d": Scene(phases("1: 2"), ranks=THREE),
        # exact, so that errors are rounding
        "verification/tilted_plane_2d": Scene(
            {**refined(2), "Exact solution/Displacement": ""}
        ),
    },
    "literature": {
        "verification/literature/greco_plate": Scene(cells(16, 16, to="0.04, 0.04")),
        # a cone
        "verification/literature/indenter": Scene(
            {
                "Geometry/Global refinements": 1,
                "Geometry/Boundary ids": "if(id == 2 && x < 2, 4, id)",
                **on_boundary(4, Gap="0.04/pi*x", Foundation_displacement="-0.02*t"),
            }
        ),
        # with the jump
        "verification/literature/leaning_bar": Scene(phases("1: 1, 2: 2, 3: 12")),
        "verification/literature/punch_with_friction": Scene(
            {"Geometry/Boundary refinements": "4: 3"}
        ),
        "verification/literature/contact_patch": Scene(
            {"Boundary 23/Pressure": "0.01*t*x"}
        ),
        "verification/literature/roller_on_block": Scene(
            {
                "Geometry/Arguments": "16, 16 : 0, -1 : 1, 0 : true | "
                "20, 20 : 0, 1 : 1, 2 : true"
            }
        ),
        "verification/literature/salt_cavity": Scene(phases("5: 2, 40: 4")),
        "verification/literature/slip_zone": Scene(
            {"Geometry/Boundary refinements": "4: 2"}
        ),
        "verification/literature/slab_on_bed": Scene(cells(40, 2, to="10, 0.25")),
        "verification/literature/thick_cylinder_creep": Scene(
            {**refined(2), **phases("1: 4, 2: 2")}
        ),
    },
    "laws": {
        "verification/cantilever_creep": Scene(phases("2.6: 10")),
        "verification/layers": Scene(),
        "verification/excavated_column": Scene(),
        # forces that are not zero
        "verification/crowned_floor_2d": Scene(
            {
                **phases("2: 4"),
                "Loads/Axial force": "0.1*t",
                **on_boundary(1, Role="traction", Pressure="t"),
            }
        ),
        "verification/uniform_strain": Scene(),
        "verification/perzyna_compression_2d": Scene(phases("1: 20, 4: 20")),
        "verification/perzyna_compression_3d": Scene(phases("1: 20, 4: 20")),
    },
    "manufactured": {
        "verification/manufactured/tresca_2d": Scene(),
        "verification/manufactured/coulomb_2d": Scene(),
        "verification/manufactured/tresca_3d": Scene(phases("1: 4")),
        "verification/manufactured/coulomb_3d": Scene(phases("1: 3")),
        **{
            # steps below the stability limit of all of them
            f"verification/manufactured/law_{law}": Scene(phases("0.5: 8"), law=law)
            for law in (
                "elastic", "norton", "parsed", "perzyna", "perzyna_hardening", "zener"
            )
        },
    },
    "demos": {
        "demos/brake_pad_3d": Scene(
            {**cells(12, 6, 3, to="0.1, 0.05, 0.012"), **phases("0.1: 2, 1: 4")}
        ),
        "demos/brake_pad_pressed_3d": Scene({**refined(0), **phases("0.1: 2, 1: 4")}),
        "demos/ball_creep_2d": Scene(
            {
                "Geometry/Arguments": "16, 16 : 0, -1 : 1, 0 : true"
                " | 8, 8 : 0, 0 : 0.5, 0.5 : true",
                **phases("1: 2, 60: 2, 600: 4"),
            }
        ),
        "demos/hot_shrink_fit_2d": Scene(
            {
                "Geometry/Arguments": "6, 8 : 0, 0 : 100, 160 : true"
                " | 8, 5 : 100, 0 : 250, 80 : true",
                **phases("10: 4, 1000: 4"),
            }
        ),
        "demos/ball_zener_3d": Scene(
            {
                "Geometry/Arguments": "6, 4, 2 : -12, 0, -12 : 24, 12, 0 : true",
                **phases("0.02: 1, 0.3: 2, 0.5: 3, 0.52: 1, 1.5: 6"),
            }
        ),
        "demos/brake_pad_disc_3d": Scene(
            {
                "Geometry/Arguments": "7, 4, 1 : -0.02, -0.01, -0.007 : 0.12, 0.06, 0"
                " : true | 6, 6, 3 : 0, 0, 0 : 0.1, 0.05, 0.018 : true",
                **phases("0.1: 1, 1: 3"),
            }
        ),
        "demos/seal_in_housing_2d": Scene({**phases("1: 1, 2: 1, 3: 2, 4: 2")}),
        "demos/lap_joint_2d": Scene({**refined(0), **phases("1: 1, 2: 1, 4: 2, 6: 2")}),
        "demos/rod_seal_2d": Scene(
            {
                "Geometry/File": SOURCE / "prm" / "demos" / "rod_seal_2d.msh",
                **refined(0),
                **phases("1: 3, 2.5: 3, 3.5: 2, 5: 2"),
            }
        ),
        "demos/salt_cavern_2d": Scene(
            {
                "Table 1/File": SOURCE / "prm" / "demos" / "salt_cavern_2d.csv",
                "Geometry/Arguments": "14, 10 : 0, 0 : 1, 1 : true",
                **phases("1: 3, 10: 5"),
            }
        ),
        "demos/salt_drift_2d": Scene(
            {
                "Geometry/File": SOURCE / "prm" / "demos" / "salt_drift_2d.msh",
                **refined(0),
                **phases("20: 4, 60: 4"),
            }
        ),
        "demos/salt_joint_2d": Scene(
            {
                "Geometry/Arguments": "8, 8 : -1, 0 : 1, 4 : true",
                # times of events are found to a tolerance
                "Step control/Tolerance": 0,
                **phases("20: 2, 40: 8, 100: 10"),
            }
        ),
        "demos/salt_pillar_2d": Scene(
            {**cells(16, 8, to="6, 3"), **phases("8.64e5: 8")}
        ),
        "demos/salt_pillar_rock_2d": Scene(
            {
                "Geometry/Arguments": "16, 8 : 0, 0 : 6, 3 : true | "
                "16, 16 : 0, 3 : 12, 15 : true",
                **phases("8.64e5: 3"),
            }
        ),
        "demos/sheared_slab_2d": Scene(
            {**cells(24, 4, to="0.12, 0.02"), **phases("180: 8")}
        ),
        "demos/tread_block_3d": Scene(
            {
                **cells(6, 4, 2, to="0.03, 0.02, 0.008"),
                **phases("1e-3: 1, 4e-3: 2, 7e-3: 2, 1.1e-2: 2"),
            }
        ),
        "demos/tunnel_lining_2d": Scene(refined(1)),
    },
}

# Folders and scenes of prm/ that are judged elsewhere.
ELSEWHERE = {
    "verification/hard": "the suite of hard cases (tests/hard) judges them",
    "verification/supports_block_3d": "its forces are rounding, for test_supports",
}


def several(name, scene):
    """Runs of a scene on each of its numbers of ranks."""
    changes = {
        "Output/Fields every": 1,
        "Output/Fields interval": 0,
        "Solver/Contact tolerance": 1e-10,
        **scene.changes,
    }
    text = scene_file(name.partition("/")[2]).read_text()
    if scene.law:
        base = (MANUFACTURED / "tresca_2d.prm").read_text()
        text = base.replace("set Law             = maxwell", "") + text
    return [run(name, changes, ranks=n, text=text) for n in scene.ranks]


class SameOnAllRanks(TestCase):
    def check(self, name, scene, identities=False):
        ranks = scene.ranks
        runs = several(name, scene)
        alone = runs[0]
        if identities:
            for one in runs:
                self.check_identities(one)
        for n, other in zip(ranks[1:], runs[1:]):
            self.assertEqual(int(other.info["n_mpi_ranks"]), n)
            found = compare(alone, other)
            what = f"{name} on {ranks[0]} and {n} ranks"
            self.assertEqual(found.unlike, [], what)
            self.assertEqual(found.flips, [], f"active sets of {what}")
            if not scene.ties:
                self.assertEqual(found.n_ties, 0, f"ties of {what}")
            if "friction_dissipation" in alone.statistics:
                self.assertGreater(found.n_points, 0, what)
            for kind, bound in ("columns", AGREE), ("fields", AGREE_IN_FIELDS):
                largest, where = found.worst(kind)
                self.assertLessEqual(largest, bound, f"{where} of {what}")
            print(
                f"{what}: {found.n_points} points, {found.n_ties} ties,",
                "columns %.1e (%s)," % found.worst("columns"),
                "fields %.1e (%s)" % found.worst("fields"),
                file=sys.stderr,
            )

    def check_group(self, group, **options):
        for name, scene in SCENES[group].items():
            with self.subTest(name):
                self.check(name, scene, **options)


class Scenes(SameOnAllRanks):
    def test_no_scene_is_missing(self):
        here = {name for group in SCENES.values() for name in group}
        folder = SOURCE / "prm"
        files = {
            name
            for path in folder.rglob("*.prm")
            for name in [str(path.relative_to(folder).with_suffix(""))]
            if not {name, name.rpartition("/")[0]} & set(ELSEWHERE)
        }
        self.assertEqual(files, here)

    def test_plane(self):
        self.check_group("plane")

    def test_corners(self):
        # with 3: test_foundation_on_one_rank
        self.check_group("corners")

    def test_space(self):
        self.check_group("space", identities=True)

    def test_adaptive(self):
        self.check_group("adaptive", identities=True)

    def test_opening(self):
        self.check_group("opening", identities=True)

    def test_literature(self):
        self.check_group("literature")

    def test_laws(self):
        self.check_group("laws")

    def test_manufactured(self):
        self.check_group("manufactured")

    def test_demos(self):
        self.check_group("demos")


# Two cells, and one, of the slab and the pad.
TWO_CELLS = {**cells(2, 1, to="2, 1"), **phases("1: 3, 2: 2")}
ONE_CELL = {**cells(1, 1, 1, to="1, 1, 1"), **phases("1.5: 4")}
EVERYTHING = {
    "Material/Stress history": "quadrature points",
    "Error control/Error bar": "true",
}
GROWING = {
    "Mesh refinement/Strategy": "residual",
    "Mesh refinement/Every n steps": 1,
    "Mesh refinement/Refinement fraction": 0.5,
    "Mesh refinement/Maximal level": 2,
}


class MoreRanksThanCells(SameOnAllRanks):
    """Ranks without cells, without contact faces, and what they take part in."""

    PLANE = "verification/slab", TWO_CELLS, FOUR
    SPACE = "verification/pad", ONE_CELL, THREE

    def check_both(self, changes):
        for name, few, ranks in self.PLANE, self.SPACE:
            with self.subTest(name):
                scene = Scene({**few, **EVERYTHING, **changes}, ranks)
                self.check(name, scene, identities=True)

    def test_forward_euler(self):
        self.check_both({})

    def test_backward_euler(self):
        self.check_both({"Time/Scheme": "backward Euler"})

    def test_heun(self):
        self.check_both({"Time/Scheme": "Heun"})

    def test_meshes_that_grow(self):
        self.check_both(GROWING)

    def test_foundation_on_one_rank(self):
        """Two faces of contact at a corner, most ranks without any."""
        self.check("verification/corner_tresca_150_2d", Scene(refined(1), RANKS))

    def test_checkpoints_go_to_other_ranks(self):
        for name, few, (_, most) in self.PLANE, self.SPACE:
            name = name.partition("/")[2]
            changes = {
                **few,
                **EVERYTHING,
                **GROWING,
                "Output/Fields every": 1,
                "Checkpoint/Every n steps": 1,
                "Checkpoint/Keep": 1000,
                "Solver/Contact tolerance": 1e-10,
            }
            for before, after in (most, 1), (1, most):
                with self.subTest(name, before=before, after=after):
                    with Job(name, changes) as whole:
                        expected = whole.run(ranks=before)
                        with Job(name, changes, copy_of=whole) as job:
                            job.forget_after(2)
                            resumed = job.run("--restart", ranks=after)
                            found = compare(expected, resumed)
                            self.assertEqual(found.unlike + found.flips, [])
                            self.assertLessEqual(found.worst("columns")[0], AGREE)
                            self.assertLessEqual(
                                found.worst("fields")[0], AGREE_IN_FIELDS
                            )

    def test_check(self):
        """--check says the same on all ranks, but how many there are."""
        for name, few, (_, most) in self.PLANE, self.SPACE:
            with Job(name.partition("/")[2], few) as job:
                said = [job.run("--check", ranks=n).stdout for n in (1, most)]
                cells = [re.search(r"(\d+) cells?", text) for text in said]
                self.assertTrue(all(cells), said)
                self.assertEqual(cells[0][1], cells[1][1])

    def test_pilots_of_a_price(self):
        """They begin with two cells of a scene whose solution is known."""
        few = {**cells(2, 1, to="1, 1"), **refined(0), **phases("1: 2")}
        self.check("verification/manufactured/tresca_2d", Scene(few, FOUR))


if __name__ == "__main__":
    main()
