"""The closed loop (38) on the free directions, and the matrix inequalities of [T4] about it, in floats."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation.lmi_region import LmiRegion


@dataclass(frozen=True, slots=True)
class Tangent:
    """M22, C22, K22 of one closed loop, in mass-normalised coordinates, time counted in 1/omega."""

    M: Array
    C: Array
    K: Array

    def companion(self) -> Array:
        """Give A of x' = A x for x = (z, z')."""
        t = len(self.M)
        return frozen(
            np.block([[np.zeros((t, t)), np.eye(t)], [-np.linalg.solve(self.M, np.hstack([self.K, self.C]))]])
        )


def energy_slack(tangents: Sequence[Tangent], regions: Sequence[LmiRegion], eps: float) -> float:
    """Give the least eigenvalue of all inequalities of [T4] for a given eps: positive proves the whole polytope."""
    worst = np.inf
    for each in tangents:
        M, C, K = each.M, each.C, each.K
        P = np.block([[K, eps * M], [eps * M, M]])
        PA = np.block([[-eps * K, K - eps * C], [-K, eps * M - C]])
        matrices = [P, *(-(np.kron(r.L, P) + np.kron(r.R, PA) + np.kron(r.R.T, PA.T)) for r in regions)]
        worst = min(worst, *(float(np.linalg.eigvalsh(X)[0]) for X in matrices))
    return worst
