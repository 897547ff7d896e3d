"""A rocket in vacuum: the least fuel for a change of speed in free space, the greatest height in constant gravity with
a given mass of fuel, or the least fuel for a given height.

Answer: Tsiolkovsky's equation; in gravity full thrust at once and a coast (Goddard's problem without drag).
"""

import math

from scipy.optimize import brentq

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, problem


def apogee(fuel, mass, thrust, exhaust, g):
    """The height at which the rocket stops, and when; all fuel burnt at full thrust."""
    flow = thrust / exhaust
    burn, rest = fuel / flow, mass - fuel
    speed = exhaust * math.log(mass / rest) - g * burn
    height = exhaust * (burn - rest / flow * math.log(mass / rest)) - g * burn**2 / 2
    return height + speed**2 / (2 * g), burn + speed / g


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.2)
        mass = sizes.draw("mass", 0.05, 1e6)
        exhaust = sizes.draw("speed", 300, 5000)
        fuel = sizes.write("mass", mass.si * rng.uniform(0.05, 0.85), mass.unit, 3)
        g = sizes.write("acceleration", rng.choice((9.81, 1.62, 3.71)), digits=3)
        thrust = sizes.write("force", mass.si * g.si * rng.uniform(1.2, 10), digits=3)
        goal = rng.choice(("speed", "height", "fuel"))
        grid = mesh(rng)
        height, T = apogee(fuel.si, mass.si, thrust.si, exhaust.si, g.si)
        change = exhaust.si * math.log(mass.si / (mass.si - fuel.si))
        if goal == "speed":
            T = rng.uniform(1.5, 4) * fuel.si * exhaust.si / thrust.si
        statements = [
            f"param exhaust = {exhaust};",
            f"input F in 0 .. {thrust};",
            f"duration T in {sizes.bounds('time', T)};" if goal != "speed" else f"duration T = {sizes.write('time', T, digits=2)};",
        ]
        length, speed = sizes.unit("length", height), sizes.unit("speed", change)
        about = lambda share: sizes.write("mass", share * mass.si, mass.unit, 3)
        poor = [f"v = {sizes.write('speed', 10 * change, digits=1)}", f"m = {about(0.1)}"]
        if goal == "speed":
            wanted = sizes.write("speed", change, speed, 4)
            statements += [
                f"state v {speed}, m {mass.unit};",
                "dynamics { m * der(v) == F;  der(m) == -F / exhaust; }",
                f"initial {{ v == 0;  m == {mass}; }}",
                f"final {{ v == {wanted}; }}",
                rng.choice((f"minimize fuel {mass.unit}: initial(m) - final(m);", f"minimize fuel {mass.unit}: integral(F) / exhaust;")),
                grid.statement,
            ]
            optimum, tolerance = mass.si * -math.expm1(-wanted.si / exhaust.si) / mass.unit.si, grid.switches(1, factor=0.02)
            line = [f"v = {wanted} * tau", f"m = {mass} - {fuel} * tau"]
        else:
            motion = "der(h) == v;  der(v) == F / m - g;  der(m) == -F / exhaust;"
            statements += [f"param g = {g};", f"state h {length}, v {speed}, m in 0 .. {mass};", f"dynamics {{ {motion} }}"]
            line = [f"h = {sizes.write('length', height, digits=1)} * tau", f"m = {mass} - {fuel} * tau", f"T = {sizes.write('time', T, digits=1)}"]
            phased = rng.random() < 0.4
            if phased:
                burn = fuel.si * exhaust.si / thrust.si
                statements = [one for one in statements if not one.startswith(("duration", "input"))]
                statements = [one.replace("F", "thrust") if one.startswith("dynamics") else one for one in statements]
                statements += [
                    f"phase boost {{ duration in {sizes.bounds('time', burn)};  let thrust = {thrust}; }}",
                    f"phase coast after boost {{ duration in {sizes.bounds('time', T - burn)};  let thrust = 0{' [N]' if not sizes.pure else ''}; }}",
                ]
                line = line[:-1]
            tolerance = 1e-6 + 0.05 * (1 / grid.intervals) ** (2 * grid.points) if phased else grid.switches(1, factor=2)
            begin = ["h == 0", "v == 0", f"m == {mass}"]
            if goal == "height":
                statements += [
                    f"maximize {'height ' + str(length) + ': ' if length.symbol else ''}final(h);",
                    block("initial", begin),
                    f"final {{ m >= {mass} - {fuel}; }}",
                ]
                optimum = height / length.si
            else:
                wanted = sizes.write("length", height, length, 4)
                best = brentq(lambda one: apogee(one, mass.si, thrust.si, exhaust.si, g.si)[0] - wanted.si, 1e-3 * fuel.si, 0.97 * mass.si, xtol=1e-14 * mass.si)
                statements += [
                    f"minimize fuel {mass.unit}: {mass} - final(m);",
                    block("initial", begin),
                    block("final", [f"h == {wanted}"]),
                ]
                optimum = best / mass.unit.si
            statements.append(grid.statement)
        statements += guess(rng, line, poor)
        text = problem(rng, "Rocket", "A rocket in vacuum.", statements).replace("fuel :", "fuel:")
        yield Case(name=f"rocket_{k}", text=text, optimum=optimum, tolerance=tolerance, why=f"best {goal}, full thrust and coast")
