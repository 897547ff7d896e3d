"""A ball is thrown as far as it goes, without air, from a height, or up or down a slope.

Answer: range v / g sqrt(v^2 + 2 g h) from a height h; v^2 / (g (1 + sin b)) along a slope of angle b. Parabolas are
splines, so every mesh is exact.
"""

import math

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, problem
from units import DEGREE


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.2)
        v = sizes.draw("speed", 0.1, 5e3)
        g = sizes.write("acceleration", rng.choice((9.81, 1.62, 3.71)), digits=3)
        reach = v.si**2 / g.si
        sloped = rng.random() < 0.5
        if sloped:
            slope = round(rng.uniform(-60, 60))
            far = reach / (1 + math.sin(slope * DEGREE)) * math.cos(slope * DEGREE)
            lands = f"y == x * tan({slope}{'' if sizes.pure else ' [deg]'})"
            if sizes.pure:
                lands = f"y == x * tan({slope} / 180 * pi)"
            height = None
            T = far / (v.si * math.cos((45 + slope / 2) * DEGREE))
        else:
            height = sizes.write("length", reach * rng.choice((0.0, rng.uniform(-0.4, 2))), digits=3)
            far = v.si / g.si * math.sqrt(v.si**2 + 2 * g.si * height.si)
            lands = "y == 0"
            T = far / v.si * 1.4
        start = "y == 0" if height is None else f"y == {height}"
        shown = sizes.unit("length", far)
        grid = mesh(rng, 1, 20)
        form = rng.choice(("speeds", "second order", "flat"))
        how = rng.choice(("hypot(vx, vy) == {}", "hypot(vx, vy) <= {}", "vx^2 + vy^2 <= ({})^2")).format(v)
        statements = [
            f"duration T in {sizes.bounds('time', T)};",
            f"param g = {g};",
            f"maximize {'range ' + str(shown) + ': ' if shown.symbol else ''}final(x);",
            block("initial", ["x == 0", start, how]),
            block("final", [lands]),
        ]
        speed = sizes.unit("speed", v.si)
        across = sizes.unit("length", far)
        if form == "speeds":
            statements += [
                f"state x {across}, y {across}, vx {speed}, vy {speed};",
                "dynamics { der(x) == vx;  der(y) == vy;  der(vx) == 0;  der(vy) == -g; }",
                grid.statement,
            ]
        else:
            names = f"let vx {speed} = der(x);", f"let vy {speed} = der(y);"
            equations = "{ der(x, 2) == 0;  der(y, 2) == -g; }"
            if form == "flat":
                order = rng.choice((3, 4))
                statements += [
                    *names,
                    f"output x {across}, y {across}: spline(order = {order}, intervals = 1);",
                    f"trajectory {equations}",
                    f"collocation gauss(points = 3, equalities = {order - 2});",
                ]
            else:
                statements += [*names, f"state x {across}, y {across};", f"dynamics {equations}", grid.statement]
        distance = sizes.write("length", far, digits=1)
        statements += guess(
            rng,
            [f"x = {distance} * tau", f"T = {sizes.write('time', T, digits=1)}"],
            [f"x = {distance} * tau", f"y = -{distance}", f"T = {sizes.write('time', 0.1 * T, digits=1)}"],
        )
        yield Case(
            name=f"cannonball_{k}",
            text=problem(rng, "Throw", "A ball is thrown as far as it goes, without air.", statements),
            optimum=far / shown.si,
            tolerance=1e-6,
            why="parabola of safety",
        )
