"""Lyapunov matrices for one plant, in floats: where they come from does not matter, as they are proven afterwards.

For an edge of the region, P > 0 with

    decay rate     -(P A + A^T P) - 2 alpha P > 0
    damping ratio  -(P H + H* P) > 0,  H = e^(i phi) A,  phi = pi/2 - th   (P Hermitian)
    bandwidth      w^2 P - A^T P A > 0

exists if and only if all eigenvalues of A lie inside; each is solved with the identity on the right.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from flint import arb

from firmtouch.certificate.edges import Edge, EdgeKind
from firmtouch.certificate.matrices import BallMatrix, blocks, exact, is_positive_definite, symmetrised

Matrix = np.ndarray[Any, np.dtype[Any]]

STEPS: Final = 60
SETTLED: Final = 1e-12
DIVERGED: Final = 1e30
REFINEMENTS: Final = 2


def lyapunov_matrix(A: Matrix, edge: Edge) -> Matrix | None:
    """Find P for an edge, Hermitian and with the largest eigenvalue one; none if the iteration comes to no end."""
    match edge.kind:
        case EdgeKind.DECAY:
            P = solve_lyapunov(A + edge.value * np.eye(len(A)), np.eye(len(A)))
        case EdgeKind.DAMPING:
            P = solve_lyapunov((np.sqrt(1 - edge.value**2) + 1j * edge.value) * A, np.eye(len(A)))
        case EdgeKind.BANDWIDTH:
            P = _discrete(A / edge.value)
    if P is None or not np.all(np.isfinite(P)):
        return None
    P = (P + P.conj().T) / 2
    size = float(np.linalg.norm(P, 2))
    return P / size if size > 0 else None


def proves(P: Matrix, A: BallMatrix, edge: Edge) -> bool | None:
    """Tell whether P is positive definite and satisfies the inequality of the edge; a no says nothing about A."""
    value = arb(edge.value)
    real, imaginary = exact(P.real), exact(P.imag)
    match edge.kind:
        case EdgeKind.DECAY:
            inequality = -(real * A + A.transpose() * real) - real * (2 * value)
            return _both(is_positive_definite(real), is_positive_definite(symmetrised(inequality)))
        case EdgeKind.BANDWIDTH:
            inequality = real * (value * value) - A.transpose() * real * A
            return _both(is_positive_definite(real), is_positive_definite(symmetrised(inequality)))
        case EdgeKind.DAMPING:
            sine = (1 - value * value).sqrt()
            P2 = _real_form(real, imaginary)
            H = _real_form(A * sine, A * value)
            inequality = -(P2 * H + H.transpose() * P2)
            return _both(is_positive_definite(P2), is_positive_definite(symmetrised(inequality)))


def _real_form(real: BallMatrix, imaginary: BallMatrix) -> BallMatrix:
    """Write X + i Y as [[X, -Y], [Y, X]]: a Hermitian matrix is positive definite if and only if this is."""
    return blocks([[real, -imaginary], [imaginary, real]])


def _both(first: bool | None, second: bool | None) -> bool | None:
    return True if first and second else None


def solve_lyapunov(A: Matrix, Q: Matrix) -> Matrix | None:
    """Solve A* P + P A = -Q for a stable A, refined by what is left: near the edge floats lose half their digits."""
    P = _by_sign(A, Q)
    for _ in range(REFINEMENTS):
        if P is None or not np.all(np.isfinite(P)):
            return None
        more = _by_sign(A, A.conj().T @ P + P @ A + Q)
        P = P if more is None else P + (more + more.conj().T) / 2
    return P


def _by_sign(A: Matrix, Q: Matrix) -> Matrix | None:
    """Solve it by Newton's scaled iteration for the sign of a matrix (Roberts 1980)."""
    Q = Q.astype(A.dtype)
    for _ in range(STEPS):
        try:
            inverse = np.linalg.inv(A)
        except np.linalg.LinAlgError:
            return None
        scale = np.sqrt(np.linalg.norm(inverse) / np.linalg.norm(A))
        A, before = (scale * A + inverse / scale) / 2, A
        Q = (scale * Q + inverse.conj().T @ Q @ inverse / scale) / 2
        if np.linalg.norm(A - before) <= SETTLED * np.linalg.norm(A):
            break
    return Q / 2


def _discrete(A: Matrix) -> Matrix | None:
    """Solve P - A^T P A = I, refined in the same way."""
    one = np.eye(len(A))
    P = _by_doubling(A, one)
    for _ in range(REFINEMENTS):
        if P is None:
            return None
        more = _by_doubling(A, one - P + A.T @ P @ A)
        P = P if more is None else P + (more + more.T) / 2
    return P


def _by_doubling(A: Matrix, Q: Matrix) -> Matrix | None:
    """Solve P - A^T P A = Q by doubling (Smith 1968)."""
    P: Matrix = Q
    for _ in range(STEPS):
        more = A.T @ P @ A
        P, A = P + more, A @ A
        if np.linalg.norm(more) <= SETTLED * np.linalg.norm(P):
            return P
        if np.linalg.norm(more) > DIVERGED:
            return None
    return None
