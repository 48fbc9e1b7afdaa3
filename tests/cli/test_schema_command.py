"""`firmtouch schema` prints what editors read."""

import json

import jsonschema

from firmtouch.cli import main
from firmtouch.modelfile.json_schema import model_schema


def test_the_schema_goes_to_stdout_and_nothing_else(capsys):
    assert main(["schema"]) == 0
    told = capsys.readouterr()
    assert told.err == ""
    printed = json.loads(told.out)
    assert printed == model_schema()
    assert printed["title"] == "firmtouch model file"
    jsonschema.Draft202012Validator.check_schema(printed)
