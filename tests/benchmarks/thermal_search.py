"""How long a whole design search takes: 20 parts and 4 sizes, on two processes, and what it finds against a grid.

Beads of 20 sizes in a gel, as small thermistors are mounted; sizes are the cover, the gel behind, the contact that the
cover makes, and the temperature. The grid has every part with 3 values of each size, and is tried in the same run.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from tests.benchmarks.measure import Figure, seconds

from firmtouch.thermal.search import search
from firmtouch.thermal.search.candidate import Question, try_out
from firmtouch.thermal.search.variables import variables_of
from firmtouch.thermal.sensorfile import SensorFile, parse_sensor

SECONDS, JOBS, ROUNDS = 30, 2, 2
AS_GOOD = 1.01
"""Of the best of the grid: sizes are rounded where that costs less than a percent."""
GRID = 3
BEADS = [round(60 + 10 * i) for i in range(20)]


def sensor() -> SensorFile:
    rows = "\n".join(
        f"  bead_{d}: {{kind: ntc, diameter: {d} um, resistance: 10 kohm, B: 3435 K, tolerance: 20 %, source: made up}}"
        for d in BEADS
    )
    text = f"""
schema: firmtouch.sensor/1
title: Beads
parts:
{rows}
stack:
  - {{name: cover, material: thermal_silicone, thickness: 20 um}}
  - {{name: bead, film: {{part: bead_100}}, sensed: true}}
  - {{name: gel, material: thermal_silicone, thickness: 0.3 mm}}
  - {{name: foam, material: foam_backing, thickness: 1 mm}}
backing: base
contact: {{low: 5 kW/m^2/K, nominal: 20 kW/m^2/K, high: 40 kW/m^2/K}}
objects: [softwood, pmma, glass, steel_304, copper]
temperatures: {{object: 22 degC, sensor: 36 degC}}
pad: {{radius: 0.5 mm}}
electronics: {{bridge_voltage: 0.5 V, noise_density: 10 nV/sqrt(Hz), sampling: 1 kHz}}
requirements:
  rise_time: {{at_most: 0.4 s, metric: 10-90}}
  discrimination: {{pairs: [[copper, glass], [glass, pmma], [pmma, softwood]], time: 100 ms}}
  surface_temperature: 43 degC
  self_heating: 5 K
search:
  stack:
    cover: {{thickness: [5 um, 100 um]}}
    bead: {{part: [{", ".join(f"bead_{d}" for d in BEADS)}]}}
    gel: {{thickness: [0.1 mm, 1 mm]}}
  contact: {{nominal: [5 kW/m^2/K, 50 kW/m^2/K]}}
  temperatures: {{sensor: [30 degC, 42 degC]}}
  objective: rise_time
  front: [rise_time, discrimination]
"""
    return parse_sensor(text.encode(), name="beads")


def best_of_grid(file: SensorFile) -> float:
    variables = variables_of(file.spec)
    question = Question(file.spec, variables, file.catalogue, ("rise_time",))
    axes = [
        range(len(each.choices)) if each.choices else np.linspace(*each.bounds, GRID)
        for each in variables
    ]  # fmt: skip
    tried = (try_out(question, np.array(x, dtype=float)) for x in itertools.product(*axes))
    return min((each.figures["rise_time"] for each in tried if each.meets), default=math.inf)


def figures() -> list[Figure]:
    file = sensor()
    found = []
    time = min(seconds(lambda: found.append(search(file, jobs=JOBS))) for _ in range(ROUNDS))
    chosen, grid = found[-1].chosen.figures["rise_time"], best_of_grid(file)
    detail = f"{found[-1].tried} designs, {found[-1].met} meet everything"
    return [
        Figure("thermal search, 20 parts, 4 sizes, 2 cores", time, "<=", SECONDS, "s", detail),
        Figure("thermal search: rise time / best of a grid", chosen / grid, "<=", AS_GOOD, "", f"{chosen:.4g} s"),
    ]
