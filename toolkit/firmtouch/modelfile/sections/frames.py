"""`constraints` on frames of a robot: a tool on a surface, a frame on a rail, a rod, two frames that are joined."""

from __future__ import annotations

import math
from typing import Annotated, Final, Literal

from pydantic import Field, StrictBool, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import Checked, Text, declared, refuse, values_of
from firmtouch.modelfile.rows import ROD, Row, contact_rows, join_rows, others, rail_rows
from firmtouch.modelfile.sections.pose import FrameSpec
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.sections.space import Axis, Direction, Length, Place
from firmtouch.modelfile.sections.surface import SurfaceSpec
from firmtouch.modelfile.words import listed, shown

PARALLEL: Final = 1e-9
"""The sine of the angle between two directions, below which they span no plane."""


class RowOfFrames(Section):
    """One row of a constraint on frames; lambda > 0 pushes towards growing phi, as everywhere."""

    unit: str
    label: str
    one_sided: bool
    written: str


def _left_out(raw: object, info: ValidationInfo) -> tuple[str, ...]:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, list) or not all(isinstance(each, str) for each in raw):
        refuse(Problem("a list of rows was expected, such as `[about_x, about_y]`"))
    return tuple(raw)


class OnFrames(Section):
    """A constraint on frames, which may be several rows of Phi."""

    label: Text | None = Field(None, description="what it is, in words")
    without: Annotated[tuple[str, ...], Checked(_left_out, {"type": "array", "items": {"type": "string"}})] = Field(
        (), description="rows that are left out, such as `[about_x]`: those that the others imply"
    )

    def all_rows(self) -> tuple[Row, ...]:
        """Give the rows, those left out too."""
        raise NotImplementedError

    def written(self) -> str:
        """Say what is constrained, in a few words."""
        raise NotImplementedError

    def one_sided_rows(self) -> bool:
        """Tell whether the row that is named as the entry can only push."""
        return False

    @model_validator(mode="after")
    def _rows_are_left(self) -> OnFrames:
        names = [each.suffix for each in self.all_rows() if each.optional]
        for i, each in enumerate(self.without):
            if each not in names:
                choices = f"; there are: {listed(names)}" if names else "; it is one row, which cannot be left out"
                message = f"{shown(each)} is no row that could be left out{choices}"
                refuse(Problem(message, path=("without", i), near=(each, tuple(names))))
        if len(set(self.without)) == len(self.all_rows()):
            refuse(Problem("no row is left", path=("without",)))
        return self

    def rows(self, name: str) -> dict[str, RowOfFrames]:
        """Give the rows of the entry of this name."""
        found = {}
        for each in self.all_rows():
            if each.suffix not in self.without or not each.optional:
                words = f"{self.label}: {each.words}" if self.label and each.suffix else self.label or each.words
                one_sided = self.one_sided_rows() and not each.suffix
                found[each.name(name)] = RowOfFrames(
                    unit=each.unit, label=words, one_sided=one_sided, written=self.written()
                )
        return found


class SurfaceContact(OnFrames):
    """A point of the robot on a surface, and, with `align`, an axis of its frame along the surface's normal."""

    surface: SurfaceSpec = Field(description="what is touched")
    point: FrameSpec | None = Field(None, description="the frame whose origin touches; without it, the tool")
    align: Axis | None = Field(None, description="the axis of that frame that stays along the normal: two more rows")
    one_sided: StrictBool = Field(True, description="false: the contact can pull too")

    def all_rows(self) -> tuple[Row, ...]:
        """Give the distance, and the turns about the two other axes."""
        return contact_rows(self.align)

    def written(self) -> str:
        """Name the frame and the surface."""
        return f"{self.point.frame if self.point else 'tool'} on a {self.surface.kind.replace('_', ' ')}"

    def one_sided_rows(self) -> bool:
        """Tell whether the surface can only push."""
        return self.one_sided

    @property
    def other_axes(self) -> tuple[str, str]:
        """The axes of the frame that stay in the tangent plane."""
        assert self.align is not None
        return others(self.align)

    @model_validator(mode="after")
    def _a_point_is_known(self, info: ValidationInfo) -> SurfaceContact:
        known = declared(info)
        if self.point is None and known.frames is None:
            refuse(Problem("a `surface` is for robots, and this `mechanism` is none; write an `expression`"))
        if self.point is None and len(known.tools) != 1:
            refuse(Problem("which frame touches? Give its `point`, or the mechanism one `tool`"))
        if self.point is None:
            point = FrameSpec.model_construct(frame=known.tools[0], position=None, orientation=())
            return self.model_copy(update={"point": point})
        return self


class LineSpec(Section):
    """A straight rail."""

    point: Place = Field(description="a point of it, in the world")
    direction: Direction = Field(description="where it leads, of any length")
    up: Direction | None = Field(None, description="square to it: with `hold: frame`, along the frame's y axis")

    @model_validator(mode="after")
    def _up_is_not_along(self) -> LineSpec:
        along, up = values_of(self.direction), None if self.up is None else values_of(self.up)
        if along is not None and up is not None and _parallel(along, up):
            refuse(Problem("`up` points along the line itself", path=("up",)))
        return self


class CircleSpec(Section):
    """A round rail."""

    centre: Place
    axis: Direction = Field(description="square to its plane; with `hold: frame`, along the frame's y axis")
    radius: Length


class CurveSpec(Section):
    """A curve in the world."""

    line: LineSpec | None = None
    circle: CircleSpec | None = None

    @model_validator(mode="after")
    def _one_curve(self) -> CurveSpec:
        if (self.line is None) == (self.circle is None):
            refuse(Problem("a rail is one `line` or one `circle`"))
        return self


def _parallel(u: tuple[float, ...], v: tuple[float, ...]) -> bool:
    """Tell whether two directions are the same, or opposite, but for rounding."""
    (a, b, c), (x, y, z) = (tuple(each / math.hypot(*w) for each in w) for w in (u, v))
    return math.hypot(b * z - c * y, c * x - a * z, a * y - b * x) < PARALLEL


def _differ(frames: tuple[FrameSpec, FrameSpec], key: str) -> None:
    """Refuse a link and itself, between which nothing moves."""
    if frames[0].frame == frames[1].frame:
        message = f"both are on the link {shown(frames[0].frame)}, which cannot move against itself"
        refuse(Problem(message, path=(key, 1)))


HOLDS: Final = "`point`: the origin; `axis`: the z axis too; `frame`: all of it"


class RailContact(OnFrames):
    """A frame of the robot that slides along a curve."""

    rail: CurveSpec
    frame: FrameSpec = Field(description="what slides")
    hold: Literal["point", "axis", "frame"] = Field("point", description=f"what stays on or along the curve: {HOLDS}")

    def all_rows(self) -> tuple[Row, ...]:
        """Give two distances, and the turns that are held."""
        return rail_rows(self.hold)

    def written(self) -> str:
        """Name the frame and the curve."""
        return f"{self.frame.frame} on a {'circle' if self.rail.line is None else 'line'}"

    @model_validator(mode="after")
    def _the_frame_has_a_direction(self) -> RailContact:
        if self.hold == "frame" and self.rail.line is not None and self.rail.line.up is None:
            refuse(Problem("`hold: frame` needs `up`, a direction square to the line", path=("rail", "line")))
        return self


class Rod(OnFrames):
    """Two points at a fixed distance."""

    distance: Length = Field(description="the rod's length")
    between: tuple[FrameSpec, FrameSpec] = Field(description="the frames whose origins it joins")

    @model_validator(mode="after")
    def _two_frames(self) -> Rod:
        _differ(self.between, "between")
        return self

    def all_rows(self) -> tuple[Row, ...]:
        """Give the one length."""
        return (ROD,)

    def written(self) -> str:
        """Name the ends."""
        return " to ".join(each.frame for each in self.between)


class Join(OnFrames):
    """Two frames of the robot that are joined: a closed chain."""

    join: tuple[FrameSpec, FrameSpec] = Field(description="the two frames; gaps count along the first one's axes")
    hold: Literal["point", "axis", "frame"] = Field("frame", description=f"what coincides: {HOLDS}")

    @model_validator(mode="after")
    def _two_frames(self) -> Join:
        _differ(self.join, "join")
        return self

    def all_rows(self) -> tuple[Row, ...]:
        """Give three gaps, and the turns that are held."""
        return join_rows(self.hold)

    def written(self) -> str:
        """Name the frames."""
        return " = ".join(each.frame for each in self.join)
