"""One row of Phi with its derivatives, as expressions of q."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True, slots=True)
class Row:
    """phi, its gradient (n x 1) and its Hessian (n x n); `bent` where they come from a surface's own derivatives."""

    phi: ca.SX
    gradient: ca.SX
    hessian: ca.SX
    bent: bool = False

    def rate(self, q: ca.SX, qdot: ca.SX) -> ca.SX:
        """Give this row of J' q': q'^T phi'' q'."""
        if self.bent:
            return ca.dot(qdot, self.hessian @ qdot)
        return ca.jtimes(ca.dot(self.gradient, qdot), q, qdot)


def row_of(phi: ca.SX, q: ca.SX) -> Row:
    """Differentiate an expression."""
    hessian, gradient = ca.hessian(phi, q)
    return Row(phi, gradient, hessian)
