"""Damping ratio: the poles lie in a sector."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.lmi_region import LmiRegion
from firmtouch.synthesis.region.terms.term import RegionTerm


@dataclass(frozen=True, kw_only=True)
class Damping(RegionTerm):
    """Every pole has -Re s / |s| >= zeta = cos(th), [T4]."""

    name: str = "damping ratio"
    asked: float = 0.0
    unit: str = ""
    at_most: bool = False

    def region(self) -> LmiRegion:
        """[[sin th (s + s*), cos th (s - s*)], [cos th (s* - s), sin th (s + s*)]] < 0."""
        cosine = self.asked
        sine = float(np.sqrt(1 - cosine**2))
        return LmiRegion(np.zeros((2, 2)), np.array([[sine, cosine], [-cosine, sine]]))

    def of_pole(self, s: complex) -> float:
        """Give its damping ratio."""
        return -s.real / abs(s)

    def reached(self, loop: ClosedLoop) -> float:
        """Give the least damping ratio of any pole."""
        return min(map(self.of_pole, loop.poles.pencil))
