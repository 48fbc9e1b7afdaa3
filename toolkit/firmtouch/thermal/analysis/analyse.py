"""A sensor file -> its `Analysis`: responses, what it tells apart, its heat, and what it reaches of what is asked."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from firmtouch.thermal.analysis.binding import Binding, binding_of
from firmtouch.thermal.analysis.crosstalk import Crosstalk, crosstalk_of
from firmtouch.thermal.analysis.felt import Felt, feel, loop_margin
from firmtouch.thermal.analysis.heat import Heat, recovery_times
from firmtouch.thermal.analysis.outcomes import (
    METRICS,
    Outcome,
    crosstalk_time,
    grades,
    heat_of,
    metric_of,
    outcomes,
    pairs,
)
from firmtouch.thermal.analysis.rational import RationalModel, rational_models
from firmtouch.thermal.analysis.spectra import Spectra, spectra_of
from firmtouch.thermal.analysis.telling import Grade, Pair
from firmtouch.thermal.analysis.tolerances import Tolerances, tolerances_of
from firmtouch.thermal.electronics import SelfHeating
from firmtouch.thermal.loop import require_followable, require_stable
from firmtouch.thermal.metrics import Metric, NoResponseError
from firmtouch.thermal.readout import own_heat
from firmtouch.thermal.sensor import HeldPower, HeldTemperature, Scenario, Sensor
from firmtouch.thermal.sensorfile.build import sensor_of
from firmtouch.thermal.sensorfile.read import SensorFile
from firmtouch.thermal.sensorfile.requirements import RequirementsSpec
from firmtouch.thermal.sensorfile.specification import SensorSpec
from firmtouch.thermal.signals import scale, signal_noise

ENOUGH_LOOP_MARGIN: Final = 0.5
UNEQUAL: Final = 0.05
"""Of the power that holds the stated temperature: another stated power than that is worth a warning."""


@dataclass(frozen=True, slots=True)
class ScenarioResponse:
    """How a signal responds in one scenario; times in s, the end value in `unit`, `gain` by `per`.

    `end_value` is the extremum in the window, and `gain` that value by what makes it (T_o - T_s, T_2 - T_1, or the
    pulse's power).
    """

    scenario: Scenario
    drive: str
    unit: str
    gain: float
    per: str
    rise_10_90: float
    rise_63: float
    start: float
    end: float
    end_value: float
    window: float
    recovery: float


@dataclass(frozen=True, slots=True, eq=False)
class Analysis:
    """All that is found out about a sensor.

    `felt` has the signals, `open_loop` those at constant power where the drive is another, for comparison;
    `spectra` and `rational` are of the usual contact, and `signal_noise` (K or W/m2) is that of one sample. `spec` is
    what was analysed: the file's, or a design's.
    """

    file: SensorFile
    spec: SensorSpec
    sensor: Sensor
    felt: Felt
    open_loop: Felt | None
    responses: tuple[ScenarioResponse, ...]
    spectra: Spectra
    rational: tuple[RationalModel, ...]
    crosstalk: tuple[Crosstalk, ...]
    discrimination: tuple[Pair, ...]
    range: tuple[Grade, ...]
    heat: Heat
    own_heat: SelfHeating | None
    signal_noise: float | None
    loop_margin: float
    outcomes: tuple[Outcome, ...]
    binding: Binding | None
    tolerances: Tolerances | None
    warnings: tuple[str, ...]

    @property
    def met(self) -> bool:
        """Tell whether everything that is asked is met."""
        return all(each.met for each in self.outcomes)


def analyse(file: SensorFile, spec: SensorSpec | None = None) -> Analysis:
    """Analyse the sensor of a file, or one that a search has made of it.

    Raises
    ------
    LoopUnstableError, LoopRingsError
        If its loop grows, or rings longer than can be followed.
    NoResponseError
        If nothing is felt at all.
    """
    spec = file.spec if spec is None else spec
    sensor, asked = sensor_of(spec, file.catalogue), spec.requirements
    _require_followable(sensor, spec.window)
    felt = feel(sensor, spec.window)
    found = felt.rises(Metric.TEN_TO_NINETY)
    if not found.end_value.any():
        raise NoResponseError(f"nothing is felt within {spec.window:g} s")
    open_loop = None
    if isinstance(sensor.drive, HeldTemperature):
        open_loop = feel(replace(sensor, drive=HeldPower()), spec.window)
    reached = outcomes(asked, felt)
    missed = [each for each in reached if not each.met]
    warmth, margin = heat_of(felt), loop_margin(sensor)
    tolerances = tolerances_of(sensor, spec, file.catalogue, metric_of(asked))
    return Analysis(
        file=file,
        spec=spec,
        sensor=sensor,
        felt=felt,
        open_loop=open_loop,
        responses=(*_responses(felt), *(() if open_loop is None else _responses(open_loop))),
        spectra=spectra_of(sensor, spec.window),
        rational=rational_models(felt),
        crosstalk=crosstalk_of(sensor, crosstalk_time(asked) or spec.window),
        discrimination=() if asked.discrimination is None else pairs(asked, felt, until=spec.window),
        range=() if asked.range is None else grades(asked, felt),
        heat=warmth,
        own_heat=_own_heat(sensor),
        signal_noise=signal_noise(sensor),
        loop_margin=margin,
        outcomes=reached,
        binding=binding_of(asked, missed, sensor, spec.window),
        tolerances=tolerances,
        warnings=(*_warnings(file, spec, sensor, warmth, margin), *_of_tolerances(asked, reached, tolerances)),
    )


def _require_followable(sensor: Sensor, window: float) -> None:
    if isinstance(sensor.drive, HeldTemperature):
        require_stable(sensor.stack, sensor.front, sensor.drive.loop)
        for each in sensor.touches:
            require_followable(sensor.stack, each, sensor.drive.loop, np.array([window]))


def _responses(felt: Felt) -> Iterator[ScenarioResponse]:
    sensor = felt.sensor
    slow, quick = felt.rises(Metric.TEN_TO_NINETY), felt.rises(Metric.SIXTY_THREE)
    recovery = recovery_times(sensor, sensor.touches, felt.window, slow.end_value)
    for i, scenario in enumerate(sensor.scenarios):
        yield ScenarioResponse(
            scenario=scenario,
            drive=sensor.drive.mode,
            unit=sensor.drive.unit,
            gain=float(slow.end_value[i]) / scale(sensor),
            per="W/m^2" if sensor.drive.mode == "pulse" else "K",
            rise_10_90=float(slow.seconds[i]),
            rise_63=float(quick.seconds[i]),
            start=float(slow.start[i]),
            end=float(slow.end[i]),
            end_value=float(slow.end_value[i]),
            window=felt.window,
            recovery=float(recovery[i]),
        )


def _own_heat(sensor: Sensor) -> SelfHeating | None:
    if sensor.readout is None:
        return None
    return own_heat(sensor.stack, sensor.front, sensor.readout, sensor.temperatures.face)


def _of_tolerances(asked: RequirementsSpec, reached: Sequence[Outcome], tolerances: Tolerances | None) -> Iterator[str]:
    """Warn where a rise time is met only by the tables' own values."""
    spec = asked.rise_time
    if tolerances is None or spec is None or spec.metric not in METRICS:
        return
    met = all(each.met for each in reached if each.name == "rise_time")
    if met and tolerances.worst > spec.at_most:
        yield (
            f"the rise time is met by the tables' values, but not with all of their tolerances at their worst: "
            f"{1e3 * tolerances.worst:.3g} ms then, and {1e3 * spec.at_most:.3g} ms are asked"
        )


def _warnings(file: SensorFile, spec: SensorSpec, sensor: Sensor, warmth: Heat, margin: float) -> Iterator[str]:
    for entry in spec.stack:
        part = file.catalogue.parts.get(entry.film.part or "") if entry.film is not None else None
        if part is not None and part.capacity is not None and part.capacity.warning:
            yield f"the heat capacity of {part.title} is doubtful: {part.capacity.warning}"
    drive = sensor.drive
    if not warmth.can_hold(sensor.temperatures.difference):
        yield (
            f"without any heating the touched face is {warmth.surplus:.3g} K warmer than stated: base, air and the "
            "bridge's own current warm it"
        )
    if isinstance(drive, HeldTemperature) and warmth.hold >= 0 > warmth.least:
        yield (
            f"the heater would have to cool ({warmth.least:.3g} W/m²): it cannot, so that what the loop is said to do "
            "after a touch of something warmer holds for small differences alone"
        )
    if isinstance(drive, HeldTemperature) and margin < ENOUGH_LOOP_MARGIN:
        yield f"the loop is near its limit: 1 + L comes as near to 0 as {margin:.2g}; {ENOUGH_LOOP_MARGIN:g} is usual"
    if isinstance(drive, HeldPower) and drive.power is not None:
        needed = warmth.hold
        if abs(drive.power - needed) > UNEQUAL * max(abs(needed), drive.power):
            yield (
                f"the stated heater power is {drive.power:.3g} W/m², but the touched face is at its stated temperature "
                f"with {needed:.3g} W/m²"
            )
