# SPDX-License-Identifier: LGPL-2.1-or-later
"""What can be left out of a scene: its effects, one at a time, and what stands in
their place."""

from dataclasses import dataclass, field

from .scene import identifier
from .words import exact

# Of what an effect is: of the problem that is solved, of how it is discretized, or
# of what only watches the run and should change no answer.
KINDS = PROBLEM, DISCRETIZATION, OBSERVATION = (
    "problem",
    "discretization",
    "observation",
)

# What a temperature does, by entries of materials.
OF_HEAT = "Thermal expansion", "Activation energy"

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
    def changes_stiffness(self):
        """Whether energy norms are those of bodies that cannot be compared."""
        return self.instead == "rigid"

    @property
    def is_extreme(self):
        """Whether it has numbers that solvers may not stand, in the place of a limit."""
        return self.instead in ("rigid", "never")

    def excludes(self, other):
        """Whether both cannot be left out at once, or one contains the other."""
        if self.effect == other.effect:
            return True
        mine, theirs = (
            {entry.split("=", 1)[0]: entry for entry in variant.overrides}
            for variant in (self, other)
        )
        if any(theirs.get(path, entry) != entry for path, entry in mine.items()):
            return True
        return contains(self, other) or contains(other, self)


def contains(law, part):
    """Without a law there are no parameters of it."""
    return any(
        path.startswith(section) and "/" in path[len(section) :]
        for entry in law.overrides
        if entry.endswith("/Law=elastic")
        for section in [entry[: entry.index("/") + 1]]
        for path in (other.split("=", 1)[0] for other in part.overrides)
    )


def both(first, second):
    """Two simplifications at once."""
    return EffectVariant(
        f"{first.effect} and {second.effect}",
        f"{first.instead}; {second.instead}",
        first.overrides + second.overrides,
        first.kind,
        first.has_outputs,
        first.is_load,
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


def as_number(text):
    """None if it is an expression."""
    try:
        return float(text)
    except ValueError:
        return None


class Variants:
    """Collects the variants of one scene."""

    def __init__(self, scene, typical_stress, contact_force):
        self.scene = scene
        self.values, self.means = scene.values, scene.about["means"]
        self.areas, self.isotropic = (
            scene.about["areas"],
            scene.about["nearest_isotropic"],
        )
        self.typical_stress, self.contact_force = typical_stress, contact_force
        self.kind, self.is_load, self.result = PROBLEM, False, []

    def sections(self, kind):
        """Numbered sections, `Boundary 0' and so on, by their numbers."""
        names = {path.split("/", 1)[0] for path in self.values}
        ids = [
            int(name[len(kind) + 1 :]) for name in names if name.startswith(kind + " ")
        ]
        return {number: f"{kind} {number}" for number in sorted(ids)}

    def title(self, section):
        """What the scene calls it."""
        return self.scene.about.get("names", {}).get(section.lower(), section)

    def add(self, effect, instead, *overrides, has_outputs=False):
        self.result.append(
            EffectVariant(
                effect, instead, list(overrides), self.kind, has_outputs, self.is_load
            )
        )

    def add_mean(self, over, what, entry):
        """The mean over space or time of a datum, where that is something else."""
        mean = self.means.get(entry, {}).get(f"over_{over}")
        if mean is None or len(mean) >= LONGEST_TEXT:
            return
        overrides = [f"{entry}={mean}"]
        # What is there from the beginning needs stresses to hold it.
        if over == "time" and self.is_load:
            overrides.append("Initial state/Equilibrate=true")
        self.add(f"{what} over {over}", "its mean", *overrides)

    def collect(self):
        self.add_materials()
        for section in self.sections("Boundary").values():
            self.add_boundary(section)
        if not is_zero(self.scene["Loads/Body force"]):
            self.is_load = True
            self.add("body force", "none", "Loads/Body force=")
            for over in ("space", "time"):
                self.add_mean(over, "body force", "Loads/Body force")
            self.is_load = False
        if self.scene["Temperature/Value"].strip():
            self.add_no_temperature()
            for over in ("space", "time"):
                self.add_mean(over, "temperature", "Temperature/Value")
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
        told = [
            path
            for section in self.materials()
            for path in (f"{section}/{name}" for name in OF_HEAT)
            if not is_zero(self.scene[path] or "0")
        ]
        if len(told) > 1:
            told += (f"{section}/Law temperature" for section in self.materials())
            told += "Temperature/Value", "Temperature/Reference temperature"
            self.add("temperature", "none", *(f"{path}=" for path in told))

    def materials(self):
        """The sections that count."""
        return list(self.sections("Material").values()) or ["Material"]

    def add_materials(self):
        sections = self.materials()
        for section in sections:
            self.add_material(
                section, f" of {self.title(section)}" if len(sections) > 1 else ""
            )
        if len(sections) > 1 and self.pairs():
            for section in sections:
                self.add_rigid(section)
        # All of the first one.
        first = sections[0] + "/"
        same = [
            f"{other}/{path[len(first):]}={text}"
            for path, text in sorted(self.values.items())
            if path.startswith(first) and path != f"{first}Name"
            for other in sections[1:]
            if self.values[f"{other}/{path[len(first):]}"] != text
        ]
        if same:
            self.add(
                "different materials", f"{self.title(sections[0])} everywhere", *same
            )

    def pairs(self):
        """The boundaries that are in contact with another body."""
        return [
            section
            for section in self.sections("Boundary").values()
            if self.values[f"{section}/Role"] == "contact"
            and self.values.get(f"{section}/Against")
        ]

    def add_rigid(self, section):
        """One of two bodies as the foundation of the other."""
        modulus, ratio = (
            self.values[f"{section}/{name}"]
            for name in ("Young's modulus", "Poisson's ratio")
        )
        if section in self.isotropic:
            modulus, ratio = map(exact, self.isotropic[section])
        self.add(
            f"deformation of {self.title(section)}",
            "rigid",
            f"{section}/Law=elastic",
            f"{section}/Voigt matrix=",
            f"{section}/Young's modulus=1e4*({modulus})",
            f"{section}/Poisson's ratio={ratio}",
        )

    def add_material(self, section, of):
        law = self.scene[f"{section}/Law"]
        self.add_law(section, of, law)
        for name in OF_HEAT[: 1 if law == "elastic" else 2]:
            if not is_zero(self.scene[f"{section}/{name}"] or "0"):
                self.add(in_a_sentence(name) + of, "none", f"{section}/{name}=")
        self.add_mean("space", "thermal expansion" + of, f"{section}/Thermal expansion")
        moduli = ("Young's modulus", "Poisson's ratio")
        if section in self.isotropic:
            nearest = zip(moduli, self.isotropic[section])
            self.add(
                f"anisotropy{of}",
                "the nearest isotropic stiffness",
                f"{section}/Voigt matrix=",
                *(f"{section}/{name}={exact(value)}" for name, value in nearest),
            )
        else:
            for modulus in moduli:
                self.add_mean("space", modulus + of, f"{section}/{modulus}")
        of_law = f"{section}/{law}/"
        for path in sorted(self.values):
            if path.startswith(of_law):
                what = in_a_sentence(path[len(of_law) :]) + of
                for over in ("space", "time"):
                    self.add_mean(over, what, path)

    def add_law(self, section, of, law):
        if law == "elastic":
            return
        of_law, elastic = f"{section}/{law}/", f"{section}/Law=elastic"
        if law == "zener":
            self.add(f"relaxation{of}", "elastic at once", elastic)
            modulus = self.values[of_law + "Long-term Young's modulus"]
            ratio = self.values[of_law + "Long-term Poisson's ratio"]
            if not is_zero(modulus):
                self.add(
                    f"relaxation{of}",
                    "elastic with the long-term moduli",
                    elastic,
                    f"{section}/Voigt matrix=",
                    f"{section}/Young's modulus={modulus}",
                    f"{section}/Poisson's ratio={ratio}",
                )
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

        on, role = f" on {self.title(section)}", data("Role")
        is_contact = role == "contact"
        friction, contact = (
            data(f"{name} law") if is_contact else ""
            for name in ("Friction", "Contact")
        )
        gives_way = contact == "normal compliance"
        is_unilateral = contact == "unilateral" or gives_way
        is_coulomb = friction == "coulomb"
        loads, others = [], []
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
                self.add(
                    f"dependence of friction on the slip rate{on}",
                    "none",
                    f"{section}/Slip rate factor=1",
                )
        if is_unilateral:
            self.add_unilateral(section, on, gives_way, is_coulomb)
            if not is_zero(data("Gap")):
                others.append("Gap")
        if is_coulomb and not is_unilateral:
            loads.append("Normal stress")
        elif is_contact:
            loads.append("Foundation displacement")
        if role == "traction":
            loads.append("Traction")
        if role == "displacement":
            loads.append("Displacement")
        if role in ("traction", "displacement"):
            loads.append("Pressure")
            for name in ("Normal stiffness", "Tangential stiffness"):
                if not is_zero(data(name)):
                    what = f"{in_a_sentence(name)} of springs{on}"
                    self.add(what, "none", f"{section}/{name}=0")
                    others.append(name)

        def add_mean(over, name):
            # There is none of what is zero.
            if over == "time" or not is_zero(data(name)):
                self.add_mean(over, in_a_sentence(name) + on, f"{section}/{name}")

        for name in others:
            add_mean("time", name)
            add_mean("space", name)
        self.is_load = True
        if is_contact and not is_zero(data("Foundation motion")):
            motion = f"{section}/Foundation motion"
            self.add(f"motion of the foundation{on}", "at rest", f"{motion}=")
            # Its mean over time is no motion.
            add_mean("space", "Foundation motion")
        for name in loads:
            if not is_zero(data(name)):
                nothing = f"{section}/{name}={zeros_for(data(name))}"
                self.add(in_a_sentence(name) + on, "none", nothing)
                add_mean("time", name)
                add_mean("space", name)
        self.is_load = False

    def add_unilateral(self, section, on, gives_way, is_coulomb):
        normal = self.values[f"{section}/Foundation normal"].strip()
        if gives_way:
            self.add(
                f"compliance of the foundation{on}",
                "rigid",
                f"{section}/Contact law=unilateral",
            )
        # On curved pieces there is nothing but the foundation's normal.
        elif not is_coulomb and not normal:
            gap, displacement = (
                "0" if is_zero(text) else text
                for text in (
                    self.values[f"{section}/Gap"],
                    self.values[f"{section}/Foundation displacement"],
                )
            )
            self.add(
                f"opening of contact{on}",
                "bilateral",
                f"{section}/Contact law=bilateral",
                f"{section}/Foundation displacement=({gap}) + ({displacement})",
            )
        if not is_coulomb:
            return
        pressure = self.scene["Solver/Coulomb pressure"]
        other = "fixed point" if pressure == "lagged" else "lagged"
        self.add(
            f"pressure of Coulomb's law ({pressure}){on}",
            other,
            f"Solver/Coulomb pressure={other}",
        )
        # The normal force of the run, spread evenly over the face. What the
        # foundation held along its normal, something else has to hold.
        unilateral = [
            name
            for name in self.sections("Boundary").values()
            if self.values[f"{name}/Role"] == "contact"
            and self.values[f"{name}/Contact law"]
            in ("unilateral", "normal compliance")
            and name not in self.pairs()
        ]
        if (
            unilateral == [section]
            and not normal
            and self.contact_force
            and len(self.contact_force) < LONGEST_TEXT
        ):
            area = exact(self.areas[section.split()[1]])
            self.add(
                f"computed pressure{on}",
                "given, the mean over the face",
                f"{section}/Contact law=given normal stress",
                f"{section}/Normal stress=-({self.contact_force})/{area}",
                f"{section}/Gap=",
                f"{section}/Foundation displacement=0",
            )

    def add_discretization(self):
        scene = self.scene

        def alternative(what, path, others):
            mine = scene[path]
            for other in others:
                if other != mine:
                    self.add(f"{what} ({mine})", other, f"{path}={other}")

        full = scene["Material/Volumetric integration"] == "full"
        alternative(
            "volumetric integration",
            "Material/Volumetric integration",
            ["mean dilatation" if full else "full"],
        )
        if any(scene[f"{section}/Law"] != "elastic" for section in self.materials()):
            alternative(
                "stress history",
                "Material/Stress history",
                ["cell means", "quadrature points"],
            )
            alternative(
                "time scheme",
                "Time/Scheme",
                ["forward Euler", "backward Euler", "Heun"],
            )
        if scene.has_step_control:
            self.add(
                "step control", "the steps of the phases", "Step control/Tolerance=0"
            )
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
        if not needs_estimate and scene["Error control/Error bar"] == "true":
            self.add(
                "error bar",
                "none, and a fixed tolerance",
                "Error control/Error bar=false",
            )
        if any(
            scene.number(path) > 0.0
            for path in (
                "Output/Fields every",
                "Output/Fields interval",
                "Checkpoint/Every n steps",
                "Checkpoint/Wall time interval",
            )
        ):
            self.add("fields and checkpoints", "none", has_outputs=True)


def effect_variants(scene, typical_stress, contact_force=""):
    """The simplifications that a scene (with means) allows, in the order of its
    sections: flow and each part of a law, anisotropy, differences between materials,
    friction (none, or so much that nothing slips), motion of the foundation, each
    load, the initial state, changes of each datum over space and time; then the
    choices of the discretization, and what only watches.

    Typical stress: a von Mises stress at which a power law and a linear one are to
    flow at the same rate. Contact force: the size of the force of unilateral contact,
    as an expression of t; empty where it is not known."""
    return Variants(scene, typical_stress, contact_force).collect()
