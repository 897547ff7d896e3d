"""Jobs that wait for one another: the least time for all is the longest path through them.

Answer: the critical path method. Each job is an agent that covers its way with a bounded speed, or a double integrator from
rest to rest with a bounded acceleration (2 sqrt(d / a)); it starts when it likes, after those before it and a pause.
"""

import math

from case import Case
from spell import bounds, draw, number, objective, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time")
        length, _ = unit(rng, "length")
        n = rng.randint(2, 6)
        tempo = draw(rng, 1e-2, 1e3, 2)
        statements, lasts, ends = [], [], []
        links = []
        for k in range(n):
            way = draw(rng, 1e-2, 1e3)
            time = tempo * draw(rng, 0.3, 3)
            by_force = rng.random() < 0.4
            if by_force:
                push = rounded(4 * way / time**2, 3)
                lasts.append(2 * math.sqrt(way / push))
                body = (
                    f"    state x [{length}], v [{length}/{clock}];\n    input a in -{number(push)} .. {number(push)} [{length}/{clock}^2];\n"
                    "    dynamics { der(x) == v;  der(v) == a; }\n    initial { x == 0;  v == 0; }\n"
                    f"    final {{ x == {number(way)} [{length}];  v == 0; }}\n    collocation gauss(points = 3, intervals = {2 * rng.randint(2, 6)});\n"
                )
            else:
                top = rounded(way / time, 3)
                lasts.append(way / top)
                body = (
                    f"    output x [{length}]: spline(order = 4, intervals = {rng.randint(1, 5)});\n"
                    f"    trajectory {{ der(x) in 0 .. {number(top)} [{length}/{clock}]; }}\n"
                    f"    initial {{ x == 0; }}\n    final {{ x == {number(way)} [{length}]; }}\n"
                )
            before = [j for j in range(k) if rng.random() < 0.5]
            begin = 0.0
            for j in before:
                pause = rng.choice([0.0, rounded(tempo * draw(rng, 0.1, 1), 2)])
                begin = max(begin, ends[j] + pause)
                links.append(f"start(job{k + 1}) >= end(job{j + 1})" + (f" + {number(pause)} [{clock}]" if pause else ""))
            ends.append(begin + lasts[-1])
            start = rng.choice(["start in 0 ..;", f"start in 0 .. {number(100 * n * tempo)} [{clock}];"])
            statements.append(
                f"agent job{k + 1} {{\n    {start}\n    duration in {bounds(rng, lasts[-1], clock)};\n{body}}}"
            )
        best = max(ends)
        links += [f"end(job{k + 1}) <= done" for k in range(n)]
        statements += ["temporal {\n" + "\n".join(f"    {link};" for link in links) + "\n}"]
        statements += [
            f"variable done in 0 .. {number(1000 * best)} [{clock}];"
            if rng.random() < 0.5
            else f"variable done [{clock}];"
        ]
        minimize, worth = objective(rng, "minimize", "makespan", "done", clock, second)
        text = problem(rng, "Schedule", "Everything is done as soon as it can be.", statements + [minimize])
        yield Case(f"schedules_{index}", text, best * worth, 1e-4, why=f"{n} jobs, {len(links) - n} links")
