"""Ten numbers of a rigid body, linear in its mass distribution, so that bodies that move together just add."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import Array, Vector, frozen
from firmtouch.mechanics.tree.placement import Placement, cross_matrix


@dataclass(frozen=True, slots=True)
class SpatialInertia:
    """Mass (kg), first moment h = m c (3, kg m), and the inertia I about the frame's origin (3 x 3, kg m^2)."""

    mass: ca.SX
    moment: ca.SX
    tensor: ca.SX

    def moved(self, R: ca.SX, p: ca.SX) -> SpatialInertia:
        """Give it in an outer frame, where this one's is at R x + p: I - [p][h] - [h][p] - m [p][p] there."""
        h, P = R @ self.moment, ca.skew(p)
        crossed = P @ ca.skew(h)
        tensor = R @ self.tensor @ R.T - crossed - crossed.T - self.mass * P @ P
        return SpatialInertia(self.mass, h + self.mass * p, tensor)

    def __add__(self, other: SpatialInertia) -> SpatialInertia:
        """Give that of both bodies together."""
        return SpatialInertia(self.mass + other.mass, self.moment + other.moment, self.tensor + other.tensor)


@dataclass(frozen=True, slots=True)
class BodyInertia:
    """The same in numbers."""

    mass: float
    moment: Array
    tensor: Array

    def __add__(self, other: BodyInertia) -> BodyInertia:
        """Give that of both bodies together."""
        return BodyInertia(
            self.mass + other.mass, frozen(self.moment + other.moment), frozen(self.tensor + other.tensor)
        )

    def symbolic(self) -> SpatialInertia:
        """Give it as constants of CasADi."""
        return SpatialInertia(ca.SX(self.mass), ca.SX(ca.DM(self.moment)), ca.SX(ca.DM(self.tensor)))


NOTHING = BodyInertia(0.0, frozen(np.zeros(3)), frozen(np.zeros((3, 3))))


def body_inertia(mass: float, about_centre: Array, at: Placement) -> BodyInertia:
    """Give the inertia of a body in the frame where `at` places its centre of mass and the axes of `about_centre`."""
    C = cross_matrix(at.p)
    return BodyInertia(mass, frozen(mass * at.p), frozen(at.R @ about_centre @ at.R.T - mass * C @ C))


def symmetric_tensor(entries: Vector) -> Array:
    """Give the 3 x 3 matrix of ixx, ixy, ixz, iyy, iyz, izz."""
    ixx, ixy, ixz, iyy, iyz, izz = entries
    return frozen([[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
