# SPDX-License-Identifier: LGPL-2.1-or-later
"""Units of what a run computes, and axes that show them.

A scene may declare the units of length, time and stress; those of all other
quantities follow.  Numbers stay those of the scene: an axis or a text shows
them in the scene's unit, as the program does, or where they are large or small in a
handy multiple of it, seconds as days where there are many,
or without units in a power of ten, which stands in the label.
"""

import math
import re
from typing import NamedTuple

import numpy as np
from matplotlib.ticker import MaxNLocator, ScalarFormatter

PREFIXES = {"n": 1e-9, "µ": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6, "G": 1e9}
PREFIXES.update({"T": 1e12, "P": 1e15})
DAY = 86400.0
TIMES = {"s": 1.0, "min": 60.0, "h": 3600.0, "days": DAY, "years": 365.25 * DAY}
ALIASES = {
    **{"day": "days", "d": "days", "year": "years", "yr": "years", "a": "years"},
    **{"sec": "s", "hour": "h", "hours": "h", "N/mm^2": "MPa", "N/m^2": "Pa"},
}
ORDERS = {"length": "m", "stress": "Pa"}
# What follows from these two, in the plane on a unit of depth.
DERIVED = {
    "force": {2: "N/m", 3: "N"},
    "energy": {2: "J/m", 3: "J"},
    "surface energy": {2: "J/m²", 3: "J/m²"},
    "force density": {2: "N/m³", 3: "N/m³"},
    # Of a whole section in generalized plane strain.
    "section force": {2: "N", 3: "N"},
}


# Kinds whose units have names; those of others are written as products of powers.
KINDS = (
    *("stress", "length", "time", "area", "volume", "force", "energy"),
    *("surface energy", "force density", "energy norm", "velocity", "rate"),
    *("rate norm", "section force"),
)
ROOT = "root of "  # before a kind, as of what cells estimate


def powers(kind, dimension):
    """Of stress, length and time in the unit of a kind of quantity, or of these
    powers themselves."""
    if isinstance(kind, tuple):
        return kind
    if kind.startswith(ROOT):
        return tuple(0.5 * p for p in powers(kind.removeprefix(ROOT), dimension))
    return {
        "stress": (1, 0, 0),
        "length": (0, 1, 0),
        "time": (0, 0, 1),
        "area": (0, dimension - 1, 0),
        "volume": (0, dimension, 0),
        "force": (1, dimension - 1, 0),
        "energy": (1, dimension, 0),
        "surface energy": (1, 1, 0),
        "force density": (1, -1, 0),
        "section force": (1, 2, 0),
        "energy norm": (0.5, 0.5 * dimension, 0),
        "stress norm": (1, 0.5 * dimension, 0),
        "rate norm": (0.5, 0.5 * dimension, -0.5),
        "velocity": (0, 1, -1),
        "rate": (0, 0, -1),
        "temperature": (0, 0, 0),  # always in kelvins
    }[kind]


class Unit(NamedTuple):
    """A number of the scene reads number / size in this unit."""

    size: float
    text: str

    def label(self, words):
        return f"{words} [{self.text}]" if self.text else words

    def value(self, number, digits=4):
        """A number with its unit."""
        text = plain_number(number / self.size, digits)
        if text == "0":
            return f"0 {re.sub(TEN, '', self.text)}".strip()
        between = " × " if self.text.startswith("$10") else " "
        several = self.text in ("day", "year") and text != "1"
        unit = self.text + "s" * several
        return f"{text}{between}{unit}" if unit else text


def plain_number(value, digits=4):
    return f"{value:.{digits}g}" if 1e-3 <= abs(value) < 1e4 else f"{value:.3g}"


TEN = r"^\$10\^\{-?\d+\}\$ ?"


def power_of_ten(largest):
    """0 where numbers up to `largest` are short as they are."""
    if not 0.0 < largest < math.inf or 1e-2 <= largest < 1e4:
        return 0
    return 3 * math.floor(math.log10(largest) / 3)


def ten(power, unit=""):
    text = f"$10^{{{power}}}$" if power else ""
    return f"{text} {unit}".strip()


class Units:
    """declared   {"length": "m", "time": "s", "stress": "Pa"}, or some of them
    dimension  in two dimensions forces are those on a unit of depth
    duration   the end of the run, which velocities and rates go by"""

    def __init__(self, declared=None, dimension=3, duration=0.0):
        declared = {name: str(text).strip() for name, text in (declared or {}).items()}
        self.declared = {name: text for name, text in declared.items() if text}
        self.dimension = dimension
        self.duration = duration
        # How many meters, seconds and pascals one of each is, where known.
        self.known = {
            name: si(name, text)
            for name, text in self.declared.items()
            if si(name, text) is not None
        }

    @staticmethod
    def of(results):
        """The units of a directory of results."""
        times = [time for time, _ in results.solution]
        times += list(results.statistics.get("t", ()))[-1:]
        dimension = results.dimension() if results.solution else None
        if dimension is None:
            in_space = any(name.endswith("_z") for name in results.statistics)
            dimension = 3 if in_space else 2
        if results.is_of_revolution():
            dimension = 3
        return Units(results.units, dimension, max(times, default=0.0))

    def parts(self, kind):
        """[("stress", power), ...] of the unit of a kind, without zero powers."""
        names = "stress", "length", "time"
        return [part for part in zip(names, powers(kind, self.dimension)) if part[1]]

    def unit(self, kind, values):
        """The unit for numbers up to the size of the values; of no kind, or where
        the scene does not say, a power of ten."""
        if kind == "temperature":
            return Unit(1.0, "K")
        largest = float(np.abs(values).max(initial=0.0)) if np.size(values) else 0.0
        power = power_of_ten(largest)
        needed = [name for name, _ in self.parts(kind)] if kind else []
        if not kind or any(name not in self.declared for name in needed):
            return Unit(10.0**power, ten(power))
        own = self.own(kind)
        if own and (1.0 <= largest < 1e4 or (largest == 0.0 and kind in self.declared)):
            return Unit(1.0, own)
        named = isinstance(kind, str) and kind.removeprefix(ROOT) in KINDS
        if named and all(name in self.known for name in needed):
            return self.multiple(kind, largest)
        return Unit(10.0**power, ten(power, self.composed(kind)))

    def own(self, kind):
        """What the program calls the unit of the scene's numbers, where that is short."""
        if kind in self.declared:
            return self.declared[kind]
        length, time = self.declared.get("length"), self.declared.get("time")
        if kind == "velocity":
            return f"{length}/{time}"
        base = {"force": "N", "section force": "N", "energy": "J"}.get(kind)
        if not base or not {"length", "stress"} <= self.known.keys():
            return None
        power = 3 if kind == "energy" else 2
        size = self.known["stress"] * self.known["length"] ** power
        per = f"/{length}" if self.dimension == 2 and kind != "section force" else ""
        return next(
            (f"{p}{base}{per}" for p, of in PREFIXES.items() if abs(size / of - 1.0) < 1e-9),
            None,
        )

    def multiple(self, kind, largest):
        """The largest unit of the international system in which `largest` is
        at least one."""
        size = math.prod(self.known[name] ** power for name, power in self.parts(kind))
        choices = self.choices(kind)
        fitting = [unit for unit in choices if unit.size <= 1.0001 * largest * size]
        unit = max(fitting or choices[:1], key=lambda unit: unit.size)
        if largest == 0.0:
            unit = min(choices, key=lambda unit: abs(math.log(unit.size / size)))
        power = power_of_ten(largest * size / unit.size)
        return Unit(unit.size / size * 10.0**power, ten(power, unit.text))

    def choices(self, kind):
        """Units of the international system, the smallest first."""
        if kind == "time":
            # Three of the next one at least: 400 days rather than a year.
            found = [Unit(1e-6, "µs"), Unit(1e-3, "ms"), Unit(1.0, "s")]
            long = 3.0 * np.array([TIMES[name] for name in ("h", "days", "years")])
            for limit, name in zip(long, ("h", "days", "years")):
                if self.duration * self.known["time"] >= limit:
                    found.append(Unit(TIMES[name], name))
            return found
        if kind in ("velocity", "rate"):
            name = self.pace()
            per = name.removesuffix("s") if len(name) > 2 else name
            if kind == "rate":
                return [Unit(1.0 / TIMES[name], f"1/{per}")]
            return [
                Unit(size / TIMES[name], f"{prefix}m/{per}")
                for prefix, size in PREFIXES.items()
                if size <= 1e3
            ]
        energy = DERIVED["energy"][self.dimension]
        if kind == "energy norm":
            return [Unit(1.0, f"({energy})$^{{1/2}}$")]
        if kind == "rate norm":
            (rate,) = self.choices("rate")
            per = rate.text.removeprefix("1")
            return [Unit(rate.size**0.5, f"({energy}{per})$^{{1/2}}$")]
        if kind.startswith(ROOT):
            of = self.choices(kind.removeprefix(ROOT))
            unit = min(of, key=lambda unit: abs(math.log(unit.size)))
            return [Unit(unit.size**0.5, f"({unit.text})$^{{1/2}}$")]
        if kind in ("area", "volume"):
            power = powers(kind, self.dimension)[1]
            mark = {1: "", 2: "²", 3: "³"}[power]
            lengths = {"mm": 1e-3, "m": 1.0, "km": 1e3}
            return [Unit(size**power, name + mark) for name, size in lengths.items()]
        name, per = ORDERS.get(kind) or DERIVED[kind][self.dimension], 1.0
        if kind in ("force", "energy") and name.endswith("/m"):
            name, per = f"{name[:1]}/{self.declared['length']}", self.known["length"]
        return [
            Unit(size / per, prefix + name)
            for prefix, size in PREFIXES.items()
            if kind != "length" or size <= 1e3
        ]

    def pace(self):
        """The time that velocities go by: that of the scene, or instead of seconds
        years of runs over months, and so on."""
        if self.known["time"] > 1.0:
            return next(name for name, of in TIMES.items() if of == self.known["time"])
        seconds = self.duration * self.known["time"]
        for name, least in (("years", 100 * DAY), ("days", 3 * DAY), ("h", 3 * 3600.0)):
            if seconds >= least:
                return name
        return "s"

    def composed(self, kind):
        """The unit of a kind in words, where it is not one of the system."""
        parts = []
        for name, power in self.parts(kind):
            raised = f"$^{{{power:g}}}$" if power != 1 else ""
            parts.append(self.declared[name] + raised)
        return " ".join(parts)


def si(name, text):
    """How many meters, seconds or pascals that unit is, or None."""
    text = ALIASES.get(text, text).replace("u", "µ", 1 if text[:1] == "u" else 0)
    if name == "time" and text in TIMES:
        return TIMES[text]
    base = {"length": "m", "time": "s", "stress": "Pa"}.get(name, text)
    prefix = text.removesuffix(base)
    if text == prefix:
        return None
    return {**PREFIXES, "c": 1e-2}.get(prefix)


class Ticks(MaxNLocator):
    """Round numbers in a unit."""

    def __init__(self, size, **options):
        self.size = size
        options = {"nbins": "auto", "steps": [1, 2, 2.5, 5, 10], **options}
        super().__init__(**options)

    def tick_values(self, low, high):
        return super().tick_values(low / self.size, high / self.size) * self.size


class Numbers(ScalarFormatter):
    """Numbers in a unit, without a power of ten of their own.

    As text, which matplotlib would parse as mathematics, each of them: half of
    the time of a picture.
    """

    def __init__(self, size=1.0):
        super().__init__(useOffset=False)
        self.size = size
        self.set_scientific(False)

    def set_locs(self, places):
        super().set_locs(np.asarray(places) / self.size)

    def __call__(self, x, pos=None):
        label = super().__call__(x / self.size, pos)
        return label.removeprefix(r"$\mathdefault{").removesuffix("}$")


def show(axis, words, unit, **ticks):
    """Label a linear axis and number it in a unit."""
    axis.set_major_locator(Ticks(unit.size, **ticks))
    axis.set_major_formatter(Numbers(unit.size))
    axis.set_label_text(unit.label(words))
