"""What the constraints' curvature does: the open-loop poles with and without sum of lambda_dj Phi_j''."""

from __future__ import annotations

import numpy as np

from firmtouch.checks.inertia import NEARLY_SINGULAR
from firmtouch.checks.result import CheckResult, told
from firmtouch.checks.subject import Subject
from firmtouch.mechanics import Array
from firmtouch.regulation.operating_point import operating_point_at
from firmtouch.regulation.split import split_directions

NAME = "lambda-Hessian"
ROUNDING = 1e-13
"""What is this much smaller than the largest s^2 is zero but for rounding."""


def curvature_matters(subject: Subject) -> CheckResult:
    """Compare M22 s^2 + N0_22 = 0 with what a linearisation that drops lambda would find."""
    if not _regular(subject):
        return told(NAME, "not computed: there is no regular operating point")
    op = operating_point_at(subject.plant, subject.projection, subject.lambda_d)
    V2 = split_directions(op.J).V2
    blocks = [V2.T @ X @ V2 for X in (op.M, op.N0, op.P_qq)]
    if not np.all(np.isfinite(blocks)):
        return told(NAME, "not computed: the stiffness is not finite")
    M22, N22, P22 = blocks
    true, dropped = squared_poles(M22, N22), squared_poles(M22, P22)
    words = f"open-loop poles {in_words(true)}; without the term {in_words(dropped)}"
    if bool(np.all(true < 0)) != bool(np.all(dropped < 0)):
        words += " (dropping it would turn the verdict on stability)"
    return told(NAME, words)


def _regular(subject: Subject) -> bool:
    """Tell whether q_d lies on the constraints, J has full rank there, and M is positive definite."""
    J, M = subject.plant.J(subject.q_d), subject.plant.M(subject.q_d)
    if subject.missed is not None or not (np.all(np.isfinite(J)) and np.all(np.isfinite(M))):
        return False
    masses = np.linalg.eigvalsh(M)
    return bool(masses[0] > NEARLY_SINGULAR * masses[-1] and np.linalg.matrix_rank(J) == subject.plant.m)


def squared_poles(M22: Array, N22: Array) -> Array:
    """Give s^2 for M22 s^2 + N22 = 0, ascending."""
    inverse = np.linalg.inv(np.linalg.cholesky(M22))
    return -np.linalg.eigvalsh(inverse @ N22 @ inverse.T)[::-1]


def in_words(squared: Array) -> str:
    """Write poles +-sqrt(s^2) as real or imaginary numbers; what is zero but for rounding is written so."""
    nothing = ROUNDING * float(np.max(np.abs(squared), initial=0.0))
    return ", ".join(
        "±0" if abs(each) <= nothing else f"±{np.sqrt(abs(each)):.4g}{'j' if each < 0 else ''}" for each in squared
    )
