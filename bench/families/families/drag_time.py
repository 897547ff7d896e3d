"""A mass with viscous friction goes from rest to rest in the least time; push and brake are limited.

Answer: one switch, whose time is the root of an equation (velocity decays with exp(-c t / m)).
"""

import math

from scipy.optimize import brentq

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, problem, rounded


def least_time(d, push, brake, c):
    """Accelerations `push`, `brake` and the friction's rate c: v' = push - c v, then v' = -brake - c v."""

    def braking(first):
        peak = push / c * -math.expm1(-c * first)
        return math.log1p(peak * c / brake) / c

    far = lambda first: (push * first - brake * braking(first)) / c - d
    top = math.sqrt(2 * d / push)
    while far(top) < 0:
        top *= 2
    first = brentq(far, 0, top, xtol=1e-15 * top, rtol=1e-14)
    return first + braking(first)


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.2)
        mass = sizes.draw("mass", 1e-3, 1e5)
        d = sizes.draw("length", 1e-3, 1e5)
        push = sizes.write("force", mass.si * 10 ** rng.uniform(-2, 2), digits=3)
        brake = sizes.write("force", push.si * rng.uniform(0.3, 3), digits=3)
        # How many times friction's time constant goes into the way without friction.
        much = 10 ** rng.uniform(-2, 1)
        c = rounded(much * mass.si / math.sqrt(2 * d.si * mass.si / push.si), 3)
        T = least_time(d.si, push.si / mass.si, brake.si / mass.si, c / mass.si)
        grid = mesh(rng)
        shown = sizes.unit("time", T)
        speed = d.si / T
        friction = f"{c!r} {sizes.mark('kg/s')}".rstrip()
        statements = [
            f"param mass = {mass};",
            f"param friction = {friction};",
            f"duration T in {sizes.bounds('time', T)};",
            f"state x {sizes.unit('length', d.si)}, v {sizes.unit('speed', speed)};",
            f"input F in -{brake} .. {push};",
            grid.statement,
            block("dynamics", ["der(x) == v", rng.choice(("mass * der(v) == F - friction * v", "der(v) == (F - friction * v) / mass"))]),
            f"minimize time {shown}: T;" if shown.symbol else "minimize T;",
            block("initial", ["x == 0", "v == 0"]),
            block("final", [f"x == {d}", "v == 0"]),
        ]
        statements += guess(
            rng,
            [f"x = {d} * tau", f"v = {sizes.write('speed', speed, digits=2)}", f"T = {sizes.write('time', T, digits=1)}"],
            [f"x = {d}", "v = 0", f"T = {sizes.write('time', 30 * T, digits=1)}"],
        )
        yield Case(
            name=f"drag_time_{k}",
            text=problem(rng, "Sledge", "A sledge in oil goes from rest to rest, as fast as it can.", statements),
            optimum=T / shown.si,
            # Where friction is quick, an interval of the switch costs the more.
            tolerance=grid.switches(1, factor=max(1, c / mass.si * T / 4)),
            why="root of the switching equation",
        )
