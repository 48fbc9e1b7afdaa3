"""Where a frame is in another, and frames of the robot, with what stands off from them."""

from __future__ import annotations

from typing import Annotated, Final

from pydantic import Field, ValidationInfo

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Checked, Expression, declared, refuse
from firmtouch.modelfile.sections.section import Section, ShortSection
from firmtouch.modelfile.sections.space import Place, Turns
from firmtouch.modelfile.words import did_you_mean, listed, shown

LONGEST_FRAME: Final = 200


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


FrameName = Annotated[str, Checked(_frame, {"type": "string"})]


class PoseSpec(Section):
    """A frame in another: where its origin is, and rotations about the axes as the earlier ones have left them."""

    position: Place | None = Field(None, description="the origin, such as `[0, 0, 0.8 m]`; without it, the same")
    orientation: Turns = Field((), description="such as `[{z: 90 deg}, {y: 10 deg}]`, about the moving axes")

    def expressions(self) -> tuple[Expression, ...]:
        """List what it is made of."""
        return (*((self.position,) if self.position else ()), *(angle for _, angle in self.orientation))


class FrameSpec(ShortSection, PoseSpec):
    """A frame of the robot, or one that stands off from it; `tool0` is short for `{frame: tool0}`."""

    short_for = "frame"

    frame: FrameName = Field(description="a link of the robot")
