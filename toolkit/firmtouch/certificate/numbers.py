"""Numbers in certificates: hexadecimal floats, each in the one way that Python writes it, and never infinite."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, PlainSerializer

from firmtouch.errors import InputError
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen


class NotACertificateError(InputError):
    """The file is not a certificate of this schema."""


class Part(BaseModel):
    """A part of a certificate: nothing may be missing, and nothing may stand there that is not known."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


def _read(raw: object) -> float:
    if not isinstance(raw, str):
        raise ValueError("a hexadecimal float was expected, as in `0x1.8p+1`")  # noqa: TRY004  # pydantic's way
    try:
        value = float.fromhex(raw)
    except OverflowError as error:
        raise ValueError("too large for a binary64 number") from error
    if not math.isfinite(value):
        raise ValueError("a finite number was expected")
    if value.hex() != raw:
        raise ValueError(f"a hexadecimal float was expected in its one way of writing it, `{value.hex()}`")
    return value


Number = Annotated[float, BeforeValidator(_read), PlainSerializer(lambda value: value.hex())]
Rows = list[list[Number]]


def hexadecimal(values: Array | Sequence[float] | float) -> Any:  # noqa: ANN401  # nested lists
    """Write numbers, vectors and matrices."""
    return [hexadecimal(each) for each in values] if np.ndim(values) else float(values).hex()  # type: ignore[union-attr, arg-type]


def matrix(rows: Rows) -> Array:
    """Give rows as an array.

    Raises
    ------
    NotACertificateError
        If rows differ in length.
    """
    if len({len(row) for row in rows}) > 1:
        raise NotACertificateError("no certificate: a matrix whose rows differ in length")
    return frozen(rows)
