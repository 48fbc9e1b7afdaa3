"""Numbers that remember to second order what they depend on: c + a e + e^T Q e + r, |e_i| <= 1, r a ball around zero.

Plain balls forget that two of them move together: the tip of an arm that slides along a circle seems to move by the
sum of what its joints do. Here the first two orders are kept (their own rounding is enclosed, too), and only what is of
third order in the size of a cell is a ball: Taylor forms, in `arb`. With l = a e, s = e^T Q e + r and d = l + s,

    x y  = ... + outer product of the two a + l_x s_y + s_x l_y + s_x s_y
    f(x) = f(c) + f'(c) d + f''(c) (l^2 + 2 l s + s^2) / 2 + f'''(c + d) d^3 / 6
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import casadi as ca
from flint import arb, arb_mat

from firmtouch.certificate.matrices import BallMatrix
from firmtouch.mechanics.balls import NO_NUMBER, Ball, is_less
from firmtouch.mechanics.tape import Arithmetic

LARGEST_EXPONENT: Final = 64
MOST_SYMBOLS: Final = 64
_UNITS: Final = [(arb_mat(1, n, [arb(0, 1)] * n), arb_mat(n, 1, [arb(0, 1)] * n)) for n in range(MOST_SYMBOLS)]
"""All e, as a row and as a column."""


@dataclass(frozen=True, slots=True)
class Expansion:
    """c + a e + e^T Q e + r; a is a row and Q square, both None for a number that depends on nothing.

    `first` holds a e and `rest` holds e^T Q e + r, for all e.
    """

    c: Ball
    a: BallMatrix | None
    Q: BallMatrix | None
    r: Ball
    first: Ball
    rest: Ball

    @property
    def ball(self) -> Ball:
        """Give all its values."""
        return self.c if self.a is None else self.c + self.first + self.rest


def constant(value: float | Ball) -> Expansion:
    """Give a number that depends on nothing."""
    zero = arb(0)
    return Expansion(arb(value), None, None, zero, zero, zero)


def _with(c: Ball, a: BallMatrix, Q: BallMatrix, r: Ball) -> Expansion:
    row, column = _UNITS[a.ncols()]
    return Expansion(c, a, Q, r, (a * column)[0, 0], (row * (Q * column))[0, 0] + r)


def inputs(c: Sequence[Ball], a: BallMatrix, Q: Sequence[BallMatrix]) -> list[Expansion]:
    """Give c + a e + e^T Q e, one number for each row of a."""
    return [_with(x, arb_mat([row]), bend, arb(0)) for x, row, bend in zip(c, a.tolist(), Q, strict=True)]


def _add(x: Expansion, y: Expansion) -> Expansion:
    if x.a is None or x.Q is None:
        return Expansion(x.c + y.c, y.a, y.Q, y.r, y.first, y.rest)
    if y.a is None or y.Q is None:
        return Expansion(x.c + y.c, x.a, x.Q, x.r, x.first, x.rest)
    return _with(x.c + y.c, x.a + y.a, x.Q + y.Q, x.r + y.r)


def _negative(x: Expansion) -> Expansion:
    if x.a is None or x.Q is None:
        return constant(-x.c)
    return Expansion(-x.c, -x.a, -x.Q, -x.r, -x.first, -x.rest)


def _subtract(x: Expansion, y: Expansion) -> Expansion:
    return _add(x, _negative(y))


def _multiply(x: Expansion, y: Expansion) -> Expansion:
    if x.a is None or x.Q is None:
        if y.a is None or y.Q is None:
            return constant(x.c * y.c)
        return Expansion(x.c * y.c, y.a * x.c, y.Q * x.c, y.r * x.c, y.first * x.c, y.rest * x.c)
    if y.a is None or y.Q is None:
        return _multiply(y, x)
    Q = x.Q * y.c + y.Q * x.c + x.a.transpose() * y.a
    r = x.r * y.c + y.r * x.c + x.first * y.rest + x.rest * (y.first + y.rest)
    return _with(x.c * y.c, x.a * y.c + y.a * x.c, Q, r)


def _square(x: Expansion) -> Expansion:
    return _multiply(x, x)


_Function = Callable[[Ball], Ball]


def _smooth(f: _Function, first: _Function, second: _Function, third: _Function) -> Callable[[Expansion], Expansion]:
    """Expand a function by its first three derivatives."""

    def expand(x: Expansion) -> Expansion:
        if x.a is None or x.Q is None:
            return constant(f(x.c))
        slope, half, d = first(x.c), second(x.c) / 2, x.first + x.rest
        r = x.r * slope + half * (2 * x.first + x.rest) * x.rest + third(x.c + d) * d * d * d / 6
        return _with(f(x.c), x.a * slope, x.Q * slope + x.a.transpose() * x.a * half, r)

    return expand


def _atan_third(x: Ball) -> Ball:
    square = 1 + x * x
    return (6 * x * x - 2) / (square * square * square)


_invert = _smooth(
    lambda x: 1 / x, lambda x: -1 / (x * x), lambda x: 2 / (x * x * x), lambda x: -6 / (x * x * x * x)
)  # fmt: skip
_exp = _smooth(arb.exp, arb.exp, arb.exp, arb.exp)
_log = _smooth(arb.log, lambda x: 1 / x, lambda x: -1 / (x * x), lambda x: 2 / (x * x * x))
_atan = _smooth(
    arb.atan, lambda x: 1 / (1 + x * x), lambda x: -2 * x / ((1 + x * x) * (1 + x * x)), _atan_third
)  # fmt: skip
_sin = _smooth(arb.sin, arb.cos, lambda x: -x.sin(), lambda x: -x.cos())
_cos = _smooth(arb.cos, lambda x: -x.sin(), lambda x: -x.cos(), arb.sin)
_sinh = _smooth(arb.sinh, arb.cosh, arb.sinh, arb.cosh)
_cosh = _smooth(arb.cosh, arb.sinh, arb.cosh, arb.sinh)
_sqrt = _smooth(
    arb.sqrt,
    lambda x: 1 / (2 * x.sqrt()),
    lambda x: -1 / (4 * x * x.sqrt()),
    lambda x: 3 / (8 * x * x * x.sqrt()),
)


def _divide(x: Expansion, y: Expansion) -> Expansion:
    return _multiply(x, _invert(y))


def _power(base: Expansion, exponent: Expansion) -> Expansion:
    """Give whole powers as products: the logarithm has no value at zero."""
    e = exponent.c
    whole = exponent.a is None and e.is_exact() and e.is_integer() and 0 < abs(e) <= LARGEST_EXPONENT
    if not whole:
        return _exp(_multiply(exponent, _log(base)))
    product = base
    for _ in range(abs(int(float(e))) - 1):
        product = _multiply(product, base)
    return product if e > 0 else _invert(product)


def _atan2(y: Expansion, x: Expansion) -> Expansion:
    """Expand the angle of (x, y), turned back by the angle at the centre; no number where it may jump."""
    if y.ball.contains(0) and not x.ball > 0:
        return constant(NO_NUMBER)
    cos, sin = constant(x.c), constant(y.c)
    ahead, aside = _add(_multiply(x, cos), _multiply(y, sin)), _subtract(_multiply(y, cos), _multiply(x, sin))
    if not ahead.ball > 0:
        return constant(NO_NUMBER)
    return _add(constant(arb.atan2(y.c, x.c)), _atan(_divide(aside, ahead)))


def _sign(x: Expansion) -> Expansion:
    return constant(1 if x.ball > 0 else -1 if x.ball < 0 else NO_NUMBER)


def _is_less(x: Expansion, y: Expansion) -> Expansion:
    return constant(is_less(x.ball, y.ball))


def _tan(x: Expansion) -> Expansion:
    return _divide(_sin(x), _cos(x))


def _asin(x: Expansion) -> Expansion:
    return _atan2(x, _sqrt(_subtract(constant(1), _square(x))))


def _acos(x: Expansion) -> Expansion:
    return _atan2(_sqrt(_subtract(constant(1), _square(x))), x)


EXPANSIONS: Final = Arithmetic(
    constant,
    {
        ca.OP_ASSIGN: lambda x: x,
        ca.OP_ADD: _add,
        ca.OP_SUB: _subtract,
        ca.OP_MUL: _multiply,
        ca.OP_DIV: _divide,
        ca.OP_INV: _invert,
        ca.OP_NEG: _negative,
        ca.OP_SQ: _square,
        ca.OP_TWICE: lambda x: _multiply(constant(2), x),
        ca.OP_POW: _power,
        ca.OP_CONSTPOW: _power,
        ca.OP_SQRT: _sqrt,
        ca.OP_EXP: _exp,
        ca.OP_LOG: _log,
        ca.OP_SIN: _sin,
        ca.OP_COS: _cos,
        ca.OP_TAN: _tan,
        ca.OP_ASIN: _asin,
        ca.OP_ACOS: _acos,
        ca.OP_ATAN: _atan,
        ca.OP_ATAN2: _atan2,
        ca.OP_SINH: _sinh,
        ca.OP_COSH: _cosh,
        ca.OP_TANH: lambda x: _divide(_sinh(x), _cosh(x)),
        ca.OP_FABS: lambda x: _multiply(_sign(x), x),
        ca.OP_SIGN: _sign,
        ca.OP_LT: _is_less,
    },
)
"""Scalar operations on expansions, those of `BALLS`."""
