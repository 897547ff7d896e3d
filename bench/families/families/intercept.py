"""A missile meets a moving target with the least effort at a fixed time, or at the best time if time costs too.

Answer: 3 |Z|^2 / (2 T^3) for half the integral of a^2, where Z is the miss without effort (Bryson and Ho, section 5.4);
where the velocity is to be matched too, 6 p^2 / T^3 + 6 p v / T^2 + 2 v^2 / T. The best time is found on a fine grid.
"""

import numpy as np

from case import Case
from meshes import mesh
from sizes import Sizes, vector
from spell import block, guess, number, problem, rounded


def effort(T, place, velocity, matched):
    """Half the integral of a^2, for the target's place and velocity relative to the missile's at the start; T may be an array."""
    p, v = np.array(place), np.array(velocity)
    pp, pv, vv = p @ p, p @ v, v @ v
    if matched:
        return 6 * pp / T**3 + 6 * pv / T**2 + 2 * vv / T
    return 1.5 * (pp / T**3 + 2 * pv / T**2 + vv / T)


def cases(rng, count):
    for k in range(count):
        n = rng.choice((2, 3))
        sizes = Sizes(rng, pure=rng.random() < 0.2)
        length = sizes.unit("length", 10 ** rng.uniform(0, 6))
        far = length.si * 10 ** rng.uniform(0, 1.5)
        speed = sizes.unit("speed", far / 10 ** rng.uniform(0, 2))
        fast = speed.si * 10 ** rng.uniform(0, 1)
        drawn = lambda size, unit, digits: [sizes.write("", rng.uniform(-1, 1) * size, unit, digits) for _ in range(n)]
        target, moves, own = drawn(far, length, 4), drawn(0.4 * fast, speed, 3), drawn(fast, speed, 3)
        place = [q.si for q in target]
        velocity = [q.si - p.si for q, p in zip(moves, own)]
        matched = rng.random() < 0.4
        distance, closing = np.hypot.reduce(place), np.hypot.reduce(velocity)
        free = rng.random() < 0.4
        T = sizes.write("time", distance / closing * rng.uniform(0.3, 3), digits=3)
        T_text, T_si = f"duration T = {T};", T.si
        price = 0.0
        if free:
            # So that time costs about as much as the effort.
            price = rounded(effort(T.si, place, velocity, matched) / T.si, 2)
            low, high = T.si / 10, T.si * 10
            times = np.geomspace(low, high, 200001)
            costs = price * times + effort(times, place, velocity, matched)
            best, T_si = float(costs.min()), float(times[costs.argmin()])
            T_text = f"duration T in {number(low / T.unit.si)} .. {number(high / T.unit.si)} {T.unit}".rstrip() + ";"
        else:
            best = effort(T.si, place, velocity, matched)
        grid = mesh(rng, 2, 30)
        statements = [
            T_text,
            f"param place[{n}] = {vector(target)};",
            f"param moves[{n}] = {vector(moves)};",
            f"state r[{n}] {length}, v[{n}] {speed};",
            f"input a[{n}] {sizes.mark('m/s^2')};",
            grid.statement,
            "dynamics { der(r) == v;  der(v) == a; }",
            f"initial {{ r == 0;  v == {vector(own)}; }}",
            block("final", ["r == place + moves * t"] + (["v == moves"] if matched else [])),
        ]
        cost = rng.choice(("norm(a)^2", "dot(a, a)", "sum(i in 1 .. %d, a[i]^2)" % n))
        statements.append(f"minimize effort: 0.5 * integral({cost});")
        if free:
            statements.append(f"minimize time: {price!r} {sizes.mark('m^2/s^4')} * T;")
        statements += guess(rng, ["r = place * tau"], ["r = -10 * place", "a = 0"])
        yield Case(
            name=f"intercept_{k}",
            text=problem(rng, "Intercept", "A missile meets a target with the least effort.", statements),
            optimum=best,
            tolerance=2e-6,
            scale=price * T_si,
            why="zero-effort miss",
        )
