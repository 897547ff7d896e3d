"""Many parameter sets on a Ray cluster: Arrow batches of whole blocks, a kept solver in every actor.

>>> import ntg, ntg.ray                                      # doctest: +SKIP
>>> table = ntg.ray.solve_many(ntg.load("flight.ntg"), frame)   # doctest: +SKIP

A worker that dies is begun again by Ray, and its batch is solved again with the same rows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterator, Mapping, Optional, Sequence

from . import _batches
from ._settings import DEFAULT, Settings

if TYPE_CHECKING:
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
    problem: "Problem",
    table: Any,
    *,
    columns: Optional[Sequence[str]] = None,
    values: Sequence[str] = (),
    settings: Settings = DEFAULT,
    jobs: int = 1,
    block: Optional[int] = None,
    batch: int = 2048,
    parameters: Optional[Mapping[str, Any]] = None,
    workers: Optional[int] = None,
) -> Any:
    """As `Problem.solve_many`, with the same rows, on a Ray cluster; a local one is begun where there is none.

    `jobs` is the number of rows at a time in each actor, `batch` the least number of rows that are sent at once.
    """
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
    return _batches.joined(map_batches(task, batches, workers=workers), sum(len(one) for one in batches), back)
