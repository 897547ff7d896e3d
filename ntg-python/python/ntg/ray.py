"""Many parameter sets on a Ray cluster: Arrow batches of whole blocks, the problem compiled once in every worker.

>>> import ntg, ntg.ray                                      # doctest: +SKIP
>>> table = ntg.ray.solve_many(ntg.load("flight.ntg"), frame)   # doctest: +SKIP

Batches are Ray tasks: their worker processes are there before the first call and stay for the next one. Where one dies,
its batch is solved again by another, with the same rows.
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
"""Batches a worker that Ray has at a time: one is solved, and the next one waits for it."""


def map_batches(task: "_batches.Task", batches: Sequence[Any], *, workers: Optional[int] = None) -> Iterator[Any]:
    """The solved batches, Arrow tables, as they come. `workers` is how many are solved at a time, by a core each; one
    for each core of the cluster otherwise."""
    import ray

    count, cores = _workers(workers), _cores()
    # Cores keep to the number of workers where all of them are wanted; else nothing may wait beside what is solved.
    most = count * AHEAD if count >= cores else count
    solve = ray.remote(num_cpus=1, max_retries=-1)(_batches.solve)
    shared, left = ray.put(task), list(reversed(batches))
    sent: list[Any] = []
    try:
        while left or sent:
            while left and len(sent) < most:
                sent.append(solve.remote(shared, left.pop()))
            ready, sent = ray.wait(sent)
            yield ray.get(ready[0])
    finally:
        # Nobody waits for what is still on its way where the caller has stopped, or a batch could not be solved.
        for batch in sent:
            ray.cancel(batch, force=True)


def _cores() -> int:
    """Those of the cluster."""
    import ray

    return max(1, int(ray.cluster_resources().get("CPU", 1)))


def _workers(wanted: Optional[int]) -> int:
    """How many batches are solved at a time, on a cluster that is begun where there is none."""
    import ray

    count = None if wanted is None else _given.count(wanted, "`workers`, the number of batches at a time,", 1)
    if not ray.is_initialized():
        ray.init()
    return count or _cores()


def solve_many(
    problem: "Problem", table: Any, *, workers: Optional[int] = None, **options: "Unpack[_batches.Options]"
) -> Any:
    """As `Problem.solve_many`, with the same rows, on a Ray cluster; a local one is begun where there is none.

    `workers` is how many batches are solved at a time, by a core each; one for each core of the cluster otherwise.
    Options are `columns`, `values`, `settings`, `block` and `parameters` of `Problem.solve_many`; `jobs`, the number of
    rows at a time in each worker (1); and `batch`, the number of rows that are sent at once, at most (2048).
    """
    solve = partial(map_batches, workers=workers)
    return _batches.solve_many(solve, partial(_workers, workers), problem, table, options)
