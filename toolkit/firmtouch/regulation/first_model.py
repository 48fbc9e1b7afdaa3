"""A first model of a robot of which nothing is known but its file: its tool on a plane where the arm can move well."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.mechanics.tree import KinematicTree, frame_pose, grow_tree, placement
from firmtouch.modelfile.sections.robot import coordinates_of
from firmtouch.modelfile.template import robot_template
from firmtouch.modelfile.urdf import EARTH, UrdfRobot, select_moving
from firmtouch.regulation.inverse_kinematics.evaluation import Evaluation
from firmtouch.regulation.inverse_kinematics.reach import reach_of_tree

TRIES: Final = 400
DOWN: Final = 0.5
"""How much a tool that points upwards is worth, beside one that points down to a table."""


@dataclass(frozen=True, slots=True)
class Start:
    """A configuration q (n), and there a frame's origin (3, m) and its z axis (3)."""

    q: Array
    position: Array
    axis: Array


def first_robot_model(name: str, robot: UrdfRobot, place: str, *, tool: str | None = None) -> str:
    """Give the text of a model file; `place` is the robot's file as seen from it, `tool` a link (or the last one).

    Raises
    ------
    InputError
        If there is no such tool, or it does not move; a `ModelFileError` where the robot's file is to blame.
    """
    tool = tool or select_moving(robot).links[-1]
    moving = select_moving(robot, tools=(tool,))
    start, coordinates = comfortable_start(grow_tree(moving, placement(), EARTH), tool), coordinates_of(moving)
    return robot_template(
        name,
        urdf=place,
        tool=tool,
        guess=dict(zip(coordinates, start.q.tolist(), strict=True)),
        units={each: coordinate.unit for each, coordinate in coordinates.items()},
        point=start.position.tolist(),
        axis=start.axis.tolist(),
    )


def comfortable_start(tree: KinematicTree, frame: str) -> Start:
    """Find a configuration far from joint limits and singularities, with the frame's z axis rather downwards.

    Of some that fill the joints' ranges evenly, it is the one with the largest room (`Solution`), times a factor from
    `DOWN` to 1 by where the axis points.
    """
    q = ca.SX.sym("q", tree.n)
    p, R = frame_pose(tree, frame, q)
    pose = ca.Function("pose", [q], [ca.densify(p), ca.densify(R[:, 2])])
    at = Evaluation(reach_of_tree(tree, frame, p, q))

    def discomfort(here: Array) -> float:
        downwards = -float(pose(here)[1][2])
        return at.minus_log_room(here) - float(np.log(DOWN + (1 - DOWN) * (1 + downwards) / 2))

    best = min(at.starts(TRIES), key=discomfort)
    position, axis = (frozen(np.asarray(each.full()).ravel()) for each in pose(best))
    return Start(frozen(best), position, axis)
