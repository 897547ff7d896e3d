"""Where the search begins."""
import json

import casadi as ca
import numpy as np


class Guesses:
    """Fills `w0` from the guess of the spec, or from a saved solution."""

    def guess(self):
        given, done = {}, set()
        items = []
        for owner, ph in [(self.body, None)] + [(p["body"], p) for p in self.phases]:
            for s in owner:
                if s[0] == "guess":
                    items += [(g, loc, ph) for g, loc in self.relations(s[1], ph["loc"] if ph else None)]
        total = {}
        for g, loc, ph in items:  # Durations and variables first.
            if g[0] != "set":
                continue
            tgt = g[1]
            if tgt[0] == "call" and tgt[1] == "duration":
                p = self.phase_of(tgt[2][0][1][-1], {"__locals": loc})
                if "dvar" in p:
                    p["d0"] = float(self.ev(g[2], {"__locals": loc}))
                    self.w0[p["dvar"]] = np.array([p["d0"]])
            elif tgt[0] == "name" and len(tgt[1]) == 1:
                name, index = tgt[1][0]
                i = None if index is None else int(round(float(self.ev(index, {"__locals": loc}))))
                if (name, i) in self.vars:
                    v = float(self.ev(g[2], {"__locals": loc}))
                    for n, sym in enumerate(self.w):
                        if sym is self.vars[(name, i)]:
                            self.w0[n] = np.array([v])
                            for p in self.phases:
                                if p.get("dvar") == n:
                                    p["d0"] = v
                    total[name] = v
        if len(self.phases) > 1:
            names = [s[1] for s in self.body if s[0] == "duration"]
            if names and names[0] in total:
                pass
        durs = np.array([p["d0"] for p in self.phases])
        starts = np.concatenate([[0], np.cumsum(durs)])
        for n, p in enumerate(self.phases):
            for key, sp in p["spline"].items():
                f = None
                for g, loc, ph in items:
                    if ph is not None and ph is not p:
                        continue
                    hit = self.guess_function(g, loc, key, p, None if ph is p or len(self.phases) == 1 else (starts, n))
                    if hit is not None:
                        f = hit
                if f is None:
                    f = self.line(p, key)
                x = np.concatenate([np.linspace(a + 1e-9, b - 1e-9, max(12, sp.order * 2)) for a, b in zip(sp.knots[:-1], sp.knots[1:])])
                y = np.array([f(v) for v in x])
                A = np.array(ca.DM(sp.matrix(x, np.ones(len(x)), 0)))
                self.w0[p["coef"][key][0]] = np.linalg.lstsq(A, y, rcond=None)[0] / p["coef"][key][2]
        del done, given

    def guess_function(self, g, loc, key, p, whole):
        def to_tau(tau):
            if whole is None:
                return tau
            starts, n = whole
            return (starts[n] + tau * (starts[n + 1] - starts[n])) / starts[-1]
        if g[0] == "set":
            tgt = g[1]
            if tgt[0] != "name" or len(tgt[1]) != 1:
                return None
            name, index = tgt[1][0]
            i = None if index is None else int(round(float(self.ev(index, {"__locals": loc}))))
            if (name, i) != key:
                return None

            def f(tau):
                d = {n: q["d0"] for n, q in enumerate(self.phases)}
                c = {"__locals": dict(loc, tau=to_tau(tau), t=tau * p["d0"])}
                c["vars"] = {(q["dname"], None): q["d0"] for q in self.phases if q["dname"]}
                c["dur"] = d
                return float(self.ev(g[2], c))
            return f
        names = [g[1]] if g[1][0] == "name" else g[1][1]
        keys = [(t[1][0][0], None if t[1][0][1] is None else int(round(float(self.ev(t[1][0][1], {"__locals": loc}))))) for t in names]
        if key not in keys:
            return None
        pts = np.array([np.atleast_1d(self.ev(q, {"__locals": loc})) for q in g[2]], float)
        if pts.shape[0] == 1 or pts.ndim == 1:
            pts = pts.reshape(len(g[2]), -1)
        s = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(pts, axis=0), axis=1))])
        s = s / s[-1] if s[-1] > 0 else np.linspace(0, 1, len(s))
        col = keys.index(key)
        return lambda tau: float(np.interp(to_tau(tau), s, pts[:, col]))

    def line(self, p, key):
        """A straight line between fixed ends; where one end is free, constant; else the middle of its bounds."""
        ends = {}
        for which, ph in (("initial", self.phases[0]), ("final", self.phases[-1])):
            for s in self.body + ph["body"]:
                if s[0] != which:
                    continue
                for r, loc in self.relations(s[1]):
                    if r[2][0] == "name" and r[1] is r[3]:
                        name, index = r[2][1][0]
                        i = None if index is None else int(round(float(self.ev(index, {"__locals": loc}))))
                        try:
                            if (name, i) == key:
                                ends[which] = self.number(r[1], loc)
                        except Exception:
                            pass
        if not ends:
            for s in self.body + p["body"]:
                if s[0] == "trajectory":
                    for r, loc in self.relations(s[1]):
                        if r[0] == "relation" and r[2][0] == "name" and r[2][1][0][0] == key[0]:
                            try:
                                lo, hi = self.number(r[1], loc), self.number(r[3], loc)
                                return lambda tau: 0.5 * (lo + hi)
                            except Exception:
                                pass
            return lambda tau: 0.0
        a = ends.get("initial", ends.get("final"))
        b = ends.get("final", a)
        return lambda tau: a + (b - a) * tau

    def start_from(self, saved):
        """Takes the point that `ntg solve --save` wrote, by its samples: is it a minimum of the program as read here?"""
        o = json.load(open(saved))

        def entry(quantities, key):
            """A saved quantity, or one element of a vector: its entry with its own values."""
            one = quantities.get(key[0])
            if one is None or key[1] is None:
                return one
            at = key[1] - one.get("first", 1)
            value = [v[at] for v in one["value"]] if "t" in one else one["value"][at]
            return {**one, "value": value}

        for p, q in zip(self.phases, o["phases"]):
            begin, length = q["start"], q["end"] - q["start"]
            if "dvar" in p:
                self.w0[p["dvar"]] = np.array([length])
            for key, sp in p["spline"].items():
                a = entry(o["outputs"], key)
                t, v = np.array(a["t"]), np.array(a["value"], float) * a["factor"]
                x = np.concatenate([np.linspace(lo + 1e-6 * (hi - lo), hi - 1e-6 * (hi - lo), 9) for lo, hi in zip(sp.knots[:-1], sp.knots[1:])])
                y = np.interp(begin + length * x, t, v)
                A = np.array(ca.DM(sp.matrix(x, np.ones(len(x)), 0)))
                self.w0[p["coef"][key][0]] = np.linalg.lstsq(A, y, rcond=None)[0] / p["coef"][key][2]
        for (name, i), sym in self.vars.items():
            for n, w in enumerate(self.w):
                v = entry(o["variables"], (name, i))
                if w is sym and v is not None:
                    self.w0[n] = np.array([v["value"] * v.get("factor", 1) if isinstance(v, dict) else v], float)
        self.attempts = 1
