"""The decision variables of the search and what is affine in them, as cvxpy expressions in scaled coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import cvxpy as cp
import numpy as np
import scipy.sparse

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen, symmetric
from firmtouch.regulation import OperatingPoint, split_directions
from firmtouch.regulation.lmi_region import LmiRegion
from firmtouch.synthesis.region.coordinates import Scaling

STRICT: Final = 1e-6
"""What a strict inequality asks for, in scaled coordinates: far above the solver's accuracy, far below any margin."""

Constraints = list[Any]
"""cvxpy's constraints."""


@dataclass(frozen=True, slots=True)
class Corner:
    """One vertex of the polytope in scaled coordinates: tangent blocks M22 and N22, and the whole N0 (n x n)."""

    M22: Array
    N22: Array
    N0: Array


@dataclass(frozen=True, slots=True)
class Cushion:
    """Radii of balls around the polytope, in scaled coordinates: what M22 and N22 may lie outside it."""

    M: float = 0.0
    N: float = 0.0
    N_full: float = 0.0


class Variables:
    """W and C (scaled, n x n, zero outside the pattern), eps, and the expressions that the terms are made of."""

    def __init__(
        self, op: OperatingPoint, scaling: Scaling, corners: tuple[Corner, ...], *, pattern: Array, cushion: Cushion
    ) -> None:
        self.scaling, self.corners, self.cushion = scaling, corners, cushion
        self.split = split = split_directions(op.J)
        self.n, self.t = scaling.T.shape
        basis = _symmetric_basis(pattern)
        self.W, self.C = (
            cp.reshape(basis @ cp.Variable(basis.shape[1]), (self.n, self.n), order="F") for _ in range(2)
        )
        self.eps = cp.Parameter(nonneg=True, value=1.0)
        self.tau, self.sigma = cp.Parameter(nonneg=True, value=1.0), cp.Parameter(nonneg=True, value=1.0)
        self.cost = cp.Variable()
        self.frame, self.normal_frame = scaling.joint[:, None] * scaling.T, scaling.joint[:, None] * split.V1
        self.W22, self.C22 = self.frame.T @ self.W @ self.frame, self.frame.T @ self.C @ self.frame
        self.K22 = [self.W22 + corner.N22 for corner in corners]
        self.K = [self.W + corner.N0 for corner in corners]
        self.nominal, self.nominal_M12 = corner_of(op, scaling), frozen(split.V1.T @ op.M @ scaling.T)

    def values(self) -> tuple[Array, Array]:
        """Give W and C as the solver left them, in SI."""
        return self.scaling.stiffness(self.W.value), self.scaling.damping(self.C.value)

    def energy(self, corner: int) -> Any:  # noqa: ANN401  # a cvxpy expression
        """Give Pm = [[K22, eps M22], [eps M22, M22]], [T4]."""
        M, K = self.corners[corner].M22, self.K22[corner]
        return cp.bmat([[K, self.eps * M], [self.eps * M, M]])

    def motion(self, corner: int) -> Any:  # noqa: ANN401  # a cvxpy expression
        """Give Pm A = [[-eps K22, K22 - eps C22], [-K22, eps M22 - C22]], [T4]."""
        M, K, C = self.corners[corner].M22, self.K22[corner], self.C22
        return cp.bmat([[-self.eps * K, K - self.eps * C], [-K, self.eps * M - C]])

    def energy_positive(self, slack: Any = STRICT) -> Constraints:  # noqa: ANN401  # a cvxpy expression
        """Ask for Pm > slack at every corner: positive, it makes V = x^T Pm x / 2 a Lyapunov function."""
        apart = slack + self.cushion.N + self.cushion.M * (1 + self.eps)
        return [self.energy(i) >> apart * np.eye(2 * self.t) for i in range(len(self.corners))]

    def in_region(self, region: LmiRegion, slack: Any = STRICT) -> Constraints:  # noqa: ANN401  # a cvxpy expression
        """Ask for -(L (x) Pm + R (x) PmA + R^T (x) (PmA)^T) > slack at every corner; time counts in 1/omega."""
        size = len(region.L) * 2 * self.t
        constraints = []
        for i in range(len(self.corners)):
            P, PA = self.energy(i), self.motion(i)
            X = _combined(region, P, PA)
            constraints.append(-X >> (slack + self.spread(region)) * np.eye(size))
        return constraints

    def spread(self, region: LmiRegion) -> Any:  # noqa: ANN401  # a number or a cvxpy expression
        """Bound how much the balls around the polytope can change a region's inequality: |c (x) X| = |c| |X|."""
        if self.cushion.M == 0 and self.cushion.N == 0:
            return 0.0
        L, R = np.linalg.norm(region.L, 2), 2 * np.linalg.norm(region.R, 2)
        of_M = L * (1 + self.eps) + R * self.eps
        of_N = L + R * (1 + self.eps)
        return self.cushion.M * of_M + self.cushion.N * of_N


def _combined(region: LmiRegion, P: Any, PA: Any) -> Any:  # noqa: ANN401  # cvxpy expressions
    """Give L (x) P + R (x) PA + R^T (x) (PA)^T, block by block, so that eps stays a parameter."""
    L, R = region.L, region.R
    size = len(L)
    return cp.bmat(
        [[float(L[i, j]) * P + float(R[i, j]) * PA + float(R[j, i]) * PA.T for j in range(size)] for i in range(size)]
    )


def _symmetric_basis(pattern: Array) -> scipy.sparse.csc_array:
    """Map the free entries (on and above the diagonal, where the pattern allows) to a symmetric matrix, by columns."""
    n = len(pattern)
    entries = [(i, j) for j in range(n) for i in range(j + 1) if pattern[i, j]]
    rows = [place for i, j in entries for place in {i + n * j, j + n * i}]
    columns = [k for k, (i, j) in enumerate(entries) for _ in {i + n * j, j + n * i}]
    return scipy.sparse.csc_array((np.ones(len(rows)), (rows, columns)), shape=(n * n, len(entries)))


def corner_of(op: OperatingPoint, scaling: Scaling) -> Corner:
    """Scale one vertex."""
    return Corner(
        scaling.tangent(op.M),
        symmetric(scaling.tangent(op.N0) / scaling.omega**2),
        frozen(scaling.scaled_stiffness(op.N0)),
    )
