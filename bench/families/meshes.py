"""Meshes of a collocation, and what the cost on one may be off by."""

from dataclasses import dataclass

from spell import log_uniform


@dataclass(frozen=True)
class Mesh:
    """Intervals of all splines, and Gauss points in each."""

    intervals: int
    points: int

    @property
    def statement(self):
        return f"collocation gauss(points = {self.points}, intervals = {self.intervals});"

    def switches(self, count=1, factor=0.5):
        """What a cost may be off by, relative, where `count` switches fall inside intervals."""
        return 1e-6 + factor * count / self.intervals**2

    def ramps(self, count, share, factor=0.5):
        """The same of a least time, where speed rises and falls within a share of it: a switch loses way as an
        interval's square over the ramp's length, and at most half an interval."""
        return 1e-6 + count * min(factor * max(1, 0.5 / share) / self.intervals**2, 0.5 / self.intervals)


def mesh(rng, low=5, high=80, least=2):
    """Intervals evenly on a logarithmic scale, and `least` to 5 points in each: states of order up to 6."""
    return Mesh(round(log_uniform(rng, low, high)), rng.choice([points for points in (2, 3, 3, 4, 5) if points >= least]))
