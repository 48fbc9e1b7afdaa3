"""What the tables' tolerances do to the rise time: one quantity at a time, together at random, and at worst."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

from firmtouch.thermal.analysis.felt import COARSE, feel
from firmtouch.thermal.metrics import Metric
from firmtouch.thermal.sensor import Sensor
from firmtouch.thermal.sensorfile.specification import SensorSpec
from firmtouch.thermal.stack import Film, HalfSpace, Layer, Material, Stack
from firmtouch.thermal.tables.catalogue import Catalogue
from firmtouch.thermal.tables.values import TableMaterial

STEP: Final = 0.02
"""Of the logarithm, in central differences: their error is its square, that of the coarse grid 1e-3 over it."""
FAST_ENOUGH: Final = 1e-3
"""Slopes below this are the grid's own."""


@dataclass(frozen=True, slots=True)
class Tolerance:
    """A quantity of a material or a film that is known to +- `tolerance` (relative), and d ln(rise time)/d ln(it)."""

    quantity: str
    of: str
    tolerance: float
    slope: float

    @property
    def effect(self) -> float:
        """Give the relative change of the rise time at the end of the tolerance."""
        return abs(self.slope) * self.tolerance


@dataclass(frozen=True, slots=True)
class Tolerances:
    """The worst rise time of all scenarios (s) as computed, and as the tolerances of the tables may make it.

    `likely` is larger by the root of the sum of the squares of all effects, and `worst` is computed with every quantity
    at the end that makes the sensor slower.
    """

    metric: Metric
    nominal: float
    likely: float
    worst: float
    effects: tuple[Tolerance, ...]


@dataclass(frozen=True, slots=True)
class _Quantity:
    name: str
    of: str
    tolerance: float
    scaled: Callable[[Sensor, float], Sensor]


def tolerances_of(
    sensor: Sensor, spec: SensorSpec, catalogue: Catalogue, metric: Metric = Metric.TEN_TO_NINETY
) -> Tolerances | None:
    """Find what the tolerances do; None where nothing of the sensor has one."""

    def slowest(changed: Sensor) -> float:
        return float(feel(changed, spec.window, COARSE).rises(metric).seconds.max())

    nominal, found, corner = slowest(sensor), [], sensor
    for each in _quantities(sensor, spec, catalogue):
        up, down = (slowest(each.scaled(sensor, math.exp(sign * STEP))) for sign in (1, -1))
        slope = math.log(up / down) / (2 * STEP)
        found.append(Tolerance(each.name, each.of, each.tolerance, slope if abs(slope) > FAST_ENOUGH else 0.0))
        corner = each.scaled(corner, 1 + math.copysign(min(each.tolerance, 0.9), slope))
    if not found:
        return None
    likely = nominal * (1 + math.sqrt(sum(each.effect**2 for each in found)))
    found.sort(key=lambda each: -each.effect)
    return Tolerances(metric, nominal, likely, max(slowest(corner), nominal), tuple(found))


def _quantities(sensor: Sensor, spec: SensorSpec, catalogue: Catalogue) -> Iterator[_Quantity]:
    """List k, rho and c of each material of the sensor, and the capacity of each film or part."""
    backing = sensor.stack.backing
    layers = [each.material for each in sensor.stack.elements if isinstance(each, Layer)]
    materials = [*layers, *([backing.material] if isinstance(backing, HalfSpace) else [])]
    for material in {each.name: each for each in materials if isinstance(each, TableMaterial)}.values():
        for name in ("conductivity", "density", "heat_capacity"):
            changed = _of_material(material.name, name)
            yield _Quantity(name.replace("_", " "), material.name, material.tolerance, changed)
    for i, entry in enumerate(spec.stack):
        if entry.film is not None and entry.film.capacity is None:
            rows: Sequence[str | None] = (entry.film.material, entry.film.part)
            row = catalogue.materials[rows[0]] if rows[0] is not None else catalogue.parts[str(rows[1])]
            yield _Quantity("heat capacity", f"{entry.name or 'film'} ({row.name})", row.tolerance, _of_film(i))


def _of_material(material: str, name: str) -> Callable[[Sensor, float], Sensor]:
    def other(each: Material, factor: float) -> Material:
        return replace(each, **{name: getattr(each, name) * factor}) if each.name == material else each

    def scaled(sensor: Sensor, factor: float) -> Sensor:
        stack = sensor.stack
        elements = tuple(
            replace(each, material=other(each.material, factor)) if isinstance(each, Layer) else each
            for each in stack.elements
        )
        backing = stack.backing
        if isinstance(backing, HalfSpace):
            backing = HalfSpace(other(backing.material, factor))
        return replace(sensor, stack=Stack(elements, stack.sensed, backing))

    return scaled


def _of_film(i: int) -> Callable[[Sensor, float], Sensor]:
    def scaled(sensor: Sensor, factor: float) -> Sensor:
        stack = sensor.stack
        film = stack.elements[i]
        assert isinstance(film, Film)
        elements = (*stack.elements[:i], Film(film.areal_capacity * factor), *stack.elements[i + 1 :])
        return replace(sensor, stack=Stack(elements, stack.sensed, stack.backing))

    return scaled
