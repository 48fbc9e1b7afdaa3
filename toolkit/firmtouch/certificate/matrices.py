"""Matrices of balls: exact from floats, put together from blocks, and proven positive definite."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

import numpy as np
from flint import arb, arb_mat
from numpy.typing import ArrayLike

from firmtouch.mechanics.balls import Ball

BallMatrix = Any
"""A python-flint `arb_mat`; the library has no types."""


def exact(values: ArrayLike) -> BallMatrix:
    """Take binary64 numbers as they are; a vector becomes a column."""
    array = np.asarray(values, dtype=np.float64)
    if array.ndim == 1:
        array = array[:, None]
    return arb_mat(array.shape[0], array.shape[1], [arb(each) for each in array.ravel().tolist()])


def by_columns(entries: Sequence[Ball], rows: int, columns: int) -> BallMatrix:
    """Arrange entries that are counted by columns, as CasADi counts."""
    return arb_mat(rows, columns, [entries[i + rows * j] for i in range(rows) for j in range(columns)])


def identity(n: int) -> BallMatrix:
    """Give I."""
    return arb_mat(n, n, [arb(int(i == j)) for i in range(n) for j in range(n)])


def diagonal(values: Sequence[Ball | float]) -> BallMatrix:
    """Give a diagonal matrix."""
    n = len(values)
    return arb_mat(n, n, [arb(values[i]) if i == j else arb(0) for i in range(n) for j in range(n)])


def symmetrised(X: BallMatrix) -> BallMatrix:
    """Give (X + X^T) / 2: of a matrix that is symmetric, as the enclosures of its halves need not be."""
    return (X + X.transpose()) / 2


def blocks(rows: Sequence[Sequence[BallMatrix]]) -> BallMatrix:
    """Put a matrix together from blocks."""
    lines = [
        [entry for block in lines for entry in block]
        for row in rows
        for lines in zip(*(each.tolist() for each in row), strict=True)
    ]
    return arb_mat(lines)


def kronecker(A: BallMatrix, X: BallMatrix) -> BallMatrix:
    """Give A (x) X."""
    return blocks([[X * entry for entry in row] for row in A.tolist()])


def largest_size(entries: Sequence[Ball]) -> Ball:
    """Bound all |x_i| from above; no number if one of them is none."""
    return functools.reduce(arb.max, (abs(each) for each in entries), arb(0)).upper()


def middle(X: BallMatrix) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Give the midpoints as floats."""
    return np.array([[float(entry.mid()) for entry in row] for row in X.tolist()])


def is_positive_definite(X: BallMatrix) -> bool | None:
    """Tell whether a symmetric matrix is positive definite, by X = L D L^T with pivots that are certainly positive.

    False if a pivot is certainly not positive, where all before it are; None if the balls do not tell. Only the lower
    triangle is looked at.
    """
    rows = X.tolist()
    for k, row in enumerate(rows):
        pivot = row[k]
        if not pivot > 0:
            return False if pivot <= 0 else None
        for i in range(k + 1, len(rows)):
            below = rows[i]
            if below[k].is_zero():
                continue
            factor = below[k] / pivot
            for j in range(k + 1, i + 1):
                below[j] -= factor * rows[j][k]
    return True


def norm_is_within(A: BallMatrix, bound: Ball) -> bool | None:
    """Tell whether ||A|| < bound: bound^2 I - A A^T > 0, or with A^T A, whichever is smaller."""
    product = A * A.transpose() if A.nrows() <= A.ncols() else A.transpose() * A
    return is_positive_definite(identity(product.nrows()) * (bound * bound) - product) if bound > 0 else None
