"""Constants of the file: a quantity, a number in SI, or an expression of the parameters."""

from __future__ import annotations

from typing import Any, Final

from pydantic import ValidationInfo

from firmtouch.modelfile.declarations import Declarations, Extent
from firmtouch.modelfile.expression import Kind, Problem
from firmtouch.modelfile.expression.tree import Number, Vector
from firmtouch.modelfile.fields.checked import Checked, declared, read_all, refuse
from firmtouch.modelfile.fields.formula import EXPRESSION_SCHEMA, Expression, read_expression
from firmtouch.modelfile.fields.quantity import expect_dimension, read_quantity
from firmtouch.modelfile.units import UnitError, parse_unit, split_quantity

CONSTANT_SCHEMA: Final[dict[str, Any]] = {"anyOf": EXPRESSION_SCHEMA["anyOf"]}
VECTOR_SCHEMA: Final[dict[str, Any]] = {
    "anyOf": [{"type": "array", "items": CONSTANT_SCHEMA, "minItems": 3, "maxItems": 3}, {"type": "string"}]
}


def constant_in(unit: str) -> Checked:
    """Make the type of a constant scalar in a unit."""
    return Checked(
        lambda raw, info: read_constant(raw, declared(info), unit),
        {**CONSTANT_SCHEMA, "description": f"in {unit}" if unit != "1" else "a number or an angle"},
    )


def vector_in(unit: str) -> Checked:
    """Make the type of a constant vector in space."""

    def read(raw: object, info: ValidationInfo) -> Expression:
        known = declared(info)
        if not isinstance(raw, list):
            return read_expression(raw, known.constant(), unit=unit, sizes=(3,))
        if len(raw) != 3:
            refuse(Problem(f"{len(raw)} entries where 3 were expected: x, y and z"))
        entries = read_all(enumerate(raw), lambda _, each: read_constant(each, known, unit)).values()
        text = f"[{', '.join(each.text for each in entries)}]"
        extent = Extent(1 + sum(each.extent.nodes for each in entries), 1 + max(each.extent.depth for each in entries))
        return Expression(text, Vector(tuple(each.tree for each in entries), 0), Kind(parse_unit(unit).dimension, 3), extent)

    return Checked(read, VECTOR_SCHEMA)


def read_constant(raw: object, known: Declarations, unit: str) -> Expression:
    """Read a quantity such as `12 cm`, or an expression of the parameters."""
    if isinstance(raw, str) and _is_quantity(raw):
        quantity = read_quantity(raw, example=f"5 {unit}")
        value = expect_dimension(quantity, parse_unit(unit).dimension)
        return Expression(quantity.text, Number(repr(value), 0), Kind(parse_unit(unit).dimension), Extent(1, 1))
    return read_expression(raw, known.constant(), unit=unit)


def _is_quantity(text: str) -> bool:
    """Tell a number with a unit from an expression: `2*r` and `-r` are expressions, `2 m` and `30 deg` are not."""
    split = split_quantity(text)
    if split is None or not split[1].strip():
        return False
    try:
        parse_unit(split[1])
    except (UnitError, ValueError):
        return split[1][:1].isspace()
    return True
