"""V of Eq. (9): what it is made of, and how it falls."""

import numpy as np
import pytest

import firmtouch
from firmtouch.regulation import Controller, closed_loop_acceleration, control_law, lyapunov
from firmtouch.regulation.graph import surface_above
from firmtouch.regulation.lyapunov import potential


@pytest.fixture(scope="module")
def designed(op) -> firmtouch.ClosedLoop:
    return firmtouch.assign_poles(op, op.plant.spec.design.with_method("poles"))


def on_surface(loop, x2):
    split, op = loop.split, loop.operating_point
    found = surface_above(op.plant, op.q_d, split.V1, split.V2, x1=np.zeros(op.m), x2=x2)
    assert found is not None
    return found


def test_the_graph_lies_on_the_surface_and_above_its_point(designed):
    op, split = designed.operating_point, designed.split
    x2 = 0.05 * np.ones(op.n - op.m)
    x1, q = on_surface(designed, x2)
    assert np.abs(op.plant.Phi(q)).max() < 1e-11
    np.testing.assert_allclose(split.V2.T @ (q - op.q_d), x2, atol=1e-14)  # rounding
    # The surface leaves its tangent space quadratically: a half of x2 makes a quarter of x1.
    half, _ = on_surface(designed, x2 / 2)
    if np.abs(x1).max() > 1e-9:  # a plane stays in it
        assert np.log2(np.linalg.norm(x1) / np.linalg.norm(half)) == pytest.approx(2, abs=0.15)


def test_the_potential_is_that_of_K_along_the_surface(designed):
    """P_cd = x2^T K22 x2 / 2 and terms of third order."""
    K22 = designed.split.blocks(designed.K).X22
    x2 = 1e-3 * np.random.default_rng(1).normal(size=K22.shape[0])
    errors = []
    for size in (1.0, 0.5):
        _, q = on_surface(designed, size * x2)
        errors.append(abs(potential(designed, q) - size**2 * x2 @ K22 @ x2 / 2))
    scale = x2 @ K22 @ x2
    assert errors[0] < 0.05 * scale
    assert errors[0] < 1e-9 * scale or errors[1] < 0.3 * errors[0]  # third order halves to an eighth, fourth to less


def test_its_rate_is_that_of_the_damping(designed):
    """V' = -q'^T C q' for (15) and (11), by the chain rule with accelerations that are solved elsewhere."""
    op = designed.operating_point
    _, q = on_surface(designed, 0.05 * np.ones(op.n - op.m))
    T = np.linalg.svd(op.plant.J(q))[2][op.m :].T
    qdot = T @ np.random.default_rng(2).normal(size=T.shape[1])
    h = 1e-6
    for controller in (Controller.AFFINE, Controller.ENERGY_WITH_FORCE):
        law = control_law(op, designed.gains, controller)
        qddot, _ = closed_loop_acceleration(op, law, q, qdot, d=np.zeros(op.n))

        def V(t, qddot=qddot):
            # Phi^T lambda_d is part of V beside the surface, where the parabola leaves it.
            beside = q + t * qdot + t**2 * qddot / 2
            return lyapunov(designed, beside, qdot + t * qddot) - op.plant.Phi(beside) @ op.lambda_d

        rate = (V(h) - V(-h)) / (2 * h)
        assert rate == pytest.approx(-qdot @ designed.gains.C @ qdot, rel=1e-6)  # a difference over 2e-6 s
