"""Tables of parameter sets: DataFrames, Arrow, NumPy; in, and back as what they were."""

from __future__ import annotations

import time
from typing import Any, Callable, Mapping, NamedTuple, Optional, Sequence

from . import _given
from ._errors import ParameterError, TableError
from ._settings import Line


class How(NamedTuple):
    """What decides how a study is run, as the extension module reads it."""

    values: list[str]
    jobs: int
    block: Optional[int]
    lengths: list[int]
    journal: Any


def how(values: Any, jobs: Any, block: Any) -> How:
    """How a study is run, checked."""
    try:
        rows = None if block is None else _given.count(block, "`block`, the number of rows of a block,", 1)
        together = _given.count(jobs, "`jobs`, the number of rows at a time,", 0)
        return How(_given.names(values, "`values`"), together, rows, [], None)
    except ValueError as error:
        raise TableError(str(error)) from None


def unlike(inputs: Sequence[str], parameters: Any) -> None:
    """Raises where a parameter is a column, and given for all rows too."""
    for name in inputs:
        if parameters is not None and name in parameters:
            raise TableError(f"`{name}` is a column, and given in `parameters` too")


Read = tuple[list[str], Any, Callable[[dict[str, Any]], Any]]


def read(core: Any, table: Any, columns: Optional[Sequence[str]]) -> Read:
    """Names of the columns, the sets as an array of two dimensions, and what makes a table of that kind."""
    import numpy as np

    named, back = _columns(table, columns)
    if not named:
        raise TableError("the table has no columns; name them after parameters")
    for name, values in named.items():
        if isinstance(values, (str, bytes)) or not hasattr(values, "__len__"):
            words = "give a list, and what holds for all rows as `parameters`"
            raise TableError(f"column `{name}` is {values!r}, one value; {words}")
    lengths = {name: len(values) for name, values in named.items()}
    if len(set(lengths.values())) > 1:
        raise TableError(f"the columns have different lengths: {lengths}")
    inputs = list(named)
    rows = next(iter(lengths.values()))
    sets = np.empty((rows, len(inputs)), dtype=np.float64)
    for i, name in enumerate(inputs):
        sets[:, i] = _numbers(core, name, named[name])
    return inputs, sets, back


def _numbers(core: Any, name: str, values: Any) -> Any:
    """A column in the declared unit of its parameter; texts are read as quantities."""
    import numpy as np

    array = np.asarray(values)
    if array.ndim != 1:
        raise TableError(f"column `{name}` has {array.ndim} dimensions; give members of an array as `{name}[1]`, ...")
    if array.dtype.kind in "OUS" and any(isinstance(value, (str, bytes)) for value in array):
        known: dict[str, float] = {}
        numbers = np.empty(len(array))
        for row, value in enumerate(array):
            if value is None:
                raise TableError(f"row {row}: `{name}` has no value")
            text = value.decode() if isinstance(value, bytes) else str(value)
            if text not in known:
                try:
                    known[text] = core.number(name, text)
                except ParameterError as error:
                    raise TableError(f"row {row}: {error}") from None
            numbers[row] = known[text]
        array = numbers
    if array.dtype.kind not in "biufO":
        raise TableError(f"column `{name}` holds no numbers but {array.dtype}")
    try:
        numbers = array.astype(np.float64)
    except (TypeError, ValueError) as error:
        raise TableError(f"column `{name}` holds something that is no number: {error}") from None
    missing = np.flatnonzero(~np.isfinite(numbers))
    if missing.size:
        raise TableError(f"row {missing[0]}: `{name}` is {numbers[missing[0]]}, no finite number")
    return numbers


def _columns(table: Any, columns: Optional[Sequence[str]]) -> tuple[dict[str, Any], Callable[[dict[str, Any]], Any]]:
    kind = type(table).__module__.split(".")[0]
    name = type(table).__name__
    if columns is not None:
        columns = _given.names(columns, "`columns`")
    if columns is not None and kind != "numpy":
        raise TableError("`columns` names the columns of a NumPy array; a table has names of its own")
    if kind == "pandas" and name == "DataFrame":
        return _pandas(table)
    if kind == "polars" and name == "DataFrame":
        return {str(one): table[one].to_numpy() for one in table.columns}, _to_polars
    if kind == "pyarrow" and name in ("Table", "RecordBatch"):
        _unlike(table.schema.names)
        arrays = {one: table.column(one).to_numpy(**({} if name == "Table" else {"zero_copy_only": False})) for one in table.schema.names}
        return arrays, _to_arrow
    if kind == "numpy":
        return _numpy(table, columns), _to_numpy
    if isinstance(table, Mapping) or (name != "Series" and hasattr(table, "keys") and hasattr(table, "__getitem__")):
        return {str(one): table[one] for one in table.keys()}, _to_numpy
    raise TableError(
        f"{name} is no table; give a pandas or polars DataFrame, an Arrow table, a mapping of columns, or a "
        "NumPy array with `columns`"
    )


def _pandas(table: Any) -> tuple[dict[str, Any], Callable[[dict[str, Any]], Any]]:
    index = table.index

    def back(found: dict[str, Any]) -> Any:
        import pandas

        return pandas.DataFrame(found, index=index)

    _unlike([str(one) for one in table.columns])
    return {str(one): table[one].to_numpy() for one in table.columns}, back


def _unlike(names: Sequence[str]) -> None:
    """Raises where two columns have one name."""
    for i, one in enumerate(names):
        if one in names[:i]:
            raise TableError(f"two columns are called `{one}`")


def _numpy(table: Any, columns: Optional[Sequence[str]]) -> dict[str, Any]:
    if table.dtype.names is not None:
        return {one: table[one] for one in table.dtype.names}
    if columns is None:
        raise TableError("an array without named fields needs `columns`, the parameters that its columns are")
    if table.ndim != 2 or table.shape[1] != len(columns):
        raise TableError(f"the array has shape {table.shape}; with these `columns` its shape is (rows, {len(columns)})")
    _unlike(columns)
    return {one: table[:, i] for i, one in enumerate(columns)}


def _to_polars(found: dict[str, Any]) -> Any:
    import polars

    return polars.DataFrame(found)


def _to_arrow(found: dict[str, Any]) -> Any:
    import pyarrow

    return pyarrow.table(found)


def _to_numpy(found: dict[str, Any]) -> Any:
    import numpy as np

    return {name: np.asarray(values) for name, values in found.items()}


def watcher(progress: Any) -> Optional[Callable[[int, int], Any]]:
    """A callback of rows that are finished and of all rows, or none."""
    if progress is None or progress is False:
        return None
    if progress is not True:
        if not callable(progress):
            raise TypeError("progress is True, or a function of the rows that are finished and of all rows")
        return progress
    line, began = Line(), time.monotonic()

    def show(done: int, rows: int) -> None:
        seconds = time.monotonic() - began
        left = f", {seconds * (rows - done) / done:.0f} s left" if 0 < done < rows else ""
        line.show(f"{done} of {rows} rows in {seconds:.0f} s{left}", seconds, last=done == rows)

    return show


__all__ = ["How", "how", "read", "unlike", "watcher"]
