"""Where one frame is in another, in numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from firmtouch.mechanics.arrays import Array, Vector, frozen

EXACT_ZERO = float(np.finfo(np.float64).eps)
"""Entries of a rotation below this are zeros: pi / 2 in a file is itself wrong by as much. It saves operations."""


@dataclass(frozen=True, slots=True)
class Placement:
    """A point x of the inner frame is at R x + p in the outer one; R (3 x 3) is a rotation, p (3) in metres."""

    R: Array
    p: Array

    def __matmul__(self, inner: Placement) -> Placement:
        """Give the placement of a frame that `inner` places in this one."""
        return Placement(_rotation(self.R @ inner.R), frozen(self.R @ inner.p + self.p))


def placement(xyz: Vector = (0.0, 0.0, 0.0), rpy: Vector = (0.0, 0.0, 0.0)) -> Placement:
    """Place a frame at xyz (metres), turned by R = Rz(yaw) Ry(pitch) Rx(roll) (radians)."""
    roll, pitch, yaw = rpy
    R = turn((0, 0, 1), yaw) @ turn((0, 1, 0), pitch) @ turn((1, 0, 0), roll)
    return Placement(_rotation(R), frozen(xyz))


def turn(axis: Vector, angle: float) -> Array:
    """Give the rotation by an angle about a unit vector a: a a^T + cos (1 - a a^T) + sin [a x]."""
    a = np.asarray(axis, dtype=np.float64)
    along = np.outer(a, a)
    return _rotation(along + np.cos(angle) * (np.eye(3) - along) + np.sin(angle) * cross_matrix(a))


def cross_matrix(a: Array) -> Array:
    """Give [a x] (3 x 3)."""
    x, y, z = a
    return frozen([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _rotation(R: Array) -> Array:
    return frozen(np.where(np.abs(R) < EXACT_ZERO, 0.0, R))
