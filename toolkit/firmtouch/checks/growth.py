"""How large derivatives grow when they are written out: SymPy shares nothing that it writes twice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.expression import Call, Name, Node, Number, Power, Product, Rate, Sum, Vector
from firmtouch.modelfile.expression.tree import children
from firmtouch.modelfile.sections.section import expressions_in


@dataclass(frozen=True, slots=True)
class Size:
    """Nodes of an expression, and of its first and second derivative by one variable."""

    value: int
    first: int = 0
    second: int = 0


def second_derivatives(spec: ModelSpec) -> int:
    """Add up the second derivatives of a mechanism and its constraints, each by one variable."""
    known = {name: Size(1, 1) for name in spec.coordinates}
    for name, expression in spec.definitions.items():
        known[name] = size_of(expression.tree, known)
    return sum(size_of(each.tree, known).second for each in expressions_in((spec.mechanism, spec.entries)))


def size_of(node: Node, known: Mapping[str, Size]) -> Size:
    """Measure an expression; names that are not known are constants."""
    match node:
        case Number():
            return Size(1)
        case Name(name=name):
            return known.get(name, Size(1))
        case Rate():
            return Size(1, 1)
        case Sum() | Vector():
            parts = [size_of(each, known) for each in children(node)]
            return Size(_written(parts), sum(each.first for each in parts), sum(each.second for each in parts))
        case Product(factors=factors):
            sizes = [(divides, size_of(each, known)) for divides, each in factors]
            return _product([_function([size]) if divides else size for divides, size in sizes])
        case Power() | Call():
            return _function([size_of(each, known) for each in children(node)])


def _written(parts: list[Size]) -> int:
    return 1 + sum(each.value for each in parts)


def _product(parts: list[Size]) -> Size:
    """Replace each of k factors in turn by its derivative, and then each of the others by its own."""
    written, moving = _written(parts), [each for each in parts if each.first]
    k, first, seconds = len(moving), sum(each.first for each in moving), [each.second for each in moving if each.second]
    pairs = k * (k - 1) * written + 2 * (k - 1) * first
    return Size(written, first + k * written, sum(seconds) + len(seconds) * written + pairs)


def _function(parts: list[Size]) -> Size:
    """Differentiate by the chain rule; the outer derivatives are about as large as the function."""
    written, moving = _written(parts), [each for each in parts if each.first]
    k, first, seconds = len(moving), sum(each.first for each in moving), [each.second for each in moving if each.second]
    pairs = k * k * written + 2 * k * first
    return Size(written, first + k * written, sum(seconds) + len(seconds) * written + pairs)
