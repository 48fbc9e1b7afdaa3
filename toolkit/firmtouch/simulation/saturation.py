"""The algebraic loop of the force feedback where drives are at their limits: piecewise affine equations for lambda."""

from __future__ import annotations

from typing import Final

import casadi as ca

NEVER: Final = 1e30
SOLVED: Final = 1e-9
"""The error, relative to the terms of the equation, up to which lambda counts as its solution."""


def saturated_multipliers(
    reach: ca.SX, pull: ca.SX, steady: ca.SX, *, u_0: ca.SX, B: ca.SX, limits: ca.SX, first: ca.SX
) -> ca.SX:
    """Solve reach lambda + pull^T sat(u_0 + B lambda) = steady, from the unlimited loop's `first`; m.

    Newton's method goes round in circles here once G_f is large. So the path is followed on which the error shrinks
    along a straight line to zero: it is straight until a drive meets or leaves its limit, and runs backwards where the
    determinant is negative (Katzenelson's method). 2 n + 2 pieces are written out. What is not solved then is nan.
    """
    n = u_0.numel()
    wanted = u_0 + B @ first
    at = (wanted > limits) - (wanted < -limits)  # 0, or the sign of the limit
    aim = steady - reach @ first - pull.T @ _limited(wanted, limits)
    lambda_, way = first, ca.SX(0)
    for _ in range(2 * n + 2):
        slope = reach + pull.T @ (ca.repmat(at == 0, 1, reach.shape[0]) * B)
        forward = ca.sign(ca.det(slope))
        direction = ca.solve(slope, aim) * forward
        wanted, rate = u_0 + B @ lambda_, B @ direction
        border = ca.if_else(at == 0, ca.sign(rate), at) * limits
        meets = ca.if_else(at == 0, rate != 0, at * rate < 0)
        reached = ca.if_else(meets, ca.fmax((border - wanted) / rate, 0), NEVER)
        nearest, end = ca.mmin(reached), ca.if_else(forward > 0, 1 - way, NEVER)
        step = ca.fmin(nearest, end)
        changes = ca.logic_and(reached == nearest, nearest < end)
        at = ca.if_else(changes, ca.if_else(at == 0, ca.sign(rate), 0), at)
        lambda_, way = lambda_ + step * direction, way + step * forward
    wanted = u_0 + B @ lambda_
    free = ca.fabs(wanted) < limits
    slope = reach + pull.T @ (ca.repmat(free, 1, reach.shape[0]) * B)
    lambda_ -= ca.solve(slope, reach @ lambda_ + pull.T @ _limited(wanted, limits) - steady)  # rounding
    made = pull.T @ _limited(u_0 + B @ lambda_, limits)
    error, size = reach @ lambda_ + made - steady, ca.norm_inf(steady) + ca.norm_inf(made) + 1
    return ca.if_else(ca.norm_inf(error) <= SOLVED * size, lambda_, ca.SX.nan(lambda_.shape))


def _limited(u: ca.SX, limits: ca.SX) -> ca.SX:
    return ca.fmin(ca.fmax(u, -limits), limits)
