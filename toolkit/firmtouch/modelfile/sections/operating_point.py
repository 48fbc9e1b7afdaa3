"""`operating_point`: where the mechanism shall rest, and how hard it shall press."""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import QUANTITY_SCHEMA, Checked, declared, read_quantities, refuse
from firmtouch.modelfile.sections.section import Section

PER_NAME: Final = {"type": "object", "additionalProperties": QUANTITY_SCHEMA}


def _configuration(raw: object, info: ValidationInfo) -> dict[str, float]:
    return read_quantities(raw, declared(info).coordinates, "coordinate")


def _multipliers(raw: object, info: ValidationInfo) -> dict[str, float]:
    """Read all multipliers; rows that come with others count as zero where they are not given."""
    known = declared(info)
    kinds = known.multipliers
    if isinstance(raw, dict):
        kinds = {name: kind for name, kind in kinds.items() if name in raw or name not in known.optional}
    values = read_quantities(raw, kinds, "constraint")
    return {name: values.get(name, 0.0) for name in known.multipliers}


def _joint_forces(raw: object, info: ValidationInfo) -> dict[str, float]:
    return read_quantities(raw, declared(info).joint_forces, "coordinate")


Configuration = Annotated[dict[str, float], Checked(_configuration, PER_NAME)]
Multipliers = Annotated[dict[str, float], Checked(_multipliers, PER_NAME)]
JointForces = Annotated[dict[str, float], Checked(_joint_forces, PER_NAME)]


class OperatingPointSpec(Section):
    """The regulation point (q_d, lambda_d), or what it is found from."""

    q_d: Configuration | None = Field(None, description="the configuration; it must satisfy the constraints")
    guess: Configuration | None = Field(None, description="instead of q_d: a guess, projected onto the constraints")
    lambda_d: Multipliers | None = Field(None, description="the multipliers: newtons for constraints in metres")
    f_d: JointForces | None = Field(None, description="instead of lambda_d: the constraint force in joint coordinates")

    @model_validator(mode="after")
    def _one_of_each(self) -> OperatingPointSpec:
        problems = [
            Problem(f"give either `{a}` or `{b}`{', not both' if given == 2 else ''}")
            for a, b in (("q_d", "guess"), ("lambda_d", "f_d"))
            if (given := (getattr(self, a) is not None) + (getattr(self, b) is not None)) != 1
        ]
        if problems:
            refuse(*problems)
        return self
