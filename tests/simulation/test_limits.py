"""Joint force limits: kept at every instant, with the algebraic loop solved as it then is, piecewise affine."""

import numpy as np
import pytest

from firmtouch.regulation import control_law
from firmtouch.regulation.controllers import Controller
from firmtouch.simulation.dae import derive_dae, parameters_of
from firmtouch.simulation.motion import HOLD
from firmtouch.simulation.scenario import Feedback
from firmtouch.simulation.trajectory import Outcome
from firmtouch.simulation.world import nominal_world

ASKED = 0.95
"""The part of random states, far from rest and with most drives at their limits, at which the loop must be solved."""
LAWS = [Controller.AFFINE_WITH_FORCE, Controller.ENERGY_WITH_FORCE]


@pytest.fixture
def fed(shipped, with_gains):
    """Give a shipped loop with another force feedback."""
    return lambda name, g: with_gains(shipped(name), G_f=g * np.eye(shipped(name).operating_point.m))


def tight(loop, over):
    """Limits that hold the regulation point with a reserve, as N m."""
    return np.abs(loop.gains.bias) + over


@pytest.mark.parametrize(
    "name",
    ["planar_2r_wall", *(pytest.param(each, marks=pytest.mark.slow) for each in ("planar_3r_circle", "two_arms_bar"))],
)
@pytest.mark.parametrize("controller", LAWS)
def test_limits_that_never_act_change_nothing(shipped, run, name, controller):
    loop = shipped(name)
    words = {"way": 0.1, "duration": 0.5}
    free = run(loop, Feedback(controller), **words)
    for limits in (np.full(loop.operating_point.n, 1e6), np.full(loop.operating_point.n, np.inf)):
        limited = run(loop, Feedback(controller, limits=limits), **words)
        # the same equations in another order of operations: the steps of the integrator may differ
        assert limited.q == pytest.approx(free.q, abs=1e-8)
        assert limited.u == pytest.approx(free.u, abs=1e-4)


# How far the start is, in rad, from where such limits let it come back.
@pytest.mark.parametrize(
    ("name", "way"), [("planar_2r_wall", 0.2), ("planar_3r_circle", 0.1), ("planar_3r_wall", 0.05)]
)
@pytest.mark.parametrize("controller", LAWS)
def test_limits_are_kept_the_loop_is_solved_and_the_constraints_hold(shipped, run, name, way, controller):
    loop = shipped(name)
    op, limits = loop.operating_point, tight(loop, 1.0)
    law = control_law(op, loop.gains, controller)
    assert np.trace(loop.gains.G_f) > 0
    done = run(loop, Feedback(controller, limits=limits), way=way, duration=1.0)
    assert np.all(np.abs(done.u) <= limits)
    acted = np.any(np.abs(done.u) == limits, axis=1)
    assert 0 < acted.sum() < acted.size
    assert np.abs(done.Phi).max() < 1e-8
    for q, v, lambda_, u in zip(*(each[::7] for each in (done.q, done.qdot, done.lambda_, done.u)), strict=True):
        plant = op.plant
        assert u == pytest.approx(np.clip(law(q, v, lambda_).full().ravel(), -limits, limits), abs=1e-9)
        # and this lambda is the one that u makes: the other half of the loop, in NumPy
        J = plant.J(q)
        drift = plant.Jdot_qdot(q, v) + 2 * HOLD * J @ v + HOLD**2 * plant.Phi(q)
        second = J @ np.linalg.solve(plant.M(q), u + J.T @ lambda_ - plant.theta(q, v)) + drift
        assert second == pytest.approx(np.zeros(op.m), abs=1e-9 * (1 + np.abs(u).max() + np.abs(lambda_).max()))


@pytest.mark.parametrize(("name", "way", "over"), [("planar_3r_circle", 0.1, 1.0), ("planar_3r_wall", 0.1, 2.0)])
def test_a_limited_drive_still_converges_and_later(shipped, run, name, way, over):
    loop = shipped(name)

    def arrival(limits):
        done = run(loop, Feedback(limits=limits), way=way, duration=3.0)
        assert done.outcome is Outcome.CONVERGED
        away = np.abs(done.q - loop.operating_point.q_d).max(axis=1)
        return done.t[np.flatnonzero(away > 1e-3)[-1]], done

    unlimited, _ = arrival(None)
    limited, done = arrival(tight(loop, over))
    assert np.any(np.abs(done.u) == tight(loop, over))
    assert limited > unlimited + 0.02


@pytest.mark.parametrize(
    "name",
    ["planar_2r_wall", "planar_3r_circle", "planar_3r_wall", pytest.param("two_arms_bar", marks=pytest.mark.slow)],
)
@pytest.mark.parametrize("controller", LAWS)
@pytest.mark.parametrize(
    "g", [0.8, pytest.param(3.0, marks=pytest.mark.slow), 30.0, pytest.param(1000.0, marks=pytest.mark.slow)]
)
def test_the_saturated_loop_is_solved_at_any_state_or_nothing_is_said(fed, rng, controller, name, g):
    """Phi'' + 2 a Phi' + a^2 Phi = 0 shows that lambda belongs to u, whichever drives are at their limits."""
    loop = fed(name, g)
    op, plant = loop.operating_point, loop.operating_point.plant
    limits, solved, acted, tries = tight(loop, 1.0), 0, 0, 60
    dae, world = derive_dae(loop, Feedback(controller, limits=limits)), nominal_world(loop.operating_point)
    parameters = parameters_of(dae, world, t=0.0)
    for _ in range(tries):
        q, v = op.q_d + 0.1 * rng.normal(size=op.n), rng.normal(size=op.n)
        x = np.concatenate([q, v])
        lambda_, u, _ = (each.full().ravel() for each in dae.outputs(0.0, x, parameters))
        found = dae.rate(0.0, x, parameters).full().ravel()[op.n :]
        if not np.all(np.isfinite(lambda_)):
            continue
        acted += bool(np.any(np.abs(u) == limits))
        J = plant.J(q)
        drift = plant.Jdot_qdot(q, v) + 2 * HOLD * J @ v + HOLD**2 * plant.Phi(q)
        size = 1 + np.abs(found).max() + np.abs(lambda_).max()
        assert J @ found == pytest.approx(-drift, abs=1e-8 * size)
        solved += 1
    assert acted > tries / 3
    assert solved >= ASKED * tries
