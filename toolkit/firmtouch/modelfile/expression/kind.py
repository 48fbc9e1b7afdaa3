"""What an expression is: its physical dimension and its size, found without evaluating it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from types import MappingProxyType
from typing import Final, NoReturn, TypeGuard

from firmtouch.modelfile.expression.evaluate import evaluate
from firmtouch.modelfile.expression.functions import CONSTANTS, SCALAR
from firmtouch.modelfile.expression.problem import ExpressionError, Problem
from firmtouch.modelfile.expression.tree import (
    Call,
    Name,
    Node,
    Number,
    Power,
    Product,
    Rate,
    Sum,
    Vector,
    children,
    walk,
)
from firmtouch.modelfile.units import DIMENSIONLESS, Dimension
from firmtouch.modelfile.words import shown

LARGEST_EXPONENT = 32
MOST_UNDECLARED = 10
"""So many undeclared names of one expression are reported; there is no use in more."""
NOTHING: Final[Mapping[str, str]] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Kind:
    """The dimension and the number of entries of a value (`size` 0 is a scalar).

    A `literal` is a constant made of numbers alone: in a sum it takes the dimension of its neighbours and counts
    in SI units, so that `x(tip) - 1.2` needs no declared parameter. An unknown kind (`known` is false) belongs to
    a name whose declaration is itself wrong; it agrees with everything, so that one mistake is reported once.
    """

    dimension: Dimension = DIMENSIONLESS
    size: int = 0
    literal: bool = False
    known: bool = True

    def agrees(self, other: Kind) -> bool:
        """Tell whether two values may be added."""
        if not (self.known and other.known):
            return True
        loose = self.literal or other.literal
        return self.size == other.size and (loose or self.dimension == other.dimension)

    def fits(self, dimension: Dimension) -> bool:
        """Tell whether it can stand where a dimension is asked for: a literal counts in SI."""
        return not self.known or self.literal or self.dimension == dimension

    def __str__(self) -> str:
        """Name the kind in a message."""
        unit = "a number" if self.dimension == DIMENSIONLESS else str(self.dimension)
        return unit if self.size == 0 else f"a vector of {self.size} in {unit}"


UNKNOWN = Kind(known=False)
LITERAL = Kind(literal=True)


def kind_of(
    node: Node, *, names: Mapping[str, Kind], rates: Mapping[str, Kind], hidden: Mapping[str, str] = NOTHING
) -> Kind:
    """Find the kind of an expression; `hidden` are names that exist and cannot be used here, each with the reason.

    Raises
    ------
    ExpressionError
        With the undeclared names, or else with the first place where dimensions or sizes disagree.
    """
    declared = {**names, **dict.fromkeys(CONSTANTS, LITERAL)}
    missing = {(type(each), each.name): each for each in reversed(list(walk(node))) if _missing(each, declared, rates)}
    if missing:
        first = sorted(missing.values(), key=lambda each: each.at)[:MOST_UNDECLARED]
        raise ExpressionError(*(_undeclared(each, declared, rates, hidden) for each in first))
    kind = _Reader(declared, rates).read(node)
    if _check_constants(node):
        constant(node)
    return kind


def constant(node: Node) -> float:
    """Evaluate a literal, which must be finite; of a vector, give the first entry."""
    functions = {name: getattr(math, name) for name in SCALAR}
    try:
        value = evaluate(node, names=CONSTANTS, rates={}, number=float, functions=functions, power=math.pow)
    except (OverflowError, ZeroDivisionError, ValueError) as error:
        raise ExpressionError(Problem(f"a constant that is no finite number ({error})", node.at)) from error
    entries = value if isinstance(value, tuple) else (value,)
    if not all(math.isfinite(each) for each in entries):
        raise ExpressionError(Problem("a constant that is no finite number", node.at))
    return float(entries[0])


def _check_constants(node: Node) -> bool:
    """Tell whether a tree is made of numbers alone; where it is not, hold the largest such parts to be finite."""
    if isinstance(node, Name | Rate):
        return isinstance(node, Name) and node.name in CONSTANTS
    below = [(each, _check_constants(each)) for each in children(node)]
    if all(numeric for _, numeric in below):
        return True
    for each, numeric in below:
        if numeric:
            constant(each)
    return False


def _missing(node: Node, names: Mapping[str, Kind], rates: Mapping[str, Kind]) -> TypeGuard[Name | Rate]:
    return (isinstance(node, Name) and node.name not in names) or (isinstance(node, Rate) and node.name not in rates)


def _undeclared(
    node: Name | Rate, names: Mapping[str, Kind], rates: Mapping[str, Kind], hidden: Mapping[str, str]
) -> Problem:
    if isinstance(node, Rate) and not rates:
        return Problem("velocities are not allowed here: this expression depends on the configuration alone", node.at)
    if isinstance(node, Rate):
        return Problem(f"{shown(node.name)} is no coordinate", node.at, near=(node.name, tuple(rates)))
    if node.name in hidden:
        return Problem(f"`{node.name}` cannot be used here: {hidden[node.name]}", node.at)
    return Problem(f"{shown(node.name)} is not declared", node.at, near=(node.name, tuple(names)))


class _Reader:
    """One reading of a tree; each method finds the kind of one sort of node."""

    def __init__(self, names: Mapping[str, Kind], rates: Mapping[str, Kind]) -> None:
        self._names = names
        self._rates = rates

    def read(self, node: Node) -> Kind:
        match node:
            case Number():
                return LITERAL
            case Name(name=name):
                return self._names[name]
            case Rate(name=name):
                return self._rates[name]
            case Vector():
                return self._vector(node)
            case Sum(terms=terms):
                nodes = tuple(each for _, each in terms)
                return _alike(nodes, [self.read(each) for each in nodes], "added")
            case Product():
                return self._product(node)
            case Power():
                return self._power(node)
            case Call():
                return self._call(node)

    def _vector(self, node: Vector) -> Kind:
        if len(node.entries) not in (2, 3):
            _refuse(node, f"a vector of {len(node.entries)}; vectors here have 2 or 3 entries")
        kind = _alike(node.entries, [self.read(each) for each in node.entries], "joined")
        if kind.known and kind.size:
            _refuse(node, "a vector inside a vector")
        return replace(kind, size=len(node.entries))

    def _product(self, node: Product) -> Kind:
        dimension, size, literal, known = DIMENSIONLESS, 0, True, True
        for divides, factor in node.factors:
            kind = self.read(factor)
            if kind.size and divides:
                _refuse(factor, "a division by a vector")
            if kind.literal and divides and constant(factor) == 0:
                _refuse(factor, "a division by zero")
            if kind.size and size:
                _refuse(factor, "a product of two vectors; use `inner` or `cross`")
            dimension = dimension / kind.dimension if divides else dimension * kind.dimension
            size, literal, known = size or kind.size, literal and kind.literal, known and kind.known
        return Kind(dimension, size, literal, known)

    def _power(self, node: Power) -> Kind:
        base, exponent = self.read(node.base), self.read(node.exponent)
        if base.size or exponent.size:
            _refuse(node, "a power of a vector; use `inner` or `norm`")
        if exponent.known and exponent.dimension != DIMENSIONLESS:
            _refuse(node.exponent, f"an exponent in {exponent.dimension}; exponents are plain numbers")
        if exponent.literal:
            value = constant(node.exponent)
            if abs(value) > LARGEST_EXPONENT:
                _refuse(node.exponent, f"an exponent of {value:.4g}; at most {LARGEST_EXPONENT} in size is read")
            rational = Fraction(value).limit_denominator(64)
            return Kind(base.dimension**rational, 0, base.literal, base.known)
        if exponent.known and base.known and base.dimension != DIMENSIONLESS:
            _refuse(node.exponent, f"the base is in {base.dimension}, so its exponent must be a constant number")
        return Kind(known=base.known and exponent.known)

    def _call(self, node: Call) -> Kind:
        kinds = [self.read(each) for each in node.arguments]
        literal = all(kind.literal for kind in kinds)
        if not all(kind.known for kind in kinds):
            return UNKNOWN
        match node.function:
            case "x" | "y" | "z":
                if kinds[0].size <= "xyz".index(node.function):
                    _refuse(node, f"`{node.function}` takes a component of a vector; this is {kinds[0]}")
                return replace(kinds[0], size=0)
            case "norm" | "inner" | "cross":
                return self._vector_call(node, kinds)
            case "sqrt":
                self._scalar(node, kinds)
                return Kind(kinds[0].dimension ** Fraction(1, 2), 0, literal)
            case "atan2":
                self._scalar(node, kinds)
                _alike(node.arguments, kinds, "compared")
                return Kind(literal=literal)
            case _:
                self._scalar(node, kinds)
                if kinds[0].dimension != DIMENSIONLESS:
                    _refuse(node.arguments[0], f"`{node.function}` of {kinds[0]}; it takes a plain number or an angle")
                return Kind(literal=literal)

    def _vector_call(self, node: Call, kinds: list[Kind]) -> Kind:
        size = kinds[0].size
        if size == 0 or any(kind.size != size for kind in kinds):
            _refuse(node, f"`{node.function}` takes vectors of one size, not {' and '.join(map(str, kinds))}")
        if node.function == "norm":
            return replace(kinds[0], size=0)
        product = kinds[0].dimension * kinds[1].dimension
        in_space = node.function == "cross" and size == 3
        return Kind(product, 3 if in_space else 0, all(kind.literal for kind in kinds))

    @staticmethod
    def _scalar(node: Call, kinds: list[Kind]) -> None:
        if any(kind.size for kind in kinds):
            _refuse(node, f"`{node.function}` takes a scalar, not a vector")


def _alike(nodes: tuple[Node, ...], kinds: list[Kind], verb: str) -> Kind:
    """Give the kind that values have in common: that of those which are no literals."""
    total = kinds[0]
    for node, kind in zip(nodes[1:], kinds[1:], strict=True):
        if not total.agrees(kind):
            _refuse(node, f"{kind} is {verb} to {total}")
        if not kind.literal and (total.literal or not total.known):
            total = kind
    return total


def _refuse(node: Node, message: str) -> NoReturn:
    raise ExpressionError(Problem(message, node.at))
