"""Least energies of curves with a given area, mean square or length of side conditions.

Answer: of curves between zeros with the area A over a length L the least integral of y'^2 is 12 A^2 / L^3, of y''^2 clamped
720 A^2 / L^5; with a mean square of 1 it is the first eigenvalue: (pi / L)^2 of a string, (pi / L)^4 of a supported and
(4.730 / L)^4 of a clamped beam, (pi / 2 L)^2 of a string with one free end; orthogonal to the first, the second of them.
"""

import math

from scipy.optimize import brentq

from case import Case
from spell import draw, number, objective, problem
from units import unit

CLAMPED = brentq(lambda x: math.cos(x) * math.cosh(x) - 1, 4.6, 4.9, xtol=1e-15)


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time", "s", "ms", "h", "us")
        length, size = draw(rng, 1e-2, 1e2), draw(rng, 1e-3, 1e3)
        intervals = rng.randint(4, 20)
        name = ["area", "string", "area of a beam", "clamped", "free", "second"][index % 6]
        zero, level = "y == 0;", "y == 0;  der(y) == 0;"
        ends, order = (zero, zero), 1
        side = f"integral(y^2) == {number(size)} [m^2*{clock}]"
        if name == "area":
            best, side = 12 * size**2 / length**3, f"integral(y) == {number(size)} [m*{clock}]"
        elif name == "area of a beam":
            best, side, order, ends = (
                720 * size**2 / length**5,
                f"integral(y) == {number(size)} [m*{clock}]",
                2,
                (level, level),
            )
        elif name == "string":
            order = rng.choice([1, 2])
            best = size * (math.pi / length) ** (2 * order)
        elif name == "clamped":
            best, order, ends = size * (CLAMPED / length) ** 4, 2, (level, level)
        elif name == "free":
            best, ends = size * (math.pi / 2 / length) ** 2, (zero, "")
        else:
            best = size * (2 * math.pi / length) ** 2
            side += ";\n    integral(y * sin(pi * tau)) == 0"
        guess = rng.choice(["", "", f"guess {{ y = {number(math.sqrt(size / length))} [m] * sin(pi * tau); }}"])
        if name.startswith("area") or name == "second":
            guess = rng.choice(["", f"guess {{ y = {number(math.sqrt(size / length))} [m] * tau * (1 - tau)^2; }}"])
        if name == "free":
            guess = rng.choice(["", f"guess {{ y = {number(math.sqrt(size / length))} [m] * tau; }}"])
        power = 2 * order
        minimize, worth = objective(
            rng,
            "minimize",
            "energy",
            f"integral(der(y, {order})^2)",
            f"m^2/{clock}^{power - 1}",
            1 / second ** (power - 1),
        )
        text = problem(
            rng,
            "Membrane",
            "The least energy under a side condition.",
            [
                f"duration L = {number(length)} [{clock}];",
                f"output y [m]: spline(order = {order + rng.randint(4, 5)}, intervals = {intervals});",
                minimize,
                f"initial {{ {ends[0]} }}",
                f"final {{ {ends[1]} }}" if ends[1] else "",
                f"temporal {{\n    {side};\n}}",
                guess,
            ],
        )
        yield Case(f"eigenvalues_{index}", text, best * worth, 1e-3, why=name)
