"""A surface f(x, y, z) = 0."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.rigid_bodies import rotation
from firmtouch.mechanics.space import into_frame
from firmtouch.mechanics.surfaces import first_order
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import Implicit


def distance(implicit: Implicit, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give f / |grad f|."""
    R = rotation(implicit.orientation, symbols)
    return first_order.distance(_level(implicit, symbols), into_frame(x, implicit.position, R, symbols))


def normal(implicit: Implicit, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the normal of the level set of f through x."""
    R = rotation(implicit.orientation, symbols)
    return R @ first_order.normal(_level(implicit, symbols), into_frame(x, implicit.position, R, symbols))


def _level(implicit: Implicit, symbols: Symbols) -> first_order.Level:
    def level(y: ca.SX) -> ca.SX:
        return ca.SX(symbols.read(implicit.expression, dict(zip("xyz", ca.vertsplit(y), strict=True))))

    return level
