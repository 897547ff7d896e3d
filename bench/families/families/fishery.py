"""A fishery with logistic growth: the largest catch in a given time, with bounded effort or harvest.

Answer: the catch of x' = g x (1 - x / K) - h is largest with x at K / 2, approached and left as fast as the bound
allows (Clark, Mathematical Bioeconomics, section 2.7); the times follow in closed form from the logistic curve.
"""

import math

from scipy.integrate import solve_ivp

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import guess, number, problem, rounded


def catch(g, x0, last, most, T):
    """The largest integral of h with capacity 1, and whether the middle is reached and left in time."""
    fish = lambda t, x: [g * x[0] * (1 - x[0]) - most]
    rise = lambda x, y: math.log(y * (1 - x) / (x * (1 - y))) / g

    def fall(x, y):
        """The time in which full harvest brings the stock from x down to y."""
        reached = lambda t, z: z[0] - y
        reached.terminal = True
        found = solve_ivp(fish, (0, 100 * T), [x], events=reached, rtol=1e-11, atol=1e-13)
        return float(found.t[-1])

    if x0 < 0.5:
        first, taken = rise(x0, 0.5), 0.0
    else:
        first = fall(x0, 0.5)
        taken = most * first
    final = fall(0.5, last) if last < 0.5 else rise(0.5, last)
    taken += most * final if last < 0.5 else 0.0
    stay = T - first - final
    return taken + g / 4 * stay, stay


def cases(rng, count):
    k = 0
    while k < count:
        sizes = Sizes(rng, pure=rng.random() < 0.4)
        g = round(rng.uniform(0.2, 3), 2)
        x0, last = round(rng.uniform(0.1, 0.95), 2), round(rng.uniform(0.1, 0.9), 2)
        most = round(g / 4 * rng.uniform(1.3, 4), 3)
        T = float(round(rng.uniform(4, 40) / g, 1))
        total, stay = catch(g, x0, last, most, T)
        if stay < 0.1 * T or abs(x0 - 0.5) < 0.05 or abs(last - 0.5) < 0.05:
            continue
        scale = 1.0 if sizes.pure else rounded(10 ** rng.uniform(0, 5), 2)
        tonnes, rate, flow, time = ("", "", "", "") if sizes.pure else (" [t]", " [1/day]", " [t/day]", " [day]")
        grid = mesh(rng, 10, 80)
        size = lambda value: f"{number(rounded(value * scale, 6))}{tonnes}"
        statements = [
            f"param g = {g!r}{rate};",
            f"param K = {size(1)};",
            f"duration T = {number(T)}{time};",
            f"state x{tonnes};",
            f"input h in 0 .. {number(rounded(most * scale, 6))}{flow};",
            grid.statement,
            rng.choice(("dynamics { der(x) == g * x * (1 - x / K) - h; }", "dynamics { der(x) + h == g * (x - x^2 / K); }")),
            f"initial {{ x == {size(x0)}; }}",
            f"final {{ x {rng.choice(('==', '>='))} {size(last)}; }}",
            f"maximize {'' if sizes.pure else 'catch [t]: '}integral(h);",
        ]
        statements += guess(rng, [f"x = {size(x0)} + ({size(last)} - {size(x0)}) * tau"], [f"x = {size(0.01)}", "h = 0"])
        yield Case(
            name=f"fishery_{k}",
            text=problem(rng, "Fishery", "A fishery catches what it can.", statements),
            optimum=total * scale,
            # Both switches lie inside intervals.
            tolerance=grid.switches(2, factor=0.2 * max(1, g * T / 4) ** 2),
            why="most rapid approach to half the capacity",
        )
        k += 1
