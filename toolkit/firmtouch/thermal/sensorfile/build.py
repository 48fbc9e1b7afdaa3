"""A checked specification -> the `Sensor` that it describes."""

from __future__ import annotations

import math

from firmtouch.thermal.contact import Roughness, contact_conductance
from firmtouch.thermal.contact_event import Pulse
from firmtouch.thermal.electronics import Bridge, Reading, noise
from firmtouch.thermal.loop import Loop
from firmtouch.thermal.readout import Readout
from firmtouch.thermal.sensor import (
    Drive,
    HeldPower,
    HeldTemperature,
    Pad,
    Pulsed,
    Scenario,
    Sensor,
    Temperatures,
    TwoFaces,
    Unknown,
    air_before,
)
from firmtouch.thermal.sensorfile.specification import SensorSpec
from firmtouch.thermal.sensorfile.stack import BackingSpec, SensingElement, StackEntry
from firmtouch.thermal.sensorfile.touch import LEVELS, ContactSpec, ObjectSpec
from firmtouch.thermal.stack import (
    Adiabatic,
    Air,
    Backing,
    Base,
    Contact,
    Disc,
    Element,
    Film,
    HalfSpace,
    Layer,
    Material,
    Slab,
    Stack,
    Touch,
    TouchedObject,
)
from firmtouch.thermal.tables.catalogue import Catalogue
from firmtouch.thermal.thermometer import NTC, RTD, SteinhartHart, Thermometer


def sensor_of(spec: SensorSpec, catalogue: Catalogue) -> Sensor:
    """Build what a specification describes, of a catalogue that has its materials and parts."""
    stack = Stack(
        tuple(_element(each, catalogue) for each in spec.stack),
        sensed=_plane(spec, spec.sensed),
        backing=_backing(spec.backing, catalogue),
    )
    pad = _pad(spec)
    return Sensor(
        stack=stack,
        heater=_plane(spec, spec.heated),
        drive=_drive(spec, pad),
        temperatures=_temperatures(spec),
        scenarios=_scenarios(spec, catalogue, pad),
        unknown=Unknown(spec.contact.prior, spec.temperatures.prior),
        pad=pad,
        readout=_readout(spec, catalogue, pad),
    )


def _pad(spec: SensorSpec) -> Pad | None:
    if spec.pad is None:
        return None
    pitch = math.inf if spec.pad.pitch is None else spec.pad.pitch
    return Pad(spec.pad.radius, pitch, spec.pad.rows, spec.pad.columns)


def _element(entry: StackEntry, catalogue: Catalogue) -> Element:
    if entry.film is not None:
        return Film(entry.film.areal_capacity(catalogue))
    if entry.joint is not None:
        return Contact(entry.joint)
    assert entry.material is not None
    assert entry.thickness is not None
    return Layer(catalogue.materials[entry.material], entry.thickness)


def _plane(spec: SensorSpec, entry: int) -> int:
    """Give the plane that a mark at an entry means: a film's own, a layer's inner face."""
    return entry if spec.stack[entry].film is not None else entry + 1


def _backing(backing: BackingSpec, catalogue: Catalogue) -> Backing:
    if backing.half_space is not None:
        return HalfSpace(catalogue.materials[backing.half_space])
    if backing.air is not None:
        return Air(backing.air)
    return Base() if backing.end == "base" else Adiabatic()


def _temperatures(spec: SensorSpec) -> Temperatures:
    """Take the base at the sensor's temperature and the air at the object's, where nothing else is said."""
    given = spec.temperatures
    ambient = given.object if given.ambient is None else given.ambient
    base = given.sensor if given.base is None else given.base
    return Temperatures(given.object, given.sensor, ambient if spec.backing.air is not None else base, ambient)


def _drive(spec: SensorSpec, pad: Pad | None) -> Drive:
    drive = spec.drive
    flux = drive.flux
    if drive.power is not None:
        assert pad is not None
        flux = drive.power / pad.area
    match drive.mode:
        case "constant_temperature":
            assert drive.loop_gain is not None
            loop = Loop(
                gain=drive.loop_gain,
                heater=_plane(spec, spec.heated),
                integral_gain=drive.integral_gain,
                sensor_lag=drive.sensor_lag,
                dead_time=drive.delay,
            )
            return HeldTemperature(loop, reads_power=spec.signal == "power")
        case "pulse":
            assert flux is not None
            whole = drive.duration is None or drive.duration >= spec.window
            return Pulsed(Pulse(flux, _plane(spec, spec.heated), float("inf") if whole else float(drive.duration or 0)))
        case "two_temperature":
            assert drive.second is not None
            return TwoFaces(drive.second)
        case _:
            return HeldPower(flux)


def _scenarios(spec: SensorSpec, catalogue: Catalogue, pad: Pad | None) -> tuple[Scenario, ...]:
    """List every object with every contact; conductances of pressures depend on the object too."""
    air = air_before(_temperatures(spec), second=spec.drive.mode == "two_temperature")
    return tuple(
        Scenario(each.called, level, Touch(_object(each, catalogue, pad), h, air))
        for each in spec.objects
        for level, h in _conductances(spec, catalogue, catalogue.materials[each.material])
    )


def _object(each: ObjectSpec, catalogue: Catalogue, pad: Pad | None) -> TouchedObject:
    material = catalogue.materials[each.material]
    if pad is not None:
        return Disc(material, pad.radius, math.inf if each.thickness is None else each.thickness)
    return HalfSpace(material) if each.thickness is None else Slab(material, each.thickness)


def _conductances(spec: SensorSpec, catalogue: Catalogue, touched: Material) -> list[tuple[str, float]]:
    contact = spec.contact
    if contact.pressure is None:
        return [(level, h) for level in LEVELS if (h := getattr(contact, level)) is not None]
    levels = LEVELS if len(contact.pressure) == len(LEVELS) else ("nominal",)
    cover = _cover(spec, catalogue) or touched
    return [
        (level, contact_conductance(pressure, _roughness(contact), cover.conductivity, touched.conductivity).total)
        for level, pressure in zip(levels, contact.pressure, strict=True)
    ]


def _roughness(contact: ContactSpec) -> Roughness:
    assert contact.roughness is not None
    return Roughness(contact.roughness, contact.slope, contact.hardness)


def _cover(spec: SensorSpec, catalogue: Catalogue) -> Material | None:
    """Give the material of the touched face, as far as the file tells it."""
    first = spec.stack[0]
    name = first.material or (first.film.material if first.film is not None else None)
    return None if name is None else catalogue.materials[name]


def _readout(spec: SensorSpec, catalogue: Catalogue, pad: Pad | None) -> Readout | None:
    """Take the noise as measured, or add it up from the bridge on."""
    given = spec.electronics
    if given is None:
        return None
    bandwidth = given.sampling / 2 if given.bandwidth is None else given.bandwidth
    if given.temperature_noise is not None:
        return Readout(given.sampling, given.temperature_noise, bandwidth)
    film = spec.stack[spec.sensed].film
    assert film is not None
    assert given.bridge_voltage is not None
    part = None if film.part is None else catalogue.parts[film.part]
    element = film.element(part)
    assert element is not None
    bridge = Bridge(_thermometer(element), given.bridge_voltage)
    reading = Reading(given.noise_density or 0.0, bandwidth, given.gain, given.adc_bits, given.adc_range)
    sources = noise(bridge, reading, spec.temperatures.sensor)
    area = film.area or (None if part is None else part.footprint) or (None if pad is None else pad.area)
    return Readout(given.sampling, sources.netd.total, bandwidth, bridge, sources, area)


def _thermometer(element: SensingElement) -> Thermometer:
    if element.steinhart_hart is not None:
        return SteinhartHart(*element.steinhart_hart)
    if element.B is not None:
        return NTC(element.resistance, element.B, element.at)
    assert element.coefficient is not None
    return RTD(element.resistance, element.coefficient, element.at)
