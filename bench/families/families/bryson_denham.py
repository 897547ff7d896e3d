"""Bryson and Denham's problem with any ceiling: a cart turns round within a time and a room, with the least energy.

Answer: with l in units of v T, the integral of u^2 / 2 in units of v^2 / T is 2 for l >= 1/4, 2 + 6 (1 - 4 l)^2 for
1/6 <= l <= 1/4, and 4 / (9 l) below (Bryson and Ho, section 3.11).
"""

import math

from case import Case
from meshes import Mesh, mesh
from sizes import Sizes
from spell import block, guess, log_uniform, problem


def energy(room):
    if room >= 1 / 4:
        return 2.0
    return 2 + 6 * (1 - 4 * room) ** 2 if room >= 1 / 6 else 4 / (9 * room)


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.4)
        v = sizes.draw("speed", 1e-3, 1e4)
        T = sizes.draw("time", 1e-2, 1e5)
        room = rng.choice((rng.uniform(0.25, 0.4), rng.uniform(0.17, 0.25), log_uniform(rng, 0.02, 0.16), log_uniform(rng, 0.02, 0.16)))
        ceiling = sizes.write("length", room * v.si * T.si, digits=4)
        room = ceiling.si / (v.si * T.si)
        grid = mesh(rng)
        # Three intervals at least on the way to the ceiling.
        grid = Mesh(max(grid.intervals, math.ceil(1 / room)), grid.points)
        form = rng.choice(("states", "flat"))
        limit = rng.choice((f"x <= {ceiling}", f"{ceiling} - x >= 0"))
        statements = [
            f"duration T = {T};",
            block("initial", ["x == 0", f"v == {v}"]),
            block("final", ["x == 0", f"v == -{v}"]),
            f"trajectory {{ {limit}; }}",
            "minimize 0.5 * integral(u^2);",
        ]
        if form == "states":
            statements += [
                f"state x {ceiling.unit}, v {v.unit};",
                f"input u {sizes.mark('m/s^2')};",
                grid.statement,
                "dynamics { der(x) == v;  der(v) == u; }",
            ]
        else:
            statements += [
                f"output x {ceiling.unit}: spline(order = {rng.choice((4, 5))}, intervals = {grid.intervals}, smoothness = {rng.choice((2, 3))});",
                f"let v {v.unit} = der(x);",
                "let u = der(v);",
            ]
        statements += guess(rng, ["x = 0", "u = 0"] if form == "states" else ["x = 0"], [f"x = -{ceiling}"])
        if room >= 1 / 4:
            tolerance = 1e-6
        else:
            # The way to the ceiling takes 3 l of the time, and ends inside an interval.
            tolerance = grid.switches(1, factor=0.2 / min(1, 3 * room) ** 2)
        yield Case(
            name=f"bryson_denham_{k}",
            text=problem(rng, "TurnRound", "A cart turns round below a ceiling with the least energy.", statements),
            optimum=energy(room) * v.si**2 / T.si,
            tolerance=tolerance,
            why=f"closed form, room {room:.4f}",
        )
