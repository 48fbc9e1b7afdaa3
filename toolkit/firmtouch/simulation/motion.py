"""Eq. (4) with the true constraints, their stabilisation, and drives that have limits, as CasADi expressions.

Phi = 0 is differentiated twice and held by Baumgarte's stabilisation, Phi'' + 2 a Phi' + a^2 Phi = 0, which is zero
on the constraints: it changes no motion there and pulls rounding and integration errors back at the rate a.
"""

from __future__ import annotations

from typing import Final

import casadi as ca

from firmtouch.regulation import ClosedLoop
from firmtouch.simulation.saturation import saturated_multipliers
from firmtouch.simulation.scenario import Feedback

HOLD: Final = 20.0
"""The rate a of the stabilisation, 1/s."""


class Motion:
    """Eq. (4) with the true constraints and their stabilisation, as expressions in q, q', u and lambda."""

    def __init__(
        self, loop: ClosedLoop, feedback: Feedback, given: dict[str, ca.SX], *, q: ca.SX, qdot: ca.SX, d: ca.SX
    ) -> None:
        op = loop.operating_point
        n, m, functions, p = op.n, op.m, op.plant.functions, given["p"]
        R, E = ca.reshape(given["R"], m, m), ca.reshape(given["E"], m, n)
        self._given, self._limited = given, feedback.limits is not None
        self._q, self._qdot = q, qdot
        self.J = R @ functions["J"](q, p) + E
        self.Phi = R @ functions["Phi"](q, p) + E @ (q - ca.DM(op.q_d)) - given["Delta"]
        self.drift = R @ functions["Jdot_qdot"](q, qdot, p) + 2 * HOLD * (self.J @ qdot) + HOLD**2 * self.Phi
        self._factors = ca.ldl(functions["M"](q, p))
        self.forces = d - functions["theta"](q, qdot, p)
        self._pull = self._solve(self.J.T)  # M^-1 J^T
        self._reach = self.J @ self._pull  # J M^-1 J^T

    def _solve(self, right: ca.SX) -> ca.SX:
        """Multiply by M^-1."""
        return ca.ldl_solve(right, *self._factors)

    def acceleration(self, u: ca.SX, lambda_: ca.SX) -> ca.SX:
        """Give q'' of Eq. (4)."""
        return self._solve(u + self.forces + self.J.T @ lambda_)

    def multipliers(self, u: ca.SX) -> ca.SX:
        """Give the lambda that keeps the constraints under a known u."""
        return ca.solve(self._reach, -self.drift - self._pull.T @ (u + self.forces))

    def limited(self, u: ca.SX) -> ca.SX:
        """Give what the drives do where they cannot do more."""
        limits = self._given["limits"]
        return ca.fmin(ca.fmax(u, -limits), limits) if self._limited else u

    def close(self, law: ca.Function) -> tuple[ca.SX, ca.SX]:
        """Solve the algebraic loop u = law(lambda), lambda = multipliers(u); gives both.

        The law is affine in lambda; with limits the loop is piecewise affine.
        """
        m = self._reach.shape[0]
        u_0 = law(self._q, self._qdot, ca.SX.zeros(m)) + self._given["bias_error"]
        probe = ca.SX.sym("probe", m)
        B = ca.substitute(ca.jacobian(law(self._q, self._qdot, probe), probe), probe, ca.SX.zeros(m))
        steady = -self.drift - self._pull.T @ self.forces
        lambda_ = ca.solve(self._reach + self._pull.T @ B, steady - self._pull.T @ u_0)
        if self._limited:
            limits = self._given["limits"]
            lambda_ = saturated_multipliers(self._reach, self._pull, steady, u_0=u_0, B=B, limits=limits, first=lambda_)
        return self.limited(u_0 + B @ lambda_), lambda_
