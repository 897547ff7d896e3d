"""A mine is sold until it is empty, for as long as it takes, at the greatest discounted value.

Answer: with a demand of price p - b q the value of q is p q - b q^2 / 2, and p - b q grows like the discount (Hotelling's
rule); the mine is closed when q = 0, which with the stock gives the time by one equation.
"""

import math

from scipy.optimize import brentq

from case import Case
from meshes import mesh
from spell import bounds, draw, number, problem, rounded


def closing(price, slope, discount, stock):
    """The time at which the mine is empty, and the value."""

    def sold(total):
        return price / slope * (total - (1 - math.exp(-discount * total)) / discount)

    end = brentq(lambda total: sold(total) - stock, 1e-9, 20 / discount, xtol=1e-13)
    return end, price**2 / (2 * slope) * (1 - math.exp(-discount * end)) ** 2 / discount


def cases(rng, count):
    for index in range(count):
        price, slope, discount = draw(rng, 1e-2, 1e4), draw(rng, 1e-2, 1e2), draw(rng, 0.01, 1)
        years = draw(rng, 0.3, 6)
        stock = rounded(price / slope * (years + math.expm1(-years)) / discount, 3)
        end, value = closing(price, slope, discount, stock)
        statements = [
            f"duration T in {bounds(rng, end)};",
            "state S;",
            f"input q in 0 .. {number(price / slope)};" if rng.random() < 0.5 else "input q;\ntrajectory { q >= 0; }",
            f"const p = {number(price)};",
            f"const b = {number(slope)};",
            f"maximize integral(exp(-{number(discount)} * t) * (p * q - b * q^2 / 2));",
            "dynamics { der(S) == -q; }",
            f"initial {{ S == {number(stock)}; }}",
            "final { S >= 0; }",
            rng.choice(["", f"guess {{ S = {number(stock)} * (1 - tau);  T = {number(2 * end)}; }}"]),
            mesh(rng, 8, 30, least=3).statement,
        ]
        text = problem(rng, "Mine", "A mine is sold when it is worth most.", statements)
        yield Case(f"mine_{index}", text, value, 1e-3, why=f"closed at {end}")
