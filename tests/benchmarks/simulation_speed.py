"""How long 5 s of a 3R closed loop take, against SciPy's Radau with the same equations as a Python callback.

Both keep a relative and absolute tolerance of 1e-8. Radau finds its Jacobian by differences, as it does when none is
given. Its callback is one of two: NumPy's solution of Eq. (4) with the constraints (`closed_loop_acceleration`), or the
very CasADi function that we integrate, called with NumPy arrays: the least that Python can do. Our time is that of all
of `simulate`: the projected start, the integration, lambda and u at 250 instants and more, the resting place, and the
outcome. Setting the integrator up, once for a loop, is told beside it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from tests.benchmarks.measure import ROOT, Figure, best_of

import firmtouch
from firmtouch.mechanics import Array
from firmtouch.regulation import closed_loop_acceleration, control_law
from firmtouch.regulation.controllers import Controller
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
BOUNDS = {
    ("3R, 5 s, shaken", "NumPy"): 100,
    ("3R, 5 s, shaken", "CasADi"): 30,
    ("3R, 5 s, to rest", "NumPy"): 30,
    ("3R, 5 s, to rest", "CasADi"): 5,
}
"""A loop at rest costs Radau next to nothing, and us the 250 instants that we look at."""
SAME = 1e-5
"""What the two may differ by at the end (rad): each keeps its own tolerance a step, of some hundred."""


def radau_time(rate: Callable[[float, Array], Array], first: Array, last: Array) -> tuple[float, int]:
    """Time Radau, best of two, check where it ends, and count its calls."""
    found = []

    def work() -> None:
        found.append(solve_ivp(rate, (0.0, DURATION), first, method="Radau", rtol=TOLERANCE, atol=TOLERANCE))

    time = best_of(2, work)
    assert found[-1].success
    assert np.abs(found[-1].y[:, -1] - last).max() < SAME
    return time, found[-1].nfev


def measured(name: str, *push: Disturbance) -> list[Figure]:
    """Measure one motion against both callbacks."""
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
    law = control_law(op, loop.gains, Controller.AFFINE_WITH_FORCE)

    def in_numpy(t: float, x: Array) -> Array:
        d = sum((each.d * np.sin(each.omega * t) for each in push), np.zeros(op.n))
        return np.concatenate([x[op.n :], closed_loop_acceleration(op, law, x[: op.n], x[op.n :], d=d)[0]])

    def in_casadi(t: float, x: Array) -> Array:
        return rate(t, x, parameters).full().ravel()

    made = []
    for callback, words in ((in_numpy, "NumPy"), (in_casadi, "CasADi")):
        radau, calls = radau_time(callback, first, last)
        detail = f"{radau:.2f} s ({calls} calls) against {1e3 * ours:.1f} ms, warm; {1e3 * build:.0f} ms to build, once"
        made.append(Figure(f"{name}: Radau ({words}) / ours", radau / ours, ">=", BOUNDS[name, words], "", detail))
    return made


def figures() -> list[Figure]:
    return [*measured("3R, 5 s, shaken", SHAKEN), *measured("3R, 5 s, to rest")]
