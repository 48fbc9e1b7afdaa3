"""Sensor files: what a good one becomes, each mistake at its line and column, and that nothing breaks the reader."""

from pathlib import Path

import jsonschema
import pytest
from ruamel.yaml import YAML
from tests.hostile.mutations import mutate

from firmtouch.errors import ModelFileError
from firmtouch.thermal.sensorfile import parse_sensor, read_sensor, sensor_schema
from firmtouch.thermal.tables import parse_catalogue, read_catalogue

ROOT = Path(__file__).parents[2]
MODELS = sorted((ROOT / "models" / "thermal").glob("*.yaml"))
VALIDATOR = jsonschema.Draft202012Validator(sensor_schema())
MARK = "»"

GOOD = """\
schema: firmtouch.sensor/1
title: "  A sensor   with everything "
materials: {my_gel: {k: 0.2 W/m/K, rho: 1000 kg/m^3, c: 2000 J/kg/K, tolerance: 20 %, source: measured}}
parts: {my_chip: {kind: ntc, tolerance: 20 %, source: weighed, mass: 1 mg, body: my_gel}}
contacts: {wet: {conductance: 40 kW/m^2/K, low: 20 kW/m^2/K, high: 50 kW/m^2/K, tolerance: 50 %, source: measured}}
stack:
  - {name: cover, material: parylene_c, thickness: 2 um}
  - {joint: 100 kW/m^2/K}
  - {name: film, film: {material: platinum, thickness: 100 nm, resistance: 100 ohm, coefficient: 0.385 %/K}, sensed: true}
  - {name: chip, film: {part: my_chip, area: 0.5 mm^2}, heated: true}
  - {name: rubber, material: my_gel, thickness: 1 mm}
backing: {half_space: pdms}
contact: wet
objects: [copper, {material: glass, thickness: 3 mm}, {material: glass, name: block}]
temperatures: {object: 295.15 K, sensor: 36 degC}
drive: {mode: constant_temperature, loop_gain: 50 kW/m^2/K, integral_gain: 1e6 W/m^2/K/s, sensor_lag: 0.2 ms}
pad: {radius: 0.5 mm, pitch: 2 mm, rows: 20, columns: 10}
electronics: {bridge_voltage: 0.2 V, noise_density: 10 nV/sqrt(Hz), gain: 100, adc_bits: 16, adc_range: 2.5 V, sampling: 1 kHz}
requirements:
  rise_time: {at_most: 10 ms, metric: 10-90, window: 200 ms}
  discrimination: {pairs: [[copper, glass], [block, glass]], time: 10 ms}
  range: {least: eps_foam, most: 37137, time: 10 ms}
  crosstalk: 5 %
  surface_temperature: 43 degC
  power: {pad: 0.2 W, array: 60 W}
  self_heating: 0.1 K
  feedback: 5 %
  loop_margin: 0.5
  recovery: 1 s
  pitch: 2 mm
  thickness: 2 mm
search:
  stack: {cover: {thickness: [1 um, 10 um], material: [parylene_c, kapton]}, chip: {part: [my_chip, murata_ncp03wf104]}}
  contact: {nominal: [10 kW/m^2/K, 50 kW/m^2/K]}
  drive: {mode: [constant_power, constant_temperature], loop_gain: [1e4, 1e5]}
  pad: {pitch: [1 mm, 3 mm]}
  temperatures: {sensor: [30 degC, 42 degC]}
  electronics: {adc_bits: [12, 16], sampling: [500 Hz, 5 kHz]}
  objective: rise_time
  front: [rise_time, power]
"""


def load(text):
    return YAML(typ="safe", pure=True).load(text)


def read(text):
    return parse_sensor(text.encode(), name="made", file="made.yaml")


def told(text):
    """Read a file with mistakes, and give them as `line:column: message`."""
    with pytest.raises(ModelFileError) as error:
        read(text)
    return [f"{each.line}:{each.column}: {each.message}" for each in error.value.diagnostics]


def marked(text):
    """Take the first mark out of a text, and give where it stood."""
    at = text.index(MARK)
    return text.replace(MARK, ""), f"{text.count(chr(10), 0, at) + 1}:{at - text.rfind(chr(10), 0, at)}"


class TestAGoodFile:
    sensor = read(GOOD)
    spec = sensor.spec

    def test_the_schema_accepts_it(self):
        VALIDATOR.check_schema(VALIDATOR.schema)
        VALIDATOR.validate(load(GOOD))

    def test_all_is_in_SI(self):
        spec = self.spec
        assert spec.title == "A sensor with everything"
        assert [each.thickness for each in spec.stack if each.material] == pytest.approx([2e-6, 1e-3])
        assert spec.stack[1].joint == pytest.approx(1e5)
        assert (spec.temperatures.object, spec.temperatures.sensor) == pytest.approx((295.15, 309.15))
        assert spec.drive.loop_gain == pytest.approx(5e4)
        assert spec.electronics.noise_density == pytest.approx(1e-8)
        assert spec.electronics.sampling == pytest.approx(1e3)
        assert spec.stack[2].film.coefficient == pytest.approx(3.85e-3)
        assert spec.requirements.surface_temperature == pytest.approx(316.15)
        assert spec.search.temperatures.sensor == pytest.approx((303.15, 315.15))

    def test_planes_signal_and_window(self):
        assert (self.spec.sensed, self.spec.heated) == (2, 3)
        assert self.spec.signal == "power"
        assert self.spec.window == pytest.approx(0.2)

    def test_a_contact_of_the_file_has_three_values(self):
        assert self.spec.contact.conductances == (2e4, 4e4, 5e4)

    def test_names_of_objects(self):
        assert [each.called for each in self.spec.objects] == ["copper", "glass", "block"]

    def test_a_range_may_be_told_by_materials_or_numbers(self):
        asked = self.spec.requirements.range
        assert (asked.least, asked.most) == pytest.approx((36.95, 37137), abs=0.01)

    def test_areal_capacities(self):
        film, chip = (self.spec.entry(each).film for each in ("film", "chip"))
        assert film.areal_capacity(self.sensor.catalogue) == pytest.approx(21450 * 133 * 100e-9)
        assert chip.areal_capacity(self.sensor.catalogue) == pytest.approx(1e-6 * 2000 / 0.5e-6)

    def test_the_element_is_the_rows_or_the_films(self):
        film = self.spec.entry("film").film
        parts = self.sensor.catalogue.parts
        own = film.element(None)
        assert (own.resistance, own.at, own.B, own.coefficient) == pytest.approx((100, 298.15, None, 3.85e-3))
        with_row = film.model_copy(update={"resistance": None, "coefficient": None})
        pt100, ntc = (with_row.element(parts[name]) for name in ("ist_p0k1_161", "semitec_103kt1005t"))
        assert (pt100.resistance, pt100.at, pt100.coefficient) == pytest.approx((100, 273.15, 3.85e-3))
        assert (ntc.resistance, ntc.at, ntc.B) == pytest.approx((1e4, 298.15, 3435))
        assert with_row.element(parts["tdk_b57885s"]) is None  # a family
        assert with_row.element(parts["amphenol_b05"]) is None

    def test_the_variables_of_the_search(self):
        assert self.spec.search.variables() == (
            ("stack", "cover", "thickness"), ("stack", "cover", "material"), ("stack", "chip", "part"), ("contact", "nominal"),
            ("drive", "mode"), ("drive", "loop_gain"), ("pad", "pitch"), ("temperatures", "sensor"),
            ("electronics", "sampling"), ("electronics", "adc_bits"),
        )  # fmt: skip

    def test_what_is_asked(self):
        every = {*type(self.spec.requirements).model_fields}
        assert {*self.spec.requirements.asked} == every

    def test_a_later_mistake_is_told_at_its_place(self):
        error = self.sensor.mistake("too thick", ("stack", 0, "thickness"))
        assert str(error) == "made.yaml:7:52: too thick"

    def test_a_catalogue_can_be_given(self):
        text = GOOD.replace("objects: [copper", "objects: [slate")
        assert "14:11: `slate` is no material" in told(text.replace("pairs: [[copper", "pairs: [[slate"))[0]
        rows = b"materials: {slate: {k: 2 W/m/K, rho: 2800, c: 800, tolerance: 0.2, source: x}}"
        more = parse_catalogue(rows, read_catalogue(), file="mine")
        found = parse_sensor(text.replace("pairs: [[copper", "pairs: [[slate").encode(), name="made", catalogue=more)
        assert found.catalogue.materials["slate"].density == 2800


SMALL = """\
schema: firmtouch.sensor/1
title: A film on foam
stack:
  - {material: kapton, thickness: 12.5 um, sensed: true}
  - {material: foam_backing, thickness: 1 mm}
backing: base
contact: 1e4 W/m^2/K
objects: [copper]
temperatures: {object: 23 degC, sensor: 37 degC}
"""


class TestASmallFile:
    def test_what_is_not_said(self):
        spec = read(SMALL).spec
        assert (spec.sensed, spec.heated, spec.signal, spec.window) == (0, 0, "temperature", 0.5)
        assert spec.drive.mode == "constant_power"
        assert spec.contact.conductances == (1e4,)
        assert spec.contact.prior == 0.3
        assert spec.backing.end == "base"
        assert spec.requirements.asked == ()
        assert spec.search is None
        assert spec.pad is None

    @pytest.mark.parametrize(
        ("written", "kind", "value"),
        [("adiabatic", "end", "adiabatic"), ("{air: 10 W/m^2/K}", "air", 10.0), ("{half_space: pdms}", "half_space", "pdms"), ("{end: base}", "end", "base")],
    )  # fmt: skip
    def test_backings(self, written, kind, value):
        text = SMALL.replace("backing: base", f"backing: {written}")
        assert getattr(read(text).spec.backing, kind) == value
        VALIDATOR.validate(load(text))

    @pytest.mark.parametrize(
        ("written", "conductances"),
        [("smooth", (6.7e3, 1e4, 1.8e4)), ("{nominal: smooth}", (1e4,)), ("{low: rough, nominal: 3 kW/m^2/K, high: gel}", (1e3, 3e3, 3e4)), ("500", (500,))],
    )  # fmt: skip
    def test_contacts(self, written, conductances):
        text = SMALL.replace("contact: 1e4 W/m^2/K", f"contact: {written}")
        assert read(text).spec.contact.conductances == pytest.approx(conductances)
        VALIDATOR.validate(load(text))

    @pytest.mark.parametrize(
        ("written", "pressures"), [("50 kPa", (5e4,)), ("[20 kPa, 50 kPa, 1 bar]", (2e4, 5e4, 1e5))]
    )
    def test_contacts_by_pressure(self, written, pressures):
        text = SMALL.replace("contact: 1e4 W/m^2/K", f"contact: {{pressure: {written}, roughness: 1 um}}")
        contact = read(text).spec.contact
        assert (contact.pressure, contact.roughness) == (pytest.approx(pressures), pytest.approx(1e-6))
        assert (contact.slope, contact.hardness, contact.conductances) == (0.15, 0.25e9, ())
        VALIDATOR.validate(load(text))

    @pytest.mark.parametrize(
        "drive",
        ["pulse", "{mode: pulse, flux: 10 kW/m^2}", "{mode: two_temperature, second: 45 degC}", "{mode: constant_power, flux: 1 kW/m^2}", "constant_power"],
    )  # fmt: skip
    def test_drives(self, drive):
        text = f"{SMALL}drive: {drive}\n"
        VALIDATOR.validate(load(text))
        if drive == "pulse":
            assert told(text) == ["10:1: the mode `pulse` needs a `power` or a `flux`"]
        else:
            assert read(text).spec.drive.mode in drive

    def test_a_pulse_needs_no_difference(self):
        text = SMALL.replace("23 degC", "37 degC")
        assert len(told(text)) == 1
        assert read(f"{text}drive: {{mode: pulse, flux: 10 kW/m^2}}\n").spec.signal == "temperature"


LAYER = "{material: kapton, thickness: 12.5 um, sensed: true}"
FOAM = "{material: foam_backing, thickness: 1 mm}"
AT = "contact: 1e4 W/m^2/K"
OBJECTS = "objects: [copper]"
BASE = "backing: base"
WARM = "temperatures: {object: 23 degC, sensor: 37 degC}"

# What is replaced in the small file, by what, and what is told; the mark stands where it is told.
MISTAKES = {
    "negative thickness": (FOAM, f"{{material: foam_backing, thickness: {MARK}-1 mm}}", "`-1 mm` is out of range; it must be positive"),
    "thickness of zero": (FOAM, f"{{material: foam_backing, thickness: {MARK}0}}", "`0` is out of range; it must be positive"),
    "thickness in another unit": (FOAM, f"{{material: foam_backing, thickness: {MARK}1 mW}}", "`1 mW` is in W, but m was expected"),
    "thickness of no sense": (FOAM, f"{{material: foam_backing, thickness: {MARK}thin}}", "`thin` is no quantity"),
    "thick as a house": (FOAM, f"{{material: foam_backing, thickness: {MARK}3 m}}", "`3 m` is out of range; it must lie between 1e-09 and 1 m"),
    "no thickness": (FOAM, f"{MARK}{{material: foam_backing}}", "`thickness` is missing here"),
    "unknown material": (LAYER, f"{{material: {MARK}captan, thickness: 5 um, sensed: true}}", "`captan` is no material"),
    "unknown material, suggestion": (LAYER, f"{{material: {MARK}kaptan, thickness: 5 um, sensed: true}}", "did you mean `kapton`?"),
    "unknown material behind": (BASE, f"backing: {{half_space: {MARK}pdmss}}", "did you mean `pdms`?"),
    "unknown object": (OBJECTS, f"objects: [{MARK}coper]", "did you mean `copper`?"),
    "unknown object of a thickness": (OBJECTS, f"objects: [{{material: {MARK}coper, thickness: 1 mm}}]", "did you mean `copper`?"),
    "unknown key": (FOAM, f"{{material: foam_backing, {MARK}thicknes: 1 mm, thickness: 1 mm}}", "did you mean `thickness`?"),
    "unknown section": (BASE, f"backing: base\n{MARK}requirement: {{}}", "did you mean `requirements`?"),
    "conductance of zero": (AT, f"contact: {MARK}0 W/m^2/K", "a conductance of zero lets no heat through"),
    "conductance below zero": (AT, f"contact: {{nominal: {MARK}-5}}", "`-5` is out of range; it must be positive"),
    "conductance of a layer": (AT, f"contact: {MARK}5 W/m/K", "`5 W/m/K` is in W/m/K, but W/m^2/K was expected"),
    "unknown contact": (AT, f"contact: {MARK}smoth", "`smoth` is no contact; there are: rough, finger, smooth, gel; did you mean `smooth`?"),
    "contacts in disorder": (AT, f"contact: {{low: gel, nominal: {MARK}smooth}}", "must not decrease"),
    "no contact": (AT, f"{MARK}contact: {{low: rough}}", "`nominal` is missing here"),
    "pressure without roughness": (AT, f"contact: {{{MARK}pressure: 5 kPa}}", "`pressure` needs the `roughness` beside it"),
    "pressure and conductance": (AT, f"contact: {{{MARK}nominal: smooth, pressure: 5 kPa, roughness: 1 um}}", "give either conductances or a `pressure`"),
    "pressure of zero": (AT, f"contact: {{pressure: {MARK}0 Pa, roughness: 1 um}}", "a pressure of zero is no contact"),
    "pressure as of a press": (AT, f"contact: {{pressure: {MARK}50 MPa, roughness: 1 um}}", "below a tenth of the hardness, 2.5e+07 Pa"),
    "two pressures": (AT, f"contact: {{pressure: {MARK}[1 kPa, 2 kPa], roughness: 1 um}}", "three pressures were expected"),
    "roughness alone": (AT, f"contact: {{nominal: smooth, {MARK}roughness: 1 um}}", "`roughness` needs a `pressure` beside it"),
    "no sensed plane": (LAYER, FOAM, "no plane is sensed; mark an entry with `sensed: true`"),
    "two sensed planes": (FOAM, f"{{material: pdms, thickness: 1 mm, {MARK}sensed: true}}", "a second sensed plane; the first is entry 1 of the stack"),
    "two heated planes": (FOAM, f"{{material: pdms, thickness: 1 mm, heated: true}}\n  - {{material: pdms, thickness: 1 mm, {MARK}heated: true}}", "a second heated plane; the first is entry 2"),
    "sensed joint": (FOAM, f"{{joint: 1e5, {MARK}sensed: true}}", "a joint has two temperatures"),
    "a layer and a film": (FOAM, f"{MARK}{{material: pdms, thickness: 1 mm, film: {{capacity: 1}}}}", "here is `material` and `film`"),
    "nothing": (FOAM, f"{MARK}{{name: x}}", "here is none of them"),
    "a word as an entry": (FOAM, f"{MARK}foam", "a mapping `name: value` was expected, not `foam`"),
    "two entries of a name": (FOAM, f"{{name: a, joint: 1e5}}\n  - {{name: {MARK}a, joint: 1e5}}", "an entry `a` stands above"),
    "unknown part": (FOAM, f"{{film: {{part: {MARK}tdk_b575}}}}", "did you mean `tdk_b574`?"),
    "part without capacity": (FOAM, f"{{film: {{part: {MARK}semitec_ft_r, area: 1 mm^2}}}}", "`semitec_ft_r` is a part without a heat capacity"),
    "part of two media": (FOAM, f"{{film: {{part: {MARK}vishay_ntcle413, area: 1 mm^2}}}}", "`vishay_ntcle413` is a part without a heat capacity"),
    "part without footprint": (FOAM, f"{{film: {{part: {MARK}semitec_103jt}}}}", "has no footprint in the tables; give the `area`"),
    "film without capacity": (FOAM, f"{{film: {{capacity: {MARK}0}}}}", "a film without a capacity"),
    "film of nothing": (FOAM, f"{{film: {MARK}{{}}}}", "here is none of them"),
    "film of two": (FOAM, f"{{film: {MARK}{{capacity: 1, part: amphenol_b05}}}}", "here is `part` and `capacity`"),
    "film without thickness": (FOAM, f"{{{MARK}film: {{material: gold}}}}", "`thickness` is missing here"),
    "film with an area": (FOAM, f"{{film: {{material: gold, thickness: 1 um, {MARK}area: 1 mm^2}}}}", "`area` goes with `part`"),
    "part with another B": (FOAM, f"{{film: {{part: murata_ncp03wf104, {MARK}B: 3000 K}}}}", "a part brings its `B` from the table"),
    "a metal with B": (FOAM, f"{{film: {{part: ist_p0k1_161, {MARK}B: 3000 K}}}}", "a metal has a `coefficient` and no `B`"),
    "an oxide with a coefficient": (FOAM, f"{{film: {{part: amphenol_b05, {MARK}coefficient: 1 %/K}}}}", "an ntc has a `B` and no `coefficient`"),
    "a film with both": (FOAM, f"{{film: {{capacity: 1, {MARK}B: 3000 K, coefficient: 1 %/K}}}}", "a metal has a `coefficient` and no `B`"),
    "a resistance out of its family": (
        FOAM,
        f"{{film: {{part: vishay_tfpt0603, area: 1 mm^2, resistance: {MARK}2 kohm}}}}",
        "the parts of this family have 100 to 1000",
    ),
    "backing of air without h": (BASE, f"backing: {MARK}air", "give its conductance, `{air: 10 W/m^2/K}`"),
    "backing of two": (BASE, f"backing: {MARK}{{air: 10, half_space: pdms}}", "here is `half_space` and `air`"),
    "backing of nothing known": (BASE, f"backing: {MARK}bas", "did you mean `base`?"),
    "bare temperature": (WARM, f"temperatures: {{object: {MARK}23, sensor: 37 degC}}", "`23` may be in degC or in K; write `37 degC` or `310 K`"),
    "cold as space": (WARM, f"temperatures: {{object: {MARK}23 K, sensor: 37 degC}}", "`23 K` is out of range; it must lie between 200 K and 500 K"),
    "no difference": (WARM, f"temperatures: {{object: 37 degC, sensor: {MARK}37 degC}}", "object and sensor have one temperature"),
    "no temperature": (WARM, f"{MARK}temperatures: {{object: 37 degC}}", "`sensor` is missing here"),
    "an object twice": (OBJECTS, f"objects: [copper, {MARK}copper]", "an object `copper` stands above; give this one another `name`"),
    "no objects": (OBJECTS, f"objects: {MARK}[]", "no entries where at least 1 is needed"),
    "a shipped row": (BASE, f"backing: base\nmaterials: {{{MARK}pdms: {{k: 1, rho: 1000, c: 1000, tolerance: 0, source: x}}}}", "`pdms` is in the table already"),
}  # fmt: skip

# What is added to the small file.
ADDED = {
    "unknown mode": (f"drive: {MARK}constant_pwoer", "did you mean `constant_power`?"),
    "mode without its gain": (f"{MARK}drive: constant_temperature", "the mode `constant_temperature` needs a `loop_gain`"),
    "gain of zero": (f"drive: {{mode: constant_temperature, loop_gain: {MARK}0}}", "`0` is out of range; it must be positive"),
    "lag below zero": (f"drive: {{mode: constant_temperature, loop_gain: 1e4, sensor_lag: {MARK}-1 ms}}", "it must not be negative"),
    "gain of another mode": (f"drive: {{mode: constant_power, {MARK}loop_gain: 1e4}}", "`loop_gain` does not go with the mode `constant_power`"),
    "power without a pad": (f"drive: {{mode: constant_power, {MARK}power: 5 mW}}", "the `power` of a pad needs a `pad`"),
    "power and flux": (f"pad: {{radius: 1 mm}}\ndrive: {{mode: pulse, power: 5 mW, {MARK}flux: 1}}", "give either `power` or `flux`"),
    "both at one temperature": (f"drive: {{mode: two_temperature, second: {MARK}37 degC}}", "both pads have one temperature"),
    "pads that overlap": (f"pad: {{radius: 2 mm, pitch: {MARK}3 mm}}", "pads of 0.004 m across overlap at a pitch of 0.003 m"),
    "pads without a pitch": (f"{MARK}pad: {{radius: 2 mm, rows: 2}}", "2 x 1 pads need a `pitch`"),
    "half a row": (f"pad: {{radius: 2 mm, rows: {MARK}1.5}}", "`1.5` is not possible here; expected a whole number from 1 to 1000"),
    "noise density": (f"electronics: {{sampling: 1 kHz, bridge_voltage: 1 V, noise_density: {MARK}10 nV}}", "`10 nV` is no noise density; write `10 nV/sqrt(Hz)`"),
    "noise twice": (f"electronics: {{sampling: 1 kHz, temperature_noise: 1 mK, {MARK}adc_bits: 12, adc_range: 1 V}}", "would count noise a second time"),
    "no noise": (f"{MARK}electronics: {{sampling: 1 kHz}}", "give a `bridge_voltage`, or the `temperature_noise`"),
    "bits of no range": (f"electronics: {{sampling: 1 kHz, bridge_voltage: 1 V, {MARK}adc_bits: 12}}", "`adc_bits` needs `adc_range` beside it"),
    "metric unnamed": (f"requirements:\n  {MARK}rise_time: {{at_most: 1 ms}}", "`metric` is missing here"),
    "metric unknown": (f"requirements: {{rise_time: {{at_most: 1 ms, metric: {MARK}tau}}}}", "`tau` is not possible here; expected `10-90`, `63 %` or `d_prime`"),
    "metric without pairs": (f"requirements: {{rise_time: {{at_most: 1 ms, metric: {MARK}d_prime}}}}", "the metric `d_prime` needs `discrimination`"),
    "longer than the window": (f"requirements: {{rise_time: {{at_most: {MARK}1 s, metric: 10-90}}}}", "1 s is longer than the window of 0.5 s"),
    "power that tells nothing": (f"requirements: {{rise_time: {{at_most: 1 ms, metric: 10-90, signal: {MARK}power}}}}", "the heater's power tells nothing"),
    "a pair of what is not touched": (f"electronics: {{sampling: 1 kHz, temperature_noise: 1 mK}}\nrequirements: {{discrimination: {{pairs: [[copper, {MARK}coppper]], time: 1 ms}}}}", "`coppper` is none of the `objects`; did you mean `copper`?"),
    "a pair of one": (f"requirements: {{discrimination: {{pairs: [{MARK}[copper, copper]], time: 1 ms}}}}", "an object cannot be told from itself"),
    "discrimination without noise": (f"requirements: {{{MARK}range: {{least: cork, most: copper, time: 1 ms}}}}", "`range` needs the `electronics`"),
    "a range upside down": (f"requirements: {{range: {{least: {MARK}copper, most: cork, time: 1 ms}}}}", "the range is empty"),
    "cross-talk of one pad": (f"pad: {{radius: 1 mm}}\nrequirements: {{{MARK}crosstalk: {{at_most: 5 %, time: 1 ms}}}}", "`crosstalk` needs a `pad` with its `pitch`"),
    "cross-talk at no time": (f"pad: {{radius: 1 mm, pitch: 3 mm}}\nrequirements: {{crosstalk: {MARK}5 %}}", "say at which `time` after the touch"),
    "power of nothing": (f"pad: {{radius: 1 mm}}\nrequirements: {{power: {MARK}{{}}}}", "at least one of `pad` and `array` is needed"),
    "a bridge on nothing": (
        f"electronics: {{sampling: 1 kHz, bridge_voltage: {MARK}1 V}}",
        "the sensed film has no `resistance` with a `B` or a `coefficient`",
    ),
    "self-heating of no bridge": (
        f"electronics: {{sampling: 1 kHz, temperature_noise: 1 mK}}\nrequirements: {{{MARK}self_heating: 0.1 K}}",
        "`self_heating` needs the `bridge_voltage`",
    ),
    "search of nothing": (f"{MARK}search: {{objective: power}}", "nothing to search; there are: stack, contact, drive"),
    "search of no entry": (f"search: {{objective: power, stack: {{{MARK}cover: {{thickness: [1 um, 2 um]}}}}}}", "`cover` is the `name` of no entry of the stack"),
    "search of no pad": (f"search: {{objective: power, {MARK}pad: {{radius: [1 mm, 2 mm]}}}}", "the file has no `pad` to start from"),
    "search of an empty range": (f"search: {{objective: power, contact: {{nominal: {MARK}[2, 1]}}}}", "`[2, 1]` holds nothing"),
    "search of a range of zero": (f"search: {{objective: power, contact: {{nominal: [{MARK}0, 1]}}}}", "a conductance of zero lets no heat through"),
    "search of a pressure": (f"search: {{objective: power, contact: {{{MARK}pressure: [1 kPa, 2 kPa]}}}}", "the file's `contact` is given by its conductance"),
    "search of an unknown mode": (f"search: {{objective: power, drive: {{mode: [puls, {MARK}pulse]}}}}".replace(f"puls, {MARK}", f"{MARK}puls, "), "did you mean `pulse`?"),
    "an unknown objective": (f"search: {{objective: {MARK}raise_time, contact: {{nominal: [1, 2]}}}}", "did you mean `rise_time`?"),
    "a front of one": (f"search: {{objective: power, front: {MARK}[power], contact: {{nominal: [1, 2]}}}}", "two or three different objectives"),
    "search of a loop without a gain": (f"search: {{objective: power, drive: {{mode: [{MARK}constant_temperature]}}}}", "needs a `loop_gain`, in `drive` or in `search: drive`"),
    "search of a pulse without power": (f"search: {{objective: power, drive: {{mode: [{MARK}pulse]}}}}", "needs a `power` or a `flux`, in `drive` or in `search: drive`"),
    "search of a pad's power": (f"search: {{objective: power, drive: {{{MARK}power: [1 mW, 2 mW]}}}}", "the `power` of a pad needs a `pad`"),
    "search of bits of nothing": (f"electronics: {{sampling: 1 kHz, temperature_noise: 1 mK}}\nsearch: {{objective: power, electronics: {{{MARK}adc_bits: [12, 16]}}}}", "have no `adc_range`"),
    "search of a voltage of nothing": (f"electronics: {{sampling: 1 kHz, temperature_noise: 1 mK}}\nsearch: {{objective: power, electronics: {{{MARK}bridge_voltage: [1 V, 2 V]}}}}", "have no `bridge_voltage`"),
    "discrimination of nothing": (f"search: {{objective: {MARK}discrimination, contact: {{nominal: [1, 2]}}}}", "say in `requirements: discrimination` of which pairs"),
}  # fmt: skip


FELT = (
    SMALL.replace(", sensed: true", "").replace(
        "stack:", "stack:\n  - {film: {capacity: 1 J/m^2/K, FELT}, sensed: true}"
    )
    + "electronics: {sampling: 1 kHz, bridge_voltage: 0.1 V}\n"
)


class TestWhatAFilmFeelsWith:
    def test_the_coefficients_of_steinhart_and_hart(self):
        text = FELT.replace("FELT", "steinhart_hart: [1.129e-3, 2.341e-4, 8.775e-8]")
        VALIDATOR.validate(load(text))
        element = read(text).spec.stack[0].film.element(None)
        assert element.steinhart_hart == pytest.approx((1.129e-3, 2.341e-4, 8.775e-8))

    @pytest.mark.parametrize(
        ("felt", "message"),
        [
            ("steinhart_hart: [1e-3, 2e-4]", "three plain numbers a, b, c were expected"),
            ("steinhart_hart: [1e-3, 2e-4, 9e-8], B: 3435 K", "`steinhart_hart` is given; `B` says it again"),
            ("steinhart_hart: [1e-3 K, 2e-4, 9e-8]", "a plain number"),
        ],
    )
    def test_other_coefficients_are_refused(self, felt, message):
        found = told(FELT.replace("FELT", felt))
        assert len(found) == 1, found
        assert message in found[0]

    @pytest.mark.parametrize("name", ["self_heating: 0.1 K", "feedback: 5 %"])
    def test_its_own_heat_needs_its_size(self, name):
        text = FELT.replace("FELT", "resistance: 100 ohm, coefficient: 0.4 %/K") + f"requirements: {{{name}}}\n"
        assert "needs the size of the sensed film: a `pad`" in "".join(told(text))
        assert read(text + "pad: {radius: 1 mm}\n").spec.requirements.asked == (name.partition(":")[0],)


class TestMistakes:
    @pytest.mark.parametrize("name", MISTAKES)
    def test_of_a_piece(self, name):
        old, new, message = MISTAKES[name]
        assert SMALL.count(old) == 1
        text = SMALL.replace(old, new)
        text, place = marked(text) if MARK in text else (text, "3:1")
        found = told(text)
        assert len(found) == 1, found
        assert found[0].startswith(f"{place}: "), found
        assert message in found[0]

    @pytest.mark.parametrize("name", ADDED)
    def test_of_what_is_added(self, name):
        more, message = ADDED[name]
        text, place = marked(SMALL + more + "\n")
        found = told(text)
        assert len(found) == 1, found
        assert found[0].startswith(f"{place}: "), found
        assert message in found[0]

    def test_an_empty_stack(self):
        text = SMALL.replace(f"\n  - {LAYER}\n  - {FOAM}", " []")
        assert told(text) == ["3:8: no entries where at least 1 is needed"]

    def test_a_stack_of_joints(self):
        text = SMALL.replace(LAYER, "{joint: 1e5}").replace(FOAM, "{joint: 1e5}")
        assert "3:1: a stack of joints alone" in told(text)

    def test_an_empty_file(self):
        assert told("") == [
            "1:1: the file is empty; a sensor's layers stand under `stack:`, from the touched face inward"
        ]

    def test_all_of_them_at_once_and_none_for_what_a_bad_row_is_used_in(self):
        text = SMALL.replace("kapton", "my_film").replace("1 mm", "-1 mm").replace("1e4 W/m^2/K", "0")
        text += "materials: {my_film: {k: 0 W/m/K, rho: 1000, c: 1000, tolerance: 0, source: x}}\n"
        assert [each.partition(": ")[0] for each in told(text)] == ["5:41", "7:10", "10:26"]


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
class TestModels:
    def test_they_are_read_and_the_schema_accepts_them(self, path):
        sensor = read_sensor(path)
        assert sensor.name == path.stem
        assert len(sensor.sha256) == 64
        assert sensor.spec.requirements.rise_time is not None
        VALIDATOR.validate(load(path.read_text(encoding="utf-8")))

    def test_no_damage_breaks_the_reader(self, path):
        source, answers = path.read_bytes(), []
        for i in range(75):
            damaged = mutate(source, f"{path.stem}:{i}")
            try:
                parse_sensor(damaged.content, name="damaged", file="damaged.yaml")
            except ModelFileError as error:
                answers.append(False)
                lines = damaged.content.decode("utf-8", "replace").count("\n") + 2
                for each in error.diagnostics:
                    assert 1 <= each.line <= lines + damaged.content.count(b"\r"), damaged
                    assert each.column >= 1, damaged
                    assert each.message.isprintable(), damaged
                    words = ("Input should", "Field required", "validation error", "should be")
                    assert not any(word in each.message for word in words), damaged
            else:
                answers.append(True)
        assert 5 <= sum(answers) <= 70  # some damage is harmless, most is not: the damage is no mere noise


def test_there_are_four_models():
    assert [path.stem for path in MODELS] == ["array_20x20", "biotac_like", "fingertip_chip", "fingertip_film"]


def test_the_capacities_of_the_models_that_decide():
    chip, film = (read_sensor(path) for path in MODELS[2:])
    found = chip.spec.entry("chip").film.areal_capacity(chip.catalogue)
    assert found * 0.5e-6 == pytest.approx(1.54e-3)  # delta tau of the data sheet
    # What 10 ms need of the contact, 2.197 C''/t: out of reach of any contact of the tables.
    needed = 2.197225 * found / film.spec.requirements.rise_time.at_most
    assert needed == pytest.approx(6.8e5, rel=0.01)
    assert needed > 10 * max(each.high for each in chip.catalogue.contacts.values())


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("titel",), "x"),
        (("stack",), []),
        (("stack", 0), "kapton"),
        (("stack", 0, "thicknes"), "1 um"),
        (("stack", 0, "sensed"), "yes"),
        (("objects",), []),
        (("objects",), "copper"),
        (("temperatures",), {"object": "20 degC"}),
        (("temperatures", "object"), 20),
        (("drive",), "constant"),
        (("requirements",), {"rise_time": {"at_most": "1 ms"}}),
        (("requirements",), {"rise_time": {"at_most": "1 ms", "metric": "tau"}}),
        (("search",), {"objective": "speed"}),
        (("pad",), {"radius": "1 mm", "rows": 0}),
        (("schema",), "firmtouch.sensor/2"),
    ],
)
def test_the_schema_refuses_mistakes_of_structure(path, value):
    data = here = load(SMALL)
    for key in path[:-1]:
        here = here[key]
    here[path[-1]] = value
    assert not VALIDATOR.is_valid(data)
