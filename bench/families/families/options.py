"""Phases that may vanish: a detour by road or straight, a wait, a charge on the way, each taken only where it pays.

A duration does not become shorter than a millionth of its upper bound, which is in the tolerance.

Answer: by road after a leg across is worth it beyond the critical angle, else the straight way is best and the road has no
length. A vehicle that must not arrive before a gate opens waits, at no cost, or comes late anyway. A battery is charged
on the way for as long as the rest of the way needs it, which may be not at all.
"""

import math

from case import Case
from spell import draw, number, objective, problem, rounded
from units import unit


def vanishing(rng, most, clock):
    """Of a phase that may have no length."""
    return rng.choice(
        [
            f"in 0 .. {number(rounded(most * 5, 2))} [{clock}]",
            f"in 0 .. {number(rounded(most * 100, 1))} [{clock}]",
            "in 0 ..",
        ]
    )


def road(rng, length, clock):
    """Across the fields to a road and along it."""
    across, slow = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
    fast = rounded(slow * draw(rng, 1.2, 4), 3)
    sine = slow / fast
    critical = across * sine / math.sqrt(1 - sine**2)
    along = rounded(critical * draw(rng, 0.2, 4), 3)
    if along > critical:
        best = along / fast + across * math.sqrt(1 / slow**2 - 1 / fast**2)
    else:
        best = math.hypot(along, across) / slow
    place, rate = f"[{length}]", f"[{length}/{clock}]"
    statements = [
        f"output x, y {place}: spline(order = 4, intervals = {rng.randint(1, 4)}, smoothness = 1);",
        f"phase field {{\n    duration in 0 .. {number(rounded(best * 10, 2))} [{clock}];\n    trajectory {{ hypot(der(x), der(y)) <= {number(slow)} {rate}; }}\n"
        f"    final {{ y == {number(across)} {place}; }}\n}}",
        f"phase road after field {{\n    duration {vanishing(rng, best, clock)};\n"
        f"    trajectory {{ y == {number(across)} {place};  der(x) in 0 .. {number(fast)} {rate}; }}\n}}",
        "initial { x == 0;  y == 0; }",
        f"final {{ x == {number(along)} {place}; }}",
    ]
    return statements, "duration(field) + duration(road)", best


def gate(rng, length, clock):
    """To a gate that opens at a time, a wait, and on."""
    speed, first, second = draw(rng, 1e-2, 1e2), draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e3)
    opens = rounded(first / speed * draw(rng, 0.3, 3), 3)
    best = max(first / speed, opens) + second / speed
    place, rate = f"[{length}]", f"[{length}/{clock}]"
    to = number(rounded((first + second) / speed * 10, 2))
    statements = [
        f"state x {place};\ninput v in 0 .. {number(speed)} {rate};\ndynamics {{ der(x) == v; }}\ncollocation gauss(points = 3, intervals = {rng.randint(1, 5)});",
        f"phase out {{\n    duration in 0 .. {to} [{clock}];\n    final {{ x == {number(first)} {place}; }}\n}}",
        f"phase wait after out {{\n    duration {vanishing(rng, opens, clock)};\n    trajectory {{ v == 0; }}\n}}",
        f"phase on after wait {{\n    duration in 0 .. {to} [{clock}];\n    final {{ x == {number(first + second)} {place}; }}\n}}",
        "initial { x == 0; }",
        f"temporal {{ start(on) >= {number(opens)} [{clock}]; }}",
    ]
    return statements, "end(on)", best


def charge(rng, length, clock):
    """As much as the way needs is charged half way."""
    speed, way, use = draw(rng, 1e-2, 1e2), draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
    full = rounded(use * way * draw(rng, 0.6, 1.5), 3)
    power = rounded(use * speed * draw(rng, 0.5, 5), 3)
    best = way / speed + max(0.0, use * way - full) / power
    place, rate = f"[{length}]", f"[{length}/{clock}]"
    to = number(rounded(way / speed * 10, 2))
    drive = f"    dynamics {{ der(x) == {number(speed)} {rate};  der(E) == -{number(use)} [J/{length}] * {number(speed)} {rate}; }}\n"
    statements = [
        f"state x {place}, E in 0 .. {number(3 * use * way)} [J];\ncollocation gauss(points = 2, intervals = {rng.randint(1, 5)});",
        f"phase first {{\n    duration in 0 .. {to} [{clock}];\n{drive}    final {{ x == {number(way / 2)} {place}; }}\n}}",
        f"phase plug after first {{\n    duration {vanishing(rng, way / speed, clock)};\n    dynamics {{ der(x) == 0;  der(E) == {number(power)} [J/{clock}]; }}\n}}",
        f"phase last after plug {{\n    duration in 0 .. {to} [{clock}];\n{drive}    final {{ x == {number(way)} {place}; }}\n}}",
        f"initial {{ x == 0;  E == {number(full)} [J]; }}",
    ]
    return statements, "end(last)", best


def cases(rng, count):
    for index in range(count):
        length, _ = unit(rng, "length")
        clock, second = unit(rng, "time")
        kind = [road, gate, charge][index % 3]
        statements, expression, best = kind(rng, length, clock)
        minimize, worth = objective(rng, "minimize", "time", expression, clock, second)
        text = problem(rng, "Option", "Taken only where it pays.", statements + [minimize])
        yield Case(f"options_{index}", text, best * worth, 3e-4, why=kind.__doc__)
