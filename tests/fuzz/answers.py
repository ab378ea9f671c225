# SPDX-License-Identifier: LGPL-2.1-or-later
"""Whether the answer to a scene can be right, by what holds in any scene: the
discrete identities, the balance of energy, and that a run agrees with itself.

Each function returns what is wrong, or nothing.
"""

import json
import re
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "regression"))

from harness import COUPLED, Run, TestCase

PAIR = re.compile(r"(?<![\w.])([-+.\de]*\d) of ([-+.\de]*\d)(?![\w.%])")

# Powers of length, stress and time in the unit of a column, where d stands for
# the dimension.
UNITS = {
    "t": (0, 0, 1),
    "cells": (0, 0, 0),
    "stick_area": (-1, 0, 0),
    "slip_area": (-1, 0, 0),
    "max_pressure": (0, 1, 0),
    "max_gap": (1, 0, 0),
    "strain_energy": ("d", 1, 0),
    "stored_energy": ("d", 1, 0),
    "friction_dissipation": ("d", 1, 0),
    "viscous_dissipation": ("d", 1, 0),
    "max_displacement": (1, 0, 0),
    "max_von_mises": (0, 1, 0),
}


# Words of refusals that contradict what is known of a scene: that its loads keep
# the body down between walls, and that its initial stress balances its loads.
PROMISES = {
    "held": re.compile(
        r"No contact force balances|converge|not found|definite|come to rest"
    ),
    "in balance": re.compile(r"\(2\.12\)|violat|No contact force balances"),
}


def of_promise(promise, sentence):
    best = re.search(r"bound is (\S+) at best", sentence)
    if best and float(best[1]) < 1e-9:
        return ""  # rounding, of a tolerance that asks for more
    made = re.search(r"rounding alone makes (\S+) or more", sentence)
    if made and float(made[1]) > 1e-3:
        return ""  # no solution is in these numbers
    if "use the direct linear solver" in sentence:
        return ""  # which is the one for such a body
    if promise and PROMISES[promise].search(sentence):
        return f"refused, but it is {promise}: {sentence[:300]}"
    return ""


def results(work, stdout=""):
    process = SimpleNamespace(returncode=0, stdout=stdout, stderr="")
    return Run(work / "results", process)


def tolerance(entries):
    """The bound on the algebraic error of a step."""
    given = float(entries.get("Solver/Contact tolerance", 0))
    has_bar = entries.get("Error control/Error bar", "true") == "true"
    return given or (COUPLED if has_bar else 1e-8)


def rest_of_iterations(entries):
    """How far numbers may differ between iterations that stop elsewhere."""
    return min(1e-3, max(1e-6, 1e3 * tolerance(entries)))


def of_identities(run, stdout, entries):
    bound = max(tolerance(entries), rounding(run, entries))
    if "rounding leaves an error of the solver" in stdout:
        # which is then more than the tolerance, but no more than is refused
        bound = max(bound, min(1e-3, 1.01 * run["algebraic_error"].max()))
    # beyond this the program has to warn (doc/error_bar.md)
    balance = max(1e-8, min(1e3 * bound, 1e-2))
    of_forces = "load_", "reaction_", "friction_force_", "contact_force_"
    forces = [
        abs(column).max()
        for name, column in run.statistics.items()
        if name.startswith(of_forces)
    ]
    work = max(forces) * run["max_displacement"].max()
    is_small = lambda part: work < part * run["stored_energy"].max()
    if "forces balance only to" in stdout:
        if is_small(1e-8):
            return "warning: forces that do not balance are rounding of zero"
        balance = np.inf
    elif is_small(min(1, 1e3 * bound)):
        balance = np.inf  # beside stresses that balance each other
    if run["strain_energy"].max() < 1e-20 * run["stored_energy"].max():
        return ""  # motions of a body at rest in its initial stress are rounding
    try:
        TestCase().check_identities(run, bound, balance)
    except AssertionError as error:
        # the name of the identity is in the last words
        return "identities: " + " ".join(str(error).split())
    return ""


def of_times(run):
    if not np.array_equal(run["step"], np.arange(len(run["step"]))):
        return "times: steps are missing"
    if not np.all(np.diff(run["t"]) > 0):
        return "times: they do not increase"
    return ""


def of_words(stdout):
    """Two numbers that contradict each other."""
    for line in stdout.splitlines():
        for part, whole in PAIR.findall(line):
            if float(part) > float(whole) * (1 + 1e-4):
                return f"contradiction: {line.strip()}"
        share = re.search(r"on (\d+) % of the face", line)
        if share and int(share[1]) > 100:
            return f"contradiction: {line.strip()}"
    return ""


def of_fields(run):
    """Fields that are not finite, in the last output."""
    for name in ("solution", "contact"):
        if (run.directory / f"{name}.pvd").exists() and run.series(name):
            fields = run.fields(name)
            for kind in (fields.point_data, fields.cell_data):
                for key, values in kind.items():
                    if not np.all(np.isfinite(values)):
                        return f"fields: {key} in {name} is not finite"
    return ""


def of_files(run):
    try:
        run.info
    except json.JSONDecodeError as error:
        return f"files: run.json is no JSON ({error})"
    table = run.directory / "uncertainty.csv"
    if table.exists() and re.search(r"\b(nan|inf)\b", table.read_text()):
        return "files: uncertainty.csv has numbers that are not finite"
    return ""


def is_constant(entries, *names):
    return not any(
        re.search(r"\bt\b", value)
        for entry, value in entries.items()
        if entry.endswith(names)
    )


def has_computed_pressure(entries):
    """Whether a bound of friction is that of a pressure that comes out."""
    return any(
        value in ("unilateral", "normal compliance")
        and entries.get(entry.replace("Contact law", "Friction law")) == "coulomb"
        for entry, value in entries.items()
        if entry.endswith("Contact law")
    )


def has_large_friction(entries):
    """Whether Coulomb's law may have several solutions, each one certified."""
    return has_computed_pressure(entries) and any(
        float(re.match(r"\d[\d.]*", str(value))[0]) > 3
        for entry, value in entries.items()
        if entry.endswith("Friction coefficient") and str(value)[:1].isdigit()
    )


def may_share_corners(entries):
    """Whether friction of one piece may take of what presses a corner onto another:
    any part of it that is within its bound. The bounds of the other follow."""
    pieces = [
        entry
        for entry, value in entries.items()
        if entry.endswith("Friction law") and value in ("coulomb", "tresca")
    ]
    return has_computed_pressure(entries) and len(pieces) > 1


def rounding(run, entries):
    """What rounding of its displacements leaves of the error of a step in the
    plane, where a body that hardly strains is carried far."""
    energy, motion = run["strain_energy"], run["max_displacement"]
    strains = energy > 0
    if entries.get("Dimension") == "3" or not strains.any():
        return 0.0
    norm = np.sqrt(2 * energy[strains])
    return 1e-12 * (stiffness(entries) ** 0.5 * motion[strains] / norm).max()


def stiffness(entries):
    """About the largest of the materials."""
    moduli = [
        float(re.match(r"[\d.e+-]+", value)[0])
        for entry, value in entries.items()
        if entry.endswith(("Young's modulus", "Voigt matrix"))
        and "Long-term" not in entry
    ]
    return max(moduli, default=1.0)


def is_unstressed(run, entries):
    """Whether stresses are rounding beside the stiffness: a rigid motion."""
    return run["max_von_mises"].max() < 1e-9 * stiffness(entries)


def of_energy(run, stdout, entries):
    """The defect of the balance of energy is the error in time of friction
    alone (doc/method.md, section 10)."""
    if is_unstressed(run, entries):
        return ""
    defect = run["energy_balance_defect"]
    moved = abs(np.diff(run["external_work"])).sum()
    energy = moved + run["stored_energy"][0]
    meshes = abs(run.statistics.get("adaptation_energy", np.zeros(1))).max()
    if "Warning" in stdout and "energ" in stdout:
        return ""
    if max(meshes, abs(defect).max()) > 2 * energy + 1e-300:
        return (
            f"energy: defect {abs(defect).max():.3g} and meshes {meshes:.3g} are more "
            f"than twice the work {energy:.3g}, without a warning"
        )
    if "adaptation_energy" in run.statistics:
        return ""
    # What iterations leave, and rounding of the terms.
    energy = moved + run["stored_energy"].max() + run["strain_energy"].max()
    rest = (10 * tolerance(entries) + 1e-10) * energy
    step = abs(np.diff(defect))
    bounds = "Friction bound", "Friction coefficient", "Normal stress"
    if "friction_dissipation" not in run.statistics:
        allowed = rest
    elif has_computed_pressure(entries):
        return ""  # which changes, and the bounds with it
    elif is_constant(entries, *bounds):
        # |lambda_n - lambda_(n-1)| <= 2 rho, and lambda_n . s_n = rho |s_n|
        allowed = np.diff(run["friction_dissipation"]) + rest
    else:
        return ""
    # The first step also balances initial data.
    if np.any((step > allowed)[1:]):
        n = 1 + int(np.argmax((step - allowed)[1:]))
        return (
            f"energy: the defect of step {n + 1} is {step[n]:.3g}, not at most "
            f"{np.broadcast_to(allowed, step.shape)[n]:.3g} of {energy:.3g}"
        )
    return ""


def of_run(work, stdout, entries):
    """All that can be said of one run."""
    run = results(work, stdout)
    return (
        of_identities(run, stdout, entries)
        or of_times(run)
        or of_words(stdout)
        or of_files(run)
        or of_fields(run)
        or of_energy(run, stdout, entries)
    )


def of_other_units(run, other, dimension, units, entries):
    """other is the same scene, but in these units of length, stress, time."""
    if is_unstressed(run, entries):
        return ""
    # Iterations stop at the same only where no digit changes; where the times of
    # steps do, energies may by 1.1e-6 of 1e-3 of the error bar.
    bound = rest_of_iterations(entries) if units.names else 1e-6
    if chooses_steps(entries):
        bound = max(bound, 1e-5)
    if len(run["t"]) != len(other["t"]):
        return f"units: {len(run['t'])} steps, but {len(other['t'])} in other units"
    # Where a foundation is touched without pressure, rounding decides who does.
    touches = "contact_area" in run.statistics
    # The force of a corner that friction of one piece and contact of another
    # hold is shared between them in more than one way.
    forces = re.compile(r"(?:contact|friction)_force_(\d+)_")
    shares = len(set(forces.findall(" ".join(run.statistics)))) > 1
    for name, powers in UNITS.items():
        if name not in run.statistics or (touches and name.endswith("_area")):
            continue
        if shares and name == "max_pressure":
            continue
        scale = 1.0
        for unit, power in zip((units.length, units.stress, units.time), powers):
            power = {"d": dimension, -1: dimension - 1}.get(power, power)
            scale *= unit**power
        here, there = run[name], other[name] / scale
        size = abs(here).max()
        if name == "max_gap":  # of what touches everywhere it is rounding
            size = max(size, 1e-6 * run["max_displacement"].max())
        if name.endswith("dissipation"):
            size = max(size, abs(run["stored_energy"]).max())
        if abs(here - there).max() > bound * size:
            return (
                f"units: {name} is {here[-1]:.9g} at the end, "
                f"but {there[-1]:.9g} in other units"
            )
    return ""


def chooses_steps(entries):
    return "Step control/Tolerance" in entries or "Error control/Tolerance" in entries


def of_other_iterations(what, one, other, entries):
    """On other numbers of ranks, or with another linear solver, iterations stop
    elsewhere, but meshes and steps are the same, and numbers up to the tolerance
    of iterations. Steps that errors choose move with them: then the ends are
    compared."""
    if has_large_friction(entries):
        return ""  # iterations may lead to different solutions of the law
    n, m = len(one["t"]), len(other["t"])
    if n != m and not (chooses_steps(entries) and abs(n - m) <= 0.1 * max(n, m)):
        return f"{what}: {n} steps, but {m}"
    same_times = n == m and np.allclose(one["t"], other["t"], rtol=1e-9, atol=0)
    rows = slice(None) if same_times else slice(-1, None)
    if not np.array_equal(one["cells"][rows], other["cells"][rows]):
        return f"{what}: {one['cells'][-1]:g} cells, but {other['cells'][-1]:g}"
    if is_unstressed(one, entries):
        return ""
    bound = 1e-2 if may_share_corners(entries) else rest_of_iterations(entries)
    for name in "strain_energy", "max_displacement":
        difference = abs(one[name][rows] - other[name][rows]).max()
        size = abs(one[name]).max()
        if name == "strain_energy":
            # a soft bed stores far more, and lets the body go a long way, of which
            # this energy is rounding
            size = max(size, 1e-3 * abs(one["stored_energy"]).max())
        if difference > bound * size:
            return f"{what}: {name} is {one[name][-1]:.9g}, but {other[name][-1]:.9g}"
    return ""
