"""design.json read again: the same loop to the last bit, and nothing that was tampered with goes unnoticed."""

import copy
import json
import math
import random
from pathlib import Path

import numpy as np
import pytest

import firmtouch
from firmtouch.cli import main
from firmtouch.errors import InputError, ModelFileError
from firmtouch.report.saved import LONGEST, read_design

ROOT = Path(__file__).parents[2]
FAST = ("pendulum_rod", "planar_2r_circle", "planar_3r_wall", "two_arms_bar")


class Saved:
    """What `design.json` holds of a model, from its gains alone; the rest of the file is not read."""

    def __init__(self, content: bytes, name: str) -> None:
        self.model = firmtouch.parse_model(content, name=name)
        op = firmtouch.find_operating_point(firmtouch.derive_plant(self.model.spec))
        self.loop = firmtouch.assign_poles(op, self.model.spec.design)
        self.data = {
            "schema": "firmtouch.design/1",
            "model": {"name": name, "source": self.model.document.text},
            "operating_point": {"q_d": op.q_d.tolist(), "lambda_d": op.lambda_d.tolist()},
            "gains": {each: getattr(self.loop.gains, each).tolist() for each in ("W", "C", "G_f", "bias")},
        }


@pytest.fixture(scope="session")
def saved():
    cache: dict[str, Saved] = {}

    def get(name) -> Saved:
        if name not in cache:
            cache[name] = Saved((ROOT / "models" / f"{name}.yaml").read_bytes(), name)
        return cache[name]

    return get


@pytest.fixture
def write(tmp_path):
    def write(data) -> Path:
        path = tmp_path / "design.json"
        path.write_text(data if isinstance(data, str) else json.dumps(data), encoding="utf-8")
        return path

    return write


def same_loop(first, second):
    for name in ("W", "C", "G_f", "bias"):
        assert np.array_equal(getattr(first.gains, name), getattr(second.gains, name)), name
    assert np.array_equal(first.K, second.K)
    assert first.poles == second.poles
    for level in ("full", "tangent"):
        one, two = getattr(first, level), getattr(second, level)
        assert one.holds == two.holds
        assert all(np.array_equal(getattr(one, name), getattr(two, name)) for name in ("K", "C", "W"))
    for name in ("q_d", "lambda_d", "f_d", "M", "J", "g", "P_qq", "N0", "constraint_hessians"):
        assert np.array_equal(getattr(first.operating_point, name), getattr(second.operating_point, name)), name


@pytest.mark.parametrize("name", FAST)
def test_the_loop_is_the_same_to_the_last_bit(name, saved, write):
    model, loop = read_design(write(saved(name).data))
    same_loop(loop, saved(name).loop)
    assert model.name == name
    assert model.spec == saved(name).model.spec


def test_a_whole_design_as_it_is_written_is_read(shipped_report, tmp_path):
    report = shipped_report("pendulum_rod")
    path = tmp_path / "design.json"
    path.write_text(json.dumps(report.json))
    model, loop = read_design(path)
    same_loop(loop, report.design.loop)
    assert model.sha256 == report.design.model.sha256


ROBOT = """\
schema: firmtouch.model/1
title: A robot
mechanism: {urdf: parts/arm.urdf, tool: tip}
constraints:
  wall: {surface: {plane: {point: [0.5 m, 0, 0], normal: [-1, 0, 0]}}}
operating_point:
  guess: {j1: 60 deg, j2: -70 deg}
  normal_force: 5 N
design: {poles: [-4, -5], force_feedback: 0.5}
"""
LINK = '<link name="{}"><inertial><origin xyz="0.2 0 0"/><mass value="1"/><inertia ixx="0.001" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>'
JOINT = '<joint name="{}" type="continuous"><origin xyz="{} 0 0"/><parent link="{}"/><child link="{}"/><axis xyz="0 0 1"/></joint>'
URDF = f"""<robot name="{{}}"><link name="ground"/>{LINK.format("upper")}{LINK.format("fore")}<link name="tip"/>
{JOINT.format("j1", 0, "ground", "upper")}{JOINT.format("j2", 0.4, "upper", "fore")}
<joint name="end" type="fixed"><origin xyz="0.4 0 0"/><parent link="fore"/><child link="tip"/></joint></robot>"""


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
def test_a_robot_is_read_back_without_its_file_at_hand(encoding, write, tmp_path):
    (tmp_path / "parts").mkdir()
    text = '<?xml version="1.0" encoding="utf-8"?>' + URDF.format("\N{LATIN SMALL LETTER E WITH ACUTE}")
    (tmp_path / "parts" / "arm.urdf").write_bytes(text.encode(encoding))
    (tmp_path / "arm.yaml").write_text(ROBOT)
    model = firmtouch.read_model(tmp_path / "arm.yaml")
    op = firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))
    loop = firmtouch.assign_poles(op, model.spec.design)
    (tmp_path / "parts" / "arm.urdf").unlink()
    files = {name: content.decode("utf-8", "surrogateescape") for name, content in model.attached.items()}
    data = {
        "schema": "firmtouch.design/1",
        "model": {"name": "arm", "source": ROBOT, "files": files},
        "operating_point": {"q_d": op.q_d.tolist(), "lambda_d": op.lambda_d.tolist()},
        "gains": {each: getattr(loop.gains, each).tolist() for each in ("W", "C", "G_f", "bias")},
    }
    assert list(data["model"]["files"]) == ["parts/arm.urdf"]
    again, same = read_design(write(data))
    same_loop(same, loop)
    assert again.sha256 == model.sha256
    assert again.spec.coordinates == model.spec.coordinates
    del data["model"]["files"]
    with pytest.raises(ModelFileError, match=r"`parts/arm\.urdf` was not kept"):
        read_design(write(data))


@pytest.mark.parametrize(
    "dress", [lambda text: b"\xef\xbb\xbf" + text, lambda text: text.replace(b"\n", b"\r\n")], ids=["BOM", "CRLF"]
)
def test_a_model_file_of_windows_is_kept(dress, write):
    content = dress((ROOT / "models" / "pendulum_rod.yaml").read_bytes())
    made = Saved(content, "windows")
    model, loop = read_design(write(made.data))
    same_loop(loop, made.loop)
    assert model.spec == made.model.spec


def test_it_follows_the_numbers_of_the_file_and_not_the_models_design(saved, write):
    data = copy.deepcopy(saved("pendulum_rod").data)
    data["gains"]["W"][0][0] += 5.0
    _, loop = read_design(write(data))
    assert loop.gains.W[0, 0] == saved("pendulum_rod").loop.gains.W[0, 0] + 5.0
    assert loop.poles != saved("pendulum_rod").loop.poles


def without(*path):
    def change(data):
        for key in path[:-1]:
            data = data[key]
        del data[path[-1]]

    return change


def put(*path, value):
    def change(data):
        for key in path[:-1]:
            data = data[key]
        data[path[-1]] = value

    return change


# What is done to the file, and words of what is said of it.
TAMPERED = {
    "no schema": (without("schema"), "its schema is None, and `firmtouch.design/1` was expected"),
    "another schema": (put("schema", value="firmtouch.certificate/1"), "its schema is 'firmtouch.certificate/1'"),
    "a schema of another sort": (put("schema", value=[1]), "its schema is"),
    "no model": (without("model"), "`model`"),
    "no source": (without("model", "source"), "`model.source`"),
    "a source that is no text": (put("model", "source", value=3), "`model.source`"),
    "no point": (without("operating_point"), "`operating_point`"),
    "no q_d": (without("operating_point", "q_d"), "`operating_point.q_d`"),
    "no gains": (without("gains"), "`gains`"),
    "no W": (without("gains", "W"), "`gains.W`"),
    "no bias": (without("gains", "bias"), "`gains.bias`"),
    "a short q_d": (put("operating_point", "q_d", value=[0.0]), "`operating_point.q_d` must have the shape (2,)"),
    "a long lambda_d": (put("operating_point", "lambda_d", value=[1.0, 2.0]), "`operating_point.lambda_d` must have the shape (1,)"),
    "no entries": (put("operating_point", "lambda_d", value=[]), "`operating_point.lambda_d` must have the shape (1,)"),
    "ragged": (put("gains", "W", value=[[1.0, 2.0], [3.0]]), "`gains.W` must have the shape (2, 2)"),
    "too many rows": (put("gains", "C", value=[[1.0, 2.0]] * 3), "`gains.C` must have the shape (2, 2)"),
    "no rows": (put("gains", "C", value=[]), "`gains.C` must have the shape (2, 2)"),
    "empty rows": (put("gains", "C", value=[[], []]), "`gains.C` must have the shape (2, 2)"),
    "a number for a matrix": (put("gains", "G_f", value=0.5), "`gains.G_f`"),
    "a row for a matrix": (put("gains", "G_f", value=[0.5]), "`gains.G_f"),
    "deeper": (put("gains", "G_f", value=[[[0.5]]]), "`gains.G_f"),
    "a word": (put("gains", "bias", value=["much", 0]), "`gains.bias"),
    "nothing": (put("gains", "bias", value=[None, 0]), "`gains.bias"),
    "not a number": (put("gains", "bias", value=[math.nan, 0]), "finite"),
    "infinite": (put("gains", "W", value=[[math.inf, 0], [0, 1]]), "finite"),
    "beyond a double": (put("gains", "bias", value=[10**400, 0]), "`gains.bias"),
    "beyond what is a gain": (put("gains", "W", value=[[1e308, 0], [0, 1]]), "`gains.W` has entries beyond 1e+15"),
    "not symmetric": (put("gains", "C", value=[[16.0, 1e-9], [0, 16.0]]), "`gains.C` must be symmetric"),
    "negative force feedback": (put("gains", "G_f", value=[[-1.0]]), "`gains.G_f` must not be negative, and has the eigenvalue -1"),
    "off the surface": (put("operating_point", "q_d", value=[0.0, -0.98]), "q_d misses the constraints by 0.001"),
    "far away": (put("operating_point", "q_d", value=[1e308, 1e308]), "q_d misses the constraints"),
    "where the constraint has no value": (put("operating_point", "q_d", value=[0.0, 0.0]), "q_d misses the constraints"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "words"), TAMPERED.values(), ids=list(TAMPERED))
def test_what_does_not_fit_is_an_input_error(change, words, saved, write):
    data = copy.deepcopy(saved("pendulum_rod").data)
    change(data)
    path = write(data)
    with pytest.raises(InputError) as caught:
        read_design(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    ["", " ", "{", "[]", "null", "3", '"design"', "[" * 100_000, '{"schema": "firmtouch.design/1"', "\x00", '{"schema": "firmtouch.design/1"}'],
)  # fmt: skip
def test_what_is_no_design_is_told_so(text, write):
    with pytest.raises(InputError, match=r"no design\.json"):
        read_design(write(text))


def test_bytes_that_are_no_text_are_no_design(tmp_path):
    path = tmp_path / "design.json"
    path.write_bytes(b"\xff\xfe\xfd{}")
    with pytest.raises(InputError, match=r"no design\.json"):
        read_design(path)


def test_a_file_that_is_too_long_is_not_parsed(tmp_path):
    path = tmp_path / "design.json"
    with path.open("wb") as file:
        file.truncate(LONGEST + 1)  # sparse
    with pytest.raises(InputError, match=r"no design\.json"):
        read_design(path)


def test_mistakes_of_the_model_in_it_are_told_at_their_places(saved, write):
    data = copy.deepcopy(saved("pendulum_rod").data)
    data["model"]["source"] = data["model"]["source"].replace("potential_energy: m*g*y", "potential_energy: m*g*z")
    path = write(data)
    with pytest.raises(ModelFileError) as caught:
        read_design(path)
    (line,) = str(caught.value).splitlines()
    assert line.startswith(f"{path}:model.source:22:25: ")
    assert "`z` is not declared" in line


def test_a_model_of_other_size_does_not_fit(saved, write):
    data = copy.deepcopy(saved("pendulum_rod").data)
    data["model"]["source"] = (ROOT / "models" / "planar_3r_circle.yaml").read_text(encoding="utf-8")
    with pytest.raises(InputError, match=r"`operating_point.q_d` must have the shape \(3,\)"):
        read_design(write(data))


@pytest.mark.parametrize("name", ["no W", "ragged", "not a number", "off the surface", "another schema"])
def test_the_command_says_so_with_exit_code_two_and_writes_nothing(name, saved, write, tmp_path, capsys):
    data = copy.deepcopy(saved("pendulum_rod").data)
    change, words = TAMPERED[name]
    change(data)
    assert main(["simulate", str(write(data)), "--out", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert words in printed.err
    assert len(printed.err.splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_any_damage_is_answered(saved, write):
    """Values exchanged at random: a loop with finite numbers, or an input error; nothing else."""
    values = (
        None,
        True,
        -1,
        0,
        1e308,
        10**30,
        "",
        "x",
        [],
        {},
        [[]],
        [[1.0]],
        math.nan,
        math.inf,
        [0.0, 0.0],
        {"a": 1},
    )
    source = saved("pendulum_rod").data
    read = 0
    for seed in range(120):
        rng = random.Random(seed)
        data = copy.deepcopy(source)
        box, key = data, rng.choice(list(data))
        while isinstance(box[key], dict | list) and box[key] and rng.random() < 0.8:
            box = box[key]
            key = rng.choice(list(box)) if isinstance(box, dict) else rng.randrange(len(box))
        box[key] = rng.choice(values)
        try:
            _, loop = read_design(write(data))
        except InputError:
            continue
        read += 1
        assert np.all(np.isfinite(loop.K)), seed
    assert 0 < read < 60
