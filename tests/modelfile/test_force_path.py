"""`force_path` and `force_feedback: auto`: what a good one becomes, in SI, and how each mistake in one is told."""

import math

import jsonschema
import pytest
from ruamel.yaml import YAML

from firmtouch.errors import ModelFileError
from firmtouch.modelfile import parse_model
from firmtouch.modelfile.json_schema import model_schema

BASE = """\
title: An arm
parameters: {l: 0.5 m, m: 2 kg}
coordinates: {q1: rad, q2: rad, q3: rad}
definitions:
  tip: l*[cos(q1) + cos(q1 + q2), sin(q1) + sin(q1 + q2)]
mechanism:
  kinetic_energy: 0.5*m*l**2*(dot(q1)**2 + dot(q2)**2 + dot(q3)**2)
  potential_energy: m*9.81*y(tip)
constraints:
  wall: {expression: 0.6 m - x(tip), unit: m}
operating_point:
  guess: {q1: 70 deg, q2: -75 deg, q3: 0}
  lambda_d: {wall: 40 N}
design:
  poles: [-4, -5, -6, -7]
  force_feedback: 0.8
force_path:
  # here
"""
BASE = (
    BASE.replace("0.6 m - x", "0.6 - x")
    .replace("m*9.81*y(tip)", "m*g*y(tip)")
    .replace("m: 2 kg", "m: 2 kg, g: 9.81 m/s^2")
)
TWO = (
    BASE.replace("  wall: {expr", "  turn: {expression: q1 - q2, unit: rad}\n  wall: {expr")
    .replace("{wall: 40 N}", "{turn: 1 N*m, wall: 40 N}")
    .replace("[-4, -5, -6, -7]", "[-4, -5]")
)
MARK = "»"
VALIDATOR = jsonschema.Draft202012Validator(model_schema())


def with_lines(*lines, base=BASE):
    return base.replace("  # here\n", "".join(f"  {line}\n" for line in lines))


def read(*lines, base=BASE):
    """Read a file, which the JSON Schema must accept too."""
    text = with_lines(*lines, base=base)
    VALIDATOR.validate(YAML(typ="safe", pure=True).load(text))
    return parse_model(text.encode(), name="arm").spec


def told_alone(text, words):
    """Check that one mistake is told, at the mark and in these words."""
    at = text.index(MARK)
    place = f"{text.count(chr(10), 0, at) + 1}:{at - text.rfind(chr(10), 0, at)}"
    with pytest.raises(ModelFileError) as caught:
        parse_model(text.replace(MARK, "").encode(), name="arm", file="arm.yaml")
    (line,) = (each.removeprefix("arm.yaml:") for each in str(caught.value).splitlines())
    assert line.startswith(f"{place}: "), f"{line} where {place} was expected"
    assert words in line


VALUES = {
    "hertz are cycles": ("bandwidth: 80 Hz", "bandwidth", 2 * math.pi * 80),
    "kilohertz too": ("bandwidth: 1.5 kHz", "bandwidth", 2 * math.pi * 1500),
    "a word": ("bandwidth: 80 hertz", "bandwidth", 2 * math.pi * 80),
    "radians": ("bandwidth: 500 rad/s", "bandwidth", 500),
    "delay": ("delay: 1500 us", "delay", 1.5e-3),
    "a bare delay is in s": ("delay: 0.002", "delay", 2e-3),
    "sample": ("sample: 1 ms", "sample", 1e-3),
}


@pytest.mark.parametrize(("line", "name", "expected"), VALUES.values(), ids=list(VALUES))
def test_quantities_become_seconds_and_radians_by_second(line, name, expected):
    path = read(line).force_path
    assert getattr(path, name) == pytest.approx(expected, rel=1e-15)
    others = {"bandwidth", "delay", "sample", "margins", "contact_stiffness"} - {name}
    assert all(getattr(path, each) is None for each in others)


def test_a_file_needs_no_force_path():
    assert parse_model(BASE.replace("force_path:\n  # here\n", "").encode(), name="arm").spec.force_path is None


def test_all_of_it_at_once():
    path = read(
        "bandwidth: 80 Hz", "sample: 0.1 ms", "delay: 0.3 ms", "margins: {gain: 2, delay: 0.5 ms, modulus: 50 %}",
        "contact_stiffness: 1e5 N/m",
    ).force_path  # fmt: skip
    assert path.delay / path.sample == pytest.approx(3, rel=1e-15)  # though 0.3/0.1 is no whole number in binary
    assert (path.margins.gain, path.margins.delay, path.margins.modulus) == (2, 0.5e-3, 0.5)
    assert path.contact_stiffness == {"wall": 1e5}


def test_each_constraint_may_have_its_own_stiffness_in_its_unit():
    path = read("delay: 1 ms", "contact_stiffness: {wall: 100 N/mm, turn: 300 N*m/rad}", base=TWO).force_path
    assert path.contact_stiffness == {"turn": 300, "wall": 1e5}


MISTAKES = {
    "nothing": (f"{MARK}{{margins: {{gain: 2}}}}", "at least one of `bandwidth`, `delay` and `sample` is needed"),
    "cycles or radians": (f"bandwidth: {MARK}80 1/s", "write `80 Hz` (cycles) or `500 rad/s`"),
    "a bare bandwidth": (f"bandwidth: {MARK}80", "write `80 Hz` (cycles) or `500 rad/s`"),
    "no frequency": (f"bandwidth: {MARK}80 rad", "a plain number, but 1/s was expected"),
    "no frequency in hertz": (f"bandwidth: {MARK}80 m*Hz", "but 1/s was expected"),
    "slow": (f"bandwidth: {MARK}0.001 Hz", "it must lie between 0.1 and 1e+07 rad/s"),
    "negative": (f"bandwidth: {MARK}-80 Hz", "is out of range"),
    "no delay": (f"delay: {MARK}0 s", "between 1e-07 and 1"),
    "a delay in metres": (f"delay: {MARK}1 mm", "in m, but s was expected"),
    "a long delay": (f"delay: {MARK}2 s", "between 1e-07 and 1"),
    "no whole sample": (f"{{sample: 1 ms, delay: {MARK}1.5 ms}}", "1.5 samples; with `sample`, the delay must be a whole"),
    "less than a sample": (f"{{sample: 1 ms, delay: {MARK}1 us}}", "0.001 samples"),
    "many samples": (f"{{sample: 1 ms, delay: {MARK}101 ms}}", "101 samples; at most 100 are read"),
    "no margins": (f"{{sample: 1 ms, margins: {MARK}{{}}}}", "at least one of `gain`, `delay` and `modulus` is needed"),
    "gain margin": (f"{{sample: 1 ms, margins: {{gain: {MARK}0.5}}}}", "must be between 1 and 1e+06"),
    "modulus margin": (f"{{sample: 1 ms, margins: {{modulus: {MARK}1}}}}", "it must lie between 0 and 1, both excluded"),
    "delay margin": (f"{{sample: 1 ms, margins: {{delay: {MARK}2}}}}", "must be between 1e-07 and 1"),
    "unknown margin": (f"{{sample: 1 ms, margins: {{{MARK}phase: 60 deg}}}}", "unknown key `phase`; there are: gain, delay, modulus"),
    "unknown key": (f"{{{MARK}bandwith: 80 Hz, delay: 1 ms}}", "unknown key `bandwith`"),
    "stiffness": (f"{{sample: 1 ms, contact_stiffness: {MARK}3 N}}", "in N, but N/m was expected"),
    "no stiffness": (f"{{sample: 1 ms, contact_stiffness: {MARK}0 N/m}}", "it must be positive"),
}  # fmt: skip


@pytest.mark.parametrize(("line", "words"), MISTAKES.values(), ids=list(MISTAKES))
def test_each_mistake_is_told_at_its_place(line, words):
    in_line = line.removeprefix(MARK).startswith("{")
    told_alone(BASE.replace("\n  # here", f" {line}") if in_line else with_lines(line), words)


def test_stiffnesses_of_different_units_are_not_one_quantity():
    told_alone(with_lines("delay: 1 ms", f"contact_stiffness: {MARK}1e5 N/m", base=TWO), "have different units")


AUTO = BASE.replace("force_feedback: 0.8", "force_feedback: auto")
CHOSEN = {
    "usual margins": "sample: 1 ms",
    "a low-pass and a delay margin": "{bandwidth: 80 Hz, margins: {delay: 1 ms}}",
    "a delay and a gain margin": "{delay: 1 ms, margins: {gain: 2}}",
}


@pytest.mark.parametrize("line", CHOSEN.values(), ids=list(CHOSEN))
def test_auto_is_read(line):
    text = (
        AUTO.replace("force_path:\n  # here", f"force_path: {line}")
        if line.startswith("{")
        else with_lines(line, base=AUTO)
    )
    VALIDATOR.validate(YAML(typ="safe", pure=True).load(text))
    assert parse_model(text.encode(), name="arm").spec.design.force_feedback == "auto"


NO_CHOICE = {
    "no path": ("", "`auto` needs `force_path`"),
    "a low-pass alone": ("force_path: {bandwidth: 80 Hz}", "a low-pass alone bounds no G_f"),
    "a low-pass and no delay margin": ("force_path: {bandwidth: 80 Hz, margins: {gain: 2}}", "a low-pass alone bounds no G_f"),
    "a delay margin alone": ("force_path: {delay: 1 ms, margins: {delay: 1 ms}}", "ask for a `gain` or `modulus` margin too"),
}  # fmt: skip


@pytest.mark.parametrize(("path", "words"), NO_CHOICE.values(), ids=list(NO_CHOICE))
def test_auto_without_a_largest_gain_is_refused_at_its_place(path, words):
    text = AUTO.replace("force_path:\n  # here", path).replace("force_feedback: auto", f"force_feedback: {MARK}auto")
    told_alone(text, words)


def test_another_word_is_still_no_gain():
    told_alone(with_lines("delay: 1 ms").replace("0.8", f"{MARK}automatic"), "a plain number was expected")


def test_auto_within_a_list_is_no_gain():
    told_alone(with_lines("delay: 1 ms").replace("0.8", f"[{MARK}auto]"), "a plain number was expected")
