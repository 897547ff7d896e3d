"""bench/run --check: are the peers' programs ntg's programs, and the known optima theirs?"""

import casadi as ca
import numpy as np

from .casadi_solvers import IPOPT, Solver
from .chain import NoChain
from .fatrop_solver import Chained
from .table import AGREES

SAME_START = 1e-9  # Relative; both fits solve least-squares problems.


def check(row, server):
    """Findings about a row; none is good."""
    program = row.program()
    solver = Solver(program, "sx")
    found = []
    described = server.ask("start", row.ask)
    if len(described) != len(program.steps):
        found.append(f"{len(program.steps)} steps, ntg has {len(described)}")
    ours = described[0]
    for what, here in (("variables", program.variables), ("rows", program.rows)):
        if ours[what] != here:
            found.append(f"{here} {what}, ntg has {ours[what]}")
    # The order of the variables differs, so the starts are compared sorted.
    here, there = np.sort(np.array(program.start) * program.units), np.sort(ours["start"])
    if here.shape == there.shape:
        off = np.abs(here - there).max() / np.abs(there).max()
        if off > SAME_START:
            found.append(f"the starts differ by {off:.1e}")
    for here, step in zip(solver.at_start(), described):
        if abs(here - step["objective"]) > SAME_START * max(abs(here), 1):
            found.append(f"objective at the start {here!r}, ntg has {step['objective']!r}")
    return found + optimum(row, solver, "IPOPT") + check_chain(row, program, solver)


def check_chain(row, program, solver):
    """The chain form at a random point near the start, with the program's own functions; and IPOPT's optimum of it."""
    try:
        chained = Chained(program, "sx", False)
    except NoChain as why:
        return [f"no chain form: {why}"]
    chain, found = chained.chain, []
    away = np.random.default_rng(1).uniform(-0.01, 0.01, program.variables)
    v = np.asarray(program.start) + away * program.sizes()
    for p in solver.steps:
        objective, rows = [np.array(values).ravel() for values in solver.functions(v, p)]
        objective_there, all_there = [np.array(values).ravel() for values in chained.functions(chain.spread(v), p)]
        dynamics, rows_there = chain.split(all_there)
        pairs = [("objective", objective, objective_there), ("rows", rows, rows_there), ("dynamics", 0 * dynamics, dynamics)]
        for what, one, other in pairs:
            off = np.abs(one - other).max() / max(np.abs(one).max(), 1)
            if not off <= SAME_START:
                found.append(f"{what} of the chain: off by {off:.1e}")
    for what in ("lower", "upper"):
        one, other = (np.sort(np.array(getattr(side, what))) for side in (program, chain.program))
        if not np.array_equal(one[np.isfinite(one)], other[np.isfinite(other)]):
            found.append(f"the chain has other {what} bounds")
    chained.solver = ca.nlpsol("solver", "ipopt", chained.nlp, IPOPT)
    return found + optimum(row, chained, "IPOPT on the chain form")


def optimum(row, solver, who):
    """Findings about where a solver ends."""
    end = solver.once()
    if not end["solved"]:
        return [f"{who} says {end['status']}"]
    if row.reference is not None and abs(end["objective"] / row.reference - 1) > AGREES:
        return [f"{who} finds {end['objective']!r} instead of {row.reference!r}"]
    return []
