"""A sensor's stack as its picture shows it."""

from __future__ import annotations

from firmtouch.report.figures.thermal import Band, Plane, StackView
from firmtouch.report.thermal.words import celsius, quantity, range_words
from firmtouch.thermal.analysis import Analysis
from firmtouch.thermal.sensorfile.specification import SensorSpec
from firmtouch.thermal.sensorfile.stack import StackEntry
from firmtouch.thermal.stack import Adiabatic, Air, Base, Film, HalfSpace


def entry_name(entry: StackEntry, place: int) -> str:
    """Name an entry of the stack, counted from 0; one without a name by its kind and place."""
    return entry.name or f"{entry_kind(entry)} {place + 1}"


def entry_kind(entry: StackEntry) -> str:
    """Say what an entry is."""
    return "film" if entry.film is not None else "joint" if entry.joint is not None else "layer"


def stack_view(analysis: Analysis) -> StackView:
    """Collect the words and sizes of a picture."""
    spec, sensor = analysis.spec, analysis.sensor
    conductances = [each.touch.conductance for each in sensor.scenarios]
    return StackView(
        touched=", ".join(each.called for each in spec.objects),
        contact=f"contact, h = {range_words(conductances, 'W/m^2/K')}",
        bands=tuple(_band(analysis, entry, i) for i, entry in enumerate(spec.stack)),
        sensed=_plane(spec, spec.sensed),
        heated=_plane(spec, spec.heated) if is_heated(spec) else None,
        backing=backing_words(analysis),
        backing_kind=backing_kind(analysis),
    )


def is_heated(spec: SensorSpec) -> bool:
    """Tell whether a heater's plane matters: it is marked, or the drive is of power."""
    return any(each.heated for each in spec.stack) or spec.drive.mode in {"constant_temperature", "pulse"}


def _plane(spec: SensorSpec, entry: int) -> Plane:
    return Plane(entry, inner=spec.stack[entry].film is None)


def _band(analysis: Analysis, entry: StackEntry, i: int) -> Band:
    kind, name = entry_kind(entry), entry_name(entry, i)
    if entry.film is not None:
        film = entry.film
        element = analysis.sensor.stack.elements[i]
        assert isinstance(element, Film)
        capacity = quantity(element.areal_capacity, "J/m^2/K")
        size = capacity if film.thickness is None else quantity(film.thickness, "m")
        return Band(name, film.material or film.part or "", None, size, kind)
    if entry.joint is not None:
        return Band(name, "", None, quantity(entry.joint, "W/m^2/K"), kind)
    assert entry.thickness is not None
    return Band(name, entry.material or "", entry.thickness, quantity(entry.thickness, "m"), kind)


def backing_kind(analysis: Analysis) -> str:
    """Say what kind of backing a stack has."""
    match analysis.sensor.stack.backing:
        case Base():
            return "base"
        case Adiabatic():
            return "adiabatic"
        case Air():
            return "air"
        case HalfSpace():
            return "half_space"


def backing_words(analysis: Analysis) -> str:
    """Say what is behind a stack."""
    at = analysis.sensor.temperatures
    match analysis.sensor.stack.backing:
        case Base():
            return f"base, held at {celsius(at.base)}"
        case Adiabatic():
            return "insulated: no heat passes"
        case Air(conductance=h):
            return f"air at {celsius(at.ambient)}, {quantity(h, 'W/m^2/K')}"
        case HalfSpace(material=material):
            return f"{material.name}, as deep as heat gets"
