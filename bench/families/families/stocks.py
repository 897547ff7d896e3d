"""Stocks: production for an order, doses that keep a level, levels that decay.

Answer: Kamien and Schwartz (1991), section I.1: with a cost c u^2 and h x an order of B at T is begun 2 sqrt(c B / h) before
and costs h^2 t^3 / (6 c), or, where there is less time, c B^2 / T + h B T / 2 - h^2 T^3 / (48 c). The least sum of doses that
keep a decaying level is a linear program (scipy).
"""

import math

import numpy as np
from scipy.optimize import linprog

from case import Case
from meshes import mesh
from spell import draw, number, numbers, objective, problem, rounded
from units import unit


def order(rng, clock):
    """Production at a quadratic cost into a stock at a linear one."""
    amount, dear, hold = draw(rng, 1e-2, 1e5), draw(rng, 1e-3, 1e2), draw(rng, 1e-3, 1e2)
    lead = 2 * math.sqrt(dear * amount / hold)
    total = rounded(lead * draw(rng, 0.3, 4), 4)
    if total >= lead:
        best = hold**2 * lead**3 / (6 * dear)
    else:
        best = dear * amount**2 / total + hold * amount * total / 2 - hold**2 * total**3 / (48 * dear)
    grid = mesh(rng, 8, 40, least=3)
    statements = [
        f"duration T = {number(total)} [{clock}];",
        f"param c = {number(dear)} [{clock}];",
        f"param h = {number(hold)} [1/{clock}];",
        grid.statement,
        "state x;",
        rng.choice(
            [f"input u in 0 .. {number(100 * amount / min(total, lead))} [1/{clock}];", f"input u in 0 [1/{clock}] ..;"]
        ),
        "dynamics { der(x) == u; }",
        "initial { x == 0; }",
        f"final {{ x {rng.choice(['==', '>='])} {number(amount)}; }}",
    ]
    return statements, "integral(c * u^2 + h * x)", best, 1e-3 + 3 / grid.intervals**2


def doses(rng, clock):
    """Doses at given times; the level must not fall below what is needed."""
    n = rng.randint(2, 6)
    decay = draw(rng, 0.1, 3)
    step = draw(rng, 1e-1, 1e1)
    least = draw(rng, 1e-3, 1e3)
    needs = [rounded(least * draw(rng, 0.5, 2), 3) for _ in range(n)]
    lasts = [rounded(step * draw(rng, 0.5, 2), 3) for _ in range(n)]
    rate = rounded(decay / step, 3)
    keep = [math.exp(-rate * last) for last in lasts]
    rows = []
    for k in range(n):
        rows.append([math.prod(keep[j : k + 1]) if j <= k else 0.0 for j in range(n)])
    best = linprog(np.ones(n), A_ub=-np.array(rows), b_ub=-np.array(needs), bounds=(0, None)).fun
    statements = [
        f"variable dose[{n}] in {rng.choice(['0 ..', f'0 .. {number(1e4 * least)}'])};",
        f"variable level[{n}];",
        "state x;",
        f"param lasts[{n}] = {numbers(lasts)} [{clock}];",
        f"param need[{n}] = {numbers(needs)};",
        f"dynamics {{ der(x) == -{number(rate)} [1/{clock}] * x; }}",
        f"collocation gauss(points = 4, intervals = {rng.randint(4, 10)});",
        f"phase day[i in 1 .. {n}] {{\n    duration = lasts[i];\n    jump x;\n    initial {{ x == level[i]; }}\n"
        + rng.choice(["    trajectory { x >= need[i]; }\n", "    final { x >= need[i]; }\n"])
        + "}",
        f"temporal {{ level[1] == dose[1];  for i in 2 .. {n} {{ level[i] == final(day[i - 1], x) + dose[i]; }} }}",
    ]
    return statements, "sum(dose)", best, 1e-4


def cases(rng, count):
    for index in range(count):
        clock, _ = unit(rng, "time", "day", "h", "min")
        statements, expression, best, tolerance = [order, doses][index % 2](rng, clock)
        minimize, worth = objective(rng, "minimize", "cost", expression, "", 1.0)
        text = problem(rng, "Stock", "What is needed is there when it is needed.", statements + [minimize])
        yield Case(f"stocks_{index}", text, best * worth, tolerance, why=[order, doses][index % 2].__doc__)
