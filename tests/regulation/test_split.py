"""Tangent and normal coordinates."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from firmtouch.regulation import Gains, close_loop, split_directions

SIZES = st.integers(2, 7).flatmap(lambda n: st.tuples(st.just(n), st.integers(1, n - 1)))
SEEDS = st.integers(0, 2**32 - 1)
EXACT = 1e-13  # products of orthonormal matrices of at most seven columns


@settings(max_examples=40)
@given(SIZES, SEEDS)
def test_the_split_is_orthonormal_and_v2_spans_the_kernel(size, seed):
    J = np.random.default_rng(seed).normal(size=size[::-1])
    split = split_directions(J)
    V = np.hstack([split.V1, split.V2])
    assert np.allclose(V.T @ V, np.eye(len(V)), rtol=0, atol=EXACT)
    assert split.U @ np.diag(split.S) @ split.V1.T == pytest.approx(J, abs=EXACT * np.abs(J).max() * 10)
    assert np.abs(J @ split.V2).max() < EXACT * 10


@settings(max_examples=40)
@given(SIZES, SEEDS)
def test_blocks_and_assemble_are_inverses(size, seed):
    rng = np.random.default_rng(seed)
    split, X = split_directions(rng.normal(size=size[::-1])), rng.normal(size=(size[0], size[0]))
    X = X + X.T
    blocks = split.blocks(X)
    assert split.assemble(blocks) == pytest.approx(X, abs=EXACT * 10)
    again = split.blocks(split.assemble(blocks))
    assert np.allclose(again.X12, blocks.X12, rtol=0, atol=EXACT * 10)
    assert np.linalg.eigvalsh(X) == pytest.approx(
        np.linalg.eigvalsh(np.block([[blocks.X11, blocks.X12], [blocks.X12.T, blocks.X22]])), abs=EXACT * 50
    )


def test_the_signs_of_the_basis_do_not_depend_on_the_sign_of_j(rng):
    J = rng.normal(size=(2, 5))
    one, other = split_directions(J), split_directions(-J)
    assert np.allclose(one.V1, other.V1, rtol=0, atol=EXACT)
    assert np.allclose(one.V2, other.V2, rtol=0, atol=EXACT)


@settings(max_examples=40)
@given(SIZES, SEEDS)
def test_eq_37_holds_for_any_solution_of_the_dae(random_point, random_positive, size, seed):
    n, m = size
    op, rng = random_point(n, m, seed), np.random.default_rng(seed)
    C, K, G_f = (random_positive(k, seed + i) for i, k in enumerate((n, n, m)))
    loop = close_loop(op, Gains(W=K - op.N0, C=C, G_f=G_f, bias=op.g - op.f_d))
    x2, x2_rate = rng.normal(size=(2, n - m))
    dq, dq_rate = loop.split.V2 @ x2, loop.split.V2 @ x2_rate
    # Eqs. (19), (20): M dq'' + C dq' + K dq = J^T (I + G_f) dlambda, J dq'' = 0.
    matrix = np.block([[op.M, -op.J.T @ (np.eye(m) + G_f)], [op.J, np.zeros((m, m))]])
    solution = np.linalg.solve(matrix, np.concatenate([-C @ dq_rate - K @ dq, np.zeros(m)]))
    x2_accel, dlambda = loop.split.V2.T @ solution[:n], solution[n:]
    left = np.diag(loop.split.S) @ loop.split.U.T @ (np.eye(m) + G_f) @ dlambda
    right = sum(loop.split.blocks(X).X12 @ x for X, x in zip((op.M, C, K), (x2_accel, x2_rate, x2), strict=True))
    # Rounding through a solve whose condition number grows with that of J, at most some 1e4 in these draws.
    assert left == pytest.approx(right, abs=1e-9 * max(1, np.abs(right).max()))
    residual = sum(loop.split.blocks(X).X22 @ x for X, x in zip((op.M, C, K), (x2_accel, x2_rate, x2), strict=True))
    assert residual == pytest.approx(np.zeros(n - m), abs=1e-9)  # Eq. (38)
