"""What the constraints' curvature does: the open-loop poles with and without sum of lambda_dj Phi_j''."""

from __future__ import annotations

import numpy as np

from firmtouch.checks.result import CheckResult, told
from firmtouch.checks.subject import Subject
from firmtouch.mechanics import Array
from firmtouch.regulation.operating_point import operating_point_at
from firmtouch.regulation.split import split_directions

NAME = "lambda-Hessian"


def curvature_matters(subject: Subject) -> CheckResult:
    """Compare M22 s^2 + N0_22 = 0 with what a linearisation that drops lambda would find."""
    plant = subject.plant
    J, M = plant.J(subject.q_d), plant.M(subject.q_d)
    usable = subject.missed is None and np.all(np.isfinite(M)) and np.linalg.eigvalsh(M)[0] > 0
    if not usable or np.linalg.matrix_rank(J) < plant.m:
        return told(NAME, "not computed: there is no regular operating point")
    op = operating_point_at(plant, subject.projection, subject.lambda_d)
    V2 = split_directions(J).V2
    true, dropped = (squared_poles(V2.T @ op.M @ V2, V2.T @ X @ V2) for X in (op.N0, op.P_qq))
    if not np.all(np.isfinite([*true, *dropped])):
        return told(NAME, "not computed: the stiffness is not finite")
    words = f"open-loop poles {in_words(true)}; without the term {in_words(dropped)}"
    if bool(np.all(true < 0)) != bool(np.all(dropped < 0)):
        words += " (dropping it would turn the verdict on stability)"
    return told(NAME, words)


def squared_poles(M22: Array, N22: Array) -> Array:
    """Give s^2 for M22 s^2 + N22 = 0, ascending."""
    inverse = np.linalg.inv(np.linalg.cholesky(M22))
    return -np.linalg.eigvalsh(inverse @ N22 @ inverse.T)[::-1]


def in_words(squared: Array) -> str:
    """Write poles +-sqrt(s^2) as real or imaginary numbers."""
    return ", ".join(f"±{np.sqrt(abs(each)):.4g}{'j' if each < 0 else ''}" for each in squared)
