"""Fastest from rest to rest against quadratic drag, falls with drag, and parachutes that are chosen.

Answer: v dv/dx = a - k v^2 on the way up and -a - k v^2 on the way down: logarithms of the speed meet at the switch, the
times are an inverse hyperbolic and an inverse trigonometric tangent. A fall from rest has v = V tanh(g t / V), the height
V^2 / g log cosh(g t / V); the drag that makes the speed at the ground what it shall be is a root.
"""

import math

from scipy.optimize import brentq

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time", "s", "ms", "min", "h")
        push, way = draw(rng, 1e-2, 1e2), draw(rng, 1e-1, 1e3)
        drag = rounded(draw(rng, 0.1, 10) / way, 3)
        grid = mesh(rng, 12, 40, least=3)
        x, v, a = f"[{length}]", f"[{length}/{clock}]", f"[{length}/{clock}^2]"
        kind = ["race", "fall", "parachute"][index % 3]
        statements = [f"state x {x}, v {v};", grid.statement]
        expression, symbol, factor = "T", clock, second
        if kind == "race":
            # log(1 - k v^2 / a) and log(1 + k v^2 / a) over 2 k share the way.
            share = brentq(lambda s: (-math.log(1 - s) + math.log(1 + s)) / (2 * drag) - way, 0, 1 - 1e-15)
            root = math.sqrt(share)
            best = (math.atanh(root) + math.atan(root)) / math.sqrt(push * drag)
            signed = rng.choice(["v^2", "v * abs(v)"])
            statements += [
                f"input a in -{number(push)} .. {number(push)} {a};",
                f"param k = {number(drag)} [1/{length}];",
                f"dynamics {{ der(x) == v;  der(v) == a - k * {signed}; }}",
                "initial { x == 0;  v == 0; }",
                f"final {{ x == {number(way)} {x};  v == 0; }}",
                f"duration T in {bounds(rng, best, clock)};",
            ]
            tolerance = 1e-3 + 10 / grid.intervals**2
        elif kind == "fall":
            top = math.sqrt(push / drag)
            best = top / push * math.acosh(math.exp(drag * way))
            statements += [
                f"param k = {number(drag)} [1/{length}];",
                f"dynamics {{ der(x) == v;  der(v) == {number(push)} {a} - k * v^2; }}",
                "initial { x == 0;  v == 0; }",
                f"final {{ x == {number(way)} {x}; }}",
                f"duration T in {bounds(rng, best, clock)};",
            ]
            tolerance = 1e-4
        else:
            shown = rounded(math.sqrt(2 * push * way) * draw(rng, 0.3, 0.9), 4)
            # v^2 = a / k (1 - exp(-2 k x)).
            best = brentq(
                lambda k: push / k * -math.expm1(-2 * k * way) - shown**2, 1e-6 / way, 1e3 / way, xtol=1e-15 / way
            )
            fallen = math.sqrt(1 / (push * best)) * math.acosh(math.exp(best * way))
            statements += [
                f"variable k in {bounds(rng, best, '1/' + length)};",
                f"dynamics {{ der(x) == v;  der(v) == {number(push)} {a} - k * v^2; }}",
                "initial { x == 0;  v == 0; }",
                f"final {{ x == {number(way)} {x};  v <= {number(shown)} {v}; }}",
                f"duration T in {bounds(rng, fallen, clock)};",
            ]
            expression, symbol, factor, tolerance = "k", f"1/{length}", 1 / metre, 1e-3
        minimize, worth = objective(rng, "minimize", "least", expression, symbol, factor)
        text = problem(rng, "Drag", "Against the drag.", statements + [minimize])
        yield Case(f"quadratic_drag_{index}", text, best * worth, tolerance, why=kind)
