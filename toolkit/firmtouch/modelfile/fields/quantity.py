"""Quantities and units: `0.6 m` -> a number in SI."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Final

from pydantic import ValidationInfo

from firmtouch.modelfile.expression import Kind, Problem
from firmtouch.modelfile.fields.checked import Checked, read_all, refuse
from firmtouch.modelfile.fields.names import check_keys
from firmtouch.modelfile.units import DIMENSIONLESS, Dimension, UnitError, parse_unit, split_quantity
from firmtouch.modelfile.words import shown

LARGEST: Final = 1e15


@dataclass(frozen=True, slots=True)
class Quantity:
    """A number with a unit, converted to SI; `text` is what was written."""

    text: str
    value: float
    dimension: Dimension
    bare: bool

    def in_(self, dimension: Dimension) -> bool:
        """Tell whether it can be read as a quantity of this dimension: bare numbers are SI."""
        return self.bare or self.dimension == dimension


def read_quantity(raw: object, *, example: str = "0.6 m") -> Quantity:
    """Read `0.6 m` or a bare number."""
    if isinstance(raw, bool) or not isinstance(raw, str | int | float):
        refuse(Problem(f"a quantity was expected, such as `{example}`"))
    if isinstance(raw, int | float):
        return _bounded(Quantity(f"{raw:g}", float(raw), DIMENSIONLESS, bare=True), raw)
    split = split_quantity(raw)
    if split is None:
        refuse(Problem(f"{shown(raw)} is no quantity; write a number and a unit, such as `{example}`"))
    number, unit_text, offset = split
    try:
        unit = parse_unit(unit_text)
    except UnitError as error:
        refuse(Problem(str(error), offset + error.offset))
    bare = not unit_text.strip()
    return _bounded(Quantity(" ".join(raw.split()), number * unit.factor, unit.dimension, bare=bare), raw)


def _bounded(quantity: Quantity, raw: object) -> Quantity:
    if not math.isfinite(quantity.value) or abs(quantity.value) > LARGEST:
        refuse(Problem(f"{shown(str(raw))} is no finite number of a usable size (at most {LARGEST:g} in SI)"))
    return quantity


def _any_quantity(raw: object, info: ValidationInfo) -> Quantity:  # noqa: ARG001  # the signature is pydantic's
    return raw if isinstance(raw, Quantity) else read_quantity(raw)


QUANTITY_SCHEMA: Final[dict[str, Any]] = {
    "anyOf": [{"type": "number"}, {"type": "string", "pattern": r"^\s*[-+]?[0-9.].*$"}]
}
AnyQuantity = Annotated[Quantity, Checked(_any_quantity, {**QUANTITY_SCHEMA, "description": "such as `0.6 m`"})]


def quantity_in(unit: str, *, least: float = -math.inf, most: float = math.inf) -> Checked:
    """Make the type of a quantity of one dimension between two bounds, in SI."""

    def read(raw: object, info: ValidationInfo) -> float:  # noqa: ARG001  # the signature is pydantic's
        quantity = read_quantity(raw, example=f"5 {unit}" if unit != "1" else "5")
        expect_dimension(quantity, parse_unit(unit).dimension)
        if not least <= quantity.value <= most:
            span = f"at least {least:g}" if most == math.inf else f"between {least:g} and {most:g}"
            refuse(Problem(f"{shown(str(raw))} is out of range; it must be {span}"))
        return quantity.value

    return Checked(read, {**QUANTITY_SCHEMA, "description": f"in {unit}"})


def expect_dimension(quantity: Quantity, dimension: Dimension) -> float:
    """Give the value in SI of a quantity that must have this dimension."""
    if not quantity.in_(dimension):
        wanted = "a plain number or an angle" if dimension == DIMENSIONLESS else dimension
        refuse(Problem(f"`{quantity.text}` is {quantity.dimension.in_words()}, but {wanted} was expected"))
    return quantity.value


def _unit(raw: object, info: ValidationInfo) -> str:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, str):
        refuse(Problem("a unit was expected, such as `m` or `rad`"))
    try:
        return parse_unit(raw).text
    except UnitError as error:
        refuse(Problem(str(error), error.offset))


UnitText = Annotated[str, Checked(_unit, {"type": "string", "examples": ["m", "rad", "1"]})]


def read_quantities(raw: object, kinds: Mapping[str, Kind], what: str) -> dict[str, float]:
    """Read a mapping that has one quantity, of its own dimension, for each name; the values are in SI."""
    if not isinstance(raw, dict):
        refuse(Problem(f"an entry for each {what} was expected, as in `{{{next(iter(kinds), 'name')}: ...}}`"))
    check_keys(raw, kinds, what, complete=True)

    def read(name: str, each: object) -> float:
        quantity = read_quantity(each)
        return expect_dimension(quantity, kinds[name].dimension) if kinds[name].known else quantity.value

    return read_all(raw.items(), read)
