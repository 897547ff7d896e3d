"""A problem as a differentiable function of some of its parameters: what `ntg.jax` and `ntg.torch` share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Sequence

from . import _given
from ._curve import Curve
from ._sensitivity import checked
from ._settings import DEFAULT, Settings

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._problem import Problem
    from ._sensitivity import Wanted
    from ._solution import Solution


class Function:
    """From values of parameters, in declared units, to wanted numbers of the optimum.

    A solver is kept. Every call solves from the solution of the call before; the same values are solved once. A set that
    cannot be solved raises `UnsolvedError`.
    """

    def __init__(
        self, problem: "Problem", inputs: Sequence[str], outputs: "Sequence[Wanted]", settings: Settings = DEFAULT
    ) -> None:
        import numpy as np

        self.inputs = _given.names(inputs, "inputs")
        # Finds what cannot be set.
        problem.with_parameters({name: 0.0 for name in self.inputs})
        self.outputs = [one if isinstance(one, str) else (one[0], _given.times(one[1])) for one in checked(outputs)]
        self.size = sum(1 if isinstance(one, str) else one[1].size for one in self.outputs)
        self._solver = problem.solver(settings=settings)
        self._last: "Optional[tuple[tuple[float, ...], Solution]]" = None

    def value(self, values: Any) -> "NDArray[np.float64]":
        """The wanted numbers, in the order in which they were named, a time of a function in turn."""
        import numpy as np

        solution = self._solution(values)
        rows: list[Any] = [np.empty(0)]
        for one in self.outputs:
            if isinstance(one, str):
                found = solution.objective if one == "objective" else solution[one]
                if isinstance(found, Curve):
                    raise TypeError(f'`{one}` is a function of time: name times too, as in ("{one}", [0, 60])')
                if isinstance(found, np.ndarray):
                    raise TypeError(f"`{one}` has elements: name these, as in `{one}[1]`")
                rows.append([found])
            else:
                curve: Any = solution[one[0]]
                if isinstance(curve, Curve) and curve.shape:
                    raise TypeError(f"`{curve.name}` has elements: name these, as in `{curve.elements[0]}`")
                rows.append(curve(one[1]).reshape(-1))
        return np.concatenate(rows)

    def jacobian(self, values: Any) -> "NDArray[np.float64]":
        """Their derivatives: one row a number, one column an input."""
        sensitivity = self._solution(values).sensitivity(*self.inputs)
        # By the order of the inputs; that of the derivatives is the order of the spec.
        columns = [sensitivity.parameters.index(name) for name in self.inputs]
        return sensitivity.jacobian(self.outputs)[:, columns]

    def check(self, given: int) -> None:
        """Raises where the number of given values is not that of the inputs."""
        if given != len(self.inputs):
            values = "1 value is" if given == 1 else f"{given} values are"
            raise ValueError(f"{values} given for {len(self.inputs)} inputs: {', '.join(self.inputs)}")

    def _solution(self, values: Any) -> "Solution":
        import numpy as np

        given = tuple(np.asarray(values, dtype=np.float64).reshape(-1).tolist())
        self.check(len(given))
        if self._last is None or self._last[0] != given:
            solution = self._solver.resolve(dict(zip(self.inputs, given))).raise_if_unsolved()
            self._last = (given, solution)
        return self._last[1]
