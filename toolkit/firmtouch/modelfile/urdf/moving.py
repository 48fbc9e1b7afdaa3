"""Which joints of a robot move: not the locked ones, and only those that matter for the tools; and their bounds."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from firmtouch.errors import InputError
from firmtouch.modelfile.urdf.robot import JointType, UrdfJoint, UrdfRobot
from firmtouch.modelfile.words import did_you_mean, listed, shown


@dataclass(frozen=True, slots=True)
class MovingJoint:
    """An independent joint's position: rad where it `revolves`, else m. Bounds as in the file, positions narrowed.

    `lower` and `upper` are such that the joints that follow this one also stay within theirs.
    """

    name: str
    revolves: bool
    lower: float
    upper: float
    velocity: float
    effort: float


@dataclass(frozen=True, slots=True)
class Moving:
    """What moves of a robot: `joints` in the robot's order, the others being fixed, locked (at `stopped`) or left out.

    `links` are those that stand still or that these joints carry.
    """

    robot: UrdfRobot
    stopped: Mapping[str, float]
    joints: tuple[UrdfJoint, ...]
    links: tuple[str, ...]

    @property
    def leaders(self) -> tuple[UrdfJoint, ...]:
        """The joints that follow no other: one coordinate each."""
        return tuple(each for each in self.joints if each.mimic is None)

    def coordinates(self) -> tuple[MovingJoint, ...]:
        """Give the independent joints with their bounds.

        Raises
        ------
        ModelFileError
            If a joint cannot move within all bounds.
        """
        return tuple(self._coordinate(each) for each in self.leaders)

    def _coordinate(self, joint: UrdfJoint) -> MovingJoint:
        lower, upper = joint.limits.lower, joint.limits.upper
        for other in self.joints:
            if other.mimic is None or other.mimic.joint != joint.name or other.mimic.multiplier == 0:
                continue
            ends = sorted(
                (end - other.mimic.offset) / other.mimic.multiplier for end in (other.limits.lower, other.limits.upper)
            )
            lower, upper = max(lower, ends[0]), min(upper, ends[1])
            if lower > upper:
                message = f"joint {shown(other.name)} follows {shown(joint.name)} and is never within its own limits"
                raise self.robot.mistake(message, other)
        revolves = joint.type is not JointType.PRISMATIC
        return MovingJoint(joint.name, revolves, lower, upper, joint.limits.velocity, joint.limits.effort)


def select_moving(robot: UrdfRobot, *, tools: Iterable[str] = (), locked: Mapping[str, float] | None = None) -> Moving:
    """Select the joints that move: all that are not locked, or, with tools (links), those that matter for them.

    Raises
    ------
    InputError
        If a name is unknown or cannot be locked, a position is out of bounds, or nothing is left that moves.
    """
    stopped = locked_positions(robot, locked or {})
    kept = matters(robot, stopped, tuple(tools))
    joints, links = [], [robot.root]
    for joint in robot.joints.values():
        if joint.parent not in links:
            continue
        if joint.name in kept:
            joints.append(joint)
        elif joint.type is not JointType.FIXED and joint.name not in stopped:
            continue
        links.append(joint.child)
    if not joints:
        raise InputError("no joint is left that could move")
    return Moving(robot, stopped, tuple(joints), tuple(links))


def locked_positions(robot: UrdfRobot, locked: Mapping[str, float]) -> dict[str, float]:
    """Give the position of every joint that does not move, with those that follow a locked one.

    Raises
    ------
    InputError
        If a joint is unknown or cannot be locked, or a position is outside of its bounds.
    """
    movable = {name: each for name, each in robot.joints.items() if each.type is not JointType.FIXED}
    for name, position in locked.items():
        joint = movable.get(name)
        if joint is None:
            choices = did_you_mean(name, movable) or f"; there are: {listed(movable)}"
            raise InputError(f"there is no joint {shown(name)} that could be locked{choices}")
        if joint.mimic is not None:
            raise InputError(f"joint {shown(name)} follows {shown(joint.mimic.joint)}: lock that one")
        if not (math.isfinite(position) and joint.limits.lower <= position <= joint.limits.upper):
            bounds = f"{joint.limits.lower:g} to {joint.limits.upper:g}"
            raise InputError(f"joint {shown(name)} is locked at {position:g}, outside of its bounds {bounds}")
    stopped = dict(locked)
    for name, joint in movable.items():
        if joint.mimic is not None and joint.mimic.joint in locked:
            stopped[name] = joint.mimic.multiplier * locked[joint.mimic.joint] + joint.mimic.offset
    return stopped


def matters(robot: UrdfRobot, stopped: Mapping[str, float], tools: tuple[str, ...]) -> frozenset[str]:
    """Give the moving joints that matter for the tools, or all of them without any.

    What hangs at the same joint next to the ground is one mechanism with the tool; so is what follows, or is followed
    by, a joint of that. All else moves by itself.

    Raises
    ------
    InputError
        If a tool is no link, or does not move.
    """
    first: dict[str, str] = {}  # of each link that moves, the joint next to the ground
    moving: dict[str, str] = {}  # of each joint that moves, the same
    for name, joint in robot.joints.items():
        moves = joint.type is not JointType.FIXED and name not in stopped
        at = first.get(joint.parent, name if moves else None)
        if at is not None:
            first[joint.child] = at
            if moves:
                moving[name] = at
    if not tools:
        return frozenset(moving)
    for tool in tools:
        if tool not in robot.links:
            raise InputError(f"the tool {shown(tool)} is no link{did_you_mean(tool, robot.links)}")
        if tool not in first:
            raise InputError(f"the tool {shown(tool)} does not move: no joint between it and the ground is free")
    group, size = {first[tool] for tool in tools}, 0
    while len(group) > size:
        size = len(group)
        for name, at in moving.items():
            mimic = robot.joints[name].mimic
            if mimic is not None and {at, moving[mimic.joint]} & group:
                group |= {at, moving[mimic.joint]}
    return frozenset(name for name, at in moving.items() if at in group)
