"""Moves under bounds on different norms of speed or thrust, and lengths of ways in these norms.

Answer: what is asked for is on a straight line; the least time is |d| / V, or from rest to rest 2 sqrt(|d| / A), in the norm of
the bound; the least length, however fast it is covered, is |d| in the norm of the cost, for which there are many ways.
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, number, numbers, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        n = rng.choice([2, 2, 3])
        way = [rounded(draw(rng, 1e-2, 1e2) * rng.choice([1, -1]), 3) for _ in range(n)]
        which = rng.choice(["sum", "norm", "max"])
        size = {"sum": sum(map(abs, way)), "norm": math.hypot(*way), "max": max(map(abs, way))}[which]
        spelled = {
            "sum": lambda v: (
                " + ".join(f"abs({v}[{k}])" for k in range(1, n + 1))
                if rng.random() < 0.5
                else f"sum(i in 1 .. {n}, abs({v}[i]))"
            ),
            "norm": lambda v: f"norm({v})",
            "max": lambda v: f"max(i in 1 .. {n}, abs({v}[i]))",
        }[which]
        kind = ["speed", "thrust", "length"][index % 3]
        place, rate, force = f"[{length}]", f"[{length}/{clock}]", f"[{length}/{clock}^2]"
        most = draw(rng, 1e-2, 1e2)
        grid = mesh(rng, 6, 30, least=3)
        end = f"r == {numbers(way)} {place};"
        if kind == "thrust":
            best = 2 * math.sqrt(size / most)
            statements = [
                f"state r[{n}] {place}, v[{n}] {rate};",
                f"input a[{n}] {force};",
                "dynamics { der(r) == v;  der(v) == a; }",
                f"trajectory {{ {spelled('a')} <= {number(most)} {force}; }}",
                "initial { r == 0;  v == 0; }",
                f"final {{ {end}  v == 0; }}",
                f"duration T in {bounds(rng, best, clock)};",
            ]
            expression, symbol, factor, tolerance = "T", clock, second, 1e-3 + 6 / grid.intervals**2
        elif kind == "speed":
            best = size / most
            statements = [
                f"state r[{n}] {place};",
                f"input v[{n}] {rate};",
                "dynamics { der(r) == v; }",
                f"trajectory {{ {spelled('v')} <= {number(most)} {rate}; }}",
                "initial { r == 0; }",
                f"final {{ {end} }}",
                f"duration T in {bounds(rng, best, clock)};",
            ]
            expression, symbol, factor, tolerance = "T", clock, second, 1e-5
        else:
            best = size
            statements = [
                f"output r[{n}] {place}: spline(order = {rng.randint(3, 5)}, intervals = {grid.intervals});",
                "initial { r == 0; }",
                f"final {{ {end} }}",
                f"duration T = {number(draw(rng, 0.1, 100))} [{clock}];",
                f"let v[{n}] {rate} = der(r);",
            ]
            expression, symbol, factor, tolerance = f"integral({spelled('v')})", length, metre, 1e-4
        if kind != "length":
            statements.append(grid.statement)
        minimize, worth = objective(rng, "minimize", "cost", expression, symbol, factor)
        text = problem(rng, "Norm", "A straight line in some norm.", statements + [minimize])
        yield Case(f"norms_{index}", text, best * worth, tolerance, why=f"{kind}, {which}")
