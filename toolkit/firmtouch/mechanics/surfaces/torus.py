"""A torus."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.space import unit
from firmtouch.mechanics.surfaces.around_axis import along_and_away, outwards
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import Torus


def distance(torus: Torus, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the distance from the circle in the middle of the tube, less the tube's radius."""
    along, away = along_and_away(x, torus.centre, torus.axis, symbols)
    across = away - symbols.scalar(torus.ring_radius)
    return ca.sqrt(along**2 + across**2) - symbols.scalar(torus.tube_radius)


def normal(torus: Torus, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the direction from the nearest point of that circle."""
    _, away = outwards(x, torus.centre, torus.axis, symbols)
    return unit(x - symbols.column(torus.centre) - away * symbols.scalar(torus.ring_radius))
