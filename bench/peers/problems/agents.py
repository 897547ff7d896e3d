"""Several vehicles with conditions on their times, table C, in km and s."""

import math

import numpy as np

from ..program import Program, widened
from ..splines import Spline, polygon, uniform
from .flight import State

APART = 5.0


def off(i, n):
    return i + 1 - (n + 1) / 2


def ends_of(i, n):
    o = off(i, n)
    return (-100 - 3 * abs(o) + 6 * o, 12 * o), (10 * math.cos(o), -6 * o)


def vehicle(u, p):
    """The formula of a flight without radar."""
    state = State(u)
    rows, _, _ = state.limits()
    return 1e-4 * state.duration * 3e4 * state.speed**2, rows


def fleet(n, times, guess=600, intervals=8):
    """`times` is free, equal or later (by 30 .. 60 s each); all durations start at `guess`."""
    program = Program()
    tau, weights = uniform(5 * intervals + 1)
    made = [positions(program, i, n, intervals, 0.0) for i in range(n)]
    durations = [program.variable(guess, 100, 3000) for _ in range(n)]
    for i in range(n):
        add_vehicle(program, made[i], durations[i], (tau, weights), ends_of(i, n)[1])
        program.add(lambda u, p: (1e-4 * u[0] ** 2, []), [program.everywhere(durations[i], 1)])
    for one, two in zip(durations, durations[1:]):
        width = program.variables
        later = widened(program.everywhere(two, 1), width) - widened(program.everywhere(one, 1), width)
        if times == "equal":
            program.fix(later, 0)
        if times == "later":
            program.add(lambda u, p: (None, [u[0]]), [later], None, [30], [60])
    return program


def separated(n, guess=600, intervals=8, bow=5.0):
    """One clock for all, every pair apart at every point; guesses bow sideways, alternately."""
    program = Program()
    tau, weights = uniform(5 * intervals + 1)
    made = [positions(program, i, n, intervals, (-1) ** i * bow) for i in range(n)]
    duration = program.variable(guess, 100, 3000)
    for i in range(n):
        add_vehicle(program, made[i], duration, (tau, weights), ends_of(i, n)[1])
    program.add(lambda u, p: (n * 1e-4 * u[0] ** 2, []), [program.everywhere(duration, 1)])
    apart = lambda u, p: (None, [(u[0] - u[1]) ** 2 + (u[2] - u[3]) ** 2])
    for i in range(n):
        for j in range(i + 1, n):
            slots = [made[i][0].at(tau), made[j][0].at(tau), made[i][1].at(tau), made[j][1].at(tau)]
            program.add(apart, slots, None, [APART**2], [np.inf])
    return program


def positions(program, i, n, intervals, bow):
    """The two outputs of vehicle `i`, guessed straight, or bowed to one side."""
    (x0, y0), (x1, y1) = ends_of(i, n)
    half = [((x0 + x1) / 2, (y0 + y1) / 2 + bow)] if bow else []
    way = polygon([(x0, y0), *half, (x1, y1)])
    return [program.output(Spline(5, 3, intervals), f, unit=1000) for f in way]


def add_vehicle(program, outputs, duration, points, target):
    tau, weights = points
    slots = [o.at(tau, d) for o in outputs for d in range(3)] + [program.everywhere(duration, len(tau))]
    program.add(vehicle, slots, weights, [0.10, -1], [0.25, 1])
    for output, velocity, aim in zip(outputs, (0.2, 0.0), target):
        program.fix(output.at(0), output_start(program, output))
        program.fix(output.at(1), aim)
        fast = lambda u, p: (None, [u[0] / u[1]])
        program.add(fast, [output.at(0, 1), program.everywhere(duration, 1)], None, [velocity], [velocity])


def output_start(program, output):
    """Guesses are exact at their ends, so the first coefficient is where the vehicle departs."""
    return program.start[output.first]
