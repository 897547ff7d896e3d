"""Oscillations that return: the best steady state of a forced oscillator, and free motions that are periodic anyway.

Answer: one harmonic of the force suffices; of the pair of amplitudes the least of |X|^2 + p |U|^2 with Z X = F + U is
|F|^2 p / (1 + p |Z|^2), half of it in the mean. A free oscillation of whole turns ends as it begins: fixing its start
and asking for a periodic one says the same twice; the integral of x^2 is T (x0^2 + v0^2 / w^2) / 2.
"""

import math

from case import Case
from meshes import mesh
from spell import draw, number, objective, problem
from units import unit


def forced(rng, clock):
    """A driven mass, spring and damper in its best steady state."""
    mass, damping, spring = draw(rng, 0.1, 10), draw(rng, 0.05, 5), draw(rng, 0.1, 10)
    omega, force, price = draw(rng, 0.2, 5), draw(rng, 1e-2, 1e2), draw(rng, 0.01, 10)
    impedance = (spring - mass * omega**2) ** 2 + (damping * omega) ** 2
    turns = rng.choice([1, 1, 2])
    total = 2 * math.pi / omega * turns
    best = force**2 * price / (1 + price * impedance) / 2 * total
    grid = mesh(rng, 8 * turns, 30, least=3)
    kg, damper, stiff = "kg", f"kg/{clock}", f"kg/{clock}^2"
    statements = [
        f"param m = {number(mass)} [{kg}];",
        f"param c = {number(damping)} [{damper}];",
        f"param k = {number(spring)} [{stiff}];",
        f"let push [kg*m/{clock}^2] = {number(force)} [kg*m/{clock}^2] * cos({number(omega)} [1/{clock}] * t);",
        f"param price = {number(price)} [{clock}^4/kg^2];",
        f"param omega = {number(omega)} [1/{clock}];\nduration T = {2 * turns} * pi / omega;",
        grid.statement,
    ]
    if rng.random() < 0.5:
        statements += [
            f"output x [m]: spline(order = 7, intervals = {grid.intervals});",
            f"let u [kg*m/{clock}^2] = m * der(x, 2) + c * der(x) + k * x - push;",
            "periodic x;",
        ]
    else:
        statements += [
            f"state x [m], v [m/{clock}];",
            f"input u [kg*m/{clock}^2]: continuous;",
            "dynamics { der(x) == v;  m * der(v) == u + push - c * v - k * x; }",
            "periodic x, v;",
        ]
    return statements, best, "integral(x^2 + price * u^2)"


def free(rng, clock):
    """A conservative motion that is fixed at its start and periodic."""
    omega, place, speed = draw(rng, 0.1, 10), draw(rng, 0.1, 10), draw(rng, 0.1, 10)
    turns = rng.choice([1, 1, 2, 3])
    total = 2 * math.pi / omega * turns
    best = total * (place**2 + (speed / omega) ** 2) / 2
    grid = mesh(rng, 12 * turns, 50, least=4)
    statements = [
        f"param omega = {number(omega)} [1/{clock}];",
        f"duration T = {2 * turns} * pi / omega;",
        grid.statement,
        f"state x [m], v [m/{clock}];",
        "dynamics { der(x) == v;  der(v) == -omega^2 * x; }",
        f"initial {{ x == {number(place)} [m];  v == {number(speed)} [m/{clock}]; }}",
        rng.choice(["periodic x, v;", "periodic x;\nfinal { v == initial(v); }"]),
    ]
    return statements, best, "integral(x^2)"


def turn(rng, clock):
    """The time of one turn, from the start and the periodicity alone."""
    omega, place = draw(rng, 0.1, 10), draw(rng, 0.1, 10)
    total = 2 * math.pi / omega
    grid = mesh(rng, 12, 40, least=4)
    statements = [
        f"param omega = {number(omega)} [1/{clock}];",
        f"duration T in {number(0.6 * total)} .. {number(1.7 * total)} [{clock}];",
        grid.statement,
        f"state x [m], v [m/{clock}];",
        "dynamics { der(x) == v;  der(v) == -omega^2 * x; }",
        f"initial {{ x == {number(place)} [m];  v == 0; }}",
        "periodic x, v;",
    ]
    return statements, total, "T"


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time")
        kind = [forced, free, turn][index % 3]
        statements, best, expression = kind(rng, clock)
        symbol, factor = (clock, second) if kind is turn else (f"m^2*{clock}", second)
        minimize, worth = objective(rng, "minimize", "cost", expression, symbol, factor)
        text = problem(rng, "Steady", "A mass on a spring returns to where it was.", statements + [minimize])
        yield Case(f"periodic_{index}", text, best * worth, 1e-4, why=kind.__doc__)
