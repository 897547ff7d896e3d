"""How far an answer is from a solution, measured outside all solvers, for the program as it was before any of them changed it.

The rules are those of `ntg-export/src/judge.rs`: what is left of the Lagrangian's gradient in a variable is the
multiplier of its bounds. A multiplier whose bound is infinite is an error of stationarity. Where the bound is finite, its
product with the distance is an error of complementarity (Nocedal and Wright, *Numerical Optimization*, theorem 12.1).
All errors are relative to sizes of the program's own terms.
"""

import casadi as ca
import numpy as np
import scipy.sparse as sp

from .casadi_solvers import expressions


class Judge:
    """The errors of points with multipliers, of one program."""

    def __init__(self, program):
        self.program, self.sizes = program, program.sizes()
        nlp, self.row_lower, self.row_upper = expressions(program, "sx", np.ones(program.variables))
        x, p, f, g = nlp["x"], nlp["p"], nlp["f"], nlp["g"]
        self.values = ca.Function("judge", [x, p], [f, g, ca.gradient(f, x), ca.jacobian(g, x)])

    def errors(self, p, x, multipliers):
        """Relative violation, stationarity and complementarity; CasADi's signs, whose Lagrangian is f + m g."""
        f, rows, gradient, jacobian = self.values(x, p)
        f, rows, gradient, jacobian = float(f), np.array(rows).ravel(), np.array(gradient).ravel(), sp.csc_array(jacobian.sparse())
        moved = abs(jacobian @ sp.diags_array(self.sizes))
        row_sizes = size_of(self.row_lower, self.row_upper, moved.max(axis=1).toarray().ravel())
        own = np.asarray(self.program.lower), np.asarray(self.program.upper)
        left = gradient + jacobian.T @ multipliers
        # The multiplier of a lower bound is positive: what the objective gains where the bound moves.
        every = [(left, self.sizes, x, *own), (-multipliers, row_sizes, rows, self.row_lower, self.row_upper)]
        largest = max(np.abs(gradient * self.sizes).max(), (sp.diags_array(np.abs(multipliers)) @ moved).max())
        found = np.array([unmatched(*one) for one in every]).max(axis=0)
        violation = max(missed(x, *own, size_of(*own, self.sizes)), missed(rows, self.row_lower, self.row_upper, row_sizes))
        return {
            "violation": float(violation),
            "stationarity": float(found[0] / positive(largest)),
            "complementarity": float(found[1] / positive(max(largest, abs(f)))),
        }


def unmatched(multipliers, sizes, values, lower, upper):
    """The largest multiplier without a bound, by what it would move, and the largest product with a distance."""
    bounds = np.where(multipliers > 0, lower, upper)
    is_bound = np.isfinite(bounds)
    alone = np.where(is_bound, 0, np.abs(multipliers * sizes))
    products = np.abs(multipliers * (values - np.where(is_bound, bounds, values)))
    return alone.max(initial=0), products.max(initial=0)


def missed(values, lower, upper, sizes):
    return (np.maximum(np.maximum(lower - values, values - upper), 0) / positive(sizes)).max(initial=0)


def size_of(lower, upper, least):
    """The largest of the finite bounds and of what one typical change of the variables does."""
    bounds = [np.where(np.isfinite(bound), np.abs(bound), 0) for bound in (lower, upper)]
    return np.maximum.reduce([*bounds, least])


def positive(size):
    return np.where(size > 0, size, 1.0)
