"""What a row of a study costs beside a solve by a kept solver, on one core: low-observability flight without limit (B1).

    ntg-python/.venv/bin/python bench/study/rows.py [ROWS [TURNS]]      # with the wheel installed

Prints processor seconds of both by turns, and their ratios: rows from the guess of the spec (`block=1`), rows from the
solution of a neighbour (`block=32`), and a row with a wanted value that is looked at 401 times.
"""

import statistics
import sys
import time
from pathlib import Path

import numpy as np

import ntg

SPEC = Path(__file__).resolve().parents[2] / "specs" / "low_observable.ntg"


def cost(work):
    """Processor seconds of this process, all threads."""
    began = time.process_time()
    work()
    return time.process_time() - began


def main():
    rows = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    turns = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    random = np.random.default_rng(1)
    table = {"v_max": 0.23 + 0.04 * random.random(rows), "reach": 0.5 + random.random(rows)}
    problem = ntg.load(SPEC).with_parameters(signature_max=7)
    solver = problem.solver()
    solver.solve()

    def kept():
        for v_max, reach in zip(table["v_max"], table["reach"]):
            solver.solve(v_max=v_max, reach=reach)

    works = {
        "a solve by a kept solver": kept,
        "a row from the guess (block=1)": lambda: problem.solve_many(table, jobs=1, block=1),
        "a row from a neighbour (block=32)": lambda: problem.solve_many(table, jobs=1, block=32),
        "the same with max(speed)": lambda: problem.solve_many(table, jobs=1, block=32, values=["max(speed)"]),
    }
    times = {name: [] for name in works}
    for _ in range(turns):
        for name, work in works.items():
            times[name].append(cost(work) / rows)
    base = times["a solve by a kept solver"]
    for name, found in times.items():
        ratio = statistics.median(one / other for one, other in zip(found, base))
        print(f"{name:36} {1e3 * statistics.median(found):8.3f} ms  ratio {ratio:.2f}")
    for block in (1, 32):
        found = problem.solve_many(table, block=block)
        solved = np.mean(found["status"] == "solved")
        print(f"block={block}: {np.mean(found['iterations']):.1f} iterations a row, {100 * solved:.1f} % solved")


if __name__ == "__main__":
    main()
