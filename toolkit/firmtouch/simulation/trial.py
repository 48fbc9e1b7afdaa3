"""A finished loop put through its usual scenarios, with what the linear theory says beside it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from firmtouch.regulation import ClosedLoop, SteadyState
from firmtouch.simulation.prediction import Prediction, predict
from firmtouch.simulation.run import TOLERANCE, Simulator, build_simulator, simulate
from firmtouch.simulation.scenario import Scenario
from firmtouch.simulation.steady import SimulatedSteadyState, simulate_steady_state
from firmtouch.simulation.trajectory import Trajectory
from firmtouch.simulation.usual import usual_scenarios


@dataclass(frozen=True, slots=True)
class Run:
    """A simulation and the linear prediction of the same scenario."""

    trajectory: Trajectory
    prediction: Prediction


@dataclass(frozen=True, slots=True)
class Trial:
    """The usual scenarios, and the table of steady-state errors as it is simulated."""

    runs: tuple[Run, ...]
    steady_state: SimulatedSteadyState


def try_out(loop: ClosedLoop, errors: SteadyState) -> Trial:
    """Simulate the usual scenarios and the table."""
    scenarios = usual_scenarios(loop, errors)
    simulator = build_simulator(loop, scenarios[0])
    shared = [each for each in scenarios if each.feedback is scenarios[0].feedback]
    others = [each for each in scenarios if each.feedback is not scenarios[0].feedback]
    runs = (*run_all(loop, shared, simulator), *run_all(loop, others))
    return Trial(runs, simulate_steady_state(loop, errors, simulator))


def run_all(
    loop: ClosedLoop,
    scenarios: Iterable[Scenario],
    simulator: Simulator | None = None,
    *,
    tolerance: float = TOLERANCE,
) -> tuple[Run, ...]:
    """Simulate scenarios and predict them; a `simulator`, with a tolerance of its own, must fit all of them."""
    return tuple(
        Run(simulate(loop, each, simulator=simulator, tolerance=tolerance), predict(loop, each)) for each in scenarios
    )
