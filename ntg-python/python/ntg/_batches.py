"""Arrow batches of whole blocks, for workers elsewhere: what `ntg.ray` and `ntg.dask` share.

A scheduler sees batches, never rows. Rows of a batch are those that `Problem.solve_many` gives, bit for bit, because a
batch holds whole blocks: see `Problem.solve_many`.
"""

from __future__ import annotations

from typing import Any, Callable, Iterable, Mapping, NamedTuple, Optional, Sequence, TypedDict

from . import _given, _ntg, _table
from ._errors import TableError
from ._problem import Problem, merged
from ._settings import DEFAULT, Settings, checked

ROW = "row"
BLOCK = "block"
LEAST = 64
"""Rows of a batch at least. A fit: a scheduler works on a batch as long as a solver on some ten rows of the flight."""


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
    """The number of rows that are sent at once, at most; the last batches are smaller."""
    parameters: Optional[Mapping[str, Any]]


DEFAULTS = Options(columns=None, values=(), settings=DEFAULT, jobs=1, block=None, batch=2048, parameters=None)


def cut(problem: Problem, table: Any, options: Options, workers: "Callable[[], int]") -> "tuple[Task, list[Any], Any]":
    """The task, the batches as Arrow tables with the columns `row` and `block`, and what makes a table of the rows.

    How many workers there are is asked once all else is checked. A batch is half of a worker's share of
    the rows that are left, so that workers end together (guided self-scheduling: Polychronopoulos and Kuck, 1987), but
    no larger than `batch`.
    """
    import numpy as np
    import pyarrow

    unknown = [name for name in options if name not in DEFAULTS]
    if unknown:
        raise TypeError(f"there is no option `{unknown[0]}`; there are: {', '.join(f'`{name}`' for name in DEFAULTS)}")
    how: Options = {**DEFAULTS, **options}
    run = _table.how(how["values"], how["jobs"], how["block"])
    try:
        batch = _given.count(how["batch"], "`batch`, the number of rows that are sent at once,", 1)
    except ValueError as error:
        raise TableError(str(error)) from None
    settings = checked(how["settings"])
    _given.instance(problem, Problem, "the problem")
    problem = Problem(problem._core.with_parameters(merged(how["parameters"], {})))
    inputs, sets, back = _table.read(problem._core, table, how["columns"])
    _table.unlike(inputs, how["parameters"])
    # No row at all: finds what a worker would find, before there is one.
    _ntg.sweep(problem._core, inputs, sets[:0], settings, run, None)
    pieces = _ntg.blocks(sets, run.block)
    batches, some, count, left, shares = [], [], 0, len(sets), 2 * workers()
    for number, rows in enumerate(pieces):
        some.append((number, rows))
        count += len(rows)
        if count >= min(batch, max(LEAST, left // shares)) or number + 1 == len(pieces):
            order = np.concatenate([rows for _, rows in some])
            numbers = np.concatenate([np.full(len(rows), number) for number, rows in some])
            data = {ROW: order, BLOCK: numbers, **{name: sets[order, i] for i, name in enumerate(inputs)}}
            batches.append(pyarrow.table(data))
            some, count, left = [], 0, left - count
    return Task(problem, inputs, run.values, settings, run.jobs, run.block), batches, back


def solve_many(
    map_batches: "Callable[[Task, Sequence[Any]], Iterable[Any]]",
    workers: "Callable[[], int]",
    problem: Problem,
    table: Any,
    options: Options,
) -> Any:
    """The rows of a table, whose batches `map_batches` solves on so many workers, in any order."""
    task, batches, back = cut(problem, table, options, workers)
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
    whole = whole.take(order)

    def plain(column: Any) -> Any:
        is_text = pyarrow.types.is_string(column.type) or pyarrow.types.is_large_string(column.type)
        return column.to_pylist() if is_text else column.to_numpy()

    return back({name: plain(whole.column(name)) for name in whole.column_names})


__all__ = ["Options", "Task", "cut", "joined", "solve", "solve_many"]
