"""The fastest way through layers of different speeds, one phase for each: Fermat and Snell.

Answer: sin(angle) / speed is the same in all layers; its value is the root of the total offset. Sideways winds and layers
of one speed are not drawn; a last layer may be a cruise along a road, entered at the critical angle.
"""

import math

from scipy.optimize import brentq

from case import Case
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def fastest(heights, speeds, offset):
    """The times in the layers."""

    def reached(sine):
        return sum(h * sine * v / math.sqrt(1 - (sine * v) ** 2) for h, v in zip(heights, speeds)) - offset

    top = 1 / max(speeds)
    sine = brentq(reached, 0, top * (1 - 1e-15), xtol=1e-18 * top, rtol=1e-14)
    return [h / v / math.sqrt(1 - (sine * v) ** 2) for h, v in zip(heights, speeds)]


def cases(rng, count):
    for index in range(count):
        length, _ = unit(rng, "length")
        clock, second = unit(rng, "time")
        road = index % 3 == 2
        n = 1 if road else rng.randint(2, 4)
        size, pace = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
        heights = [rounded(size * draw(rng, 0.3, 3), 3) for _ in range(n)]
        speeds = [rounded(pace * draw(rng, 0.3, 3), 3) for _ in range(n)]
        offset = rounded(sum(heights) * draw(rng, 0.3, 3), 3)
        names = [f"layer{k}" for k in range(1, n + 1)]
        if road:
            fast = rounded(speeds[0] * draw(rng, 1.3, 4), 3)
            sine = speeds[0] / fast
            least = heights[0] * sine / math.sqrt(1 - sine**2)
            offset = rounded(least * draw(rng, 1.3, 5), 4)
            times = [heights[0] / speeds[0] / math.sqrt(1 - sine**2), (offset - least) / fast]
        else:
            times = fastest(heights, speeds, offset)
        best = sum(times)
        by_angle = rng.random() < 0.5
        place = f"[{length}]"
        statements = [f"state x, y {place};", f"collocation gauss(points = 3, intervals = {rng.randint(1, 6)});"]
        if by_angle:
            statements += [
                "input angle in 0 .. 90 [deg];",
                "dynamics { der(x) == speed * sin(angle);  der(y) == speed * cos(angle); }",
            ]
            jump = "jump angle;"
        else:
            statements += [
                f"input vx, vy [{length}/{clock}];",
                "dynamics { der(x) == vx;  der(y) == vy; }",
                "trajectory { hypot(vx, vy) <= speed; }",
            ]
            jump = "jump vx, vy;"
        reached = 0.0
        for position, (name, height, speed) in enumerate(zip(names, heights, speeds)):
            reached += height
            after = f" after {names[position - 1]}" if position else ""
            statements.append(
                f"phase {name}{after} {{\n"
                f"    duration in {bounds(rng, times[position], clock)};\n"
                f"    let speed [{length}/{clock}] = {number(speed)} [{length}/{clock}];\n"
                + (f"    {jump}\n" if position else "")
                + f"    final {{ y == {number(reached)} {place}; }}\n"
                "}"
            )
        if road:
            statements.append(
                f"phase road after layer1 {{\n    duration in {bounds(rng, times[1], clock)};\n    jump {'angle' if by_angle else 'vx, vy'};\n"
                f"    let speed [{length}/{clock}] = {number(fast)} [{length}/{clock}];\n    trajectory {{ y == {number(heights[0])} {place}; }}\n}}"
            )
        statements += [
            "initial { x == 0;  y == 0; }",
            f"final {{ x == {number(offset)} {place}; }}",
            f"duration T in {bounds(rng, best, clock)};",
        ]
        minimize, worth = objective(rng, "minimize", "time", "T", clock, second)
        text = problem(rng, "Refraction", "The fastest way through layers.", statements + [minimize])
        yield Case(f"refraction_{index}", text, best * worth, 1e-5, why="critical angle" if road else f"{n} layers")
