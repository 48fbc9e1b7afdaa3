"""From a configuration onto the constraints Phi(q) = 0, by Newton's method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np

from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation.inverse_kinematics import Reached

MOST_STEPS: Final = 60
LARGEST_STEP: Final = 0.5
ON_SURFACE: Final = 1e-12
"""Phi(q_d), in metres or radians: what Newton's method reaches in double precision for mechanisms of metre size."""
NEAR_SURFACE: Final = 1e-3
"""How far (m or rad) what a file states may miss the constraints and still be taken as rounded."""
RANK: Final = 1e-9
"""Singular values of J below this part of the largest count as zero."""


class Surface(Protocol):
    """Constraints as functions of q: a plant's own, or what they truly are."""

    def Phi(self, q: Array, /) -> Array:
        """Give the constraint functions, m."""

    def J(self, q: Array, /) -> Array:
        """Give their gradients, m x n."""


@dataclass(frozen=True, slots=True)
class Projection:
    """Where Newton's method went, and what |Phi| it left."""

    q: Array
    residual: float
    moved: float
    reached: Reached | None = None


class OffSurfaceError(NoDesignError):
    """The constraints cannot be met near the given configuration."""

    def __init__(self, message: str, projection: Projection) -> None:
        self.projection = projection
        super().__init__(message)


def project(surface: Surface, start: Array) -> Projection:
    """Project a configuration onto Phi(q) = 0 by Newton's method with the step of least norm.

    Raises
    ------
    OffSurfaceError
        If it does not converge; its `projection` says how far it came.
    """
    q = np.array(start)
    best, best_residual = q, np.inf
    for _ in range(MOST_STEPS):
        Phi = surface.Phi(q)
        residual = float(np.max(np.abs(Phi)))
        if not np.isfinite(residual):
            break
        if residual < best_residual:
            best, best_residual = q, residual
        elif best_residual <= ON_SURFACE:
            break
        J = surface.J(q)
        if not np.all(np.isfinite(J)):
            break
        step = np.linalg.lstsq(J, -Phi, rcond=RANK)[0]
        length = float(np.linalg.norm(step))
        q = q + step * min(1.0, LARGEST_STEP / length if length else 1.0)
    projection = Projection(frozen(best), best_residual, float(np.linalg.norm(best - start)))
    if not best_residual <= ON_SURFACE * max(1.0, float(np.max(np.abs(best)))):
        raise OffSurfaceError(
            f"no configuration near the given one satisfies the constraints: Newton's method came to {short(best)}, "
            f"where the largest |phi| is {best_residual:.3g}",
            projection,
        )
    return projection


def short(values: Array) -> str:
    """Write a vector for a message."""
    return "(" + ", ".join(f"{each:.4g}" for each in values) + ")"
