"""Motions that equations decide alone: pendulum, epidemic, stiff chains, heat along a rod.

Answer: a pendulum falls from rest to the bottom in sqrt(l / g) K(sin(a / 2)); an epidemic's peak is i + s - (1 + log(R s)) / R;
chains of reactions and rods are exponentials of matrices.
"""

import math

import numpy as np
from scipy.linalg import expm
from scipy.special import ellipk

from case import Case
from meshes import mesh
from spell import draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time", "s", "min", "h", "day", "ms")
        kind = ["pendulum", "epidemic", "stiff", "rod"][index % 4]
        grid = mesh(rng, 10, 40, least=3)
        tolerance, sense, symbol, factor = 1e-4, "minimize", "", 1.0
        if kind == "pendulum":
            angle, ratio = draw(rng, 2, 175), draw(rng, 1e-2, 1e2)
            best = float(ellipk(math.sin(math.radians(angle) / 2) ** 2)) / math.sqrt(ratio)
            statements = [
                f"state q [1], w [1/{clock}];",
                f"param k = {number(ratio)} [1/{clock}^2];",
                "dynamics { der(q) == w;  der(w) == -k * sin(q); }",
                f"initial {{ q == {number(angle)} [deg];  w == 0; }}",
                "final { q == 0; }",
                f"duration T in {number(rounded(best * 0.5, 2))} .. {number(rounded(best * 1.8, 2))} [{clock}];",
            ]
            expression, symbol, factor = "T", clock, second
        elif kind == "epidemic":
            spread, gamma, first = draw(rng, 1.3, 8), draw(rng, 1e-2, 1e2), draw(rng, 1e-4, 1e-1)
            best = 1 - (1 + math.log(spread * (1 - first))) / spread
            length = (math.log(1 / first) / (spread - 1) + 8) / gamma
            rates = f"param beta = {number(spread * gamma)} [1/{clock}];\nparam gamma = {number(gamma)} [1/{clock}];"
            statements = [
                "state S, I;",
                rates,
                "dynamics { der(S) == -beta * S * I;  der(I) == beta * S * I - gamma * I; }",
                f"initial {{ S == {number(1 - first)};  I == {number(first)}; }}",
            ]
            if rng.random() < 0.5:
                statements.append(f"duration T in 0 .. {number(rounded(length, 2))} [{clock}];")
                expression, sense = "final(I)", "maximize"
            else:
                statements += [
                    f"duration T = {number(rounded(length, 2))} [{clock}];",
                    "variable peak;",
                    "trajectory { I <= peak; }",
                ]
                expression = "peak"
            tolerance = 2e-2
        elif kind == "stiff":
            n = rng.randint(2, 5)
            rates = [draw(rng, 1e-2, 1e2) * rng.choice([1, 1, 1e3]) for _ in range(n)]
            total = draw(rng, 0.5, 3) / min(rates)
            total = rounded(total, 3)
            matrix = -np.diag(rates) + np.diag(rates[:-1], -1)
            at_end = expm(matrix * total)[:, 0]
            best = 1 - float(np.sum(at_end))
            names = [f"c{k}" for k in range(1, n + 1)] + ["made"]
            flows = [f"{number(rate)} [1/{clock}] * c{k + 1}" for k, rate in enumerate(rates)]
            rows = [f"der(c1) == -{flows[0]};"]
            rows += [
                f"der({names[k]}) == {flows[k - 1]}" + (f" - {flows[k]};" if k < n else ";") for k in range(1, n + 1)
            ]
            statements = [
                "state " + ", ".join(names) + ";",
                "dynamics {\n" + "\n".join("    " + row for row in rows) + "\n}",
                "initial { c1 == 1;  " + "  ".join(f"{name} == 0;" for name in names[1:]) + " }",
                f"duration T = {number(total)} [{clock}];",
            ]
            expression, sense, tolerance = "final(made)", "maximize", 1e-3
        else:
            n = rng.randint(3, 16)
            rate = draw(rng, 1e-2, 1e2)
            total = rounded(draw(rng, 0.05, 2) * n**2 / rate / 10, 3)
            hot = draw(rng, 1, 1000)
            matrix = rate * (np.diag([-2.0] * n) + np.diag([1.0] * (n - 1), 1) + np.diag([1.0] * (n - 1), -1))
            matrix[-1, -1] = -rate
            source = np.zeros(n)
            source[0] = rate * hot
            best = float((np.linalg.solve(matrix, (expm(matrix * total) - np.eye(n)) @ source))[-1])
            statements = [
                f"state u[{n}] [K];",
                f"param a = {number(rate)} [1/{clock}];",
                f"dynamics {{ for i in 1 .. {n} {{\n"
                f"    der(u[i]) == a * ((if i == 1 {{ {number(hot)} [K] }} else {{ u[i - 1] }}) - 2 * u[i] + (if i == {n} {{ u[i] }} else {{ u[i + 1] }}));\n}} }}",
                "initial { u == 0; }",
                f"duration T = {number(total)} [{clock}];",
            ]
            expression, symbol = f"final(u[{n}])", "K"
        sought, worth = objective(rng, sense, "what", expression, symbol, factor)
        text = problem(rng, "Motion", "A motion that its equations decide.", statements + [grid.statement, sought])
        yield Case(f"simulations_{index}", text, best * worth, tolerance, scale=1e-6 * abs(worth), why=kind)
