"""Problems without a solution, beside ones that are just possible.

Answer: the least time, effort or speed of each is known in closed form; a demand beyond it cannot be met, one within it can,
and then the objective is known too: a move in less than 2 sqrt(d / a), with less energy than 12 d^2 / T^3, at a speed below
d / T, two windows that exclude each other, a rest point beyond what a first-order system can hold.
"""

import math

from case import Case
from meshes import mesh
from spell import draw, number, objective, problem
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        kind = ["force", "energy", "speed", "windows", "hold", "way"][index % 6]
        possible = rng.random() < 0.35
        margin = draw(rng, 0.01, 0.4, 2)
        beyond = 1 + margin if possible else 1 / (1 + margin)
        way, total = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
        grid = mesh(rng, 8, 30, least=3)
        x, v, a = f"[{length}]", f"[{length}/{clock}]", f"[{length}/{clock}^2]"
        double = [f"state x {x}, v {v};", f"input a {a};", "dynamics { der(x) == v;  der(v) == a; }"]
        fixed = [f"duration T = {number(total)} [{clock}];"]
        ends = ["initial { x == 0;  v == 0; }", f"final {{ x == {number(way)} {x};  v == 0; }}"]
        symbol, factor = f"{length}^2/{clock}^3", metre**2 / second**3
        expression, tolerance, best = "integral(a^2)", 1e-3, math.nan
        if kind == "force":
            push = 4 * way / total**2 * beyond
            statements = fixed + double + ends + [f"trajectory {{ a in -{number(push)} .. {number(push)} {a}; }}"]
            # The least energy under the limit: full, a straight line, full; the ramp is as long as the way demands.
            ramp = math.sqrt(max(0.0, 1 - way / (push * total**2 / 4)) * 3)
            best = push**2 * total * (1 - 2 * ramp / 3) if ramp <= 1 else 12 * way**2 / total**3
            tolerance = 1e-3 + 2 / grid.intervals**2
        elif kind == "energy":
            most = 12 * way**2 / total**3 * beyond
            statements = fixed + double + ends + [f"temporal {{ integral(a^2) <= {number(most)} [{symbol}]; }}"]
            best, expression, symbol, factor = way, "final(x)", length, metre
            tolerance = 1e-5
        elif kind == "speed":
            top = way / total * beyond
            statements = fixed + [
                f"output x {x}: spline(order = 4, intervals = {grid.intervals});",
                f"trajectory {{ der(x) <= {number(top)} {v}; }}",
                "initial { x == 0; }",
                f"final {{ x >= {number(way)} {x}; }}",
            ]
            best, expression, symbol, factor = (
                way**2 / total,
                "integral(der(x)^2)",
                f"{length}^2/{clock}",
                metre**2 / second,
            )
        elif kind == "windows":
            # In the middle it is at 0 or more, a tenth of the time later below: the speed decides.
            gap = 0.1 * total
            top = way / gap * beyond
            statements = fixed + [
                f"state x {x};",
                f"input v in -{number(top)} .. {number(top)} {v};",
                "dynamics { der(x) == v; }",
                f"trajectory from 0.3 * T to 0.5 * T {{ x >= {number(way)} {x}; }}",
                "trajectory from 0.6 * T to 0.8 * T { x <= 0; }",
            ]
            best, expression, symbol, factor = way**2 / gap, "integral(v^2)", f"{length}^2/{clock}", metre**2 / second
        elif kind == "hold":
            most = way * beyond
            best, expression, symbol, factor = way * total, "integral(u)", clock, second
            statements = fixed + [
                "state x;",
                f"input u in 0 .. {number(most)};",
                f"dynamics {{ der(x) == (u - x) / {number(total / draw(rng, 1, 5))} [{clock}]; }}",
                f"trajectory {{ x >= {number(way)}; }}",
                f"initial {{ x == {number(way)}; }}",
            ]
        else:
            # Less than the straight line, in the plane.
            most = way * beyond
            statements = fixed + [
                f"output p[2] {x}: spline(order = 5, intervals = {grid.intervals});",
                "initial { p == 0; }",
                f"final {{ p == ({number(0.6 * way)}, {number(0.8 * way)}) {x}; }}",
                f"temporal {{ integral(norm(der(p))) <= {number(most)} {x}; }}",
            ]
            best, expression, symbol, factor = (
                way**2 / total,
                "integral(norm(der(p))^2)",
                f"{length}^2/{clock}",
                metre**2 / second,
            )
        if kind not in ("speed", "way"):
            statements = statements + [grid.statement]
        sought, worth = objective(rng, "minimize", "cost", expression, symbol, factor)
        text = problem(rng, "Demand", "What is asked for.", statements + [sought])
        why = f"{kind}, {margin:.2g} {'within' if possible else 'beyond'}"
        yield Case(
            f"near_the_limit_{index}",
            text,
            best * worth if possible else math.nan,
            tolerance,
            why=why,
            infeasible=not possible,
        )
