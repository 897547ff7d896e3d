"""Linear quadratic regulators over a finite horizon, of one to five states and one or two inputs.

Answer: x' P(0) x with the solution P of the Riccati equation, by the exponential of the Hamiltonian matrix.
"""

import numpy as np
from scipy.linalg import expm

from case import Case
from meshes import Mesh, mesh
from spell import block, guess, number, numbers, problem


def riccati(A, B, Q, R, last, T):
    """P(0), and the fastest rate of the Hamiltonian system; in steps, so that exponentials stay small."""
    n = len(A)
    hamiltonian = np.block([[A, -B @ np.linalg.solve(R, B.T)], [-Q, -A.T]])
    fastest = np.abs(np.linalg.eigvals(hamiltonian)).max()
    steps = max(1, int(np.ceil(fastest * T)))
    step = expm(-hamiltonian * T / steps)
    P = last
    for _ in range(steps):
        pair = step @ np.vstack([np.eye(n), P])
        P = pair[n:] @ np.linalg.inv(pair[:n])
    return P, fastest


def cases(rng, count):
    for k in range(count):
        n = rng.choice((2, 3, 4, 5))
        m = rng.choice((1, 2))
        draw = lambda rows, columns: np.array([[round(rng.gauss(0, 1), 2) for _ in range(columns)] for _ in range(rows)])
        A, B = draw(n, n), draw(n, m)
        q = np.array([round(10 ** rng.uniform(-2, 2), 3) for _ in range(n)])
        r = np.array([round(10 ** rng.uniform(-2, 1), 3) for _ in range(m)])
        last = np.array([rng.choice((0.0, round(10 ** rng.uniform(-1, 2), 2)))] * n)
        T = round(10 ** rng.uniform(-0.5, 1), 2)
        begin = np.array([round(rng.uniform(-1, 1) * 10 ** rng.uniform(-1, 3), 2) for _ in range(n)])
        P, fastest = riccati(A, B, np.diag(q), np.diag(r), np.diag(last), T)
        grid = mesh(rng)
        # Half a time constant an interval, so that the mesh can follow.
        grid = Mesh(max(grid.intervals, int(np.ceil(2 * fastest * T))), grid.points)
        form = rng.choice(("matrices", "written out"))
        statements = [f"duration T = {number(T)};", grid.statement]
        if form == "matrices":
            statements += [
                f"param A[{n}, {n}] = {numbers(A)};",
                f"param B[{n}, {m}] = {numbers(B)};",
                f"param q[{n}] = {numbers(q)};",
                f"state x[{n}];",
                f"input u[1 .. {m}];",
                "dynamics { der(x) == A * x + B * u; }",
                f"initial {{ x == {numbers(begin)}; }}",
                f"minimize integral(dot(x, diagonal(q) * x) + {' + '.join(f'{number(one)} * u[{j + 1}]^2' for j, one in enumerate(r))});",
            ]
            if last[0]:
                statements.append(f"minimize {number(last[0])} * final(dot(x, x));")
            statements += guess(rng, ["x = 0"], [f"x = {number(round(1e3 * abs(begin).max()))}"])
        else:
            sides = [
                " + ".join(f"{number(A[i, j])} * x{j + 1}" for j in range(n)) + "".join(f" + {number(B[i, j])} * u{j + 1}" for j in range(m))
                for i in range(n)
            ]
            statements += [
                "state " + ", ".join(f"x{i + 1}" for i in range(n)) + ";",
                "input " + ", ".join(f"u{j + 1}" for j in range(m)) + ";",
                block("dynamics", [f"der(x{i + 1}) == {side}" for i, side in enumerate(sides)]),
                block("initial", [f"x{i + 1} == {number(one)}" for i, one in enumerate(begin)]),
                "minimize state: integral(" + " + ".join(f"{number(one)} * x{i + 1}^2" for i, one in enumerate(q)) + ");",
                "minimize input: integral(" + " + ".join(f"{number(one)} * u{j + 1}^2" for j, one in enumerate(r)) + ");",
            ]
            if last[0]:
                statements.append("minimize last: " + " + ".join(f"{number(last[0])} * final(x{i + 1})^2" for i in range(n)) + ";")
            statements += guess(rng, [f"x{i + 1} = {number(one)} * (1 - tau)" for i, one in enumerate(begin)], ["x1 = 1e5"])
        yield Case(
            name=f"lqr_{k}",
            text=problem(rng, "Regulator", "A linear system is regulated at the least quadratic cost.", statements),
            optimum=float(begin @ P @ begin),
            tolerance=1e-6 + 0.1 * (fastest * T / grid.intervals) ** (2 * grid.points),
            why="Riccati equation",
        )
