"""Amounts: quantities that are positive, one for all coordinates or constraints, or one for each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from pydantic import ValidationInfo

from firmtouch.modelfile.declarations import Declarations
from firmtouch.modelfile.expression import Kind, Problem
from firmtouch.modelfile.fields import (
    QUANTITY_SCHEMA,
    Checked,
    Quantity,
    check_keys,
    declared,
    expect_dimension,
    read_all,
    read_quantities,
    read_quantity,
    refuse,
)
from firmtouch.modelfile.sections.operating_point import PER_NAME
from firmtouch.modelfile.units import parse_unit

SMALLEST: Final = 1e-15
"""What counts as zero, in SI: squares of amounts, and their inverses, are taken."""
LARGEST: Final = 1e15
_ONE_OR_EACH: Final[dict[str, Any]] = {"anyOf": [*QUANTITY_SCHEMA["anyOf"], PER_NAME]}


def read_amount(raw: object, unit: str, most: float = LARGEST) -> float:
    """Read one positive quantity in a unit."""
    quantity = read_quantity(raw, example=f"5 {unit}" if unit != "1" else "5")
    return _held(expect_dimension(quantity, parse_unit(unit).dimension), most=most)


def amount_in(unit: str, *, most: float = LARGEST) -> Checked:
    """Make the type of one positive quantity in a unit."""
    return Checked(lambda raw, _: read_amount(raw, unit, most), {**QUANTITY_SCHEMA, "description": f"in {unit}"})


@dataclass(frozen=True, slots=True)
class PerName:
    """Quantities that each coordinate, or each constraint, has one of, in a unit of its own."""

    what: str
    kinds: Callable[[Declarations], Mapping[str, Kind]]

    def each(self, *, zero: bool = False) -> Checked:
        """Make the type of one positive quantity for each name; one alone holds for all, if all have one unit."""

        def read(raw: object, info: ValidationInfo) -> dict[str, float]:
            kinds = self.kinds(declared(info))
            if not isinstance(raw, dict):
                return self._one_for_all(raw, kinds, zero=zero)
            values = read_quantities(raw, kinds, self.what)
            return read_all(values.items(), lambda _, value: _held(value, zero=zero))

        return Checked(read, _ONE_OR_EACH)

    def some(self) -> Checked:
        """Make the type of positive quantities for some of the names, at least one."""

        def read(raw: object, info: ValidationInfo) -> dict[str, float]:
            kinds = self.kinds(declared(info))
            if not isinstance(raw, dict) or not raw:
                example = f"{{{next(iter(kinds), 'name')}: ...}}"
                refuse(Problem(f"an entry for a {self.what} was expected, as in `{example}`"))
            check_keys(raw, kinds, self.what, complete=False)
            values = read_quantities(raw, {name: kinds[name] for name in raw}, self.what)
            return read_all(values.items(), lambda _, value: _held(value))

        return Checked(read, {**PER_NAME, "minProperties": 1})

    def norm(self) -> Checked:
        """Make the type of a positive 2-norm over all names: in their unit, or a bare number if they have several."""

        def read(raw: object, info: ValidationInfo) -> float:
            quantity, kinds = read_quantity(raw), self.kinds(declared(info))
            if not _mixed(kinds):
                _fits_all(quantity, kinds)
            elif not quantity.bare:
                message = f"the {self.what}s have different units, so this norm has none: write a bare number, in SI"
                refuse(Problem(message))
            return _held(quantity.value)

        return Checked(read, QUANTITY_SCHEMA)

    def _one_for_all(self, raw: object, kinds: Mapping[str, Kind], *, zero: bool) -> dict[str, float]:
        quantity = read_quantity(raw)
        if _mixed(kinds):
            example = f"{{{next(iter(kinds))}: ...}}"
            refuse(Problem(f"the {self.what}s have different units; give one value for each, as in `{example}`"))
        _fits_all(quantity, kinds)
        return dict.fromkeys(kinds, _held(quantity.value, zero=zero))


POSITIONS: Final = PerName("coordinate", lambda known: known.coordinates)
VELOCITIES: Final = PerName("coordinate", lambda known: known.rates)
JOINT_FORCES: Final = PerName("coordinate", lambda known: known.joint_forces)
STIFFNESSES: Final = PerName("coordinate", lambda known: known.stiffnesses)
DAMPINGS: Final = PerName("coordinate", lambda known: known.dampings)
MULTIPLIERS: Final = PerName("constraint", lambda known: known.multipliers)
CONTACT_STIFFNESSES: Final = PerName("constraint", lambda known: known.contact_stiffnesses)


def _mixed(kinds: Mapping[str, Kind]) -> bool:
    return len({kind.dimension for kind in kinds.values() if kind.known}) > 1


def _fits_all(quantity: Quantity, kinds: Mapping[str, Kind]) -> None:
    for dimension in {kind.dimension for kind in kinds.values() if kind.known}:
        expect_dimension(quantity, dimension)


def _held(value: float, *, zero: bool = False, most: float = LARGEST) -> float:
    """Refuse an amount that is negative, or zero where that is not allowed, or too large."""
    if zero and value < 0:
        refuse(Problem(f"{value:g} is out of range; it must not be negative"))
    if not (zero or value >= SMALLEST):
        refuse(Problem(f"{value:g} is out of range; it must be positive (at least {SMALLEST:g} in SI)"))
    if value > most:
        refuse(Problem(f"{value:g} is out of range; it must be at most {most:g}"))
    return value
