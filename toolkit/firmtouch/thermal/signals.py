"""What a sensor feels: its drive's signal after a touch, as a function of time, and the noise in it.

`response` is the careful way for one touch: a loop that grows, or rings longer than can be followed, is refused.
`responses` is the fast one for many touches at once, unchecked, for a search; both compute the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from firmtouch.thermal.arrays import Array, Complex, Response
from firmtouch.thermal.contact_event import ContactEvent, pulse_response, two_temperatures
from firmtouch.thermal.inversion import EULER_ORDER, euler, step
from firmtouch.thermal.loop import (
    loop_transfer,
    power_after_dead_time,
    power_response,
    power_transfer,
    temperature_response,
    temperature_transfer,
)
from firmtouch.thermal.quadrupole import contact_transfer
from firmtouch.thermal.sensor import Drive, HeldPower, HeldTemperature, Pulsed, Sensor, TwoFaces
from firmtouch.thermal.stack import Front, Touch

FREQUENCIES: Final = 120
"""Over which a loop's noise is added up, from a thousandth of the bandwidth on."""


def scale(sensor: Sensor) -> float:
    """Give what the signal is proportional to: T_o - T_s or T_2 - T_1 (K), or a pulse's power (W/m2).

    The signal of a pulse has a part that T_o - T_s makes besides.
    """
    match sensor.drive:
        case TwoFaces(second=second):
            return second - sensor.temperatures.face
        case Pulsed(pulse=pulse):
            return pulse.power
        case _:
            return sensor.temperatures.difference


def response(sensor: Sensor, touch: Touch, drive: Drive | None = None) -> Response:
    """Give the signal (K or W/m2) after a touch; another drive than the sensor's own may be asked for.

    Its calls raise LoopUnstableError, LoopRingsError and InversionError, as those of `loop`.
    """
    stack, temperatures, drive = sensor.stack, sensor.temperatures, drive or sensor.drive
    difference = temperatures.difference
    match drive:
        case HeldPower():
            return lambda t: ContactEvent(stack, touch, difference).temperature(t)
        case HeldTemperature(loop=loop, reads_power=reads_power):
            of_loop = power_response if reads_power else temperature_response
            return lambda t: difference * of_loop(stack, touch, loop, t)
        case Pulsed(pulse=pulse):
            event = ContactEvent(stack, touch, difference)
            return lambda t: event.temperature(t) + pulse_response(stack, touch, pulse, t)
        case TwoFaces(second=second):
            faces, T_o = (temperatures.face, second), temperatures.object
            return lambda t: two_temperatures(stack, touch, t, faces=faces, object_temperature=T_o).difference


def responses(sensor: Sensor, touches: Sequence[Touch], t: Array, *, order: int = EULER_ORDER) -> Array:
    """Give the signals after several touches, one row for each; nothing is checked.

    `order` is that of Euler's method, by which loops are inverted: 10 leaves errors of some 1e-6.
    """
    match sensor.drive:
        case HeldTemperature():
            return _of_loop(sensor, touches, t, order)
        case Pulsed(pulse=pulse):
            found = sensor.temperatures.difference * _contacts(sensor, touches, t)
            return found + pulse_response(sensor.stack, touches, pulse, t)
        case _:
            return scale(sensor) * _contacts(sensor, touches, t)


def contact_signal(sensor: Sensor, touches: Touch | Sequence[Touch], s: Complex, *, prompt: bool = False) -> Complex:
    """Give the signal by T_o - T_s, times 1/s for the step at contact; `prompt`, as from its dead time on.

    Of a pulse it is the part that T_o - T_s makes.
    """
    match sensor.drive:
        case HeldTemperature(loop=loop, reads_power=True):
            return (power_after_dead_time if prompt else power_transfer)(sensor.stack, touches, loop, s)
        case HeldTemperature(loop=loop):
            return temperature_transfer(sensor.stack, touches, loop, s)
        case _:
            return contact_transfer(sensor.stack, touches, s).sensed


def dead_time(sensor: Sensor) -> float:
    """Give for how long (s) a signal is zero after the touch."""
    drive = sensor.drive
    return drive.loop.dead_time if isinstance(drive, HeldTemperature) and drive.reads_power else 0.0


def _contacts(sensor: Sensor, touches: Sequence[Touch], t: Array) -> Array:
    return step(lambda s: contact_signal(sensor, touches, s), t)


def _of_loop(sensor: Sensor, touches: Sequence[Touch], t: Array, order: int) -> Array:
    late = dead_time(sensor)
    found = np.zeros((len(touches), t.size))
    after = t > late
    found[:, after] = euler(lambda s: contact_signal(sensor, touches, s, prompt=True) / s, t[after] - late, order=order)
    return sensor.temperatures.difference * found


def signal_noise(sensor: Sensor) -> float | None:
    """Give the noise of one sample of the signal (K or W/m2); None without a readout.

    Two pads have sqrt(2) times the noise of one. A loop makes power of it: sigma_p^2 is the mean of |K/(1 + L)|^2 over
    the bandwidth, times sigma^2, with the object that makes most of it; the noise is that of what is read, so it does
    not pass the lag F of the sensor before it reaches the controller. That of the power is least at low frequencies,
    and is taken as white here, which promises too little rather than too much.
    """
    readout = sensor.readout
    if readout is None:
        return None
    match sensor.drive:
        case TwoFaces():
            return math.sqrt(2) * readout.noise
        case HeldTemperature(loop=loop, reads_power=True):
            f = readout.bandwidth * np.concatenate([[0.0], np.geomspace(1e-3, 1, FREQUENCIES)])
            s = 2j * np.pi * np.where(f == 0, 1e-6 * readout.bandwidth, f)
            fronts: list[Front] = [sensor.front, *sensor.touches]
            density = np.abs(loop.controller(s) / (1 + loop_transfer(sensor.stack, fronts, loop, s))) ** 2
            mean = np.trapezoid(density, f, axis=1) / readout.bandwidth
            return float(readout.noise * np.sqrt(mean.max()))
        case _:
            return readout.noise
