"""Do finished gains keep the poles in a region on a whole polytope? One matrix inequality each, and no sampling."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy.optimize

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.synthesis.region.lmi_region import LmiRegion

LOGARITHMS: Final = (-6.0, 4.0)
"""Where ln(eps) is looked for, time counted in 1/omega."""


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


def best_energy_slack(tangents: Sequence[Tangent], regions: Sequence[LmiRegion], hint: float = 1.0) -> float:
    """Maximise the slack over eps: positive proves the whole polytope."""
    return best_energy_epsilon(tangents, regions, hint)[1]


def best_energy_epsilon(
    tangents: Sequence[Tangent], regions: Sequence[LmiRegion], hint: float = 1.0
) -> tuple[float, float]:
    """Maximise the slack over eps: it is concave in eps, as the inequalities are linear in it for fixed gains.

    `hint` is an eps that is tried first, and taken if it has slack: at the edge of what is feasible there is but one.
    """
    slack = energy_slack(tangents, regions, hint)
    if slack > 0:
        return hint, slack
    found = scipy.optimize.minimize_scalar(
        lambda logarithm: -energy_slack(tangents, regions, float(np.exp(logarithm))),
        bounds=LOGARITHMS,
        method="bounded",
        options={"xatol": 1e-3},
    )
    return float(np.exp(found.x)), -float(found.fun)
