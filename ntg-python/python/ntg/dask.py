"""Many parameter sets on a Dask cluster: Arrow batches of whole blocks, a kept solver on every worker.

>>> from dask.distributed import Client                      # doctest: +SKIP
>>> import ntg, ntg.dask                                     # doctest: +SKIP
>>> with Client() as client:                                 # doctest: +SKIP
...     table = ntg.dask.solve_many(ntg.load("flight.ntg"), frame, client)

A worker that dies is Dask's matter: its batches are solved again elsewhere, with the same rows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Sequence

from . import _batches, _given

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._problem import Problem

__all__ = ["map_batches", "solve_many"]


def map_batches(task: "_batches.Task", batches: Sequence[Any], client: Any, *, retries: int = 10) -> list[Any]:
    """Futures of the solved batches, Arrow tables, in the order of the batches."""
    # The task goes with every batch: a worker that joins later, or comes back, needs nothing but its batch.
    return [client.submit(_batches.solve, task, batch, pure=False, retries=retries) for batch in batches]


def solve_many(problem: "Problem", table: Any, client: Any = None, **options: "Unpack[_batches.Options]") -> Any:
    """As `Problem.solve_many`, with the same rows, on the workers of a client; the present client where none is given.

    Options are `columns`, `values`, `settings`, `block` and `parameters` of `Problem.solve_many`; `jobs`, the number of
    rows at a time on each worker's thread (1); and `batch`, the number of rows that are sent at once, at most (2048).
    """
    from dask.distributed import get_client

    if client is None:
        try:
            client = get_client()
        except ValueError:
            raise ValueError("there is no Dask client; make one, `Client()`, and give it as `client`") from None
    if not hasattr(client, "submit"):
        raise TypeError(f"`client` is a dask.distributed.Client, not {_given.kind(client)}")
    futures: list[Any] = []

    def workers() -> int:
        return max(1, sum(int(threads) for threads in client.nthreads().values()))

    def gathered(task: "_batches.Task", batches: Sequence[Any]) -> Any:
        futures.extend(map_batches(task, batches, client))
        return client.gather(futures)

    try:
        return _batches.solve_many(gathered, workers, problem, table, options)
    finally:
        client.cancel(futures)
