"""The fastest way through a medium whose speed grows evenly with depth.

Answer: rays are circles, the time arccosh(1 + b^2 |d|^2 / (2 v1 v2)) / b for a gradient b and the speeds v1, v2 at the ends
(seismology; the geometry of Poincare's half plane).
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, _ = unit(rng, "length")
        clock, second = unit(rng, "time", "s", "ms", "min", "h")
        size, speed = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
        gradient = rounded(speed / size * draw(rng, 0.1, 6), 3)
        across, down = (
            rounded(size * draw(rng, 0.2, 3), 3),
            rounded(size * rng.choice([0.0, draw(rng, 0.1, 2)]), 3),
        )
        other = speed + gradient * down
        best = math.acosh(1 + gradient**2 * (across**2 + down**2) / (2 * speed * other)) / gradient
        grid = mesh(rng, 10, 30, least=3)
        place, rate = f"[{length}]", f"[{length}/{clock}]"
        kind = ["angle", "velocity", "curve"][index % 3]
        statements = [
            f"let c {rate} = {number(speed)} {rate} + {number(gradient)} [1/{clock}] * y;",
            "initial { x == 0;  y == 0; }",
            f"final {{ x == {number(across)} {place};  y == {number(down)} {place}; }}",
        ]
        expression = "T"
        if kind == "angle":
            statements += [
                f"state x, y {place};",
                "input psi [1];",
                "dynamics { der(x) == c * cos(psi);  der(y) == c * sin(psi); }",
            ]
        elif kind == "velocity":
            statements += [
                f"output x, y {place}: spline(order = 5, intervals = {grid.intervals}, smoothness = 2);",
                "trajectory { hypot(der(x), der(y)) <= c; }",
            ]
        else:
            statements[1:] = [
                f"domain x {place};",
                f"duration X = {number(across)} {place};",
                f"output y {place}: spline(order = 5, intervals = {grid.intervals});",
                "initial { y == 0; }",
                f"final {{ y == {number(down)} {place}; }}",
            ]
            expression = "integral(sqrt(1 + der(y)^2) / c)"
        if kind != "curve":
            statements.append(f"duration T in {bounds(rng, best, clock)};")
        # Above the ground the speed would fall below 0, and so would the time.
        statements.append(f"trajectory {{ y >= 0 {place}; }}" if rng.random() < 0.5 else "trajectory { y >= 0; }")
        minimize, worth = objective(rng, "minimize", "time", expression, clock, second)
        text = problem(rng, "Ray", "The fastest way through the ground.", statements + [grid.statement, minimize])
        yield Case(f"media_{index}", text, best * worth, 1e-2 if kind == "curve" else 1e-3, why=kind)
