"""Bounds of CasADi functions over boxes, by walking their instructions with intervals that are rounded outward."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from firmtouch.errors import NoDesignError
from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.mechanics.tape import OPERATORS, Arithmetic, UnknownOperationError, record


def has_kinks(function: ca.Function) -> bool:
    """Tell whether a function might have a kink or a jump that its derivatives do not show."""
    return any(
        function.instruction_id(k) in (ca.OP_FABS, ca.OP_SIGN, ca.OP_ATAN2, ca.OP_LT)
        for k in range(function.n_instructions())
    )


def enclose(function: ca.Function, box: list[tuple[float, float]], what: str) -> Array:
    """Bound the absolute values of a function over a box, by walking its instructions with intervals.

    Raises
    ------
    NoDesignError
        If it is not bounded or not smooth on the box, as far as intervals tell, or has an operation unknown here.
    """
    from mpmath import iv

    try:
        tape = record(function, Arithmetic(iv.mpf, _interval_operations()))
        (values,) = tape([iv.mpf(list(each)) for each in box])
    except UnknownOperationError as error:
        raise NoDesignError(f"{what} cannot be bounded: no intervals for the operation {error}") from error
    except ValueError as error:
        raise NoDesignError(f"{what} cannot be bounded over its interval ({error}); narrow it") from error
    outputs = frozen([max(abs(float(each.a)), abs(float(each.b))) for each in values])
    if not np.all(np.isfinite(outputs)):
        raise NoDesignError(f"{what} cannot be bounded over its interval (a division by zero?); narrow it")
    return outputs


def _interval_operations() -> dict[int, Callable[..., Any]]:
    """Give CasADi's operations for intervals that are rounded outward."""
    from mpmath import iv

    def power(base: Any, exponent: Any) -> Any:  # noqa: ANN401  # mpmath has no types
        whole = exponent.a == exponent.b and float(exponent.a).is_integer()
        return base ** int(float(exponent.a)) if whole else iv.exp(exponent * iv.log(base))

    def atan2(y: Any, x: Any) -> Any:  # noqa: ANN401
        if x.a <= 0 and y.a <= 0 <= y.b:
            raise ValueError("atan2 jumps")
        return iv.atan2(y, x)

    def sign(x: Any) -> Any:  # noqa: ANN401
        if x.a <= 0 <= x.b:
            raise ValueError("an absolute value has a kink")
        return iv.mpf(1 if x.a > 0 else -1)

    def is_less(x: Any, y: Any) -> Any:  # noqa: ANN401
        if x.a < y.b and y.a <= x.b:  # the parameter moves the knot of a spline, of which it is then no polynomial
            raise ValueError("a spline has a knot there")
        return iv.mpf(1 if x.b < y.a else 0)

    def cathetus(x: Any) -> Any:  # noqa: ANN401
        return iv.sqrt(1 - x**2)

    return {
        **OPERATORS,
        ca.OP_SQ: lambda x: x**2,
        ca.OP_POW: power,
        ca.OP_CONSTPOW: power,
        ca.OP_SQRT: iv.sqrt,
        ca.OP_EXP: iv.exp,
        ca.OP_LOG: iv.log,
        ca.OP_SIN: iv.sin,
        ca.OP_COS: iv.cos,
        ca.OP_TAN: iv.tan,
        ca.OP_ASIN: lambda x: atan2(x, cathetus(x)),
        ca.OP_ACOS: lambda x: atan2(cathetus(x), x),
        ca.OP_ATAN: lambda x: atan2(x, iv.mpf(1)),
        ca.OP_ATAN2: atan2,
        ca.OP_SINH: lambda x: (iv.exp(x) - iv.exp(-x)) / 2,
        ca.OP_COSH: lambda x: (iv.exp(x) + iv.exp(-x)) / 2,
        ca.OP_TANH: lambda x: 1 - 2 / (iv.exp(2 * x) + 1),
        ca.OP_FABS: lambda x: sign(x) * x,
        ca.OP_SIGN: sign,
        ca.OP_LT: is_less,
    }
