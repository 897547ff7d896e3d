"""Draining and filling tanks: Torricelli's law, down to the last drop, and two tanks that share one pump.

Answer: A h' = -c sqrt(h): from h0 to h1 in 2 A (sqrt(h0) - sqrt(h1)) / c, to the ground in a finite time. One pump fills two
tanks, of which the first leaks in proportion to what is in it, in the least time if it fills that last.
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time", "min", "h", "s", "day")
        kind = ["drain", "empty", "share"][index % 3]
        grid = mesh(rng, 12, 40, least=3)
        tolerance = 1e-4
        if kind == "share":
            pump, leak = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
            first = rounded(pump / leak * draw(rng, 0.1, 0.8), 4)
            second_tank = rounded(pump / leak * draw(rng, 0.2, 3), 4)
            best = second_tank / pump - math.log(1 - first * leak / pump) / leak
            statements = [
                "state V1, V2 [L];",
                f"input q[2] in 0 .. {number(pump)} [L/{clock}];",
                f"trajectory {{ q[1] + q[2] <= {number(pump)} [L/{clock}]; }}",
                f"dynamics {{ der(V1) == q[1] - {number(leak)} [1/{clock}] * V1;  der(V2) == q[2]; }}",
                "initial { V1 == 0;  V2 == 0; }",
                f"final {{ V1 >= {number(first)} [L];  V2 >= {number(second_tank)} [L]; }}",
            ]
            tolerance = 2e-3 + 3 / grid.intervals
        else:
            area, flow, high = draw(rng, 1e-2, 1e3), draw(rng, 1e-3, 10), draw(rng, 1e-2, 1e2)
            low = 0.0 if kind == "empty" else rounded(high * draw(rng, 0.01, 0.7), 3)
            # The flow is c sqrt(h / 1 m).
            best = 2 * area / flow * (math.sqrt(high) - math.sqrt(low))
            statements = [
                rng.choice([f"state h in 0 .. {number(2 * high)} [m];", "state h [m];\ntrajectory { h >= 0; }"]),
                "input valve in 0 .. 1;",
                f"dynamics {{ {number(area)} [m^2] * der(h) == -{number(flow)} [m^3/{clock}] * valve * sqrt(h / 1 [m]); }}",
                f"initial {{ h == {number(high)} [m]; }}",
                f"final {{ h == {number(low)} [m]; }}",
            ]
            if kind == "empty":
                tolerance = 2e-2
        statements.append(f"duration T in {bounds(rng, best, clock)};")
        minimize, worth = objective(rng, "minimize", "time", "T", clock, second)
        text = problem(rng, "Tank", "Tanks are emptied or filled.", statements + [grid.statement, minimize])
        yield Case(f"tanks_{index}", text, best * worth, tolerance, why=kind)
