"""What a URDF file says of a robot's mechanics, in SI: frozen values that know the place where they were written."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from firmtouch.errors import Diagnostic, ModelFileError

Triple = tuple[float, float, float]
Place = tuple[int, int]
"""Line and column, both from one."""


EARTH = (0.0, 0.0, -9.81)
"""Gravity where z points up, m/s^2."""


class JointType(Enum):
    """The joints that are read; `floating` and `planar` are refused by name."""

    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    FIXED = "fixed"


@dataclass(frozen=True, slots=True)
class Pose:
    """A frame in another: its origin (metres), and roll, pitch, yaw (radians) with R = Rz(yaw) Ry(pitch) Rx(roll)."""

    xyz: Triple = (0.0, 0.0, 0.0)
    rpy: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass (kg), the centre of mass as the origin of `pose` in the link, and the inertia about it in that frame's axes.

    `inertia` is ixx, ixy, ixz, iyy, iyz, izz (kg m^2): the tensor's entries, so that ixy = -sum of m x y.
    A link with mass and inertia zero was written as massless; a link without an `Inertial` was not described.
    """

    pose: Pose
    mass: float
    inertia: tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body, or a bare frame."""

    name: str
    inertial: Inertial | None
    place: Place = field(compare=False)


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds of a joint: positions (rad or m; infinite where it turns freely), speed and effort as the file has them.

    Files that know no bound of speed or effort often write a zero there.
    """

    lower: float
    upper: float
    velocity: float
    effort: float


UNLIMITED = Limits(-float("inf"), float("inf"), float("inf"), float("inf"))


@dataclass(frozen=True, slots=True)
class Mimic:
    """q = multiplier * q_joint + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True)
class UrdfJoint:
    """How `child` moves in `parent`: at q = 0 as `pose` says; then about or along the unit vector `axis` of that frame.

    `damping` and `friction` are what the file says of losses, which Eqs. (1)-(4) do not have.
    """

    name: str
    type: JointType
    parent: str
    child: str
    pose: Pose
    axis: Triple
    limits: Limits
    mimic: Mimic | None
    damping: float
    friction: float
    place: Place = field(compare=False)


@dataclass(frozen=True, slots=True)
class UrdfRobot:
    """A tree of links: `joints` stand behind the joints that carry them; `root` is the one link that none carries."""

    name: str
    file: str
    root: str
    links: dict[str, Link]
    joints: dict[str, UrdfJoint]

    def mistake(self, message: str, *where: Link | UrdfJoint) -> ModelFileError:
        """Make the error of a mistake that was found later, told at each of these elements."""
        return ModelFileError(tuple(Diagnostic(self.file, *each.place, message) for each in where))
