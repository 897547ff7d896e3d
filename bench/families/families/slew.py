"""A spacecraft turns about one axis from rest to rest in the least time; rate and torque are limited, in some cases
also how fast the torque may change.

Answer: the trapezoid, or the curve of seven segments (Biagiotti and Melchiorri, Trajectory Planning, section 3.4).
"""

import math

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, problem, rounded
from units import DEGREE


def trapezoid(angle, rate, acceleration):
    if angle * acceleration <= rate**2:
        return 2 * math.sqrt(angle / acceleration)
    return angle / rate + rate / acceleration


def seven_segments(angle, rate, acceleration, jerk):
    if rate * jerk < acceleration**2:
        rise = 2 * math.sqrt(rate / jerk)
    else:
        rise = acceleration / jerk + rate / acceleration
    if angle / rate >= rise:
        return rise + angle / rate
    if angle >= 2 * acceleration**3 / jerk**2:
        half = acceleration / jerk / 2
        return 2 * (half + math.sqrt(half**2 + angle / acceleration))
    return 4 * math.cbrt(angle / (2 * jerk))


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng)
        angle = sizes.write("angle", rng.uniform(1, 180) * DEGREE, digits=3)
        inertia = rounded(10 ** rng.uniform(-2, 4), 2)
        acceleration = 10 ** rng.uniform(-5, 1)
        torque = rounded(inertia * acceleration, 3)
        acceleration = torque / inertia
        rate = sizes.write("turn rate", math.sqrt(angle.si * acceleration) * rng.uniform(0.2, 2), digits=3)
        smooth = rng.random() < 0.5
        quick = rounded(torque / (trapezoid(angle.si, rate.si, acceleration) * rng.uniform(0.05, 0.5)), 3)
        T = seven_segments(angle.si, rate.si, acceleration, quick / inertia) if smooth else trapezoid(angle.si, rate.si, acceleration)
        # The shortest time in which torque or rate come to their limits.
        ramp = min(acceleration * inertia / quick if smooth else T, rate.si / acceleration, T / 2)
        grid = mesh(rng)
        shown = sizes.unit("time", T)
        along = sizes.unit("angle", angle.si)
        turning = sizes.unit("turn rate", rate.si)
        statements = [
            f"param inertia = {inertia!r} [kg*m^2];",
            f"param torque_max = {torque!r} [N*m];",
            f"duration T in {sizes.bounds('time', T)};",
            grid.statement,
            f"minimize time {shown}: T;",
        ]
        limits = [f"-{rate} <= w <= {rate}"]
        if smooth:
            statements += [
                f"param torque_rate = {quick!r} [N*m/s];",
                f"state angle {along}, w {turning}, torque [N*m];",
                "input change [N*m/s];",
                "dynamics { der(angle) == w;  inertia * der(w) == torque;  der(torque) == change; }",
            ]
            limits += ["torque in -torque_max .. torque_max", "-torque_rate <= change <= torque_rate"]
            rest = ["w == 0", "torque == 0"]
        else:
            statements += [
                f"state angle {along}, w {turning};",
                "input torque [N*m];",
                "dynamics { der(angle) == w;  inertia * der(w) == torque; }",
            ]
            limits += ["torque in -torque_max .. torque_max"]
            rest = ["w == 0"]
        statements += [block("initial", ["angle == 0", *rest]), block("final", [f"angle == {angle}", *rest]), block("trajectory", limits)]
        statements += guess(
            rng,
            [f"angle = {angle} * tau", f"w = {angle} / T", f"T = {sizes.write('time', 1.2 * T, digits=2)}"],
            [f"angle = -{angle}", f"T = {sizes.write('time', 10 * T, digits=1)}"],
        )
        yield Case(
            name=f"slew_{k}",
            text=problem(rng, "Slew", "A spacecraft turns about one axis, from rest to rest, as fast as it can.", statements),
            optimum=T / shown.si,
            tolerance=grid.ramps(6 if smooth else 2, ramp / T),
            why="seven segments" if smooth else "trapezoid",
        )
