"""Least action of a throw and least energy of a loaded string, over all sizes from atoms to planets.

Answer: of curves between zeros the least of the integral of k x'^2 / 2 - f x is -f^2 T^3 / (24 k); with a free end
-f^2 T^3 / (6 k); with a spring s x^2 / 2 beside it -f^2 / (2 s) (T - 2 tanh(w T / 2) / w), w = sqrt(s / k).
"""

import math

from case import Case
from meshes import mesh
from spell import draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        mass, kilo = unit(rng, "mass", "kg", "g", "ug", "t", "fg")
        m, force, total = draw(rng, 1e-2, 1e3), draw(rng, 1e-3, 1e3), draw(rng, 1e-2, 1e2)
        kind = ["fixed", "free", "spring"][index % 3]
        newton = f"{mass}*{length}/{clock}^2"
        stiff = 0.0
        if kind == "fixed":
            best = -(force**2) * total**3 / (24 * m)
        elif kind == "free":
            best = -(force**2) * total**3 / (6 * m)
        else:
            stiff = rounded(m * (draw(rng, 0.3, 8) / total) ** 2, 4)
            w = math.sqrt(stiff / m)
            best = -(force**2) / (2 * stiff) * (total - 2 * math.tanh(w * total / 2) / w)
        grid = mesh(rng, 4, 20, least=4)
        if rng.random() < 0.5:
            motion = [
                f"output x [{length}]: spline(order = {rng.randint(5, 7)}, intervals = {grid.intervals});",
                f"let v [{length}/{clock}] = der(x);",
            ]
        else:
            motion = [f"state x [{length}];", f"input v [{length}/{clock}];", "dynamics { der(x) == v; }", grid.statement]
        spring = f" + {number(stiff)} [{mass}/{clock}^2] * x^2 / 2" if stiff else ""
        symbol, factor = f"{mass}*{length}^2/{clock}", kilo * metre**2 / second
        minimize, worth = objective(rng, "minimize", "action", f"integral(m * v^2 / 2{spring} - f * x)", symbol, factor)
        statements = [
            f"duration T = {number(total)} [{clock}];",
            f"param m = {number(m)} [{mass}];",
            f"param f = {number(force)} [{newton}];",
            minimize,
            "initial { x == 0; }",
            "" if kind == "free" else "final { x == 0; }",
        ]
        text = problem(rng, "Action", "A curve of the least action.", statements + motion)
        yield Case(f"action_{index}", text, best * worth, 1e-5, why=f"{kind}, {abs(best * factor):.1e} in SI units")
