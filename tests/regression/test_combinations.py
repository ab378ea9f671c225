# SPDX-License-Identifier: LGPL-2.1-or-later
"""Restarts of scenes whose choices are drawn at random.

Schemes, policies for stiff steps, step control, laws, histories, solvers,
adaptive meshes and ranks each have tests of their own; here they meet.  A run
that goes on from a checkpoint writes what the run in one piece has written, bit
by bit.  The draws are the same in every run of the test; COMBINATIONS says how
many (80 with another seed took 10 minutes).
"""

import os
import random

from harness import main
from laws import HARDENING, NORTON, PERZYNA, pressure
from runs import EVERY_STEP, Job
from test_restart import RestartCase

N_COMBINATIONS = int(os.environ.get("COMBINATIONS", 6))

SCENES = {
    "slab": {
        "Geometry/Arguments": "16, 8 : 0, 0 : 2, 1 : true",
        "Time/Phases": "0.5: 3, 1: 12, 2: 6",
    },
    "slab_adaptive": {"Time/Phases": "1: 5, 2: 3"},
    "pad": {
        "Geometry/Arguments": "4, 4, 4 : 0, 0, 0 : 1, 1, 1 : true",
        "Time/Phases": "0.8: 4, 1.5: 4",
    },
    "pad_adaptive": {
        "Time/Phases": "0.8: 3, 1.2: 1",
        "Mesh refinement/Cell budget": 200,
    },
}
LAWS = {}, NORTON, PERZYNA, HARDENING, pressure(3, 0.25)
CONTROL = {"Step control/Event tolerance": 0.02, "Step control/Landing times": "0.37"}


def draw(choose):
    """(scene, entries, ranks)"""
    scene = choose(list(SCENES))
    entries = {
        **SCENES[scene],
        **(choose(LAWS) if scene.startswith("slab") else {}),
        "Output/Fields every": 4,
        "Time/Scheme": choose(["forward Euler", "Heun", "backward Euler"]),
        "Material/Stress history": choose(["cell means", "quadrature points"]),
    }
    if choose([True, False]):
        entries |= {**CONTROL, "Step control/Tolerance": choose([0.05, 0.1, 0.3])}
    # so that no explicit step is refused for its size
    if entries["Time/Scheme"] != "backward Euler":
        policies = ["backward Euler"]
        if "Step control/Tolerance" not in entries:
            policies.append("subdivide")
        entries["Time/Stiffness policy"] = choose(policies)
    ranks = choose([1, 1, 2, 3])
    solvers = ["multigrid", "automatic"] + ["direct"] * (ranks == 1)
    entries["Solver/Linear solver"] = choose(solvers)
    return scene, entries, ranks


class Restarted(RestartCase):
    def test_random_combinations(self):
        choose = random.Random(20261122).choice
        for i in range(N_COMBINATIONS):
            scene, entries, ranks = draw(choose)
            with self.subTest(f"{i}: {scene} on {ranks} ranks, {entries}"):
                with Job(scene, {**entries, **EVERY_STEP}) as whole:
                    whole.run(ranks=ranks)
                    n = choose(whole.steps()[1:-1])
                    with Job(scene, whole.overrides, whole) as part:
                        part.forget_after(n)
                        part.run("--restart", ranks=ranks)
                        self.assertIdentical(part.results, whole.results, f"after {n}")


if __name__ == "__main__":
    main()
