"""Which joints of a robot move: not the locked ones, and only those that matter for the tool."""

from __future__ import annotations

import math
from collections.abc import Mapping

from firmtouch.errors import InputError
from firmtouch.modelfile.urdf import JointType, UrdfRobot
from firmtouch.modelfile.words import did_you_mean, listed, shown


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


def matters(robot: UrdfRobot, stopped: Mapping[str, float], tool: str | None) -> frozenset[str]:
    """Give the moving joints that matter for the tool, or all of them without one.

    What hangs at the same joint next to the ground is one mechanism with the tool; so is what follows, or is followed
    by, a joint of that. All else moves by itself.

    Raises
    ------
    InputError
        If the tool is no link, or does not move.
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
    if tool is None:
        return frozenset(moving)
    if tool not in robot.links:
        raise InputError(f"the tool {shown(tool)} is no link{did_you_mean(tool, robot.links)}")
    if tool not in first:
        raise InputError(f"the tool {shown(tool)} does not move: no joint between it and the ground is free")
    group, size = {first[tool]}, 0
    while len(group) > size:
        size = len(group)
        for name, at in moving.items():
            mimic = robot.joints[name].mimic
            if mimic is not None and {at, moving[mimic.joint]} & group:
                group |= {at, moving[mimic.joint]}
    return frozenset(name for name, at in moving.items() if at in group)
