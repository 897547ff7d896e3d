"""Dido's problem: the largest area that a rope of a given length encloses, with a straight coast or alone.

Answer: an arc of a circle, R^2 (p - sin p) / 2 with the angle p = L / R and the chord 2 R sin(p / 2); or L^2 / (4 pi).
"""

import math

from scipy.optimize import brentq

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import guess, problem


def segment(chord, length):
    """The area between an arc and its chord, and the angle of the arc."""
    half = brentq(lambda h: math.sin(h) / h - chord / length, 1e-6, math.pi)
    radius = length / (2 * half)
    return radius**2 * (2 * half - math.sin(2 * half)) / 2, 2 * half


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        chord = sizes.draw("length", 1e-2, 1e5)
        form = rng.choice(("graph", "arc", "closed"))
        grid = mesh(rng, 6, 60)
        order = rng.choice((4, 5, 6))
        if form == "graph":
            length = sizes.write("length", chord.si * rng.uniform(1.05, 1.4), chord.unit, 4)
        else:
            length = sizes.write("length", chord.si * rng.uniform(1.1, 5), chord.unit, 4)
        area, angle = segment(chord.si, length.si)
        if form == "closed":
            area, angle = length.si**2 / (4 * math.pi), 2 * math.pi
        shown = sizes.unit("area", area)
        goal = f"maximize {'area ' + str(shown) + ': ' if shown.symbol else ''}"
        unit = chord.unit
        start = sizes.write("length", length.si / 6, unit, 1)
        if form == "graph":
            statements = [
                f"domain x {unit};",
                f"duration D = {chord};",
                f"output y {unit}: spline(order = {order}, intervals = {grid.intervals});",
                f"{goal}integral(y);",
                "initial { y == 0; }",
                "final { y == 0; }",
                f"temporal {{ rope: integral(sqrt(1 + der(y)^2)) {rng.choice(('==', '<='))} {length}; }}",
            ]
            line = [f"y = 4 * {start} * tau * (1 - tau)"]
            poor = ["y = 0"]
            # Where the arc stands steep at the coast, splines follow it badly.
            tolerance = 1e-6 + (1 / (2 - angle / math.pi * 2 + 0.2) / grid.intervals) ** order
        else:
            statements = [
                f"domain s {unit};",
                f"duration L = {length};",
                f"output x {unit}, y {unit}: spline(order = {order}, intervals = {grid.intervals});",
                f"{goal}0.5 * integral(y * der(x) - x * der(y));",
                "initial { x == 0;  y == 0; }",
                "trajectory { der(x)^2 + der(y)^2 <= 1; }",
            ]
            if form == "closed":
                statements.append(rng.choice(("periodic x, y;", "final { x == 0;  y == 0; }")))
                line = [f"x = {start} * (1 - cos(2 * pi * tau))", f"y = {start} * sin(2 * pi * tau)"]
            else:
                statements.append(f"final {{ x == {chord};  y == 0; }}")
                line = [f"x = {chord} * tau", f"y = 4 * {start} * tau * (1 - tau)"]
            poor = [f"x = {start} * tau", f"y = {start} * sin(pi * tau)"]
            # A speed of at most 1 at all points is a chord's error of the turn within an interval.
            tolerance = 1e-6 + (angle / grid.intervals / 2) ** (order - 1)
        statements += guess(rng, line, poor)
        yield Case(
            name=f"dido_{k}",
            text=problem(rng, "Dido", "The largest area that a rope encloses.", statements),
            optimum=area / shown.si,
            tolerance=tolerance,
            why="arc of a circle",
        )
