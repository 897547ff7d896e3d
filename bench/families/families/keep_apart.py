"""Two vehicles change places and keep apart.

Answer: their middle rests and what lies between them goes along the shortest line around a disc: two tangents and an arc,
2 sqrt(d^2 - D^2) + D (pi - 2 acos(D / d)) for the distance d at the start and D on the way. Energy L^2 / (2 T), time
L / (2 v) with bounded speeds.
"""

import math

from case import Case
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        apart = draw(rng, 1e-2, 1e3)
        far = rounded(apart * draw(rng, 1.2, 6), 4)
        way = 2 * math.sqrt(far**2 - apart**2) + apart * (math.pi - 2 * math.acos(apart / far))
        half = number(far / 2)
        fast = index % 2 == 1
        intervals = rng.randint(16, 40)
        if fast:
            speed = draw(rng, 1e-2, 1e2)
            best = way / (2 * speed)
            minimize, worth = objective(rng, "minimize", "time", "T", clock, second)
            extra = [
                f"duration T in {bounds(rng, best, clock)};",
                "trajectory { for i in 1 .. 2 { norm(v[i]) <= top; } }",
                f"param top = {number(speed)} [{length}/{clock}];",
            ]
        else:
            total = draw(rng, 0.1, 100)
            best = way**2 / (2 * total)
            minimize, worth = objective(
                rng,
                "minimize",
                "effort",
                "integral(norm(v[1])^2 + norm(v[2])^2)",
                f"{length}^2/{clock}",
                metre**2 / second,
            )
            extra = [f"duration T = {number(total)} [{clock}];"]
        side = rng.choice([1, -1])
        bow = number(side * apart * rng.choice([0.6, 1.0]))
        text = problem(
            rng,
            "Swap",
            "Two vehicles change places.",
            [
                f"state r[1 .. 2, 1 .. 2] [{length}];",
                f"input v[1 .. 2, 1 .. 2] [{length}/{clock}];",
                "dynamics { for i in 1 .. 2 { der(r[i]) == v[i]; } }",
                f"collocation gauss(points = 3, intervals = {intervals});",
                f"initial {{ r[1] == (-{half}, 0) [{length}];  r[2] == ({half}, 0) [{length}]; }}",
                f"final {{ r[1] == ({half}, 0) [{length}];  r[2] == (-{half}, 0) [{length}]; }}",
                f"trajectory {{ apart: norm(r[1] - r[2]) >= {number(apart)} [{length}]; }}",
                minimize,
                rng.choice(
                    [
                        "",
                        f"guess {{ r[1] through (-{half}, 0), (0, {bow}), ({half}, 0) [{length}]; }}",
                        f"guess {{ r[1] through (-{half}, 0), (0, {bow}), ({half}, 0) [{length}];"
                        f"  r[2] through ({half}, 0), (0, {number(-float(bow))}), (-{half}, 0) [{length}]; }}",
                    ]
                ),
            ]
            + extra,
        )
        yield Case(f"keep_apart_{index}", text, best * worth, 2e-3 + 4 / intervals**2, why=f"D / d {apart / far:.3g}")
