"""Why there are no gains: an irreducible set of terms that conflict, and what each of them would have to give."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import Final

from firmtouch.errors import NoDesignError
from firmtouch.synthesis.region.audit import Audit
from firmtouch.synthesis.region.convex import ConvexSearch
from firmtouch.synthesis.region.problem import RegionProblem
from firmtouch.synthesis.region.programme import Status
from firmtouch.synthesis.region.terms.positivity import Positivity
from firmtouch.synthesis.region.terms.term import Term

EASIEST: Final = 1e3
"""A term that had to be eased by more than this factor is as good as dropped."""
ACCURACY: Final = 0.01


class Verdict(Enum):
    """What it means that no gains were found; the text is for the user."""

    INFEASIBLE = "no gains exist that meet these terms"
    CONSERVATIVE = (
        "the convex search found no gains, nor did the searches after it; its condition is sufficient and not "
        "necessary, so that gains may exist all the same"
    )
    MISSED = (
        "gains that keep the poles were found, but none that keep these terms too: they are not convex in structured "
        "gains, and were approached step by step"
    )
    UNBOUNDED = (
        "the objective grows without bound: a largest margin needs something that bounds the gains from above, such as "
        "`bandwidth`, `W` or `torque`"
    )
    TROUBLE = "the solver came to no end, so that nothing is known; other units or wider intervals may help"


@dataclass(frozen=True, slots=True)
class Ease:
    """A term of the conflict, and what it would have to ask for alone for gains to exist (infinite: never enough)."""

    term: Term
    needed: float


class NoGainsError(NoDesignError):
    """No gains were found: `verdict` says what that means, `conflict` which terms stand against each other."""

    def __init__(self, verdict: Verdict, conflict: tuple[Ease, ...]) -> None:
        self.verdict, self.conflict = verdict, conflict
        lines = [verdict.value]
        if conflict and verdict is not Verdict.MISSED:
            lines.append("these terms conflict; without any one of them, or with it eased alone as said, gains exist:")
        lines += [f"  {_in_words(each)}" for each in conflict]
        super().__init__("\n".join(lines))


def _in_words(ease: Ease) -> str:
    term = ease.term
    unit = f" {term.unit}" if term.unit else ""
    if not term.can_be_eased:
        return f"{term.name} (holds or not)"
    asked = f"{term.name} {'at most' if term.at_most else 'at least'} {term.asked:.4g}{unit}"
    if ease.needed in (float("inf"), 0.0):
        return f"{asked}: eased alone it does not help"
    return f"{asked}: would have to be {ease.needed:.4g}{unit}"


def explain(problem: RegionProblem, status: Status) -> NoGainsError:
    """Find the conflict in a problem that has no gains; `status` is how the best of its solves ended."""
    if status in (Status.TROUBLE, Status.UNBOUNDED):
        return NoGainsError(Verdict[status.name], ())
    members = irreducible(problem)
    conflict = tuple(Ease(each, _needed(problem, members, each)) for each in members)
    exact = all(each.exact for each in members)
    return NoGainsError(Verdict.INFEASIBLE if exact and members else Verdict.CONSERVATIVE, conflict)


def missed(checked: Audit) -> NoGainsError:
    """Say which terms finished gains miss."""
    return NoGainsError(
        Verdict.MISSED, tuple(Ease(each.term, each.reached) for each in checked.results if not each.holds)
    )


def irreducible(problem: RegionProblem) -> tuple[Term, ...]:
    """Drop terms one by one for as long as there are still no gains: each of those left is needed for the conflict.

    Positivity is tried last, as a design without it is none.
    """
    members = list(problem.terms)
    for term in sorted(problem.terms, key=lambda each: isinstance(each, Positivity)):
        rest = tuple(each for each in members if each is not term)
        if not has_gains(problem, rest):
            members = list(rest)
    return tuple(members)


def has_gains(problem: RegionProblem, terms: tuple[Term, ...]) -> bool:
    """Tell whether the convex search finds gains for some terms: the first eps with any will do."""
    eased = replace(problem.with_terms(terms), objective={"gains": 1.0})
    return ConvexSearch(eased, checked=False).first().best.status.has_gains


def _needed(problem: RegionProblem, members: tuple[Term, ...], term: Term) -> float:
    """Bisect for what a term would have to ask for, the others of the conflict unchanged."""
    if not term.can_be_eased:
        return float("inf")

    def fine(factor: float) -> bool:
        others = tuple(term.eased(factor) if each is term else each for each in members)
        return has_gains(problem, others)

    bad, good = 1.0, 2.0
    while not fine(good):
        bad, good = good, good**2 if good > 2 else 4.0
        if good > EASIEST:
            return float("inf") if term.at_most else 0.0
    while good / bad > 1 + ACCURACY:
        middle = (good * bad) ** 0.5
        bad, good = (bad, middle) if fine(middle) else (middle, good)
    return term.eased(good).asked
