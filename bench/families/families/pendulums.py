"""A pendulum, or a crane's trolley and load, goes from one state to another in a fixed time with the least energy.

Answer: the Gramian of the equations for small angles.
"""

import numpy as np

from case import Case
from linear import least_energy
from meshes import mesh
from spell import draw, number, objective, problem
from units import unit


def pendulum(rng):
    """A joint with gravity and friction, hanging or standing."""
    stiff, friction = rng.choice([1, -1]) * draw(rng, 0.3, 3), rng.choice([0.0, draw(rng, 0.1, 1)])
    return (
        np.array([[0, 1], [-stiff, -friction]]),
        ["q", "w"],
        ["der(q) == w", f"der(w) == -({number(stiff)} [1/S^2]) * q - {number(friction)} [1/S] * w + u"],
    )


def crane(rng):
    """A trolley and its load on a rope, for small angles."""
    swing = draw(rng, 0.5, 5)
    matrix = np.array([[0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1], [0, 0, -swing, 0]])
    rows = ["der(p) == v", "der(v) == u", "der(q) == w", f"der(w) == -({number(swing)} [1/S^2]) * q - u"]
    return matrix, ["p", "v", "q", "w"], rows


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time")
        kind = [pendulum, crane][index % 2]
        matrix, names, rows = kind(rng)
        n = len(names)
        if kind is pendulum:
            b = np.array([0.0, 1.0])
            start = np.array([draw(rng, 0.01, 1), rng.choice([0.0, draw(rng, 0.1, 1)])])
            end = np.array([rng.choice([0.0, -0.5, 1.5]), 0.0])
        else:
            b = np.array([0.0, 1.0, 0.0, -1.0])
            start, end = np.zeros(4), np.array([draw(rng, 0.1, 10), 0.0, 0.0, 0.0])
        total = draw(rng, 1, 6)
        best = least_energy(matrix, b[:, None], total, start, end)
        grid = mesh(rng, 6, 24, least=4)
        # Times of the model are in units of the clock that is drawn.
        units = {"q": "", "p": "", "w": f" [1/{clock}]", "v": f" [1/{clock}]"}
        statements = [f"duration T = {number(total)} [{clock}];"]
        if kind is pendulum and rng.random() < 0.5:
            stiff, friction = -matrix[1, 0], -matrix[1, 1]
            statements += [
                f"output q [1]: spline(order = {rng.randint(6, 7)}, intervals = {grid.intervals});",
                f"let u [1/{clock}^2] = der(q, 2) + {number(friction)} [1/{clock}] * der(q) + ({number(stiff)} [1/{clock}^2]) * q;",
            ]
            spelled = ["q", "der(q)"]
        else:
            statements += [
                grid.statement,
                "state " + ", ".join(f"{name}{units[name] or ' [1]'}" for name in names) + ";",
                f"input u [1/{clock}^2];",
                "dynamics { " + "  ".join(row.replace("/S", f"/{clock}") + ";" for row in rows) + " }",
            ]
            spelled = names
        for block, values in (("initial", start), ("final", end)):
            row = "  ".join(f"{s} == {number(x)}{units[name] if x else ''};" for s, name, x in zip(spelled, names, values))
            statements.append(f"{block} {{ {row} }}")
        minimize, worth = objective(rng, "minimize", "energy", "integral(u^2)", f"1/{clock}^3", 1 / second**3)
        text = problem(rng, "Steer", "From one state to another with the least energy.", statements + [minimize])
        yield Case(f"pendulums_{index}", text, best * worth, 1e-5, why=f"{kind.__name__}, {n} states")
