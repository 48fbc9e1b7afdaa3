"""The one kind of array that values hold: binary64, read-only."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    import casadi as ca

Array = NDArray[np.floating[Any]]

Vector = Array | Sequence[float]
"""What functions of numbers take for a vector."""


def frozen(values: ArrayLike) -> Array:
    """Copy to a read-only array."""
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def symmetric(matrix: ArrayLike) -> Array:
    """Give the symmetric part, read-only: what rounding made unsymmetric is no information."""
    array = np.asarray(matrix, dtype=np.float64)
    return frozen((array + array.T) / 2)


def call(function: ca.Function, *arguments: Any) -> Array:  # noqa: ANN401  # whatever CasADi takes
    """Evaluate a CasADi function of one output."""
    return frozen(np.asarray(function(*arguments).full()))


def call_vector(function: ca.Function, *arguments: Any) -> Array:  # noqa: ANN401  # whatever CasADi takes
    """Evaluate a CasADi function whose one output is a column."""
    return frozen(np.asarray(function(*arguments).full()).ravel())
