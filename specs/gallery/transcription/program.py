"""The nonlinear program: unknowns, constraints and objective of a spec."""
import math

import casadi as ca
import numpy as np

from .meaning import Meaning
from .splines import Spline, gauss


class Program(Meaning):
    """Builds the program; `w`, `gc` and `objective` are CasADi values, the rest numbers."""

    def build(self):
        body = self.body
        families = [s for s in body if s[0] == "phase"]
        self.phases = []
        if not families:
            self.phases.append({"name": "", "index": None, "body": [], "after": None, "loc": {}})
        for s in families:
            if s[2]:
                idx = range(int(self.number(s[2][1])), int(self.number(s[2][2])) + 1)
            else:
                idx = [None]
            for i in idx:
                self.phases.append({"name": s[1], "index": i, "body": s[4], "after_path": s[3], "loc": {s[2][0]: i} if s[2] else {}})
        if families:
            for n, ph in enumerate(self.phases):
                ph["after"] = self.phases[n - 1] if n else None  # The gallery writes its phases in their order.
        self.w, self.lbw, self.ubw, self.w0 = [], [], [], []
        self.gc, self.lbg, self.ubg = [], [], []
        self.vars = {}
        for s in body:
            if s[0] == "variable":
                for name, rng, unit in s[1]:
                    lo = -math.inf if s[2] is None else self.number(s[2])
                    hi = math.inf if s[3] is None else self.number(s[3])
                    idx = [None] if not rng else range(int(self.number(rng[1])), int(self.number(rng[2])) + 1)
                    for i in idx:
                        self.vars[(name, i)] = self.add("v_%s" % name, 1, lo, hi, middle(lo, hi))
        self.durations, self.var_syms, self.dur_syms = {}, {}, {}
        for n, ph in enumerate(self.phases):
            ph["id"] = n
            d = [s for s in ph["body"] if s[0] == "duration"] or ([s for s in body if s[0] == "duration"] if not families else [])
            c = {"__locals": ph["loc"], "vars": self.vars}
            s = d[0] if d else ("duration", None, None, None)
            ph["dname"] = s[1]
            if s[2] is not None and s[2] is s[3]:
                self.durations[n] = ca.MX(ca.DM(self.ev(s[2], c)))
                ph["d0"] = float(self.ev(s[2], c))
            else:
                lo = 0 if s[2] is None else float(self.ev(s[2], c))
                hi = math.inf if s[3] is None else float(self.ev(s[3], c))
                ph["d0"] = middle(lo, hi)
                ph["dvar"] = len(self.w)
                self.durations[n] = self.add("T%d" % n, 1, max(lo, 0), hi, ph["d0"])
            if ph["dname"]:
                self.vars[(ph["dname"], None)] = self.durations[n]
        if families:
            for s in body:
                if s[0] == "duration":
                    total = sum(self.durations.values())
                    self.vars[(s[1], None)] = total
                    lo, hi = (self.number(s[2]), self.number(s[3]))
                    self.constrain(total, lo, hi)
        for ph in self.phases:
            self.build_phase(ph)
        for ph in self.phases:
            if ph["after"]:
                self.join(ph["after"], ph)
        self.objective = 0
        self.sense = 1
        for s in body:
            if s[0] == "objective":
                self.sense = s[1]
                self.objective += self.ev(s[2], self.event())
            elif s[0] == "temporal":
                self.event_block(s[1], None, None)
            elif s[0] == "initial":
                self.event_block(s[1], self.phases[0], "initial")
            elif s[0] == "final":
                self.event_block(s[1], self.phases[-1], "final")
        for ph in self.phases:
            for s in ph["body"]:
                if s[0] == "objective":
                    self.sense = s[1]
                    self.objective += self.ev(s[2], self.event(ph))
                elif s[0] in ("initial", "final"):
                    self.event_block(s[1], ph, s[0])
                elif s[0] == "temporal":
                    self.event_block(s[1], None, None)
        self.guess()

    def event(self, own=None, loc=None):
        return {"__locals": dict(loc or {}, **(own["loc"] if own else {})), "vars": self.vars, "dur": self.durations, "event": True, "own": own}

    def add(self, name, n, lo, hi, start):
        v = ca.MX.sym(name, n)
        self.w.append(v)
        self.lbw.append(np.full(n, lo))
        self.ubw.append(np.full(n, hi))
        self.w0.append(np.full(n, float(start)) if np.isscalar(start) else start)
        return v

    def constrain(self, e, lo, hi):
        n = e.numel()
        self.gc.append(ca.reshape(e, n, 1))
        self.lbg.append(np.full(n, lo) if np.isscalar(lo) else np.asarray(lo).ravel())
        self.ubg.append(np.full(n, hi) if np.isscalar(hi) else np.asarray(hi).ravel())

    def build_phase(self, ph):
        specs = [s for s in self.body + ph["body"] if s[0] == "output"]
        chosen = {}
        for s in specs:
            unit = 1.0
            for name, rng, own in reversed(s[1]):  # A name without a unit takes that of the next one that has one.
                unit = own or unit
                idx = [None] if not rng else range(int(self.number(rng[1])), int(self.number(rng[2])) + 1)
                for i in idx:
                    chosen[(name, i)] = (s[2], unit)
        S = self.symbols
        ph["spline"], ph["coef"], ph["sym"], ph["flat"] = {}, {}, {}, []
        ph["lets"] = dict(self.lets)
        for s in ph["body"]:
            if s[0] == "let":
                ph["lets"][s[1]] = s
        knots_all = set()
        for key, (opt, unit) in sorted(chosen.items(), key=str):
            k = int(self.number(opt["order"]))
            if "knots" in opt:
                knots = self.number(opt["knots"])
            else:
                knots = list(np.linspace(0, 1, int(self.number(opt["intervals"])) + 1))
            if self.refine > 1:
                knots = sorted({round(float(a + (b - a) * i / self.refine), 14) for a, b in zip(knots[:-1], knots[1:]) for i in range(self.refine + 1)})
            m = int(self.number(opt["smoothness"])) if "smoothness" in opt else k - 1
            sp = Spline(k, knots, m)
            ph["spline"][key] = sp
            ph["coef"][key] = (len(self.w), unit * self.add("c_%s_%s" % key, sp.n, -math.inf, math.inf, 0.0), unit)
            ph["sym"][key] = [S.sym("%s_%s_%d" % (key[0], key[1], j)) for j in range(k)]
            ph["flat"] += ph["sym"][key]
            knots_all |= {round(x, 12) for x in knots}
        ph["t"], ph["tau"], ph["T"] = S.sym("t"), S.sym("tau"), S.sym("T")
        ph["dsym"] = {n: S.sym("d%d" % n) for n in self.durations}
        ph["vsym"] = {key: S.sym("p") for key in self.vars}
        ph["dsym"][ph["id"]] = ph["T"]
        if ph["dname"]:
            ph["vsym"][(ph["dname"], None)] = ph["T"]
        col = [s for s in ph["body"] if s[0] == "collocation"] or [s for s in self.body if s[0] == "collocation"] or [("collocation", "gauss", {})]
        kind, opt = col[0][1], {k: int(self.number(v)) for k, v in col[0][2].items()}
        kn = sorted(knots_all)
        h = np.diff(kn)
        if kind == "uniform":
            n = (opt["breakpoints"] - 1) * self.refine + 1
            x = np.linspace(0, 1, n)
            w = np.full(n, 1 / (n - 1))
            w[[0, -1]] /= 2
            s = np.where(x > 1 - 1e-9, -1, 1)
            ph["int"], ph["eq"], ph["ineq"] = (x, s, w), (x, s), (x, s)
        else:
            n = opt.get("points", 5)
            x, w, s = gauss(kn, h, n)
            xe, _, se = gauss(kn, h, opt.get("equalities", n))
            ends = [(a, 1) for a in kn[:-1]] + [(b, -1) for b in kn[1:]]
            ph["int"], ph["eq"] = (x, s, w), (xe, se)
            ph["ineq"] = (np.concatenate([x, [e[0] for e in ends]]), np.concatenate([s, [e[1] for e in ends]]))
        # Template trajectory constraints and those of the phase.
        ctx = self.traj(ph)
        eqs, ineqs = [], []
        for owner in (self.body, ph["body"]):
            for s in owner:
                if s[0] != "trajectory":
                    continue
                for r, loc in self.relations(s[1], ph["loc"]):
                    _, lo, e, hi = r
                    cc = dict(ctx, __locals=loc)
                    if lo is hi:
                        eqs.append((self.ev(e, cc) - self.ev(lo, cc), 0, 0))
                        continue
                    v = self.ev(e, cc)
                    a = None if lo is None else self.ev(lo, cc)
                    b = None if hi is None else self.ev(hi, cc)
                    if isinstance(a, (int, float, type(None))) and isinstance(b, (int, float, type(None))):
                        if a is not None and a == b:
                            eqs.append((v - a, 0, 0))
                        else:
                            ineqs.append((v, -math.inf if a is None else a, math.inf if b is None else b))
                    else:
                        if a is not None:
                            ineqs.append((v - a, 0, math.inf))
                        if b is not None:
                            ineqs.append((v - b, -math.inf, 0))
        for rows, (x, s) in ((eqs, ph["eq"]), (ineqs, ph["ineq"])):
            if rows:
                v = self.on(ph, [r[0] for r in rows], x, s)
                self.constrain(v, np.repeat([[r[1]] for r in rows], len(x), axis=1).ravel(order="F"),
                               np.repeat([[r[2]] for r in rows], len(x), axis=1).ravel(order="F"))

    def traj(self, ph, loc=None):
        return {"__locals": dict(loc or {}, **ph["loc"]), "phase": ph, "vars": ph["vsym"], "dur": ph["dsym"], "__cache": ph.setdefault("cache", {})}

    def on(self, ph, exprs, x, s):
        """Values of expressions (rows) at points (columns)."""
        S = self.symbols
        T = self.durations[ph["id"]]
        rows = []
        for key, sp in ph["spline"].items():
            for j in range(sp.order):
                rows.append((ca.mtimes(sp.matrix(x, s, j), ph["coef"][key][1]) / T ** j).T)
        start = sum([self.durations[q] for q in self.before(ph)], ca.MX(0))
        t = start + T * ca.DM(np.asarray(x)).T
        n = len(x)
        dur = ca.repmat(ca.vertcat(*[d for d in self.durations.values()]), 1, n)
        keys = [k for k in ph["vsym"] if ph["vsym"][k] is not ph["T"]]
        var = ca.repmat(ca.vertcat(*[self.vars[k] for k in keys]), 1, n) if keys else ca.MX(0, n)
        f = ca.Function("f", [ca.vertcat(*ph["flat"]), ph["t"], ph["tau"], ca.vertcat(*ph["dsym"].values()),
                              ca.vertcat(*[ph["vsym"][k] for k in keys]) if keys else S(0, 1)],
                        [ca.vertcat(*[S(e) if isinstance(e, (int, float)) else e for e in exprs])])
        return f.map(n)(ca.vertcat(*rows), t, ca.DM(np.asarray(x)).T, dur, var)

    def before(self, ph):
        out, q = [], ph["after"]
        while q is not None:
            out.append(q["id"])
            q = q["after"]
        return out

    def total(self, ph, e, c):
        v = self.ev(e, self.traj(ph, c["__locals"]))
        x, s, w = ph["int"]
        return ca.mtimes(self.on(ph, [v], x, s), ca.DM(w)) * self.durations[ph["id"]]

    def at_end(self, ph, e, which, c):
        v = self.ev(e, self.traj(ph, c["__locals"]))
        return self.on(ph, [v], [0.0 if which == "initial" else 1.0], [1 if which == "initial" else -1])

    def event_block(self, block, ph, which):
        for r, loc in self.relations(block, ph["loc"] if ph else None):
            _, lo, e, hi = r
            c = self.event(ph, loc)

            def value(x):
                if x is None:
                    return None
                if which:
                    try:
                        return self.ev(x, {"__locals": loc})  # A number.
                    except Exception:
                        pass
                    if has_event(x):
                        return self.ev(x, c)
                    return self.at_end(ph, x, which, c)
                return self.ev(x, c)
            v, a, b = value(e), value(lo), value(hi)
            if isinstance(a, (int, float, type(None))) and isinstance(b, (int, float, type(None))):
                self.constrain(ca.MX(v), -math.inf if a is None else a, math.inf if b is None else b)
            elif lo is hi:
                self.constrain(ca.MX(v - a), 0, 0)
            else:
                if a is not None:
                    self.constrain(ca.MX(v - a), 0, math.inf)
                if b is not None:
                    self.constrain(ca.MX(v - b), -math.inf, 0)

    def join(self, a, b):
        jump = {n for s in b["body"] if s[0] == "jump" for n in s[1]}
        upto = {n: (None if s[2] is None else int(self.number(s[2]))) for s in b["body"] if s[0] == "continuous" for n in s[1]}
        for key in b["spline"]:
            if key not in a["spline"] or key[0] in jump:
                continue
            m = min(a["spline"][key].smooth, b["spline"][key].smooth)
            if key[0] in upto:
                m = upto[key[0]] + 1 if upto[key[0]] is not None else m
            for j in range(m):
                va = ca.mtimes(a["spline"][key].matrix([1.0], [-1], j), a["coef"][key][1]) / self.durations[a["id"]] ** j
                vb = ca.mtimes(b["spline"][key].matrix([0.0], [1], j), b["coef"][key][1]) / self.durations[b["id"]] ** j
                self.constrain(va - vb, 0, 0)

    # Guesses.


def has_event(e):
    if isinstance(e, tuple) and e and e[0] == "call" and e[1] in ("integral", "initial", "final", "start", "end", "duration"):
        return True
    return isinstance(e, (tuple, list)) and any(has_event(x) for x in e)


def middle(lo, hi):
    if math.isinf(lo) and math.isinf(hi):
        return 0.0
    if math.isinf(hi):
        return lo + 1
    if math.isinf(lo):
        return hi - 1
    return math.sqrt(lo * hi) if lo > 0 and hi > 10 * lo else 0.5 * (lo + hi)
