"""Checks of the constraints at the operating point: Phi(q_d), the rank of J, and f_d in the range of J^T."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from firmtouch.checks.result import CheckResult, at_least, at_most
from firmtouch.checks.subject import Subject
from firmtouch.regulation.operating_point import IN_RANGE, constraint_force_of
from firmtouch.regulation.projection import ON_SURFACE, RANK
from firmtouch.regulation.redundancy import remedy_for, row_dependencies

WELL_CONDITIONED: Final = 1e-6
"""Below this ratio of singular values the multipliers lose half of their digits."""


def on_surface(subject: Subject) -> CheckResult:
    """Phi(q_d) = 0 after projection."""
    if subject.missed is not None:
        return at_most("Phi(q_d) = 0", subject.projection.residual, ON_SURFACE, str(subject.missed))
    moved = subject.projection.moved
    detail = f"the projection moved the given configuration by {moved:.3g}" if moved else "as given"
    if subject.projection.reached is not None:
        detail = subject.projection.reached.in_words()
    scale = max(1.0, float(np.max(np.abs(subject.q_d))))
    return at_most("Phi(q_d) = 0", subject.projection.residual, ON_SURFACE * scale, detail)


def full_rank(subject: Subject) -> CheckResult:
    """J(q_d) has full row rank, and is not nearly singular."""
    J = subject.plant.J(subject.q_d)
    if not np.all(np.isfinite(J)):
        return at_least("rank of J", math.nan, WELL_CONDITIONED, "J(q_d) is not finite")
    singular = np.linalg.svd(J, compute_uv=False)
    ratio = float(singular[-1] / singular[0]) if singular[0] > 0 else 0.0
    found = row_dependencies(subject.plant, J)
    if found.rows:
        remedy = remedy_for(subject.plant, subject.q_d, found) if subject.missed is None else ""
        words = ". ".join(filter(None, (f"rank {found.rank}: {'; '.join(found.words)}", remedy)))
        return at_least("rank of J", ratio if ratio < RANK else 0.0, WELL_CONDITIONED, words)
    condition = f"rank {found.rank} of {subject.plant.m}, condition number {1 / ratio if ratio else math.inf:.3g}"
    return at_least("rank of J", ratio, WELL_CONDITIONED, condition)


def force_in_range(subject: Subject) -> CheckResult:
    """f_d = J^T lambda_d for some lambda_d, Eq. (6)."""
    if subject.plant.spec.operating_point.f_d is None:
        return at_most("f_d in range J^T", 0.0, IN_RANGE, "by construction: lambda_d is given")
    J = subject.plant.J(subject.q_d)
    if not np.all(np.isfinite(J)):
        return at_most("f_d in range J^T", math.nan, IN_RANGE, "J(q_d) is not finite")
    part, outside, _ = constraint_force_of(subject.plant, J)
    listed = ", ".join(f"{each:.4g}" for each in outside)
    return at_most("f_d in range J^T", part, IN_RANGE, f"the part of f_d that no contact can carry is ({listed})")
