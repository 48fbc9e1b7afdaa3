"""Rational models of a sensor's signal, one for each object in the usual contact."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.thermal.analysis.felt import Felt
from firmtouch.thermal.analysis.spectra import signal_transfer, signal_unit, usual
from firmtouch.thermal.arrays import Complex, Response
from firmtouch.thermal.inversion import euler, talbot
from firmtouch.thermal.loop_reduction import LoopReduction, reduce_loop
from firmtouch.thermal.metrics import Metric
from firmtouch.thermal.reduction import Reduction, reduce_step
from firmtouch.thermal.sensor import HeldTemperature, Sensor
from firmtouch.thermal.signals import dead_time
from firmtouch.thermal.stack import Touch

EARLIEST: Final = 0.1
"""Of the time to 10 % of the end value: where a model begins to hold."""
LEAST: Final = 1e-6
"""Of the window: it begins there where a response is at 10 % at once."""


@dataclass(frozen=True, slots=True)
class RationalModel:
    """A rational model of the signal by what makes it (`unit`), for one object.

    A loop is closed exactly around reduced channels, and has complex poles; but one with a dead time is fitted as a
    whole, by real poles. `dead_time` (s) is not in it: e^{-s T_d} goes before it.
    """

    object: str
    unit: str
    reduction: Reduction | LoopReduction
    dead_time: float


def rational_models(felt: Felt) -> tuple[RationalModel, ...]:
    """Reduce the unit step responses of the usual contact, each from a tenth of its start to the window's end."""
    return tuple(_models(felt))


def _models(felt: Felt) -> Iterator[RationalModel]:
    sensor, late = felt.sensor, dead_time(felt.sensor)
    start, window = felt.rises(Metric.TEN_TO_NINETY).start, felt.window - late
    for each in usual(sensor):
        begins = float(start[sensor.scenarios.index(each)]) - late
        earliest = max(EARLIEST * begins, LEAST * window)
        if not earliest < window:  # nothing is felt
            continue
        yield RationalModel(each.object, signal_unit(sensor), _reduced(sensor, each.touch, earliest, window), late)


def _reduced(sensor: Sensor, touch: Touch, earliest: float, window: float) -> Reduction | LoopReduction:
    drive = sensor.drive
    if isinstance(drive, HeldTemperature) and not drive.loop.dead_time:
        power = drive.reads_power
        return reduce_loop(sensor.stack, touch, drive.loop, earliest=earliest, window=window, reads_power=power)
    return reduce_step(_unit_step(sensor, touch), earliest=earliest, window=window)


def _unit_step(sensor: Sensor, touch: Touch) -> Response:
    """Give the step response of H(s), without its dead time."""

    def transform(s: Complex) -> Complex:
        return np.asarray(signal_transfer(sensor, [touch], s, prompt=True)[0] / s)

    if isinstance(sensor.drive, HeldTemperature):
        return lambda t: euler(transform, t)
    return lambda t: talbot(transform, t)
