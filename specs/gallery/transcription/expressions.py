"""Tokens, units and expressions of a spec; expressions become tuples whose first member is their kind."""
import math
import re

PREFIX = {"rad": 1, "mrad": 1e-3, "deg": math.pi / 180, "arcmin": math.pi / 10800, "rev": 2 * math.pi, "m": 1, "km": 1e3,
          "dm": 0.1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "Mm": 1e6, "inch": 0.0254, "ft": 0.3048, "yd": 0.9144,
          "mi": 1609.344, "nmi": 1852, "au": 149597870700.0, "ha": 1e4, "L": 1e-3, "l": 1e-3, "mL": 1e-6, "s": 1, "ms": 1e-3,
          "us": 1e-6, "ns": 1e-9, "min": 60, "h": 3600, "d": 86400, "day": 86400, "Hz": 1, "kHz": 1e3, "rpm": math.pi / 30,
          "kn": 1852 / 3600, "kt": 1852 / 3600, "mph": 0.44704, "kg": 1, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": 0.45359237,
          "N": 1, "mN": 1e-3, "kN": 1e3, "MN": 1e6, "lbf": 4.4482216152605, "Pa": 1, "hPa": 100, "kPa": 1e3, "MPa": 1e6,
          "bar": 1e5, "mbar": 100, "atm": 101325, "J": 1, "mJ": 1e-3, "kJ": 1e3, "MJ": 1e6, "Wh": 3600, "kWh": 3.6e6, "W": 1,
          "mW": 1e-3, "kW": 1e3, "MW": 1e6, "hp": 745.69987158227022, "A": 1, "mA": 1e-3, "kA": 1e3, "C": 1, "V": 1, "mV": 1e-3,
          "kV": 1e3, "ohm": 1, "S": 1, "F": 1, "H": 1, "Wb": 1, "T": 1, "K": 1, "mol": 1, "mmol": 1e-3, "cd": 1, "1": 1}
TOKEN = re.compile(r'\s+|//[^\n]*|/\*.*?\*/|(?P<num>\d+(\.\d+)?([eE][+-]?\d+)?)|(?P<name>[^\W\d]\w*)|(?P<text>"[^"]*")'
                   r'|(?P<op>\.\.|==|<=|>=|[-+*/^(){}\[\],;:=.])', re.S)


def tokens(text):
    out, at = [], 0
    while at < len(text):
        m = TOKEN.match(text, at)
        if not m:
            raise SyntaxError("at %r" % text[at:at + 30])
        at = m.end()
        if m.lastgroup or m.group("num"):
            kind = "num" if m.group("num") else m.lastgroup
            kind = kind if kind in ("num", "name", "text", "op") else "num"
            out.append((kind, m.group()))
    out.append(("end", ""))
    return out


class ExpressionParser:
    """Reads expressions, bounds and units from a list of tokens."""

    def __init__(self, text):
        self.t, self.i = tokens(text), 0

    def peek(self, ahead=0):
        return self.t[min(self.i + ahead, len(self.t) - 1)][1]

    def take(self, want=None):
        v = self.t[self.i][1]
        if want is not None and v != want:
            raise SyntaxError("expected %r, found %r after %r" % (want, v, " ".join(x[1] for x in self.t[max(0, self.i - 12):self.i])))
        self.i += 1
        return v

    def has(self, v):
        if self.peek() == v and self.t[self.i][0] != "text":
            self.i += 1
            return True
        return False

    # Units.

    def unit(self):
        self.take("[")
        f = self.unit_product()
        self.take("]")
        return f

    def unit_product(self):
        f = self.unit_power()
        while self.peek() in "*/":
            f = f * self.unit_power() if self.take() == "*" else f / self.unit_power()
        return f

    def unit_power(self):
        if self.has("("):
            f = self.unit_product()
            self.take(")")
        else:
            f = PREFIX[self.take()]
        if self.has("^"):
            sign = -1 if self.has("-") else 1
            f = f ** (sign * int(self.take()))
        return f

    # Expressions.

    def expr(self):
        a = self.term()
        while self.peek() in ("+", "-"):
            a = (self.take(), a, self.term())
        return a

    def term(self):
        a = self.factor()
        while self.peek() in ("*", "/"):
            a = (self.take(), a, self.factor())
        return a

    def factor(self):
        if self.has("-"):
            return ("neg", self.factor())
        if self.has("+"):
            return self.factor()
        a = self.atom()
        if self.has("^"):
            a = ("^", a, self.factor())
        return a

    def atom(self):
        kind, v = self.t[self.i]
        if kind == "num":
            self.i += 1
            if self.peek() == "[":
                return ("num", float(v) * self.unit())
            return ("bare", float(v))
        if v == "(":
            self.i += 1
            items = [self.expr()]
            while self.has(","):
                if self.peek() == ")":
                    break
                items.append(self.expr())
            self.take(")")
            if len(items) == 1:
                return items[0]
            return ("tuple", self.trailing(items))
        if kind != "name":
            raise SyntaxError("unexpected %r after %r" % (v, " ".join(x[1] for x in self.t[max(0, self.i - 12):self.i])))
        path = self.path()
        if self.peek() == "(":
            self.i += 1
            args = []
            while self.peek() != ")":
                if self.t[self.i][0] == "name" and self.peek(1) == "in":
                    name = self.take()
                    self.take("in")
                    a = self.expr()
                    self.take("..")
                    args.append(("loop", name, a, self.expr()))
                else:
                    args.append(self.expr())
                if not self.has(","):
                    break
            self.take(")")
            return ("call", path[0][0], args)
        return ("name", path)

    def path(self):
        out = []
        while True:
            name, index = self.take(), None
            if self.peek() == "[":
                self.take("[")
                index = self.expr()
                self.take("]")
            out.append((name, index))
            if not (self.peek() == "." and self.t[self.i + 1][0] == "name"):
                return out
            self.take(".")

    def trailing(self, items):
        """A unit after a tuple or behind its last member serves the bare numbers."""
        f = None
        if self.peek() == "[":
            f = self.unit()
        return [scale_bare(x, f) for x in items] if f else items

    def bounds(self):
        lo = hi = None
        if self.peek() != "..":
            lo = self.expr()
        self.take("..")
        if self.peek() not in (";", "}", ","):
            before = self.i
            hi = self.expr()
            if lo and self.t[self.i - 1][1] == "]" and bare(lo):
                j = self.i - 1
                while self.t[j][1] != "[":
                    j -= 1
                p = ExpressionParser("")
                p.t, p.i = self.t, j
                if j > before:
                    lo = scale_bare(lo, p.unit())
        return lo, hi

    # Statements.

    def is_range(self):
        j = self.i
        while self.t[j][1] != "]":
            if self.t[j][1] == "..":
                return True
            j += 1
        return False

    def optional_unit(self):
        return self.unit() if self.peek() == "[" else None

    def array_range(self):
        self.take("[")
        index = None
        if self.peek(1) == "in":
            index = self.take()
            self.take("in")
        a = self.expr()
        self.take("..")
        b = self.expr()
        self.take("]")
        return (index, a, b)


def bare(e):
    return e[0] == "bare" or (e[0] == "neg" and bare(e[1]))


def scale_bare(e, f):
    if e[0] == "bare":
        return ("num", e[1] * f)
    if e[0] == "neg" and bare(e[1]):
        return ("neg", scale_bare(e[1], f))
    return e
