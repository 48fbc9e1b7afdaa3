"""A robot of a URDF file -> the tree that moves: links merged, joints locked, branches that do not matter left out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from firmtouch.errors import InputError
from firmtouch.mechanics.arrays import Array, Vector, frozen
from firmtouch.mechanics.tree.inertia import NOTHING, BodyInertia, body_inertia, symmetric_tensor
from firmtouch.mechanics.tree.kinematics import find_frame
from firmtouch.mechanics.tree.placement import Placement, placement, turn
from firmtouch.mechanics.tree.selection import locked_positions, matters
from firmtouch.mechanics.tree.tree import WORLD, Coordinate, Frame, KinematicTree, TreeJoint
from firmtouch.modelfile.urdf import JointType, Link, UrdfJoint, UrdfRobot
from firmtouch.modelfile.urdf.inertial import no_body
from firmtouch.modelfile.words import shown

EARTH: Final = (0.0, 0.0, -9.81)
"""Gravity where z points up, m/s^2."""
MOST_JOINTS: Final = 100
"""Twice what a humanoid has; the expressions of M grow with the square of it."""
THINNEST: Final = 1e-6
"""Metres: a radius of gyration below this is that of a point mass, and rounding."""


@dataclass(frozen=True, slots=True)
class Payload:
    """What an arm carries: mass (kg), centre of mass (3, m), inertia about that (3 x 3, kg m^2), in a link's frame."""

    frame: str
    mass: float
    centre_of_mass: Array = field(default_factory=lambda: frozen(np.zeros(3)))
    inertia: Array = field(default_factory=lambda: frozen(np.zeros((3, 3))))


def build_tree(
    robot: UrdfRobot,
    *,
    tool: str | None = None,
    locked: Mapping[str, float] | None = None,
    payload: Payload | None = None,
    base: Placement | None = None,
    gravity: Vector = EARTH,
) -> KinematicTree:
    """Build the tree of what moves.

    `tool` is a link: branches that neither carry it nor load the joints that do are left out. `locked` gives positions
    (rad or m) to joints that do not move; `base` places the root link in the world; `gravity` (3, m/s^2) is in the
    world's axes.

    Raises
    ------
    InputError
        If a name is unknown, the tool or the payload does not move, too many joints do, or a number is not possible.
    ModelFileError
        If a link that moves has no inertia in the file, or a joint cannot move within all bounds.
    """
    stopped = locked_positions(robot, locked or {})
    kept = matters(robot, stopped, tool)
    growth = _Growth(robot, placement() if base is None else base)
    for joint in robot.joints.values():
        if joint.parent not in growth.frames:
            continue
        if joint.type is JointType.FIXED or joint.name in stopped:
            growth.fix(joint, stopped.get(joint.name, 0.0))
        elif joint.name in kept:
            growth.move(joint)
    if not growth.moving:
        raise InputError("no joint is left that could move")
    if len(growth.moving) > MOST_JOINTS:
        raise InputError(
            f"{len(growth.moving)} joints move; at most {MOST_JOINTS} are taken: lock some, or name the tool"
        )
    growth.check_described()
    tree = KinematicTree(
        growth.coordinates(), growth.joints(), growth.frames, tool, _finite(gravity, "the gravity", (3,))
    )
    if payload is not None:
        tree = _load(tree, payload)
    _check_masses(tree, robot)
    return tree


class _Growth:
    """What has been built so far, joint by joint from the root on."""

    def __init__(self, robot: UrdfRobot, base: Placement) -> None:
        self._robot = robot
        self.frames = {robot.root: Frame(WORLD, base)}
        self.moving: list[UrdfJoint] = []
        self._bodies: list[BodyInertia] = []
        self._described: list[bool] = []

    def fix(self, joint: UrdfJoint, position: float) -> None:
        """Merge a link with what carries it."""
        frame = self.frames[joint.parent]
        axis = frozen(joint.axis)
        motion = placement(axis * position) if joint.type is JointType.PRISMATIC else placement()
        if joint.type in (JointType.REVOLUTE, JointType.CONTINUOUS):
            motion = replace(motion, R=turn(axis, position))
        place = frame.placement @ placement(joint.pose.xyz, joint.pose.rpy) @ motion
        self.frames[joint.child] = Frame(frame.body, place)
        if frame.body != WORLD:
            self._add(self._robot.links[joint.child], frame.body, place)

    def move(self, joint: UrdfJoint) -> None:
        """Begin a new body."""
        self.moving.append(joint)
        self._bodies.append(NOTHING)
        self._described.append(False)
        body = len(self.moving) - 1
        self.frames[joint.child] = Frame(body, placement())
        self._add(self._robot.links[joint.child], body, placement())

    def _add(self, link: Link, body: int, place: Placement) -> None:
        if link.inertial is None:
            return
        self._described[body] = True
        pose, tensor = link.inertial.pose, symmetric_tensor(link.inertial.inertia)
        self._bodies[body] += body_inertia(link.inertial.mass, tensor, place @ placement(pose.xyz, pose.rpy))

    def check_described(self) -> None:
        """Refuse links that move while the file does not say what they weigh."""
        for joint, described in zip(self.moving, self._described, strict=True):
            if not described:
                message = (
                    f"link {shown(joint.child)} moves with joint {shown(joint.name)}, and neither it nor what is fixed "
                    "to it has an `<inertial>`; lock the joint, or write the inertia (zeros for a massless link)"
                )
                raise self._robot.mistake(message, self._robot.links[joint.child])

    def joints(self) -> tuple[TreeJoint, ...]:
        """Give the joints, those that follow others with the coordinate of these."""
        number = {each.name: i for i, each in enumerate(self._leaders())}
        found = []
        for joint, body in zip(self.moving, self._bodies, strict=True):
            parent, mimic = self.frames[joint.parent], joint.mimic
            found.append(
                TreeJoint(
                    joint.name,
                    parent.body,
                    parent.placement @ placement(joint.pose.xyz, joint.pose.rpy),
                    joint.type is not JointType.PRISMATIC,
                    frozen(joint.axis),
                    number[mimic.joint if mimic else joint.name],
                    mimic.multiplier if mimic else 1.0,
                    mimic.offset if mimic else 0.0,
                    body,
                )
            )
        return tuple(found)

    def coordinates(self) -> tuple[Coordinate, ...]:
        """Give the independent joints with their bounds."""
        return tuple(self._coordinate(each) for each in self._leaders())

    def _leaders(self) -> list[UrdfJoint]:
        return [each for each in self.moving if each.mimic is None]

    def _coordinate(self, joint: UrdfJoint) -> Coordinate:
        lower, upper = joint.limits.lower, joint.limits.upper
        for other in self.moving:
            if other.mimic is None or other.mimic.joint != joint.name or other.mimic.multiplier == 0:
                continue
            ends = sorted(
                (end - other.mimic.offset) / other.mimic.multiplier for end in (other.limits.lower, other.limits.upper)
            )
            lower, upper = max(lower, ends[0]), min(upper, ends[1])
            if lower > upper:
                message = f"joint {shown(other.name)} follows {shown(joint.name)} and is never within its own limits"
                raise self._robot.mistake(message, other)
        revolves = joint.type is not JointType.PRISMATIC
        return Coordinate(joint.name, revolves, lower, upper, joint.limits.velocity, joint.limits.effort)


def _finite(values: Vector, what: str, shape: tuple[int, ...]) -> Array:
    array = frozen(values)
    if array.shape != shape or not np.all(np.isfinite(array)):
        size = " x ".join(map(str, shape))
        raise InputError(f"{what} must be {size} finite numbers, not {array.tolist()}")
    return array


def _load(tree: KinematicTree, payload: Payload) -> KinematicTree:
    frame = find_frame(tree, payload.frame)
    if frame.body == WORLD:
        raise InputError(f"the payload is fixed to {shown(payload.frame)}, which does not move")
    centre = _finite(payload.centre_of_mass, "the payload's centre of mass", (3,))
    tensor = _finite(payload.inertia, "the payload's inertia", (3, 3))
    if not (math.isfinite(payload.mass) and payload.mass >= 0):
        raise InputError(f"a payload of {payload.mass:g} kg")
    if not np.array_equal(tensor, tensor.T):
        raise InputError("the payload's inertia is not symmetric")
    ixx, ixy, ixz, iyy, iyz, izz = (float(tensor[i, j]) for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)))
    if tensor.any() and (wrong := no_body(payload.mass, (ixx, ixy, ixz, iyy, iyz, izz))):
        raise InputError(f"the payload {wrong}")
    added = body_inertia(payload.mass, tensor, frame.placement @ placement(centre))
    joints = list(tree.joints)
    joints[frame.body] = replace(joints[frame.body], inertia=joints[frame.body].inertia + added)
    return replace(tree, joints=tuple(joints))


def _check_masses(tree: KinematicTree, robot: UrdfRobot) -> None:
    """Refuse joints that carry no mass at all, or at the end of a branch only mass on their axis: M is singular."""
    carriers = {each.parent for each in tree.joints}
    for i, joint in enumerate(tree.joints):
        ends = joint.revolves and joint.inertia.mass > 0 and i not in carriers
        if ends and joint.axis @ joint.inertia.tensor @ joint.axis <= THINNEST**2 * joint.inertia.mass:
            message = f"joint {shown(joint.name)} turns nothing but point masses on its axis; give them an inertia"
            raise robot.mistake(message, robot.joints[joint.name])
    carried = [each.inertia.mass for each in tree.joints]
    for i, joint in reversed(list(enumerate(tree.joints))):
        if carried[i] == 0:
            raise robot.mistake(f"joint {shown(joint.name)} carries no mass", robot.joints[joint.name])
        if joint.parent != WORLD:
            carried[joint.parent] += carried[i]
