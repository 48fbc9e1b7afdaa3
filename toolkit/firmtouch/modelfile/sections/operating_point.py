"""`operating_point`: where the mechanism shall rest, and how hard it shall press."""

from __future__ import annotations

from typing import Annotated, Final, Literal

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.declarations import Declarations
from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import (
    QUANTITY_SCHEMA,
    Checked,
    Label,
    check_keys,
    declared,
    quantity_in,
    read_quantities,
    refuse,
)
from firmtouch.modelfile.sections.pose import FrameSpec
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.sections.space import Direction, Place
from firmtouch.modelfile.words import shown

PER_NAME: Final = {"type": "object", "additionalProperties": QUANTITY_SCHEMA}


def _configuration(raw: object, info: ValidationInfo) -> dict[str, float]:
    return read_quantities(raw, declared(info).coordinates, "coordinate")


def _multipliers(raw: object, info: ValidationInfo) -> dict[str, float]:
    """Read all multipliers; rows that come with others count as zero where they are not given."""
    known = declared(info)
    kinds = known.multipliers
    if isinstance(raw, dict):
        check_keys((*raw, *known.optional), kinds, "constraint", complete=True)
        kinds = {name: kind for name, kind in kinds.items() if name in raw or name not in known.optional}
    values = read_quantities(raw, kinds, "constraint")
    return {name: values.get(name, 0.0) for name in known.multipliers}


def _joint_forces(raw: object, info: ValidationInfo) -> dict[str, float]:
    return read_quantities(raw, declared(info).joint_forces, "coordinate")


Configuration = Annotated[dict[str, float], Checked(_configuration, PER_NAME)]
Multipliers = Annotated[dict[str, float], Checked(_multipliers, PER_NAME)]
JointForces = Annotated[dict[str, float], Checked(_joint_forces, PER_NAME)]


class ReachSpec(Section):
    """Where the robot shall be, for inverse kinematics: all constraints hold there too."""

    contact: Label | None = Field(
        None, description="the surface contact that is meant; not needed where there is only one"
    )
    frame: FrameSpec | None = Field(None, description="the frame that is placed; without it, the one that touches")
    point: Place = Field(description="where its origin shall be, in the world; for a contact, on the surface")
    axis: Literal["x", "y", "z"] = Field("z", description="the axis of the frame that points in the direction")
    direction: Direction | None = Field(
        None, description="where that axis points, in the world; for a contact, straight into the surface without it"
    )
    across: Direction | None = Field(
        None, description="where the axis before it (x for z, y for x, z for y) points as nearly as it can"
    )
    near: Configuration | None = Field(
        None, description="a configuration: of several solutions, the nearest to it is taken"
    )

    @model_validator(mode="after")
    def _contact_is_known(self, info: ValidationInfo) -> ReachSpec:
        contacts = declared(info).contacts
        if declared(info).frames is None:
            refuse(Problem("`reach` is for robots, and this `mechanism` is none; write a `guess`", at_key=True))
        if self.contact is not None and self.contact not in contacts:
            near = (self.contact, contacts)
            refuse(Problem(f"{shown(self.contact)} is no contact with a surface", path=("contact",), near=near))
        if self.contact is None and self.frame is None and len(contacts) != 1:
            refuse(Problem("which frame shall be there? Give its `frame`, or a `contact`"))
        if self.across is not None and self.direction is None and not contacts:
            refuse(Problem("`across` needs a `direction`", path=("across",), at_key=True))
        return self


class OperatingPointSpec(Section):
    """The regulation point (q_d, lambda_d), or what it is found from."""

    q_d: Configuration | None = Field(None, description="the configuration; it must satisfy the constraints")
    guess: Configuration | None = Field(None, description="instead of q_d: a guess, projected onto the constraints")
    reach: ReachSpec | None = Field(None, description="instead of q_d: a point and a direction, for a robot")
    lambda_d: Multipliers | None = Field(None, description="the multipliers: newtons for constraints in metres")
    f_d: JointForces | None = Field(None, description="instead of lambda_d: the constraint force in joint coordinates")
    normal_force: Annotated[float, quantity_in("N")] | None = Field(
        None, description="instead of lambda_d: how hard the one contact presses; all other multipliers are zero"
    )

    @model_validator(mode="after")
    def _one_of_each(self, info: ValidationInfo) -> OperatingPointSpec:
        problems = []
        for choices in (("q_d", "guess", "reach"), ("lambda_d", "f_d", "normal_force")):
            given = sum(getattr(self, each) is not None for each in choices)
            if given != 1:
                listed_choices = " or ".join(f"`{each}`" for each in _offered(choices, declared(info)))
                problems.append(Problem(f"give either {listed_choices}{', not both' if given > 1 else ''}"))
        if problems:
            refuse(*problems)
        known = declared(info)
        if self.normal_force is not None:
            if len(known.contacts) != 1:
                message = "`normal_force` is for one contact with a surface; write `lambda_d`"
                refuse(Problem(message, path=("normal_force",), at_key=True))
            values = dict.fromkeys(known.multipliers, 0.0) | {known.contacts[0]: self.normal_force}
            return self.model_copy(update={"lambda_d": values})
        return self


def _offered(choices: tuple[str, ...], known: Declarations) -> tuple[str, ...]:
    """Leave out what is for robots where there is none."""
    return choices if known.frames is not None else choices[:2]
