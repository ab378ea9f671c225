# SPDX-License-Identifier: LGPL-2.1-or-later
"""What is computed for doc/accuracy.md, and how finely.

Sizes are such that everything takes about 20 minutes on two cores.  Overrides
are those of the command line, {"Section/Entry": value}.
"""

# The errors that people ask for, and the columns of the price tables.
TOLERANCES = (0.1, 0.03, 0.01, 0.003)

# Of all studies, unless a scene says otherwise.
COUPLED = {
    "Solver/Contact tolerance": "0",
    "Output/Fields every": "0",
    "Output/Fields interval": "0",
}

SCHEMES = ("forward Euler", "backward Euler", "Heun")

# Manufactured solutions: each scene of prm/verification/manufactured with each
# of the laws there (law_*.prm, given after it) on its own mesh, and with its
# own law on other meshes and with the other schemes.  A ladder shows an order
# where what it leaves alone is small: each has a study of its own.  Only orders
# are of interest, so two studies run side by side.
MANUFACTURED = {"Study/Strategies": "uniform", "Study/Budget": "120"}
MANUFACTURED_LADDERS = {
    2: {
        "space": {
            "Geometry/Global refinements": "0",
            "Time/Phases": "1: 64",
            "Study/Levels": "3",
        },
        "time": {
            "Geometry/Global refinements": "2",
            "Time/Phases": "1: 4",
            "Study/Levels": "3",
        },
        "both": {
            "Geometry/Global refinements": "0",
            "Time/Phases": "1: 12",
            "Study/Levels": "4",
        },
    },
    3: {
        "space": {
            "Geometry/Global refinements": "0",
            "Time/Phases": "1: 16",
            "Study/Levels": "3",
        },
        "time": {
            "Geometry/Global refinements": "0",
            "Time/Phases": "1: 3",
            "Study/Levels": "3",
        },
        "both": {
            "Geometry/Global refinements": "0",
            "Time/Phases": "1: 12",
            "Study/Levels": "3",
        },
    },
}

# Steps that forward Euler can take, where those above are too long for a law.
LAW_LADDERS = {"law_norton": {"time": {"Time/Phases": "1: 14"}}}

# {mesh: overrides}; {dimension} stands for 2 or 3, {folder} for that of the
# scenes.  Local refinement is along a side, across the foundation.
MESHES = {
    "distorted": {"Geometry/File": "{folder}/distorted_{dimension}d.msh"},
    "locally refined": {"Geometry/Boundary refinements": "0: 1"},
}

# Runs to these errors are priced; the first is for comparisons only.
TARGETS = (0.3, *TOLERANCES)

# Errors are differences to a run to half of the scene's tolerance.
EVERY_WAY = {
    "Study/Ladders": "space, time, both",
    "Study/Strategies": "uniform, adaptive, tolerance",
    "Study/Time schemes": ", ".join(SCHEMES),
    "Study/Target errors": ", ".join(map(str, TARGETS)),
}

# Work-precision diagrams and prices: {scene: (title, overrides)}.
DIAGRAMS = {
    "slab": (
        "Tresca slab, two dimensions",
        {
            "Geometry/Arguments": "8, 4 : 0, 0 : 2, 1 : true",
            "Time/Phases": "1: 4, 2: 4",
            "Error control/Tolerance": "0.01",
            "Study/Levels": "5",
            "Study/Budget": "500",
            **EVERY_WAY,
        },
    ),
    "coulomb_pad_3d": (
        "Coulomb pad, three dimensions",
        {
            "Geometry/Arguments": "3, 3, 3 : 0, 0, 0 : 1, 1, 1 : true",
            "Time/Phases": "0.5: 2, 1.5: 4",
            "Error control/Tolerance": "0.08",
            "Study/Levels": "3",
            "Study/Budget": "700",
            **EVERY_WAY,
        },
    ),
    "corner_singularity_2d": (
        "Corner singularity, two dimensions",
        {
            "Geometry/Global refinements": "2",
            "Time/Phases": "1: 4",
            "Error control/Tolerance": "0.01",
            "Study/Levels": "5",
            "Study/Budget": "500",
            **EVERY_WAY,
        },
    ),
}

# Solutions that are not smooth: {scene: (why, overrides)}.
ROUGH = {
    "Study/Levels": "4",
    "Study/Ladders": "space, time, both",
    "Study/Strategies": "uniform, adaptive",
    "Study/Time schemes": ", ".join(SCHEMES),
    "Study/Budget": "60",
}
LOW_REGULARITY = {
    "kinked_load_2d": ("a kink of the load in time, a jump of the bound", ROUGH),
    "junction_2d": (
        "clamped and loaded pieces of one side",
        {**ROUGH, "Study/Time schemes": SCHEMES[0]},
    ),
    "corner_singularity_2d": (
        "re-entrant corner",
        {
            **ROUGH,
            "Study/Time schemes": SCHEMES[0],
            "Geometry/Global refinements": "1",
            "Time/Phases": "1: 4",
        },
    ),
}

# Runs to a tolerance: of known solutions, (scene, law, tolerances).
KNOWN_TO_TOLERANCE = (
    ("tresca_2d", None, (0.2, 0.1, 0.05, 0.02)),
    ("coulomb_2d", None, (0.2, 0.1, 0.05, 0.02)),
    *(
        ("coulomb_2d", f"law_{law}", (0.05,))
        for law in ("elastic", "norton", "parsed", "perzyna_hardening", "zener")
    ),
    ("tresca_3d", None, (0.3, 0.2)),
    ("coulomb_3d", None, (0.3, 0.2)),
    *(
        ("coulomb_3d", f"law_{law}", (0.2,))
        for law in ("elastic", "norton", "perzyna_hardening", "zener")
    ),
)
# And of scenes beside those of the diagrams, {scene: overrides}; of all of them
# those with one scheme are shown.
TO_TOLERANCE_SCHEME = "Heun"
BESIDE_UNIFORM = {
    **EVERY_WAY,
    "Study/Strategies": "uniform, tolerance",
    "Study/Time schemes": TO_TOLERANCE_SCHEME,
    "Study/Budget": "300",
}
TO_TOLERANCE = {
    "half_clamped_block": {
        **BESIDE_UNIFORM,
        "Geometry/Arguments": "8, 8 : 0, 0 : 1, 1 : true",
        "Error control/Tolerance": "0.01",
        "Study/Levels": "5",
    },
    "junction_2d": {
        **BESIDE_UNIFORM,
        "Error control/Tolerance": "0.01",
        "Study/Levels": "5",
    },
    "pad": {
        **BESIDE_UNIFORM,
        "Geometry/Arguments": "4, 4, 4 : 0, 0, 0 : 1, 1, 1 : true",
        "Time/Phases": "1.5: 5",
        "Error control/Tolerance": "0.08",
        "Study/Levels": "3",
    },
}
CELL_BUDGET = "2000000"

# How true the error bar is in long creep: at 1, 10, 100 and 1000 relaxation
# times, {name: (scene, quantity, tolerances of energy norm and quantity, how
# often the reference halves the mesh, overrides)}.
ADAPTIVE_CREEP = {
    "Mesh refinement/Strategy": "residual",
    "Mesh refinement/Every n steps": "2",
}


def more_steps(phases):
    """Those of the reference: four times as many."""
    pairs = (phase.split(":") for phase in phases.split(","))
    return ", ".join(f"{end.strip()}: {4 * int(steps)}" for end, steps in pairs)


def _creep(tau, steps=6, before=""):
    """Phases to 1, 10, 100 and 1000 times tau, after others."""
    phases = ", ".join(f"{tau * n:g}: {steps}" for n in (1, 10, 100, 1000))
    return {
        "Time/Scheme": "backward Euler",
        "Time/Phases": before + phases,
    }


_CYLINDER = {"Geometry/Global refinements": "2", "Solver/Contact tolerance": "0"}
_MAXWELL = {"Material/Law": "maxwell", "Material/maxwell/Viscosity": "0.5"}
_CANTILEVER = {"Geometry/Global refinements": "0"}
LONG_CREEP = {
    "thick cylinder, norton": (
        "verification/hard/norton_cylinder",
        "point0_x",
        (0.05, 0.02),
        3,
        {**_CYLINDER, **_creep(0.001), "Material/norton/Exponent": "5"},
    ),
    "thick cylinder, maxwell": (
        "verification/hard/norton_cylinder",
        "point0_x",
        (0.05, 0.02),
        3,
        {**_CYLINDER, **_creep(0.001), **_MAXWELL},
    ),
    "hollow sphere, norton": (
        "verification/hard/norton_cylinder",
        "point0_x",
        (0.2, 0.1),
        3,
        {
            **_CYLINDER,
            **_creep(0.001, 4),
            "Dimension": "3",
            "Geometry/Arguments": "0, 0, 0 : 1 : 2 : 3 : true",
            "Geometry/Global refinements": "1",
            "Material/norton/Exponent": "5",
            "Boundary 0/Traction": "x/sqrt(x*x + y*y + z*z); "
            "y/sqrt(x*x + y*y + z*z); z/sqrt(x*x + y*y + z*z)",
            "Boundary 4/Role": "symmetry",
            "Output/Points": "1, 0, 0",
        },
    ),
    "circular cavity, norton": (
        "verification/hard/norton_cylinder",
        "point0_x",
        (0.1, 0.02),
        3,
        {
            **_CYLINDER,
            **_creep(0.03, 6, "0.001: 2, "),
            "Geometry/Arguments": "0, 0 : 1 : 5 : 6 : true",
            "Material/Young's modulus": "25000",
            "Material/Poisson's ratio": "0.25",
            "Material/norton/Rate factor": "6e-6",
            "Material/norton/Exponent": "3",
            "Material/norton/Stress cap": "60",
            "Initial state/Stress": "-20; -20; -20; 0",
            "Initial state/Equilibrate": "false",
            "Boundary 0/Traction": "0; 0",
            "Boundary 0/Pressure": "20 - 15*min(t/0.001, 1)",
            "Boundary 1/Role": "traction",
            "Boundary 1/Pressure": "20",
        },
    ),
    "cantilever, maxwell": (
        "verification/cantilever_creep",
        "point0_y",
        (0.2, 0.02),
        3,
        {**_CANTILEVER, **_creep(1.3)},
    ),
    "cantilever, norton": (
        "verification/cantilever_creep",
        "point0_y",
        (0.2, 0.02),
        3,
        {
            **_CANTILEVER,
            **_creep(1),
            "Material/Law": "norton",
            "Material/norton/Rate factor": "1e4",
            "Material/norton/Exponent": "3",
            "Material/norton/Stress cap": "0.1",
        },
    ),
    "Lee-Radok, zener": (
        "verification/indentation_3d",
        "contact_force_z",
        (0.2, 0.1),
        2,
        {
            **_creep(1, 3, "0.1: 2, "),
            "Geometry/Arguments": "4, 4, 4 : 0, 0, 0 : 8, 8, 8 : true",
            "Geometry/Boundary refinements": "6: 1",
            "Geometry/Global refinements": "1",
            "Boundary 6/Foundation displacement": "-0.02*min(10*t, 1)",
            "Solver/Contact tolerance": "0",
        },
    ),
    "salt pillar, norton": (
        "demos/salt_pillar_2d",
        "reaction_2_y",
        (0.1, 0.02),
        3,
        {**_creep(4e6), "Geometry/Arguments": "12, 6 : 0, 0 : 6, 3 : true"},
    ),
    "salt joint, norton": (
        "demos/salt_joint_2d",
        "point1_y",
        (0.1, 0.02),
        3,
        {
            **_creep(140, 6, "20: 2, 40: 4, "),
            "Geometry/Arguments": "8, 16 : -1, 0 : 1, 4 : true",
            "Boundary 3/Pressure": "8*(1 + 0.9*x*min(max(t - 20, 0), 20)/20)",
            "Step control/Tolerance": "0",
        },
    ),
    # Pressed from one side, held by symmetry at the other.
    "strip on a rough foundation, norton": (
        "verification/slab",
        "point0_x",
        (0.05, 0.001),
        3,
        {
            **_creep(0.0004),
            "Geometry/Arguments": "16, 4 : 0, 0 : 4, 1 : true",
            "Geometry/Global refinements": "1",
            "Material/Young's modulus": "1000",
            "Material/Stress history": "quadrature points",
            "Material/Volumetric integration": "automatic",
            "Material/Law": "norton",
            "Material/norton/Rate factor": "1e3",
            "Material/norton/Exponent": "3",
            "Material/norton/Stress cap": "1",
            "Initial state/Equilibrate": "true",
            "Boundary 0/Traction": "0.05; 0",
            "Boundary 1/Role": "symmetry",
            "Boundary 2/Friction bound": "0.02*(1 + 0.5*sin(3*x))",
            "Boundary 3/Role": "free",
            "Output/Points": "0, 1",
        },
    ),
}
# Four scenes drawn at random, as their files say.
DRAWN = {
    "block on a curved foundation, 3D, perzyna": (
        "verification/hard/drawn_block_3d",
        None,
        (0.5, None),
        2,
        {
            "Geometry/Global refinements": "1",
            "Time/Scheme": "backward Euler",
            "Time/Phases": "0.5: 3",
        },
    ),
    "strip of two materials on a foundation that sinks": (
        "verification/hard/drawn_strip_2d",
        None,
        (0.3, None),
        2,
        {
            "Geometry/Global refinements": "1",
            "Time/Scheme": "backward Euler",
            "Time/Phases": "1: 2",
        },
    ),
    "ring whose data contradict each other, zener": (
        "verification/hard/drawn_ring_2d",
        None,
        (0.3, None),
        2,
        {
            "Geometry/Global refinements": "2",
            "Time/Scheme": "backward Euler",
            "Time/Phases": "0.25: 3",
        },
    ),
    "lifted slab, 3D, parsed": (
        "verification/hard/drawn_slab_3d",
        None,
        (0.3, None),
        2,
        {
            "Geometry/Global refinements": "1",
            "Time/Scheme": "backward Euler",
            "Time/Phases": "0.25: 4",
        },
    ),
}

# Where the fixed tolerance is compared with the coupled one: the ladder of h
# and k of the diagrams again.
FIXED_TOLERANCE = "1e-10"
TOLERANCE_STUDY = {
    "Error control/Tolerance": "0",
    "Study/Ladders": "both",
    "Study/Strategies": "uniform",
    "Study/Time schemes": "forward Euler",
    "Study/Stress histories": "cell means",
}
