"""Sampled control, and what the sensors add to it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm, solve_discrete_lyapunov

from firmtouch.regulation.force_loop import ForcePath
from firmtouch.simulation.scenario import Feedback, Noise

T = 5e-3


def noisy(op, *, position=0.0, velocity=0.0, force=0.0, seed=0, sample=T):
    sigma = Noise(np.full(op.n, position), np.full(op.n, velocity), np.full(op.m, force), seed)
    return Feedback(path=ForcePath(sample=sample), noise=sigma)


def test_what_is_held_is_the_law_of_the_sample_before(shipped, run):
    """u is constant over each step, and is the law at its beginning with the force that was just before."""
    from firmtouch.regulation import control_law
    from firmtouch.regulation.controllers import Controller

    loop = shipped("planar_3r_circle")
    op, law = loop.operating_point, control_law(loop.operating_point, loop.gains, Controller.AFFINE_WITH_FORCE)
    done = run(loop, noisy(op), way=0.1, duration=0.1)
    begin, end = slice(0, None, 2), slice(1, None, 2)
    assert done.t[begin] == pytest.approx(T * np.arange(20), abs=1e-12)
    assert done.u[begin] == pytest.approx(done.u[end], abs=0)
    assert done.q[begin][1:] == pytest.approx(done.q[end][:-1], abs=0)
    for k in range(1, 20):
        expected = law(done.q[2 * k], done.qdot[2 * k], done.lambda_[2 * k - 1]).full().ravel()
        assert done.u[2 * k] == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("name", ["planar_2r_wall", pytest.param("planar_3r_circle", marks=pytest.mark.slow)])
def test_one_seed_one_run_and_no_noise_is_the_plain_run(shipped, run, name):
    loop = shipped(name)
    op, words = loop.operating_point, {"way": 0.02, "duration": 0.4}
    sensors = {"position": 1e-4, "velocity": 1e-3, "force": 0.5}
    one, same = (run(loop, noisy(op, **sensors, seed=7), **words) for _ in range(2))
    other, silent, plain = (
        run(loop, each, **words)
        for each in (noisy(op, **sensors, seed=8), noisy(op), Feedback(path=ForcePath(sample=T)))
    )
    assert one.q == pytest.approx(same.q, abs=0)
    assert one.u == pytest.approx(same.u, abs=0)
    assert np.abs(one.q - other.q).max() > 1e-6
    assert silent.q == pytest.approx(plain.q, abs=0)
    each_alone = [run(loop, noisy(op, **{key: value}, seed=7), **words) for key, value in sensors.items()]
    assert all(np.abs(each.u - plain.u).max() > 1e-2 for each in each_alone)


def settled(done):
    """Leave out the first second, in which the start dies out; the samples alone."""
    return done.t[::2] > 1.0


def test_the_variance_is_four_times_as_large_with_twice_the_noise(shipped, run):
    """With one seed it is the same noise, doubled: 4 up to what is nonlinear, a mrad of it."""
    loop = shipped("planar_2r_wall")
    op, variances = loop.operating_point, []
    for size in (1.0, 2.0):
        done = run(loop, noisy(op, position=1e-4 * size, velocity=1e-3 * size, seed=3), duration=3.0)
        variances.append(np.var((done.q[::2] @ loop.split.V2[:, 0])[settled(done)]))
    assert variances[1] / variances[0] == pytest.approx(4.0, rel=0.02)


@pytest.mark.parametrize("g", [pytest.param(0.3, marks=pytest.mark.slow), 0.8])
def test_the_force_wanders_as_its_own_loop_says(shipped, with_gains, run, g):
    """dlambda(k + 1) = -g (dlambda(k) + noise): variance g^2 sigma^2 / (1 - g^2), and the position does not see it."""
    loop = with_gains(shipped("planar_2r_wall"), G_f=np.eye(1) * g)
    op, sigma = loop.operating_point, 0.1
    done = run(loop, noisy(op, force=sigma, seed=5, sample=1e-3), duration=4.0)
    error = done.lambda_[::2, 0] - op.lambda_d[0]
    # 4000 samples, the correlation (-g)^k: the variance has a standard deviation of
    spread = np.sqrt(2 / error.size * (1 + g**2) / (1 - g**2))
    assert np.var(error) == pytest.approx(g**2 * sigma**2 / (1 - g**2), rel=4 * spread)
    assert np.abs(done.q - op.q_d).max() < 1e-7
    measured = np.corrcoef(error[1:], error[:-1])[0, 1]
    assert measured == pytest.approx(-g, abs=4 * np.sqrt((1 - g**2) / error.size))


@pytest.mark.slow
@pytest.mark.parametrize(
    "sensors", [{"position": 1e-4}, {"velocity": 2e-3}, {"position": 1e-4, "velocity": 1e-3}], ids=str
)
def test_the_variance_is_that_of_the_discrete_lyapunov_equation(shipped, run, sensors):
    """x2 under a held input, from Eq. (38)'s blocks alone: M22 x2'' + N22 x2 = -V2^T (W (dq + noise) + C (q' + noise))."""
    loop = shipped("planar_2r_wall")
    op, split, gains = loop.operating_point, loop.split, loop.gains
    V2 = split.V2
    M22, N22 = V2.T @ op.M @ V2, V2.T @ op.N0 @ V2
    plant = np.zeros((3, 3))
    plant[0, 1] = 1
    plant[1, 0], plant[1, 2] = (-np.linalg.solve(M22, N22)).item(), (1 / M22).item()
    step = expm(plant * T)
    A, B = step[:2, :2], step[:2, 2:]
    closed = A - B @ np.hstack([V2.T @ gains.W @ V2, V2.T @ gains.C @ V2])
    noise = np.hstack([V2.T @ gains.W * sensors.get("position", 0.0), V2.T @ gains.C * sensors.get("velocity", 0.0)])
    P = solve_discrete_lyapunov(closed, B @ noise @ noise.T @ B.T)
    done = run(loop, noisy(op, **sensors, seed=11), duration=120.0)
    x2 = ((done.q[::2] - op.q_d) @ V2[:, 0])[settled(done)]
    v2 = (done.qdot[::2] @ V2[:, 0])[settled(done)]
    # The correlation lasts about 1/6 + 1/8 s: 120 s hold about 400 independent ones, so 4 spreads are 4 sqrt(2 / 400)
    assert np.var(x2) == pytest.approx(P[0, 0], rel=0.28)
    assert np.var(v2) == pytest.approx(P[1, 1], rel=0.15)  # shorter correlation


@pytest.mark.parametrize("name", ["planar_2r_wall", pytest.param("planar_3r_circle", marks=pytest.mark.slow)])
def test_sampled_control_tends_to_the_continuous_one_with_order_one(shipped, run, name):
    loop, words = shipped(name), {"way": 0.1, "duration": 0.24}
    ideal = run(loop, **words).q[-1]
    errors = [
        np.abs(run(loop, Feedback(path=ForcePath(sample=h)), **words).q[-1] - ideal).max() for h in (4e-3, 2e-3, 1e-3)
    ]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders == pytest.approx([1.0, 1.0], abs=0.1)
    assert abs(orders[1] - 1) < abs(orders[0] - 1)  # and the nearer the truer


def test_limits_hold_for_what_is_sampled(shipped, run):
    loop = shipped("planar_2r_wall")
    limits = np.abs(loop.gains.bias) + 1.0
    done = run(loop, replace(noisy(loop.operating_point, velocity=0.5), limits=limits), way=0.1, duration=0.3)
    assert np.all(np.abs(done.u) <= limits)
    assert np.any(np.abs(done.u) == limits)
