"""How a solution depends on the parameters of its problem."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, NamedTuple, Sequence, Union

from . import _given
from ._curve import Curve

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from . import _ntg
    from ._problem import Value

    Wanted = Union[str, tuple[str, ArrayLike]]
    """A number by its name (`"objective"`, `"T"`), or a function of time with mission times: `("x", [0, 60])`."""


def checked(wanted: "Sequence[Wanted]") -> "list[Wanted]":
    """The wanted numbers, each a name or a name with times."""
    if isinstance(wanted, str):
        raise TypeError(f"wanted numbers are a list; write [{wanted!r}]")
    for one in wanted:
        is_pair = isinstance(one, (tuple, list)) and len(one) == 2 and isinstance(one[0], str)
        if not (isinstance(one, str) or is_pair):
            raise TypeError(f'a wanted number is a name, or a name with times as in ("x", [0, 60]), not {one!r}')
    return list(wanted)


class Weak(NamedTuple):
    """A constraint that is only just active or inactive: derivatives may be one-sided."""

    name: str
    """The constraint, in words."""
    point: str
    """Where it is so first; empty for what belongs to no point."""
    points: int
    """At how many points."""


class Sensitivity:
    """Derivatives of a solution by parameters, to first order. Made by `Solution.sensitivity`.

    They are in units of what is differentiated per declared unit of the parameter, exact for the discretised problem as
    long as the same constraints stay active.
    """

    def __init__(self, core: "_ntg.Derivatives") -> None:
        self._core = core

    @property
    def parameters(self) -> list[str]:
        """By what is differentiated, in the order of all arrays; arrays member by member, `start[2]`."""
        return [name for name, _, _ in self._core.parameters]

    @property
    def strict(self) -> bool:
        """Whether the solution is a strict minimum.

        Where it is not, other solutions are as good: the derivatives of the objective are right all the same, all
        others are those of the solution that moves least.
        """
        return self._core.is_strict

    @property
    def weak(self) -> list[Weak]:
        """Constraints that may become active or inactive with the smallest change."""
        return [Weak(*one) for one in self._core.weak]

    def of(self, name: str) -> dict[str, float]:
        """Derivatives of the `objective`, a time, a variable or a named number, by parameter."""
        return dict(zip(self.parameters, self._number(name).tolist()))

    def at(self, name: str, times: "ArrayLike", order: int = 0) -> "NDArray[np.float64]":
        """Derivatives of an output or a named expression at mission times in seconds, which stand still.

        The shape is that of the times and, last, one column a parameter. At the very start and end, and beyond, they are
        those of the first and last value, which move with the ends. `order` is that of a derivative with respect to time,
        of outputs only.
        """
        import numpy as np

        t = _given.times(times)
        order = _given.count(order, "the order of a derivative", 0)
        if np.isnan(t).any():
            raise ValueError("a time is NaN")
        try:
            rows = self._core.at(name, np.ascontiguousarray(t.reshape(-1)), order)
        except KeyError:
            if order > 0:
                raise KeyError(f"`{name}` is no output, and only outputs have derivatives by time") from None
            raise KeyError(f"there is no function of time `{name}` to be differentiated") from None
        return rows.reshape((*t.shape, len(self.parameters)))

    def jacobian(self, wanted: "Sequence[Wanted]") -> "NDArray[np.float64]":
        """One row a number (a time of a function, in turn), one column a parameter."""
        import numpy as np

        rows = [np.empty((0, len(self.parameters)))]
        for one in checked(wanted):
            if isinstance(one, str):
                rows.append(self._number(one)[None, :])
            else:
                rows.append(self.at(*one).reshape(-1, len(self.parameters)))
        return np.concatenate(rows)

    def vector_jacobian(self, wanted: "Sequence[Wanted]", weights: "ArrayLike") -> "NDArray[np.float64]":
        """The gradient of the sum of the wanted numbers times their weights, one number a parameter."""
        import numpy as np

        jacobian, by = self.jacobian(wanted), np.asarray(weights, dtype=np.float64).reshape(-1)
        if len(by) != len(jacobian):
            raise ValueError(f"{len(by)} weights are given for {len(jacobian)} wanted numbers")
        return by @ jacobian

    def predict(self, parameters: "Mapping[str, Value] | None" = None, /, **named: "Value") -> "Prediction":
        """The solution for other values of the parameters, to first order: good for small changes."""
        from ._problem import merged

        return Prediction(self._core.predict(merged(parameters, named)))

    def _number(self, name: str) -> "NDArray[np.float64]":
        found = self._core.of(name)
        if found is None:
            raise KeyError(f"there is no number `{name}` to be differentiated; a function of time is taken `at` times")
        return found[1]

    def __repr__(self) -> str:
        return f"<ntg.Sensitivity by {', '.join(self.parameters)}>"


class Prediction:
    """A solution for parameters nearby, to first order: `prediction["x"](t)`, `prediction["T"]`."""

    def __init__(self, core: "_ntg.Predicted") -> None:
        self._core = core

    def __getitem__(self, name: str) -> Union[Curve, float]:
        data = self._core.curve(name)
        found: Any = Curve(self._core, data) if data is not None else self._core.number(name)
        if found is None:
            raise KeyError(f"there is no `{name}`")
        return found
