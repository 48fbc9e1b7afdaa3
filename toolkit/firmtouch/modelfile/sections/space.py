"""Points, directions and rotations in space, made of constants: quantities, numbers in SI, or parameters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Final, Literal

from pydantic import ValidationInfo

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import (
    EXPRESSION_SCHEMA,
    POSITIVE,
    Checked,
    Expression,
    constant_in,
    declared,
    read_all,
    read_constant,
    refuse,
    under,
    values_of,
)

AXES: Final = ("x", "y", "z")
Axis = Literal["x", "y", "z"]
Rotations = tuple[tuple[Axis, Expression], ...]


def _direction(raw: object, info: ValidationInfo) -> Expression:
    found = read_constant(raw, declared(info), "1", size=3)
    if values_of(found) == (0, 0, 0):
        refuse(Problem("a direction of length zero"))
    return found


def read_rotations(raw: list[Any], read_angle: Callable[[object], Expression], example: str) -> Rotations:
    """Read rotations about one axis each; `example` is one of them."""
    return tuple(read_all(enumerate(raw), lambda _, each: _rotation(each, read_angle, example)).values())


def _rotation(raw: object, read_angle: Callable[[object], Expression], example: str) -> tuple[Axis, Expression]:
    axis = next(iter(raw)) if isinstance(raw, dict) and len(raw) == 1 else None
    if not isinstance(raw, dict) or axis not in AXES:
        refuse(Problem(f"a rotation is written `{example}`: one axis out of x, y, z, and an angle"))
    with under(axis):
        return axis, read_angle(raw[axis])


def _turns(raw: object, info: ValidationInfo) -> Rotations:
    if not isinstance(raw, list):
        refuse(Problem("a list of rotations was expected, such as `[{z: 30 deg}, {y: 10 deg}]`"))
    known = declared(info)
    return read_rotations(raw, lambda angle: read_constant(angle, known, "1"), "{z: 30 deg}")


_TURN: Final = {"type": "object", "properties": dict.fromkeys("xyz", EXPRESSION_SCHEMA), "minProperties": 1,
                "maxProperties": 1, "additionalProperties": False}  # fmt: skip
_THREE: Final = {"type": "array", "items": EXPRESSION_SCHEMA, "minItems": 3, "maxItems": 3}
Place = Annotated[Expression, constant_in("m", size=3)]
Length = Annotated[Expression, constant_in("m", within=POSITIVE)]
Lengths = Annotated[Expression, constant_in("m", size=3, within=POSITIVE)]
Direction = Annotated[Expression, Checked(_direction, {"anyOf": [{"type": "string"}, _THREE]})]
"""A vector of plain numbers, of any length but zero."""
Turns = Annotated[Rotations, Checked(_turns, {"type": "array", "items": _TURN})]
"""Rotations about the axes as the earlier ones have left them."""
