"""Quotients, products, budgets and worst cases: the best cruise, a plan for the worst of several cases.

Answer: the most way for the energy is at the speed (P / 2 c)^(1/3); the best of the worst of |a_k U - b_k| over one number U
is a linear program; an energy E leads sqrt(E T) far at most; the energy of a move from rest to rest times T^3 is 12 d^2.
"""

from scipy.optimize import linprog

from case import Case
from meshes import mesh
from spell import bounds, draw, number, numbers, objective, problem, rounded
from units import unit


def cruise(rng, length, clock, metre, second):
    """The most way for the energy, at any speed and for as long as it likes."""
    base, drag = draw(rng, 1e-2, 1e4), draw(rng, 1e-4, 1e2)
    speed = (base / (2 * drag)) ** (1 / 3)
    best = speed / (base + drag * speed**3)
    top = rounded(speed * draw(rng, 1.5, 10), 3)
    statements = [
        f"duration T in {bounds(rng, 100 * draw(rng, 0.1, 10), clock)};",
        f"state x [{length}];",
        f"input v in 0 .. {number(top)} [{length}/{clock}];",
        "dynamics { der(x) == v; }",
        "initial { x == 0; }",
        f"let power [J/{clock}] = {number(base)} [J/{clock}] + {number(drag)} [J*{clock}^2/{length}^3] * v^3;",
        rng.choice(
            ["", f"guess {{ x = {number(speed * 50)} [{length}] * tau;  v = {number(top / 2)} [{length}/{clock}]; }}"]
        ),
    ]
    return statements, "maximize", "final(x) / integral(power)", f"{length}/J", metre, best


def worst(rng, length, clock, metre, second):
    """One input for all cases, and the least of the largest misses."""
    n = rng.randint(2, 6)
    size = draw(rng, 1e-3, 1e3)
    gains, aims = [draw(rng, 0.3, 3) for _ in range(n)], [rounded(size * draw(rng, 0.5, 2), 3) for _ in range(n)]
    total = draw(rng, 0.1, 100)
    rows = [[a, -1] for a in gains] + [[-a, -1] for a in gains]
    found = linprog([0, 1], A_ub=rows, b_ub=aims + [-b for b in aims], bounds=[(None, None), (0, None)])
    miss = rng.choice(["-miss <= x - aim[k] <= miss;", "abs(x - aim[k]) <= miss;"])
    statements = [
        f"duration T = {number(total)} [{clock}];",
        f"param gain[{n}] = {numbers(gains)};",
        f"param aim[{n}] = {numbers(aims)} [{length}];",
        f"variable miss [{length}];",
        f"scenario plant[k in 1 .. {n}] {{\n    state x [{length}];\n    input u [{length}/{clock}];\n    shared u;\n"
        f"    dynamics {{ der(x) == gain[k] * u; }}\n    initial {{ x == 0; }}\n    final {{ {miss} }}\n}}",
    ]
    return statements, "minimize", "miss", length, metre, float(found.fun)


def budget(rng, length, clock, metre, second):
    """The farthest way for an energy, in a time that is at its bound."""
    energy, total = draw(rng, 1e-3, 1e3), draw(rng, 1e-1, 1e2)
    best = (energy * total) ** 0.5
    statements = [
        f"duration T in {number(total / 10)} .. {number(total)} [{clock}];",
        f"output x [{length}]: spline(order = 4, intervals = 3);",
        "initial { x == 0; }",
        f"temporal {{ integral(der(x)^2) <= {number(energy)} [{length}^2/{clock}]; }}",
    ]
    return statements, "maximize", "final(x)", length, metre, best


def power(rng, length, clock, metre, second):
    """The energy of a move times the cube of its time is the same for any time."""
    way, total = draw(rng, 1e-2, 1e3), draw(rng, 1e-1, 1e2)
    statements = [
        f"duration T in {number(total / 10)} .. {number(total)} [{clock}];",
        f"output x [{length}]: spline(order = 5, intervals = 3);",
        "initial { x == 0;  der(x) == 0; }",
        f"final {{ x == {number(way)} [{length}];  der(x) == 0; }}",
    ]
    return statements, "minimize", "integral(der(x, 2)^2) * T^3", f"{length}^2", metre**2, 12 * way**2


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        kind = [cruise, worst, budget, power][index % 4]
        statements, sense, expression, symbol, factor, best = kind(rng, length, clock, metre, second)
        sought, worth = objective(rng, sense, "value", expression, symbol, factor)
        if kind in (cruise, worst):
            statements.append(mesh(rng, 3, 12, least=3).statement)
        text = problem(rng, "Worth", "The most for what it costs.", statements + [sought])
        yield Case(f"efficiency_{index}", text, best * worth, 1e-5, why=kind.__doc__)
