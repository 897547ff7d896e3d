"""Rendezvous near a circular orbit with the least energy, in a plane or in space.

Answer: the Gramian of Clohessy and Wiltshire's equations.
"""

import math

import numpy as np

from case import Case
from linear import least_energy
from meshes import Mesh, mesh
from sizes import Sizes, vector
from spell import guess, problem, rounded


def cases(rng, count):
    for k in range(count):
        n = rng.choice((2, 3))
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        rate = 1.0 if sizes.pure else rounded(10 ** rng.uniform(-4.5, -2.9), 3)
        T = sizes.write("time", 2 * math.pi / rate * 10 ** rng.uniform(-1.3, 0.6), digits=3)
        far = sizes.unit("length", 10 ** rng.uniform(0, 5))
        speed = sizes.unit("speed", far.si * rate)
        place = [sizes.write("length", far.si * rng.uniform(-5, 5), far, 3) for _ in range(n)]
        moves = [sizes.write("speed", far.si * rate * rng.choice((0, rng.uniform(-5, 5))), speed, 3) for _ in range(n)]
        A = np.zeros((2 * n, 2 * n))
        A[:n, n:] = np.eye(n)
        # In times of 1 / rate.
        A[n, 0], A[n, n + 1], A[n + 1, n] = 3, 2, -2
        if n == 3:
            A[5, 2] = -1
        B = np.vstack([np.zeros((n, n)), np.eye(n)])
        begin = [q.si for q in place] + [q.si / rate for q in moves]
        energy = least_energy(A, B, T.si * rate, begin, [0] * (2 * n)) * rate**3
        grid = mesh(rng)
        # At most a radian an interval.
        grid = Mesh(max(grid.intervals, math.ceil(rate * T.si)), grid.points)
        pull = ["3 * w^2 * r[1] + 2 * w * v[2]", "-2 * w * v[1]", "-w^2 * r[3]"][:n]
        statements = [
            f"param w = {rate!r} {sizes.mark('rad/s')};",
            f"duration T = {T};",
            grid.statement,
            f"state r[{n}] {far}, v[{n}] {speed};",
            f"input a[{n}] {sizes.mark(rng.choice(('m/s^2', 'mm/s^2')))};",
            f"dynamics {{ der(r) == v;  der(v) == ({', '.join(pull)}) + a; }}",
            f"initial {{ r == {vector(place)};  v == {vector(moves)}; }}",
            "final { r == 0;  v == 0; }",
            f"minimize {rng.choice(('integral(dot(a, a))', 'integral(norm(a)^2)'))};",
        ]
        statements += guess(rng, [f"r = {vector(place)} * (1 - tau)"], ["r = 0"])
        span = rate * T.si / grid.intervals
        yield Case(
            name=f"clohessy_wiltshire_{k}",
            text=problem(rng, "Rendezvous", "A chaser comes to rest at a station on a circular orbit.", statements),
            optimum=energy,
            tolerance=1e-6 + (span / 2) ** (2 * grid.points),
            why="Gramian",
        )
