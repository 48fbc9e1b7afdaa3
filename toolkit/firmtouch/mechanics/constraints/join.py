"""Two frames of a robot that are joined: a closed chain."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.arm import Arm
from firmtouch.mechanics.constraints.turns import turns
from firmtouch.modelfile.sections.frames import Join


def join_rows(entry: Join, arm: Arm) -> list[ca.SX]:
    """Give the gap from the first frame to the second (m), then its turn (rad), along and about the first one's axes.

    So a multiplier is what the joint does to the second frame: forces in N and moments in N m in the first one's axes.
    """
    first, second = (arm.pose(each) for each in entry.join)
    gap = first.R.T @ (second.p - first.p)
    return [*ca.vertsplit(gap), *turns(first.R.T @ second.R, entry.hold)]
