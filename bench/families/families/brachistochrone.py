"""The brachistochrone: a bead slides from rest to a place below or beside in the least time.

Answer: the cycloid through both places, x = R (p - sin p), y = R (1 - cos p), in the time sqrt(R / g) p.
"""

import math

from scipy.optimize import brentq

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, problem


def slide(across, down, g):
    """The least time, and the angle of the cycloid at the end."""
    ratio = lambda p: (p - math.sin(p)) / (1 - math.cos(p)) - across / down
    end = brentq(ratio, 1e-4, 2 * math.pi - 1e-6, xtol=1e-14)
    return math.sqrt(down / (1 - math.cos(end)) / g) * end, end


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        down = sizes.draw("length", 1e-3, 1e5)
        across = sizes.write("length", down.si * 10 ** rng.uniform(-0.7, 1), down.unit, 3)
        g = sizes.write("acceleration", rng.choice((9.81, 1.62, 1.0, 274.0)), digits=3)
        T, end = slide(across.si, down.si, g.si)
        grid = mesh(rng)
        shown = sizes.unit("time", T)
        upward = rng.random() < 0.5
        speed = sizes.unit("speed", math.sqrt(2 * g.si * down.si))
        statements = [
            f"param g = {g};",
            f"duration T in {sizes.bounds('time', T)};",
            f"minimize {'time ' + str(shown) + ': ' if shown.symbol else ''}T;",
            grid.statement,
        ]
        sign = "-" if upward else ""
        form = rng.choice(("angle", "energy"))
        drop = f"{sign}{down}"
        if form == "angle":
            statements += [
                f"state x {down.unit}, y {down.unit}, v {speed};",
                f"input angle {sizes.mark('deg')};",
                f"dynamics {{ der(x) == v * sin(angle);  der(y) == {sign}v * cos(angle);  der(v) == g * cos(angle); }}",
                "initial { x == 0;  y == 0;  v == 0; }",
            ]
            line = [f"v = {sizes.write('speed', math.sqrt(2 * g.si * down.si), speed, 1)} * tau", f"angle = {0.8 if sizes.pure else '45 [deg]'}"]
        else:
            statements += [
                f"state x {down.unit}, y {down.unit}, v {speed};",
                "input cx, cy;" if sizes.pure else "input cx [1], cy [1];",
                f"dynamics {{ der(x) == v * cx;  der(y) == {sign}v * cy;  der(v) == g * cy; }}",
                "trajectory { cx^2 + cy^2 == 1; }",
                "initial { x == 0;  y == 0;  v == 0; }",
            ]
            line = ["cx = 0.7", "cy = 0.7"]
        statements.append(block("final", [f"x == {across}", f"y == {drop}"]))
        line = [f"x = {across} * tau", f"y = {drop} * tau", *line, f"T = {sizes.write('time', 1.5 * T, digits=1)}"]
        statements += guess(rng, line, [f"x = {across}", f"y = {drop}", f"T = {sizes.write('time', 20 * T, digits=1)}"])
        yield Case(
            name=f"brachistochrone_{k}",
            text=problem(rng, "Slide", "A bead slides to a place in the least time.", statements),
            optimum=T / shown.si,
            tolerance=1e-6 + (end / grid.intervals) ** (2 * grid.points - 1),
            why="cycloid",
        )
