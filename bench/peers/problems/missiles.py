"""Missile intercept, cases D1 (turning either way) and D2 (boost and coast), in km, s and rad."""

import math

import casadi as ca
import numpy as np

from ..program import Program
from ..splines import Spline, gauss, polygon


def breakpoints(intervals):
    """With Gauss points, inequalities hold at the ends of the intervals too."""
    return np.linspace(0, 1, intervals + 1)


def intercept(y_via, intervals=20):
    """The missile flies from (0, 10) km away from its target, which flies along +x at 0.2 km/s."""
    program = Program()
    tau, weights = gauss(4, intervals)
    way = polygon([(0, 10), (0, y_via), (31, 10)])
    x, y = (program.output(Spline(5, 1, intervals), f, unit=1000) for f in way)
    shorter = lambda angle: math.atan2(math.sin(angle), math.cos(angle))
    first, to_via, to_hit = math.radians(170), math.atan2(y_via - 10, 0), math.atan2(10 - y_via, 31)
    turn = shorter(to_via - first) + shorter(to_hit - to_via)
    heading = program.output(Spline(5, 2, intervals), lambda s: first + turn * s)
    duration = program.variable(60.0, 20, 200)
    at = lambda points: program.everywhere(duration, points)

    def path(u, p):
        vx, vy, angle, rate, time = u[0] / u[4], u[1] / u[4], u[2], u[3] / u[4], u[4]
        a = 1000 * rate
        return time * a**2 / 1e4, [vx - ca.cos(angle), vy - ca.sin(angle), a]

    slots = [x.at(tau, 1), y.at(tau, 1), heading.at(tau), heading.at(tau, 1), at(len(tau))]
    program.add(path, slots, weights, [0, 0, -150], [0, 0, 150])
    ends = breakpoints(intervals)
    lateral = lambda u, p: (None, [1000 * u[0] / u[1]])
    program.add(lateral, [heading.at(ends, 1), at(len(ends))], None, [-150], [150])
    program.add(lambda u, p: (u[0], []), [at(1)])
    for output, value in ((x, 0), (y, 10), (heading, first)):
        program.fix(output.at(0), value)
    hit = lambda u, p: (None, [((20 + 0.2 * u[2] - u[0]) ** 2 + (10 - u[1]) ** 2) / 0.005**2])
    program.add(hit, [x.at(1), y.at(1), at(1)], None, [-np.inf], [1])
    return program


BURN, START_SPEED = 6.0, 300.0


def boost_coast(a_max, intervals=6):
    """The quickest hit of a target at (20 - 0.25 t, 9) km; kilometres, metres a second for the speed."""
    program = Program()
    guessed = (BURN, 10.0)
    whole, begun, phases = sum(guessed), 0.0, []
    route = polygon([(0, 5), (20 - 15 * 0.25, 9)])
    functions = [*route, lambda s: START_SPEED * (1 + 2 * s), lambda s: math.radians(15)]
    for length in guessed:
        place = lambda s, begun=begun, length=length: min((begun + s * length) / whole, 1.0)
        made = []
        for function, smoothness, unit in zip(functions, (1, 1, 1, 2), (1000, 1000, 1, 1)):
            guess = lambda s, function=function, place=place: function(place(s))
            made.append(program.output(Spline(5, smoothness, intervals), guess, unit=unit))
        phases.append(made)
        begun += length
    coast = program.variable(guessed[1], 1, 60)
    motion(program, phases[0], None, a_max, intervals)
    motion(program, phases[1], coast, a_max, intervals)
    for output, value in zip(phases[0], (0, 5, START_SPEED, 0)):
        program.fix(output.at(0), value)
    for before, after in zip(*phases):
        program.add(lambda u, p: (None, [u[0] - u[1]]), [before.at(1), after.at(0)], None, [0], [0])
    x, h = phases[1][:2]
    hit = lambda u, p: (None, [u[0] - (20 - 0.25 * (BURN + u[1]))])
    program.add(hit, [x.at(1), program.everywhere(coast, 1)], None, [0], [0])
    program.fix(h.at(1), 9)
    program.add(lambda u, p: (BURN + u[0], []), [program.everywhere(coast, 1)])
    return program


def motion(program, outputs, coast, a_max, intervals):
    """The equations of motion of one phase; the boost has no free duration, but its time matters."""
    x, h, v, gamma = outputs
    tau, _ = gauss(4, intervals)
    g, area = 9.81, 0.025

    def path(u, p):
        height, speed, angle = u[2], u[3], u[5]
        if coast is None:
            duration, mass, thrust = BURN, 150 - 50 * u[7], 18e3
        else:
            duration, mass, thrust = u[7], 100, 0
        vx, vh, pull, turn = u[0] / duration, u[1] / duration, u[4] / duration, u[6] / duration
        pressure = 1.225 * ca.exp(-height / 8.5) * speed**2 / 2
        a_n = speed * turn + g * ca.cos(angle)
        drag = 0.35 * pressure * area + 0.02 * (mass * a_n) ** 2 / (pressure * area)
        along = (mass * (pull + g * ca.sin(angle)) - thrust + drag) / 1e3
        return None, [vx - speed * ca.cos(angle) / 1e3, vh - speed * ca.sin(angle) / 1e3, along, a_n]

    def across(u, p):
        return None, [u[0] * u[2] / (BURN if coast is None else u[3]) + g * ca.cos(u[1])]

    ends = breakpoints(intervals)
    fixed = lambda points: program.everywhere(coast, len(points)) if coast is not None else points
    slots = [v.at(ends), gamma.at(ends), gamma.at(ends, 1), fixed(ends)]
    program.add(across, slots, None, [-a_max], [a_max])
    slots = [x.at(tau, 1), h.at(tau, 1), h.at(tau), v.at(tau), v.at(tau, 1), gamma.at(tau), gamma.at(tau, 1)]
    program.add(path, [*slots, fixed(tau)], None, [0, 0, 0, -a_max], [0, 0, 0, a_max])
