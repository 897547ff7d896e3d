"""Least energy of linear systems, by the controllability Gramian (Bryson and Ho, section 5.3)."""

import numpy as np
from scipy.linalg import expm


def transition(A, B, T):
    """The matrix exponential over T, and the Gramian, the integral of exp(A s) B B' exp(A' s); by Van Loan's block matrix."""
    A, B = np.atleast_2d(A).astype(float), np.atleast_2d(B).astype(float)
    n = len(A)
    block = expm(np.block([[-A, B @ B.T], [np.zeros((n, n)), A.T]]) * T)
    forward = block[n:, n:].T
    return forward, forward @ block[:n, n:]


def least_energy(A, B, T, begin, end, rows=None):
    """The least integral of u'u from `begin` to `end` within T; `rows` are the states that are fixed at the end."""
    forward, gramian = transition(A, B, T)
    rows = list(range(len(forward))) if rows is None else rows
    miss = (np.asarray(end, float) - forward @ np.asarray(begin, float))[rows]
    return float(miss @ np.linalg.solve(gramian[np.ix_(rows, rows)], miss))


def integrators(n):
    """A chain of n integrators, dimensionless."""
    return np.eye(n, k=1), np.eye(n)[:, -1:]
