"""A YAML file -> a checked specification: units, safe expressions, errors at `file:line:column`. Knows no mechanics."""

from firmtouch.modelfile.fields import Expression
from firmtouch.modelfile.read import ModelFile, parse_model, read_model
from firmtouch.modelfile.scenarios import ScenarioFile, parse_scenarios, read_scenarios
from firmtouch.modelfile.specification import ModelSpec

__all__ = [
    "Expression",
    "ModelFile",
    "ModelSpec",
    "ScenarioFile",
    "parse_model",
    "parse_scenarios",
    "read_model",
    "read_scenarios",
]
