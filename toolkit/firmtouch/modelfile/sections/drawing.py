"""`drawing`: what the report's picture shows, as expressions that are evaluated at q_d."""

from __future__ import annotations

from typing import Annotated, Any, Final

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import (
    EXPRESSION_SCHEMA,
    Checked,
    Expression,
    Label,
    check_keys,
    declared,
    expression_in,
    read_all,
    read_expression,
    refuse,
)
from firmtouch.modelfile.sections.mechanism import PLANE_OR_SPACE
from firmtouch.modelfile.sections.section import Section

_POINTS: Final = {"type": "array", "minItems": 2, "items": {"anyOf": [*EXPRESSION_SCHEMA["anyOf"], {"type": "array"}]}}
Point = Annotated[Expression, expression_in("m", sizes=PLANE_OR_SPACE)]


def _points(raw: object, info: ValidationInfo) -> tuple[Expression, ...]:
    if not isinstance(raw, list) or len(raw) < 2:
        refuse(Problem("a list of at least two points was expected, such as `[[0, 0], elbow, tip]`"))
    return tuple(read_all(enumerate(raw), lambda _, each: _point(each, info)).values())


def _point(raw: object, info: ValidationInfo) -> Expression:
    return read_expression(raw, declared(info), unit="m", sizes=PLANE_OR_SPACE)


Points = Annotated[tuple[Expression, ...], Checked(_points, _POINTS)]


class Surface(Section):
    """A wall through points, a circle or a sphere."""

    through: Points | None = Field(None, description="points that a flat or bent wall runs through, in the plane")
    centre: Point | None = Field(None, description="centre of a circle or a sphere")
    radius: Annotated[Expression, expression_in("m")] | None = Field(None, description="its radius")

    @model_validator(mode="after")
    def _one_form(self) -> Surface:
        round_ = self.centre is not None and self.radius is not None and self.through is None
        wall = self.through is not None and self.centre is None and self.radius is None
        if not (round_ or wall):
            refuse(Problem("a surface is given by `through`, or by `centre` and `radius`"))
        return self


def _contacts(raw: object, info: ValidationInfo) -> dict[str, tuple[Expression, ...]]:
    if not isinstance(raw, dict):
        refuse(Problem("a point for each constraint whose force is drawn was expected, as in `{wall: tip}`"))
    check_keys(raw, declared(info).constraints, "constraint", complete=False)
    return read_all(raw.items(), lambda _, each: _contact(each, info))


def _contact(raw: object, info: ValidationInfo) -> tuple[Expression, ...]:
    """Read a point, or two points that press on each other."""
    if isinstance(raw, list) and len(raw) == 2:
        entries = read_all(
            enumerate(raw), lambda _, each: read_expression(each, declared(info), sizes=(0, *PLANE_OR_SPACE))
        )
        if all(each.size for each in entries.values()):
            return tuple(read_all(enumerate(raw), lambda _, each: _point(each, info)).values())
    return (_point(raw, info),)


class Drawing(Section):
    """Lines, surfaces and contact points, all in the plane or all in space."""

    lines: dict[Label, Points] = Field({}, description="polylines such as `arm: [[0, 0], elbow, tip]`")
    surfaces: dict[Label, Surface] = Field({}, description="what is touched")
    contacts: Annotated[dict[str, tuple[Expression, ...]], Checked(_contacts, {"type": "object"})] = Field(
        {},
        description="constraint -> the point at which its force acts; in a closed chain two points `[hand, handle]`, "
        "of which the first feels the force and the second its reaction",
    )

    @model_validator(mode="after")
    def _one_space(self) -> Drawing:
        sizes = {point.size for point in self.points() if point.kind.known}
        if len(sizes) > 1:
            refuse(Problem("points in the plane and points in space are mixed"))
        return self

    def points(self) -> tuple[Expression, ...]:
        """List all points of the drawing."""
        centres = [each.centre for each in self.surfaces.values() if each.centre is not None]
        walls = [point for each in self.surfaces.values() for point in each.through or ()]
        lines: list[Any] = [point for line in self.lines.values() for point in line]
        contacts = [point for points in self.contacts.values() for point in points]
        return (*lines, *walls, *centres, *contacts)
