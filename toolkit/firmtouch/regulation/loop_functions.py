"""The nonlinear closed loop and its first derivatives as CasADi functions, for those who build on them."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from firmtouch.regulation.closed_loop import ClosedLoop
from firmtouch.regulation.controllers import Controller, control_law


@dataclass(frozen=True, slots=True)
class LoopFunctions:
    """Functions of q, q' and a disturbance force d (n each), at the plant's parameters.

    `motion` gives q'' (n) and lambda (m) of Eqs. (4), (21) with J q'' + J' q' = 0 and the controller, the algebraic
    loop of its force feedback solved. `derivatives` gives A = d(q', q'')/d(q, q') (2n x 2n) and L = d lambda/d(q, q')
    (m x 2n). At rest at q_d the eigenvalues of A are the poles of the loop, and 2 m zeros: d/dt twice of Phi.
    """

    motion: ca.Function
    derivatives: ca.Function


def loop_functions(loop: ClosedLoop, controller: Controller = Controller.AFFINE_WITH_FORCE) -> LoopFunctions:
    """Derive them: the derivatives are those of the equations at fixed q'' and lambda, through the same matrices.

    [M, -(J^T + U); J, 0] d(q'', lambda) = -d[M q'' + theta - J^T lambda - u; J q'' + J' q'],  u = u_0 + U lambda
    """
    op = loop.operating_point
    n, m, functions, p = op.n, op.m, op.plant.functions, op.plant.p
    law = control_law(op, loop.gains, controller)
    q, qdot, d = (ca.SX.sym(name, n) for name in ("q", "qdot", "d"))
    qddot, lambda_ = ca.SX.sym("qddot", n), ca.SX.sym("lambda", m)
    M, J = functions["M"](q, p), functions["J"](q, p)
    u = law(q, qdot, lambda_)
    push = J.T + ca.jacobian(u, lambda_)  # the law is affine in lambda
    forces = ca.substitute(u, lambda_, ca.SX.zeros(m)) + d - functions["theta"](q, qdot, p)
    drift = functions["Jdot_qdot"](q, qdot, p)
    factors = ca.ldl(M)

    def solve(force: ca.SX, rate: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Solve M x - push y = force, J x = rate, for columns."""
        pushed, pulled = ca.ldl_solve(push, *factors), ca.ldl_solve(force, *factors)
        y = ca.solve(J @ pushed, rate - J @ pulled)
        return pulled + pushed @ y, y

    motion = solve(forces, -drift)
    state = ca.vertcat(q, qdot)
    left = ca.jacobian(M @ qddot + functions["theta"](q, qdot, p) - J.T @ lambda_ - u, state)
    held = ca.jacobian(J @ qddot + drift, state)
    slopes = [ca.substitute(each, ca.vertcat(qddot, lambda_), ca.vertcat(*motion)) for each in (left, held)]
    qddot_x, lambda_x = solve(-slopes[0], -slopes[1])
    A = ca.vertcat(ca.horzcat(ca.SX(n, n), ca.SX.eye(n)), qddot_x)
    return LoopFunctions(
        ca.Function("motion", [q, qdot, d], ca.cse([ca.densify(each) for each in motion])),
        ca.Function("derivatives", [q, qdot, d], ca.cse([ca.densify(A), ca.densify(lambda_x)])),
    )
