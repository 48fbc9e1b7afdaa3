"""The blocks X12 and X11 of C and K, which the poles leave free: [T1], [T2], [T3]."""

from __future__ import annotations

from typing import Final

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen, symmetric
from firmtouch.modelfile.sections.design import NormalBlocks
from firmtouch.regulation.split import Blocks

CLEARLY_POSITIVE: Final = 1e-6
"""The part of the largest stiffness below which W22 counts as zero: K11, and its rounding, grow with its inverse."""


def mixed_block(X22: Array, M: Blocks, policy: NormalBlocks) -> Array:
    """Choose X12: M12 M22^-1 X22 makes the right side of Eq. (37) vanish [T1], zero rejects disturbances best [T2].

    A blend takes `weight` times the first.
    """
    weight = {"decouple": 1.0, "reject": 0.0}.get(policy.policy, policy.weight or 0.0)
    return frozen(weight * M.X12 @ np.linalg.solve(M.X22, X22))


def damping_blocks(C22: Array, M: Blocks, policy: NormalBlocks) -> Blocks:
    """Complete C22 to C with least eigenvalue at least `margin` times that of C22."""
    C12 = mixed_block(C22, M, policy)
    return Blocks(least_normal_block(C12, C22, policy.margin), C12, C22)


def stiffness_blocks(K22: Array, M: Blocks, N0: Blocks, policy: NormalBlocks) -> Blocks:
    """Complete K22 to K so that K and W = K - N0 have least eigenvalues of `margin` times those of K22 and W22.

    Where W22 itself is not clearly positive definite no K11 of sensible size can make W so, and K alone is completed.
    """
    K12 = mixed_block(K22, M, policy)
    needed = least_normal_block(K12, K22, policy.margin)
    W22 = symmetric(K22 - N0.X22)
    if np.linalg.eigvalsh(W22)[0] > CLEARLY_POSITIVE * max(np.linalg.norm(K22, 2), np.linalg.norm(N0.X22, 2)):
        needed = _upper_bound(needed, least_normal_block(K12 - N0.X12, W22, policy.margin) + N0.X11)
    return Blocks(needed, K12, K22)


def least_normal_block(X12: Array, X22: Array, margin: float) -> Array:
    """Give the least X11 with [[X11, X12], [X12^T, X22]] >= t I for t = margin * (least eigenvalue of X22) [T3].

    By the Schur complement X11 = t I + X12 (X22 - t I)^-1 X12^T.
    """
    t = margin * float(np.linalg.eigvalsh(X22)[0])
    shifted = X22 - t * np.eye(X22.shape[0])
    return symmetric(t * np.eye(X12.shape[0]) + X12 @ np.linalg.solve(shifted, X12.T))


def _upper_bound(A: Array, B: Array) -> Array:
    """Give A + (B - A)_+, the matrix of least trace above both A and B."""
    values, vectors = np.linalg.eigh(B - A)
    return symmetric(A + (vectors * np.maximum(values, 0)) @ vectors.T)
