"""One input for several cases of an uncertain system, by weighted least squares.

Answer: with free responses and kernels f_k(s) of first-order systems, the least mean of w_k (x_k(T) - goal)^2 plus p times
the energy of the input is r^T (diag(1/w) + G / p)^-1 r, G the Gram matrix of the kernels. With a shared input over a
bounded time, G has the shared part for all pairs and the rest on the diagonal alone.
"""

import math

import numpy as np

from case import Case
from meshes import mesh
from spell import draw, number, numbers, problem, rounded
from units import unit


def overlap(a, b, low, high):
    """Integral of exp(-a s) exp(-b s)."""
    rate = a + b
    return (math.exp(-rate * low) - math.exp(-rate * high)) / rate


def cases(rng, count):
    for index in range(count):
        clock, _ = unit(rng, "time")
        n = rng.randint(2, 6)
        # The price is that of the mean square of the input.
        total, price, size = draw(rng, 0.1, 100), draw(rng, 0.01, 10), draw(rng, 1e-3, 1e3)
        rates = [rounded(draw(rng, 0.2, 3) / total, 3) for _ in range(n)]
        gains = [rounded(draw(rng, 0.5, 2) / total, 3) for _ in range(n)]
        start = rounded(size * rng.uniform(-1, 1), 3)
        weights = [draw(rng, 0.1, 1, 2) for _ in range(n)]
        weights = [rounded(w / sum(weights), 4) for w in weights]
        given = rng.random() < 0.6
        if not given:
            weights = [1 / n] * n
        # Kernels run back from the end; the input is shared up to a time that is an end of an interval.
        grid = mesh(rng, 6, 16, least=4)
        shared_to = total if index % 2 == 0 else total * rng.randint(1, grid.intervals - 1) / grid.intervals
        gram = np.zeros((n, n))
        for i in range(n):
            for j in range(n):
                gram[i, j] = gains[i] * gains[j] * overlap(rates[i], rates[j], total - shared_to, total) / sum(weights)
            # After it is shared each case has its own input, which costs by its weight.
            gram[i, i] += gains[i] ** 2 * overlap(rates[i], rates[i], 0, total - shared_to) / weights[i]
        rest = np.array([size - start * math.exp(-a * total) for a in rates])
        best = float(rest @ np.linalg.solve(np.diag(1 / np.array(weights)) + gram * total / price, rest))
        shared = "shared u;" if shared_to == total else f"shared u until {number(shared_to)} [{clock}];"
        weight = " weight chance[k]" if given else ""
        text = problem(
            rng,
            "Plan",
            "One plan for several cases.",
            [
                f"duration T = {number(total)} [{clock}];",
                grid.statement,
                f"param rate[{n}] = {numbers(rates)} [1/{clock}];",
                f"param gain[{n}] = {numbers(gains)} [1/{clock}];",
                f"param chance[{n}] = {numbers(weights)};" if given else "",
                f"scenario plant[k in 1 .. {n}]{weight} {{\n    state x;\n    input u;\n    {shared}\n"
                "    dynamics { der(x) == -rate[k] * x + gain[k] * u; }\n"
                f"    initial {{ x == {number(start)}; }}\n"
                f"    minimize miss: (final(x) - {number(size)})^2;\n"
                f"    minimize effort: {number(price / total)} [1/{clock}] * integral(u^2);\n}}",
            ],
        )
        yield Case(f"scenarios_{index}", text, best, 1e-6, scale=1e-6 * size**2, why=shared)
