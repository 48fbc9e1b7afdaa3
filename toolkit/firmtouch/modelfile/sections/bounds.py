"""`bounds`: how large the causes of steady-state errors may be."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Final

from pydantic import Field, ValidationInfo

from firmtouch.modelfile.expression import Kind, Problem
from firmtouch.modelfile.fields import (
    QUANTITY_SCHEMA,
    Checked,
    declared,
    expect_dimension,
    quantity_in,
    read_quantities,
    read_quantity,
    refuse,
)
from firmtouch.modelfile.sections.operating_point import PER_NAME
from firmtouch.modelfile.sections.section import Section

_SEMI_AXES: Final[dict[str, Any]] = {"anyOf": [*QUANTITY_SCHEMA["anyOf"], PER_NAME]}


def read_disturbance(raw: object, info: ValidationInfo) -> dict[str, float]:
    """Read semi-axes of an ellipsoid of generalised forces."""
    return _semi_axes(raw, declared(info).joint_forces, "coordinate")


def read_offset(raw: object, info: ValidationInfo) -> dict[str, float]:
    """Read semi-axes of an ellipsoid of surface offsets."""
    return _semi_axes(raw, declared(info).constraints, "constraint")


def _semi_axes(raw: object, kinds: Mapping[str, Kind], what: str) -> dict[str, float]:
    if isinstance(raw, dict):
        values = read_quantities(raw, kinds, what)
    else:
        quantity = read_quantity(raw)
        values = {name: expect_dimension(quantity, kind.dimension) for name, kind in kinds.items() if kind.known}
    negative = [Problem("a bound must not be negative", path=(name,)) for name, each in values.items() if each < 0]
    if negative:
        refuse(*negative)
    return values


class Bounds(Section):
    """Radii of balls, or, with one value for each name, semi-axes of ellipsoids."""

    disturbance: Annotated[dict[str, float], Checked(read_disturbance, _SEMI_AXES)] | None = Field(
        None, description="of the constant generalised force d: one quantity, or one for each coordinate"
    )
    offset: Annotated[dict[str, float], Checked(read_offset, _SEMI_AXES)] | None = Field(
        None, description="of the surface offset Delta: one quantity, or one for each constraint"
    )
    rotation: Annotated[float, quantity_in("rad", least=0, most=1)] | None = Field(
        None, description="angle of the rotation R of the constraints' gradients, |R - I| to first order"
    )
    tilt: Annotated[float, quantity_in("rad", least=0, most=1)] | None = Field(
        None, description="tilt E of the surface normals, as an angle: |E| is at most this times |J|"
    )
