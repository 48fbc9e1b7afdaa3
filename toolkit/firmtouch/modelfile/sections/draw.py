"""`draw` of a scenario file: what a Monte Carlo study draws around a scenario, and from how wide a set."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any, Final

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Kind, Problem
from firmtouch.modelfile.fields import (
    QUANTITY_SCHEMA,
    Checked,
    check_keys,
    declared,
    expect_dimension,
    quantity_in,
    read_all,
    read_quantity,
    refuse,
)
from firmtouch.modelfile.sections.amounts import POSITIONS, VELOCITIES
from firmtouch.modelfile.sections.bounds import read_disturbance, read_offset
from firmtouch.modelfile.sections.operating_point import PER_NAME
from firmtouch.modelfile.sections.section import Section

NONE: Final = "none"
_NONE_SCHEMA: Final = {"const": NONE}
_SETS: Final[dict[str, Any]] = {"anyOf": [*QUANTITY_SCHEMA["anyOf"], PER_NAME]}


def or_none(read: Callable[[object, ValidationInfo], Any], nothing: Callable[[ValidationInfo], Any]) -> Any:  # noqa: ANN401
    """Make a reading function that also takes the word `none`, for which `nothing` gives the value."""
    return lambda raw, info: nothing(info) if raw == NONE else read(raw, info)


def _parameters(raw: object, info: ValidationInfo) -> dict[str, tuple[float, float] | None]:
    """Read names, which vary over the model's intervals (None here), or names with intervals of their own."""
    kinds = declared(info).parameters
    if isinstance(raw, list):
        names = [str(each) for each in raw]
        read_all(enumerate(names), lambda i, each: _known(each, kinds, twice=each in names[:i]))
        return dict.fromkeys(names)
    if not isinstance(raw, dict) or not raw:
        refuse(Problem("parameters were expected, as in `[m1, m2]` or `{m1: [3 kg, 5 kg]}`, or `none`"))
    check_keys(raw, kinds, "parameter", complete=False)
    return read_all(raw.items(), lambda name, each: _interval(each, kinds[name]))


def _known(name: str, kinds: Mapping[str, Kind], *, twice: bool) -> None:
    if twice:
        refuse(Problem(f"`{name}` stands here twice"))
    if name not in kinds:
        refuse(*_unknown(name, kinds))


def _unknown(name: str, kinds: Mapping[str, Kind]) -> tuple[Problem, ...]:
    choices = tuple(kinds)
    listed = ", ".join(f"`{each}`" for each in choices) or "none"
    return (Problem(f"`{name}` is no parameter; there are: {listed}", near=(name, choices)),)


def _interval(raw: object, kind: Kind) -> tuple[float, float]:
    if not isinstance(raw, list) or len(raw) != 2:
        refuse(Problem("two quantities were expected, as in `[3.5 kg, 5.0 kg]`"))

    def read(_: int, each: object) -> float:
        quantity = read_quantity(each)
        return expect_dimension(quantity, kind.dimension) if kind.known else quantity.value

    low, high = read_all(enumerate(raw), read).values()
    if low > high:
        refuse(Problem(f"the interval from {low:g} to {high:g} (in SI) is empty"))
    return low, high


_PARAMETERS_SCHEMA: Final[dict[str, Any]] = {
    "anyOf": [
        _NONE_SCHEMA,
        {"type": "array", "items": {"type": "string"}},
        {"type": "object", "minProperties": 1, "additionalProperties": {"type": "array", "items": QUANTITY_SCHEMA}},
    ]
}
_ANGLE: Final = quantity_in("rad", least=0, most=1)


def _set(read: Callable[[object, ValidationInfo], Any], nothing: Callable[[ValidationInfo], Any]) -> Checked:
    return Checked(or_none(read, nothing), {"anyOf": [_NONE_SCHEMA, *_SETS["anyOf"]]})


class DrawSpec(Section):
    """What each run of a Monte Carlo study draws; what is not named is drawn from the model's intervals and bounds."""

    position: Annotated[dict[str, float], POSITIONS.each(zero=True)] | None = Field(
        None, description="half widths of the box around the scenario's start, by default 0.1 rad or m; each"
    )
    velocity: Annotated[dict[str, float], VELOCITIES.each(zero=True)] | None = Field(
        None, description="half widths of the box around the scenario's starting velocity, by default 0; each"
    )
    parameters: (
        Annotated[
            dict[str, tuple[float, float] | None], Checked(or_none(_parameters, lambda _: {}), _PARAMETERS_SCHEMA)
        ]
        | None
    ) = Field(
        None, description="names, or names with intervals; by default all that have an `interval` in the model; `none`"
    )
    disturbance: (
        Annotated[
            dict[str, float], _set(read_disturbance, lambda info: dict.fromkeys(declared(info).joint_forces, 0.0))
        ]
        | None
    ) = Field(None, description="semi-axes of the ellipsoid of constant forces, by default `bounds: disturbance`; each")
    offset: (
        Annotated[dict[str, float], _set(read_offset, lambda info: dict.fromkeys(declared(info).constraints, 0.0))]
        | None
    ) = Field(None, description="semi-axes of the ellipsoid of surface offsets, by default `bounds: offset`; each")
    tilt: Annotated[float, _set(_ANGLE.read, lambda _: 0.0)] | None = Field(
        None, description="largest tilt of the surface normals, by default `bounds: tilt`"
    )
    rotation: Annotated[float, _set(_ANGLE.read, lambda _: 0.0)] | None = Field(
        None, description="largest rotation of the constraints' gradients, by default `bounds: rotation`"
    )

    @model_validator(mode="after")
    def _rotation_needs_two(self, info: ValidationInfo) -> DrawSpec:
        if self.rotation and len(declared(info).constraints) == 1:
            refuse(Problem("a rotation mixes constraints, and there is only one", path=("rotation",), at_key=True))
        return self
