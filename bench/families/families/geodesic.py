"""Shortest ways on a sphere, a cone and a cylinder.

Answer: the great circle; a straight line on the surface that is rolled out.
"""

import math

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, number, problem
from units import DEGREE


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        surface = rng.choice(("sphere", "sphere", "cone", "cylinder"))
        radius = sizes.draw("length", 1e-2, 1e7)
        unit = radius.unit
        angle = lambda degrees: number(float(degrees * DEGREE)) if sizes.pure else f"{number(float(degrees))} [deg]"
        grid = mesh(rng)
        across = round(rng.uniform(10, 150))
        if surface == "sphere":
            low, high = round(rng.uniform(-65, 65)), round(rng.uniform(-65, 65))
            length = radius.si * math.acos(
                math.sin(low * DEGREE) * math.sin(high * DEGREE) + math.cos(low * DEGREE) * math.cos(high * DEGREE) * math.cos(across * DEGREE)
            )
            first, names = "lat", ("lat", "lon")
            begin, end = angle(low), angle(high)
            mark = sizes.mark("deg")
            rates = ("radius * der(lat)", "radius * cos(lat) * der(lon)")
            constants = [f"param radius = {radius};"]
            poor = ["lat = 0"]
        else:
            first, names = "s", ("s", "lon")
            s0, s1 = radius, sizes.write("length", radius.si * rng.uniform(0.3, 3), unit, 3)
            begin, end = str(s0), str(s1)
            mark = str(unit)
            if surface == "cone":
                half = round(rng.uniform(10, 60))
                rolled = across * DEGREE * math.sin(half * DEGREE)
                length = math.sqrt(s0.si**2 + s1.si**2 - 2 * s0.si * s1.si * math.cos(rolled))
                constants = [f"param half = {angle(half)};"]
                rates = ("der(s)", "s * sin(half) * der(lon)")
            else:
                length = math.hypot(s1.si - s0.si, radius.si * across * DEGREE)
                constants = [f"param radius = {radius};"]
                rates = ("der(s)", "radius * der(lon)")
            poor = [f"s = 3 * {s0}"]
        speed = sizes.write("speed", length / 10 ** rng.uniform(-1, 5), digits=2)
        T = length / speed.si
        goal = rng.choice(("time", "energy"))
        statements = [
            *constants,
            f"initial {{ {first} == {begin};  lon == 0; }}",
            f"final {{ {first} == {end};  lon == {angle(across)}; }}",
        ]
        square = f"({rates[0]})^2 + ({rates[1]})^2"
        line = [f"{first} = {begin} + ({end} - ({begin})) * tau", f"lon = {angle(across)} * tau"]
        if goal == "energy":
            seconds = sizes.write("time", T, digits=2)
            statements += [
                f"duration T = {seconds};",
                f"minimize integral({square});",
                f"output {names[0]} {mark}, lon {sizes.mark('deg')}: spline(order = {grid.points + 1}, intervals = {grid.intervals});",
            ]
            optimum = length**2 / seconds.si
            power = 2 * grid.points
        else:
            shown = sizes.unit("time", T)
            statements += [
                f"duration T in {sizes.bounds('time', T)};",
                f"param speed = {speed};",
                f"minimize {'time ' + str(shown) + ': ' if shown.symbol else ''}T;",
                f"state {names[0]} {mark}, lon {sizes.mark('deg')};",
                f"input north {speed.unit}, east {speed.unit};",
                block("dynamics", [f"{rates[0]} == north", f"{rates[1]} == east"]),
                "trajectory { north^2 + east^2 <= speed^2; }",
                grid.statement,
            ]
            line.append(f"T = {sizes.write('time', T, digits=1)}")
            optimum = T / shown.si
            power = grid.points
        statements += guess(rng, line, poor)
        yield Case(
            name=f"geodesic_{k}",
            text=problem(rng, "Geodesic", f"The shortest way on a {surface}.", statements),
            optimum=optimum,
            # The bearing turns by less than a full turn; a way over high latitudes turns within a part of it.
            tolerance=1e-6 + (2 * math.pi / grid.intervals / 2) ** power,
            why=f"straight on the {surface}",
        )
