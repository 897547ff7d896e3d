"""Energy at prices that jump with time, in windows that are no knots of the mesh.

Answer: energy is bought in the cheapest windows first, full power in each (a merit order); with a square price of the power
p u^2 / 2 in each window the power goes as 1 / p, at a cost E^2 / (2 sum t / p).
"""

from case import Case
from spell import draw, number, objective, problem, rounded
from units import unit


def stairs(prices, ends, clock):
    """A price for each window."""
    text = number(prices[-1])
    for price, end in reversed(list(zip(prices[:-1], ends[:-1]))):
        text = f"if t <= {number(end)} [{clock}] {{ {number(price)} }} else {{ {text} }}"
    return text


def cases(rng, count):
    for index in range(count):
        clock, second = unit(rng, "time", "h", "min", "day", "s")
        n = rng.randint(2, 5)
        step, most = draw(rng, 1e-1, 1e2), draw(rng, 1e-2, 1e3)
        on_knots = rng.random() < 0.5
        lasts = [step if on_knots else rounded(step * draw(rng, 0.4, 2), 3) for _ in range(n)]
        ends = [sum(lasts[: k + 1]) for k in range(n)]
        prices = [draw(rng, 0.1, 2, 2) for _ in range(n)]
        intervals = n * rng.randint(2, 10)
        square = index % 2 == 1
        by_phases = rng.random() < 0.3
        price = stairs(prices, ends, clock)
        energy = rounded(most * ends[-1] * draw(rng, 0.1, 0.9), 4)
        if square:
            best = energy**2 / (2 * sum(last / p for last, p in zip(lasts, prices)))
            expression, symbol, factor = "integral(price * u^2 / 2)", f"J^2/{clock}", 1 / second
            bounds = f"input u [J/{clock}];"
        else:
            left, best = energy, 0.0
            for p, last in sorted(zip(prices, lasts)):
                bought = min(left, most * last)
                best, left = best + p * bought, left - bought
            expression, symbol, factor = "integral(price * u)", "J", 1.0
            bounds = f"input u in 0 .. {number(most)} [J/{clock}];"
        statements = [
            "state E [J];",
            bounds,
            "dynamics { der(E) == u; }",
            "initial { E == 0; }",
            f"final {{ E >= {number(energy)} [J]; }}",
        ]
        sharp = on_knots or by_phases
        tolerance = (1e-5 if square else 1e-2) if sharp else 2e-2 + 2 / intervals
        if by_phases:
            for k, (last, p) in enumerate(zip(lasts, prices)):
                after = f" after w{k}" if k else ""
                statements.append(
                    f"phase w{k + 1}{after} {{ duration = {number(last)} [{clock}];  let price = {number(p)};"
                    + ("  jump u; }" if k else " }")
                )
            statements.append(f"collocation gauss(points = 3, intervals = {rng.randint(1, 6)});")
        else:
            statements += [
                f"let price = {price};",
                f"duration T = {number(ends[-1])} [{clock}];",
                f"collocation gauss(points = 3, intervals = {intervals});",
            ]
        minimize, worth = objective(rng, "minimize", "bill", expression, symbol, factor)
        text = problem(rng, "Tariff", "Energy at prices that jump.", statements + [minimize])
        yield Case(f"tariffs_{index}", text, best * worth, tolerance, why="square" if square else "merit order")
