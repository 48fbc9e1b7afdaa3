"""Questions that a proof answers, and the claims that come of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum
from typing import Final

from firmtouch.certificate.decision import PRECISIONS, Verdict, decide
from firmtouch.certificate.surface import NoRootError

SHRINKS: Final = (1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-2, 0.1, 0.3)
"""By which parts of itself an estimate is worsened until it is proven."""
QUICK: Final = PRECISIONS[1]
"""Bits that a sharper figure may take; or twice as many as what is asked took."""


class Scope(Enum):
    """For which plants a claim is made."""

    NOMINAL = "nominal plant"
    VERTICES = "nominal plant and all vertices"
    POLYTOPE = "all plants of the polytope"


@dataclass(frozen=True, slots=True)
class Question:
    """Does a figure bound something? `holds(value)` answers for one value, at the precision of the moment.

    `relation` is ">" where the figure is a lower bound, "<" where it is an upper one; `asked` is what must hold for the
    claim to be proven (none: any finite figure will do); `estimate` is what floats say of the best figure. A refutation
    by a `sufficient` condition says nothing.
    """

    name: str
    words: str
    scope: Scope
    relation: str
    asked: float | None
    unit: str
    route: str
    estimate: Callable[[], float]
    holds: Callable[[float], bool | None]
    sufficient: bool = False

    def answer(self, value: float) -> bool | None:
        """Answer for a value, with whatever is no number as no answer."""
        try:
            found = self.holds(value)
        except (NoRootError, ZeroDivisionError):
            return None
        return None if found is False and self.sufficient else found


@dataclass(frozen=True, slots=True)
class Claim:
    """A question with its answer: `figure` is proven to be a bound (infinite where nothing is proven)."""

    name: str
    words: str
    scope: Scope
    relation: str
    asked: float | None
    unit: str
    route: str
    verdict: Verdict
    figure: float
    bits: int


def settle(question: Question) -> Claim:
    """Prove what is asked, or refute it, or leave it undecided; then sharpen the figure as far as is quickly done."""
    verdict, bits, figure = Verdict.UNDECIDED, PRECISIONS[-1], math.inf
    if question.asked is not None:
        verdict, bits = decide(lambda: question.answer(_given(question.asked)))
        if verdict is not Verdict.PROVEN:
            return _claim(question, verdict, math.inf, bits)
        figure = question.asked
    precisions = tuple(
        each for each in PRECISIONS if each <= (QUICK if question.asked is None else max(2 * bits, QUICK))
    )
    for candidate in _candidates(question):
        better, needed = decide(lambda value=candidate: question.answer(value), precisions)  # type: ignore[misc]
        if better is Verdict.PROVEN:
            return _claim(question, Verdict.PROVEN, candidate, needed if question.asked is None else bits)
    return _claim(question, verdict, figure, bits)


def confirm(question: Question, figure: float) -> Verdict:
    """Prove a figure that somebody else found, and what is asked."""
    needed = [figure] if question.asked is None else [figure, question.asked]
    for value in needed:
        verdict, _ = decide(lambda value=value: question.answer(value))  # type: ignore[misc]
        if verdict is not Verdict.PROVEN:
            return verdict
    return Verdict.PROVEN


def every(answers: Iterable[bool | None]) -> bool | None:
    """Tell whether all answers are yes: no at the first no, undecided if only that stands in the way."""
    doubtful = False
    for each in answers:
        if each is False:
            return False
        doubtful |= each is None
    return None if doubtful else True


def _candidates(question: Question) -> Iterable[float]:
    """Give figures that get worse and worse, none worse than what is asked."""
    best, asked = question.estimate(), question.asked
    if not math.isfinite(best):
        return
    sign = -1.0 if question.relation == ">" else 1.0
    for part in SHRINKS:
        value = best + sign * part * abs(best)
        if asked is not None and sign * (value - asked) >= 0:
            return
        yield value


def _given(value: float | None) -> float:
    assert value is not None
    return value


def _claim(question: Question, verdict: Verdict, figure: float, bits: int) -> Claim:
    q = question
    return Claim(q.name, q.words, q.scope, q.relation, q.asked, q.unit, q.route, verdict, figure, bits)
