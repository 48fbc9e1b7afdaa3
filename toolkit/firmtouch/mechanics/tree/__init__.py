"""Arms as trees of joints: `UrdfRobot` -> `KinematicTree` -> M, theta, P, K, frames by recursion on CasADi symbols."""

from firmtouch.mechanics.tree.build import Payload, build_tree
from firmtouch.mechanics.tree.chain import planar_chain
from firmtouch.mechanics.tree.dynamics import inverse_dynamics, kinetic_energy, mass_matrix, potential_energy, theta
from firmtouch.mechanics.tree.inertia import SpatialInertia
from firmtouch.mechanics.tree.kinematics import frame_jacobian, frame_pose
from firmtouch.mechanics.tree.placement import Placement, placement
from firmtouch.mechanics.tree.tree import Coordinate, Frame, KinematicTree, TreeJoint

__all__ = [
    "Coordinate",
    "Frame",
    "KinematicTree",
    "Payload",
    "Placement",
    "SpatialInertia",
    "TreeJoint",
    "build_tree",
    "frame_jacobian",
    "frame_pose",
    "inverse_dynamics",
    "kinetic_energy",
    "mass_matrix",
    "placement",
    "planar_chain",
    "potential_energy",
    "theta",
]
