"""Robots in model files: what is read of them, and how each mistake is told at its place, the URDF's own included."""

import copy
import json
import random
from pathlib import Path

import jsonschema
import pytest
from ruamel.yaml import YAML

from firmtouch.errors import ModelFileError
from firmtouch.modelfile import read_model
from firmtouch.modelfile.json_schema import model_schema
from firmtouch.modelfile.sections.robot import LONGEST_NAME

MODELS = Path(__file__).parents[2] / "models"
ROBOTS = [path for path in sorted(MODELS.glob("*.yaml")) if "urdf:" in path.read_text(encoding="utf-8")]
VALIDATOR = jsonschema.Draft202012Validator(model_schema())
MARK = "»"
PYDANTIC = (
    "Input should", "Field required", "Value error", "validation error", "List should", "Tuple should", "type=", "pydantic",
)  # fmt: skip

SURFACE = "surface: {plane: {point: [0, 0, L], normal: [0, 0, 1]}}"
BASE = f"""\
schema: firmtouch.model/1
title: An arm
parameters: {{m: 1 kg, L: 0.1 m}}
mechanism:
  urdf: urdf/ur5e.urdf
  tool: flange
  payload: {{mass: m}}
constraints:
  table: {{{SURFACE}}}
operating_point:
  reach: {{point: [0.4 m, 0.2 m, L]}}
  normal_force: 40 N
design:
  poles: [-6, -6.5, -7, -7.5, -8, -8.5, -9, -9.5, -10, -10.5]
  force_feedback: 0.8
"""
ARM = "  urdf: urdf/ur5e.urdf\n  tool: flange\n  payload: {mass: m}\n"
REACH = "reach: {point: [0.4 m, 0.2 m, L]}"
NO_ROBOT = f"""\
schema: firmtouch.model/1
title: No robot
parameters: {{I: 1 kg*m^2, L: 0.1 m, k: 1 J}}
coordinates: {{q1: rad, q2: rad}}
mechanism: {{kinetic_energy: I*(dot(q1)**2 + dot(q2)**2)/2, potential_energy: k*cos(q1)}}
constraints:
  table: {{{SURFACE}}}
operating_point:
  guess: {{q1: 0, q2: 0}}
  lambda_d: {{table: 1}}
design: {{poles: [-6, -7], force_feedback: 0.8}}
"""


@pytest.fixture
def place(tmp_path):
    """Write a model file beside the shipped robots."""
    (tmp_path / "urdf").symlink_to(MODELS / "urdf")

    def write(text):
        path = tmp_path / "arm.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


def changed(*replacements):
    text = BASE
    for old, new in replacements:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def marked(text):
    """Take the marks out of a text, and give the places where they stood."""
    places = []
    while (at := text.find(MARK)) >= 0:
        places.append(f"{text.count(chr(10), 0, at) + 1}:{at - (text.rfind(chr(10), 0, at) + 1) + 1}")
        text = text[:at] + text[at + 1 :]
    return text, places


def told(path):
    """Give what is told about a file, with paths from its folder."""
    with pytest.raises(ModelFileError) as caught:
        read_model(path)
    text = str(caught.value)
    assert not any(words in text for words in PYDANTIC), text
    return text.replace(f"{path.parent}/", "").splitlines()


def test_the_base_of_these_tests_has_no_mistake(place):
    spec = read_model(place(BASE)).spec
    assert list(spec.coordinates) == ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
    assert spec.entries["table"].point.frame == "flange"
    elbow = spec.coordinates["elbow"]
    assert (elbow.unit, elbow.lower, elbow.upper) == ("rad", pytest.approx(-3.14159, abs=1e-5), -elbow.lower)
    assert elbow.effort.value > 0
    assert elbow.velocity.value > 0


TOOL, PAYLOAD, TABLE, FORCE = "tool: flange", "payload: {mass: m}", f"table: {{{SURFACE}}}", "normal_force: 40 N"
MISTAKES = {
    # The file.
    "no file": (("urdf: urdf/ur5e.urdf", "urdf: »urdf/ur5.urdf"), "there is no file `urdf/ur5.urdf`"),
    "a folder": (("urdf: urdf/ur5e.urdf", "urdf: »urdf"), "`urdf` is no file"),
    "a device": (("urdf: urdf/ur5e.urdf", "urdf: »/dev/zero"), "`/dev/zero` is no file"),
    "a device by a way round": (("urdf: urdf/ur5e.urdf", "urdf: »/dev/../dev/zero"), "`/dev/../dev/zero` is no file"),
    "NUL in a path": (("urdf: urdf/ur5e.urdf", r'urdf: »"a\0b"'), "there is no file `a\N{REPLACEMENT CHARACTER}b`"),
    "half a character": (("urdf: urdf/ur5e.urdf", r'urdf: »"\ud800"'), "there is no file `\N{REPLACEMENT CHARACTER}`"),
    "a very long name": (("urdf: urdf/ur5e.urdf", f"urdf: »{'x' * 5000}"), "…` cannot be read (File name too long)"),
    "a number as file": (("urdf: urdf/ur5e.urdf", "urdf: »5"), "the path of a URDF file was expected"),
    "nothing as file": (("urdf: urdf/ur5e.urdf", "»urdf:"), "the path of a URDF file was expected"),
    "a list as file": (("urdf: urdf/ur5e.urdf", "urdf: »[a]"), "the path of a URDF file was expected"),
    # The tool.
    "unknown tool": ((TOOL, "tool: »flang"), "the tool `flang` is no link; did you mean `flange`?"),
    "second tool": ((TOOL, "tool: [flange, »flang]"), "the tool `flang` is no link; did you mean `flange`?"),
    "a tool that stands still": ((TOOL, "tool: »base"), "the tool `base` does not move"),
    "a number as tool": ((TOOL, "tool: »5"), "the name of a link was expected"),
    "no tools": ((TOOL, "tool: »[]"), "the name of a link was expected, or a list of them"),
    "nothing in a list of tools": ((TOOL, "tool: [flange, »~]"), "the name of a link was expected"),
    "unknown key": ((TOOL, "»tol: flange"), "unknown key `tol`; there are: urdf, tool, locked, base, gravity, payload, rotors; did you mean `tool`?"),
    "a robot and bodies": ((TOOL, f"{TOOL}\n  »bodies: {{}}"), "`bodies` does not go with `urdf`; there are: urdf, tool"),
    "a robot and a chain": ((TOOL, f"{TOOL}\n  »planar_chain: {{n: 2}}"), "`planar_chain` does not go with `urdf`"),
    # What is locked, and what motors add.
    "rotor of no joint": ((TOOL, f"{TOOL}\n  rotors: {{»elbo: 1 kg*m^2}}"), "`elbo` is no joint that moves by itself; did you mean `elbow`?"),
    "rotor in kg": ((TOOL, f"{TOOL}\n  rotors: {{elbow: »1 kg}}"), "`1 kg` is in kg, but kg*m^2 was expected"),
    "negative rotor": ((TOOL, f"{TOOL}\n  rotors: {{elbow: »-1 kg*m^2}}"), "an inertia must not be negative"),
    "one rotor for all": ((TOOL, f"{TOOL}\n  rotors: »1 kg*m^2"), "an inertia for each joint was expected"),
    "unknown joint": ((TOOL, f"{TOOL}\n  locked: {{elbo: »1}}"), "there is no joint `elbo` that could be locked; did you mean `elbow`?"),
    "locked out of bounds": ((TOOL, f"{TOOL}\n  locked: {{elbow: »20}}"), "joint `elbow` is locked at 20, outside of its bounds -3.14159 to 3.14159"),
    "an angle in metres": ((TOOL, f"{TOOL}\n  locked: {{elbow: »1 m}}"), "`1 m` is in m, but a plain number or an angle was expected"),
    "locked without position": ((TOOL, f"{TOOL}\n  locked: {{elbow: »[1]}}"), "a quantity was expected"),
    "a list of locked joints": ((TOOL, f"{TOOL}\n  locked: »[elbow]"), "a position for each locked joint was expected"),
    "a fixed joint": ((TOOL, f"{TOOL}\n  locked: {{flange_mount: »0}}"), "there is no joint `flange_mount` that could be locked; there are: shoulder_pan"),
    "all locked": ((TOOL, f"tool: »flange\n  locked: {{{', '.join(f'{each}: 0' for each in ('shoulder_pan', 'shoulder_lift', 'elbow', 'wrist_1', 'wrist_2', 'wrist_3'))}}}"), "does not move: no joint between it and the ground is free"),
    # Where it stands.
    "base with a parameter": ((TOOL, f"{TOOL}\n  base: »{{position: [0, 0, L]}}"), "the robot's place is made of numbers alone, without parameters"),
    "base of two entries": ((TOOL, f"{TOOL}\n  base: {{position: »[0, 0]}}"), "2 entries where a list of three was expected"),
    "base in kilograms": ((TOOL, f"{TOOL}\n  base: {{position: [0, »1 kg, 0]}}"), "`1 kg` is in kg, but m was expected"),
    "turned in metres": ((TOOL, f"{TOOL}\n  base: {{orientation: [{{z: »1 m}}]}}"), "`1 m` is in m"),
    "turned about w": ((TOOL, f"{TOOL}\n  base: {{orientation: [»{{w: 1}}]}}"), "a rotation is written `{z: 30 deg}`"),
    "a number as base": ((TOOL, f"{TOOL}\n  base: »5"), "a mapping `name: value` was expected, not `5`"),
    "gravity in the plane": ((TOOL, f"{TOOL}\n  gravity: »[0, -9.81]"), "three accelerations were expected"),
    "gravity in metres": ((TOOL, f"{TOOL}\n  gravity: [0, 0, »-9.81 m]"), "`-9.81 m` is in m, but m/s^2 was expected"),
    # What it carries.
    "payload on nothing": ((PAYLOAD, "payload: {mass: m, frame: »flang}"), "the robot carries no link `flang`; did you mean `flange`?"),
    "payload on the ground": ((PAYLOAD, "payload: {mass: m, frame: »base}"), "the payload is fixed to `base`, which does not move"),
    "payload on two frames": ((PAYLOAD, "payload: {mass: m, frame: »[flange, wrist_3]}"), "the name of a link was expected"),
    "payload without frame": (("tool: flange\n  payload: {", "tool: [flange, wrist_3]\n  payload: »{"), "which link carries it? Give its `frame`"),
    "payload without mass": ((PAYLOAD, "»payload: {}"), "`mass` is missing here"),
    "negative mass": ((PAYLOAD, "payload: {mass: »-1 kg}"), "`-1 kg` is out of range; it must be at least 0"),
    "mass of a joint": ((PAYLOAD, "payload: {mass: »elbow}"), "`elbow` is not declared"),
    "mass in metres": ((PAYLOAD, "payload: {mass: »L}"), "this is in m, but kg was expected"),
    "one moment": ((PAYLOAD, "payload: {mass: m, inertia: »1}"), "no list where a list of three was expected"),
    "moments of no body": ((PAYLOAD, "payload: {mass: m, inertia: »[1, 1, 3]}"), "no body has these moments: 3 exceeds the sum of the others"),
    # A chain.
    **{f"a chain of {n}": ((ARM, f"  planar_chain: {{n: »{n}, length: 1 m, mass: 1 kg}}\n"), "a whole number from 1 to 100 was expected") for n in (0, 1.5, 1000, -1, "true", '"2"', "[2]")},
    "a chain without length": ((ARM, "  planar_chain: {n: 6, length: »0 m, mass: 1 kg}\n"), "`0 m` is out of range"),
    "a chain in kilograms": ((ARM, "  planar_chain: {n: 6, length: »1 kg, mass: 1 kg}\n"), "`1 kg` is in kg, but m was expected"),
    # Names.
    "coordinates too": (("mechanism:", "»coordinates: {q1: rad}\nmechanism:"), "the robot's joints are the coordinates; leave this out"),
    "a parameter named as a joint": (("{m: 1 kg", "{»elbow: 1, m: 1 kg"), "`elbow` is declared twice, as a parameter and as a coordinate"),
    "a definition named as a joint": (("mechanism:", "definitions: {»elbow: 2*wrist_1}\nmechanism:"), "`elbow` is declared twice"),
    # Contacts.
    "aligned with w": ((TABLE, f"table: {{{SURFACE}, align: »w}}"), "`w` is not possible here; expected `x`, `y` or `z`"),
    "which tool touches": (("tool: flange\n  payload: {mass: m}\nconstraints:\n  table: {", "tool: [flange, wrist_3]\nconstraints:\n  table: »{"), "which frame touches? Give its `point`, or the mechanism one `tool`"),
    "unknown point": ((TABLE, f"table: {{{SURFACE}, point: »flang}}"), "the robot has no frame `flang` that it carries or stands on; did you mean `flange`?"),
    "a number as point": ((TABLE, f"table: {{{SURFACE}, point: »5}}"), "the name of a frame was expected: a link of the robot"),
    "a number as frame": ((TABLE, f"table: {{{SURFACE}, point: {{frame: »5}}}}"), "the name of a frame was expected: a link of the robot"),
    "a row that is not there": ((TABLE, f"table: {{{SURFACE}, without: [»about_x]}}"), "`about_x` is no row that could be left out; it is one row, which cannot be left out"),
    "rows as text": ((TABLE, f"table: {{{SURFACE}, without: »about_x}}"), "a list of rows was expected"),
    "not one-sided": ((TABLE, f"table: {{{SURFACE}, one_sided: »1}}"), "`true` or `false` was expected, not `1`"),
    "a key of another form": ((TABLE, f"table: {{{SURFACE}, »hold: point}}"), "`hold` does not go with `surface`; there are: label, without, surface, point, align, one_sided"),
    "a surface as text": ((TABLE, "table: {surface: »plane}"), "a mapping `name: value` was expected, not `plane`"),
    # The operating point.
    "unknown contact": (("{point: [0.4 m", "{contact: »tabel, point: [0.4 m"), "`tabel` is no contact with a surface; did you mean `table`?"),
    "unknown frame": (("{point: [0.4 m", "{frame: »flang, point: [0.4 m"), "the robot has no frame `flang`"),
    "along w": (("{point: [0.4 m", "{axis: »w, point: [0.4 m"), "`w` is not possible here"),
    "a direction of no length": (("{point: [0.4 m", "{direction: »[0, 0, 0], point: [0.4 m"), "a direction of length zero"),
    "across nothing": (("{point: [0.4 m", "{frame: forearm, »across: [1, 0, 0], point: [0.4 m"), "`across` needs a `direction`"),
    "near in metres": (("{point: [0.4 m", "{near: {shoulder_pan: 0, shoulder_lift: 0, elbow: »1 m, wrist_1: 0, wrist_2: 0, wrist_3: 0}, point: [0.4 m"), "`1 m` is in m"),
    "near some": (("{point: [0.4 m", "{near: »{elbow: 0}, point: [0.4 m"), "no entry for the coordinate `shoulder_pan`"),
    "a point in kilograms": (("{point: [0.4 m", "{point: [»0.4 kg"), "`0.4 kg` is in kg, but m was expected"),
    "reach and guess": ((REACH, f"»{REACH}\n  guess: {{shoulder_pan: 0, shoulder_lift: 0, elbow: 0, wrist_1: 0, wrist_2: 0, wrist_3: 0}}"), "give either `q_d` or `guess` or `reach`, not both"),
    "a force in metres": ((FORCE, "normal_force: »40 m"), "`40 m` is in m, but N was expected"),
    "unknown row": ((FORCE, "lambda_d: {table: 1 N, »tabl: 1 N}"), "`tabl` is no constraint; there are: table; did you mean `table`?"),
}  # fmt: skip


@pytest.mark.parametrize("name", MISTAKES)
def test_each_mistake_is_told_once_at_its_place(name, place):
    change, words = MISTAKES[name]
    text, (where,) = marked(changed(change))
    (line,) = told(place(text))
    assert line.startswith(f"arm.yaml:{where}: "), line
    assert words in line


LINE = "rail: {line: {point: [0, 0, 0], direction: [0, 0, 1]}}, frame: flange"
CIRCLE = "rail: {circle: {centre: [0, 0, 0], axis: [0, 0, 1], radius: 1 m}}, frame: flange"
ENTRIES = {
    f"{LINE}, hold: frame".replace("line: {", "line: »{"): "`hold: frame` needs `up`, a direction square to the line",
    LINE.replace("[0, 0, 1]", "»[0, 0, 0]"): "a direction of length zero",
    LINE.replace("1]}", "1], up: »[0, 0, -2]}"): "`up` points along the line itself",
    "rail: »{}, frame: flange": "a rail is one `line` or one `circle`",
    "rail: »5, frame: flange": "a mapping `name: value` was expected, not `5`",
    CIRCLE.replace("1 m", "»-1 m"): "`-1 m` is out of range; it must be positive",
    CIRCLE.replace("1 m", "»1 kg"): "`1 kg` is in kg, but m was expected",
    f"{CIRCLE}, hold: »all": "`all` is not possible here; expected `point`, `axis` or `frame`",
    f"{CIRCLE}, without: »[beside_1, beside_2]": "no row is left",
    "distance: 1 m, between: »[flange]": "two frames were expected, as in `[left_tool, right_tool]`",
    "distance: 1 m, between: »[flange, base, elbow]": "two frames were expected",
    "distance: 1 m, between: »flange": "two frames were expected",
    "distance: 1 m, between: [flange, »flange]": "both are on the link `flange`, which cannot move against itself",
    "distance: 1 m, between: [flange, »~]": "the name of a frame was expected",
    "distance: »0 m, between: [flange, base]": "`0 m` is out of range; it must be positive",
    "distance: »1 kg, between: [flange, base]": "`1 kg` is in kg, but m was expected",
    "distance: 1 m, between: [flange, base], without: [»x]": "it is one row, which cannot be left out",
    "join: »[flange]": "two frames were expected",
    "join: »[]": "two frames were expected",
    "join: [flange, »{frame: flange, position: [0, 0, 1]}]": "both are on the link `flange`",
    "join: [flange, base], hold: »z": "`z` is not possible here; expected `point`, `axis` or `frame`",
    "join: [flange, base], hold: point, without: [»about_x]": "`about_x` is no row that could be left out; there are: x, y, z",
    "join: [flange, base], without: »[x, y, z, about_x, about_y, about_z]": "no row is left",
    "»joint: [flange, base]": "unknown key `joint`;",
}  # fmt: skip


@pytest.mark.parametrize("entry", ENTRIES)
def test_each_mistake_in_a_constraint_on_frames_is_told_at_its_place(entry, place):
    text, (where,) = marked(changed((TABLE, f"{TABLE}\n  other: {{{entry}}}")))
    lines = told(place(text))
    # What follows from it, such as too many poles, may be told as well.
    assert any(line.startswith(f"arm.yaml:{where}: ") and ENTRIES[entry] in line for line in lines), lines


def test_a_misspelled_sort_of_constraint_is_recognised(place):
    lines = told(place(changed((TABLE, "table: {join_: [flange, base]}"))))
    assert any("did you mean `join`?" in line for line in lines)


def test_a_force_on_one_contact_is_not_one_on_two(place):
    two = (TABLE, f"{TABLE}\n  wall: {{{SURFACE}}}"), (", -10, -10.5]", "]")
    lines = told(place(changed(*two)))
    assert any("which frame shall be there? Give its `frame`, or a `contact`" in line for line in lines)
    named = ("{point: [0.4 m", "{contact: wall, point: [0.4 m")
    text, (where,) = marked(changed(*two, named, (FORCE, f"»{FORCE}")))
    assert told(place(text)) == [
        f"arm.yaml:{where}: `normal_force` is for one contact with a surface; write `lambda_d`"
    ]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (None, "a `surface` is for robots, and this `mechanism` is none; write an `expression`"),
        ((SURFACE, "join: [a, b]"), "a frame belongs to a robot, and this `mechanism` is none; write an `expression`"),
        ((SURFACE, "distance: 1 m, between: [a, b]"), "a frame belongs to a robot"),
        ((SURFACE, LINE), "a frame belongs to a robot"),
        (("guess: {q1: 0, q2: 0}", "reach: {point: [0, 0, 0]}"), "`reach` is for robots, and this `mechanism` is none; write a `guess`"),
    ],
)  # fmt: skip
def test_what_is_for_robots_is_refused_elsewhere(change, words, place):
    text = NO_ROBOT if change is None else NO_ROBOT.replace(*change)
    assert any(words in line for line in told(place(text)))


def test_mistakes_in_the_robots_file_are_told_there(place, tmp_path):
    robot = (MODELS / "urdf" / "ur5e.urdf").read_text()
    (tmp_path / "own.urdf").write_text(
        robot.replace('<joint name="elbow" type="revolute">', '<joint name="elbow" type="turning">')
    )
    line = next(i for i, each in enumerate(robot.splitlines(), 1) if '<joint name="elbow"' in each)
    told_of_it = told(place(changed(("urdf/ur5e.urdf", "own.urdf"))))
    assert told_of_it[0].startswith(f"own.urdf:{line}:")
    assert "unknown type `turning`" in told_of_it[0]


def test_a_file_that_is_no_urdf_is_told_so(place):
    assert told(place(changed(("urdf: urdf/ur5e.urdf", "urdf: arm.yaml")))) == [
        "arm.yaml:1:1: no valid XML: syntax error"
    ]


def test_an_absolute_path_is_read(place):
    absolute = str(MODELS / "urdf" / "ur5e.urdf")
    spec = read_model(place(changed(("urdf: urdf/ur5e.urdf", f"urdf: {absolute}")))).spec
    assert spec.coordinates == read_model(place(BASE)).spec.coordinates


def test_the_digest_covers_the_robots_file(place, tmp_path):
    text = changed(("urdf/ur5e.urdf", "own.urdf"))
    robot = (MODELS / "urdf" / "ur5e.urdf").read_bytes()
    digests = []
    for content in (robot, robot + b"\n"):
        (tmp_path / "own.urdf").write_bytes(content)
        model = read_model(place(text))
        assert dict(model.attached) == {"own.urdf": content}
        digests.append(model.sha256)
    assert digests[0] != digests[1]


def arm_of(names, link="l"):
    """Write the links `link0`, `link1`, ... on joints of these names, one on the other."""
    for i, name in enumerate(names):
        parent = f"{link}{i - 1}" if i else "ground"
        yield (
            f'<link name="{link}{i}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
            f'</inertial></link><joint name="{name}" type="continuous"><origin xyz="0.1 0 0"/><parent link="{parent}"/>'
            f'<child link="{link}{i}"/></joint>'
        )


def robot_of(*pieces):
    return f'<robot name="r"><link name="ground"/>{"".join(pieces)}</robot>'


def chain_of(names):
    """Write a robot whose joints have these names."""
    return robot_of(*arm_of(names))


def test_joint_names_become_names_that_expressions_can_use(place, tmp_path):
    long = "joint_" * 10
    names = ["a-b", "a b", "a_b", "1st", "sin", "pi", "é", "dot", f"{long}1", f"{long}2", f"{long}3", "x", "_q"]
    (tmp_path / "odd.urdf").write_text(chain_of(names), encoding="utf-8")
    text = changed(
        ("urdf/ur5e.urdf", "odd.urdf"),
        (TOOL, "tool: l12"),
        ("[-6, -6.5, -7, -7.5, -8, -8.5, -9, -9.5, -10, -10.5]", f"[{', '.join(f'-{4 + i}' for i in range(22))}]"),
    )
    # An expression that uses them shows that each is a name.
    other = (TABLE, f"{TABLE}\n  odd: {{expression: a_b + a_b_2 + a_b_3 + q_1st + q_sin + q_pi + x, unit: rad}}")
    text = text.replace(other[0], other[1]).replace(FORCE, "lambda_d: {table: 1 N, odd: 1}")
    coordinates = list(read_model(place(text)).spec.coordinates)
    assert len(set(coordinates)) == len(names)
    assert coordinates[:6] == ["a_b_2", "a_b_3", "a_b", "q_1st", "q_sin", "q_pi"]  # `a_b` is one already
    assert coordinates[-2:] == ["x", "q__q"]
    assert all(len(each) <= LONGEST_NAME and each.isidentifier() and each[0].isalpha() for each in coordinates)


def test_more_joints_than_are_read_are_told_where_the_robot_is_named(place, tmp_path):
    (tmp_path / "long.urdf").write_text(chain_of([f"j{i}" for i in range(101)]))
    text, (where,) = marked(
        changed(
            ("urdf/ur5e.urdf\n  tool: flange", "long.urdf\n  tool: l40"), ("mechanism:\n", "mechanism:\n  »")
        ).replace("»  ", "»")
    )
    assert told(place(text)) == [
        f"arm.yaml:{where}: 101 joints move, and at most 100 are read: name the `tool`, or lock some"
    ]


# The JSON Schema for editors.


def load(text):
    return YAML(typ="safe", pure=True).load(text)


FORMS = [
    TABLE,
    f"table: {{{SURFACE}, align: z, point: {{frame: flange, position: [0, 0, 0.1 m], orientation: [{{x: 90 deg}}]}}, without: [about_x]}}",
    f"table: {{{LINE}}}",
    f"table: {{{CIRCLE}, hold: axis}}",
    "table: {distance: 0.4 m, between: [flange, {frame: base}]}",
    "table: {join: [flange, base], hold: frame, without: [about_x], label: shut}",
    "table: {expression: elbow - 1, unit: rad}",
]


@pytest.mark.parametrize("form", FORMS)
def test_the_schema_accepts_each_form(form):
    VALIDATOR.validate(load(changed((TABLE, form))))


@pytest.mark.parametrize(
    "mechanism",
    [
        "  urdf: a.urdf\n",
        "  urdf: a.urdf\n  tool: [a, b]\n  locked: {c: 0.02 m}\n  base: {position: [0, 0, 1 m], orientation: [{z: 1}]}\n  gravity: [0, 0, -1.6]\n",
        "  planar_chain: {n: 3, length: 1 m, mass: 1 kg}\n",
    ],
)
def test_the_schema_accepts_each_robot(mechanism):
    VALIDATOR.validate(load(changed((ARM, mechanism))))


@pytest.mark.parametrize(
    "change",
    [
        ("urdf: urdf/ur5e.urdf", "urdf: 5"),
        (TOOL, "tool: {a: 1}"),
        (TOOL, "tol: flange"),
        (TOOL, f"{TOOL}\n  planar_chain: {{n: 3, length: 1 m, mass: 1 kg}}"),
        (PAYLOAD, "payload: {}"),
        (ARM, "  planar_chain: {n: 1000, length: 1 m, mass: 1 kg}\n"),
        (ARM, "  planar_chain: {n: 1.5, length: 1 m, mass: 1 kg}\n"),
        (TABLE, f"table: {{{SURFACE}, align: w}}"),
        (TABLE, f"table: {{{SURFACE}, hold: point}}"),
        (TABLE, "table: {surface: {plane: {point: [0, 0, 0]}}}"),
        (TABLE, "table: {join: [flange]}"),
        (TABLE, "table: {join: flange}"),
        (TABLE, "table: {distance: 1 m, between: [a, b, c]}"),
        (TABLE, f"table: {{{CIRCLE}, hold: all}}"),
        (REACH, "reach: {}"),
        (REACH, "reach: {point: [0, 0]}"),
        (REACH, "reach: {point: [0, 0, 0], axis: w}"),
        (FORCE, "normal_force: [1]"),
    ],
)
def test_the_schema_refuses_nonsense(change):
    assert not VALIDATOR.is_valid(load(changed(change)))


# Any damage.

RUBBISH = (
    None, True, 0, -1, 1.5, 1e300, "", " ", "x" * 300, "5 m", "1 kg", "flange", "base", "z", [], {}, [None], [0, 0, 0], ["flange", "base"],
    {"frame": "flange"}, {"plane": {}}, {"line": {}}, [{"z": 1}], "L", "elbow", "1/0", "[0, 0, 1]", [[1]], {"": 1}, {"__class__": 1}, "\0", "\ud800",
)  # fmt: skip
RICH = {
    "mechanism": {"urdf": "two.urdf", "tool": ["left3", "right3"], "locked": {"left_joint1": 1, "right_joint1": "1 rad"}, "base": {"position": [0, 0, "1 m"], "orientation": [{"z": "90 deg"}]}, "gravity": [0, 0, -9.81], "payload": {"frame": "left3", "mass": "m", "centre_of_mass": [0, 0, "L"], "inertia": ["1 kg*m^2", 1, 1]}},
    "constraints": {
        "table": {"surface": {"plane": {"point": [0, 0, "L"], "normal": [0, 0, 1]}}, "point": "left3", "align": "z", "without": ["about_x"]},
        "bar": {"distance": "0.4 m", "between": ["left3", {"frame": "right3", "position": [0, 0, "1 cm"]}]},
        "track": {"rail": {"line": {"point": [0, 0, 0], "direction": [0, 0, 1], "up": [0, 1, 0]}}, "frame": "left2", "hold": "point"},
        "round": {"rail": {"circle": {"centre": [0, 0, 0], "axis": [0, 0, 1], "radius": "1 m"}}, "frame": "right2", "without": ["beside_1"]},
        "grip": {"join": ["left3", "right3"], "hold": "point"},
    },
    "operating_point": {"reach": {"contact": "table", "point": [0, 0, "L"], "axis": "z", "direction": [0, 0, 1], "across": [1, 0, 0]}, "lambda_d": {"table": "1 N", "bar": 1}},
}  # fmt: skip


def spots(data, path=()):
    """List all places of a tree of data."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from spots(value, (*path, key))


def damage(data, rng):
    """Replace, take out, rename or repeat one to three places of a tree."""
    data = copy.deepcopy(data)
    for _ in range(rng.choice((1, 1, 2, 3))):
        places = [each for each in spots(data) if each[0] not in ("schema", "title", "design")]
        if not places:
            break
        *path, key = rng.choice(places)
        here = data
        for each in path:
            here = here[each]
        match rng.randrange(4):
            case 0:
                del here[key]
            case 1 if isinstance(here, dict):
                here[rng.choice([*here, "tool", "hold", "x", "elbow", "a b", ""])] = here.pop(key)
            case 2:
                here[key] = [copy.deepcopy(here[key])] * rng.choice((1, 2, 3))
            case _:
                here[key] = rng.choice(RUBBISH)
    return data


TWO_ARMS = robot_of(
    *(piece for side in ("left", "right") for piece in arm_of([f"{side}_joint{i}" for i in range(6)], side))
)
CHUNK = 25


@pytest.mark.parametrize(
    "start", [0, CHUNK, *(pytest.param(i, marks=pytest.mark.slow) for i in range(2 * CHUNK, 80 * CHUNK, CHUNK))]
)
def test_any_damage_is_read_or_told(start, place, tmp_path):
    (tmp_path / "two.urdf").write_text(TWO_ARMS)
    rich = load(BASE) | RICH | {"design": {"poles": [-5] * 2, "force_feedback": 0.1}}
    for seed in range(start, start + CHUNK):
        path = place(json.dumps(damage(rich if seed % 4 else load(BASE), random.Random(seed))))
        try:
            read_model(path)
        except ModelFileError as error:
            text = str(error)
            assert all(line.startswith(f"{tmp_path}/") for line in text.splitlines()), (seed, text)
            assert text.replace("\n", "").isprintable(), (seed, text)
            assert not any(words in text for words in PYDANTIC), (seed, text)
            assert all(each.line >= 1 and each.column >= 1 for each in error.diagnostics), (seed, text)


def test_what_is_damaged_there_is_whole_before(place, tmp_path):
    (tmp_path / "two.urdf").write_text(TWO_ARMS)
    whole = load(BASE) | RICH | {"design": {"poles": [-5] * 2, "force_feedback": 0.1}}
    spec = read_model(place(json.dumps(whole))).spec
    assert (spec.n, spec.m) == (10, 9)
