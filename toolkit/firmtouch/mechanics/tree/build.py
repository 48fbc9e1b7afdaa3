"""A robot of a URDF file -> the tree that moves: links merged, joints locked, branches that do not matter left out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from firmtouch.errors import InputError
from firmtouch.mechanics.arrays import Array, Vector, frozen
from firmtouch.mechanics.tree.inertia import NOTHING, BodyInertia, body_inertia, symmetric_tensor
from firmtouch.mechanics.tree.placement import Placement, placement, turn
from firmtouch.mechanics.tree.tree import WORLD, Frame, KinematicTree, TreeJoint
from firmtouch.modelfile.urdf import EARTH, JointType, Link, Moving, UrdfJoint, UrdfRobot, select_moving
from firmtouch.modelfile.words import shown

MOST_JOINTS: Final = 100
"""Twice what a humanoid has; the expressions of M grow with the square of it."""
THINNEST: Final = 1e-6
"""Metres: a radius of gyration below this is that of a point mass, and rounding."""


def build_tree(
    robot: UrdfRobot,
    *,
    tool: str | None = None,
    locked: Mapping[str, float] | None = None,
    base: Placement | None = None,
    gravity: Vector = EARTH,
) -> KinematicTree:
    """Build the tree of what moves, or of what matters for a tool (a link).

    `locked` gives positions (rad or m) to joints that do not move; `base` places the root link in the world; `gravity`
    (3, m/s^2) is in the world's axes.

    Raises
    ------
    InputError
        If a name is unknown, the tool does not move, too many joints do, or a number is not possible.
    ModelFileError
        If a link that moves has no inertia in the file, or a joint cannot move within all bounds.
    """
    moving = select_moving(robot, tools=() if tool is None else (tool,), locked=locked)
    return grow_tree(moving, placement() if base is None else base, gravity)


def grow_tree(moving: Moving, base: Placement, gravity: Vector) -> KinematicTree:
    """Build the tree of joints that were selected already; see `build_tree`."""
    if len(moving.joints) > MOST_JOINTS:
        raise InputError(
            f"{len(moving.joints)} joints move; at most {MOST_JOINTS} are taken: lock some, or name the tool"
        )
    growth = _Growth(moving, base)
    free = {each.name for each in moving.joints}
    for joint in moving.robot.joints.values():
        if joint.name in free:
            growth.move(joint)
        elif joint.child in moving.links:
            growth.fix(joint, moving.stopped.get(joint.name, 0.0))
    growth.check_described()
    tree = KinematicTree(moving.coordinates(), growth.joints(), growth.frames, _finite(gravity, "the gravity", (3,)))
    _check_masses(tree, moving.robot)
    return tree


class _Growth:
    """What has been built so far, joint by joint from the root on."""

    def __init__(self, moving: Moving, base: Placement) -> None:
        self._moving, self._robot = moving, moving.robot
        self.frames = {self._robot.root: Frame(WORLD, base)}
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
        self._bodies.append(NOTHING)
        self._described.append(False)
        body = len(self._bodies) - 1
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
        for joint, described in zip(self._moving.joints, self._described, strict=True):
            if not described:
                message = (
                    f"link {shown(joint.child)} moves with joint {shown(joint.name)}, and neither it nor what is fixed "
                    "to it has an `<inertial>`; lock the joint, or write the inertia (zeros for a massless link)"
                )
                raise self._robot.mistake(message, self._robot.links[joint.child])

    def joints(self) -> tuple[TreeJoint, ...]:
        """Give the joints, those that follow others with the coordinate of these."""
        number = {each.name: i for i, each in enumerate(self._moving.leaders)}
        found = []
        for joint, body in zip(self._moving.joints, self._bodies, strict=True):
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


def _finite(values: Vector, what: str, shape: tuple[int, ...]) -> Array:
    array = frozen(values)
    if array.shape != shape or not np.all(np.isfinite(array)):
        size = " x ".join(map(str, shape))
        raise InputError(f"{what} must be {size} finite numbers, not {array.tolist()}")
    return array


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
