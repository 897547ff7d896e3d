"""Least times in phases with limits on rates, whose durations nobody limits: which phase does how much is for the solver to find.

Answer: one phase with a greatest speed or acceleration, where there are two with the same; the better one, where there are
two that differ, and the other has no length; acceleration, a cruise and braking, where the cruise is of use only on a long way.
A duration does not become shorter than a millionth of its upper bound, which is in the tolerance. Of accelerations meshes have an
even number of intervals, so that they turn round at a knot.
"""

import math

from case import Case
from spell import draw, number, objective, problem, rounded
from units import unit


def durations(rng, count, best, clock):
    """Durations of phases, mostly open."""
    kinds = [
        "0 ..",
        "0 ..",
        f"0 .. {number(rounded(best * draw(rng, 3, 30), 2))} [{clock}]",
        f"0 .. {number(rounded(best * draw(rng, 30, 1e3), 2))} [{clock}]",
    ]
    return [rng.choice(kinds) for _ in range(count)]


def alike(rng, length, clock):
    """Phases that may do the same."""
    way, speed = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
    order, count = rng.randint(3, 5), rng.randint(2, 3)
    names = ["a", "b", "c"][:count]
    best = way / speed
    spans = durations(rng, count, best, clock)
    statements = [
        f"output x [{length}]: spline(order = {order}, intervals = {rng.randint(3, 25)});",
        f"trajectory {{ abs(der(x)) <= {number(speed)} [{length}/{clock}]; }}",
        "initial { x == 0; }",
        f"final {{ x == {number(way)} [{length}]; }}",
    ]
    for i, name in enumerate(names):
        after = f" after {names[i - 1]}" if i else ""
        statements.append(f"phase {name}{after} {{ duration in {spans[i]}; }}")
    return statements, f"end({names[-1]})", best


def faster(rng, length, clock):
    """Phases of which one is faster."""
    way = draw(rng, 1e-2, 1e3)
    speeds = [draw(rng, 1e-1, 10), draw(rng, 1e-1, 10)]
    best = way / max(speeds)
    spans = durations(rng, 2, best, clock)
    statements = [
        f"output x [{length}]: spline(order = 2, intervals = {rng.randint(3, 25)});",
        "initial { x == 0; }",
        f"final {{ x == {number(way)} [{length}]; }}",
    ]
    for i, name in enumerate(["a", "b"]):
        limit = f"{number(speeds[i])} [{length}/{clock}]"
        limit = f"abs(der(x)) <= {limit}" if rng.random() < 0.5 else f"der(x) in -{limit} .. {limit}"
        after = " after a" if i else ""
        statements.append(f"phase {name}{after} {{\n    duration in {spans[i]};\n    trajectory {{ {limit}; }}\n}}")
    return statements, "end(b)", best


def cruise(rng, length, clock):
    """Acceleration, a cruise and braking."""
    way, up = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
    down = rounded(up * draw(rng, 0.3, 3), 3)
    peak = math.sqrt(2 * way * up * down / (up + down))
    most = rounded(peak * draw(rng, 0.3, 3), 3)
    if peak <= most:
        best = peak / up + peak / down
    else:
        best = most / up + most / down + (way - most**2 / 2 * (1 / up + 1 / down)) / most
    spans = durations(rng, 3, best, clock)
    rate = f"[{length}/{clock}^2]"
    limits = [f"der(x, 2) in 0 .. {number(up)} {rate}", "der(x, 2) == 0", f"der(x, 2) in -{number(down)} {rate} .. 0"]
    statements = [
        f"output x [{length}]: spline(order = 3, intervals = {rng.randint(3, 25)});",
        f"trajectory {{ der(x) <= {number(most)} [{length}/{clock}]; }}",
        "initial { x == 0;  der(x) == 0; }",
        f"final {{ x == {number(way)} [{length}];  der(x) == 0; }}",
    ]
    for i, name in enumerate(["up", "cruise", "down"]):
        after = f" after {['up', 'cruise'][i - 1]}" if i else ""
        span = f"    duration in {spans[i]};\n    trajectory {{ {limits[i]}; }}\n"
        statements.append(f"phase {name}{after} {{\n{span}}}")
    return statements, "end(down)", best


def stronger(rng, length, clock):
    """Phases of which one accelerates and brakes better."""
    way = draw(rng, 1e-2, 1e3)
    pushes = [draw(rng, 1e-1, 10), draw(rng, 1e-1, 10)]
    best = 2 * math.sqrt(way / max(pushes))
    spans = durations(rng, 2, best, clock)
    statements = [
        f"output x [{length}]: spline(order = 3, intervals = {2 * rng.randint(4, 12)});",
        "initial { x == 0;  der(x) == 0; }",
        f"final {{ x == {number(way)} [{length}];  der(x) == 0; }}",
    ]
    for i, name in enumerate(["a", "b"]):
        after = " after a" if i else ""
        limit = f"abs(der(x, 2)) <= {number(pushes[i])} [{length}/{clock}^2]"
        statements.append(f"phase {name}{after} {{\n    duration in {spans[i]};\n    trajectory {{ {limit}; }}\n}}")
    return statements, "end(b)", best


def cases(rng, count):
    for index in range(count):
        length, _ = unit(rng, "length")
        clock, second = unit(rng, "time")
        kind = [alike, faster, cruise, stronger][index % 4]
        statements, expression, best = kind(rng, length, clock)
        minimize, worth = objective(rng, "minimize", "time", expression, clock, second)
        text = problem(rng, "Split", "Who does how much.", statements + [minimize])
        # Of two phases the mesh of the weaker one may hold some of the way, a local minimum.
        yield Case(f"splits_{index}", text, best * worth, 0.05 if kind is stronger else 1e-3, why=kind.__doc__)
