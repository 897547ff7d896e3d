"""python-control's flat systems, on the one problem here that they can state.

`point_to_point` needs a fixed time, the whole state and input at both ends, and adds the cost up over the
inner points: that is the lane change, whose cost vanishes at its ends. Van der Pol's oscillator ends on a
line and not in a state; the other problems have free times.
"""

import time
import warnings

import control.flatsys
import numpy as np


class LaneChange:
    """The car's flat outputs as two double integrators; the inputs are the accelerations."""

    def __init__(self):
        forward = lambda x, u, params: [np.array([x[i], x[i + 2], u[i]]) for i in range(2)]
        reverse = lambda z, params: (np.array([z[0][0], z[1][0], z[0][1], z[1][1]]), np.array([z[0][2], z[1][2]]))
        self.system = control.flatsys.FlatSystem(forward, reverse, inputs=2, states=4)
        self.basis = control.flatsys.BSplineFamily([0, 2.5, 5], 4, 2, vars=2)
        self.points = np.linspace(0, 5, 20)

    def once(self):
        clocks = time.perf_counter(), time.process_time()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "Precision loss" is said by `success` as well.
            found = control.flatsys.point_to_point(
                self.system,
                self.points,
                [0, -2, 8, 0],
                [0, 0],
                [40, 2, 8, 0],
                [0, 0],
                cost=lambda x, u: u @ u,
                basis=self.basis,
                minimize_method="SLSQP",
                minimize_options={"ftol": 1e-10},
            )
        wall, cpu = time.perf_counter() - clocks[0], time.process_time() - clocks[1]
        return {
            "wall": [wall],
            "cpu": [cpu],
            "objective": float(found.cost),
            "solved": bool(found.success),
            "status": str(found.message),
            "iterations": 0,
        }

    def answer(self, seconds, solves):
        """Solves again until there is enough to tell a median."""
        answers = [self.once()]
        while len(answers) < solves and sum(a["wall"][0] for a in answers) < seconds:
            answers.append(self.once())
        clocks = {clock: [a[clock][0] for a in answers] for clock in ("wall", "cpu")}
        return answers[-1] | clocks
