"""What a good file becomes: values in SI, expressions as trees, all frozen."""

import math

import pytest
from pydantic import ValidationError
from ruamel.yaml import YAML

from firmtouch.errors import ModelFileError
from firmtouch.modelfile import Expression, parse_model
from firmtouch.modelfile.sections.mechanism import Bodies, Energies
from firmtouch.modelfile.template import model_template


def read(change=lambda data: None):
    """Read the template with something changed."""
    data = YAML(typ="safe", pure=True).load(model_template("arm"))
    change(data)
    import json

    return parse_model(json.dumps(data).encode(), name="arm").spec


def put(*path, value):
    def change(data):
        for key in path[:-1]:
            data = data[key]
        data[path[-1]] = value

    return change


def test_quantities_are_converted_to_si():
    spec = read(put("parameters", "l1", value="500 mm"))
    assert spec.parameters["l1"].value.value == pytest.approx(0.5, rel=1e-15)
    assert spec.operating_point.guess == pytest.approx({"q1": math.radians(70), "q2": math.radians(-75)}, rel=1e-15)
    assert spec.bounds.offset == {"wall": pytest.approx(0.002)}


def test_an_interval_is_converted_and_holds_its_value():
    m2 = read().parameters["m2"]
    assert [end.value for end in m2.interval] == [3.5, 5]
    with pytest.raises(ModelFileError, match="does not hold the value"):
        read(put("parameters", "m2", value={"value": "6 kg", "interval": ["3 kg", "5 kg"]}))


@pytest.mark.parametrize(
    ("written", "groups"),
    [
        ([-6, -8], ((-6,), (-8,))),
        (["-6+3j", "-6-3j"], ((-6 + 3j,), (-6 - 3j,))),
        (["-6 + 3i", "-6 - 3i"], ((-6 + 3j,), (-6 - 3j,))),
        ([["-4", -5.5]], ((-4, -5.5),)),
        (["-1e1", "-7."], ((-10,), (-7,))),
    ],
)
def test_poles_are_read_in_all_their_forms(written, groups):
    assert read(put("design", "poles", value=written)).design.poles == groups


@pytest.mark.parametrize("written", [0.8, [0.8], [[0.8]]])
def test_force_feedback_is_a_matrix_however_it_is_written(written):
    assert read(put("design", "force_feedback", value=written)).design.force_feedback == ((0.8,),)


def test_bounds_are_one_for_all_or_one_for_each():
    assert read(put("bounds", "disturbance", value="3 N*m")).bounds.disturbance == {"q1": 3, "q2": 3}
    each = read(put("bounds", "disturbance", value={"q1": "1 N*m", "q2": 0.5})).bounds
    assert each.disturbance == {"q1": 1, "q2": 0.5}


def test_a_mechanism_is_bodies_or_energies():
    assert isinstance(read().mechanism, Bodies)
    energies = {"kinetic_energy": "0.5*I1*(dot(q1)**2 + dot(q2)**2)", "potential_energy": "m1*g*l1*sin(q1)"}
    assert isinstance(read(put("mechanism", value=energies)).mechanism, Energies)
    mixed = {**energies, "gravity": [0, -9.81]}
    with pytest.raises(ModelFileError, match="gravity"):
        read(put("mechanism", value=mixed))


def test_bodies_in_space_have_rotations_and_three_moments():
    def change(data):
        data["mechanism"] = {
            "gravity": [0, 0, "-g"],
            "bodies": {
                "arm": {
                    "mass": "m1",
                    "inertia": ["I1", "I1", 0.01],
                    "centre_of_mass": ["l1*cos(q1)", "l1*sin(q1)", 0],
                    "orientation": [{"z": "q1"}, {"y": "q2"}],
                }
            },
        }
        del data["drawing"]

    body = read(change).mechanism.bodies["arm"]
    assert [axis for axis, _ in body.orientation] == ["z", "y"]
    assert all(isinstance(each, Expression) for row in body.inertia for each in row)
    assert body.inertia[0][1].text == "0"


def test_definitions_use_what_stands_above_them():
    with pytest.raises(ModelFileError, match="`elbow` cannot be used here"):
        read(put("definitions", value={"tip": "elbow", "elbow": ["l1*cos(q1)", "l1*sin(q1)"]}))


def test_a_specification_never_changes():
    spec = read()
    with pytest.raises(ValidationError, match="frozen"):
        spec.title = "another"
    with pytest.raises(AttributeError):
        spec.constraints["wall"].expression.text = "0"


def test_a_file_is_known_by_the_hash_of_its_bytes():
    import hashlib

    content = model_template("arm").encode()
    assert parse_model(content, name="arm").sha256 == hashlib.sha256(content).hexdigest()
