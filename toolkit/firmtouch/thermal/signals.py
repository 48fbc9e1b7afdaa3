"""What a sensor feels: its drive's signal after a touch, as a function of time.

`response` is the careful way for one touch: a loop that grows, or rings longer than can be followed, is refused.
`responses` is the fast one for many touches at once, unchecked, for a search; both compute the same.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from firmtouch.thermal.arrays import Array, Complex, Response
from firmtouch.thermal.contact_event import ContactEvent, pulse_response, two_temperatures
from firmtouch.thermal.inversion import EULER_ORDER, euler, step
from firmtouch.thermal.loop import power_after_dead_time, power_response, temperature_response, temperature_transfer
from firmtouch.thermal.quadrupole import contact_transfer, heater_transfer
from firmtouch.thermal.sensor import Drive, HeldPower, HeldTemperature, Pulsed, Sensor, TwoFaces
from firmtouch.thermal.stack import Touch


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
            return _of_loop(sensor, sensor.drive, touches, t, order)
        case Pulsed(pulse=pulse):
            found = sensor.temperatures.difference * _contacts(sensor, touches, t)
            return found + pulse_response(sensor.stack, touches, pulse, t)
        case _:
            return scale(sensor) * _contacts(sensor, touches, t)


def _contacts(sensor: Sensor, touches: Sequence[Touch], t: Array) -> Array:
    return step(lambda s: contact_transfer(sensor.stack, touches, s).sensed, t)


def _of_loop(sensor: Sensor, drive: HeldTemperature, touches: Sequence[Touch], t: Array, order: int) -> Array:
    loop, transfer = drive.loop, power_after_dead_time if drive.reads_power else temperature_transfer
    late = loop.dead_time if drive.reads_power else 0.0

    def transform(s: Complex) -> Complex:
        return np.asarray(transfer(sensor.stack, touches, loop, s) / s)

    found = np.zeros((len(touches), t.size))
    after = t > late
    found[:, after] = euler(transform, t[after] - late, order=order)
    return sensor.temperatures.difference * found


def untouched_transfer(sensor: Sensor, s: Complex) -> Complex:
    """Give theta/P'' (m2K/W) of the sensed plane for the heater's power, while nothing is touched."""
    return heater_transfer(sensor.stack, sensor.front, s, heater=sensor.heater)
