"""A CasADi function read as a list of instructions, so that it can be evaluated in another arithmetic."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import casadi as ca

Number = Any
"""A number of the arithmetic: an `arb` ball or an mpmath interval; neither library has types."""

Operation = Callable[..., Number]


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """An arithmetic: a `number` from a float, and CasADi's scalar operations, by their codes."""

    number: Callable[[float], Number]
    operations: Mapping[int, Operation]


OPERATORS: Final[Mapping[int, Operation]] = {
    ca.OP_ASSIGN: lambda x: x,
    ca.OP_ADD: lambda x, y: x + y,
    ca.OP_SUB: lambda x, y: x - y,
    ca.OP_MUL: lambda x, y: x * y,
    ca.OP_DIV: lambda x, y: x / y,
    ca.OP_INV: lambda x: 1 / x,
    ca.OP_NEG: lambda x: -x,
    ca.OP_TWICE: lambda x: 2 * x,
}
"""What Python's operators do, for numbers that have them."""


class UnknownOperationError(Exception):
    """An instruction that the arithmetic has no operation for; its text is the instruction's name."""


@dataclass(frozen=True, slots=True)
class Tape:
    """The instructions of a function, each with a place of its own for its result.

    `loads` are (place, input, entry), `constants` (place, value), `steps` (place, operation, places), `stores` (place,
    output, entry); `lengths` are the numbers of entries of the outputs, which are counted by columns.
    """

    zero: Number
    loads: tuple[tuple[int, int, int], ...]
    constants: tuple[tuple[int, Number], ...]
    steps: tuple[tuple[int, Operation, tuple[int, ...]], ...]
    stores: tuple[tuple[int, int, int], ...]
    places: int
    lengths: tuple[int, ...]

    def __call__(self, *inputs: Sequence[Number]) -> tuple[list[Number], ...]:
        """Evaluate; gives the entries of each output."""
        work: list[Number] = [None] * self.places
        for place, which, entry in self.loads:
            work[place] = inputs[which][entry]
        for place, value in self.constants:
            work[place] = value
        for place, operation, sources in self.steps:
            work[place] = operation(*[work[each] for each in sources])
        outputs = tuple([self.zero] * length for length in self.lengths)
        for place, which, entry in self.stores:
            outputs[which][entry] = work[place]
        return outputs


def record(function: ca.Function, arithmetic: Arithmetic) -> Tape:
    """Read the instructions of a function of scalar operations (SX).

    Raises
    ------
    UnknownOperationError
        If it has one that the arithmetic does not know.
    """
    loads, constants, steps, stores = [], [], [], []
    at: dict[int, int] = {}  # CasADi uses its registers again and again
    for place in range(function.n_instructions()):
        code, sources, into = (
            function.instruction_id(place),
            function.instruction_input(place),
            function.instruction_output(place),
        )
        if code == ca.OP_OUTPUT:
            stores.append((at[sources[0]], into[0], into[1]))
            continue
        if code == ca.OP_INPUT:
            loads.append((place, sources[0], sources[1]))
        elif code == ca.OP_CONST:
            constants.append((place, arithmetic.number(float(function.instruction_constant(place)))))
        elif code in arithmetic.operations:
            steps.append((place, arithmetic.operations[code], tuple(at[each] for each in sources)))
        else:
            raise UnknownOperationError(_name_of(code))
        at[into[0]] = place
    lengths = tuple(function.nnz_out(i) for i in range(function.n_out()))
    zero, places = arithmetic.number(0.0), function.n_instructions()
    return Tape(zero, tuple(loads), tuple(constants), tuple(steps), tuple(stores), places, lengths)


def _name_of(operation: int) -> str:
    return next(name for name in dir(ca) if name.startswith("OP_") and getattr(ca, name) == operation)
