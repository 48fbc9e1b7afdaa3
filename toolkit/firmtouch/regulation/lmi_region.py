"""Regions of the complex plane that are linear matrix inequalities (Chilali and Gahinet 1996)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.mechanics import Array


@dataclass(frozen=True, slots=True)
class LmiRegion:
    """The points s with L + s R + conj(s) R^T < 0; L is symmetric, both are k x k, in 1/s and 1.

    All eigenvalues of A lie in it if and only if L (x) P + R (x) PA + R^T (x) (PA)^T < 0 for some P > 0.
    """

    L: Array
    R: Array

    def excess(self, s: complex) -> float:
        """Give the largest eigenvalue of L + s R + conj(s) R^T: negative inside."""
        return float(np.linalg.eigvalsh(self.L + s * self.R + np.conj(s) * self.R.T)[-1])

    def in_time_unit(self, omega: float) -> LmiRegion:
        """Give the region of s / omega."""
        return LmiRegion(self.L / omega, self.R)
