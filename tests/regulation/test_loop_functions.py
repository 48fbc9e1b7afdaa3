"""The closed loop as functions: against the loop solved in numbers, against differences, and against its poles."""

from pathlib import Path

import numpy as np
import pytest

import firmtouch
from firmtouch.regulation import Controller, closed_loop_acceleration, control_law
from firmtouch.regulation.loop_functions import loop_functions

ROOT = Path(__file__).parents[2]

MODELS = ("planar_3r_circle", "spatial_3r_sphere", "two_arms_bar")
LARGE = ("spatial_6r_plane", "panda_sphere_normal", "dual_arm_box")


@pytest.fixture(scope="module", params=[*MODELS, *(pytest.param(each, marks=pytest.mark.slow) for each in LARGE)])
def loop(request):
    op = firmtouch.find_operating_point(
        firmtouch.derive_plant(firmtouch.read_model(ROOT / "models" / f"{request.param}.yaml").spec)
    )
    return firmtouch.assign_poles(op, op.plant.spec.design)


OTHERS = [pytest.param(each, marks=pytest.mark.slow) for each in Controller if each is not Controller.ENERGY_WITH_FORCE]


@pytest.fixture(scope="module", params=[Controller.ENERGY_WITH_FORCE, *OTHERS], ids=lambda each: each.name.lower())
def found(request, loop):
    return request.param, loop_functions(loop, request.param)


def states(op, rng, count=3):
    for _ in range(count):
        yield op.q_d + rng.uniform(-0.1, 0.1, op.n), rng.uniform(-1, 1, op.n), rng.uniform(-1, 1, op.n)


def test_the_motion_is_that_of_the_equations_solved_in_numbers(found, loop, rng):
    controller, functions = found
    op = loop.operating_point
    law = control_law(op, loop.gains, controller)
    for q, qdot, d in states(op, rng):
        qddot, lambda_ = (each.full().ravel() for each in functions.motion(q, qdot, d))
        wanted = closed_loop_acceleration(op, law, q, qdot, d=d)
        np.testing.assert_allclose(qddot, wanted[0], rtol=1e-8, atol=1e-8)  # M of light wrists loses some digits
        np.testing.assert_allclose(lambda_, wanted[1], rtol=1e-8, atol=1e-8)


def test_the_derivatives_are_those_of_the_motion(found, loop, rng):
    _, functions = found
    op, h = loop.operating_point, 1e-6
    (state,) = states(op, rng, 1)
    q, qdot, d = state
    A, L = (each.full() for each in functions.derivatives(q, qdot, d))
    x = np.concatenate([q, qdot])

    def rate(x):
        qddot, lambda_ = (each.full().ravel() for each in functions.motion(x[: op.n], x[op.n :], d))
        return np.concatenate([x[op.n :], qddot]), lambda_

    for i, e in enumerate(np.eye(2 * op.n)):
        (up, over), (down, under) = rate(x + h * e), rate(x - h * e)
        # Central differences: h^2 of third derivatives, and rounding over h, both of the size of the column.
        size = 1 + np.max(np.abs(A[:, i])) + np.max(np.abs(up))
        np.testing.assert_allclose(A[:, i], (up - down) / (2 * h), rtol=0, atol=3e-6 * size)
        size = 1 + np.max(np.abs(L[:, i])) + np.max(np.abs(over))
        np.testing.assert_allclose(L[:, i], (over - under) / (2 * h), rtol=0, atol=3e-6 * size)


def test_at_rest_the_eigenvalues_are_the_poles_and_the_constraint_twice(loop):
    op = loop.operating_point
    still = np.zeros(op.n)
    A, _ = loop_functions(loop).derivatives(op.q_d, still, still)
    # On {J dq = 0, J dq' = 0} it is the reduced loop; on the rest Phi'' = 0, a double zero that rounding splits.
    V2 = np.kron(np.eye(2), loop.split.V2)
    found = np.linalg.eigvals(V2.T @ A.full() @ V2)
    for pole in loop.poles.reduced:
        assert np.min(np.abs(found - pole)) < 1e-5 * np.max(
            np.abs(loop.poles.reduced)
        )  # double poles: sqrt of rounding
