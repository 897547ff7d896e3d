"""A soap film between two rings on an axis: the least surface of revolution.

Answer: the catenoid y = a cosh((x - b) / a), by root finding; rings are so near that it is less than the two discs.
"""

import math

from scipy.optimize import fsolve

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import guess, problem


def catenoid(d, y0, y1, near):
    """The area between rings of radii y0 and y1 at a distance d, from parameters near the solution."""
    miss = lambda z: (z[0] * math.cosh(z[1]) - y0, z[0] * math.cosh(z[1] + d / z[0]) - y1)
    a, u = fsolve(miss, near, xtol=1e-13)
    v = u + d / a
    return math.pi * a**2 * ((v + math.sinh(2 * v) / 2) - (u + math.sinh(2 * u) / 2))


def cases(rng, count):
    k = 0
    while k < count:
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        u = rng.uniform(-0.9, 0.2)
        v = rng.uniform(max(u + 0.2, 0), 0.9)
        unit = sizes.unit("length", 10 ** rng.uniform(-3, 3))
        a = unit.si * 10 ** rng.uniform(-0.5, 1.5)
        d, y0, y1 = (sizes.write("length", size, unit, 4) for size in (a * (v - u), a * math.cosh(u), a * math.cosh(v)))
        area = catenoid(d.si, y0.si, y1.si, (a, u))
        if area > 0.97 * math.pi * (y0.si**2 + y1.si**2):
            continue
        grid = mesh(rng)
        shown = sizes.unit("area", area)
        goal = f"minimize {'area ' + str(shown) + ': ' if shown.symbol else ''}"
        statements = [
            f"domain x {unit};",
            f"duration D = {d};",
            f"initial {{ y == {y0}; }}",
            f"final {{ y == {y1}; }}",
        ]
        if rng.random() < 0.6:
            order = rng.choice((4, 5, 6))
            statements += [
                f"{goal}2 * pi * integral(y * {rng.choice(('sqrt(1 + der(y)^2)', 'hypot(1, der(y))'))});",
                f"output y {unit}: spline(order = {order}, intervals = {grid.intervals});",
            ]
            tolerance = 1e-6 + (0.5 / grid.intervals) ** (2 * order - 2)
        else:
            statements += [
                f"state y {unit};",
                f"input slope {sizes.mark('1')};",
                grid.statement,
                "dynamics { der(y) == slope; }",
                f"{goal}integral(2 * pi * y * sqrt(1 + slope^2));",
            ]
            tolerance = 1e-6 + (1 / grid.intervals) ** (2 * grid.points)
        statements += guess(rng, [f"y = {y0} + ({y1} - {y0}) * tau"], [f"y = {sizes.write('length', 5 * y0.si, unit, 2)}"])
        yield Case(
            name=f"soap_film_{k}",
            text=problem(rng, "Film", "A soap film between two rings.", statements),
            optimum=area / shown.si,
            tolerance=tolerance,
            why="catenoid",
        )
        k += 1
