"""The guaranteed quadratic cost of a region design [T5], by a Lyapunov matrix for every vertex.

V = x^T P x with A^T P + P A < -(Q + U^T U) bounds the cost by the largest V of a start; x = (x2, dx2/d(unit t)).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from flint import arb

from firmtouch.certificate.claims.poles import companion
from firmtouch.certificate.lyapunov import solve_lyapunov
from firmtouch.certificate.matrices import (
    BallMatrix,
    blocks,
    diagonal,
    exact,
    is_positive_definite,
    middle,
    symmetrised,
)
from firmtouch.certificate.question import Question, Scope, every
from firmtouch.certificate.subject import Subject
from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile.sections.region import NO_WEIGHT, CostSpec

ROOM: Final = 1e-9
"""By which part the Lyapunov equation is overdone, so that its inequality is strict."""


def questions(subject: Subject) -> Iterator[Question]:
    """Ask for the cost of the worst start, where the design has one."""
    region = subject.asked.region
    if region is None or region.cost is None:
        return
    cost = _Cost(subject, region.cost)
    yield Question(
        "guaranteed cost",
        "The quadratic cost of every start in the ellipsoid, in the linearised loop",
        Scope.VERTICES,
        "<",
        region.cost.at_most,
        "s",
        "Lyapunov",
        cost.estimate,
        cost.holds,
        sufficient=True,
    )


@dataclass(frozen=True, slots=True)
class _Cost:
    """The weights of a cost by Bryson's rule, on ker J, and what a Lyapunov matrix makes of them."""

    subject: Subject
    spec: CostSpec

    def holds(self, value: float) -> bool | None:
        """Tell whether the cost is below a value for all plants."""
        balls, E, rate = self.subject.balls(), self._starts(), self._rate()
        answers = []
        for i in range(len(balls.plants)):
            found = self._lyapunov(i)
            if found is None:
                return None
            P, A = symmetrised(exact(found)), companion(self.subject, balls, i)
            falls = -(A.transpose() * P + P * A) - rate
            answers += [is_positive_definite(symmetrised(falls)), is_positive_definite(E * arb(value) - P)]
        return every(answers)

    def estimate(self) -> float:
        """Give the largest cost of a start, in floats."""
        L, worst = np.linalg.cholesky(middle(self._starts())), 0.0
        for i in range(len(self.subject.tangents)):
            P = self._lyapunov(i)
            if P is None:
                return np.inf
            half = np.linalg.solve(L, np.linalg.solve(L, P).T)
            worst = max(worst, float(np.linalg.norm((half + half.T) / 2, 2)))
        return worst

    def _lyapunov(self, i: int) -> Array | None:
        rate = middle(self._rate())
        overdone = rate + ROOM * float(np.linalg.norm(rate, 2)) * np.eye(len(rate))
        return solve_lyapunov(self.subject.tangents[i].companion(), overdone)

    def _rate(self) -> BallMatrix:
        """Give Q + U^T U with U = R^(1/2) [W X, C X]; time counts in 1/unit."""
        X, unit, gains = self.subject.balls().X, arb(self.subject.unit), self.subject.gains
        R = diagonal([1 / arb(each) for each in self._values(self.spec.torque).tolist()])
        U = blocks([[R * exact(gains.W) * X, R * exact(gains.C) * X * unit]])
        Q = self._both(self.spec.position, self.spec.velocity)
        return symmetrised(Q + U.transpose() * U) / unit

    def _starts(self) -> BallMatrix:
        """Give the inverse shape of the ellipsoid of starts."""
        return self._both(self.spec.start_position, self.spec.start_velocity)

    def _both(self, position: dict[str, float], velocity: dict[str, float] | None) -> BallMatrix:
        """Weigh positions and velocities by 1/value^2."""
        X, unit = self.subject.balls().X, arb(self.subject.unit)
        first, second = (
            X.transpose() * diagonal([1 / arb(each) ** 2 for each in self._values(values).tolist()]) * X
            for values in (position, velocity)
        )
        zero = first * 0
        return symmetrised(blocks([[first, zero], [zero, second * unit**2]]))

    def _values(self, values: dict[str, float] | None) -> Array:
        names = self.subject.op.plant.spec.coordinates
        return frozen([NO_WEIGHT if values is None else values[name] for name in names])
