"""Tables of data whose meaning is known: prices of energy over time, ways over ground, losses over speed.

Answer: energy is bought when it is cheapest: with a price that is linear between its nodes, all of the time below one price
(a root). A table of a straight line is that line, by whatever method: a metric along the way, a drag that is linear in
the speed (the least time is a logarithm), a plane whose lowest place in a circle is known.
"""

import math

import numpy as np

from case import Case
from meshes import Mesh, mesh
from spell import bounds, draw, number, objective, problem, rounded
from units import unit

METHODS = ["monotone", "linear", "bspline(order = 4)", "bspline(order = 3)"]


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time", "h", "min", "day")
        kind = ["price", "line", "drag", "plane"][index % 4]
        grid = mesh(rng, 16, 48, least=3)
        tolerance = 1e-5
        if kind == "price":
            n = rng.randint(3, 7)
            step, most = draw(rng, 0.1, 10, 2), draw(rng, 1e-2, 1e3)
            nodes = np.arange(n + 1) * step
            prices = np.array([draw(rng, 0.1, 1, 2) for _ in nodes])
            part = draw(rng, 0.15, 0.8)
            energy = rounded(most * nodes[-1] * part, 4)
            fine = (np.arange(400_000) + 0.5) * nodes[-1] / 400_000
            curve = np.sort(np.interp(fine, nodes, prices))
            share = energy / (most * nodes[-1]) * len(curve)
            best = (
                most * nodes[-1] / len(curve) * (curve[: int(share)].sum() + (share - int(share)) * curve[int(share)])
            )
            rows = "  ".join(f"{number(t)}: {number(p)};" for t, p in zip(nodes, prices))
            statements = [
                f"duration T = {number(nodes[-1])} [{clock}];",
                f"table price(time [{clock}]) [1/J] = linear {{ {rows} }}",
                "state E [J];",
                f"input p in 0 .. {number(most)} [J/{clock}];",
                "dynamics { der(E) == p; }",
                "initial { E == 0; }",
                f"final {{ E >= {number(energy)} [J]; }}",
            ]
            grid = Mesh(n * rng.randint(3, 8), 3)
            expression, symbol, factor, sense = "integral(price(t) * p)", "", 1.0, "minimize"
            tolerance = 1e-3 + 30 / grid.intervals**2
        elif kind == "line":
            length, metre = unit(rng, "length")
            way, slope, first = draw(rng, 1e-2, 1e3), draw(rng, 0.01, 1), draw(rng, 1, 10)
            method = rng.choice(METHODS)
            nodes = [way * f for f in (-0.5, 0.1, 0.3, 0.7, 1.6)]
            rows = "  ".join(f"{number(x)}: {number(first + slope * x / way)};" for x in nodes)
            total = draw(rng, 0.1, 100)
            # The root of the table times the speed is even: the square of its integral over the way, by the time.
            best = (way * (2 / 3) * ((first + slope) ** 1.5 - first**1.5) / slope) ** 2 / total
            statements = [
                f"duration T = {number(total)} [{clock}];",
                f"table rough(x [{length}]) = {method} {{ {rows} }}",
                f"output x [{length}]: spline(order = 5, intervals = {rng.randint(6, 16)});",
                "initial { x == 0; }",
                f"final {{ x == {number(way)} [{length}]; }}",
            ]
            expression, symbol, factor, sense = (
                "integral(rough(x) * der(x)^2)",
                f"{length}^2/{clock}",
                metre**2 / second,
                "minimize",
            )
        elif kind == "drag":
            method = rng.choice(METHODS)
            drag, top = draw(rng, 1e-2, 10), draw(rng, 1, 1e3)
            push = rounded(drag * top * draw(rng, 1.1, 5), 4)
            best = math.log(push / (push - drag * top)) / drag
            nodes = [top * f for f in (-0.2, 0.25, 0.5, 0.9, 1.3)]
            rows = "  ".join(f"{number(v)}: {number(drag * v)};" for v in nodes)
            statements = [
                f"duration T in {bounds(rng, best, clock)};",
                f"table drag(v [m/{clock}]) [m/{clock}^2] = {method} {{ {rows} }}",
                f"state v in {number(-0.1 * top)} .. {number(1.2 * top)} [m/{clock}];"
                if rng.random() < 0.5
                else f"state v [m/{clock}];",
                f"input f in 0 .. {number(push)} [m/{clock}^2];",
                "dynamics { der(v) == f - drag(v); }",
                "initial { v == 0; }",
                f"final {{ v == {number(top)} [m/{clock}]; }}",
            ]
            expression, symbol, factor, sense = "T", clock, second, "minimize"
        else:
            method = rng.choice(METHODS)
            side, height, bend = draw(rng, 1, 1e3), draw(rng, 1, 100), draw(rng, 0.1, 1)
            nodes = [-side, -side / 3, side / 4, side, 2 * side]
            table = "\n".join(
                f"    {number(x)}: " + ", ".join(number(height * (1 + bend * x / side + 0.5 * y / side)) for y in nodes) + ";"
                for x in nodes
            )
            total = draw(rng, 0.1, 100)
            # A point rolls to the lowest place of a plane within a circle: its height there is known.
            best = height * (1 - math.hypot(bend, 0.5) * 0.8)
            statements = [
                f"duration T = {number(total)} [{clock}];",
                f"table ground(x [m], y [m]) [m] = {method} {{\n    {', '.join(number(y) for y in nodes)};\n{table}\n}}",
                "output x, y [m]: spline(order = 4, intervals = 3);",
                "initial { x == 0;  y == 0; }",
                f"final {{ hypot(x, y) <= {number(0.8 * side)} [m]; }}",
            ]
            expression, symbol, factor, sense = "final(ground(x, y))", "m", 1.0, "minimize"
        sought, worth = objective(rng, sense, "cost", expression, symbol, factor)
        if kind in ("price", "drag"):
            statements.append(grid.statement)
        text = problem(rng, "Data", "What tables say.", statements + [sought])
        yield Case(f"tables_{index}", text, float(best) * worth, tolerance, why=kind)
