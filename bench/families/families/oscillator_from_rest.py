"""A harmonic oscillator brought to rest in the least time by a bounded force.

Answer: Athans and Falb (1966), section 7: the force is bang-bang, its sign changes every half turn. The last arc is a
part of a half circle through the origin; going back from there over whole half turns to rest at the start is one
equation for its angle.
"""

import math

from scipy.optimize import brentq

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem
from units import unit


def backward(last, turns):
    """Where the motion was at rest before an arc to the origin and whole half turns, and the angle in all."""
    x, v = 1 - math.cos(last), -math.sin(last)
    centre = 1.0
    for _ in range(turns):
        centre = -centre
        x, v = 2 * centre - x, -v
    centre = -centre
    angle = math.atan2(-v, x - centre)
    radius = math.hypot(x - centre, v)
    start = centre + radius if angle >= 0 else centre - radius
    return abs(start), last + turns * math.pi + angle % math.pi


def least_angle(start):
    """The least time in radians from rest at `start`, in units of what the force holds."""
    if abs(start / 2 - round(start / 2)) < 1e-12:
        return math.pi * round(start / 2)
    turns = int(start / 2)
    last = brentq(lambda angle: backward(angle, turns)[0] - start, 1e-9, math.pi - 1e-9, xtol=1e-14)
    return backward(last, turns)[1]


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time")
        rate, push = draw(rng, 0.01, 100), draw(rng, 1e-3, 1e3)
        start = rng.choice([2.0, 4.0, draw(rng, 0.2, 5)])
        best = least_angle(start) / rate
        grid = mesh(rng, 12, 60, least=3)
        minimize, worth = objective(rng, "minimize", "time", "T", clock, second)
        place = number(start * push / rate**2)
        if rng.random() < 0.5:
            motion = [
                f"state x [m], v [m/{clock}];",
                f"input u in -{number(push)} .. {number(push)} [m/{clock}^2];",
                "dynamics { der(x) == v;  der(v) == -rate^2 * x + u; }",
                f"initial {{ x == {place} [m];  v == 0; }}",
                "final { x == 0;  v == 0; }",
            ]
        else:
            motion = [
                f"output x [m]: spline(order = 5, intervals = {grid.intervals}, smoothness = 2);",
                f"let u [m/{clock}^2] = der(x, 2) + rate^2 * x;",
                f"trajectory {{ -push <= u <= push; }}\nparam push = {number(push)} [m/{clock}^2];",
                f"initial {{ x == {place} [m];  der(x) == 0; }}",
                "final { x == 0;  der(x) == 0; }",
            ]
        guess = rng.choice(
            ["", f"guess {{ x = {place} [m] * (1 - tau); }}", f"guess {{ T = {number(3 * best)} [{clock}]; }}"]
        )
        text = problem(
            rng,
            "Swing",
            "A mass on a spring is brought to rest as soon as its drive can.",
            [
                f"duration T in {bounds(rng, best, clock)};",
                f"param rate = {number(rate)} [1/{clock}];",
                grid.statement,
                minimize,
                guess,
            ]
            + motion,
        )
        # On the ends of the half circles the least time has a root: what a mesh misses there falls with its step alone.
        tolerance = 1e-3 + (0.7 / grid.intervals if start in (2.0, 4.0) else 10 / grid.intervals**2)
        yield Case(f"oscillator_from_rest_{index}", text, best * worth, tolerance, why=f"start {start}")
