"""A whole model file as one frozen value."""

from __future__ import annotations

from typing import Annotated, Final, Literal

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import (
    EXPRESSION_SCHEMA,
    Checked,
    Expression,
    Label,
    NewName,
    Text,
    declared,
    new_name,
    read_all,
    read_expression,
    refuse,
)
from firmtouch.modelfile.sections.bounds import Bounds
from firmtouch.modelfile.sections.constraint import Constraint
from firmtouch.modelfile.sections.design import DesignSpec
from firmtouch.modelfile.sections.drawing import Drawing
from firmtouch.modelfile.sections.mechanism import Mechanism
from firmtouch.modelfile.sections.operating_point import OperatingPointSpec
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.sections.variables import Coordinate, Parameter

MOST_COORDINATES: Final = 40


def _definitions(raw: object, info: ValidationInfo) -> dict[str, Expression]:
    if not isinstance(raw, dict):
        refuse(Problem("names and their expressions were expected, as in `elbow: [l1*cos(q1), l1*sin(q1)]`"))
    known = declared(info)

    def read(name: str, each: object) -> Expression:
        new_name(name, known)
        return read_expression(each, known.above(name), sizes=(0, 2, 3))

    return read_all(raw.items(), read)


_DEFINITIONS: Final = {
    "type": "object",
    "additionalProperties": {
        "anyOf": [
            *EXPRESSION_SCHEMA["anyOf"],
            {"type": "array", "items": EXPRESSION_SCHEMA, "minItems": 2, "maxItems": 3},
        ]
    },
}


class ModelSpec(Section):
    """A mechanism, its constraints, a regulation point, and what is asked of the feedback there."""

    schema_: Literal["firmtouch.model/1"] = Field("firmtouch.model/1", alias="schema", description="the file's format")
    title: Text = Field(description="one line, the report's title")
    description: Text | None = Field(None, description="a few sentences for the report's reader")
    parameters: dict[NewName, Parameter] = Field({}, description="constants, each a quantity such as `l1: 0.6 m`")
    coordinates: dict[NewName, Coordinate] = Field(
        min_length=1, max_length=MOST_COORDINATES, description="the generalised coordinates q, in order"
    )
    definitions: Annotated[dict[str, Expression], Checked(_definitions, _DEFINITIONS)] = Field(
        {}, description="named intermediate expressions, scalars or vectors; each may use those above it"
    )
    mechanism: Mechanism = Field(description="`gravity` and `bodies`, or `kinetic_energy` and `potential_energy`")
    constraints: dict[Label, Constraint] = Field(min_length=1, description="the constraints Phi(q) = 0, in order")
    operating_point: OperatingPointSpec
    design: DesignSpec
    bounds: Bounds = Bounds()
    drawing: Drawing | None = None

    @model_validator(mode="after")
    def _fewer_constraints_than_coordinates(self) -> ModelSpec:
        n, m = len(self.coordinates), len(self.constraints)
        if m >= n:
            message = f"{m} constraints on {n} coordinates leave nothing to move; there must be fewer"
            refuse(Problem(message, path=("constraints",)))
        return self

    @property
    def n(self) -> int:
        """The number of coordinates."""
        return len(self.coordinates)

    @property
    def m(self) -> int:
        """The number of constraints."""
        return len(self.constraints)
