"""What a search may choose: its coordinates, and a specification with values put in against a file that has them."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from firmtouch.thermal.search import Variable
from firmtouch.thermal.search.variables import value_of, values_at, variables_of, with_values
from firmtouch.thermal.sensorfile import parse_sensor
from firmtouch.thermal.sensorfile.build import sensor_of

HEAD = """\
schema: firmtouch.sensor/1
title: made
materials:
  wool: {k: 0.04 W/m/K, rho: 50, c: 1000, tolerance: 10 %, source: made}
  felt: {k: 0.08 W/m/K, rho: 100, c: 1000, tolerance: 10 %, source: made}
  metal: {k: 400 W/m/K, rho: 8000, c: 400, tolerance: 10 %, source: made}
  oxide: {k: 2 W/m/K, rho: 5000, c: 800, tolerance: 10 %, source: made}
  endless: {k: 1e4 W/m/K, rho: 3e4, c: 2e4, tolerance: 10 %, source: made}
"""


def sizes():
    logs = st.floats(-9, 6)
    return st.builds(lambda a, width: (10**a, 10 ** (a + width)), logs, st.floats(1e-3, 4))


class TestVariables:
    @given(sizes(), st.floats(0, 1))
    def test_a_size_goes_to_its_coordinate_and_back(self, bounds, at):
        variable = Variable(("stack", "cover", "thickness"), *bounds)
        low, high = variable.bounds
        value = variable.value(low + at * (high - low))
        assert bounds[0] <= value <= bounds[1]
        assert low <= variable.coordinate(value) <= high
        assert variable.value(variable.coordinate(value)) == pytest.approx(value, rel=1e-14)

    @given(sizes(), st.floats(0, 1))
    def test_rounded_sizes_have_three_figures_or_are_a_bound(self, bounds, at):
        variable = Variable(("pad", "radius"), *bounds)
        value = bounds[0] * (bounds[1] / bounds[0]) ** at
        found = variable.rounded(min(max(value, bounds[0]), bounds[1]))
        assert bounds[0] <= found <= bounds[1]
        assert found in bounds or found == float(f"{found:.2e}")
        assert found == pytest.approx(value, rel=5.1e-3)  # half of the last of three figures

    @given(st.floats(250, 349), st.floats(0.01, 50), st.floats(0, 1))
    @example(309.15, 10.0, 0.0)
    def test_temperatures_are_linear_and_rounded_to_tenths_of_a_degree(self, low, width, at):
        variable = Variable(("temperatures", "sensor"), low, low + width)
        value = variable.value(low + at * width)
        assert variable.coordinate(value) == value
        found = variable.rounded(value)
        assert low <= found <= low + width
        celsius = found - 273.15
        assert found in (low, low + width) or celsius == pytest.approx(round(celsius, 1), abs=1e-9)
        assert abs(found - value) < 0.0501

    def test_choices(self):
        variable = Variable(("electronics", "adc_bits"), choices=(12, 16, 24))
        assert variable.bounds == (0, 2)
        assert [variable.value(x) for x in (-0.4, 0.4, 0.6, 2.4)] == [12, 12, 16, 24]
        assert [variable.coordinate(x) for x in (12, 24, 10, None)] == [0, 2, 0, 0]
        assert variable.rounded(16) == 16
        assert variable.unit == ""

    def test_names(self):
        found = [
            Variable(path, 1.0, 2.0).name
            for path in (("stack", "cover", "thickness"), ("drive", "loop_gain"), ("pad", "radius"), ("drive", "flux"))
        ]
        assert found == ["cover thickness", "loop gain", "pad radius", "drive flux"]


EVERYTHING = f"""{HEAD}
parts:
  one: {{kind: ntc, tolerance: 10 %, source: made, size: [1 mm, 0.5 mm, 0.4 mm], capacity: 1 mJ/K, resistance: 10 kohm, B: 3400 K}}
  other: {{kind: ntc, tolerance: 10 %, source: made, size: [0.6 mm, 0.3 mm, 0.3 mm], capacity: 0.2 mJ/K, resistance: 100 kohm, B: 4250 K}}
stack:
  - {{name: cover, material: COVER, thickness: THICKNESS}}
  - {{name: chip, film: {{part: PART}}, sensed: true}}
  - {{name: layer, film: {{material: LAYER, thickness: 3 um}}}}
  - {{material: felt, thickness: 2 mm}}
backing: base
contact: {{low: LOW, nominal: NOMINAL, high: HIGH}}
objects: [metal, oxide]
temperatures: {{object: 290 K, sensor: SENSOR}}
drive: {{mode: MODE}}
pad: {{radius: RADIUS, pitch: PITCH}}
electronics: {{sampling: SAMPLING, bridge_voltage: VOLTAGE, adc_bits: BITS, adc_range: 2 V}}
"""
FIRST = {
    "COVER": "oxide", "THICKNESS": "5 um", "PART": "one", "LAYER": "metal", "LOW": "5e3", "NOMINAL": "1e4", "HIGH": "3e4",
    "SENSOR": "310 K", "MODE": "constant_temperature, loop_gain: 2e4", "RADIUS": "1 mm", "PITCH": "3 mm", "SAMPLING": "1 kHz",
    "VOLTAGE": "1 V", "BITS": "12",
}  # fmt: skip
SECOND = {
    "COVER": "metal", "THICKNESS": "8 um", "PART": "other", "LAYER": "oxide", "LOW": "1e4", "NOMINAL": "2e4", "HIGH": "6e4",
    "SENSOR": "312.5 K", "MODE": "constant_temperature, loop_gain: 3e4", "RADIUS": "0.5 mm", "PITCH": "2 mm", "SAMPLING": "2 kHz",
    "VOLTAGE": "0.5 V", "BITS": "16",
}  # fmt: skip
SEARCH = """\
search:
  stack:
    cover: {material: [oxide, metal], thickness: [1 um, 9 um]}
    chip: {part: [one, other]}
    layer: {material: [metal, oxide]}
  contact: {nominal: [5e3, 5e4]}
  drive: {loop_gain: [1e3, 1e5]}
  pad: {radius: [0.2 mm, 1 mm], pitch: [2 mm, 4 mm]}
  temperatures: {sensor: [300 K, 320 K]}
  electronics: {sampling: [100 Hz, 10 kHz], bridge_voltage: [0.1 V, 2 V], adc_bits: [12, 16]}
  objective: rise_time
"""


def filled(values, more="", *, template=EVERYTHING):
    text = template
    for name, value in values.items():
        text = text.replace(name, value)
    return parse_sensor((text + more).encode(), name="made")


def test_values_put_in_are_as_if_the_file_had_them():
    """All kinds of variables: the sensor of the changed specification is that of the file with the values written in."""
    file, other = filled(FIRST, SEARCH), filled(SECOND)
    variables = variables_of(file.spec)
    assert len(variables) == 12
    values = {each.path: value_of(other.spec, each.path) for each in variables}
    x = np.array([each.coordinate(values[each.path]) for each in variables])
    for put in (values, values_at(variables, x)):
        changed = sensor_of(with_values(file.spec, put), file.catalogue)
        expected = sensor_of(other.spec, other.catalogue)
        assert changed.stack.sensed == expected.stack.sensed
        assert [each.touch.conductance for each in changed.scenarios] == pytest.approx(
            [each.touch.conductance for each in expected.scenarios]
        )
        assert [each.object.radius for each in changed.touches] == pytest.approx([0.5e-3] * 6)
        assert changed.drive.loop.gain == pytest.approx(3e4)
        assert (changed.pad.radius, changed.pad.pitch) == pytest.approx((0.5e-3, 2e-3))
        assert changed.temperatures.face == pytest.approx(312.5)
        assert changed.readout.noise == pytest.approx(expected.readout.noise, rel=1e-9)
        assert (changed.readout.rate, changed.readout.area) == pytest.approx((2e3, expected.readout.area))
        for one, two in zip(changed.stack.elements, expected.stack.elements, strict=True):
            assert getattr(one, "material", None) == getattr(two, "material", None)
            for size in ("thickness", "areal_capacity"):
                assert getattr(one, size, 0) == pytest.approx(getattr(two, size, 0), rel=1e-12)
    unchanged = with_values(file.spec, {each.path: value_of(file.spec, each.path) for each in variables})
    assert sensor_of(unchanged, file.catalogue) == sensor_of(file.spec, file.catalogue)


def test_pressures_keep_their_ratios():
    text = EVERYTHING.replace(
        "{low: LOW, nominal: NOMINAL, high: HIGH}", "{pressure: [20 kPa, 50 kPa, 1 bar], roughness: 1 um}"
    )
    spec = with_values(filled(FIRST, template=text).spec, {("contact", "pressure"): 25e3})
    assert spec.contact.pressure == pytest.approx((10e3, 25e3, 50e3))
