# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scenes of a few cells, each with other parts of the program in it, as
{"Section/Entry": value}."""

PLANE = {
    "Dimension": "2",
    "Geometry/Generator": "subdivided_hyper_rectangle",
    "Geometry/Arguments": "2, 1 : 0, 0 : 2, 1 : true",
    "Boundary 0/Role": "traction",
    "Boundary 0/Traction": "0.3*t; 0",
    "Boundary 1/Role": "free",
    "Boundary 2/Role": "contact",
    "Boundary 2/Friction law": "tresca",
    "Boundary 2/Friction bound": "0.08",
    "Boundary 3/Role": "clamped",
    "Time/Phases": "0.2: 2, 0.4: 1",
    "Output/Fields every": "0",
    "Output/Directory": "results",
}

SOLID = {
    "Dimension": "3",
    "Geometry/Generator": "subdivided_hyper_rectangle",
    "Geometry/Arguments": "1, 1, 1 : 0, 0, 0 : 1, 1, 1 : true",
    "Boundary 0/Role": "traction",
    "Boundary 0/Traction": "0.1*t; 0; 0",
    "Boundary 1/Role": "free",
    "Boundary 2/Role": "symmetry",
    "Boundary 3/Role": "free",
    "Boundary 4/Role": "contact",
    "Boundary 4/Friction law": "coulomb",
    "Boundary 4/Friction coefficient": "0.3",
    "Boundary 4/Normal stress": "-0.1*t",
    "Boundary 5/Role": "displacement",
    "Boundary 5/Displacement": "0; 0; -0.01*t",
    "Time/Phases": "0.2: 2",
    "Output/Fields every": "0",
    "Output/Directory": "results",
}

MAXWELL = {"Material/Law": "maxwell", "Material/maxwell/Viscosity": "0.5"}
ZENER = {"Material/Law": "zener", "Material/zener/Relaxation time": "2"}
PERZYNA = {"Material/Law": "perzyna", "Material/perzyna/Hardening modulus": "0.1"}
NORTON = {"Material/Law": "norton", "Material/norton/Stress cap": "1"}
PARSED = {
    "Material/Law": "parsed",
    "Material/parsed/Strain rate": "0.1*min(sigma_eq, 2)^2*exp(-eps_eq)",
    "Material/parsed/Factor": "1 + x",
}
LAYERS = {
    "Geometry/Material ids": "if(x > 1, 1, 0)",
    "Material 0/Law": "maxwell",
    "Material 1/Law": "zener",
    "Material 1/Young's modulus": "2 + y",
}
CRYSTAL = {
    "Material/Voigt matrix": "4, 1, 1, 0, 0, 0; 1, 3, 1, 0, 0, 0; 1, 1, 2, 0, 0, 0; "
    "0, 0, 0, 1, 0, 0; 0, 0, 0, 0, 1, 0; 0, 0, 0, 0, 0, 1"
}
ADAPTIVE = {
    **MAXWELL,
    "Geometry/Global refinements": "1",
    "Mesh refinement/Strategy": "residual",
    "Mesh refinement/Maximal level": "2",
}

SCENES = {
    "elastic": PLANE,
    "maxwell": {**PLANE, **MAXWELL},
    "zener": {**PLANE, **ZENER, "Time/Scheme": "backward Euler"},
    "perzyna": {**PLANE, **PERZYNA},
    "norton": {**PLANE, **NORTON, "Material/Stress history": "quadrature points"},
    "parsed": {**PLANE, **PARSED},
    "layers": {**PLANE, **LAYERS, "Geometry/Boundary refinements": "2: 1"},
    "crystal": {**PLANE, **CRYSTAL},
    "adaptive": {**PLANE, **ADAPTIVE},
    "solid": {**SOLID, **MAXWELL},
    "initial": {
        **PLANE,
        "Initial state/Stress": "0; 0; 0; 0",
        "Initial state/Equilibrate": "true",
        "Loads/Body force": "0; -0.01*t",
        "Output/Points": "0, 0; 1, 1",
    },
}


def as_prm(entries):
    """The text of a parameter file, each section once."""
    tree = {}
    for path, value in entries.items():
        *sections, entry = path.split("/")
        node = tree
        for section in sections:
            node = node.setdefault(("subsection", section), {})
        node[("set", entry)] = value

    def write(node, indent):
        text = ""
        for (kind, name), content in node.items():
            if kind == "set":
                text += f"{indent}set {name} = {content}\n"
            else:
                inner = write(content, indent + "  ")
                text += f"{indent}subsection {name}\n{inner}{indent}end\n"
        return text

    return write(tree, "")


def with_entry(text, path, value):
    """The text with one more assignment: a file of its own overrides others,
    but within a file no entry may stand twice."""
    *sections, entry = path.split("/")
    begin = "".join(f"subsection {name}\n" for name in sections)
    return f"{text}{begin}set {entry} = {value}\n" + "end\n" * len(sections)
