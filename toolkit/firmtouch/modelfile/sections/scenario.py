"""A scenario: how the world differs from the model, and what the controller has to work with, for a while."""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal

from pydantic import Field, StrictBool, ValidationInfo, model_validator

from firmtouch.modelfile.expression import Kind, Problem
from firmtouch.modelfile.fields import (
    Checked,
    Expression,
    Label,
    Text,
    check_keys,
    declared,
    expression_in,
    frequency_between,
    quantity_in,
    read_all,
    read_quantities,
    refuse,
)
from firmtouch.modelfile.sections.amounts import MULTIPLIERS, POSITIONS, VELOCITIES
from firmtouch.modelfile.sections.draw import DrawSpec
from firmtouch.modelfile.sections.force_path import ForcePathSpec
from firmtouch.modelfile.sections.operating_point import PER_NAME, Configuration
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.words import listed, shown

LONGEST: Final = 3600.0
"""The longest run, in s."""
SLOWEST, FASTEST = 1e-3, 1e5
"""Frequencies of disturbances, in rad/s."""
MOST_SCENARIOS: Final = 50
MOST_DISTURBANCES: Final = 20
LARGEST_SEED: Final = 2**32 - 1


def _some(raw: object, kinds: dict[str, Kind], what: str) -> dict[str, float]:
    """Read quantities for some of the names, at least one."""
    if not isinstance(raw, dict) or not raw:
        refuse(Problem(f"an entry for a {what} was expected, as in `{{{next(iter(kinds), 'name')}: ...}}`"))
    check_keys(raw, kinds, what, complete=False)
    return read_quantities(raw, {name: kinds[name] for name in raw}, what)


def _positions(raw: object, info: ValidationInfo) -> dict[str, float]:
    return _some(raw, dict(declared(info).coordinates), "coordinate")


def _velocities(raw: object, info: ValidationInfo) -> dict[str, float]:
    return _some(raw, declared(info).rates, "coordinate")


def _joint_forces(raw: object, info: ValidationInfo) -> dict[str, float]:
    return _some(raw, declared(info).joint_forces, "coordinate")


def _offsets(raw: object, info: ValidationInfo) -> dict[str, float]:
    return _some(raw, dict(declared(info).constraints), "constraint")


def _parameters(raw: object, info: ValidationInfo) -> dict[str, float]:
    return _some(raw, dict(declared(info).parameters), "parameter")


def _tilts(raw: object, info: ValidationInfo) -> dict[str, dict[str, float]]:
    known = declared(info)
    if not isinstance(raw, dict) or not raw:
        refuse(
            Problem("an entry for a constraint was expected, as in `{wall: {q1: 5 mm}}`: what is added to its row of J")
        )
    check_keys(raw, known.constraints, "constraint", complete=False)

    def read(name: str, row: object) -> dict[str, float]:
        phi = known.constraints[name]
        kinds = {
            each: Kind(phi.dimension / kind.dimension, known=phi.known and kind.known)
            for each, kind in known.coordinates.items()
        }
        return _some(row, kinds, "coordinate")

    return read_all(raw.items(), read)


def _pair(raw: object, info: ValidationInfo) -> tuple[str, str]:
    """Read two constraints that can be rotated into each other."""
    known = declared(info).constraints
    if not isinstance(raw, list) or len(raw) != 2 or not all(isinstance(each, str) for each in raw):
        refuse(Problem("two constraints were expected, as in `[first, second]`"))
    there_are = f"is no constraint; there are: {listed(known)}"
    unknown = [(i, each) for i, each in enumerate(raw) if each not in known]
    if unknown:
        refuse(*(Problem(f"{shown(each)} {there_are}", path=(i,), near=(each, tuple(known))) for i, each in unknown))
    first, second = raw
    if first == second:
        refuse(Problem("the same constraint twice; a rotation mixes two"))
    if known[first].dimension != known[second].dimension:
        refuse(Problem("constraints of different units cannot be rotated into each other"))
    return first, second


def _seed(raw: object, info: ValidationInfo) -> int:  # noqa: ARG001  # the signature is pydantic's
    if isinstance(raw, bool) or not isinstance(raw, int) or not 0 <= raw <= LARGEST_SEED:
        refuse(Problem(f"a whole number between 0 and {LARGEST_SEED} was expected"))
    return raw


_SOME: Final[dict[str, Any]] = {**PER_NAME, "minProperties": 1}
_PAIR: Final[dict[str, Any]] = {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}
_SEED: Final[dict[str, Any]] = {"type": "integer", "minimum": 0, "maximum": LARGEST_SEED}
SomePositions = Annotated[dict[str, float], Checked(_positions, _SOME)]
SomeVelocities = Annotated[dict[str, float], Checked(_velocities, _SOME)]
SomeJointForces = Annotated[dict[str, float], Checked(_joint_forces, _SOME)]
Time = Annotated[float, quantity_in("s", least=0, most=LONGEST)]


class DisturbanceSpec(Section):
    """A generalised force: constant, or a step or pulse by `from` and `until`, or a sinusoid by `frequency`."""

    force: SomeJointForces = Field(description="joint forces; coordinates that are not named feel none")
    from_: Time = Field(0.0, alias="from", description="when it begins")
    until: Time | None = Field(None, description="when it ends; without it, not before the run does")
    frequency: Annotated[float, frequency_between(SLOWEST, FASTEST)] | None = Field(
        None, description="makes it swing: force * sin(2 pi f (t - from) + phase)"
    )
    phase: Annotated[float, quantity_in("rad", least=-100, most=100)] | None = Field(
        None, description="of the swing at its beginning"
    )

    @model_validator(mode="after")
    def _makes_sense(self) -> DisturbanceSpec:
        if self.until is not None and self.until <= self.from_:
            refuse(Problem(f"this ends at {self.until:g} s, and begins at {self.from_:g} s", path=("until",)))
        if self.phase is not None and self.frequency is None:
            refuse(Problem("a `phase` belongs to a `frequency`", path=("phase",)))
        return self


class StartSpec(Section):
    """Where the mechanism is let go; it is put onto the true surface, and its velocity along it."""

    q: Configuration | None = Field(None, description="a configuration, all coordinates")
    beside_q_d: SomePositions | None = Field(None, description="instead of `q`: how far each coordinate is off q_d")
    velocity: SomeVelocities | None = Field(None, description="velocities; coordinates that are not named rest")

    @model_validator(mode="after")
    def _one_place(self) -> StartSpec:
        if self.q is not None and self.beside_q_d is not None:
            refuse(Problem("give either `q` or `beside_q_d`, not both", path=("beside_q_d",), at_key=True))
        return self


class RotationSpec(Section):
    """The rotation R of Eq. (33): by an angle in the plane of two constraints, from the first to the second."""

    angle: Annotated[float, quantity_in("rad", least=-3.2, most=3.2)]
    constraints: Annotated[tuple[str, str], Checked(_pair, _PAIR)] = Field(description="two constraints of one unit")


class SurfaceSpec(Section):
    """Where the surface truly is."""

    offset: Annotated[dict[str, float], Checked(_offsets, _SOME)] | None = Field(
        None, description="Phi = Delta instead of 0, Eq. (28)"
    )
    rotation: RotationSpec | None = None
    tilt: Annotated[dict[str, dict[str, float]], Checked(_tilts, {"type": "object"})] | None = Field(
        None, description="what is added to rows of J: constraint -> coordinate -> change, as in `{wall: {q1: 5 mm}}`"
    )


class NoiseSpec(Section):
    """Standard deviations of white noise on what is measured at each sample."""

    position: Annotated[dict[str, float], POSITIONS.each(zero=True)] | None = Field(None, description="of the encoders")
    velocity: Annotated[dict[str, float], VELOCITIES.each(zero=True)] | None = Field(None, description="of velocities")
    force: Annotated[dict[str, float], MULTIPLIERS.each(zero=True)] | None = Field(None, description="of lambda")
    seed: Annotated[int, Checked(_seed, _SEED)] = Field(0, description="another seed draws other noise")


class ScenarioSpec(Section):
    """One run."""

    title: Text | None = Field(None, description="a line for the reader")
    duration: Annotated[float, quantity_in("s", least=1e-3, most=LONGEST)] | None = Field(
        None, description="how long is simulated; by default four times what the loop needs to settle"
    )
    controller: Literal[5, 11, 15, 17] = Field(17, description="the control law, by its equation's number")
    P_d: Annotated[Expression, expression_in("J")] | None = Field(
        None, description="the desired potential energy of controllers 5 and 11; its gradient at q_d must be f_d"
    )
    start: StartSpec = StartSpec.model_construct(q=None, beside_q_d=None, velocity=None)
    disturbances: tuple[DisturbanceSpec, ...] = Field((), max_length=MOST_DISTURBANCES)
    surface: SurfaceSpec = SurfaceSpec.model_construct(offset=None, rotation=None, tilt=None)
    parameters: Annotated[dict[str, float], Checked(_parameters, _SOME)] | None = Field(
        None, description="what the plant's parameters truly are; the controller keeps the model's"
    )
    gravity_error: SomeJointForces | None = Field(
        None, description="the controller's gravity term minus the true one, a constant"
    )
    limits: StrictBool = Field(True, description="whether the drives' `effort` limits hold")
    force_path: ForcePathSpec | None = Field(
        None, description="what lies between contact force and controller here; without it, the model's `force_path`"
    )
    ideal_force_path: StrictBool = Field(False, description="true: nothing lies between contact force and controller")
    noise: NoiseSpec | None = None

    @model_validator(mode="after")
    def _belongs_together(self) -> ScenarioSpec:
        if self.P_d is not None and self.controller not in (5, 11):
            refuse(Problem(f"`P_d` belongs to controllers 5 and 11, and this is {self.controller}", path=("P_d",)))
        if self.ideal_force_path and self.force_path is not None:
            refuse(
                Problem("an ideal force path, and another one; drop either", path=("ideal_force_path",), at_key=True)
            )
        return self


class ScenarioFileSpec(Section):
    """A file of scenarios for one model."""

    schema_: Literal["firmtouch.scenario/1"] = Field(
        "firmtouch.scenario/1", alias="schema", description="the file's format"
    )
    scenarios: dict[Label, ScenarioSpec] = Field(min_length=1, max_length=MOST_SCENARIOS)
    draw: DrawSpec | None = Field(None, description="what `firmtouch montecarlo` draws in each run")
