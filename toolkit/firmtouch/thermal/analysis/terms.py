"""The physical quantities that a requirement may depend on, and how to change each in a sensor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from firmtouch.thermal.sensor import HeldTemperature, Pad, Sensor
from firmtouch.thermal.stack import Air, Backing, Disc, Element, Film, HalfSpace, Layer, Material, Stack


@dataclass(frozen=True, slots=True)
class Term:
    """A physical quantity of a sensor, and how to change it by a factor f >= 1 in the direction that may help."""

    name: str
    unit: str
    value: Callable[[Sensor], float | None]
    changed: Callable[[Sensor, float], Sensor]


def _conductance(sensor: Sensor) -> float:
    return min(each.conductance for each in sensor.touches)


def _better_contact(sensor: Sensor, f: float) -> Sensor:
    touches = [replace(each, conductance=each.conductance * f) for each in sensor.touches]
    scenarios = zip(sensor.scenarios, touches, strict=True)
    return replace(sensor, scenarios=tuple(replace(each, touch=touch) for each, touch in scenarios))


def _worse_contact(sensor: Sensor, f: float) -> Sensor:
    return _better_contact(sensor, 1 / f)


def _with_elements(sensor: Sensor, change: Callable[[int, Element], Element], backing: Backing | None = None) -> Sensor:
    stack = sensor.stack
    elements = tuple(change(i, each) for i, each in enumerate(stack.elements))
    return replace(sensor, stack=Stack(elements, stack.sensed, backing or stack.backing))


def _film_capacity(sensor: Sensor) -> float | None:
    return sum(each.areal_capacity for each in sensor.stack.elements if isinstance(each, Film)) or None


def _less_film(sensor: Sensor, f: float) -> Sensor:
    return _with_elements(sensor, lambda _, each: Film(each.areal_capacity / f) if isinstance(each, Film) else each)


def _depth(sensor: Sensor) -> float | None:
    front = sensor.stack.elements[: sensor.stack.sensed]
    return sum(each.thickness for each in front if isinstance(each, Layer)) or None


def _shallower(sensor: Sensor, f: float) -> Sensor:
    def change(i: int, each: Element) -> Element:
        return replace(each, thickness=each.thickness / f) if _before(sensor, i) and isinstance(each, Layer) else each

    return _with_elements(sensor, change)


def _before(sensor: Sensor, i: int) -> bool:
    return i < sensor.stack.sensed


def _backing_effusivity(sensor: Sensor) -> float | None:
    behind = sensor.stack.elements[sensor.stack.sensed :]
    layers = [each.material.effusivity for each in behind if isinstance(each, Layer)]
    if layers:
        return layers[0]
    return sensor.stack.backing.material.effusivity if isinstance(sensor.stack.backing, HalfSpace) else None


def _lighter_backing(sensor: Sensor, f: float) -> Sensor:
    def lighter(material: Material) -> Material:
        return Material(material.name, material.conductivity / f, material.density / f, material.heat_capacity)

    def change(i: int, each: Element) -> Element:
        if _before(sensor, i) or not isinstance(each, Layer):
            return each
        return replace(each, material=lighter(each.material))

    backing = sensor.stack.backing
    match backing:
        case HalfSpace(material=material):
            backing = HalfSpace(lighter(material))
        case Air(conductance=h):
            backing = Air(h / f)
    return _with_elements(sensor, change, backing)


def _thinner(sensor: Sensor, f: float) -> Sensor:
    return _with_elements(
        sensor, lambda _, each: replace(each, thickness=each.thickness / f) if isinstance(each, Layer) else each
    )


def _of_loop(name: str) -> Callable[[Sensor], float | None]:
    def value(sensor: Sensor) -> float | None:
        drive = sensor.drive
        return getattr(drive.loop, name) or None if isinstance(drive, HeldTemperature) else None

    return value


def _loop_changed(name: str, direction: int) -> Callable[[Sensor, float], Sensor]:
    def changed(sensor: Sensor, f: float) -> Sensor:
        drive = sensor.drive
        assert isinstance(drive, HeldTemperature)
        size = getattr(drive.loop, name) * f**direction
        return replace(sensor, drive=replace(drive, loop=replace(drive.loop, **{name: size})))

    return changed


def _difference(sensor: Sensor) -> float | None:
    return abs(sensor.temperatures.difference) or None


def _difference_changed(direction: int) -> Callable[[Sensor, float], Sensor]:
    def changed(sensor: Sensor, f: float) -> Sensor:
        at = sensor.temperatures
        face = at.object - at.difference * f**direction
        base = face if at.base == at.face else at.base
        return replace(sensor, temperatures=replace(at, face=face, base=base))

    return changed


def _noise(sensor: Sensor) -> float | None:
    return None if sensor.readout is None else sensor.readout.noise


def _quieter(sensor: Sensor, f: float) -> Sensor:
    assert sensor.readout is not None
    return replace(sensor, readout=replace(sensor.readout, noise=sensor.readout.noise / f))


def _prior(sensor: Sensor) -> float | None:
    return sensor.unknown.ln_h or None


def _known_contact(sensor: Sensor, f: float) -> Sensor:
    return replace(sensor, unknown=replace(sensor.unknown, ln_h=sensor.unknown.ln_h / f))


def _voltage(sensor: Sensor) -> float | None:
    bridge = sensor.readout.bridge if sensor.readout is not None else None
    return None if bridge is None else bridge.voltage


def _lower_voltage(sensor: Sensor, f: float) -> Sensor:
    assert sensor.readout is not None
    assert sensor.readout.bridge is not None
    bridge = replace(sensor.readout.bridge, voltage=sensor.readout.bridge.voltage / f)
    return replace(sensor, readout=replace(sensor.readout, bridge=bridge))


def _pad(name: str) -> Callable[[Sensor], float | None]:
    return lambda sensor: None if sensor.pad is None else getattr(sensor.pad, name)


def _wider_pitch(sensor: Sensor, f: float) -> Sensor:
    assert sensor.pad is not None
    return replace(sensor, pad=replace(sensor.pad, pitch=sensor.pad.pitch * f))


def _smaller_pad(sensor: Sensor, f: float) -> Sensor:
    assert sensor.pad is not None
    pad: Pad = replace(sensor.pad, radius=sensor.pad.radius / f)
    smaller = tuple(
        replace(each, touch=replace(each.touch, object=replace(each.touch.object, radius=pad.radius)))
        if isinstance(each.touch.object, Disc)
        else each
        for each in sensor.scenarios
    )
    return replace(sensor, pad=pad, scenarios=smaller)


CONTACT: Final = Term("contact conductance", "W/m^2/K", _conductance, _better_contact)
FILM: Final = Term("film capacity", "J/m^2/K", _film_capacity, _less_film)
DEPTH: Final = Term("depth diffusion", "m", _depth, _shallower)
BACKING: Final = Term("backing", "W s^(1/2)/m^2/K", _backing_effusivity, _lighter_backing)
GAIN: Final = Term("loop gain", "W/m^2/K", _of_loop("gain"), _loop_changed("gain", 1))
LOWER_GAIN: Final = Term("loop gain", "W/m^2/K", _of_loop("gain"), _loop_changed("gain", -1))
LAG: Final = Term("sensor lag", "s", _of_loop("sensor_lag"), _loop_changed("sensor_lag", -1))
DEAD_TIME: Final = Term("dead time", "s", _of_loop("dead_time"), _loop_changed("dead_time", -1))
WARMER: Final = Term("temperature difference", "K", _difference, _difference_changed(1))
COOLER: Final = Term("temperature difference", "K", _difference, _difference_changed(-1))
NOISE: Final = Term("noise", "K", _noise, _quieter)
PRIOR: Final = Term("knowledge of the contact", "1", _prior, _known_contact)
VOLTAGE: Final = Term("bridge voltage", "V", _voltage, _lower_voltage)
PITCH: Final = Term("pitch", "m", _pad("pitch"), _wider_pitch)
PAD: Final = Term("pad radius", "m", _pad("radius"), _smaller_pad)
LAYERS: Final = Term("thickness of the layers", "m", lambda sensor: sensor.stack.thickness or None, _thinner)
WORSE_CONTACT: Final = Term("contact conductance", "W/m^2/K", _conductance, _worse_contact)

_FAST: Final = (CONTACT, FILM, DEPTH, BACKING, GAIN, LAG, DEAD_TIME)
_TELLING: Final = (NOISE, WARMER, PRIOR, *_FAST)
TERMS_OF: Final[dict[str, tuple[Term, ...]]] = {
    "rise_time": (*_FAST, NOISE, WARMER, PRIOR),
    "discrimination": _TELLING,
    "range": _TELLING,
    "crosstalk": (PITCH, PAD),
    "surface_temperature": (COOLER,),
    "power_pad": (PAD, COOLER, WORSE_CONTACT),
    "power_array": (PAD, COOLER, WORSE_CONTACT),
    "self_heating": (VOLTAGE,),
    "feedback": (VOLTAGE,),
    "loop_margin": (LOWER_GAIN, LAG, DEAD_TIME),
    "recovery": (FILM, LAYERS, BACKING, GAIN),
    "pitch": (Term("pitch", "m", _pad("pitch"), lambda sensor, f: _wider_pitch(sensor, 1 / f)),),
    "thickness": (LAYERS,),
}
