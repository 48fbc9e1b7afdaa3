"""A YAML file -> a checked specification: units, safe expressions, errors at `file:line:column`. Knows no mechanics."""

from firmtouch.modelfile.fields import Expression
from firmtouch.modelfile.read import ModelFile, parse_model, read_model
from firmtouch.modelfile.specification import ModelSpec

__all__ = ["Expression", "ModelFile", "ModelSpec", "parse_model", "read_model"]
