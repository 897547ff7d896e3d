"""Splines in scaled time, written independently of ntg's own: knots, values, fits."""

import functools

import numpy as np
from scipy.interpolate import BSpline


class Spline:
    """Order `order` (degree and one more), `smoothness` continuity conditions at each of the inner
    ones of `intervals` + 1 equally spaced breakpoints of 0 .. 1."""

    def __init__(self, order, smoothness, intervals):
        self.order, self.smoothness, self.intervals = order, smoothness, intervals
        inner = np.arange(1, intervals) / intervals
        ends = np.ones(order)
        self.knots = np.concatenate([0 * ends, np.repeat(inner, order - smoothness), ends])
        self.size = len(self.knots) - order

    @functools.lru_cache(maxsize=None)
    def _basis(self):
        return BSpline(self.knots, np.eye(self.size), self.order - 1)

    def rows(self, tau, derivative=0):
        """The values at `tau` of all B-splines' derivatives: one row a point."""
        basis = self._basis()
        basis = basis.derivative(derivative) if derivative else basis
        # At 1 the value is the one from the left; scipy would look beyond the last knot.
        return basis(np.minimum(np.atleast_1d(tau), 1 - 1e-16))

    def fit(self, function):
        """Least squares through samples in every interval, with exact ends."""
        count = 4 * self.order
        part = (np.arange(count) + 0.5) / count
        tau = (np.arange(self.intervals)[:, None] + part[None, :]).ravel() / self.intervals
        rows, values = self.rows(tau), np.array([function(t) for t in tau])
        first, last = function(0.0), function(1.0)
        values = values - rows[:, 0] * first - rows[:, -1] * last
        inner = np.linalg.lstsq(rows[:, 1:-1], values, rcond=None)[0]
        return np.concatenate([[first], inner, [last]])


def uniform(count):
    """Equally spaced points with both ends, and the trapezoid rule's weights."""
    weights = np.full(count, 1 / (count - 1))
    weights[[0, -1]] /= 2
    return np.linspace(0, 1, count), weights


def gauss(points, intervals):
    """Gauss-Legendre points in each of equal intervals, and their weights."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    tau = (np.arange(intervals)[:, None] + (nodes + 1) / 2).ravel() / intervals
    return tau, np.tile(weights / 2 / intervals, intervals)


def polygon(points):
    """A function of 0 .. 1 that runs through way-points at constant speed."""
    points = np.asarray(points, float)
    length = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    return [lambda s, axis=axis: float(np.interp(s, length / length[-1], points[:, axis])) for axis in range(points.shape[1])]
