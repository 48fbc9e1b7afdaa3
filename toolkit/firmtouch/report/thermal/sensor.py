"""The sensor: its stack, what it touches, and how it is driven and read."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

from firmtouch.report.document import Block, Line, Paragraph, Section, Table
from firmtouch.report.numbers import number
from firmtouch.report.thermal.stack_view import backing_words, entry_kind, entry_name, is_heated
from firmtouch.report.thermal.words import MODES, breakable, celsius, percent, quantity, range_words
from firmtouch.thermal.analysis import Analysis
from firmtouch.thermal.sensor import HeldPower, HeldTemperature, Pad, Pulsed, TwoFaces
from firmtouch.thermal.stack import Base, Contact, Film, Layer, Slab

NONE: Final = "–"
SIZES: Final = "k in W/mK, ρc in MJ/m³K, e in W√s/m²K"


def section(analysis: Analysis) -> Section:
    """Write the sensor."""
    blocks: list[Block] = [
        _stack(analysis),
        Paragraph(("What it touches, and the conductance h of the contact:",)),
        _objects(analysis),
        Paragraph(("How it is used, driven and read:",)),
        Table((("what",), ("value",)), tuple(_settings(analysis)), wide=frozenset({1})),
    ]
    return Section("The sensor", tuple(blocks))


def _stack(analysis: Analysis) -> Table:
    headings: tuple[Line, ...] = (
        ("entry",), ("kind",), ("material",), ("thickness",), ("k",), ("ρc",), ("e",),
        ("C″",),
    )  # fmt: skip
    spec, rows = analysis.spec, []
    for i, (entry, element) in enumerate(zip(spec.stack, analysis.sensor.stack.elements, strict=True)):
        marks = [word for word, at in (("sensed", spec.sensed), ("heated", spec.heated)) if at == i]
        marks = [each for each in marks if each == "sensed" or is_heated(spec)]
        name = entry_name(entry, i) + (f" ({', '.join(marks)})" if marks else "")
        material = entry.material or (entry.film.material or entry.film.part if entry.film is not None else None)
        cells = [name, entry_kind(entry), material or NONE]
        match element:
            case Layer(material=m, thickness=L):
                capacity = m.volumetric_capacity
                cells += [quantity(L, "m"), number(m.conductivity, 3), number(capacity / 1e6, 3)]
                cells += [number(m.effusivity, 4), number(capacity * L, 3)]
            case Film(areal_capacity=C):
                thickness = None if entry.film is None else entry.film.thickness
                cells += [NONE if thickness is None else quantity(thickness, "m"), NONE, NONE, NONE, number(C, 3)]
            case Contact(conductance=h):
                cells += [f"h = {quantity(h, 'W/m^2/K')}", NONE, NONE, NONE, NONE]
        rows.append(tuple((breakable(each),) for each in cells))
    caption = (f"From the touched face inward; behind it: {backing_words(analysis)}. {SIZES}, C″ in J/m²K.",)
    return Table(headings, tuple(rows), frozenset(range(3, 8)), caption)


def _objects(analysis: Analysis) -> Table:
    levels = list(dict.fromkeys(each.level for each in analysis.sensor.scenarios))
    names = {"low": "bad", "nominal": "usual", "high": "good"}
    headings: tuple[Line, ...] = (
        ("object",), ("material",), ("as",), ("k",), ("ρc",), ("e",),
        *((f"h, {names[each]}",) for each in levels),
    )  # fmt: skip
    by_object = {(each.object, each.level): each.touch for each in analysis.sensor.scenarios}
    rows: list[tuple[Line, ...]] = []
    for each in analysis.spec.objects:
        touched = by_object[each.called, levels[0]].object
        if isinstance(touched, Base):
            continue
        form = f"plate, {quantity(touched.thickness, 'm')}" if isinstance(touched, Slab) else "deep"
        if each.thickness is not None and not isinstance(touched, Slab):
            form = "taken as deep"
        m = touched.material
        cells = [each.called, each.material, form, number(m.conductivity, 3), number(m.volumetric_capacity / 1e6, 3)]
        cells += [number(m.effusivity, 4), *(number(by_object[each.called, level].conductance, 3) for level in levels)]
        rows.append(tuple((breakable(cell),) for cell in cells))
    return Table(headings, tuple(rows), frozenset(range(3, 6 + len(levels))), (f"{SIZES}, h in W/m²K.",))


def _settings(analysis: Analysis) -> Iterator[tuple[Line, ...]]:
    for name, value in _pairs(analysis):
        yield (name,), (value,)


def _pairs(analysis: Analysis) -> Iterator[tuple[str, str]]:
    spec, at = analysis.spec, analysis.sensor.temperatures
    contact = spec.contact
    if contact.pressure is not None and contact.roughness is not None:
        pressed = range_words(contact.pressure, "Pa")
        yield "contact", f"pressed with {pressed}, roughness {quantity(contact.roughness, 'm')} (both faces together)"
    yield (
        "temperatures",
        (
            f"object {celsius(at.object)}, touched face {celsius(at.face)}, behind {celsius(at.base)}, "
            f"air {celsius(at.ambient)}"
        ),
    )
    yield "drive", _drive(analysis)
    pad = analysis.sensor.pad
    if pad is None:
        yield "pad", "wide: heat flows in one dimension"
    else:
        yield "pad", f"a disc of radius {quantity(pad.radius, 'm')}{_beside(pad)}"
    electronics = spec.electronics
    if electronics is None:
        yield "electronics", "none stated, so that nothing is said of noise"
    elif electronics.temperature_noise is not None:
        yield (
            "electronics",
            (
                f"{quantity(electronics.temperature_noise, 'K')} of noise in a sample, as measured; "
                f"{quantity(electronics.sampling, 'Hz')} sampling"
            ),
        )
    else:
        yield "electronics", "; ".join(_chain(analysis))


def _beside(pad: Pad) -> str:
    if math.isinf(pad.pitch):
        return ""
    many = f"{pad.rows} × {pad.columns} of them" if pad.count > 1 else "the next one"
    return f", {many} at a pitch of {quantity(pad.pitch, 'm')}"


def _drive(analysis: Analysis) -> str:
    drive = analysis.sensor.drive
    words = MODES[drive.mode]
    match drive:
        case HeldTemperature(loop=loop, reads_power=reads_power):
            parts = [f"gain {quantity(loop.gain, 'W/m^2/K')}"]
            if loop.integral_gain:
                parts.append(f"integral gain {number(loop.integral_gain, 3)} W/m²Ks")
            if loop.sensor_lag:
                parts.append(f"sensor lag {quantity(loop.sensor_lag, 's')}")
            if loop.dead_time:
                parts.append(f"dead time {quantity(loop.dead_time, 's')}")
            signal = "the heater's power" if reads_power else "the temperature that is left"
            return f"{words} ({', '.join(parts)}); the signal is {signal}"
        case Pulsed(pulse=pulse):
            lasts = "as long as the window" if math.isinf(pulse.duration) else f"for {quantity(pulse.duration, 's')}"
            return f"{words} of {quantity(pulse.power, 'W/m^2')}, {lasts}; the signal is the temperature"
        case TwoFaces(second=second):
            return f"{words}, the second at {celsius(second)}; the signal is the difference of both"
        case HeldPower(power=power):
            size = "what holds the touched face at its temperature" if power is None else quantity(power, "W/m^2")
            return f"{words}: {size}; the signal is the temperature"


def _chain(analysis: Analysis) -> Iterator[str]:
    given = analysis.spec.electronics
    assert given is not None
    assert given.bridge_voltage is not None
    yield f"half-bridge at {quantity(given.bridge_voltage, 'V')}"
    if given.noise_density is not None:
        yield f"amplifier with {number(1e9 * given.noise_density, 3)} nV/√Hz, gain {number(given.gain)}"
    if given.adc_bits is not None and given.adc_range is not None:
        yield f"converter of {given.adc_bits} bits over {quantity(given.adc_range, 'V')}"
    yield f"{quantity(given.sampling, 'Hz')} sampling"
    readout = analysis.sensor.readout
    if readout is not None:
        yield f"noise in a bandwidth of {quantity(readout.bandwidth, 'Hz')}"


def prior_words(analysis: Analysis) -> str:
    """Say what is taken to be unknown of a touch."""
    unknown, parts = analysis.sensor.unknown, []
    if unknown.ln_h:
        parts.append(f"the contact's h within {percent(unknown.ln_h)}")
    if unknown.temperature:
        parts.append(f"the object's temperature within {quantity(unknown.temperature, 'K')}")
    return " and ".join(parts)
