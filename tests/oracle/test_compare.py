"""MuJoCo's steady state and motion against ours: they differ by MuJoCo's compliance, and by nothing else."""

import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from firmtouch.oracle import (
    ContactStiffness,
    MissingOracleError,
    NotExpressibleError,
    NotSettledError,
    compare_motion_with_mujoco,
    compare_with_mujoco,
    settle_in_mujoco,
)
from firmtouch.oracle.stiffness import DEFAULT, VERY_STIFF
from firmtouch.regulation import close_loop, closed_loop_equilibrium

# A run ends with speeds below 1e-10 rad/s; with poles of about -6 1/s some 2e-11 rad are then left to go, and gains of
# some 100 N m/rad, with the speed's and the contact's settling at 1e3 1/s, make up to 1e-8 N of that.
SETTLED, FORCE_SETTLED = 1e-10, 1e-8


def disturbance(loop):
    """Push by some tenths of N m, of either sign; less where there is a wrist, which gives way sooner."""
    n = loop.operating_point.n
    return (0.3 if n < 6 else 0.05) * np.cos(np.arange(n))


@pytest.fixture(scope="module", params=[DEFAULT, VERY_STIFF], ids=["default", "very stiff"])
def found(request, resting_arm):
    loop = resting_arm
    return loop, request.param, compare_with_mujoco(loop, stiffness=request.param, d=disturbance(loop))


def test_compliance_explains_all_of_the_difference(found):
    _, _, comparison = found
    assert comparison.explained.position < SETTLED
    assert comparison.explained.constraint_force < FORCE_SETTLED
    assert np.abs(comparison.give).max() < 1e-14  # at rest penetration is compliance times force: rounding of q


def test_the_residual_is_what_is_known_of_each_stiffness(found):
    _, stiffness, comparison = found
    low, high = (1e-4, 2e-3) if stiffness is DEFAULT else (1e-10, 1e-8)
    assert np.all(comparison.rest.penetration > low)
    assert np.all(comparison.rest.penetration < high)
    assert low < comparison.raw.position < 10 * high  # the arm gives way by about as much in its joints
    assert comparison.rest.contacts == comparison.rest.penetration.size
    assert comparison.rest.agreement.at_rest < 1e-13  # rounding


def test_the_arm_has_really_moved_and_its_force_has_really_changed(found):
    loop, _, comparison = found
    op = loop.operating_point
    assert np.linalg.norm(comparison.rest.q - op.q_d) > 2e-3  # far above the differences that are compared
    assert np.linalg.norm(comparison.rest.lambda_ - op.lambda_d) > 1e-3


def test_the_offset_row_predicts_the_difference(resting_arm):
    comparison = compare_with_mujoco(resting_arm, stiffness=DEFAULT)
    for actual, predicted in (
        (comparison.raw.q, comparison.predicted.q),
        (comparison.raw.lambda_, comparison.predicted.lambda_),
    ):
        # First order in a penetration of 2e-4 m at lengths of 0.1 m and more.
        assert np.linalg.norm(actual - predicted) < 2e-2 * np.linalg.norm(actual)


@pytest.mark.slow
def test_the_difference_is_proportional_to_the_penetration(arm):
    d = disturbance(arm)
    found = [
        compare_with_mujoco(arm, stiffness=ContactStiffness(timeconst=each, dmin=0.95), d=d)
        for each in (0.02, 0.01, 0.005, 0.0025)
    ]
    for first, second in pairwise(found):
        ratio = np.linalg.norm(first.rest.penetration) / np.linalg.norm(second.rest.penetration)
        assert ratio == pytest.approx(4, rel=0.05)  # as the square of the time constant; the force changes a little
        assert first.raw.position / second.raw.position == pytest.approx(ratio, rel=0.05)
        assert first.raw.constraint_force / second.raw.constraint_force == pytest.approx(ratio, rel=0.05)


@pytest.mark.slow
def test_the_offset_rows_error_has_order_two(arm):
    def errors(timeconst):
        found = compare_with_mujoco(arm, stiffness=ContactStiffness(timeconst=timeconst, dmin=0.95))
        left = found.raw.q - found.predicted.q, found.raw.lambda_ - found.predicted.lambda_
        return np.linalg.norm(found.rest.penetration), *map(np.linalg.norm, left)

    (first, *before), (second, *after) = errors(0.02), errors(0.01)
    for large, small in zip(before, after, strict=True):
        assert np.log(large / small) / np.log(first / second) == pytest.approx(2, abs=0.1)


@pytest.mark.slow
def test_the_motion_nears_eq_38_with_the_order_of_mujocos_integrator(arm):
    coarse, fine = (compare_motion_with_mujoco(arm, timestep=each).deviation for each in (5e-4, 2.5e-4))
    assert coarse < 3e-3  # the fastest pole times half a step is 4e-3
    # Order one, but for the 1e-4 that the start's size and the contact leave.
    assert coarse / fine == pytest.approx(2, abs=0.2)


def test_a_scaled_constraint_gives_the_scaled_multiplier(shipped, loop_of):
    scaled = (("expression: d - x(tip)", "expression: 4*(d - x(tip))"), ("{wall: 40 N}", "{wall: 10 N}"))
    one, four = (loop_of(shipped("planar_2r_wall", *each)) for each in ((), scaled))
    first, second = (compare_with_mujoco(each) for each in (one, four))
    assert second.explained.constraint_force < FORCE_SETTLED
    assert 4 * second.rest.lambda_ == pytest.approx(first.rest.lambda_, rel=1e-3)  # the same newtons, other gains
    assert np.abs(second.give).max() < 1e-14


def test_the_comparison_can_fail(wall):
    """MuJoCo's arm with gains that are a little wrong rests elsewhere, and no compliance explains that."""
    d = disturbance(wall)
    rest = settle_in_mujoco(close_loop(wall.operating_point, replace(wall.gains, W=1.001 * wall.gains.W)), d=d)
    ours = closed_loop_equilibrium(wall, d=d, Delta=-rest.penetration)
    assert np.abs(rest.q - ours.q).max() > 1e4 * SETTLED


def test_force_feedback_of_one_and_more_is_refused(wall):
    strong = close_loop(wall.operating_point, replace(wall.gains, G_f=np.array([[1.0]])))
    with pytest.raises(NotExpressibleError, match="only eigenvalues below 1 are stable"):
        settle_in_mujoco(strong)


def test_too_little_time_is_told(wall):
    with pytest.raises(NotSettledError, match="give a longer `duration`") as error:
        settle_in_mujoco(wall, duration=0.5)
    assert 1e-6 < error.value.speed < 1e-2
    assert error.value.time == 0.5


def test_an_explosion_is_told_and_leaves_no_log(wall, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    unstable = close_loop(wall.operating_point, replace(wall.gains, C=-wall.gains.C))
    with pytest.raises(NotSettledError, match="it explodes") as error:
        settle_in_mujoco(unstable)
    assert error.value.speed == np.inf
    assert list(tmp_path.iterdir()) == []


def test_without_mujoco_the_error_tells_what_to_install(wall, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingOracleError, match=r"pip install 'firmtouch\[oracle\]'"):
        compare_with_mujoco(wall)
