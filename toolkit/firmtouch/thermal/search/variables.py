"""What a search may choose, as a vector of numbers, and the specification that such a vector makes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from firmtouch.thermal.arrays import Array
from firmtouch.thermal.fields import ABSOLUTE_ZERO
from firmtouch.thermal.sensorfile.specification import SensorSpec

Path = tuple[str, ...]
Value = float | int | str
UNITS: Final = {
    "thickness": "m", "nominal": "W/m^2/K", "pressure": "Pa", "loop_gain": "W/m^2/K", "power": "W", "flux": "W/m^2",
    "radius": "m", "pitch": "m", "sensor": "K", "sampling": "Hz", "bridge_voltage": "V",
}  # fmt: skip
LINEAR: Final = frozenset({"sensor"})
"""Searched in itself; all other sizes are searched in their logarithm."""


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable of a search: a size between two bounds, or a choice among values."""

    path: Path
    low: float = 0.0
    high: float = 0.0
    choices: tuple[Value, ...] = ()

    @property
    def name(self) -> str:
        """Name it for readers: `cover thickness`, `loop gain`."""
        words = self.path[1:] if self.path[0] == "stack" or self.path[-1] == "loop_gain" else self.path
        return " ".join(words).replace("_", " ")

    @property
    def unit(self) -> str:
        """Give its unit; none of a choice."""
        return "" if self.choices else UNITS[self.path[-1]]

    @property
    def bounds(self) -> tuple[float, float]:
        """Give the bounds of its coordinate."""
        if self.choices:
            return 0.0, float(len(self.choices) - 1)
        if self.path[-1] in LINEAR:
            return self.low, self.high
        return math.log(self.low), math.log(self.high)

    def value(self, coordinate: float) -> Value:
        """Give the value that a coordinate stands for."""
        if self.choices:
            return self.choices[round(coordinate)]
        value = coordinate if self.path[-1] in LINEAR else math.exp(coordinate)
        return min(max(value, self.low), self.high)

    def rounded(self, value: Value) -> Value:
        """Round a size to three figures and a temperature to a tenth of a degree Celsius, within the bounds."""
        if not isinstance(value, float):
            return value
        celsius = round(value + ABSOLUTE_ZERO, 1) - ABSOLUTE_ZERO
        return min(max(celsius if self.path[-1] in LINEAR else float(f"{value:.2e}"), self.low), self.high)

    def coordinate(self, value: Value | None) -> float:
        """Give the coordinate of a value, or of the nearest that is allowed; of the middle where there is none."""
        low, high = self.bounds
        if self.choices:
            return float(self.choices.index(value)) if value in self.choices else low
        if not isinstance(value, (int, float)):
            return (low + high) / 2
        inside = min(max(float(value), self.low), self.high)
        return inside if self.path[-1] in LINEAR else math.log(inside)


def variables_of(spec: SensorSpec) -> tuple[Variable, ...]:
    """List the variables of a specification's search."""
    search = spec.search
    assert search is not None
    found = []
    for path in search.variables():
        entry = search.stack[path[1]] if path[0] == "stack" else getattr(search, path[0])
        asked = getattr(entry, path[-1])
        of_choices = path[-1] in {"material", "part", "mode", "adc_bits"}
        found.append(Variable(path, choices=asked) if of_choices else Variable(path, *asked))
    return tuple(found)


def values_at(variables: tuple[Variable, ...], x: Array) -> dict[Path, Value]:
    """Give the values that a vector stands for."""
    return {each.path: each.value(float(at)) for each, at in zip(variables, x, strict=True)}


def value_of(spec: SensorSpec, path: Path) -> Value | None:
    """Give the value that a specification has where a variable stands."""
    if path[0] == "stack":
        entry = spec.entry(path[1])
        holder: Any = entry.film if entry.film is not None else entry
    else:
        holder = getattr(spec, path[0])
    found = getattr(holder, path[-1])
    if path[-1] == "pressure":
        found = found[len(found) // 2]
    value: Value | None = found
    return value


def with_values(spec: SensorSpec, values: Mapping[Path, Value]) -> SensorSpec:
    """Put values in the places of variables; low and high contacts keep their ratio to the usual one."""
    groups: dict[str, dict[str, Any]] = {}
    entries: dict[str, dict[str, Value]] = {}
    for path, value in values.items():
        if path[0] == "stack":
            entries.setdefault(path[1], {})[path[-1]] = value
        elif path[0] == "contact":
            groups.setdefault("contact", {}).update(_contact(spec, path[-1], float(value)))
        else:
            groups.setdefault(path[0], {})[path[-1]] = value
    changed: dict[str, Any] = {
        name: getattr(spec, name).model_copy(update=update) for name, update in groups.items()
    }  # fmt: skip
    if entries:
        changed["stack"] = tuple(
            _entry(each, entries[each.name]) if each.name in entries else each for each in spec.stack
        )
    return spec.model_copy(update=changed)


def _entry(entry: Any, update: Mapping[str, Value]) -> Any:  # noqa: ANN401  # a StackEntry
    if entry.film is not None:
        return entry.model_copy(update={"film": entry.film.model_copy(update=dict(update))})
    return entry.model_copy(update=dict(update))


def _contact(spec: SensorSpec, name: str, value: float) -> dict[str, Any]:
    contact = spec.contact
    if name == "pressure":
        assert contact.pressure is not None
        usual = contact.pressure[len(contact.pressure) // 2]
        return {"pressure": tuple(each * value / usual for each in contact.pressure)}
    assert contact.nominal is not None
    levels = {level: getattr(contact, level) for level in ("low", "nominal", "high")}
    return {level: h * value / contact.nominal for level, h in levels.items() if h is not None}
