"""How long 5 s of a 3R closed loop take, against SciPy's Radau with the same equations as a Python callback.

Both integrate the very same CasADi function to a relative and absolute tolerance of 1e-8; Radau calls it from Python
with NumPy arrays, as a user would, and finds its Jacobian by differences, as it does when none is given. Our time is
that of all of `simulate`: the projected start, the integration, lambda and u at 400 instants and more, the resting place, and the
outcome. Setting the integrator up, once for a loop, is told beside it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from tests.benchmarks.measure import ROOT, Figure, best_of, seconds

import firmtouch
from firmtouch.simulation.dae import parameters_of
from firmtouch.simulation.run import build_simulator, simulate
from firmtouch.simulation.scenario import Feedback, Scenario, Start
from firmtouch.simulation.trajectory import Trajectory
from firmtouch.simulation.world import Disturbance, nominal_world

MODEL = ROOT / "models" / "planar_3r_circle.yaml"
DURATION, TOLERANCE, START = 5.0, 1e-8, 0.1
SHAKEN = Disturbance(np.array([2.0, -1.0, 0.5]), omega=6.0)
"""Keeps the loop moving; without it, it has come to rest after a second."""
REPETITIONS = 20
SAME = 1e-5
"""What the two may differ by at the end (rad): each keeps its own tolerance a step, of some hundred."""


@dataclass(frozen=True)
class Times:
    """Seconds: of building, of our run, and of Radau's, with how often Radau called the equations."""

    build: float
    ours: float
    radau: float
    calls: int


def measured(*push: Disturbance) -> Times:
    op = firmtouch.find_operating_point(firmtouch.derive_plant(firmtouch.read_model(MODEL).spec))
    loop = firmtouch.assign_poles(op, op.plant.spec.design)
    start = Start(op.q_d + START * loop.split.V2[:, 0], np.zeros(op.n))
    scenario = Scenario("speed", "Speed", Feedback(), start, nominal_world(op, *push), DURATION)
    build = best_of(3, lambda: build_simulator(loop, scenario, tolerance=TOLERANCE))
    simulator = build_simulator(loop, scenario, tolerance=TOLERANCE)
    runs: list[Trajectory] = []
    ours = best_of(REPETITIONS, lambda: runs.append(simulate(loop, scenario, simulator=simulator)))
    first, last = (np.concatenate([runs[-1].q[i], runs[-1].qdot[i]]) for i in (0, -1))
    rate, parameters = simulator.dae.rate, parameters_of(simulator.dae, scenario.world, t=0.0)
    found = []

    def radau() -> None:
        def callback(t, x):
            return rate(t, x, parameters).full().ravel()

        span = (0.0, DURATION)
        found.append(solve_ivp(callback, span, first, method="Radau", rtol=TOLERANCE, atol=TOLERANCE))

    radau_time = min(seconds(radau) for _ in range(2))
    assert found[-1].success
    assert np.abs(found[-1].y[:, -1] - last).max() < SAME
    return Times(build, ours, radau_time, found[-1].nfev)


def figures() -> list[Figure]:
    made = []
    for name, push in (("3R, 5 s: Radau / ours", ()), ("3R, 5 s, shaken: Radau / ours", (SHAKEN,))):
        times = measured(*push)
        detail = (
            f"{times.radau:.2f} s ({times.calls} calls) against {1e3 * times.ours:.1f} ms, warm; "
            f"{1e3 * times.build:.0f} ms to build, once"
        )
        made.append(Figure(name, times.radau / times.ours, ">=", 100, "", detail))
    return made
