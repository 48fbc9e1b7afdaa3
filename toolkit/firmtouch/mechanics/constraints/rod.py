"""Two points of a robot at a fixed distance."""

from __future__ import annotations

import casadi as ca

from firmtouch.mechanics.arm import Arm
from firmtouch.modelfile.sections.frames import Rod


def rod_rows(entry: Rod, arm: Arm) -> list[ca.SX]:
    """Give |a - b| - L (m): its multiplier is the rod's compression (N)."""
    a, b = (arm.pose(each).p for each in entry.between)
    return [ca.norm_2(a - b) - arm.symbols.scalar(entry.distance)]
