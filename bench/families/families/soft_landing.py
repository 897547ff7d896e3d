"""A soft landing on one engine with the least fuel, mass constant or falling.

Answer: coast, then full thrust (Meditch 1964); the switch lies where the braking curve is met.
"""

import math

from scipy.optimize import brentq

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, problem


def light(h0, v0, g, a):
    """The integral of the acceleration by thrust, and the time, of a mass that stays."""
    switch = (v0**2 + 2 * g * h0) / (2 * a)
    speed = math.sqrt(2 * (a - g) * switch)
    return a * speed / (a - g), (v0 + speed) / g + speed / (a - g)


def heavy(h0, v0, g, thrust, exhaust, mass):
    """The fuel, and the time."""
    flow = thrust / exhaust

    def miss(burn):
        rest = mass - flow * burn
        speed = exhaust * math.log(mass / rest) - g * burn
        switch = speed * burn - exhaust * (burn - rest / flow * math.log(mass / rest)) + g * burn**2 / 2
        return switch + (speed**2 - v0**2) / (2 * g) - h0

    burn = brentq(miss, 0, 0.999 * mass / flow, xtol=1e-15 * mass / flow, rtol=1e-14)
    speed = exhaust * math.log(mass / (mass - flow * burn)) - g * burn
    return flow * burn, (v0 + speed) / g + burn


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.2)
        g = sizes.write("acceleration", rng.choice((1.62, 3.71, 9.81, 0.01)), digits=3)
        h0 = sizes.draw("length", 1, 1e5)
        ratio = rng.uniform(1.3, 6)
        # Down by less than what can still be braked, or up.
        most = math.sqrt(2 * (ratio - 1) * g.si * h0.si)
        v0 = sizes.write("speed", most * rng.choice((0, rng.uniform(-0.85, 0.3))), sizes.unit("speed", most), 3)
        grid = mesh(rng)
        speed = sizes.unit("speed", most)
        falling = rng.random() < 0.5
        statements = [
            f"param g = {g};",
            grid.statement,
            block("final", ["h == 0", "v == 0"]),
        ]
        start = [f"h == {h0}", "v == 0" if v0.number == 0 else f"v == {v0}"]
        line = [f"h = {h0} * (1 - tau)"]
        if falling:
            mass = sizes.draw("mass", 0.1, 1e5)
            thrust = sizes.write("force", mass.si * g.si * ratio, digits=3)
            exhaust = sizes.write("speed", max(1000, 3 * most) * rng.uniform(1, 3), digits=2)
            fuel, T = heavy(h0.si, v0.si, g.si, thrust.si, exhaust.si, mass.si)
            unit = mass.unit
            statements += [
                f"param exhaust = {exhaust};",
                f"state h {h0.unit}, v {speed}, m {unit};",
                f"input F in 0 .. {thrust};",
                "dynamics { der(h) == v;  der(v) == F / m - g;  der(m) == -F / exhaust; }",
                block("initial", [*start, f"m == {mass}"]),
                f"minimize {'fuel ' + str(unit) + ': ' if unit.symbol else ''}{rng.choice((f'{mass} - final(m)', 'integral(F) / exhaust'))};",
            ]
            line.append(f"m = {mass}")
            optimum = fuel / unit.si
        else:
            most_push = sizes.write("acceleration", g.si * ratio, digits=3)
            total, T = light(h0.si, v0.si, g.si, most_push.si)
            statements += [
                f"state h {h0.unit}, v {speed};",
                f"input u in 0 .. {most_push};",
                "dynamics { der(h) == v;  der(v) == u - g; }",
                block("initial", start),
                f"minimize {'push ' + str(speed) + ': ' if speed.symbol else ''}integral(u);",
            ]
            optimum = total / speed.si
        statements.append(f"duration T in {sizes.bounds('time', T)};")
        statements += guess(
            rng,
            [*line, f"T = {sizes.write('time', T, digits=1)}"],
            [f"h = {h0}", f"T = {sizes.write('time', T * rng.choice((0.1, 10)), digits=1)}"],
        )
        yield Case(
            name=f"soft_landing_{k}",
            text=problem(rng, "Landing", "A lander sets down softly with the least fuel.", statements),
            optimum=optimum,
            tolerance=grid.switches(1, factor=0.5),
            why="coast, then full thrust",
        )
