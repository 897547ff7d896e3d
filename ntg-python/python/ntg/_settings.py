"""How a problem is solved, and how far it is."""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, Callable, Mapping, NamedTuple, Optional, Union

from . import _given
from ._errors import SettingsError

if TYPE_CHECKING:
    ProgressArgument = Union[None, bool, Callable[["Progress"], Any]]


class Progress(NamedTuple):
    """One iteration of a solve."""

    iteration: int
    """Iterations completed; 0 at the start of a solve or of a step of a continuation."""
    objective: float
    """The minimised objective, in its unit."""
    violation: float
    """Largest scaled violation of a constraint or bound."""
    stationarity: float
    """Largest scaled component of the Lagrangian's gradient."""
    step: float
    """Length of the last step, as a fraction of the one proposed."""
    seconds: float
    """Seconds since the solve began."""


@dataclass(frozen=True)
class Settings:
    """How a problem is solved. The defaults suit most problems."""

    method: str = "auto"
    """`auto` (the interior-point method, and what helps where it fails), `interior-point` alone,
    `augmented-lagrangian`, or `sqp`."""
    restoration: str = "absolute"
    """What the interior-point method makes small where it restores feasibility: the sum of violations, `absolute`, or of
    their squares, `squared`."""
    inertia_correction: str = "by-element"
    """How the interior-point method corrects the inertia of its matrix: `by-element`, or `by-shift` of the diagonal."""
    tolerance: float = 1e-8
    """Largest scaled residual of stationarity and complementarity of a solution."""
    constraint_tolerance: float = 1e-8
    """Largest scaled violation of a constraint of a solution."""
    max_iterations: int = 2000
    """Iterations of all that a solve does, after which it is given up."""
    time_limit: Optional[float] = None
    """Seconds after which a solve is given up; none for no limit."""
    samples: int = 20
    """Points of the check after a solve for each point of the transcription."""
    refine: Optional[float] = None
    """Solve again on finer meshes until cost and constraints are exact to this relative error."""
    between: str = "report"
    """What becomes of a solution that violates constraints between its points: `report`, `refuse` or `refine`."""
    between_tolerance: float = 0.01
    """The largest violation between the points, relative to the constraint's bound, of which nothing is said."""
    scales: Mapping[str, float] = field(default_factory=dict)
    """Typical sizes of outputs and variables by name, in their units."""

    def __post_init__(self) -> None:
        for name, kind, words in _KINDS:
            value = getattr(self, name)
            if not kind(value):
                raise SettingsError(f"setting `{name}`: {words}, not {value!r}")


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)


def _is_count(value: Any) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool) and 0 <= int(value) < 2**32


def _is_text(value: Any) -> bool:
    return isinstance(value, str)


def _is_limit(value: Any) -> bool:
    return value is None or _is_number(value)


def _is_scales(value: Any) -> bool:
    return isinstance(value, Mapping) and all(isinstance(name, str) and _is_number(value[name]) for name in value)


# Kinds of values; their ranges are the solver's.
_KINDS = (
    ("method", _is_text, "a text"),
    ("tolerance", _is_number, "a number"),
    ("constraint_tolerance", _is_number, "a number"),
    ("max_iterations", _is_count, "a whole number from 0 to 2^32 - 1"),
    ("time_limit", _is_limit, "a number of seconds, or None"),
    ("samples", _is_count, "a whole number from 0 to 2^32 - 1"),
    ("refine", _is_limit, "a number, or None"),
    ("between", _is_text, "a text"),
    ("between_tolerance", _is_number, "a number"),
    ("scales", _is_scales, "numbers by the names of outputs and variables"),
)

DEFAULT = Settings()


def checked(settings: Any) -> Settings:
    """Settings, and nothing else."""
    found: Settings = _given.instance(settings, Settings, "settings")
    if found is None:
        raise TypeError("settings is an ntg.Settings, not None; leave it out for the usual ones")
    return found


class Line:
    """A line of progress on standard error, which notebooks and terminals show alike."""

    def __init__(self) -> None:
        self._last = 0.0
        self._width = 0

    def show(self, text: str, now: float, *, last: bool = False) -> None:
        """Shows a text, at most ten times a second."""
        if not last and now - self._last < 0.1:
            return
        self._last = now
        end = "\n" if last else ""
        sys.stderr.write("\r" + text.ljust(self._width) + end)
        sys.stderr.flush()
        self._width = len(text)


def watcher(progress: "ProgressArgument") -> Optional[Callable[..., Any]]:
    """The callback that the extension module calls in every iteration, or none."""
    if progress is None or progress is False:
        return None
    if progress is True:
        line = Line()

        def show(iteration: int, objective: float, violation: float, dual: float, step: float, seconds: float) -> None:
            text = f"iteration {iteration}: objective {objective:.6g}, violation {violation:.1e}, stationarity {dual:.1e}"
            line.show(text, seconds)

        return show
    if not callable(progress):
        raise TypeError("progress is True, or a function of a Progress that returns False to stop")
    callback = progress
    return lambda *parts: callback(Progress(*parts))
