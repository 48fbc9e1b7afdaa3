"""The grid of a height field: its two spans, and its heights."""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import ValidationInfo

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import (
    EXPRESSION_SCHEMA,
    QUANTITY_SCHEMA,
    Checked,
    Expression,
    declared,
    expect_dimension,
    read_all,
    read_constant,
    read_quantity,
    refuse,
    values_of,
)
from firmtouch.modelfile.units import parse_unit

LEAST, MOST = 4, 40
"""Heights along each axis: a cubic has four; every height is part of every evaluation of the surface."""


def _span(raw: object, info: ValidationInfo) -> Expression:
    found = read_constant(raw, declared(info), "m", size=2)
    values = values_of(found)
    if values is not None and not values[0] < values[1]:
        refuse(Problem(f"it starts at {values[0]:g} m and stops at {values[1]:g} m; `[start, stop]` must grow"))
    return found


def _heights(raw: object, info: ValidationInfo) -> tuple[tuple[float, ...], ...]:  # noqa: ARG001  # pydantic's
    if not isinstance(raw, list) or not raw or not all(isinstance(row, list) and row for row in raw):
        refuse(Problem("a list of lists was expected: for each x, the heights along y"))
    if not LEAST <= len(raw) <= MOST:
        refuse(Problem(f"{len(raw)} rows; {LEAST} to {MOST} are read"))
    columns = len(raw[0])
    if not LEAST <= columns <= MOST:
        refuse(Problem(f"{columns} heights in a row; {LEAST} to {MOST} are read", path=(0,)))
    ragged = [
        Problem(f"{len(row)} heights, and {columns} in the first row", path=(i,))
        for i, row in enumerate(raw)
        if len(row) != columns
    ]
    if ragged:
        refuse(*ragged)
    rows = read_all(enumerate(raw), lambda _, row: tuple(read_all(enumerate(row), lambda _, h: _height(h)).values()))
    return tuple(rows.values())


def _height(raw: object) -> float:
    return expect_dimension(read_quantity(raw, example="0.02 m"), parse_unit("m").dimension)


_SPAN: Final = {"type": "array", "items": EXPRESSION_SCHEMA, "minItems": 2, "maxItems": 2}
_SIZES: Final = {"minItems": LEAST, "maxItems": MOST}
_ROWS: Final = {"type": "array", **_SIZES, "items": {"type": "array", **_SIZES, "items": QUANTITY_SCHEMA}}
Span = Annotated[Expression, Checked(_span, {"anyOf": [{"type": "string"}, _SPAN]})]
Heights = Annotated[tuple[tuple[float, ...], ...], Checked(_heights, _ROWS)]
