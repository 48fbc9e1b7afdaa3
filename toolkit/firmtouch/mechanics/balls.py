"""Ball arithmetic for tapes: every ball holds the exact value, all rounding enclosed (python-flint's `arb`).

The precision is that of the moment (`flint.ctx.workprec`). What has no certain value, such as 1/[-1, 1], a kink or a
jump, is no number: `is_finite()` is false for it and for all that is made of it.
"""

from __future__ import annotations

from typing import Any, Final

import casadi as ca
from flint import arb

from firmtouch.mechanics.tape import OPERATORS, Arithmetic

Ball = Any
"""A python-flint `arb`."""

NO_NUMBER: Final = arb.nan()
UNDECIDED: Final = arb(0.5, 0.5)
"""[0, 1]: a comparison, 0 or 1, whose answer differs within a ball."""


def _square(x: Ball) -> Ball:
    size = abs(x)
    return size * size


def _whole_power(base: Ball, exponent: int) -> Ball:
    """Multiply it out, by halves: `arb ** 2` is no number for a ball around zero itself."""
    if exponent < 0:
        return 1 / _whole_power(base, -exponent)
    if exponent == 0:
        return arb(1)
    half = _square(_whole_power(base, exponent // 2))
    return half * base if exponent % 2 else half


def _power(base: Ball, exponent: Ball) -> Ball:
    if exponent.is_exact() and exponent.is_integer():
        return _whole_power(base, int(float(exponent)))
    return base**exponent


def _atan2(y: Ball, x: Ball) -> Ball:
    """Angle of (x, y); no number where it may jump."""
    return NO_NUMBER if y.contains(0) and not x > 0 else arb.atan2(y, x)


def _sign(x: Ball) -> Ball:
    """Sign of x; no number where it may change."""
    return arb(1) if x > 0 else arb(-1) if x < 0 else NO_NUMBER


def is_less(x: Ball, y: Ball) -> Ball:
    """Give x < y as 0 or 1, or [0, 1] where it is undecided.

    No expression of a file can compare, nor does CasADi by itself. Only surfaces do (`surfaces/spline.py`,
    `superellipsoid.py`), and there each comparison is a factor of t^k, k >= 3, which it switches at t = 0: what is
    switched is C^2, and its derivatives k t^(k-1), k (k-1) t^(k-2), ... have the same factor. So [0, 1] encloses the
    value and the first two derivatives, the more tightly the smaller t is, and of the third, which is bounded, both
    values between which it jumps: that is enough for mean values, as what it is the slope of is Lipschitz.
    """
    return arb(1) if x < y else arb(0) if x >= y else UNDECIDED


BALLS: Final = Arithmetic(
    arb,
    {
        **OPERATORS,
        ca.OP_SQ: _square,
        ca.OP_POW: _power,
        ca.OP_CONSTPOW: _power,
        ca.OP_SQRT: arb.sqrt,
        ca.OP_EXP: arb.exp,
        ca.OP_LOG: arb.log,
        ca.OP_SIN: arb.sin,
        ca.OP_COS: arb.cos,
        ca.OP_TAN: arb.tan,
        ca.OP_ASIN: arb.asin,
        ca.OP_ACOS: arb.acos,
        ca.OP_ATAN: arb.atan,
        ca.OP_ATAN2: _atan2,
        ca.OP_SINH: arb.sinh,
        ca.OP_COSH: arb.cosh,
        ca.OP_TANH: arb.tanh,
        ca.OP_FABS: lambda x: _sign(x) * x,
        ca.OP_SIGN: _sign,
        ca.OP_LT: is_less,
    },
)
"""Scalar operations on balls."""
