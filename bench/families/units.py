"""Units that specs are written in, by kind, with their sizes in SI units."""

import math
from typing import NamedTuple

G = 9.80665
FOOT = 0.3048
MILE = 1609.344
NAUTICAL = 1852.0
DEGREE = math.pi / 180

UNITS = {
    "length": {"nm": 1e-9, "um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1, "km": 1e3, "Mm": 1e6, "ft": FOOT, "mi": MILE, "nmi": NAUTICAL},
    "time": {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1, "min": 60, "h": 3600, "day": 86400},
    "speed": {"um/s": 1e-6, "mm/s": 1e-3, "m/s": 1, "km/h": 1 / 3.6, "kn": NAUTICAL / 3600, "ft/s": FOOT, "km/s": 1e3, "mph": MILE / 3600},
    "acceleration": {"um/s^2": 1e-6, "mm/s^2": 1e-3, "m/s^2": 1, "ft/s^2": FOOT, "km/s^2": 1e3, "km/h/s": 1 / 3.6},
    "jerk": {"mm/s^3": 1e-3, "m/s^3": 1, "ft/s^3": FOOT, "km/s^3": 1e3},
    "mass": {"fg": 1e-18, "ug": 1e-9, "mg": 1e-6, "g": 1e-3, "kg": 1, "t": 1e3, "lb": 0.45359237},
    "force": {"uN": 1e-6, "mN": 1e-3, "N": 1, "kN": 1e3, "MN": 1e6, "lbf": 0.45359237 * G},
    "energy": {"mJ": 1e-3, "J": 1, "kJ": 1e3, "MJ": 1e6, "Wh": 3600, "kWh": 3.6e6},
    "power": {"mW": 1e-3, "W": 1, "kW": 1e3, "MW": 1e6},
    "charge": {"pC": 1e-12, "nC": 1e-9, "uC": 1e-6, "C": 1},
    "area": {"mm^2": 1e-6, "cm^2": 1e-4, "m^2": 1, "km^2": 1e6, "ha": 1e4, "ft^2": FOOT**2},
    "volume": {"mL": 1e-6, "L": 1e-3, "m^3": 1, "km^3": 1e9, "ft^3": FOOT**3},
    "concentration": {"umol/L": 1e-3, "mmol/L": 1, "mol/m^3": 1, "mol/L": 1e3, "kmol/m^3": 1e3},
    "angle": {"deg": DEGREE, "rad": 1, "mrad": 1e-3, "rev": 2 * math.pi},
    "turn rate": {"deg/s": DEGREE, "rad/s": 1, "mrad/s": 1e-3, "rpm": 2 * math.pi / 60, "deg/min": DEGREE / 60},
    "turn acceleration": {"deg/s^2": DEGREE, "rad/s^2": 1, "mrad/s^2": 1e-3},
    "turn jerk": {"deg/s^3": DEGREE, "rad/s^3": 1},
    "rate": {"1/s": 1, "1/min": 1 / 60, "1/h": 1 / 3600, "Hz": 1},
}


class Unit(NamedTuple):
    """A unit by its symbol, which is empty where a spec has none, and its size in SI units."""

    symbol: str
    si: float

    def __str__(self):
        return f"[{self.symbol}]" if self.symbol else ""


NONE = Unit("", 1.0)


def unit(rng, kind, *among):
    """A unit of a kind, of all or of those that are named."""
    symbol = rng.choice(among or list(UNITS[kind]))
    return Unit(symbol, UNITS[kind][symbol])
