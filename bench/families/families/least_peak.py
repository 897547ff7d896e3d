"""The least maximum: of a derivative of a move, of its speed, of a polynomial.

Answer: the least peak of derivative n from rest to rest is 4^(n-1) (n-1)! d / T^n (perfect splines); with bounded
acceleration the least top speed follows from the trapezium d = v (T - v / a); the least peak of a monic polynomial of
degree n on an interval of length L is 2 (L/4)^n (Chebyshev).
"""

import math

from case import Case
from meshes import mesh
from spell import draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        way, total = draw(rng, 1e-2, 1e3), draw(rng, 1e-2, 1e2)
        kind = ["peak", "speed", "monic", "peak"][index % 4]
        grid = mesh(rng, 10, 48, least=3)
        tolerance = 2e-3 + 10 / grid.intervals**2
        x = f"[{length}]"
        statements = [f"duration T = {number(total)} [{clock}];"]
        if kind == "peak":
            n = rng.randint(2, 5)
            best = 4 ** (n - 1) * math.factorial(n - 1) * way / total**n
            rate = f"{length}/{clock}^{n}"
            rest = "  ".join(f"der(x, {k}) == 0;" for k in range(1, n))
            minimize, worth = objective(rng, "minimize", "peak", "top", rate, metre / second**n)
            top = (
                f"variable top in 0 .. {number(best * 100)} [{rate}];" if rng.random() < 0.4 else f"variable top [{rate}];"
            )
            statements += [
                f"output x {x}: spline(order = {n + 2}, intervals = {grid.intervals}, smoothness = {n});",
                top,
                grid.statement,
                minimize,
                f"initial {{ x == 0;  {rest} }}",
                f"final {{ x == {number(way)} {x};  {rest} }}",
                rng.choice(
                    [f"trajectory {{ abs(der(x, {n})) <= top; }}", f"trajectory {{ -top <= der(x, {n}) <= top; }}"]
                ),
            ]
        elif kind == "speed":
            force = rounded(4 * way / total**2 * draw(rng, 1.1, 20), 4)
            best = force / 2 * (total - math.sqrt(total**2 - 4 * way / force))
            minimize, worth = objective(rng, "minimize", "speed", "top", f"{length}/{clock}", metre / second)
            statements += [
                f"state x {x}, v [{length}/{clock}];",
                f"input a in -{number(force)} .. {number(force)} [{length}/{clock}^2];",
                f"variable top [{length}/{clock}];",
                grid.statement,
                minimize,
                "dynamics { der(x) == v;  der(v) == a; }",
                "initial { x == 0;  v == 0; }",
                f"final {{ x == {number(way)} {x};  v == 0; }}",
                "trajectory { v <= top; }",
            ]
        else:
            n = rng.randint(2, 6)
            best = 2 * (total / 4) ** n
            tolerance = 5e-3
            minimize, worth = objective(rng, "minimize", "height", "top", f"{clock}^{n}", second**n)
            statements += [
                f"output p [{clock}^{n}]: spline(order = {n + 1}, intervals = 1);",
                f"variable top [{clock}^{n}];",
                f"collocation uniform(breakpoints = {rng.randint(101, 201)});",
                minimize,
                f"trajectory {{ -top <= p <= top; }}\ninitial {{ der(p, {n}) == {math.factorial(n)}; }}",
            ]
        text = problem(rng, "Peak", "The least maximum.", statements)
        yield Case(f"least_peak_{index}", text, best * worth, tolerance, why=kind)
