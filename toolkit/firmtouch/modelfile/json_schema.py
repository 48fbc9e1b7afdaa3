"""The JSON Schema of model files, for editors."""

from __future__ import annotations

from typing import Any

from firmtouch.modelfile.specification import ModelSpec


def model_schema() -> dict[str, Any]:
    """Give the JSON Schema (draft 2020-12) of a model file."""
    schema = _closed(ModelSpec.model_json_schema(by_alias=True))
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "firmtouch model file"}


def _closed(part: Any) -> Any:  # noqa: ANN401  # any JSON
    """Refuse names that do not fit their pattern; pydantic would leave them unchecked."""
    if isinstance(part, list):
        return [_closed(each) for each in part]
    if not isinstance(part, dict):
        return part
    closed = {key: _closed(each) for key, each in part.items()}
    return closed | {"additionalProperties": False} if "patternProperties" in closed else closed
