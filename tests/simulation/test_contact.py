"""Loss of contact: a one-sided surface cannot pull, and the run ends when it would have to."""

import numpy as np
import pytest
from scipy.optimize import brentq

from firmtouch.regulation.force_loop import ForcePath
from firmtouch.simulation.ending import lost_contact
from firmtouch.simulation.samples import Samples
from firmtouch.simulation.scenario import Feedback
from firmtouch.simulation.trajectory import Outcome
from firmtouch.simulation.world import Disturbance, nominal_world

TIMELY = 1e-4  # s: what is asked for


@pytest.fixture
def wall(shipped):
    return shipped("planar_2r_wall", one_sided=True)


@pytest.fixture
def crossing_of(reference, scenario):
    """Find the first root of lambda within 2 s on the dense output of DOP853."""

    def find(loop, done, d):
        other = reference(loop, scenario(loop, duration=2.0), done.q[0], done.qdot[0], d)
        t = np.linspace(0, 2, 501)
        forces = np.array([other.lambda_(each)[0] for each in t])
        i = int(np.argmax(forces < 0))
        assert i > 0
        return brentq(lambda t: other.lambda_(t)[0], t[i - 1], t[i])

    return find


def pulling(op, force, omega, *, aside=1.0):
    """Pull the tip off and shake it along the wall too."""
    d = op.J.T @ [force] + aside * np.array([0.3, 1.0])
    return (Disturbance(d, omega=omega),), lambda t: d * np.sin(omega * t)


@pytest.mark.parametrize("duration", [2.0, pytest.param(60.0, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "pull", [(120.0, 0.8), *(pytest.param(each, marks=pytest.mark.slow) for each in ((90.0, 4.0), (95.0, 11.0)))]
)
def test_contact_is_lost_when_lambda_crosses_zero(wall, run, crossing_of, duration, pull):
    op = wall.operating_point
    push, d = pulling(op, *pull)
    done = run(wall, way=0.05, push=push, duration=duration)
    crossing = crossing_of(wall, done, d)
    assert done.outcome is Outcome.CONTACT_LOST
    assert done.t[-1] == pytest.approx(crossing, abs=TIMELY)
    assert "`wall`" in done.reason
    assert f"{done.t[-1]:.4g}" in done.reason
    assert done.lambda_[-1, 0] < 0
    assert np.all(done.lambda_[:-1] >= 0)
    assert np.all(np.diff(done.t) >= 0)


def test_two_sided_contact_goes_on(shipped, run):
    loop = shipped("planar_2r_wall")
    done = run(loop, push=pulling(loop.operating_point, 90.0, 4.0)[0], duration=2.0)
    assert done.lambda_.min() < -5
    assert done.outcome.good
    assert done.t[-1] == 2.0


def test_a_step_that_pulls_it_off_ends_the_run_at_the_step(wall, run):
    op, g = wall.operating_point, wall.gains.G_f[0, 0]
    enough = 40.0 * (1 + g)
    lost = run(wall, push=(Disturbance(op.J.T @ [1.001 * enough], start=0.3),), duration=1.0)
    assert lost.outcome is Outcome.CONTACT_LOST
    assert lost.t[-1] == pytest.approx(0.3, abs=1e-9)
    kept = run(wall, push=(Disturbance(op.J.T @ [0.999 * enough], start=0.3),), duration=1.0)
    assert kept.outcome is Outcome.CONVERGED
    assert 0 < kept.lambda_[-1, 0] < 0.05


@pytest.mark.parametrize("duration", [1.0, 20.0])
@pytest.mark.parametrize("omega", [40.0, 2 * np.pi * 400 / 20, 200.0])
def test_a_short_dip_between_the_kept_instants_is_found(wall, run, omega, duration):
    """lambda = 40 - a sin(w t), with its least value 0.1 N under or over zero: the dip is shorter than a step.

    With w = 2 pi 20 / s the kept instants of 20 s, if there were 400, would all see the same phase.
    """
    op, g = wall.operating_point, wall.gains.G_f[0, 0]
    for least, outcome in ((-0.1, Outcome.CONTACT_LOST), (0.1, Outcome.CONVERGED)):
        size = (40.0 - least) * (1 + g)
        push = (Disturbance(op.J.T @ [size], omega=omega, end=duration / 2),)
        done = run(wall, push=push, duration=duration)
        if outcome is Outcome.CONTACT_LOST:
            assert done.outcome is outcome
            first = np.arcsin(40 / (40 - least)) / omega
            assert done.t[-1] == pytest.approx(first, abs=TIMELY)
        else:
            assert done.t[-1] == duration
            assert done.lambda_.min() == pytest.approx(least, abs=0.5)


def test_a_start_that_would_have_to_pull_ends_at_once(wall, run):
    op = wall.operating_point
    done = run(wall, push=(Disturbance(op.J.T @ [100.0]),), duration=1.0)
    assert done.outcome is Outcome.CONTACT_LOST
    assert done.t[-1] == 0.0


@pytest.mark.parametrize("path", [ForcePath(lag=2e-3), ForcePath(delay=1e-3), ForcePath(sample=1e-3)], ids=str)
def test_contact_is_lost_whatever_the_electronics(wall, with_gains, run, path):
    """Without force feedback they change nothing; in steps the end is known to a step."""
    loop, push = with_gains(wall, G_f=np.zeros((1, 1))), pulling(wall.operating_point, 60.0, 4.0)[0]
    plain, other = (run(loop, each, push=push, duration=1.0) for each in (Feedback(), Feedback(path=path)))
    assert other.outcome is Outcome.CONTACT_LOST
    # the sampled law acts a millisecond late: its force differs by that much of its rate
    assert other.t[-1] == pytest.approx(plain.t[-1], abs=TIMELY if not (path.delay or path.sample) else 2.1e-3)


def test_the_name_is_that_of_the_constraint_that_pulls(make_arm, loop_of, run):
    """Two constraints, one of them with lambda_d < 0: it is lost when its force becomes positive."""
    constraints = {
        "circle": {"expression": "norm(p4 - [0.9, 0.2]) - 0.3", "unit": "m", "one_sided": True},
        "parabola": {"expression": "y(p3) - x(p3)**2/(4*l) - 0.3", "unit": "m", "one_sided": True},
    }
    loop = loop_of(make_arm(4, constraints, [1.4, -0.6, -0.5, -0.8], lambda_d={"circle": 15, "parabola": -8}))
    op = loop.operating_point
    for k, name in enumerate(constraints):
        pull = 1.6 * np.eye(2)[k] * op.lambda_d * (1 + loop.gains.G_f[k, k])
        done = run(loop, push=(Disturbance(op.J.T @ pull, omega=2.0),), duration=2.0)
        assert done.outcome is Outcome.CONTACT_LOST
        assert f"`{name}`" in done.reason
        assert np.sign(done.lambda_[-1, k]) == -np.sign(op.lambda_d[k])


def test_a_jump_between_two_samples_is_no_dip():
    """20, 1 | 2, 1.5: a held input jumps; the parabola through the three would go below zero."""
    t, force = np.array([0.0, 1.0, 1.0, 2.0]), np.array([[20.0, 1.0, 2.0, 1.5]])
    jumping = Samples(t, np.zeros((4, 4)), force, np.zeros((2, 4)), np.zeros((1, 4)))
    assert lost_contact(jumping, np.ones(1)) is None
    smooth = Samples(np.arange(4.0), *(np.zeros((4, 4)), force, np.zeros((2, 4)), np.zeros((1, 4))))
    assert lost_contact(smooth, np.ones(1)) == 1


def test_noise_may_tear_the_contact_and_a_world_may_be_the_reason(wall, run):
    op = wall.operating_point
    bias = nominal_world(op, Disturbance(op.J.T @ [70.0]))  # 1.1 N are left
    from firmtouch.simulation.scenario import Noise

    quiet = Feedback(path=ForcePath(sample=1e-3))
    noisy = Feedback(path=ForcePath(sample=1e-3), noise=Noise(np.zeros(2), np.zeros(2), np.full(1, 1.0), seed=1))
    assert run(wall, quiet, world=bias, way=0.0, duration=0.5).outcome is not Outcome.STOPPED
    assert run(wall, noisy, world=bias, way=0.0, duration=0.5).outcome is Outcome.CONTACT_LOST
