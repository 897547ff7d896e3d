"""A nonlinear program as sums over points, in no solver's language yet.

A group applies one formula to the *slots* of each of its points: flat variables at the point and
globals, all linear in the program's variables. `peers.casadi_solvers` turns it into CasADi's terms,
point by point (SX) or as a map over the points (MX).
"""

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp


@dataclass
class Group:
    """`formula(u, p)` gives the cost (or None) and a list of rows, from the slots `u` of one point."""

    formula: object
    slots: list  # One sparse matrix (points x variables) a slot, or an array of fixed numbers, one a point.
    weights: np.ndarray  # Of the cost, one a point.
    lower: list  # One a row.
    upper: list

    @property
    def points(self):
        return self.slots[0].shape[0]

    def matrix(self, variables):
        """The linear part: slots of the first point, then those of the second, and so on."""
        count, slots = self.points, len(self.slots)
        stacked = sp.vstack([widened(slot, variables) for slot in self.slots]).tocsr()
        order = np.arange(count * slots).reshape(slots, count).T.ravel()
        return stacked[order]

    def offset(self):
        """The fixed part, likewise."""
        fixed = [slot if isinstance(slot, np.ndarray) else np.zeros(self.points) for slot in self.slots]
        return np.array(fixed).T.ravel()


def widened(slot, variables):
    """The matrix with as many columns as the program has variables."""
    if isinstance(slot, np.ndarray):
        return sp.coo_matrix((len(slot), variables))
    slot = slot.tocoo()
    return sp.coo_matrix((slot.data, (slot.row, slot.col)), shape=(slot.shape[0], variables))


@dataclass
class Output:
    """A spline and where its coefficients start."""

    spline: object
    first: int

    @property
    def last(self):
        """Where they end."""
        return self.first + self.spline.size

    def at(self, tau, derivative=0):
        """The slot of a derivative with respect to scaled time, at points."""
        rows = self.spline.rows(tau, derivative)
        rows[np.abs(rows) < 1e-14 * np.abs(rows).max()] = 0
        return sp.hstack([sp.coo_matrix((rows.shape[0], self.first)), sp.coo_matrix(rows)])


@dataclass
class Program:
    """Variables with start and bounds, groups, and the values of the parameters, one list a step of a
    continuation."""

    steps: list = field(default_factory=lambda: [[]])
    groups: list = field(default_factory=list)
    start: list = field(default_factory=list)
    lower: list = field(default_factory=list)
    upper: list = field(default_factory=list)
    units: list = field(default_factory=list)  # Of each variable, in SI.
    outputs: list = field(default_factory=list)

    @property
    def variables(self):
        return len(self.start)

    def sizes(self):
        """A typical size of each variable: the largest guessed coefficient of an output, and every
        other variable's own guess."""
        sizes = np.abs(self.start)
        for output in self.outputs:
            sizes[output.first : output.last] = sizes[output.first : output.last].max()
        return np.where(sizes > 0, sizes, 1.0)

    def output(self, spline, guess, unit=1.0):
        """A spline whose coefficients are fitted to a function of scaled time; `unit` in SI."""
        output = Output(spline, self.variables)
        self.outputs.append(output)
        self.units.extend([unit] * spline.size)
        self.start.extend(spline.fit(guess))
        self.lower.extend([-np.inf] * spline.size)
        self.upper.extend([np.inf] * spline.size)
        return output

    def variable(self, guess, lower, upper):
        """A number; gives its index."""
        self.start.append(guess)
        self.units.append(1.0)
        self.lower.append(lower)
        self.upper.append(upper)
        return self.variables - 1

    def everywhere(self, index, points):
        """The slot of a variable: the same at all points."""
        return sp.coo_matrix((np.ones(points), (np.arange(points), np.full(points, index))), shape=(points, index + 1))

    @property
    def rows(self):
        return sum(len(group.lower) * group.points for group in self.groups)

    def add(self, formula, slots, weights=None, lower=(), upper=()):
        """A group; without weights its cost, if any, counts once."""
        weights = np.ones(slots[0].shape[0]) if weights is None else np.asarray(weights)
        self.groups.append(Group(formula, slots, weights, list(lower), list(upper)))

    def fix(self, slot, value):
        """One linear equality for each point of a slot."""
        self.add(lambda u, p: (None, [u[0]]), [slot], None, [value], [value])
