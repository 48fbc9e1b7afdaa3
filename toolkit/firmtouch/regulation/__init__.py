"""Plant + regulation point -> `OperatingPoint` -> `ClosedLoop`: controllers, poles, steady-state errors."""

from firmtouch.regulation.closed_loop import ClosedLoop, Poles, Positivity, close_loop
from firmtouch.regulation.controllers import Controller, closed_loop_acceleration, control_law
from firmtouch.regulation.equilibrium import Equilibrium, NoEquilibriumError, closed_loop_equilibrium
from firmtouch.regulation.gains import Gains
from firmtouch.regulation.lyapunov import lyapunov
from firmtouch.regulation.operating_point import OperatingPoint, find_operating_point
from firmtouch.regulation.projection import project
from firmtouch.regulation.split import Split, split_directions
from firmtouch.regulation.state_space import state_space
from firmtouch.regulation.steady_state import SteadyState, SteadyStateError, steady_state_errors

__all__ = [
    "ClosedLoop",
    "Controller",
    "Equilibrium",
    "Gains",
    "NoEquilibriumError",
    "OperatingPoint",
    "Poles",
    "Positivity",
    "Split",
    "SteadyState",
    "SteadyStateError",
    "close_loop",
    "closed_loop_acceleration",
    "closed_loop_equilibrium",
    "control_law",
    "find_operating_point",
    "lyapunov",
    "project",
    "split_directions",
    "state_space",
    "steady_state_errors",
]
