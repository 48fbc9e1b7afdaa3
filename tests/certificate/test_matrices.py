"""Matrices of balls, and LDL^T against eigenvalues of 60 digits."""

import mpmath as mp
import numpy as np
from flint import arb, arb_mat
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.certificate.exactly import DIGITS, eigenvalues, matrix, matrix_holds, pivots

from firmtouch.certificate.decision import PRECISIONS, Verdict, decide
from firmtouch.certificate.matrices import (
    blocks,
    by_columns,
    diagonal,
    exact,
    identity,
    is_positive_definite,
    kronecker,
    largest_size,
    middle,
    norm_is_within,
    symmetrised,
)

sizes, seeds = st.integers(1, 6), st.integers(0, 10**6)


def draw(n, seed, *, low=-1.0):
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(n, n)))
    X = turn @ np.diag(rng.uniform(low, 3, n)) @ turn.T
    return (X + X.T) / 2


def decided(X):
    return decide(lambda: is_positive_definite(X))[0]


def test_floats_are_taken_as_they_are():
    values = np.array([[0.1, 1e300], [-1e-300, 5e-324]])
    for i, j in np.ndindex(2, 2):
        entry = exact(values)[i, j]
        assert entry.is_exact()
        assert float(entry.mid()) == values[i, j]
    assert (exact([1.0, 2.0]).nrows(), exact([1.0, 2.0]).ncols()) == (2, 1)


def test_entries_are_counted_by_columns():
    assert middle(by_columns([arb(k) for k in range(6)], 2, 3)).tolist() == [[0, 2, 4], [1, 3, 5]]


def test_blocks_and_products_are_numpys(rng):
    A, B, C, D = (rng.integers(-9, 9, shape).astype(float) for shape in ((2, 3), (2, 1), (4, 3), (4, 1)))
    assert np.array_equal(middle(blocks([[exact(A), exact(B)], [exact(C), exact(D)]])), np.block([[A, B], [C, D]]))
    assert np.array_equal(middle(kronecker(exact(A), exact(C))), np.kron(A, C))
    assert np.array_equal(middle(identity(3)), np.eye(3))
    assert np.array_equal(middle(diagonal([1.0, arb(2)])), np.diag([1.0, 2.0]))
    square = rng.integers(-9, 9, (3, 3)).astype(float)
    assert np.array_equal(middle(symmetrised(exact(square))), (square + square.T) / 2)


def test_the_largest_size_is_a_bound_and_no_number_where_one_entry_is_none():
    found = largest_size([arb(1, 0.5), arb(-2, 0.25), arb(0)])
    assert arb(2.25) <= found <= arb(2.26)
    assert largest_size([]) == 0
    for entries in ([arb.nan(), arb(1)], [arb(1), arb.nan()]):
        assert not largest_size(entries) < arb(10)


@given(n=sizes, seed=seeds)
def test_the_verdict_is_that_of_the_eigenvalues(n, seed):
    X = draw(n, seed)
    least = eigenvalues(matrix(X))[0]
    assert abs(least) > 1e-14
    assert decided(exact(X)) is (Verdict.PROVEN if least > 0 else Verdict.REFUTED)


@settings(max_examples=60)
@given(n=sizes, seed=seeds, power=st.integers(3, 40), above=st.booleans())
def test_a_hair_beside_an_eigenvalue_decides(n, seed, power, above):
    """The shift is 10^-power above or below the true least eigenvalue; more bits tell what 64 do not."""
    X = draw(n, seed)
    least = eigenvalues(matrix(X))[0]
    with mp.workdps(DIGITS):
        text = mp.nstr(least + mp.mpf(10) ** -power * (1 if above else -1), DIGITS)
    verdict, bits = decide(lambda: is_positive_definite(exact(X) - identity(n) * arb(text)))
    assert verdict is (Verdict.REFUTED if above else Verdict.PROVEN)
    assert bits in PRECISIONS
    assert bits > 64 or power < 22


def test_a_singular_matrix_is_never_proven():
    """Rank one, exactly: its second pivot is exactly zero, or a ball around it."""
    assert decided(exact([[1.0, 2.0], [2.0, 4.0]])) is Verdict.REFUTED
    third = arb_mat([[arb(9), arb(3)], [arb(3), arb(1)]]) * (1 / arb(3))
    assert decided(third) is not Verdict.PROVEN
    assert decided(exact([[0.0]])) is Verdict.REFUTED
    assert decided(exact(np.zeros((3, 3)))) is Verdict.REFUTED


def test_only_what_is_certain_is_answered():
    """Three answers: a matrix of balls holds matrices of both kinds, or of one only."""
    assert is_positive_definite(arb_mat([[arb(1, 0.5)]])) is True
    assert is_positive_definite(arb_mat([[arb(-1, 0.5)]])) is False
    assert is_positive_definite(arb_mat([[arb(0, 0.5)]])) is None
    assert is_positive_definite(arb_mat([[arb(0.5, 0.5)]])) is None
    assert is_positive_definite(arb_mat([[arb.nan()]])) is None
    assert is_positive_definite(arb_mat([[arb(1), arb(0)], [arb(0), arb.nan()]])) is None
    assert is_positive_definite(arb_mat([[arb(1), arb.nan()], [arb.nan(), arb(-1)]])) is None
    assert is_positive_definite(arb_mat([[arb.pos_inf()]])) is not False
    # A first pivot that may be negative leaves the second one open, although that is certainly negative alone.
    assert is_positive_definite(arb_mat([[arb(0, 1), arb(0)], [arb(0), arb(-1)]])) is None


@settings(max_examples=80)
@given(n=st.integers(2, 5), seed=seeds, radius=st.floats(-12, -0.5).map(lambda x: 10.0**x))
def test_an_answer_is_true_for_every_symmetric_matrix_in_the_balls(n, seed, radius):
    X, rng = draw(n, seed), np.random.default_rng(seed)
    answer = is_positive_definite(arb_mat(n, n, [arb(x, radius) for x in X.ravel().tolist()]))
    if answer is None:
        return
    for _ in range(8):
        move = rng.choice([-1.0, 1.0], size=(n, n)) * radius
        with mp.workdps(DIGITS):
            moved = matrix(X) + matrix(np.tril(move) + np.tril(move, -1).T)
            assert (pivots(moved)[-1] > 0) is answer


@settings(max_examples=60)
@given(rows=st.integers(1, 4), columns=st.integers(1, 4), seed=seeds, part=st.sampled_from([1e-13, 1e-6, 0.1]))
def test_a_norm_is_within_what_is_above_its_singular_values(rows, columns, seed, part):
    A = np.random.default_rng(seed).normal(size=(rows, columns))
    with mp.workdps(DIGITS):
        largest = mp.sqrt(eigenvalues(matrix(A).T * matrix(A))[-1])
        above, below = (arb(mp.nstr(largest * (1 + sign * mp.mpf(part)), 40)) for sign in (1, -1))
    assert decide(lambda: norm_is_within(exact(A), above))[0] is Verdict.PROVEN
    assert decide(lambda: norm_is_within(exact(A), below))[0] is Verdict.REFUTED


def test_no_norm_is_within_nothing():
    assert norm_is_within(exact([[0.0]]), arb(0)) is not True
    assert norm_is_within(exact([[1.0]]), arb(-2)) is not True
    assert norm_is_within(exact([[0.0]]), arb(1e-300)) is True


@given(n=st.integers(1, 4), seed=seeds)
def test_products_and_inverses_hold_the_true_ones(n, seed):
    rng = np.random.default_rng(seed)
    A, B = rng.normal(size=(n, n)), rng.normal(size=(n, n))
    with mp.workdps(DIGITS):
        assert matrix_holds(exact(A) * exact(B), matrix(A) * matrix(B))
        assert matrix_holds(exact(A).inv(), mp.inverse(matrix(A)), mp.mpf(10) ** -40)


def test_deciding_takes_as_many_bits_as_it_needs():
    asked = []

    def answers(*given):
        left = iter(given)
        return lambda: (asked.append(1), next(left))[1]

    assert decide(answers(True)) == (Verdict.PROVEN, 64)
    assert decide(answers(None, None, False)) == (Verdict.REFUTED, 256)
    assert decide(answers(*[None] * 5)) == (Verdict.UNDECIDED, 1024)
    assert len(asked) == 9
