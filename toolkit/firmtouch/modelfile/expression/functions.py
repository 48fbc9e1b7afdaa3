"""The functions that an expression may call. All are twice differentiable where they are defined."""

from __future__ import annotations

import math
from typing import Final

SCALAR: Final = {
    "sin": 1, "cos": 1, "tan": 1, "asin": 1, "acos": 1, "atan": 1, "atan2": 2,
    "sinh": 1, "cosh": 1, "tanh": 1, "exp": 1, "log": 1, "sqrt": 1,
}  # fmt: skip
"""Scalar functions and how many arguments they take; each arithmetic brings its own of these names."""

VECTOR: Final = {"x": 1, "y": 1, "z": 1, "norm": 1, "inner": 2, "cross": 2}
"""Functions of vectors, which are made of scalar arithmetic: components, length, and the two products."""

FUNCTIONS: Final = {**SCALAR, **VECTOR}

CONSTANTS: Final = {"pi": math.pi}

ROUGH: Final = frozenset({"abs", "sign", "min", "max", "floor", "ceil", "round", "mod", "heaviside", "piecewise"})
"""Functions that users try and that have no second derivative; the paper's Phi and P must be C^2."""
