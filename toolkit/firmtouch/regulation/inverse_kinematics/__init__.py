"""What a tool shall meet -> `Reach` -> `Reached`: all configurations within the joints' limits that were found."""

from firmtouch.regulation.inverse_kinematics.errors import BeyondLimitsError, Miss, OutOfReachError
from firmtouch.regulation.inverse_kinematics.reach import Reach, pointed, reach_of_tree, turned
from firmtouch.regulation.inverse_kinematics.solution import Reached, Solution
from firmtouch.regulation.inverse_kinematics.solve import solve_reach

__all__ = [
    "BeyondLimitsError",
    "Miss",
    "OutOfReachError",
    "Reach",
    "Reached",
    "Solution",
    "pointed",
    "reach_of_tree",
    "solve_reach",
    "turned",
]
