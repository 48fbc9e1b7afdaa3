"""MuJoCo as an oracle: the same mechanism, controller and surface in a simulator that shares nothing with ours.

It needs the optional extra `firmtouch[oracle]`.
"""

from firmtouch.oracle.agreement import Agreement, check_export, check_export_at_rest, compare_export
from firmtouch.oracle.compare import (
    Comparison,
    Difference,
    MotionComparison,
    compare_motion_with_mujoco,
    compare_with_mujoco,
)
from firmtouch.oracle.export import MujocoExport, export_mechanism
from firmtouch.oracle.library import MissingOracleError, NotExpressibleError
from firmtouch.oracle.run import NotSettledError, OracleMotion, OracleRest, move_in_mujoco, settle_in_mujoco
from firmtouch.oracle.stiffness import ContactStiffness
from firmtouch.oracle.surfaces import Ball, JointSum, Plane, Touch, find_touches

__all__ = [
    "Agreement",
    "Ball",
    "Comparison",
    "ContactStiffness",
    "Difference",
    "JointSum",
    "MissingOracleError",
    "MotionComparison",
    "MujocoExport",
    "NotExpressibleError",
    "NotSettledError",
    "OracleMotion",
    "OracleRest",
    "Plane",
    "Touch",
    "check_export",
    "check_export_at_rest",
    "compare_export",
    "compare_motion_with_mujoco",
    "compare_with_mujoco",
    "export_mechanism",
    "find_touches",
    "move_in_mujoco",
    "settle_in_mujoco",
]
