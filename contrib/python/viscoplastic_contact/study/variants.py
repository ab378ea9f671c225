# SPDX-License-Identifier: LGPL-2.1-or-later
"""What can be left out of a scene: its effects, one at a time, and what stands in
their place."""

from dataclasses import dataclass, field, replace

from .scene import identifier
from .words import exact

# Of what an effect is: of the problem that is solved, of how it is discretized, or
# of what only watches the run and should change no answer.
KINDS = "problem", "discretization", "observation"
PROBLEM, DISCRETIZATION, OBSERVATION = KINDS

# What a temperature does, by entries of materials.
OF_HEAT = "Thermal expansion", "Activation energy"

# Entries of materials and boundaries.
MODULI = "Young's modulus", "Poisson's ratio"
DISPLACEMENT = "Foundation displacement"

# How often there are fields and checkpoints.
OUTPUTS = (
    *("Output/Fields every", "Output/Fields interval"),
    *("Checkpoint/Every n steps", "Checkpoint/Wall time interval"),
)

# muParser refuses expressions of 20000 characters.
LONGEST_TEXT = 15000


@dataclass
class EffectVariant:
    """A scene with one of its effects left out or simplified, by entries
    `Section/Entry=value'. Its run may be the one that writes fields and checkpoints,
    which other runs of studies go without; a load is what drives the scene."""

    effect: str
    instead: str
    overrides: list = field(default_factory=list)
    kind: str = PROBLEM
    has_outputs: bool = False
    is_load: bool = False

    @property
    def name(self):
        """For directories."""
        return identifier(f"{self.effect}__{self.instead}")

    @property
    def is_extreme(self):
        """Whether it has numbers that solvers may not stand, in the place of a limit."""
        return self.instead in ("rigid", "never")

    @property
    def entries(self):
        return dict(entry.split("=", 1) for entry in self.overrides)

    def excludes(self, other):
        """Whether both cannot be left out at once, or one contains the other."""
        mine, theirs = self.entries, other.entries
        return (
            self.effect == other.effect
            or any(theirs.get(path, value) != value for path, value in mine.items())
            or contains(mine, theirs)
            or contains(theirs, mine)
        )


def contains(law, part):
    """Without a law there are no parameters of it."""
    for path, value in law.items():
        if path.endswith("/Law") and value == "elastic":
            section = path[: -len("Law")]
            if any(p.startswith(section) and "/" in p[len(section) :] for p in part):
                return True
    return False


def both(first, second):
    """Two simplifications at once."""
    return replace(
        first,
        effect=f"{first.effect} and {second.effect}",
        instead=f"{first.instead}; {second.instead}",
        overrides=first.overrides + second.overrides,
    )


def is_zero(expression):
    """Whether an expression is zero for everybody to see."""
    return all(not part.strip("0. -+") for part in expression.split(";"))


def zeros_for(expression):
    """The expression with every component that it gives replaced by zero."""
    parts = (part.strip() for part in expression.split(";"))
    return "; ".join(part if part in ("", "free") else "0" for part in parts)


def in_a_sentence(entry):
    """ "friction bound" of "Friction bound"; names keep their capitals."""
    if entry.startswith(("Young", "Poisson")):
        return entry
    return entry[0].lower() + entry[1:]


def moduli(section, *values):
    """The entries of an isotropic material."""
    pairs = zip(MODULI, values)
    return [f"{section}/Voigt matrix=", *(f"{section}/{n}={v}" for n, v in pairs)]


def as_number(text):
    """None if it is an expression."""
    try:
        return float(text)
    except ValueError:
        return None


class Variants:
    """Collects the variants of one scene."""

    def __init__(self, scene, typical_stress, contact_force):
        self.scene, self.values, about = scene, scene.values, scene.about
        self.means, self.areas = about["means"], about["areas"]
        self.isotropic = about["nearest_isotropic"]
        self.typical_stress, self.contact_force = typical_stress, contact_force
        self.kind, self.is_load, self.result = PROBLEM, False, []

    def sections(self, kind):
        """Numbered sections, `Boundary 0' and so on, by their numbers."""
        names = {path.split("/", 1)[0] for path in self.values}
        found = (name for name in names if name.startswith(kind + " "))
        return sorted(found, key=lambda name: int(name[len(kind) + 1 :]))

    def contacts(self):
        """Contact laws by boundary, and the boundaries against other bodies."""
        found = [
            section
            for section in self.sections("Boundary")
            if self.values[f"{section}/Role"] == "contact"
        ]
        laws = {section: self.values[f"{section}/Contact law"] for section in found}
        return laws, [s for s in found if self.values.get(f"{s}/Against")]

    def title(self, section):
        """What the scene calls it."""
        return self.scene.about.get("names", {}).get(section.lower(), section)

    def add(self, effect, instead, *overrides, has_outputs=False):
        of_kind = self.kind, has_outputs, self.is_load
        self.result.append(EffectVariant(effect, instead, list(overrides), *of_kind))

    def add_mean(self, over, what, entry):
        """The mean over space or time of a datum, where that is something else."""
        mean = self.means.get(entry, {}).get(f"over_{over}")
        if mean is None or len(mean) >= LONGEST_TEXT:
            return
        # What is there from the beginning needs stresses to hold it.
        begins = ["Initial state/Equilibrate=true"] * (over == "time" and self.is_load)
        self.add(f"{what} over {over}", "its mean", f"{entry}={mean}", *begins)

    def add_means(self, what, entry, order=("space", "time")):
        for over in order:
            self.add_mean(over, what, entry)

    def collect(self):
        self.add_materials()
        for section in self.sections("Boundary"):
            self.add_boundary(section)
        if not is_zero(self.scene["Loads/Body force"]):
            self.is_load = True
            self.add("body force", "none", "Loads/Body force=")
            self.add_means("body force", "Loads/Body force")
            self.is_load = False
        if self.scene["Temperature/Value"].strip():
            self.add_no_temperature()
            self.add_means("temperature", "Temperature/Value")
        initial = "Initial state/Stress", "Initial state/Displacement"
        if any(self.scene[path] for path in initial):
            self.add("initial state", "none", *(f"{path}=" for path in initial))
        self.kind = DISCRETIZATION
        self.add_discretization()
        self.kind = OBSERVATION
        self.add_observation()
        return self.result

    def add_no_temperature(self):
        """Where it does more than one thing: one alone has a variant of its own."""
        sections = self.materials()
        paths = [f"{section}/{name}" for section in sections for name in OF_HEAT]
        told = [path for path in paths if not is_zero(self.scene[path] or "0")]
        if len(told) > 1:
            told += (f"{section}/Law temperature" for section in sections)
            told += "Temperature/Value", "Temperature/Reference temperature"
            self.add("temperature", "none", *(f"{path}=" for path in told))

    def materials(self):
        """The sections that count."""
        return self.sections("Material") or ["Material"]

    def add_materials(self):
        first, *others = sections = self.materials()
        for section in sections:
            self.add_material(section, f" of {self.title(section)}" if others else "")
        if others and self.contacts()[1]:
            for section in sections:
                self.add_rigid(section)
        # All of the first one.
        same = [
            f"{other}{path[len(first):]}={text}"
            for path, text in sorted(self.values.items())
            if path.startswith(f"{first}/") and path != f"{first}/Name"
            for other in others
            if self.values[f"{other}{path[len(first):]}"] != text
        ]
        if same:
            self.add("different materials", f"{self.title(first)} everywhere", *same)

    def add_rigid(self, section):
        """One of two bodies as the foundation of the other."""
        modulus, ratio = (self.values[f"{section}/{name}"] for name in MODULI)
        if section in self.isotropic:
            modulus, ratio = map(exact, self.isotropic[section])
        self.add(
            f"deformation of {self.title(section)}",
            "rigid",
            f"{section}/Law=elastic",
            *moduli(section, f"1e4*({modulus})", ratio),
        )

    def add_material(self, section, of):
        law = self.scene[f"{section}/Law"]
        self.add_law(section, of, law)
        for name in OF_HEAT[: 1 if law == "elastic" else 2]:
            if not is_zero(self.scene[f"{section}/{name}"] or "0"):
                self.add(in_a_sentence(name) + of, "none", f"{section}/{name}=")
        self.add_mean("space", "thermal expansion" + of, f"{section}/Thermal expansion")
        if section in self.isotropic:
            nearest = moduli(section, *map(exact, self.isotropic[section]))
            self.add(f"anisotropy{of}", "the nearest isotropic stiffness", *nearest)
        else:
            for modulus in MODULI:
                self.add_mean("space", modulus + of, f"{section}/{modulus}")
        of_law = f"{section}/{law}/"
        for path in sorted(self.values):
            if path.startswith(of_law):
                self.add_means(in_a_sentence(path[len(of_law) :]) + of, path)

    def add_law(self, section, of, law):
        if law == "elastic":
            return
        of_law, elastic = f"{section}/{law}/", f"{section}/Law=elastic"
        if law == "zener":
            self.add(f"relaxation{of}", "elastic at once", elastic)
            long_term = [self.values[f"{of_law}Long-term {name}"] for name in MODULI]
            if not is_zero(long_term[0]):
                entries = elastic, *moduli(section, *long_term)
                self.add(f"relaxation{of}", "elastic with the long-term moduli", *entries)
            return
        self.add(f"viscous flow{of}", "elastic", elastic)
        if law == "perzyna" and not is_zero(self.values[of_law + "Hardening modulus"]):
            self.add(f"hardening{of}", "none", of_law + "Hardening modulus=0")
        if law == "norton" and self.typical_stress > 0.0:
            exponent = as_number(self.values[of_law + "Exponent"])
            if exponent is not None and exponent != 1.0:
                factor = exact(self.typical_stress ** (exponent - 1.0))
                rate = self.values[of_law + "Rate factor"]
                self.add(
                    f"power of the flow law{of}",
                    "1, same rate at the mean stress",
                    of_law + "Exponent=1",
                    f"{of_law}Rate factor={factor}*({rate})",
                )

    def add_boundary(self, section):
        def data(name):
            return self.values[f"{section}/{name}"]

        def add_means(name, order=("time", "space")):
            # There is none over space of what is zero.
            order = order[:1] if is_zero(data(name)) else order
            self.add_means(in_a_sentence(name) + on, f"{section}/{name}", order)

        on, role = f" on {self.title(section)}", data("Role")
        is_contact, loads, others = role == "contact", [], []
        friction = data("Friction law") if is_contact else ""
        contact = data("Contact law") if is_contact else ""
        is_unilateral = contact in ("unilateral", "normal compliance")
        is_coulomb = friction == "coulomb"
        if friction in ("tresca", "coulomb"):
            name = "Friction coefficient" if is_coulomb else "Friction bound"
            self.add(f"friction{on}", "none", f"{section}/{name}=0")
            # Where there is none, there is none. With such a coefficient the step's
            # own pressure may have no solution; bounds of the last one hold, too.
            never = [f"{section}/{name}=1e6*({data(name)})"]
            if is_coulomb and is_unilateral:
                never.append("Solver/Coulomb pressure=lagged")
            self.add(f"slip{on}", "never", *never)
            others.append(name)
            if data("Slip rate factor").strip() != "1":
                effect = f"dependence of friction on the slip rate{on}"
                self.add(effect, "none", f"{section}/Slip rate factor=1")
        if is_unilateral:
            self.add_unilateral(section, on, contact, is_coulomb)
            others += [] if is_zero(data("Gap")) else ["Gap"]
        if is_coulomb and not is_unilateral:
            loads.append("Normal stress")
        elif is_contact:
            loads.append("Foundation displacement")
        if role in ("traction", "displacement"):
            loads += role.capitalize(), "Pressure"
            for name in ("Normal stiffness", "Tangential stiffness"):
                if not is_zero(data(name)):
                    what = f"{in_a_sentence(name)} of springs{on}"
                    self.add(what, "none", f"{section}/{name}=0")
                    others.append(name)
        for name in others:
            add_means(name)
        self.is_load = True
        if is_contact and not is_zero(data("Foundation motion")):
            motion = f"{section}/Foundation motion="
            self.add(f"motion of the foundation{on}", "at rest", motion)
            # Its mean over time is no motion.
            add_means("Foundation motion", ("space",))
        for name in loads:
            if not is_zero(data(name)):
                nothing = f"{section}/{name}={zeros_for(data(name))}"
                self.add(in_a_sentence(name) + on, "none", nothing)
                add_means(name)
        self.is_load = False

    def add_unilateral(self, section, on, contact, is_coulomb):
        normal = self.values[f"{section}/Foundation normal"].strip()
        law = f"{section}/Contact law="
        if contact == "normal compliance":
            self.add(f"compliance of the foundation{on}", "rigid", law + "unilateral")
        # On curved pieces there is nothing but the foundation's normal.
        elif not is_coulomb and not normal:
            texts = (self.values[f"{section}/{n}"] for n in ("Gap", DISPLACEMENT))
            gap, displacement = ("0" if is_zero(text) else text for text in texts)
            place = f"{section}/{DISPLACEMENT}=({gap}) + ({displacement})"
            self.add(f"opening of contact{on}", "bilateral", law + "bilateral", place)
        if not is_coulomb:
            return
        path = "Solver/Coulomb pressure"
        pressure = self.scene[path]
        other = "fixed point" if pressure == "lagged" else "lagged"
        self.add(f"pressure of Coulomb's law ({pressure}){on}", other, f"{path}={other}")
        # The normal force of the run, spread evenly over the face. What the
        # foundation held along its normal, something else has to hold.
        laws, pairs = self.contacts()
        one_sided = "unilateral", "normal compliance"
        unilateral = [s for s in laws if laws[s] in one_sided and s not in pairs]
        is_known = 0 < len(self.contact_force) < LONGEST_TEXT
        if unilateral == [section] and not normal and is_known:
            area = exact(self.areas[section.split()[1]])
            self.add(
                f"computed pressure{on}",
                "given, the mean over the face",
                law + "given normal stress",
                f"{section}/Normal stress=-({self.contact_force})/{area}",
                f"{section}/Gap=",
                f"{section}/{DISPLACEMENT}=0",
            )

    def add_discretization(self):
        scene = self.scene

        def alternative(what, path, others):
            mine = scene[path]
            for other in others:
                if other != mine:
                    self.add(f"{what} ({mine})", other, f"{path}={other}")

        integration = "Material/Volumetric integration"
        other = "mean dilatation" if scene[integration] == "full" else "full"
        alternative("volumetric integration", integration, [other])
        if any(scene[f"{section}/Law"] != "elastic" for section in self.materials()):
            histories = "cell means", "quadrature points"
            alternative("stress history", "Material/Stress history", histories)
            schemes = "forward Euler", "backward Euler", "Heun"
            alternative("time scheme", "Time/Scheme", schemes)
        if scene.has_step_control:
            phases = "the steps of the phases"
            self.add("step control", phases, "Step control/Tolerance=0")
        if scene.is_adaptive:
            self.add("adaptive mesh", "the first mesh", "Mesh refinement/Strategy=none")

    def add_observation(self):
        scene = self.scene
        needs_estimate = (
            scene.has_tolerance
            or scene["Error control/Quantity"]
            or scene["Mesh refinement/Strategy"] != "none"
            or scene.has_step_control
        )
        bar = "Error control/Error bar"
        if not needs_estimate and scene[bar] == "true":
            self.add("error bar", "none, and a fixed tolerance", f"{bar}=false")
        if any(scene.number(path) > 0.0 for path in OUTPUTS):
            self.add("fields and checkpoints", "none", has_outputs=True)


def effect_variants(scene, typical_stress, contact_force=""):
    """The simplifications that a scene (with means) allows, of the problem first.

    Typical stress: a von Mises stress at which a power law and a linear one are to
    flow at the same rate. Contact force: the size of the force of unilateral contact,
    as an expression of t; empty where it is not known."""
    return Variants(scene, typical_stress, contact_force).collect()
