"""Symmetry of the gains, and the bounds that a region design sets to them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from flint import arb
from numpy.typing import NDArray

from firmtouch.certificate.matrices import exact, norm_is_within
from firmtouch.certificate.question import Question, Scope
from firmtouch.certificate.subject import Subject
from firmtouch.mechanics import Array
from firmtouch.modelfile.sections.region import TorqueLimit
from firmtouch.modelfile.vector_units import joint_units

Holds = Callable[[float], bool | None]


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
