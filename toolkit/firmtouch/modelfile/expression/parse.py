"""Text -> tree, by recursive descent over a fixed grammar.

    sum     = product { ("+" | "-") product }
    product = factor { ("*" | "/") factor }
    factor  = ("+" | "-") factor | power
    power   = atom [ "**" factor ]
    atom    = number | name | name "(" sum { "," sum } ")" | "(" sum ")" | "[" sum { "," sum } "]"

Nothing else exists: no attributes, no indexing, no strings, no keywords. Length and nesting are bounded, so hostile
text costs no more than an honest one.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

from firmtouch.modelfile.expression.functions import FUNCTIONS, ROUGH
from firmtouch.modelfile.expression.problem import ExpressionError, Problem
from firmtouch.modelfile.expression.tree import Call, Name, Node, Number, Power, Product, Rate, Sum, Vector
from firmtouch.modelfile.words import shown

LONGEST: Final = 4000
DEEPEST: Final = 40

_TOKEN: Final = re.compile(
    r"(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*)"
    r"|(?P<symbol>\*\*|[-+*/(),\[\]])"
)
_SPACE: Final = re.compile(r"\s*")


@dataclass(frozen=True, slots=True)
class Token:
    """A number, a name, a symbol, or the end of the text."""

    sort: str
    text: str
    at: int


@lru_cache(maxsize=256)
def parse(text: str) -> Node:
    """Parse an expression; the last ones are remembered, since definitions are read twice.

    Raises
    ------
    ExpressionError
        With the offset of the first mistake in `text`.
    """
    if len(text) > LONGEST:
        message = f"an expression of {len(text)} characters; at most {LONGEST} are read: split it with `definitions`"
        raise ExpressionError(Problem(message))
    return _Parser(_tokens(text)).whole()


def _tokens(text: str) -> tuple[Token, ...]:
    tokens: list[Token] = []
    at = _SPACE.match(text).end()  # type: ignore[union-attr]  # the pattern matches the empty string too
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise ExpressionError(Problem(f"{shown(text[at])} has no meaning in an expression{_hint(text[at:])}", at))
        tokens.append(Token(str(match.lastgroup), match.group(), at))
        at = _SPACE.match(text, match.end()).end()  # type: ignore[union-attr]  # as above
    tokens.append(Token("end", "", len(text)))
    return tuple(tokens)


def _hint(rest: str) -> str:
    if rest.startswith("^"):
        return "; powers are written `**`"
    if rest.startswith("."):
        return "; there are no attributes here, a component is written `x(p)`, `y(p)` or `z(p)`"
    if rest.startswith("'"):
        return "; the time derivative of a coordinate is written `dot(q1)`"
    return "; numbers, declared names, + - * / ** ( ) [ , ] and the listed functions have"


class _Parser:
    """A cursor over the tokens; each method reads one rule of the grammar."""

    def __init__(self, tokens: tuple[Token, ...]) -> None:
        self._tokens = tokens
        self._at = 0
        self._depth = 0

    @property
    def _next(self) -> Token:
        return self._tokens[self._at]

    def _take(self) -> Token:
        token = self._next
        self._at += token.sort != "end"
        return token

    def _accept(self, *symbols: str) -> Token | None:
        return self._take() if self._next.sort == "symbol" and self._next.text in symbols else None

    def _expect(self, symbol: str) -> None:
        if self._accept(symbol) is None:
            raise ExpressionError(self._surprise(f"`{symbol}` was expected"))

    def _surprise(self, expected: str) -> Problem:
        token = self._next
        found = "the expression ends" if token.sort == "end" else f"unexpected {shown(token.text)}"
        return Problem(f"{found} where {expected}", token.at)

    def whole(self) -> Node:
        if self._next.sort == "end":
            raise ExpressionError(Problem("an empty expression; write a formula, for example `l1*cos(q1)`"))
        node = self._sum()
        if self._next.sort != "end":
            raise ExpressionError(self._surprise("an operator or the end was expected"))
        return node

    def _sum(self) -> Node:
        at = self._next.at
        terms = [(False, self._product())]
        while (sign := self._accept("+", "-")) is not None:
            terms.append((sign.text == "-", self._product()))
        return terms[0][1] if len(terms) == 1 else Sum(tuple(terms), at)

    def _product(self) -> Node:
        at = self._next.at
        factors = [(False, self._factor())]
        while (sign := self._accept("*", "/")) is not None:
            factors.append((sign.text == "/", self._factor()))
        return factors[0][1] if len(factors) == 1 else Product(tuple(factors), at)

    def _factor(self) -> Node:
        self._depth += 1
        if self._depth > DEEPEST:
            raise ExpressionError(Problem(f"nested more than {DEEPEST} deep; use `definitions`", self._next.at))
        sign = self._accept("+", "-")
        node = self._power() if sign is None else Sum(((sign.text == "-", self._factor()),), sign.at)
        self._depth -= 1
        return node

    def _power(self) -> Node:
        base = self._atom()
        if (sign := self._accept("**")) is None:
            return base
        return Power(base, self._factor(), sign.at)

    def _atom(self) -> Node:
        token = self._next
        if token.sort == "number":
            return self._number(self._take())
        if token.sort == "name":
            self._take()
            return self._call(token) if self._accept("(") else Name(token.text, token.at)
        if self._accept("("):
            node = self._sum()
            self._expect(")")
            return node
        if self._accept("["):
            return Vector(self._arguments("]"), token.at)
        raise ExpressionError(self._surprise("a number, a name or a bracket was expected"))

    def _number(self, token: Token) -> Number:
        value = float(token.text)
        vanished = value == 0 and re.search("[1-9]", re.split("[eE]", token.text)[0]) is not None
        if vanished or not math.isfinite(value):
            raise ExpressionError(Problem(f"{shown(token.text)} is beyond the range of a double", token.at))
        return Number(token.text, token.at)

    def _arguments(self, closing: str) -> tuple[Node, ...]:
        arguments = [self._sum()]
        while self._accept(","):
            arguments.append(self._sum())
        self._expect(closing)
        return tuple(arguments)

    def _call(self, name: Token) -> Node:
        if name.text != "dot" and name.text not in FUNCTIONS:
            raise ExpressionError(_no_function(name))
        arguments = self._arguments(")")
        if name.text == "dot":
            if len(arguments) != 1 or not isinstance(arguments[0], Name):
                raise ExpressionError(Problem("`dot` takes the name of one coordinate, as in `dot(q1)`", name.at))
            return Rate(arguments[0].name, name.at)
        wanted = FUNCTIONS[name.text]
        if len(arguments) != wanted:
            plural = "" if wanted == 1 else "s"
            message = f"`{name.text}` takes {wanted} argument{plural}, not {len(arguments)}"
            raise ExpressionError(Problem(message, name.at))
        return Call(name.text, arguments, name.at)


def _no_function(name: Token) -> Problem:
    if name.text.lower() in ROUGH:
        message = f"`{name.text}` has no second derivative everywhere, and energies and constraints must have two"
        return Problem(message, name.at)
    known = (*FUNCTIONS, "dot")
    message = f"there is no function {shown(name.text)}; those that exist: {', '.join(known)}"
    return Problem(message, name.at, near=(name.text, known))
