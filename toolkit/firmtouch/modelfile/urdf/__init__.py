"""URDF, the robot description format: a file -> a checked `UrdfRobot`, mistakes at `file:line:column`."""

from firmtouch.modelfile.urdf.moving import Moving, MovingJoint, select_moving
from firmtouch.modelfile.urdf.read import parse_urdf, read_urdf
from firmtouch.modelfile.urdf.robot import EARTH, Inertial, JointType, Limits, Link, Mimic, Pose, UrdfJoint, UrdfRobot

__all__ = [
    "EARTH",
    "Inertial",
    "JointType",
    "Limits",
    "Link",
    "Mimic",
    "Moving",
    "MovingJoint",
    "Pose",
    "UrdfJoint",
    "UrdfRobot",
    "parse_urdf",
    "read_urdf",
    "select_moving",
]
