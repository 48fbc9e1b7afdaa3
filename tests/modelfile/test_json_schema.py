"""The JSON Schema accepts what the reader accepts, and refuses the mistakes of structure that editors should mark."""

from pathlib import Path

import jsonschema
import pytest
from ruamel.yaml import YAML

from firmtouch.modelfile import parse_model
from firmtouch.modelfile.json_schema import model_schema
from firmtouch.modelfile.template import model_template

MODELS = sorted((Path(__file__).parents[2] / "models").glob("*.yaml"))
VALIDATOR = jsonschema.Draft202012Validator(model_schema())


def load(text):
    return YAML(typ="safe", pure=True).load(text)


def test_it_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(VALIDATOR.schema)


@pytest.mark.parametrize("path", MODELS, ids=lambda path: path.stem)
def test_the_shipped_models_are_accepted(path):
    VALIDATOR.validate(load(path.read_text(encoding="utf-8")))


def test_the_template_is_accepted_by_both():
    text = model_template("polisher")
    parse_model(text.encode(), name="polisher")
    VALIDATOR.validate(load(text))


def test_short_and_long_forms_are_accepted():
    data = load(model_template("polisher"))
    data["parameters"]["m1"] = {"value": "6 kg"}
    data["parameters"]["m2"] = 4
    data["coordinates"] = {"q1": "rad", "q2": {"unit": "rad"}}
    data["design"]["normal_blocks"] = {"policy": "blend", "weight": 0.5}
    data["design"]["poles"] = [["-4", -5.5]]
    data["design"]["force_feedback"] = [[0.5]]
    data["bounds"]["disturbance"] = {"q1": "1 N*m", "q2": 2}
    VALIDATOR.validate(data)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("titel",), "x"),
        (("title",), ""),
        (("coordinates",), {}),
        (("coordinates", "q1"), {"units": "rad"}),
        (("parameters", "l1"), {"label": "no value"}),
        (("mechanism", "bodies", "forearm", "mas"), 3),
        (("mechanism", "bodies", "forearm", "mass"), None),
        (("constraints", "wall"), "x(tip)"),
        (("design", "method"), "magic"),
        (("design", "poles"), []),
        (("design", "normal_blocks"), "decople"),
        (("schema",), "firmtouch.model/2"),
    ],
)
def test_mistakes_of_structure_are_refused(path, value):
    data = load(model_template("polisher"))
    here = data
    for key in path[:-1]:
        here = here[key]
    here[path[-1]] = value
    assert not VALIDATOR.is_valid(data)
