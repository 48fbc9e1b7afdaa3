"""`design.region`: what a good one becomes, in SI, and how each mistake in one is told."""

import math
import time

import jsonschema
import pytest
from pydantic import ValidationError
from ruamel.yaml import YAML

from firmtouch.errors import InputError, ModelFileError
from firmtouch.modelfile import parse_model
from firmtouch.modelfile.json_schema import model_schema
from firmtouch.modelfile.sections.region import RegionSpec

BASE = """\
title: An arm
parameters:
  l: 0.5 m
  m: {value: 2 kg, interval: [1 kg, 3 kg]}
  k: 3 N/m
  d: 0.6 m
  deep: {value: 1 m, interval: [1 m, 2 m]}
coordinates: {q1: rad, q2: rad, q3: rad}
definitions:
  elbow: [l*cos(q1), l*sin(q1)]
  tip: elbow + l*[cos(q1 + q2), sin(q1 + q2)]
mechanism:
  kinetic_energy: 0.5*m*l**2*(dot(q1)**2 + dot(q2)**2 + dot(q3)**2)
  potential_energy: k*deep*x(tip)
constraints:
  wall: {expression: d - x(tip), unit: m}
operating_point:
  guess: {q1: 70 deg, q2: -75 deg, q3: 0}
  lambda_d: {wall: 40 N}
design:
  method: region
  force_feedback: 0.8
  region:
    decay: 4 1/s
    # here
bounds:
  disturbance: 2 N*m
  offset: 2 mm
"""
SLIDING = (
    BASE.replace("q3: rad", "q3: m")
    .replace(" + dot(q3)**2)", ") + 0.5*m*dot(q3)**2")
    .replace("disturbance: 2 N*m", "disturbance: {q1: 1 N*m, q2: 1 N*m, q3: 3 N}")
)
TWO_WALLS = BASE.replace("wall: {expr", "floor: {expression: y(tip), unit: m}\n  wall: {expr").replace(
    "{wall: 40 N}", "{floor: 1 N, wall: 40 N}"
)
MIXED_WALLS = TWO_WALLS.replace("y(tip), unit: m}", "q1 - q2, unit: rad}").replace("floor: 1 N,", "floor: 1 N*m,")
MIXED_WALLS = MIXED_WALLS.replace("  offset: 2 mm\n", "  offset: {floor: 1 mrad, wall: 2 mm}\n")
COST = "cost: {position: 1 deg, torque: 5 N*m, start_position: 2 deg, start_velocity: 0.1 rad/s}"
MARK = "»"
VALIDATOR = jsonschema.Draft202012Validator(model_schema())
ALL = {"q1", "q2", "q3"}


def with_lines(*lines, base=BASE):
    return base.replace("    # here\n", "".join(f"    {line}\n" for line in lines))


def read(text):
    """Read a file, which the JSON Schema must accept too."""
    VALIDATOR.validate(YAML(typ="safe", pure=True).load(text))
    return parse_model(text.encode(), name="arm").spec


def region(*lines, base=BASE):
    return read(with_lines(*lines, base=base)).design.region


def value(of, path):
    for each in path.split("."):
        of = of[each] if isinstance(of, dict) else getattr(of, each)
    return of


def told(text):
    with pytest.raises(ModelFileError) as caught:
        parse_model(text.encode(), name="arm", file="arm.yaml")
    return [each.removeprefix("arm.yaml:") for each in str(caught.value).splitlines()]


def told_alone(text, words):
    """Check that one mistake is told, at the mark and in these words."""
    at = text.index(MARK)
    place = f"{text.count(chr(10), 0, at) + 1}:{at - text.rfind(chr(10), 0, at)}"
    (line,) = told(text.replace(MARK, ""))
    assert line.startswith(f"{place}: "), f"{line} where {place} was expected"
    assert words in line


def test_a_region_may_ask_for_little():
    spec = region()
    assert spec.decay == 4
    assert spec.objective == {"gains": 1.0}
    assert spec.torque == {}
    assert (spec.structure.kind, spec.structure.text) == ("full", "full")
    assert spec.structure.pattern == ((True,) * 3,) * 3
    unset = {"damping", "bandwidth", "positivity", "W", "C", "cost", "position_error", "force_error"}
    assert all(getattr(spec, name) is None for name in unset | {"force_feedback_limit", "uncertainty"})


DEGREE = math.radians(1)
EACH = dict.fromkeys(("q1", "q2", "q3"))
VALUES = {
    "damping": ("damping: 0.7", "damping", 0.7),
    "damping in percent": ("damping: 70 %", "damping", 0.7),
    "bandwidth": ("bandwidth: 30 rad/s", "bandwidth", 30),
    "bandwidth in 1/s": ("bandwidth: 30 1/s", "bandwidth", 30),
    "bandwidth in revolutions": ("bandwidth: 60 rpm", "bandwidth", 2 * math.pi),
    "positivity": ("positivity: 20 N*m/rad", "positivity", {"q1": 20, "q2": 20, "q3": 20}),
    "positivity of each": ("positivity: {q1: 1, q2: 2 N*m/rad, q3: 3 kN*mm}", "positivity", {"q1": 1, "q2": 2, "q3": 3}),
    "norm of W": ("W: 300 N*m/rad", "W.norm", 300),
    "norm of W, long": ("W: {norm: 300}", "W.norm", 300),
    "joints of W": ("W: {joints: {q2: 100 N*m/deg}}", "W.joints", {"q2": 100 / DEGREE}),
    "norm of C": ("C: 60 N*m*s/rad", "C.norm", 60),
    "joints of C": ("C: {norm: 9, joints: {q1: 1 N*m*s/rad, q3: 2}}", "C.joints", {"q1": 1, "q3": 2}),
    "torque, position": ("torque: {start: {position: 2 deg, at_most: 20 N*m}}", "torque.start.position", dict.fromkeys(EACH, 2 * DEGREE)),
    "torque, no velocity": ("torque: {start: {position: 2 deg, at_most: 20 N*m}}", "torque.start.velocity", None),
    "torque, velocity": ("torque: {ripple: {velocity: {q1: 1 deg/s, q2: 0, q3: 1}, at_most: 1}}", "torque.ripple.velocity", {"q1": DEGREE, "q2": 0, "q3": 1}),
    "torque, limit": ("torque: {a: {velocity: 1, at_most: {q1: 1, q2: 2 N*m, q3: 3}}}", "torque.a.at_most", {"q1": 1, "q2": 2, "q3": 3}),
    "cost, position": (COST, "cost.position", dict.fromkeys(EACH, DEGREE)),
    "cost, no velocity": (COST, "cost.velocity", None),
    "cost, velocity": (COST.replace("torque", "velocity: 3 deg/s, torque"), "cost.velocity", dict.fromkeys(EACH, 3 * DEGREE)),
    "cost, torque": (COST, "cost.torque", dict.fromkeys(EACH, 5)),
    "cost, start": (COST, "cost.start_position", dict.fromkeys(EACH, 2 * DEGREE)),
    "cost, start velocity": (COST, "cost.start_velocity", dict.fromkeys(EACH, 0.1)),
    "cost, limit": (COST.replace("{", "{at_most: 20 ms, "), "cost.at_most", 0.02),
    "position error": ("position_error: 1 deg", "position_error", DEGREE),
    "force error": ("force_error: {disturbance: 2 N}", "force_error.disturbance", 2),
    "force error by an offset": ("force_error: {offset: 1 kN}", "force_error.offset", 1000),
    "objective": ("objective: margin", "objective", {"margin": 1}),
    "objectives": ("objective: {gains: 1, margin: 0.5}", "objective", {"gains": 1, "margin": 0.5}),
    "limit of the force path": ("force_feedback_limit: 3", "force_feedback_limit", (3,)),
    "limits of the force path": ("force_feedback_limit: [0.8]", "force_feedback_limit", (0.8,)),
    "uncertain parameters": ("uncertainty: {parameters: [m]}", "uncertainty.parameters", ("m",)),
    "no uncertain parameters": ("uncertainty: {parameters: []}", "uncertainty.parameters", ()),
    "all uncertain parameters": ("uncertainty: {}", "uncertainty.parameters", None),
    "box": ("uncertainty: {lambda_d: {box: 5 N}}", "uncertainty.lambda_d.box", {"wall": 5}),
    "box of each": ("uncertainty: {lambda_d: {box: {wall: 0 N}}}", "uncertainty.lambda_d.box", {"wall": 0}),
    "ball": ("uncertainty: {lambda_d: {ball: 5 mN}}", "uncertainty.lambda_d.ball", 0.005),
}  # fmt: skip


@pytest.mark.parametrize("entry", VALUES)
def test_an_entry_becomes_a_value_in_si(entry):
    line, path, expected = VALUES[entry]
    found = value(region(line), path)
    assert type(found) is type(expected) or isinstance(expected, int | float)
    assert found == (expected if expected is None or isinstance(expected, tuple) else pytest.approx(expected))


def test_each_coordinate_and_each_constraint_has_its_own_unit():
    spec = region(
        "positivity: {q1: 1 N*m/rad, q2: 2 N*m/rad, q3: 3 N/mm}",
        "W: {norm: 500, joints: {q3: 4 kN/m}}",
        "C: {norm: 50, joints: {q1: 1 N*m*s/rad, q3: 5 N*s/m}}",
        "position_error: 0.01",
        base=SLIDING,
    )
    assert spec.positivity == pytest.approx({"q1": 1, "q2": 2, "q3": 3000})
    assert (spec.W.norm, spec.W.joints) == (500, {"q3": 4000})
    assert (spec.C.norm, spec.C.joints) == (50, {"q1": 1, "q3": 5})
    assert spec.position_error == 0.01
    mixed = region("force_error: {disturbance: 2}", "uncertainty: {lambda_d: {ball: 3}}", base=MIXED_WALLS)
    assert (mixed.force_error.disturbance, mixed.uncertainty.lambda_d.ball) == (2, 3)


def test_the_limit_of_the_force_path_is_one_for_all_or_one_for_each():
    assert region("force_feedback_limit: 2", base=TWO_WALLS).force_feedback_limit == (2, 2)
    assert region("force_feedback_limit: [2, 1]", base=TWO_WALLS).force_feedback_limit == (2, 1)


X, O = True, False  # noqa: E741  # a pattern to be seen as one
FULL, DIAGONAL, FIRST_TWO, CHAIN = (
    ((X, X, X), (X, X, X), (X, X, X)),
    ((X, O, O), (O, X, O), (O, O, X)),
    ((X, X, O), (X, X, O), (O, O, X)),
    ((X, X, O), (X, X, X), (O, X, X)),
)


@pytest.mark.parametrize(
    ("written", "kind", "text", "pattern"),
    [
        ("full", "full", "full", FULL),
        ("diagonal", "diagonal", "diagonal", DIAGONAL),
        ("{block: [[q1, q2], [q3]]}", "block", "block: [[q1, q2], [q3]]", FIRST_TWO),
        ("{block: [[q3], [q2, q1]]}", "block", "block: [[q3], [q2, q1]]", FIRST_TWO),
        ("{banded: 0}", "banded", "banded: 0", DIAGONAL),
        ("{banded: 1}", "banded", "banded: 1", CHAIN),
        ("{banded: 2}", "banded", "banded: 2", FULL),
        ("{pattern: [[q1, q2]]}", "pattern", "pattern: [[q1, q2]]", FIRST_TWO),
        ("{pattern: [[q2, q1], [q2, q3]]}", "pattern", "pattern: [[q2, q1], [q2, q3]]", CHAIN),
    ],
)
def test_a_structure_is_a_symmetric_pattern(written, kind, text, pattern):
    structure = region(f"structure: {written}").structure
    assert (structure.kind, structure.text, structure.pattern) == (kind, text, pattern)


# A line of the region, with a mark where the mistake is, and words of the message.
SINGLE = {
    "decay of zero": (f"decay: {MARK}0", "0 is out of range; it must be positive"),
    "decay negative": (f"decay: {MARK}-4 1/s", "-4 is out of range; it must be positive (at least 1e-15 in SI)"),
    "decay too fast": (f"decay: {MARK}1e7 1/s", "1e+07 is out of range; it must be at most 1e+06"),
    "decay in seconds": (f"decay: {MARK}4 s", "`4 s` is in s, but 1/s was expected"),
    "damping of one": (f"damping: {MARK}1", "a damping ratio of 1; it must lie between 0 and 1, both excluded"),
    "damping of zero": (f"damping: {MARK}0", "it must be positive"),
    "damping with a unit": (f"damping: {MARK}0.7 N", "`0.7 N` is in N, but a plain number"),
    "bandwidth below the decay": (f"bandwidth: {MARK}3 rad/s", "a bandwidth of 3 1/s leaves no poles with a decay of 4 1/s"),
    "bandwidth as the decay": (f"bandwidth: {MARK}4 rad/s", "it must be greater"),
    "bandwidth in hertz": (f"bandwidth: {MARK}5 Hz", "hertz may count turns or radians; write `30 rad/s`"),
    "positivity of zero": (f"positivity: {MARK}0", "it must be positive"),
    "positivity in newtons": (f"positivity: {MARK}5 N", "`5 N` is in N, but J was expected"),
    "positivity of one": (f"positivity: {MARK}{{q1: 5, q2: 1}}", "no entry for the coordinate `q3`"),
    "positivity of another": (f"positivity: {{q1: 5, q2: 1, q3: 1, {MARK}q4: 1}}", "`q4` is no coordinate; there are: q1, q2, q3"),
    "positivity of one negative": (f"positivity: {{q1: 5, q2: {MARK}-1, q3: 1}}", "-1 is out of range"),
    "norm of W": (f"W: {MARK}5 N*s", "`5 N*s` is in kg m s^-1, but J was expected"),
    "norm of W of zero": (f"W: {{norm: {MARK}0}}", "it must be positive"),
    "W of nothing": (f"W: {MARK}{{}}", "at least one of `norm` and `joints` is needed"),
    "norm of C": (f"C: {MARK}5 N*m/rad", "`5 N*m/rad` is in J, but kg m^2 s^-1 was expected"),
    "joints of C": (f"C: {{joints: {{q1: {MARK}5 N*m}}}}", "is in J, but kg m^2 s^-1 was expected"),
    "joints of W without names": (f"W: {{joints: {MARK}5}}", "an entry for a coordinate was expected, as in `{q1: ...}`"),
    "joints of W, unknown": (f"W: {{joints: {{{MARK}q4: 5}}}}", "`q4` is no coordinate"),
    "joints of W, negative": (f"W: {{joints: {{q1: {MARK}-5}}}}", "it must be positive"),
    "unknown key of W": (f"W: {{{MARK}nrom: 5}}", "unknown key `nrom`; there are: norm, joints; did you mean `norm`?"),
    "torque without errors": (f"torque: {{start: {MARK}{{at_most: 5}}}}", "at least one of `position` and `velocity` is needed"),
    "torque without a limit": (f"torque: {{{MARK}start: {{position: 5}}}}", "`at_most` is missing here"),
    "torque of no name": (f"torque: {{{MARK}2nd: {{position: 5, at_most: 1}}}}", "`2nd` is no name"),
    "torque limit of zero": (f"torque: {{start: {{position: 5, at_most: {MARK}0}}}}", "it must be positive"),
    "torque limit in newtons": (f"torque: {{start: {{position: 5, at_most: {MARK}5 N}}}}", "`5 N` is in N, but J was expected"),
    "torque, negative error": (f"torque: {{start: {{position: {MARK}-5, at_most: 1}}}}", "-5 is out of range; it must not be negative"),
    "torque, velocity as position": (f"torque: {{start: {{velocity: {MARK}5 deg, at_most: 1}}}}", "is a plain number, but 1/s was expected"),
    "cost without torque": (COST.replace("torque: 5 N*m, ", "").replace("cost", f"{MARK}cost"), "`torque` is missing here"),
    "cost of zero": (COST.replace("1 deg", f"{MARK}0 deg"), "it must be positive"),
    "cost so small that its square is zero": (COST.replace("1 deg", f"{MARK}1e-200"), "at least 1e-15 in SI"),
    "cost in newtons": (COST.replace("5 N*m", f"{MARK}5 N"), "`5 N` is in N, but J was expected"),
    "cost, start": (COST.replace("0.1 rad/s", f"{MARK}0"), "it must be positive"),
    "cost, limit": (COST.replace("{", f"{{at_most: {MARK}5 m, "), "`5 m` is in m, but s was expected"),
    "position error": (f"position_error: {MARK}1 mm", "`1 mm` is in m, but a plain number or an angle was expected"),
    "position error of zero": (f"position_error: {MARK}0", "it must be positive"),
    "force error of nothing": (f"force_error: {MARK}{{}}", "at least one of `disturbance` and `offset` is needed"),
    "force error in metres": (f"force_error: {{offset: {MARK}1 mm}}", "`1 mm` is in m, but N was expected"),
    "force path below the gain": (f"force_feedback_limit: {MARK}0.5", "this allows 0.5 for the constraint `wall`, and `force_feedback` asks for 0.8"),
    "force path below the gain, listed": (f"force_feedback_limit: [{MARK}0.5]", "this allows 0.5"),
    "force path of two": (f"force_feedback_limit: {MARK}[1, 2]", "2 force-feedback gains for 1 constraint"),
    "force path with a unit": (f"force_feedback_limit: {MARK}1 N", "force-feedback gains have no unit"),
    "structure of no kind": (f"structure: {MARK}diagonl", "did you mean `diagonal`?"),
    "structure of another kind": (f"structure: {{{MARK}blocks: []}}", "did you mean `block`?"),
    "structure of nothing": (f"structure: {MARK}{{}}", "a structure is `full`, `diagonal`, `{block: [[q1, q2], [q3]]}`"),
    "blocks of an unknown name": (f"structure: {{block: [[q1, {MARK}q4], [q2, q3]]}}", "`q4` is no coordinate; there are: q1, q2, q3"),
    "blocks with a name twice": (f"structure: {{block: [[q1, q2], [{MARK}q1, q3]]}}", "`q1` stands in the blocks twice"),
    "blocks without a name": (f"structure: {{block: {MARK}[[q1], [q2]]}}", "no block holds `q3`"),
    "blocks without brackets": (f"structure: {{block: [[q1, q2], {MARK}q3]}}", "a list of groups of coordinates was expected"),
    "blocks that are none": (f"structure: {{block: {MARK}2}}", "a list of groups of coordinates was expected"),
    "too wide a band": (f"structure: {{banded: {MARK}3}}", "from 0 to n - 1 = 2"),
    "a band of true": (f"structure: {{banded: {MARK}true}}", "from 0 to n - 1 = 2"),
    "an empty pattern": (f"structure: {{pattern: {MARK}[]}}", "an empty pattern; write `diagonal`"),
    "a pattern of three": (f"structure: {{pattern: [{MARK}[q1, q2, q3]]}}", "two different coordinates were expected"),
    "a pattern of the diagonal": (f"structure: {{pattern: [{MARK}[q1, q1]]}}", "two different coordinates were expected"),
    "a pattern with a pair twice": (f"structure: {{pattern: [[q1, q2], {MARK}[q2, q1]]}}", "`q2` and `q1` stand in the pattern twice"),
    "a pattern of an unknown name": (f"structure: {{pattern: [[q1, {MARK}q4]]}}", "`q4` is no coordinate"),
    "a pattern of lists": (f"structure: {{pattern: [[q1, {MARK}[q2]]]}}", "is no coordinate"),
    "objective": (f"objective: {MARK}gain", "`gain` is no objective; there are: gains, margin, cost, force_error; did you mean `gains`?"),
    "objective in a sum": (f"objective: {{{MARK}gain: 1}}", "`gain` is no objective"),
    "objective of nothing": (f"objective: {MARK}{{}}", "an objective was expected, or several with their weights"),
    "weight of zero": (f"objective: {{gains: {MARK}0}}", "it must be positive"),
    "objective without its cost": (f"objective: {MARK}cost", "the objective `cost` needs `cost`"),
    "objective without its cost, in a sum": (f"objective: {{{MARK}cost: 1}}", "the objective `cost` needs `cost`"),
    "uncertain parameter, unknown": (f"uncertainty: {{parameters: [{MARK}q1]}}", "`q1` is no parameter; there are: l, m, k, d, deep"),
    "uncertain parameter twice": (f"uncertainty: {{parameters: [m, {MARK}m]}}", "`m` stands here twice"),
    "uncertain parameter that is none": (f"uncertainty: {{parameters: [{MARK}[m]]}}", "is no parameter"),
    "uncertain parameters without brackets": (f"uncertainty: {{parameters: {MARK}m}}", "a list of parameters was expected"),
    "uncertain parameter without interval": (f"uncertainty: {{parameters: [m, {MARK}k]}}", "the parameter `k` has no `interval`"),
    "box and ball": (f"uncertainty: {{lambda_d: {MARK}{{box: 1 N, ball: 1 N}}}}", "give either `box` or `ball`, not both"),
    "no box and no ball": (f"uncertainty: {{lambda_d: {MARK}{{}}}}", "give either `box` or `ball`"),
    "box in newton metres": (f"uncertainty: {{lambda_d: {{box: {MARK}1 N*m}}}}", "`1 N*m` is in J, but N was expected"),
    "box negative": (f"uncertainty: {{lambda_d: {{box: {{wall: {MARK}-1 N}}}}}}", "it must not be negative"),
    "ball of zero": (f"uncertainty: {{lambda_d: {{ball: {MARK}0}}}}", "it must be positive"),
    "unknown key": (f"{MARK}decays: 5", "unknown key `decays`; there are: decay, damping, bandwidth, positivity, W, C, torque"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", SINGLE)
def test_a_mistake_is_told_alone_at_its_line_and_column(mistake):
    line, words = SINGLE[mistake]
    base = BASE.replace("    decay: 4 1/s\n", "") if line.startswith("decay:") else BASE
    told_alone(with_lines(line, base=base), words)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (f"positivity: {MARK}5", "the coordinates have different units; give one value for each, as in `{q1: ...}`"),
        (f"torque: {{a: {{position: 1, at_most: {MARK}5}}}}", "give one value for each"),
        (f"W: {MARK}5 N/m", "the coordinates have different units, so this norm has none: write a bare number, in SI"),
        (f"C: {{norm: {MARK}5 N*s/m}}", "write a bare number, in SI"),
        (f"W: {{joints: {{q3: {MARK}5 N*m}}}}", "`5 N*m` is in J, but N/m was expected"),
        (f"position_error: {MARK}5 mm", "write a bare number, in SI"),
    ],
)
def test_different_units_have_no_value_in_common(line, words):
    told_alone(
        with_lines(line, base=SLIDING)
        .replace("position: 1,", "position: {q1: 1, q2: 1, q3: 1},"),
        words,
    )  # fmt: skip


@pytest.mark.parametrize(
    "line", [f"force_error: {{offset: {MARK}2 N}}", f"uncertainty: {{lambda_d: {{ball: {MARK}2 N}}}}"]
)
def test_constraints_of_different_units_have_norms_without_one(line):
    told_alone(with_lines(line, base=MIXED_WALLS), "the constraints have different units, so this norm has none")


def test_a_region_must_ask_something_of_the_loop():
    text = BASE.replace("    decay: 4 1/s\n    # here", f"    {MARK}W: 5")
    told_alone(text, "at least one of `decay`, `damping`, `bandwidth` and `cost` is needed")
    assert read(BASE.replace("decay: 4 1/s", COST)).design.region.decay is None


@pytest.mark.parametrize(
    ("line", "bound"),
    [
        (f"{MARK}position_error: 1 deg", "disturbance"),
        (f"force_error: {{{MARK}disturbance: 1 N}}", "disturbance"),
        (f"force_error: {{{MARK}offset: 1 N}}", "offset"),
        (f"objective: {MARK}force_error", "disturbance"),
        (f"objective: {{gains: 1, {MARK}force_error: 1}}", "disturbance"),
    ],
)
def test_a_limit_of_an_error_needs_the_bound_of_its_cause(line, bound):
    without = BASE.partition("bounds:")[0] + "bounds: {tilt: 1 deg}\n"
    words = "the objective `force_error` needs `force_error`, or `bounds: disturbance`"
    told_alone(with_lines(line, base=without), words if "objective" in line else f"this needs `bounds: {bound}`")


def test_several_disagreements_are_told_together():
    without = BASE.partition("bounds:")[0]
    lines = told(with_lines("position_error: 1 deg", "uncertainty: {parameters: [k, l]}", base=without))
    assert [each.split(": ")[0] for each in lines] == ["25:5", "26:32", "26:35"]


@pytest.mark.parametrize(
    "uncertain", ["# none", "uncertainty: {}", "uncertainty: {parameters: [m, l]}", "uncertainty: {parameters: [l]}"]
)
def test_a_parameter_of_a_constraint_must_not_vary(uncertain):
    marked = BASE.replace("l: 0.5 m", f"l: {{value: 0.5 m, interval: {MARK}[0.4 m, 0.6 m]}}")
    others = {"parameters: [m, l]": "[m]", "parameters: [l]": "[]"}.get(uncertain[14:-1], "[m, deep]")
    words = f"`uncertainty: {{parameters: {others}}}`"
    told_alone(with_lines(uncertain, base=marked), words)
    told_alone(
        with_lines(uncertain, base=marked), "`l` is part of a constraint: q_d and the free directions would move"
    )
    # The remedy is one.
    read(with_lines(f"uncertainty: {{parameters: {others}}}", base=marked.replace(MARK, "")))


def test_a_parameter_that_stands_in_the_constraint_itself_must_not_vary():
    marked = BASE.replace("d: 0.6 m", f"d: {{value: 0.6 m, interval: {MARK}[0.4 m, 0.6 m]}}")
    told_alone(marked, "`d` is part of a constraint")


def test_an_uncertainty_of_nothing_is_refused():
    certain = BASE.replace(", interval: [1 kg, 3 kg]", "").replace(", interval: [1 m, 2 m]", "")
    told_alone(with_lines(f"{MARK}uncertainty: {{}}", base=certain), "nothing varies here")
    read(with_lines("uncertainty: {lambda_d: {ball: 1 N}}", base=certain))


def test_a_method_needs_its_own_entry():
    told_alone(
        BASE.replace("  method: region\n", "").replace("design:", f"{MARK}design:"), "`method: poles` needs `poles`"
    )
    lines = BASE.partition("  region:")[0].replace("design:", f"{MARK}design:") + "  poles: [-1, -2, -3, -4]\n"
    told_alone(lines, "`method: region` needs `region`")


def test_a_file_may_hold_both_entries_and_the_caller_chooses():
    both = read(BASE.replace("  method: region\n", "  poles: [-1, -2, -3, -4]\n")).design
    assert both.method == "poles"
    assert both.with_method("region").method == "region"
    assert both.with_method("region").region is both.region
    assert both.with_method("poles") == both
    with pytest.raises(InputError, match="there is no method `magic`; there are: poles, region"):
        both.with_method("magic")


def test_a_method_without_its_entry_cannot_be_chosen():
    only_region = read(BASE).design
    with pytest.raises(InputError, match="the file's `design` has no `poles`, which `--method poles` needs"):
        only_region.with_method("poles")
    poles = read(
        BASE.partition("  region:")[0].replace("  method: region\n", "") + "  poles: [-1, -2, -3, -4]\n"
    ).design
    with pytest.raises(InputError, match="the file's `design` has no `region`, which `--method region` needs"):
        poles.with_method("region")


def test_free_normal_blocks_are_for_region_designs():
    free = BASE.replace("  method: region\n", "  method: region\n  poles: [-1, -2, -3, -4]\n  normal_blocks: free\n")
    design = read(free).design
    assert design.normal_blocks.policy == "free"
    with pytest.raises(InputError, match="`free`, which `--method poles` cannot use"):
        design.with_method("poles")
    text = free.replace("method: region", "method: poles").replace(": free", f": {MARK}free")
    told_alone(text, "`free` leaves these blocks to the search of `method: region`")
    long = free.replace("method: region", "method: poles").replace(": free", f": {{policy: {MARK}free}}")
    told_alone(long, "`free` leaves these blocks")


def test_a_wrong_declaration_causes_no_second_message():
    lines = ("W: 5 N*m", "positivity: 5 N*m", "position_error: 1", "structure: {block: [[q1, q2], [q3]]}", COST)
    assert told(with_lines(*lines).replace("q3: rad", "q3: radd")) == ["8:37: `radd` is no unit; did you mean `rad`?"]
    (line,) = told(with_lines(*lines).replace("unit: m}", "unit: meh}"))
    assert "`meh` is no unit" in line


def test_thousands_of_coordinates_are_answered_soon():
    many = ", ".join(f"p{i}: rad" for i in range(1500))
    start = time.process_time()
    lines = told(with_lines("W: 5", "structure: {banded: 1}", COST).replace("q3: rad", f"q3: rad, {many}"))
    assert time.process_time() - start < 4.0  # one second
    assert any("1503 entries where at most 100 are read" in line for line in lines)


def test_a_region_never_changes_and_describes_all_its_keys():
    with pytest.raises(ValidationError, match="frozen"):
        region().decay = 3
    schemas = VALIDATOR.schema["$defs"]
    sections = ("RegionSpec", "TorqueLimit", "CostSpec", "ForceErrorSpec", "LambdaUncertainty", "UncertaintySpec")
    for name in sections:
        assert schemas[name]["description"]
        assert all("description" in each for each in schemas[name]["properties"].values())
    assert set(schemas["RegionSpec"]["properties"]) == set(RegionSpec.model_fields)


@pytest.mark.parametrize(
    "line",
    [
        "structure: {blocks: [[q1]]}",
        "structure: {pattern: []}",
        "objective: gain",
        "objective: {gain: 1}",
        "decays: 1",
        "W: {norms: 1}",
    ],
)
def test_editors_mark_mistakes_of_structure(line):
    assert not VALIDATOR.is_valid(YAML(typ="safe", pure=True).load(with_lines(line)))
