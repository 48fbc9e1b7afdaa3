"""Kinds of entry of thermal files: amounts with a range, temperatures, intervals, names of rows of the tables."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Final

from pydantic import ValidationInfo

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import QUANTITY_SCHEMA, Checked, expect_dimension, read_all, read_quantity, refuse
from firmtouch.modelfile.units import parse_unit, split_quantity
from firmtouch.modelfile.words import listed, shown

ABSOLUTE_ZERO: Final = -273.15
"""In degC."""
COLDEST, HOTTEST = 200.0, 500.0
"""Temperatures of sensors and objects, in K; polymers do not bear more."""
_CELSIUS: Final = re.compile(r"\s*(?:degC|°C|celsius)\s*", re.IGNORECASE)
_ROOT_HERTZ: Final = re.compile(r"\s*/\s*(?:√Hz|sqrt\(Hz\)|rtHz)\s*$")
Read = Callable[[object], float]


def reader(unit: str, *, least: float = 0.0, most: float, zero: str | None = "") -> Read:
    """Make the reading function of a quantity; `least` is allowed itself, but 0 only where `zero` is None.

    What `zero` says is told where 0 is given.
    """

    def read(raw: object) -> float:
        quantity = read_quantity(raw, example=f"5 {unit}" if unit != "1" else "5")
        value = expect_dimension(quantity, parse_unit(unit).dimension)
        if value == 0 and zero:
            refuse(Problem(zero))
        if value < 0 or (value == 0 and zero is not None):
            refuse(
                Problem(
                    f"{shown(str(raw))} is out of range; it must {'not be negative' if zero is None else 'be positive'}"
                )
            )
        if not least <= value <= most:
            of = "" if unit == "1" else f" {unit}"
            refuse(Problem(f"{shown(str(raw))} is out of range; it must lie between {least:g} and {most:g}{of}"))
        return value

    return read


def described(read: Read, description: str) -> Checked:
    """Make the type of a reading function of one quantity."""
    return Checked(lambda raw, _: read(raw), {**QUANTITY_SCHEMA, "description": description})


def amount(unit: str, *, least: float = 0.0, most: float, zero: str | None = "") -> Checked:
    """Make the type of a quantity, as `reader` reads it."""
    return described(reader(unit, least=least, most=most, zero=zero), f"in {unit}" if unit != "1" else "a plain number")


def read_temperature(raw: object) -> float:
    """Read `37 degC` or `310 K` -> K. A bare number is refused: it may be meant either way."""
    split = split_quantity(raw) if isinstance(raw, str) else None
    if split is not None and _CELSIUS.fullmatch(split[1]):
        value = split[0] - ABSOLUTE_ZERO
    else:
        quantity = read_quantity(raw, example="37 degC")
        if quantity.bare:
            refuse(Problem(f"{shown(str(raw))} may be in degC or in K; write `37 degC` or `310 K`"))
        value = expect_dimension(quantity, parse_unit("K").dimension)
    if not COLDEST <= value <= HOTTEST:
        refuse(Problem(f"{shown(str(raw))} is out of range; it must lie between {COLDEST:g} K and {HOTTEST:g} K"))
    return value


def _noise_density(raw: object) -> float:
    """Read `10 nV/sqrt(Hz)` -> V/sqrt(Hz)."""
    if not isinstance(raw, str) or not _ROOT_HERTZ.search(raw):
        refuse(Problem(f"{shown(str(raw))} is no noise density; write `10 nV/sqrt(Hz)`"))
    return reader("V", most=1.0)(_ROOT_HERTZ.sub("", raw))


def interval(read: Read, description: str) -> Checked:
    """Make the type of `[low, high]`, where low < high."""

    def both(raw: object, info: ValidationInfo) -> tuple[float, float]:  # noqa: ARG001  # the signature is pydantic's
        if not isinstance(raw, list) or len(raw) != 2:
            refuse(Problem("two quantities were expected, the least and the most, as in `[2, 5]` with their unit"))
        low, high = read_all(enumerate(raw), lambda _, each: read(each)).values()
        if low >= high:
            refuse(Problem(f"{shown(f'[{raw[0]}, {raw[1]}]')} holds nothing; the first must be less than the second"))
        return low, high

    schema = {"type": "array", "items": QUANTITY_SCHEMA, "minItems": 2, "maxItems": 2}
    return Checked(both, {**schema, "description": description})


def span(read: Read, description: str) -> Checked:
    """Make the type of one quantity, or of `[low, high]` for what a family of parts has; always a pair."""
    two = interval(read, description)

    def either(raw: object, info: ValidationInfo) -> tuple[float, float]:
        if isinstance(raw, list):
            found: tuple[float, float] = two.read(raw, info)
            return found
        value = read(raw)
        return value, value

    return Checked(either, {"anyOf": [*QUANTITY_SCHEMA["anyOf"], two.schema], "description": description})


def whole(least: int, most: int) -> Checked:
    """Make the type of a whole number."""

    def read(raw: object, info: ValidationInfo) -> int:  # noqa: ARG001  # the signature is pydantic's
        return read_whole(raw, least, most)

    return Checked(read, {"type": "integer", "minimum": least, "maximum": most})


def read_whole(raw: object, least: int, most: int) -> int:
    """Read a whole number between two others."""
    if isinstance(raw, bool) or not isinstance(raw, int) or not least <= raw <= most:
        refuse(Problem(f"{shown(str(raw))} is not possible here; expected a whole number from {least} to {most}"))
    return raw


def read_name(raw: object, table: Mapping[str, object], what: str) -> str:
    """Read the name of a row of a table."""
    if not isinstance(raw, str) or raw not in table:
        choices = tuple(table)
        refuse(Problem(f"{shown(str(raw))} is no {what}; there are: {listed(choices)}", near=(str(raw), choices)))
    return raw


def choices_of(read: Callable[[object, ValidationInfo], Any], items: dict[str, Any], what: str) -> Checked:
    """Make the type of a list of different values, out of which a search chooses."""

    def each(raw: object, info: ValidationInfo) -> tuple[Any, ...]:
        if not isinstance(raw, list) or not raw:
            refuse(Problem(f"a list of {what} was expected, to choose from"))

        def one(i: int, entry: object) -> Any:  # noqa: ANN401  # whatever is chosen
            value = read(entry, info)
            if entry in raw[:i]:
                refuse(Problem(f"{shown(str(entry))} stands here twice"))
            return value

        return tuple(read_all(enumerate(raw), one).values())

    return Checked(each, {"type": "array", "items": items, "minItems": 1, "description": f"{what} to choose from"})


RATIO: Final = reader("1", most=1.0, zero=None)
LENGTH: Final = reader("m", least=1e-9, most=1.0)
CONDUCTANCE: Final = reader(
    "W/m^2/K",
    least=1e-3,
    most=1e9,
    zero="a conductance of zero lets no heat through: nothing would be felt",
)
DURATION: Final = reader("s", least=1e-9, most=1e5)
Ratio = Annotated[float, described(RATIO, "a fraction, such as `5 %`")]
Length = Annotated[float, described(LENGTH, "in m")]
Conductance = Annotated[float, described(CONDUCTANCE, "in W/m^2/K")]
Duration = Annotated[float, described(DURATION, "in s")]
Temperature = Annotated[
    float, Checked(lambda raw, _: read_temperature(raw), {"type": "string", "examples": ["37 degC", "310 K"]})
]
NoiseDensity = Annotated[
    float, Checked(lambda raw, _: _noise_density(raw), {"type": "string", "examples": ["10 nV/sqrt(Hz)"]})
]
