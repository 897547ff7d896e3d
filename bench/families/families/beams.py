"""Beams and strings find the deflection of the least energy.

Answer: Euler and Bernoulli: under an even load q the energy is -q^2 L^5 / (N EI) with N = 40 for a cantilever, 240 on two
supports, 1440 clamped at both ends, 640 with one end clamped and one supported; under a load P in the middle
-P^2 L^3 / (N EI) with N = 96 and 384, at the end of a cantilever 6. A string of tension S above a floor touches it from
where its parabola is level.
"""

from case import Case
from spell import draw, number, objective, problem, rounded
from units import unit

SUPPORTS = {
    "cantilever": ("w == 0;  der(w) == 0;", "", 40, None),
    "supported": ("w == 0;", "w == 0;", 240, 96),
    "clamped": ("w == 0;  der(w) == 0;", "w == 0;  der(w) == 0;", 1440, 384),
    "propped": ("w == 0;  der(w) == 0;", "w == 0;", 640, None),
}


def cases(rng, count):
    for index in range(count):
        along, metre = unit(rng, "length", "m", "cm", "mm", "ft")
        length = draw(rng, 0.1, 1e3)
        stiffness, load = draw(rng, 1e-3, 1e7), draw(rng, 1e-4, 1e4)
        kind = ["even", "point", "string"][index % 3]
        intervals = rng.randint(1, 12) * 2
        statements = [f"domain s [{along}];", f"duration L = {number(length)} [{along}];"]
        tolerance = 1e-5
        if kind == "string":
            tension = draw(rng, 1e-2, 1e4)
            sag = load * (length * metre) ** 2 / (8 * tension)
            floor = rounded(sag * draw(rng, 0.1, 0.9), 4)
            # The string is free over a length a at both ends, with q a^2 / (2 S) = floor, and lies on the floor between.
            free = (2 * tension * floor / load) ** 0.5
            energy = 2 * (load**2 * free**3 / (6 * tension) - load * floor * free + load**2 * free**3 / (6 * tension))
            best = energy - load * floor * (length * metre - 2 * free)
            intervals = rng.randint(10, 40)
            tolerance = 1e-3 + 1 / intervals**2
            statements += [
                f"output w [m]: spline(order = {rng.randint(3, 5)}, intervals = {intervals}, smoothness = 2);",
                f"trajectory {{ w >= -{number(floor)} [m]; }}",
                "initial { w == 0; }\nfinal { w == 0; }",
            ]
            expression = f"integral({number(tension)} [N] * der(w)^2 / 2 + {number(load)} [N/m] * w)"
        else:
            name = rng.choice([k for k, v in SUPPORTS.items() if kind == "even" or v[3] or k == "cantilever"])
            start, end, even, middle = SUPPORTS[name]
            statements += [
                f"output w [m]: spline(order = {rng.randint(5, 7) if kind == 'even' else 5}, intervals = {intervals}, smoothness = 3);",
                f"param EI = {number(stiffness)} [N*m^2];",
                f"initial {{ {start} }}",
                f"final {{ {end} }}" if end else "",
            ]
            bending = "integral(EI / 2 * der(w, 2)^2)"
            if kind == "even":
                best = -(load**2) * (length * metre) ** 5 / (even * stiffness)
                expression = bending + f" - integral({number(load)} [N/m] * w)"
            else:
                place = "final(w)" if name == "cantilever" else "at(L / 2, w)"
                best = -(load**2) * (length * metre) ** 3 / ((6 if name == "cantilever" else middle) * stiffness)
                expression = bending + f" - {number(load)} [N] * {place}"
        minimize, worth = objective(rng, "minimize", "energy", expression, "J", 1.0)
        text = problem(rng, "Beam", "A deflection of the least energy.", statements + [minimize])
        yield Case(f"beams_{index}", text, best * worth, tolerance, why=kind)
