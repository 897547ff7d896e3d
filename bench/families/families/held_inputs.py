"""Linear systems with inputs that are held in each interval: finite programs, solved at once.

Answer: the state at the end is A^n x0 + sum A^k B u (zero-order hold, by the exponential of a matrix). The least energy is
d^T (C C^T)^-1 d, the least sum of magnitudes and the least peak are linear programs (scipy).
"""

import numpy as np
from scipy.linalg import expm
from scipy.optimize import linprog

from case import Case
from spell import draw, number, numbers, objective, problem, rounded
from units import unit


def cases(rng, count):
    index = 0
    while index < count:
        clock, second = unit(rng, "time")
        n = rng.randint(2, 4)
        steps = rng.randint(n + 2, 20)
        total = draw(rng, 0.5, 5)
        matrix = np.array([[rounded(rng.gauss(0, 0.6), 2) for _ in range(n)] for _ in range(n)])
        b = np.array([rounded(rng.gauss(0, 1), 2) for _ in range(n)])
        size = draw(rng, 1e-4, 1e4, 2)
        start = np.array([rounded(size * rng.gauss(0, 1), 3) for _ in range(n)])
        goal_at = np.array([rounded(size * rng.gauss(0, 1), 3) for _ in range(n)]) * rng.choice([0, 1])
        step = total / steps
        hold = expm(np.block([[matrix, b[:, None]], [np.zeros((1, n + 1))]]) * step)
        a_step, b_step = hold[:n, :n], hold[:n, n]
        columns = [b_step]
        for _ in range(steps - 1):
            columns.append(a_step @ columns[-1])
        control = np.array(columns[::-1]).T
        rest = goal_at - np.linalg.matrix_power(a_step, steps) @ start
        kind = ["energy", "fuel", "peak"][index % 3]
        extra = ""
        if kind == "energy":
            best = float(rest @ np.linalg.solve(control @ control.T, rest)) * step
            expression, symbol, factor = "integral(u^2)", f"1/{clock}", 1 / second
        elif kind == "fuel":
            peak = 3 * float(np.max(np.abs(np.linalg.pinv(control) @ rest)))
            peak = rounded(peak, 3)
            split = linprog(np.ones(2 * steps), A_eq=np.hstack([control, -control]), b_eq=rest, bounds=(0, peak))
            best = split.fun * step
            extra = f"trajectory {{ abs(u) <= {number(peak)} [1/{clock}]; }}"
            expression, symbol, factor = "integral(abs(u))", "", 1.0
        else:
            rows = np.vstack([np.eye(steps), -np.eye(steps)])
            split = linprog(
                [0] * steps + [1],
                A_ub=np.hstack([rows, -np.ones((2 * steps, 1))]),
                b_ub=np.zeros(2 * steps),
                A_eq=np.hstack([control, np.zeros((n, 1))]),
                b_eq=rest,
                bounds=(None, None),
            )
            best = split.fun
            extra = f"variable peak [1/{clock}];\ntrajectory {{ max(u, -u) <= peak; }}"
            expression, symbol, factor = "peak", f"1/{clock}", 1 / second
        if kind != "energy" and split.status:
            # The start cannot be left with this input: another one is drawn.
            continue
        rows_text = numbers(matrix)
        minimize, worth = objective(rng, "minimize", "cost", expression, symbol, factor)
        # The input is a rate, so that the state has no unit.
        text = problem(
            rng,
            "Held",
            "A system with an input that is held.",
            [
                f"duration T = {number(total)} [{clock}];",
                f"param A[{n}, {n}] = {rows_text} [1/{clock}];",
                f"param B[{n}] = {numbers(b)};",
                f"state x[{n}];",
                f"input u [1/{clock}]: held;",
                f"collocation gauss(points = {rng.choice([4, 5])}, intervals = {steps});",
                "dynamics { der(x) == A * x + B * u; }",
                f"initial {{ x == {numbers(start)}; }}",
                f"final {{ x == {numbers(goal_at)}; }}",
                extra,
                minimize,
            ],
        )
        yield Case(f"held_inputs_{index}", text, best * worth, 1e-5, why=f"{kind}, {n} states, {steps} steps")
        index += 1
