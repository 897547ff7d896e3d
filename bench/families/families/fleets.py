"""Fleets of agents of one kind that arrive together, at a price of effort and time.

Answer: each spends 12 d^2 / T^3 from rest to rest (or d^2 / T without); with a price c of the common time it is
(36 S / c)^(1/4), S the sum of d^2 (or (S / c)^(1/2)).
"""

from case import Case
from spell import bounds, draw, number, numbers, problem, rounded
from units import unit


def cases(rng, count):
    for index in range(count):
        length, metre = unit(rng, "length")
        clock, second = unit(rng, "time")
        n = rng.randint(2, 12)
        ways = [draw(rng, 1e-2, 1e2) for _ in range(n)]
        square = sum(way**2 for way in ways)
        tempo = draw(rng, 1e-1, 1e2)
        rest = rng.random() < 0.6
        if rest:
            price = rounded(36 * square / tempo**4, 4)
            time = (36 * square / price) ** 0.25
            best, power = 12 * square / time**3 + price * time, 3
        else:
            price = rounded(square / tempo**2, 4)
            time = (square / price) ** 0.5
            best, power = square / time + price * time, 1
        effort = "der(x, 2)^2" if rest else "der(x)^2"
        unit_text = f"{length}^2/{clock}^{power}"
        ends = "  der(x) == 0;" if rest else ""
        named = rng.random() < 0.5
        price_text = f"{number(price)} [{length}^2/{clock}^{power + 1}]"
        fly = f"fly [{unit_text}]: " if named else ""
        text = problem(
            rng,
            "Fleet",
            "All arrive together.",
            [
                f"param way[{n}] = {numbers(ways)} [{length}];",
                f"agent car[i in 1 .. {n}] {{\n    duration in {bounds(rng, time, clock)};\n"
                f"    output x [{length}]: spline(order = {rng.randint(4, 6)}, intervals = {rng.randint(1, 5)});\n"
                f"    minimize {fly}integral({effort});\n    initial {{ x == 0;{ends} }}\n    final {{ x == way[i];{ends} }}\n}}",
                f"minimize {'late [' + unit_text + ']: ' if named else ''}{price_text} * end(car[1]);",
                f"temporal {{ for i in 2 .. {n} {{ end(car[i]) == end(car[1]); }} }}",
            ],
        )
        yield Case(f"fleets_{index}", text, best * (1 if named else metre**2 / second**power), 1e-5, why=f"{n} agents")
