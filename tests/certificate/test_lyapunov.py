"""Lyapunov matrices: they prove an edge if and only if all eigenvalues lie inside."""

import numpy as np
import pytest
from flint import arb, arb_mat
from hypothesis import given, settings
from hypothesis import strategies as st

from firmtouch.certificate.edges import Edge, EdgeKind
from firmtouch.certificate.lyapunov import lyapunov_matrix, proves, solve_lyapunov
from firmtouch.certificate.matrices import exact

seeds = st.integers(0, 10**6)


def draw(seed, n):
    """Draw A with eigenvalues in the left half plane, well apart, and what they reach."""
    rng = np.random.default_rng(seed)
    blocks, size = np.zeros((n, n)), 0
    while size < n:
        a, b = -rng.uniform(0.5, 4), rng.uniform(0.2, 4)
        if size + 1 < n and rng.random() < 0.6:
            blocks[size : size + 2, size : size + 2] = [[a, b], [-b, a]]
            size += 2
        else:
            blocks[size, size] = a
            size += 1
    turn, _ = np.linalg.qr(rng.normal(size=(n, n)))
    turn = turn @ np.diag(rng.uniform(0.5, 2, n))  # not normal, and not so far from it that floats lose 1e-6
    return turn @ blocks @ np.linalg.inv(turn)


def reached(A, kind):
    values = [kind.of_pole(complex(s)) for s in np.linalg.eigvals(A)]
    return min(values) if kind.relation == ">=" else max(values)


@settings(max_examples=30)
@given(seed=seeds, n=st.integers(1, 6), part=st.sampled_from([1e-6, 1e-3, 0.3]))
@pytest.mark.parametrize("kind", EdgeKind)
def test_it_proves_what_is_inside_and_nothing_else(kind, seed, n, part):
    """A part of 1e-6 on either side of what the eigenvalues reach, whose own rounding is far less."""
    A = draw(seed, n)
    value, sign = reached(A, kind), -1 if kind.relation == ">=" else 1
    inner, outer = (Edge(kind, value * (1 + each * part)) for each in (sign, -sign))
    P = lyapunov_matrix(A, inner)
    assert P is not None
    assert np.array_equal(P, P.conj().T)
    assert np.linalg.norm(P, 2) == pytest.approx(1)
    assert proves(P, exact(A), inner) is True
    if kind is not EdgeKind.DAMPING or outer.value < 1:
        assert proves(P, exact(A), outer) is not True
        other = lyapunov_matrix(A, outer)
        assert other is None or proves(other, exact(A), outer) is not True


@given(seed=seeds, n=st.integers(1, 5))
def test_the_equation_is_solved(seed, n):
    A = draw(seed, n)
    Q = np.random.default_rng(seed).normal(size=(n, n))
    Q = Q @ Q.T
    P = solve_lyapunov(A, Q)
    assert np.allclose(A.T @ P + P @ A, -Q, atol=1e-8 * (1 + np.linalg.norm(P) * np.linalg.norm(A)))


@pytest.mark.parametrize("kind", EdgeKind)
@settings(max_examples=30)
@given(seed=seeds, n=st.integers(2, 4))
def test_no_matrix_at_all_proves_an_eigenvalue_outside(kind, seed, n):
    """Whatever P somebody brings: random ones, the identity, and nearly the right one."""
    A, rng = draw(seed, n), np.random.default_rng(seed)
    value = reached(A, kind)
    edge = Edge(kind, value * (1.01 if kind.relation == ">=" else 0.99))
    if kind is EdgeKind.DAMPING and value > 0.98:
        return
    X = rng.normal(size=(n, n)) + 1j * rng.normal(size=(n, n)) * (kind is EdgeKind.DAMPING)
    nearly = lyapunov_matrix(A, Edge(kind, value * (0.98 if kind.relation == ">=" else 1.02)))
    for P in (X @ X.conj().T, np.eye(n, dtype=X.dtype), nearly, -nearly, nearly * 0):
        assert proves(P, exact(A), edge) is not True


def test_an_indefinite_matrix_proves_nothing():
    """-P of an unstable A would satisfy the inequality itself."""
    A = np.diag([1.0, 2.0])
    P = -np.eye(2)
    assert proves(P, exact(A), Edge(EdgeKind.DECAY, 0.0)) is not True
    assert proves(np.zeros((2, 2)), exact(-A), Edge(EdgeKind.DECAY, 0.0)) is not True


def test_uncertain_matrices_are_not_proven():
    A = arb_mat([[arb(-1, 2)]])
    assert proves(np.eye(1), A, Edge(EdgeKind.DECAY, 0.0)) is not True
    assert proves(np.eye(1), arb_mat([[arb.nan()]]), Edge(EdgeKind.DECAY, 0.0)) is not True
    assert proves(np.eye(1), arb_mat([[arb(-1, 0.5)]]), Edge(EdgeKind.DECAY, 0.0)) is True


@pytest.mark.parametrize(
    ("A", "edge"),
    [
        (np.zeros((2, 2)), Edge(EdgeKind.DECAY, 0.0)),
        (np.zeros((2, 2)), Edge(EdgeKind.DAMPING, 0.5)),
        (np.diag([0.0, -1.0]), Edge(EdgeKind.DECAY, 0.0)),
        (np.array([[0.0, 1.0], [-1.0, 0.0]]), Edge(EdgeKind.DECAY, 0.0)),
        (np.array([[0.0, 1.0], [-1.0, 0.0]]), Edge(EdgeKind.BANDWIDTH, 1.0)),
        (np.diag([-2.0, -1.0]), Edge(EdgeKind.BANDWIDTH, 2.0)),
        (np.diag([2.0, -1.0]), Edge(EdgeKind.DECAY, 0.0)),
    ],
)
def test_eigenvalues_on_the_edge_and_beyond_come_to_no_proof(A, edge):
    P = lyapunov_matrix(A, edge)
    assert P is None or proves(P, exact(A), edge) is not True


def test_a_defective_matrix_is_proven_too():
    A = np.array([[-1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [0.0, 0.0, -1.0]])
    for edge in (Edge(EdgeKind.DECAY, 0.99), Edge(EdgeKind.BANDWIDTH, 1.01), Edge(EdgeKind.DAMPING, 0.9)):
        assert proves(lyapunov_matrix(A, edge), exact(A), edge) is True
