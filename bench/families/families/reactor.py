"""First-order kinetics A -> B -> C: the best time, the best temperature, the best stirred tank; flushing a tank.

Answer: Levenspiel, Chemical Reaction Engineering, chapter 8: the most of B is (k1/k2)^(k2/(k2-k1)), of equal rates 1/e; in
a stirred tank 1/(1 + sqrt(k2/k1))^2. The best temperature at a fixed time is a maximum of one variable. A tank that is
flushed with clear water needs its volume times the logarithm of the dilution.
"""

import math

import numpy as np
from scipy.optimize import minimize_scalar

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def made(k1, k2, time):
    """Share of B after a time."""
    if abs(k1 - k2) < 1e-9 * k1:
        return k1 * time * math.exp(-k1 * time)
    return k1 / (k2 - k1) * (math.exp(-k1 * time) - math.exp(-k2 * time))


def cases(rng, count):
    for index in range(count):
        (clock, second), (amount, dense) = unit(rng, "time", "min", "h", "s", "ms", "day"), unit(rng, "concentration")
        full, k1 = draw(rng, 1e-3, 1e3), draw(rng, 1e-3, 1e3)
        k2 = rng.choice([k1, rounded(k1 * draw(rng, 0.02, 20), 3)])
        kinetics = [f"state A, B [{amount}];", f"initial {{ A == {number(full)} [{amount}];  B == 0; }}"]
        equations = "dynamics { der(A) == -k1 * A;  der(B) == k1 * A - k2 * B; }"
        kind = ["time", "temperature", "tank", "flush"][index % 4]
        grid = mesh(rng, 10, 30, least=4)
        tolerance, symbol, factor, sense, expression = 1e-5, amount, dense, "maximize", "final(B)"
        if kind == "time":
            end = 1 / k1 if k1 == k2 else math.log(k1 / k2) / (k1 - k2)
            best = full * made(k1, k2, end)
            rates = f"param k1 = {number(k1)} [1/{clock}];\nparam k2 = {number(k2)} [1/{clock}];"
            statements = kinetics + [equations, rates, f"duration T in {bounds(rng, end, clock)};"]
        elif kind == "temperature":
            first = draw(rng, 3000, 9000)
            barrier = first, rounded(first * draw(rng, 1.3, 3), 4)
            time = rounded(draw(rng, 0.5, 5) / k1, 3)
            k2 = rounded(0.3 * k1, 3)

            def share(kelvin):
                return made(*(k * math.exp(e * (1 / 350 - 1 / kelvin)) for k, e in zip((k1, k2), barrier)), time)

            kelvins = np.linspace(250, 500, 4001)
            top = kelvins[int(np.argmax([share(kelvin) for kelvin in kelvins]))]
            found = minimize_scalar(
                lambda k: -share(k),
                bounds=(max(250, top - 1), min(500, top + 1)),
                method="bounded",
                options={"xatol": 1e-9},
            )
            best, tolerance = -float(found.fun) * full, 1e-4
            lets = "\n".join(
                f"let k{i} [1/{clock}] = {number(k)} [1/{clock}] * exp({number(e)} [K] * (1 / 350 [K] - 1 / Temp));"
                for i, k, e in ((1, k1, barrier[0]), (2, k2, barrier[1]))
            )
            temperature = "variable Temp in 250 .. 500 [K];"
            statements = kinetics + [equations, lets, temperature, f"duration T = {number(time)} [{clock}];"]
        elif kind == "tank":
            end = 1 / math.sqrt(k1 * k2)
            best = full * k1 * end / ((1 + k1 * end) * (1 + k2 * end))
            # A steady state is a motion that stands still: one interval, a variable for the time spent in the tank.
            statements = [
                f"variable theta in {bounds(rng, end, clock)};",
                f"variable A [{amount}], B [{amount}];",
                "output s: spline(order = 2, intervals = 1);",
                "initial { s == 0; }\nfinal { s == 1; }",
                f"duration T = 1 [{clock}];",
                f"param k1 = {number(k1)} [1/{clock}];\nparam k2 = {number(k2)} [1/{clock}];",
                f"temporal {{ {number(full)} [{amount}] - A == k1 * theta * A;  B == theta * (k1 * A - k2 * B); }}",
            ]
            expression = "B"
        else:
            volume, dilution = draw(rng, 1e-2, 1e3), draw(rng, 1.5, 200)
            pump = draw(rng, 1e-2, 1e2)
            best, sense = volume / pump * math.log(dilution), "minimize"
            symbol, factor, expression = clock, second, "T"
            statements = [
                f"duration T in {bounds(rng, best, clock)};",
                f"state c [{amount}];",
                f"input q in 0 .. {number(pump)} [m^3/{clock}];",
                f"dynamics {{ {number(volume)} [m^3] * der(c) == -q * c; }}",
                f"initial {{ c == {number(full)} [{amount}]; }}",
                f"final {{ c <= {number(full / dilution)} [{amount}]; }}",
            ]
            tolerance = 1e-4
        sought, worth = objective(rng, sense, "best", expression, symbol, factor)
        text = problem(rng, "Reactor", "The most from a reactor.", statements + [grid.statement, sought])
        yield Case(f"reactor_{index}", text, best * worth, tolerance, why=kind)
