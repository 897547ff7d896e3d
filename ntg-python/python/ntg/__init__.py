"""Optimal control and trajectory generation from a readable problem file.

>>> import ntg
>>> flight = ntg.load("specs/low_observable.ntg")            # doctest: +SKIP
>>> solution = flight.solve(v_max="240 m/s")                 # doctest: +SKIP
>>> solution["x"]([0.0, 60.0, 120.0])                        # doctest: +SKIP

A `Problem` is a compiled spec, a `Solution` what a solve found, a `Solver` one that is kept for many solves;
`Problem.solve_many` solves a table of parameter sets on all cores. Values are in the units that the spec declares,
times in seconds. Whatever is wrong raises a subclass of `ntg.Error`; a solve that ends without a solution does not, see
`Solution.status` and `Solution.raise_if_unsolved`.
"""

from __future__ import annotations

from ._errors import (
    BusyError,
    Error,
    Finding,
    ParameterError,
    SensitivityError,
    SettingsError,
    SetupError,
    SpecError,
    TableError,
    UnsolvedError,
)
from ._curve import Curve
from ._ntg import __version__
from ._problem import Parameter, Problem, load, loads
from ._sensitivity import Prediction, Sensitivity, Weak
from ._settings import Progress, Settings
from ._solution import Constraint, Estimate, Measurement, Phase, Solution, Worst
from ._solver import Solver

__all__ = [
    "BusyError",
    "Constraint",
    "Curve",
    "Error",
    "Estimate",
    "Finding",
    "Measurement",
    "Parameter",
    "ParameterError",
    "Phase",
    "Prediction",
    "Problem",
    "Progress",
    "Sensitivity",
    "SensitivityError",
    "Settings",
    "SettingsError",
    "SetupError",
    "Solution",
    "Solver",
    "SpecError",
    "TableError",
    "UnsolvedError",
    "Weak",
    "Worst",
    "__version__",
    "load",
    "loads",
]
