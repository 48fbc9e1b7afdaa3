"""What is merged, locked, followed, left out and carried; and what cannot be built, said by name."""

import math
import re

import casadi as ca
import numpy as np
import pytest

from firmtouch.errors import InputError, ModelFileError
from firmtouch.mechanics.tree import build_tree, loaded, placement

ROUNDING = 1e-13  # some hundred operations on numbers around one


def names(tree):
    return [each.name for each in tree.joints], [each.name for each in tree.coordinates]


def test_followers_have_no_coordinate_and_narrow_the_bounds_of_what_they_follow(branched):
    tree = build_tree(branched, tool="tip")
    assert names(tree) == (["swing", "push", "left_finger", "right_finger"], ["swing", "push", "left_finger"])
    np.testing.assert_array_equal(tree.G, [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, -2]])
    # -1 <= -2 q + 0.3 <= 3
    assert (tree.coordinates[2].lower, tree.coordinates[2].upper) == pytest.approx((-1.35, 0.65), abs=ROUNDING)
    assert (tree.coordinates[0].lower, tree.coordinates[0].upper, tree.coordinates[1].revolves) == (-10, 10, False)


def test_branches_that_move_by_themselves_are_left_out(branched):
    assert names(build_tree(branched))[1] == ["swing", "push", "left_finger", "elsewhere"]
    assert names(build_tree(branched, tool="other"))[1] == ["elsewhere"]
    # The arm loads what carries it, so the fingers stay where the tool is before them.
    assert names(build_tree(branched, tool="slide"))[1] == ["swing", "push", "left_finger"]
    assert "other" not in build_tree(branched, tool="tip").frames


def test_a_branch_that_follows_the_tools_joint_matters(say):
    robot = say.robot(
        say.link("base"), say.link("a", 1.0), say.link("b", 1.0), say.joint("j", "revolute", "base", "a"),
        say.joint("k", "revolute", "base", "b", extra='<mimic joint="j"/>'),
    )  # fmt: skip
    assert names(build_tree(robot, tool="a")) == (["j", "k"], ["j"])
    assert names(build_tree(robot, tool="b")) == (["j", "k"], ["j"])


def test_locked_joints_are_the_same_as_not_moving(branched, say, rng):
    whole = say.functions(build_tree(branched, tool="tip"))
    locked = build_tree(branched, tool="tip", locked={"left_finger": 0.4, "push": -0.2})
    assert names(locked) == (["swing"], ["swing"])
    part = say.functions(locked)
    for q, v in rng.normal(size=(5, 2)):
        full, speeds = [q, -0.2, 0.4], [v, 0, 0]
        assert part.M([q])[0, 0] == pytest.approx(whole.M(full)[0, 0], rel=ROUNDING)
        assert part.theta([q], [v])[0] == pytest.approx(whole.theta(full, speeds)[0], rel=ROUNDING, abs=ROUNDING)
        np.testing.assert_allclose(part.p([q]), whole.p(full), atol=ROUNDING)
        np.testing.assert_allclose(part.R([q]), whole.R(full), atol=ROUNDING)
        np.testing.assert_allclose(part.J([q])[:, 0], whole.J(full)[:, 0], atol=ROUNDING)


def test_the_base_pose_and_gravity_turn_together(branched, say, rng):
    at = placement((0.5, -1, 2), (0.4, 0.2, -1.3))
    upright = say.functions(build_tree(branched, tool="tip"))
    turned = say.functions(build_tree(branched, tool="tip", base=at, gravity=at.R @ (0, 0, -9.81)))
    q, v = rng.normal(size=(2, 3))
    np.testing.assert_allclose(turned.M(q), upright.M(q), atol=ROUNDING)
    np.testing.assert_allclose(turned.theta(q, v), upright.theta(q, v), atol=20 * ROUNDING)
    np.testing.assert_allclose(turned.p(q), at.R @ upright.p(q) + at.p, atol=ROUNDING)
    np.testing.assert_allclose(turned.R(q), at.R @ upright.R(q), atol=ROUNDING)


def test_a_payload_is_a_body_at_its_frame(branched, say, rng):
    m, c, inertia = 1.7, np.array([0.05, -0.02, 0.1]), np.diag([0.02, 0.03, 0.04])
    empty = say.functions(build_tree(branched, tool="tip"), "tip")
    tree = build_tree(branched, tool="tip")
    body = loaded(tree, "tip", mass=ca.SX(m), centre_of_mass=ca.SX(ca.DM(c)), inertia=ca.SX(ca.DM(inertia)))
    full = say.functions(tree, "tip", body)
    for q in rng.normal(size=(5, 3)):
        J, R = empty.J(q), empty.R(q)
        arm = R @ c
        J_c = J[:3] + np.cross(J[3:].T, arm).T
        M = m * J_c.T @ J_c + J[3:].T @ R @ inertia @ R.T @ J[3:]
        np.testing.assert_allclose(full.M(q) - empty.M(q), M, atol=10 * ROUNDING)
        assert full.P(q) - empty.P(q) == pytest.approx(m * 9.81 * (empty.p(q) + arm)[2], abs=100 * ROUNDING)


def test_roll_turns_first_and_yaw_last():
    # x, y, z go by the roll to x, z, -y, and from there by the yaw to y, z, x.
    R = placement(rpy=(math.pi / 2, 0, math.pi / 2)).R
    np.testing.assert_allclose(R, [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=ROUNDING)
    R = placement(rpy=(0, math.pi / 2, math.pi / 2)).R  # by the pitch to -z, y, x, then to -z, -x, y
    np.testing.assert_allclose(R, [[0, -1, 0], [0, 0, 1], [-1, 0, 0]], atol=ROUNDING)


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"tool": "tap"}, "the tool `tap` is no link; did you mean `tip`?"),
        ({"tool": "base"}, "the tool `base` does not move"),
        ({"locked": {"swin": 0}}, "there is no joint `swin` that could be locked; did you mean `swing`?"),
        ({"locked": {"bolt": 0}}, "there is no joint `bolt` that could be locked"),
        ({"locked": {"right_finger": 0}}, "joint `right_finger` follows `left_finger`: lock that one"),
        ({"locked": {"swing": 11}}, "joint `swing` is locked at 11, outside of its bounds -10 to 10"),
        ({"locked": {"left_finger": math.nan}}, "joint `left_finger` is locked at nan"),
        (
            {"locked": dict.fromkeys(("swing", "push", "left_finger", "elsewhere"), 0)},
            "no joint is left that could move",
        ),
        ({"gravity": (0, -9.81)}, "the gravity must be 3 finite numbers"),
    ],
)
def test_what_cannot_be_built_is_said(branched, asked, told):
    with pytest.raises(InputError) as caught:
        build_tree(branched, **asked)
    assert told in str(caught.value)


@pytest.mark.parametrize(
    ("frame", "told"), [("plat", "there is no frame `plat`; did you mean `plate`?"), ("base", "which does not move")]
)
def test_a_payload_needs_a_frame_that_moves(branched, frame, told):
    with pytest.raises(InputError, match=re.escape(told)):
        loaded(build_tree(branched), frame, mass=ca.SX(1), centre_of_mass=ca.SX(3, 1), inertia=ca.SX(3, 3))


def test_point_masses_on_the_axis_of_the_last_joint_are_refused(say):
    def arm(at):
        return say.robot(
            say.link("base"), say.link("a", 1.0), say.link("b", 0.0, inertia=(0, 0, 0)), say.link("tip", 2.0, inertia=(0, 0, 0)),
            say.joint("j", "revolute", "base", "a"), say.joint("k", "revolute", "a", "b", "0 0 0", "1 0 1", "0.1 0.2 0.3"),
            say.joint("t", "fixed", "b", "tip", at),
        )  # fmt: skip

    with pytest.raises(ModelFileError, match="joint `k` turns nothing but point masses on its axis"):
        build_tree(arm("0.3 0 0.3"))
    off_axis = build_tree(arm("0.3 0 0"))
    axis = off_axis.joints[1].axis
    # Half of 0.3^2 is the squared distance from an axis at 45 degrees.
    assert axis @ off_axis.joints[1].inertia.tensor @ axis == pytest.approx(2 * 0.3**2 / 2, rel=1e-12)


def test_a_link_that_moves_needs_an_inertial_in_the_file(say):
    pieces = (
        say.link("base"),
        say.link("a", 1.0),
        say.joint("j", "revolute", "base", "a"),
        say.joint("k", "revolute", "a", "b"),
    )
    with pytest.raises(ModelFileError, match=r"r.urdf:1:\d+: link `b` moves with joint `k`"):
        build_tree(say.robot(*pieces, say.link("b")))
    with pytest.raises(ModelFileError, match="joint `k` carries no mass"):
        build_tree(say.robot(*pieces, say.link("b", 0.0, inertia=(0.0, 0.0, 0.0))))
    assert build_tree(say.robot(*pieces, say.link("b")), locked={"k": 1.0}).n == 1
    # What is fixed to it may describe it, and a massless link between two others may be written as one.
    assert build_tree(say.robot(*pieces, say.link("b"), say.link("c", 1.0), say.joint("f", "fixed", "b", "c"))).n == 2
    massless = say.robot(say.link("base"), say.link("a", 0.0, inertia=(0.0, 0.0, 0.0)), say.link("b", 1.0), *pieces[2:])
    assert build_tree(massless).n == 2


def test_very_many_joints_are_refused_before_anything_is_derived(say):
    links = [say.link("l0"), *(say.link(f"l{i}", 1.0) for i in range(1, 102))]
    joints = [say.joint(f"j{i}", "revolute", f"l{i - 1}", f"l{i}") for i in range(1, 102)]
    with pytest.raises(InputError, match="101 joints move; at most 100 are taken"):
        build_tree(say.robot(*links, *joints))
    assert build_tree(say.robot(*links, *joints), locked={"j7": 0.5}).n == 100


def test_bounds_that_exclude_each_other_are_said(say):
    robot = say.robot(
        say.link("base"), say.link("a", 1.0), say.link("b", 1.0), say.joint("j", "revolute", "base", "a", limits=(0, 1)),
        say.joint("k", "revolute", "a", "b", limits=(2, 3), extra='<mimic joint="j"/>'),
    )  # fmt: skip
    with pytest.raises(ModelFileError, match="joint `k` follows `j` and is never within its own limits"):
        build_tree(robot)
