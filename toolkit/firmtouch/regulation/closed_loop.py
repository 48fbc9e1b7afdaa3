"""The linearised closed loop (19)-(20): its poles by two routes, and the positivity of (14) on both levels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen, symmetric
from firmtouch.regulation.gains import Gains
from firmtouch.regulation.operating_point import OperatingPoint
from firmtouch.regulation.split import Split, split_directions


@dataclass(frozen=True, slots=True)
class Poles:
    """The 2(n - m) poles by two routes: of the whole pencil (19)-(20), and of the reduced equation (38)."""

    pencil: tuple[complex, ...]
    reduced: tuple[complex, ...]

    @property
    def disagreement(self) -> float:
        """Largest distance between the two routes, relative to each pole."""
        return pole_distance(self.pencil, self.reduced)


@dataclass(frozen=True, slots=True)
class Positivity:
    """Eigenvalues of K = W + N0, C and W on one level, ascending; `holds` says that those that must be are positive."""

    holds: bool
    K: Array
    C: Array
    W: Array


@dataclass(frozen=True, slots=True)
class ClosedLoop:
    """An operating point with gains: K of (14), the split, the poles, and positivity on the two levels."""

    operating_point: OperatingPoint
    gains: Gains
    split: Split
    K: Array
    poles: Poles
    full: Positivity
    tangent: Positivity


def close_loop(op: OperatingPoint, gains: Gains) -> ClosedLoop:
    """Analyse a controller from its finished gains alone."""
    split = split_directions(op.J)
    K = symmetric(gains.W + op.N0)  # Eq. (14), with P as in (19)
    return ClosedLoop(
        operating_point=op,
        gains=gains,
        split=split,
        K=K,
        poles=Poles(
            pencil=pencil_poles(op.M, gains.C, K, op.J, gains.G_f),
            reduced=reduced_poles(op.M, gains.C, K, split.V2),
        ),
        full=_full(gains, K),
        tangent=_tangent(gains, K, split.V2),
    )


def _full(gains: Gains, K: Array) -> Positivity:
    K_values, C_values, W_values = (frozen(np.linalg.eigvalsh(X)) for X in (K, gains.C, gains.W))
    return Positivity(bool(min(K_values[0], C_values[0], W_values[0]) > 0), K_values, C_values, W_values)


def _tangent(gains: Gains, K: Array, V2: Array) -> Positivity:
    K_values, C_values, W_values = (frozen(np.linalg.eigvalsh(V2.T @ X @ V2)) for X in (K, gains.C, gains.W))
    return Positivity(bool(min(K_values[0], C_values[0]) > 0), K_values, C_values, W_values)


def pencil_poles(M: Array, C: Array, K: Array, J: Array, G_f: Array) -> tuple[complex, ...]:
    """Find the finite eigenvalues of the pencil of Eqs. (19)-(20), with force feedback, in (dq, dq', dlambda).

    The pencil has index three, and QZ would turn each of its infinite eigenvalues into a large finite one. So it is
    shifted and inverted: the finite poles s are 1/mu + sigma for the 2(n - m) largest eigenvalues mu of
    (A - sigma E)^-1 E, at which the infinite ones are zero. sigma > 0 is no pole of a stable loop.
    """
    m, n = J.shape
    scale = np.sqrt(np.linalg.norm(K, 2) / np.linalg.norm(M, 2)) or 1.0  # a pole's size, so that time counts as 1/scale
    stiffness = np.linalg.norm(M, 2) * scale**2
    gradient = J / np.linalg.norm(J, 2)
    E, A = np.zeros((2 * n + m, 2 * n + m)), np.zeros((2 * n + m, 2 * n + m))
    E[:n, :n] = np.eye(n)
    E[n : 2 * n, n : 2 * n] = M * scale**2 / stiffness
    A[:n, n : 2 * n] = np.eye(n)
    A[n : 2 * n, :n] = -K / stiffness
    A[n : 2 * n, n : 2 * n] = -C * scale / stiffness
    A[n : 2 * n, 2 * n :] = gradient.T @ (np.eye(m) + G_f)
    A[2 * n :, :n] = gradient
    sigma = 1.0
    mu = np.linalg.eigvals(np.linalg.solve(A - sigma * E, E))
    finite = mu[np.argsort(-np.abs(mu))][: 2 * (n - m)]
    return _ordered(scale * (1 / finite + sigma))


def reduced_poles(M: Array, C: Array, K: Array, V2: Array) -> tuple[complex, ...]:
    """Find the poles of M22 x2'' + C22 x2' + K22 x2 = 0, Eq. (38), in mass-normalised coordinates."""
    size = V2.shape[1]
    inverse = np.linalg.inv(np.linalg.cholesky(V2.T @ M @ V2))
    C22, K22 = (inverse @ (V2.T @ X @ V2) @ inverse.T for X in (C, K))
    companion = np.block([[np.zeros((size, size)), np.eye(size)], [-K22, -C22]])
    return _ordered(np.linalg.eigvals(companion))


def match_poles(achieved: tuple[complex, ...], requested: tuple[complex, ...]) -> tuple[complex, ...]:
    """Order achieved poles as the requested ones, by the assignment of least total distance."""
    from scipy.optimize import linear_sum_assignment  # checking a certificate needs none of SciPy

    distance = np.abs(np.subtract.outer(np.array(requested), np.array(achieved)))
    _, columns = linear_sum_assignment(distance)
    return tuple(achieved[i] for i in columns)


def pole_distance(achieved: tuple[complex, ...], requested: tuple[complex, ...]) -> float:
    """Give the largest distance between matched poles, each relative to the requested one."""
    matched = match_poles(achieved, requested)
    return max(abs(a - b) / abs(b) if b else abs(a) for a, b in zip(matched, requested, strict=True))


def _ordered(poles: Array) -> tuple[complex, ...]:
    return tuple(sorted((complex(each) for each in poles), key=lambda s: (-s.real, abs(s.imag), s.imag)))
