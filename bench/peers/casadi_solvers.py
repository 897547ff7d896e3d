"""CasADi's solvers on a `peers.program.Program`.

| name | what it is |
|---|---|
| sx | IPOPT, one big scalar expression |
| mx | IPOPT, each formula a function that is mapped over its points |
| c | as sx, translated to C and compiled by gcc -O3, kept in bench/cache |
| mc | as mx, translated and compiled likewise: the code does not grow with the points |
| sqp | CasADi's sqpmethod with BFGS on DAQP |
| sqpx | the same with exact Hessians, their negative eigenvalues clipped |
"""

import contextlib
import hashlib
import subprocess
import tempfile
import time
from pathlib import Path

import casadi as ca
import numpy as np
import scipy.sparse as sp

EXPRESSION = {"mx": "mx", "mc": "mx"}  # One scalar expression for all other kinds.
CLOCKS = ("wall", "cpu", "alone")  # Of a call; the last is FATROP's, without evaluations.
CACHE = Path(__file__).resolve().parent.parent / "cache"
IPOPT = {"ipopt.print_level": 0, "ipopt.sb": "yes", "print_time": False, "ipopt.tol": 1e-8}
SQP = {
    "qpsol": "daqp",
    "print_header": False,
    "print_iteration": False,
    "print_status": False,
    "print_time": False,
    "tol_pr": 1e-8,
    "tol_du": 1e-8,
    "max_iter": 500,
    "error_on_fail": False,
    "qpsol_options": {"error_on_fail": False},
}


def sparse(matrix):
    matrix = sp.csc_matrix(matrix)
    matrix.eliminate_zeros()
    return ca.DM(matrix)


def expressions(program, kind, sizes):
    """The program as CasADi's `x, p, f, g` and the bounds of `g`; `x` counts in `sizes`."""
    symbol = ca.SX if kind == "sx" else ca.MX
    x = symbol.sym("x", program.variables)
    p = symbol.sym("p", len(program.steps[0]))
    objective, rows, lower, upper = 0, [], [], []
    for number, group in enumerate(program.groups):
        slots, points = len(group.slots), group.points
        u, q = ca.SX.sym("u", slots), ca.SX.sym("p", len(program.steps[0]))
        cost, constraints = group.formula(u, q)
        outputs = ([cost] if cost is not None else []) + ([ca.vertcat(*constraints)] if constraints else [])
        function = ca.Function(f"group{number}", [u, q], outputs)
        at = ca.mtimes(sparse(group.matrix(program.variables) @ sp.diags(sizes)), x) + ca.DM(group.offset())
        if kind == "sx":
            found = [function.call([at[i * slots : (i + 1) * slots], p]) for i in range(points)]
            found = [ca.horzcat(*parts) for parts in zip(*found)]
        else:
            mapped = function.map(points) if points > 1 else function
            found = mapped.call([ca.reshape(at, slots, points), ca.repmat(p, 1, points)])
        if cost is not None:
            objective = objective + ca.mtimes(found[0], ca.DM(group.weights))
        if constraints:
            rows.append(ca.vec(found[-1]))
            lower += list(group.lower) * points
            upper += list(group.upper) * points
    return {"x": x, "p": p, "f": objective, "g": ca.vertcat(*rows)}, np.array(lower), np.array(upper)


class Solver:
    """One of CasADi's solvers on one program; `seconds_to_build` is not part of any comparison.
    `end` is where the last solve ended: parameters, point and multipliers of the rows, for the judge.
    `said` are the solver's statistics of each of its steps."""

    def __init__(self, program, kind, scaled=False):
        began = time.perf_counter()
        self.sizes = program.sizes() if scaled else np.ones(program.variables)
        nlp = self.state(program, *expressions(program, EXPRESSION.get(kind, "sx"), self.sizes))
        if kind in ("sx", "mx"):
            self.solver = ca.nlpsol("solver", "ipopt", nlp, IPOPT)
        elif kind in ("c", "mc"):
            self.solver = ca.nlpsol("solver", "ipopt", str(compiled(nlp)), IPOPT)
        else:
            exact = {"hessian_approximation": "exact", "convexify_strategy": "eigen-clip"}
            kinds = {"sqp": {"hessian_approximation": "limited-memory"}, "sqpx": exact}
            self.solver = ca.nlpsol("solver", "sqpmethod", nlp, SQP | kinds[kind])
        self.seconds_to_build = time.perf_counter() - began

    def state(self, program, nlp, lower, upper):
        """Keeps what a call needs beside the solver."""
        self.arguments = {
            "lbx": ca.DM(program.lower / self.sizes),
            "ubx": ca.DM(program.upper / self.sizes),
            "lbg": ca.DM(lower),
            "ubg": ca.DM(upper),
        }
        self.start = ca.DM(program.start / self.sizes)
        self.steps = [ca.DM(step) if step else ca.DM(0, 1) for step in program.steps]
        self.functions = ca.Function("fg", [nlp["x"], nlp["p"]], [nlp["f"], nlp["g"]])
        return nlp

    def once(self):
        """All steps of the continuation, each solution the guess of the next; only the calls are timed."""
        x, wall, cpu, iterations, self.said = self.start, 0.0, 0.0, 0, []
        for p in self.steps:
            clocks = time.perf_counter(), time.process_time()
            found = self.solver(x0=x, p=p, **self.arguments)
            wall += time.perf_counter() - clocks[0]
            cpu += time.process_time() - clocks[1]
            stats = self.solver.stats()
            iterations += stats.get("iter_count", 0)
            self.said.append(stats)
            x = found["x"]
        self.end = p, np.array(x).ravel() * self.sizes, np.array(found["lam_g"]).ravel()
        return {
            "wall": [wall],
            "cpu": [cpu],
            "objective": float(found["f"]),
            "solved": bool(stats["success"]),
            "status": stats["return_status"],
            "iterations": iterations,
        }

    def answer(self, seconds, solves):
        """Solves again until there is enough to tell a median."""
        answers = [self.once()]
        while len(answers) < solves and sum(answer["wall"][0] for answer in answers) < seconds:
            answers.append(self.once())
        clocks = {clock: [answer[clock][0] for answer in answers] for clock in CLOCKS if clock in answers[-1]}
        return answers[-1] | clocks

    def at_start(self):
        """The objective at the first point, in each step of the continuation."""
        return [float(self.functions(self.start, p)[0]) for p in self.steps]


def compiled(nlp, plugin="ipopt", options=IPOPT):
    """The shared library of a program's functions, from the cache or by gcc."""
    CACHE.mkdir(exist_ok=True)
    solver = ca.nlpsol("solver", plugin, nlp, options)
    with tempfile.TemporaryDirectory(dir=CACHE) as folder, contextlib.chdir(folder):
        solver.generate_dependencies("nlp.c")
        # CasADi copies nothing to nowhere where a formula has no parameter; gcc wants to know it is meant.
        command = ["gcc", "-O3", "-w", "-fPIC", "-shared", "-o", "nlp.so", "nlp.c", "-lm"]
        text = Path("nlp.c").read_bytes() + " ".join(command).encode()
        library = CACHE / f"{hashlib.sha256(text).hexdigest()[:24]}.so"
        if not library.exists():
            began = time.perf_counter()
            subprocess.run(command, check=True)
            Path("nlp.so").rename(library)
            print(f"    gcc -O3 took {time.perf_counter() - began:.0f} s", flush=True)
    return library
