"""NTG's own examples: van der Pol's oscillator and the car that changes lane."""

from ..program import Program
from ..splines import Spline, gauss, uniform


def points(rule, intervals):
    return uniform(20) if rule == "uniform" else gauss(5, intervals)


def van_der_pol(rule="uniform", intervals=2):
    """min 1/2 int z^2 + z'^2 + u^2, u = z'' + z - (1 - z^2) z', over five seconds."""
    program, duration = Program(), 5.0
    z = program.output(Spline(5, 3, intervals), lambda tau: 1.0)
    tau, weights = points(rule, intervals)

    def cost(u, p):
        z, v, a = u[0], u[1] / duration, u[2] / duration**2
        force = a + z - (1 - z**2) * v
        return 0.5 * duration * (z**2 + v**2 + force**2), []

    program.add(cost, [z.at(tau, d) for d in range(3)], weights)
    program.fix(z.at(0), 1)
    program.fix(z.at(0, 1) / duration, 0)
    program.fix(z.at(1, 1) / duration - z.at(1), 1)
    return program


def kinematic_car(rule="uniform"):
    """min int x''^2 + y''^2 over five seconds, between two states of rest across the lane."""
    program, duration = Program(), 5.0
    spline = Spline(5, 3, 2)
    x = program.output(spline, lambda tau: 40 * tau)
    y = program.output(spline, lambda tau: 4 * tau - 2)
    tau, weights = points(rule, 2)

    def cost(u, p):
        return (u[0] ** 2 + u[1] ** 2) / duration**3, []

    program.add(cost, [x.at(tau, 2), y.at(tau, 2)], weights)
    for end, states in [(0, [(0, 8, 0), (-2, 0, 0)]), (1, [(40, 8, 0), (2, 0, 0)])]:
        for output, state in zip((x, y), states):
            for derivative, value in enumerate(state):
                program.fix(output.at(end, derivative) / duration**derivative, value)
    return program
