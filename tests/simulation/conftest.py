"""Loops of the shipped models, short words for a run, and an integration that shares the plant alone with ours."""

import itertools
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import firmtouch
from firmtouch.regulation import control_law
from firmtouch.simulation.dae import Dae, derive_dae
from firmtouch.simulation.run import simulate
from firmtouch.simulation.scenario import Feedback, Scenario, Start
from firmtouch.simulation.start import true_surface
from firmtouch.simulation.trajectory import Trajectory
from firmtouch.simulation.world import nominal_world

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="session")
def shipped() -> Callable[[str], firmtouch.ClosedLoop]:
    """Give the loop of a shipped model by its name; its contacts hold the mechanism on both sides unless asked for."""

    @cache
    def get(name: str, *, one_sided: bool = False) -> firmtouch.ClosedLoop:
        spec = firmtouch.read_model(MODELS / f"{name}.yaml").spec
        if one_sided:
            assert any(each.one_sided for each in spec.constraints.values())
        else:
            spec = spec.all_two_sided()
        op = firmtouch.find_operating_point(firmtouch.derive_plant(spec))
        return firmtouch.assign_poles(op, op.plant.spec.design)

    return get


ROBOTS = {"panda_plane"}
"""One arm that is read from a URDF is enough: what is special of it ends with its plant."""
NAMES = sorted(
    {path.stem for path in MODELS.glob("*.yaml") if "urdf:" not in path.read_text(encoding="utf-8")} | ROBOTS
)
LARGE = {"spatial_6r_plane", "two_arms_bar", "spatial_3r_sphere", *ROBOTS}
"""Their equations alone take up to half a second to write out."""


@pytest.fixture(
    scope="session", params=[pytest.param(each, marks=pytest.mark.slow if each in LARGE else ()) for each in NAMES]
)
def loop(request, shipped) -> firmtouch.ClosedLoop:
    """Give the loop of each shipped model."""
    return shipped(request.param)


@pytest.fixture(scope="session")
def dae_of() -> Callable[..., Dae]:
    """Derive the equations of a loop under a controller, once."""

    @cache
    def get(key, controller) -> Dae:
        return derive_dae(loops[key], Feedback(controller))

    loops = {}

    def derive(loop, controller) -> Dae:
        loops[id(loop)] = loop  # kept, so that the key stays its own
        return get(id(loop), controller)

    return derive


@pytest.fixture(scope="session")
def with_gains() -> Callable[..., firmtouch.ClosedLoop]:
    """Give the loop with some of its gains replaced."""

    def change(loop: firmtouch.ClosedLoop, **gains) -> firmtouch.ClosedLoop:
        return firmtouch.close_loop(loop.operating_point, replace(loop.gains, **gains))

    return change


@pytest.fixture(scope="session")
def scenario() -> Callable[..., Scenario]:
    """Describe a run: let go at q (or `way` along the first free direction), in the model's own world by default."""

    def describe(loop, feedback=None, *, way=0.0, q=None, qdot=None, world=None, push=(), duration=1.0) -> Scenario:
        op = loop.operating_point
        q = op.q_d + way * loop.split.V2[:, 0] if q is None else q
        world = world or nominal_world(op)
        world = replace(world, disturbances=(*world.disturbances, *push))
        start = Start(q, np.zeros(op.n) if qdot is None else qdot)
        return Scenario("made", "made by a test", feedback or Feedback(), start, world, duration)

    return describe


@pytest.fixture(scope="session")
def run(scenario) -> Callable[..., Trajectory]:
    """Simulate what `scenario` describes."""

    def run(loop, feedback=None, *, tolerance=1e-10, **words) -> Trajectory:
        return simulate(loop, scenario(loop, feedback, **words), tolerance=tolerance)

    return run


@pytest.fixture(scope="session")
def acceleration() -> Callable[..., tuple[np.ndarray, np.ndarray]]:
    """Solve Eq. (4) with a world's constraints, twice differentiated and not stabilised, for q'' and lambda in NumPy."""

    def solve(loop, law, world, q, v, *, d):
        op, n, m = loop.operating_point, loop.operating_point.n, loop.operating_point.m
        plant, J = op.plant.with_parameters(world.p), true_surface(op, world).J(q)
        u_0 = law(q, v, np.zeros(m)).full().ravel()
        B = np.column_stack([law(q, v, unit).full().ravel() - u_0 for unit in np.eye(m)])
        matrix = np.block([[plant.M(q), -(J.T + B)], [J, np.zeros((m, m))]])
        right = np.concatenate([u_0 + world.bias_error + d - plant.theta(q, v), -world.R @ plant.Jdot_qdot(q, v)])
        found = np.linalg.solve(matrix, right)
        return found[:n], found[n:]

    return solve


@pytest.fixture(scope="session")
def reference(acceleration) -> Callable[..., SimpleNamespace]:
    """Integrate a scenario by DOP853 at 1e-12; `d(t)` must say again, in the test's words, what disturbs."""

    def integrate(loop, scenario, q, v, d=None, *, borders=()) -> SimpleNamespace:
        op, world, feedback = loop.operating_point, scenario.world, scenario.feedback
        n = op.n
        law = control_law(op, loop.gains, feedback.controller, P_d=feedback.P_d)
        d = d or (lambda t: np.zeros(n))

        def rate(t, x):
            return np.concatenate([x[n:], acceleration(loop, law, world, x[:n], x[n:], d=d(t))[0]])

        x, pieces, times = np.concatenate([q, v]), [], [0.0, *borders, scenario.duration]
        for begin, end in itertools.pairwise(times):
            # just inside the piece, so that a change at its border belongs to one side
            inside = slice(begin + 1e-12, end - 1e-12)
            piece = solve_ivp(
                lambda t, x, inside=inside: rate(min(max(t, inside.start), inside.stop), x),
                (begin, end), x, method="DOP853", rtol=1e-12, atol=1e-12, dense_output=True,
            )  # fmt: skip
            x = piece.y[:, -1]
            pieces.append((end, piece.sol))

        def state(t):
            return next(sol for end, sol in pieces if t <= end)(t)

        def lambda_(t):
            x = state(t)
            return acceleration(loop, law, world, x[:n], x[n:], d=d(t))[1]

        return SimpleNamespace(state=state, lambda_=lambda_, final=x)

    return integrate
