"""Tangent and normal coordinates of the paper's appendix: dq = V1 x1 + V2 x2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen, symmetric


@dataclass(frozen=True, slots=True)
class Blocks:
    """The blocks of a symmetric X: X11 = V1^T X V1 (m x m), X12 = V1^T X V2, X22 = V2^T X V2."""

    X11: Array
    X12: Array
    X22: Array


@dataclass(frozen=True, slots=True)
class Split:
    """J = U diag(S) V1^T; V2 (n x (n-m)) spans the kernel of J, the directions that the constraints leave free."""

    U: Array
    S: Array
    V1: Array
    V2: Array

    def blocks(self, X: Array) -> Blocks:
        """Take a symmetric matrix apart."""
        return Blocks(
            symmetric(self.V1.T @ X @ self.V1), frozen(self.V1.T @ X @ self.V2), symmetric(self.V2.T @ X @ self.V2)
        )

    def assemble(self, blocks: Blocks) -> Array:
        """Put a symmetric matrix together: the inverse of `blocks`."""
        mixed = self.V1 @ blocks.X12 @ self.V2.T
        return symmetric(self.V1 @ blocks.X11 @ self.V1.T + mixed + mixed.T + self.V2 @ blocks.X22 @ self.V2.T)


def split_directions(J: Array) -> Split:
    """Split the coordinates by the singular value decomposition of J, which must have full row rank.

    The columns' signs are fixed (largest entry positive), so that the same model gives the same split everywhere.
    """
    m = J.shape[0]
    U, S, Vt = np.linalg.svd(J)
    V = Vt.T
    peaks = V[np.argmax(np.abs(V), axis=0), np.arange(V.shape[1])]
    signs = np.where(peaks < 0, -1.0, 1.0)
    V = V * signs
    return Split(frozen(U * signs[:m]), frozen(S), frozen(V[:, :m]), frozen(V[:, m:]))
