"""Statements of a spec: tuples whose first member is their kind."""
from .expressions import ExpressionParser, bare, scale_bare


class Parser(ExpressionParser):
    """Reads a problem, statement by statement."""

    def block(self):
        self.take("{")
        out = []
        while not self.has("}"):
            out.append(self.statement())
        return out

    def statement(self):
        w = self.peek()
        if w == "problem":
            self.take()
            return ("problem", self.take(), self.block())
        if w in ("const", "param", "continuation", "variable", "output", "let", "fn", "table", "duration", "collocation", "minimize",
                 "maximize", "initial", "trajectory", "final", "temporal", "guess", "phase", "for", "jump", "continuous"):
            if not (w in ("initial", "final", "duration") and self.peek(1) == "("):
                if w == "param" and self.peek(1) == "table":
                    self.take()
                    w = "table"
                return getattr(self, "s_" + w)(self.take())
        return self.relation()

    def s_const(self, _):
        name = self.take()
        self.take("=")
        e = self.expr()
        self.take(";")
        return ("const", name, e)

    def s_param(self, _):
        name, size = self.take(), None
        if self.has("["):
            size = self.expr()
            self.take("]")
        self.take("=")
        e = self.expr()
        if e[0] == "tuple":
            e = ("tuple", self.trailing(e[1]))
        self.take(";")
        return ("param", name, size, e)

    def s_continuation(self, _):
        name = self.take()
        self.take("=")
        e = self.expr()
        self.take(";")
        return ("param", name, None, e[1][-1])

    def s_variable(self, _):
        names = []
        while True:
            name, rng = self.take(), None
            if self.peek() == "[" and self.is_range():
                rng = self.array_range()
            unit = self.optional_unit()
            names.append((name, rng, unit))
            if not self.has(","):
                break
        lo = hi = None
        if self.has("in"):
            lo, hi = self.bounds()
        self.take(";")
        return ("variable", names, lo, hi)

    def s_output(self, _):
        names = []
        while True:
            name, rng = self.take(), None
            if self.peek() == "[" and self.is_range():
                rng = self.array_range()
            names.append([name, rng, self.optional_unit()])
            if not self.has(","):
                break
        self.take(":")
        self.take("spline")
        self.take("(")
        opt = {}
        while not self.has(")"):
            key = self.take()
            self.take("=")
            opt[key] = self.expr()
            self.has(",")
        self.take(";")
        return ("output", names, opt)

    def s_let(self, _):
        name, rng = self.take(), None
        if self.peek() == "[" and self.is_range():
            rng = self.array_range()
        self.optional_unit()
        self.take("=")
        e = self.expr()
        self.take(";")
        return ("let", name, rng, e)

    def s_fn(self, _):
        name = self.take()
        self.take("(")
        args = []
        while not self.has(")"):
            args.append(self.take())
            self.has(",")
        self.take("=")
        e = self.expr()
        self.take(";")
        return ("fn", name, args, e)

    def s_table(self, _):
        name = self.take()
        self.take("(")
        units, kinds = [], []
        while not self.has(")"):
            self.take()
            kind = None
            if self.peek() in ("even", "periodic"):
                kind = self.take()
            units.append(self.optional_unit() or 1)
            kinds.append(kind)
            self.has(",")
        value = self.optional_unit() or 1
        self.take("=")
        method = self.take()
        opt = {}
        if self.has("("):
            while not self.has(")"):
                key = self.take()
                self.take("=")
                opt[key] = self.expr() if self.t[self.i][0] != "name" else self.take()
                self.has(",")
        rows, nodes2 = [], None
        if self.has("from"):
            file = self.take().strip('"')
            self.take(";")
            return ("table", name, units, value, method, opt, file, None, kinds)
        self.take("{")
        while not self.has("}"):
            first = [self.expr()]
            if self.has(":"):
                v = [self.expr()]
                while self.has(","):
                    v.append(self.expr())
                rows.append((first[0], v))
            else:
                while self.has(","):
                    first.append(self.expr())
                nodes2 = first
            self.take(";")
        return ("table", name, units, value, method, opt, rows, nodes2, kinds)

    def s_duration(self, _):
        name = None
        if self.peek() not in ("in", "="):
            name = self.take()
        if self.has("="):
            e = self.expr()
            self.take(";")
            return ("duration", name, e, e)
        self.take("in")
        lo, hi = self.bounds()
        self.take(";")
        return ("duration", name, lo, hi)

    def s_collocation(self, _):
        kind = self.take()
        self.take("(")
        opt = {}
        while not self.has(")"):
            key = self.take()
            self.take("=")
            opt[key] = self.expr()
            self.has(",")
        self.take(";")
        return ("collocation", kind, opt)

    def s_minimize(self, w):
        if self.t[self.i][0] == "name" and (self.peek(1) == ":" or self.named_unit()):
            self.take()
            self.optional_unit()
            self.take(":")
        e = self.expr()
        self.take(";")
        return ("objective", 1 if w == "minimize" else -1, e)


    def named_unit(self):
        if self.peek(1) != "[":
            return False
        j = self.i + 1
        while self.t[j][1] != "]":
            j += 1
        return self.t[j + 1][1] == ":"

    def s_initial(self, w):
        return (w, self.block())


    def s_for(self, _):
        name = self.take()
        self.take("in")
        a = self.expr()
        self.take("..")
        b = self.expr()
        return ("for", name, a, b, self.block())

    def s_phase(self, _):
        name = self.take()
        rng = self.array_range() if self.peek() == "[" else None
        after = self.path() if self.has("after") else None
        return ("phase", name, rng, after, self.block())

    def s_jump(self, _):
        names = [self.take()]
        while self.has(","):
            names.append(self.take())
        self.take(";")
        return ("jump", names)

    def s_continuous(self, _):
        names = [self.take()]
        while self.has(","):
            names.append(self.take())
        up = None
        if self.has("up"):
            self.take("to")
            up = self.expr()
        self.take(";")
        return ("continuous", names, up)

    def relation(self):
        if self.t[self.i][0] == "name" and self.peek(1) == ":":
            self.take()
            self.take()
        elif self.t[self.i][0] == "name" and self.peek(1) == "[":
            j = self.i + 1
            while self.t[j][1] != "]":
                j += 1
            if self.t[j + 1][1] == ":":
                self.i = j + 2
        a = self.expr()
        if self.has("in"):
            lo, hi = self.bounds()
            self.take(";")
            return ("relation", lo, a, hi)
        op = self.take()
        if op == "through":
            raise SyntaxError("through")
        if op not in ("==", "<=", ">="):
            raise SyntaxError("relation %r" % op)
        b = self.expr()
        if self.peek() in ("<=", ">="):
            self.take()
            c = self.expr()
            self.take(";")
            lo, hi = (a, c) if op == "<=" else (c, a)
            if bare(lo) and not bare(hi) and False:
                pass
            return ("relation", lo, b, hi)
        self.take(";")
        if op == "==":
            return ("relation", b, a, b)
        return ("relation", None, a, b) if op == "<=" else ("relation", b, a, None)

    def s_guess(self, _):
        self.take("{")
        return ("guess", self.guesses())

    def guesses(self):
        out = []
        while not self.has("}"):
            if self.has("for"):
                name = self.take()
                self.take("in")
                a = self.expr()
                self.take("..")
                b = self.expr()
                self.take("{")
                out.append(("for", name, a, b, self.guesses()))
                continue
            target = self.expr()
            if self.has("through"):
                points = [self.expr()]
                while self.has(","):
                    points.append(self.expr())
                if self.peek() == "[":
                    f = self.unit()
                    points = [("tuple", [scale_bare(x, f) for x in p[1]]) if p[0] == "tuple" else scale_bare(p, f) for p in points]
                self.take(";")
                out.append(("through", target, points))
            else:
                self.take("=")
                e = self.expr()
                self.take(";")
                out.append(("set", target, e))
        return out

    s_maximize = s_minimize
    s_trajectory = s_final = s_temporal = s_initial
