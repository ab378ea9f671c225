# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs that only tell what they cost."""

import os

from .analysis import cost_of_run
from .runs import Failure
from .words import seconds_in_words


def is_affordable(cost, seconds):
    """Whether seconds and memory of a run, as cost_of_run() has them, are no more than
    so many seconds and half of the memory of this machine."""
    memory = 0.5e-6 * os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGESIZE")
    return cost[0] <= seconds and cost[1] <= memory


def seconds_of(records):
    return sum(record.number("seconds_total") for record in records)


def seconds_for_timing(spent, price):
    """The seconds for make_timing_runs(): as many as the runs have taken that there
    are, or a tenth of those of the run that is to be priced, but one at least."""
    return max(1.0, spent, price / 10.0)


def make_timing_runs(runs, records, mesh_level, seconds, found, what, console):
    """Time runs of one method variant on meshes that are finer than those of its
    records, of which there must be one: each with half of the mesh width of the one
    before, up to the mesh level, and with as many steps as a record has and half of
    the seconds left allow. Prices of long runs go by these instead of by
    extrapolation, and learn of solvers that small meshes do not have. They end where
    the next one would take more than is left of the seconds, or half of the memory
    of this machine. Adds their records to those found; a signal ends what."""
    times = [record.key.time_level for record in records]
    finest = max(record.key.mesh_level for record in records)
    for level in range(finest + 1, mesh_level + 1):
        # As many steps as half of the seconds allow: long steps take more iterations
        # than those of the run that is priced.
        for time_level in range(max(times), min(times) - 1, -1):
            key = records[0].key._replace(
                mesh_level=level, time_level=time_level, is_timing=True
            )
            cost = cost_of_run(runs.scene, [*records, *found], key)
            record = runs.find(key)
            if record or cost[0] <= 0.5 * seconds:
                break
        if not record:
            if not is_affordable(cost, seconds):
                return
            about = seconds_in_words(cost[0])
            console.status(f"Timing run {runs.name(key)}, about {about}")
            try:
                record = runs.make(key, what)
            except Failure:  # what fails tells nothing
                return
        seconds -= record.number("seconds_total")
        found.append(record)
