"""`firmtouch schema` prints what editors read."""

import json
from pathlib import Path

import jsonschema
import pytest
from ruamel.yaml import YAML

from firmtouch.cli import main
from firmtouch.modelfile.json_schema import model_schema, scenario_schema


def test_the_schema_goes_to_stdout_and_nothing_else(capsys):
    assert main(["schema"]) == 0
    told = capsys.readouterr()
    assert told.err == ""
    printed = json.loads(told.out)
    assert printed == model_schema()
    assert printed["title"] == "firmtouch model file"
    jsonschema.Draft202012Validator.check_schema(printed)


def test_scenario_files_have_a_schema_of_their_own(capsys):
    assert main(["schema", "--scenario"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == scenario_schema()
    assert printed["title"] == "firmtouch scenario file"
    validator = jsonschema.Draft202012Validator(printed)
    validator.check_schema(printed)
    page = (Path(__file__).parents[2] / "docs" / "simulation.md").read_text(encoding="utf-8")
    example = page.split("```yaml\n")[1].split("```")[0]
    data = YAML(typ="safe", pure=True).load(example)
    validator.validate(data)
    next(iter(data["scenarios"].values()))["controler"] = 17
    assert [each.validator for each in validator.iter_errors(data)] == ["additionalProperties"]


@pytest.mark.parametrize(
    ("option", "title"), [("--sensor", "firmtouch sensor file"), ("--catalogue", "firmtouch catalogue file")]
)
def test_the_files_of_the_fingertip_have_schemas_too(capsys, option, title):
    assert main(["schema", option]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["title"] == title
    jsonschema.Draft202012Validator.check_schema(printed)
