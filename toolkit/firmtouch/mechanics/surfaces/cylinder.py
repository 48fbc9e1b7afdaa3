"""A round cylinder."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.surfaces.around_axis import along_and_away, outwards
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import Cylinder


def distance(cylinder: Cylinder, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the distance from the axis, less the radius."""
    _, away = along_and_away(x, cylinder.point, cylinder.axis, symbols)
    return away - symbols.scalar(cylinder.radius)


def normal(cylinder: Cylinder, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the direction away from the axis."""
    return outwards(x, cylinder.point, cylinder.axis, symbols)[1]
