"""What a sensor reaches of what is asked of it: one outcome for each requirement, at its worst scenario."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from firmtouch.thermal.analysis.crosstalk import object_share
from firmtouch.thermal.analysis.felt import Felt, loop_margin
from firmtouch.thermal.analysis.heat import Heat, heat, recovery_times
from firmtouch.thermal.analysis.telling import Grade, Pair, grade, tell_pairs
from firmtouch.thermal.discrimination import Sampling
from firmtouch.thermal.electronics import SelfHeating
from firmtouch.thermal.metrics import Metric
from firmtouch.thermal.readout import own_heat
from firmtouch.thermal.sensor import HeldTemperature, Sensor
from firmtouch.thermal.sensorfile.requirements import DiscriminationSpec, RangeSpec, RequirementsSpec
from firmtouch.thermal.signals import signal_noise

METRICS: Final = {"10-90": Metric.TEN_TO_NINETY, "63 %": Metric.SIXTY_THREE}
GRADES: Final = 7
"""Effusivities at which a range is graded, its ends among them."""
A_STEP_IN_TEMPERATURE: Final = 10.0
"""K: what counts as much as a factor of e in other units."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """A requirement, and what is reached of it in its worst scenario `where`; `asked` is the most, or the least."""

    name: str
    asked: float
    reached: float
    unit: str
    at_most: bool = True
    where: str = ""

    @property
    def margin(self) -> float:
        """Give by how much it is met, in its unit; negative where it is not."""
        return self.asked - self.reached if self.at_most else self.reached - self.asked

    @property
    def met(self) -> bool:
        """Tell whether it is."""
        return self.margin >= 0

    @property
    def shortfall(self) -> float:
        """Give ln of the factor that is missing; 0 where it is met, `inf` where nothing is reached."""
        if self.met:
            return 0.0
        if self.name == "surface_temperature":
            return -self.margin / A_STEP_IN_TEMPERATURE
        least, most = sorted((self.asked, self.reached))
        return math.log(most / least) if least > 0 and math.isfinite(most) else math.inf


def outcomes(asked: RequirementsSpec, felt: Felt) -> tuple[Outcome, ...]:
    """Hold a sensor against what is asked, in the order of the file."""
    return tuple(found for name in asked.asked for found in OF[name](asked, felt))


def metric_of(asked: RequirementsSpec) -> Metric:
    """Give the metric of a rise time: the asked one, and 10-90 % where none is asked, or one by d'."""
    return METRICS.get(asked.rise_time.metric if asked.rise_time is not None else "", Metric.TEN_TO_NINETY)


def _rise_time(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    spec = asked.rise_time
    assert spec is not None
    if spec.metric == "d_prime":
        found = pairs(asked, felt, until=spec.window)
        worst = max(found, key=lambda each: each.told_after)
        yield Outcome("rise_time", spec.at_most, worst.told_after, "s", where=_pair_words(worst))
        return
    if spec.signal == "power" and not isinstance(felt.sensor.drive, HeldTemperature):
        yield Outcome("rise_time", spec.at_most, math.inf, "s", where="this drive's power tells nothing")
        return
    seconds = felt.rises(METRICS[spec.metric]).seconds
    i = int(seconds.argmax())
    yield Outcome("rise_time", spec.at_most, float(seconds[i]), "s", where=felt.sensor.scenarios[i].words)


def sampling_of(sensor: Sensor) -> Sampling:
    """Give the samples of the signal; there must be a readout."""
    noise = signal_noise(sensor)
    assert noise is not None
    assert sensor.readout is not None
    return Sampling(noise, sensor.readout.rate)


def pairs(asked: RequirementsSpec, felt: Felt, *, until: float | None = None) -> tuple[Pair, ...]:
    """Tell all pairs apart that are asked for."""
    spec = asked.discrimination
    assert spec is not None
    sampling = sampling_of(felt.sensor)
    return tell_pairs(felt.sensor, spec.pairs, sampling, at=spec.time, until=until, enough=spec.d_prime)


def _pair_words(pair: Pair) -> str:
    return f"{pair.first} and {pair.second}, {pair.level} h"


def _discrimination(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    spec = asked.discrimination
    assert isinstance(spec, DiscriminationSpec)
    worst = min(pairs(asked, felt), key=lambda each: each.d_prime)
    yield Outcome("discrimination", spec.d_prime, worst.d_prime, "1", at_most=False, where=_pair_words(worst))


def grades(asked: RequirementsSpec, felt: Felt) -> tuple[Grade, ...]:
    """Grade the range of effusivity that is asked for, in all contacts."""
    spec = asked.range
    assert isinstance(spec, RangeSpec)
    e = np.geomspace(spec.least, spec.most, GRADES)
    return grade(felt.sensor, [float(each) for each in e], sampling_of(felt.sensor), at=spec.time)


def _range(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    assert asked.range is not None
    worst = max(grades(asked, felt), key=lambda each: each.spread)
    where = f"e = {worst.effusivity:.3g} W s^½/m²K, {worst.level} h"
    yield Outcome("range", asked.range.sd, worst.spread, "1", where=where)


def crosstalk_time(asked: RequirementsSpec) -> float | None:
    """Give when after the touch cross-talk counts: as asked, or when the signal must be there."""
    if asked.crosstalk is not None and asked.crosstalk.time is not None:
        return asked.crosstalk.time
    return None if asked.rise_time is None else asked.rise_time.at_most


def _crosstalk(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    spec, at, pad = asked.crosstalk, crosstalk_time(asked), felt.sensor.pad
    assert spec is not None
    assert at is not None
    assert pad is not None
    found = {each.object: object_share(each, pad, at) for each in felt.sensor.scenarios}
    worst = max(found, key=lambda name: found[name])
    yield Outcome("crosstalk", spec.at_most, found[worst], "1", where=worst)


def _surface_temperature(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    assert asked.surface_temperature is not None
    yield Outcome("surface_temperature", asked.surface_temperature, heat_of(felt).hottest, "K")


@lru_cache(maxsize=4)  # several requirements and objectives ask for it
def heat_of(felt: Felt) -> Heat:
    """Give the powers that go with the signals."""
    return heat(felt.sensor, felt.t, felt.values)


def _power(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    spec, pad, found = asked.power, felt.sensor.pad, heat_of(felt)
    assert spec is not None
    assert pad is not None
    one = found.most * pad.area
    if spec.pad is not None:
        yield Outcome("power_pad", spec.pad, one, "W", where=found.most_in)
    if spec.array is not None:
        yield Outcome("power_array", spec.array, one * pad.count, "W", where=found.most_in)


def _own_heat(felt: Felt) -> SelfHeating | None:
    sensor = felt.sensor
    assert sensor.readout is not None
    return own_heat(sensor.stack, sensor.front, sensor.readout, sensor.temperatures.face)


def _self_heating(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    assert asked.self_heating is not None
    found = _own_heat(felt)
    yield Outcome("self_heating", asked.self_heating, math.inf if found is None else found.rise, "K")


def _feedback(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    assert asked.feedback is not None
    found = _own_heat(felt)
    yield Outcome("feedback", asked.feedback, math.inf if found is None else found.feedback_ratio, "1")


def _loop_margin(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    assert asked.loop_margin is not None
    yield Outcome("loop_margin", asked.loop_margin, loop_margin(felt.sensor), "1", at_most=False)


def _recovery(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    assert asked.recovery is not None
    ends = felt.rises(Metric.SIXTY_THREE).end_value
    seconds = recovery_times(felt.sensor, felt.sensor.touches, felt.window, ends, grid=felt.grid)
    i = int(seconds.argmax())
    yield Outcome("recovery", asked.recovery, float(seconds[i]), "s", where=felt.sensor.scenarios[i].words)


def _pitch(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    assert asked.pitch is not None
    assert felt.sensor.pad is not None
    yield Outcome("pitch", asked.pitch, felt.sensor.pad.pitch, "m")


def _thickness(asked: RequirementsSpec, felt: Felt) -> Iterator[Outcome]:
    assert asked.thickness is not None
    yield Outcome("thickness", asked.thickness, felt.sensor.stack.thickness, "m")


OF: Final[dict[str, Callable[[RequirementsSpec, Felt], Iterator[Outcome]]]] = {
    "rise_time": _rise_time,
    "discrimination": _discrimination,
    "range": _range,
    "crosstalk": _crosstalk,
    "surface_temperature": _surface_temperature,
    "power": _power,
    "self_heating": _self_heating,
    "feedback": _feedback,
    "loop_margin": _loop_margin,
    "recovery": _recovery,
    "pitch": _pitch,
    "thickness": _thickness,
}
