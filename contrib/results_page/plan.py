# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is computed for doc/accuracy.md, and how finely.

Sizes are such that everything takes about 20 minutes on two cores.  Overrides
are those of the command line, {"Section/Entry": value}.
"""

# The errors that people ask for, and the columns of the price tables.
TOLERANCES = (0.1, 0.03, 0.01, 0.003)

# Of all studies, unless a scene says otherwise.
COUPLED = {"Solver/Contact tolerance": "0", "Output/Fields every": "0"}

# All scenes of prm/verification/manufactured, by their own mesh and steps.
# Only orders are of interest, so two studies run side by side.
MANUFACTURED = {
    "Study/Levels": "4",
    "Study/Ladders": "space, time, both",
    "Study/Strategies": "uniform",
    "Study/Budget": "60",
}
MANUFACTURED_3D = {"Study/Levels": "3"}
# {scene: overrides} for those that need other sizes.
MANUFACTURED_SCENES = {}

EVERY_WAY = {
    "Study/Strategies": "uniform, adaptive",
    "Study/Time schemes": "forward Euler, backward Euler",
    "Study/Stress histories": "cell means, quadrature points",
    "Study/Target errors": ", ".join(map(str, TOLERANCES)),
}

# Work-precision diagrams and prices: {scene: (title, overrides)}.
DIAGRAMS = {
    "slab": (
        "Tresca slab, two dimensions",
        {
            "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
            "Time/Phases": "1: 4, 2: 4",
            "Study/Levels": "5",
            "Study/Ladders": "space, time, both",
            "Study/Budget": "200",
            **EVERY_WAY,
        },
    ),
    "coulomb_pad_3d": (
        "Coulomb pad, three dimensions",
        {
            "Geometry/Arguments": "3, 3, 3 : 0, 0, 0 : 1, 1, 1 : true",
            "Time/Phases": "0.5: 4, 1.5: 8",
            "Study/Levels": "3",
            "Study/Ladders": "space, time, both",
            "Study/Budget": "300",
            **EVERY_WAY,
        },
    ),
    "corner_singularity_2d": (
        "Corner singularity, two dimensions",
        {
            "Geometry/Global refinements": "1",
            "Time/Phases": "1: 4",
            "Study/Levels": "5",
            "Study/Ladders": "space, time, both",
            "Study/Budget": "200",
            **EVERY_WAY,
        },
    ),
}

# Where the fixed tolerance is compared with the coupled one: the ladder of h
# and k of the diagrams again.
FIXED_TOLERANCE = "1e-10"
TOLERANCE_STUDY = {
    "Study/Ladders": "both",
    "Study/Strategies": "uniform",
    "Study/Time schemes": "forward Euler",
    "Study/Stress histories": "cell means",
}
