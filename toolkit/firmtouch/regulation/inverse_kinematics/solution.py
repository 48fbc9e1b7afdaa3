"""What is told of a configuration that meets the question, and which one of several is taken."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.mechanics.arrays import Array

NEAREST: Final = "nearest to the given configuration"
FARTHEST: Final = "farthest from joint limits and singularities"


@dataclass(frozen=True, slots=True)
class Solution:
    """A configuration q (n) within the limits, its largest |r| as `residual`, and how much it leaves to move.

    `manipulability` is Yoshikawa's index w of the task's rows J (t x n), the product of their singular values, which
    for six rows is sqrt(det(J J^T)). Its unit is m for each direction in which J moves the tool's point and rad for
    each in which it turns it, per the joints' units: m^3 for an arm of six or more revolute joints and all six rows.
    `least_singular_value` is that of J, which mixes m and rad: 0 at a singularity (T. Yoshikawa, "Manipulability of
    robotic mechanisms", Int. J. Robotics Research 4(2), 1985). Singular values that are zero everywhere, as for a
    planar arm, are left out of both.
    `margin` is the least distance to a joint limit as a part of that joint's range: 0 at a limit, 1/2 in the middle of
    all ranges, infinite where no joint is limited.
    `room` = w times 4 (q_i - lower_i) (upper_i - q_i) / (upper_i - lower_i)^2 of each limited joint.
    """

    q: Array
    residual: float
    manipulability: float
    least_singular_value: float
    margin: float
    room: float


@dataclass(frozen=True, slots=True)
class Reached:
    """All distinct `solutions` that were found, the one to take first, `because` says by what.

    `starts` searches were made, of which `met` ended within the limits at a solution. `rank` is that of dr/dq at the
    first solution. Where it is n, the solutions are isolated. Where it is less, they form continua of which the best
    places by the same measure stand here; an isolated solution that is singular (a stretched arm) looks like that too.
    """

    solutions: tuple[Solution, ...]
    because: str
    starts: int
    met: int
    rank: int

    @property
    def q(self) -> Array:
        """The configuration to take."""
        return self.solutions[0].q

    def in_words(self) -> str:
        """Say which of how many solutions is taken, and why."""
        count, taken = len(self.solutions), self.solutions[0]
        which = f"the one of {count} that is {self.because}" if count > 1 else "the only one found"
        return f"by inverse kinematics, {which}: manipulability {taken.manipulability:.3g}"

    @property
    def isolated(self) -> bool:
        """Whether no other solution is near the one to take."""
        return self.rank == len(self.q)


def order(solutions: list[Solution], near: Array | None) -> tuple[Solution, ...]:
    """Put the one to take first: the nearest to a given configuration, or the one of the largest room."""
    if near is not None:
        return tuple(sorted(solutions, key=lambda each: float(np.linalg.norm(each.q - near))))
    return tuple(sorted(solutions, key=lambda each: -each.room))
