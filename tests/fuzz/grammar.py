# SPDX-License-Identifier: LGPL-2.1-or-later
"""A grammar of scenes: everything that a parameter file can ask for, combined
at random, in sizes of less than two seconds.

Numbers are drawn for a body of size 1 with stresses and times of size 1 and
then multiplied by units of length, stress and time, so that one scene can be
drawn in several systems of units.
"""

import math
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Units:
    length: float = 1.0
    stress: float = 1.0
    time: float = 1.0


@dataclass
class Body:
    """A coarse mesh: pieces says of each boundary id whether it is flat,
    planes are its cuts in x along faces of cells, points lie inside, and
    outwards goes out of the body at some of its boundaries."""

    generator: str
    arguments: str
    cells: int
    pieces: dict
    planes: list = field(default_factory=list)
    points: list = field(default_factory=list)
    ids: str = ""
    outwards: dict = field(default_factory=dict)


def flat(*ids):
    return {id: True for id in ids}


def curved(*ids):
    return {id: False for id in ids}


class Scene:
    """Entries of a scene, drawn part by part."""

    def __init__(self, random, units=Units()):
        self.random = random
        self.units = units
        self.entries = {}
        self.dim = 2 if self.chance(0.75) else 3
        self.set("Dimension", self.dim)
        # The size of strains, on which that of all data depends.
        self.strain = 10 ** random.uniform(-4, -1.5)
        if self.chance(0.06):
            self.strain = random.choice((1e-12, 1e-8, 1.0))
        self.equilibrate = self.chance(0.3)
        self.geometry()
        self.materials()
        self.boundaries()
        self.loads()
        self.time()
        self.solver()
        self.output()

    # Words

    def set(self, entry, value):
        self.entries[entry] = str(value)

    def chance(self, probability):
        return self.random.random() < probability

    def maybe(self, probability, entry, *values):
        """One of the values, or the default of the program."""
        value = self.random.choice(values)
        if self.chance(probability):
            self.set(entry, value)

    def spread(self, low, high):
        """A number between two powers of ten."""
        return 10 ** self.random.uniform(low, high)

    def number(self, value, unit=1.0):
        """Few digits, times a unit; exact where that is a power of two."""
        value = float(f"{value:.4g}") * unit
        return repr(value) if math.frexp(unit)[0] == 0.5 else f"{value:.12g}"

    def length(self, value):
        return self.number(value, self.units.length)

    def stress(self, value):
        return self.number(value, self.units.stress)

    def duration(self, value):
        return self.number(value, self.units.time)

    def point(self, *coordinates):
        return ", ".join(self.length(c) for c in coordinates)

    def in_units(self, text):
        """An expression of coordinates and times of size 1."""
        for names, unit in (("xyz", self.units.length), ("t", self.units.time)):
            for name in names:
                quotient = name if unit == 1 else f"({name}/{unit!r})"
                text = text.replace(f"[{name}]", quotient)
        return text

    # Expressions

    def in_space(self):
        """A positive function of place."""
        return self.in_units(
            self.random.choice(
                ("1", "1", "1", "(1 + [x]^2)", "if([x] > 0.5, 0.2, 1)")
                + ("exp(-([y])^2)", "8^(-4*sin([x]))", "(1.5 + sin(7*[x]*[y]))")
                + ("(1 + [y]*[y])^0.5", "([x] < 0.3 ? 2 : 0.1)", "abs([x] - 0.4)")
            )
        )

    def from_zero(self):
        """A function of time that is zero at the beginning."""
        return self.in_units(
            self.random.choice(
                ("[t]", "[t]", "[t]", "[t]^2", "sin(4*[t])", "min([t], 1 - [t])")
                + ("[t]*exp(-[t])", "if([t] < 0.4, 0, 1)", "min([t], 0.5)")
                + ("sin(20*[t])", "([t] < 0.5 ? [t] : 1 - [t])", "(1 - cos(6*[t]))")
            )
        )

    def in_time(self):
        """A function of time for data that have to balance at the beginning."""
        if self.equilibrate and self.chance(0.4):
            return self.in_units(self.random.choice(("1", "(1 + [t])", "cos(5*[t])")))
        return self.from_zero()

    def not_negative_in_time(self):
        return self.in_units(
            self.random.choice(
                ("1", "1", "1", "1", "(1 + sin(9*[t]))", "abs(sin(7*[t]))", "[t]")
                + ("if([t] < 0.4, 0.5, 1)", "max(0, 0.7 - [t])", "if([t] < 0.6, 1, 0)")
            )
        )

    def datum(self, number):
        return f"{number}*{self.in_space()}*{self.in_time()}"

    def vector(self, number, probability=0.6):
        """Components; each is zero now and then."""
        return "; ".join(
            self.datum(number()) if self.chance(probability) else "0"
            for _ in range(self.dim)
        )

    def displacement(self):
        sign = self.random.choice((-1, 1))
        return self.length(self.strain * sign * self.spread(-1, 0.3))

    def traction(self):
        return self.number(self.load(), self.units.stress)

    def load(self):
        return self.strain * self.random.choice((-1, 1)) * self.spread(-1, 0.5)

    # Parts of a scene

    def body(self):
        pick, flat_sides = self.random.choice, flat(*range(2 * self.dim))
        count = lambda most: self.random.randint(1, most)
        kinds = ("box",) * 5 + ("L", "cell", "half shell", "quarter shell", "shell")
        kinds += ("hole", "half ball", "quarter ball")
        kinds += () if self.dim == 2 else ("cylinder", "cone")
        kind = pick(kinds)
        radii = f"{self.length(0.5)} : {self.length(1)}"
        origin = self.point(*[0] * self.dim)
        if kind == "box":
            cells = [count(6 if self.dim == 2 else 3) for _ in range(self.dim)]
            sides = [pick((1, 1, 2, 0.5, 0.1)) for _ in range(self.dim)]
            n = ", ".join(map(str, cells))
            planes = [sides[0] * i / cells[0] for i in range(1, cells[0])]
            outwards = {
                2 * axis + end: [(2 * end - 1) * (i == axis) for i in range(self.dim)]
                for axis in range(self.dim)
                for end in (0, 1)
            }
            return Body(
                "subdivided_hyper_rectangle",
                f"{n} : {origin} : {self.point(*sides)} : true",
                math.prod(cells),
                flat_sides,
                planes,
                [[s * self.random.random() for s in sides] for _ in range(2)],
                outwards=outwards,
            )
        if kind == "L":
            # in 3D deal.II tells no faces apart
            at = lambda axis, x: f"abs({axis} - {self.length(x)}) < {self.length(0.01)}"
            planes = [at(axis, x) for x in (0, 1, 0.5) for axis in "xyz"]
            ids = "8"
            for id in range(7, -1, -1):
                ids = f"if({planes[id]}, {id}, {ids})"
            return Body(
                "hyper_L",
                f"0 : {self.length(1)} : true",
                2**self.dim - 1,
                flat(*range(6 if self.dim == 2 else 9)),
                [0.5],
                ids="" if self.dim == 2 else ids,
            )
        if kind == "cell":
            # an affine image of the cube, so that all faces are flat
            edges = [
                [(i == j) + self.random.uniform(-0.4, 0.4) for j in range(self.dim)]
                for i in range(self.dim)
            ]
            corners = []
            for n in range(2**self.dim):
                chosen = [edge for i, edge in enumerate(edges) if n >> i & 1]
                corners.append([sum(e[j] for e in chosen) for j in range(self.dim)])
            text = "; ".join(self.point(*corner) for corner in corners)
            return Body("general_cell", f"{text} : true", 1, flat_sides)
        if kind == "half shell" and self.dim == 2:
            n = pick((2, 3, 4))
            arguments = f"{origin} : {radii} : {n} : true"
            pieces = curved(0, 1) | flat(2, 3)
            outwards = {0: (-1, 0), 1: (1, 0)}
            return Body("half_hyper_shell", arguments, n, pieces, outwards=outwards)
        if kind in ("half shell", "quarter shell"):
            pieces = curved(0, 1) | flat(*range(2, self.dim + 2))
            n = 3
            arguments = f"{origin} : {radii} : {n} : true"
            outwards = {0: [-1] * self.dim, 1: [1] * self.dim}
            return Body("quarter_hyper_shell", arguments, n, pieces, outwards=outwards)
        if kind == "shell":
            n = pick((6, 8)) if self.dim == 2 else 6
            arguments = f"{origin} : {radii} : {n} : true"
            return Body("hyper_shell", arguments, n, curved(0, 1))
        if kind == "hole" and self.dim == 2:
            lengths = " : ".join(map(self.length, (0.4, 1, 0.5, 0.5, 0.5, 0.5)))
            arguments = f"{lengths} : {origin} : 0 : 1 : {self.length(1)} : 2 : true"
            pieces = flat(0, 1, 2, 3) | curved(4)
            return Body("plate_with_a_hole", arguments, 24, pieces)
        if kind in ("hole", "half ball"):
            n = 4 if self.dim == 2 else 6
            arguments = f"{origin} : {self.length(1)}"
            outwards = {0: [1] + [0] * (self.dim - 1)}
            pieces = curved(0) | flat(1)
            return Body("half_hyper_ball", arguments, n, pieces, outwards=outwards)
        if kind == "quarter ball":
            near = f"abs({{}}) < {self.length(1e-6)}"
            ids = f"if({near.format('x')}, 1, if({near.format('y')}, 2, 3))"
            ids = f"if(id == 0, 0, {ids})"
            pieces = curved(0) | flat(*range(1, self.dim + 1))
            n = 3 if self.dim == 2 else 4
            arguments = f"{origin} : {self.length(1)}"
            outwards = {0: [1] * self.dim}
            return Body(
                "quarter_hyper_ball", arguments, n, pieces, ids=ids, outwards=outwards
            )
        if kind == "cylinder":
            return Body("cylinder", radii, 10, curved(0) | flat(1, 2))
        arguments = f"{self.length(0.6)} : {self.length(0.4)} : {self.length(1)}"
        return Body("truncated_cone", arguments, 5, curved(0) | flat(1, 2))

    def geometry(self):
        body = self.body()
        self.pieces = body.pieces
        self.planes = body.planes
        self.set("Geometry/Generator", body.generator)
        self.set("Geometry/Arguments", body.arguments)
        if body.ids:
            self.set("Geometry/Boundary ids", body.ids)
        elif body.planes and body.generator != "hyper_L" and self.chance(0.3):
            # a piece of its own, of one cell now and then
            id = self.random.choice((2, 3))
            cut = self.length(self.random.choice(body.planes))
            self.set("Geometry/Boundary ids", f"if(id == {id} && x > {cut}, 7, id)")
            self.pieces = self.pieces | flat(7)
        most = 130 if self.dim == 2 else 40
        cells, refinements = body.cells, 0
        while cells * 2**self.dim <= most and self.chance(0.65):
            cells, refinements = cells * 2**self.dim, refinements + 1
        self.refinements = refinements
        if refinements > 0:
            self.set("Geometry/Global refinements", refinements)
        if cells <= most and self.chance(0.2):
            id = self.random.choice(sorted(self.pieces))
            times = self.random.choice((1, 1, 2)) if cells < 20 else 1
            self.set("Geometry/Boundary refinements", f"{id}: {times}")
        moved = False
        straight = all(body.pieces.values())
        if straight and self.chance(0.3):
            moved = True
            angle = self.random.choice((30, 90, 180, self.random.uniform(-180, 180)))
            self.set("Geometry/Rotation angle", f"{angle:.5g}")
            if self.dim == 3 and self.chance(0.6):
                self.set("Geometry/Rotation axis", "1, 2, -0.5")
        if straight and self.chance(0.12):
            moved = True
            shift = [self.random.choice((0, 1, -3, 50)) for _ in range(self.dim)]
            self.set("Geometry/Translation", self.point(*shift))
        self.outwards = {} if moved else body.outwards
        if body.points and not moved and self.chance(0.4):
            n = self.random.randint(1, len(body.points))
            points = "; ".join(self.point(*p) for p in body.points[:n])
            self.set("Output/Points", points)

    def materials(self):
        self.viscous = False
        self.rate = 0.0
        n = 1
        ids = "0"
        if self.planes and self.chance(0.25):
            n = 2
            cut = self.length(self.random.choice(self.planes))
            ids = f"if(x > {cut}, 2, 1)"
        self.set("Geometry/Material ids", ids)
        # Explicit schemes with a policy, and backward Euler, stand any rate.
        self.scheme = self.random.choice(("forward Euler", "backward Euler", "Heun"))
        policies = "refuse", "refuse", "subdivide", "backward Euler"
        self.policy = self.random.choice(policies)
        for i in range(n):
            self.material("Material" if n == 1 else f"Material {i + 1}")
        self.maybe(0.2, "Material/Stress history", "cell means", "quadrature points")
        modes = "automatic", "full", "mean dilatation"
        self.maybe(0.2, "Material/Volumetric integration", *modes)

    def material(self, section):
        pick = self.random.choice
        modulus = self.spread(-0.5, 0.5)
        poisson = pick((0.3, 0.3, 0.0, 0.25, 0.45, 0.499, -0.5, 0.4999))
        if self.chance(0.12):
            self.voigt(section)
        else:
            vary = pick(("", "", "", "*(1 + [x]^2)", "*if([y] > 0.4, 3, 1)"))
            vary = self.in_units(vary)
            self.set(f"{section}/Young's modulus", self.stress(modulus) + vary)
            self.set(f"{section}/Poisson's ratio", poisson)
        laws = "elastic", "maxwell", "maxwell", "zener", "perzyna", "norton", "parsed"
        law = pick(laws)
        self.set(f"{section}/Law", law)
        if law == "elastic":
            return
        self.viscous = True
        entry = lambda name: f"{section}/{law}/{name}"
        # The relaxation time; the run takes time 1 in some ten steps.
        if self.scheme == "backward Euler" or self.policy == "backward Euler":
            theta = self.spread(-3, 1.5)
        else:
            theta = self.spread(-0.5 if self.policy == "refuse" else -1.2, 1.5)
        shear = modulus / (2 * (1 + poisson))
        size = self.strain * modulus
        vary = pick(("", "", self.in_units("*(1 + [t])"), f"*(1 + {self.in_space()})"))
        stress_time = self.units.stress * self.units.time
        if law == "maxwell":
            self.set(entry("Viscosity"), self.number(shear * theta, stress_time) + vary)
        elif law == "zener":
            share = pick((0, 0.01, 0.3, 0.5, 1))
            long_term = self.stress(share * modulus * 0.99)
            self.set(entry("Long-term Young's modulus"), long_term)
            self.set(entry("Long-term Poisson's ratio"), poisson)
            self.set(entry("Relaxation time"), self.duration(theta) + vary)
        elif law == "perzyna":
            radius = size * pick((0, 0.01, 0.3, 1, 1e3))
            self.set(entry("Yield radius"), self.stress(radius) + vary)
            moduli = map(self.stress, (0, 0.1, modulus))
            self.maybe(0.5, entry("Hardening modulus"), *moduli)
            self.set(entry("Viscosity"), self.number(2 * shear * theta, stress_time))
        elif law == "norton":
            n = pick((1, 1.5, 2, 3, 5))
            cap = pick((1, 2, 4)) if self.policy == "refuse" else 5
            factor = 1 / (3 * shear * theta * n * size ** (n - 1) * cap ** (n - 1))
            unit = 1 / (self.units.stress**n * self.units.time)
            self.set(entry("Rate factor"), self.number(factor, unit) + vary)
            self.set(entry("Exponent"), n)
            self.set(entry("Stress cap"), self.stress(size * cap))
        else:
            cap, unit = self.stress(size * 3), self.units.stress * self.units.time
            slope = self.number(1 / (3 * shear * theta), 1 / unit)
            rate = pick(
                (
                    f"{slope}*sigma_eq",
                    f"{slope}*min(sigma_eq, {cap})",
                    f"{slope}/{cap}*min(sigma_eq, {cap})^2",
                    f"{slope}*sigma_eq*exp(-min(eps_eq/{self.number(self.strain)}, 5))",
                    f"{slope}*max(0, sigma_eq - {self.stress(size / 2)} - 0.3*p)",
                    f"{slope}*if(t > {self.duration(0.5)}, sigma_eq, 0)",
                )
            )
            self.set(entry("Strain rate"), rate)
            factors = self.in_space(), self.not_negative_in_time()
            self.maybe(0.4, entry("Factor"), *factors)

    def voigt(self, section):
        """Orthotropic, or with a coupling that plane strain permits."""
        pick = self.random.choice
        rows = [[4, 1, 1, 0, 0, 0], [1, 3, 1, 0, 0, 0], [1, 1, 2, 0, 0, 0]]
        rows += [[0, 0, 0, pick((1, 0.3)), 0, 0], [0, 0, 0, 0, pick((1, 0.5)), 0]]
        rows += [[0, 0, 0, 0, 0, pick((1, 0.7))]]
        if self.chance(0.5):
            rows[0][5] = rows[5][0] = 0.2
        text = "; ".join(", ".join(map(self.stress, row)) for row in rows)
        self.set(f"{section}/Voigt matrix", text)

    def boundaries(self):
        ids = sorted(self.pieces)
        self.random.shuffle(ids)
        # Something has to hold the body; now and then nothing does.
        held = self.chance(0.9)
        # A face of contact comes first where there is a choice.
        faces = [id for id in ids if self.pieces[id]]
        contact = faces[0] if faces and self.chance(0.85) else None
        holder = next((id for id in ids if id != contact), None) if held else None
        for id in ids:
            if id == contact:
                role = "contact"
            elif id == holder:
                role = self.random.choice(("clamped",) * 3 + ("displacement", "glued"))
            else:
                roles = ("free",) * 4 + ("traction",) * 3 + ("displacement",)
                roles += ("contact",) * 3 + ("symmetry",)
                role = self.random.choice(roles)
            if role in ("contact", "symmetry", "glued") and not self.pieces[id]:
                # Only unilateral contact takes a curved face, whose foundation
                # has a normal.
                if role != "contact" or id not in self.outwards:
                    role = "clamped" if id == holder else "free"
            self.boundary(id, role, whole=id == holder)

    def boundary(self, id, role, whole):
        entry = lambda name: f"Boundary {id}/{name}"
        self.set(entry("Role"), "contact" if role == "glued" else role)
        if role == "displacement":
            parts = [
                self.datum(self.displacement()) if whole or self.chance(0.5) else "free"
                for _ in range(self.dim)
            ]
            self.set(entry("Displacement"), "; ".join(parts))
        elif role == "traction":
            if self.chance(0.3):
                self.set(entry("Pressure"), self.datum(self.traction()))
            else:
                self.set(entry("Traction"), self.vector(self.traction))
        elif role in ("contact", "glued"):
            laws = ("tresca",) * 3 + ("coulomb",) * 2 + ("none", "glued")
            law = "glued" if role == "glued" else self.random.choice(laws)
            unilateral = law != "glued" and self.chance(0.4)
            if not self.pieces[id]:
                law = self.random.choice(("none", "tresca", "coulomb"))
                unilateral = True
            self.contact(entry, law, unilateral)
            if unilateral:
                self.foundation(entry, id)

    def foundation(self, entry, id):
        """Where it is, of contact that opens and closes."""
        pick = self.random.choice
        size = self.length(self.strain * self.spread(-1.5, 0))
        far = ("0", "0", "1", "[x]^2", "([x] - 0.5)^2", "([x]^2 + [y]^2)")
        far += ("(1 + sin(9*[x]*[y]))", "if([x] > 0.5, 0, 1)", "abs([x] - 0.4)")
        if self.equilibrate:
            far += ("([x] - 0.3)", "cos(7*[x])")  # overlaps at the beginning
        gap = f"{size}*{self.in_units(pick(far))}"
        if self.chance(0.4):
            gap += f" + ({self.displacement()})*{self.from_zero()}"
        if gap != f"{size}*0" or self.chance(0.5):
            self.set(entry("Gap"), gap)
        if not self.pieces[id] or (id in self.outwards and self.chance(0.3)):
            tilt = [pick((0, 0, 0.1, -0.3)) for _ in range(self.dim)]
            normal = [a + b for a, b in zip(self.outwards[id], tilt)]
            self.set(entry("Foundation normal"), ", ".join(f"{n:g}" for n in normal))

    def compliance(self, entry):
        """A foundation from softer than the body to hardly different from rigid."""
        exponent = self.random.choice((1, 1, 1.5, 2, 3))
        unit = self.units.stress / self.units.length**exponent
        size = self.strain ** (1 - exponent) * self.spread(-1, 5)
        self.set(entry("Contact law"), "normal compliance")
        self.set(entry("Compliance"), self.number(size, unit) + f"*{self.in_space()}")
        self.set(entry("Compliance exponent"), str(exponent))

    def contact(self, entry, law, unilateral):
        pick = self.random.choice
        self.set(entry("Friction law"), law)
        if unilateral and self.chance(0.25):
            self.compliance(entry)
        elif unilateral:
            self.set(entry("Contact law"), "unilateral")
        size = pick((0, 1e-9, 0.01, 0.03, 0.1, 0.1, 0.3, 0.3, 1, 1, 10, 1e6))
        if law == "tresca":
            vary = f"*{self.in_space()}*{self.not_negative_in_time()}"
            self.set(entry("Friction bound"), self.stress(size * self.strain) + vary)
        if law == "coulomb":
            coefficients = (0, 0.01, 0.1, 0.3, 0.5, 1, 3, 1e5)
            if unilateral:
                coefficients = (0, 0.1, 0.2, 0.3, 0.3, 0.5, 1, 30)
                self.maybe(0.5, "Solver/Coulomb pressure", "lagged", "fixed point")
                self.maybe(0.4, "Solver/Coulomb tolerance", "1e-3", "1e-9")
            else:
                pressure = self.stress(-self.strain * self.spread(-1, 0.5))
                self.set(entry("Normal stress"), self.datum(pressure))
            coefficient = pick(coefficients)
            vary = f"*{self.in_space()}*{self.not_negative_in_time()}"
            self.set(entry("Friction coefficient"), f"{coefficient}{vary}")
        if (law != "coulomb" or unilateral) and self.chance(0.35):
            self.set(entry("Foundation displacement"), self.datum(self.displacement()))
        if law != "none" and self.chance(0.35):
            motions = [self.vector(self.displacement)]
            if self.dim == 2:
                turn = f"{self.number(self.strain)}*{self.from_zero()}"
                motions.append(f"-{turn}*y; {turn}*x")
            self.set(entry("Foundation motion"), pick(motions))

    def loads(self):
        if self.chance(0.3):
            unit = self.units.stress / self.units.length
            force = lambda: self.number(self.load(), unit)
            self.set("Loads/Body force", self.vector(force))
        if self.equilibrate:
            self.set("Initial state/Equilibrate", "true")
            if self.chance(0.3):
                n = 4 if self.dim == 2 else 6
                stress = "; ".join(
                    self.traction() if self.chance(0.6) else "0" for _ in range(n)
                )
                self.set("Initial state/Stress", stress)

    def time(self):
        pick = self.random.choice
        self.phases = []
        end = 0.0
        for _ in range(pick((1, 1, 1, 2, 3))):
            end += pick((0.25, 0.5, 1.0))
            self.phases.append(f"{self.duration(end)}: {pick((1, 2, 3, 4, 5, 8))}")
        self.set("Time/Phases", ", ".join(self.phases))
        self.set("Time/Scheme", self.scheme)
        if self.policy != "refuse" and self.chance(0.9 if self.viscous else 0.2):
            self.set("Time/Stiffness policy", self.policy)
        if self.chance(0.3):
            control = lambda name: f"Step control/{name}"
            self.set(control("Tolerance"), pick((0.03, 0.1, 0.3)))
            times = sorted(pick((0.1, 0.25, 0.4, 0.7)) for _ in range(pick((1, 2))))
            times = [self.duration(value * end) for value in sorted(set(times))]
            self.maybe(0.4, control("Landing times"), ", ".join(times))
            self.maybe(0.2, control("Land on kinks"), "false")
            self.maybe(0.4, control("Resolve events"), "true", "false")
            self.set(control("Event tolerance"), pick((0.02, 0.1, 0.5)))
            self.maybe(0.4, control("Largest step"), self.duration(pick((0.1, 0.3))))
            self.set(control("Smallest step"), self.duration(0.005))

    def solver(self):
        self.maybe(0.5, "Solver/Linear solver", "direct", "multigrid", "automatic")
        self.maybe(0.25, "Solver/Contact tolerance", "1e-6", "1e-8", "1e-10", "1e-12")
        # Step control needs it.
        off = 0.05 if "Step control/Tolerance" in self.entries else 0.25
        self.maybe(off, "Error control/Error bar", "false")
        self.maybe(0.15, "Error control/Algebraic fraction", "0.5", "0.001")
        if self.refinements > 0 and self.chance(0.12):
            self.set("Error control/Two-level comparison", "true")
        entry = lambda name: f"Mesh refinement/{name}"
        if self.chance(0.15):
            id = self.random.randrange(2 * self.dim)
            self.set(
                "Error control/Quantity",
                self.random.choice(("friction_force_x", f"reaction_{id}_y")),
            )
        if self.chance(0.15) and "Step control/Tolerance" not in self.entries:
            self.set("Error control/Tolerance", self.random.choice((0.1, 0.3, 0.9)))
            self.set("Step control/Smallest step", self.duration(0.005))
            self.set(entry("Cell budget"), 200 if self.dim == 2 else 60)
            return
        if not self.chance(0.25):
            return
        self.set(entry("Strategy"), self.random.choice(("residual", "kelly")))
        self.maybe(0.5, entry("Every n steps"), 1, 2, 3)
        self.set(entry("Maximal level"), min(self.refinements + 1, 3))
        self.maybe(0.3, entry("Minimal level"), 1 if self.refinements else 0)
        self.maybe(0.4, entry("Refinement fraction"), 0, 0.1, 0.6)
        self.maybe(0.4, entry("Coarsening fraction"), 0, 0.3, 0.4)
        self.set(entry("Cell budget"), 200 if self.dim == 2 else 60)

    def output(self):
        self.set("Output/Directory", "results")
        self.set("Output/Fields every", self.random.choice((0, 0, 1, 3)))
        self.maybe(0.15, "Output/Fields interval", self.duration(0.2))
        self.maybe(0.15, "Output/Reference fields", "true")
        if self.chance(0.3):
            self.set("Checkpoint/Every n steps", self.random.choice((1, 2, 3)))
            self.set("Checkpoint/Keep", 1000)
