"""A target on a straight line is caught in the least time, by a pursuer with a limit of speed, or of acceleration.

Answer: the first time at which the target is in reach: |d + w T| = V T, or |d + (w - v0) T| = A T^2 / 2.
"""

import numpy as np

from case import Case
from meshes import mesh
from sizes import Sizes, vector
from spell import block, guess, problem
from units import DEGREE


def first_root(coefficients):
    """The least positive root of a polynomial, the highest power first."""
    roots = np.roots(coefficients)
    return min((root.real for root in roots if abs(root.imag) < 1e-9 * abs(root) and root.real > 0), default=None)


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.2)
        d = sizes.draw("length", 1e-2, 1e8)
        speed = sizes.unit("speed", d.si / 10 ** rng.uniform(0, 4))
        target = [sizes.write("speed", speed.si * rng.uniform(-3, 3), speed, 3) for _ in range(2)]
        where = rng.uniform(-180, 180)
        place = [sizes.write("length", d.si * f(where * DEGREE), d.unit, 4) for f in (np.cos, np.sin)]
        P, W = np.array([q.si for q in place]), np.array([q.si for q in target])
        grid = mesh(rng, 3, 60)
        form = rng.choice(("velocity", "heading", "acceleration"))
        statements = [
            f"param place[2] = {vector(place)};",
            f"param target[2] = {vector(target)};",
            grid.statement,
        ]
        if form == "acceleration":
            own = [sizes.write("speed", speed.si * rng.choice((0, rng.uniform(-3, 3))), speed, 3) for _ in range(2)]
            push = sizes.write("acceleration", d.si / (d.si / speed.si) ** 2 * 10 ** rng.uniform(-1, 1), digits=3)
            R = W - np.array([q.si for q in own])
            T = first_root([push.si**2 / 4, 0, -R @ R, -2 * P @ R, -P @ P])
            statements += [
                f"state r[2] {d.unit}, v[2] {speed};",
                f"input a[2] {push.unit};",
                "dynamics { der(r) == v;  der(v) == a; }",
                f"trajectory {{ norm(a) <= {push}; }}",
                f"initial {{ r == 0;  v == {vector(own)}; }}",
            ]
        else:
            own = sizes.write("speed", np.hypot(*W) * rng.uniform(1.05, 3), digits=3)
            T = first_root([W @ W - own.si**2, 2 * P @ W, P @ P])
            statements.append("initial { r == 0; }")
            if form == "heading":
                statements += [
                    f"param speed = {own};",
                    f"state r[2] {d.unit};",
                    f"input heading {sizes.mark('deg')};",
                    "dynamics { der(r) == (speed * cos(heading), speed * sin(heading)); }",
                ]
            else:
                statements += [
                    f"state r[2] {d.unit};",
                    f"input v[2] {own.unit};",
                    f"trajectory {{ {rng.choice(('norm(v) <= {}', 'v[1]^2 + v[2]^2 <= ({})^2')).format(own)}; }}",
                    "dynamics { der(r) == v; }",
                ]
        shown = sizes.unit("time", T)
        statements += [
            f"duration T in {sizes.bounds('time', T)};",
            f"minimize {'time ' + str(shown) + ': ' if shown.symbol else ''}T;",
            block("final", [rng.choice(("r == place + target * T", "r == place + target * t"))]),
        ]
        statements += guess(
            rng,
            ["r = place * tau", f"T = {sizes.write('time', 1.3 * T, digits=2)}"],
            ["r = 0", f"T = {sizes.write('time', T * rng.choice((0.03, 30)), digits=1)}"],
        )
        yield Case(
            name=f"pursuit_{k}",
            text=problem(rng, "Pursuit", "A target on a straight line is caught in the least time.", statements),
            optimum=T / shown.si,
            tolerance=1e-6,
            why="first time in reach",
        )
