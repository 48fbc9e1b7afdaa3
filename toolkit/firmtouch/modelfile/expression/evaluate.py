"""Reading a tree with an arithmetic: floats, CasADi symbols, SymPy symbols, intervals."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from typing import Any

from firmtouch.modelfile.expression.tree import Call, Name, Node, Number, Power, Product, Rate, Sum, Vector

Value = Any
"""A scalar of the chosen arithmetic, or a tuple of them for a vector."""


def evaluate(
    node: Node,
    *,
    names: Mapping[str, Value],
    rates: Mapping[str, Value],
    number: Callable[[str], Value],
    functions: Mapping[str, Callable[..., Value]],
    power: Callable[[Value, Value], Value] = operator.pow,
) -> Value:
    """Evaluate a checked tree.

    `names` and `rates` give the values of names and of `dot(name)`, `number` reads a decimal, and `functions` has
    one callable for each name in `functions.SCALAR`. Vectors are tuples; their functions need only `+`, `*` and
    `sqrt`.
    """

    def read(here: Node) -> Value:
        match here:
            case Number(text=text):
                return number(text)
            case Name(name=name):
                return names[name]
            case Rate(name=name):
                return rates[name]
            case Vector(entries=entries):
                return tuple(read(each) for each in entries)
            case Sum(terms=terms):
                return _sum([(minus, read(each)) for minus, each in terms])
            case Product(factors=factors):
                return _product([(divides, read(each)) for divides, each in factors])
            case Power(base=base, exponent=exponent):
                return power(read(base), read(exponent))
            case Call(function=name, arguments=arguments):
                return _call(name, [read(each) for each in arguments], functions)

    return read(node)


def _sum(terms: list[tuple[bool, Value]]) -> Value:
    signed = [_scaled(value, -1) if minus else value for minus, value in terms]
    total = signed[0]
    for each in signed[1:]:
        total = tuple(a + b for a, b in zip(total, each, strict=True)) if isinstance(total, tuple) else total + each
    return total


def _product(factors: list[tuple[bool, Value]]) -> Value:
    total = factors[0][1]
    for divides, value in factors[1:]:
        if isinstance(total, tuple):
            total = tuple(each / value if divides else each * value for each in total)
        elif isinstance(value, tuple):
            total = _scaled(value, total)
        else:
            total = total / value if divides else total * value
    return total


def _scaled(value: Value, factor: Value) -> Value:
    return tuple(factor * each for each in value) if isinstance(value, tuple) else factor * value


def _inner(a: Value, b: Value) -> Value:
    products = [p * q for p, q in zip(a, b, strict=True)]
    return sum(products[1:], products[0])


def _call(name: str, arguments: list[Value], functions: Mapping[str, Callable[..., Value]]) -> Value:
    match name:
        case "x" | "y" | "z":
            return arguments[0]["xyz".index(name)]
        case "inner":
            return _inner(*arguments)
        case "norm":
            return functions["sqrt"](_inner(arguments[0], arguments[0]))
        case "cross":
            a, b = arguments
            if len(a) == 2:
                return a[0] * b[1] - a[1] * b[0]
            return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
        case _:
            return functions[name](*arguments)
