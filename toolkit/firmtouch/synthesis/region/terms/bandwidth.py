"""Bandwidth: the poles lie in a disc about the origin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.lmi_region import LmiRegion
from firmtouch.synthesis.region.terms.term import RegionTerm


@dataclass(frozen=True, kw_only=True)
class Bandwidth(RegionTerm):
    """Every pole has |s| <= w_max: [[w_max Pm, PmA], [A^T Pm, w_max Pm]] >= 0, [T4]."""

    name: str = "greatest |s|"
    asked: float = 0.0
    unit: str = "rad/s"
    at_most: bool = True

    def region(self) -> LmiRegion:
        """[[-w_max, s], [s*, -w_max]] < 0."""
        return LmiRegion(-self.asked * np.eye(2), np.array([[0.0, 1.0], [0.0, 0.0]]))

    def of_pole(self, s: complex) -> float:
        """Give its distance from the origin."""
        return abs(s)

    def reached(self, loop: ClosedLoop) -> float:
        """Give the greatest |s| of any pole."""
        return max(map(self.of_pole, loop.poles.pencil))
