"""CasADi functions evaluated at numbers through memory of their own, without a matrix made for each call."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from firmtouch.mechanics.arrays import Array


@dataclass(frozen=True, slots=True, eq=False)
class Evaluator:
    """A function with the memory of its inputs and outputs: `evaluator(q, qdot)` gives a tuple of arrays.

    An ordinary call of a CasADi function from Python takes some 20 us, whatever is computed; this takes below 1 us.

    The arrays are the outputs' own memory, rows x columns as in CasADi (a column is k x 1), read-only to the caller:
    the next call writes over them. Copy what must stay, or ask for `copies`. For the same reason an evaluator serves
    one thread at a time. It can be pickled; what comes out has memory of its own. `buffer` is kept because `evaluate`
    knows it by its address alone.
    """

    function: ca.Function
    arguments: tuple[Array, ...]
    results: tuple[Array, ...]
    buffer: ca.FunctionBuffer
    evaluate: Callable[[], None]

    def __call__(self, *values: ArrayLike) -> tuple[Array, ...]:
        """Evaluate. A number in place of an array fills it, as everywhere in NumPy.

        Raises
        ------
        ValueError
            If there are too many or too few values, or one has another shape than its input.
        """
        for argument, value in zip(self.arguments, values, strict=True):
            argument[...] = value
        self.evaluate()
        return self.results

    def copies(self, *values: ArrayLike) -> tuple[Array, ...]:
        """Evaluate, and give arrays that stay as they are."""
        return tuple(each.copy() for each in self(*values))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the function alone: memory is of one process."""
        return build_evaluator, (self.function,)


@lru_cache(maxsize=256)
def evaluator_of(function: ca.Function) -> Evaluator:
    """Give the evaluator of a function, made once for as long as it is among the last ones that were used."""
    return build_evaluator(function)


def build_evaluator(function: ca.Function) -> Evaluator:
    """Give a function its memory. Inputs that are columns take arrays of one axis, all others of two.

    Inputs must be dense; outputs that are not are filled up with zeros.
    """
    assert all(function.sparsity_in(i).is_dense() for i in range(function.n_in()))
    dense = _with_dense_outputs(function)
    buffer, evaluate = dense.buffer()
    arguments, results = [], []
    for i in range(dense.n_in()):
        memory, matrix = _matrix(dense.size_in(i))
        buffer.set_arg(i, memory.data)  # type: ignore[call-arg]  # CasADi's types know its C++ face alone
        arguments.append(memory if matrix.shape[1] == 1 else matrix)
    for i in range(dense.n_out()):
        memory, matrix = _matrix(dense.size_out(i))
        buffer.set_res(i, memory.data)  # type: ignore[call-arg]  # the same
        matrix.setflags(write=False)
        results.append(matrix)
    return Evaluator(function, tuple(arguments), tuple(results), buffer, evaluate)


def _matrix(shape: tuple[int, int]) -> tuple[Array, Array]:
    """Give memory and a matrix that looks at it as CasADi does, column after column."""
    memory = np.zeros(shape[0] * shape[1])
    return memory, memory.reshape(shape, order="F")


def _with_dense_outputs(function: ca.Function) -> ca.Function:
    if all(function.sparsity_out(i).is_dense() for i in range(function.n_out())):
        return function
    inputs = [ca.MX.sym(f"i{i}", *function.size_in(i)) for i in range(function.n_in())]
    return ca.Function(function.name(), inputs, [ca.densify(each) for each in function.call(inputs)])
