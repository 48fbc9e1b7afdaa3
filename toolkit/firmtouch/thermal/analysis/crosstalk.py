"""What a pad feels of its neighbours' heat: through the object, in its signal, and through its own layers."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.thermal.arrays import Complex
from firmtouch.thermal.inversion import euler, talbot
from firmtouch.thermal.loop import power_transfer
from firmtouch.thermal.neighbours import array_crosstalk, point_source_transfer, substrate_crosstalk
from firmtouch.thermal.pad import object_crosstalk
from firmtouch.thermal.quadrupole import contact_transfer, heater_transfer
from firmtouch.thermal.sensor import HeldTemperature, Pad, Scenario, Sensor
from firmtouch.thermal.signals import contact_signal
from firmtouch.thermal.stack import Base, HalfSpace, Material, Touch

NEGLIGIBLE: Final = 1e-12
"""A share that is less than this is none."""


@dataclass(frozen=True, slots=True)
class Crosstalk:
    """What a neighbour's heat does at a time (s) after both have touched an object.

    `neighbour`: the change of the object's face under the next pad, of that under the pad itself, at equal heat flows;
    this is what blurs the object's own share of a signal. `array`: the same of all other pads together. `signal`: what
    the next pad takes off this one's signal, of that signal. `substrate`: a bound for the way through the layers.
    """

    object: str
    time: float
    neighbour: float
    array: float
    signal: float
    substrate: float


def object_share(scenario: Scenario, pad: Pad, at: float) -> float:
    """Give `Crosstalk.neighbour` alone; an object whose temperature is held passes nothing on."""
    body = _body(scenario.touch)
    if body is None:
        return 0.0
    material, thickness = body
    return _clean(float(object_crosstalk(material, pad.radius, pad.pitch, np.array([at]), thickness=thickness)[0]))


def crosstalk_of(sensor: Sensor, at: float) -> tuple[Crosstalk, ...]:
    """Give the cross-talk of each object at a time (s), in its best contact; none without a pitch."""
    pad = sensor.pad
    if pad is None or math.isinf(pad.pitch):
        return ()
    best = {each.object: each for each in sensor.scenarios}  # the last level is the best contact
    t = np.array([at])
    gap = pad.pitch - 2 * pad.radius
    substrate = 1.0 if gap <= 0 else _clean(float(substrate_crosstalk(sensor.stack, gap, t)[0]))
    return tuple(
        Crosstalk(
            object=each.object,
            time=at,
            neighbour=object_share(each, pad, at),
            array=_array_share(each, pad, at),
            signal=_signal_share(sensor, each.touch, pad, at),
            substrate=substrate,
        )
        for each in best.values()
    )


def _body(touch: Touch) -> tuple[Material, float] | None:
    match touch.object:
        case Base():
            return None
        case HalfSpace(material=material):
            return material, math.inf
        case each:
            return each.material, each.thickness


def _array_share(scenario: Scenario, pad: Pad, at: float) -> float:
    body = _body(scenario.touch)
    if body is None or pad.count == 1:
        return 0.0
    material, thickness = body
    t, (rows, columns) = np.array([at]), (pad.rows, pad.columns)
    found = array_crosstalk(material, pad.radius, pad.pitch, t, rows=rows, columns=columns, thickness=thickness)
    return _clean(float(found[0]))


def _signal_share(sensor: Sensor, touch: Touch, pad: Pad, at: float) -> float:
    """Compare both signals per kelvin of T_o - T_s: the neighbour's is driven by the object's face under it."""
    body, t = _body(touch), np.array([at])
    if body is None:
        return 0.0

    def own(s: Complex) -> Complex:
        return contact_signal(sensor, touch, s)

    def other(s: Complex) -> Complex:
        passed = point_source_transfer(body[0], pad.pitch, s, thickness=body[1])
        return own(s) * pad.area * _flux(sensor, touch, s) * passed

    invert = euler if isinstance(sensor.drive, HeldTemperature) else talbot
    signal, part = float(invert(lambda s: own(s) / s, t)[0]), float(invert(lambda s: other(s) / s, t)[0])
    return _clean(abs(part / signal)) if signal else math.inf


def _flux(sensor: Sensor, touch: Touch, s: Complex) -> Complex:
    """Give q''/dV out of the object; what a loop's heater adds to the face's temperature makes it less."""
    found = contact_transfer(sensor.stack, touch, s)
    if not isinstance(sensor.drive, HeldTemperature):
        return found.flux
    power = power_transfer(sensor.stack, touch, sensor.drive.loop, s)
    face = heater_transfer(sensor.stack, touch, s, heater=sensor.heater, plane=0)
    return np.asarray(found.flux * (1 - face * power / (1 - found.face)))


def _clean(share: float) -> float:
    """Take what an inversion cannot tell from nothing as nothing."""
    return share if share > NEGLIGIBLE else 0.0
