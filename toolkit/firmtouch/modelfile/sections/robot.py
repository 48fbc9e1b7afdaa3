"""`mechanism` as a robot of a URDF file. Its joints are the coordinates."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Collection, Mapping
from typing import Annotated, Final, TypeVar

from pydantic import Field, ValidationInfo, model_validator

from firmtouch.errors import InputError, ModelFileError
from firmtouch.modelfile.declarations import MOST_COORDINATES
from firmtouch.modelfile.expression import Problem
from firmtouch.modelfile.fields import (
    QUANTITY_SCHEMA,
    AnyQuantity,
    Checked,
    Expression,
    Quantity,
    Range,
    constant_in,
    declared,
    expect_dimension,
    read_all,
    read_quantity,
    refuse,
    under,
    values_of,
)
from firmtouch.modelfile.fields.names import RESERVED
from firmtouch.modelfile.sections.joint_tree import Robot
from firmtouch.modelfile.sections.pose import LONGEST_FRAME, PoseSpec
from firmtouch.modelfile.sections.section import Section
from firmtouch.modelfile.sections.variables import Coordinate
from firmtouch.modelfile.units import parse_unit
from firmtouch.modelfile.urdf.inertial import ROUNDED
from firmtouch.modelfile.urdf.moving import Moving, MovingJoint, locked_positions, matters, select_moving
from firmtouch.modelfile.urdf.robot import EARTH, JointType, UrdfRobot
from firmtouch.modelfile.words import shown

LONGEST_NAME: Final = 32
PER_JOINT: Final = {"type": "object", "additionalProperties": QUANTITY_SCHEMA}
NOT_NEGATIVE: Final = Range(least=0)
T = TypeVar("T")


def _urdf(raw: object, info: ValidationInfo) -> UrdfRobot:
    attached = declared(info).attached
    if not isinstance(raw, str) or not raw.strip():
        refuse(Problem("the path of a URDF file was expected, such as `urdf/arm.urdf`"))
    if attached is None:
        refuse(Problem("this file stands alone here, so no other one can be read"))
    try:
        robot: UrdfRobot = attached(raw)
    except ModelFileError:
        raise  # mistakes in that file, at their places there
    except InputError as error:
        refuse(Problem(str(error)))
    return robot


def _link(raw: object) -> str:
    if not isinstance(raw, str) or not 0 < len(raw) <= LONGEST_FRAME:
        refuse(Problem("the name of a link was expected"))
    return raw


def _tools(raw: object, info: ValidationInfo) -> tuple[str, ...]:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, list):
        return (_link(raw),)
    if not raw:
        refuse(Problem("the name of a link was expected, or a list of them"))
    return tuple(read_all(enumerate(raw), lambda _, each: _link(each)).values())


def _locked(raw: object, info: ValidationInfo) -> dict[str, Quantity]:  # noqa: ARG001  # the signature is pydantic's
    if not isinstance(raw, dict):
        refuse(Problem("a position for each locked joint was expected, as in `{finger: 0.02 m}`"))
    return read_all(raw.items(), lambda _, each: read_quantity(each, example="0.02 m"))


def _rotors(raw: object, info: ValidationInfo) -> dict[str, Quantity]:  # noqa: ARG001
    if not isinstance(raw, dict):
        refuse(Problem("an inertia for each joint was expected, as in `{wrist_3: 0.06 kg*m^2}`"))
    return read_all(raw.items(), lambda _, each: read_quantity(each, example="0.06 kg*m^2"))


def _gravity(raw: object, info: ValidationInfo) -> tuple[float, float, float]:  # noqa: ARG001
    if not isinstance(raw, list) or len(raw) != 3:
        refuse(Problem("three accelerations were expected, as in `[0, 0, -9.81]`"))
    dimension = parse_unit("m/s^2").dimension
    x, y, z = read_all(enumerate(raw), lambda _, each: expect_dimension(read_quantity(each), dimension)).values()
    return x, y, z


class PayloadSpec(Section):
    """What a link of the robot carries."""

    frame: Annotated[str, Checked(lambda raw, _: _link(raw), {"type": "string"})] | None = Field(
        None, description="the link that carries it; without it, the tool"
    )
    mass: Annotated[Expression, constant_in("kg", within=NOT_NEGATIVE)] = Field(
        description="such as `1.5 kg`, or a parameter"
    )
    centre_of_mass: Annotated[Expression, constant_in("m", size=3)] | None = Field(
        None, description="in the frame's axes; without it, at its origin"
    )
    inertia: Annotated[Expression, constant_in("kg*m^2", size=3, within=NOT_NEGATIVE)] | None = Field(
        None, description="moments about its centre of mass along the frame's axes; without it, a point mass"
    )

    @model_validator(mode="after")
    def _some_body_has_these_moments(self) -> PayloadSpec:
        moments = None if self.inertia is None else values_of(self.inertia)
        if moments is not None and max(moments) > (1 + ROUNDED) * (sum(moments) - max(moments)):
            message = f"no body has these moments: {max(moments):g} exceeds the sum of the others"
            refuse(Problem(message, path=("inertia",)))
        return self


class UrdfMechanism(Robot):
    """A robot of a URDF file."""

    urdf: Annotated[UrdfRobot, Checked(_urdf, {"type": "string"})] = Field(description="the file, relative to this one")
    tool: Annotated[tuple[str, ...], Checked(_tools, {"type": ["string", "array"]})] = Field(
        (), description="the link that touches, or a list of links; joints that do not matter for it are left out"
    )
    locked: Annotated[dict[str, Quantity], Checked(_locked, PER_JOINT)] = Field(
        {}, description="joints that do not move, each with its position"
    )
    base: PoseSpec | None = Field(None, description="where the robot's root link stands in the world")
    gravity: Annotated[tuple[float, float, float], Checked(_gravity, {"type": "array"})] = Field(
        EARTH, description="as a vector in the world; without it, 9.81 m/s^2 against z"
    )
    payload: PayloadSpec | None = Field(None, description="what the tool carries")
    rotors: Annotated[dict[str, Quantity], Checked(_rotors, PER_JOINT)] = Field(
        {},
        description="inertia that joints feel of their motors, which a URDF does not hold: a rotor's times its "
        "gear's ratio squared, such as `{wrist_3: 0.06 kg*m^2}`",
    )

    @model_validator(mode="after")
    def _something_moves(self) -> UrdfMechanism:
        with under("locked"):
            read_all(self.locked.items(), self._check_locked)
        stopped = locked_positions(self.urdf, self.positions())
        with under("tool"):
            read_all(enumerate(self.tool), lambda _, each: _asked(lambda: matters(self.urdf, stopped, (each,))))
        moving = _asked(self.moving)
        if len(moving.leaders) > MOST_COORDINATES:
            message = f"{len(moving.leaders)} joints move, and at most {MOST_COORDINATES} are read"
            refuse(Problem(f"{message}: name the `tool`, or lock some"))
        with under("rotors"):
            read_all(self.rotors.items(), lambda name, each: self._check_rotor(name, each, moving))
        if self.base is not None and any(each.names for each in self.base.expressions()):
            refuse(Problem("the robot's place is made of numbers alone, without parameters", path=("base",)))
        if self.payload is not None:
            with under("payload"):
                self._check_carrier(self.payload.frame, moving, stopped)
        return self

    def _check_rotor(self, name: str, inertia: Quantity, moving: Moving) -> None:
        joints = {each.name: each for each in moving.leaders}
        if name not in joints:
            refuse(Problem(f"{shown(name)} is no joint that moves by itself", at_key=True, near=(name, tuple(joints))))
        unit = "kg" if joints[name].type is JointType.PRISMATIC else "kg*m^2"
        if expect_dimension(inertia, parse_unit(unit).dimension) < 0:
            refuse(Problem("an inertia must not be negative"))

    def _check_locked(self, name: str, position: Quantity) -> None:
        joint = self.urdf.joints.get(name)
        if joint is not None:
            expect_dimension(position, parse_unit("m" if joint.type is JointType.PRISMATIC else "rad").dimension)
        _asked(lambda: locked_positions(self.urdf, {name: position.value}))

    def _check_carrier(self, frame: str | None, moving: Moving, stopped: Mapping[str, float]) -> None:
        if frame is None and len(set(self.tool)) != 1:
            refuse(Problem("which link carries it? Give its `frame`"))
        if frame is not None and frame not in moving.links:
            message = f"the robot carries no link {shown(frame)}"
            refuse(Problem(message, path=("frame",), near=(frame, moving.links)))
        if frame is not None:
            try:
                matters(self.urdf, stopped, (frame,))
            except InputError:
                refuse(Problem(f"the payload is fixed to {shown(frame)}, which does not move", path=("frame",)))

    def positions(self) -> dict[str, float]:
        """Give the locked joints' positions."""
        return {name: each.value for name, each in self.locked.items()}

    def rotor_inertias(self) -> tuple[float, ...]:
        """Give what each coordinate feels of its motor, in kg m^2 or kg."""
        known = {name: each.value for name, each in self.rotors.items()}
        return tuple(known.get(each.name, 0.0) for each in self.moving().coordinates())

    def moving(self) -> Moving:
        """Select the joints that move."""
        return select_moving(self.urdf, tools=self.tool, locked=self.positions())

    def coordinates(self) -> dict[str, Coordinate]:
        """Give the independent joints that move."""
        return coordinates_of(self.moving())

    def frames(self) -> tuple[str, ...]:
        """Give the links that stand still or that the moving joints carry."""
        return self.moving().links

    def tools(self) -> tuple[str, ...]:
        """Give the tools, as named."""
        return tuple(dict.fromkeys(self.tool))


def coordinates_of(moving: Moving) -> dict[str, Coordinate]:
    """Give the independent joints as coordinates, under their own names where expressions can use these."""
    joints = moving.coordinates()
    as_they_are = {each.name for each in joints if each.name == _usable(each.name, ())}
    found: dict[str, Coordinate] = {}
    for each in joints:
        name = each.name if each.name in as_they_are else _usable(each.name, as_they_are | found.keys())
        found[name] = _coordinate(each)
    return found


def _asked(question: Callable[[], T]) -> T:
    """Report at this place what cannot be."""
    try:
        return question()
    except ModelFileError:
        raise  # a mistake in the robot's own file
    except InputError as error:
        refuse(Problem(str(error)))


def _usable(name: str, taken: Collection[str]) -> str:
    """Make a joint's name one that expressions can use: letters, digits and `_`, 32 at most, not taken."""
    usable = re.sub(r"[^A-Za-z0-9_]", "_", name)
    usable = usable if re.match("[A-Za-z]", usable) and usable not in RESERVED else f"q_{usable}"
    choices = (f"{usable[: LONGEST_NAME - 4]}_{count}" for count in itertools.count(2))
    return next(each for each in itertools.chain([usable[:LONGEST_NAME]], choices) if each not in taken)


def _coordinate(joint: MovingJoint) -> Coordinate:
    """Give a joint's unit and bounds; a zero says that the file knows none."""
    unit, effort = ("rad", "N*m") if joint.revolves else ("m", "N")

    def quantity(value: float, unit_text: str) -> AnyQuantity:
        unit = parse_unit(unit_text)
        return Quantity(f"{value:g} {unit_text}", value, unit.dimension, bare=False)

    def bound(value: float, unit_text: str) -> AnyQuantity | None:
        return quantity(value, unit_text) if 0 < value < math.inf else None

    limited = math.isfinite(joint.lower) and math.isfinite(joint.upper)
    return Coordinate(
        unit=unit,
        effort=bound(joint.effort, effort),
        limits=(quantity(joint.lower, unit), quantity(joint.upper, unit)) if limited else None,
        velocity=bound(joint.velocity, f"{unit}/s"),
        label=None,
    )
