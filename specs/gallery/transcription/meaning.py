"""What expressions mean, at points of a trajectory and of the whole."""
import math

import casadi as ca

FUNCTIONS = {"sqrt": ca.sqrt, "exp": ca.exp, "log": ca.log, "sin": ca.sin, "cos": ca.cos, "tan": ca.tan, "asin": ca.asin,
             "acos": ca.acos, "atan": ca.atan, "sinh": ca.sinh, "cosh": ca.cosh, "tanh": ca.tanh, "atan2": ca.atan2,
             "abs": ca.fabs, "sign": ca.sign, "logistic": lambda u: 1 / (1 + ca.exp(-u)),
             "softplus": lambda u: ca.fmax(u, 0) + ca.log1p(ca.exp(-ca.fabs(u)))}


class Meaning:
    """Evaluates expressions. A context holds the phase for trajectory values, `event` for values of the whole, and `__locals`."""

    def number(self, e, env=None):
        v = self.ev(e, {"__locals": env or {}})
        return float(v) if not isinstance(v, list) else [float(x) for x in v]

    def ev(self, e, c):
        k = e[0]
        if k in ("num", "bare"):
            return e[1]
        if k in "+-*/^" and len(e) == 3:
            a, b = self.ev(e[1], c), self.ev(e[2], c)
            if k == "+":
                return a + b
            if k == "-":
                return a - b
            if k == "*":
                return a * b
            if k == "/":
                return a / b
            if isinstance(b, (int, float)) and float(b).is_integer() and 0 < b <= 8 and not isinstance(a, (int, float)):
                out = a
                for _ in range(int(b) - 1):
                    out = out * a
                return out
            return a ** b
        if k == "neg":
            return -self.ev(e[1], c)
        if k == "tuple":
            return [self.ev(x, c) for x in e[1]]
        if k == "name":
            return self.name(e[1], c)
        if k == "call":
            return self.call(e[1], e[2], c)
        raise NotImplementedError(k)

    def name(self, path, c):
        if len(path) == 2:
            ph = self.phase_of(path[0], c)
            return self.durations[ph["id"]]
        name, index = path[0]
        i = None if index is None else int(round(float(self.ev(index, c))))
        loc = c["__locals"]
        if name in loc:
            v = loc[name]
            return v[i - 1] if i is not None and isinstance(v, list) else v
        if name == "pi":
            return math.pi
        ph = c.get("phase")
        if ph is not None:
            key = (name, i)
            if key in ph["sym"]:
                return ph["sym"][key][0]
            if name in ph["lets"]:
                return self.let(ph["lets"][name], i, c)
            if name == "t":
                return ph["t"]
            if name == "tau":
                return ph["tau"]
        if name in self.consts:
            s = self.consts[name]
            v = self.ev(s[-1], {"__locals": {}})
            return v[i - 1] if i is not None else v
        if c.get("vars") and (name, i) in c["vars"]:
            return c["vars"][(name, i)]
        if name in self.lets:
            return self.let(self.lets[name], i, c)
        raise NameError("%s[%s]" % (name, i))

    def let(self, s, i, c):
        loc = {}
        if s[2] and s[2][0]:
            loc[s[2][0]] = i
        elif s[2]:
            loc = {}
        cache = c.setdefault("__cache", {})
        key = (s[1], i, id(s))
        if key not in cache:
            cache[key] = self.ev(s[3], dict(c, __locals=loc))
            if s[2] and not s[2][0] and i is not None and isinstance(cache[key], list):
                cache[key] = cache[key][i - 1]
        return cache[key]

    def call(self, name, args, c):
        if args and args[0][0] == "loop":
            _, index, a, b = args[0]
            lo, hi = int(round(self.ev(a, c))), int(round(self.ev(b, c)))
            vals = [self.ev(args[1], dict(c, __locals=dict(c["__locals"], **{index: i}))) for i in range(lo, hi + 1)]
            out = vals[0] if vals else (1 if name == "prod" else 0)
            for v in vals[1:]:
                if name == "smooth_max":
                    w = self.ev(args[2], c)
                    out = smooth_max(out, v, w)
                else:
                    out = {"sum": lambda p, q: p + q, "prod": lambda p, q: p * q, "min": ca.fmin, "max": ca.fmax}[name](out, v)
            return out
        if name in ("integral", "initial", "final") and c.get("event"):
            if len(args) == 2:
                phases = [self.phase_of(args[0][1][-1], c)]
            elif c.get("own") is not None:
                phases = [c["own"]]
            else:
                phases = self.phases
            e = args[-1]
            if name == "integral":
                return sum(self.total(ph, e, c) for ph in phases)
            return self.at_end(phases[0] if name == "initial" else phases[-1], e, name, c)
        if name in ("start", "end", "duration"):
            ph = self.phase_of(args[0][1][-1], c)
            chain = []
            q = ph
            while q is not None:
                chain.append(q)
                q = q["after"]
            d = c["dur"]
            if name == "duration":
                return d[ph["id"]]
            return sum([d[q["id"]] for q in (chain if name == "end" else chain[1:])], 0)
        if name == "der":
            j = int(self.number(args[1])) if len(args) > 1 else 1
            e = self.ev(args[0], c)
            for _ in range(j):
                e = self.dt(e, c["phase"])
            return e
        if name == "partial":
            raise NotImplementedError("partial")
        a = [self.ev(x, c) for x in args]
        if name in self.fns:
            _, _, names, body = self.fns[name]
            return self.ev(body, dict(c, __locals=dict(c["__locals"], **dict(zip(names, a)))))
        if name in self.tables:
            return self.tables[name](*a)
        if name == "hypot":
            return ca.sqrt(sum(x * x for x in a))
        if name in ("min", "max"):
            out = a[0]
            for x in a[1:]:
                out = (ca.fmin if name == "min" else ca.fmax)(out, x)
            return out
        if name == "smooth_abs":
            return ca.sqrt(a[0] * a[0] + a[1] * a[1])
        if name == "smooth_max":
            return smooth_max(*a)
        return FUNCTIONS[name](*a)

    def dt(self, e, ph):
        if isinstance(e, (int, float)):
            return 0.0
        x = ca.vertcat(*ph["flat"], ph["t"], ph["tau"])
        rates = []
        for key, ss in ph["sym"].items():
            rates += list(ss[1:]) + [0]
        v = ca.vertcat(*[self.symbols(r) if isinstance(r, int) else r for r in rates], 1, 1 / ph["T"])
        return ca.jtimes(e, x, v)

    def phase_of(self, item, c):
        name, index = item
        i = None if index is None else int(round(float(self.ev(index, c))))
        for ph in self.phases:
            if ph["name"] == name and ph["index"] == i:
                return ph
        raise NameError("phase %s" % name)

    # Building the program.

    def relations(self, block, loc=None):
        for s in block:
            if s[0] == "for":
                for i in range(int(self.number(s[2], loc)), int(self.number(s[3], loc)) + 1):
                    yield from self.relations(s[4], dict(loc or {}, **{s[1]: i}))
            else:
                yield s, dict(loc or {})


def smooth_max(a, b, w):
    return 0.5 * (a + b + ca.sqrt((a - b) * (a - b) + w * w))
