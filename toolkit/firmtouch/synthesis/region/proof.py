"""For which eps do finished gains prove by [T4] that the poles of a whole polytope lie in a region? No sampling."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import scipy.optimize

from firmtouch.regulation.lmi_region import LmiRegion
from firmtouch.regulation.tangent import Tangent, energy_slack

LOGARITHMS: Final = (-6.0, 4.0)
"""Where ln(eps) is looked for, time counted in 1/omega."""


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
