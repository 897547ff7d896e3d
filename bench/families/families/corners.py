"""Costs, limits and equations with corners: abs, max, min, norm, if.

Answer: the least sum of distances to points is at their weighted median on a line (by sorting) and at Fermat's point in the
plane (Weiszfeld); a battery with losses that trades between two prices fills at the low one and sells at the high one if
that pays; a follower with a bounded speed is late by the triangle between a step and its ramp; a saturated input is a
bounded one.
"""

import math

import numpy as np

from case import Case
from meshes import Mesh, mesh
from spell import bounds, draw, number, numbers, objective, problem, rounded
from units import unit


def weiszfeld(points, weights):
    """The least weighted sum of distances."""

    def cost(p):
        return float(weights @ np.linalg.norm(points - p, axis=1))

    p = np.average(points, axis=0, weights=weights)
    for _ in range(20_000):
        distance = np.maximum(np.linalg.norm(points - p, axis=1), 1e-15)
        before, p = p, np.average(points, axis=0, weights=weights / distance)
        if np.linalg.norm(p - before) <= 1e-14 * np.linalg.norm(points):
            break
    return min([cost(p)] + [cost(q) for q in points])


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        kind = ["median", "fermat", "battery", "step", "saturated", "comfort"][index % 6]
        grid = mesh(rng, 10, 40, least=3)
        total, size = draw(rng, 1e-1, 1e2), draw(rng, 1e-3, 1e3)
        tolerance, scale, x = 1e-5, 0.0, f"[{length}]"
        fixed = [f"duration T = {number(total)} [{clock}];"]
        if kind == "median":
            n = rng.randint(2, 6)
            places = [rounded(size * rng.uniform(-1, 1), 3) for _ in range(n)]
            weights = [draw(rng, 0.2, 5, 2) for _ in range(n)]
            best = min(sum(w * abs(p - q) for w, p in zip(weights, places)) for q in places)
            statements = fixed + [
                f"output x {x}: spline(order = 4, intervals = {rng.randint(1, 4)});",
                f"param p[{n}] = {numbers(places)} {x};",
                f"param w[{n}] = {numbers(weights)};",
                "initial { x == 0; }" if rng.random() < 0.5 else "",
                rng.choice(["", f"guess {{ x = {number(5 * size)} {x}; }}"]),
            ]
            expression, symbol, factor = f"sum(i in 1 .. {n}, w[i] * abs(final(x) - p[i]))", length, metre
        elif kind == "fermat":
            n = rng.randint(3, 6)
            places = np.array([[rounded(size * rng.uniform(-1, 1), 3) for _ in range(2)] for _ in range(n)])
            weights = np.array([draw(rng, 0.2, 5, 2) for _ in range(n)])
            best = weiszfeld(places, weights)
            statements = fixed + [
                f"output r[2] {x}: spline(order = 4, intervals = {rng.randint(1, 4)});",
                f"param p[{n}, 2] = {numbers(places)} {x};",
                f"param w[{n}] = {numbers(weights)};",
                f"let gap[i in 1 .. {n}] {x} = norm(r - p[i]);",
                "initial { r == 0; }",
            ]
            expression, symbol, factor = f"sum(i in 1 .. {n}, w[i] * final(gap[i]))", length, metre
        elif kind == "battery":
            # The price is low up to the middle and high from there; what is stored in half of the time is all sold.
            low, high, eta = draw(rng, 0.1, 1), draw(rng, 0.5, 5), draw(rng, 0.6, 0.98, 2)
            most, room = draw(rng, 0.1, 100), draw(rng, 0.1, 2)
            capacity = rounded(most * total / 2 * eta * room, 3)
            stored = min(capacity, eta * most * total / 2, most * total / 2 / eta)
            best = -max(0.0, stored * eta * high - stored / eta * low)
            price = f"(if t <= T / 2 {{ {number(low)} }} else {{ {number(high)} }})"
            statements = fixed + [
                f"state E in 0 .. {number(capacity)} [J];",
                f"input p in -{number(most)} .. {number(most)} [J/{clock}];",
                f"dynamics {{ der(E) == if p >= 0 {{ {number(eta)} * p }} else {{ p / {number(eta)} }}; }}",
                "initial { E == 0; }",
            ]
            # The price jumps in the middle.
            statements.append(Mesh(2 * rng.randint(4, 16), 3).statement)
            expression, symbol, factor = f"integral({price} * p)", "J", 1.0
            tolerance, scale = 2e-3, 0.01 * low * most * total
        elif kind == "step":
            # On the way to a place at a bounded speed and staying there: late by size^2 / (2 v).
            speed = rounded(size / total * draw(rng, 1.3, 10), 3)
            best = size**2 / (2 * speed)
            statements = fixed + [
                f"output x {x}: spline(order = {rng.randint(3, 4)}, intervals = {grid.intervals}, smoothness = 1);",
                f"trajectory {{ abs(der(x)) <= {number(speed)} [{length}/{clock}]; }}",
                "initial { x == 0; }",
            ]
            expression, symbol, factor = f"integral(abs(x - {number(size)} {x}))", f"{length}*{clock}", metre * second
            tolerance = 1e-3 + 3 * (speed * total / size / grid.intervals) ** 2
        elif kind == "saturated":
            # A double integrator whose drive gives no more than it can, whatever is asked of it.
            force = draw(rng, 1e-2, 1e2)
            best = 2 * math.sqrt(size / force)
            statements = [
                f"duration T in {bounds(rng, best, clock)};",
                f"state x {x}, v [{length}/{clock}];",
                f"input u in -{number(5 * force)} .. {number(5 * force)} [{length}/{clock}^2];",
                f"param top = {number(force)} [{length}/{clock}^2];",
                "dynamics { der(x) == v;  der(v) == max(-top, min(top, u)); }",
                "initial { x == 0;  v == 0; }",
                f"final {{ x == {number(size)} {x};  v == 0; }}",
                grid.statement,
            ]
            expression, symbol, factor = "T", clock, second
            tolerance = 1e-3 + 8 / grid.intervals**2
        else:
            # A room cools like exp(-t) from twice what is wanted: what is missed begins after a half-life.
            rate, want = draw(rng, 0.3, 3) / total, draw(rng, 1, 30)
            rate = rounded(rate, 3)
            after = math.log(2) / rate
            best = (
                0.0
                if after >= total
                else want * ((total - after) - (math.exp(-rate * after) - math.exp(-rate * total)) * 2 / rate)
            )
            statements = fixed + [
                "state warm [K];",
                f"dynamics {{ der(warm) == -{number(rate)} [1/{clock}] * warm; }}",
                f"initial {{ warm == {number(2 * want)} [K]; }}",
                grid.statement,
            ]
            expression, symbol, factor = f"integral(max(0, {number(want)} [K] - warm))", f"K*{clock}", second
            tolerance, scale = 1e-3 + 3 / grid.intervals**2, 0.01 * want * total
        minimize, worth = objective(rng, "minimize", "cost", expression, symbol, factor)
        text = problem(rng, "Corner", "A cost with corners.", statements + [minimize])
        yield Case(f"corners_{index}", text, best * worth, tolerance, scale=scale * worth, why=kind)
