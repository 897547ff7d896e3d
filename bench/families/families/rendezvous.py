"""Vehicles that meet at a place, or at a time, of their own choice.

Answer: from rest to rest a double integrator spends 12 d^2 / T^3, so the best meeting place is the weighted mean of the
starts; with free velocities it spends 3 d^2 / T^3. Vehicles of bounded speed meet first at the centre of the least circle
around them, or on the line between two in proportion to their speeds.
"""

import itertools
import math

import numpy as np

from case import Case
from meshes import mesh
from spell import bounds, draw, number, numbers, objective, problem, rounded
from units import unit


def least_circle(points):
    """Radius of the least circle around three points."""
    best = math.inf
    for a, b in itertools.combinations(points, 2):
        centre = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        radius = math.dist(a, b) / 2
        if all(math.dist(centre, p) <= radius * (1 + 1e-12) for p in points):
            best = min(best, radius)
    if best < math.inf:
        return best
    a, b, c = math.dist(points[1], points[2]), math.dist(points[0], points[2]), math.dist(points[0], points[1])
    s = (a + b + c) / 2
    return a * b * c / (4 * math.sqrt(s * (s - a) * (s - b) * (s - c)))


def energy(rng, length, clock):
    """Double integrators, a fixed time, a free place; arrays in one clock."""
    n, size = rng.randint(2, 4), rng.choice([1, 2, 3])
    total, spread = draw(rng, 0.1, 100), draw(rng, 1e-2, 1e3)
    starts = np.array([[rounded(spread * rng.uniform(-1, 1), 3) for _ in range(size)] for _ in range(n)])
    weights = [draw(rng, 0.2, 5, 2) for _ in range(n)]
    rest = rng.random() < 0.5
    middle = np.average(starts, axis=0, weights=weights)
    best = (12 if rest else 3) / total**3 * sum(w * float((s - middle) @ (s - middle)) for w, s in zip(weights, starts))
    rows = numbers(starts) if size > 1 else numbers(s[0] for s in starts)
    shape = f"[{n}, {size}]" if size > 1 else f"[{n}]"
    declared = f"[1 .. {n}, 1 .. {size}]" if size > 1 else f"[1 .. {n}]"
    square = "norm(a[i])^2" if size > 1 else "a[i]^2"
    statements = [
        f"duration T = {number(total)} [{clock}];",
        f"param from{shape} = {rows} [{length}];",
        f"param w[{n}] = {numbers(weights)};",
        f"state r{declared} [{length}], v{declared} [{length}/{clock}];",
        f"input a{declared} [{length}/{clock}^2];",
        f"dynamics {{ for i in 1 .. {n} {{ der(r[i]) == v[i];  der(v[i]) == a[i]; }} }}",
        f"initial {{ for i in 1 .. {n} {{ r[i] == from[i];  v[i] == 0; }} }}",
        f"final {{ for i in 2 .. {n} {{ r[i] == r[1]; }} }}",
        f"final {{ for i in 1 .. {n} {{ v[i] == 0; }} }}" if rest else "",
    ]
    return statements, best, f"sum(i in 1 .. {n}, w[i] * integral({square}))"


def two(rng, length, clock):
    """Agents of two speeds on a plane: they meet after the distance over the sum of the speeds."""
    fast, slow, reach = draw(rng, 0.1, 100), draw(rng, 0.1, 100), draw(rng, 1e-2, 1e3)
    angle = rng.uniform(0, 2 * math.pi)
    place = [rounded(reach * math.cos(angle), 4), rounded(reach * math.sin(angle), 4)]
    best = math.hypot(*place) / (fast + slow)
    statements = []
    for name, start, speed in (("hare", "(0, 0)", fast), ("hound", numbers(place), slow)):
        statements.append(
            f"agent {name} {{\n"
            f"    duration in {bounds(rng, best, clock)};\n"
            f"    state r[2] [{length}];\n"
            f"    input v[2] [{length}/{clock}];\n"
            f"    collocation gauss(points = 3, intervals = {rng.randint(4, 12)});\n"
            "    dynamics { der(r) == v; }\n"
            f"    trajectory {{ norm(v) <= {number(speed)} [{length}/{clock}]; }}\n"
            f"    initial {{ r == {start} [{length}]; }}\n"
            "}"
        )
    statements.append(
        "temporal { end(hare) == end(hound);  final(hare, r[1]) == final(hound, r[1]);  final(hare, r[2]) == final(hound, r[2]); }"
    )
    return statements, best, "end(hare)"


def three(rng, length, clock):
    """Three of one speed meet at the centre of the least circle around them."""
    speed, reach = draw(rng, 0.1, 100), draw(rng, 1e-2, 1e3)
    starts = [
        (rounded(reach * rng.uniform(-1, 1), 4), rounded(reach * rng.uniform(-1, 1), 4)) for _ in range(3)
    ]
    best = least_circle(starts) / speed
    statements = [
        f"duration T in {bounds(rng, best, clock)};",
        f"param from[3, 2] = {numbers(starts)} [{length}];",
        f"state r[1 .. 3, 1 .. 2] [{length}];",
        f"input v[1 .. 3, 1 .. 2] [{length}/{clock}];",
        "dynamics { for i in 1 .. 3 { der(r[i]) == v[i]; } }",
        "initial { for i in 1 .. 3 { r[i] == from[i]; } }",
        "final { r[1] == r[2];  r[2] == r[3]; }",
        f"trajectory {{ for i in 1 .. 3 {{ norm(v[i]) <= {number(speed)} [{length}/{clock}]; }} }}",
    ]
    return statements, best, "T"


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        kind = [energy, two, three][index % 3]
        statements, best, expression = kind(rng, length, clock)
        if kind is energy:
            minimize, worth = objective(rng, "minimize", "effort", expression, f"{length}^2/{clock}^3", metre**2 / second**3)
        else:
            minimize, worth = objective(rng, "minimize", "meeting", expression, clock, second)
        if kind is not two:
            statements.append(mesh(rng, 3, 12, least=3).statement)
        text = problem(rng, "Meeting", "Vehicles meet.", statements + [minimize])
        yield Case(f"rendezvous_{index}", text, best * worth, 1e-5, why=kind.__doc__)
