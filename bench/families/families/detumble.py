"""A tumbling satellite is brought to rest: in the least time with a bounded torque, or with the least energy.

Answer: the angular momentum h turns in the body but its length changes by the torque along it alone: the least time is
|h| / U, the least integral of the squared torque |h|^2 / T, whatever the inertia is (Athans, Falb and Lacoss 1963).
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, number, numbers, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time", "s", "min", "ms", "h")
        scale = draw(rng, 1e-4, 1e4)
        even = rounded(scale * draw(rng, 0.5, 1.5), 3)
        inertia = (
            [even, even, rounded(even * draw(rng, 0.3, 1.9), 3)]
            if rng.random() < 0.5
            else [rounded(scale * f, 3) for f in (draw(rng, 0.8, 1.1), draw(rng, 1, 1.5), draw(rng, 0.7, 1.6))]
        )
        spin = draw(rng, 0.05, 1)
        rates = [rounded(spin * rng.gauss(0, 1), 3) for _ in range(3)]
        momentum = math.hypot(*(j * w for j, w in zip(inertia, rates)))
        fast = index % 2 == 0
        turns = draw(rng, 0.5, 10)
        grid = mesh(rng, 10, 30, least=4)
        torque = f"kg*m^2/{clock}^2"
        statements = [
            f"param J[3, 3] = (({number(inertia[0])}, 0, 0), (0, {number(inertia[1])}, 0), (0, 0, {number(inertia[2])})) [kg*m^2];"
            if rng.random() < 0.5
            else f"param D[3] = {numbers(inertia)} [kg*m^2];\nlet J[3, 3] = diagonal(D);",
            f"state w[3] [1/{clock}];",
            f"initial {{ w == {numbers(rates)} [1/{clock}]; }}",
            "final { w == 0; }",
            "dynamics { J * der(w) == u - cross(w, J * w); }",
            grid.statement,
            f"input u[3] [{torque}];",
        ]
        if fast:
            most = rounded(momentum * spin / turns, 3)
            best = momentum / most
            statements += [
                f"duration T in {bounds(rng, best, clock)};",
                f"trajectory {{ norm(u) <= {number(most)} [{torque}]; }}",
            ]
            minimize, worth = objective(rng, "minimize", "time", "T", clock, second)
        else:
            total = rounded(turns / spin, 3)
            best = momentum**2 / total
            statements += [f"duration T = {number(total)} [{clock}];"]
            minimize, worth = objective(
                rng, "minimize", "effort", "integral(norm(u)^2)", f"kg^2*m^4/{clock}^3", 1 / second**3
            )
        text = problem(rng, "Detumble", "A satellite comes to rest.", statements + [minimize])
        yield Case(f"detumble_{index}", text, best * worth, 1e-3, why="time" if fast else "energy")
