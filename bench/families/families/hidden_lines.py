"""Motions that are straight lines in other coordinates: nonlinear equations with the optimum of an integrator.

Answer: with y = f(x) and f'(x) x' = u the least energy is (f(b) - f(a))^2 / T, the least time |f(b) - f(a)| / U. The same
motion in polar coordinates, in a turning frame or on a moving ground is a straight line seen from elsewhere.
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem, rounded
from units import unit

# The rate of x for an input, f, and what is drawn for the two ends.
MAPS = [
    ("x * u", math.log, lambda rng: (draw(rng, 1e-4, 1e4), draw(rng, 1e-4, 1e4))),
    ("x^2 * u", lambda x: -1 / x, lambda rng: (draw(rng, 0.05, 5), draw(rng, 0.05, 5))),
    ("exp(x) * u", lambda x: -math.exp(-x), lambda rng: (rng.uniform(-3, 3), rng.uniform(-3, 3))),
    ("cos(x)^2 * u", math.tan, lambda rng: (rng.uniform(-1.45, 1.45), rng.uniform(-1.45, 1.45))),
    ("(1 + x^2) * u", math.atan, lambda rng: (rng.uniform(-10, 10), rng.uniform(-10, 10))),
    ("sqrt(1 + x^2) * u", math.asinh, lambda rng: (rng.uniform(-100, 100), rng.uniform(-100, 100))),
    ("u / (1 + 3 * x^2)", lambda x: x + x**3, lambda rng: (rng.uniform(-3, 3), rng.uniform(-3, 3))),
    (
        "x * (1 - x) * u",
        lambda x: math.log(x / (1 - x)),
        lambda rng: (rng.uniform(0.01, 0.99), rng.uniform(0.01, 0.99)),
    ),
]


def mapped(rng, clock, second):
    """One nonlinear equation."""
    rate, f, ends = rng.choice(MAPS)
    a, b = (rounded(x, 4) for x in ends(rng))
    way = f(b) - f(a)
    statements = [
        "state x;",
        f"dynamics {{ der(x) == {rate}; }}",
        f"initial {{ x == {number(a)}; }}",
        f"final {{ x == {number(b)}; }}",
    ]
    poor = [
        f"x = {number(b)};",
        f"x = {number(a)} + ({number(b - a)}) * tau^4;",
        f"x = {number((a + b) / 2)};  u = {number(draw(rng, 1, 100))} [1/{clock}];",
    ]
    guess = rng.choice(["", rng.choice(poor)])
    if rng.random() < 0.5:
        total = draw(rng, 1e-2, 1e2)
        statements.append(f"guess {{ {guess} }}" if guess else "")
        statements += [f"duration T = {number(total)} [{clock}];", f"input u [1/{clock}];"]
        return statements, "integral(u^2)", f"1/{clock}", 1 / second, way**2 / total, rate
    most = draw(rng, 1e-2, 1e2)
    best = abs(way) / most
    late = rng.choice(["", f"  T = {number(best * rng.choice([0.03, 30]))} [{clock}];"])
    statements.append(f"guess {{ {guess}{late} }}" if guess or late else "")
    statements += [f"duration T in {bounds(rng, best, clock)};", f"input u in -{number(most)} .. {number(most)} [1/{clock}];"]
    return statements, "T", clock, second, best, rate


def polar(rng, clock, second):
    """A straight line in polar coordinates, at a bounded speed."""
    length, _ = unit(rng, "length")
    size, speed = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
    r0, r1, turn = size, rounded(size * draw(rng, 0.3, 3), 3), draw(rng, 10, 165)
    best = math.sqrt(r0**2 + r1**2 - 2 * r0 * r1 * math.cos(math.radians(turn))) / speed
    by_angle = rng.random() < 0.5
    statements = [
        f"state r [{length}], theta [1];",
        "input psi [1];" if by_angle else f"input vr, vt [{length}/{clock}];",
        f"param V = {number(speed)} [{length}/{clock}];",
        "dynamics { der(r) == V * cos(psi);  der(theta) == V * sin(psi) / r; }"
        if by_angle
        else "dynamics { der(r) == vr;  der(theta) == vt / r; }\ntrajectory { vr^2 + vt^2 <= V^2; }",
        f"initial {{ r == {number(r0)} [{length}];  theta == 0; }}",
        f"final {{ r == {number(r1)} [{length}];  theta == {number(turn)} [deg]; }}",
        f"duration T in {bounds(rng, best, clock)};",
    ]
    return statements, "T", clock, second, best, "polar"


def turning(rng, clock, second):
    """Between places of a turning table, with the least energy seen from the ground."""
    omega, total = draw(rng, 0.1, 2), draw(rng, 0.3, 4)
    a = (draw(rng, 0.1, 10), draw(rng, 0.1, 10))
    b = (-draw(rng, 0.1, 10), draw(rng, 0.1, 10))
    angle = omega * total
    end = (b[0] * math.cos(angle) - b[1] * math.sin(angle), b[0] * math.sin(angle) + b[1] * math.cos(angle))
    best = math.dist(a, end) ** 2 / total
    statements = [
        "state p[2] [m];",
        f"input v[2] [m/{clock}];",
        f"param w = {number(omega)} [1/{clock}];",
        "dynamics { der(p[1]) == v[1] + w * p[2];  der(p[2]) == v[2] - w * p[1]; }",
        f"initial {{ p == ({number(a[0])}, {number(a[1])}) [m]; }}",
        f"final {{ p == ({number(b[0])}, {number(b[1])}) [m]; }}",
        f"duration T = {number(total)} [{clock}];",
    ]
    return statements, "integral(norm(v)^2)", f"m^2/{clock}", 1 / second, best, "turning"


def drifting(rng, clock, second):
    """A boat in a stream that changes with time alone: only the drift counts."""
    speed, size = draw(rng, 0.5, 50), draw(rng, 1e-1, 1e3)
    omega = speed / size * draw(rng, 0.3, 6)
    omega = rounded(omega, 3)
    stream = rounded(speed * draw(rng, 0.1, 0.8), 3)
    # Away by `size` across, and where the stream alone would have led along: it takes size / speed.
    best = size / speed
    statements = [
        "state x, y [m];",
        "input psi [1];" if rng.random() < 0.5 else "input psi in -180 .. 180 [deg];",
        f"let stream [m/{clock}] = {number(stream)} [m/{clock}] * cos({number(omega)} [1/{clock}] * t);",
        f"dynamics {{ der(x) == {number(speed)} [m/{clock}] * cos(psi);  der(y) == {number(speed)} [m/{clock}] * sin(psi) + stream; }}",
        "initial { x == 0;  y == 0; }",
        f"final {{ x == {number(size)} [m];  y == {number(stream / omega)} [m] * sin({number(omega)} [1/{clock}] * T); }}",
        f"duration T in {bounds(rng, best, clock)};",
    ]
    return statements, "T", clock, second, best, "drifting"


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time")
        statements, expression, symbol, factor, best, why = [mapped, polar, mapped, turning, mapped, drifting][
            index % 6
        ](rng, clock, second)
        minimize, worth = objective(rng, "minimize", "cost", expression, symbol, factor)
        grid = mesh(rng, 10, 30, least=3)
        text = problem(rng, "Line", "A straight line, seen from elsewhere.", statements + [minimize, grid.statement])
        yield Case(f"hidden_lines_{index}", text, best * worth, 2e-3, why=why)
