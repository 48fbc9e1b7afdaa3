"""What all sections have in common."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema

from firmtouch.modelfile.fields import Expression


class Section(BaseModel):
    """Any part of a model file: unknown keys are refused, and values never change."""

    model_config = ConfigDict(frozen=True, extra="forbid", arbitrary_types_allowed=True)


class ShortSection(Section):
    """A section that may be written as one entry alone: that of its field `short_for`."""

    short_for: ClassVar[str]

    @model_validator(mode="before")
    @classmethod
    def _shorthand(cls, raw: Any) -> Any:  # noqa: ANN401  # whatever the file holds
        return raw if isinstance(raw, dict | cls) else {cls.short_for: raw}

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Allow both forms."""
        whole = handler.resolve_ref_schema(handler(schema))
        return {"anyOf": [whole, whole["properties"][cls.short_for]], "description": whole.get("description", "")}


def expressions_in(part: object) -> Iterator[Expression]:
    """Find the expressions of a part of the specification."""
    match part:
        case Expression():
            yield part
        case Section():
            yield from expressions_in([value for _, value in part])
        case Mapping():
            yield from expressions_in(list(part.values()))
        case tuple() | list():
            for each in part:
                yield from expressions_in(each)
