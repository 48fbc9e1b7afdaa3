"""Directions and frames in space that a file describes, as SX."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import Expression


def direction(expression: Expression, symbols: Symbols) -> ca.SX:
    """Read a direction, and give it length 1."""
    return unit(symbols.column(expression))


def unit(vector: ca.SX) -> ca.SX:
    """Give a vector length 1."""
    return vector / length(vector)


def length(vector: ca.SX) -> ca.SX:
    """Give |v|; at zero it has no derivative."""
    return ca.sqrt(ca.sumsqr(vector))


def into_frame(x: ca.SX, position: Expression | None, R: ca.SX, symbols: Symbols) -> ca.SX:
    """Give a point of the world in a frame, R^T (x - position); R (3 x 3) is from the frame to the world."""
    return R.T @ (x if position is None else x - symbols.column(position))
