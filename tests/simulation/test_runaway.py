"""Designs that do not hold: diverged, when, and as fast as the linear theory says; and starts of every size."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmtouch.regulation.controllers import Controller
from firmtouch.simulation.scenario import Feedback
from firmtouch.simulation.trajectory import Outcome


def spoiled(loop, with_gains, what):
    """Make K22 or C22 negative along the first mode, and give the pole that this brings to the right."""
    V2, gains = loop.split.V2, loop.gains
    e = V2[:, :1] @ V2[:, :1].T
    if what == "K":
        W = gains.W - e * (1.5 * (V2.T @ loop.K @ V2)[0, 0])
        bad = with_gains(loop, W=(W + W.T) / 2)
    else:
        bad = with_gains(loop, C=-gains.C / 4)
    return bad, max(bad.poles.reduced, key=lambda s: s.real)


CASES = [
    pytest.param("planar_2r_wall", "K", id="K of a 2R arm"),
    pytest.param("planar_2r_circle", "C", id="C of a 2R arm", marks=pytest.mark.slow),
    pytest.param("planar_3r_circle", "K", id="K of a 3R arm", marks=pytest.mark.slow),
    pytest.param("pendulum_rod", "C", id="C of a pendulum", marks=pytest.mark.slow),
    pytest.param("planar_3r_circle", "C", id="C of a 3R arm", marks=pytest.mark.slow),
]


@pytest.mark.parametrize(("name", "what"), CASES)
def test_an_unstable_design_diverges_and_a_smaller_start_takes_longer_by_the_logarithm(
    shipped, with_gains, run, name, what
):
    """Along the unstable eigenvector, exp(p T) smaller for a period T of it: all later is the same, T later."""
    loop, pole = spoiled(shipped(name), with_gains, what)
    op, V2 = loop.operating_point, loop.split.V2
    M22, C22, K22 = (V2.T @ X @ V2 for X in (op.M, loop.gains.C, loop.K))
    mode = np.linalg.svd(M22 * pole**2 + C22 * pole + K22)[2][-1].conj()
    assert pole.real > 0
    later = 2 * np.pi / abs(pole.imag) if pole.imag else 4 / pole.real
    times = []
    for size in (1e-5, 1e-5 * np.exp(-pole.real * later)):
        q, v = (size * V2 @ (mode * factor).real for factor in (1, pole))
        done = run(loop, q=op.q_d + q, qdot=v, duration=20.0, tolerance=1e-13)
        assert done.outcome is Outcome.DIVERGED
        assert f"diverged at {done.t[-1]:.4g} s" in done.reason
        assert done.t[-1] < 20.0
        assert np.all(np.isfinite(done.q))
        times.append(done.t[-1])
    # nonlinear from 1e-5 rad on: 1e-5 of it; the start's projection is second order
    assert times[1] - times[0] == pytest.approx(later, abs=1e-4 * later)
    assert times[0] > 0.5 * np.log(1e4) / pole.real


@pytest.mark.slow
@pytest.mark.parametrize("speed", [30.0, 300.0])
def test_a_stable_design_that_is_thrown_too_hard_ends_with_a_word(shipped, run, speed):
    done = run(shipped("planar_3r_circle"), qdot=np.array([speed, -speed, speed]), duration=3.0)
    assert done.outcome in (Outcome.DIVERGED, Outcome.STOPPED)
    assert f"{done.t[-1]:.4g}" in done.reason
    assert np.all(np.isfinite(done.q))


@pytest.mark.parametrize("name", ["planar_2r_circle", "pendulum_rod", "planar_3r_wall"])
def test_another_resting_place_is_told_apart(shipped, with_gains, run, name):
    """K22 < 0 at q_d, but W holds it further on: it rests, all forces in balance, and not where it should."""
    loop, _ = spoiled(shipped(name), with_gains, "K")
    op = loop.operating_point
    done = run(loop, way=1e-3, duration=20.0)
    assert done.outcome is Outcome.ELSEWHERE
    q, lambda_, u = done.q[-1], done.lambda_[-1], done.u[-1]
    assert np.abs(q - op.q_d).max() > 0.2
    assert u + op.plant.J(q).T @ lambda_ == pytest.approx(op.plant.P_q(q), abs=1e-2)  # ARRIVED speed, 1e-3, times C
    assert not done.outcome.good


SMALL = st.floats(-1, 1)


@settings(max_examples=12)
@given(
    name=st.sampled_from(["pendulum_rod", "planar_2r_circle", "planar_2r_wall", "planar_3r_circle", "planar_3r_wall"]),
    controller=st.sampled_from(Controller),
    start=st.lists(SMALL, min_size=6, max_size=6),
)
def test_small_starts_converge_as_all_poles_say(shipped, run, name, controller, start):
    loop = shipped(name)
    op, slowest = loop.operating_point, max(each.real for each in loop.poles.reduced)
    assert slowest < 0
    q, v = np.array(start[: op.n]), np.array(start[3 : 3 + op.n])
    done = run(loop, Feedback(controller), q=op.q_d + 0.03 * q, qdot=0.1 * v, duration=12 / -slowest)
    assert done.outcome is Outcome.CONVERGED
    # exp(-12) is 6e-6 of 0.03 rad and 0.1 rad/s over 4 1/s, a few times that where two poles meet
    assert np.abs(done.q[-1] - op.q_d).max() < 2e-5
    assert np.abs(done.Phi).max() < 1e-8


@settings(max_examples=5)
@given(seed=st.integers(0, 1000))
def test_small_motion_is_the_linear_one_up_to_second_order(shipped, run, seed):
    """x2 of Eq. (38), by the matrix exponential; the rest falls with the square of the start."""
    from scipy.linalg import expm

    loop = shipped("planar_3r_circle")
    op, V2 = loop.operating_point, loop.split.V2
    M22, C22, K22 = (V2.T @ X @ V2 for X in (op.M, loop.gains.C, loop.K))
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M22, K22), -np.linalg.solve(M22, C22)]])
    x, errors = np.random.default_rng(seed).normal(size=4) * [0.3, 0.3, 1, 1], []
    for size in (2e-2, 1e-2):
        done = run(loop, q=op.q_d + size * V2 @ x[:2], qdot=size * V2 @ x[2:], duration=0.15, tolerance=1e-12)
        linear = (expm(A * 0.15) @ x)[:2] * size
        errors.append(np.linalg.norm((done.q[-1] - op.q_d) @ V2 - linear))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.35)
