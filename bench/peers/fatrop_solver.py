"""FATROP (Vanroye and others, arXiv 2303.16746), from CasADi's wheel, on a program's chain form (`peers.chain`).

FATROP does not reach every tolerance on every program. It is asked for 1e-8, then for less, and what counts
is the tightest with which it ends; `peers.judge` says what that point is worth.
"""

import multiprocessing
import signal
import time

import casadi as ca
import numpy as np

from .casadi_solvers import EXPRESSION, Solver, compiled, expressions
from .chain import Chain

TOLERANCES = (1e-8, 1e-6, 1e-4)
LIMIT = 20  # Seconds of processor time that a first solve may take.
EVALUATIONS = ("obj", "grad", "cv", "jac", "hess")


def chained(chain, kind, sizes):
    """The chain as CasADi's `x, p, f, g` and the bounds of `g`, in FATROP's order."""
    nlp, lower, upper = expressions(chain.program, kind, sizes)
    here, after = chain.dynamics
    gaps = nlp["x"][after.tolist()] - nlp["x"][here.tolist()]
    nlp["g"] = ca.vertcat(gaps, nlp["g"])[chain.order.tolist()]
    none = np.zeros(len(here))
    return nlp, np.concatenate([none, lower])[chain.order], np.concatenate([none, upper])[chain.order]


class Chained(Solver):
    """A program's chain form, for any solver."""

    def __init__(self, program, kind, scaled):
        self.chain = Chain(program)
        self.sizes = self.chain.spread(program.sizes() if scaled else np.ones(program.variables))
        self.nlp = self.state(self.chain.program, *chained(self.chain, EXPRESSION.get(kind, "sx"), self.sizes))

    def once(self):
        found = super().once()
        p, z, multipliers = self.end
        self.end = p, self.chain.gather(z), self.chain.split(multipliers)[1]
        return found


class Fatrop(Chained):
    """FATROP with the face of the other solvers; `kind` is one of IPOPT's."""

    def __init__(self, program, kind, scaled, tolerance):
        began = time.perf_counter()
        super().__init__(program, kind, scaled)
        self.tolerance = tolerance
        nlp = str(compiled(self.nlp, "fatrop", self.options())) if kind in ("c", "mc") else self.nlp
        self.solver = ca.nlpsol("solver", "fatrop", nlp, self.options())
        self.seconds_to_build = time.perf_counter() - began

    def options(self):
        chain = self.chain
        shape = {"N": len(chain.nx) - 1, "nx": chain.nx, "nu": chain.nu, "ng": chain.ng}
        own = {"fatrop.print_level": 0, "fatrop.tolerance": self.tolerance}
        return {"structure_detection": "manual", "print_time": False, **shape, **own}

    def once(self):
        found = super().once()
        sizes = [x + u for x, u in zip(self.chain.nx, self.chain.nu)]
        shape = {"stages": len(sizes), "largest": max(sizes)}
        return found | {"alone": [self.alone()], "tolerance": self.tolerance, "chain": shape}

    def alone(self):
        """FATROP's own time without the program's functions, on the wall: it has no other clock."""
        clocks = [stats["fatrop"] for stats in self.said]
        return sum(clock["time_total"] - sum(clock[f"eval_{what}_time"] for what in EVALUATIONS) for clock in clocks)


def best(program):
    """Units and tolerance: the tightest tolerance with which it ends, in the units that take fewer iterations."""
    endings = []
    for tolerance in TOLERANCES:
        found = [(attempt(program, "sx", scaled, tolerance), scaled) for scaled in (False, True)]
        solved = [(answer["iterations"], scaled) for answer, scaled in found if answer["solved"]]
        if solved:
            return min(solved)[1], tolerance
        endings += [f"{answer['status']} with {tolerance:.0e}" for answer, _ in found]
    raise RuntimeError("; ".join(dict.fromkeys(endings)))


def attempt(program, kind, scaled, tolerance):
    """One solve in a process of its own: where its restoration finds no way, FATROP 1.1.8 does not come back."""
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    child = context.Process(target=solve_and_tell, args=(theirs, program, kind, scaled, tolerance))
    child.start()
    theirs.close()
    try:
        return ours.recv()
    except EOFError:
        return {"solved": False, "status": f"no end in {LIMIT} s"}
    finally:
        child.join()


def solve_and_tell(pipe, program, kind, scaled, tolerance):
    """What the process does."""
    try:
        solver = Fatrop(program, kind, scaled, tolerance)
        # The signal that ends the process when its processor time is up.
        signal.setitimer(signal.ITIMER_PROF, LIMIT)
        pipe.send(solver.once())
    except RuntimeError as error:
        pipe.send({"solved": False, "status": str(error).strip().splitlines()[-1]})
