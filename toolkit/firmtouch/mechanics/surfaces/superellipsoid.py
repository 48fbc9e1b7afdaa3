"""A superellipsoid, ((|x/a|^e2 + |y/b|^e2)^(e1/e2) + |z/c|^e1)^(1/e1) = 1.

At the seams x = 0, y = 0, z = 0 a power |t|^e with e >= 2 has two derivatives, but what differentiating makes of it
may be 0 * inf. So even exponents are polynomials, odd ones have their sign switched, as splines have their knots, and
all others are constant within TINY of the seam, where they and their first two derivatives vanish: these are no numbers
in ball arithmetic where a ball meets the seam. The same holds at the poles x = y = 0 for the outer power, unless e1/e2
is whole; if e1 = 2 < e2, it has no second derivative there, and so no number.
"""

from __future__ import annotations

from typing import Final

import casadi as ca

from firmtouch.mechanics.rigid_bodies import rotation
from firmtouch.mechanics.space import into_frame
from firmtouch.mechanics.surfaces import first_order
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile.sections.surface import Superellipsoid

TINY: Final = 1e-100
"""Of a power's base, relative to the semi-axes: its powers from -3 on are finite doubles."""


def distance(superellipsoid: Superellipsoid, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give f / |grad f| of f = g - 1, where g is the gauge above, homogeneous of degree one."""
    R = rotation(superellipsoid.orientation, symbols)
    return first_order.distance(_level(superellipsoid, symbols), into_frame(x, superellipsoid.centre, R, symbols))


def normal(superellipsoid: Superellipsoid, x: ca.SX, symbols: Symbols) -> ca.SX:
    """Give the normal of the superellipsoid of the same shape through x."""
    R = rotation(superellipsoid.orientation, symbols)
    return R @ first_order.normal(_level(superellipsoid, symbols), into_frame(x, superellipsoid.centre, R, symbols))


def _level(superellipsoid: Superellipsoid, symbols: Symbols) -> first_order.Level:
    axes, (e1, e2) = symbols.column(superellipsoid.semi_axes), superellipsoid.exponents

    def level(y: ca.SX) -> ca.SX:
        u, v, w = ca.vertsplit(y / axes)
        across, along = size_to_the(u, e2) + size_to_the(v, e2), size_to_the(w, e1)
        return (_outer(across, e1, e2) + along) ** (1 / e1) - 1

    return level


def size_to_the(t: ca.SX, e: float) -> ca.SX:
    """Give |t|^e, whose first two derivatives are numbers at t = 0 too."""
    switched = 2 * (t > 0) - 1
    if e.is_integer():
        power = _whole_power(t, int(e))
        return power * switched if e % 2 else power
    apart = 1 - (t > -TINY) * (t < TINY)
    return (apart * switched * t + (1 - apart) * TINY) ** e


def _outer(across: ca.SX, e1: float, e2: float) -> ca.SX:
    ratio = e1 / e2
    if ratio.is_integer():
        return _whole_power(across, int(ratio))
    if e1 == 2:
        return across**ratio
    apart = across > TINY
    return (apart * across + (1 - apart) * TINY) ** ratio


def _whole_power(base: ca.SX, exponent: int) -> ca.SX:
    """Multiply it out: CasADi's power of a symbol by a whole number is a logarithm's beyond its first few."""
    if exponent == 1:
        return base
    half = _whole_power(base, exponent // 2) ** 2
    return half * base if exponent % 2 else half
