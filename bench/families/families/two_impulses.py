"""Two impulses from one circular orbit to another in the same plane, at the least sum of changes of velocity.

Answer: Hohmann's transfer, the best of two impulses where the radii differ by less than a factor of 11.94.
"""

import math

from case import Case
from meshes import Mesh, mesh
from sizes import Sizes
from spell import guess, problem, rounded

BODIES = {"Earth": (398600.4, 6700), "Mars": (42828.4, 3700), "Moon": (4902.8, 1850), "Sun": (1.32712e11, 1.5e8)}


def hohmann(r1, r2, mu):
    """The sum of both impulses, and the time between them."""
    first = math.sqrt(mu / r1) * abs(math.sqrt(2 * r2 / (r1 + r2)) - 1)
    second = math.sqrt(mu / r2) * abs(1 - math.sqrt(2 * r1 / (r1 + r2)))
    return first + second, math.pi * math.sqrt((r1 + r2) ** 3 / (8 * mu))


def cases(rng, count):
    for k in range(count):
        sizes = Sizes(rng, pure=rng.random() < 0.4)
        body = rng.choice(list(BODIES))
        mu, r1 = (1.0, 1.0) if sizes.pure else BODIES[body]
        if not sizes.pure:
            r1 = rounded(r1 * rng.uniform(1, 3), 3)
        r2 = rounded(r1 * 10 ** (rng.choice((-1, 1, 1)) * rng.uniform(0.05, 0.9)), 4)
        change, T = hohmann(r1, r2, mu)
        grid = mesh(rng, 10, 80)
        # Half a radian at the inner radius an interval, at most.
        around = T * math.sqrt(mu / min(r1, r2) ** 3)
        grid = Mesh(max(grid.intervals, math.ceil(2 * around)), max(grid.points, 3))
        km, kms = sizes.mark("km"), sizes.mark("km/s")
        unit = sizes.unit("time", T)
        bounds = rng.choice((f"{0.2 * T / unit.si:.3g} .. {5 * T / unit.si:.3g}", f"{0.01 * T / unit.si:.3g} .. {100 * T / unit.si:.3g}"))
        statements = [
            f"param mu = {mu!r} {sizes.mark('km^3/s^2')};",
            f"param r1 = {r1!r} {km};",
            f"param r2 = {r2!r} {km};",
            f"duration T in {bounds} {unit};",
            grid.statement,
            f"let first[2] {kms} = v - (0, sqrt(mu / r1));",
            f"let second[2] {kms} = sqrt(mu / r2) / r2 * (-r[2], r[1]) - v;",
            f"minimize {'change ' + kms + ': ' if kms else ''}norm(initial(first)) + norm(final(second));",
            "initial { r == (r1, 0); }",
            "final { norm(r) == r2; }",
            f"state r[2] {km}, v[2] {kms};",
            "dynamics { der(r) == v;  der(v) == -mu * r / norm(r)^3; }",
        ]
        arc = [
            "r = (r1 + (r2 - r1) * tau) * (cos(pi * tau), sin(pi * tau))",
            "v = sqrt(mu / r1) * (-sin(pi * tau), cos(pi * tau))",
            f"T = {sizes.write('time', T, digits=1)}",
        ]
        quarter = ["r = (r1 * (1 - tau), r2 * tau)", f"T = {sizes.write('time', T / 2, digits=1)}"]
        statements += guess(rng, arc, rng.choice((arc, quarter)))
        yield Case(
            name=f"two_impulses_{k}",
            text=problem(rng, "Transfer", "Two impulses lead from one circular orbit to another.", statements),
            optimum=change,
            tolerance=1e-6 + (around / grid.intervals / 2) ** (2 * grid.points),
            why="Hohmann",
        )
