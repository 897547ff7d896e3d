"""A mass on a spring is brought to rest at its middle in the least time by a bounded force.

Answer: by construction. Every motion with full force that changes sides after half a period each, but for the first
and the last time, is optimal (Bushaw 1952; Athans and Falb, section 7.7); so one is run backward from the middle.
"""

import math

from case import Case
from meshes import mesh
from sizes import Quantity, Sizes
from spell import block, guess, problem, rounded


def backward(last, halves, first):
    """Place and velocity from which the motion starts, where force, mass and stiffness are 1."""
    x = v = 0.0
    u = 1.0
    for duration in (last, *[math.pi] * halves, first):
        c, s = math.cos(duration), math.sin(duration)
        # Back in time: a turn by the opposite angle round (u, 0).
        x, v = u + (x - u) * c - v * s, (x - u) * s + v * c
        u = -u
    return x, v


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        mass = sizes.draw("mass", 1e-3, 1e5)
        rate = 10 ** rng.uniform(-2, 3)
        stiffness = rounded(mass.si * rate**2, 3)
        rate = math.sqrt(stiffness / mass.si)
        push = sizes.draw("force", 1e-3 * stiffness, 10 * stiffness)
        halves = rng.choice((0, 0, 1, 2, 4))
        last, first = rng.uniform(0.3, math.pi), rng.uniform(0.3, math.pi)
        x, v = backward(last, halves, first)
        size = push.si / stiffness
        length, speed = sizes.unit("length", size), sizes.unit("speed", size * rate)
        # To so many digits that their rounding is not seen.
        place = Quantity(rounded(x * size / length.si, 10), length)
        moves = Quantity(rounded(v * size * rate / speed.si, 10), speed)
        T = (last + halves * math.pi + first) / rate
        grid = mesh(rng, 5 * (1 + halves), 80)
        shown = sizes.unit("time", T)
        statements = [
            f"param mass = {mass};",
            f"param stiffness = {stiffness!r} {sizes.mark('N/m')}".rstrip() + ";",
            f"input F in -{push} .. {push};",
            f"duration T in {sizes.bounds('time', T)};",
            f"minimize {'time ' + str(shown) + ': ' if shown.symbol else ''}T;",
            block("initial", [f"x == {place}", f"v == {moves}"]),
            block("final", ["x == 0", "v == 0"]),
            grid.statement,
        ]
        if rng.random() < 0.5:
            statements += [f"state x {length}, v {speed};", "dynamics { der(x) == v;  mass * der(v) == F - stiffness * x; }"]
        else:
            statements += [f"state x {length};", f"let v {speed} = der(x);", "dynamics { mass * der(x, 2) + stiffness * x == F; }"]
        statements += guess(
            rng,
            [f"x = {place} * (1 - tau)", f"T = {sizes.write('time', T, digits=1)}"],
            [f"x = {place}", f"T = {sizes.write('time', T * rng.choice((0.1, 10)), digits=1)}"],
        )
        yield Case(
            name=f"oscillator_time_{k}",
            text=problem(rng, "Spring", "A mass on a spring is brought to rest in the least time.", statements),
            optimum=T / shown.si,
            # An interval of a switch counts by its angle.
            tolerance=1e-6 + 0.4 * (1 + halves) * (T * rate / grid.intervals) ** 2,
            why=f"backward from the middle, {halves + 1} switches",
        )
