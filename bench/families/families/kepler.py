"""Free motion about a planet: times from Kepler's equation, falls along a radius, and periods.

Answer: t = sqrt(a^3 / mu) (E - e sin E) from the pericentre; the energy, the momentum and the way back to the start say
what the equations say already. A body that falls along a radius takes a time in closed form.
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time", "s", "min", "h")
        length, metre = unit(rng, "length", "km", "m", "Mm")
        # In units of the spec.
        mu = draw(rng, 1e2, 1e6, 6) * 1e9 / metre**3 * second**2
        mu = rounded(mu, 6)
        near = rounded(draw(rng, 1e2, 1e5, 4) * 1e3 / metre, 6)
        eccentricity = rng.choice([0.0, draw(rng, 0.01, 0.7, 2)])
        axis = near / (1 - eccentricity)
        motion = math.sqrt(mu / axis**3)
        speed = math.sqrt(mu * (1 + eccentricity) / near)
        grid = mesh(rng, 14, 36, least=4)
        kind = ["anomaly", "period", "fall", "apocentre"][index % 4]
        mu_text = f"param mu = {number(mu)} [{length}^3/{clock}^2];"
        plane = [
            f"state x, y [{length}], vx, vy [{length}/{clock}];",
            f"let r [{length}] = hypot(x, y);",
            "dynamics { der(x) == vx;  der(y) == vy;  der(vx) == -mu * x / r^3;  der(vy) == -mu * y / r^3; }",
            f"initial {{ x == {number(near)} [{length}];  y == 0;  vx == 0;  vy == {speed:.16g} [{length}/{clock}]; }}",
        ]
        if kind == "anomaly":
            eccentric = draw(rng, 0.3, 2.8)
            best = (eccentric - eccentricity * math.sin(eccentric)) / motion
            true = 2 * math.atan(math.sqrt((1 + eccentricity) / (1 - eccentricity)) * math.tan(eccentric / 2))
            statements = [
                f"state r [{length}], theta [1], vr [{length}/{clock}], h [{length}^2/{clock}];",
                "dynamics { der(r) == vr;  der(theta) == h / r^2;  der(vr) == h^2 / r^3 - mu / r^2;  der(h) == 0; }",
                f"initial {{ r == {number(near)} [{length}];  theta == 0;  vr == 0;  h == {near * speed:.16g} [{length}^2/{clock}]; }}",
                f"final {{ theta == {true:.16g}; }}",
            ]
            guess = f"guess {{ r = {number(near)} [{length}];  theta = {number(true)} * tau;  h = {near * speed:.16g} [{length}^2/{clock}];  T = {number(best * draw(rng, 0.6, 1.6))} [{clock}]; }}"
        elif kind == "period":
            best = 2 * math.pi / motion
            statements = plane + ["periodic x, y, vx, vy;"]
            guess = (
                f"guess {{ x = {number(near)} [{length}] * cos(2 * pi * tau);  y = {number(near)} [{length}] * sin(2 * pi * tau);"
                f"  T = {number(best * draw(rng, 0.8, 1.2))} [{clock}]; }}"
            )
        elif kind == "fall":
            high = near
            low = rounded(high * draw(rng, 0.05, 0.9), 4)
            share = low / high
            best = math.sqrt(high**3 / (2 * mu)) * (math.acos(math.sqrt(share)) + math.sqrt(share * (1 - share)))
            statements = [
                f"state r [{length}], v [{length}/{clock}];",
                "dynamics { der(r) == v;  der(v) == -mu / r^2; }",
                f"initial {{ r == {number(high)} [{length}];  v == 0; }}",
                f"final {{ r == {number(low)} [{length}]; }}",
            ]
            guess = ""
        else:
            best = math.pi / motion
            statements = plane + [f"final {{ y == 0;  x <= -{number(near * 0.5)} [{length}]; }}"]
            if rng.random() < 0.5:
                statements.append(f"trajectory {{ x * vy - y * vx == {near * speed:.16g} [{length}^2/{clock}]; }}")
            guess = (
                f"guess {{ (x, y) through ({number(near)}, 0), (0, {number(near)}), (-{number(near)}, 0) [{length}];"
                f"  T = {number(best * draw(rng, 0.7, 1.4))} [{clock}]; }}"
            )
        low, high = number(rounded(best * 0.55, 2)), number(rounded(best * 1.45, 2))
        duration = (
            f"duration T in {low} .. {high} [{clock}];" if kind != "fall" else f"duration T in {bounds(rng, best, clock)};"
        )
        minimize, worth = objective(rng, "minimize", "time", "T", clock, second)
        text = problem(
            rng,
            "Orbit",
            "A free motion about a planet.",
            statements + [mu_text, grid.statement, guess, duration, minimize],
        )
        yield Case(f"kepler_{index}", text, best * worth, 1e-3, why=f"{kind}, e = {eccentricity}")
