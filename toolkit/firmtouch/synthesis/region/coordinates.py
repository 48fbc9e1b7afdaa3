"""The coordinates of the search: mass-normalised, in the region's own unit of time, and back again.

x2 = S^-1 z turns M22 into I; counting time in 1/omega turns poles of the size omega into poles of size one. Badly
scaled linear matrix inequalities make interior-point solvers fail, and these are scaled as well as they can be.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen, symmetric
from firmtouch.regulation import OperatingPoint, Split


@dataclass(frozen=True, slots=True)
class Scaling:
    """T (n x (n-m)) with T^T M T = I and J T = 0; joint (n) = sqrt(M_ii); omega in rad/s.

    W = omega^2 D W' D and C = omega D C' D with D = diag(joint); tangent blocks are T^T X T, divided by omega^2 for a
    stiffness and by omega for a damping.
    """

    T: Array
    joint: Array
    omega: float

    def stiffness(self, scaled: Array) -> Array:
        """Turn a scaled stiffness (n x n) into SI."""
        return symmetric(self.omega**2 * scaled * np.outer(self.joint, self.joint))

    def damping(self, scaled: Array) -> Array:
        """Turn a scaled damping (n x n) into SI."""
        return symmetric(self.omega * scaled * np.outer(self.joint, self.joint))

    def scaled_stiffness(self, X: Array) -> Array:
        """Turn a stiffness in SI into a scaled one: the inverse of `stiffness`."""
        return symmetric(X / np.outer(self.joint, self.joint) / self.omega**2)

    def scaled_damping(self, X: Array) -> Array:
        """Turn a damping in SI into a scaled one: the inverse of `damping`."""
        return symmetric(X / np.outer(self.joint, self.joint) / self.omega)

    def tangent(self, X: Array) -> Array:
        """Take the tangent block of a matrix in SI, in mass-normalised coordinates (time in seconds)."""
        return symmetric(self.T.T @ X @ self.T)


def scale(op: OperatingPoint, split: Split, omega: float) -> Scaling:
    """Choose the coordinates for a plant and a reference frequency."""
    S = np.linalg.cholesky(split.V2.T @ op.M @ split.V2).T  # Step 3: M22 = S^T S
    T = scipy.linalg.solve_triangular(S, split.V2.T, trans="T").T
    return Scaling(frozen(T), frozen(np.sqrt(np.diag(op.M))), omega)
