"""Many parameter sets on a Dask cluster: Arrow batches of whole blocks, a kept solver on every worker.

>>> from dask.distributed import Client                      # doctest: +SKIP
>>> import ntg, ntg.dask                                     # doctest: +SKIP
>>> with Client() as client:                                 # doctest: +SKIP
...     table = ntg.dask.solve_many(ntg.load("flight.ntg"), frame, client)

A worker that dies is Dask's matter: its batches are solved again elsewhere, with the same rows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence

from . import _batches
from ._settings import DEFAULT, Settings

if TYPE_CHECKING:
    from ._problem import Problem

__all__ = ["map_batches", "solve_many"]


def map_batches(task: "_batches.Task", batches: Sequence[Any], client: Any, *, retries: int = 10) -> list[Any]:
    """Futures of the solved batches, Arrow tables, in the order of the batches."""
    # The task goes with every batch: a worker that joins later, or comes back, needs nothing but its batch.
    return [client.submit(_batches.solve, task, batch, pure=False, retries=retries) for batch in batches]


def solve_many(
    problem: "Problem",
    table: Any,
    client: Any = None,
    *,
    columns: Optional[Sequence[str]] = None,
    values: Sequence[str] = (),
    settings: Settings = DEFAULT,
    jobs: int = 1,
    block: Optional[int] = None,
    batch: int = 2048,
    parameters: Optional[Mapping[str, Any]] = None,
) -> Any:
    """As `Problem.solve_many`, with the same rows, on the workers of a client; the present client where none is given.

    `jobs` is the number of rows at a time on each worker's thread, `batch` the least number of rows that are sent at
    once.
    """
    from dask.distributed import get_client

    client = get_client() if client is None else client
    task, batches, back = _batches.cut(
        problem,
        table,
        columns=columns,
        values=values,
        settings=settings,
        jobs=jobs,
        block=block,
        batch=batch,
        parameters=parameters,
    )
    futures = map_batches(task, batches, client)
    try:
        return _batches.joined(client.gather(futures), sum(len(one) for one in batches), back)
    finally:
        client.cancel(futures)
