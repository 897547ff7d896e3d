"""What tests share: the specs of the repository, and small ones."""

import os
from pathlib import Path

import pytest

# Ray reads it when it is imported: a loaded machine takes longer than the usual half minute.
os.environ.setdefault("RAY_raylet_start_wait_time_s", "180")

import ntg

SPECS = Path(__file__).resolve().parents[2] / "specs"

MOVE = """
/// From rest to rest with the least effort: a cubic, with cost 12 distance^2 / T^3.
problem Move {
    duration T = 2 [s];
    /// How far.
    param distance = 1 [m];
    param limit = 100 [m/s];
    output x [m]: spline(order = 6, intervals = 2);
    let speed [cm/s] = der(x);
    let mean [m/s] = distance / T;
    minimize effort: integral(der(x, 2)^2);
    initial { x == 0;  der(x) == 0; }
    trajectory { slow: der(x) <= limit; }
    final { reach: x == distance;  der(x) == 0; }
}
"""


@pytest.fixture(scope="session")
def move():
    return ntg.loads(MOVE, name="move.ntg")


@pytest.fixture(scope="session")
def flight():
    return ntg.load(SPECS / "low_observable.ntg")
