"""Bounds of steady-state errors, exact in first order: section 5's table and [T6], in a form that needs no K > 0.

With X any basis of ker J, J+ = J^T (J J^T)^-1, Lambda = (I + G_f)^-1 and T = X (X^T K X)^-1 X^T,

    dq / d = T                        dlambda / d = -Lambda J+^T (I - K T)
    dq / Delta = (I - T K) J+         dlambda / Delta = Lambda J+^T K (I - T K) J+

which are Eqs. (25), (26), (31) and (32). A tilt E acts as the force E^T lambda_d; a rotation moves no position.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final

import flint
import numpy as np
from flint import arb

from firmtouch.certificate.decision import PRECISIONS
from firmtouch.certificate.matrices import (
    BallMatrix,
    diagonal,
    exact,
    identity,
    is_positive_definite,
    middle,
    norm_is_within,
)
from firmtouch.certificate.plants import PlantBalls
from firmtouch.certificate.question import Question, Scope, every
from firmtouch.certificate.subject import Balls, Subject

TINY: Final = 1e-300
"""Bounds an error that is exactly zero."""

Matrix = Callable[[Balls, PlantBalls], BallMatrix]


def questions(subject: Subject) -> Iterator[Question]:
    """Ask for the worst errors under the causes that the file bounds; a region's own bounds at every vertex."""
    asked, op = subject.asked, subject.op
    causes, units, region = asked.causes, asked.units, asked.region
    tilt = _Tilt(causes.tilt)
    force = region.force_error if region is not None else None
    bounds: Mapping[str, float | None] = {
        "position error under force": region.position_error if region is not None else None,
        "force error under force": force.disturbance if force is not None else None,
        "force error under offset": force.offset if force is not None else None,
    }
    disturbance, offset = exact(np.diag(causes.disturbance)), exact(np.diag(causes.offset))
    rows: list[tuple[str, str, Matrix]] = [
        ("position error under force", units.coordinate, lambda b, plant: _position(b, plant) * disturbance),
        ("force error under force", units.multiplier, lambda b, plant: _force(b, plant) * disturbance),
        ("position error under offset", units.coordinate, lambda b, plant: _offset(b, plant) * offset),
        ("force error under offset", units.multiplier, lambda b, plant: _offset_force(b, plant) * offset),
        ("position error under tilt", units.coordinate, lambda b, plant: _position(b, plant) * tilt.radius(b)),
        ("force error under tilt", units.multiplier, lambda b, plant: _force(b, plant) * tilt.radius(b)),
    ]
    if op.m > 1:
        rows.append(("force error under rotation", units.multiplier, lambda b, _: _rotated(b, causes.rotation)))
    for name, unit, matrix in rows:
        yield _question(subject, name, unit, matrix, bounds.get(name))


def _question(subject: Subject, name: str, unit: str, matrix: Matrix, asked: float | None) -> Question:
    everywhere = asked is not None

    def plants(balls: Balls) -> tuple[PlantBalls, ...]:
        return balls.plants if everywhere else (balls.nominal,)

    def holds(value: float) -> bool | None:
        balls = subject.balls()
        return every(norm_is_within(matrix(balls, each), arb(value)) for each in plants(balls))

    def estimate() -> float:
        with flint.ctx.workprec(PRECISIONS[1]):
            balls = subject.balls()
            return max(TINY, *(_norm(matrix(balls, each)) for each in plants(balls)))

    scope = Scope.VERTICES if everywhere else Scope.NOMINAL
    words = name.capitalize().replace(" under ", " at rest under the worst ") + ": its norm"
    return Question(name, words, scope, "<", asked, unit, "LDL^T", estimate, holds)


def _norm(X: BallMatrix) -> float:
    """Estimate it, not below what the balls leave open: it may be zero (no tilt, no force, a singular K)."""
    left_open = np.array([float(entry.rad()) for entry in X.entries()])
    return float(np.linalg.norm(middle(X), 2)) + 4 * float(np.linalg.norm(left_open))


def _position(balls: Balls, plant: PlantBalls) -> BallMatrix:
    """Eq. (25)."""
    return balls.X * balls.tangent(balls.K(plant)).inv() * balls.X.transpose()


def _force(balls: Balls, plant: PlantBalls) -> BallMatrix:
    """Eq. (26)."""
    K, n = balls.K(plant), balls.X.nrows()
    return -(balls.Lambda * balls.J_plus.transpose() * (identity(n) - K * _position(balls, plant)))


def _offset(balls: Balls, plant: PlantBalls) -> BallMatrix:
    """Eq. (31)."""
    K, n = balls.K(plant), balls.X.nrows()
    return (identity(n) - _position(balls, plant) * K) * balls.J_plus


def _offset_force(balls: Balls, plant: PlantBalls) -> BallMatrix:
    """Eq. (32)."""
    return balls.Lambda * balls.J_plus.transpose() * balls.K(plant) * _offset(balls, plant)


def _rotated(balls: Balls, angle: float) -> BallMatrix:
    """Eq. (36) in first order: (R^T - I) lambda_d lies in the ball of radius angle |lambda_d| normal to lambda_d."""
    lambda_d, m = balls.lambda_d, balls.lambda_d.nrows()
    square = (lambda_d.transpose() * lambda_d)[0, 0]
    if square.is_zero():
        return identity(m) * 0
    along = lambda_d * lambda_d.transpose()
    return balls.Lambda * (identity(m) * square - along) * (arb(angle) / square.sqrt())


@dataclass(frozen=True, slots=True)
class _Tilt:
    """E with |E| <= angle |J| (2-norms): d = E^T lambda_d fills the ball of radius angle |J| |lambda_d|."""

    angle: float

    def radius(self, balls: Balls) -> BallMatrix:
        """Give the radius times I; |J| is bounded by the largest eigenvalue of J J^T, from above."""
        n, m = balls.J.ncols(), balls.J.nrows()
        product = balls.J * balls.J.transpose()
        size = float(np.linalg.norm(middle(product), 2))
        bound = arb(size) * (1 + arb(2) ** -40)
        if is_positive_definite(identity(m) * bound - product) is not True:
            bound = product.trace()
        lambda_d = balls.lambda_d
        square = (lambda_d.transpose() * lambda_d)[0, 0]
        return diagonal([(bound * square).sqrt() * arb(self.angle)] * n)
