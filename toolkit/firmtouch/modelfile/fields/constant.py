"""Constants: a quantity such as `0.12 m`, a bare number in SI, or an expression of the file's parameters."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Final

from pydantic import ValidationInfo

from firmtouch.modelfile.declarations import Declarations, Extent, parse_entry
from firmtouch.modelfile.expression import CONSTANTS, ExpressionError, Kind, Problem, Vector
from firmtouch.modelfile.expression.kind import constant
from firmtouch.modelfile.fields.checked import Checked, declared, read_all, refuse
from firmtouch.modelfile.fields.formula import EXPRESSION_SCHEMA, Expression, read_expression
from firmtouch.modelfile.fields.quantity import expect_dimension, read_quantity
from firmtouch.modelfile.units import parse_unit
from firmtouch.modelfile.words import shown

_QUANTITY: Final = re.compile(r"\s*[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?\s*[A-Za-zµμΩ°%]")
"""A number and then a letter: no expression begins like that, as `2*r` has an operator between."""
_TERMS: Final = re.compile(r"(?<![eE^*])[-+](?=\s)|[()]|(?<=\s)[-+](?=[A-Za-z])")
"""Where a quantity goes on as a sum or with a bracket."""
SIZES: Final = {2: "two", 3: "three"}


@dataclass(frozen=True, slots=True)
class Range:
    """The numbers that a constant may be: above and below are excluded themselves, least and most are not."""

    above: float = -math.inf
    below: float = math.inf
    least: float = -math.inf
    most: float = math.inf

    def check(self, value: float, text: str) -> None:
        """Refuse a number outside."""
        if not (self.above < value < self.below and self.least <= value <= self.most):
            refuse(Problem(f"{shown(text)} is out of range; it must be {self}"))

    def __str__(self) -> str:
        """Say it in a message."""
        if self == POSITIVE:
            return "positive"
        bounds = {"above": self.above, "below": self.below, "at least": self.least, "at most": self.most}
        return " and ".join(f"{word} {bound:.6g}" for word, bound in bounds.items() if math.isfinite(bound))


ANY: Final = Range()
POSITIVE: Final = Range(above=0)


def constant_in(unit: str, *, size: int = 0, within: Range = ANY) -> Checked:
    """Make the type of a constant in a unit; `size` 0 is a scalar, otherwise a vector of 2 or 3.

    It becomes an `Expression`, and what a quantity is in SI a number in it. Whatever is a number is held to be within
    the range, entry by entry; what has parameters in it cannot be, as their values are read elsewhere.
    """

    def read(raw: object, info: ValidationInfo) -> Expression:
        return read_constant(raw, declared(info), unit, size=size, within=within)

    items = {"type": "array", "items": EXPRESSION_SCHEMA, "minItems": size, "maxItems": size}
    schema = {"anyOf": [{"type": "string"}, items]} if size else EXPRESSION_SCHEMA
    return Checked(read, {**schema, "description": f"a constant{' in ' + unit if unit != '1' else ''}"})


def read_constant(raw: object, known: Declarations, unit: str, *, size: int = 0, within: Range = ANY) -> Expression:
    """Read a constant, as `constant_in` says."""
    known = known.constant()
    if not size:
        return _scalar(raw, known, unit, within)
    if isinstance(raw, str):
        found = read_expression(raw, known, unit=unit, sizes=(size,))
        for value in values_of(found) or ():
            within.check(value, f"{value:g}")
        return found
    if not isinstance(raw, list) or len(raw) != size:
        count = f"{len(raw)} entries" if isinstance(raw, list) else "no list"
        refuse(Problem(f"{count} where a list of {SIZES[size]} was expected"))
    entries = read_all(enumerate(raw), lambda _, each: _scalar(each, known, unit, within))
    return _vector(tuple(entries.values()), unit)


def values_of(expression: Expression) -> tuple[float, ...] | None:
    """Give the numbers that an expression is, entry by entry; None where parameters are in it."""
    if not expression.kind.known or not expression.names <= set(CONSTANTS):
        return None
    tree = expression.tree
    entries = tree.entries if isinstance(tree, Vector) else (tree,)
    try:
        return tuple(constant(each) for each in entries)
    except ExpressionError as error:
        refuse(*error.problems)


def value_of(expression: Expression) -> float | None:
    """Give the number that a scalar expression is; None where parameters are in it."""
    values = values_of(expression)
    return None if values is None else values[0]


def _scalar(raw: object, known: Declarations, unit: str, within: Range) -> Expression:
    if isinstance(raw, str) and _QUANTITY.match(raw):
        if (sum_ := _TERMS.search(raw)) is not None:
            message = "a quantity with a unit stands alone here; in an expression, numbers count in SI"
            refuse(Problem(message, sum_.start()))
        quantity = read_quantity(raw, example=f"5 {unit}" if unit != "1" else "5")
        value = expect_dimension(quantity, parse_unit(unit).dimension)
        found = Expression(quantity.text, parse_entry(value), Kind(quantity.dimension), Extent(1, 1))
    else:
        found = read_expression(raw, known, unit=unit)
    number = value_of(found)
    if number is not None:
        within.check(number, found.text)
    return found


def _vector(entries: tuple[Expression, ...], unit: str) -> Expression:
    literal, known = all(each.kind.literal for each in entries), all(each.kind.known for each in entries)
    kind = Kind(parse_unit(unit).dimension, len(entries), literal=literal, known=known)
    nodes, depth = sum(each.extent.nodes for each in entries), max(each.extent.depth for each in entries)
    text = f"[{', '.join(each.text for each in entries)}]"
    return Expression(text, Vector(tuple(each.tree for each in entries), 0), kind, Extent(1 + nodes, 1 + depth))
