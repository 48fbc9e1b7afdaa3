"""[T8] in the nonlinear loop: just below its bound the force settles, just above it grows, at the rates of 1 + g L = 0."""

import cmath

import numpy as np
import pytest

from firmtouch.regulation.force_loop import ForcePath
from firmtouch.simulation.scenario import Feedback
from firmtouch.simulation.trajectory import Outcome
from firmtouch.simulation.world import Disturbance

MS = 1e-3


@pytest.fixture
def fed(shipped, with_gains):
    """Give a shipped loop with another force feedback."""
    return lambda name, g: with_gains(shipped(name), G_f=np.eye(1) * g)


def kicked(loop, run, path, *, duration, size=1.0):
    """Begin at rest with a force along the normal: it moves nothing, so that the loop of the force is all there is.

    Gives the run, its instants, and how far lambda is from its resting value.
    """
    op = loop.operating_point
    done = run(loop, Feedback(path=path), push=(Disturbance(op.J.T @ np.full(op.m, size)),), duration=duration)
    assert np.abs(done.q - op.q_d).max() < 1e-6
    return done, (done.lambda_ - done.rest.lambda_)[:, 0]


@pytest.mark.parametrize("name", ["planar_2r_wall", pytest.param("planar_3r_circle", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "g", [pytest.param(0.97, marks=pytest.mark.slow), 0.99, 1.01, pytest.param(1.03, marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("path", [ForcePath(delay=MS), ForcePath(sample=MS)], ids=["delay", "sample"])
def test_a_pure_delay_and_one_sample_multiply_the_force_by_minus_g_a_step(fed, run, name, g, path):
    loop = fed(name, g)
    done, error = kicked(loop, run, path, duration=0.1)
    each = error[::2] if path.sample else error[np.searchsorted(done.t, MS * (np.arange(99) + 0.5))]
    ratios = each[1:] / each[:-1]
    # the force is linear in itself while nothing moves: to the integrator's 1e-10 in q', times masses over a step
    assert ratios == pytest.approx(np.full(ratios.size, -g), abs=1e-6)


BELOW_AND_ABOVE = [0.99, 1.01]


@pytest.mark.parametrize("part", BELOW_AND_ABOVE)
def test_a_delay_of_1_ms_with_a_lag_of_2_ms_at_its_bound_of_3_80688(shipped, with_gains, run, part):
    g, tau, lag = 3.80688 * part, MS, 2 * MS
    s = 1836.597j  # solve (1 + s lag) exp(s tau) + g = 0 from the bound's frequency
    for _ in range(20):
        e = cmath.exp(s * tau)
        s -= ((1 + s * lag) * e + g) / ((lag + tau * (1 + s * lag)) * e)
    assert np.sign(s.real) == np.sign(part - 1)
    loop = with_gains(shipped("planar_2r_wall"), G_f=np.eye(1) * g)
    done, error = kicked(loop, run, ForcePath(delay=tau, lag=lag), duration=0.3)

    def amplitude(begin, end):
        chosen = (done.t >= begin) & (done.t <= end)
        t = done.t[chosen] - begin
        waves = np.exp(s.real * t)[:, None] * np.column_stack([np.cos(s.imag * t), np.sin(s.imag * t)])
        found = np.linalg.lstsq(waves, error[chosen], rcond=None)[0]
        assert waves @ found == pytest.approx(error[chosen], abs=1e-4 * np.hypot(*found))  # nothing else is left in it
        return np.hypot(*found)

    growth = np.log(amplitude(0.25, 0.28) / amplitude(0.15, 0.18)) / 0.1
    assert growth == pytest.approx(s.real, rel=1e-3)


@pytest.mark.parametrize("part", BELOW_AND_ABOVE)
@pytest.mark.parametrize("lag", [0.5 * MS, 2 * MS])
def test_a_sampled_loop_with_a_lag_at_its_bound(shipped, with_gains, run, part, lag):
    """L(z) = (1 - a) / (z - a): the root of 1 + g L is a - g (1 - a), and is -1 at g = (1 + a) / (1 - a)."""
    a = np.exp(-MS / lag)
    g = part * (1 + a) / (1 - a)
    loop = with_gains(shipped("planar_2r_wall"), G_f=np.eye(1) * g)
    _, error = kicked(loop, run, ForcePath(sample=MS, lag=lag), duration=0.1)
    ratios = error[2::2] / error[:-2:2]
    assert ratios == pytest.approx(np.full(ratios.size, a - g * (1 - a)), abs=1e-5)


@pytest.mark.parametrize("part", BELOW_AND_ABOVE)
@pytest.mark.parametrize("steps", [1, 2])
def test_a_sampled_loop_with_whole_steps_of_delay(shipped, with_gains, run, part, steps):
    """z^(1 + steps) = -g: every step's force is -g times that of 1 + steps before; the bound is 1."""
    loop = with_gains(shipped("planar_2r_wall"), G_f=np.eye(1) * part)
    _, error = kicked(loop, run, ForcePath(sample=MS, delay=steps * MS), duration=0.1)
    each = error[::2]
    assert each[1 + steps :] / each[: -1 - steps] == pytest.approx(np.full(each.size - 1 - steps, -part), abs=1e-6)


@pytest.mark.parametrize(("g", "outcome"), [(0.97, Outcome.CONVERGED), (1.03, Outcome.DIVERGED)])
@pytest.mark.parametrize(
    "path",
    [pytest.param(ForcePath(delay=5 * MS), marks=pytest.mark.slow), ForcePath(sample=5 * MS)],
    ids=["delay", "sample"],
)
def test_a_motion_with_a_delayed_force_converges_below_the_bound_and_diverges_above(fed, run, path, g, outcome):
    loop = fed("planar_2r_wall", g)
    done = run(loop, Feedback(path=path), way=0.05, duration=4.0)
    assert done.outcome is outcome
    if outcome is Outcome.CONVERGED:
        assert done.lambda_[-1] == pytest.approx(loop.operating_point.lambda_d, abs=1e-4)
    else:
        assert "contact force" in done.reason


def test_a_force_that_swings_for_ever_has_not_come_to_rest(shipped, with_gains, run):
    """At g = 1 exactly the position settles and the force does not."""
    loop = with_gains(shipped("planar_2r_wall"), G_f=np.eye(1))
    done = run(
        loop, Feedback(path=ForcePath(sample=MS)), push=(Disturbance(loop.operating_point.J.T @ [10.0]),), duration=1.0
    )
    assert np.abs(done.lambda_[-1] - done.rest.lambda_) == pytest.approx([5.0], rel=1e-3)
    assert done.outcome is Outcome.MOVING
    assert "contact force" in done.reason


def test_without_force_feedback_a_delay_of_the_force_does_nothing(shipped, with_gains, run):
    loop = with_gains(shipped("planar_2r_wall"), G_f=np.zeros((1, 1)))
    plain = run(loop, way=0.1, duration=0.5).q[-1]  # to some hundred times the tolerance, 1e-10
    for path in (ForcePath(delay=MS), ForcePath(lag=MS), ForcePath(delay=MS, lag=MS)):
        assert run(loop, Feedback(path=path), way=0.1, duration=0.5).q[-1] == pytest.approx(plain, abs=1e-7)


@pytest.mark.parametrize("kind", ["delay", "lag", "sample"])
def test_what_is_slow_in_the_force_path_becomes_ideal_with_order_one(shipped, run, kind, observed_order):
    """Delay, lag and sample time -> 0, measured in the position while it moves."""
    loop = shipped("planar_2r_wall")
    words = {"way": 0.2, "duration": 0.2}
    ideal = run(loop, **words)

    def error(size):
        slow = run(loop, Feedback(path=ForcePath(**{kind: size})), **words)
        assert slow.t[-1] == pytest.approx(0.2)
        return np.abs(slow.q[-1] - ideal.q[-1]).max()

    assert observed_order(error, 1e-3) == pytest.approx(1.0, abs=0.12)
    assert error(5e-4) < 1e-2


@pytest.mark.parametrize(
    "path",
    [
        ForcePath(lag=5 * MS),
        *(
            pytest.param(each, marks=pytest.mark.slow)
            for each in (ForcePath(delay=2 * MS), ForcePath(delay=MS, lag=2 * MS))
        ),
    ],
    ids=str,
)
def test_the_force_path_does_not_change_where_it_rests(shipped, run, path):
    loop, push = shipped("planar_2r_wall"), (Disturbance(np.array([0.5, -0.3])),)
    slow = run(loop, Feedback(path=path), way=0.1, push=push, duration=4.0)
    ideal = run(loop, way=0.1, push=push, duration=4.0)
    assert slow.q[-1] == pytest.approx(ideal.q[-1], abs=1e-8)
    assert slow.lambda_[-1] == pytest.approx(ideal.lambda_[-1], abs=1e-5)
    assert slow.rest.q == pytest.approx(ideal.rest.q, abs=1e-12)
