"""Problems without a solution: what is asked for lies beyond a bound that follows from the others.

Answer: none. Each target is beyond the closed form of what can be reached by 2 % to a factor of 3.
"""

import math

from case import Case
from meshes import mesh
from sizes import Sizes
from spell import block, guess, number, problem, rounded


def too_far(rng, sizes):
    """From rest to rest at a distance that takes longer than there is time."""
    push = sizes.draw("acceleration", 1e-3, 1e3)
    T = sizes.draw("time", 1e-1, 1e5)
    reach = push.si * T.si**2 / 4
    d = sizes.write("length", reach * beyond(rng), digits=5)
    fixed = rng.random() < 0.5
    return [
        f"duration T = {T};" if fixed else f"duration T in {number(T.number / 10)} .. {T};",
        f"state x {d.unit}, v {sizes.unit('speed', d.si / T.si)};",
        f"input u in -{push} .. {push};",
        "dynamics { der(x) == v;  der(v) == u; }",
        block("initial", ["x == 0", "v == 0"]),
        block("final", [f"x == {d}", "v == 0"]),
        "minimize integral(u^2);" if fixed else "minimize T;",
    ], [f"x = {d} * tau"]


def too_fast(rng, sizes):
    """A target at constant speed that runs away from a slower pursuer."""
    own = sizes.draw("speed", 1e-2, 1e4)
    target = sizes.write("speed", own.si * beyond(rng), digits=5)
    d = sizes.draw("length", 1e-1, 1e6)
    return [
        f"duration T in {sizes.bounds('time', d.si / own.si)};",
        f"state x {d.unit}, y {d.unit};",
        f"input vx {own.unit}, vy {own.unit};",
        "dynamics { der(x) == vx;  der(y) == vy; }",
        "initial { x == 0;  y == 0; }",
        f"trajectory {{ hypot(vx, vy) <= {own}; }}",
        f"final {{ x == {d} + {target} * T;  y == 0; }}",
        "minimize T;",
    ], [f"x = {d} * tau"]


def too_wide(rng, sizes):
    """A throw beyond the parabola of safety."""
    v = sizes.draw("speed", 0.1, 3e3)
    g = sizes.write("acceleration", 9.81, digits=3)
    d = sizes.write("length", v.si**2 / g.si * beyond(rng), digits=5)
    return [
        f"duration T in {sizes.bounds('time', d.si / v.si)};",
        f"param g = {g};",
        f"state x {d.unit}, y {d.unit}, vx {v.unit}, vy {v.unit};",
        "dynamics { der(x) == vx;  der(y) == vy;  der(vx) == 0;  der(vy) == -g; }",
        f"initial {{ x == 0;  y == 0;  hypot(vx, vy) <= {v}; }}",
        f"final {{ x == {d};  y == 0; }}",
        "minimize T;",
    ], [f"x = {d} * tau"]


def too_dear(rng, sizes):
    """Less energy than a motion from rest to rest takes, 12 d^2 / T^3."""
    T = sizes.draw("time", 1e-1, 1e4)
    d = sizes.draw("length", 1e-2, 1e5)
    least = 12 * d.si**2 / T.si**3
    budget = rounded(least / beyond(rng), 5)
    return [
        f"duration T = {T};",
        f"state x {d.unit}, v {sizes.unit('speed', d.si / T.si)};",
        f"input u {sizes.mark('m/s^2')};",
        "dynamics { der(x) == v;  der(v) == u; }",
        block("initial", ["x == 0", "v == 0"]),
        block("final", [f"x == {d}", "v == 0"]),
        f"temporal {{ budget: integral(u^2) <= {budget!r} {sizes.mark('m^2/s^3')}".rstrip() + "; }",
        "minimize integral(x);",
    ], [f"x = {d} * tau"]


def too_heavy(rng, sizes):
    """More change of speed than the fuel gives."""
    mass = sizes.draw("mass", 0.1, 1e5)
    dry = sizes.write("mass", mass.si * rng.uniform(0.1, 0.8), mass.unit, 3)
    exhaust = sizes.draw("speed", 300, 5000)
    most = exhaust.si * math.log(mass.si / dry.si)
    wanted = sizes.write("speed", most * beyond(rng), digits=5)
    thrust = sizes.write("force", mass.si * 10 ** rng.uniform(0, 2), digits=2)
    T = sizes.write("time", 5 * exhaust.si * mass.si / thrust.si, digits=2)
    return [
        f"duration T = {T};",
        f"param exhaust = {exhaust};",
        f"state v {wanted.unit}, m in {number(dry.number)} .. {mass};",
        f"input F in 0 .. {thrust};",
        "dynamics { der(v) == F / m;  der(m) == -F / exhaust; }",
        f"initial {{ v == 0;  m == {mass}; }}",
        f"final {{ v == {wanted}; }}",
        "minimize integral(F);",
    ], [f"v = {wanted} * tau", f"m = {mass}"]


def too_late(rng, sizes):
    """A boat that is carried away by a current faster than it, from a place down the stream."""
    own = sizes.draw("speed", 1e-2, 1e3)
    current = sizes.write("speed", own.si * beyond(rng), digits=5)
    d = sizes.draw("length", 1e-1, 1e6)
    return [
        f"duration T in {sizes.bounds('time', d.si / own.si)};",
        f"param V = {own};",
        f"state x {d.unit}, y {d.unit};",
        f"input heading {sizes.mark('deg')};",
        f"dynamics {{ der(x) == {current} + V * cos(heading);  der(y) == V * sin(heading); }}",
        "initial { x == 0;  y == 0; }",
        f"final {{ x == -{d};  y == 0; }}",
        "minimize T;",
    ], [f"x = -{d} * tau"]


def beyond(rng):
    return 1 + 10 ** rng.uniform(-1.7, 0.3)


KINDS = (too_far, too_fast, too_wide, too_dear, too_heavy, too_late)


def cases(rng, count):
    for k in range(count):
        kind = KINDS[k % len(KINDS)]
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        statements, line = kind(rng, sizes)
        statements.append(mesh(rng).statement)
        statements += guess(rng, line, line)
        yield Case(
            name=f"out_of_reach_{k}",
            text=problem(rng, "Beyond", kind.__doc__.splitlines()[0], statements),
            optimum=0.0,
            tolerance=0.0,
            why=kind.__doc__,
            infeasible=True,
        )
