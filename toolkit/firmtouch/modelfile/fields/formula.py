"""Expressions, with the dimension and the size that a field expects."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from pydantic import ValidationInfo

from firmtouch.modelfile.declarations import Declarations, Extent, parse_entry
from firmtouch.modelfile.expression import ExpressionError, Kind, Node, Problem, names_in
from firmtouch.modelfile.fields.checked import Checked, declared, read_all, refuse
from firmtouch.modelfile.units import parse_unit


@dataclass(frozen=True, slots=True)
class Expression:
    """A checked expression: what was written, its tree, its dimension and size.

    `extent` is that of the tree with its definitions written out.
    """

    text: str
    tree: Node
    kind: Kind
    extent: Extent

    @property
    def size(self) -> int:
        """How many entries it has; 0 is a scalar."""
        return self.kind.size

    @property
    def names(self) -> frozenset[str]:
        """The names that it uses directly."""
        return names_in(self.tree)


EXPRESSION_SCHEMA: Final[dict[str, Any]] = {"anyOf": [{"type": "string"}, {"type": "number"}]}


def expression_in(
    unit: str | None, *, sizes: tuple[int, ...] = (0,), velocities: bool = False, constant: bool = False
) -> Checked:
    """Make the type of an expression with a unit (`None`: any) and a size out of `sizes` (0: a scalar).

    A `constant` one may use parameters alone.
    """

    def read(raw: object, info: ValidationInfo) -> Expression:
        known = declared(info).constant() if constant else declared(info)
        return read_expression(raw, known, unit=unit, sizes=sizes, velocities=velocities)

    vectors = {"type": "array", "items": EXPRESSION_SCHEMA, "minItems": 2, "maxItems": 3}
    choices = [*EXPRESSION_SCHEMA["anyOf"], vectors] if max(sizes) else EXPRESSION_SCHEMA["anyOf"]
    return Checked(read, {"anyOf": choices, "description": f"an expression{f' in {unit}' if unit else ''}"})


def read_expression(
    raw: object,
    known: Declarations,
    *,
    unit: str | None = None,
    sizes: tuple[int, ...] = (0,),
    velocities: bool = False,
) -> Expression:
    """Read an expression, and hold its unit and its size against what is wanted."""
    if isinstance(raw, list):
        read_all(enumerate(raw), lambda _, each: read_expression(each, known, velocities=velocities))
    try:
        tree = parse_entry(raw)
        kind, extent = known.check(tree, velocities=velocities)
    except ExpressionError as error:
        refuse(*error.problems)
    if kind.known and kind.size not in sizes:
        refuse(Problem(f"{_sized(kind.size)} was given where {' or '.join(map(_sized, sizes))} was expected"))
    if unit is not None and not kind.fits(parse_unit(unit).dimension):
        wanted = "a plain number or an angle" if unit == "1" else parse_unit(unit).dimension
        refuse(Problem(f"this is {kind.dimension.in_words()}, but {wanted} was expected"))
    text = raw if isinstance(raw, str) else str(raw).replace("'", "")
    return Expression(" ".join(text.split()), tree, kind, extent)


def _sized(size: int) -> str:
    return f"a vector of {size}" if size else "a scalar"
