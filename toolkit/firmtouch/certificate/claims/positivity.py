"""C > 0, W > 0 and K >= mu D (14), on the full level and on the tangent level."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from flint import arb

from firmtouch.certificate.matrices import BallMatrix, diagonal, identity, is_positive_definite
from firmtouch.certificate.question import Question, Scope, every
from firmtouch.certificate.subject import Balls, Subject
from firmtouch.mechanics import Array


def questions(subject: Subject) -> Iterator[Question]:
    """Ask on the level of the design, and on the tangent level, which is all that is needed near q_d."""
    units, floats, full = subject.asked.units, subject.floats, subject.asked.level == "full"
    C22 = floats.V2.T @ subject.gains.C @ floats.V2
    if full:
        yield _least("C full", lambda b: [b.C], [subject.gains.C], units.damping, subject)
        yield _least("W full", lambda b: [b.W], [subject.gains.W], units.stiffness, subject)
        yield _stiffness(subject, "full")
        yield _least("C tangent", lambda b: [b.C], [C22], units.damping, subject)
        K22 = [floats.V2.T @ K @ floats.V2 for K in floats.K]
        yield _least("K tangent", lambda b: [b.K(each) for each in b.plants], K22, units.stiffness, subject)
    else:
        yield _least("C tangent", lambda b: [b.C], [C22], units.damping, subject)
        yield _stiffness(subject, "tangent")


def _least(
    name: str, matrices: Callable[[Balls], list[BallMatrix]], estimates: Sequence[Array], unit: str, subject: Subject
) -> Question:
    """Ask for the least eigenvalue: X > value I, or, on ker J, Z^T (X - value I) Z > 0 for any basis Z."""
    X, _, level = name.partition(" ")

    def holds(value: float) -> bool | None:
        balls = subject.balls()
        shifted = (each - identity(subject.op.n) * arb(value) for each in matrices(balls))
        return every(is_positive_definite(each if level == "full" else balls.tangent(each)) for each in shifted)

    return Question(
        name,
        f"{X} > 0{'' if level == 'full' else ' on ker J'}: its least eigenvalue",
        Scope.POLYTOPE if X == "K" else Scope.NOMINAL,
        ">",
        0.0,
        unit,
        "LDL^T",
        lambda: min(float(np.linalg.eigvalsh(each)[0]) for each in estimates),
        holds,
    )


def _stiffness(subject: Subject, level: str) -> Question:
    """Ask for K >= mu D; at mu = 0 for K > 0."""
    asked, floats = subject.asked, subject.floats
    mixed = bool(np.any(asked.D != 1))

    def holds(value: float) -> bool | None:
        balls = subject.balls()
        margin = diagonal([arb(each) * arb(value) for each in asked.D.tolist()])
        shifted = (balls.K(plant) - margin for plant in balls.plants)
        return every(is_positive_definite(X if level == "full" else balls.tangent(X)) for X in shifted)

    def estimate() -> float:
        least = []
        for K in floats.K:
            basis = np.diag(asked.D**-0.5)
            if level == "tangent":
                L = np.linalg.cholesky(floats.V2.T @ np.diag(asked.D) @ floats.V2)
                basis = floats.V2 @ np.linalg.inv(L).T
            least.append(float(np.linalg.eigvalsh(basis.T @ K @ basis)[0]))
        return min(least)

    where = "" if level == "full" else " on ker J"
    return Question(
        f"K {level}",
        f"K > mu {'D' if mixed else 'I'}{where}, the margin of (14)",
        Scope.POLYTOPE,
        ">",
        asked.mu,
        "of D" if mixed else asked.units.stiffness,
        "LDL^T",
        estimate,
        holds,
    )
