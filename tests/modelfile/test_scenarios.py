"""Scenario files: what a good one becomes, each mistake at its line and column, and that nothing breaks the reader."""

import json
import math
import random
from collections import Counter
from pathlib import Path

import pytest
from pydantic import ValidationError
from ruamel.yaml import YAML

from firmtouch.errors import InputError, ModelFileError
from firmtouch.modelfile import parse_model, read_model
from firmtouch.modelfile.scenarios import parse_scenarios, read_scenarios

ROOT = Path(__file__).parents[2]
MARK = "»"

# Lengths and angles among the coordinates and among the constraints; a table top in metres beside a wall in metres.
MODEL = """\
schema: firmtouch.model/1
title: A plate on a table
parameters: {m: 2 kg, I: 0.1 kg*m^2, g: 9.81 m/s^2}
coordinates:
  x: {unit: m, effort: 30 N}
  y: {unit: m}
  a: {unit: rad, effort: 5 N*m}
  b: rad
mechanism:
  kinetic_energy: 0.5*m*(dot(x)**2 + dot(y)**2) + 0.5*I*(dot(a)**2 + dot(b)**2)
  potential_energy: m*g*y
constraints:
  table: {expression: y, unit: m, one_sided: true}
  wall: {expression: x, unit: m}
  flat: {expression: a, unit: rad}
operating_point:
  q_d: {x: 0, y: 0, a: 0, b: 0}
  lambda_d: {table: 19.62 N, wall: 3 N, flat: 1 N*m}
design: {poles: [-4, -5], force_feedback: 0.5}
"""

GOOD = """\
schema: firmtouch.scenario/1
scenarios:
  all_at_once:
    title: "  Everything   at once  "
    duration: 250 ms
    controller: 11
    P_d: m*g*y + m*g*(x + y)*b**2 - m*g*x
    start:
      beside_q_d: {x: 2 mm, b: 3 deg}
      velocity: {b: 90 deg/s}
    disturbances:
      - {force: {x: 2 N, a: 50 N*mm}}
      - {force: {b: 1 N*m}, from: 20 ms, until: 0.1 s}
      - {force: {y: 1 kN}, frequency: 5 Hz, phase: 90 deg}
      - {force: {y: 3}, frequency: 7 rad/s, from: 1}
    surface:
      offset: {table: 2 mm}
      rotation: {angle: 2 deg, constraints: [table, wall]}
      tilt: {flat: {x: 3, a: 0.1}, wall: {b: 4 mm}}
    parameters: {m: 2500 g}
    gravity_error: {y: 0.5 N}
    limits: false
    force_path: {bandwidth: 80 Hz, delay: 2 ms, sample: 1 ms}
    noise: {position: {x: 1 um, y: 0, a: 1 mrad, b: 1 mrad}, force: {table: 0.1 N, wall: 0.2 N, flat: 0}, seed: 7}
  nothing: {}
"""


@pytest.fixture(scope="module")
def model():
    return parse_model(MODEL.encode(), name="plate")


@pytest.fixture(scope="module")
def read(model):
    return lambda text: parse_scenarios(text.encode(), model, file="runs.yaml").scenarios


@pytest.fixture(scope="module")
def told(read):
    """Give what is told of a file, as `line:column: message`."""

    def told(text):
        with pytest.raises(ModelFileError) as caught:
            read(text)
        lines = str(caught.value).splitlines()
        assert all(each.startswith("runs.yaml:") for each in lines)
        return [each.removeprefix("runs.yaml:") for each in lines]

    return told


def marked(text):
    """Take the marks out of a text, and give the places where they stood."""
    places = []
    while (at := text.find(MARK)) >= 0:
        places.append(f"{text.count(chr(10), 0, at) + 1}:{at - (text.rfind(chr(10), 0, at) + 1) + 1}")
        text = text[:at] + text[at + 1 :]
    return text, places


class TestAGoodFile:
    def test_quantities_are_in_si(self, read):
        run = read(GOOD)["all_at_once"]
        assert run.title == "Everything at once"
        assert run.duration == pytest.approx(0.25, rel=1e-15)
        assert run.start.beside_q_d == pytest.approx({"x": 0.002, "b": math.radians(3)}, rel=1e-15)
        assert run.start.velocity == pytest.approx({"b": math.pi / 2}, rel=1e-15)
        assert run.surface.offset == pytest.approx({"table": 0.002}, rel=1e-15)
        assert run.surface.rotation.angle == pytest.approx(math.radians(2), rel=1e-15)
        assert run.surface.rotation.constraints == ("table", "wall")
        assert run.surface.tilt == {"flat": {"x": 3, "a": 0.1}, "wall": {"b": pytest.approx(0.004, rel=1e-15)}}
        assert run.parameters == {"m": pytest.approx(2.5, rel=1e-15)}
        assert run.gravity_error == {"y": 0.5}
        assert run.noise.position == pytest.approx({"x": 1e-6, "y": 0, "a": 1e-3, "b": 1e-3}, rel=1e-15)
        assert run.noise.velocity is None
        assert run.noise.force == {"table": 0.1, "wall": 0.2, "flat": 0}
        assert run.noise.seed == 7

    def test_a_force_is_constant_a_pulse_or_swings(self, read):
        push, pulse, swing, slow = read(GOOD)["all_at_once"].disturbances
        assert push.force == {"x": 2, "a": pytest.approx(0.05, rel=1e-15)}
        assert (push.from_, push.until, push.frequency, push.phase) == (0, None, None, None)
        assert (pulse.from_, pulse.until) == (pytest.approx(0.02, rel=1e-15), 0.1)
        assert swing.force == {"y": 1000}
        assert swing.frequency == pytest.approx(10 * math.pi, rel=1e-15)  # hertz count cycles
        assert swing.phase == pytest.approx(math.pi / 2, rel=1e-15)
        assert slow.frequency == 7  # and radians are radians
        assert slow.from_ == 1

    def test_the_electronics_are_those_of_the_file(self, read):
        run = read(GOOD)["all_at_once"]
        assert run.controller == 11
        assert run.P_d.names == {"x", "y", "b", "g", "m"}
        assert run.limits is False
        assert run.ideal_force_path is False
        assert run.force_path.bandwidth == pytest.approx(160 * math.pi, rel=1e-15)
        assert (run.force_path.delay, run.force_path.sample) == pytest.approx((2e-3, 1e-3), rel=1e-15)

    def test_what_is_not_said_is_the_plain_case(self, read):
        run = read(GOOD)["nothing"]
        assert (run.title, run.duration, run.P_d, run.noise, run.force_path) == (None,) * 5
        assert (run.controller, run.limits, run.ideal_force_path, run.disturbances) == (17, True, False, ())
        assert (run.start.q, run.start.beside_q_d, run.start.velocity) == (None,) * 3
        assert (run.surface.offset, run.surface.rotation, run.surface.tilt) == (None,) * 3
        assert (run.parameters, run.gravity_error) == (None, None)

    def test_scenarios_keep_their_order_and_never_change(self, read):
        scenarios = read(GOOD)
        assert list(scenarios) == ["all_at_once", "nothing"]
        with pytest.raises(ValidationError, match="frozen"):
            scenarios["nothing"].duration = 1.0

    def test_the_schema_may_be_left_out(self, read):
        assert list(read("scenarios: {a: {}}")) == ["a"]

    def test_a_whole_configuration_is_read_in_the_models_units(self, read):
        run = read("scenarios: {a: {start: {q: {x: 1 cm, y: 0, a: 90 deg, b: 1}}}}")["a"]
        assert run.start.q == pytest.approx({"x": 0.01, "y": 0, "a": math.pi / 2, "b": 1}, rel=1e-15)

    def test_as_many_scenarios_and_forces_as_are_allowed(self, read):
        forces = ", ".join(["{force: {x: 1 N}}"] * 20)
        many = "".join(f"  s{i}: {{}}\n" for i in range(49))
        found = read(f"scenarios:\n  busy: {{disturbances: [{forces}]}}\n{many}")
        assert len(found) == 50
        assert len(found["busy"].disturbances) == 20

    def test_a_file_of_bytes_with_bom_and_crlf_is_the_same(self, read, model):
        content = b"\xef\xbb\xbf" + GOOD.replace("\n", "\r\n").encode()
        assert parse_scenarios(content, model, file="runs.yaml").scenarios == read(GOOD)


# A scenario with a mark where the mistake is, and words of the message.
SINGLE = {
    "unknown coordinate": (f"start: {{beside_q_d: {{{MARK}q9: 1 mm}}}}", "`q9` is no coordinate; there are: x, y, a, b"),
    "unknown coordinate of a force": (f"disturbances: [{{force: {{{MARK}z: 1 N}}}}]", "`z` is no coordinate"),
    "unknown coordinate of a velocity": (f"start: {{velocity: {{{MARK}z: 1 m/s}}}}", "`z` is no coordinate"),
    "unknown constraint": (f"surface: {{offset: {{{MARK}tabel: 1 mm}}}}", "`tabel` is no constraint; there are: table, wall, flat; did you mean `table`?"),
    "unknown constraint of a tilt": (f"surface: {{tilt: {{{MARK}floor: {{x: 1}}}}}}", "`floor` is no constraint"),
    "unknown coordinate of a tilt": (f"surface: {{tilt: {{table: {{{MARK}z: 1}}}}}}", "`z` is no coordinate"),
    "unknown parameter": (f"parameters: {{{MARK}M: 3 kg}}", "`M` is no parameter; there are: m, I, g"),
    "unknown key": (f"{MARK}dration: 1 s", "unknown key `dration`; there are: title, duration, controller"),
    "unknown key, suggestion": (f"{MARK}dration: 1 s", "did you mean `duration`?"),
    "unknown key below": (f"surface: {{{MARK}ofset: {{table: 1 mm}}}}", "did you mean `offset`?"),
    "from as it is named in the code": (f"disturbances: [{{force: {{x: 1 N}}, {MARK}from_: 1 s}}]", "unknown key `from_`"),
    "unit of a position": (f"start: {{beside_q_d: {{x: {MARK}1 deg/s}}}}", "`1 deg/s` is in 1/s, but m was expected"),
    "unit of an angle": (f"start: {{beside_q_d: {{a: {MARK}1 mm}}}}", "`1 mm` is in m, but a plain number or an angle was expected"),
    "unit of a velocity": (f"start: {{velocity: {{x: {MARK}1 m}}}}", "`1 m` is in m, but m/s was expected"),
    "unit of a force": (f"disturbances: [{{force: {{x: {MARK}1 N*m}}}}]", "`1 N*m` is in J, but N was expected"),
    "unit of a torque": (f"gravity_error: {{a: {MARK}1 N}}", "`1 N` is in N, but J was expected"),
    "unit of an offset": (f"surface: {{offset: {{flat: {MARK}1 mm}}}}", "`1 mm` is in m, but a plain number or an angle was expected"),
    "unit of a tilt": (f"surface: {{tilt: {{table: {{b: {MARK}1 deg}}}}}}", "but m was expected"),
    "unit of a parameter": (f"parameters: {{m: {MARK}1 m}}", "`1 m` is in m, but kg was expected"),
    "unit of a duration": (f"duration: {MARK}1 m", "`1 m` is in m, but s was expected"),
    "unit of P_d": (f"{{controller: 5, P_d: {MARK}m*g}}", "this is in N, but J was expected"),
    "velocity in P_d": (f"{{controller: 5, P_d: m*{MARK}dot(x)**2}}", "velocities are not allowed here"),
    "name in P_d": (f"{{controller: 5, P_d: m*g*{MARK}z}}", "`z`"),
    "until before from": (f"disturbances: [{{force: {{x: 1 N}}, from: 2 s, until: {MARK}1 s}}]", "this ends at 1 s, and begins at 2 s"),
    "until at from": (f"disturbances: [{{force: {{x: 1 N}}, from: 2 s, until: {MARK}2 s}}]", "this ends at 2 s, and begins at 2 s"),
    "from in the past": (f"disturbances: [{{force: {{x: 1 N}}, from: {MARK}-1 s}}]", "`-1 s` is out of range; it must be between 0 and 3600"),
    "phase alone": (f"disturbances: [{{force: {{x: 1 N}}, phase: {MARK}1}}]", "a `phase` belongs to a `frequency`"),
    "frequency of nothing": (f"disturbances: [{{force: {{x: 1 N}}, frequency: {MARK}5}}]", "this may count cycles or radians; write `80 Hz`"),
    "frequency in 1/s": (f"disturbances: [{{force: {{x: 1 N}}, frequency: {MARK}5 1/s}}]", "this may count cycles or radians"),
    "frequency in seconds": (f"disturbances: [{{force: {{x: 1 N}}, frequency: {MARK}5 s}}]", "`5 s` is in s, but 1/s was expected"),
    "frequency of zero": (f"disturbances: [{{force: {{x: 1 N}}, frequency: {MARK}0 Hz}}]", "0 rad/s is out of range; it must lie between 0.001"),
    "no force": (f"disturbances: [{MARK}{{from: 1 s}}]", "`force` is missing here"),
    "empty force": (f"disturbances: [{{force: {MARK}{{}}}}]", "an entry for a coordinate was expected, as in `{x: ...}`"),
    "force for all": (f"disturbances: [{{force: {MARK}1 N}}]", "an entry for a coordinate was expected"),
    "both places": (f"start: {{q: {{x: 0, y: 0, a: 0, b: 0}}, {MARK}beside_q_d: {{x: 0}}}}", "give either `q` or `beside_q_d`, not both"),
    "half a configuration": (f"start: {{q: {MARK}{{x: 0, y: 0}}}}", "no entry for the coordinate `a`, `b`"),
    "rotation of one": (f"surface: {{rotation: {{angle: 1 deg, constraints: {MARK}[table]}}}}", "two constraints were expected, as in `[first, second]`"),
    "rotation of three": (f"surface: {{rotation: {{angle: 1 deg, constraints: {MARK}[table, wall, flat]}}}}", "two constraints were expected, as in `[first, second]`"),
    "rotation of one name": (f"surface: {{rotation: {{angle: 1 deg, constraints: {MARK}table}}}}", "two constraints were expected, as in `[first, second]`"),
    "rotation of units": (f"surface: {{rotation: {{angle: 1 deg, constraints: {MARK}[table, flat]}}}}", "constraints of different units cannot be rotated"),
    "rotation of the same": (f"surface: {{rotation: {{angle: 1 deg, constraints: {MARK}[wall, wall]}}}}", "the same constraint twice; a rotation mixes two"),
    "rotation of what is not": (f"surface: {{rotation: {{angle: 1 deg, constraints: [wall, {MARK}floor]}}}}", "`floor` is no constraint"),
    "rotation too far": (f"surface: {{rotation: {{angle: {MARK}200 deg, constraints: [table, wall]}}}}", "`200 deg` is out of range; it must be between -3.2 and 3.2"),
    "rotation by nothing": (f"surface: {{{MARK}rotation: {{constraints: [table, wall]}}}}", "`angle` is missing here"),
    "negative noise": (f"noise: {{position: {{x: {MARK}-1 um, y: 0, a: 0, b: 0}}}}", "-1e-06 is out of range; it must not be negative"),
    "noise for all of several units": (f"noise: {{position: {MARK}1 mm}}", "the coordinates have different units; give one value for each"),
    "noise without one": (f"noise: {{force: {MARK}{{table: 1 N, wall: 1 N}}}}", "no entry for the constraint `flat`"),
    "seed below zero": (f"noise: {{seed: {MARK}-1}}", "a whole number between 0 and 4294967295 was expected"),
    "seed too large": (f"noise: {{seed: {MARK}4294967296}}", "a whole number between 0 and 4294967295 was expected"),
    "seed that is a word": (f"noise: {{seed: {MARK}true}}", "a whole number between 0 and 4294967295 was expected"),
    "seed with a fraction": (f"noise: {{seed: {MARK}1.5}}", "a whole number between 0 and 4294967295 was expected"),
    "P_d of 17": (f"P_d: {MARK}m*g*y", "`P_d` belongs to controllers 5 and 11, and this is 17"),
    "P_d of 15": (f"{{controller: 15, P_d: {MARK}m*g*y}}", "`P_d` belongs to controllers 5 and 11, and this is 15"),
    "ideal and real": (f"{{{MARK}ideal_force_path: true, force_path: {{sample: 1 ms}}}}", "an ideal force path, and another one; drop either"),
    "delay beside the samples": (f"force_path: {{sample: 2 ms, delay: {MARK}3 ms}}", "1.5 samples; with `sample`, the delay must be a whole number"),
    "controller": (f"controller: {MARK}16", "`16` is not possible here; expected 5, 11, 15 or 17"),
    "controller in words": (f"controller: {MARK}'17'", "the text `17` is not possible here; expected the number"),
    "limits": (f"limits: {MARK}maybe", "`true` or `false` was expected, not `maybe`"),
    "forces that are no list": (f"disturbances: {MARK}5 N", "a list was expected, not `5 N`"),
    "a force that is none": (f"disturbances: [{MARK}5 N]", "a mapping `name: value` was expected, not `5 N`"),
    "duration of zero": (f"duration: {MARK}0 s", "`0 s` is out of range; it must be between 0.001 and 3600"),
    "duration too long": (f"duration: {MARK}2 h", "`2 h` is out of range; it must be between 0.001 and 3600"),
    "duration below zero": (f"duration: {MARK}-1", "`-1` is out of range"),
    "duration without end": (f"duration: {MARK}.inf", "`.inf` is no finite number"),
    "empty title": (f"title: {MARK}''", "a text was expected"),
    "title": (f"title: {MARK}[a]", "a text was expected"),
    "tag": (f"title: {MARK}!!python/object/apply:os.system [id]", "a scenario file is plain data, without tags"),
    "anchor": (f"title: {MARK}&a text", "anchors and aliases are not read here"),
    "a key twice": (f"{{limits: true, {MARK}limits: false}}", "`limits` stands here twice"),
}  # fmt: skip


def in_a_file(text):
    body = text if text.startswith("{") else "{" + text + "}"
    return f"schema: firmtouch.scenario/1\nscenarios:\n  first: {{}}\n  second: {body}\n"


@pytest.mark.parametrize(("text", "words"), SINGLE.values(), ids=list(SINGLE))
def test_a_mistake_is_told_at_its_place(text, words, told):
    text, places = marked(in_a_file(text))
    lines = told(text)
    assert [each.split(": ")[0] for each in lines] == places
    assert words in lines[0]
    # The words of pydantic, which are for programmers.
    assert not any(each in lines[0] for each in ("Input should", "Field required", "Value error", "valid "))


# Whole files.
FILES = {
    "wrong schema": (f"schema: {MARK}firmtouch.model/1\nscenarios: {{a: {{}}}}", "`firmtouch.model/1` is not possible here; expected `firmtouch.scenario/1`"),
    "no scenarios": (f"scenarios: {MARK}{{}}", "no entries where at least 1 is needed"),
    "no key": (f"{MARK}schema: firmtouch.scenario/1\n", "`scenarios` is missing here"),
    "empty": (f"{MARK}", "the file is empty; scenarios stand under `scenarios:`"),
    "comments alone": (f"{MARK}# nothing\n", "the file is empty; scenarios stand under"),
    "a list": (f"{MARK}- a\n- b\n", "a scenario file is a mapping of `schema:` and `scenarios:`"),
    "a list of scenarios": (f"scenarios:\n  {MARK}- a\n", "a mapping `name: value` was expected, not a list"),
    "nothing as scenarios": (f"{MARK}scenarios:\n", "a mapping `name: value` was expected, not nothing"),
    "nothing as a scenario": (f"scenarios:\n  {MARK}a:\n", "a mapping `name: value` was expected, not nothing"),
    "a name that is none": (f"scenarios:\n  {MARK}../../etc/passwd: {{}}\n", "`../../etc/passwd` is no name"),
    "a name with a space": (f"scenarios:\n  {MARK}two words: {{}}\n", "`two words` is no name"),
    "a name twice": (f"scenarios:\n  a: {{}}\n  {MARK}a: {{}}\n", "`a` stands here twice"),
    "two documents": (f"scenarios: {{a: {{}}}}\n{MARK}---\nscenarios: {{b: {{}}}}\n", "a second document; a scenario file holds one"),
    "an alias": (f"scenarios:\n  a: {MARK}&x {{}}\n  b: *x\n", "anchors and aliases are not read here"),
    "merging": (f"scenarios:\n  a: {{}}\n  b: {{{MARK}<<: {{limits: true}}}}\n", "unknown key `<<`"),
    "no YAML": (f"scenarios: {{a: [\n{MARK}", "no valid YAML: while parsing a flow node"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "words"), FILES.values(), ids=list(FILES))
def test_a_file_that_is_none_is_told_so(text, words, told):
    text, places = marked(text)
    lines = told(text)
    assert [each.split(": ")[0] for each in lines] == places
    assert words in lines[0]


def test_too_many_scenarios_are_counted(told):
    many = "".join(f"  s{i}: {{}}\n" for i in range(51))
    lines = told(f"scenarios:\n{many}")
    assert len(lines) == 1
    assert "51 entries where at most 50 are read" in lines[0]


def test_too_many_forces_are_counted(told):
    forces = ", ".join(["{force: {x: 1 N}}"] * 21)
    lines = told(f"scenarios: {{a: {{disturbances: [{forces}]}}}}")
    assert len(lines) == 1
    assert "21 entries where at most 20 are read" in lines[0]


def test_all_mistakes_are_told_at_once_in_the_order_of_the_file(told):
    text = f"""\
schema: {MARK}firmtouch.scenario/2
scenarios:
  a:
    duration: {MARK}5 kg
    start: {{beside_q_d: {{x: 1 mm, {MARK}q: 1}}}}
    surface: {{offset: {{table: {MARK}1 N, wall: {MARK}1 s}}}}
  b: {{controller: {MARK}12, noise: {{force: {MARK}-1 N}}}}
"""
    text, places = marked(text)
    assert [each.split(": ")[0] for each in told(text)] == places


def test_a_file_that_cannot_be_read_is_no_scenario_file(tmp_path, model):
    with pytest.raises(InputError, match="cannot be read"):
        read_scenarios(tmp_path / "missing.yaml", model)
    with pytest.raises(InputError, match="cannot be read"):
        read_scenarios(tmp_path, model)


class TestTheModelsDrivesAndWalls:
    """`effort` and `one_sided`, which simulations alone use."""

    def test_a_drive_has_a_force_or_a_torque(self, model):
        efforts = {name: each.effort and each.effort.value for name, each in model.spec.coordinates.items()}
        assert efforts == {"x": 30, "y": None, "a": 5, "b": None}

    def test_contacts_hold_both_ways_unless_the_file_says_otherwise(self, model):
        assert {name: each.one_sided for name, each in model.spec.constraints.items()} == {
            "table": True, "wall": False, "flat": False,
        }  # fmt: skip

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            ("effort: 30 N}", f"effort: {MARK}30 N*m}}", "`30 N*m` is in J, but N was expected"),
            ("effort: 5 N*m", f"effort: {MARK}5 N", "`5 N` is in N, but J was expected"),
            ("effort: 30 N}", f"effort: {MARK}0 N}}", "a drive without any force; it must be positive"),
            ("effort: 30 N}", f"effort: {MARK}-30 N}}", "a drive without any force; it must be positive"),
            ("effort: 30 N}", f"effort: {MARK}.inf}}", "`.inf` is no finite number"),
            ("effort: 30 N}", f"effort: {MARK}true}}", "a quantity was expected"),
            ("effort: 30 N}", f"{MARK}efort: 30 N}}", "did you mean `effort`?"),
            ("one_sided: true", f"one_sided: {MARK}1", "`true` or `false` was expected, not `1`"),
            ("one_sided: true", f"one_sided: {MARK}yes", "`true` or `false` was expected, not `yes`"),
        ],
    )
    def test_mistakes_are_told_at_their_places(self, old, new, words):
        assert old in MODEL
        text, (place,) = marked(MODEL.replace(old, new))
        with pytest.raises(ModelFileError) as caught:
            parse_model(text.encode(), name="plate", file="plate.yaml")
        (line,) = str(caught.value).splitlines()
        assert line.startswith(f"plate.yaml:{place}: ")
        assert words in line
        assert "Input should" not in line


class TestDamagedFiles:
    """Untrusted input: always scenarios or a list of mistakes, never another error."""

    COUNT = 120
    PIECES = (
        "1 mm", "-1 mm", "1e999", ".nan", "-.inf", "0", "-1", "1", "2", "1e15", "9" * 400, "yes", "~", "null", "true", "[]", "{}", "''", "[[[[1]]]]",
        "!!python/object/apply:os.system [id]", "&a 1", "*a", "<<", "x", "y", "table", "9**9**9 m", "exp(exp(exp(100)))", "(" * 60,
        "5 Hz", "5 rad/s", "1 parsec", "1:30", "2001-01-01", "\t", "\x00", "é", "'\\x00'", "---", "...", "17", "5", "x**y", "0/0",
    )  # fmt: skip

    def damaged(self, rng):
        """Change scalars, cut lines, exchange parts of lines, or flip bytes."""
        lines = GOOD.splitlines()
        for _ in range(rng.choice((1, 1, 1, 2, 3))):
            i = rng.randrange(len(lines))
            match rng.choice(("scalar", "scalar", "scalar", "delete", "repeat", "indent", "bytes", "splice")):
                case "scalar" if ": " in lines[i]:
                    parts = lines[i].split(": ")
                    j = rng.randrange(1, len(parts))
                    tail = parts[j][parts[j].find(",") :] if "," in parts[j] else "}" * parts[j].count("}")
                    parts[j] = rng.choice(self.PIECES) + tail
                    lines[i] = ": ".join(parts)
                case "delete" if len(lines) > 1:
                    del lines[i]
                case "repeat":
                    lines.insert(i, lines[i])
                case "indent":
                    lines[i] = rng.choice(("  ", " ", "\t")) + lines[i]
                case "splice":
                    at = rng.randrange(len(lines[i]) + 1)
                    lines[i] = lines[i][:at] + rng.choice(self.PIECES) + lines[i][at + rng.choice((0, 1, 4)) :]
                case "bytes":
                    at = rng.randrange(len(lines[i]) + 1)
                    lines[i] = lines[i][:at] + chr(rng.randrange(0x250)) + lines[i][at + 1 :]
        return "\n".join(lines).encode()

    def test_every_one_is_read_or_told_what_is_wrong_with_it(self, model):
        found = Counter()
        for seed in range(self.COUNT):
            content = self.damaged(random.Random(seed))
            try:
                scenarios = parse_scenarios(content, model, file="runs.yaml").scenarios
            except ModelFileError as error:
                found["refused"] += 1
                for line in str(error).splitlines():
                    assert line.startswith("runs.yaml:"), seed
                    assert line.isprintable(), seed
                    assert not any(words in line for words in ("Input should", "Field required", "Value error")), (
                        seed,
                        line,
                    )
            else:
                found["read"] += 1
                assert scenarios, seed
        # Damage that makes only rubbish, or none, tests little.
        assert min(found["read"], found["refused"]) > self.COUNT // 20

    @pytest.mark.parametrize("content", [b"\xff\xfe", b"\x00" * 100, b"a" * 3_000_000, b"[" * 2_000, b"{a: " * 1000], ids=["utf16", "zeros", "long", "brackets", "braces"])  # fmt: skip
    def test_rubbish_is_refused(self, content, model):
        with pytest.raises(ModelFileError):
            parse_scenarios(content, model, file="runs.yaml")


@pytest.mark.parametrize("path", sorted((ROOT / "models").glob("*.yaml")), ids=lambda path: path.stem)
def test_the_names_and_units_are_those_of_the_model(path):
    """One scenario written by program for every shipped model, from its own names, is read without a word."""
    model = read_model(path)
    spec = model.spec
    units = {name: "mm" if each.unit == "m" else "deg" for name, each in spec.coordinates.items()}
    forces = {name: "N" if each.unit == "m" else "N*m" for name, each in spec.coordinates.items()}
    run = {
        "start": {"beside_q_d": {name: f"1 {unit}" for name, unit in units.items()}},
        "disturbances": [{"force": {name: f"1 {unit}" for name, unit in forces.items()}}],
        "surface": {"offset": {name: f"1 {'mm' if each.unit == 'm' else 'mrad'}" for name, each in spec.constraints.items()}},
    }  # fmt: skip
    if spec.parameters:
        run["parameters"] = {name: each.value.value for name, each in spec.parameters.items()}
    content = json.dumps({"scenarios": {"run": run}}).encode()
    found = parse_scenarios(content, model, file="runs.yaml").scenarios["run"]
    assert set(found.start.beside_q_d) == set(spec.coordinates)
    assert found.disturbances[0].force == dict.fromkeys(spec.coordinates, 1)
    assert YAML(typ="safe", pure=True).load(content) == {"scenarios": {"run": run}}
