"""A sphere."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.space import length, unit
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import Sphere


def distance(sphere: Sphere, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give |x - centre| - radius; it has no derivative at the centre."""
    return length(x - symbols.column(sphere.centre)) - symbols.scalar(sphere.radius)


def normal(sphere: Sphere, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the direction from the centre."""
    return unit(x - symbols.column(sphere.centre))
