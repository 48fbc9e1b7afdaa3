"""Where a point is in the half-plane through an axis: along it, and away from it."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.space import direction, length
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import Expression


def along_and_away(x: ca.SX, origin: Expression, axis: Expression, symbols: Symbols) -> tuple[ca.SX, ca.SX]:
    """Give a . d and |a x d|, with d = x - origin and a the unit axis; on the axis the second has no derivative."""
    a, d = direction(axis, symbols), x - symbols.column(origin)
    return ca.dot(a, d), length(ca.cross(a, d))


def outwards(x: ca.SX, origin: Expression, axis: Expression, symbols: Symbols) -> tuple[ca.SX, ca.SX]:
    """Give the unit axis a, and the unit vector across it towards x."""
    a, d = direction(axis, symbols), x - symbols.column(origin)
    away = d - a * ca.dot(a, d)
    return a, away / length(away)
