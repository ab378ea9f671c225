# SPDX-License-Identifier: LGPL-2.1-or-later
"""Words and numbers of drawn scenes, in any system of units.

Numbers are drawn for a body of size 1 with stresses and times of size 1 and
then multiplied by units of length, stress and time, so that one scene can be
drawn in several systems of units.
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Units:
    """The size of length, stress and time 1 in the units of the scene.

    names     of units that numbers have behind them, as m, MPa, day
    declared  what the scene says in its section Units of its own units
    """

    length: float = 1.0
    stress: float = 1.0
    time: float = 1.0
    names: tuple = ()
    declared: tuple = ()

    def of(self, *powers):
        """The unit of these powers of length, stress and time."""
        units = self.length, self.stress, self.time
        return math.prod(unit**power for unit, power in zip(units, powers))

    def words(self, *powers):
        """What stands behind a number of this unit, or nothing."""
        powers = dict(zip(self.names, powers))
        power = lambda p: "" if p == 1 else f"^{p:g}"
        return "".join(f" {name}{power(p)}" for name, p in powers.items() if p != 0)


class Drawing:
    """Entries, and what they are drawn with."""

    def __init__(self, random, units):
        self.random = random
        self.units = units
        self.entries = {}

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

    def number(self, value, length=0, stress=0, time=0):
        """Few digits, times a unit; exact where that is a power of two."""
        powers = length, stress, time
        if self.units.names:
            return f"{float(f'{value:.4g}')!r}{self.units.words(*powers)}"
        unit = self.units.of(*powers)
        value = float(f"{value:.4g}") * unit
        return repr(value) if math.frexp(unit)[0] == 0.5 else f"{value:.12g}"

    def length(self, value):
        return self.number(value, length=1)

    def stress(self, value):
        return self.number(value, stress=1)

    def duration(self, value):
        return self.number(value, time=1)

    def point(self, *coordinates):
        return ", ".join(self.length(c) for c in coordinates)

    def in_units(self, text):
        """An expression of coordinates and times of size 1."""
        for names, unit in (("xyz", self.length(1)), ("t", self.duration(1))):
            for name in names:
                plain = unit in ("1.0", "1")
                quotient = name if plain else f"({name}/({unit}))"
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
        return self.stress(self.load())

    def load(self):
        return self.strain * self.random.choice((-1, 1)) * self.spread(-1, 0.5)
