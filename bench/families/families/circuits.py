"""Electrical drives: a motor's move with the least copper loss, a capacitor charged through a resistor, a coil's current.

Answer: a capacitor takes R q^2 / T; with a leak r beside it, d^T W^-1 d of a first-order system. A motor's move by an angle
from rest to rest without friction loses 12 R (J / k)^2 angle^2 / T^3; with viscous friction b the speed is a hyperbolic
cosine and the loss R (b / k)^2 c angle, c = angle / (T - 2 tanh(a T / 2) / a), a = b / J. A coil reaches a current with a
bounded voltage after L / R log(U / (U - R i)).
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time", "s", "ms", "us", "ns")
        kind = ["charge", "motor", "coil", "leak"][index % 4]
        grid = mesh(rng, 4, 24, least=4)
        total = draw(rng, 1e-1, 1e2)
        ohm = draw(rng, 1e-3, 1e6)
        statements = [grid.statement, f"param R = {number(ohm)} [ohm];"]
        symbol, factor, tolerance = "J", 1.0, 1e-6
        if kind == "charge":
            prefix, coulomb = unit(rng, "charge")
            charge = draw(rng, 0.1, 100)
            best = ohm * (charge * coulomb) ** 2 / (total * second)
            statements += [
                f"duration T = {number(total)} [{clock}];",
                f"state q [{prefix}];",
                "input i [A];",
                "dynamics { der(q) == i; }",
                "initial { q == 0; }",
                f"final {{ q == {number(charge)} [{prefix}]; }}",
            ]
            expression = "integral(R * i^2)"
        elif kind == "motor":
            total = draw(rng, 0.1, 5)
            inertia, constant, turn = draw(rng, 1e-6, 1e2), draw(rng, 1e-2, 10), draw(rng, 0.1, 1000)
            friction = rng.choice([0.0, inertia / (total * second) * draw(rng, 0.3, 10)])
            friction = rounded(friction, 3)
            time = total * second
            if friction:
                a = friction / inertia
                best = ohm * (friction / constant) ** 2 * turn**2 / (time - 2 / a * math.tanh(a * time / 2))
            else:
                best = 12 * ohm * (inertia / constant * turn) ** 2 / time**3
            statements += [
                f"duration T = {number(total)} [{clock}];",
                f"param J = {number(inertia)} [kg*m^2];",
                f"param k = {number(constant)} [N*m/A];",
                f"param b = {number(friction)} [N*m*s];",
                f"initial {{ angle == 0;  {'w' if index % 8 > 3 else 'der(angle)'} == 0; }}",
                f"final {{ angle == {number(turn)};  {'w' if index % 8 > 3 else 'der(angle)'} == 0; }}",
            ]
            if index % 8 > 3:
                statements += [
                    "state angle [1], w [rad/s];",
                    "input i [A];",
                    "dynamics { der(angle) == w;  J * der(w) == k * i - b * w; }",
                ]
            else:
                statements += [
                    f"output angle: spline(order = {rng.randint(5, 7)}, intervals = {grid.intervals});",
                    "let i [A] = (J * der(angle, 2) + b * der(angle)) / k;",
                ]
            expression, tolerance = "R * integral(i^2)", 1e-5
        elif kind == "coil":
            voltage = draw(rng, 1e-2, 1e4)
            current = rounded(voltage / ohm * draw(rng, 0.1, 0.98), 4)
            constant = draw(rng, 0.1, 100)
            best = constant * math.log(voltage / (voltage - ohm * current))
            statements += [
                f"duration T in {bounds(rng, best, clock)};",
                "state i [A];",
                f"input U in -{number(voltage)} .. {number(voltage)} [V];",
                f"dynamics {{ {number(constant * second * ohm)} [H] * der(i) == U - R * i; }}",
                "initial { i == 0; }",
                f"final {{ i == {number(current)} [A]; }}",
            ]
            expression, symbol, factor, tolerance = "T", clock, second, 1e-4
        else:
            leak = rounded(ohm * draw(rng, 0.3, 10), 3)
            constant = total * draw(rng, 0.3, 3)
            farad = constant * second / leak
            voltage = draw(rng, 1e-3, 1e4)
            # C v' = i - v / r, from 0 to the voltage with the least integral of R i^2.
            time = total * second
            gram = (1 - math.exp(-2 * time / (leak * farad))) * leak / (2 * farad)
            best = ohm * voltage**2 / gram
            statements += [
                f"duration T = {number(total)} [{clock}];",
                "state v [V];",
                "input i [A];",
                f"dynamics {{ {number(farad)} [F] * der(v) == i - v / {number(leak)} [ohm]; }}",
                "initial { v == 0; }",
                f"final {{ v == {number(voltage)} [V]; }}",
            ]
            expression, tolerance = "integral(R * i^2)", 1e-5
        minimize, worth = objective(rng, "minimize", "loss", expression, symbol, factor)
        text = problem(rng, "Circuit", "The least loss.", statements + [minimize])
        yield Case(f"circuits_{index}", text, best * worth, tolerance, why=kind)
