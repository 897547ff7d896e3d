"""Many parameter sets on a Ray cluster: Arrow batches of whole blocks, a kept solver in every actor.

>>> import ntg, ntg.ray                                      # doctest: +SKIP
>>> table = ntg.ray.solve_many(ntg.load("flight.ntg"), frame)   # doctest: +SKIP

A worker that dies is begun again by Ray, and its batch is solved again with the same rows.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Iterator, Optional, Sequence

from . import _batches

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._problem import Problem

__all__ = ["map_batches", "solve_many"]


class _Worker:
    """Holds the compiled problem."""

    def __init__(self, task: "_batches.Task") -> None:
        self._task = task

    def solve(self, batch: Any) -> Any:
        return _batches.solve(self._task, batch)


def map_batches(task: "_batches.Task", batches: Sequence[Any], *, workers: Optional[int] = None) -> Iterator[Any]:
    """The solved batches, Arrow tables, as they come. `workers` is the number of actors, one for each core otherwise."""
    import ray
    from ray.util import ActorPool

    if not ray.is_initialized():
        ray.init()
    count = workers or int(ray.cluster_resources().get("CPU", 1))
    # A worker that dies is begun anew, and what it was doing is done again.
    actor = ray.remote(num_cpus=1, max_restarts=-1, max_task_retries=-1)(_Worker)
    shared = ray.put(task)
    pool = ActorPool([actor.remote(shared) for _ in range(max(1, min(count, len(batches))))])
    yield from pool.map_unordered(lambda worker, batch: worker.solve.remote(batch), list(batches))


def solve_many(
    problem: "Problem", table: Any, *, workers: Optional[int] = None, **options: "Unpack[_batches.Options]"
) -> Any:
    """As `Problem.solve_many`, with the same rows, on a Ray cluster; a local one is begun where there is none.

    Options are `columns`, `values`, `settings`, `block` and `parameters` of `Problem.solve_many`; `jobs`, the number of
    rows at a time in each actor (1); and `batch`, the least number of rows that are sent at once (2048).
    """
    return _batches.solve_many(partial(map_batches, workers=workers), problem, table, options)
