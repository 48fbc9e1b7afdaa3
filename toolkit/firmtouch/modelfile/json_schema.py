"""The JSON Schemas of model files and of scenario files, for editors."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from firmtouch.modelfile.sections.scenario import ScenarioFileSpec
from firmtouch.modelfile.specification import ModelSpec


def model_schema() -> dict[str, Any]:
    """Give the JSON Schema (draft 2020-12) of a model file."""
    schema = schema_of(ModelSpec, "firmtouch model file")
    schema["required"].remove("coordinates")  # a robot's joints are the coordinates
    return schema


def scenario_schema() -> dict[str, Any]:
    """Give that of a scenario file, for whatever model."""
    return schema_of(ScenarioFileSpec, "firmtouch scenario file")


def schema_of(root: type[BaseModel], title: str) -> dict[str, Any]:
    """Give the JSON Schema of a file whose root this is."""
    schema = _closed(root.model_json_schema(by_alias=True))
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": title}


def _closed(part: Any) -> Any:  # noqa: ANN401  # any JSON
    """Refuse names that do not fit their pattern; pydantic would leave them unchecked."""
    if isinstance(part, list):
        return [_closed(each) for each in part]
    if not isinstance(part, dict):
        return part
    closed = {key: _closed(each) for key, each in part.items()}
    return closed | {"additionalProperties": False} if "patternProperties" in closed else closed
