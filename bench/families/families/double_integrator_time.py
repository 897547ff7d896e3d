"""A cart reaches a place and stops there in the least time; push and brake are limited, in some cases speed too.

Answer: full push, cruise at the limit if it is reached, full brake (Bryson and Ho, section 3.9).
"""

import math

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, problem


def least_time(d, v0, push, brake, limit):
    """From (0, v0) to rest at d, where v0 can be braked before d; the number of switches and the highest speed too."""
    peak = math.sqrt((d + v0**2 / (2 * push)) / (1 / (2 * push) + 1 / (2 * brake)))
    if limit is None or peak <= limit:
        return (peak - v0) / push + peak / brake, 1, peak
    cruise = d - (limit**2 - v0**2) / (2 * push) - limit**2 / (2 * brake)
    return (limit - v0) / push + limit / brake + cruise / limit, 2, limit


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        d = sizes.draw("length", 1e-4, 1e7)
        push = sizes.draw("acceleration", 1e-4, 1e3)
        brake = push if rng.random() < 0.5 else sizes.write("acceleration", push.si * rng.uniform(0.2, 5))
        fast = math.sqrt(2 * brake.si * d.si)
        v0 = sizes.write("speed", rng.choice((0, 0, rng.uniform(-0.5, 0.8))) * fast, digits=3)
        limit = None
        if rng.random() < 0.5:
            limit = sizes.write("speed", max(rng.uniform(0.1, 1.2) * fast, 1.1 * v0.si))
        T, switches, top = least_time(d.si, v0.si, push.si, brake.si, limit and limit.si)
        grid = mesh(rng)
        shown = sizes.unit("time", T)
        unit = {kind: sizes.unit(kind, si) for kind, si in (("length", d.si), ("speed", fast), ("acceleration", push.si))}
        form = rng.choice(("states", "states", "second order", "flat"))
        first = ["x == 0", "v == 0" if v0.si == 0 else f"v == {v0}"]
        last = [f"x == {d}", "v == 0"]
        limits = [f"v <= {limit}"] if limit else []
        statements = [
            f"duration T in {sizes.bounds('time', T)};",
            f"minimize time {shown}: T;" if shown.symbol else "minimize T;",
            block("initial", first),
            block("final", last),
        ]
        if form == "states":
            statements += [
                f"state x {unit['length']}, v {unit['speed']};",
                f"input u in -{brake} .. {push};",
                grid.statement,
                "dynamics { der(x) == v;  der(v) == u; }",
            ]
        elif form == "second order":
            statements += [
                f"state x {unit['length']};",
                f"input u in -{brake} .. {push};",
                grid.statement,
                f"let v {unit['speed']} = der(x);",
                "dynamics { der(x, 2) == u; }",
            ]
        else:
            order = rng.choice((3, 4, 5))
            statements += [
                f"output x {unit['length']}: spline(order = {order}, intervals = {grid.intervals}, smoothness = 2);",
                f"let v {unit['speed']} = der(x);",
                f"let u {unit['acceleration']} = der(v);",
            ]
            limits.append(f"-{brake} <= u <= {push}")
        if limits:
            statements.append(block("trajectory", limits))
        statements += guess(
            rng,
            [f"x = {d} * tau", f"T = {sizes.write('time', 1.5 * T, digits=2)}"],
            ["x = 0", f"T = {sizes.write('time', T * rng.choice((0.05, 20)), digits=1)}"],
        )
        yield Case(
            name=f"double_integrator_time_{k}",
            text=problem(rng, "Cart", "A cart goes to a place and stops there, as fast as it can.", statements),
            optimum=T / shown.si,
            tolerance=grid.ramps(switches, min((top - v0.si) / push.si, top / brake.si) / T),
            why="full push, cruise, full brake",
        )
