"""Moves through points at given times, within windows, or with points that may be missed.

Answer: the least integral of the squared acceleration through points is the cubic spline (de Boor), clamped or natural,
its energy exact from its second derivative. A soft point at a square price joins the quadratic program, which is solved
by its kernel. With windows the program in the places is convex (scipy).
"""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize as descend

from case import Case
from spell import draw, number, objective, problem, rounded
from units import unit


def energy(times, places, clamped):
    """Integral of the squared second derivative."""
    spline = CubicSpline(times, places, bc_type="clamped" if clamped else "natural")
    bend = spline(times, 2)
    steps = np.diff(times)
    return float(np.sum(steps * (bend[1:] ** 2 + bend[1:] * bend[:-1] + bend[:-1] ** 2) / 3))


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        n = rng.randint(2, 6)
        size, step = draw(rng, 1e-3, 1e3), draw(rng, 1e-2, 1e2, 2)
        clamped = rng.random() < 0.5
        places = [rounded(size * rng.uniform(-1, 1), 3) for _ in range(n + 1)]
        places[0] = 0.0
        kind = ["points", "windows", "soft"][index % 3]
        times = np.arange(n + 1) * step
        matrix = np.zeros((n + 1, n + 1))
        for i in range(n + 1):
            for j in range(n + 1):
                e = [np.eye(n + 1)[k] for k in (i, j)]
                matrix[i, j] = (energy(times, e[0] + e[1], clamped) - energy(times, e[0] - e[1], clamped)) / 4
        x = f"[{length}]"
        at = [f"at {number(times[k])} [{clock}] {{ x == {number(places[k])} {x}; }}" for k in range(1, n)]
        price = ""
        if kind == "points":
            best = energy(times, places, clamped)
        elif kind == "windows":
            half = rounded(size * draw(rng, 0.05, 0.5), 2)
            scaled = matrix[1:n, 1:n] / matrix[1, 1]
            linear = (matrix[1:n, [0, n]] @ np.array([places[0], places[n]])) / matrix[1, 1] / size
            found = descend(
                lambda y: y @ scaled @ y + 2 * linear @ y,
                np.array(places[1:n]) / size,
                jac=lambda y: 2 * (scaled @ y + linear),
                bounds=[((p - half) / size, (p + half) / size) for p in places[1:n]],
                method="L-BFGS-B",
                options={"ftol": 1e-16, "gtol": 1e-13, "maxiter": 10000},
            )
            best = energy(times, [places[0], *(found.x * size), places[n]], clamped)
            at = [
                f"at {number(times[k])} [{clock}] {{ abs(x - {number(places[k])} {x}) <= {number(half)} {x}; }}"
                for k in range(1, n)
            ]
        else:
            price_value = rounded(matrix[1, 1] * draw(rng, 0.1, 10), 3)
            weight = price_value * np.eye(n - 1)
            free = matrix[1:n, 1:n] + weight
            known = np.array([places[0], places[n]])
            right = price_value * np.array(places[1:n]) - matrix[1:n, [0, n]] @ known
            inner = np.linalg.solve(free, right)
            best = energy(times, [places[0], *inner, places[n]], clamped)
            best += price_value * float(np.sum((inner - places[1:n]) ** 2))
            price = f"param price = {number(price_value)} [1/{clock}^3];"
            at = [
                f"at {number(times[k])} [{clock}] {{ soft(square = price): x == {number(places[k])} {x}; }}"
                for k in range(1, n)
            ]
        rest = "  v == 0;" if clamped else ""
        if rng.random() < 0.5:
            motion = [
                f"state x {x}, v [{length}/{clock}];",
                f"input a [{length}/{clock}^2];",
                "dynamics { der(x) == v;  der(v) == a; }",
                f"collocation gauss(points = 3, intervals = {n * rng.randint(1, 3)});",
            ]
            force = "a"
        else:
            motion = [
                f"output x {x}: spline(order = {rng.choice([4, 5])}, intervals = {n * rng.randint(1, 3)}, smoothness = 3);",
                f"let v [{length}/{clock}] = der(x);",
            ]
            force = "der(x, 2)"
        minimize, worth = objective(
            rng, "minimize", "effort", f"integral({force}^2)", f"{length}^2/{clock}^3", metre**2 / second**3
        )
        if kind == "soft":
            minimize, worth = f"minimize integral({force}^2);", metre**2 / second**3
        text = problem(
            rng,
            "Tour",
            "Through points at given times.",
            [
                f"duration T = {number(n * step)} [{clock}];",
                f"initial {{ x == 0;{rest} }}",
                f"final {{ x == {number(places[n])} {x};{rest} }}",
                minimize,
                price,
            ]
            + motion
            + at,
        )
        # Windows may leave a straight line, which costs nothing.
        scale = 1e-3 * size**2 / (n * step) ** 3 * worth
        yield Case(
            f"waypoint_windows_{index}",
            text,
            best * worth,
            1e-5,
            scale=scale,
            why=f"{kind}, {'clamped' if clamped else 'natural'}",
        )
