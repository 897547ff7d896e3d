"""Arrow batches of whole blocks, for workers elsewhere: what `ntg.ray` and `ntg.dask` share.

A scheduler sees batches, never rows. Rows of a batch are those that `Problem.solve_many` gives, bit for bit, because a
batch holds whole blocks: see `Problem.solve_many`.
"""

from __future__ import annotations

from typing import Any, Callable, Iterable, Mapping, NamedTuple, Optional, Sequence, TypedDict

from . import _ntg, _table
from ._errors import TableError
from ._problem import Problem, merged
from ._settings import DEFAULT, Settings

ROW = "row"
BLOCK = "block"


class Task(NamedTuple):
    """What a worker needs to know beside its batches. It can be pickled."""

    problem: Problem
    inputs: list[str]
    values: list[str]
    settings: Settings
    jobs: int
    block: Optional[int]


class Options(TypedDict, total=False):
    """What a study on a cluster may be told, as `Problem.solve_many` is."""

    columns: Optional[Sequence[str]]
    values: Sequence[str]
    settings: Settings
    jobs: int
    """The number of rows at a time in each worker."""
    block: Optional[int]
    batch: int
    """The least number of rows that are sent at once."""
    parameters: Optional[Mapping[str, Any]]


DEFAULTS = Options(columns=None, values=(), settings=DEFAULT, jobs=1, block=None, batch=2048, parameters=None)


def cut(problem: Problem, table: Any, options: Options) -> "tuple[Task, list[Any], Any]":
    """The task, the batches as Arrow tables with the columns `row` and `block`, and what makes a table of the rows."""
    import numpy as np
    import pyarrow

    unknown = [name for name in options if name not in DEFAULTS]
    if unknown:
        raise TypeError(f"there is no option `{unknown[0]}`; there are: {', '.join(f'`{name}`' for name in DEFAULTS)}")
    how: Options = {**DEFAULTS, **options}
    block, batch = how["block"], how["batch"]
    if batch < 1 or (block is not None and block < 1):
        raise TableError("`batch` and `block` are numbers of rows, at least 1")
    problem = Problem(problem._core.with_parameters(merged(how["parameters"], {})))
    inputs, sets, back = _table.read(problem._core, table, how["columns"])
    pieces = _ntg.blocks(sets, block)
    batches, some, count = [], [], 0
    for number, rows in enumerate(pieces):
        some.append((number, rows))
        count += len(rows)
        if count >= batch or number + 1 == len(pieces):
            order = np.concatenate([rows for _, rows in some])
            numbers = np.concatenate([np.full(len(rows), number) for number, rows in some])
            data = {ROW: order, BLOCK: numbers, **{name: sets[order, i] for i, name in enumerate(inputs)}}
            batches.append(pyarrow.table(data))
            some, count = [], 0
    return Task(problem, inputs, list(how["values"]), how["settings"], how["jobs"], block), batches, back


def solve_many(
    map_batches: "Callable[[Task, Sequence[Any]], Iterable[Any]]", problem: Problem, table: Any, options: Options
) -> Any:
    """The rows of a table, whose batches `map_batches` solves somewhere, in any order."""
    task, batches, back = cut(problem, table, options)
    return joined(map_batches(task, batches), sum(len(one) for one in batches), back)


def solve(task: Task, batch: Any) -> Any:
    """Solves one batch; gives an Arrow table of its rows. Solvers are kept within the batch."""
    import numpy as np
    import pyarrow

    numbers = batch.column(BLOCK).to_numpy()
    starts = np.flatnonzero(np.diff(numbers, prepend=-1))
    lengths = np.diff(np.append(starts, len(numbers)))
    sets = np.column_stack([batch.column(name).to_numpy() for name in task.inputs])
    how = _table.How(task.values, task.jobs, task.block, [int(length) for length in lengths], None)
    found = dict(_ntg.sweep(task.problem._core, task.inputs, sets, task.settings, how, None))
    found[ROW] = batch.column(ROW).to_numpy()
    return pyarrow.table(found)


def joined(tables: Iterable[Any], count: int, back: Any) -> Any:
    """The rows of all batches in order, as a table of the kind that was given. Every row is there once."""
    import numpy as np
    import pyarrow

    # A batch in which no row could be solved has no results.
    whole = pyarrow.concat_tables(list(tables), promote_options="default")
    rows = whole.column(ROW).to_numpy()
    order = np.argsort(rows, kind="stable")
    if not np.array_equal(rows[order], np.arange(count)):
        raise RuntimeError("rows were lost or solved twice")
    columns = {}
    for name in whole.column_names:
        column = whole.column(name)
        is_text = pyarrow.types.is_string(column.type) or pyarrow.types.is_large_string(column.type)
        columns[name] = [column.to_pylist()[i] for i in order] if is_text else column.to_numpy()[order]
    return back(columns)


__all__ = ["Options", "Task", "cut", "joined", "solve", "solve_many"]
