"""The JSON Schema of model files, for editors."""

from __future__ import annotations

from typing import Any

from firmtouch.modelfile.specification import ModelSpec


def model_schema() -> dict[str, Any]:
    """Give the JSON Schema (draft 2020-12) of a model file."""
    schema = ModelSpec.model_json_schema(by_alias=True)
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "firmtouch model file"}
