# SPDX-License-Identifier: LGPL-2.1-or-later
"""Words, symbols and kinds of units of what a run writes, and its signs."""

import re

from . import units

SCALARS = {
    "temperature": ("temperature $T$", "temperature"),
    "von_mises": (r"von Mises stress $\sigma_\mathrm{vM}$", "stress"),
    "creep_strain": (r"equivalent creep strain $\varepsilon_\mathrm{c}$", None),
    "creep_rate": (r"equivalent creep rate $\dot\varepsilon_\mathrm{c}$", "rate"),
    "pressure": (r"pressure $-\mathrm{tr}\,\sigma/3$, compression positive", "stress"),
    "estimator": ("estimated error of cells", "energy norm"),
    "error_energy": (r"true error $\Vert u-u_h\Vert_{a,K}$", "energy norm"),
    "recovery": ("error by recovered strain", "energy norm"),
    "subdomain": ("MPI rank", None),
    "bound": (r"friction bound $\rho$", "stress"),
    "utilisation": (r"utilisation $|\sigma_\tau|/\rho$", None),
    "stick": ("share that sticks", None),
    "friction_work": ("work of friction on an area", "surface energy"),
    "contact_pressure": ("contact pressure $p$", "stress"),
    "gap": ("gap that is left $g_n-u_n$", "length"),
    "normal_traction": (r"normal traction $\sigma_\nu$, tension positive", "stress"),
}
VECTORS = {
    "displacement": ("displacement", "u", "length"),
    "velocity": ("velocity", r"\dot{u}", "velocity"),
    "slip": ("slip", "s", "length"),
    "slip_rate": ("slip rate", r"\dot{s}", "velocity"),
    "traction": ("friction traction on the body", r"\sigma_\tau", "stress"),
}
TENSORS = {
    "stress": ("stress", r"\sigma", "stress"),
    "irreversible_stress": ("irreversible stress", "z", "stress"),
    "strain": ("strain", r"\varepsilon", None),
    "history": ("history variable", r"\alpha", None),
    "irreversible_strain": ("irreversible strain", r"\varepsilon^\mathrm{i}", None),
    "principal_stress": ("principal stress", r"\sigma", "stress"),
}

# Columns of statistics.csv: pattern, words, kind of unit.
COLUMNS = [
    ("t", "time", "time"),
    ("k", "step size $k$", "time"),
    ("step_limit", "limit of the step $2/r$", "time"),
    ("slip_area", "slipping part of the face", "area"),
    ("stick_area", "sticking part of the face", "area"),
    ("tension_area", "part of the face under tension", "area"),
    ("contact_area", "part of the face that touches", "area"),
    ("friction_force_([xyz])", "friction force exerted by the body, ${0}$", "force"),
    ("contact_force_([xyz])", "contact force exerted by the body, ${0}$", "force"),
    (
        r"(friction|contact)_force_(\d+)_([xyz])",
        "{0} force of the body on {boundary}, ${2}$",
        "force",
    ),
    ("max_pressure", "largest contact pressure", "stress"),
    ("max_gap", "largest gap", "length"),
    (r"reaction_(\d+)_([xyz])", "reaction of {boundary} on the body, ${1}$", "force"),
    (
        r"reaction_(point|edge)(\d+)_([xyz])",
        "reaction of support {0} {1} on the body, ${2}$",
        "force",
    ),
    ("load_([xyz])", "load on the body, ${0}$", "force"),
    ("axial_strain", r"axial strain $\varepsilon_{{zz}}$", None),
    ("axial_force", "axial force $N$", "section force"),
    (r"point(\d+)_([xyz])", "displacement of {point}, ${1}$", "length"),
    ("max_displacement", "largest displacement", "length"),
    ("max_stick_slip|max_slip", None, "length"),
    ("critical_cell_[xyz]", None, "length"),
    ("max_von_mises", "largest von Mises stress", "stress"),
    ("mean_von_mises", "mean von Mises stress", "stress"),
    ("capped_volume", "capped volume", "volume"),
    (r"(stored|strain|spring|adaptation|construction)_energy", None, "energy"),
    (r"(external|thermal)_work|duality_gap|energy_balance_defect", None, "energy"),
    (r"(viscous|friction)_dissipation", None, "energy"),
    (r"stored_energy_\w+|viscous_dissipation_\w+", None, "energy"),
    (r"area_\w+", None, "area"),
    (r"volume_\w+", None, "volume"),
    (r"integral_boundary_\d+_traction_[xyz]", None, "force"),
    (r"integral_boundary_\d+_displacement_[xyz]", None, "volume"),
    (r"integral_(?:body|material_\d+)_stress_\w+", None, "energy"),
    ("stress_norm", None, "stress norm"),
    ("velocity_variation", None, "rate norm"),
    (r"estimate_\w+|estimator|energy_norm|error_energy", None, "energy norm"),
    ("exact_energy|error_memory|time_indicator", None, "energy norm"),
]


# What the scene that is drawn calls its places: {"boundary 3": "roof"}.
names_of_places = {}
# The column of its quantity of interest, whose unit that of its error is.
of_interest = None


def set_scene(results):
    """Take from results what their scene calls its places and estimates."""
    global names_of_places, of_interest
    names_of_places = results.names
    about = results.about().get("estimated_error_of_quantity", {})
    of_interest = about.get("quantity")


def place(kind, number):
    """The name of `boundary' 3, or `boundary 3'."""
    text = f"{kind} {number}"
    return plain(names_of_places.get(text, text))


def plain(text):
    """A name as it is, not as mathematics."""
    return text.replace("$", r"\$")


def field(name):
    """(label, kind of unit) of a field of the body."""
    if name in SCALARS:
        return SCALARS[name]
    if name in VECTORS:
        words, symbol, kind = VECTORS[name]
        return f"{words} $|{symbol}|$", kind
    stem, _, component = name.rpartition("_")
    if stem in VECTORS:
        words, symbol, kind = VECTORS[stem]
        return f"{words} ${symbol}_{component}$", kind
    if stem in TENSORS:
        words, symbol, kind = TENSORS[stem]
        label = f"{words} ${symbol}_{{{component}}}$"
        # Principal values and normal components have a sign that means something.
        if kind == "stress" and component in ("xx", "yy", "zz", "1", "2", "3"):
            label += ", tension positive"
        return label, kind
    return plain(name), None


# The kinds of units of expressions of columns, see derived.py.
derived = {}


def column(name):
    """(label, kind of unit) of a column of statistics.csv."""
    if name in derived:
        words = name.replace("_", " ").replace("/", " / ").replace("*", " · ")
        return plain(words), derived[name]
    if re.fullmatch("wall_.*", name):
        return plain(f"seconds, {name[5:]}"), None
    words = plain(re.sub("^max_", "largest ", name).replace("_", " "))
    if of_interest and (name == "estimator" or name.startswith("quantity_")):
        kind = column(of_interest)[1]
        # Estimates of cells are recorded as roots.
        return words, kind and (units.ROOT * (name == "estimator") + kind)
    for pattern, template, kind in COLUMNS:
        match = re.fullmatch(pattern, name)
        if match:
            places = {
                kind: place(kind, next(filter(str.isdigit, match.groups())))
                for kind in ("boundary", "point")
                if f"{{{kind}}}" in (template or "")
            }
            return (template or words).format(*match.groups(), **places), kind
    # A field at a point: point0_stress_xx
    match = re.fullmatch(r"point(\d+)_(\w+)", name)
    if match:
        label, kind = field(match.group(2))
        return f"{label} at {place('point', match.group(1))}", kind
    return words, None


def in_titles(label):
    """A label without what it says of signs and components."""
    return label.split(", ")[0]
