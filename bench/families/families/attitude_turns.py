"""Turns from one attitude to another by quaternions: about one axis, at an even rate or from rest to rest.

Answer: the angle of a turn is twice the arc between the quaternions; the least integral of the squared rate is angle^2 / T,
from rest to rest of the squared torque on a round body 12 J^2 angle^2 / T^3; the least time at a bounded rate angle / W.
"""

import math

from case import Case
from meshes import mesh
from spell import bounds, draw, number, objective, problem
from units import unit


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time", "s", "min", "ms", "h")
        angle = math.radians(draw(rng, 5, 179))
        axis = [rng.gauss(0, 1) for _ in range(3)]
        size = math.hypot(*axis)
        end = [math.cos(angle / 2)] + [math.sin(angle / 2) * a / size for a in axis]
        total, tempo = draw(rng, 1e-1, 1e2), draw(rng, 1e-2, 1e1)
        kind = ["rate", "time", "torque"][index % 3]
        grid = mesh(rng, 6, 20, least=4)
        turn = "der(q) == 0.5 * rotation::product(q, (0, w[1], w[2], w[3]));"
        by_hand = rng.random() < 0.5
        if by_hand:
            turn = (
                "2 * der(q[1]) == -q[2] * w[1] - q[3] * w[2] - q[4] * w[3];\n    2 * der(q[2]) == q[1] * w[1] + q[3] * w[3] - q[4] * w[2];\n"
                "    2 * der(q[3]) == q[1] * w[2] + q[4] * w[1] - q[2] * w[3];\n    2 * der(q[4]) == q[1] * w[3] + q[2] * w[2] - q[3] * w[1];"
            )
        final = f"q == {'(' + ', '.join(f'{e:.15g}' for e in end) + ')'};"
        if rng.random() < 0.4:
            final = f"q[2 .. 4] == {'(' + ', '.join(f'{e:.15g}' for e in end[1:]) + ')'};  q[1] >= 0;"
        rest = ""
        inertia = draw(rng, 1e-3, 1e4)
        if kind == "torque":
            motion = [f"state q[4] [1], w[3] [1/{clock}];", f"input m[3] [kg*m^2/{clock}^2];"]
            turn += f"\n    {number(inertia)} [kg*m^2] * der(w) == m;"
            rest = "  w == 0;"
            best = 12 * inertia**2 * angle**2 / total**3
            expression, symbol, factor = "integral(norm(m)^2)", f"kg^2*m^4/{clock}^3", 1 / second**3
            duration = f"duration T = {number(total)} [{clock}];"
        elif kind == "rate":
            motion = ["state q[4];", f"input w[3] [1/{clock}];"]
            best = angle**2 / total
            expression, symbol, factor = "integral(norm(w)^2)", f"1/{clock}", 1 / second
            duration = f"duration T = {number(total)} [{clock}];"
        else:
            motion = [
                "state q[4];",
                f"input w[3] [1/{clock}];",
                f"trajectory {{ norm(w) <= {number(tempo)} [1/{clock}]; }}",
            ]
            best = angle / tempo
            expression, symbol, factor = "T", clock, second
            duration = f"duration T in {bounds(rng, best, clock)};"
        extra = "trajectory { dot(q, q) == 1; }" if rng.random() < 0.3 else ""
        minimize, worth = objective(rng, "minimize", "cost", expression, symbol, factor)
        text = problem(
            rng,
            "Slew",
            "A turn from one attitude to another.",
            motion
            + [
                duration,
                grid.statement,
                minimize,
                extra,
                f"dynamics {{\n    {turn}\n}}",
                f"initial {{ q == (1, 0, 0, 0);{rest} }}",
                f"final {{ {final}{rest} }}",
            ],
        )
        if not by_hand:
            text = "use std::rotation;\n\n" + text
        yield Case(f"attitude_turns_{index}", text, best * worth, 1e-4, why=f"{kind}, {math.degrees(angle):.4g} deg")
