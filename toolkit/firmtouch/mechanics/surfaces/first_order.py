"""The distance of first order from a level set f = 0: s = f / |grad f|.

On the surface grad s is its normal, and along the surface the Hessian of s is that of the true distance, so the
contact force and the curvature are the true ones. Off the surface s errs by O(s^2).
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from firmtouch.mechanics.space import length, unit

Level = Callable[[ca.SX], ca.SX]
"""f, of a point (3) in the surface's frame."""


def distance(level: Level, y: ca.SX) -> ca.SX:
    """Give f / |grad f|."""
    at = ca.SX.sym("y", 3)
    f = level(at)
    return ca.substitute(f / length(ca.gradient(f, at)), at, y)


def normal(level: Level, y: ca.SX) -> ca.SX:
    """Give grad f / |grad f| in the surface's frame."""
    at = ca.SX.sym("y", 3)
    return ca.substitute(unit(ca.gradient(level(at), at)), at, y)
