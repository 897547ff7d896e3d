"""Costs that can be nothing at all: what is wished for can be done.

Answer: a reference that the system can follow, a soft limit that can be kept, a goal within reach, data without noise; the
optimum is 0, and errors are beside what the cost is for a motion that does nothing.
"""

import math

from case import Case
from meshes import mesh
from spell import draw, number, numbers, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        size, total = draw(rng, 1e-3, 1e3), draw(rng, 1e-2, 1e2)
        grid = mesh(rng, 6, 30, least=4)
        x, v = f"[{length}]", f"[{length}/{clock}]"
        first = [
            f"duration T = {number(total)} [{clock}];",
            f"state x {x};",
            f"input u {v};",
            "dynamics { der(x) == u; }",
            grid.statement,
        ]
        kind = ["track", "reach", "soft", "decay", "late"][index % 5]
        symbol, factor = f"{length}^2*{clock}", metre**2 * second
        if kind == "track":
            omega = draw(rng, 0.5, 6) / total
            statements = first + [
                f"let wished {x} = {number(size)} {x} * sin({number(omega)} [1/{clock}] * t);",
                "initial { x == 0; }",
            ]
            expression, scale = "integral((x - wished)^2)", size**2 * total / 2
        elif kind == "reach":
            most = size / total * draw(rng, 1.1, 10)
            statements = first + [f"trajectory {{ abs(u) <= {number(most)} {v}; }}", "initial { x == 0; }"]
            expression, scale, symbol, factor = f"(final(x) - {number(size)} {x})^2", size**2, f"{length}^2", metre**2
            if rng.random() < 0.5:
                expression, scale, symbol, factor = f"abs(final(x) - {number(size)} {x})", size, length, metre
        elif kind == "soft":
            statements = first + [
                f"trajectory {{ soft(square = 3): x in 0 .. {number(size)} {x}; }}",
                f"final {{ soft(square = {number(total)} [{clock}]): x == {number(size)} {x}; }}",
                "initial { x == 0; }",
            ]
            expression, scale = f"integral(max(0, x - {number(size)} {x})^2)", size**2 * total
            statements.append(f"minimize {expression};")
            text = problem(rng, "Zero", "What is wished for can be done.", statements)
            yield Case(f"zeros_{index}", text, 0.0, 1e-4, scale=scale * factor, why=kind)
            continue
        elif kind == "decay":
            n = rng.randint(4, 12)
            rate = rounded(draw(rng, 0.3, 4) / total, 3)
            times = [total * (k + 0.5) / n for k in range(n)]
            statements = [
                f"duration T = {number(total)} [{clock}];",
                f"state x {x};",
                grid.statement,
                f"variable k in {number(rate / 5)} .. {number(rate * 7)} [1/{clock}];",
                "dynamics { der(x) == -k * x; }",
                f"const at_time[{n}] = {numbers(times)} [{clock}];",
                f"param seen[{n}] = ({', '.join(f'{size * math.exp(-rate * t):.16g}' for t in times)}) {x};",
            ]
            expression = f"sum(i in 1 .. {n}, (at(at_time[i], x) - seen[i])^2)"
            symbol, factor, scale = f"{length}^2", metre**2, size**2
        else:
            most = size / total * draw(rng, 1.1, 4)
            statements = first + [
                f"trajectory {{ u in 0 .. {number(most)} {v}; }}",
                "initial { x == 0; }",
            ]
            expression, symbol, factor, scale = f"max(0 {x}, {number(size)} {x} - final(x))", length, metre, size
        minimize, worth = objective(rng, "minimize", "miss", expression, symbol, factor)
        text = problem(rng, "Zero", "What is wished for can be done.", statements + [minimize])
        yield Case(f"zeros_{index}", text, 0.0, 1e-4, scale=scale * worth, why=kind)
