"""The tree of an expression: eight kinds of node, each of which knows where in the text it begins.

Sums and products are flat, so that a long sum is no deep tree: the depth of a tree is bounded by the nesting of
brackets, which `parse` bounds.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Number:
    """A decimal number, kept as it was written."""

    text: str
    at: int


@dataclass(frozen=True, slots=True)
class Name:
    """A parameter, a coordinate, a definition or a constant."""

    name: str
    at: int


@dataclass(frozen=True, slots=True)
class Rate:
    """The time derivative of a coordinate, written `dot(q1)`."""

    name: str
    at: int


@dataclass(frozen=True, slots=True)
class Sum:
    """Terms, each with whether it is subtracted. A leading minus is a sum of one term."""

    terms: tuple[tuple[bool, Node], ...]
    at: int


@dataclass(frozen=True, slots=True)
class Product:
    """Factors, each with whether it divides, from left to right."""

    factors: tuple[tuple[bool, Node], ...]
    at: int


@dataclass(frozen=True, slots=True)
class Power:
    """`base ** exponent`."""

    base: Node
    exponent: Node
    at: int


@dataclass(frozen=True, slots=True)
class Call:
    """A listed function of its arguments."""

    function: str
    arguments: tuple[Node, ...]
    at: int


@dataclass(frozen=True, slots=True)
class Vector:
    """A vector in the plane or in space, written `[a, b]`."""

    entries: tuple[Node, ...]
    at: int


Node = Number | Name | Rate | Sum | Product | Power | Call | Vector


def children(node: Node) -> tuple[Node, ...]:
    """List the nodes directly below a node."""
    match node:
        case Sum(terms=pairs) | Product(factors=pairs):
            return tuple(child for _, child in pairs)
        case Power(base=base, exponent=exponent):
            return (base, exponent)
        case Call(arguments=below) | Vector(entries=below):
            return below
        case Number() | Name() | Rate():
            return ()


def walk(node: Node) -> Iterator[Node]:
    """Visit a node and all below it, in the order of the text."""
    stack = [node]
    while stack:
        here = stack.pop()
        yield here
        stack.extend(reversed(children(here)))


def names_in(node: Node) -> frozenset[str]:
    """Collect the names that an expression uses, those under `dot` included."""
    return frozenset(each.name for each in walk(node) if isinstance(each, Name | Rate))


def size(node: Node) -> int:
    """Count the nodes of a tree."""
    return sum(1 for _ in walk(node))
