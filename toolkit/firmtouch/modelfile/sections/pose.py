"""Where a frame is in another, and frames of the robot, with what stands off from them."""

from __future__ import annotations

from typing import Annotated, Any, Final

from pydantic import Field, ValidationInfo

from firmtouch.modelfile.declarations import Declarations
from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import EXPRESSION_SCHEMA, Checked, Expression, declared, read_all, refuse, under
from firmtouch.modelfile.fields.constant import constant_in, read_constant
from firmtouch.modelfile.sections.section import Section, ShortSection
from firmtouch.modelfile.words import did_you_mean, listed, shown

LONGEST_FRAME: Final = 200
Turns = tuple[tuple[str, Expression], ...]


def _turn(raw: object, known: Declarations) -> tuple[str, Expression]:
    axis = next(iter(raw)) if isinstance(raw, dict) and len(raw) == 1 else None
    if not isinstance(raw, dict) or axis not in ("x", "y", "z"):
        refuse(Problem("a rotation is written `{z: 90 deg}`: one axis out of x, y, z, and an angle"))
    with under(axis):
        return axis, read_constant(raw[axis], known, "1")


def _turns(raw: object, info: ValidationInfo) -> Turns:
    if not isinstance(raw, list):
        refuse(Problem("a list of rotations was expected, such as `[{z: 90 deg}, {y: 10 deg}]`"))
    return tuple(read_all(enumerate(raw), lambda _, each: _turn(each, declared(info))).values())


def _frame(raw: object, info: ValidationInfo) -> str:
    frames = declared(info).frames
    if frames is None:
        refuse(Problem("a frame belongs to a robot, and this `mechanism` is none; write an `expression`"))
    if not isinstance(raw, str) or not raw or len(raw) > LONGEST_FRAME:
        refuse(Problem("the name of a frame was expected: a link of the robot"))
    if raw not in frames:
        near = did_you_mean(raw, frames) or f"; there are: {listed(frames)}"
        refuse(Problem(f"the robot has no frame {shown(raw)} that it carries or stands on{near}"))
    return raw


_ROTATIONS: Final[dict[str, Any]] = {
    "type": "array",
    "items": {"type": "object", "properties": dict.fromkeys("xyz", EXPRESSION_SCHEMA), "maxProperties": 1},
}
FrameName = Annotated[str, Checked(_frame, {"type": "string"})]
Orientation = Annotated[Turns, Checked(_turns, _ROTATIONS)]
Vector3 = Annotated[Expression, constant_in("m", size=3)]


class PoseSpec(Section):
    """A frame in another: where its origin is, and rotations about the axes as the earlier ones have left them."""

    position: Vector3 | None = Field(None, description="the origin, such as `[0, 0, 0.8 m]`; without it, the same")
    orientation: Orientation = Field((), description="such as `[{z: 90 deg}, {y: 10 deg}]`, about the moving axes")

    def expressions(self) -> tuple[Expression, ...]:
        """List what it is made of."""
        return (*((self.position,) if self.position else ()), *(angle for _, angle in self.orientation))


class FrameSpec(ShortSection, PoseSpec):
    """A frame of the robot, or one that stands off from it; `tool0` is short for `{frame: tool0}`."""

    short_for = "frame"

    frame: FrameName = Field(description="a link of the robot")
