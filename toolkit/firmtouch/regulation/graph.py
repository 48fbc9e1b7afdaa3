"""The constraints' surface as a graph over the free directions: q = q_d + V1 x1 + V2 x2, with x1 a function of x2."""

from __future__ import annotations

from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.regulation.projection import Surface

MOST_STEPS: Final = 12
ON_SURFACE: Final = 1e-11
TURNED: Final = 1e9
"""The condition number of J V1 beyond which the surface has turned away from its tangent space at q_d."""


def surface_above(
    surface: Surface, q_d: Array, V1: Array, V2: Array, *, x1: Array, x2: Array
) -> tuple[Array, Array] | None:
    """Solve Phi = 0 for x1 by Newton's method from a point nearby; gives x1 and q, or None where it is no graph."""
    for _ in range(MOST_STEPS):
        q = q_d + V1 @ x1 + V2 @ x2
        Phi = surface.Phi(q)
        if np.max(np.abs(Phi)) < ON_SURFACE:
            return x1, q
        slope = surface.J(q) @ V1
        if not np.all(np.isfinite(slope)) or np.linalg.cond(slope) > TURNED:
            return None
        x1 = x1 - np.linalg.solve(slope, Phi)
    return None
