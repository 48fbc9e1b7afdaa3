"""The poles by four routes: the shifted pencil, the reduced equation, the raw pencil, and the nonlinear loop."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given, settings
from hypothesis import strategies as st

from firmtouch.regulation import Gains, close_loop, closed_loop_acceleration, control_law, split_directions
from firmtouch.regulation.closed_loop import match_poles, pencil_poles, pole_distance, reduced_poles
from firmtouch.regulation.controllers import Controller

SIZES = st.integers(2, 7).flatmap(lambda n: st.tuples(st.just(n), st.integers(1, n - 1)))
SEEDS = st.integers(0, 2**32 - 1)
NEARLY_DOUBLE = 1e-6  # two poles that nearly meet move by the square root of rounding


@pytest.fixture(scope="session")
def random_loop(random_point, random_positive):
    def draw(n, m, seed, **spread):
        op = random_point(n, m, seed)
        C, K = (random_positive(n, seed + i, **spread) for i in (1, 2))
        return close_loop(op, Gains(W=K - op.N0, C=C, G_f=random_positive(m, seed + 3), bias=op.g - op.f_d))

    return draw


@pytest.fixture(scope="session")
def second_order():
    """Make M, C, K and J whose reduced equation has the given factors s^2 + c s + k, in random coordinates."""

    def make(factors, m, seed):
        rng = np.random.default_rng(seed)
        size = len(factors)
        n = size + m
        V, _ = np.linalg.qr(rng.normal(size=(n, n)))
        X = rng.normal(size=(n, n))
        M = X @ X.T + np.eye(n)
        V1, V2 = V[:, :m], V[:, m:]
        L = np.linalg.cholesky(V2.T @ M @ V2)
        turn, _ = np.linalg.qr(rng.normal(size=(size, size)))
        half = V2 @ L @ turn
        C, K = (half @ np.diag([each[i] for each in factors]) @ half.T + V1 @ V1.T for i in (0, 1))
        return M, C, K, rng.normal(size=(m, m)) @ V1.T, V2

    return make


@settings(max_examples=60)
@given(SIZES, SEEDS)
def test_the_pencil_and_the_reduced_equation_have_the_same_poles(random_loop, size, seed):
    loop = random_loop(*size, seed)
    assert len(loop.poles.pencil) == len(loop.poles.reduced) == 2 * (size[0] - size[1])
    assert loop.poles.disagreement < NEARLY_DOUBLE
    assert max(each.real for each in loop.poles.pencil) < 0  # C > 0 and K > 0


@settings(max_examples=30)
@given(SIZES, SEEDS, st.floats(0, 1e4))
def test_the_poles_do_not_depend_on_force_feedback(random_loop, random_positive, size, seed, gain):
    loop = random_loop(*size, seed)
    op, gains = loop.operating_point, loop.gains
    G_f = gain * random_positive(size[1], seed)
    assert pole_distance(pencil_poles(op.M, gains.C, loop.K, op.J, G_f), loop.poles.reduced) < NEARLY_DOUBLE


@settings(max_examples=30)
@given(SIZES, SEEDS)
def test_scipys_raw_pencil_has_the_same_small_poles_among_its_large_ones(random_loop, size, seed):
    (n, m), loop = size, random_loop(*size, seed)
    op, gains, Z = loop.operating_point, loop.gains, np.zeros
    E = scipy.linalg.block_diag(np.eye(n), op.M, Z((m, m)))
    A = np.block(
        [
            [Z((n, n)), np.eye(n), Z((n, m))],
            [-loop.K, -gains.C, op.J.T @ (np.eye(m) + gains.G_f)],
            [op.J, Z((m, n)), Z((m, m))],
        ]
    )
    values = scipy.linalg.eig(A, E, right=False)
    finite = values[np.isfinite(values)]
    smallest = tuple(finite[np.argsort(np.abs(finite))][: 2 * (n - m)])
    # QZ loses digits next to the index-three infinity, whose eigenvalues come out near eps^(-1/3).
    assert pole_distance(smallest, loop.poles.reduced) < 1e-5


def test_trap_1_an_arm_with_two_joints_on_a_wall_has_two_poles_not_four(make_arm, loop_of):
    loop = loop_of(make_arm(2, {"wall": "0.55 - x(p2)"}, [1.0, -0.9], design={"poles": [-7, -7.5]}))
    assert np.sort(np.real(loop.poles.pencil)) == pytest.approx([-7.5, -7], rel=1e-9)
    assert max(np.abs(loop.gains.W).max(), np.abs(loop.gains.C).max()) < 1e4  # 1e11 where noise is placed


def factors_of(poles):
    return [(-(a + b).real, (a * b).real) for a, b in zip(poles[::2], poles[1::2], strict=True)]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("poles", "tolerance"),
    [
        ([-3, -3], 1e-6),  # a double pole moves by the square root of rounding, times conditioning
        ([-3, -3, -3, -3, -3, -3], 1e-6),  # no chain is longer than two
        ([-2 + 5j, -2 - 5j] * 3, 1e-9),  # complex ones repeated in different modes are semisimple
        ([-2 + 5j, -2 - 5j, -4, -6], 1e-9),
        ([5j, -5j, 0.5, -2], 1e-9),  # unstable ones are found too
    ],
)
def test_repeated_complex_and_unstable_poles_are_found(second_order, poles, tolerance, seed):
    M, C, K, J, V2 = second_order(factors_of(poles), 2, seed)
    for found in (pencil_poles(M, C, K, J, 0.5 * np.eye(2)), reduced_poles(M, C, K, V2)):
        assert pole_distance(found, tuple(map(complex, poles))) < tolerance


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    "poles",
    [[-0.01, -1e4], [-0.01, -0.02, -1e3, -1e4], [-0.01, -1e4, -1, -30], [-100 + 1e4j, -100 - 1e4j, -0.01, -0.5]],
)
def test_time_scales_from_100_s_to_100_us_are_each_found_well(second_order, poles, seed):
    M, C, K, J, V2 = second_order(factors_of(poles), 2, seed)
    wanted = np.array(poles, dtype=complex)
    for found in (pencil_poles(M, C, K, J, 0.5 * np.eye(2)), reduced_poles(M, C, K, V2)):
        each = np.array(match_poles(found, tuple(wanted)))
        # Gains of size 1e8 are rounded to 1e-8, so a k of 2e-4 keeps only some four digits.
        assert (np.abs(each - wanted) / np.abs(wanted)).max() < 1e-4


def manifold_rate(op, law, z, z_rate):
    """Give z'' of the nonlinear loop in q = q_d + V2 z + V1 y(z), with y found by Newton's method."""
    split, plant = split_directions(op.J), op.plant
    q = op.q_d + split.V2 @ z
    for _ in range(6):
        q = q - split.V1 @ np.linalg.solve(plant.J(q) @ split.V1, plant.Phi(q))
    J = plant.J(q)
    tangent = split.V2 - split.V1 @ np.linalg.solve(J @ split.V1, J @ split.V2)
    acceleration, _ = closed_loop_acceleration(op, law, q, tangent @ z_rate, d=np.zeros(op.n))
    return split.V2.T @ acceleration


def linearised_by_differences(op, law, h):
    """Give [A_z, A_z'] of z'' = A_z z + A_z' z' by central differences of the nonlinear loop."""
    size = op.n - op.m
    rate = lambda x: manifold_rate(op, law, x[:size], x[size:])  # noqa: E731
    return np.column_stack([(rate(h * e) - rate(-h * e)) / (2 * h) for e in np.eye(2 * size)])


@pytest.mark.parametrize("controller", Controller)
def test_the_nonlinear_loop_on_the_manifold_has_eq_38_as_its_linearisation(loop, controller, observed_order):
    op, law = loop.operating_point, control_law(loop.operating_point, loop.gains, controller)
    M22, C22, K22 = (loop.split.blocks(X).X22 for X in (op.M, loop.gains.C, loop.K))
    reduced = -np.linalg.solve(M22, np.hstack([K22, C22]))  # Eq. (38)

    def error(h):
        return np.abs(linearised_by_differences(op, law, h) - reduced).max() / np.abs(reduced).max()

    assert error(1e-4) < 1e-5  # second order in the step, times third derivatives of the loop
    assert observed_order(error, 8e-3, exact=1e-9) > 1.9  # below 1e-9 there is only rounding over the step


def test_trap_2_the_poles_hold_lambda_times_the_hessian(arm_on_circle, loop_of):
    loop = loop_of(arm_on_circle)
    op, V2 = loop.operating_point, loop.split.V2
    lower = linearised_by_differences(op, control_law(op, loop.gains, Controller.AFFINE), 1e-4)
    true = tuple(np.linalg.eigvals(np.vstack([np.eye(4)[2:], lower])))
    assert pole_distance(true, loop.poles.reduced) < 1e-6  # differences of step 1e-4
    assert pole_distance(true, reduced_poles(op.M, loop.gains.C, loop.gains.W + op.P_qq, V2)) > 0.05
