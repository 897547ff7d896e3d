"""Programs in a few numbers beside a motion that only passes the time: linear, entropic, geometric, nearest points.

Answer: linear programs by scipy; the greatest entropy under a mean is exponential in the value, its rate a root; the most
volume of a box with a surface S is (S/6)^1.5, of a can S^1.5 / sqrt(54 pi); the nearest point of an ellipse is a root; a
portfolio under a budget has w = C^-1 1 / (1 C^-1 1).
"""

import math

import numpy as np
from scipy.optimize import brentq, linprog

from case import Case
from spell import draw, number, numbers, objective, problem, rounded
from units import unit


def linear(rng):
    """Costs of a mixture with at least so much of each part."""
    n, m = rng.randint(2, 6), rng.randint(2, 4)
    scale = draw(rng, 1e-6, 1e6, 1)
    costs = [draw(rng, 0.1, 10, 2) for _ in range(n)]
    parts = [[draw(rng, 0.05, 1, 2) for _ in range(n)] for _ in range(m)]
    needs = [rounded(scale * draw(rng, 0.5, 2, 2), 2) for _ in range(m)]
    best = linprog(costs, A_ub=-np.array(parts), b_ub=-np.array(needs), bounds=(0, None)).fun
    statements = [
        f"variable a[{n}] in {rng.choice(['0 [kg] ..', f'0 .. {number(1000 * scale)} [kg]'])};",
        f"param cost[{n}] = {numbers(costs)};",
        f"param part[{m}, {n}] = {numbers(parts)};",
        f"param need[{m}] = {numbers(needs)} [kg];",
        f"temporal {{ for i in 1 .. {m} {{ sum(j in 1 .. {n}, part[i, j] * a[j]) >= need[i]; }} }}",
    ]
    return statements, "minimize", f"sum(j in 1 .. {n}, cost[j] * a[j])", "kg", 1.0, best, ""


def entropy(rng):
    """Shares of values with a given mean."""
    n = rng.randint(3, 8)
    values = sorted(draw(rng, 0.1, 10) for _ in range(n))
    mean = values[0] + (values[-1] - values[0]) * rng.uniform(0.15, 0.85)
    mean = rounded(mean, 4)
    points = np.array(values)

    def shares(rate):
        weights = np.exp(rate * points - np.max(rate * points))
        return weights / weights.sum()

    p = shares(brentq(lambda rate: shares(rate) @ points - mean, -200, 200, xtol=1e-14))
    best = -float(np.sum(p * np.log(p)))
    statements = [
        f"variable p[{n}] in {rng.choice(['0 .. 1', '1e-9 .. 1', '0 ..'])};",
        f"const value[{n}] = {numbers(values)};",
        f"temporal {{ sum(p) == 1;  sum(i in 1 .. {n}, value[i] * p[i]) == {number(mean)}; }}",
    ]
    return (
        statements,
        "maximize",
        f"-sum(i in 1 .. {n}, p[i] * log(p[i]))",
        "",
        1.0,
        best,
        f"guess {{ p = {number(1 / n)}; }}",
    )


def box(rng):
    """The largest box or can of a surface."""
    length, metre = unit(rng, "length")
    surface = draw(rng, 1e-4, 1e6)
    if rng.random() < 0.5:
        best = (surface / 6) ** 1.5
        statements = [
            f"variable a, b, c [{length}];",
            f"temporal {{ 2 * (a * b + b * c + a * c) <= {number(surface)} [{length}^2];  a >= 0;  b >= 0;  c >= 0; }}",
        ]
        side = surface**0.5
        sides = f"guess {{ a = {number(side / 3)} [{length}];  b = {number(side / 2)} [{length}];  c = {number(side / 9)} [{length}]; }}"
        expression, guess = "a * b * c", rng.choice(["", sides])
    else:
        best = surface**1.5 / math.sqrt(54 * math.pi)
        side = number(10 * surface**0.5)
        statements = [
            f"variable r in 0 .. {side} [{length}], h in 0 .. {side} [{length}];",
            f"temporal {{ 2 * pi * r * (r + h) <= {number(surface)} [{length}^2]; }}",
        ]
        expression, guess = "pi * r^2 * h", ""
    return statements, "maximize", expression, f"{length}^3", metre**3, best, guess


def ellipse(rng):
    """The way from a place outside to an ellipse."""
    length, metre = unit(rng, "length")
    a = draw(rng, 1e-2, 1e3)
    b = rounded(a * draw(rng, 0.2, 1), 3)
    x, y = rounded(a * draw(rng, 0.9, 3), 3), rounded(a * draw(rng, 0.9, 3), 3)
    # (a x / (a^2 + s))^2 + (b y / (b^2 + s))^2 = 1.
    s = brentq(
        lambda s: (a * x / (a * a + s)) ** 2 + (b * y / (b * b + s)) ** 2 - 1,
        0,
        10 * (x * x + y * y),
        xtol=1e-16 * a * a,
    )
    best = math.hypot(x - a * a * x / (a * a + s), y - b * b * y / (b * b + s))
    statements = [
        f"variable p[2] [{length}];",
        f"temporal {{ (p[1] / {number(a)} [{length}])^2 + (p[2] / {number(b)} [{length}])^2 {rng.choice(['==', '<='])} 1; }}",
    ]
    expression = f"norm(p - ({number(x)}, {number(y)}) [{length}])"
    guess = rng.choice(["", f"guess {{ p = ({number(a / 2)}, {number(b / 2)}) [{length}]; }}"])
    return statements, "minimize", expression, length, metre, best, guess


def portfolio(rng):
    """The least variance of shares that add up."""
    n = rng.randint(2, 6)
    root = np.array([[rounded(rng.gauss(0, 1), 3) for _ in range(n)] for _ in range(n)])
    scale = draw(rng, 1e-6, 1e3, 1)
    covariance = scale * (root @ root.T + 0.2 * np.eye(n))
    inverse = np.linalg.solve(covariance, np.ones(n))
    statements = [
        f"variable w[{n}];",
        f"param C[{n}, {n}] = ({', '.join('(' + ', '.join(f'{x:.15g}' for x in row) + ')' for row in covariance)});",
        "temporal { sum(w) == 1; }",
    ]
    return statements, "minimize", "dot(w, C * w)", "", 1.0, float(1 / inverse.sum()), ""


def cases(rng, count):
    for index in range(count):
        kind = [linear, entropy, box, ellipse, portfolio][index % 5]
        statements, sense, expression, symbol, factor, best, guess = kind(rng)
        sought, worth = objective(rng, sense, "value", expression, symbol, factor)
        idle = [
            "duration T = 1 [s];",
            "output idle: spline(order = 2, intervals = 1);",
            "initial { idle == 0; }",
            "final { idle == 1; }",
        ]
        text = problem(rng, "Static", "A program in a few numbers.", statements + idle + [guess, sought])
        yield Case(f"statics_{index}", text, best * worth, 1e-5, why=kind.__doc__)
