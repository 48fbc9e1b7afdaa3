"""A point of the surface, proven: q* near q_d with Phi(q*) = 0, which q_d itself satisfies only to rounding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import casadi as ca
import flint
import numpy as np
from flint import arb, arb_mat

from firmtouch.certificate.matrices import BallMatrix, blocks, by_columns, exact, identity, largest_size, middle
from firmtouch.mechanics import Array, Plant
from firmtouch.mechanics.balls import BALLS, Ball
from firmtouch.mechanics.tape import record
from firmtouch.regulation import split_directions

NEWTON_STEPS: Final = 12
ROOM: Final = 4
"""The box that is tried, in lengths of the last Newton step."""


class NoRootError(Exception):
    """At this precision no root was proven."""


@dataclass(frozen=True, slots=True)
class SurfacePoint:
    """The only q* with Phi(q*) = 0 and V2^T (q* - q_d) = 0 in a box: `q` are balls that hold it.

    `distance` bounds |q*_i - q_di|.
    """

    q: list[Ball]
    distance: Ball


class Surface:
    """Phi and J of a plant as tapes, and the proof of a root by Krawczyk's operator.

    F(q) = (Phi(q), V2^T (q - q_d)) has the Jacobian [J(q); V2^T]. With R an approximate inverse of it, c a point and B
    a box around it, c - R F(c) + (I - R F'(B)) (B - c) in the interior of B proves that B holds exactly one root.
    """

    def __init__(self, plant: Plant, q_d: Array) -> None:
        self.n, self.m, self.q_d = plant.n, plant.m, exact(q_d)
        self._p = [arb(each) for each in plant.p.tolist()]
        q, p = ca.SX.sym("q", plant.n), ca.SX.sym("p", plant.p.size)
        Phi, J = plant.functions["Phi"](q, p), plant.functions["J"](q, p)
        self._value = record(ca.Function("Phi", [q, p], [Phi]), BALLS)
        self._slope = record(ca.Function("PhiJ", [q, p], [J]), BALLS)
        self._V2 = exact(split_directions(plant.J(q_d)).V2)

    def J(self, q: list[Ball]) -> BallMatrix:
        """Enclose J(q), m x n."""
        return by_columns(self._slope(q, self._p)[0], self.m, self.n)

    def root(self) -> SurfacePoint:
        """Prove a root at the precision of the moment, as closely as that allows.

        Raises
        ------
        NoRootError
            If the operator does not map the box into itself.
        """
        c, tiny = self.q_d, arb(2) ** (8 - flint.ctx.prec)
        for _ in range(NEWTON_STEPS):
            try:
                step = self._jacobian(c).solve(self._F(c)).mid()
            except ZeroDivisionError as error:
                raise NoRootError from error
            c = (c - step).mid()
            length = largest_size(step.entries())
            if not length.is_finite():
                raise NoRootError
            if length < tiny:
                break
        size = 1 + largest_size(c.entries())
        radius = (ROOM * (length + tiny * size)).upper()
        box = arb_mat(self.n, 1, [arb(each, radius) for each in c.entries()])
        R = exact(np.linalg.inv(middle(self._jacobian(c))))
        image = c - R * self._F(c) + (identity(self.n) - R * self._jacobian(box)) * (box - c)
        inside = zip(box.entries(), image.entries(), strict=True)
        smooth = all(each.is_finite() for each in self._F(box).entries())  # the slope of atan2 does not show its jump
        if not smooth or not all(each.contains_interior(found) for each, found in inside):
            raise NoRootError
        q = image.entries()
        return SurfacePoint(q, largest_size((image - self.q_d).entries()))

    def _F(self, q: BallMatrix) -> BallMatrix:  # as in the docstring
        Phi = by_columns(self._value(q.entries(), self._p)[0], self.m, 1)
        return blocks([[Phi], [self._V2.transpose() * (q - self.q_d)]])

    def _jacobian(self, q: BallMatrix) -> BallMatrix:
        return blocks([[self.J(q.entries())], [self._V2.transpose()]])
