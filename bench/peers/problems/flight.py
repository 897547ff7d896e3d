"""The low-observability flight, cases B1 to B4, in km and s."""

import math

import casadi as ca
import numpy as np

from ..program import Program, widened
from ..splines import Spline, gauss, polygon, uniform

START, TARGET, ALTITUDE = (-100.0, -100.0), (5.0, -15.0), 12.0
V_MIN, V_MAX, RHO_MIN = 0.10, 0.25, 5.0
SHORTEST, LONGEST = 100, 3000  # Of the whole flight.
ROOM = 1e-6  # What the cosine form holds between the signature's least value and its limit.
CONTINUATION = [[20.0], [10.0], [5.0], [2.0], [1.0]]
ROUTE_A, ROUTE_B = (-100.0, -15.0), (0.0, -100.0)
NOSE_IN = np.polyfit([0, 20, 45, 90], [1.5, 2.5, 3.5, 6.5], 3)  # The cubic through the nose-in column.


def logistic(x):
    return 1 / (1 + ca.exp(-x))


class State:
    """What the pilot knows at one point: `u` is x, x', x'', y, y', y'' by scaled time, and the duration."""

    def __init__(self, u):
        self.duration = u[6]
        self.x, self.vx, self.ax = u[0], u[1] / u[6], u[2] / u[6] ** 2
        self.y, self.vy, self.ay = u[3], u[4] / u[6], u[5] / u[6] ** 2
        self.speed = ca.sqrt(self.vx**2 + self.vy**2)
        turn = self.vx * self.ay - self.vy * self.ax
        self.curvature = turn / (self.vx**2 + self.vy**2) ** 1.5

    def limits(self):
        """The rows of speed and turn, and their bounds."""
        return [self.speed, RHO_MIN * self.curvature], [V_MIN, -1], [V_MAX, 1]


class Seen(State):
    """The same with the radar at the origin; `width` of the blend in degrees."""

    def __init__(self, u, width):
        super().__init__(u)
        self.ground = ca.sqrt(self.x**2 + self.y**2)
        self.ahead = -(self.x * self.vx + self.y * self.vy) / self.speed
        left = (self.x * self.vy - self.y * self.vx) / self.speed
        self.azimuth = ca.atan2(left, self.ahead) * 180 / math.pi
        self.elevation = ca.atan2(ALTITUDE, self.ground) * 180 / math.pi
        self.nose_in = sum(c * self.elevation**k for k, c in enumerate(NOSE_IN[::-1]))
        self.nose_out = 5.5 + logistic((self.elevation - 45) / 6)
        self.width = width
        away = logistic((self.azimuth - 30.5) / width) + logistic((-self.azimuth - 30.5) / width)
        self.signature = self.nose_in + (self.nose_out - self.nose_in) * away

    def detection(self):
        slant = ca.sqrt(self.x**2 + self.y**2 + ALTITUDE**2)
        margin = ca.log(slant) - math.log(10) / 4 * self.signature - 2.1477
        return logistic(-margin / 0.0634)

    def cosine(self, limit):
        """Two rows: at least 0 and 1e-6 where the signature is at most `limit`."""
        room = limit - self.nose_in
        widest = 30.5 + self.width * ca.log(ca.fmax(room, ROOM) / (self.nose_out - limit))
        return [self.ahead / self.ground - ca.cos(widest * math.pi / 180), room]


def stretch(limit, cosine, detection):
    """The formula of one phase, and the bounds of its rows. No `limit`: what is seen only costs."""

    def formula(u, p):
        state = Seen(u, p)
        cost = 3e4 * state.speed**2 + 20 * state.signature
        cost = cost + detection * state.detection() if detection else cost
        rows, _, _ = state.limits()
        if limit is not None:
            rows += state.cosine(limit) if cosine else [state.signature]
        return 1e-4 * state.duration * cost, rows

    lower, upper = [V_MIN, -1], [V_MAX, 1]
    if limit is not None:
        lower += [0, ROOM] if cosine else [-np.inf]
        upper += [np.inf, np.inf] if cosine else [limit]
    return formula, lower, upper


def flight(phases, route=(ROUTE_A,), intervals=8, cosine=False, detection=0, rule="uniform"):
    """`phases` are (shortest, longest, guessed duration, limit of the signature)."""
    limited = any(phase[3] is not None for phase in phases)
    program = Program(steps=CONTINUATION if limited and not cosine else CONTINUATION[-1:])
    tau, weights = uniform(5 * intervals + 1) if rule == "uniform" else gauss(5, intervals)
    way = polygon([START, *route, TARGET])
    whole, begun, made = sum(phase[2] for phase in phases), 0.0, []
    for _, _, guess, _ in phases:
        place = lambda s, f, begun=begun, guess=guess: f(min((begun + s * guess) / whole, 1.0))
        made.append([program.output(Spline(5, 3, intervals), lambda s, f=f: place(s, f), unit=1000) for f in way])
        begun += guess
    durations = [program.variable(guess, shortest, longest) for shortest, longest, guess, _ in phases]
    for (x, y), duration, (_, _, _, limit) in zip(made, durations, phases):
        slots = [o.at(tau, d) for o in (x, y) for d in range(3)] + [program.everywhere(duration, len(tau))]
        formula, lower, upper = stretch(limit, cosine, detection)
        program.add(formula, slots, weights, lower, upper)
    ends(program, made, durations)
    return program


def ends(program, made, durations):
    """Start, target, joints of phases, and the time squared."""
    for output, start in zip(made[0], START):
        program.fix(output.at(0), start)
    arrival = lambda u, p: (None, [(u[0] - TARGET[0]) ** 2 + (u[1] - TARGET[1]) ** 2])
    program.add(arrival, [output.at(1) for output in made[-1]], None, [-np.inf], [1])
    whole = sum_of(program, durations)
    program.add(lambda u, p: (1e-4 * u[0] ** 2, []), [whole])
    if len(durations) > 1:
        program.add(lambda u, p: (None, [u[0]]), [whole], None, [SHORTEST], [LONGEST])
    for before, after, one, two in zip(made, made[1:], durations, durations[1:]):
        times = [program.everywhere(one, 1), program.everywhere(two, 1)]
        for left, right in zip(before, after):
            program.fix(minus(left.at(1), right.at(0)), 0)
            for d in (1, 2):
                joint = lambda u, p, d=d: (None, [u[0] / u[2] ** d - u[1] / u[3] ** d])
                program.add(joint, [left.at(1, d), right.at(0, d), *times], None, [0], [0])


def minus(a, b):
    width = max(a.shape[1], b.shape[1])
    return widened(a, width) - widened(b, width)


def sum_of(program, indices):
    return sum(widened(program.everywhere(index, 1), program.variables) for index in indices)


def b1(**options):
    return flight([(SHORTEST, LONGEST, 900, None)], **options)


def b2(**options):
    return flight([(SHORTEST, LONGEST, 900, 4.2)], **options)


def b3(**options):
    """Nothing is above 6.5, so in the cosine form the second limit has no counterpart and is left out."""
    second = None if options.get("cosine") else 6.5
    return flight([(100, 1000, 600, 4.2), (20, 40, 30, second)], **options)


def b4(**options):
    return b2(detection=400, **options)
