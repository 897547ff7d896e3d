"""Dubins' car: the shortest way between two places with headings, turning no tighter than a radius.

Answer: the shortest of the six words LSL, RSR, LSR, RSL, RLR, LRL (Dubins 1957; Shkel and Lumelsky 2001). The final
heading is given as the turns of that word add up, or but for whole turns.
"""

import math

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, number, problem
from units import DEGREE

FULL = 2 * math.pi


def words(d, a, b):
    """The words from (0, 0, a) to (d, 0, b) at radius 1: pairs of the lengths of three parts and the turns of the arcs."""
    sa, sb, ca, cb, cab = math.sin(a), math.sin(b), math.cos(a), math.cos(b), math.cos(a - b)
    turn = lambda angle: angle % FULL
    square = 2 + d * d - 2 * cab + 2 * d * (sa - sb)
    if square >= 0:
        way = math.atan2(cb - ca, d + sa - sb)
        yield (turn(way - a), math.sqrt(square), turn(b - way)), (1, 0, 1)
    square = 2 + d * d - 2 * cab + 2 * d * (sb - sa)
    if square >= 0:
        way = math.atan2(ca - cb, d - sa + sb)
        yield (turn(a - way), math.sqrt(square), turn(way - b)), (-1, 0, -1)
    square = d * d - 2 + 2 * cab + 2 * d * (sa + sb)
    if square >= 0:
        p = math.sqrt(square)
        way = math.atan2(-ca - cb, d + sa + sb) - math.atan2(-2, p)
        yield (turn(way - a), p, turn(way - b)), (1, 0, -1)
    square = d * d - 2 + 2 * cab - 2 * d * (sa + sb)
    if square >= 0:
        p = math.sqrt(square)
        way = math.atan2(ca + cb, d - sa - sb) - math.atan2(2, p)
        yield (turn(a - way), p, turn(b - way)), (-1, 0, 1)
    cosine = (6 - d * d + 2 * cab + 2 * d * (sa - sb)) / 8
    if abs(cosine) <= 1:
        p = turn(FULL - math.acos(cosine))
        first = turn(a - math.atan2(ca - cb, d - sa + sb) + p / 2)
        yield (first, p, turn(a - b - first + p)), (-1, 1, -1)
    cosine = (6 - d * d + 2 * cab + 2 * d * (sb - sa)) / 8
    if abs(cosine) <= 1:
        p = turn(FULL - math.acos(cosine))
        first = turn(-a + math.atan2(cb - ca, d + sa - sb) + p / 2)
        yield (first, p, turn(b - a - first + p)), (1, -1, 1)


def arrival(a, lengths, turns):
    """Where a word ends that begins at (0, 0, a)."""
    x = y = 0.0
    for length, side in zip(lengths, turns):
        if side:
            x += side * (math.sin(a + side * length) - math.sin(a))
            y += side * (math.cos(a) - math.cos(a + side * length))
            a += side * length
        else:
            x, y = x + length * math.cos(a), y + length * math.sin(a)
    return x, y, a


def shortest(d, a, b):
    """The shortest word: its length, and how far the heading turns in all."""
    best = None
    for lengths, turns in words(d, a, b):
        x, y, end = arrival(a, lengths, turns)
        if math.hypot(x - d, y) + abs(math.sin((end - b) / 2)) < 1e-8 and (best is None or sum(lengths) < best[0]):
            best = sum(lengths), end - a
    return best


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        radius = sizes.draw("length", 1e-2, 1e5)
        speed = sizes.write("speed", radius.si / 10 ** rng.uniform(-1, 2), digits=2)
        far, where = radius.si * 10 ** rng.uniform(0, 1.3), rng.uniform(-math.pi, math.pi)
        x = sizes.write("length", far * math.cos(where), radius.unit, 4)
        y = sizes.write("length", far * math.sin(where), radius.unit, 4)
        angle = lambda degrees: number(degrees * DEGREE) if sizes.pure else f"{number(degrees)} [deg]"
        begin = float(rng.choice((0, round(rng.uniform(-180, 180)))))
        end = float(round(rng.uniform(-180, 180)))
        d, where = math.hypot(x.si, y.si) / radius.si, math.atan2(y.si, x.si)
        length, turned = shortest(d, begin * DEGREE - where, end * DEGREE - where)
        T = length * radius.si / speed.si
        grid = mesh(rng)
        total = round(begin + turned / DEGREE)
        heading = rng.choice((f"psi == {angle(float(total))}", f"cos(psi - {angle(end)}) == 1"))
        shown = sizes.unit("time", T)
        statements = [
            f"param speed = {speed};",
            f"param radius = {radius};",
            f"state x {radius.unit}, y {radius.unit}, psi {sizes.mark('deg')};",
            grid.statement,
            f"initial {{ x == 0;  y == 0;  psi == {angle(begin)}; }}",
            block("final", [f"x == {x}", f"y == {y}", heading]),
            f"duration T in {sizes.bounds('time', T)};",
            f"minimize {'time ' + str(shown) + ': ' if shown.symbol else ''}T;",
        ]
        if rng.random() < 0.5:
            statements += [
                "input bend in -1 .. 1;",
                "dynamics { der(x) == speed * cos(psi);  der(y) == speed * sin(psi);  der(psi) == speed / radius * bend; }",
            ]
        else:
            statements += [
                f"input turn {sizes.mark('deg/s')};",
                "dynamics { der(x) == speed * cos(psi);  der(y) == speed * sin(psi);  der(psi) == turn; }",
                "trajectory { -speed <= radius * turn <= speed; }",
            ]
        statements += guess(
            rng,
            [f"x = {x} * tau", f"y = {y} * tau", f"psi = {angle(begin)} + {angle(float(total - begin))} * tau", f"T = {sizes.write('time', T, digits=1)}"],
            [f"x = {x} * tau", f"y = {y} * tau", f"T = {sizes.write('time', 10 * T, digits=1)}"],
        )
        yield Case(
            name=f"dubins_{k}",
            text=problem(rng, "Dubins", "A car goes to a place with a heading on the shortest way.", statements),
            optimum=T / shown.si,
            # A switch within an interval moves the way sideways by up to that share of a turn.
            tolerance=grid.switches(2, factor=0.5 * max(1, length / 4)),
            why="shortest of the six words",
        )
