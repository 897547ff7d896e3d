"""Tables of data as CasADi functions."""
import os

import casadi as ca
import numpy as np
from scipy.interpolate import PPoly, make_interp_spline


def monotone_slopes(x, y):
    """Fritsch and Carlson 1980 as docs/maths.md states it, (7.8) to (7.10)."""
    h = np.diff(x)
    d = np.diff(y) / h
    if len(x) == 2:
        return np.array([d[0], d[0]])
    s = np.zeros(len(x))
    s[1:-1] = (h[1:] * d[:-1] + h[:-1] * d[1:]) / (h[:-1] + h[1:])
    s[0], s[-1] = 2 * d[0] - s[1], 2 * d[-1] - s[-2]
    below, above = np.concatenate([[d[0]], d]), np.concatenate([d, [d[-1]]])
    s = np.where((np.sign(s) == np.sign(below)) & (np.sign(s) == np.sign(above)), s, 0)
    size = np.hypot(s[:-1], s[1:])
    t = np.where(size > 3 * np.abs(d), 3 * np.abs(d) / np.where(size > 0, size, 1), 1)
    return s * np.minimum(np.concatenate([[1], t]), np.concatenate([t, [1]]))


def table(problem, s):
    """The function that a table declares, of CasADi values."""
    _, name, units, value, method, opt, rows, nodes2, kinds = s
    if isinstance(rows, str):
        data = [[float(x) for x in line.split(",")] for line in open(os.path.join(problem.dir, rows)) if line.strip() and line[0] != "#"]
        if len(units) == 1:
            rows, x2 = data, None
        else:
            x2, rows = data[0], data[1:]
        x = [r[0] for r in rows]
        v = [r[1:] for r in rows]
    else:
        x = [problem.number(r[0]) for r in rows]
        v = [[problem.number(e) for e in r[1]] for r in rows]
        x2 = [problem.number(e) for e in nodes2] if nodes2 else None
    x = np.array(x) * units[0]
    if x2 is not None:
        x2 = np.array(x2) * units[1]
    v = np.array(v) * value
    kind = {"monotone": "pchip"}.get(method, method)
    order = int(problem.number(opt["order"])) if "order" in opt else 4
    if x2 is None:
        y = v[:, 0]
        ext = opt.get("extrapolate")
        if kind == "pchip":
            s_ = monotone_slopes(x, y)
            coefs = []
            for i in range(len(x) - 1):
                h = x[i + 1] - x[i]
                d = (y[i + 1] - y[i]) / h
                coefs.append((y[i], s_[i], (3 * d - 2 * s_[i] - s_[i + 1]) / h, (s_[i] + s_[i + 1] - 2 * d) / h ** 2))
        elif kind == "linear":
            coefs = [(y[i], (y[i + 1] - y[i]) / (x[i + 1] - x[i]), 0, 0) for i in range(len(x) - 1)]
        else:
            pp = PPoly.from_spline(make_interp_spline(x, y, k=order - 1))
            keep = [i for i in range(len(pp.x) - 1) if pp.x[i + 1] > pp.x[i]]

            def spline(u):
                z = ca.fmin(ca.fmax(u, x[0]), x[-1])
                out = 0
                for n, i in enumerate(keep):
                    inside = (ca.logic_and(z >= pp.x[i], z < pp.x[i + 1]) if 0 < n < len(keep) - 1 else
                              (z < pp.x[i + 1] if n == 0 else z >= pp.x[i]))
                    dz = z - pp.x[i]
                    acc = 0
                    for c in pp.c[:, i]:
                        acc = acc * dz + c
                    out = ca.if_else(inside if len(keep) > 1 else 1, acc, out)
                return out
            return spline

        def cubic(u):
            z = u if ext == "linear" else ca.fmin(ca.fmax(u, x[0]), x[-1])
            out = None
            for i, c in enumerate(coefs):
                d = z - x[i]
                val = c[0] + d * (c[1] + d * (c[2] + d * c[3]))
                out = val if out is None else ca.if_else(z >= x[i], val, out)
            return out
        return cubic
    problem.symbols = ca.MX
    if kind == "linear":
        f = ca.interpolant(name, "linear", [list(x), list(x2)], v.ravel(order="F"))
    else:
        # Not-a-knot tensor spline of the given order; `monotone` of two arguments has no counterpart here.
        if kind == "pchip":
            raise NotImplementedError("monotone table of two arguments")
        a = make_interp_spline(x, v, k=order - 1)
        b = make_interp_spline(x2, a.c.T, k=order - 1)
        coef = b.c  # (n2, n1)
        f0 = ca.Function.bspline(name, [list(a.t), list(b.t)], list(coef.ravel()), [order - 1, order - 1], 1)
        f = lambda z: f0(z)
    lo, hi = (x[0], x2[0]), (x[-1], x2[-1])
    return lambda u, w: f(ca.vertcat(ca.fmin(ca.fmax(u, lo[0]), hi[0]), ca.fmin(ca.fmax(w, lo[1]), hi[1])))

# Evaluation. A context holds "phase" (trajectory symbols), "event" (True for values of the whole) and "__locals".
