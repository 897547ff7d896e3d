"""A solver that is kept."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, Optional

from . import _given
from ._settings import watcher
from ._solution import Solution

if TYPE_CHECKING:
    from . import _ntg
    from ._problem import Value
    from ._settings import ProgressArgument


class Solver:
    """Solves one problem many times and keeps what does not change between the solves.

    Made by `Problem.solver`. Parameters that are set stay set; a mistake in them leaves all as it was. One thread uses a
    solver at a time: another one gets `BusyError`.
    """

    def __init__(self, core: "_ntg.KeptSolver") -> None:
        self._core = core

    def __reduce__(self) -> Any:
        raise TypeError("a Solver cannot be copied or pickled; its problem can, and makes another one by `solver()`")

    def solve(
        self,
        parameters: "Mapping[str, Value] | None" = None,
        /,
        *,
        guess: Optional[Solution] = None,
        progress: "ProgressArgument" = None,
        **named: "Value",
    ) -> Solution:
        """Sets parameters and solves from the guess of the spec, or from `guess`. As `Problem.solve`."""
        return self._solve(parameters, named, False, guess, progress)

    def resolve(
        self,
        parameters: "Mapping[str, Value] | None" = None,
        /,
        *,
        progress: "ProgressArgument" = None,
        **named: "Value",
    ) -> Solution:
        """Sets parameters and solves from the last solution and its multipliers, at once and without continuation.

        Where there is no last solution, or no way from it to a new one, solves from the guess of the spec.
        """
        return self._solve(parameters, named, True, None, progress)

    def _solve(self, parameters: Any, named: Any, again: bool, guess: Any, progress: Any) -> Solution:
        from ._problem import merged

        core = _given.core(guess, Solution, "guess")
        return Solution(self._core.solve(merged(parameters, named), again, core, watcher(progress)))
