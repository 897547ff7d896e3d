"""A case of a family."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Case:
    """A spec, and what it must be answered with."""

    name: str
    text: str
    # The optimum in the unit in which the spec shows its objective.
    optimum: float
    # What the discretisation may be off by, relative to the larger of |optimum| and scale.
    tolerance: float
    scale: float = 0.0
    # The formula or the book that the optimum comes from.
    why: str = ""
    # There is no solution: the right end is to say so.
    infeasible: bool = False
