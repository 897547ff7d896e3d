"""The fastest run along a way with speed limits by place, and along a circle within a friction ellipse.

Answer: the square of the speed is piecewise linear in the place: what the limits, accelerating from each lower one and
braking for it leave is an envelope; the time is its quadrature. On a circle of radius r with a grip a, v^2 = a r sin(2 s / r
+ c) until the limit sqrt(a r).
"""

import math

import numpy as np

from case import Case
from meshes import mesh
from spell import draw, number, problem, rounded
from units import unit


def envelope(lines, push, brake, s):
    """The largest square of the speed under limits (from, to, square)."""
    return np.min(
        [e + 2 * push * np.maximum(s - b, 0) + 2 * brake * np.maximum(a - s, 0) for a, b, e in lines], axis=0
    )


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length", "m", "km", "ft")
        circle = index % 2 == 1
        grid = mesh(rng, 12, 50, least=3)
        push = draw(rng, 0.1, 10)
        if circle:
            radius = draw(rng, 1, 1e3)
            grip, first = push, draw(rng, 0.1, 0.9)
            start = math.sqrt(first * grip * radius * metre)
            start = rounded(start, 4)
            first = start**2 / (grip * radius * metre)
            angle = draw(rng, 0.5, 2 * math.pi)
            n = 400_000
            x = (np.arange(n) + 0.5) * (angle / n)
            share = np.where(2 * x + math.asin(first) < math.pi / 2, np.sin(2 * x + math.asin(first)), 1)
            best = float(np.sum(1 / np.sqrt(share)) * angle / n) * math.sqrt(radius * metre / grip)
            if rng.random() < 0.5:
                statements = [
                    f"domain s [{length}];",
                    f"duration S = {number(angle * radius)} [{length}];",
                    "state E [m^2/s^2];",
                    "input a [m/s^2];",
                    "dynamics { der(E) == 2 * a; }",
                    f"trajectory {{ grip: hypot(a, E / radius) <= {number(grip)} [m/s^2]; }}",
                    f"initial {{ E == {number(start**2)} [m^2/s^2]; }}",
                    f"guess {{ E = {number(start**2)} [m^2/s^2]; }}",
                ]
                expression = "integral(1 / sqrt(E))"
            else:
                statements = [
                    f"duration T in {number(best / 10)} .. {number(best * 10)} [s];",
                    "state phi [1], w [rad/s];",
                    "input a [1/s^2];",
                    "dynamics { der(phi) == w;  der(w) == a; }",
                    f"trajectory {{ grip: hypot(radius * a, radius * w^2) <= {number(grip)} [m/s^2]; }}",
                    f"initial {{ phi == 0;  w == {number(start / (radius * metre))} [rad/s]; }}",
                    f"final {{ phi == {number(angle)}; }}",
                ]
                expression = "T"
            statements.append(f"param radius = {number(radius)} [{length}];")
        else:
            brake = draw(rng, 0.1, 10)
            pieces, place = [], 0.0
            top = draw(rng, 3, 60)
            step = top**2 / push / metre
            speeds = [rounded(top * draw(rng, 0.3, 1), 3) for _ in range(rng.randint(2, 4))]
            ends = []
            for speed in speeds:
                ends.append(rounded(place + step * draw(rng, 0.3, 3), 4))
                pieces.append((place * metre, ends[-1] * metre, speed))
                place = ends[-1]
            start, end = (rounded(min(speeds[k], top) * draw(rng, 0.3, 0.9), 3) for k in (0, -1))
            lines = [(0.0, 0.0, start**2), (place * metre, place * metre, end**2)] + [
                (a, b, v * v) for a, b, v in pieces
            ]
            # The run is possible where what it begins and ends with is below what the limits leave.
            while np.any(
                envelope(lines, push, brake, np.array([0, place * metre])) < 0.999 * np.array([start**2, end**2])
            ):
                push, brake = rounded(1.5 * push, 3), rounded(1.5 * brake, 3)
            # The envelope has corners: a fine midpoint rule is exact to 1e-8.
            n = 500_000
            s = (np.arange(n) + 0.5) * (place * metre / n)
            best = float(np.sum(1 / np.sqrt(envelope(lines, push, brake, s)))) * place * metre / n
            by_square = rng.random() < 0.5
            shown = "sqrt(E)" if by_square else "v"
            statements = [
                f"domain s [{length}];",
                f"duration S = {number(place)} [{length}];",
                "state E in 0.01 .. 1e5 [m^2/s^2];" if by_square else "state v in 0.1 .. 300 [m/s];",
                f"input a in -{number(brake)} .. {number(push)} [m/s^2];",
                "dynamics { der(E) == 2 * a; }" if by_square else "dynamics { der(v) == a / v; }",
                f"initial {{ {shown} == {number(start)} [m/s]; }}",
                f"final {{ {shown} == {number(end)} [m/s]; }}",
            ]
            before = 0.0
            for speed, after in zip(speeds, ends):
                statements.append(
                    f"trajectory from {number(before)} [{length}] to {number(after)} [{length}] {{ {shown} <= {number(speed)} [m/s]; }}"
                )
                before = after
            expression = f"integral(1 / {shown})"
        minute = rng.random() < 0.3
        sought = f"minimize time [min]: {expression};" if minute else f"minimize {expression};"
        text = problem(rng, "Run", "The fastest run.", statements + [grid.statement, sought])
        yield Case(
            f"speed_limits_{index}",
            text,
            best / 60 if minute else best,
            3e-3 + 6 / grid.intervals**2,
            why="circle" if circle else "limits",
        )
