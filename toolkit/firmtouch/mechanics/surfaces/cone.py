"""A round cone."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.surfaces.around_axis import along_and_away, outwards
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import Cone


def distance(cone: Cone, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give away cos(alpha) - along sin(alpha): exact where the nearest point is on the mantle, not the apex."""
    along, away = along_and_away(x, cone.apex, cone.axis, symbols)
    alpha = symbols.scalar(cone.half_angle)
    return away * ca.cos(alpha) - along * ca.sin(alpha)


def normal(cone: Cone, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the mantle's normal in the half-plane of x."""
    axis, away = outwards(x, cone.apex, cone.axis, symbols)
    alpha = symbols.scalar(cone.half_angle)
    return away * ca.cos(alpha) - axis * ca.sin(alpha)
