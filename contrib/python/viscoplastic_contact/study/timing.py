# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs that only tell what they cost."""

import os

from .analysis import cost_of, expected_steps
from .words import seconds_in_words


def affordable_memory():
    """In MB, half of the memory of this machine."""
    return 0.5e-6 * os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGESIZE")


def seconds_for_timing(spent, price):
    """The seconds for make_timing_runs(): as many as the runs have taken that there
    are, or a tenth of those of the run that is to be priced, but one at least."""
    return max(1.0, spent, price / 10.0)


def make_timing_runs(runs, records, mesh_level, seconds, console):
    """Time runs of one method variant on meshes that are finer than those of its
    records, of which there must be one: each with half of the mesh width of the one
    before, up to the mesh level, and with as many steps as a record has and half of
    the seconds left allow. Prices of long runs go by these instead of by
    extrapolation, and learn of solvers that small meshes do not have. They end where
    the next one would take more than is left of the seconds, or half of the memory
    of this machine. Returns records, and the name of a signal that has ended them."""
    scene = runs.scene
    times = [record.key.time_level for record in records]
    finest = max(record.key.mesh_level for record in records)
    variant = records[0].key.variant
    known, found, left = list(records), [], seconds
    for level in range(finest + 1, mesh_level + 1):
        cost = cost_of(known)
        dofs = 2.0**scene.dimension * cost.demand.dofs
        # As many steps as half of the seconds allow: long steps take more iterations
        # than those of the run that is priced.
        for time_level in range(max(times), min(times) - 1, -1):
            key = records[0].key._replace(
                mesh_level=level, time_level=time_level, is_timing=True
            )
            steps = expected_steps(scene, known, key)
            n_set_ups = scene.n_set_ups(variant.strategy, steps, scene.planned_steps(key))
            expected = cost.seconds(dofs, steps, n_set_ups)
            record = runs.find(key)
            if record or expected <= 0.5 * left:
                break
        if not record:
            memory = cost.memory(dofs, steps, n_set_ups)
            if expected > left or memory > affordable_memory():
                break
            console.status(
                f"Timing run {runs.name(key)}, about {seconds_in_words(expected)}"
            )
            outcome = runs.make(key)
            record = outcome.record
            if outcome.interruption:
                return found, outcome.interruption
            if not record:  # what fails tells nothing
                break
        left -= record.number("seconds_total")
        found.append(record)
        known.append(record)
    return found, ""
