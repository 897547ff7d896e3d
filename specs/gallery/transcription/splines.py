"""Splines of outputs, and Gauss points."""
import casadi as ca
import numpy as np


class Spline:
    """Coefficients of one output in one phase: polynomial pieces on equal or given intervals."""

    def __init__(self, order, knots, smooth):
        inner = np.repeat(knots[1:-1], order - smooth)
        t = np.concatenate([np.repeat(knots[0], order), inner, np.repeat(knots[-1], order)])
        self.n = len(t) - order
        self.order, self.knots, self.smooth, self.t = order, np.array(knots), smooth, t
        self.pieces = {}

    def matrix(self, taus, sides, j):
        """Rows: the j-th derivative in scaled time at taus, from the given sides (+1: the interval that begins there)."""
        if j >= self.order:
            return ca.DM(len(taus), self.n)
        k, rows = self.order, np.zeros((len(taus), self.n))
        for r, (x, side) in enumerate(zip(taus, sides)):
            e = np.searchsorted(self.knots, x + (1e-12 if side > 0 else -1e-12), side="right") - 1
            e = min(max(e, 0), len(self.knots) - 2)
            if e not in self.pieces:
                mid = 0.5 * (self.knots[e] + self.knots[e + 1])
                last = np.searchsorted(self.t, mid) - 1
                self.pieces[e] = (last, self.t[last - k + 1:last + k + 1])
            last, local = self.pieces[e]
            for c in range(k):
                coef = np.zeros(k)
                coef[c] = 1
                rows[r, last - k + 1 + c] = deboor(local, coef, k, x, j)
        return ca.sparsify(ca.DM(rows))


def deboor(t, c, k, x, j):
    """j-th derivative at x of the polynomial piece with the 2k knots t about it and the k coefficients c."""
    c, p = list(c), k - 1
    for d in range(j):
        c = [(p - d) * (c[i + 1] - c[i]) / (t[i + 1 + p] - t[i + 1 + d]) for i in range(p - d)]
    q = p - j
    t = t[j:len(t) - j]
    for r in range(1, q + 1):
        for i in range(q, r - 1, -1):
            w = (x - t[i]) / (t[i + 1 + q - r] - t[i])
            c[i] = (1 - w) * c[i - 1] + w * c[i]
    return c[q]


def gauss(knots, h, n):
    z, w = np.polynomial.legendre.leggauss(n)
    x = np.concatenate([a + d * (z + 1) / 2 for a, d in zip(knots[:-1], h)])
    return x, np.concatenate([d * w / 2 for d in h]), np.ones(len(x))
