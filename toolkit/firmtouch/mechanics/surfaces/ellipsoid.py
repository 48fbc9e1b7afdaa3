"""An ellipsoid."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.rigid_bodies import rotation
from firmtouch.mechanics.space import into_frame, length
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import Ellipsoid


def distance(ellipsoid: Ellipsoid, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give f / |grad f| of f = g - 1, g = |(y1/a, y2/b, y3/c)|: exact for a sphere, nearly linear far away."""
    y, axes = _inside(ellipsoid, x, symbols)
    g = length(y / axes)
    return (g - 1) * g / length(y / axes**2)  # grad g = (y_i / a_i^2) / g


def normal(ellipsoid: Ellipsoid, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the normal of the ellipsoid of the same shape through x."""
    y, axes = _inside(ellipsoid, x, symbols)
    across = y / axes**2
    return rotation(ellipsoid.orientation, symbols) @ (across / length(across))


def _inside(ellipsoid: Ellipsoid, x: ca.SX, symbols: Symbols) -> tuple[ca.SX, ca.SX]:
    R = rotation(ellipsoid.orientation, symbols)
    return into_frame(x, ellipsoid.centre, R, symbols), symbols.column(ellipsoid.semi_axes)
