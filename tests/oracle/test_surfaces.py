"""Which surface stands for a constraint is read from phi, and what none stands for is refused."""

import numpy as np
import pytest

import firmtouch
from firmtouch.oracle import Ball, JointSum, NotExpressibleError, Plane, find_touches


def touches(model):
    return find_touches(firmtouch.find_operating_point(firmtouch.derive_plant(model.spec)))


def test_a_wall_is_a_plane_whose_normal_points_to_the_arm(shipped):
    (plane,) = touches(shipped("planar_2r_wall"))
    assert isinstance(plane, Plane)
    assert plane.normal == pytest.approx([-1, 0, 0], abs=1e-12)  # phi = d - x
    assert (plane.scale, plane.distance) == pytest.approx((1, -0.62))


def test_a_sloping_worktop_in_space_is_a_plane_without_being_drawn(grinder):
    (plane,) = touches(grinder)
    slope = np.deg2rad(15)
    assert isinstance(plane, Plane)
    assert plane.normal == pytest.approx([-np.sin(slope), 0, np.cos(slope)], abs=1e-12)
    assert plane.distance == pytest.approx(0.2)


def test_round_surfaces_are_those_of_the_drawing(shipped):
    (disc,), (ball,) = touches(shipped("planar_3r_circle")), touches(shipped("spatial_3r_sphere"))
    assert isinstance(disc, Ball)
    assert isinstance(ball, Ball)
    assert (disc.disc, ball.disc) == (True, False)
    assert (disc.radius, disc.scale, ball.radius, ball.scale) == pytest.approx((0.12, 1, 0.12, 1))
    assert ball.centre == pytest.approx([0.55, 0.15, 0.3])


def test_the_scale_of_phi_is_found(shipped):
    (plane,) = touches(shipped("planar_2r_wall", ("expression: d - x(tip)", "expression: 2.5*(d - x(tip))")))
    assert (plane.scale, plane.distance) == pytest.approx((2.5, -0.62))


def test_a_sum_of_angles_needs_no_surface(shipped):
    _, square = touches(shipped("planar_3r_wall"))
    assert isinstance(square, JointSum)
    assert [*square.weights, square.constant] == pytest.approx([1, 1, 1, 0], abs=1e-12)


CIRCLE = "norm(tip - centre) - radius"


@pytest.mark.parametrize(
    ("name", "replacement", "reason"),
    [
        ("two_arms_bar", ("40 N", "40 N"), "two parts of the mechanism press on each other"),
        ("pendulum_rod", ("19.62 N", "19.62 N"), "neither the distance of its contact point from a plane"),
        ("planar_2r_wall", ("{wall: 40 N}", "{wall: -40 N}"), "a contact in MuJoCo pushes and never pulls"),
        ("planar_2r_circle", (CIRCLE, "radius - norm(tip - centre)"), "solid"),
        ("planar_2r_circle", (CIRCLE, "norm(tip - centre)**2/radius - radius"), "nor from a circle or sphere"),
        ("planar_2r_wall", ("  contacts:\n    wall: tip\n", ""), "no contact point in the drawing"),
    ],
    ids=["closed loop", "inside a drawn rod", "pulls", "inside", "no distance", "no point"],
)
def test_what_no_surface_stands_for_is_refused(shipped, name, replacement, reason):
    with pytest.raises(NotExpressibleError, match=reason):
        touches(shipped(name, replacement))
