"""A design's certificate as a value, and how it is made."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from firmtouch.certificate.claims import cost, errors, gains, poles, positivity, surface
from firmtouch.certificate.decision import Verdict
from firmtouch.certificate.question import Claim, Question, settle
from firmtouch.certificate.subject import Subject


@dataclass(frozen=True, slots=True)
class Certificate:
    """All claims about finished gains, each proven, refuted or undecided; `subject` is what they are about."""

    subject: Subject
    claims: tuple[Claim, ...]

    @property
    def certified(self) -> bool:
        """Tell whether every claim is proven."""
        return all(each.verdict is Verdict.PROVEN for each in self.claims)

    @property
    def open(self) -> tuple[Claim, ...]:
        """List the claims that are not proven."""
        return tuple(each for each in self.claims if each.verdict is not Verdict.PROVEN)


def questions_of(subject: Subject) -> Iterator[Question]:
    """List all that is asked about a subject, in the order of a certificate."""
    for kind in (surface, positivity, poles, errors, gains, cost):
        yield from kind.questions(subject)


def certify(subject: Subject) -> Certificate:
    """Settle every question."""
    return Certificate(subject, tuple(settle(each) for each in questions_of(subject)))
