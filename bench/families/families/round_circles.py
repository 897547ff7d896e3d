"""The shortest way past one or two round obstacles, at a limited speed.

Answer: tangents and arcs; the shortest path in the graph of all tangents that cross no obstacle.
"""

import heapq
import math

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, number, numbers, problem, rounded


def tangent_points(p, circle):
    """Where the two tangents from a point touch."""
    (x, y), (a, b, r) = p, circle
    d = math.hypot(x - a, y - b)
    toward, side = math.atan2(y - b, x - a), math.acos(r / d)
    return [(a + r * math.cos(toward + s * side), b + r * math.sin(toward + s * side)) for s in (-1, 1)]


def common_tangents(one, two):
    """The four tangents of two circles that lie apart: pairs of points."""
    (a, b, r), (c, d, s) = one, two
    apart, along = math.hypot(c - a, d - b), math.atan2(d - b, c - a)
    for sign in (1, -1):
        opening = math.acos((r - sign * s) / apart)
        for side in (-1, 1):
            angle = along + side * opening
            yield (
                (a + r * math.cos(angle), b + r * math.sin(angle)),
                (c + sign * s * math.cos(angle), d + sign * s * math.sin(angle)),
            )


def free(p, q, circles):
    """Whether a straight line crosses no circle."""
    (x, y), (u, v) = p, q
    length = math.hypot(u - x, v - y)
    for a, b, r in circles:
        along = max(0.0, min(1.0, ((a - x) * (u - x) + (b - y) * (v - y)) / length**2)) if length else 0.0
        if math.hypot(x + along * (u - x) - a, y + along * (v - y) - b) < r * (1 - 1e-9):
            return False
    return True


def shortest(begin, end, circles):
    """The length of the shortest way round circles that lie apart, and the points of it."""
    nodes, on = [begin, end], [None, None]
    edges = {}

    def link(i, j, length):
        edges.setdefault(i, []).append((j, length))
        edges.setdefault(j, []).append((i, length))

    def add(point, circle):
        nodes.append(point)
        on.append(circle)
        return len(nodes) - 1

    def straight(i, j):
        if free(nodes[i], nodes[j], circles):
            link(i, j, math.dist(nodes[i], nodes[j]))

    straight(0, 1)
    for c, circle in enumerate(circles):
        for place in (0, 1):
            for point in tangent_points(nodes[place], circle):
                straight(place, add(point, c))
        for other in range(c):
            for p, q in common_tangents(circles[other], circle):
                straight(add(p, other), add(q, c))
    for i in range(len(nodes)):
        for j in range(i):
            if on[i] is not None and on[i] == on[j]:
                a, b, r = circles[on[i]]
                turn = math.atan2(nodes[i][1] - b, nodes[i][0] - a) - math.atan2(nodes[j][1] - b, nodes[j][0] - a)
                link(i, j, r * abs(math.remainder(turn, 2 * math.pi)))
    queue, best, before = [(0.0, 0, None)], {}, {}
    while queue:
        length, i, last = heapq.heappop(queue)
        if i in best:
            continue
        best[i], before[i] = length, last
        for j, step in edges.get(i, ()):
            heapq.heappush(queue, (length + step, j, i))
    path, i = [], 1
    while i is not None:
        path.append(nodes[i])
        i = before[i]
    return best[1], path[::-1]


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        unit = sizes.unit("length", 10 ** rng.uniform(-2, 6))
        # Numbers in the unit: from (0, 0) to (10, 0), times a size.
        much = rounded(10 ** rng.uniform(-1, 1), 1)
        circles = [(rng.uniform(2.5, 7.5), rng.uniform(-1.5, 1.5), rng.uniform(0.5, 2.4))]
        if rng.random() < 0.5:
            circles = [(rng.uniform(2, 3.5), rng.uniform(-1.2, 1.2), rng.uniform(0.5, 1.7)), (rng.uniform(6.5, 8), rng.uniform(-1.2, 1.2), rng.uniform(0.5, 1.7))]
        circles = [tuple(rounded(one * much, 3) for one in circle) for circle in circles]
        far = 10 * much
        length, path = shortest((0.0, 0.0), (far, 0.0), circles)
        speed = sizes.write("speed", unit.si * much / 10 ** rng.uniform(-2, 3), digits=2)
        T = length * unit.si / speed.si
        shown = sizes.unit("time", T)
        grid = mesh(rng, 10, 80)
        here = lambda point: numbers(rounded(one, 3) for one in point)
        mark = f" {unit}".rstrip()
        keep_out = []
        for a, b, r in circles:
            apart = f"(x - {number(a)}{mark})^2 + (y - {number(b)}{mark})^2".replace("- -", "+ ")
            keep_out.append(rng.choice((f"{apart} >= ({number(r)}{mark})^2", f"hypot(x - ({number(a)}{mark}), y - ({number(b)}{mark})) >= {number(r)}{mark}")))
        form = rng.choice(("velocity", "heading", "flat"))
        statements = [
            f"param speed = {speed};",
            f"duration T in {sizes.bounds('time', T)};",
            f"minimize {'time ' + str(shown) + ': ' if shown.symbol else ''}T;",
            "initial { x == 0;  y == 0; }",
            f"final {{ x == {number(far)}{mark};  y == 0; }}",
        ]
        if form == "flat":
            statements.append(f"output x{mark}, y{mark}: spline(order = {grid.points + 1}, intervals = {grid.intervals}, smoothness = {rng.choice((1, 2))});")
            statements.append(block("trajectory", ["hypot(der(x), der(y)) <= speed", *keep_out]))
        else:
            statements += [f"state x{mark}, y{mark};", grid.statement]
            if form == "velocity":
                statements += [f"input vx {speed.unit}, vy {speed.unit};", "dynamics { der(x) == vx;  der(y) == vy; }"]
                statements.append(block("trajectory", ["vx^2 + vy^2 <= speed^2", *keep_out]))
            else:
                statements += [f"input way {sizes.mark('deg')};", "dynamics { der(x) == speed * cos(way);  der(y) == speed * sin(way); }"]
                statements.append(block("trajectory", keep_out))
        via = f"(x, y) through {', '.join(here(point) for point in path)}{mark}"
        about = f"T = {sizes.write('time', T, digits=1)}"
        statements += guess(
            rng,
            [via, about],
            [rng.choice((f"(x, y) through (0, 0), ({number(far)}, 0){mark}", "x = 0")), about],
        )
        yield Case(
            name=f"round_circles_{k}",
            text=problem(rng, "Around", "The shortest way past round obstacles.", statements),
            optimum=T / shown.si,
            tolerance=grid.switches(len(path), factor=1.0),
            why="shortest path in the graph of tangents",
        )
