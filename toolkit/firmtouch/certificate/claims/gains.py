"""The bounds that a region design sets to its gains, and its guaranteed cost."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any, Final

import numpy as np
from flint import arb
from numpy.typing import NDArray

from firmtouch.certificate.claims.poles import companion, companion_floats
from firmtouch.certificate.lyapunov import solve_lyapunov
from firmtouch.certificate.matrices import (
    BallMatrix,
    blocks,
    diagonal,
    exact,
    is_positive_definite,
    middle,
    norm_is_within,
    symmetrised,
)
from firmtouch.certificate.question import Question, Scope, every
from firmtouch.certificate.subject import Subject
from firmtouch.mechanics import Array
from firmtouch.modelfile.sections.region import CostSpec, TorqueLimit
from firmtouch.modelfile.vector_units import joint_units

Holds = Callable[[float], bool | None]

FREE: Final = 1e9
"""What is acceptable of a velocity that costs nothing, in SI."""
ROOM: Final = 1e-9
"""By which part the Lyapunov equation of the cost is overdone, so that its inequality is strict."""


def questions(subject: Subject) -> Iterator[Question]:
    """Ask for symmetry, and for all bounds of a region design."""
    region, units, gains = subject.asked.region, subject.asked.units, subject.gains
    yield _symmetry(subject)
    if region is None:
        return
    yield _structure(subject, np.array(region.structure.pattern))
    for name, X, bound, unit in (
        ("W", gains.W, region.W, units.stiffness), ("C", gains.C, region.C, units.damping)
    ):  # fmt: skip
        if bound is not None and bound.norm is not None:
            yield _norm(name, X, bound.norm, unit)
        for i, joint in enumerate(subject.op.plant.spec.coordinates):
            if bound is not None and joint in (bound.joints or {}):
                assert bound.joints is not None
                yield _entry(subject, name, X, i, bound.joints[joint])
    for label, limit in region.torque.items():
        for i in range(subject.op.n):
            yield _torque(subject, label, limit, i)
    if region.cost is not None:
        yield _cost(subject, region.cost)


def _symmetry(subject: Subject) -> Question:
    gains = subject.gains

    def holds(value: float) -> bool:
        return all(float(np.max(np.abs(X - X.T))) <= value for X in (gains.W, gains.C, gains.G_f))

    words = "W, C and G_f are symmetric: the largest difference of two entries"
    return _bound("symmetry", words, asked=0.0, unit="", figure=0.0, holds=holds, route="comparison")


def _structure(subject: Subject, pattern: NDArray[np.bool_]) -> Question:
    gains = subject.gains

    def holds(value: float) -> bool:
        return all(float(np.max(np.abs(X[~pattern]), initial=0.0)) <= value for X in (gains.W, gains.C))

    words = "W and C are zero where the structure has them so: the largest entry there"
    return _bound("structure", words, asked=0.0, unit="", figure=0.0, holds=holds, route="comparison")


def _bound(name: str, words: str, *, asked: float, unit: str, figure: float, holds: Holds, route: str) -> Question:
    return Question(name, words, Scope.NOMINAL, "<", asked, unit, route, lambda: figure, holds)


def _norm(name: str, X: Array, asked: float, unit: str) -> Question:
    def holds(value: float) -> bool | None:
        return norm_is_within(exact(X), arb(value))

    figure = float(np.linalg.norm(X, 2))
    words = f"The norm of {name}"
    return _bound(f"norm of {name}", words, asked=asked, unit=unit, figure=figure, holds=holds, route="LDL^T")


def _entry(subject: Subject, name: str, X: Array, i: int, asked: float) -> Question:
    joint, coordinate = list(subject.op.plant.spec.coordinates.items())[i]
    own, size = joint_units(coordinate.unit), abs(float(X[i, i]))
    unit = own.stiffness if name == "W" else own.damping
    words = f"The entry of {name} at {joint}"

    def holds(value: float) -> bool:
        return size <= value

    name = f"{name} of {joint}"
    return _bound(name, words, asked=asked, unit=unit, figure=size, holds=holds, route="comparison")


def _torque(subject: Subject, label: str, limit: TorqueLimit, i: int) -> Question:
    joint, coordinate = list(subject.op.plant.spec.coordinates.items())[i]
    names = list(subject.op.plant.spec.coordinates)
    position, velocity = (
        [(errors or {}).get(each, 0.0) for each in names] for errors in (limit.position, limit.velocity)
    )

    def total() -> Any:  # noqa: ANN401  # a ball
        rows = ((subject.gains.W[i], position), (subject.gains.C[i], velocity))
        return sum(
            (abs(arb(x)) * arb(e) for row, errors in rows for x, e in zip(row.tolist(), errors, strict=True)), arb(0)
        )

    def holds(value: float) -> bool | None:
        found = total()
        return True if found <= arb(value) else False if found > arb(value) else None

    return _bound(
        f"torque of {joint}, {label}",
        f"The torque that the feedback asks of {joint}, {label}",
        asked=limit.at_most[joint],
        unit=joint_units(coordinate.unit).joint_force,
        figure=float(total().mid()),
        holds=holds,
        route="sum",
    )


def _cost(subject: Subject, cost: CostSpec) -> Question:
    """Bound the cost by the largest V = x^T P x of a start, where A^T P + P A < -(Q + U^T U)."""
    spec = subject.op.plant.spec

    def diagonal_of(values: Mapping[str, float] | None) -> Array:
        return np.array([(values or {}).get(name, FREE) for name in spec.coordinates])

    position, velocity, torque = (diagonal_of(each) for each in (cost.position, cost.velocity, cost.torque))
    start = (diagonal_of(cost.start_position), diagonal_of(cost.start_velocity))
    unit = subject.unit

    def weights(X: BallMatrix, square: Callable[[Array], BallMatrix]) -> tuple[BallMatrix, BallMatrix, BallMatrix]:
        """Give Q and the inverse shape of the ellipsoid for x = (x2, dx2/d(unit t)), and U."""
        u2 = arb(unit) ** 2

        def both(a: Array, b: Array) -> BallMatrix:
            first, second = X.transpose() * square(a) * X, X.transpose() * square(b) * X * u2
            zero = first * 0
            return symmetrised(blocks([[first, zero], [zero, second]]))

        R = diagonal([1 / arb(each) for each in torque.tolist()])
        U = blocks([[R * exact(subject.gains.W) * X, R * exact(subject.gains.C) * X * arb(unit)]])
        return both(position, velocity), both(*start), U

    def inverse_squares(values: Array) -> BallMatrix:
        return diagonal([1 / arb(each) ** 2 for each in values.tolist()])

    def at(i: int) -> tuple[BallMatrix, BallMatrix, Array | None, BallMatrix]:
        balls = subject.balls()
        Q, E, U = weights(balls.X, inverse_squares)
        rate = symmetrised(Q + U.transpose() * U) / arb(unit)  # time counts in 1/unit
        floats = middle(rate)
        overdone = floats + ROOM * float(np.linalg.norm(floats, 2)) * np.eye(len(floats))
        return rate, E, solve_lyapunov(companion_floats(subject, i), overdone), companion(subject, balls, i)

    def holds(value: float) -> bool | None:
        answers = []
        for i in range(len(subject.floats.M)):
            rate, E, P_, A = at(i)
            if P_ is None:
                return None
            P = symmetrised(exact(P_))
            falls = -(A.transpose() * P + P * A) - rate
            answers += [is_positive_definite(symmetrised(falls)), is_positive_definite(E * arb(value) - P)]
        return every(answers)

    def estimate() -> float:
        worst = 0.0
        for i in range(len(subject.floats.M)):
            _, E, P, _ = at(i)
            if P is None:
                return np.inf
            L = np.linalg.cholesky(middle(E))
            half = np.linalg.solve(L, np.linalg.solve(L, P).T)
            worst = max(worst, float(np.linalg.norm((half + half.T) / 2, 2)))
        return worst

    return Question(
        "guaranteed cost",
        "The quadratic cost of every start in the ellipsoid, in the linearised loop",
        Scope.VERTICES,
        "<",
        cost.at_most,
        "s",
        "Lyapunov",
        estimate,
        holds,
        sufficient=True,
    )
