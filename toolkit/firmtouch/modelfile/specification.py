"""A whole model file as one frozen value."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Final, Literal

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.modelfile.declarations import MOST_COORDINATES
from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import (
    EXPRESSION_SCHEMA,
    Checked,
    Expression,
    Label,
    NewName,
    Text,
    declared,
    new_name,
    read_all,
    read_expression,
    refuse,
)
from firmtouch.modelfile.sections.bounds import Bounds
from firmtouch.modelfile.sections.constraint import Constraint, Entry
from firmtouch.modelfile.sections.design import DesignSpec
from firmtouch.modelfile.sections.drawing import Drawing
from firmtouch.modelfile.sections.force_path import ForcePathSpec
from firmtouch.modelfile.sections.frames import RowOfFrames, SurfaceContact
from firmtouch.modelfile.sections.mechanism import Mechanism
from firmtouch.modelfile.sections.operating_point import OperatingPointSpec
from firmtouch.modelfile.sections.region import RegionSpec, UncertaintySpec
from firmtouch.modelfile.sections.section import Section, expressions_in
from firmtouch.modelfile.sections.variables import Coordinate, Parameter


def _definitions(raw: object, info: ValidationInfo) -> dict[str, Expression]:
    if not isinstance(raw, dict):
        refuse(Problem("names and their expressions were expected, as in `elbow: [l1*cos(q1), l1*sin(q1)]`"))
    known = declared(info)

    def read(name: str, each: object) -> Expression:
        new_name(name, known)
        return read_expression(each, known.above(name), sizes=(0, 2, 3))

    return read_all(raw.items(), read)


_DEFINITIONS: Final = {
    "type": "object",
    "additionalProperties": {
        "anyOf": [
            *EXPRESSION_SCHEMA["anyOf"],
            {"type": "array", "items": EXPRESSION_SCHEMA, "minItems": 2, "maxItems": 3},
        ]
    },
}


class ModelSpec(Section):
    """A mechanism, its constraints, a regulation point, and what is asked of the feedback there."""

    schema_: Literal["firmtouch.model/1"] = Field("firmtouch.model/1", alias="schema", description="the file's format")
    title: Text = Field(description="one line, the report's title")
    description: Text | None = Field(None, description="a few sentences for the report's reader")
    parameters: dict[NewName, Parameter] = Field({}, description="constants, each a quantity such as `l1: 0.6 m`")
    coordinates: dict[NewName, Coordinate] = Field(
        min_length=1, max_length=MOST_COORDINATES, description="the generalised coordinates q, in order"
    )
    definitions: Annotated[dict[str, Expression], Checked(_definitions, _DEFINITIONS)] = Field(
        {}, description="named intermediate expressions, scalars or vectors; each may use those above it"
    )
    mechanism: Mechanism = Field(
        description="`gravity` and `bodies`, or `kinetic_energy` and `potential_energy`, or a robot: `urdf`"
    )
    entries: dict[Label, Entry] = Field(
        alias="constraints", min_length=1, description="the constraints Phi(q) = 0, in order"
    )
    operating_point: OperatingPointSpec
    design: DesignSpec
    force_path: ForcePathSpec | None = Field(
        None, description="the force sensor, delays and sampling, which bound the force feedback"
    )
    bounds: Bounds = Bounds()
    drawing: Drawing | None = None

    @model_validator(mode="before")
    @classmethod
    def _joints_are_coordinates(cls, data: Any, info: ValidationInfo) -> Any:  # noqa: ANN401  # whatever the file holds
        joints = declared(info).joints
        if joints is None or not isinstance(data, dict):
            return data
        if "coordinates" in data:
            refuse(
                Problem("the robot's joints are the coordinates; leave this out", path=("coordinates",), at_key=True)
            )
        return {**data, "coordinates": dict(joints)}

    @model_validator(mode="after")
    def _fewer_constraints_than_coordinates(self) -> ModelSpec:
        n, m = self.n, self.m
        names = [row for entry, each in self.entries.items() for row in each.rows(entry)]
        twice = sorted({each for each in names if names.count(each) > 1})
        if twice:
            refuse(Problem(f"two constraints have the row `{twice[0]}`; rename one", path=("constraints",)))
        if m >= n:
            message = f"{m} constraints on {n} coordinates leave nothing to move; there must be fewer"
            if m > len(self.entries):
                message += " (`without: [...]` leaves out rows that a planar mechanism meets anyway)"
            refuse(Problem(message, path=("constraints",)))
        return self

    @model_validator(mode="after")
    def _across_has_a_direction(self) -> ModelSpec:
        """Refuse an `across` that nothing would use: without a `direction`, only a contact gives one."""
        reach = self.operating_point.reach
        if reach is None or reach.across is None or reach.direction is not None or reach.contact is not None:
            return self
        touching = [each.point for each in self.entries.values() if isinstance(each, SurfaceContact)]
        if reach.frame is not None and touching != [reach.frame]:
            path = ("operating_point", "reach", "across")
            refuse(Problem("`across` needs a `direction`: this frame is not the one contact's", path=path, at_key=True))
        return self

    @model_validator(mode="after")
    def _the_region_has_what_it_needs(self) -> ModelSpec:
        region = self.design.region
        problems = [] if region is None else [*self._missing_bounds(region), *self._uncertainty(region.uncertainty)]
        if problems:
            refuse(*problems)
        return self

    @model_validator(mode="after")
    def _the_force_feedback_can_be_chosen(self) -> ModelSpec:
        if self.design.force_feedback == "auto":
            reason = self._no_choice()
            if reason is not None:
                refuse(Problem(reason, path=("design", "force_feedback")))
        return self

    def _no_choice(self) -> str | None:
        """Say why no G_f is the largest one with the margins, if that is so."""
        path = self.force_path
        if path is None:
            return "`auto` needs `force_path`: without one, every G_f is stable and none is the largest"
        asked = path.margins
        if not path.bounded and (asked is None or asked.delay is None):
            return (
                "a low-pass alone bounds no G_f: give `force_path` a `delay` or a `sample`, or ask for a delay margin, "
                "or write a number"
            )
        if path.bandwidth is None and asked is not None and asked.gain is None and asked.modulus is None:
            return (
                "without a low-pass every stable G_f bears any further delay: ask for a `gain` or `modulus` margin too"
            )
        return None

    def _missing_bounds(self, region: RegionSpec) -> Iterator[Problem]:
        """Find the limits of steady-state errors whose causes are not bounded."""
        force = region.force_error
        needed: list[tuple[object, tuple[str, ...], str]] = [
            (region.position_error, ("position_error",), "disturbance"),
            (force and force.disturbance, ("force_error", "disturbance"), "disturbance"),
            (force and force.offset, ("force_error", "offset"), "offset"),
        ]
        for asked, path, bound in needed:
            if asked is not None and getattr(self.bounds, bound) is None:
                message = f"this needs `bounds: {bound}`, the cause of the error, which is not given"
                yield Problem(message, path=("design", "region", *path), at_key=True)
        shaped = region.structure.kind == "full" and self.design.normal_blocks.policy == "free"
        if "force_error" in region.objective and force is None and self.bounds.disturbance is None:
            message = "the objective `force_error` needs `force_error`, or `bounds: disturbance`"
            yield Problem(message, path=("design", "region", "objective", "force_error"), at_key=True)
        elif "force_error" in region.objective and self.design.method == "region" and not shaped:
            message = "the objective `force_error` chooses K12: it needs `structure: full` and `normal_blocks: free`"
            yield Problem(message, path=("design", "region", "objective", "force_error"), at_key=True)

    def _uncertainty(self, uncertain: UncertaintySpec | None) -> Iterator[Problem]:
        """Find parameters that cannot vary: without an interval, or in a constraint."""
        here = ("design", "region", "uncertainty")
        with_interval = [name for name, each in self.parameters.items() if each.interval is not None]
        named = None if uncertain is None else uncertain.parameters
        for i, name in enumerate(named or ()):
            if name not in with_interval:
                message = f"the parameter `{name}` has no `interval` over which it could vary"
                yield Problem(message, path=(*here, "parameters", i))
        if uncertain is not None and named is None and not with_interval and uncertain.lambda_d is None:
            message = "nothing varies here: no parameter has an `interval`, and there is no `lambda_d`"
            yield Problem(message, path=here, at_key=True)
        fixed = self._names_in_constraints()
        varying = [name for name in with_interval if named is None or name in named]
        others = ", ".join(name for name in varying if name not in fixed)
        for name in varying:
            if name in fixed:
                message = (
                    f"`{name}` is part of a constraint: q_d and the free directions would move with it, and a region "
                    f"design holds them fixed; drop the interval, or say in `region` what varies: "
                    f"`uncertainty: {{parameters: [{others}]}}`"
                )
                yield Problem(message, path=("parameters", name, "interval"))

    def _names_in_constraints(self) -> frozenset[str]:
        """Collect the names that the constraints use, themselves or through definitions."""
        names = frozenset[str]().union(*(each.names for each in expressions_in(self.entries)))
        for name, each in reversed(self.definitions.items()):  # a definition uses those above it
            if name in names:
                names |= each.names
        return names

    @property
    def constraints(self) -> dict[str, Constraint | RowOfFrames]:
        """The rows of Phi, in order."""
        return {name: row for entry, each in self.entries.items() for name, row in each.rows(entry).items()}

    def all_two_sided(self) -> ModelSpec:
        """Let every contact pull as well as push."""
        entries = {
            name: each.model_copy(update={"one_sided": False}) if hasattr(each, "one_sided") else each
            for name, each in self.entries.items()
        }
        return self.model_copy(update={"entries": entries})

    @property
    def n(self) -> int:
        """The number of coordinates."""
        return len(self.coordinates)

    @property
    def m(self) -> int:
        """The number of constraints."""
        return len(self.constraints)
