"""Where the mechanism rests: projection, the range of J^T, redundant constraints."""

import numpy as np
import pytest

import firmtouch
from firmtouch.regulation import project
from firmtouch.regulation.operating_point import ForceOutOfRangeError
from firmtouch.regulation.projection import ON_SURFACE, OffSurfaceError
from firmtouch.regulation.redundancy import DependentConstraintsError


@pytest.fixture
def point_of():
    return lambda model: firmtouch.find_operating_point(firmtouch.derive_plant(model.spec))


def test_each_model_rests_on_its_constraints(op):
    assert op.residual <= ON_SURFACE * max(1, np.abs(op.q_d).max())
    assert np.abs(op.plant.Phi(op.q_d)).max() == op.residual
    assert op.f_d == pytest.approx(op.J.T @ op.lambda_d, rel=1e-14)
    N0 = op.P_qq - sum(each * Phi_j for each, Phi_j in zip(op.lambda_d, op.constraint_hessians, strict=True))
    assert np.allclose(op.N0, N0, rtol=0, atol=1e-12 * np.abs(N0).max())  # rounding of a few sums


def test_projection_converges_quadratically(arm_in_corner):
    plant = firmtouch.derive_plant(arm_in_corner.spec)
    on_surface = firmtouch.find_operating_point(plant).q_d
    q = on_surface + 0.05 * np.array([1, -1, 0.5, 0.3])
    residuals = []
    for _ in range(4):  # the step that `project` takes where it is short
        residuals.append(np.abs(plant.Phi(q)).max())
        q = q - np.linalg.pinv(plant.J(q)) @ plant.Phi(q)
    orders = np.log(residuals[2:]) / np.log(residuals[1:-1])
    assert orders.min() > 1.7  # two in the limit, less while the constant weighs
    assert residuals[-1] < 1e-9


def test_projection_is_idempotent_and_leaves_tangents_alone(op):
    again = project(op.plant, op.q_d)
    assert np.array_equal(again.q, op.q_d)
    assert again.moved == 0
    # From a point off the surface, the first step is along the normal, so a small miss moves no tangent coordinate.
    missed = project(op.plant, op.q_d + 1e-4 * op.J[0] / np.linalg.norm(op.J[0]))
    assert np.linalg.norm(missed.q - op.q_d) < 1e-6  # second order in the miss, times curvature


def test_a_stated_q_d_off_the_surface_is_refused_with_the_figure(make_arm, point_of):
    q_d = {"q1": 1.0, "q2": -0.9}
    model = make_arm(2, {"wall": "0.3 - x(p2)"}, [0, 0], operating_point={"guess": None, "q_d": q_d})
    missed = abs(0.3 - 0.4 * (np.cos(1.0) + np.cos(0.1)))
    with pytest.raises(OffSurfaceError, match=f"misses the constraints by {missed:.3g}") as refusal:
        point_of(model)
    assert refusal.value.projection.residual == pytest.approx(missed)
    assert "guess" in str(refusal.value)


def test_a_surface_out_of_reach_is_refused_with_the_nearest_configuration(make_arm, point_of):
    with pytest.raises(OffSurfaceError) as refusal:
        point_of(make_arm(2, {"wall": "1.0 - x(p2)"}, [0.3, 0.2]))
    left = refusal.value.projection.residual  # the arm is 0.8 m long; Newton's method does not minimise what is left
    assert left == pytest.approx(0.2, abs=0.02)
    assert f"{left:.3g}" in str(refusal.value)


@pytest.fixture
def made_with_force(arm_in_corner, make_arm, point_of):
    """Make the 4R arm with f_d = J^T lambda_d + something across."""
    op = point_of(arm_in_corner)
    constraints = {name: each.expression.text for name, each in arm_in_corner.spec.constraints.items()}

    def make(lambda_d, across=0.0):
        V2 = np.linalg.svd(op.J)[2][op.m :]
        f_d = dict(zip(arm_in_corner.spec.coordinates, op.J.T @ lambda_d + across * V2[0], strict=True))
        point = {"f_d": {name: float(each) for name, each in f_d.items()}, "lambda_d": None}
        return make_arm(4, constraints, [float(each) for each in op.q_d], operating_point=point), V2[0]

    return make


def test_lambda_d_is_recovered_from_a_force_in_the_range(made_with_force, point_of):
    lambda_d = np.array([12.5, -7.25])
    model, _ = made_with_force(lambda_d)
    op = point_of(model)
    assert op.lambda_d == pytest.approx(lambda_d, rel=1e-10)  # J's condition number is of order ten
    assert op.f_d == pytest.approx(op.J.T @ lambda_d, rel=1e-10)


def test_a_force_out_of_the_range_is_refused_with_the_part_outside(made_with_force, point_of):
    model, across = made_with_force(np.array([12.5, -7.25]), across=0.3)
    with pytest.raises(ForceOutOfRangeError) as refusal:
        point_of(model)
    size = np.linalg.norm([model.spec.operating_point.f_d[name] for name in model.spec.coordinates])
    assert refusal.value.outside == pytest.approx(0.3 * across, abs=1e-9)
    assert refusal.value.part == pytest.approx(0.3 / size, rel=1e-9)


@pytest.mark.parametrize(
    ("third", "told"),
    [
        ("x(p4) - 0.7", "the gradient of `again` is +1 wall"),
        ("0.7 - x(p4)", "the gradient of `again` is -1 wall"),
        ("2*(x(p4) - 0.7) - 3*(y(p4) - 0.1)", "the gradient of `again` is +2 wall -3 floor"),
        ("(x(p4) - 0.7)**2/l", "the gradient of `again` is zero"),
    ],
)
def test_redundant_constraints_are_named_with_their_weights(make_arm, point_of, third, told):
    constraints = {"wall": "x(p4) - 0.7", "floor": "y(p4) - 0.1", "again": third}
    guess = [1.2, -0.9, -0.7, 0.4]
    plant = firmtouch.derive_plant(make_arm(4, {k: constraints[k] for k in ("wall", "floor")}, guess).spec)
    guess = [float(each) for each in firmtouch.find_operating_point(plant).q_d]
    with pytest.raises(DependentConstraintsError) as refusal:
        point_of(make_arm(4, constraints, guess))
    assert refusal.value.rank == 2
    assert refusal.value.dependencies == (told,)


def test_a_joint_that_does_not_move_the_constraint_does_no_harm(make_arm, loop_of):
    # The last link lies across the wall, so that solving the constraint for its joint would divide by zero.
    q_d = np.array([0.8, -0.4, -0.5, 0.1])
    wall = f"x(p4) - {0.4 * np.cos(np.cumsum(q_d)).sum():.16f}"
    loop = loop_of(make_arm(4, {"wall": wall}, list(q_d), design={"level": "tangent", "modes": "plant"}))
    assert abs(loop.operating_point.J[0, 3]) < 1e-12
    assert np.sort(np.real(loop.poles.pencil)) == pytest.approx([-9, -8, -7, -6, -5, -4], rel=1e-8)
