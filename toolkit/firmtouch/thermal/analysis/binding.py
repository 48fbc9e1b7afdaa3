"""Why a requirement is not met: which physical term binds, and what value of it would do."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

from firmtouch.errors import InputError
from firmtouch.thermal.analysis.felt import COARSE, feel
from firmtouch.thermal.analysis.outcomes import OF, Outcome
from firmtouch.thermal.analysis.terms import TERMS_OF, Term
from firmtouch.thermal.sensor import Sensor
from firmtouch.thermal.sensorfile.requirements import RequirementsSpec

FARTHEST: Final = 1e5
"""A term is changed by at most this factor; what does not help then is not what binds."""
CLOSE: Final = 0.005
"""Of ln of the factor that suffices."""


@dataclass(frozen=True, slots=True)
class Relief:
    """A change of a term, from `now` to `needed` in its unit, with which the requirement comes to `reached`."""

    term: str
    unit: str
    now: float
    needed: float
    reached: float

    @property
    def factor(self) -> float:
        """Give by how much it must change, at least 1."""
        return max(self.needed / self.now, self.now / self.needed)


@dataclass(frozen=True, slots=True)
class Binding:
    """The requirement that is missed most, and what would meet it.

    `alone` holds the terms of which each suffices by itself, the smallest change first. Where there are none,
    `together` is a set of which none can be left out, each with what it needs if all others of it were ideal, the
    largest change first; where it is empty too, nothing about the sensor suffices, and what is touched binds.
    """

    outcome: Outcome
    alone: tuple[Relief, ...]
    together: tuple[Relief, ...] = ()

    @property
    def term(self) -> str:
        """Name the term that binds."""
        return next((each.term for each in (*self.alone, *self.together)), "the object")


def binding_of(asked: RequirementsSpec, missed: Sequence[Outcome], sensor: Sensor, window: float) -> Binding | None:
    """Find what binds a sensor that misses some requirements; None where it misses none."""
    if not missed:
        return None
    worst = max(missed, key=lambda each: each.shortfall)
    terms = tuple(each for each in TERMS_OF[worst.name] if (each.value(sensor) or 0) > 0)
    trial = _Trial(asked, worst, sensor, window)
    alone = tuple(filter(None, (trial.relief(each) for each in terms)))
    if alone:
        return Binding(worst, tuple(sorted(alone, key=lambda each: each.factor)))
    needed = trial.needed_together(terms)
    together = filter(None, (trial.relief(each, [x for x in needed if x is not each]) for each in needed))
    return Binding(worst, (), tuple(sorted(together, key=lambda each: -each.factor)))


@dataclass(frozen=True, slots=True)
class _Trial:
    """A requirement that a sensor misses, and the sensor with terms changed."""

    asked: RequirementsSpec
    missed: Outcome
    sensor: Sensor
    window: float

    def outcome(self, changes: Sequence[tuple[Term, float]]) -> Outcome:
        """Hold the sensor, with terms changed by factors, against the requirement.

        A size that no sensor has reaches nothing.
        """
        try:
            felt = feel(self.changed(changes), self.window, COARSE, asked=self.asked.quickest)
            found = OF[_asked_name(self.missed.name)](self.asked, felt)
            return next(each for each in found if each.name == self.missed.name)
        except InputError:
            return replace(self.missed, reached=math.inf if self.missed.at_most else 0.0)

    def changed(self, changes: Sequence[tuple[Term, float]]) -> Sensor:
        sensor = self.sensor
        for term, f in changes:
            sensor = term.changed(sensor, f)
        return sensor

    def needed_together(self, terms: Sequence[Term]) -> tuple[Term, ...]:
        """Leave out of all terms, while the others suffice if ideal, the one that matters least."""
        if not self.outcome([(each, FARTHEST) for each in terms]).met:
            return ()
        while True:
            without = {each: self.outcome([(x, FARTHEST) for x in terms if x is not each]) for each in terms}
            least = min(terms, key=lambda each: without[each].shortfall)
            if not without[least].met:
                return tuple(terms)
            terms = [each for each in terms if each is not least]

    def relief(self, term: Term, ideal: Sequence[Term] = ()) -> Relief | None:
        """Find the least change of a term that suffices, by bisection in ln f; others may be ideal meanwhile."""
        others = [(each, FARTHEST) for each in ideal]
        low, high = 0.0, math.log(FARTHEST)
        last = self.outcome([*others, (term, FARTHEST)])
        if not last.met:
            return None
        while high - low > CLOSE:
            middle = (low + high) / 2
            there = self.outcome([*others, (term, math.exp(middle))])
            if there.met:
                high, last = middle, there
            else:
                low = middle
        now, needed = term.value(self.sensor), term.value(self.changed([(term, math.exp(high))]))
        return None if now is None or needed is None else Relief(term.name, term.unit, now, needed, last.reached)


def _asked_name(outcome: str) -> str:
    """Give the requirement that an outcome belongs to: two are of `power`."""
    return "power" if outcome.startswith("power_") else outcome
