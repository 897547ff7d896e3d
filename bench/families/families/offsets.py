"""Small moves far from the origin, as heights above the centre of the earth are.

Answer: only differences count: 12 d^2 / T^3 from rest to rest, d^2 / T for an integrator, 2 sqrt(d / a) in the least time, wherever
the origin is. What a double leaves of a small move at a large offset is in the tolerance.
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, objective, problem
from units import unit


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time")
        offset, way = draw(rng, 1e2, 1e7), draw(rng, 1e-2, 1e1)
        drift = rng.choice([0.0, draw(rng, 1, 1e4)])
        total = draw(rng, 1e-1, 1e2)
        spelled = f"{offset:.16g} [m]"
        grid = mesh(rng, 4, 30, least=3)
        # The move is what is over a steady drift.
        end = f"{offset + drift * total + way:.16g} [m]"
        kind = ["rest", "line", "time"][index % 3]
        rounding = 1e-14 * (offset + drift * total) / way
        by_states = rng.random() < 0.5
        x = (
            [
                f"state x [m], v [m/{clock}];",
                f"input a [m/{clock}^2];",
                "dynamics { der(x) == v;  der(v) == a; }",
                grid.statement,
            ]
            if by_states
            else [
                f"output x [m]: spline(order = 6, intervals = {grid.intervals}, smoothness = 2);",
                f"let v [m/{clock}] = der(x);",
                f"let a [m/{clock}^2] = der(x, 2);",
            ]
        )
        speed = f"{drift:.16g} [m/{clock}]"
        if kind == "rest":
            statements = [
                f"duration T = {total:.16g} [{clock}];",
                f"initial {{ x == {spelled};  v == {speed}; }}",
                f"final {{ x == {end};  v == {speed}; }}",
            ]
            expression, symbol, factor, best, tolerance = (
                "integral(a^2)",
                f"m^2/{clock}^3",
                1 / second**3,
                12 * way**2 / total**3,
                1e-6,
            )
        elif kind == "line":
            statements = [
                f"duration T = {total:.16g} [{clock}];",
                f"initial {{ x == {spelled}; }}",
                f"final {{ x == {end}; }}",
            ]
            expression, symbol, factor, best, tolerance = (
                f"integral((v - {speed})^2)",
                f"m^2/{clock}",
                1 / second,
                way**2 / total,
                1e-4,
            )
        else:
            push = draw(rng, 1e-2, 1e2)
            end = f"{offset + way:.16g} [m]"
            best = 2 * math.sqrt(way / push)
            rounding = 1e-14 * offset / way
            statements = [
                f"duration T in {bounds(rng, best, clock)};",
                f"initial {{ x == {spelled};  v == 0; }}",
                f"final {{ x == {end};  v == 0; }}",
                f"trajectory {{ abs(a) <= {push:.16g} [m/{clock}^2]; }}",
            ]
            expression, symbol, factor, tolerance = "T", clock, second, 1e-3 + 6 / grid.intervals**2
        minimize, worth = objective(rng, "minimize", "cost", expression, symbol, factor)
        text = problem(rng, "Offset", "A small move far from the origin.", statements + x + [minimize])
        yield Case(
            f"offsets_{index}", text, best * worth, tolerance + 100 * rounding, why=f"{kind}, {offset / way:.1e}"
        )
