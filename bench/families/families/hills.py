"""A train over hills, electric and without loss, with the least work for a given mean speed.

Answer: by Jensen's inequality the resistance c0 + c2 v^2 costs least at constant speed, whatever the hills; the work is
that and the rise.
"""

import math

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import guess, number, problem, rounded


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng)
        waves = rng.choice((0, 1, 3))
        way = sizes.write("length", 10 ** rng.uniform(3, 5.3), digits=3)
        time = sizes.write("time", way.si / rng.uniform(8, 40), digits=3)
        speed = way.si / time.si
        c0 = rounded(10 ** rng.uniform(-2.5, -1), 2)
        c2 = rounded(10 ** rng.uniform(-5, -3.5), 2)
        grade, mean = round(rng.uniform(0.001, 0.02), 4), round(rng.uniform(-0.003, 0.003), 4)
        work = way.si * (c0 + c2 * speed**2 + 9.81 * mean)
        grid = mesh(rng, max(8, 6 * waves), 80)
        shown = sizes.unit("speed", speed)
        slope = number(mean) + (f" + {grade} * sin(2 * pi * {waves} * s / S)" if waves else "")
        statements = [
            f"domain s {way.unit};",
            f"duration S = {way};",
            f"state v in 1 [m/s] .., clock {time.unit};",
            "input f [N/kg];",
            grid.statement,
            f"let slope = {slope};",
            f"let drag [N/kg] = {c0!r} [N/kg] + {c2!r} [1/m] * v^2;",
            rng.choice(("dynamics { v * der(v) == f - drag - 9.81 [m/s^2] * slope;  der(clock) == 1 / v; }", "dynamics { der(v) == (f - drag - 9.81 [m/s^2] * slope) / v;  v * der(clock) == 1; }")),
            "initial { clock == 0; }",
            rng.choice((f"final {{ clock == {time}; }}", f"final {{ clock <= {time}; }}")),
            rng.choice(("periodic v up to 0;", "temporal { initial(v) == final(v); }")),
            f"minimize work [{rng.choice(('J/kg', 'm^2/s^2'))}]: integral(f);",
        ]
        begin = sizes.write("speed", speed * 1.3, shown, 1)
        statements += guess(rng, [f"v = {begin}", f"clock = s / ({begin})"], [f"v = {sizes.write('speed', 5 * speed, shown, 1)}"])
        per_wave = 2 * math.pi * max(waves, 0.1) / grid.intervals
        yield Case(
            name=f"hills_{k}",
            text=problem(rng, "Train", "A train runs over hills with the least work.", statements),
            optimum=work,
            tolerance=1e-6 + 9.81 * grade * way.si / max(abs(work), 1.0) * (per_wave / 2) ** (2 * grid.points),
            scale=way.si * c0,
            why="constant speed",
        )
