"""A plane."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.space import direction
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import Plane


def distance(plane: Plane, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give n . (x - point)."""
    return ca.dot(direction(plane.normal, symbols), x - symbols.column(plane.point))


def normal(plane: Plane, x: ca.SX, symbols: Symbols) -> ca.SX:  # noqa: ARG001  # as of any surface
    """Give n."""
    return direction(plane.normal, symbols)
