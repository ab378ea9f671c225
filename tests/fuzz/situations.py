# SPDX-License-Identifier: LGPL-2.1-or-later
"""Scenes whose parts belong together, which chance alone would hardly put side by
side: bodies that only contact holds, stresses that balance their loads from the
beginning, foundations that meet and of which one moves."""

from dataclasses import dataclass
from typing import Callable

import bodies


@dataclass
class Situation:
    """body  that it takes, or None for any
    data  what draws boundaries and loads, or None for what chance draws
    """

    body: bodies.Body = None
    data: Callable = None


def draw(scene):
    kind = scene.random.random()
    count = lambda: scene.random.randint(1, 5 if scene.dim == 2 else 2)
    if kind < 0.3:
        if scene.chance(0.5):
            body = bodies.slab(scene)
        else:
            sides = [scene.random.choice((1, 2, 0.5)) for _ in range(scene.dim)]
            body = bodies.box(scene, [count() for _ in sides], sides)
        scene.may_turn = False
        return Situation(body, held_by_contact if kind < 0.18 else foundations_that_meet)
    if kind < 0.4:
        scene.may_turn = False
        return Situation(bodies.draw(scene), in_balance)
    return Situation()


def held_by_contact(scene):
    """A body under its weight on a foundation, pressed, lifted or pushed."""
    pick, chance = scene.random.choice, scene.chance
    up = scene.dim - 1
    below, above = 2 * up, 2 * up + 1
    for id in scene.pieces:
        scene.set(f"Boundary {id}/Role", "free")
    entry = lambda name: f"Boundary {below}/{name}"
    scene.set(entry("Role"), "contact")
    law = pick(("none", "tresca", "coulomb", "coulomb"))
    scene.contact(entry, law, unilateral=True)
    scene.foundation(entry, below)
    scene.entries.pop(entry("Foundation normal"), None)
    scene.motion(entry, law, unilateral=True)
    between_walls = law != "coulomb" or chance(0.5)
    if between_walls:
        for id in range(0, 2 * up, 2):
            scene.set(f"Boundary {id}/Role", "symmetry")

    if scene.equilibrate:
        scene.set("Initial state/Equilibrate", "true")
    # All in proportion, so that what presses at one time presses at all.
    grows = ("1", "(1 + [t])") if scene.equilibrate else ("[t]", "[t]^2", "min(4*[t], 1)")
    grows = scene.in_units(pick(grows))
    components = lambda axis, value: "; ".join(
        f"{value}*{grows}" if i == axis else "0" for i in range(scene.dim)
    )
    weight = scene.strain * scene.spread(-1, 0.3)  # a force per area of the face
    if chance(0.8):
        force = scene.number(-weight / scene.sides[up], stress=1, length=-1)
        scene.set("Loads/Body force", components(up, force))
    else:
        weight = 0
    # Where a corner is lifted nothing is known but that the whole is not.
    share = 1.0
    if scene.planes and not scene.entries.get("Geometry/Boundary ids") and chance(0.6):
        cut = pick(scene.planes)
        share = 1 - cut / scene.sides[0]
        ids = f"if(id == {above} && x > {scene.length(cut)}, 7, id)"
        scene.set("Geometry/Boundary ids", ids)
        above = 7
        scene.set(f"Boundary {above}/Role", "free")
    way = pick(("pressed", "lifted", "nothing")) if weight else "pressed"
    load = weight * pick((0.1, 0.5, 0.9)) / share
    if way == "pressed":
        load = -scene.strain * scene.spread(-1, 0.5)
    elif way == "lifted" and chance(0.15):
        load *= 3
    lift = load * share if way == "lifted" else 0.0
    if way != "nothing":
        scene.set(f"Boundary {above}/Role", "traction")
        traction = components(up, scene.stress(load))
        scene.set(f"Boundary {above}/Traction", traction)
    pushed = chance(0.4)
    if pushed:
        push = scene.strain * scene.spread(-2, 0) * pick((-1, 1))
        scene.set("Boundary 1/Role", "traction")
        scene.set("Boundary 1/Traction", components(0, scene.stress(push)))
    if between_walls and (way == "pressed" or lift < 0.99 * weight):
        # Whatever pushes it sideways is held by the walls, which also keep it
        # from turning over: it can only rise, and its loads keep it down.
        scene.promise = "held"


def in_balance(scene):
    """The stress at the beginning is that of the loads, on any mesh."""
    pick, chance = scene.random.choice, scene.chance
    scene.equilibrate = False
    scene.entries.pop("Initial state/Equilibrate", None)
    pressure = scene.strain * scene.spread(-1, 0.5)
    stress = [-pressure] * 3 + [0.0] * (1 if scene.dim == 2 else 3)
    straight = all(id in scene.outwards for id in scene.pieces)
    if straight and chance(0.5):
        stress = [float(f"{scene.load():.4g}") for _ in stress]
    scene.set("Initial state/Stress", "; ".join(map(scene.stress, stress)))
    isotropic = stress[0] == -pressure
    # xx; yy; zz; xy; xz; yz
    place = {(0, 0): 0, (1, 1): 1, (2, 2): 2, (0, 1): 3, (0, 2): 4, (1, 2): 5}
    component = lambda i, j: stress[place[min(i, j), max(i, j)]]
    more = lambda: f" + {scene.traction()}*{scene.from_zero()}" if chance(0.4) else ""
    ids = sorted(scene.pieces)
    held = pick(ids)
    for id in ids:
        entry = lambda name: f"Boundary {id}/{name}"
        role = "clamped" if id == held else pick(("traction",) * 3 + ("contact", "clamped"))
        if role == "contact" and not (isotropic and scene.pieces[id]):
            role = "traction"
        scene.set(entry("Role"), role)
        if role == "contact":
            law = pick(("tresca", "coulomb", "none"))
            scene.contact(entry, law, unilateral=chance(0.4))
            if entry("Normal stress") in scene.entries:
                scene.set(entry("Normal stress"), scene.stress(-pressure) + more())
            if scene.entries.get(entry("Contact law")) == "normal compliance":
                scene.set(entry("Contact law"), "unilateral")
                for name in "Compliance", "Compliance exponent":
                    scene.entries.pop(entry(name))
        elif role == "traction" and isotropic:
            scene.set(entry("Pressure"), scene.stress(pressure) + more())
        elif role == "traction":
            n = scene.outwards[id]
            on_face = [
                sum(component(i, j) * n[j] for j in range(scene.dim))
                for i in range(scene.dim)
            ]
            text = "; ".join(scene.stress(value) + more() for value in on_face)
            scene.set(entry("Traction"), text)
    scene.promise = "in balance"


def foundations_that_meet(scene):
    """Two or three faces in contact by laws of their own, of which one moves."""
    low = [2 * axis for axis in range(scene.dim)]
    faces = scene.random.sample(low, scene.random.randint(2, scene.dim))
    held = scene.random.choice([id for id in scene.pieces if id not in faces])
    for id in sorted(scene.pieces):
        if id in faces:
            scene.boundary(id, "contact", whole=False)
        elif id == held:
            scene.boundary(id, scene.random.choice(("clamped", "displacement")), True)
        else:
            scene.boundary(id, scene.random.choice(("free", "traction")), False)
    for id in faces[1:]:
        for name in "Foundation motion", "Foundation displacement":
            scene.entries.pop(f"Boundary {id}/{name}", None)
    scene.loads()
