# SPDX-License-Identifier: LGPL-2.1-or-later
"""A grammar of scenes: everything that a parameter file can ask for, combined
at random, in sizes of less than two seconds.

What is drawn with is in drawing.py, bodies in bodies.py, and scenes whose parts
belong together in situations.py.
"""

import bodies
import situations
from drawing import Drawing, Units


class Scene(Drawing):
    """Entries of a scene, drawn part by part.

    promise   what is known of the answer: a name of answers.PROMISES, or ""
    may_turn  whether the body may be turned and shifted
    """

    def __init__(self, random, units=Units()):
        super().__init__(random, units)
        self.promise = ""
        self.may_turn = True
        if units.declared:
            for name, unit in zip(("Length", "Stress", "Time"), units.declared):
                self.set(f"Units/{name}", unit)
        self.dim = 2 if self.chance(0.75) else 3
        self.set("Dimension", self.dim)
        # The size of strains, on which that of all data depends.
        self.strain = 10 ** random.uniform(-4, -1.5)
        if self.chance(0.06):
            self.strain = random.choice((1e-12, 1e-8, 1.0))
        self.equilibrate = self.chance(0.3)
        situation = situations.draw(self)
        self.geometry(situation.body)
        self.materials()
        if situation.data:
            situation.data(self)
        else:
            self.boundaries()
            self.loads()
        self.time()
        self.solver()
        self.output()

    # Parts of a scene

    def geometry(self, body=None):
        body = bodies.draw(self) if body is None else body
        self.pieces = body.pieces
        self.planes = body.planes
        self.sides = body.sides
        self.set("Geometry/Generator", body.generator)
        self.set("Geometry/Arguments", body.arguments)
        if body.ids:
            self.set("Geometry/Boundary ids", body.ids)
        elif body.planes and body.generator != "hyper_L" and self.chance(0.3):
            # a piece of its own, of one cell now and then
            id = self.random.choice((2, 3))
            cut = self.length(self.random.choice(body.planes))
            self.set("Geometry/Boundary ids", f"if(id == {id} && x > {cut}, 7, id)")
            self.pieces = self.pieces | bodies.flat(7)
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
        self.points = 0
        moved = False
        straight = all(body.pieces.values())
        if straight and self.may_turn and self.chance(0.3):
            moved = True
            angle = self.random.choice((30, 90, 180, self.random.uniform(-180, 180)))
            self.set("Geometry/Rotation angle", f"{angle:.5g}")
            if self.dim == 3 and self.chance(0.6):
                self.set("Geometry/Rotation axis", "1, 2, -0.5")
        if straight and self.may_turn and self.chance(0.12):
            moved = True
            shift = [self.random.choice((0, 1, -3, 50)) for _ in range(self.dim)]
            self.set("Geometry/Translation", self.point(*shift))
        self.outwards = {} if moved else body.outwards
        if body.points and not moved and self.chance(0.4):
            n = self.random.randint(1, len(body.points))
            self.points = n
            points = "; ".join(self.point(*p) for p in body.points[:n])
            self.set("Output/Points", points)

    def materials(self):
        self.viscous = False
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
        if n == 2 and self.chance(0.3):
            self.make_stiff("Material 2")
        self.parts = n
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
        viscosity = lambda value: self.number(value, stress=1, time=1) + vary
        if law == "maxwell":
            self.set(entry("Viscosity"), viscosity(shear * theta))
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
            self.set(entry("Viscosity"), viscosity(2 * shear * theta))
        elif law == "norton":
            n = pick((1, 1.5, 2, 3, 5))
            cap = pick((1, 2, 4)) if self.policy == "refuse" else 5
            factor = 1 / (3 * shear * theta * n * size ** (n - 1) * cap ** (n - 1))
            factor = self.number(factor, stress=-n, time=-1)
            self.set(entry("Rate factor"), factor + vary)
            self.set(entry("Exponent"), n)
            self.set(entry("Stress cap"), self.stress(size * cap))
        else:
            cap = self.stress(size * 3)
            slope = self.number(1 / (3 * shear * theta), stress=-1, time=-1)
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

    def make_stiff(self, section):
        """A stiff material beside a soft one."""
        entry = f"{section}/Young's modulus"
        if entry in self.entries:
            factor = self.random.choice((1e2, 1e3, 1e5, 1e7, 1e9, 1e11))
            self.set(entry, f"{self.entries[entry]}*{factor:g}")
            self.set(f"{section}/Law", "elastic")

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
            self.motion(entry, law, unilateral)

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
        """A foundation from much softer than the body to hardly different from a
        rigid one; the stiffness of a body of size 1 is about 1."""
        exponent = self.random.choice((1, 1, 1.5, 2, 3))
        stiffness = self.spread(*self.random.choice(((-1, 5), (-9, 9))))
        size = self.strain ** (1 - exponent) * stiffness
        size = self.number(size, stress=1, length=-exponent)
        self.set(entry("Contact law"), "normal compliance")
        self.set(entry("Compliance"), f"{size}*{self.in_space()}")
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

    def motion(self, entry, law, unilateral):
        """Of a foundation, towards the body and along it."""
        pick = self.random.choice
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
            force = lambda: self.number(self.load(), stress=1, length=-1)
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
        if self.parts == 2 and len(self.phases) > 1 and self.chance(0.4):
            when = self.random.choice(self.phases[:-1]).split(":")[0]
            self.set("Material 2/Removed at", when)
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
        if self.refinements > 0:
            self.chance(0)  # of an entry that is gone; scenes keep their numbers
        entry = lambda name: f"Mesh refinement/{name}"
        strategies = "residual", "kelly"
        if self.chance(0.15):
            self.set("Error control/Quantity", self.quantity())
            strategies = ("residual",)
        if self.chance(0.15) and "Step control/Tolerance" not in self.entries:
            self.set("Error control/Tolerance", self.random.choice((0.1, 0.3, 0.9)))
            self.set("Step control/Smallest step", self.duration(0.005))
            self.set(entry("Cell budget"), 200 if self.dim == 2 else 60)
        if self.chance(0.9) and any(
            f"Error control/{name}" in self.entries for name in ("Quantity", "Tolerance")
        ):
            self.entries.pop("Error control/Error bar", None)
        if "Error control/Tolerance" in self.entries:
            return
        if not self.chance(0.25):
            return
        self.set(entry("Strategy"), self.random.choice(strategies))
        self.maybe(0.5, entry("Every n steps"), 1, 2, 3)
        self.set(entry("Maximal level"), min(self.refinements + 1, 3))
        self.maybe(0.3, entry("Minimal level"), 1 if self.refinements else 0)
        self.maybe(0.4, entry("Refinement fraction"), 0, 0.1, 0.6)
        self.maybe(0.4, entry("Coarsening fraction"), 0, 0.3, 0.4)
        self.set(entry("Cell budget"), 200 if self.dim == 2 else 60)

    def quantity(self):
        """A column of statistics.csv that this scene has."""
        is_any = lambda *words: any(value in words for value in self.entries.values())
        roles = {id: self.entries[f"Boundary {id}/Role"] for id in self.pieces}
        held = [id for id, role in roles.items() if role in ("clamped", "symmetry")]
        names = [f"reaction_{id}_y" for id in held]
        if is_any("tresca", "coulomb"):
            names += ["friction_force_x", "friction_dissipation"]
        if is_any("unilateral", "normal compliance"):
            names += ["contact_force_x", "contact_force_y"]
        if self.points:
            names += ["point0_x", "point0_y"]
        return self.random.choice(names or ["friction_force_x"])

    def output(self):
        self.set("Output/Directory", "results")
        self.set("Output/Fields every", self.random.choice((0, 0, 1, 3)))
        self.maybe(0.15, "Output/Fields interval", self.duration(0.2))
        self.maybe(0.15, "Output/Reference fields", "true")
        if self.chance(0.3):
            self.set("Checkpoint/Every n steps", self.random.choice((1, 2, 3)))
            self.set("Checkpoint/Keep", 1000)
