"""A first-order system between two states at a cost of state and input, over horizons from short to long.

Answer: x'' = l^2 x with l^2 = a^2 + b^2 q / r; the integral of q x^2 + r u^2 is r / b^2 (l ((x0^2 + x1^2) cosh - 2 x0 x1) / sinh
- a (x1^2 - x0^2)) at l T. About another level the state is shifted, where a = 0. What is far from both ends stays at 0.
"""

import math

from case import Case
from spell import draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time")
        a, b, q, r = (
            rng.choice([0.0, rng.choice([1, -1]) * draw(rng, 0.1, 3)]),
            draw(rng, 0.1, 10),
            draw(rng, 0.1, 10),
            draw(rng, 0.1, 10),
        )
        rate = math.sqrt(a * a + b * b * q / r)
        total = rounded(draw(rng, 0.3, 40) / rate, 3)
        size = draw(rng, 1e-3, 1e3)
        x0, x1 = rounded(size * rng.uniform(0.2, 1), 3), rounded(size * rng.uniform(-1, 1), 3)
        level = 0.0 if a else rounded(size * rng.uniform(-3, 3), 3)
        y0, y1, phase = x0 - level, x1 - level, rate * total
        best = (
            r
            / b**2
            * (rate * ((y0**2 + y1**2) / math.tanh(phase) - 2 * y0 * y1 / math.sinh(phase)) - a * (y1**2 - y0**2))
        )
        intervals = rng.randint(10, 30)
        away = f"(x - {number(level)} [m])" if level else "x"
        by_input = rng.random() < 0.5
        if by_input:
            motion = [
                "state x [m];",
                f"input u [m/{clock}];",
                f"dynamics {{ der(x) == ({number(a)} [1/{clock}]) * x + {number(b)} * u; }}",
            ]
            motion.append(f"collocation gauss(points = {rng.choice([3, 4, 5])}, intervals = {intervals});")
        else:
            motion = [f"output x [m]: spline(order = {rng.randint(5, 6)}, intervals = {intervals});"]
            motion.append(f"let u [m/{clock}] = (der(x) - ({number(a)} [1/{clock}]) * x) / {number(b)};")
        expression = f"integral({number(q)} [1/{clock}^2] * {away}^2 + {number(r)} * u^2)"
        minimize, worth = objective(rng, "minimize", "cost", expression, f"m^2/{clock}", 1 / second)
        statements = [
            f"duration T = {number(total)} [{clock}];",
            f"initial {{ x == {number(x0)} [m]; }}",
            f"final {{ x == {number(x1)} [m]; }}",
            minimize,
        ]
        text = problem(rng, "Turnpike", "There, along the level, and back.", statements + motion)
        step = phase / intervals
        yield Case(f"turnpikes_{index}", text, best * worth, 1e-5 + 3e-3 * min(step, 3) ** 4, why=f"l T = {phase:.3g}")
