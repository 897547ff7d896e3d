"""Least acceleration, jerk or snap from rest to rest through way-points at given times.

Answer: the spline of degree 3, 5 or 7 through them that is clamped at the ends, by linear algebra.
"""

import numpy as np
from scipy.interpolate import make_interp_spline

from case import Case
from sizes import Sizes
from spell import block, guess, number, numbers, problem


def least(times, places, n):
    """The integral of the squared n-th derivative; columns of `places` are coordinates."""
    rest = [(j, np.zeros(places.shape[1])) for j in range(1, n)]
    # In times of about 1, which keeps the equations well conditioned.
    span = times[-1]
    spline = make_interp_spline(times / span, places, k=2 * n - 1, bc_type=(rest, rest)).derivative(n)
    nodes, weights = np.polynomial.legendre.leggauss(n + 1)
    total = 0.0
    for a, b in zip(times[:-1] / span, times[1:] / span):
        values = spline((a + b) / 2 + (b - a) / 2 * nodes)
        total += (b - a) / 2 * float(weights @ (values**2).sum(axis=1))
    return total / span ** (2 * n - 1)


def cases(rng, count):
    for k in range(count):
        n = rng.choice((2, 3, 4))
        dimension = rng.choice((1, 2, 3))
        inner = rng.choice((1, 2, 3, 5, 8))
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        unit = sizes.unit("time", 10 ** rng.uniform(-1, 4))
        legs = [round(10 ** rng.uniform(-0.5, 0.8), 1) for _ in range(inner + 1)]
        times = np.round(np.cumsum([0.0, *legs]), 1)
        length = sizes.unit("length", 10 ** rng.uniform(-2, 4))
        places = np.array([[round(rng.uniform(-20, 20), 1) for _ in range(dimension)] for _ in range(inner + 2)])
        optimum = least(times * unit.si, places * length.si, n)
        point = lambda row: f"{numbers(row) if dimension > 1 else number(row[0])} {length}".rstrip()
        clock = lambda value: f"{number(float(value))} {unit}".rstrip()
        name = "r" if dimension > 1 else "x"
        declared = f"{name}[{dimension}]" if dimension > 1 else name
        rest = [f"der({name}{f', {j}' if j > 1 else ''}) == 0" for j in range(1, n)]
        square = f"norm(der({name}, {n}))^2" if dimension > 1 else f"der({name}, {n})^2"
        statements = [
            block("initial", [f"{name} == {point(places[0])}", *rest]),
            block("final", [f"{name} == {point(places[-1])}", *rest]),
        ]
        form = rng.choice(("knots", "phases", "states"))
        order = rng.choice((2 * n, 2 * n + 1))
        if form == "phases":
            statements.append(f"output {declared} {length}: spline(order = {order}, intervals = 1, smoothness = {n});")
            statements.append(f"minimize integral({square});")
            for i in range(inner + 1):
                after = f" after leg_{i - 1}" if i else ""
                gate = f"  final {{ {name} == {point(places[i + 1])}; }}" if i < inner else ""
                statements.append(f"phase leg_{i}{after} {{ duration = {clock(round(times[i + 1] - times[i], 1))};{gate} }}")
        else:
            statements.append(f"duration T = {clock(times[-1])};")
            statements += [f"at {clock(times[i])} {{ {name} == {point(places[i])}; }}" for i in range(1, inner + 1)]
            if form == "knots":
                knots = ", ".join(["0", *(repr(float(one / times[-1])) for one in times[1:-1]), "1"])
                smooth = rng.choice((n, 2 * n - 1))
                statements.append(f"output {declared} {length}: spline(order = {order}, knots = ({knots}), smoothness = {smooth});")
                statements.append(f"minimize integral({square});")
            else:
                # The optimum is smooth to order 2 n - 2, so that an input without smoothness holds it.
                control = f"u[{dimension}]" if dimension > 1 else "u"
                statements += [
                    f"state {declared} {length};",
                    f"input {control} {sizes.mark(f'm/s^{n}')};",
                    f"collocation gauss(points = {rng.choice((n, n + 1))}, intervals = {rng.choice((1, 4, 10))});",
                    f"dynamics {{ der({name}, {n}) == u; }}",
                    f"minimize integral({'norm(u)^2' if dimension > 1 else 'u^2'});",
                ]
        statements += guess(rng, [f"{name} = {point(places[0])} * (1 - tau)"], [f"{name} = {point(100 * places[0])}"])
        yield Case(
            name=f"waypoints_{k}",
            text=problem(rng, "Waypoints", f"Through way-points with the least derivative of order {n}.", statements),
            optimum=optimum,
            tolerance=1e-6,
            why="clamped spline",
        )
