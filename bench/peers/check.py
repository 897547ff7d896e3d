"""bench/run --check: are the peers' programs ntg's programs, and the known optima theirs?"""

import numpy as np

from .casadi_solvers import Solver
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
    end = solver.once()
    if not end["solved"]:
        found.append(f"IPOPT says {end['status']}")
    elif row.reference is not None and abs(end["objective"] / row.reference - 1) > AGREES:
        found.append(f"IPOPT finds {end['objective']!r} instead of {row.reference!r}")
    return found
