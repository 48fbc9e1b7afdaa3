"""What finished gains reach, term by term, at every vertex: from the gains alone, whoever found them."""

from __future__ import annotations

from dataclasses import dataclass

from firmtouch.regulation import ClosedLoop, Gains, OperatingPoint, close_loop
from firmtouch.synthesis.region.terms.term import Term


@dataclass(frozen=True, slots=True)
class TermResult:
    """A term with what is reached at the worst vertex; `margin` > 0 is how far that is on the good side."""

    term: Term
    reached: float
    worst_vertex: int

    @property
    def margin(self) -> float:
        """Distance from what was asked to what is reached, positive where it is good."""
        return self.term.margin(self.reached)

    @property
    def holds(self) -> bool:
        """Tell whether the term holds at every vertex."""
        return self.term.holds(self.reached)


@dataclass(frozen=True, slots=True)
class Audit:
    """The closed loop at the nominal plant and at every vertex, and every term's result."""

    nominal: ClosedLoop
    loops: tuple[ClosedLoop, ...]
    results: tuple[TermResult, ...]

    @property
    def holds(self) -> bool:
        """Tell whether every term holds at every vertex."""
        return all(each.holds for each in self.results)


def audit(op: OperatingPoint, points: tuple[OperatingPoint, ...], gains: Gains, terms: tuple[Term, ...]) -> Audit:
    """Analyse finished gains at the nominal plant and at every vertex."""
    nominal, loops = close_loop(op, gains), tuple(close_loop(point, gains) for point in points)
    return Audit(nominal, loops, tuple(_result(term, (nominal,) if term.nominal else loops) for term in terms))


def _result(term: Term, loops: tuple[ClosedLoop, ...]) -> TermResult:
    values = [term.reached(loop) for loop in loops]
    worst = min(range(len(values)), key=lambda i: term.margin(values[i]))
    return TermResult(term, values[worst], worst)
