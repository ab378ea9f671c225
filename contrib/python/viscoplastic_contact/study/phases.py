# SPDX-License-Identifier: LGPL-2.1-or-later
"""`Time/Phases': pairs of the end of a phase, as the scene gives it, and its
number of steps."""

import math

MOST_STEPS = 10**8


def read_phases(text):
    pairs = (phase.split(":") for phase in text.split(",") if phase.strip())
    return [(end.strip(), int(float(n))) for end, n in pairs]


def write_phases(phases):
    return ", ".join(f"{end}: {n}" for end, n in phases)


def scale_phases(phases, factor):
    """Every phase with factor times its steps, rounded up."""
    return [
        (end, int(min(max(math.ceil(factor * n * (1.0 - 1e-12)), 1), MOST_STEPS)))
        for end, n in phases
    ]


def n_steps(phases):
    return sum(n for _, n in phases)


def largest_step(phases):
    """The longest step."""
    largest = start = 0.0
    for end, n in phases:
        largest = max(largest, (float(end) - start) / n)
        start = float(end)
    return largest
