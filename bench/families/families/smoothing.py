"""The likeliest motion behind noisy measurements: random walks and their integrals, at once by least squares.

Answer: a motion whose derivative of order m is white noise of density q has the covariance q times the integral of
(s-u)^(m-1) (t-u)^(m-1) / (m-1)!^2; with a free start, generalised least squares with polynomials of degree m-1 gives the
least half of the weighted squares (Wahba, Spline Models for Observational Data, 1990). Curves through a fit are natural
splines of order 2 m.
"""

import numpy as np
from numpy.polynomial import polynomial

from case import Case
from spell import draw, number, numbers, problem, rounded
from units import unit


def covariance(order, s, t):
    """Of two values of the noise integrated `order` times from 0."""
    first = min(s, t)
    factor = polynomial.Polynomial([s, -1]) ** (order - 1) * polynomial.Polynomial([t, -1]) ** (order - 1)
    whole = factor.integ()
    scale = 1.0 if order < 3 else 4.0
    return (whole(first) - whole(0)) / scale


def least(order, times, seen, sigma, density):
    """Half of the squares in all."""
    matrix = density * np.array([[covariance(order, s, t) for t in times] for s in times]) + sigma**2 * np.eye(
        len(times)
    )
    trend = np.vander(times, order, increasing=True)
    inverse = np.linalg.inv(matrix)
    rest = inverse - inverse @ trend @ np.linalg.solve(trend.T @ inverse @ trend, trend.T @ inverse)
    return 0.5 * float(np.array(seen) @ rest @ np.array(seen))


def cases(rng, count):
    for index in range(count):
        clock, _ = unit(rng, "time")
        order = rng.choice([1, 2, 2, 3])
        n = rng.randint(order + 2, 12)
        refine = rng.choice([1, 2, 3])
        step = draw(rng, 0.01, 100, 2)
        size = draw(rng, 1e-4, 1e4)
        sigma = draw(rng, 0.02, 0.5)
        noise = draw(rng, 0.05, 2)
        shape = [rng.gauss(0, 1) * k + rng.gauss(0, 0.3) for k in range(n + 1)]
        kept = sorted(rng.sample(range(n + 1), max(order + 2, n - 2)))
        seen = [rounded(size * shape[k], 4) for k in kept]
        sigma = rounded(sigma * size, 3)
        root = rounded(noise * size / step ** (order - 0.5), 3)
        best = least(order, [step * k for k in kept], seen, sigma, root**2)
        kept_times = [step * k for k in kept]
        count_kept = len(kept)
        statements = [
            f"duration T = {number(step * n)} [{clock}];",
            f"const time[{count_kept}] = {numbers(kept_times)} [{clock}];",
            f"param seen[{count_kept}] = {numbers(seen)} [m];",
            f"param spread = {number(sigma)} [m];",
        ]
        drive = f"der(x, {order})"
        if rng.random() < 0.5:
            statements.append(f"output x [m]: spline(order = {2 * order}, intervals = {n * refine});")
            statements.append(f"collocation gauss(points = {max(3, order + 1)});")
        else:
            names = ["x", "v", "a"][:order]
            units = ["[m]", f"[m/{clock}]", f"[m/{clock}^2]"][:order]
            statements.append("state " + ", ".join(f"{name} {u}" for name, u in zip(names, units)) + ";")
            statements.append(f"input w [m/{clock}^{order}];")
            statements.append(
                "dynamics { " + "  ".join(f"der({a}) == {b};" for a, b in zip(names, names[1:] + ["w"])) + " }"
            )
            statements.append(f"collocation gauss(points = {order + 1}, intervals = {n * refine});")
            drive = "w"
        statements.append(
            f"minimize roughness: 0.5 * integral(({drive} / {number(root)} [m/{clock}^{order}])^2) / 1 [{clock}];"
        )
        if rng.random() < 0.6:
            statements.append(
                f"measure {{ for i in 1 .. {count_kept} {{ at(time[i], x) == seen[i] sigma {number(sigma)} [m]; }} }}"
            )
        else:
            statements.append(
                f"minimize fit: 0.5 * sum(i in 1 .. {count_kept}, ((at(time[i], x) - seen[i]) / spread)^2);"
            )
        text = problem(rng, "Smoother", "A track from its noisy fixes.", statements)
        yield Case(f"smoothing_{index}", text, best, 1e-6, why=f"order {order}, {count_kept} fixes")
