"""Gates that are open over parts of the time: the least energy through them is a taut string.

Answer: between gates the speed is even; with the places at the ends of the parts as unknowns the sum of d^2 / t under
bounds is convex (solved by scipy). A gate is a band that holds over a whole part.
"""

import numpy as np
from scipy.optimize import lsq_linear

from case import Case
from spell import draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        n = rng.randint(3, 8)
        size, step = draw(rng, 1e-3, 1e3), draw(rng, 1e-2, 1e2, 2)
        by_points = index % 2 == 0
        low, high, parts = np.full(n + 1, -np.inf), np.full(n + 1, np.inf), []
        x, middle = f"[{length}]", 0.0
        for k in range(1, n):
            if rng.random() < 0.3:
                continue
            middle += rng.gauss(0, 0.8)
            half = draw(rng, 0.1, 1)
            a, b = rounded(size * (middle - half), 3), rounded(size * (middle + half), 3)
            if by_points:
                parts.append(f"at {number(k * step)} [{clock}] {{ x in {number(a)} .. {number(b)} {x}; }}")
                low[k], high[k] = a, b
            elif k + 1 < n and low[k] == -np.inf:
                parts.append(
                    f"trajectory from {number(k * step)} [{clock}] to {number((k + 1) * step)} [{clock}] {{ x in {number(a)} .. {number(b)} {x}; }}"
                )
                low[k], high[k], low[k + 1], high[k + 1] = a, b, a, b
        end = rounded(size * rng.gauss(0, 2), 3)
        # Least squares of the differences; both ends are fixed.
        matrix = (np.eye(n, n + 1, 1) - np.eye(n, n + 1)) / np.sqrt(step)
        inner = matrix[:, 1:n]
        right = -matrix[:, n] * end / size
        found = lsq_linear(inner, right, bounds=(low[1:n] / size, high[1:n] / size), method="bvls", tol=1e-15)
        best = float(2 * found.cost * size**2)
        intervals = n * rng.randint(1, 4)
        if rng.random() < 0.5:
            motion = [
                f"state x {x};",
                f"input v [{length}/{clock}];",
                "dynamics { der(x) == v; }",
                f"collocation gauss(points = 3, intervals = {intervals});",
            ]
        else:
            motion = [
                f"output x {x}: spline(order = 3, intervals = {intervals}, smoothness = 1);",
                f"let v [{length}/{clock}] = der(x);",
            ]
        minimize, worth = objective(rng, "minimize", "effort", "integral(v^2)", f"{length}^2/{clock}", metre**2 / second)
        text = problem(
            rng,
            "Gates",
            "Through gates that open and close.",
            [
                f"duration T = {number(n * step)} [{clock}];",
                "initial { x == 0; }",
                f"final {{ x == {number(end)} {x}; }}",
                minimize,
            ]
            + motion
            + parts,
        )
        yield Case(
            f"taut_strings_{index}",
            text,
            best * worth,
            1e-5,
            scale=1e-3 * size**2 / step * worth,
            why="points" if by_points else "bands",
        )
