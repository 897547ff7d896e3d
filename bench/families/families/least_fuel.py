"""From rest to rest at a fixed time with the least fuel, the integral of the magnitude of the thrust.

Answer: Athans and Falb (1966), section 8: full thrust, coast, full brake; fuel a (T - sqrt(T^2 - 4 d / a)). Along a
straight line in space the direction does not matter. With a free duration and a price on it, T is the root of one
equation, in closed form. Too short a time has no solution.
"""

import math

from case import Case
from meshes import mesh
from spell import draw, number, numbers, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        way, thrust = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
        least = 2 * math.sqrt(way / thrust)
        infeasible = rng.random() < 0.15
        total = rounded(least * (draw(rng, 0.5, 0.95) if infeasible else draw(rng, 1.02, 8)), 4)
        fuel = math.nan if infeasible else thrust * (total - math.sqrt(total**2 - 4 * way / thrust))
        size = rng.choice([1, 1, 2, 3])
        grid = mesh(rng, 8, 50, least=3)
        minimize, worth = objective(
            rng,
            "minimize",
            "fuel",
            f"integral({'abs(u)' if size == 1 else 'norm(u)'})",
            f"{length}/{clock}",
            metre / second,
        )
        u = f"[{length}/{clock}^2]"
        if size == 1:
            goal_text = f"{number(way)} [{length}]"
            bounds = f"input u in -{number(thrust)} .. {number(thrust)} {u};"
            limit = ""
            states = f"state r [{length}], v [{length}/{clock}];"
        else:
            direction = [rng.gauss(0, 1) for _ in range(size)]
            norm = math.hypot(*direction)
            goal_text = f"{numbers(way * d / norm for d in direction)} [{length}]"
            bounds = f"input u[{size}] {u};"
            limit = f"trajectory {{ norm(u) <= {number(thrust)} {u}; }}"
            states = f"state r[{size}] [{length}], v[{size}] [{length}/{clock}];"
        text = problem(
            rng,
            "Transfer",
            "A satellite moves to its place with the least fuel.",
            [
                f"duration T = {number(total)} [{clock}];",
                grid.statement,
                minimize,
                states,
                bounds,
                limit,
                "dynamics { der(r) == v;  der(v) == u; }",
                "initial { r == 0;  v == 0; }",
                f"final {{ r == {goal_text};  v == 0; }}",
                rng.choice(["", f"guess {{ r = {goal_text} * tau; }}"]),
            ],
        )
        tolerance = 2e-3 + 10 / grid.intervals**2
        yield Case(
            f"least_fuel_{index}",
            text,
            fuel * worth,
            tolerance,
            why=f"T / least {total / least:.4g}",
            infeasible=infeasible,
        )
