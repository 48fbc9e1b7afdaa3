"""Configurations that meet a pose: closed forms, their number, joint limits, and what is told when there are none."""

from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmtouch.errors import InputError
from firmtouch.mechanics.arrays import call, frozen
from firmtouch.mechanics.tree import build_tree, frame_pose
from firmtouch.modelfile.urdf import read_urdf
from firmtouch.regulation.inverse_kinematics import (
    BeyondLimitsError,
    OutOfReachError,
    Reach,
    pointed,
    reach_of_tree,
    solve_reach,
    turned,
)
from firmtouch.regulation.inverse_kinematics.evaluation import Evaluation

URDF = Path(__file__).parents[2] / "models" / "urdf"
FREE = 2 * np.pi
UPPER_ARM, FOREARM = 0.4, 0.3
FEW = 12
"""Starts that suffice for a planar arm."""


def planar(lengths, target, *, lower=-FREE, upper=FREE):
    """Ask a planar arm for a position of its tip; its task is that position."""
    n = len(lengths)
    q = ca.SX.sym("q", n)
    angles = ca.cumsum(q)
    p = ca.vertcat(ca.dot(ca.DM(lengths), ca.cos(angles)), ca.dot(ca.DM(lengths), ca.sin(angles)))
    return Reach(
        ca.Function("r", [q], [p - ca.DM(target)]),
        ca.Function("task", [q], [ca.jacobian(p, q)]),
        frozen(np.broadcast_to(lower, n)),
        frozen(np.broadcast_to(upper, n)),
        (True,) * n,
        tuple(f"j{i}" for i in range(n)),
        lengths=(0, 1),
    )


class Arm:
    """An arm of a file with its flange's pose, and questions for poses of it."""

    def __init__(self, name):
        self.tree = build_tree(read_urdf(URDF / f"{name}.urdf"), tool="flange")
        self.q = ca.SX.sym("q", self.tree.n)
        self.p, self.R = frame_pose(self.tree, "flange", self.q)
        self._p, self._R = (ca.Function("f", [self.q], [each]) for each in (self.p, self.R))
        bounds = [(max(each.lower, -np.pi), min(each.upper, np.pi)) for each in self.tree.coordinates]
        self.lower, self.upper = np.array(bounds).T

    def pose(self, q):
        return call(self._p, q)[:, 0], call(self._R, q)

    def reach(self, p_d, R_d, *, direction=False):
        turn = pointed(self.R[:, 2], R_d[:, 2]) if direction else turned(self.R, R_d)
        r = ca.vertcat(self.p - ca.DM(p_d), turn)
        return reach_of_tree(
            self.tree, "flange", r, self.q, lengths=(0, 1, 2), angles=tuple(range(3, 5 if direction else 6))
        )


@pytest.fixture(scope="module")
def ur5e():
    return Arm("ur5e")


@pytest.fixture(scope="module")
def panda():
    return Arm("panda")


def elbows(x, y):
    """Give both configurations of the planar arm of two links, by the law of cosines."""
    cosine = (x * x + y * y - UPPER_ARM**2 - FOREARM**2) / (2 * UPPER_ARM * FOREARM)
    for elbow in (np.arccos(cosine), -np.arccos(cosine)):
        yield (
            np.arctan2(y, x) - np.arctan2(FOREARM * np.sin(elbow), UPPER_ARM + FOREARM * np.cos(elbow)),
            elbow,
        )


def test_two_links_have_their_two_closed_forms():
    found = solve_reach(planar((UPPER_ARM, FOREARM), (0.3, 0.45)))
    assert found.isolated
    assert found.met == found.starts  # nothing stops a planar arm within its reach
    expected = sorted(elbows(0.3, 0.45))
    assert sorted(tuple(each.q) for each in found.solutions) == [pytest.approx(each, abs=1e-12) for each in expected]
    for each in found.solutions:
        sine = abs(np.sin(each.q[1]))
        # Yoshikawa's own example: w = l1 l2 |sin q2|.
        assert each.manipulability == pytest.approx(UPPER_ARM * FOREARM * sine, rel=1e-12)
        assert each.margin == pytest.approx(min(0.5 - np.abs(each.q) / (2 * FREE)), rel=1e-12)
        parts = (1 - each.q / FREE) * (1 + each.q / FREE)
        assert each.room == pytest.approx(each.manipulability * np.prod(parts), rel=1e-12)
    assert found.solutions[0].room >= found.solutions[1].room
    assert "farthest from joint limits" in found.because


def test_the_nearest_is_taken_and_told_in_its_own_turn():
    reach = planar((UPPER_ARM, FOREARM), (0.3, 0.45))
    for each in elbows(0.3, 0.45):
        near = frozen(np.add(each, [0.1, -0.1]))
        found = solve_reach(reach, near=near, starts=FEW)
        assert found.q == pytest.approx(each, abs=1e-12)
        assert "nearest" in found.because
    up = next(elbows(0.3, 0.45))
    beyond = frozen(np.subtract(up, [2 * np.pi, 0]))
    assert solve_reach(reach, near=beyond, starts=FEW).q == pytest.approx(beyond, abs=1e-12)
    limited = replace(reach, lower=frozen([-np.pi, -np.pi]))  # where that turn is not allowed
    assert solve_reach(limited, near=beyond, starts=FEW).q == pytest.approx(up, abs=1e-12)


def test_limits_leave_one_elbow():
    reach = planar((UPPER_ARM, FOREARM), (0.3, 0.45), lower=[-np.pi, -np.pi], upper=[np.pi, 0.1])
    found = solve_reach(reach, starts=FEW)
    assert [each.q[1] < 0 for each in found.solutions] == [True]


def test_a_start_that_ends_at_a_limit_is_led_around_it():
    """The one start ends in the corner of the limits, on the wrong side of the target."""
    target = np.array([-0.654, -0.245])
    reach = planar((UPPER_ARM, FOREARM), target, lower=[-3.1, -0.5], upper=[3.1, 3.0])
    found = solve_reach(reach, starts=1)
    assert found.met == 0
    assert len(found.solutions) == 1
    assert np.abs(reach.residual(found.q).full()).max() < 1e-12
    assert np.all((reach.lower <= found.q) & (found.q <= reach.upper))


def test_a_stretched_arm_has_one_singular_solution():
    found = solve_reach(planar((UPPER_ARM, FOREARM), (0.7, 0.0)))
    assert len(found.solutions) == 1
    assert found.rank == 1
    assert not found.isolated
    assert found.q == pytest.approx([0, 0], abs=1e-4)  # r is quadratic there: half the digits
    assert found.solutions[0].manipulability == pytest.approx(0, abs=1e-5)


def test_a_redundant_arm_settles_where_the_room_is_largest():
    """Against a fine search of the one-parametric family of a planar arm of three links."""
    reach = planar((0.4, 0.3, 0.2), (0.35, 0.3), lower=-2.5, upper=2.5)
    found = solve_reach(reach)
    assert found.rank == 2
    at = Evaluation(reach)
    best = 0.0
    for heading in np.linspace(-np.pi, np.pi, 1001):
        wrist = np.array([0.35, 0.3]) - 0.2 * np.array([np.cos(heading), np.sin(heading)])
        if abs(UPPER_ARM - FOREARM) < np.linalg.norm(wrist) < UPPER_ARM + FOREARM:
            for first, second in elbows(*wrist):
                third = (heading - first - second + np.pi) % (2 * np.pi) - np.pi
                q = np.array([first, second, third])
                if np.all(np.abs(q) < 2.5):
                    best = max(best, at.solution(q).room)
    # The family is walked in steps of 6e-3 rad, so its best misses the maximum by some 4e-5 of it.
    assert found.solutions[0].room == pytest.approx(best, rel=1e-4)
    assert found.solutions[0].room >= best * (1 - 1e-9)


def test_gradient_of_the_room_is_that_of_differences(panda, rng):
    at = Evaluation(panda.reach(*panda.pose(panda.lower), direction=True))
    for q in rng.uniform(panda.lower + 0.1, panda.upper - 0.1, (5, 7)):
        differences = [(at.minus_log_room(q + h) - at.minus_log_room(q - h)) / 2e-6 for h in 1e-6 * np.eye(7)]
        gradient = at.minus_log_room_gradient(q)
        # 1e-6^2 of the third derivative, and 1e-16 / 1e-6 of rounding.
        assert gradient == pytest.approx(differences, abs=1e-7 * max(1, np.abs(gradient).max()) ** 2)


def test_a_six_joint_arm_has_eight_solutions(ur5e):
    """Known of arms whose joints two to four are parallel: two shoulders, two wrists, two elbows."""
    p_d, R_d = ur5e.pose([0.4, -1.2, 1.5, -1.0, -1.3, 0.3])
    reach = replace(ur5e.reach(p_d, R_d), lower=frozen(np.full(6, -np.pi)), upper=frozen(np.full(6, np.pi)))
    found = solve_reach(reach)
    assert len(found.solutions) == 8
    assert found.isolated
    for each in found.solutions:
        p, R = ur5e.pose(each.q)
        assert p == pytest.approx(p_d, abs=1e-12)  # rounding of six products of metres
        assert pytest.approx(R_d, abs=1e-12) == R
        assert each.residual < 1e-12
    J = Evaluation(reach).task(found.q)
    assert found.solutions[0].manipulability == pytest.approx(np.sqrt(np.linalg.det(J @ J.T)), rel=1e-9)


def test_the_same_question_has_the_same_answer(panda):
    reach = panda.reach(*panda.pose((panda.lower + 2 * panda.upper) / 3))
    once, again = (solve_reach(reach, starts=6) for _ in range(2))
    assert np.array_equal([each.q for each in once.solutions], [each.q for each in again.solutions])
    assert once.solutions[0] is not again.solutions[0]


def test_starts_where_r_is_not_defined_do_no_harm():
    reach = planar((UPPER_ARM, FOREARM), (0.3, 0.45))
    q = ca.SX.sym("q", 2)
    defined = ca.exp(ca.log(q[0] + 1)) / (q[0] + 1)  # one, where q0 > -1
    found = solve_reach(replace(reach, residual=ca.Function("r", [q], [defined * reach.residual(q)])))
    assert found.met < found.starts
    assert sorted(tuple(each.q) for each in found.solutions) == [
        pytest.approx(each, abs=1e-12) for each in sorted(elbows(0.3, 0.45))
    ]


def test_a_seven_joint_arm_points_its_tool(panda):
    down = np.diag([1.0, -1.0, -1.0])
    reach = panda.reach(np.array([0.5, 0.1, 0.3]), down, direction=True)
    found = solve_reach(reach)
    assert found.rank == 5
    for each in found.solutions:
        p, R = panda.pose(each.q)
        assert p == pytest.approx([0.5, 0.1, 0.3], abs=1e-12)
        assert R[:, 2] == pytest.approx([0, 0, -1], abs=1e-12)
        assert np.all((reach.lower <= each.q) & (each.q <= reach.upper))
    usual = frozen([0, -np.pi / 4, 0, -3 * np.pi / 4, 0, np.pi / 2, np.pi / 4])
    nearest = solve_reach(reach, near=usual, starts=8)
    step = nearest.q - usual
    J = Evaluation(reach).J(nearest.q)
    # At the nearest place the way from `usual` is normal to the continuum: a combination of the rows of dr/dq.
    along = step - np.linalg.pinv(J) @ (J @ step)
    assert np.linalg.norm(along) < 1e-3 * np.linalg.norm(step)
    assert all(np.linalg.norm(step) <= np.linalg.norm(each.q - usual) for each in found.solutions)


def test_out_of_reach_says_by_how_much():
    with pytest.raises(OutOfReachError) as caught:
        solve_reach(planar((UPPER_ARM, FOREARM), (0.6, 0.8)), starts=FEW)
    # A metre away with 0.7 m of arm: stretched towards it.
    assert caught.value.miss.position == pytest.approx(0.3, rel=1e-6)
    assert caught.value.miss.q == pytest.approx([np.arctan2(0.8, 0.6), 0], abs=1e-3)
    assert np.isinf(caught.value.miss.direction)
    assert "misses by 300 mm, at q" in str(caught.value)


def test_direction_and_position_out_of_reach(ur5e):
    with pytest.raises(OutOfReachError, match=r"mm and .* deg"):
        solve_reach(ur5e.reach(np.array([0.0, 0.0, 1.5]), np.diag([1.0, -1.0, -1.0])), starts=2)


def test_beyond_limits_names_the_joint_and_the_excess():
    up, down = elbows(0.3, 0.45)
    between = {"lower": [-np.pi, down[1] + 0.3], "upper": [np.pi, up[1] - 0.2]}
    with pytest.raises(BeyondLimitsError) as caught:
        solve_reach(planar((UPPER_ARM, FOREARM), (0.3, 0.45), **between), starts=FEW)
    assert caught.value.excess == {"j1": pytest.approx(0.2, abs=1e-12)}
    assert caught.value.q == pytest.approx(up, abs=1e-12)
    assert caught.value.miss.position > 0
    assert "joint `j1` would be at" in str(caught.value)
    assert "0.2 rad (11.5 deg) above its upper limit" in str(caught.value)


def test_beyond_limits_of_a_redundant_arm_is_the_least_excess():
    # Three links of 0.3 m, a target at 0.85 m: the least |q_i| that suffice, with q0 free, are all that is needed.
    with pytest.raises(BeyondLimitsError) as caught:
        solve_reach(
            planar((0.3, 0.3, 0.3), (0.85, 0.0), lower=[-np.pi, -0.1, -0.1], upper=[np.pi, 0.1, 0.1]), starts=FEW
        )
    assert set(caught.value.excess) == {"j1", "j2"}
    beyond = np.abs(list(caught.value.excess.values()))
    # By symmetry both joints bend alike: 1 + 2 cos(a) = 0.85 / 0.3 seen from the middle link.
    assert beyond == pytest.approx(np.arccos((0.85 / 0.3 - 1) / 2) - 0.1, abs=1e-4)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"lower": frozen([0, 1]), "upper": frozen([1, 1])}, "joint `j1` has no range"),
        ({"lower": frozen([0])}, "not all of 2 joints"),
    ],
)
def test_what_does_not_fit_together_is_refused(change, message):
    with pytest.raises(InputError, match=message):
        replace(planar((UPPER_ARM, FOREARM), (0.3, 0.45)), **change)


def test_wrong_arguments_are_refused():
    reach = planar((UPPER_ARM, FOREARM), (0.3, 0.45))
    with pytest.raises(InputError, match="2 finite numbers"):
        solve_reach(reach, near=frozen([0, np.nan]))
    with pytest.raises(InputError, match="at least one"):
        solve_reach(reach, starts=0)
    with pytest.raises(InputError, match="no rotation"):
        turned(ca.SX.eye(3), np.diag([1.0, 1.0, -1.0]))
    with pytest.raises(InputError, match="no unit vector"):
        pointed(ca.SX.ones(3), (0, 0, 2))


@settings(max_examples=30)
@given(angle=st.floats(0, 3.1), axis=st.tuples(*3 * [st.floats(0.1, 1)]))
def test_turned_and_pointed_measure_the_angle(angle, axis):
    a = np.array(axis) / np.linalg.norm(axis)
    along = np.outer(a, a)
    R = along + np.cos(angle) * (np.eye(3) - along) + np.sin(angle) * np.cross(np.eye(3), a)
    half = 2 * np.sin(angle / 2)
    # Divided by cos(angle / 2), which is 0.02 at the end.
    assert ca.DM(turned(ca.SX(ca.DM(R)), np.eye(3))).full()[:, 0] == pytest.approx(half * a, abs=1e-12)
    across = np.linalg.svd(a[None, :])[2][1]
    tilted = np.cos(angle) * a + np.sin(angle) * across
    assert np.linalg.norm(ca.DM(pointed(ca.SX(ca.DM(tilted)), a)).full()) == pytest.approx(half, abs=1e-12)


def test_a_follower_that_turns_half_as_far_has_no_whole_turns(ur5e):
    joints = (*ur5e.tree.joints[:5], replace(ur5e.tree.joints[5], coordinate=4, multiplier=0.5))
    tree = replace(ur5e.tree, coordinates=ur5e.tree.coordinates[:5], joints=joints)
    q = ca.SX.sym("q", 5)
    assert reach_of_tree(tree, "flange", frame_pose(tree, "flange", q)[0], q).revolves == (True,) * 4 + (False,)


@pytest.mark.slow
@pytest.mark.parametrize("direction", [False, True])
@pytest.mark.parametrize("name", ["ur5e", "panda"])
def test_whatever_the_arm_takes_is_reached(name, direction, request):
    arm = request.getfixturevalue(name)

    @settings(max_examples=20)
    @given(parts=st.tuples(*arm.tree.n * [st.floats(0, 1)]))
    def reached(parts):
        q = arm.lower + np.array(parts) * (arm.upper - arm.lower)
        found = solve_reach(arm.reach(*arm.pose(q), direction=direction))
        assert all(each.residual < 1e-9 for each in found.solutions)
        assert found.solutions

    reached()
