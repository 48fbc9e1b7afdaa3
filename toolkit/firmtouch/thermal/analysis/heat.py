"""The heat that a sensor takes: to be warm, while it touches, and until it is warm again."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np

from firmtouch.thermal.analysis.felt import FINE, Grid
from firmtouch.thermal.arrays import Array, Complex, ThermalValueError
from firmtouch.thermal.contact_event import pulse_response, while_on
from firmtouch.thermal.inversion import EULER_ORDER, euler, step
from firmtouch.thermal.loop import power_transfer
from firmtouch.thermal.metrics import DENSER
from firmtouch.thermal.quadrupole import contact_transfer, heater_transfer, of_touch
from firmtouch.thermal.readout import reading_power
from firmtouch.thermal.sensor import HeldPower, HeldTemperature, Pulsed, Sensor
from firmtouch.thermal.signals import responses, scale
from firmtouch.thermal.stack import Base, Touch

TOO_WARM: Final = 0.05
"""Of T_o - T_s: a face that is so much warmer than stated without any heating is not held at all."""
RESIDUE: Final = 0.1
"""A sensor can feel again when what is left of a touch is below this share of its signal."""
DECADES: Final = 5.0
"""Of the touch's duration: where its heat flow is resolved, after the touch and before the release."""
LONGEST: Final = 1e4
"""Times the touch: a recovery that takes longer counts as none."""


@dataclass(frozen=True, slots=True)
class Heat:
    """A pad's heater power by area (W/m2): `hold` untouched, and the `most` and `least` in all scenarios' windows.

    `hottest` (K) is the highest temperature of the touched face. A loop whose `least` is negative would have to cool.
    `surplus` (K) is by how much the untouched face is warmer than stated without any heating, colder if negative: base,
    air and the bridge's own current warm it, and no heater cools.
    """

    hold: float
    most: float
    least: float
    most_in: str
    hottest: float
    surplus: float

    def can_hold(self, difference: float) -> bool:
        """Tell whether a heater can hold the stated temperature, but for some of T_o - T_s (K)."""
        return self.surplus <= TOO_WARM * abs(difference)


def hold_power(sensor: Sensor) -> float:
    """Give P'' (W/m2) that holds the touched face at its temperature, untouched, between the base and the air.

    Raises
    ------
    ThermalValueError
        If the heater is on the base, which it cannot warm.
    """
    unheated, warmed = _unheated(sensor)
    if not warmed:
        raise ThermalValueError("heater's plane", sensor.heater, "one whose temperature the base does not hold")
    return (sensor.temperatures.face - unheated) / warmed


def _unheated(sensor: Sensor) -> tuple[float, float]:
    """Give the untouched face's temperature (K) without any power, and what a heater's power adds (m2K/W)."""
    at, rest = sensor.temperatures, np.zeros(1)
    with np.errstate(invalid="ignore"):
        by_air = contact_transfer(sensor.stack, Touch(Base(), sensor.front.conductance), rest, plane=0).sensed
        by_power = heater_transfer(sensor.stack, sensor.front, rest, heater=sensor.heater, plane=0)
    share = float(by_air[0].real)
    return share * at.ambient + (1 - share) * at.base, float(by_power[0].real)


def _surplus(sensor: Sensor) -> float:
    at, rest = sensor.temperatures, np.zeros(1)
    with np.errstate(invalid="ignore"):
        by_bridge = heater_transfer(sensor.stack, sensor.front, rest, plane=0)
    return _unheated(sensor)[0] + reading_power(sensor.readout, at.face) * float(by_bridge[0].real) - at.face


def heat(sensor: Sensor, t: Array, values: Array) -> Heat:
    """Give the powers of a sensor whose signals at times t are `values`, one row for each scenario."""
    hold, drive, hottest = hold_power(sensor), sensor.drive, sensor.temperatures.face
    most, least, where = hold, hold, ""
    match drive:
        case HeldTemperature():
            by_power = replace(sensor, drive=replace(drive, reads_power=True))
            powers = values if drive.reads_power else responses(by_power, sensor.touches, t)
            i = int(powers.max(axis=1).argmax())
            most, least = hold + max(0.0, float(powers.max())), hold + min(0.0, float(powers.min()))
            where = sensor.scenarios[i].words if powers.max() > 0 else ""
        case HeldPower(power=power) if power is not None:
            most = least = power
        case Pulsed(pulse=pulse):
            most = hold + pulse.power
            end = np.array([min(pulse.duration, float(t[-1]))])
            risen = step(lambda s: heater_transfer(sensor.stack, sensor.front, s, heater=sensor.heater, plane=0), end)
            hottest += max(0.0, pulse.power * float(risen[0]))
        case _:
            hottest = max(hottest, getattr(drive, "second", hottest))
    return Heat(hold, most, least, where, hottest, _surplus(sensor))


@dataclass(frozen=True, slots=True, eq=False)
class Release:
    """What is left of the signal after a touch: `values` at the times t (s) since the release."""

    t: Array
    values: Array


def release(sensor: Sensor, touches: Sequence[Touch], duration: float, *, grid: Grid = FINE) -> Release:
    """Follow the signal after touches of a duration (s), one row each; a loop goes on holding, a pulse ends.

    Until the release the untouched network, fed with a flux q''(t) into its face, does what the touched one does
    (substitution theorem), so the signal after it is that network's: with S(t) for a step of flux, the sum of q_i (S(t
    - t_i) - S(t - t_i+1)) over intervals, in each of which q'' is taken where 1/sqrt(t) has its mean, and what is left
    of a pulse. With the fine grid's knots recovery times are within 5e-4, with the coarse one's within 2e-3.
    """
    from scipy.interpolate import make_interp_spline

    breaks = [0.0, duration]
    if isinstance(sensor.drive, Pulsed) and sensor.drive.pulse.duration < duration:
        breaks.insert(1, sensor.drive.pulse.duration)
    ends, inside = _intervals(breaks, grid.knots)
    q = flux_into(sensor, touches, inside, order=grid.order)
    since = duration * np.logspace(-DECADES, math.log10(LONGEST), grid.knots * 3 // 2)
    t = np.geomspace(since[0], (duration + since[-1]) * 1.001, 3 * grid.knots)
    S = make_interp_spline(np.log(t), _untouched_step(sensor, t), k=3)
    steps = S(np.log(duration + since[:, np.newaxis] - ends))  # times by ends
    left = -q @ np.diff(steps, axis=1).T
    if isinstance(sensor.drive, Pulsed):
        pulse = replace(sensor.drive.pulse, duration=min(sensor.drive.pulse.duration, duration))
        left += pulse_response(sensor.stack, sensor.front, pulse, duration + since)
    return Release(since, left)


def _intervals(breaks: Sequence[float], knots: int) -> tuple[Array, Array]:
    """Cut the time between breaks finely next to them; give the intervals' ends, and where each has its mean flux."""
    ends, inside = [np.zeros(1)], []
    for start, end in pairwise(breaks):
        half = (end - start) / 2 * np.logspace(-DECADES, 0, knots // 2 + 1)
        since = np.concatenate([[0.0], half, end - start - half[-2::-1], [end - start]])
        ends.append(start + since[1:])
        inside.append(start + ((np.sqrt(since[1:]) + np.sqrt(since[:-1])) / 2) ** 2)
    return np.concatenate(ends), np.concatenate(inside)


def flux_into(sensor: Sensor, touches: Sequence[Touch], t: Array, *, order: int = EULER_ORDER) -> Array:
    """Give q'' (W/m2) that does to the untouched face what touches do, at times t (s), with the drive's part in it.

    It is what the object gives, what the air took before and takes no more, and what the air before an untouched face
    would take, h_air theta_face.
    """
    stack, heater, scaled = sensor.stack, sensor.heater, scale(sensor)
    air = sensor.front.conductance

    def of_contact(s: Complex) -> Complex:
        found = contact_transfer(stack, touches, s)
        return np.asarray(found.flux + air * found.face - of_touch(touches, s, lambda each: each.air))

    def of_heater(s: Complex) -> Complex:
        """Give the same per heater power, of which the object takes theta_face/(1/h + Z_o)."""
        found = contact_transfer(stack, touches, s)
        face = heater_transfer(stack, touches, s, heater=heater, plane=0)
        return np.asarray(face * (air - found.flux / (1 - found.face)))

    match sensor.drive:
        case HeldTemperature(loop=loop):

            def held(s: Complex) -> Complex:
                return (of_contact(s) + of_heater(s) * power_transfer(stack, touches, loop, s)) / s

            return scaled * euler(held, t, order=order)
        case Pulsed(pulse=pulse):
            found = sensor.temperatures.difference * step(of_contact, t)
            return found + pulse.power * while_on(of_heater, pulse, t)
        case _:
            return scaled * step(of_contact, t)


def _untouched_step(sensor: Sensor, t: Array) -> Array:
    """Give the untouched signal of a step of flux into the face."""

    def open_loop(s: Complex) -> Complex:
        return heater_transfer(sensor.stack, sensor.front, s, heater=0)

    match sensor.drive:
        case HeldTemperature(loop=loop, reads_power=reads_power):

            def closed(s: Complex) -> Complex:
                driven = loop.controller(s) * loop.sensor(s)
                passage = heater_transfer(sensor.stack, sensor.front, s, heater=loop.heater)
                return np.asarray((-driven if reads_power else 1) * open_loop(s) / (1 + driven * passage) / s)

            return euler(closed, t)
        case _:
            return step(open_loop, t)


def recovery_times(
    sensor: Sensor, touches: Sequence[Touch], duration: float, end_values: Array, *, grid: Grid = FINE
) -> Array:
    """Give the times (s) after release until what is left of each signal stays below a tenth of its end value."""
    from scipy.interpolate import make_interp_spline

    after = release(sensor, touches, duration, grid=grid)
    x = np.log(after.t)
    dense = np.linspace(x[0], x[-1], DENSER * (x.size - 1) + 1)
    left = np.abs(make_interp_spline(x, after.values, k=3, axis=1)(dense))
    share = left / np.abs(np.where(end_values == 0, np.inf, end_values))[:, np.newaxis]
    found = np.zeros(len(touches))
    for i, each in enumerate(share):
        above = np.flatnonzero(each > RESIDUE)
        if not above.size:
            continue
        last = int(above[-1])
        if last + 1 == each.size:
            found[i] = math.inf
            continue
        found[i] = math.exp(np.interp(-RESIDUE, -each[last : last + 2], dense[last : last + 2]))
    return found
