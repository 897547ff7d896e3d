"""Rates of motions from recordings with noise, against least squares of the motions in closed form.

Answer: exponential decay, Newton's cooling, logistic growth and the damped spring are known in closed form; the least sum
of squares over their parameters is scipy's.
"""

import numpy as np
from scipy.optimize import least_squares

from case import Case
from meshes import mesh
from spell import draw, number, numbers, problem, rounded
from units import unit


def decay(x, t):
    """First order: start and rate."""
    return x[0] * np.exp(-x[1] * t)


def cooling(x, t):
    """Start, rate and surroundings."""
    return x[2] + (x[0] - x[2]) * np.exp(-x[1] * t)


def growth(x, t):
    """Logistic: start, rate and capacity."""
    return x[2] / (1 + (x[2] / x[0] - 1) * np.exp(-x[1] * t))


def swing(x, t):
    """Damped spring from rest: start, stiffness, damping."""
    half = x[2] / 2
    rate = np.sqrt(x[1] - half**2)
    return x[0] * np.exp(-half * t) * (np.cos(rate * t) + half / rate * np.sin(rate * t))


MODELS = {
    decay: ((1.0, 1.0), "der(x) == -k * x;", ["k"], 3.0),
    cooling: ((1.0, 1.0, 0.2), "der(x) == -k * (x - p);", ["k", "p"], 4.0),
    growth: ((0.1, 1.0, 1.0), "der(x) == k * x * (1 - x / p);", ["k", "p"], 5.0),
    swing: ((1.0, 4.0, 0.4), "der(x) == v;  der(v) == -k * x - c * v;", ["k", "c"], 5.0),
}


def cases(rng, count):
    for index in range(count):
        clock, _ = unit(rng, "time")
        model = list(MODELS)[index % 4]
        typical, motion, names, length = MODELS[model]
        truth = np.array(typical) * [draw(rng, 0.8, 1.25) for _ in typical]
        n = rng.randint(6, 25)
        times = np.array(sorted(rounded(length * (i + 0.9 * rng.random()) / n, 4) for i in range(n)))
        noise = draw(rng, 0.003, 0.05)
        rows = np.array([rounded(value + rng.gauss(0, noise), 5) for value in model(truth, times)])
        found = least_squares(lambda x: (model(x, times) - rows) / noise, truth, xtol=1e-15, ftol=1e-15, gtol=1e-12)
        tempo, size = draw(rng, 1e-3, 1e3, 2), draw(rng, 1e-6, 1e6, 2)
        units = {"k": f"[1/{clock}]", "p": "[m]", "c": f"[1/{clock}]"}
        value = {"k": 1 / tempo, "p": size, "c": 1 / tempo}
        if model is swing:
            units["k"], value["k"] = f"[1/{clock}^2]", 1 / tempo**2
        variables = []
        for position, name in enumerate(names):
            best = truth[position + 1] * value[name]
            low, high = rng.choice([(0.3, 3), (0.01, 100), (0.1, 10)])
            bounds = (
                f" in {number(rounded(best * low, 2))} .. {number(rounded(best * high, 2))}"
                if rng.random() < 0.8
                else ""
            )
            variables.append(f"variable {name}{bounds} {units[name]};")
        guess = rng.choice(
            [
                "",
                "guess { "
                + "  ".join(f"{n} = {number(value[n] * rng.choice([0.4, 1, 2]))} {units[n]};" for n in names)
                + " }",
            ]
        )
        states = f"state x [m], v [m/{clock}];" if model is swing else "state x [m];"
        # A swing turns by 10 radians or so.
        grid = mesh(rng, 20 if model is swing else 10, 30, least=4)
        by_measure = rng.random() < 0.7
        share = number(size * noise)
        fit = (
            f"measure {{ for i in 1 .. {n} {{ seen_at: at(time[i], x) == seen[i] sigma {share} [m]; }} }}"
            if by_measure
            else f"minimize 0.5 * sum(i in 1 .. {n}, ((at(time[i], x) - seen[i]) / {share} [m])^2);"
        )
        text = problem(
            rng,
            "Recording",
            "The rates of a motion from its recording.",
            [
                f"duration T = {number(length * tempo)} [{clock}];",
                f"const time[{n}] = {numbers(times * tempo)} [{clock}];",
                f"param seen[{n}] = {numbers(rows * size)} [m];",
                states,
                grid.statement,
                "dynamics { " + motion + " }",
                "initial { v == 0; }" if model is swing else "",
                fit,
                guess,
            ]
            + variables,
        )
        yield Case(f"identification_{index}", text, float(found.cost), 1e-3, scale=1.0, why=model.__doc__)
