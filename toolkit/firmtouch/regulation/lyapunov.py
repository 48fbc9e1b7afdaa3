"""The Lyapunov function of Eq. (9), V = q'^T M q' / 2 + P_cd(q), with P_d of Eq. (12), on the constraints."""

from __future__ import annotations

from firmtouch.mechanics import Array
from firmtouch.regulation.closed_loop import ClosedLoop


def potential(loop: ClosedLoop, q: Array) -> float:
    """Give P_cd at a configuration on the constraints, counted from q_d, in J: with the controller's own numbers.

    P_cd = P(q) - P(q_d) - bias^T (q - q_d) + (q - q_d)^T W (q - q_d) / 2; Phi^T lambda_d is zero there.
    """
    op, dq = loop.operating_point, q - loop.operating_point.q_d
    return float(op.plant.P(q) - op.plant.P(op.q_d) - loop.gains.bias @ dq + dq @ loop.gains.W @ dq / 2)


def lyapunov(loop: ClosedLoop, q: Array, qdot: Array) -> float:
    """Give V in J at a state on the constraints; V' = -q'^T C q' under (15), and under (11) with any G_f."""
    return loop.operating_point.plant.K(q, qdot) + potential(loop, q)
