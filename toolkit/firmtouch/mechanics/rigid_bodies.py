"""The inertia matrix and the potential of rigid bodies, from where their masses are."""

from __future__ import annotations

from typing import Any

import casadi as ca

from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import Expression
from firmtouch.modelfile.sections.mechanism import Bodies, Body


def mass_matrix(bodies: Bodies, symbols: Symbols) -> ca.SX:
    """Give M(q) = sum of m J_v^T J_v + J_w^T I J_w over the bodies, with K = 1/2 q'^T M q'."""
    total = ca.SX.zeros(symbols.q.numel(), symbols.q.numel())
    for body in bodies.bodies.values():
        J_v = ca.jacobian(symbols.column(body.centre_of_mass), symbols.q)
        total += symbols.scalar(body.mass) * J_v.T @ J_v
        if body.inertia is not None:
            inertia, J_w = _rotational(body, symbols)
            total += J_w.T @ inertia @ J_w
    return total


def potential_energy(bodies: Bodies, symbols: Symbols) -> ca.SX:
    """Give P(q) = -sum of m g . r over the bodies."""
    gravity = symbols.column(bodies.gravity)
    terms = [
        -symbols.scalar(body.mass) * ca.dot(gravity, symbols.column(body.centre_of_mass))
        for body in bodies.bodies.values()
    ]
    return sum(terms, ca.SX(0))


def rotation(orientation: Any, symbols: Symbols) -> ca.SX:  # noqa: ANN401  # `Orientation`, in space
    """Give the rotation matrix from body to world of a body in space."""
    if orientation and isinstance(orientation[0][0], Expression):
        return ca.vertcat(*(ca.horzcat(*map(symbols.scalar, row)) for row in orientation))
    total = ca.SX.eye(3)
    for axis, angle in orientation:
        total @= elementary_rotation(axis, symbols.scalar(angle))
    return total


def elementary_rotation(axis: str, angle: ca.SX) -> ca.SX:
    """Give the rotation by an angle about the x, y or z axis."""
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    R = ca.SX.eye(3)
    R[j, j], R[k, k] = ca.cos(angle), ca.cos(angle)
    R[k, j], R[j, k] = ca.sin(angle), -ca.sin(angle)
    return R


def angular_jacobian(R: ca.SX, q: ca.SX) -> ca.SX:
    """Give J_w with w = J_w q' in the body's axes, from the skew matrices R^T dR/dq_i."""
    columns = []
    for i in range(q.numel()):
        S = R.T @ ca.jacobian(R, q[i]).reshape((3, 3))
        columns.append(ca.vertcat(S[2, 1] - S[1, 2], S[0, 2] - S[2, 0], S[1, 0] - S[0, 1]) / 2)
    return ca.horzcat(*columns)


def _rotational(body: Body, symbols: Symbols) -> tuple[ca.SX, ca.SX]:
    if isinstance(body.inertia, Expression):
        assert isinstance(body.orientation, Expression)
        return symbols.scalar(body.inertia), ca.jacobian(symbols.scalar(body.orientation), symbols.q)
    assert body.inertia is not None
    inertia = ca.vertcat(*(ca.horzcat(*map(symbols.scalar, row)) for row in body.inertia))
    return inertia, angular_jacobian(rotation(body.orientation, symbols), symbols.q)
