"""`Study` -> `thermal.json`, schema `firmtouch.thermal/1`, and `responses.csv`: numbers in SI, full precision."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping
from typing import Any, Final

from firmtouch.thermal.analysis import Analysis, Binding, Outcome, Relief, ScenarioResponse, Tolerances
from firmtouch.thermal.search import Candidate, SearchResult
from firmtouch.thermal.sensor import HeldPower, HeldTemperature, Pulsed, Sensor, TwoFaces
from firmtouch.thermal.sensorfile.stack import StackEntry
from firmtouch.thermal.stack import Contact, Element, Film, Layer
from firmtouch.thermal.study import Study

SCHEMA: Final = "firmtouch.thermal/1"


def study_as_json(study: Study) -> dict[str, Any]:
    """Give a study as plain data for JSON; what is infinite or unknown is null."""
    analysis = study.analysis
    file = analysis.file
    return {
        "schema": SCHEMA,
        "file": {"name": file.name, "title": file.spec.title, "sha256": file.sha256, "source": file.document.text},
        "sensor": _sensor(analysis),
        "responses": [_response(each) for each in analysis.responses],
        "crosstalk": [_values(each) for each in analysis.crosstalk],
        "discrimination": [_values(each) for each in analysis.discrimination],
        "range": [_values(each) for each in analysis.range],
        "noise": _noise(analysis.sensor),
        "heat": {**_values(analysis.heat), **_of_pads(analysis)},
        "self_heating": None if analysis.own_heat is None else _values(analysis.own_heat),
        "loop_margin": _plain(analysis.loop_margin),
        "requirements": [_outcome(each) for each in analysis.outcomes],
        "verdict": study.verdict,
        "binding": None if analysis.binding is None else _binding(analysis.binding),
        "tolerances": None if analysis.tolerances is None else _tolerances(analysis.tolerances),
        "search": None if study.search is None else _search(study.search),
        "warnings": list(analysis.warnings),
    }


def responses_as_csv(analysis: Analysis) -> str:
    """Give the signals over time: `t` in s, and a column for each object and contact, its unit in its name."""
    felt, text = analysis.felt, io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    unit = analysis.sensor.drive.unit
    writer.writerow(["t [s]", *(f"{each.object} {each.level} [{unit}]" for each in analysis.sensor.scenarios)])
    for t, row in zip(felt.t, felt.values.T, strict=True):
        writer.writerow([f"{t:.6g}", *(f"{each:.9g}" for each in row)])
    return text.getvalue()


def _plain(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _values(value: Any) -> dict[str, Any]:  # noqa: ANN401  # a frozen dataclass of numbers and words
    names: Iterable[str] = type(value).__dataclass_fields__
    fields = ((name, getattr(value, name)) for name in names)
    return {name: _plain(each) if isinstance(each, float) else each for name, each in fields}


def _sensor(analysis: Analysis) -> dict[str, Any]:
    sensor, spec = analysis.sensor, analysis.spec
    entries = zip(spec.stack, sensor.stack.elements, strict=True)
    pad = sensor.pad
    return {
        "stack": [_entry(entry, element) for entry, element in entries],
        "sensed_plane": sensor.stack.sensed,
        "heated_plane": sensor.heater,
        "backing": {"kind": spec.backing.end or ("half_space" if spec.backing.half_space is not None else "air"),
                    "material": spec.backing.half_space, "conductance": spec.backing.air},
        "thickness": sensor.stack.thickness,
        "contacts": [
            {"object": each.object, "level": each.level, "conductance": _plain(each.touch.conductance)}
            for each in sensor.scenarios
        ],
        "temperatures": {**_values(sensor.temperatures), "difference": sensor.temperatures.difference},
        "drive": {"mode": sensor.drive.mode, "signal_unit": sensor.drive.unit, **_drive(sensor)},
        "pad": None if pad is None else {**_values(pad), "area": pad.area},
    }  # fmt: skip


def _entry(entry: StackEntry, element: Element) -> dict[str, Any]:
    base: dict[str, Any] = {"name": entry.name, "sensed": entry.sensed, "heated": entry.heated}
    match element:
        case Layer(material=material, thickness=thickness):
            sizes = {"k": material.conductivity, "rho": material.density, "c": material.heat_capacity}
            return {**base, "kind": "layer", "material": material.name, "thickness": thickness, **sizes}
        case Film(areal_capacity=capacity):
            film = entry.film
            assert film is not None
            of = {"material": film.material, "thickness": film.thickness, "part": film.part, "area": film.area}
            return {**base, "kind": "film", **of, "areal_capacity": capacity}
        case Contact(conductance=h):
            return {**base, "kind": "joint", "conductance": h}


def _drive(sensor: Sensor) -> Mapping[str, Any]:
    match sensor.drive:
        case HeldPower(power=power):
            return {"power": power}
        case HeldTemperature(loop=loop):
            return _values(loop)
        case Pulsed(pulse=pulse):
            return {"power": pulse.power, "duration": _plain(pulse.duration)}
        case TwoFaces(second=second):
            return {"second": second}


def _response(each: ScenarioResponse) -> dict[str, Any]:
    return {
        "object": each.scenario.object,
        "contact": each.scenario.level,
        "contact_conductance": _plain(each.scenario.touch.conductance),
        "drive": each.drive,
        "unit": each.unit,
        "gain": _plain(each.gain),
        "gain_per": each.per,
        "rise_time_10_90": _plain(each.rise_10_90),
        "rise_time_63": _plain(each.rise_63),
        "end_value": _plain(each.end_value),
        "window": each.window,
        "recovery": _plain(each.recovery),
    }


def _noise(sensor: Sensor) -> dict[str, Any] | None:
    readout = sensor.readout
    if readout is None:
        return None
    sources = None if readout.sources is None else {
        "voltage": _values(readout.sources.voltage), "temperature": _values(readout.sources.netd)
    }  # fmt: skip
    return {"rate": readout.rate, "bandwidth": readout.bandwidth, "temperature": readout.noise, "sources": sources}


def _of_pads(analysis: Analysis) -> dict[str, Any]:
    pad = analysis.sensor.pad
    if pad is None:
        return {}
    one = analysis.heat.most * pad.area
    return {"pad": _plain(one), "array": _plain(one * pad.count)}


def _outcome(each: Outcome) -> dict[str, Any]:
    return {
        "name": each.name,
        "asked": each.asked,
        "reached": _plain(each.reached),
        "margin": _plain(each.margin),
        "unit": each.unit,
        "sense": "at_most" if each.at_most else "at_least",
        "met": each.met,
        "where": each.where,
    }


def _binding(binding: Binding) -> dict[str, Any]:
    return {
        "requirement": binding.outcome.name,
        "term": binding.term,
        "alone": [_relief(each) for each in binding.alone],
        "together": [_relief(each) for each in binding.together],
    }


def _relief(each: Relief) -> dict[str, Any]:
    return {"term": each.term, "unit": each.unit, "now": each.now, "needed": each.needed, "reached": each.reached}


def _tolerances(found: Tolerances) -> dict[str, Any]:
    seconds = {"nominal": _plain(found.nominal), "likely": _plain(found.likely), "worst": _plain(found.worst)}
    return {"metric": found.metric.value, **seconds, "effects": [_values(each) for each in found.effects]}


def _search(found: SearchResult) -> dict[str, Any]:
    variables = found.variables
    return {
        "objective": found.spec.objective,
        "tried": found.tried,
        "met": found.met,
        "variables": [
            {
                "path": list(each.path),
                "unit": each.unit,
                **({"choices": list(each.choices)} if each.choices else {"low": each.low, "high": each.high}),
                "chosen": found.chosen.values[each.path],
            }
            for each in variables
        ],
        "front": None if found.front is None else {
            "objectives": list(found.front.objectives),
            "units": list(found.front.units),
            "designs": [_candidate(each) for each in found.front.designs],
        },
    }  # fmt: skip


def _candidate(each: Candidate) -> dict[str, Any]:
    return {
        "figures": {name: _plain(value) for name, value in each.figures.items()},
        "values": [{"path": list(path), "value": value} for path, value in each.values.items()],
    }
