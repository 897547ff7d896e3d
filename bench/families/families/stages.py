"""Rockets of several stages in free space, and gliders that are pushed: jumps of mass and of velocity.

Answer: Tsiolkovsky: each stage gives exhaust * log(mass before / mass after). The best sizes of the stages for a payload,
a structural share each and a mass in all are the root of one multiplier (Lagrange). Pushes at given times that move a
coasting body by d, at rest in the end or not, have the least sum of squares d^T (A A^T)^-1 d.
"""

import math

import numpy as np
from scipy.optimize import minimize_scalar

from case import Case
from meshes import mesh
from spell import bounds, draw, number, numbers, objective, problem, rounded
from units import unit


def velocity(rng):
    """Stages of given sizes burn one after another; how long, thrust and flow say."""
    n = rng.randint(2, 3)
    payload = draw(rng, 1, 1e4)
    exhausts = [draw(rng, 1.5, 4.5) for _ in range(n)]
    fuels = [rounded(payload * draw(rng, 0.5, 20), 3) for _ in range(n)][::-1]
    shells = [rounded(fuel * draw(rng, 0.05, 0.2), 3) for fuel in fuels]
    mass = payload + sum(fuels) + sum(shells)
    best = 0.0
    statements = [mesh(rng, 4, 12, least=3).statement, "initial { v == 0; }", f"initial {{ m == {number(mass)} [kg]; }}"]
    statements += ["state v [km/s], m [kg];"]
    for k, (exhaust, fuel, shell) in enumerate(zip(exhausts, fuels, shells)):
        best += exhaust * math.log(mass / (mass - fuel))
        burn = draw(rng, 10, 500)
        after = f" after stage{k}" if k else ""
        drop = f"    jump m;\n    initial {{ m == {number(mass)} [kg]; }}\n" if k else ""
        statements.append(
            f"phase stage{k + 1}{after} {{\n    duration in {bounds(rng, burn, 's')};\n{drop}"
            f"    input flow in 0 .. {number(fuel / burn)} [kg/s];\n"
            f"    let exhaust [km/s] = {number(exhaust)} [km/s];\n"
            f"    dynamics {{ der(m) == -flow;  der(v) == exhaust * flow / m; }}\n"
            f"    final {{ m >= {number(mass - fuel)} [kg]; }}\n}}"
        )
        mass -= fuel + shell
    return statements, best, "km/s", 1e3, "maximize final(v)"


def sizes(rng):
    """How much of the fuel goes into which stage."""
    first, second = draw(rng, 2, 4), draw(rng, 2, 4)
    shell = [draw(rng, 0.05, 0.15, 2), draw(rng, 0.05, 0.15, 2)]
    payload = draw(rng, 1, 100)
    total = rounded(payload * draw(rng, 8, 60), 3)

    def speed(stage1):
        stage2 = total - payload - stage1
        fuel1, fuel2 = stage1 * (1 - shell[0]), stage2 * (1 - shell[1])
        return first * math.log(total / (total - fuel1)) + second * math.log(
            (payload + stage2) / (payload + stage2 - fuel2)
        )

    high = total - payload
    inner = minimize_scalar(lambda x: -speed(x), bounds=(0, high), method="bounded", options={"xatol": 1e-10 * high}).x
    stage1 = max((0.0, float(inner), high), key=speed)
    statements = [
        f"variable stage1 in 0 .. {number(total)} [kg], stage2 in 0 .. {number(total)} [kg];",
        f"temporal {{ stage1 + stage2 == {number(total - payload)} [kg]; }}",
        "state v [km/s], m [kg];",
        mesh(rng, 6, 12, least=3).statement,
        f"initial {{ v == 0;  m == {number(total)} [kg]; }}",
    ]
    for k, exhaust in enumerate((first, second)):
        after = " after burn1" if k else ""
        before = f"{number(total)} [kg]" if k == 0 else f"({number(payload)} [kg] + stage2)"
        jump = f"    jump m;\n    initial {{ m == {before}; }}\n" if k else ""
        statements.append(
            f"phase burn{k + 1}{after} {{\n    duration = {number(draw(rng, 10, 300))} [s];\n{jump}"
            f"    input flow [kg/s];\n    trajectory {{ flow >= 0; }}\n"
            f"    dynamics {{ der(m) == -flow;  der(v) == {number(exhaust)} [km/s] * flow / m; }}\n"
            f"    final {{ m == {before} - {number(1 - shell[k])} * stage{k + 1}; }}\n}}"
        )
    return statements, speed(stage1), "km/s", 1e3, "maximize final(v)"


def pushes(rng):
    """Velocity jumps between phases that coast."""
    length, metre = unit(rng, "length")
    clock, second = unit(rng, "time")
    n = rng.randint(2, 5)
    way, step = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
    legs = [rounded(step * draw(rng, 0.5, 2), 3) for _ in range(n)]
    left = [sum(legs[k:]) for k in range(n)]
    rest = rng.random() < 0.5
    if rest:
        matrix = np.array([left + [0.0], [1.0] * (n + 1)])
        target = np.array([way, 0.0])
    else:
        matrix, target = np.array([left]), np.array([way])
    scale = np.array([1 / sum(legs), 1.0])[: len(target)]
    matrix, target = matrix * scale[:, None], target * scale
    best = float(target @ np.linalg.solve(matrix @ matrix.T, target))
    rate = f"{length}/{clock}"
    square = f"{length}^2/{clock}^2"
    total = f"sum(i in 1 .. {n}, push[i]^2)" + (f" + final(leg[{n}], v)^2" if rest else "")
    statements = [
        f"variable push[{n}] [{rate}];",
        f"variable speed[{n}] [{rate}];",
        f"state x [{length}], v [{rate}];",
        f"param lasts[{n}] = {numbers(legs)} [{clock}];",
        "dynamics { der(x) == v;  der(v) == 0; }",
        f"phase leg[i in 1 .. {n}] {{\n    duration = lasts[i];\n    jump v;\n    initial {{ v == speed[i]; }}\n}}",
        f"temporal {{ speed[1] == push[1];  for i in 2 .. {n} {{ speed[i] == final(leg[i - 1], v) + push[i]; }} }}",
        "initial { x == 0; }",
        f"final {{ x == {number(way)} [{length}]; }}",
        mesh(rng, 1, 4, least=3).statement,
    ]
    return statements, best, square, metre**2 / second**2, f"minimize {total}"


def cases(rng, count):
    for index in range(count):
        kind = [velocity, sizes, pushes][index % 3]
        statements, best, symbol, factor, sentence = kind(rng)
        sense, expression = sentence.split(" ", 1)
        sought, worth = objective(rng, sense, "value", expression, symbol, factor)
        # Fuel may be burnt within one interval, which a mesh sees too well by a part of a percent.
        tolerance = {velocity: 5e-3, sizes: 1e-2, pushes: 1e-6}[kind]
        text = problem(rng, "Stages", "Stages, and what jumps between them.", statements + [sought])
        yield Case(f"stages_{index}", text, best * worth, tolerance, why=kind.__doc__)
