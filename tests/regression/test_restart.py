# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs that are interrupted and go on give the results of runs that are not.

On the same number of ranks that is meant bit by bit: every number of
statistics.csv but the wall times, and every VTU file but the date in it.

RESTART_KILLS sets how many instants the kill test tries, and
RESTART_MUTATIONS how many damaged checkpoints; both are small by default.
"""

import contextlib
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path
from unittest import mock

import numpy as np

from harness import DEFECTS, EFFORT, EXECUTABLE, PROGRAM, TestCase, main
from runs import EVERY_STEP, Job, on_boundary, without_wall_times

N_KILLS = int(os.environ.get("RESTART_KILLS", 4))
N_MUTATIONS = int(os.environ.get("RESTART_MUTATIONS", 12))

SLAB = {
    "Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true",
    "Time/Phases": "1: 8, 2: 8",
    "Output/Fields every": 3,
}


class Process:
    """What Linux says of a process."""

    def __init__(self, pid):
        # after its name, which may contain anything
        _, parent, _, session, *_ = (
            Path("/proc", str(pid), "stat").read_text().rpartition(")")[2].split()
        )
        self.parent, self.session = int(parent), int(session)


def processes(condition):
    """The numbers of the processes that satisfy it."""
    result = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        with contextlib.suppress(OSError):  # it has ended meanwhile
            if condition(Process(pid)):
                result.append(int(pid))
    return result


def without_comments(file):
    """deal.II writes the date into a comment."""
    return re.sub(rb"<!--.*?-->", b"", file.read_bytes(), flags=re.DOTALL)


def series(directory):
    return sorted(
        path.name
        for path in directory.iterdir()
        if path.suffix in (".vtu", ".pvtu", ".pvd")
    )


class RestartCase(TestCase):
    def assertIdentical(self, directory, reference, what=""):
        self.assertEqual(
            without_wall_times(directory / "statistics.csv"),
            without_wall_times(reference / "statistics.csv"),
            f"{what}: statistics.csv",
        )
        self.assertEqual(series(directory), series(reference), what)
        for name in series(reference):
            self.assertEqual(
                without_comments(directory / name),
                without_comments(reference / name),
                f"{what}: {name}",
            )

    def assertOneSentence(self, message, *names):
        for name in names:
            self.assertRegex(message, f"(?is){name}")
        lines = [line for line in message.splitlines() if line.strip()]
        self.assertEqual(len(lines), 1, f"not one sentence: {message}")
        self.assertNotIn("Stacktrace", message)


class Identical(RestartCase):
    """From a checkpoint in the middle to the end, on the same ranks."""

    def check(self, scene, overrides, after, ranks=1):
        with Job(scene, {**overrides, **EVERY_STEP}) as reference:
            reference.run(ranks=ranks)
            for n in after:
                with Job(scene, reference.overrides, reference) as job:
                    job.forget_after(n)
                    job.run("--restart", ranks=ranks)
                    self.assertIdentical(
                        job.results, reference.results, f"{scene} after {n}"
                    )

    def test_slab(self):
        self.check("slab", SLAB, (1, 7, 12))

    def test_slab_with_multigrid(self):
        """The hierarchy is that of an earlier stick set, and must be again."""
        self.check("slab", {**SLAB, "Solver/Linear solver": "multigrid"}, (1, 7, 12))

    def test_slab_two_ranks(self):
        self.check("slab", SLAB, (7,), ranks=2)

    def test_pad_with_multigrid(self):
        """In 3D the hierarchy knows the springs of slipping points, too."""
        overrides = {
            "Geometry/Arguments": "6, 6, 6 : 0, 0, 0 : 1, 1, 1 : true",
            "Time/Phases": "1.5: 10",
            "Solver/Linear solver": "multigrid",
        }
        self.check("pad", overrides, (4, 8))

    def test_adaptive_slab(self):
        overrides = {"Time/Phases": "1: 8, 2: 8", "Output/Fields every": 3}
        self.check("slab_adaptive", overrides, (1, 6, 11))

    def test_adaptive_slab_two_ranks(self):
        """With the work of friction, a sum over steps and meshes."""
        overrides = {
            "Time/Phases": "1: 5, 2: 3",
            "Output/Fields every": 3,
            "Output/Additional fields": "friction work, creep strain",
        }
        self.check("slab_adaptive", overrides, (2, 6), ranks=2)

    def test_adaptive_pad(self):
        overrides = {
            "Time/Phases": "1.5: 8",
            "Mesh refinement/Cell budget": 500,
            "Output/Additional fields": "friction work",
        }
        self.check("pad_adaptive", overrides, (1, 4))

    def test_adaptive_pad_two_ranks(self):
        overrides = {"Time/Phases": "1.5: 4", "Mesh refinement/Cell budget": 300}
        self.check("pad_adaptive", overrides, (2,), ranks=2)

    def test_adaptive_body_of_revolution(self):
        overrides = {
            "Geometry/Plane model": "axisymmetric",
            "Geometry/Arguments": "16, 8 : 0, 0 : 6, 3 : true",
            "Mesh refinement/Strategy": "residual",
            "Time/Scheme": "backward Euler",
            "Time/Phases": "2.592e6: 8",
        }
        self.check("salt_pillar_2d", overrides, (4,))

    def test_adaptive_curved_pair(self):
        """Normals at nodes, gaps and what lies opposite are made anew."""
        overrides = {
            "Geometry/Global refinements": 1,
            **on_boundary(1, Friction_law="coulomb", Friction_coefficient=0.2),
            **on_boundary(21, Role="traction", Pressure="2e-3*t*x^2"),
            "Material 0/Law": "maxwell",
            "Material 0/maxwell/Viscosity": 3,
            "Time/Phases": "2: 4",
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Every n steps": 1,
        }
        for ranks in 1, 2:
            self.check("shrink_fit_2d", overrides, (2,), ranks)

    def test_adaptive_generalized_plane_strain_two_ranks(self):
        overrides = {
            "Geometry/Plane model": "generalized strain",
            "Loads/Axial force": "-40*t/2.592e6",
            "Geometry/Arguments": "8, 4 : 0, 0 : 6, 3 : true",
            "Mesh refinement/Strategy": "residual",
            "Time/Scheme": "backward Euler",
            "Time/Phases": "2.592e6: 4",
        }
        self.check("salt_pillar_2d", overrides, (2,), ranks=2)

    def test_moving_foundation(self):
        self.check("conveyor_2d", {"Time/Phases": "1: 5, 2: 5"}, (3, 7))

    def test_moving_foundation_adaptive(self):
        overrides = {
            "Time/Phases": "1: 5, 2: 5",
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Maximal level": 2,
        }
        self.check("conveyor_2d", overrides, (4,))

    def test_history_at_quadrature_points(self):
        """With an initial displacement: u0 is part of the state, too."""
        overrides = {"Time/Phases": "2.6: 10", "Output/Fields every": 4}
        self.check("cantilever_creep", overrides, (1, 5))

    def test_history_at_quadrature_points_adaptive_two_ranks(self):
        overrides = {
            "Time/Phases": "2.6: 10",
            "Mesh refinement/Strategy": "residual",
            "Mesh refinement/Maximal level": 2,
        }
        self.check("cantilever_creep", overrides, (5,), ranks=2)

    def test_elastic_body_that_rests(self):
        """A step without change is not solved; the restart knows that."""
        self.check("elastic_frictionless", {}, (2,))

    def test_bodies_that_rest_on_friction(self):
        """From the middle of a time at rest, and from before it."""
        held = {**SLAB, "Boundary 0/Traction": "0.3*min(t, 0.5); 0"}
        for law in "elastic", "perzyna":
            overrides = {
                **held,
                "Material/Law": law,
                "Material/perzyna/Yield radius": 10,
                "Solver/Linear solver": "multigrid",
            }
            self.check("slab", overrides, (3, 6))

    def test_contact_that_opens(self):
        """With Coulomb's law, also where nothing but contact holds the body."""
        pressed = {
            **on_boundary(2, Contact_law="unilateral", Gap="0.002*(x - 1)^2"),
            **on_boundary(2, Friction_law="coulomb", Friction_coefficient=0.3),
        }
        self.check(
            "slab",
            {
                **SLAB,
                **pressed,
                "Boundary 3/Role": "displacement",
                "Boundary 3/Displacement": "0.02*sin(3*t); -0.01*sin(2*t)",
                "Mesh refinement/Strategy": "residual",
                "Mesh refinement/Maximal level": 2,
            },
            (3, 7, 14),
        )
        self.check(
            "slab",
            {
                **SLAB,
                **pressed,
                "Boundary 0/Traction": "0.01*max(0, t - 0.5); 0",
                **on_boundary(3, Role="traction", Traction="0; -0.03*min(2*t, 1)"),
            },
            (2, 9),
        )

    def test_foundation_that_gives_way_two_ranks(self):
        """With friction that depends on the slip rate, on new meshes."""
        overrides = {
            "Boundary 4/Slip rate factor": "0.6 + 0.4*exp(-v/0.01)",
            "Boundary 6/Slip rate factor": "0.6 + 0.4*exp(-v/0.01)",
        }
        self.check("soft_ground_3d", overrides, (1, 3), ranks=2)

    def test_contact_that_opens_in_space_two_ranks(self):
        overrides = {
            "Time/Phases": "1.5: 4",
            **on_boundary(4, Contact_law="unilateral", Gap="0.004*(x^2 + y^2)"),
            **on_boundary(4, Friction_law="coulomb", Friction_coefficient=0.3),
            "Boundary 5/Role": "displacement",
            "Boundary 5/Displacement": "0.02*sin(t); 0.01*t; -0.01*sin(3*t)",
            "Solver/Coulomb pressure": "fixed point",
            "Mesh refinement/Cell budget": 300,
        }
        self.check("pad_adaptive", overrides, (1, 3), ranks=2)

    def test_a_stage_beyond_the_first_end(self):
        """The run ends when the material goes, and is made longer."""
        short, whole = {"Time/Phases": "1: 2"}, {"Time/Phases": "1: 2, 3: 2"}
        with Job("excavated_column", {**whole, **EVERY_STEP}) as reference:
            expected = reference.run()
            with Job("excavated_column", {**short, **EVERY_STEP}) as job:
                job.run()
                job.overrides.update(whole)
                result = job.run("--restart")
                for name in ("point0_y", "stored_energy", "construction_energy"):
                    self.assertEqual(
                        result[name].tolist(), expected[name].tolist(), name
                    )
            # What has been there, or has not, stays so.
            with Job("excavated_column", reference.overrides, reference) as job:
                job.forget_after(3)
                job.overrides["Material 2/Removed at"] = 3
                refusal = job.run("--restart", code=1).stderr
                self.assertRegex(refusal, "other unknowns: 'Material 2/Removed at'")

    def test_stages_of_construction(self):
        """At the end of a stage, before the materials change, and around it."""
        overrides = {
            "Material 1/Law": "maxwell",
            "Material 1/maxwell/Viscosity": 100,
            **on_boundary(2, Role="contact", Friction_law="tresca", Friction_bound=0.3),
            "Mesh refinement/Strategy": "residual",
            "Initial state/Reset displacement": "true",
        }
        self.check("excavated_column", overrides, (1, 2, 3))


class OtherRanks(RestartCase):
    AGREE = 1e-7

    def compare(self, scene, overrides, after, ranks):
        overrides = {**overrides, **EVERY_STEP, "Solver/Contact tolerance": 1e-10}
        with Job(scene, overrides) as reference:
            expected = reference.run(ranks=ranks[0])
            for n in ranks[1:]:
                with Job(scene, overrides, reference) as job:
                    job.forget_after(after)
                    result = job.run("--restart", ranks=n)
                    self.assertRegex(result.stdout, "Note: the checkpoint is from")
                    for name, column in expected.statistics.items():
                        if name in EFFORT | DEFECTS or name.startswith("wall_"):
                            continue
                        scale = abs(column[np.isfinite(column)]).max()
                        if name[-2:] in ("_x", "_y", "_z"):
                            scale = abs(expected.vector(name[:-2])).max()
                        self.assertClose(
                            result[name],
                            column,
                            absolute=self.AGREE * scale + 1e-14,
                            what=f"{scene}, {n} ranks, {name}",
                        )

    def test_slab(self):
        self.compare("slab", SLAB, 6, (1, 3))

    def test_adaptive_slab(self):
        self.compare("slab_adaptive", {"Time/Phases": "1: 6, 2: 6"}, 5, (2, 3))

    def test_adaptive_pad(self):
        overrides = {"Time/Phases": "1.5: 6", "Mesh refinement/Cell budget": 400}
        self.compare("pad_adaptive", overrides, 3, (2, 1))

    def test_pair(self):
        """Nodes of one body are tied to those of the other, on whatever rank."""
        overrides = {"Geometry/Global refinements": 1, "Time/Phases": "2: 4"}
        self.compare("shrink_fit_2d", overrides, 2, (1, 3))

    def test_history_at_quadrature_points(self):
        self.compare("cantilever_creep", {"Time/Phases": "2.6: 10"}, 5, (3, 2))


class JobOnDisk(Job):
    """Whose checkpoints are in part there for as long as a disk takes."""

    place = None


class Killed(RestartCase):
    """kill -9 at random instants, also inside writes."""

    OVERRIDES = {
        "Time/Phases": "1: 8, 2: 8",
        "Output/Fields every": 1,
        "Checkpoint/Every n steps": 1,
    }

    def kill(self, process, instant):
        try:
            process.wait(instant)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGKILL)
        process.communicate()
        return process.returncode == -signal.SIGKILL

    def test_random_instants(self):
        chance = random.Random(20001)
        n_restarted = 0
        with Job("slab_adaptive", self.OVERRIDES) as reference:
            begin = time.time()
            reference.run()
            duration = time.time() - begin
            for i in range(N_KILLS):
                with Job("slab_adaptive", self.OVERRIDES) as job:
                    instant = chance.uniform(0.1, 1) * duration
                    process = job.start()
                    if i % 2 == 1:
                        # not before there is something to go on from, also
                        # where other programs make the start slow
                        while process.poll() is None and not job.steps():
                            time.sleep(0.01)
                        instant *= 0.5
                    self.kill(process, instant)
                    n_restarted += job.steps() != []
                    job.run("--restart=auto")
                    self.assertIdentical(
                        job.results, reference.results, f"kill {i}, {instant} s"
                    )
                    self.assertEqual(len(job.steps()), 2)
        self.assertGreater(n_restarted, 0)

    def test_no_process_is_left(self):
        """Open MPI would start a daemon for a run without mpirun, which goes on
        when the run is killed."""
        singleton = "OMPI_MCA_ess_singleton_isolated"
        with Job("slab", {"Time/Phases": "1: 1000000"}) as job:
            with mock.patch.dict(os.environ):
                os.environ.pop(singleton, None)
                process = job.start(start_new_session=True)
            self.addCleanup(process.communicate)
            self.addCleanup(process.kill)
            process.stdout.readline()  # MPI has been started
            self.assertIn(process.pid, processes(lambda p: p.session == process.pid))
            self.assertEqual(processes(lambda p: p.parent == process.pid), [])
            process.kill()
            process.wait()
            self.assertEqual(processes(lambda p: p.session == process.pid), [])

    def test_inside_of_writes(self):
        """Killed when a checkpoint is there in part."""
        chance = random.Random(20002)
        n_parts = 0
        with JobOnDisk("slab_adaptive", self.OVERRIDES) as reference:
            reference.run()
            for i in range(N_KILLS):
                with JobOnDisk("slab_adaptive", self.OVERRIDES) as job:
                    process = job.start()
                    wanted = chance.randrange(2, 14)
                    while process.poll() is None and not job.step(wanted).exists():
                        time.sleep(2e-4)
                    time.sleep(chance.uniform(0, 0.002))
                    process.send_signal(signal.SIGKILL)
                    process.communicate()
                    n_parts += wanted not in job.steps()
                    job.run("--restart")
                    self.assertIdentical(
                        job.results, reference.results, f"kill {i} in step {wanted}"
                    )
                    self.assertEqual(len(list(job.checkpoints.iterdir())), 2)
        self.assertGreater(n_parts, 0)

    def test_again_and_again(self):
        """The same run, killed each time soon after it has got further."""
        chance = random.Random(20003)
        with Job("slab_adaptive", self.OVERRIDES) as reference:
            reference.run()
            with Job("slab_adaptive", self.OVERRIDES) as job:
                n_kills, newest = 0, 0
                while newest < 15:
                    process = job.start("--restart=auto")
                    wait_for(
                        lambda: max(job.steps(), default=0) > newest
                        or process.poll() is not None
                    )
                    n_kills += self.kill(process, chance.uniform(0, 0.1))
                    newest = max(job.steps())
                job.run("--restart")
                self.assertGreater(n_kills, 2)
                self.assertIdentical(job.results, reference.results)


def wait_for(condition, seconds=60):
    end = time.time() + seconds
    while not condition():
        if time.time() > end:
            raise AssertionError("nothing happened")
        time.sleep(0.01)


def children(pid):
    tasks = Path(f"/proc/{pid}/task/{pid}/children")
    return [int(child) for child in tasks.read_text().split()]


class Signals(RestartCase):
    OVERRIDES = {
        "Geometry/Arguments": "32, 16 : 0, 0 : 2, 1 : true",
        "Time/Phases": "1: 40, 2: 40",
        "Output/Fields every": 10,
    }

    @classmethod
    def setUpClass(cls):
        cls.references = {}

    @classmethod
    def reference(cls, ranks):
        """The run that no signal interrupts."""
        if ranks not in cls.references:
            job = cls.references[ranks] = Job("slab", cls.OVERRIDES)
            cls.addClassCleanup(job.__exit__)
            job.run(ranks=ranks)
        return cls.references[ranks]

    def n_rows(self, job):
        file = job.results / "statistics.csv"
        return file.read_text().count("\n") if file.exists() else 0

    def check(self, number, ranks, program=EXECUTABLE):
        reference = self.reference(ranks)
        self.assertFalse(reference.checkpoints.exists(), "nobody asked")
        with Job("slab", self.OVERRIDES) as job:
            process = job.start(ranks=ranks, program=program)
            self.addCleanup(process.kill)
            wait_for(lambda: self.n_rows(job) > 3 or process.poll() is not None)
            # one rank alone is told
            pid = process.pid if ranks == 1 else children(process.pid)[-1]
            os.kill(pid, number)
            _, message = process.communicate(timeout=60)
            if number == signal.SIGUSR1:
                self.assertEqual(process.returncode, 0, message)
                self.assertEqual(len(job.steps()), 1)
            else:
                self.assertEqual(process.returncode, 3, message)
                sentence = next(
                    line for line in message.splitlines() if "--restart" in line
                )
                self.assertIn(signal.Signals(number).name, sentence)
                rows = self.n_rows(job)
                self.assertLess(rows, 81)
                self.assertEqual(job.steps(), [rows - 2])
            result = job.run("--restart", ranks=ranks)
            self.assertIn("Restart after step", result.stdout)
            self.assertIdentical(job.results, reference.results)

    def test_sigusr1(self):
        self.check(signal.SIGUSR1, 1)

    def test_sigterm(self):
        self.check(signal.SIGTERM, 1)

    def test_sigint(self):
        self.check(signal.SIGINT, 1)

    def test_what_tests_run_instead_of_the_program(self):
        """tests/server/client passes signals on."""
        self.check(signal.SIGINT, 1, PROGRAM)

    def test_sigterm_two_ranks(self):
        self.check(signal.SIGTERM, 2)

    def test_sigusr1_two_ranks(self):
        self.check(signal.SIGUSR1, 2)

    def test_mpirun_forwards_sigusr1_to_ranks(self):
        with Job("slab", self.OVERRIDES) as job:
            process = job.start(ranks=2)
            wait_for(lambda: self.n_rows(job) > 3)
            process.send_signal(signal.SIGUSR1)
            _, message = process.communicate()
            self.assertEqual(process.returncode, 0, message)
            # mpirun tells one rank after the other; where a step ends in between,
            # there are two checkpoints
            self.assertTrue(job.steps())


class Triggers(RestartCase):
    def test_every_n_steps_and_keep(self):
        with Job("slab", {**SLAB, "Checkpoint/Every n steps": 5}) as job:
            job.run()
            # of 5, 10, 15 and the last
            self.assertEqual(job.steps(), [15, 16])

    def test_wall_time(self):
        with Job("slab", {**SLAB, "Checkpoint/Wall time interval": 1e-6}) as job:
            job.run()
            self.assertEqual(job.steps(), [15, 16])

    def test_wall_time_limit(self):
        """Ended before the step that would pass it, with the error so far."""
        bars = {**SLAB, "Error control/Error bar": "true"}
        with Job("slab", bars) as reference, Job("slab", bars) as job:
            reference.run()
            job.overrides["Checkpoint/Wall time limit"] = 1e-6
            message = job.run(code=3).stderr
            self.assertEqual(job.steps(), [1])
            self.assertRegex(
                message,
                r"'Checkpoint/Wall time limit' has ended the run after the checkpoint "
                r"of step 1 .*; --restart goes on\. The error in the energy norm up to "
                r"there is estimated as [0-9.]+ %\.",
            )
            job.run("--restart", code=3)
            self.assertEqual(job.steps(), [1, 2])
            job.overrides["Checkpoint/Wall time limit"] = 1000
            job.run("--restart")
            self.assertIdentical(job.results, reference.results)

    def test_wall_time_limit_in_an_early_pass(self):
        """A run to the tolerance of a quantity goes on in the pass that has ended, and
        of what passes have written the last one's is left."""
        scene = {
            "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
            "Output/Points": "0, 0",
            "Output/Fields every": 1,
            "Error control/Quantity": "point0_x",
            "Error control/Tolerance": 0.05,
        }
        with Job("slab", scene) as reference, Job("slab", scene) as job:
            result = reference.run()
            self.assertGreater(result.stdout.count("Again from the beginning"), 1)
            self.assertNotIn("have been removed", result.stdout)
            self.assertEqual(
                len(list(reference.results.glob("solution_*.vtu"))), len(result["t"])
            )
            job.overrides["Checkpoint/Wall time limit"] = 1e-6
            job.run(code=3)
            job.run("--restart", code=3)
            self.assertEqual(job.steps(), [1, 2])
            self.assertLess(job.run("--restart", code=3)["cells"][-1], result["cells"][0])
            job.overrides["Checkpoint/Wall time limit"] = 1000
            job.run("--restart")
            self.assertIdentical(job.results, reference.results)

    def test_no_traces_without_checkpoints(self):
        with Job("slab", SLAB) as job:
            job.run()
            self.assertFalse(job.checkpoints.exists())

    def test_other_directory(self):
        with Job("slab", {**SLAB, **EVERY_STEP}) as reference, Job(
            "slab", {**SLAB, **EVERY_STEP}
        ) as job:
            reference.run()
            elsewhere = job.work / "safe" / "place"
            job.overrides["Checkpoint/Directory"] = elsewhere
            job.run()
            self.assertFalse(job.checkpoints.exists())
            job.checkpoints = elsewhere
            job.forget_after(4)
            job.run("--restart")
            self.assertIdentical(job.results, reference.results)


class OfSlab(RestartCase):
    """What begins with the checkpoints of a run that has ended."""

    @classmethod
    def setUpClass(cls):
        cls.reference = Job("slab_adaptive", {**SLAB, **EVERY_STEP})
        cls.reference.run()

    @classmethod
    def tearDownClass(cls):
        cls.reference.__exit__()


class Damaged(OfSlab):
    """Checkpoints that are not what was written."""

    def falls_back(self, damage, remark="Warning: the checkpoint.*step_000009"):
        with Job("slab_adaptive", self.reference.overrides, self.reference) as job:
            job.forget_after(9)
            damage(job.step(9))
            result = job.run("--restart")
            self.assertRegex(result.stdout, remark)
            self.assertRegex(result.stdout, "Restart after step 8 ")
            self.assertIdentical(job.results, self.reference.results)

    def test_truncated(self):
        def damage(step):
            file = step / "fields_00000.bin"
            os.truncate(file, file.stat().st_size // 2)

        self.falls_back(damage)

    def test_garbled(self):
        def damage(step):
            file = step / "run.bin"
            content = bytearray(file.read_bytes())
            content[len(content) // 2] ^= 1
            file.write_bytes(content)

        self.falls_back(damage)

    def test_file_missing(self):
        self.falls_back(lambda step: (step / "run.bin").unlink())

    def test_manifest_missing(self):
        """As in a checkpoint that the program was killed in."""
        self.falls_back(
            lambda step: (step / "manifest.txt").unlink(), "Restart after step 8 "
        )

    def test_manifest_garbled(self):
        def damage(step):
            file = step / "manifest.txt"
            file.write_text(file.read_text().replace('"step": 9', '"step": 8'))

        self.falls_back(damage)

    def test_other_format(self):
        def damage(step):
            file = step / "manifest.txt"
            text = file.read_text()
            file.write_text(re.sub(r'checkpoint": \d+', 'checkpoint": 3', text))

        self.falls_back(damage)

    def test_no_valid_one(self):
        with Job("slab_adaptive", self.reference.overrides, self.reference) as job:
            job.forget_after(1)
            (job.step(1) / "run.bin").write_bytes(b"")
            before = (job.results / "statistics.csv").read_text()
            for option in "--restart", "--restart=auto":
                result = job.run(option, code=1)
                self.assertOneSentence(result.stderr, "checkpoint", "step_000001")
            self.assertEqual((job.results / "statistics.csv").read_text(), before)

    def mutate(self, chance, file):
        content = bytearray(file.read_bytes())
        for _ in range(chance.randrange(1, 4)):
            kind = chance.randrange(4)
            at = chance.randrange(len(content)) if content else 0
            if kind == 0 and content:
                content[at] = chance.randrange(256)
            elif kind == 1:
                del content[at:]
            elif kind == 2:
                content[at:at] = chance.randbytes(chance.randrange(1, 30))
            else:
                content[at : at + 8] = chance.choice(
                    [b"\xff" * 8, b"\x00" * 8, b"\xff\xff\xff\xff\x00\x00\x00\x00"]
                )
        file.write_bytes(content)

    def test_mutations_are_noticed(self):
        chance = random.Random(20004)
        names = "manifest.txt", "run.bin", "fields_00000.bin"
        for i in range(N_MUTATIONS):
            with Job("slab_adaptive", self.reference.overrides, self.reference) as job:
                job.forget_after(14)
                for n in job.steps()[:-2]:
                    shutil.rmtree(job.step(n))
                name = chance.choice(names)
                before = (job.step(14) / name).read_bytes()
                self.mutate(chance, job.step(14) / name)
                if (job.step(14) / name).read_bytes() == before:
                    continue
                result = job.run("--restart")
                self.assertIn(
                    "Restart after step 13 ", result.stdout, f"mutation {i} of {name}"
                )
                self.assertIdentical(job.results, self.reference.results)

    def test_statistics_that_lack_rows(self):
        with Job("slab_adaptive", self.reference.overrides, self.reference) as job:
            file = job.results / "statistics.csv"
            file.write_text("\n".join(file.read_text().splitlines()[:5]))
            result = job.run("--restart", code=1)
            self.assertOneSentence(result.stderr, "statistics.csv", "step 16")

    def test_half_a_row(self):
        """The rest of a write that a kill has cut short."""
        with Job("slab_adaptive", self.reference.overrides, self.reference) as job:
            job.forget_after(7)
            file = job.results / "statistics.csv"
            lines = file.read_text().splitlines()
            file.write_text("\n".join(lines[:9] + [lines[9][:20]]))
            job.run("--restart")
            self.assertIdentical(job.results, self.reference.results)


class Machine(RestartCase):
    """A limit on the size of files, imposed on the running process, stands for
    a disk that is full."""

    OVERRIDES = {
        "Geometry/Arguments": "48, 24 : 0, 0 : 2, 1 : true",
        "Time/Phases": "1: 60, 2: 60",
        "Output/Fields every": 0,
    }

    def fill_disk(self, job, limit):
        """Run until the third checkpoint, then with that limit."""
        process = job.start()
        wait_for(lambda: len(job.steps()) > 2 or process.poll() is not None)
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (limit, limit))
        _, message = process.communicate()
        self.assertEqual(process.returncode, 1, message)
        return message

    def test_checkpoint_fails(self):
        """The one before it stays and is good."""
        overrides = {**self.OVERRIDES, **EVERY_STEP}
        with Job("slab", overrides) as reference:
            reference.run()
            limit = (reference.step(6) / "fields_00000.bin").stat().st_size - 1000
            for name in "parameters.prm", "statistics.csv":
                self.assertGreater(limit, (reference.results / name).stat().st_size)
            with Job("slab", overrides) as job:
                message = self.fill_disk(job, limit)
                n = len(job.steps())
                self.assertOneSentence(message, f"checkpoint of step {n + 1}", "large")
                self.assertEqual(job.steps(), list(range(1, n + 1)))
                self.assertEqual(len(list(job.checkpoints.iterdir())), n)
                result = job.run("--restart")
                self.assertIn(f"Restart after step {n} ", result.stdout)
                self.assertIdentical(job.results, reference.results)

    def test_statistics_fail(self):
        overrides = {
            **SLAB,
            "Time/Phases": "1: 200, 2: 200",
            "Output/Fields every": 0,
            "Checkpoint/Every n steps": 10,
            "Checkpoint/Keep": 1000,
        }
        with Job("slab", overrides) as reference:
            reference.run()
            limit = (reference.results / "statistics.csv").stat().st_size // 2
            for file in (
                reference.step(10) / "fields_00000.bin",
                reference.results / "parameters.prm",
            ):
                self.assertGreater(limit, file.stat().st_size)
            with Job("slab", overrides) as job:
                message = self.fill_disk(job, limit)
                self.assertOneSentence(message, "statistics.csv", "disk")
                result = job.run("--restart")
                self.assertIn("Restart after step", result.stdout)
                self.assertIdentical(job.results, reference.results)

    def test_unwritable_directory(self):
        """Found before the first step."""
        with tempfile.NamedTemporaryFile() as file:
            with Job("slab", SLAB) as job:
                job.overrides["Checkpoint/Every n steps"] = 5
                job.overrides["Checkpoint/Directory"] = f"{file.name}/checkpoints"
                result = job.run(code=1)
                self.assertOneSentence(result.stderr, Path(file.name).name)
                self.assertFalse((job.results / "statistics.csv").exists())


class Changes(OfSlab):
    """Other parameters after the restart."""

    def restart(self, code, **overrides):
        with Job("slab_adaptive", self.reference.overrides, self.reference) as job:
            job.forget_after(9)
            return job.run("--restart", code=code, overrides=overrides)

    def refused(self, path, value, *names):
        result = self.restart(1, **{path: value})
        self.assertOneSentence(result.stderr, *(names or (path, "was")))

    def test_longer_run(self):
        """Ended, and then carried on: as if it had been one run."""
        overrides = {**self.reference.overrides, "Time/Phases": "1: 8"}
        with Job("slab_adaptive", overrides) as job:
            job.run()
            job.overrides["Time/Phases"] = "1: 8, 2: 8"
            # the last state of the short run was an output, step 8 is none
            # of the long one
            job.overrides["Output/Fields every"] = 4
            result = job.run("--restart")
            self.assertRegex(result.stdout, "Note: changed.*Time/Phases.*was 1: 8")
            self.assertEqual(
                without_wall_times(job.results / "statistics.csv"),
                without_wall_times(self.reference.results / "statistics.csv"),
            )

    def test_run_that_is_complete(self):
        with Job("slab_adaptive", self.reference.overrides, self.reference) as job:
            result = job.run("--restart")
            self.assertIn("nothing left to do", result.stdout)
            self.assertIdentical(job.results, self.reference.results)

    def test_killed_before_the_oldest_was_removed(self):
        with Job("slab_adaptive", self.reference.overrides, self.reference) as job:
            last = job.steps()[-2:]
            job.overrides = {**job.overrides, "Checkpoint/Keep": 2}
            job.run("--restart")
            self.assertEqual(job.steps(), last)
            self.assertIdentical(job.results, self.reference.results)

    def test_tolerance_and_output(self):
        with Job("slab_adaptive", self.reference.overrides, self.reference) as job:
            job.forget_after(9)
            job.overrides = {
                **job.overrides,
                "Solver/Contact tolerance": 1e-9,
                "Output/Fields every": 2,
            }
            result = job.run("--restart")
            self.assertRegex(result.stdout, "changed.*Fields every.*Contact tolerance")

    def test_what_may_not_change(self):
        for path, value in (
            ("Geometry/Global refinements", 1),
            ("Boundary 1/Role", "clamped"),
            ("Material/Law", "elastic"),
            ("Material/Stress history", "quadrature points"),
            ("Mesh refinement/Strategy", "none"),
            ("Output/Points", "0, 0; 2, 0"),
        ):
            with self.subTest(path):
                self.refused(path, value)
        self.refused("Boundary 7/Role", "free", "Boundary 7")
        for phases in "1: 10, 2: 8", "1: 8":  # past steps, fewer steps
            self.refused("Time/Phases", phases, "Time/Phases")


    def test_doubts_are_kept(self):
        """What a run has said before its restart of a mesh too coarse for curved faces
        and of steps with several solutions; and bodies stay opposite each other."""
        every = {"Checkpoint/Every n steps": 1, "Checkpoint/Keep": 99}
        coarse = {
            **every,
            "Geometry/Arguments": "0, 0 : 1 : 2 : 2 : true | 0, 0 : 2 : 3 : 3 : true",
            "Geometry/Global refinements": 0,
            "Error control/Tolerance": 0.9,
            "Mesh refinement/Strategy": "none",
            "Time/Phases": "1: 4",
            # small beside the miss of the arcs in the first steps alone
            **on_boundary(21, Role="traction", Pressure="t"),
        }
        with Job("shrink_fit_2d", coarse) as job:
            alone = "met by the estimate alone"
            self.assertIn(alone, job.run().stdout)
            job.forget_after(3)
            self.assertIn(alone, job.run("--restart").stdout)
            path = "Boundary 1/Against"
            result = job.run("--restart", code=1, overrides={path: 21})
            self.assertOneSentence(result.stderr, path, "was 20")
        scene = {**every, "Boundary 2/Friction coefficient": 1}
        with Job("literature/leaning_bar", scene) as job:

            def doubts():
                return json.loads((job.results / "run.json").read_text())["doubtful_steps"]

            job.run()
            expected = doubts()
            job.forget_after(job.steps()[-2])
            job.run("--restart")
            self.assertEqual(doubts(), expected)


class Begin(RestartCase):
    def test_restart_without_a_checkpoint(self):
        with Job("slab", SLAB) as job:
            result = job.run("--restart", code=1)
            self.assertOneSentence(result.stderr, "no checkpoint", "results")
            self.assertFalse(job.results.exists(), "something was written")

    def test_auto_without_a_checkpoint(self):
        with Job("slab", SLAB) as job:
            self.assertEqual(len(job.run("--restart=auto")["t"]), 17)

    def test_afresh_removes_old_checkpoints(self):
        with Job("slab", {**SLAB, **EVERY_STEP}) as job:
            job.run()
            job.overrides["Checkpoint/Every n steps"] = 0
            result = job.run()
            self.assertRegex(result.stdout, "Note: the checkpoints.*removed")
            self.assertEqual(job.steps(), [])

    def test_restart_and_check(self):
        with Job("slab", SLAB) as job:
            result = job.run("--restart", "--check", code=2)
            self.assertOneSentence(result.stderr, "--check", "--restart")

    def test_unreadable_is_not_empty(self):
        """A place that cannot be read may hold checkpoints: nothing begins
        afresh there.  A link to itself cannot be read by anybody, root
        included."""
        with Job("slab", SLAB) as job:
            job.run()
            before = (job.results / "statistics.csv").read_bytes()
            job.checkpoints.symlink_to("checkpoint")
            for options in ("--restart=auto",), ("--restart",), ():
                result = job.run(*options, code=1)
                self.assertOneSentence(
                    result.stderr, "results/checkpoint/' for checkpoints", "symbolic"
                )
            self.assertEqual((job.results / "statistics.csv").read_bytes(), before)


class Foreign(RestartCase):
    """Among checkpoints there may be what the program has not written."""

    def add(self, job, files):
        """{"step_000001/thesis.txt": text}; None for a directory."""
        for name, text in files.items():
            file = job.checkpoints / name
            file.parent.mkdir(parents=True, exist_ok=True)
            if text is None:
                file.mkdir()
            else:
                file.write_text(text)

    def contents(self, job):
        return sorted(
            str(path.relative_to(job.checkpoints))
            for path in job.checkpoints.rglob("*")
            if not path.is_dir()
        )

    def assertStays(self, result, directory, *files):
        self.assertRegex(
            result.stdout,
            rf"Note: '\S*/{directory}/?' stays, since this program has not written "
            rf"{', '.join(files)} in it\.",
        )

    def test_run_afresh(self):
        """Whether it asks for checkpoints or not."""
        foreign = {
            "step_000001/thesis.txt": "precious",
            "step_000007.outdated/b.txt": "",
            "step_000030/manifest.txt": "of a ship",
            "step_1/a.txt": "",
            "step_000001.txt": "",
        }
        for every in 0, 1:
            with Job("slab", {**SLAB, "Checkpoint/Every n steps": every}) as job:
                self.add(job, foreign)
                result = job.run()
                self.assertNotIn("removed", result.stdout)
                expected = set(foreign)
                if every == 1:
                    self.assertStays(result, "step_000001", "thesis.txt")
                    for n in 15, 16:
                        for name in "manifest.txt", "run.bin", "fields_00000.bin":
                            expected.add(f"step_{n:06}/{name}")
                self.assertEqual(self.contents(job), sorted(expected))

    def test_inside_of_checkpoints(self):
        """Only files of the program go, and a restart leaves others, too."""
        with Job("slab", {**SLAB, **EVERY_STEP}) as job:
            job.run()
            for n in 4, 12:
                (job.step(n) / "notes.txt").write_text("mine")
            job.forget_after(12)
            (job.step(12) / "run.bin").write_bytes(b"")
            result = job.run("--restart")
            self.assertIn("Restart after step 11 ", result.stdout)
            self.assertStays(result, "step_000012", "notes.txt")
            job.overrides["Checkpoint/Every n steps"] = 0
            result = job.run()
            self.assertRegex(result.stdout, "Note: the checkpoints.*removed")
            self.assertEqual(
                self.contents(job), ["step_000004/notes.txt", "step_000012/notes.txt"]
            )

    def test_remains_of_every_instant(self):
        """What the program leaves if it is killed while it writes or removes a
        checkpoint, at whatever instant, is its own, and goes."""
        names = "fields_00000.bin", "run.bin", "manifest.txt.part"
        with Job("slab", SLAB) as job:
            for i in range(len(names) + 1):
                place = f"step_{i + 1:06}"
                self.add(job, {place: None})
                self.add(job, {f"{place}/{name}": "x" for name in names[:i]})
            result = job.run()
            self.assertNotIn("stays", result.stdout)
            self.assertEqual(list(job.checkpoints.iterdir()), [])


class TwoAtOnce(RestartCase):
    """No two runs write into the same directory."""

    OVERRIDES = {
        "Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true",
        "Time/Phases": "1: 200, 2: 200",
        "Output/Fields every": 0,
        "Checkpoint/Every n steps": 1,
    }

    def test_second_run(self):
        """It is refused while the first one is there, be it asleep, and not
        when that has been killed."""
        with Job("slab", self.OVERRIDES) as job, Job("slab", SLAB) as other:
            process = job.start()
            wait_for(lambda: job.steps() or process.poll() is not None)
            process.send_signal(signal.SIGSTOP)
            try:
                rows = (job.results / "statistics.csv").read_bytes()
                for options in (), ("--restart",), ("--restart=auto",):
                    result = job.run(*options, code=1)
                    self.assertOneSentence(
                        result.stderr,
                        rf"Another run \(process {process.pid} on \S+\)",
                        "results/'",
                    )
                other.overrides["Checkpoint/Directory"] = job.checkpoints
                result = other.run(code=1)
                self.assertOneSentence(result.stderr, "Another run", "checkpoint/'")
                self.assertFalse((other.results / "statistics.csv").exists())
                self.assertEqual((job.results / "statistics.csv").read_bytes(), rows)
                job.run("--check")
            finally:
                process.kill()
                process.communicate()
            result = job.run("--restart")
            self.assertIn("Restart after step", result.stdout)
            self.assertEqual(list(job.work.rglob("*.lock")), [])

    def test_same_directory_for_all(self):
        """A run does not keep itself out."""
        with Job("slab", {**SLAB, **EVERY_STEP}) as job:
            job.overrides["Checkpoint/Directory"] = job.results
            job.run(ranks=2)
            self.assertTrue((job.results / "step_000016").exists())


if __name__ == "__main__":
    main()
