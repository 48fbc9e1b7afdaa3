"""A sensor file's sections become the right values, and give what hand-made ones give."""

import dataclasses
import math

import numpy as np
import pytest

from firmtouch.errors import ModelFileError
from firmtouch.thermal import (
    NTC,
    RTD,
    Adiabatic,
    Air,
    Base,
    Bridge,
    Contact,
    ContactEvent,
    Disc,
    Film,
    HalfSpace,
    Layer,
    Loop,
    Material,
    Pulse,
    Reading,
    Roughness,
    Slab,
    Stack,
    SteinhartHart,
    Touch,
    contact_conductance,
    noise,
    power_response,
)
from firmtouch.thermal.sensor import (
    HeldPower,
    HeldTemperature,
    Pad,
    Pulsed,
    Temperatures,
    TwoFaces,
    Unknown,
)
from firmtouch.thermal.sensorfile import parse_sensor
from firmtouch.thermal.sensorfile.build import sensor_of
from firmtouch.thermal.signals import response

GEL = Material("gel", 0.2, 1000.0, 2000.0)
OXIDE = Material("oxide", 2.0, 5000.0, 800.0)
IRON = Material("iron", 80.0, 8000.0, 500.0)
ROWS = """\
materials:
  gel: {k: 0.2 W/m/K, rho: 1000, c: 2000, tolerance: 10 %, source: made}
  oxide: {k: 2 W/m/K, rho: 5000, c: 800, tolerance: 10 %, source: made}
  iron: {k: 80 W/m/K, rho: 8000, c: 500, tolerance: 10 %, source: made}
parts:
  chip: {kind: ntc, tolerance: 10 %, source: made, size: [1 mm, 0.5 mm, 0.4 mm], capacity: 1 mJ/K, resistance: 10 kohm, B: 3400 K}
  coil: {kind: rtd, tolerance: 10 %, source: made, size: [2 mm, 1 mm, 0.4 mm], capacity: 1 mJ/K, resistance: 100 ohm, resistance_at: 0 degC, coefficient: 3900 ppm/K}
"""
STACK = """\
  - {material: gel, thickness: 10 um}
  - {joint: 50 kW/m^2/K}
  - {film: {material: oxide, thickness: 2 um}, sensed: true}
  - {material: gel, thickness: 0.5 mm}
"""


def built(stack=STACK, **sections):
    given = {
        "backing": "base",
        "contact": "1e4 W/m^2/K",
        "objects": "[iron, gel]",
        "temperatures": "{object: 295 K, sensor: 310 K}",
    } | sections
    rest = "".join(f"{name}: {text}\n" for name, text in given.items())
    file = parse_sensor(f"schema: firmtouch.sensor/1\ntitle: made\n{ROWS}stack:\n{stack}{rest}".encode(), name="made")
    return sensor_of(file.spec, file.catalogue)


def same(found, expected):
    """Compare a table's material by its numbers: it knows more than a material does."""
    assert (found.conductivity, found.density, found.heat_capacity) == pytest.approx(
        (expected.conductivity, expected.density, expected.heat_capacity), rel=1e-15
    )


def agree(found, expected):
    """Compare two values, field by field, to what reading a number in its unit may round."""
    assert type(found) is type(expected)
    if dataclasses.is_dataclass(expected):
        for field in dataclasses.fields(expected):
            agree(getattr(found, field.name), getattr(expected, field.name))
    else:
        assert found == (pytest.approx(expected, rel=1e-14) if isinstance(expected, float) else expected)


class TestStacks:
    def test_elements_and_the_plane_of_a_film(self):
        stack = built().stack
        layer, joint, film, foam = stack.elements
        same(layer.material, GEL)
        assert (layer.thickness, foam.thickness) == pytest.approx((10e-6, 0.5e-3))
        agree(joint, Contact(5e4))
        agree(film, Film(5000 * 800 * 2e-6))
        assert stack.sensed == 2  # before the film, which is its own temperature
        assert stack.backing == Base()

    def test_the_plane_of_a_layer_is_its_inner_face(self):
        stack = "  - {material: gel, thickness: 10 um, sensed: true}\n  - {material: oxide, thickness: 20 um, heated: true}\n"
        sensor = built(stack)
        assert (sensor.stack.sensed, sensor.heater) == (1, 2)
        same(sensor.stack.elements[0].material, GEL)

    @pytest.mark.parametrize(
        ("film", "capacity"),
        [
            ("{part: chip}", 1e-3 / 0.5e-6),
            ("{part: chip, area: 2 mm^2}", 1e-3 / 2e-6),
            ("{capacity: 7 J/m^2/K}", 7.0),
        ],
    )
    def test_films(self, film, capacity):
        agree(built(f"  - {{film: {film}, sensed: true}}\n").stack.elements[0], Film(capacity))

    @pytest.mark.parametrize(
        ("written", "expected"), [("base", Base()), ("adiabatic", Adiabatic()), ("{air: 25 W/m^2/K}", Air(25.0))]
    )
    def test_backings(self, written, expected):
        assert built(backing=written).stack.backing == expected

    def test_a_half_space_behind(self):
        backing = built(backing="{half_space: oxide}").stack.backing
        assert isinstance(backing, HalfSpace)
        same(backing.material, OXIDE)


class TestTouches:
    def test_each_object_in_each_contact(self):
        sensor = built(contact="{low: 1e3, nominal: 2e3, high: 4e3}", objects="[iron, {material: gel, name: jelly}]")
        assert [(each.object, each.level, each.touch.conductance) for each in sensor.scenarios] == [
            (name, level, pytest.approx(h))
            for name in ("iron", "jelly")
            for level, h in (("low", 1e3), ("nominal", 2e3), ("high", 4e3))
        ]

    @pytest.mark.parametrize(
        ("stack", "cover"),
        [
            (STACK, GEL),
            ("  - {film: {material: oxide, thickness: 2 um}, sensed: true}\n", OXIDE),
            ("  - {film: {capacity: 7 J/m^2/K}, sensed: true}\n", None),
        ],
    )
    def test_conductances_by_pressure(self, stack, cover):
        """The cover's and the object's conductivities both count; of a film of nothing known, the object's twice."""
        rough = Roughness(1e-6, 0.2, 1e9)
        pressures = (2e4, 5e4, 1e5)
        text = "{pressure: [20 kPa, 50 kPa, 1 bar], roughness: 1 um, slope: 0.2, hardness: 1 GPa}"
        sensor = built(stack, contact=text)
        expected = [
            contact_conductance(each, rough, (cover or thing).conductivity, thing.conductivity).total
            for thing in (IRON, GEL)
            for each in pressures
        ]
        assert [each.conductance for each in sensor.touches] == pytest.approx(expected, rel=1e-14)

    def test_one_pressure_is_nominal(self):
        sensor = built(contact="{pressure: 50 kPa, roughness: 1 um}")
        assert [each.level for each in sensor.scenarios] == ["nominal", "nominal"]

    def test_slabs_and_half_spaces(self):
        first, second = built(objects="[iron, {material: gel, thickness: 3 mm}]").touches
        assert isinstance(first.object, HalfSpace)
        assert isinstance(second.object, Slab)
        assert second.object.thickness == pytest.approx(3e-3)

    def test_a_pad_makes_discs(self):
        sensor = built(pad="{radius: 0.5 mm, pitch: 2 mm, rows: 3, columns: 4}")
        agree(sensor.pad, Pad(0.5e-3, 2e-3, 3, 4))
        assert (sensor.pad.area, sensor.pad.count) == (pytest.approx(math.pi * 0.25e-6), 12)
        for each, material in zip(sensor.touches, (IRON, GEL), strict=True):
            assert isinstance(each.object, Disc)
            same(each.object.material, material)
            assert each.object.radius == pytest.approx(0.5e-3)
        assert built(pad="{radius: 0.5 mm}").pad.pitch == math.inf

    def test_priors(self):
        assert built().unknown == Unknown(0.3, 0.0)
        sensor = built(
            contact="{nominal: 1e4, prior: 10 %}", temperatures="{object: 295 K, sensor: 310 K, prior: 0.5 K}"
        )
        agree(sensor.unknown, Unknown(0.1, 0.5))

    @pytest.mark.parametrize(
        ("given", "backing", "expected"),
        [
            ("{object: 295 K, sensor: 310 K}", "base", (295, 310, 310, 295)),
            ("{object: 295 K, sensor: 310 K, base: 300 K, ambient: 290 K}", "base", (295, 310, 300, 290)),
            ("{object: 295 K, sensor: 310 K, ambient: 290 K}", "{air: 10}", (295, 310, 290, 290)),
        ],
    )
    def test_temperatures(self, given, backing, expected):
        agree(built(temperatures=given, backing=backing).temperatures, Temperatures(*map(float, expected)))


class TestDrives:
    def test_power_by_area(self):
        pad = "{radius: 0.5 mm}"
        assert built().drive == HeldPower()
        assert built(drive="{mode: constant_power, flux: 2 kW/m^2}").drive == HeldPower(2e3)
        found = built(drive="{mode: constant_power, power: 3 mW}", pad=pad).drive
        agree(found, HeldPower(3e-3 / (math.pi * 0.25e-6)))

    def test_a_loop(self):
        text = "{mode: constant_temperature, loop_gain: 5e4, integral_gain: 1e6, sensor_lag: 0.2 ms, delay: 1 ms}"
        expected = Loop(5e4, 2, integral_gain=1e6, sensor_lag=2e-4, dead_time=1e-3)
        agree(built(drive=text).drive, HeldTemperature(expected, reads_power=True))
        asked = "{rise_time: {at_most: 10 ms, metric: 10-90, signal: temperature}}"
        agree(built(drive=text, requirements=asked).drive, HeldTemperature(expected, reads_power=False))

    def test_a_loop_whose_heater_is_elsewhere(self):
        stack = STACK.replace("thickness: 10 um}", "thickness: 10 um, heated: true}")
        found = built(stack, drive="{mode: constant_temperature, loop_gain: 5e4}")
        assert (found.drive.loop.heater, found.heater, found.stack.sensed) == (1, 1, 2)

    @pytest.mark.parametrize(
        ("duration", "expected"), [("", math.inf), (", duration: 0.1 s", 0.1), (", duration: 2 s", math.inf)]
    )
    def test_a_pulse_lasts_no_longer_than_the_window(self, duration, expected):
        drive = built(drive=f"{{mode: pulse, flux: 10 kW/m^2{duration}}}").drive
        agree(drive, Pulsed(Pulse(1e4, 2, expected)))

    def test_two_faces(self):
        agree(built(drive="{mode: two_temperature, second: 40 degC}").drive, TwoFaces(313.15))

    @pytest.mark.parametrize(
        ("searched", "told"),
        [
            ("{mode: [constant_power, constant_temperature]}", "`constant_temperature` needs a `loop_gain`"),
            ("{mode: [pulse, constant_power]}", "`pulse` needs a `power` or a `flux`"),
            ("{mode: [two_temperature, constant_power]}", "`two_temperature` needs a `second`"),
            ("{power: [1 mW, 1 W]}", "needs a `pad`"),
        ],
    )
    def test_a_search_has_all_that_its_modes_need(self, searched, told):
        with pytest.raises(ModelFileError, match=told):
            built(search=f"{{drive: {searched}, objective: rise_time}}")


class TestReadouts:
    def film(self, electrical):
        return STACK.replace("thickness: 2 um}", f"thickness: 2 um, {electrical}}}")

    def test_none_and_as_measured(self):
        assert built().readout is None
        found = built(electronics="{sampling: 2 kHz, temperature_noise: 3 mK}").readout
        assert (found.rate, found.noise, found.bandwidth) == pytest.approx((2e3, 3e-3, 1e3))
        assert (found.bridge, found.sources, found.area) == (None, None, None)

    @pytest.mark.parametrize(
        ("electrical", "thermometer"),
        [
            ("resistance: 100 ohm, coefficient: 0.385 %/K", RTD(100.0, 3.85e-3, 298.15)),
            ("resistance: 10 kohm, B: 3435 K", NTC(1e4, 3435.0, 298.15)),
            ("steinhart_hart: [1.1e-3, 2.4e-4, 8e-8]", SteinhartHart(1.1e-3, 2.4e-4, 8e-8)),
        ],
    )
    def test_a_bridge_adds_its_noise_up(self, electrical, thermometer):
        text = "{sampling: 1 kHz, bridge_voltage: 0.5 V, noise_density: 10 nV/sqrt(Hz), gain: 20, adc_bits: 16, adc_range: 2.5 V, bandwidth: 300 Hz}"
        found = built(self.film(electrical), electronics=text, pad="{radius: 0.5 mm}").readout
        bridge = Bridge(thermometer, 0.5)
        assert found.bridge.thermometer.resistance(305.0) == pytest.approx(thermometer.resistance(305.0), rel=1e-12)
        expected = noise(bridge, Reading(1e-8, 300.0, 20.0, 16, 2.5), 310.0)
        assert found.noise == pytest.approx(expected.netd.total, rel=1e-9)
        assert (found.rate, found.bandwidth) == pytest.approx((1e3, 300))
        assert found.area == pytest.approx(math.pi * 0.25e-6)  # a film as large as its pad

    @pytest.mark.parametrize(
        ("film", "thermometer", "area"),
        [
            ("{part: chip}", NTC(1e4, 3400.0, 298.15), 0.5e-6),
            ("{part: coil}", RTD(100.0, 3.9e-3, 273.15), 2e-6),
            ("{part: coil, area: 9 mm^2}", RTD(100.0, 3.9e-3, 273.15), 9e-6),
        ],
    )
    def test_parts_bring_their_own(self, film, thermometer, area):
        stack = f"  - {{film: {film}, sensed: true}}\n"
        found = built(stack, electronics="{sampling: 1 kHz, bridge_voltage: 0.5 V}").readout
        T = np.array([290.0, 310.0])
        assert found.bridge.thermometer.resistance(T) == pytest.approx(thermometer.resistance(T), rel=1e-12)
        assert found.area == pytest.approx(area)


class TestItGivesWhatHandMadeValuesGive:
    T = np.logspace(-4, -0.4, 9)
    STACK = Stack((Layer(GEL, 10e-6), Contact(5e4), Film(8.0), Layer(GEL, 0.5e-3)), 2, Base())

    def test_a_contact(self):
        sensor = built()
        for each, thing in zip(sensor.touches, (IRON, GEL), strict=True):
            expected = ContactEvent(self.STACK, Touch(HalfSpace(thing), 1e4, air=10), -15.0).temperature(self.T)
            assert response(sensor, each)(self.T) == pytest.approx(expected, rel=1e-12)

    def test_a_loop(self):
        sensor = built(drive="{mode: constant_temperature, loop_gain: 5e4, sensor_lag: 0.2 ms}")
        expected = -15 * power_response(
            self.STACK, Touch(HalfSpace(IRON), 1e4, air=10), Loop(5e4, 2, sensor_lag=2e-4), self.T
        )
        assert response(sensor, sensor.touches[0])(self.T) == pytest.approx(expected, rel=1e-9)
