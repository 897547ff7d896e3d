"""A logistic stock harvested for the greatest catch: the most rapid way to half of the capacity, and staying there.

Answer: Clark, Mathematical Bioeconomics (1976), section 2: singular harvest r K / 4. The way to K/2 is closed: without
harvest a logistic curve, with full harvest the time is an elementary integral, taken by quadrature.
"""

import math

from scipy.integrate import quad

from case import Case
from meshes import mesh
from spell import draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        clock, _ = unit(rng, "time", "day", "h", "s")
        mass, kilo = unit(rng, "mass", "t", "kg", "g")
        growth, capacity = draw(rng, 0.01, 10), draw(rng, 1e-2, 1e5)
        yield_best = growth * capacity / 4
        most = rounded(yield_best * draw(rng, 1.2, 5), 4)
        share = draw(rng, 0.05, 0.95)
        if share < 0.5:
            way = math.log((1 - share) / share) / growth
        else:
            way = quad(lambda x: 1 / (most - growth * x * (1 - x / capacity)), capacity / 2, share * capacity)[0]
        total = rounded(way * 1.2 + draw(rng, 1, 8) / growth, 4)
        caught = (0 if share < 0.5 else most * way) + yield_best * (total - way)
        grid = mesh(rng, 10, 50, least=3)
        maximize, worth = objective(rng, "maximize", "catch", "integral(h)", mass, kilo)
        text = problem(
            rng,
            "Fishery",
            "As much fish as possible, and half of the capacity left.",
            [
                f"domain t [{clock}];" if rng.random() < 0.5 else "",
                f"duration T = {number(total)} [{clock}];",
                f"state x {'in 0 .. ' + number(2 * capacity) if rng.random() < 0.5 else ''} [{mass}];",
                f"input h in 0 .. {number(most)} [{mass}/{clock}];",
                f"param r = {number(growth)} [1/{clock}];",
                f"param K = {number(capacity)} [{mass}];",
                "dynamics { der(x) == r * x * (1 - x / K) - h; }",
                f"initial {{ x == {number(share * capacity)} [{mass}]; }}",
                "final { x >= K / 2; }",
                maximize,
                grid.statement,
                rng.choice(["", "guess { x = K / 2; }", f"guess {{ h = {number(most / 3)} [{mass}/{clock}]; }}"]),
            ],
        )
        yield Case(f"harvest_{index}", text, caught * worth, 3e-3 + 5 / grid.intervals**2, why=f"share {share}")
