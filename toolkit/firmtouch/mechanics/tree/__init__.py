"""Arms as trees of joints: `UrdfRobot` -> `KinematicTree` -> M, theta, P, K, frames by recursion on CasADi symbols."""

from firmtouch.mechanics.tree.build import build_tree, grow_tree
from firmtouch.mechanics.tree.chain import planar_chain
from firmtouch.mechanics.tree.dynamics import inverse_dynamics, kinetic_energy, mass_matrix, potential_energy, theta
from firmtouch.mechanics.tree.inertia import SpatialInertia
from firmtouch.mechanics.tree.kinematics import frame_jacobian, frame_pose
from firmtouch.mechanics.tree.payload import loaded
from firmtouch.mechanics.tree.placement import Placement, placement
from firmtouch.mechanics.tree.tree import Frame, KinematicTree, TreeJoint

__all__ = [
    "Frame",
    "KinematicTree",
    "Placement",
    "SpatialInertia",
    "TreeJoint",
    "build_tree",
    "frame_jacobian",
    "frame_pose",
    "grow_tree",
    "inverse_dynamics",
    "kinetic_energy",
    "loaded",
    "mass_matrix",
    "placement",
    "planar_chain",
    "potential_energy",
    "theta",
]
