"""Shortest ways over surfaces that can be unrolled, and over a torus along its equators.

Answer: a cylinder and a cone unroll to a plane, there the way is straight; over a ridge z(x) that runs along y the way is
straight over the length of the profile; the inner equator of a torus is the shortest way between near points on it.
"""

import math

from scipy.integrate import quad

from case import Case
from meshes import mesh
from spell import draw, number, objective, problem, rounded
from units import unit


def profile(height, size):
    """Length over the ridge height * exp(-(x / size)^2), from -2 to 2 sizes."""

    def rate(x):
        return math.hypot(1, -height * 2 * x / size**2 * math.exp(-((x / size) ** 2)))

    return 2 * quad(rate, 0, 2 * size, epsabs=1e-12, epsrel=1e-12)[0]


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        size = draw(rng, 1e-2, 1e3)
        kind = ["cylinder", "cone", "ridge", "torus"][index % 4]
        grid = mesh(rng, 6, 24, least=4)
        place = f"[{length}]"
        tolerance = 1e-5
        if kind == "cylinder":
            turn, rise = draw(rng, 20, 340), rounded(size * draw(rng, 0.1, 10), 3)
            best = math.hypot(size * math.radians(turn), rise)
            statements = [
                f"output phi [1], z {place}: spline(order = 4, intervals = {grid.intervals});",
                f"let p[3] {place} = (R * cos(phi), R * sin(phi), z);",
                "initial { phi == 0;  z == 0; }",
                f"final {{ phi == {number(turn)} [deg];  z == {number(rise)} {place}; }}",
            ]
        elif kind == "cone":
            half = draw(rng, 10, 60)
            sine = math.sin(math.radians(half))
            turn = draw(rng, 20, min(150, 150 / sine) * 0.9)
            other = rounded(size * draw(rng, 0.5, 2), 4)
            angle = math.radians(turn) * sine
            best = math.sqrt(size**2 + other**2 - 2 * size * other * math.cos(angle))
            statements = [
                f"output phi [1], s {place}: spline(order = 5, intervals = {grid.intervals});",
                f"param half = {number(half)} [deg];",
                f"let p[3] {place} = (s * sin(half) * cos(phi), s * sin(half) * sin(phi), s * cos(half));",
                "initial { phi == 0;  s == R; }",
                f"final {{ phi == {number(turn)} [deg];  s == {number(other)} {place}; }}",
                f"guess {{ phi = {number(turn)} [deg] * tau;  s = R + ({number(other)} {place} - R) * tau; }}",
            ]
        elif kind == "ridge":
            height, aside = rounded(size * draw(rng, 0.05, 0.6), 3), rounded(size * draw(rng, 0.1, 3), 3)
            across = profile(height, size)
            best = math.hypot(across, aside)
            statements = [
                f"output x, y {place}: spline(order = 5, intervals = {grid.intervals});",
                f"let p[3] {place} = (x, y, {number(height)} {place} * exp(-(x / R)^2));",
                "initial { x == -2 * R;  y == 0; }",
                f"final {{ x == 2 * R;  y == {number(aside)} {place}; }}",
            ]
            tolerance = 1e-3
        else:
            big, turn = rounded(size * draw(rng, 1.5, 5), 4), draw(rng, 20, 170)
            best = (big - size) * math.radians(turn)
            statements = [
                f"output phi, theta: spline(order = 4, intervals = {grid.intervals});",
                f"param big = {number(big)} {place};",
                f"let rho {place} = big - R * cos(theta);",
                f"let p[3] {place} = (rho * cos(phi), rho * sin(phi), R * sin(theta));",
                "initial { phi == 0;  theta == 0; }",
                f"final {{ phi == {number(turn)} [deg];  theta == 0; }}",
            ]
        by_energy = rng.random() < 0.4
        expression = "integral(norm(der(p))^2) * T" if by_energy else "integral(norm(der(p)))"
        factor, symbol = (metre**2, f"{length}^2") if by_energy else (metre, length)
        clock = rng.choice(["s", "min"])
        statements += [
            f"param R = {number(size)} {place};",
            f"duration T = {number(draw(rng, 0.1, 10))} [{clock}];",
            grid.statement,
        ]
        minimize, worth = objective(rng, "minimize", "way", expression, symbol, factor)
        text = problem(rng, "Surface", "The shortest way over a surface.", statements + [minimize])
        yield Case(f"embedded_surfaces_{index}", text, (best**2 if by_energy else best) * worth, tolerance, why=kind)
