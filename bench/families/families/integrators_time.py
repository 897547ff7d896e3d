"""From rest to rest in the least time with a bounded derivative of order 2 to 6, and S-curves of seven segments.

Answer: the bounded derivative is a perfect spline whose switches are Chebyshev's: bound = 4^(n-1) (n-1)! d / T^n. With
limits of jerk, acceleration and speed that are all reached, T = d/v + v/a + a/j.
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, _ = unit(rng, "length")
        clock, second = unit(rng, "time")
        way = draw(rng, 1e-3, 1e3)
        order = rng.randint(2, 6)
        curve = rng.random() < 0.35
        if curve:
            order = 3
            jerk, acceleration = draw(rng, 1e-2, 1e2), draw(rng, 1e-2, 1e2)
            speed = acceleration**2 / jerk * draw(rng, 1.2, 4)
            speed = rounded(speed, 3)
            way = rounded(speed * (speed / acceleration + acceleration / jerk) * draw(rng, 1.2, 4), 4)
            best = way / speed + speed / acceleration + acceleration / jerk
        else:
            jerk = draw(rng, 1e-2, 1e2)
            best = (4 ** (order - 1) * math.factorial(order - 1) * way / jerk) ** (1 / order)
        minimize, worth = objective(rng, "minimize", "time", "T", clock, second)
        grid = mesh(rng, 2 * order + 4, 50, least=3)
        rate = f"{length}/{clock}^"
        sign = rng.choice([1, -1])
        if rng.random() < 0.5:
            names = [f"x{k}" for k in range(order)]
            units = [f"[{length}]"] + [f"[{rate}{k}]" for k in range(1, order)]
            motion = [
                "state " + ", ".join(f"{n} {u}" for n, u in zip(names, units)) + ";",
                f"input u in -{number(jerk)} .. {number(jerk)} [{rate}{order}];",
                "dynamics { " + "  ".join(f"der({a}) == {b};" for a, b in zip(names, names[1:] + ["u"])) + " }",
                "initial { " + "  ".join(f"{n} == 0;" for n in names) + " }",
                f"final {{ x0 == {number(sign * way)} [{length}];  " + "  ".join(f"{n} == 0;" for n in names[1:]) + " }",
            ]
            level = ["x1", "x2"]
        else:
            rest = "  ".join(f"der(x0, {k}) == 0;" for k in range(1, order))
            motion = [
                f"output x0 [{length}]: spline(order = {order + 3}, intervals = {grid.intervals}, smoothness = {order});",
                f"trajectory {{ der(x0, {order}) in -{number(jerk)} .. {number(jerk)} [{rate}{order}]; }}",
                f"initial {{ x0 == 0;  {rest} }}",
                f"final {{ x0 == {number(sign * way)} [{length}];  {rest} }}",
            ]
            level = ["der(x0)", "der(x0, 2)"]
        if curve:
            motion.append(
                f"trajectory {{ abs({level[0]}) <= {number(speed)} [{rate}1];"
                f"  {level[1]} in -{number(acceleration)} .. {number(acceleration)} [{rate}2]; }}"
            )
        guess = rng.choice(
            ["", f"guess {{ x0 = {number(sign * way)} [{length}] * tau; }}", f"guess {{ T = {number(4 * best)} [{clock}]; }}"]
        )
        title = "A slide goes from rest to rest in the least time."
        text = problem(
            rng, "Slide", title, [f"duration T in {bounds(rng, best, clock)};", grid.statement, minimize, guess] + motion
        )
        why = "S-curve" if curve else f"perfect spline of order {order}"
        yield Case(f"integrators_time_{index}", text, best * worth, 1e-3 + 8 / grid.intervals**2, why=why)
