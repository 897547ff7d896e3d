"""The extension module. Use the package `ntg`, which this is a part of."""

from pathlib import Path
from typing import Any, Callable, Mapping, Optional, Sequence

import numpy as np
from numpy.typing import NDArray

__version__: str

_Curve = tuple[str, str, str, float, float, list[int], list[str]]
_Number = tuple[str, float, str]
_Callback = Optional[Callable[..., Any]]

def command(words: Sequence[str]) -> int: ...
def compile(
    name: str, text: str, folder: Optional[Path], tables: Mapping[str, str], constants: Mapping[str, str]
) -> Compiled: ...
def constants(text: str) -> list[str]: ...
def blocks(sets: NDArray[np.float64], size: Optional[int]) -> list[NDArray[np.int64]]: ...
def sweep(
    compiled: Compiled,
    inputs: Sequence[str],
    sets: NDArray[np.float64],
    settings: Any,
    how: Any,
    progress: _Callback,
) -> list[tuple[str, Any]]: ...

class Compiled:
    name: str
    doc: str
    source: tuple[str, str]
    tables: dict[str, str]
    constants: dict[str, str]
    objective_unit: str
    notes: list[dict[str, Any]]
    parameters: list[tuple[str, str, str, list[float], list[int]]]
    state: list[tuple[str, list[float]]]
    def with_parameters(self, parameters: dict[str, Any]) -> Compiled: ...
    def with_state(self, state: list[tuple[str, list[float]]]) -> Compiled: ...
    def solve(self, settings: Any, guess: Optional[Found], callback: _Callback) -> Found: ...
    def solver(self, settings: Any) -> KeptSolver: ...
    def number(self, name: str, text: str) -> float: ...

class KeptSolver:
    def solve(self, parameters: dict[str, Any], again: bool, guess: Optional[Found], callback: _Callback) -> Found: ...

class Found:
    status: str
    message: str
    advice: str
    is_solved: bool
    resolution: str | None
    objective: float
    objective_fine: float
    objective_correction: float
    objective_unit: str
    violation: tuple[float, float]
    iterations: int
    seconds: float
    independent: tuple[str, str, float]
    span: tuple[float, float]
    terms: list[_Number]
    history: list[tuple[int, float, float, float, float, float]]
    problem: Compiled
    times: list[tuple[str, float]]
    variables: list[_Number]
    phases: list[tuple[str, float, float]]
    outputs: tuple[list[_Curve], list[_Curve]]
    expressions: tuple[list[_Curve], list[_Curve], list[_Number]]
    @staticmethod
    def arrays(names: list[str]) -> list[tuple[str, list[int], int]]: ...
    constraints: list[dict[str, Any]]
    def curve(self, name: str) -> Optional[_Curve]: ...
    def values(self, name: str, times: NDArray[np.float64], order: int) -> NDArray[np.float64]: ...
    def text(self) -> str: ...
    def explain(self) -> str: ...
    estimate: Optional[str]
    def json(self) -> str: ...
    def html(self, tracks: list[tuple[str, str]]) -> str: ...
    def sensitivity(self, names: Optional[list[str]]) -> Derivatives: ...

class Derivatives:
    parameters: list[tuple[str, float, str]]
    is_strict: bool
    weak: list[tuple[str, str, int]]
    def of(self, name: str) -> Optional[tuple[str, NDArray[np.float64]]]: ...
    def at(self, name: str, times: NDArray[np.float64], order: int) -> NDArray[np.float64]: ...
    def predict(self, parameters: dict[str, Any]) -> Predicted: ...

class Predicted:
    def curve(self, name: str) -> Optional[_Curve]: ...
    def number(self, name: str) -> Optional[float]: ...
    def values(self, name: str, times: NDArray[np.float64], order: int) -> NDArray[np.float64]: ...
