"""Numbers for readers: four figures, true minus signs, powers of ten in superscripts."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:  # else CasADi would be loaded for every report
    from firmtouch.mechanics import Array

_SUPERSCRIPTS: Final = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
NEGLIGIBLE: Final = 1e-11
"""Entries this much smaller than their matrix are rounding, and are shown as 0."""


def number(value: float, figures: int = 4) -> str:
    """Write a number with some significant figures."""
    if math.isinf(value) or math.isnan(value):
        return "∞" if value > 0 else "−∞" if value < 0 else "not a number"
    if value == 0:
        return "0"
    mantissa, _, power = f"{value:.{figures - 1}e}".partition("e")  # after rounding: 99999.6 counts as 1e5
    exponent = int(power)
    if -3 <= exponent < 5:
        text = _without_zeros(f"{value:.{max(figures - 1 - exponent, 0)}f}")
    else:
        text = f"{_without_zeros(mantissa)}×10{str(exponent).translate(_SUPERSCRIPTS)}"
    return text.replace("-", "−")


def bound(value: float, *, upwards: bool, figures: int = 5) -> str:
    """Write a bound, rounded to the safe side: an upper one upwards, a lower one downwards."""
    if not math.isfinite(value) or value == 0:
        return number(value)
    exact = Decimal(value)
    step = Decimal(1).scaleb(exact.adjusted() - figures + 1)
    return number(float(exact.quantize(step, rounding=ROUND_CEILING if upwards else ROUND_FLOOR)), figures)


def _without_zeros(text: str) -> str:
    return text.rstrip("0").rstrip(".") if "." in text else text


def complex_number(value: complex, figures: int = 4) -> str:
    """Write a complex number; an imaginary part that the figures would not show is left out."""
    if abs(value.imag) <= 0.5 * 10.0**-figures * abs(value):
        return number(value.real, figures)
    sign = "+" if value.imag > 0 else "−"
    return f"{number(value.real, figures)} {sign} {number(abs(value.imag), figures)}j"


def matrix(values: Array, figures: int = 4) -> tuple[tuple[str, ...], ...]:
    """Write a matrix, or a vector as a column."""
    columns = values.reshape(-1, 1) if values.ndim == 1 else values
    scale = max((abs(float(each)) for each in columns.ravel()), default=0.0)
    return tuple(tuple(_entry(float(each), scale, figures) for each in row) for row in columns)


def vector(values: Iterable[float], figures: int = 3) -> str:
    """Write a vector in a line."""
    return "(" + ", ".join(entries(values, figures)) + ")"


def entries(values: Iterable[float], figures: int = 4) -> tuple[str, ...]:
    """Write numbers that belong together, rounding beside the largest of them as 0."""
    listed = [float(each) for each in values]
    scale = max((abs(each) for each in listed), default=0.0)
    return tuple(_entry(each, scale, figures) for each in listed)


def unit(text: str) -> str:
    """Write a unit for readers: `kg*m^2` as kg m²."""
    written = text.replace("**", "^").replace("*", " ")
    return re.sub(r"\^(-?[0-9]+)", lambda match: match[1].translate(_SUPERSCRIPTS), written)


def _entry(value: float, scale: float, figures: int) -> str:
    return "0" if abs(value) <= NEGLIGIBLE * scale else number(value, figures)
