"""`surface`: what a point of the mechanism has to stay on, as one mapping `kind: {...}`.

Lengths, angles and directions are constants: quantities, bare numbers in SI, or expressions of the parameters. What is
a number is checked here; of what has parameters in it, a degenerate value shows as no number at the operating point.
"""

from __future__ import annotations

import math
from typing import Annotated, Final, Literal

from pydantic import ConfigDict, Field, ValidationInfo, model_validator

from firmtouch.modelfile.declarations import Declarations
from firmtouch.modelfile.expression import Kind, Problem
from firmtouch.modelfile.fields import (
    EXPRESSION_SCHEMA,
    QUANTITY_SCHEMA,
    Checked,
    Expression,
    Range,
    constant_in,
    declared,
    read_constant,
    read_expression,
    refuse,
    value_of,
    values_of,
)
from firmtouch.modelfile.sections.heights import Heights, Span
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.sections.space import AXES, Direction, Length, Lengths, Place, Turns

HIGHEST_EXPONENT: Final = 32
"""Of a superellipsoid: its edges are then rounded with about 1/30 of its size."""


def _exponents(raw: object, info: ValidationInfo) -> tuple[float, float]:
    within = Range(least=2, most=HIGHEST_EXPONENT)
    values = values_of(read_constant(raw, declared(info), "1", size=2, within=within))
    if values is None:
        refuse(Problem("parameters cannot stand here: the exponents decide how the surface is written"))
    return values[0], values[1]


def _level(raw: object, info: ValidationInfo) -> Expression:
    """Read f(x, y, z), whose names are the surface's own coordinates and the parameters.

    All of them are plain numbers here: surfaces are written as `x**2 + y**2 - z`, which mixes powers of metres.
    """
    known = declared(info)
    taken = [f"`{axis}`" for axis in AXES if axis in known.parameters]
    if taken:
        refuse(
            Problem(f"{', '.join(taken)} would be a coordinate of the surface here, and is a parameter too: rename it")
        )
    numbers = {name: Kind(known=kind.known) for name, kind in known.parameters.items()} | dict.fromkeys(AXES, Kind())
    hidden = {name: why for name, why in known.constant().hidden.items() if name not in AXES}
    found = read_expression(raw, Declarations(numbers, hidden=hidden))
    if not found.names & set(AXES):
        refuse(Problem("a surface in which none of x, y, z stands"))
    return found


_TWO_NUMBERS: Final = {"type": "array", "items": QUANTITY_SCHEMA, "minItems": 2, "maxItems": 2}
Side = Literal["outside", "inside"]
_SIDE: Final = "on which side the mechanism is; `inside` is in a hollow"
_ORIENTATION: Final = "rotations of its frame about the moving axes, such as `[{z: 30 deg}, {y: 10 deg}]`"
_POSITION: Final = "where the origin of its frame is in the world; without it, in the world's"


class Plane(Section):
    """A plane; outside is where its normal points."""

    point: Place = Field(description="a point of it")
    normal: Direction = Field(description="of any length, towards the mechanism")


class Sphere(Section):
    """A sphere."""

    centre: Place
    radius: Length
    side: Side = Field("outside", description=_SIDE)


class Cylinder(Section):
    """A round cylinder without ends."""

    point: Place = Field(description="a point on the axis")
    axis: Direction = Field(description="direction of the axis, of any length")
    radius: Length
    side: Side = Field("outside", description=_SIDE)


class Cone(Section):
    """A round cone without end."""

    apex: Place
    axis: Direction = Field(description="from the apex into the cone, of any length")
    half_angle: Annotated[Expression, constant_in("1", within=Range(above=0, below=math.pi / 2))] = Field(
        description="between the axis and the mantle, such as `30 deg`"
    )
    side: Side = Field("outside", description=_SIDE)


class Torus(Section):
    """A ring with a round tube."""

    centre: Place
    axis: Direction = Field(description="the ring lies across it; of any length")
    ring_radius: Length = Field(description="from the centre to the middle of the tube")
    tube_radius: Length = Field(description="of the tube; less than the ring's")
    side: Side = Field("outside", description=_SIDE)

    @model_validator(mode="after")
    def _does_not_meet_itself(self) -> Torus:
        ring, tube = value_of(self.ring_radius), value_of(self.tube_radius)
        if ring is not None and tube is not None and tube >= ring:
            message = f"a tube of {tube:g} m around a ring of {ring:g} m cuts itself; it must be thinner"
            refuse(Problem(message, path=("tube_radius",)))
        return self


class Ellipsoid(Section):
    """An ellipsoid (x/a)^2 + (y/b)^2 + (z/c)^2 = 1 in its frame."""

    centre: Place
    semi_axes: Lengths = Field(description="[a, b, c]")
    orientation: Turns = Field((), description=_ORIENTATION)
    side: Side = Field("outside", description=_SIDE)


class Superellipsoid(Section):
    """A body between an ellipsoid and a box, (|x/a|^e2 + |y/b|^e2)^(e1/e2) + |z/c|^e1 = 1 in its frame.

    [2, 2] is the ellipsoid, [8, 8] a rounded box, [8, 2] a rounded cylinder along z.
    """

    centre: Place
    semi_axes: Lengths = Field(description="[a, b, c]")
    exponents: Annotated[tuple[float, float], Checked(_exponents, _TWO_NUMBERS)] = Field(
        description="[e1, e2], plain numbers from 2 on: e1 along z and e2 across; even ones are smoothest"
    )
    orientation: Turns = Field((), description=_ORIENTATION)
    side: Side = Field("outside", description=_SIDE)


class Implicit(Section):
    """A surface f(x, y, z) = 0; f > 0 is outside."""

    expression: Annotated[Expression, Checked(_level, EXPRESSION_SCHEMA)] = Field(
        description="f, of x, y, z in the surface's frame and of parameters, all plain numbers in SI"
    )
    position: Place | None = Field(None, description=_POSITION)
    orientation: Turns = Field((), description=_ORIENTATION)


class HeightField(Section):
    """A landscape z = h(x, y) through heights over a uniform grid, by bicubic splines; outside is above."""

    x: Span = Field(description="[start, stop] of the rows, in the surface's frame")
    y: Span = Field(description="[start, stop] of the columns")
    heights: Heights = Field(description="a list for each x with a height for each y: 4 x 4 to 40 x 40")
    position: Place | None = Field(None, description=_POSITION)
    orientation: Turns = Field((), description=_ORIENTATION)


Shape = Plane | Sphere | Cylinder | Cone | Torus | Ellipsoid | Superellipsoid | Implicit | HeightField


class SurfaceSpec(Section):
    """One surface, by its kind."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})

    plane: Plane | None = None
    sphere: Sphere | None = None
    cylinder: Cylinder | None = None
    cone: Cone | None = None
    torus: Torus | None = None
    ellipsoid: Ellipsoid | None = None
    superellipsoid: Superellipsoid | None = None
    implicit: Implicit | None = None
    height_field: HeightField | None = None

    @model_validator(mode="after")
    def _one_kind(self) -> SurfaceSpec:
        given = [name for name in type(self).model_fields if name in self.model_fields_set]
        if len(given) > 1:
            listed = " and ".join(f"`{each}`" for each in given)
            refuse(Problem(f"{listed} at once; a surface is of one kind", path=(given[1],), at_key=True))
        if not given or getattr(self, given[0]) is None:
            example = "`sphere: {centre: [0, 0, 0.5 m], radius: 0.2 m}`"
            refuse(Problem(f"a surface of one kind was expected, such as {example}", at_key=True))
        return self

    @property
    def kind(self) -> str:
        """The name of its kind, as in the file."""
        return next(name for name in type(self).model_fields if getattr(self, name) is not None)

    @property
    def shape(self) -> Shape:
        """What it is."""
        shape: Shape = getattr(self, self.kind)
        return shape
