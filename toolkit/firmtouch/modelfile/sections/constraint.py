"""`constraints`: the holonomic constraints Phi(q) = 0, Eq. (1), each an expression or on frames of a robot."""

from __future__ import annotations

from typing import Annotated

from pydantic import Discriminator, Field, StrictBool, Tag, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Expression, Text, UnitText, declared, expression_in, refuse
from firmtouch.modelfile.rows import sort_of
from firmtouch.modelfile.sections.frames import Join, RailContact, Rod, SurfaceContact
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.sections.variables import expect_si
from firmtouch.modelfile.units import parse_unit


class Constraint(Section):
    """One constraint phi_j(q) = 0; lambda_j > 0 pushes the mechanism towards growing phi_j."""

    expression: Annotated[Expression, expression_in(None)] = Field(description="phi_j, of the configuration alone")
    unit: UnitText = Field(description="the unit of phi_j: in `m`, lambda_j is a force in newtons")
    label: Text | None = Field(None, description="what it is, in words")
    one_sided: StrictBool = Field(
        False, description="true: the contact can only push, as a wall does; lambda must keep the sign of lambda_d"
    )

    @model_validator(mode="after")
    def _unit_is_that_of_phi(self, info: ValidationInfo) -> Constraint:
        expect_si(self.unit)
        kind = self.expression.kind
        if not kind.fits(parse_unit(self.unit).dimension):
            refuse(Problem(f"phi is {kind.dimension.in_words()}, but its `unit` is {self.unit}", path=("expression",)))
        known = declared(info)
        if not self.expression.names & {*known.coordinates, *known.definitions}:
            refuse(Problem("a constraint in which no coordinate stands", path=("expression",)))
        return self

    @property
    def written(self) -> str:
        """What the file says of it."""
        return self.expression.text

    def rows(self, name: str) -> dict[str, Constraint]:
        """Give the one row of this entry."""
        return {name: self}


Entry = Annotated[
    Annotated[Constraint, Tag("expression")]
    | Annotated[SurfaceContact, Tag("surface")]
    | Annotated[RailContact, Tag("rail")]
    | Annotated[Rod, Tag("distance")]
    | Annotated[Join, Tag("join")],
    Discriminator(sort_of),
]
"""One entry of `constraints`, which is one row of Phi or several."""
