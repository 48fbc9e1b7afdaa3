"""Matrices of expansions: C + sum A_k e_k + sum_{i<=j} Q_ij e_i e_j + R, with |e_k| <= 1 and R of balls around zero."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

from flint import arb, arb_mat

from firmtouch.certificate.attraction.expansion import Expansion
from firmtouch.certificate.matrices import BallMatrix, identity
from firmtouch.mechanics.balls import Ball

HALF: Final = arb(1) / 2


@dataclass(frozen=True, slots=True)
class Weights:
    """Bounds on the means of e_k, and of e_i e_j, over a segment; `first` symbols have them, the others are free."""

    first: int
    linear: float
    quadratic: float


@dataclass(frozen=True, slots=True)
class Form:
    """The Q_ij are in the order of `pairs`; `near` is sum A_k e_k, and `far` what is left but for C, over all e."""

    C: BallMatrix
    A: tuple[BallMatrix, ...]
    Q: tuple[BallMatrix, ...]
    R: BallMatrix
    near: BallMatrix
    far: BallMatrix

    @staticmethod
    def of(C: BallMatrix, A: Sequence[BallMatrix], Q: Sequence[BallMatrix], R: BallMatrix) -> Form:
        """Put a form together."""
        return Form(C, tuple(A), tuple(Q), R, _linear(A, 0, 1.0, C), _quadratic(Q, len(A), None) + R)

    @property
    def whole(self) -> BallMatrix:
        """Give all its values."""
        return self.C + self.near + self.far

    def without(self, first: int) -> BallMatrix:
        """Enclose it where all but the `first` symbols are zero."""
        kept = [each for (i, j), each in zip(pairs(len(self.A)), self.Q, strict=True) if j < first]
        quadratic = _quadratic(kept, first, None) if kept else self.C * 0
        return self.C + _linear(self.A[:first], 0, 1.0, self.C) + quadratic + self.R

    def mean(self, weights: Weights) -> BallMatrix:
        """Enclose its means over segments."""
        linear = _linear(self.A, weights.first, weights.linear, self.C)
        return self.C + linear + _quadratic(self.Q, len(self.A), weights) + self.R

    def __add__(self, other: Form) -> Form:
        """Add; both depend on the same e."""
        return self._with(other, lambda a, b: a + b)

    def __sub__(self, other: Form) -> Form:
        """Subtract."""
        return self._with(other, lambda a, b: a - b)

    def _with(self, other: Form, sum_of: Callable[[BallMatrix, BallMatrix], BallMatrix]) -> Form:
        A = [sum_of(a, b) for a, b in zip(self.A, other.A, strict=True)]
        Q = [sum_of(a, b) for a, b in zip(self.Q, other.Q, strict=True)]
        return Form.of(sum_of(self.C, other.C), A, Q, sum_of(self.R, other.R))

    def __mul__(self, other: Form) -> Form:
        """Multiply matrices."""
        return _product(self, other, lambda a, b: a * b)

    def scaled(self, column: Form, j: int) -> Form:
        """Multiply by the j-th entry of a column."""
        return _product(self, column, lambda a, b: a * b[j, 0])

    def each(self, turn: Callable[[BallMatrix], BallMatrix]) -> Form:
        """Apply a linear map that depends on nothing."""
        A, Q = tuple(map(turn, self.A)), tuple(map(turn, self.Q))
        return Form(turn(self.C), A, Q, turn(self.R), turn(self.near), turn(self.far))

    def times(self, factor: Ball) -> Form:
        """Multiply by a number that depends on nothing."""
        return self.each(lambda X: X * factor)

    def by(self, right: BallMatrix) -> Form:
        """Multiply by a matrix that depends on nothing, from the right."""
        return self.each(lambda X: X * right)

    def after(self, left: BallMatrix) -> Form:
        """Multiply by a matrix that depends on nothing, from the left."""
        return self.each(lambda X: left * X)

    def turned(self) -> Form:
        """Transpose."""
        return self.each(lambda X: X.transpose())

    def inverse(self) -> Form:
        """Invert: with X = C (I + P), X^-1 = (I - P + P^2 - P^3 (I + P)^-1) C^-1.

        Raises
        ------
        ZeroDivisionError
            If a matrix in it may be singular.
        """
        inverse, one = self.C.inv(), identity(self.C.nrows())
        P = (self - fixed(self.C, len(self.A))).after(inverse)
        ball = P.whole
        third = ball * ball * ball * (one + ball).inv()
        series = fixed(one, len(self.A)) - P + P * P
        return Form.of(series.C, series.A, series.Q, series.R - third).by(inverse)


def pairs(symbols: int) -> list[tuple[int, int]]:
    """List (i, j), i <= j."""
    return list(itertools.combinations_with_replacement(range(symbols), 2))


def _product(x: Form, y: Form, product: Callable[[BallMatrix, BallMatrix], BallMatrix]) -> Form:
    A = [product(a, y.C) + product(x.C, b) for a, b in zip(x.A, y.A, strict=True)]
    Q = []
    for (i, j), a, b in zip(pairs(len(A)), x.Q, y.Q, strict=True):
        both = product(x.A[i], y.A[j])
        if i != j:
            both += product(x.A[j], y.A[i])
        Q.append(product(a, y.C) + product(x.C, b) + both)
    R = product(x.R, y.C) + product(x.C, y.R) + product(x.near, y.far) + product(x.far, y.near + y.far)
    return Form.of(product(x.C, y.C), A, Q, R)


def _linear(A: Sequence[BallMatrix], first: int, size: float, like: BallMatrix) -> BallMatrix:
    total = like * 0
    for k, each in enumerate(A):
        total += each * arb(0, size if k < first else 1)
    return total


def _quadratic(Q: Sequence[BallMatrix], symbols: int, weights: Weights | None) -> BallMatrix:
    """Enclose sum Q_ij e_i e_j or its mean; a square is not negative."""
    total = Q[0] * 0
    for (i, j), each in zip(pairs(symbols), Q, strict=True):
        size = _size(i, j, weights)
        total += each * (arb(size / 2, size / 2) if i == j else arb(0, size))
    return total


def _size(i: int, j: int, weights: Weights | None) -> float:
    if weights is None or i >= weights.first:
        return 1.0
    return weights.quadratic if j < weights.first else weights.linear


def arrange(entries: Sequence[Expansion], rows: int, columns: int, symbols: int) -> Form:
    """Arrange expansions that are counted by columns, as CasADi counts."""
    order = pairs(symbols)
    none, nothing = [arb(0)] * symbols, [arb(0)] * len(order)
    slopes = [none if each.a is None else each.a.entries() for each in entries]
    bends = [nothing if each.Q is None else _upper(each.Q.tolist(), order) for each in entries]

    def matrix(values: Sequence[arb]) -> BallMatrix:
        return arb_mat(rows, columns, [values[i + rows * j] for i in range(rows) for j in range(columns)])

    A = [matrix([each[k] for each in slopes]) for k in range(symbols)]
    Q = [matrix([each[k] for each in bends]) for k in range(len(order))]
    return Form.of(matrix([each.c for each in entries]), A, Q, matrix([each.r for each in entries]))


def _upper(Q: list[list[Ball]], order: list[tuple[int, int]]) -> list[Ball]:
    return [Q[i][j] if i == j else Q[i][j] + Q[j][i] for i, j in order]


def fixed(C: BallMatrix, symbols: int) -> Form:
    """Give a form that depends on nothing."""
    zero = C * 0
    return Form(C, (zero,) * symbols, (zero,) * len(pairs(symbols)), zero, zero, zero)
