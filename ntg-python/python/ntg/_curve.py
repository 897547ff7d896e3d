"""A function of time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

from . import _given

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from . import _ntg

POINTS = 401
"""Times of a table where none are said."""


class Curve:
    """An output or a named expression as a function of mission time: `curve(t)`.

    Times are in seconds, clamped to its own start and end; values are in `unit`. Of a vector or a matrix the values have the
    shape of the times and, last, its own: `r(t)` of a vector of three is an array of three numbers, and at an array of n times
    one of n rows.
    """

    def __init__(
        self, core: "_ntg.Found | _ntg.Predicted", data: "tuple[str, str, str, float, float, list[int], list[str]]"
    ) -> None:
        self._core = core
        self.name: str
        """Its path: `x`, `uav[2].x`, `covert.speed`."""
        self.unit: str
        """The unit of its values; empty for pure numbers."""
        self.doc: str
        """Its documentation in the spec."""
        self.start: float
        """Its start in seconds."""
        self.end: float
        """Its end in seconds."""
        self.shape: tuple[int, ...]
        """How many elements it has by each index, `(3,)` of a vector, `(2, 3)` of a matrix; `()` of a number."""
        self.elements: tuple[str, ...]
        """The names of its elements, of a matrix row by row: `("r[1]", "r[2]", "r[3]")`; its own name of a number."""
        self.name, self.unit, self.doc, self.start, self.end, shape, elements = data
        self.shape, self.elements = tuple(shape), tuple(elements) or (self.name,)

    @overload
    def __call__(self, t: float) -> Any: ...
    @overload
    def __call__(self, t: "ArrayLike") -> "NDArray[np.float64]": ...
    def __call__(self, t: Any) -> Any:
        """The values at mission times in seconds, of the same shape."""
        return self.derivative(t, 0)

    def derivative(self, t: Any, order: int = 1) -> Any:
        """A derivative with respect to time, in `unit` per second to the power of `order`. Of outputs only."""
        import numpy as np

        times = _given.times(t)
        order = _given.count(order, "the order of a derivative", 0)
        at = np.ascontiguousarray(times.reshape(-1))
        values = np.stack([self._core.values(name, at, order) for name in self.elements], axis=-1)
        return float(values[0, 0]) if times.ndim == 0 and not self.shape else values.reshape(times.shape + self.shape)

    def sample(self, count: int = POINTS) -> "tuple[NDArray[np.float64], NDArray[np.float64]]":
        """Equally spaced times from start to end in seconds, and the values there."""
        import numpy as np

        times = np.linspace(self.start, self.end, count)
        return times, self(times)

    def __repr__(self) -> str:
        unit = f" [{self.unit}]" if self.unit else ""
        size = f" of {' x '.join(str(size) for size in self.shape)}" if self.shape else ""
        return f"<ntg.Curve {self.name}{size}{unit}, {self.start:g} .. {self.end:g} s>"
