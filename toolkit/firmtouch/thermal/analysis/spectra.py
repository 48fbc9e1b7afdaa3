"""Frequency responses of a sensor: of its signal for each object, and of its loop with the margins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.thermal.analysis.felt import least_distance
from firmtouch.thermal.arrays import Array, Complex
from firmtouch.thermal.loop import loop_transfer
from firmtouch.thermal.quadrupole import frequency_response, heater_transfer
from firmtouch.thermal.sensor import HeldTemperature, Pulsed, Scenario, Sensor
from firmtouch.thermal.signals import contact_signal
from firmtouch.thermal.stack import Front, Touch

TURN: Final = 2 * math.pi
USUAL: Final = "nominal"
PER_DECADE: Final = 30
LOWEST: Final = 0.1
"""Of the inverse of the window: the lowest frequency (rad/s)."""
HIGHEST: Final = 1e8
"""rad/s: no sensor has anything to say beyond."""
FAINTEST: Final = 1e-4
"""Of the largest magnitude: where all responses are less, nothing more is shown."""


@dataclass(frozen=True, slots=True, eq=False)
class SignalSpectrum:
    """Magnitude (in `unit`) and phase (rad, unwrapped) of a signal's transfer function H(j omega) for one object.

    `bandwidth` (rad/s) is the highest frequency with |H| at least its largest value by sqrt(2); `inf` where that is
    beyond the last.
    """

    object: str
    unit: str
    magnitude: Array
    phase: Array
    bandwidth: float


@dataclass(frozen=True, slots=True, eq=False)
class LoopSpectrum:
    """Magnitude and phase (rad) of a loop's L(j omega) with one object before it, or with `None`, and its margins.

    `crossover` (rad/s) is where |L| falls below 1 for the last time, and `phase_margin` (rad) the least distance of the
    phase there and at other such places from -pi; `gain_margin` is the least factor on L that makes it pass -1. They
    are `inf` where there is none. `modulus_margin` is the least |1 + L|.
    """

    object: str | None
    magnitude: Array
    phase: Array
    crossover: float
    gain_margin: float
    phase_margin: float
    modulus_margin: float


@dataclass(frozen=True, slots=True, eq=False)
class Spectra:
    """Frequency responses at omega (rad/s), in the usual contact; without a loop, `loops` is empty."""

    omega: Array
    signals: tuple[SignalSpectrum, ...]
    loops: tuple[LoopSpectrum, ...]


def usual(sensor: Sensor) -> tuple[Scenario, ...]:
    """Give the scenarios of the usual contact, one of each object."""
    return tuple(each for each in sensor.scenarios if each.level == USUAL)


def signal_unit(sensor: Sensor) -> str:
    """Give the unit of H(s)."""
    match sensor.drive:
        case HeldTemperature(reads_power=True):
            return "W/m^2/K"
        case Pulsed():
            return "K m^2/W"
        case _:
            return "K/K"


def signal_transfer(sensor: Sensor, touches: Sequence[Touch], s: Complex, *, prompt: bool = False) -> Complex:
    """Give H(s) of the signal by what makes it, a row for each touch; `prompt`, without its dead time.

    Of a pulse it is that for the heater's power; the part that T_o - T_s makes besides is that of a constant power.
    """
    if isinstance(sensor.drive, Pulsed):
        return heater_transfer(sensor.stack, touches, s, heater=sensor.drive.pulse.heater)
    return contact_signal(sensor, touches, s, prompt=prompt)


def spectra_of(sensor: Sensor, window: float) -> Spectra:
    """Compute the frequency responses from 0.1/window up to where they have faded."""
    lowest = LOWEST / window
    decades = math.log10(HIGHEST / lowest)
    whole = np.geomspace(lowest, HIGHEST, math.ceil(PER_DECADE * decades) + 1)
    scenarios = usual(sensor)
    touches = [each.touch for each in scenarios]
    H, unit = signal_transfer(sensor, touches, 1j * whole), signal_unit(sensor)
    size = np.abs(H)
    heard = np.flatnonzero((size > FAINTEST * size.max()).any(axis=0))
    end = min(int(heard[-1]) + 2, whole.size)
    omega = whole[:end]
    signals = []
    for each, row in zip(scenarios, H, strict=True):
        magnitude, phase = frequency_response(row)
        phase = phase - TURN * (phase[0] > TURN / 4)  # of what begins at +-180 degrees, -180
        signals.append(SignalSpectrum(each.object, unit, magnitude[:end], phase[:end], _bandwidth(whole, magnitude)))
    return Spectra(omega, tuple(signals), _loops(sensor, scenarios, whole, end))


def _bandwidth(omega: Array, magnitude: Array) -> float:
    level = float(magnitude.max()) / math.sqrt(2)
    last = int(np.flatnonzero(magnitude >= level)[-1])
    return math.inf if last + 1 == omega.size else _crossing(omega, magnitude, last, level)


def _crossing(omega: Array, size: Array, i: int, level: float) -> float:
    """Interpolate in logarithms where a magnitude passes a level, between the frequencies i and i + 1."""
    part = math.log(size[i] / level) / math.log(size[i] / size[i + 1])
    return float(omega[i] * (omega[i + 1] / omega[i]) ** part)


def _loops(sensor: Sensor, scenarios: tuple[Scenario, ...], omega: Array, end: int) -> tuple[LoopSpectrum, ...]:
    if not isinstance(sensor.drive, HeldTemperature):
        return ()
    fronts: list[Front] = [sensor.front, *(each.touch for each in scenarios)]
    L = loop_transfer(sensor.stack, fronts, sensor.drive.loop, 1j * omega)
    names = [None, *(each.object for each in scenarios)]
    margins = [
        least_distance(sensor.stack, front, sensor.drive.loop, omega, np.abs(1 + row))
        for front, row in zip(fronts, L, strict=True)
    ]
    return tuple(_loop(name, row, omega, end, margin) for name, row, margin in zip(names, L, margins, strict=True))


def _loop(name: str | None, L: Complex, omega: Array, end: int, margin: float) -> LoopSpectrum:
    magnitude, phase = frequency_response(L)
    falls = np.flatnonzero((magnitude[:-1] >= 1) != (magnitude[1:] >= 1))
    at = [_crossing(omega, magnitude, int(i), 1.0) for i in falls]
    phases = [float(np.interp(math.log(w), np.log(omega), phase)) for w in at]
    distances = [abs((each + TURN) % TURN - math.pi) for each in phases]
    return LoopSpectrum(
        object=name,
        magnitude=magnitude[:end],
        phase=phase[:end],
        crossover=at[-1] if at else math.inf,
        gain_margin=_gain_margin(L),
        phase_margin=min(distances, default=math.inf),
        modulus_margin=margin,
    )


def _gain_margin(L: Complex) -> float:
    """Give the least factor > 1 at which L passes -1: 1/|L| where it crosses the negative real axis, interpolated."""
    down = np.flatnonzero((L.imag[:-1] < 0) != (L.imag[1:] < 0))
    part = L.imag[down] / (L.imag[down] - L.imag[down + 1])
    real = L.real[down] + part * (L.real[down + 1] - L.real[down])
    found = [-1 / float(each) for each in real if -1 < each < 0]
    return min(found, default=math.inf)
