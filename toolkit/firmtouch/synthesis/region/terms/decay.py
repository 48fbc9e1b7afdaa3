"""Decay rate: Re s <= -alpha."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.lmi_region import LmiRegion
from firmtouch.synthesis.region.terms.term import RegionTerm


@dataclass(frozen=True, kw_only=True)
class Decay(RegionTerm):
    """Every pole has Re s <= -alpha: -(PmA + A^T Pm) - 2 alpha Pm >= 0, [T4]."""

    name: str = "decay rate"
    asked: float = 0.0
    unit: str = "1/s"
    at_most: bool = False

    def region(self) -> LmiRegion:
        """2 alpha + s + conj(s) < 0."""
        return LmiRegion(np.array([[2 * self.asked]]), np.array([[1.0]]))

    def of_pole(self, s: complex) -> float:
        """Give its decay rate."""
        return -s.real

    def reached(self, loop: ClosedLoop) -> float:
        """Give the decay rate of the slowest pole."""
        return min(map(self.of_pole, loop.poles.pencil))
