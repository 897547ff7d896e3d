"""A case of a family, and what its generator needs: sizes in units, meshes, bounds of durations, guesses.

A generator works in SI units. `Sizes` draws a size as a user would write it, a round number in a unit that fits, and
gives both the text and the SI value of that text. A spec without units is drawn by the same calls.
"""

import math
import random
from dataclasses import dataclass


@dataclass(frozen=True)
class Case:
    """A spec, and what it must be answered with."""

    name: str
    text: str
    # The optimum in the unit in which the spec shows its objective.
    optimum: float
    # What the discretisation may be off by, relative to the larger of |optimum| and scale.
    tolerance: float
    scale: float = 0.0
    # The formula or the book that the optimum comes from.
    why: str = ""
    # There is no solution: the right end is to say so.
    infeasible: bool = False


@dataclass(frozen=True)
class Unit:
    """A unit by its symbol, which is empty where a spec has none, and its size in SI units."""

    symbol: str
    si: float

    def __str__(self):
        return f"[{self.symbol}]" if self.symbol else ""


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


NONE = Unit("", 1.0)

G = 9.80665
FOOT = 0.3048
MILE = 1609.344
NAUTICAL = 1852.0
DEGREE = math.pi / 180

UNITS = {
    "length": {"um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1, "km": 1e3, "Mm": 1e6, "ft": FOOT, "mi": MILE, "nmi": NAUTICAL},
    "time": {"us": 1e-6, "ms": 1e-3, "s": 1, "min": 60, "h": 3600, "day": 86400},
    "speed": {"um/s": 1e-6, "mm/s": 1e-3, "m/s": 1, "km/h": 1 / 3.6, "kn": NAUTICAL / 3600, "ft/s": FOOT, "km/s": 1e3, "mph": MILE / 3600},
    "acceleration": {"um/s^2": 1e-6, "mm/s^2": 1e-3, "m/s^2": 1, "ft/s^2": FOOT, "km/s^2": 1e3, "km/h/s": 1 / 3.6},
    "jerk": {"mm/s^3": 1e-3, "m/s^3": 1, "ft/s^3": FOOT, "km/s^3": 1e3},
    "mass": {"mg": 1e-6, "g": 1e-3, "kg": 1, "t": 1e3, "lb": 0.45359237},
    "force": {"uN": 1e-6, "mN": 1e-3, "N": 1, "kN": 1e3, "MN": 1e6, "lbf": 0.45359237 * G},
    "energy": {"mJ": 1e-3, "J": 1, "kJ": 1e3, "MJ": 1e6, "Wh": 3600, "kWh": 3.6e6},
    "power": {"mW": 1e-3, "W": 1, "kW": 1e3, "MW": 1e6},
    "area": {"mm^2": 1e-6, "cm^2": 1e-4, "m^2": 1, "km^2": 1e6, "ha": 1e4, "ft^2": FOOT**2},
    "volume": {"mL": 1e-6, "L": 1e-3, "m^3": 1, "km^3": 1e9, "ft^3": FOOT**3},
    "angle": {"deg": DEGREE, "rad": 1, "mrad": 1e-3, "rev": 2 * math.pi},
    "turn rate": {"deg/s": DEGREE, "rad/s": 1, "mrad/s": 1e-3, "rpm": 2 * math.pi / 60, "deg/min": DEGREE / 60},
    "turn acceleration": {"deg/s^2": DEGREE, "rad/s^2": 1, "mrad/s^2": 1e-3},
    "turn jerk": {"deg/s^3": DEGREE, "rad/s^3": 1},
    "rate": {"1/s": 1, "1/min": 1 / 60, "1/h": 1 / 3600, "Hz": 1},
}


def number(value):
    """A number as specs write it, with a digit on both sides of the point."""
    return repr(int(value)) if value == int(value) and abs(value) < 1e6 else repr(float(value))


def rounded(value, digits):
    return float(f"{value:.{digits - 1}e}")


def log_uniform(rng, low, high):
    return math.exp(rng.uniform(math.log(low), math.log(high)))


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
        """Bounds of a duration, or of what else is sought, of about `si`: from narrow to none at all."""
        unit = self.unit(kind, si)
        low = lambda factor: number(rounded(factor * si / unit.si, 2))
        mark = f" {unit}".rstrip()
        return self.rng.choice((
            f"0{mark} ..",
            f"{low(1e-3)}{mark} ..",
            f"0 .. {low(1e3)}{mark}",
            f"{low(0.01)} .. {low(100)}{mark}",
            f"{low(0.3)} .. {low(5)}{mark}",
        ))


@dataclass(frozen=True)
class Mesh:
    """Intervals of all splines, and Gauss points in each."""

    intervals: int
    points: int

    @property
    def statement(self):
        return f"collocation gauss(points = {self.points}, intervals = {self.intervals});"

    def switches(self, count=1, factor=0.5):
        """What a cost may be off by, relative, where `count` switches fall inside intervals."""
        return 1e-6 + factor * count / self.intervals**2

    def ramps(self, count, share, factor=0.5):
        """The same of a least time, where speed rises and falls within a share of it: a switch loses way as an
        interval's square over the ramp's length, and at most half an interval."""
        return 1e-6 + count * min(factor * max(1, 0.5 / share) / self.intervals**2, 0.5 / self.intervals)


def mesh(rng, low=5, high=80):
    """Intervals evenly on a logarithmic scale, and 2 to 5 points in each: states of order 3 to 6."""
    return Mesh(round(log_uniform(rng, low, high)), rng.choice((2, 3, 3, 4, 5)))


def guess(rng, line, poor):
    """The `guess` block: none at all, a line, or a poor one; each a list of `name = value;` without a semicolon."""
    lines = rng.choice(([], line, poor))
    return [block("guess", lines)] if lines else []


def block(kind, statements):
    """`kind { a;  b; }`, or a statement a line where that is too long."""
    text = f"{kind} {{ " + "  ".join(f"{one};" for one in statements) + " }"
    return text if len(text) <= 110 else f"{kind} {{\n" + "".join(f"        {one};\n" for one in statements) + "    }"


def shuffled(rng, items):
    items = list(items)
    rng.shuffle(items)
    return items


def problem(rng, title, doc, statements):
    """A spec of statements, whose order means nothing: it is drawn in half of the specs."""
    if rng.random() < 0.5:
        statements = shuffled(rng, statements)
    return f"/// {doc}\nproblem {title} {{\n" + "".join(f"    {one}\n" for one in statements) + "}\n"
