"""Many parameter sets on a Ray cluster: Arrow batches of whole blocks, a kept solver in every actor.

>>> import ntg, ntg.ray                                      # doctest: +SKIP
>>> table = ntg.ray.solve_many(ntg.load("flight.ntg"), frame)   # doctest: +SKIP

A worker that dies is begun again by Ray, and its batch is solved again with the same rows.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Iterator, Optional, Sequence

from . import _batches, _given

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._problem import Problem

__all__ = ["map_batches", "solve_many"]


AHEAD = 2
"""Batches that an actor has at a time: it works on one, and the other waits with it."""


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

    count = _workers(workers)
    # A worker that dies is begun anew, and what it was doing is done again.
    actor = ray.remote(num_cpus=1, max_restarts=-1, max_task_retries=-1)(_Worker)
    actors = [actor.remote(task) for _ in range(max(1, min(count, len(batches))))]
    pool = ActorPool(actors * AHEAD)
    yield from pool.map_unordered(lambda worker, batch: worker.solve.remote(batch), list(batches))


def _workers(wanted: Optional[int]) -> int:
    """The number of actors, on a cluster that is begun where there is none."""
    import ray

    count = None if wanted is None else _given.count(wanted, "`workers`, the number of actors,", 1)
    if not ray.is_initialized():
        ray.init()
    return count or max(1, int(ray.cluster_resources().get("CPU", 1)))


def solve_many(
    problem: "Problem", table: Any, *, workers: Optional[int] = None, **options: "Unpack[_batches.Options]"
) -> Any:
    """As `Problem.solve_many`, with the same rows, on a Ray cluster; a local one is begun where there is none.

    Options are `columns`, `values`, `settings`, `block` and `parameters` of `Problem.solve_many`; `jobs`, the number of
    rows at a time in each actor (1); and `batch`, the number of rows that are sent at once, at most (2048).
    """
    solve = partial(map_batches, workers=workers)
    return _batches.solve_many(solve, partial(_workers, workers), problem, table, options)
