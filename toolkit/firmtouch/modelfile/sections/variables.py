"""`parameters` and `coordinates`: what expressions are made of."""

from __future__ import annotations

import math

from pydantic import Field, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import AnyQuantity, Text, UnitText, expect_dimension, refuse, under
from firmtouch.modelfile.sections.section import ShortSection
from firmtouch.modelfile.units import JOULE, SECOND, parse_unit


class Parameter(ShortSection):
    """A constant of the mechanism, such as a length or a mass; `l1: 0.6 m` is short for `l1: {value: 0.6 m}`."""

    short_for = "value"

    value: AnyQuantity = Field(description="a number with its unit, such as `0.6 m`")
    interval: tuple[AnyQuantity, AnyQuantity] | None = Field(
        None, description="least and greatest value, where the parameter is not known exactly"
    )
    label: Text | None = Field(None, description="what it is, in words")

    @model_validator(mode="after")
    def _interval_holds_the_value(self) -> Parameter:
        if self.interval is not None:
            for i, end in enumerate(self.interval):
                with under("interval", i):
                    expect_dimension(end, self.value.dimension)
            low, high = (end.value for end in self.interval)
            if not low <= self.value.value <= high:
                message = f"the interval from {low:g} to {high:g} does not hold the value {self.value.value:g} (in SI)"
                refuse(Problem(message, path=("interval",)))
        return self

    @property
    def unit(self) -> str:
        """The SI unit of the value."""
        return str(self.value.dimension)


class Coordinate(ShortSection):
    """A generalised coordinate; `q1: rad` is short for `q1: {unit: rad}`."""

    short_for = "unit"

    unit: UnitText = Field(description="`rad` for an angle, `m` for a length")
    effort: AnyQuantity | None = Field(
        None, description="the greatest force of its drive: in N m for an angle, in N for a length; without it, any"
    )
    limits: tuple[AnyQuantity, AnyQuantity] | None = Field(
        None, description="least and greatest position, such as `[-120 deg, 120 deg]`; without them, any"
    )
    velocity: AnyQuantity | None = Field(None, description="the greatest speed, such as `2 rad/s`; without it, any")
    label: Text | None = Field(None, description="what it is, in words")

    @model_validator(mode="after")
    def _unit_is_si(self) -> Coordinate:
        expect_si(self.unit)
        return self

    @model_validator(mode="after")
    def _effort_is_a_force(self) -> Coordinate:
        if self.effort is not None:
            with under("effort"):
                expect_dimension(self.effort, JOULE / parse_unit(self.unit).dimension)
            if not self.effort.value > 0:
                refuse(Problem("a drive without any force; it must be positive", path=("effort",)))
        return self

    @model_validator(mode="after")
    def _limits_are_positions(self) -> Coordinate:
        unit = parse_unit(self.unit).dimension
        for i, end in enumerate(self.limits or ()):
            with under("limits", i):
                expect_dimension(end, unit)
        if self.limits is not None and not self.limits[0].value < self.limits[1].value:
            refuse(Problem("the lower limit must be below the upper one", path=("limits",)))
        if self.velocity is not None:
            with under("velocity"):
                expect_dimension(self.velocity, unit / SECOND)
            if not self.velocity.value > 0:
                refuse(Problem("a joint without any speed; it must be positive", path=("velocity",)))
        return self

    @property
    def fastest(self) -> float:
        """The greatest speed, or inf."""
        return self.velocity.value if self.velocity else math.inf

    @property
    def lower(self) -> float:
        """The least position, or -inf."""
        return self.limits[0].value if self.limits else -math.inf

    @property
    def upper(self) -> float:
        """The greatest position, or inf."""
        return self.limits[1].value if self.limits else math.inf


def expect_si(unit: str) -> None:
    """Refuse a unit that is a multiple of SI: matrices would no longer be in SI."""
    if parse_unit(unit).factor != 1:
        message = f"coordinates and constraints count in SI, and `{unit}` is a multiple; quantities may use it"
        refuse(Problem(message, path=("unit",)))
