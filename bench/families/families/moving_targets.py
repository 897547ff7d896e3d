"""Targets that move are met one after another in the least time at a bounded speed.

Answer: the meeting time with a target that moves evenly is the root of a quadratic equation; in a given order it is best to
meet each as soon as it can be met, since a faster vehicle could go on with it.
"""

import math

from case import Case
from spell import bounds, draw, number, numbers, objective, problem, rounded
from units import unit


def meet(here, now, start, drift, speed):
    """How long it takes to meet a target."""
    gap = [s + d * now - h for s, d, h in zip(start, drift, here)]
    a = sum(d * d for d in drift) - speed**2
    b = 2 * sum(g * d for g, d in zip(gap, drift))
    c = sum(g * g for g in gap)
    return (-b - math.sqrt(b * b - 4 * a * c)) / (2 * a)


def cases(rng, count):
    for index in range(count):
        length, _ = unit(rng, "length")
        clock, second = unit(rng, "time")
        n, size = rng.randint(1, 4), rng.choice([2, 2, 3])
        reach, speed = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
        starts = [[rounded(reach * rng.uniform(-1, 1), 3) for _ in range(size)] for _ in range(n)]
        drifts = [[rounded(speed * rng.uniform(-0.5, 0.5), 3) for _ in range(size)] for _ in range(n)]
        here, now, legs = [0.0] * size, 0.0, []
        for start, drift in zip(starts, drifts):
            legs.append(meet(here, now, start, drift, speed))
            now += legs[-1]
            here = [s + d * now for s, d in zip(start, drift)]
        place, rate = f"[{length}]", f"[{length}/{clock}]"
        statements = [
            f"state r[{size}] {place};",
            f"input v[{size}] {rate};",
            f"collocation gauss(points = 3, intervals = {rng.randint(1, 6)});",
            "dynamics { der(r) == v; }",
            f"trajectory {{ norm(v) <= {number(speed)} {rate}; }}",
            "initial { r == 0; }",
        ]
        if n == 1:
            statements += [
                f"duration T in {bounds(rng, now, clock)};",
                f"final {{ r == {numbers(starts[0])} {place} + T * {numbers(drifts[0])} {rate}; }}",
            ]
        else:
            low, high = min(legs), max(legs)
            limits = rng.choice(
                [
                    f"in 0 .. {number(rounded(5 * high, 2))} [{clock}]",
                    f"in {number(rounded(low / 3, 2))} .. {number(rounded(3 * high, 2))} [{clock}]",
                    "in 0 ..",
                ]
            )
            statements += [
                f"param from[{n}, {size}] = {numbers(starts)} {place};",
                f"param drift[{n}, {size}] = {numbers(drifts)} {rate};",
                f"phase leg[i in 1 .. {n}] {{\n    duration {limits};\n    final {{ r == from[i] + end(leg[i]) * drift[i]; }}\n}}",
                f"duration T in {bounds(rng, now, clock)};",
            ]
        minimize, worth = objective(rng, "minimize", "time", "T", clock, second)
        text = problem(rng, "Chase", "Targets are met one after another.", statements + [minimize])
        yield Case(f"moving_targets_{index}", text, now * worth, 1e-5, why=f"{n} targets")
