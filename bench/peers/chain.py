"""A program as a chain of stages, the form that FATROP solves.

A stage is a knot interval, and its numbers are the coefficients that count there. A B-spline of order k and
smoothness m has k of them in every interval and shares m with the next one. The shared ones are the state: they are
the derivatives 0 to m - 1 at the knot, in another basis. The k - m new ones are the control. The dynamics say that
copies are equal. A global variable is a state with the same dynamics in the stages from its first use to its last.

Outputs that meet within the interval, as those of a vehicle do, share their stages. Phases, and vehicles that have
nothing but times in common, follow one another: so a stage has few variables, and FATROP's cost grows with the cube
of their number. Between two of them is a stage that knows the end of one and the beginning of the next.

Nothing is approximated and no row is added but the dynamics: at `spread(v)` the chain has the objective and the rows
that the program has at `v`. Bounds of a variable hold for its first copy alone.
"""

from dataclasses import dataclass

import numpy as np

from .program import Group, Program, widened


class NoChain(RuntimeError):
    """Why a program cannot be written as a chain."""


@dataclass
class Lives:
    """The first and the last stage of every variable; `first` is below 0 for states of the first stage."""

    first: np.ndarray
    last: np.ndarray
    stages: int


def columns(group, variables):
    """The variables that each point of a group touches."""
    slots = sum(abs(widened(slot, variables).tocsr()) for slot in group.slots).tocsr()
    slots.eliminate_zeros()
    return [slots.indices[begin:end] for begin, end in zip(slots.indptr, slots.indptr[1:])]


def phases(program, touched):
    """Lists of outputs: those of one list share their stages, in the order of the program."""
    count = len(program.outputs)
    owner = np.full(program.variables, -1)
    for number, output in enumerate(program.outputs):
        owner[output.first : output.last] = number
    phase = list(range(count))
    for point in touched:
        point = point[owner[point] >= 0]
        met = np.unique(owner[point])
        if len(met) > 1 and not is_joint(program, met, point):
            merged = {phase[number] for number in met}
            phase = [min(merged) if old in merged else old for old in phase]
    return [[program.outputs[i] for i in range(count) if phase[i] == number] for number in sorted(set(phase))]


def is_joint(program, met, point):
    """Whether a point is at the end of some outputs and at the beginning of the others."""
    ends = set()
    for output in (program.outputs[number] for number in met):
        own = point[(point >= output.first) & (point < output.last)]
        smooth = output.spline.smoothness
        if own.max() < output.first + smooth:
            ends.add("begins")
        elif own.min() >= output.last - smooth:
            ends.add("ends")
        else:
            return False
    return len(ends) == 2


def lives_of_coefficients(program, ordered):
    """Where the coefficients are; global variables live nowhere yet."""
    lives = Lives(np.full(program.variables, program.variables), np.full(program.variables, -2), 0)
    for outputs in ordered:
        intervals = {output.spline.intervals for output in outputs}
        if len(intervals) > 1:
            raise NoChain("outputs that meet have different knots")
        end = lives.stages + intervals.pop()
        for output in outputs:
            spline, c = output.spline, np.arange(output.spline.size)
            new = spline.order - spline.smoothness
            # Interval j has the coefficients from j * new to j * new + order - 1, the stage after the last one their end.
            first = lives.stages + np.where(c < spline.smoothness, -1, (c - spline.smoothness) // new)
            last = np.where(c >= spline.size - spline.smoothness, end, lives.stages + c // new)
            lives.first[output.first : output.last], lives.last[output.first : output.last] = first, last
        lives.stages = end + 1
    return lives


def stages_of_points(lives, touched):
    """The stage of each point; extends the lives of the global variables to where they are used."""
    is_global = lives.last < -1
    stages = np.full(len(touched), -1)
    for number, point in enumerate(touched):
        coefficients, others = point[~is_global[point]], point[is_global[point]]
        if len(coefficients):
            stage = lives.last[coefficients].min()
            if lives.first[coefficients].max() > stage:
                raise NoChain("a row couples coefficients of intervals that are not neighbours")
            stages[number] = stage
            live(lives, others, stage)
    for number in np.flatnonzero(stages < 0):
        used = touched[number][lives.last[touched[number]] >= 0]
        stages[number] = lives.first[used].max() if len(used) else 0
        live(lives, touched[number], stages[number])
    # What the first stage knows of a global variable is a state there, like the coefficients of the first knot.
    lives.first[is_global & (lives.first == 0)] = -1
    return stages


def live(lives, variables, stage):
    lives.first[variables] = np.minimum(lives.first[variables], stage)
    lives.last[variables] = np.maximum(lives.last[variables], stage)


class Chain:
    """A program's chain: `program` has one variable for every copy, ordered by stages, states first; `order` are the
    rows, stage by stage, among the dynamics and the program's own rows after them."""

    def __init__(self, program):
        touched = [columns(group, program.variables) for group in program.groups]
        flat = [point for points in touched for point in points]
        lives = lives_of_coefficients(program, phases(program, flat))
        at = stages_of_points(lives, flat)
        self._lay_out(lives)
        starts = np.cumsum([0] + [len(points) for points in touched])
        points = [at[begin:end] for begin, end in zip(starts, starts[1:])]
        self.program = self._copy(program, points)
        self._order([np.repeat(stages, len(group.lower)) for group, stages in zip(program.groups, points)])

    def _lay_out(self, lives):
        """Which variable each copy is of, where the copies are, and the dynamics as pairs of places."""
        self.nx, self.nu, self.source = [], [], []
        self.place = np.full((lives.stages, len(lives.first)), -1)
        for stage in range(lives.stages):
            here = (lives.first <= stage) & (lives.last >= stage)
            states = np.flatnonzero(here & (lives.first < stage))
            controls = np.flatnonzero(here & (lives.first == stage))
            both = np.concatenate([states, controls])
            self.place[stage, both] = len(self.source) + np.arange(len(both))
            self.source.extend(both)
            self.nx.append(len(states))
            self.nu.append(len(controls))
        self.source = np.array(self.source)
        found, self.births = np.unique(self.source, return_index=True)
        if len(found) < len(lives.first):
            raise NoChain("a variable is in no row and no cost")
        # In the order of the next stage's states: FATROP wants a unit matrix there.
        pairs = [self.place[stage : stage + 2] for stage in range(lives.stages - 1)]
        self.dynamics = np.hstack([pair[:, (pair >= 0).all(axis=0)] for pair in pairs])

    def _copy(self, program, points):
        copy = Program(steps=program.steps, start=list(self.spread(program.start)))
        copy.lower, copy.upper = np.full(len(self.source), -np.inf), np.full(len(self.source), np.inf)
        copy.lower[self.births], copy.upper[self.births] = program.lower, program.upper
        for group, stages in zip(program.groups, points):
            slots = [self._slot(slot, stages) for slot in group.slots]
            copy.groups.append(Group(group.formula, slots, group.weights, group.lower, group.upper))
        return copy

    def _slot(self, slot, stages):
        if isinstance(slot, np.ndarray):
            return slot
        slot = slot.tocsr()
        slot.eliminate_zeros()
        slot = slot.tocoo()
        moved = widened(slot, len(self.source))
        moved.col = self.place[stages[slot.row], slot.col]
        return moved

    def _order(self, rows):
        rows = np.concatenate(rows)
        dynamics = np.repeat(np.arange(len(self.nx) - 1), self.nx[1:])
        # A stable sort keeps the dynamics of a stage before its rows.
        self.order = np.argsort(np.concatenate([dynamics, rows]), kind="stable")
        self.ng = [int(count) for count in np.bincount(rows, minlength=len(self.nx))]

    def spread(self, v):
        """The chain's point at a point of the program."""
        return np.asarray(v)[self.source]

    def gather(self, z):
        """The program's point: the first copy of each variable."""
        return np.asarray(z)[self.births]

    def split(self, numbers):
        """What the chain has one of a row, as that of the dynamics and that of the program's own rows."""
        unsorted = np.empty(len(numbers))
        unsorted[self.order] = numbers
        return np.split(unsorted, [self.dynamics.shape[1]])
