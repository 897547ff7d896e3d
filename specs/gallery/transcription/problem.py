"""A spec as a program that IPOPT solves."""
import os
import time

import casadi as ca
import numpy as np

from .guesses import Guesses
from .program import Program
from .reader import Parser
from .tables import table


class Problem(Program, Guesses):
    """Read from a file; `refine` splits every knot interval."""

    def __init__(self, path, refine=1):
        self.dir, self.refine, self.attempts = os.path.dirname(path), refine, 4
        p = Parser(open(path).read())
        self.body = p.statement()[2]
        self.consts, self.fns, self.tables, self.lets, self.symbols = {}, {}, {}, {}, ca.SX
        self.extra = {}
        for s in self.body:
            if s[0] == "fn":
                self.fns[s[1]] = s
            elif s[0] == "table":
                self.tables[s[1]] = table(self, s)
            elif s[0] in ("const", "param"):
                self.consts[s[1]] = s
            elif s[0] == "let":
                self.lets[s[1]] = s
        self.build()

    def minima(self, starts, iterations):
        """The local minima that IPOPT reaches from the guess and from perturbed ones, the best first."""
        rng, begin, found = np.random.default_rng(1), [np.array(v) for v in self.w0], []
        self.attempts = 1
        for k in range(starts):
            if k:
                scale = 0.4 * rng.random()
                self.w0 = [v + scale * rng.standard_normal(len(v)) * max(0.3 * np.max(np.abs(v)), 0.03) for v in begin]
            status, f, _, _, viol = self.solve(iterations)
            if status == "Solve_Succeeded" and viol < 1e-6:
                for m in found:
                    if near(m[0], f):
                        m[1] += 1
                        break
                else:
                    found.append([f, 1])
        return sorted(found, key=lambda m: self.sense * m[0])

    def solve(self, iterations=1000, options=None):
        options = dict(options or {})
        w, g = ca.vertcat(*self.w), ca.vertcat(*self.gc) if self.gc else ca.MX(0, 1)
        lbg, ubg = np.concatenate(self.lbg), np.concatenate(self.ubg)
        opts = {"ipopt.print_level": 0, "print_time": 0, "ipopt.tol": 1e-10, "ipopt.max_iter": iterations, "ipopt.sb": "yes",
                "ipopt.max_cpu_time": 40.0, "ipopt.bound_relax_factor": 1e-11, "ipopt.constr_viol_tol": 1e-9}
        opts.update(options or {})
        began, start, lo, hi = time.time(), np.concatenate(self.w0), np.concatenate(self.lbw), np.concatenate(self.ubw)
        rng, count = np.random.default_rng(1), 0
        for attempt in range(self.attempts):  # The guess as it is; then another barrier strategy; then perturbed guesses.
            if attempt:
                opts["ipopt.mu_strategy"] = "adaptive" if attempt % 2 else "monotone"
            x0 = start if attempt < 2 else start + 0.1 * (attempt - 1) * rng.standard_normal(len(start)) * (np.abs(start) + 0.1)
            s = ca.nlpsol("s", "ipopt", {"x": w, "f": self.sense * self.objective, "g": g}, opts)
            r = s(x0=x0, lbx=lo, ubx=hi, lbg=lbg, ubg=ubg)
            count += s.stats()["iter_count"]
            if s.stats()["success"]:
                break
        self.attempt = attempt + 1
        gv = np.array(r["g"]).ravel()
        viol = max(np.max(lbg - gv, initial=0), np.max(gv - ubg, initial=0))
        st = s.stats()
        self.result, self.x = r, np.array(r["x"]).ravel()
        return st["return_status"], self.sense * float(r["f"]), count, time.time() - began, viol


def near(a, b):
    return abs(a - b) <= 1e-6 * max(abs(a), abs(b), 1e-12)
