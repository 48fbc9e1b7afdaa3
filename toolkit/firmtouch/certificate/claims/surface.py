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


def questions(subject: Subject) -> Iterator[Question]:
    """Ask for the point, the constant force, the force loop, the rank of J, and M > 0."""
    op, balls = subject.op, subject.balls

    def near(value: float) -> bool | None:
        return True if balls().point.distance < arb(value) else None

    def full_rank(value: float) -> bool | None:
        J = balls().J
        return is_positive_definite(J * J.transpose() - identity(op.m) * arb(value) ** 2)

    def inertia(value: float) -> bool | None:
        shift = identity(op.n) * arb(value)
        return every(is_positive_definite(plant.M - shift) for plant in balls().plants)

    yield Question(
        "surface",
        "A point of the surface, and only one square to it, lies so near to q_d (largest entry)",
        Scope.NOMINAL,
        "<",
        None,
        subject.asked.units.coordinate,
        "Krawczyk",
        lambda: max(2 * float(np.finfo(float).eps) * float(np.max(np.abs(op.q_d))), 1e-300),
        near,
    )
    scale = max(1.0, float(np.max(np.abs(op.g))), float(np.max(np.abs(op.f_d))))

    def feedforward(value: float) -> bool | None:
        b = balls()
        missed = exact(subject.gains.bias) - (subject.plants.gradient(b.point.q) - b.J.transpose() * b.lambda_d)
        size = largest_size(missed.entries())
        return True if size < arb(value) else None

    def force_loop(value: float) -> bool | None:
        G_f = balls().G_f
        return is_positive_definite(identity(op.m) * (1 - arb(value)) + G_f)

    yield Question(
        "feedforward",
        "The constant force is g - J^T lambda_d but for rounding (largest entry)",
        Scope.NOMINAL,
        "<",
        ROUNDED * scale,
        subject.asked.units.joint_force,
        "enclosure",
        lambda: 4 * float(np.finfo(float).eps) * scale,
        feedforward,
    )
    yield Question(
        "force loop",
        "I + G_f > 0, so that the multipliers follow from the motion: its least eigenvalue",
        Scope.NOMINAL,
        ">",
        0.0,
        "",
        "LDL^T",
        lambda: 1 + float(np.linalg.eigvalsh(subject.gains.G_f)[0]),
        force_loop,
    )
    yield Question(
        "rank",
        "J has full row rank: its least singular value",
        Scope.NOMINAL,
        ">",
        0.0,
        "",
        "LDL^T",
        lambda: float(np.linalg.svd(op.J, compute_uv=False)[-1]),
        full_rank,
    )
    yield Question(
        "inertia",
        "M > 0: its least eigenvalue",
        Scope.POLYTOPE,
        ">",
        0.0,
        "",
        "LDL^T",
        lambda: min(float(np.linalg.eigvalsh(X)[0]) for X in subject.floats.M),
        inertia,
    )
