"""A configuration to start from, for a robot of which nothing is known but its file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import Array, frozen
from firmtouch.mechanics.tree import KinematicTree, frame_pose
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
