"""bench/run --robustness: from 50 random coarse routes, how many does each solver solve, and how well?"""

import statistics
from pathlib import Path

import casadi as ca

from .casadi_solvers import Solver
from .problems import flight
from .rows import route as whole_route
from .table import AGREES

ROUTES = Path(__file__).resolve().parent.parent.parent / "specs" / "data" / "routes.csv"
CASES = [("B1", "b1", flight.b1), ("B2", "b2", flight.b2), ("B3", "b3", flight.b3)]
HEAD = (
    "| case | l | solver | solved | least objective | there | median objective | median ms | iterations |\n"
    "|---|---|---|---|---|---|---|---|---|"
)


def routes():
    """Way-points between start and target, one list a route."""
    lines = [line for line in ROUTES.read_text().splitlines() if not line.startswith("#")][1:]
    numbers = [[float(field) for field in line.split(",") if field] for line in lines]
    return [list(zip(row[::2], row[1::2])) for row in numbers]


def chosen(options):
    for name, case, make in CASES:
        for intervals in (8, 32):
            if not options.only or f"{name}/l={intervals}".lower().startswith(tuple(w.lower() for w in options.only)):
                yield name, case, make, intervals


def run(server, options):
    """Prints the table as it goes, and gives everything that was found."""
    found = {}
    print(HEAD, flush=True)
    for name, case, make, intervals in chosen(options):
        ways, answers = routes(), {}
        if "ntg" in options.by:
            answers["ntg"] = [ask(server, "ntg", case, intervals, way) for way in ways]
        if "ripopt" in options.by:
            answers["ripopt"] = [ask(server, "ripopt", case, intervals, way) for way in ways]
        if "ipopt" in options.by:
            answers["IPOPT"] = by_ipopt(make, intervals, ways, "sx" if options.skip_compiled else "mc")
        found[f"{name}/l={intervals}"] = {"answers": answers}
        print("\n".join(lines({f"{name}/l={intervals}": found[f"{name}/l={intervals}"]})), flush=True)
    return found


def lines(found):
    """The table's lines, from everything that was found."""
    for case, what in found.items():
        answers, (name, intervals) = what["answers"], case.split("/l=")
        best = min((a["objective"] for every in answers.values() for a in every if a["solved"]), default=float("nan"))
        for solver, every in answers.items():
            yield line(name, intervals, solver, every, best)


def ask(server, by, case, intervals, way):
    return server.ask(by, {"case": case, "intervals": intervals, "route": points(way)}, seconds=0, solves=1)


def points(way):
    first, *_, last = whole_route((0, 0))
    return [first, *map(list, way), last]


def by_ipopt(make, intervals, ways, kind):
    solver, answers = Solver(make(intervals=intervals), kind), []
    for way in ways:
        solver.start = ca.DM(make(intervals=intervals, route=way).start)
        answers.append(solver.once())
    return answers


def line(name, intervals, solver, every, best):
    solved = [answer for answer in every if answer["solved"]]
    there = sum(abs(answer["objective"] / best - 1) < AGREES for answer in solved)
    median = lambda values: statistics.median(values) if solved else float("nan")
    cells = [
        name,
        intervals,
        solver,
        f"{len(solved)} of {len(every)}",
        f"{min((a['objective'] for a in solved), default=float('nan')):.6f}",
        str(there),
        f"{median(a['objective'] for a in solved):.6f}",
        f"{1e3 * median(a['cpu'][0] for a in solved):.3g}",
        f"{median(a['iterations'] for a in solved):.0f}",
    ]
    return "| " + " | ".join(cells) + " |"
