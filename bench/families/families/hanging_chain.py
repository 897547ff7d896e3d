"""A chain of a given length hangs between two posts: the least potential energy.

Answer: the catenary, sqrt(L^2 - h^2) = 2 a sinh(d / (2 a)).
"""

import math

from scipy.integrate import quad
from scipy.optimize import brentq

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import guess, problem, rounded


def energy(d, y0, y1, length):
    """The integral of y along the chain."""
    rise = y1 - y0
    root = math.sqrt(length**2 - rise**2)
    # In z = d / (2 a): sinh(z) / z = root / d.
    z = brentq(lambda z: math.sinh(z) / z - root / d, 1e-6, 50, xtol=1e-15)
    a = d / (2 * z)
    b = d / 2 - a * math.atanh(rise / length)
    c = y0 - a * math.cosh(b / a)
    return quad(lambda x: (a * math.cosh((x - b) / a) + c) * math.cosh((x - b) / a), 0, d, epsabs=0, epsrel=1e-12)[0], z


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        d = sizes.draw("length", 1e-2, 1e4)
        y0 = sizes.write("length", d.si * rng.uniform(0, 3), d.unit, 3)
        y1 = sizes.write("length", y0.si + d.si * rng.choice((0, rng.uniform(-1, 1))), d.unit, 3)
        straight = math.hypot(d.si, y1.si - y0.si)
        length = sizes.write("length", straight * rng.uniform(1.05, 2.5), d.unit, 4)
        moment, z = energy(d.si, y0.si, y1.si, length.si)
        weight = rounded(10 ** rng.uniform(-1, 3), 2)
        grid = mesh(rng, 8, 60)
        order = rng.choice((4, 5, 6))
        form = rng.choice(("flat", "states"))
        end = rng.choice((f"temporal {{ integral(stretch) == {length}; }}", f"temporal {{ length: {length} == integral(stretch); }}"))
        statements = [
            f"param weight = {weight!r} {sizes.mark('N/m')};",
            f"domain x {d.unit};",
            f"duration D = {d};",
            f"minimize {'' if sizes.pure else 'energy [J]: '}integral(weight * y * stretch);",
            f"initial {{ y == {y0}; }}",
            f"final {{ y == {y1}; }}",
            end,
        ]
        if form == "flat":
            statements += [
                f"output y {d.unit}: spline(order = {order}, intervals = {grid.intervals});",
                "let stretch = sqrt(1 + der(y)^2);",
            ]
            power = 2 * order - 2
        else:
            statements += [
                f"state y {d.unit};",
                f"input slope {sizes.mark('1')};",
                grid.statement,
                "let stretch = hypot(1, slope);",
                "dynamics { der(y) == slope; }",
            ]
            power = 2 * grid.points
        sag = sizes.write("length", d.si, d.unit, 1)
        statements += guess(rng, [f"y = {y0} + ({y1} - {y0}) * tau - 4 * {sag} * tau * (1 - tau)"], [f"y = {y0} + ({y1} - {y0}) * tau"])
        yield Case(
            name=f"hanging_chain_{k}",
            text=problem(rng, "Chain", "A chain hangs between two posts.", statements),
            optimum=weight * moment,
            # The slope changes by a factor of e within 1 / (2 z) of the width.
            tolerance=1e-6 + (z / grid.intervals * 2) ** power,
            scale=weight * length.si * d.si,
            why="catenary",
        )
