"""`design.region`: what gains of the region method must satisfy, and which of them are best."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Annotated, Any, Final

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import QUANTITY_SCHEMA, Checked, Label, check_keys, declared, read_all, refuse
from firmtouch.modelfile.sections.amounts import (
    DAMPINGS,
    JOINT_FORCES,
    MULTIPLIERS,
    POSITIONS,
    STIFFNESSES,
    VELOCITIES,
    amount_in,
    read_amount,
)
from firmtouch.modelfile.sections.force_feedback import ForceFeedbackLimit
from firmtouch.modelfile.sections.section import Section, ShortSection
from firmtouch.modelfile.sections.structure import AnyStructure
from firmtouch.modelfile.words import listed, shown

FASTEST: Final = 1e6
NO_WEIGHT: Final = 1e9
"""What is acceptable of a velocity that costs nothing, in SI."""
OBJECTIVES: Final = ("gains", "margin", "cost", "force_error")
_HERTZ: Final = re.compile(r"hz|hertz", re.IGNORECASE)


def _rate(raw: object, info: ValidationInfo) -> float:  # noqa: ARG001  # the signature is pydantic's
    if isinstance(raw, str) and _HERTZ.search(raw):
        refuse(Problem("hertz may count turns or radians; write `30 rad/s` or `30 1/s`"))
    return read_amount(raw, "1/s", FASTEST)


def _damping(raw: object, info: ValidationInfo) -> float:  # noqa: ARG001  # the signature is pydantic's
    value = read_amount(raw, "1")
    if value >= 1:
        refuse(Problem(f"a damping ratio of {value:g}; it must lie between 0 and 1, both excluded"))
    return value


def _objective(raw: object, info: ValidationInfo) -> dict[str, float]:  # noqa: ARG001  # the signature is pydantic's
    if isinstance(raw, str):
        if raw not in OBJECTIVES:
            message = f"{shown(raw)} is no objective; there are: {listed(OBJECTIVES)}"
            refuse(Problem(message, near=(raw, OBJECTIVES)))
        return {raw: 1.0}
    if not isinstance(raw, dict) or not raw:
        refuse(Problem("an objective was expected, or several with their weights, as in `{gains: 1, margin: 0.5}`"))
    check_keys(raw, OBJECTIVES, "objective", complete=False)
    return read_all(raw.items(), lambda _, each: read_amount(each, "1"))


def _parameters(raw: object, info: ValidationInfo) -> tuple[str, ...]:
    if not isinstance(raw, list):
        refuse(Problem("a list of parameters was expected, as in `[m1, m2]`"))
    choices = tuple(declared(info).parameters)

    def read(i: int, each: object) -> str:
        if not isinstance(each, str) or each not in choices:
            message = f"{shown(str(each))} is no parameter; there are: {listed(choices)}"
            refuse(Problem(message, near=(str(each), choices)))
        if each in raw[:i]:
            refuse(Problem(f"`{each}` stands here twice"))
        return each

    return tuple(read_all(enumerate(raw), read).values())


_OBJECTIVE_SCHEMA: Final[dict[str, Any]] = {
    "anyOf": [
        {"enum": list(OBJECTIVES)},
        {
            "type": "object",
            "properties": dict.fromkeys(OBJECTIVES, QUANTITY_SCHEMA),
            "additionalProperties": False,
            "minProperties": 1,
        },
    ]
}
_NAMES_SCHEMA: Final[dict[str, Any]] = {"type": "array", "items": {"type": "string"}, "uniqueItems": True}
Rate = Annotated[float, Checked(_rate, {**QUANTITY_SCHEMA, "description": "in 1/s"})]
Damping = Annotated[float, Checked(_damping, QUANTITY_SCHEMA)]
Objective = Annotated[dict[str, float], Checked(_objective, _OBJECTIVE_SCHEMA)]
ParameterNames = Annotated[tuple[str, ...], Checked(_parameters, _NAMES_SCHEMA)]


def _at_least_one(section: Section, *names: str) -> None:
    if all(getattr(section, name) is None for name in names):
        *others, last = (f"`{name}`" for name in names)
        refuse(Problem(f"at least one of {', '.join(others)} and {last} is needed"))


class GainBound(ShortSection):
    """How large a gain matrix may be; its norm alone may be written."""

    short_for = "norm"

    norm: float | None = None
    joints: dict[str, float] | None = None

    @model_validator(mode="after")
    def _something_is_bounded(self) -> GainBound:
        _at_least_one(self, "norm", "joints")
        return self


class StiffnessBound(GainBound):
    """How large W may be; `W: 300 N*m/rad` is short for `W: {norm: 300 N*m/rad}`."""

    norm: Annotated[float, STIFFNESSES.norm()] | None = Field(None, description="bound of the 2-norm of W")
    joints: Annotated[dict[str, float], STIFFNESSES.some()] | None = Field(
        None, description="bound of |W_ii| for some of the coordinates"
    )


class DampingBound(GainBound):
    """How large C may be; `C: 60 N*m*s/rad` is short for `C: {norm: 60 N*m*s/rad}`."""

    norm: Annotated[float, DAMPINGS.norm()] | None = Field(None, description="bound of the 2-norm of C")
    joints: Annotated[dict[str, float], DAMPINGS.some()] | None = Field(
        None, description="bound of |C_ii| for some of the coordinates"
    )


class TorqueLimit(Section):
    """A limit of what the feedback answers to errors: sum_j |W_ij| position_j + |C_ij| velocity_j <= at_most_i."""

    position: Annotated[dict[str, float], POSITIONS.each(zero=True)] | None = Field(
        None, description="largest position error: one quantity, or one for each coordinate"
    )
    velocity: Annotated[dict[str, float], VELOCITIES.each(zero=True)] | None = Field(
        None, description="largest velocity error: one quantity, or one for each coordinate"
    )
    at_most: Annotated[dict[str, float], JOINT_FORCES.each()] = Field(
        description="what the generalised force may reach: one quantity, or one for each coordinate"
    )

    @model_validator(mode="after")
    def _some_error(self) -> TorqueLimit:
        _at_least_one(self, "position", "velocity")
        return self


class CostSpec(Section):
    """A quadratic cost with weights by Bryson's rule, and the starts for which it is bounded.

    Q = diag(1/position^2), diag(1/velocity^2) and R = diag(1/torque^2): an error or a torque of the size given here
    for one second costs one second.
    """

    position: Annotated[dict[str, float], POSITIONS.each()] = Field(
        description="acceptable position error: one quantity, or one for each coordinate"
    )
    velocity: Annotated[dict[str, float], VELOCITIES.each()] | None = Field(
        None, description="acceptable velocity error, likewise; without it velocities cost nothing"
    )
    torque: Annotated[dict[str, float], JOINT_FORCES.each()] = Field(
        description="acceptable generalised force of the feedback, likewise"
    )
    start_position: Annotated[dict[str, float], POSITIONS.each()] = Field(
        description="semi-axes of the ellipsoid of starts for which the cost is guaranteed: position errors"
    )
    start_velocity: Annotated[dict[str, float], VELOCITIES.each()] = Field(
        description="semi-axes of the same ellipsoid: velocities"
    )
    at_most: Annotated[float, amount_in("s")] | None = Field(None, description="what the cost may reach, in s")


class ForceErrorSpec(Section):
    """Bounds of the 2-norm of the steady-state force error, apart for its two causes."""

    disturbance: Annotated[float, MULTIPLIERS.norm()] | None = Field(
        None, description="under the file's `bounds.disturbance`"
    )
    offset: Annotated[float, MULTIPLIERS.norm()] | None = Field(None, description="under the file's `bounds.offset`")

    @model_validator(mode="after")
    def _some_cause(self) -> ForceErrorSpec:
        _at_least_one(self, "disturbance", "offset")
        return self


class LambdaUncertainty(Section):
    """How far the multipliers may be from lambda_d: each by itself, or all of them by a norm."""

    box: Annotated[dict[str, float], MULTIPLIERS.each(zero=True)] | None = Field(
        None, description="half widths: one quantity, or one for each constraint"
    )
    ball: Annotated[float, MULTIPLIERS.norm()] | None = Field(None, description="bound of the 2-norm")

    @model_validator(mode="after")
    def _one_form(self) -> LambdaUncertainty:
        if (self.box is None) == (self.ball is None):
            refuse(Problem(f"give either `box` or `ball`{', not both' if self.box is not None else ''}"))
        return self


class UncertaintySpec(Section):
    """For what the conditions must hold beside the file's values: one pair of gains serves all."""

    parameters: ParameterNames | None = Field(
        None, description="the parameters that vary over their `interval`; without this key, all that have one"
    )
    lambda_d: LambdaUncertainty | None = Field(None, description="how far the multipliers may be from lambda_d")


class RegionSpec(Section):
    """Conditions on the poles, the gains and the errors; the gains that satisfy all of them are searched."""

    decay: Rate | None = Field(None, description="every pole has a real part of at most -decay")
    damping: Damping | None = Field(None, description="least damping ratio of the poles")
    bandwidth: Rate | None = Field(None, description="greatest distance of a pole from zero")
    positivity: Annotated[dict[str, float], STIFFNESSES.each()] | None = Field(
        None,
        description="K = W + N0 is at least the diagonal matrix of these; one quantity, or one each",
    )
    W: StiffnessBound | None = Field(None, description="how large W may be")
    C: DampingBound | None = Field(None, description="how large C may be")
    torque: dict[Label, TorqueLimit] = Field(
        {},
        description="limits of the torque: the drives', for errors at the start, or the ripple by encoder noise",
    )
    cost: CostSpec | None = Field(None, description="quadratic cost")
    position_error: Annotated[float, POSITIONS.norm()] | None = Field(
        None, description="bound of the 2-norm of the steady-state position error under the file's `bounds.disturbance`"
    )
    force_error: ForceErrorSpec | None = Field(None, description="bounds of the steady-state force error")
    force_feedback_limit: ForceFeedbackLimit | None = Field(
        None, description="what the force path allows on G_f's diagonal: one number, or one for each constraint"
    )
    structure: AnyStructure = Field(
        "full", validate_default=True, description="which entries of W and C may differ from zero"
    )
    objective: Objective = Field(
        {"gains": 1.0}, description="what is made small (margin: large), or several such with their weights"
    )
    uncertainty: UncertaintySpec | None = Field(
        None, description="what varies; without this key, the parameters that have an `interval`"
    )

    def margin(self, coordinates: Iterable[str], *, same_unit: bool) -> tuple[float, tuple[float, ...]]:
        """Read `positivity` as mu and the diagonal of D, K >= mu D: one value as mu with D = I, several as D."""
        values = [1.0 if self.positivity is None else self.positivity[name] for name in coordinates]
        if self.positivity is None:
            return 0.0, tuple(values)
        if same_unit and len(set(values)) == 1:
            return values[0], (1.0,) * len(values)
        return 1.0, tuple(values)

    @model_validator(mode="after")
    def _the_loop_is_asked_something(self) -> RegionSpec:
        _at_least_one(self, "decay", "damping", "bandwidth", "cost")
        if self.decay is not None and self.bandwidth is not None and self.decay >= self.bandwidth:
            message = f"a bandwidth of {self.bandwidth:g} 1/s leaves no poles with a decay of {self.decay:g} 1/s"
            refuse(Problem(f"{message}; it must be greater", path=("bandwidth",)))
        if "cost" in self.objective and self.cost is None:
            refuse(Problem("the objective `cost` needs `cost`", path=("objective", "cost"), at_key=True))
        return self
