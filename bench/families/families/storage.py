"""A battery buys and sells at hourly prices, or a reservoir turns its inflow into money: powers are held for a period.

Answer: the linear program itself, by scipy's linprog (HiGHS).
"""

import numpy as np
from scipy.optimize import linprog

from case import Case
from spell import guess, number, numbers, problem


def battery(prices, hours, power, room, first, efficiency):
    """The largest gain; energies at the ends of periods lie within the room, the last is the first again."""
    n = len(prices)
    # Variables: charge and discharge of each period, at the grid.
    total = np.tril(np.ones((n, n))) * hours
    stored = np.hstack([total * efficiency, -total / efficiency])
    cost = np.concatenate([prices, -prices]) * hours
    found = linprog(
        cost,
        A_ub=np.vstack([stored, -stored]),
        b_ub=np.concatenate([np.full(n, room - first), np.full(n, first)]),
        A_eq=stored[-1:],
        b_eq=[0.0],
        bounds=[(0, power)] * (2 * n),
        method="highs",
    )
    return -found.fun


def reservoir(prices, inflow, hours, most, room, first):
    """The largest sum of price times flow through the turbine; what is too much is spilt."""
    n = len(prices)
    total = np.tril(np.ones((n, n))) * hours
    filled = np.hstack([-total, -total])
    come = np.cumsum(inflow) * hours + first
    found = linprog(
        np.concatenate([-prices, np.zeros(n)]) * hours,
        A_ub=np.vstack([filled, -filled]),
        b_ub=np.concatenate([room - come, come]),
        A_eq=filled[-1:],
        b_eq=[first - come[-1]],
        bounds=[(0, most)] * n + [(0, None)] * n,
        method="highs",
    )
    return -found.fun


def cases(rng, count):
    for k in range(count):
        n = rng.choice((6, 12, 24, 48))
        period = rng.choice((1, 1, 0.5, 2))
        prices = np.array([round(rng.uniform(20, 120), 1) if rng.random() < 0.9 else round(rng.uniform(-20, 20), 1) for _ in range(n)])
        kind = rng.choice(("battery", "reservoir"))
        phases = rng.random() < 0.5
        points = rng.choice((1, 2, 3))
        window = lambda values, name: f"let {name} = sum(i in 1 .. n, if t in (i - 1) * period .. i * period {{ {values}[i] }} else {{ 0 }});"
        statements = [f"const n = {n};", f"const period = {number(period)} [h];"]
        if kind == "battery":
            power, room = round(10 ** rng.uniform(0, 3), 1), round(10 ** rng.uniform(0.5, 3.5), 1)
            first = round(room * rng.uniform(0, 1), 1)
            efficiency = rng.choice((1.0, 0.95, 0.9))
            # Prices in 1/MWh, powers in kW.
            optimum = battery(prices / 1000, period, power, room, first, efficiency)
            statements += [
                f"param price[n] = {numbers(prices)} [1/MWh];",
                f"state E in 0 .. {number(room)} [kWh];",
                f"input charge in 0 .. {number(power)} [kW]: held;",
                f"input discharge in 0 .. {number(power)} [kW]: held;",
                f"dynamics {{ der(E) == {efficiency!r} * charge - discharge / {efficiency!r}; }}",
                f"initial {{ E == {number(first)} [kWh]; }}",
                f"final {{ E == {number(first)} [kWh]; }}",
            ]
            gain = "(discharge - charge)"
            poor = ["charge = 1000 [MW]"]
            needs = ["price"]
            value, scale = "gain", power * period * 0.1
        else:
            most = round(10 ** rng.uniform(0, 2), 1)
            inflow = np.array([round(most * rng.uniform(0, 0.9), 2) for _ in range(n)])
            room = round(most * 3600 * period * 10 ** rng.uniform(-0.5, 1) / 1000, 1)
            first = round(room * rng.uniform(0, 1), 1)
            # Prices in 1/m^3, flows in m^3/s, volumes in 1000 m^3.
            optimum = reservoir(prices, inflow, 3600 * period, most, room * 1000, first * 1000)
            statements += [
                f"param price[n] = {numbers(prices)} [1/m^3];",
                f"param inflow[n] = {numbers(inflow)} [m^3/s];",
                f"state V in 0 .. {number(room * 1000)} [m^3];",
                f"input turbine in 0 .. {number(most)} [m^3/s]: held;",
                "input spill in 0 [m^3/s] ..: held;",
                "dynamics { der(V) == coming - turbine - spill; }",
                f"initial {{ V == {number(first * 1000)} [m^3]; }}",
                f"final {{ V == {number(first * 1000)} [m^3]; }}",
            ]
            gain = "turbine"
            poor = ["V = 1 [m^3]"]
            needs = ["price", "inflow"]
            value, scale = "gain", most * 3600 * period
        own = {"price": "price_now", "inflow": "coming"}
        if phases:
            statements += [
                f"collocation gauss(points = {points}, intervals = 1);",
                "phase hour[i in 1 .. n] { duration = period;  " + "  ".join(f"let {own[one]} = {one}[i];" for one in needs) + " }",
            ]
        else:
            statements += [
                f"collocation gauss(points = {points}, intervals = n);",
                "duration T = n * period;",
                *(window(one, own[one]) for one in needs),
            ]
        statements.append(f"maximize {value}: integral(price_now * {gain});")
        statements += guess(rng, [], poor)
        yield Case(
            name=f"storage_{k}",
            text=problem(rng, "Storage", f"A {kind} earns what it can.", statements),
            optimum=optimum,
            tolerance=1e-6,
            scale=scale,
            why="linprog",
        )
