"""Plant + gains -> trajectory: the nonlinear closed loop under the paper's controllers.

    usual_scenarios, scenarios_of -> Scenario -> simulate -> Trajectory
                                              -> predict  -> Prediction

`try_out` puts a loop through its usual scenarios and its table of steady-state errors.
"""

from firmtouch.simulation.from_file import drive_limits, scenarios_of, usual_duration
from firmtouch.simulation.prediction import Prediction, predict
from firmtouch.simulation.run import Simulator, build_simulator, simulate
from firmtouch.simulation.scenario import Feedback, Noise, Scenario, Start
from firmtouch.simulation.steady import SimulatedError, SimulatedSteadyState, simulate_steady_state
from firmtouch.simulation.trajectory import Outcome, Trajectory
from firmtouch.simulation.trial import Run, Trial, run_all, try_out
from firmtouch.simulation.usual import usual_scenarios
from firmtouch.simulation.world import Disturbance, World, nominal_world, tilted

__all__ = [
    "Disturbance",
    "Feedback",
    "Noise",
    "Outcome",
    "Prediction",
    "Run",
    "Scenario",
    "SimulatedError",
    "SimulatedSteadyState",
    "Simulator",
    "Start",
    "Trajectory",
    "Trial",
    "World",
    "build_simulator",
    "drive_limits",
    "nominal_world",
    "predict",
    "run_all",
    "scenarios_of",
    "simulate",
    "simulate_steady_state",
    "tilted",
    "try_out",
    "usual_duration",
    "usual_scenarios",
]
