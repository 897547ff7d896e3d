"""Vehicles take up a formation whose place, and perhaps heading, is free, with the least effort.

Answer: single integrators spend d^2 / T; the best place is the mean of what is left, the best heading that of Procrustes
in the plane: sum |p|^2 + sum |o|^2 - 2 |sum conj(o) p| with means taken away.
"""

import cmath
import math

from case import Case
from spell import draw, number, numbers, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        n = rng.randint(3, 6)
        reach, total = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
        radius = draw(rng, 0.1, 3) * reach
        offsets = [cmath.rect(radius, 2 * math.pi * k / n) for k in range(n)]
        starts = [complex(*(rounded(reach * rng.gauss(0, 1), 3) for _ in "xy")) for _ in range(n)]
        offsets = [complex(rounded(o.real, 6), rounded(o.imag, 6)) for o in offsets]
        middle, centre = sum(starts) / n, sum(offsets) / n
        p, o = [s - middle for s in starts], [f - centre for f in offsets]
        turned = index % 2 == 1
        overlap = sum(a.conjugate() * b for a, b in zip(o, p))
        gain = abs(overlap) if turned else overlap.real
        smooth = rng.random() < 0.4
        best = (12 / total**3 if smooth else 1 / total) * (sum(abs(a) ** 2 for a in p + o) - 2 * gain)
        power = 3 if smooth else 1
        minimize, worth = objective(
            rng,
            "minimize",
            "effort",
            f"sum(i in 1 .. {n}, integral({'der(x[i], 2)^2 + der(y[i], 2)^2' if smooth else 'der(x[i])^2 + der(y[i])^2'}))",
            f"{length}^2/{clock}^{power}",
            metre**2 / second**power,
        )
        rest = "  der(x[i]) == 0;  der(y[i]) == 0;" if smooth else ""
        goal_x = "cx + ox[i] * cos(heading) - oy[i] * sin(heading)" if turned else "cx + ox[i]"
        goal_y = "cy + ox[i] * sin(heading) + oy[i] * cos(heading)" if turned else "cy + oy[i]"
        intervals = rng.randint(2, 8)
        text = problem(
            rng,
            "Formation",
            "Vehicles take up a formation.",
            [
                f"duration T = {number(total)} [{clock}];",
                f"output x[1 .. {n}], y[1 .. {n}] [{length}]: spline(order = {rng.randint(4, 6)}, intervals = {intervals});",
                f"param fx[{n}] = {numbers(s.real for s in starts)} [{length}];",
                f"param fy[{n}] = {numbers(s.imag for s in starts)} [{length}];",
                f"param ox[{n}] = {numbers(s.real for s in offsets)} [{length}];",
                f"param oy[{n}] = {numbers(s.imag for s in offsets)} [{length}];",
                f"variable cx, cy [{length}];",
                rng.choice(["variable heading;", "variable heading in -180 .. 180 [deg];"]) if turned else "",
                minimize,
                f"initial {{ for i in 1 .. {n} {{ x[i] == fx[i];  y[i] == fy[i];{rest} }} }}",
                f"final {{ for i in 1 .. {n} {{ x[i] == {goal_x};  y[i] == {goal_y};{rest} }} }}",
            ],
        )
        yield Case(f"formation_{index}", text, best * worth, 1e-6, why="Procrustes" if turned else "mean")
