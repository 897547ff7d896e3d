"""Several processes: the rows of one, also when a worker is killed on the way."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import ntg
from test_many import assert_same

pytestmark = pytest.mark.slow

VALUES = ["max(speed)"]


@pytest.fixture(scope="module")
def study(flight):
    random = np.random.default_rng(2)
    table = {"v_max": 0.24 + 0.02 * random.random(600), "reach": 0.5 + random.random(600)}
    problem = flight.with_parameters(signature_max=7)
    return problem, table, problem.solve_many(table, values=VALUES, block=8)


def killed(pid, after):
    """Kills a process after so many seconds."""

    def kill():
        time.sleep(after)
        os.kill(pid, signal.SIGKILL)

    thread = threading.Thread(target=kill)
    thread.start()
    return thread


def test_dask_with_a_worker_killed_on_the_way(study):
    distributed = pytest.importorskip("distributed")
    import ntg.dask

    problem, table, whole = study
    cluster = distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None)
    with cluster, distributed.Client(cluster) as client:
        found = ntg.dask.solve_many(problem, table, client, values=VALUES, block=8, batch=64)
        assert_same(whole, found)
        pids = list(client.run(os.getpid).values())
        thread = killed(pids[0], 0.1)
        found = ntg.dask.solve_many(problem, table, client, values=VALUES, block=8, batch=16)
        thread.join()
        assert_same(whole, found)
        deadline = time.monotonic() + 30
        while pids[0] in client.run(os.getpid).values() and time.monotonic() < deadline:
            time.sleep(0.1)
        assert pids[0] not in client.run(os.getpid).values()


def test_ray_with_a_worker_killed_on_the_way(study):
    ray = pytest.importorskip("ray")
    psutil = pytest.importorskip("psutil")
    import ntg.ray
    from ntg import _batches

    problem, table, whole = study
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        assert_same(whole, ntg.ray.solve_many(problem, table, values=VALUES, block=8, batch=64))
        task, batches, back = _batches.cut(problem, table, dict(values=VALUES, block=8, batch=16), lambda: 2)
        solved, victim = [], None
        for batch in ntg.ray.map_batches(task, batches, workers=2):
            solved.append(batch)
            if victim is None:
                # Ray calls its processes after what they do; between two batches one is idle.
                children = psutil.Process().children(recursive=True)
                busy = (child.pid for child in children if "ray::solve" in " ".join(child.cmdline()))
                victim = next(busy, None)
                if victim is not None:
                    os.kill(victim, signal.SIGKILL)
        assert victim is not None
        assert_same(whole, _batches.joined(solved, 600, back))
    finally:
        ray.shutdown()
