"""Units at the file's boundary: a text such as `0.6 m` or `kg*m^2` -> SI.

The names come from pint; products and powers are read here, since pint evaluates what it is given (`9**9**9 m`
would never end). Only units that are a factor times SI are accepted, so no degrees Celsius.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import TYPE_CHECKING, Final

from firmtouch.modelfile.words import did_you_mean, shown

if TYPE_CHECKING:
    import pint

BASE: Final = ("kg", "m", "s", "A", "K", "mol", "cd")
_PINT_NAMES: Final = ("[mass]", "[length]", "[time]", "[current]", "[temperature]", "[substance]", "[luminosity]")
_FACTOR: Final = re.compile(
    r"(?:\s*(?P<sign>[*/·])\s*|\s+|^)(?P<name>[A-Za-z_µμΩ°%]+|1)(?:(?:\^|\*\*)?(?P<power>-?[0-9]+))?"
)
_NUMBER: Final = re.compile(r"\s*[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")
_MECHANICS: Final = ("N", "J", "W", "N/m", "m/s^2", "m/s", "kg*m^2", "1/s")
_HEAT: Final = ("W/m/K", "W/m^2/K", "W/m^2", "W/K", "J/K", "J/kg/K", "J/m^2/K", "V", "ohm")
"""Units of derived quantities, by which messages name dimensions."""
LONGEST_UNIT: Final = 60
HIGHEST_POWER: Final = 12
Exponent = Fraction | int
"""Whole exponents are kept as `int`: dimensions are multiplied for every product of every expression."""


@dataclass(frozen=True, slots=True)
class Dimension:
    """Exponents of the seven SI base units."""

    exponents: tuple[Exponent, ...] = (0,) * len(BASE)

    def __mul__(self, other: Dimension) -> Dimension:
        """Give the dimension of a product."""
        return Dimension(tuple(a + b for a, b in zip(self.exponents, other.exponents, strict=True)))

    def __truediv__(self, other: Dimension) -> Dimension:
        """Give the dimension of a quotient."""
        return Dimension(tuple(a - b for a, b in zip(self.exponents, other.exponents, strict=True)))

    def __pow__(self, exponent: Exponent) -> Dimension:
        """Give the dimension of a power."""
        return Dimension(tuple(_whole_if_possible(exponent * each) for each in self.exponents))

    def __str__(self) -> str:
        """Write it in SI base units, or by the name of the usual derived unit."""
        if self in _named():
            return _named()[self]
        parts = [unit if e == 1 else f"{unit}^{e}" for unit, e in zip(BASE, self.exponents, strict=True) if e]
        return " ".join(parts) or "1"

    def in_words(self) -> str:
        """Say it in a message: `in m`, or `a plain number`."""
        return "a plain number" if self == DIMENSIONLESS else f"in {self}"


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit: one of it is `factor` in SI."""

    text: str
    factor: float
    dimension: Dimension


class UnitError(ValueError):
    """A text that is no unit; `offset` is where in the text."""

    def __init__(self, message: str, offset: int = 0) -> None:
        self.offset = offset
        super().__init__(message)


def _whole_if_possible(exponent: Exponent) -> Exponent:
    return exponent.numerator if exponent.denominator == 1 else exponent


def _base(**exponents: int) -> Dimension:
    return Dimension(tuple(exponents.get(each, 0) for each in BASE))


DIMENSIONLESS: Final = Dimension()
SECOND: Final = _base(s=1)
JOULE: Final = _base(kg=1, m=2, s=-2)


def parse_unit(text: str) -> Unit:
    """Read a unit: names with powers, joined by `*`, `/` or a space.

    Raises
    ------
    UnitError
        For a name that is not known, or one that is no multiple of SI.
    """
    if len(text) > LONGEST_UNIT:
        raise UnitError(f"a unit of {len(text)} characters; at most {LONGEST_UNIT} are read")
    written = text.rstrip()
    factor, dimension, at = 1.0, DIMENSIONLESS, 0
    while at < len(written):
        match = _FACTOR.match(written, at)
        if match is None:
            raise UnitError(f"{shown(written[at:].strip())} is no unit; write for example `kg*m^2` or `N/m`", at)
        power = int(match["power"] or 1) * (-1 if match["sign"] == "/" else 1)
        if abs(power) > HIGHEST_POWER:
            raise UnitError(f"a power of {power}; at most {HIGHEST_POWER} is read", match.start("power"))
        scale, base = _unit(match["name"], match.start("name"))
        factor, dimension = factor * _power(scale, power), dimension * base**power
        at = match.end()
    if not (math.isfinite(factor) and factor > 0):
        raise UnitError(f"{shown(text)} has no finite factor to SI")
    return Unit(" ".join(written.split()), factor, dimension)


def _power(scale: float, power: int) -> float:
    try:
        return scale**power
    except OverflowError:
        return math.inf


def split_quantity(text: str) -> tuple[float, str, int] | None:
    """Split `0.6 m` into its number, its unit's text and where that begins; `None` where no number stands first."""
    match = _NUMBER.match(text)
    if match is None:
        return None
    return float(match.group()), text[match.end() :], match.end()


@cache
def _registry() -> pint.UnitRegistry[float]:
    import pint

    return pint.UnitRegistry(cache_folder=None)


@cache
def _unit(name: str, at: int) -> tuple[float, Dimension]:
    import pint

    if name == "1":
        return 1.0, DIMENSIONLESS
    try:
        quantity = _registry().Quantity(1.0, name).to_base_units()
        zero = _registry().Quantity(0.0, name).to_base_units()
    except pint.UndefinedUnitError:
        raise UnitError(f"{shown(name)} is no unit{_near(name)}", at) from None
    except (pint.PintError, AttributeError, TypeError, ValueError) as error:
        raise UnitError(f"`{name}` cannot be used as a unit ({error})", at) from None
    if zero.magnitude != 0:
        raise UnitError(f"`{name}` is no multiple of an SI unit", at)
    exponents = dict(quantity.dimensionality)
    found = tuple(_exponent(exponents.pop(each, 0)) for each in _PINT_NAMES)
    if exponents:
        raise UnitError(f"`{name}` is no unit of mechanics or heat", at)
    return float(quantity.magnitude), Dimension(found)


def _exponent(pints: object) -> Exponent:
    """Read pint's exponents: ints, and floats such as 0.5 for square roots of units."""
    return _whole_if_possible(Fraction(str(pints)).limit_denominator(9))


def _near(name: str) -> str:
    usual = ["m", "mm", "cm", "km", "kg", "g", "s", "ms", "min", "rad", "deg", "mrad", "N", "kN", "J", "W", "Hz", "Pa"]
    return did_you_mean(name, [*usual, "newton", "metre", "meter", "degree", "radian", "kilogram", "second", "joule"])


@cache
def _named() -> dict[Dimension, str]:
    return {parse_unit(text).dimension: text for text in (*_MECHANICS, *_HEAT)}
