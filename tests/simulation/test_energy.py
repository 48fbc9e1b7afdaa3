"""V of Eq. (9): kept without damping, and falling at the rate q'^T C q' with it."""

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from firmtouch.regulation.controllers import Controller
from firmtouch.simulation.dae import parameters_of
from firmtouch.simulation.scenario import Feedback
from firmtouch.simulation.world import nominal_world

MODELS = ["planar_2r_wall", pytest.param("planar_3r_circle", marks=pytest.mark.slow)]
LAWS = [Controller.AFFINE, Controller.ENERGY_WITH_FORCE]
FINEST = 1e-14  # with 1e-10 V changes by 1e-5 of itself in a minute


def lyapunov(loop, q, v):
    """V of Eq. (9) with P_d of Eq. (12), zero at the regulation point."""
    op, gains = loop.operating_point, loop.gains

    def potential(q):
        dq = q - op.q_d
        return op.plant.P(q) - gains.bias @ q + dq @ gains.W @ dq / 2 - op.plant.Phi(q) @ op.lambda_d

    return v @ op.plant.M(q) @ v / 2 + potential(q) - potential(op.q_d)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("controller", [LAWS[0], pytest.param(LAWS[1], marks=pytest.mark.slow)])
def test_without_damping_v_is_kept_to_1e_8_over_a_minute(shipped, with_gains, run, name, controller):
    loop = shipped(name)
    undamped = with_gains(loop, C=0 * loop.gains.C)
    done = run(undamped, Feedback(controller), way=0.05, duration=60.0, tolerance=FINEST)
    V = np.array([lyapunov(undamped, *each) for each in zip(done.q, done.qdot, strict=True)])
    assert np.abs(done.qdot[done.t > 55]).max() > 0.05
    assert V == pytest.approx(np.full(V.size, V[0]), rel=1e-8)


@pytest.mark.parametrize("name", MODELS)
@pytest.mark.parametrize("controller", LAWS)
def test_with_damping_v_falls_at_every_step_by_what_c_takes(shipped, run, name, controller):
    loop = shipped(name)
    done = run(loop, Feedback(controller), way=0.2, duration=1.0, tolerance=1e-12)
    V = np.array([lyapunov(loop, *each) for each in zip(done.q, done.qdot, strict=True)])
    assert np.all(np.diff(V) < 1e-11 * V[0])
    assert V[-1] < 1e-3 * V[0]
    taken = np.einsum("ki,ij,kj->k", done.qdot, loop.gains.C, done.qdot)
    once = np.concatenate([[True], np.diff(done.t) > 0])
    whole = make_interp_spline(done.t[once], taken[once], k=7).antiderivative()
    # 2.5 ms between instants, poles up to 16 rad/s: the spline errs by (0.04)^8, about 1e-11 of it
    assert V[once] + whole(done.t[once]) - whole(0.0) == pytest.approx(np.full(once.sum(), V[0]), rel=3e-9)


@pytest.mark.parametrize("controller", [*LAWS, Controller.AFFINE_WITH_FORCE, Controller.ENERGY])
def test_the_power_of_each_law_at_any_state_on_the_surface(loop, dae_of, controller, rng):
    """V' = -q'^T C q', and for (17) q'^T (J(q_d) - J(q))^T G_f (lambda - lambda_d) beside it."""
    from firmtouch.regulation import project

    op, gains = loop.operating_point, loop.gains
    dae = dae_of(loop, controller)
    q = project(op.plant, op.q_d + 0.1 * rng.normal(size=op.n)).q
    J, v = op.plant.J(q), rng.normal(size=op.n)
    v = v - np.linalg.lstsq(J, J @ v, rcond=None)[0]
    x, parameters = np.concatenate([q, v]), parameters_of(dae, nominal_world(op), t=0.0)
    rate = dae.rate(0.0, x, parameters).full().ravel()
    lambda_ = dae.outputs(0.0, x, parameters)[0].full().ravel()
    h = 1e-5
    slope = (lyapunov(loop, *np.split(x + h * rate, 2)) - lyapunov(loop, *np.split(x - h * rate, 2))) / (2 * h)
    power = -v @ gains.C @ v
    if controller is Controller.AFFINE_WITH_FORCE:
        power += v @ (op.J - J).T @ gains.G_f @ (lambda_ - op.lambda_d)
    # second differences: h^2 = 1e-10 of V''', which has accelerations squared in it
    assert slope == pytest.approx(power, abs=1e-5 * (1 + np.abs(rate).max()))
