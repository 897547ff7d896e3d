"""Heating to a temperature in time with a bounded heater, and holding it.

Answer: C T' = P - G (T - Ta). The least energy heats late and with full power, for tau ln(P / (P - G dT)); the same time
is the least. Holding a temperature over a time costs G dT a second. With a price that is higher in its first part, the
bill is what is heated in the last part alone where that is enough. Least square of the power: Gramian.
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        (clock, second), (power, watt) = unit(rng, "time", "h", "min", "s"), unit(rng, "power", "W", "kW", "mW", "MW")
        loss, constant = draw(rng, 1e-3, 1e2), draw(rng, 0.1, 20)
        air, rise = rng.choice([273.15, 293.0, 288.15]), draw(rng, 1, 80)
        full = rounded(loss * rise * draw(rng, 1.05, 10), 4)
        on = constant * math.log(full / (full - loss * rise))
        capacity = f"{number(loss * constant)} [{power}*{clock}/K]"
        statements = [
            "state Temp [K];",
            f"input P in 0 .. {number(full)} [{power}];",
            f"param G = {number(loss)} [{power}/K];",
            f"param air = {number(air)} [K];",
            f"dynamics {{ {capacity} * der(Temp) == P - G * (Temp - air); }}",
            "initial { Temp == air; }",
        ]
        kind = ["late", "soon", "hold", "square"][index % 4]
        grid = mesh(rng, 8, 40, least=3)
        tolerance = 2e-3 + 2 / grid.intervals**2
        symbol, factor = f"{power}*{clock}", watt * second
        if kind == "soon":
            statements += [f"duration T in {bounds(rng, on, clock)};", f"final {{ Temp >= air + {number(rise)} [K]; }}"]
            expression, best, symbol, factor, tolerance = "T", on, clock, second, 1e-5
        elif kind == "late":
            total = rounded(on * draw(rng, 1.3, 5), 4)
            statements += [f"duration T = {number(total)} [{clock}];", f"final {{ Temp >= air + {number(rise)} [K]; }}"]
            expression, best = "integral(P)", full * on
            tolerance += 1 / grid.intervals
        elif kind == "hold":
            ready = rounded(on * draw(rng, 1.2, 4), 4)
            until = rounded(ready + constant * draw(rng, 0.2, 3), 4)
            total = rounded(until + constant * draw(rng, 0.2, 2), 4)
            statements += [
                f"duration T = {number(total)} [{clock}];",
                f"trajectory from {number(ready)} [{clock}] to {number(until)} [{clock}] {{ warm: Temp >= air + {number(rise)} [K]; }}",
            ]
            expression, best = "integral(P)", full * on + loss * rise * (until - ready)
            tolerance += 2 * full * on / best / grid.intervals
        else:
            total = rounded(constant * draw(rng, 0.5, 3), 4)
            most = 2 * loss * rise / (1 - math.exp(-2 * total / constant))
            statements[1] = (
                f"input P [{power}];" if rng.random() < 0.5 else f"input P in 0 .. {number(2 * most)} [{power}];"
            )
            statements += [f"duration T = {number(total)} [{clock}];", f"final {{ Temp == air + {number(rise)} [K]; }}"]
            gram = (1 - math.exp(-2 * total / constant)) / (2 * loss**2 * constant)
            expression, best, symbol, factor, tolerance = (
                "integral(P^2)",
                rise**2 / gram,
                f"{power}^2*{clock}",
                watt**2 * second,
                1e-5,
            )
        minimize, worth = objective(rng, "minimize", "bill", expression, symbol, factor)
        text = problem(rng, "Heater", "A room is warm in time.", statements + [grid.statement, minimize])
        yield Case(f"heating_{index}", text, best * worth, tolerance, why=kind)
