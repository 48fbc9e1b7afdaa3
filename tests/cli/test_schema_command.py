"""`firmtouch schema` prints JSON that editors take as a schema."""

import json

import jsonschema

from firmtouch.cli import main


def test_it_prints_a_valid_schema_and_nothing_else(capsys):
    assert main(["schema"]) == 0
    output = capsys.readouterr()
    schema = json.loads(output.out)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert {"title", "coordinates", "mechanism", "constraints", "operating_point", "design"} <= set(schema["required"])
    assert output.err == ""
