"""Why a pose is not met, with how far it is away."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from firmtouch.errors import NoDesignError
from firmtouch.mechanics.arrays import Array
from firmtouch.regulation.inverse_kinematics.reach import Reach


@dataclass(frozen=True, slots=True)
class Miss:
    """The least residual that was reached, its largest entry `largest` (m or rad), and where.

    `position` (m) and `direction` (rad) are those of the rows that the question names; infinite where it names none.
    """

    q: Array
    residual: Array
    position: float
    direction: float

    @property
    def largest(self) -> float:
        """The largest |r|."""
        return float(np.max(np.abs(self.residual)))

    def __str__(self) -> str:
        """Write it for people."""
        parts = []
        if math.isfinite(self.position):
            parts.append(f"{1e3 * self.position:.3g} mm")
        if math.isfinite(self.direction):
            parts.append(f"{math.degrees(self.direction):.3g} deg")
        return " and ".join(parts) or f"{self.largest:.3g} (largest |r|, in m or rad)"


def miss(reach: Reach, q: Array, residual: Array) -> Miss:
    """Take position and direction out of a residual."""
    position = direction = math.inf
    if reach.lengths:
        position = float(np.linalg.norm(residual[list(reach.lengths)]))
    if reach.angles:
        half = float(np.linalg.norm(residual[list(reach.angles)])) / 2
        direction = 2 * math.asin(min(1.0, half))
    return Miss(q, residual, position, direction)


class OutOfReachError(NoDesignError):
    """No configuration meets the question, even with all joint limits set aside: `miss` is the nearest found."""

    def __init__(self, miss: Miss, starts: int) -> None:
        self.miss, self.starts = miss, starts
        at = ", ".join(f"{each:.4g}" for each in miss.q)
        super().__init__(
            f"out of reach: the nearest configuration found from {starts} starts, joint limits set aside, misses by "
            f"{miss}, at q = ({at})"
        )


class BeyondLimitsError(NoDesignError):
    """The question is met only beyond joint limits: at `q`, by `excess` of each joint there (below its limit: < 0).

    `miss` is the nearest that was found within the limits.
    """

    def __init__(self, reach: Reach, q: Array, excess: Mapping[str, float], miss: Miss) -> None:
        self.q, self.excess, self.miss = q, dict(excess), miss
        parts = []
        for name, beyond in excess.items():
            i = reach.names.index(name)
            side, limit = ("above its upper", reach.upper[i]) if beyond > 0 else ("below its lower", reach.lower[i])
            size = f"{abs(beyond):.4g} rad ({math.degrees(abs(beyond)):.3g} deg)"
            if not reach.revolves[i]:
                size = f"{abs(beyond):.4g}"
            parts.append(f"joint `{name}` would be at {q[i]:.4g}, {size} {side} limit {limit:.4g}")
        super().__init__(
            f"met only beyond joint limits: {'; '.join(parts)}; the nearest found within them misses by {miss}"
        )
