"""Where the closed loop comes to rest under constant errors: the rows of Eqs. (25), (26), (31), (32), (35), (36).

All are exact in first order, with Lambda = (I + G_f)^-1 and T = V2 K22^-1 V2^T.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen
from firmtouch.modelfile.sections.bounds import Bounds
from firmtouch.regulation.closed_loop import ClosedLoop


@dataclass(frozen=True, slots=True)
class WorstCase:
    """The largest effect of causes within the bound, and the cause and effect (as vectors) where it is taken."""

    value: float
    cause: Array
    effect: Array


@dataclass(frozen=True, slots=True)
class SteadyStateError:
    """One row of the table: dq_ss = position @ cause, dlambda_ss = constraint_force @ cause.

    `bound` describes the set of causes for the worst cases; `given` says whether the file gave it (else it is 1 in SI).
    """

    position: Array
    constraint_force: Array
    worst_position: WorstCase
    worst_constraint_force: WorstCase
    bound: float | Array
    given: bool


@dataclass(frozen=True, slots=True)
class SteadyState:
    """Errors due to a constant force d (and wrong gravity, which acts as one), an offset Phi = Delta, a rotation
    J -> R J (the cause is (R^T - I) lambda_d), and a tilt J -> J + E (the cause is E, row by row).
    """  # noqa: D205  # one sentence

    force: SteadyStateError
    offset: SteadyStateError
    rotation: SteadyStateError
    tilt: SteadyStateError


def steady_state_errors(loop: ClosedLoop, bounds: Bounds) -> SteadyState:
    """Compute the whole table, with worst cases for the file's bounds."""
    op = loop.operating_point
    force_q, force_lambda = disturbance_matrices(loop)
    offset_q, offset_lambda = offset_matrices(loop)
    Lambda = np.linalg.inv(np.eye(op.m) + loop.gains.G_f)
    spec = op.plant.spec
    disturbance = _semi_axes(bounds.disturbance, spec.coordinates)
    offset = _semi_axes(bounds.offset, spec.constraints)
    return SteadyState(
        force=_row(force_q, force_lambda, disturbance, given=bounds.disturbance is not None),
        offset=_row(offset_q, offset_lambda, offset, given=bounds.offset is not None),
        rotation=_rotation(op.lambda_d, Lambda, bounds.rotation, op.n),
        tilt=_tilt(loop, force_q, force_lambda, bounds.tilt),
    )


def disturbance_matrices(loop: ClosedLoop) -> tuple[Array, Array]:
    """Give dq_ss / d = T, Eq. (25), and dlambda_ss / d = -Lambda U S^-1 [I, -K12 K22^-1] V^T, Eq. (26)."""
    split, K = loop.split, loop.split.blocks(loop.K)
    K22_inverse = np.linalg.inv(K.X22)
    T = split.V2 @ K22_inverse @ split.V2.T
    outer = _lambda_factor(loop)
    return frozen(T), frozen(-outer @ (split.V1.T - K.X12 @ K22_inverse @ split.V2.T))


def offset_matrices(loop: ClosedLoop) -> tuple[Array, Array]:
    """Give dq_ss / Delta, Eq. (31), and dlambda_ss / Delta, Eq. (32), in tangent and normal coordinates."""
    split, K = loop.split, loop.split.blocks(loop.K)
    K22_inverse = np.linalg.inv(K.X22)
    x1 = np.diag(1 / split.S) @ split.U.T
    position = (split.V1 - split.V2 @ K22_inverse @ K.X12.T) @ x1
    schur = K.X11 - K.X12 @ K22_inverse @ K.X12.T
    return frozen(position), frozen(_lambda_factor(loop) @ schur @ x1)


def _lambda_factor(loop: ClosedLoop) -> Array:
    """Give Lambda U S^-1, which turns a normal force V1^T f into multipliers, Eq. (37)."""
    feedback = np.eye(loop.operating_point.m) + loop.gains.G_f
    return np.linalg.solve(feedback, loop.split.U @ np.diag(1 / loop.split.S))


def _semi_axes(bound: Mapping[str, float] | None, names: Mapping[str, object]) -> Array:
    return frozen([1.0 if bound is None else bound[name] for name in names])


def _row(position: Array, constraint_force: Array, semi_axes: Array, *, given: bool) -> SteadyStateError:
    return SteadyStateError(
        position, constraint_force, _worst(position, semi_axes), _worst(constraint_force, semi_axes), semi_axes, given
    )


def _worst(matrix: Array, semi_axes: Array) -> WorstCase:
    """Take the spectral norm over the ellipsoid with these semi-axes."""
    U, S, Vt = np.linalg.svd(matrix * semi_axes)
    sign = -1.0 if U[np.argmax(np.abs(U[:, 0])), 0] < 0 else 1.0
    return WorstCase(float(S[0]), frozen(sign * semi_axes * Vt[0]), frozen(sign * S[0] * U[:, 0]))


def _rotation(lambda_d: Array, Lambda: Array, bound: float | None, n: int) -> SteadyStateError:
    """Eqs. (35), (36) in first order: R = exp(Omega) moves no position, and (R^T - I) lambda_d is normal to lambda_d.

    Over |Omega| <= bound these causes fill the ball of radius bound |lambda_d| in that normal plane. For m = 1 it is
    empty: R can only be +-1.
    """
    m = lambda_d.size
    radius = 1.0 if bound is None else bound
    size = float(np.linalg.norm(lambda_d))
    reach = size * np.eye(m) - (np.outer(lambda_d, lambda_d) / size if size else 0.0)
    worst = _worst(frozen(-Lambda @ reach * radius), frozen(np.ones(m)))
    worst = WorstCase(worst.value, frozen(reach @ worst.cause * radius), worst.effect)
    still = WorstCase(0.0, frozen(np.zeros(m)), frozen(np.zeros(n)))
    return SteadyStateError(frozen(np.zeros((n, m))), frozen(-Lambda), still, worst, radius, bound is not None)


def _tilt(loop: ClosedLoop, force_q: Array, force_lambda: Array, bound: float | None) -> SteadyStateError:
    """Let a tilt E act as the disturbance d = E^T lambda_d; |E| <= bound |J| (2-norms) lets d fill a ball."""
    op = loop.operating_point
    angle = 1.0 if bound is None else bound
    radius = angle * float(np.linalg.norm(op.J, 2)) * float(np.linalg.norm(op.lambda_d))
    position = np.hstack([each * force_q for each in op.lambda_d])
    constraint_force = np.hstack([each * force_lambda for each in op.lambda_d])
    ball = frozen(np.full(op.n, radius))
    return SteadyStateError(
        frozen(position),
        frozen(constraint_force),
        _worst(force_q, ball),
        _worst(force_lambda, ball),
        angle,
        bound is not None,
    )
