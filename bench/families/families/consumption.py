"""A household lives on its wealth, with logarithmic or power utility and a discount rate (Ramsey's problem).

Answer: consumption grows at the rate (r - rho) / s (Euler's equation); its start follows from the budget.
"""

import math

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import guess, number, problem, rounded


def integral(rate, T):
    """The integral of exp(rate t) up to T."""
    return math.expm1(rate * T) / rate if abs(rate * T) > 1e-12 else T


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.5)
        T = float(rng.choice((5, 20, 60)))
        r, rho = round(rng.uniform(0.005, 0.1), 4), round(rng.uniform(0.005, 0.1), 4)
        s = rng.choice((1.0, 0.5, 2.0, 3.0))
        wealth = rounded(10 ** rng.uniform(-1, 6), 2)
        left = rounded(wealth * rng.choice((0, rng.uniform(0, 0.8) * math.exp(r * T))), 2)
        growth = (r - rho) / s
        begin = (wealth - left * math.exp(-r * T)) / integral(growth - r, T)
        if s == 1:
            # The integral of exp(-rho t) (log c0 + growth t).
            ramp = (1 - math.exp(-rho * T) * (1 + rho * T)) / rho**2
            utility = math.log(begin) * integral(-rho, T) + growth * ramp
        else:
            utility = begin ** (1 - s) / (1 - s) * integral(growth * (1 - s) - rho, T)
        grid = mesh(rng, 5, 40)
        day, rate = sizes.mark("day"), sizes.mark("1/day")
        flow = "c" if sizes.pure else "c / 1 [1/day]"
        value = f"log({flow})" if s == 1 else (f"({flow})^{1 - s:g} / {1 - s:g}" if 1 - s > 0 else f"({flow})^({1 - s:g}) / ({1 - s:g})")
        statements = [
            f"duration T = {number(T)} {day}".rstrip() + ";",
            f"param r = {r!r} {rate}".rstrip() + ";",
            f"param rho = {rho!r} {rate}".rstrip() + ";",
            "state k;" if sizes.pure else "state k [1];",
            "input c in 0 ..;" if sizes.pure else "input c in 0 [1/day] ..;",
            grid.statement,
            "dynamics { der(k) == r * k - c; }",
            f"maximize {'' if sizes.pure else 'utility [day]: '}integral(exp(-rho * t) * {value});",
            f"initial {{ k == {number(wealth)}; }}",
            f"final {{ k {rng.choice(('==', '>='))} {number(left)}; }}",
        ]
        if not sizes.pure:
            statements.append("domain t [day];")
        about = rounded(wealth / T, 1)
        line = [f"c = {number(about)} {rate}".rstrip(), f"k = {number(wealth)} * (1 - tau)"]
        statements += guess(rng, line, [f"c = {number(10 * about)} {rate}".rstrip()])
        yield Case(
            name=f"consumption_{k}",
            text=problem(rng, "Household", "A household lives on its wealth.", statements),
            optimum=utility,
            tolerance=1e-6 + ((abs(growth) + r) * T / grid.intervals / 2) ** (2 * grid.points),
            scale=T * 0.1,
            why="Euler's equation",
        )
