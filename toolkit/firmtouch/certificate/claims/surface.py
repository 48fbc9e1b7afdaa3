"""q_d is a point of the surface but for rounding; there the constraints are independent, and M is an inertia."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
from flint import arb

from firmtouch.certificate.matrices import exact, identity, is_positive_definite, largest_size
from firmtouch.certificate.question import Question, Scope, every
from firmtouch.certificate.subject import Subject

ROUNDED: Final = 1e-9
"""What the feedforward may miss of forces of size one."""
EPSILON: Final = float(np.finfo(float).eps)
TINY: Final = 1e-300
"""Bounds a distance that is exactly zero."""


def questions(subject: Subject) -> Iterator[Question]:
    """Ask for the point, the constant force, the force loop, the rank of J, and M > 0."""
    yield _point(subject)
    yield _feedforward(subject)
    yield _force_loop(subject)
    yield _rank(subject)
    yield _inertia(subject)


def _point(subject: Subject) -> Question:
    size = float(np.max(np.abs(subject.op.q_d)))
    return Question(
        "surface",
        "A point of the surface, and only one square to it, lies so near to q_d (largest entry)",
        Scope.NOMINAL,
        "<",
        None,
        subject.asked.units.coordinate,
        "Krawczyk",
        lambda: max(2 * EPSILON * size, TINY),
        lambda value: True if subject.balls().point.distance < arb(value) else None,
    )


def _feedforward(subject: Subject) -> Question:
    scale = max(1.0, float(np.max(np.abs(subject.op.g))), float(np.max(np.abs(subject.op.f_d))))

    def holds(value: float) -> bool | None:
        balls = subject.balls()
        exactly = subject.plants.gradient(balls.point.q) - balls.J.transpose() * balls.lambda_d
        missed = largest_size((exact(subject.gains.bias) - exactly).entries())
        return True if missed < arb(value) else None

    return Question(
        "feedforward",
        "The constant force is g - J^T lambda_d but for rounding (largest entry)",
        Scope.NOMINAL,
        "<",
        ROUNDED * scale,
        subject.asked.units.joint_force,
        "enclosure",
        lambda: 4 * EPSILON * scale,
        holds,
    )


def _force_loop(subject: Subject) -> Question:
    m = subject.op.m
    return Question(
        "force loop",
        "I + G_f > 0, so that the multipliers follow from the motion: its least eigenvalue",
        Scope.NOMINAL,
        ">",
        0.0,
        "",
        "LDL^T",
        lambda: 1 + float(np.linalg.eigvalsh(subject.gains.G_f)[0]),
        lambda value: is_positive_definite(identity(m) * (1 - arb(value)) + subject.balls().G_f),
    )


def _rank(subject: Subject) -> Question:
    def holds(value: float) -> bool | None:
        J = subject.balls().J
        return is_positive_definite(J * J.transpose() - identity(subject.op.m) * arb(value) ** 2)

    return Question(
        "rank",
        "J has full row rank: its least singular value",
        Scope.NOMINAL,
        ">",
        0.0,
        "",
        "LDL^T",
        lambda: float(np.linalg.svd(subject.op.J, compute_uv=False)[-1]),
        holds,
    )


def _inertia(subject: Subject) -> Question:
    def holds(value: float) -> bool | None:
        shift = identity(subject.op.n) * arb(value)
        return every(is_positive_definite(plant.M - shift) for plant in subject.balls().plants)

    return Question(
        "inertia",
        "M > 0: its least eigenvalue",
        Scope.POLYTOPE,
        ">",
        0.0,
        "",
        "LDL^T",
        lambda: min(float(np.linalg.eigvalsh(X)[0]) for X in subject.floats.M),
        holds,
    )
