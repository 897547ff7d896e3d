"""When to stop: felling a growing wood, replacing a machine that wears, a batch that is worth its time.

Answer: Fisher's and Faustmann's rules. A logistic stock is felled when its growth rate is the discount; average cost of
a machine whose upkeep grows by g a year is least at sqrt(2 C / g); the best time of a batch with dead time is the root of
one equation.
"""

import math

from scipy.optimize import brentq

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem
from units import unit


def fell(rng, clock, second):
    """The discounted value of a logistic stock."""
    growth, capacity, seed = draw(rng, 0.05, 5), draw(rng, 1e-3, 1e6), draw(rng, 0.001, 0.3)
    discount = growth * draw(rng, 0.05, 1 - 1.5 * seed, 2)
    share = 1 - discount / growth
    end = math.log(share * (1 - seed) / (seed * (1 - share))) / growth
    statements = [
        f"duration T in {bounds(rng, end, clock)};",
        "state V;",
        f"dynamics {{ der(V) == {number(growth)} [1/{clock}] * V * (1 - V / {number(capacity)}); }}",
        f"initial {{ V == {number(seed * capacity)}; }}",
        f"maximize final(V) * exp(-{number(discount)} [1/{clock}] * T);",
    ]
    return statements, share * capacity * math.exp(-discount * end), f"felled at {end}"


def replace(rng, clock, second):
    """The average cost of buying and keeping a machine."""
    price, wear = draw(rng, 1e-2, 1e6), draw(rng, 1e-3, 1e3)
    end = math.sqrt(2 * price / wear)
    minimize, worth = objective(rng, "minimize", "cost", "(price + integral(upkeep)) / T", f"1/{clock}", 1 / second)
    statements = [
        f"duration T in {bounds(rng, end, clock)};",
        f"state upkeep [1/{clock}];",
        f"param price = {number(price)};",
        f"dynamics {{ der(upkeep) == {number(wear)} [1/{clock}^2]; }}",
        "initial { upkeep == 0; }",
        minimize,
    ]
    return statements, math.sqrt(2 * price * wear) * worth, f"replaced at {end}"


def batch(rng, clock, second):
    """Yield a batch over its time and the time between batches."""
    rate, dead, full = draw(rng, 1e-2, 1e2), draw(rng, 0.01, 3), draw(rng, 1e-2, 1e4)
    angle = brentq(lambda x: math.log1p(x + dead) - x, 1e-9, 60)
    end = angle / rate
    best = full * rate * math.exp(-angle)
    maximize, worth = objective(rng, "maximize", "yield", "final(B) / (T + dead)", f"mol/{clock}", 1 / second)
    statements = [
        f"duration T in {bounds(rng, end, clock)};",
        "state A, B [mol];",
        f"param dead = {number(dead / rate)} [{clock}];",
        f"param k = {number(rate)} [1/{clock}];",
        "dynamics { der(A) == -k * A;  der(B) == k * A; }",
        f"initial {{ A == {number(full)} [mol];  B == 0; }}",
        maximize,
    ]
    return statements, best * worth, f"stopped at {end}"


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time", "day", "h", "s", "ms")
        statements, best, why = [fell, replace, batch][index % 3](rng, clock, second)
        grid = mesh(rng, 4, 20, least=3)
        text = problem(rng, "Stopping", "It stops when it is worth most.", statements + [grid.statement])
        yield Case(f"stopping_{index}", text, best, 1e-3, why=why)
