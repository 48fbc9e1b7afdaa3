"""G_f, the gain of the force feedback, and what the force path allows of it: plain numbers."""

from __future__ import annotations

import math
from typing import Annotated, Any, Final, Literal

from pydantic import ValidationInfo

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Checked, declared, refuse

STRONGEST: Final = 1e6


AUTO: Final = "auto"
"""G_f is to be chosen: as large as the margins of `force_path` allow."""


def _force_feedback(raw: object, info: ValidationInfo) -> tuple[tuple[float, ...], ...] | Literal["auto"]:
    m = len(declared(info).constraints)
    if raw == AUTO:
        return "auto"
    if not isinstance(raw, list) or len(raw) != m or not any(isinstance(row, list) for row in raw):
        return _diagonal(_gains(raw, m))
    matrix = tuple(_row(row, i, m) for i, row in enumerate(raw))
    for i, row in enumerate(matrix):
        for j in range(i):
            if row[j] != matrix[j][i]:
                refuse(Problem("G_f must be symmetric", path=(i, j)))
            if row[j] ** 2 > row[i] * matrix[j][j]:
                refuse(Problem("G_f must be positive semidefinite; this entry is too large", path=(i, j)))
    return matrix


def _limit(raw: object, info: ValidationInfo) -> tuple[float, ...]:
    return _gains(raw, len(declared(info).constraints))


def _gains(raw: object, m: int) -> tuple[float, ...]:
    """Read one gain for all constraints, or one for each."""
    if not isinstance(raw, list):
        return (_gain(raw),) * m
    if len(raw) != m:
        refuse(Problem(f"{len(raw)} force-feedback gains for {m} constraint{'s' * (m != 1)}"))
    return tuple(_gain(each, i) for i, each in enumerate(raw))


def _row(raw: object, i: int, m: int) -> tuple[float, ...]:
    if not isinstance(raw, list) or len(raw) != m:
        refuse(Problem(f"G_f is {m} x {m}: a list of {m} numbers was expected", path=(i,)))
    return tuple(_gain(each, i, j, least=0 if i == j else -STRONGEST) for j, each in enumerate(raw))


def _diagonal(gains: tuple[float, ...]) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(gain if i == j else 0.0 for j in range(len(gains))) for i, gain in enumerate(gains))


def _gain(raw: object, *path: int, least: float = 0.0) -> float:
    if isinstance(raw, bool) or not isinstance(raw, int | float) or not math.isfinite(raw):
        refuse(Problem("a plain number was expected: force-feedback gains have no unit", path=path))
    if not least <= raw <= STRONGEST:
        refuse(Problem(f"a force-feedback gain of {raw:g}; it must lie between {least:g} and {STRONGEST:g}", path=path))
    return float(raw)


_NUMBERS: Final[dict[str, Any]] = {"type": "array", "items": {"type": "number"}}
_ROWS: Final[dict[str, Any]] = {"type": "array", "items": {"anyOf": [{"type": "number"}, _NUMBERS]}}
ForceFeedback = Annotated[
    tuple[tuple[float, ...], ...] | Literal["auto"],
    Checked(_force_feedback, {"anyOf": [{"type": "number"}, _ROWS, {"const": AUTO}]}),
]
ForceFeedbackLimit = Annotated[tuple[float, ...], Checked(_limit, {"anyOf": [{"type": "number"}, _NUMBERS]})]
