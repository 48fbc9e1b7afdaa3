"""Directions and frames of surfaces, as SX."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.rigid_bodies import rotation
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import Expression
from firmtouch.modelfile.sections.mechanism import Rotations


def direction(expression: Expression, symbols: Symbols) -> ca.SX:
    """Read a direction, and give it length 1."""
    return unit(symbols.column(expression))


def unit(vector: ca.SX) -> ca.SX:
    """Give a vector length 1."""
    return vector / length(vector)


def length(vector: ca.SX) -> ca.SX:
    """Give |v|; at zero it has no derivative."""
    return ca.sqrt(ca.sumsqr(vector))


def rotation_of(orientation: Rotations, symbols: Symbols) -> ca.SX:
    """Give R (3 x 3), from the surface's frame to the world."""
    return rotation(orientation, symbols)


def into_frame(x: ca.SX, position: Expression | None, R: ca.SX, symbols: Symbols) -> ca.SX:
    """Give a point of the world in the surface's frame, R^T (x - position)."""
    return R.T @ (x if position is None else x - symbols.column(position))
