"""Zermelo's boat crosses a current that is constant, or that grows linearly across it, in the least time.

Answer: |d - w T| = V T; in the shear, where the tangent of the heading is linear in time (Bryson and Ho, section 2.7),
the fastest of all extremals that a search over heading and time finds.
"""

import math

import numpy as np
from scipy.optimize import fsolve

from case import Case
from families.pursuit import first_root
from meshes import mesh
from sizes import Sizes
from spell import guess, problem, rounded
from units import DEGREE


def extremal(heading, T, V, shear, y0):
    """Where the boat is after T, from (0, y0), in the current shear * y along x."""
    sign = math.copysign(1, math.cos(heading))
    q0 = math.tan(heading)
    q = q0 - shear * T
    secant0, secant = math.hypot(1, q0), math.hypot(1, q)
    y = y0 - V * sign * (secant - secant0) / shear
    along = -V * sign * (math.asinh(q) - math.asinh(q0)) / shear
    area = (y0 + V * sign * secant0 / shear) * T
    area += V * sign / shear**2 * 0.5 * (q * secant + math.asinh(q) - q0 * secant0 - math.asinh(q0))
    return along + shear * area, y


# The logarithm of the longest time that is looked at: a step of `fsolve` may lead anywhere.
LONGEST = 100


def through_shear(x, y0, y1, V, shear):
    """The least time from (0, y0) to (x, y1), in units of length and speed that are about 1."""
    best = math.inf
    for heading in np.linspace(-math.pi, math.pi, 25)[1:] + 0.01:
        for T in np.geomspace(0.1, 10, 7) * (math.hypot(x, y1 - y0) / V):
            miss = lambda z: np.subtract(extremal(z[0], math.exp(min(z[1], LONGEST)), V, shear, y0), (x, y1))
            found, _, end, _ = fsolve(miss, [heading, math.log(T)], full_output=True, xtol=1e-13)
            if end == 1 and np.abs(miss(found)).max() < 1e-9:
                best = min(best, math.exp(found[1]))
    return best


def cases(rng, count):
    np.seterr(all="ignore")
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.2)
        d = sizes.draw("length", 1e-2, 1e7)
        V = sizes.draw("speed", d.si / 1e6, d.si)
        where = rng.uniform(-180, 180) * DEGREE
        x = sizes.write("length", d.si * math.cos(where), d.unit, 4)
        y = sizes.write("length", d.si * math.sin(where), d.unit, 4)
        grid = mesh(rng)
        statements = [f"param V = {V};", f"state x {d.unit}, y {d.unit};", grid.statement]
        if rng.random() < 0.4:
            way = rng.uniform(-180, 180) * DEGREE
            current = [sizes.write("speed", V.si * rng.uniform(0, 0.95) * f(way), digits=3) for f in (math.cos, math.sin)]
            w = np.array([q.si for q in current])
            D = np.array([x.si, y.si])
            T = first_root([V.si**2 - w @ w, 2 * D @ w, -D @ D])
            drift = [f" + ({q})" for q in current]
            start, tolerance, chord, first = "y == 0", 1e-6, 0.0, 0.0
            last = y
        else:
            shear = rounded(V.si / d.si * rng.uniform(0.2, 2) * rng.choice((-1, 1)), 3)
            start_y = sizes.write("length", d.si * rng.uniform(-1, 1), d.unit, 3)
            last = sizes.write("length", start_y.si + y.si, d.unit, 5)
            T = d.si / V.si * through_shear(x.si / d.si, start_y.si / d.si, last.si / d.si, 1, shear * d.si / V.si)
            drift = [" + shear * y", ""]
            statements.append(f"param shear = {shear!r} {sizes.mark('1/s')};")
            start = f"y == {start_y}"
            # Headings turn by less than half a turn.
            tolerance = 1e-6 + (2 / grid.intervals) ** (2 * grid.points)
            chord = 0.1 * (3 / grid.intervals) ** grid.points
            first = start_y.si
        shown = sizes.unit("time", T)
        speeds = ("vx", "vy")
        form = rng.choice(("heading", "velocity"))
        if form == "heading":
            statements.append(f"input heading {sizes.mark('deg')};")
            speeds = ("V * cos(heading)", "V * sin(heading)")
        else:
            statements += [f"input vx {V.unit}, vy {V.unit};", "trajectory { vx^2 + vy^2 <= V^2; }"]
        statements += [
            f"dynamics {{ der(x) == {speeds[0]}{drift[0]};  der(y) == {speeds[1]}{drift[1]}; }}",
            f"initial {{ x == 0;  {start}; }}",
            f"final {{ x == {x};  y == {last}; }}",
            f"duration T in {sizes.bounds('time', T)};",
            f"minimize {'time ' + str(shown) + ': ' if shown.symbol else ''}T;",
        ]
        line = [f"x = {x} * tau", f"y = {sizes.write('length', first, d.unit)} + {y} * tau", f"T = {sizes.write('time', T, digits=1)}"]
        statements += guess(rng, line, [f"x = {x}", f"y = {sizes.write('length', -3 * d.si, d.unit, 1)}", f"T = {sizes.write('time', 10 * T, digits=1)}"])
        yield Case(
            name=f"zermelo_{k}",
            text=problem(rng, "Zermelo", "A boat crosses a current in the least time.", statements),
            optimum=T / shown.si,
            # A velocity is a polynomial inside the circle of speeds.
            tolerance=tolerance + (chord if form == "velocity" else 0),
            why="fastest extremal",
        )
