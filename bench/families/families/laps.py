"""Laps of an ellipse within the grip of the tyres, on its line.

Answer: the square of the speed is at most grip / curvature and changes by 2 sqrt(grip^2 - (curvature E)^2) at most along the
line; the largest such square is the least of a march forwards and one backwards around the lap (fine steps).
"""

import math

import numpy as np

from case import Case
from meshes import mesh
from spell import draw, number, problem, rounded
from units import unit


def lap(a, b, grip):
    """The least time around the half axes a, b."""
    n = 8_000
    angle = np.arange(n) * 2 * math.pi / n
    speed = np.hypot(a * np.sin(angle), b * np.cos(angle))
    bend = a * b / speed**3
    step = speed * 2 * math.pi / n
    top = grip / bend

    def march(order):
        square = top.copy()
        now = float(top.min())
        for k in order:
            now = min(now, top[k])
            square[k] = now
            now += 2 * math.sqrt(max(0.0, grip**2 - (bend[k] * now) ** 2)) * step[k]
        return square

    begin = int(np.argmin(top))
    forwards = [(begin + k) % n for k in range(n)]
    backwards = [(begin - k) % n for k in range(n)]
    return float(np.sum(step / np.sqrt(np.minimum(march(forwards), march(backwards)))))


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length", "m", "ft", "km", "cm")
        a = draw(rng, 1, 1e3)
        b = rounded(a * draw(rng, 0.3, 1), 3)
        grip = draw(rng, 0.5, 30)
        best = lap(a * metre, b * metre, grip)
        grid = mesh(rng, 24, 60, least=3)
        typical = number(rounded(0.3 * grip * b * b / a * metre, 3))
        statements = [
            "domain phi;",
            "duration Phi = 2 * pi;",
            "state E [m^2/s^2];",
            "input f [m/s^2];",
            f"param a = {number(a)} [{length}];",
            f"param b = {number(b)} [{length}];",
            f"let along [{length}] = hypot(a * sin(phi), b * cos(phi));",
            "let bend [1/m] = a * b / along^3;",
            "dynamics { der(E) == 2 * f * along; }",
            f"trajectory {{ f^2 + (bend * E)^2 <= ({number(grip)} [m/s^2])^2;  E >= {number(float(typical) / 100)} [m^2/s^2]; }}",
            "periodic E;",
            grid.statement,
            "minimize integral(along / sqrt(E));",
            rng.choice(["", f"guess {{ E = {typical} [m^2/s^2]; }}"]),
        ]
        text = problem(rng, "Lap", "A lap of an ellipse.", statements)
        yield Case(f"laps_{index}", text, best, 3e-3 + 6 / grid.intervals**2, why=f"b / a = {b / a:.3g}")
