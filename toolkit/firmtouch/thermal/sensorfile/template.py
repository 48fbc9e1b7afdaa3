"""The sensor file that `firmtouch new --sensor` writes."""

from __future__ import annotations

import json

TEMPLATE = """\
# A sensor file of firmtouch. It works as it is:  firmtouch thermal {name}.yaml
# Quantities are written with a unit (2 um, 50 kW/m^2/K, 36 degC); a bare number is in SI, and temperatures need a unit.
schema: firmtouch.sensor/1
title: {title}
description: A platinum film between parylene and Kapton on foam, held warm by a loop.

# From the touched face inward. Each entry is a layer (`material`, `thickness`), a `film`, or a `joint` (W/m^2/K).
# Materials, parts and contacts are those of the tables; `materials:`, `parts:` and `contacts:` in this file add rows.
stack:
  - {{name: cover, material: parylene_c, thickness: 4 um}}
  - name: film
    film: {{material: platinum, thickness: 100 nm, resistance: 100 ohm, coefficient: 3850 ppm/K}}
    sensed: true                    # its temperature is felt
    heated: true                    # and here is the heater
  - {{name: substrate, material: kapton, thickness: 7.5 um}}
  - {{name: foam, material: foam_backing, thickness: 1 mm}}
backing: base                       # held at its temperature; or adiabatic, {{half_space: pdms}}, {{air: 10 W/m^2/K}}

# Conductance of the contact: a row of the table, a value, {{low, nominal, high}}, or {{pressure, roughness}}.
contact: smooth

# What is touched: as deep as heat gets, or a plate, such as {{material: glass, thickness: 4 mm, name: pane}}.
objects: [softwood, pmma, glass, steel_304, copper]

# Just before the touch: of the object, and of the touched face.
temperatures: {{object: 22 degC, sensor: 36 degC}}

# constant_power, constant_temperature, pulse, or two_temperature.
drive: {{mode: constant_temperature, loop_gain: 30 kW/m^2/K, sensor_lag: 0.2 ms}}

pad: {{radius: 0.5 mm, pitch: 2 mm}}

# A half-bridge, an amplifier and a converter; or `temperature_noise` as measured.
electronics:
  sampling: 1 kHz
  bridge_voltage: 0.1 V
  noise_density: 5 nV/sqrt(Hz)
  gain: 200
  adc_bits: 16
  adc_range: 2.5 V

# What is not asked for is still told.
requirements:
  rise_time: {{at_most: 10 ms, metric: 10-90, window: 0.5 s}}
  discrimination: {{pairs: [[glass, pmma], [pmma, softwood]], d_prime: 5, time: 20 ms}}
  crosstalk: {{at_most: 5 %, time: 10 ms}}
  surface_temperature: 43 degC
  power: {{pad: 0.2 W}}

# With `search:` a design is looked for, and what is named here is chosen within its range.
# search:
#   stack:
#     cover: {{material: [parylene_c, kapton], thickness: [1 um, 12.5 um]}}
#   drive: {{loop_gain: [10 kW/m^2/K, 100 kW/m^2/K]}}
#   objective: rise_time            # or power, thickness, discrimination
#   front: [rise_time, power]       # how much of one the other costs
"""


def sensor_template(name: str) -> str:
    """Give a commented sensor file that works as it is."""
    return TEMPLATE.format(name=name, title=json.dumps(name.replace("_", " ").capitalize()))
