"""A chain of two, three or four integrators from one state to another in a fixed time with the least energy.

Answer: by the Gramian; the state is a polynomial, so every mesh is exact.
"""

from case import Case
from linear import integrators, least_energy
from meshes import mesh
from sizes import Quantity, Sizes
from spell import block, guess, problem, rounded
from units import Unit


def cases(rng, count):
    for k in range(count):
        n = rng.choice((2, 2, 3, 4))
        sizes = Sizes(rng, pure=rng.random() < 0.3)
        T = sizes.draw("time", 1e-2, 1e4)
        length = sizes.unit("length", 10 ** rng.uniform(-3, 6))
        size = length.si * 10 ** rng.uniform(-1, 2)
        second = "" if sizes.pure else "s"
        powers = [length] + [
            Unit(f"{length.symbol}/{second}" + (f"^{j}" if j > 1 else "") if second else "", length.si) for j in range(1, n)
        ]
        draw = lambda j: Quantity(rounded(rng.uniform(-1, 1) * size / T.si**j / powers[j].si, 3), powers[j])
        begin = [draw(j) if rng.random() < 0.6 else Quantity(0, powers[j]) for j in range(n)]
        end = [draw(j) if j == 0 or rng.random() < 0.5 else Quantity(0, powers[j]) for j in range(n)]
        A, B = integrators(n)
        # In times of T, which keeps the Gramian well conditioned.
        scaled = lambda state: [q.si * T.si**j for j, q in enumerate(state)]
        energy = least_energy(A, B, 1.0, scaled(begin), scaled(end)) / T.si ** (2 * n - 1)
        grid = mesh(rng, 3, 40)
        points = max(grid.points, n)
        form = rng.choice(("states", "flat"))
        names = "xvaj"[:n] if form == "states" else ["x"] + [f"der(x{f', {j}' if j > 1 else ''})" for j in range(1, n)]
        zero = lambda name, q: f"{name} == 0" if q.number == 0 else f"{name} == {q}"
        statements = [
            f"duration T = {T};",
            block("initial", [zero(*pair) for pair in zip(names, begin)]),
            block("final", [zero(*pair) for pair in zip(names, end)]),
        ]
        if form == "states":
            equations = [f"der({a}) == {b}" for a, b in zip(names, [*names[1:], "u"])]
            statements += [
                "state " + ", ".join(f"{name} {unit}".rstrip() for name, unit in zip(names, powers)) + ";",
                f"input u {sizes.mark(f'm/s^{n}')};",
                f"collocation gauss(points = {points}, intervals = {grid.intervals});",
                block("dynamics", equations),
            ]
        else:
            statements += [
                f"output x {length}: spline(order = {rng.choice((2 * n, 2 * n + 1))}, intervals = {rng.choice((1, 2, 5))});",
                f"let u = der(x, {n});",
            ]
        statements.append("minimize integral(u^2);")
        statements += guess(rng, [f"x = {begin[0]} + ({end[0]} - {begin[0]}) * tau"], [f"x = {Quantity(1e3, length)}"])
        yield Case(
            name=f"least_energy_{k}",
            text=problem(rng, "Chain", f"A chain of {n} integrators is moved with the least energy.", statements),
            optimum=energy,
            tolerance=1e-6,
            why="Gramian of the chain",
        )
