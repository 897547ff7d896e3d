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

    Times are in seconds, clamped to its own start and end; values are in `unit`.
    """

    def __init__(self, core: "_ntg.Found | _ntg.Predicted", data: tuple[str, str, str, float, float]) -> None:
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
        self.name, self.unit, self.doc, self.start, self.end = data

    @overload
    def __call__(self, t: float) -> float: ...
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
        values = self._core.values(self.name, np.ascontiguousarray(times.reshape(-1)), order)
        return float(values[0]) if times.ndim == 0 else values.reshape(times.shape)

    def sample(self, count: int = POINTS) -> "tuple[NDArray[np.float64], NDArray[np.float64]]":
        """Equally spaced times from start to end in seconds, and the values there."""
        import numpy as np

        times = np.linspace(self.start, self.end, count)
        return times, self(times)

    def __repr__(self) -> str:
        unit = f" [{self.unit}]" if self.unit else ""
        return f"<ntg.Curve {self.name}{unit}, {self.start:g} .. {self.end:g} s>"
