"""One design of a search: its values, what it reaches, and how much it misses."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from firmtouch.errors import InputError
from firmtouch.thermal.analysis.felt import COARSE, Felt, feel
from firmtouch.thermal.analysis.outcomes import Outcome, heat_of, metric_of, outcomes, pairs
from firmtouch.thermal.arrays import Array
from firmtouch.thermal.search.variables import Path, Value, Variable, values_at, with_values
from firmtouch.thermal.sensorfile.build import sensor_of
from firmtouch.thermal.sensorfile.requirements import RequirementsSpec
from firmtouch.thermal.sensorfile.specification import SensorSpec
from firmtouch.thermal.tables.catalogue import Catalogue

SLACK: Final = 2e-3
"""Of ln: by how much what is measured on the coarse grid must be better than asked, to hold on the fine one too."""
EXACT: Final = frozenset({"pitch", "thickness", "surface_temperature", "crosstalk", "self_heating", "feedback"})
HOPELESS: Final = 50.0
"""The ln of a factor that counts for nothing reached at all."""
LOOP_MARGIN: Final = 0.5
"""What a search asks of a loop where the file does not: a sensitivity of 2 at most."""


@dataclass(frozen=True, slots=True)
class Question:
    """What a search asks: a specification, its variables, and the tables of their choices."""

    spec: SensorSpec
    variables: tuple[Variable, ...]
    catalogue: Catalogue
    objectives: tuple[str, ...]

    @property
    def asked(self) -> RequirementsSpec:
        """Give the requirements; a loop is asked to keep off its limit."""
        asked = self.spec.requirements
        searched = self.spec.search.drive if self.spec.search is not None else None
        modes = {self.spec.drive.mode, *((searched.mode or ()) if searched is not None else ())}
        if asked.loop_margin is None and "constant_temperature" in modes:
            return asked.model_copy(update={"loop_margin": LOOP_MARGIN})
        return asked


@dataclass(frozen=True, slots=True)
class Candidate:
    """A design: its coordinates `x` and values, the `figures` of the objectives, and its outcomes."""

    x: tuple[float, ...]
    values: Mapping[Path, Value]
    figures: Mapping[str, float]
    outcomes: tuple[Outcome, ...]
    shortfall: float

    @property
    def meets(self) -> bool:
        """Tell whether it meets everything, with some slack."""
        return self.shortfall == 0

    def cost(self, objective: str) -> float:
        """Give ln of an objective, the less the better."""
        figure = self.figures.get(objective, math.inf)
        if objective == "discrimination":
            return -math.log(max(figure, 1e-300))
        return math.log(figure) if figure > 0 else -HOPELESS


def try_out(question: Question, x: Array) -> Candidate:
    """Try a design on all scenarios, on the coarse grid."""
    values = values_at(question.variables, x)
    at = tuple(float(each) for each in x)
    spec, asked = with_values(question.spec, values), question.asked
    try:
        felt = feel(sensor_of(spec, question.catalogue), spec.window, COARSE, asked=asked.quickest)
        reached = outcomes(asked, felt)
        figures = {name: _figure(name, asked, felt, reached) for name in question.objectives}
    except InputError:  # sizes that no sensor has, such as pads that overlap
        return Candidate(at, values, {}, (), HOPELESS)
    missing = sum(_missing(each) for each in reached)
    return Candidate(at, values, figures, reached, missing + _too_warm(felt))


def _too_warm(felt: Felt) -> float:
    """Give what a design misses whose stated temperature no heater holds, since it is warmer without any."""
    difference = felt.sensor.temperatures.difference
    found = heat_of(felt)
    return 0.0 if found.can_hold(difference) else 1 + math.log1p(found.surplus / max(abs(difference), 1e-3))


def confirmed(question: Question, candidate: Candidate) -> Candidate:
    """Measure a design finely that misses some slack alone; it meets everything if it does so on the fine grid."""
    if candidate.meets or candidate.shortfall > SLACK * len(candidate.outcomes):
        return candidate
    spec = with_values(question.spec, candidate.values)
    reached = outcomes(question.asked, feel(sensor_of(spec, question.catalogue), spec.window))
    return replace(candidate, outcomes=reached, shortfall=0.0) if all(each.met for each in reached) else candidate


def _missing(outcome: Outcome) -> float:
    """Give ln of the factor that is missing, with slack for what is measured."""
    if outcome.name in EXACT:
        return min(outcome.shortfall, HOPELESS)
    worse, better = (outcome.reached, outcome.asked) if outcome.at_most else (outcome.asked, outcome.reached)
    if not (worse < math.inf and better > 0):
        return HOPELESS
    return 0.0 if worse <= 0 else min(max(0.0, math.log(worse / better) + SLACK), HOPELESS)


def _figure(name: str, asked: RequirementsSpec, felt: Felt, reached: tuple[Outcome, ...]) -> float:
    """Measure an objective; an asked requirement has measured it already."""
    known = {each.name: each.reached for each in reached}
    match name:
        case "rise_time" | "discrimination" if name in known:
            return known[name]
        case "rise_time":
            return float(felt.rises(metric_of(asked)).seconds.max())
        case "power":
            return heat_of(felt).most * (1.0 if felt.sensor.pad is None else felt.sensor.pad.area)
        case "thickness":
            return felt.sensor.stack.thickness
        case _:
            return min(each.d_prime for each in pairs(asked, felt))


def start_of(question: Question, of_spec: Mapping[Path, Value | None]) -> Array:
    """Give the coordinates of the file's own values."""
    return np.array([each.coordinate(of_spec[each.path]) for each in question.variables])
