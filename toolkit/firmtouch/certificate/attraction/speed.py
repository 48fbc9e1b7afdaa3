"""How fast an arm may start: kinetic energies below a level, in words of velocities."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from flint import arb

from firmtouch.certificate.attraction.landscape import Landscape
from firmtouch.certificate.attraction.rounding import lower
from firmtouch.certificate.matrices import BallMatrix, identity, is_positive_definite, middle
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.mechanics.balls import Ball

GROWTH: Final = 1.001
"""A bound on the largest eigenvalue is tried this much above its floating-point value, then larger until proven."""
MOST_TRIALS: Final = 60


@dataclass(frozen=True, slots=True)
class Speeds:
    """Velocities at q* with J q' = 0 whose kinetic energy is below a level.

    All with ||q'|| < norm, and all with |q_i'| < all_joints units_i for every i. Some reach |q_i'| = fastest_i.
    """

    norm: float
    all_joints: float
    fastest: Array


def speeds(landscape: Landscape, q: list[Ball], level: float, units: Sequence[float]) -> Speeds:
    """Bound the speeds at q* (balls) from below, from M and J there."""
    J, M = landscape.point_jacobian(q), landscape.M(q)
    T = landscape.V2 - landscape.V1 * ((J * landscape.V1).inv() * (J * landscape.V2))
    M22, twice = T.transpose() * M * T, 2 * arb(level)
    inverse = (T * M22.inv() * T.transpose()).tolist()
    largest = largest_eigenvalue(M22, T.transpose() * T)
    fastest = [max(0.0, lower(arb.max(arb(0), twice * inverse[i][i]).sqrt())) for i in range(len(units))]
    return Speeds(lower((twice / largest).sqrt()), _all_joints(M, largest, level, units), frozen(fastest))


def speed_within(landscape: Landscape, q: list[Ball], level: float, units: Sequence[float]) -> float:
    """Bound from below how fast all joints may be, in their units, for q'^T M q' / 2 < level at all q of a box."""
    M = landscape.M(q)
    return _all_joints(M, largest_eigenvalue(M, identity(M.nrows())), level, units)


def _all_joints(M: BallMatrix, largest: float, level: float, units: Sequence[float]) -> float:
    """Use q'^T M q' <= sum |M_ij| |q_i'| |q_j'|, or <= largest ||q'||^2, whichever allows more."""
    u = [arb(each) for each in units]
    total = arb(0)
    for row, a in zip(M.tolist(), u, strict=True):
        for entry, b in zip(row, u, strict=True):
            total += abs(entry).upper() * a * b
    square = arb(largest) * sum((a * a for a in u), arb(0))
    if not (total.is_finite() or square.is_finite()):
        return 0.0
    return max(lower((2 * arb(level) / each).sqrt()) for each in (total, square) if each.is_finite())


def largest_eigenvalue(A: BallMatrix, B: BallMatrix) -> float:
    """Prove x^T A x < bound x^T B x for all x, and give the bound; infinite if none is proven."""
    try:
        bound = float(np.max(np.linalg.eigvals(np.linalg.solve(middle(B), middle(A))).real)) * GROWTH
    except np.linalg.LinAlgError:
        return np.inf
    for _ in range(MOST_TRIALS):
        if not np.isfinite(bound):
            break
        if is_positive_definite(B * arb(bound) - A) is True:
            return bound
        bound *= 1.1
    return np.inf
