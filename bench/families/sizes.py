"""Sizes in SI units, written as a user would write them: a round number in a unit that fits.

Both are given, the text and the SI value of that text. A spec without units is drawn by the same calls.
"""

import math
import random
from dataclasses import dataclass

from spell import bounds, log_uniform, number, numbers, rounded
from units import NONE, UNITS, Unit


@dataclass(frozen=True)
class Quantity:
    """A number in a unit; printed as it stands in a spec."""

    number: float
    unit: Unit

    @property
    def si(self):
        return self.number * self.unit.si

    def __str__(self):
        return f"{number(self.number)} {self.unit}".rstrip()


def vector(quantities):
    """Quantities of one unit, as a list of numbers in it."""
    return f"{numbers(one.number for one in quantities)} {quantities[0].unit}".rstrip()


@dataclass
class Sizes:
    """Draws sizes: with the units of a spec, or, where it is pure, without any."""

    rng: random.Random
    pure: bool = False

    def unit(self, kind, si):
        """A unit in which about `si` is a number that one would write."""
        if self.pure:
            return NONE
        units = [Unit(symbol, size) for symbol, size in UNITS[kind].items()]
        fitting = [unit for unit in units if 0.1 <= abs(si) / unit.si <= 5000]
        nearest = min(units, key=lambda unit: abs(math.log(max(abs(si), 1e-30) / unit.si)))
        return self.rng.choice(fitting or [nearest])

    def write(self, kind, si, unit=None, digits=4):
        """About `si` as a round number in a unit."""
        unit = unit or self.unit(kind, si)
        return Quantity(rounded(si / unit.si, digits) if si else 0.0, unit)

    def draw(self, kind, low, high, digits=None):
        """A size between two SI values, evenly on a logarithmic scale."""
        return self.write(kind, log_uniform(self.rng, low, high), digits=digits or self.rng.choice((1, 2, 3, 5)))

    def mark(self, symbol):
        """A unit that is written out, `[m^2/s^3]`, or nothing where the spec has no units."""
        return "" if self.pure else f"[{symbol}]"

    def bounds(self, kind, si):
        """Bounds of a duration, or of what else is sought, of about `si`."""
        unit = self.unit(kind, si)
        return bounds(self.rng, si / unit.si, unit.symbol)
