"""The units of a model's vectors: one name where all entries share it, nothing where they are mixed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from firmtouch.modelfile.specification import ModelSpec

_EFFORT: Final = {"rad": "N m", "m": "N"}
_STIFFNESS: Final = {"rad": "N m/rad", "m": "N/m"}
_DAMPING: Final = {"rad": "N m s/rad", "m": "N s/m"}


@dataclass(frozen=True, slots=True)
class Units:
    """Units of q, of generalised forces, of stiffness, of damping, of Phi and of lambda; empty where entries differ."""

    coordinate: str
    joint_force: str
    stiffness: str
    damping: str
    offset: str
    multiplier: str


def units_of(spec: ModelSpec) -> Units:
    """Find the units of a model's vectors."""
    coordinate = _shared(each.unit for each in spec.coordinates.values())
    offset = _shared(each.unit for each in spec.constraints.values())
    return Units(
        coordinate,
        _EFFORT.get(coordinate, ""),
        _STIFFNESS.get(coordinate, ""),
        _DAMPING.get(coordinate, ""),
        offset,
        _EFFORT.get(offset, ""),
    )


def joint_units(coordinate: str) -> Units:
    """Give the units that belong to one coordinate's own entries."""
    return Units(coordinate, _EFFORT[coordinate], _STIFFNESS[coordinate], _DAMPING[coordinate], "", "")


def _shared(units: Iterable[str]) -> str:
    found = set(units)
    return found.pop() if len(found) == 1 else ""
