# SPDX-License-Identifier: LGPL-2.1-or-later
"""Cases with a closed form or a published value: rows of a table and pictures."""

from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk

from plotting import style

from . import program

SCENES = program.SOURCE / "prm" / "verification"
EXACT, OURS = {"color": "#222222", "lw": 1.2}, {"color": "#0072b2", "ms": 3.5, "lw": 0}


@dataclass
class Row:
    """A quantity of a run beside its reference value."""

    case: str
    source: str
    quantity: str
    reference: float
    ours: float
    results: object

    def cells(self):
        info = self.results.info
        estimate = info["estimated_error"]
        relative = estimate["total"] / estimate["largest_energy_norm"]
        return (
            self.case,
            self.source,
            self.quantity,
            f"{self.reference:.4g}",
            f"{self.ours:.4g}",
            f"{100 * (self.ours / self.reference - 1):+.1g} %",
            f"{100 * relative:.2g} %",
            f"{self.results['wall_total'][-1]:.1f}",
        )


HEADER = (
    "case",
    "source",
    "quantity",
    "reference",
    "found",
    "difference",
    "estimated error, energy norm",
    "seconds",
)


class Contact:
    """The nodes of a contact face along x, at an output."""

    def __init__(self, results, index=-1):
        face = results.face(index)
        _, nodes = np.unique(face.points.round(12), axis=0, return_index=True)
        nodes = nodes[np.argsort(face.points[nodes, 0])]
        self.points = face.points[nodes]
        self.x = self.points[:, 0]
        self.pressure = face["contact_pressure"][nodes]
        self.shear = face["traction"][nodes, 0] if "traction" in face else None

    def integral(self, values):
        along = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return np.sum(along * (values[1:] + values[:-1])) / 2


def half_ellipse(x, b, a):
    """(b/a) sqrt(1 - x^2/b^2) within b, 0 beyond."""
    return np.sqrt(np.maximum(0, b**2 - x**2)) / a


def hertz(run, save):
    """A disc and a ball on a rigid plane."""
    source = "H. Hertz, J. reine angew. Math. 92 (1882)"
    stiffness = 1 / (1 - 0.3**2)
    disc, ball = run("hertz_disc_2d"), run("hertz_ball_3d")
    force = 2 * abs(disc["contact_force_y"][-1])
    width = np.sqrt(4 * force / (np.pi * stiffness))
    peak = 2 * force / (np.pi * width)
    line = Contact(disc)
    moment = line.integral(line.pressure * line.x**2) / line.integral(line.pressure)
    load = 4 * abs(ball["contact_force_z"][-1])
    radius = (0.75 * load / stiffness) ** (1 / 3)
    top = 1.5 * load / (np.pi * radius**2)

    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), sharey=True)
    s = np.linspace(0, 1.5, 400)
    face = Contact(ball)
    for axis, x, p, title in (
        (axes[0], line.x / width, line.pressure / peak, "disc, plane strain"),
        (
            axes[1],
            np.hypot(*face.points[:, :2].T) / radius,
            face.pressure / top,
            "ball, three dimensions",
        ),
    ):
        axis.plot(s, half_ellipse(s, 1, 1), label="Hertz", **EXACT)
        axis.plot(x, p, "o", label="nodes of the contact face", **OURS)
        axis.set_xlim(0, 1.5)
        axis.set_xlabel("distance from the middle over $a$")
        axis.set_title(title)
    axes[0].set_ylabel("pressure over $p_0$")
    axes[0].legend()
    save(figure, "hertz", "Pressure under a disc and a ball")
    return [
        Row("disc on a plane", source, "half width $a$", width, 2 * np.sqrt(moment), disc),
        Row("disc on a plane", source, "$p_0$", peak, disc["max_pressure"][-1], disc),
        Row("ball on a plane", source, "$p_0$", top, ball["max_pressure"][-1], ball),
    ]


def partial_slip(run, save):
    """Cattaneo and Mindlin: loading, the turn, and half of the way back."""
    source = "C. Cattaneo (1938); R. D. Mindlin (1949)"
    results = run("partial_slip_2d", {"Solver/Coulomb pressure": "Newton"})
    friction, nu, curvature = 0.2, 0.49, 100
    force = -results["contact_force_y"]
    ratio = -results["friction_force_x"] / (friction * np.maximum(force, 1e-9))
    time = results["t"]
    turn = int(np.argmin(abs(time - 2)))

    def exact(x, i):
        a = np.sqrt(4 * force[i] * curvature * (1 - nu**2) / np.pi)
        full = friction * 2 * force[i] / (np.pi * a)
        if i <= turn:
            stick = a * np.sqrt(1 - ratio[i])
            return full, half_ellipse(x, a, a) - half_ellipse(x, stick, a), a, stick
        stick = a * np.sqrt(1 - (ratio[turn] - ratio[i]) / 2)
        inner = a * np.sqrt(1 - ratio[turn])
        shear = -half_ellipse(x, a, a) + 2 * half_ellipse(x, stick, a)
        return full, shear - half_ellipse(x, inner, a), a, stick

    figure, axes = plt.subplots(figsize=(6.5, 3.6))
    s = np.linspace(-2, 2, 1000)
    shown = [turn - 2, turn, turn + 3]
    for i, color in zip(shown, ("#56b4e9", "#0072b2", "#d55e00")):
        full, q, a, _ = exact(s, i)
        axes.plot(s / a, q, **EXACT)
        face = Contact(results, i)
        look = {**OURS, "color": color, "label": f"$Q/\\mu P$ = {ratio[i]:.2f}"}
        axes.plot(face.x / a, face.shear / full, "o", **look)
    axes.set_xlim(-1.2, 1.2)
    axes.set_xlabel("$x/a$")
    axes.set_ylabel(r"shear stress over $\mu p_0$")
    axes.legend(title="loading, at the turn, on the way back", fontsize="small")
    save(figure, "cattaneo", "Shear stress of partial slip; lines: Cattaneo and Mindlin")
    rows = []
    for i, way in ((turn, "at the turn"), (turn + 3, "on the way back")):
        _, _, _, stick = exact(s, i)
        found = results["stick_area"][i] / 2
        rows.append(
            Row("partial slip", source, f"half width that sticks, {way}", stick, found, results)
        )
    return rows


def punch(run, save):
    """Spence: what sticks under a flat punch, over the friction coefficient."""
    source = "D. A. Spence, J. Elasticity 5 (1975)"
    nu = 0.45
    coupling = (1 - 2 * nu) / (2 * (1 - nu))

    def stuck(friction):
        return brentq(
            lambda c: ellipk(1 - c**2) / ellipk(c**2) - coupling / friction, 1e-9, 1 - 1e-9
        )

    runs = {
        friction: run(
            "literature/punch_with_friction", {"Boundary 4/Friction coefficient": friction}
        )
        for friction in (0.04, 0.055, 0.07, 0.1, 0.14)
    }
    figure, axes = plt.subplots(figsize=(5.5, 3.4))
    curve = np.linspace(0.03, 0.16, 60)
    axes.plot(curve, [stuck(mu) for mu in curve], label="Spence", **EXACT)
    found = [results["stick_area"][-1] for results in runs.values()]
    axes.plot(list(runs), found, "o", label="found", **{**OURS, "ms": 6})
    axes.set_xlabel("friction coefficient")
    axes.set_ylabel("half width that sticks")
    axes.set_ylim(0, 1)
    axes.legend()
    save(figure, "spence", "The part of a flat punch that sticks")
    return [
        Row(f"punch, mu = {mu}", source, "half width that sticks", stuck(mu), area, results)
        for (mu, results), area in zip(runs.items(), found)
        if mu in (0.07, 0.1)
    ]


def greco(run, save):
    source = "M. Raous, P. Chabrand, F. Lebon, J. Mec. Theor. Appl. 7 (1988)"
    published = 2.86, 2.72, 2.28, 1.98, 1.54
    results = run("literature/greco_plate")
    found = [1e5 * results[f"point{i}_x"][-1] for i in range(5)]
    places = 1e3 * np.array((0, 0.00125, 0.005, 0.0075, 0.01125))
    figure, axes = plt.subplots(figsize=(5.5, 3.4))
    axes.plot(places, published, "s", mfc="none", color="#222222", label="published")
    axes.plot(places, found, "o", label="found", **OURS)
    axes.set_xlabel("distance from the corner [mm]")
    axes.set_ylabel(r"displacement along the face [$10^{-5}$ m]")
    axes.legend()
    save(figure, "greco", "Plate pressed onto a plane, Coulomb's law with mu = 1")
    return [
        Row("GRECO plate", source, f"displacement at {x:g} mm, 1e-5 m", p, u, results)
        for x, p, u in zip(places, published, found)
    ]


def slip_zone(run, save):
    source = "J. Weertman, J. Geophys. Res. 85 (1980)"
    results = run("literature/slip_zone")
    nu, friction, excess = 0.2, 1, 0.05e-3
    stiffness = 4 / (2 * (1 + nu)) * (1 - nu) / (3 - 4 * nu)
    coupling = (1 - 2 * nu) / (2 * (1 - nu))
    a = np.arctan2(1, friction * coupling) / np.pi

    def slip(x):
        shape = np.sin(np.pi * a) * (1 - x) ** a * (1 + x) ** (1 - a)
        return excess / stiffness * shape

    line = results.line()
    last = line["t"] == line["t"].max()
    x, found = line["x"][last], line["displacement_x"][last]
    figure, axes = plt.subplots(figsize=(5.5, 3.2))
    s = np.linspace(-1, 1, 400)
    axes.plot(s, 1e4 * slip(s), label="Weertman", **EXACT)
    axes.plot(x, 1e4 * found, "o", label="found", **OURS)
    axes.set_xlabel("$x$")
    axes.set_ylabel("slip [$10^{-4}$]")
    axes.legend()
    save(figure, "slip_zone", "Slip between different bodies")
    middle = abs(x) < 1e-9
    return [
        Row("slip zone", source, "slip in the middle", slip(0.0), found[middle][0], results)
    ]


def creep(run, save):
    """The steady state of a thick cylinder, and the closure of a cavity."""
    source = "R. W. Bailey (1935); NAFEMS R0027"
    results = run(
        "literature/thick_cylinder_creep",
        {"Output/Lines": "100.01, 0.01 : 199.99, 0.01 : 65"},
    )
    p, n, a, b, rate = 200, 5, 100, 200, 3.125e-14
    strength = np.sqrt(3) * p / n / (a ** (-2 / n) - b ** (-2 / n))
    velocity = np.sqrt(3) / 2 * rate * strength**n / a

    def hoop(r):
        radial = -p * ((b / r) ** (2 / n) - 1) / ((b / a) ** (2 / n) - 1)
        return radial + 2 / np.sqrt(3) * strength * r ** (-2 / n)

    line = results.line()
    last = line["t"] == line["t"].max()
    figure, axes = plt.subplots(figsize=(5.5, 3.2))
    r = np.linspace(a, b, 200)
    axes.plot(r, hoop(r), label="steady state, closed form", **EXACT)
    axes.plot(line["x"][last], line["stress_yy"][last], "o", label="means of cells", **OURS)
    axes.set_xlabel("radius [mm]")
    axes.set_ylabel("hoop stress [MPa]")
    axes.legend()
    save(figure, "creep", "Thick cylinder in steady creep")
    cavity = run("literature/salt_cavity")
    p, n, rate, radius = 15, 3, 6e-6, 10
    strength = np.sqrt(3) * p / n / (1 - radius ** (-2 / n))
    closure = np.sqrt(3) / 2 * rate * strength**n
    return [
        Row(
            "thick cylinder, creep",
            source,
            "velocity inside, mm/h",
            velocity,
            results["point0_velocity_x"][-1],
            results,
        ),
        Row(
            "cavity in rock salt",
            "P. Berest, B. Brouard (2003)",
            "closure, m/day",
            closure,
            -cavity["point0_velocity_x"][-1],
            cavity,
        ),
    ]


def slab_on_bed(run, save):
    source = "Y. Weitsman, J. Appl. Mech. 37 (1970)"
    results = run("literature/slab_on_bed")
    bed, load = 50e6, 2e6
    bending = 30e9 / (1 - 0.2**2) * 0.25**3 / 12
    wave = (bed / 4 / bending) ** 0.25
    depth = load * wave / 2 / bed * (1 + np.cosh(np.pi)) / np.sinh(np.pi)
    return [
        Row("slab on a bed that does not pull", source, quantity, value, found, results)
        for quantity, value, found in (
            ("half length that lies on it, m", np.pi / 2 / wave, results["contact_area"][-1]),
            ("depth below the load, m", depth, results["max_penetration"][-1]),
        )
    ]


def two_bodies(run, save):
    patch = run("literature/contact_patch")
    roller = run("literature/roller_on_block")
    nafems = "A. Konter, NAFEMS (2006), benchmark 1"
    return [
        Row(
            "contact patch test",
            "R. L. Taylor, P. Papadopoulos (1991)",
            "pressure",
            0.01,
            patch["max_pressure"][-1],
            patch,
        ),
        Row(
            "roller on a block",
            nafems,
            "$p_0$, N/mm2",
            3585.37,
            roller["max_pressure"][-1],
            roller,
        ),
        Row(
            "roller on a block",
            nafems,
            "half width $a$, mm",
            6.21,
            roller["contact_area"][-1],
            roller,
        ),
    ]


def indenters(run, save):
    scene = "literature/indenter"
    sneddon = "I. N. Sneddon, Int. J. Engng Sci. 3 (1965)"
    boussinesq = "J. Boussinesq (1885)"
    punch = run(scene)
    cone = run(
        scene,
        {
            "Geometry/Boundary ids": "if(id == 2 && x < 2, 4, id)",
            "Boundary 4/Gap": "0.04/pi*x",
            "Boundary 4/Foundation displacement": "-0.02*t",
        },
    )
    circle = run(
        scene,
        {
            "Boundary 4/Role": "traction",
            "Boundary 4/Contact law": "not given",
            "Boundary 4/Pressure": "0.02/0.91/pi*t",
            "Boundary 4/Gap": "",
            "Boundary 4/Foundation displacement": "",
            "Output/Points": "0, 0; 1, 0",
        },
    )
    return [
        Row(
            "flat punch, round",
            sneddon,
            "force",
            0.02 / 0.91,
            -punch["contact_force_y"][-1],
            punch,
        ),
        Row(
            "cone",
            sneddon,
            "force",
            0.02 / 0.91,
            -cone["contact_force_y"][-1],
            cone,
        ),
        *(
            Row(
                "pressure on a circle",
                boussinesq,
                f"depth {where}",
                depth,
                circle[f"point{n}_y"][-1],
                circle,
            )
            for n, where, depth in (
                (0, "in the middle", 0.04 / np.pi),
                (1, "at the edge", 0.08 / np.pi**2),
            )
        ),
    ]


CASES = (hertz, indenters, partial_slip, punch, greco, slip_zone, creep, slab_on_bed, two_bodies)


def make(runner, images):
    """(rows, pictures) of all cases; runner.run() returns a directory of results."""
    style.set_up()
    rows, pictures = [], []

    def save(figure, name, caption):
        path = images / f"validation_{name}.png"
        figure.savefig(path, dpi=130, bbox_inches="tight", pad_inches=0.15)
        plt.close(figure)
        pictures.append((f"images/{path.name}", caption))

    for case in CASES:
        rows += case(runner, save)
    return rows, pictures
