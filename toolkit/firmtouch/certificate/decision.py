"""Yes, no, or undecided: a question in ball arithmetic, asked with more and more bits until it decides."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import Final

import flint

PRECISIONS: Final = (64, 128, 256, 512, 1024)
"""Bits; what the last ones do not decide stays undecided."""


class Verdict(Enum):
    """What became of a claim."""

    PROVEN = "proven"
    REFUTED = "refuted"
    UNDECIDED = "undecided"


def decide(question: Callable[[], bool | None], precisions: tuple[int, ...] = PRECISIONS) -> tuple[Verdict, int]:
    """Ask until the answer is certain; gives it with the bits that it took."""
    for bits in precisions:
        with flint.ctx.workprec(bits):
            answer = question()
        if answer is not None:
            return (Verdict.PROVEN if answer else Verdict.REFUTED), bits
    return Verdict.UNDECIDED, precisions[-1]
