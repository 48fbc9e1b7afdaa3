"""The paper's four controllers as CasADi functions, and the closed loop with its algebraic force loop solved."""

from __future__ import annotations

from enum import Enum

import casadi as ca
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import call, call_vector, frozen, symmetric
from firmtouch.mechanics.symbols import Symbols
from firmtouch.modelfile import Expression
from firmtouch.regulation.gains import Gains
from firmtouch.regulation.operating_point import OperatingPoint


class Controller(Enum):
    """The paper's control laws, by equation number."""

    ENERGY = 5
    ENERGY_WITH_FORCE = 11
    AFFINE = 15
    AFFINE_WITH_FORCE = 17

    @property
    def feels_force(self) -> bool:
        """Tell whether the contact force is fed back."""
        return self in (Controller.ENERGY_WITH_FORCE, Controller.AFFINE_WITH_FORCE)


def control_law(
    op: OperatingPoint, gains: Gains, controller: Controller, *, P_d: Expression | None = None
) -> ca.Function:
    """Give u(q, q', lambda) of one of the four controllers.

        (5)   u = P_q(q) - Pd_q(q) - C q'
        (11)  (5) + J(q)^T G_f (lambda - lambda_d)
        (15)  u = g - J^T lambda_d - W (q - q_d) - C q'
        (17)  (15) + J(q_d)^T G_f (lambda - lambda_d)

    Without `P_d`, (5) and (11) use that of Eq. (12), with which (5) is (15).
    """
    symbols = Symbols(op.plant.spec)
    q, qdot, lambda_ = symbols.q, symbols.qdot, ca.SX.sym("lambda", op.m)
    error = lambda_ - op.lambda_d
    damping = -ca.DM(gains.C) @ qdot
    if P_d is not None and controller in (Controller.ENERGY, Controller.ENERGY_WITH_FORCE):
        desired = _gradient(op, symbols, P_d)
        u = op.plant.functions["P_q"](q, op.plant.p) - desired + damping  # Eq. (5)
    else:
        u = ca.DM(gains.bias) - ca.DM(gains.W) @ (q - op.q_d) + damping  # Eq. (15)
    if controller is Controller.ENERGY_WITH_FORCE:
        u += op.plant.functions["J"](q, op.plant.p).T @ ca.DM(gains.G_f) @ error  # Eq. (11)
    if controller is Controller.AFFINE_WITH_FORCE:
        u += ca.DM(op.J).T @ ca.DM(gains.G_f) @ error  # Eq. (17)
    return ca.Function("u", [q, qdot, lambda_], [ca.densify(u)])


def energy_gradient(op: OperatingPoint, P_d: Expression) -> Array:
    """Give Pd_q(q_d) (n) of a desired potential energy: f_d, where (q_d, lambda_d) is to be an equilibrium."""
    symbols = Symbols(op.plant.spec)
    return call_vector(ca.Function("Pd_q", [symbols.q], [ca.densify(_gradient(op, symbols, P_d))]), op.q_d)


def energy_hessian(op: OperatingPoint, P_d: Expression) -> Array:
    """Give Pd_qq(q_d) (n x n) of a desired potential energy; K of Eq. (10) is Pd_qq - sum of lambda_dj Phi_j''."""
    symbols = Symbols(op.plant.spec)
    slope = ca.jacobian(_gradient(op, symbols, P_d), symbols.q)
    return symmetric(call(ca.Function("Pd_qq", [symbols.q], [ca.densify(slope)]), op.q_d))


def _gradient(op: OperatingPoint, symbols: Symbols, P_d: Expression) -> ca.SX:
    return ca.substitute(ca.gradient(symbols.scalar(P_d), symbols.q), symbols.p, ca.DM(op.plant.p))


def closed_loop_acceleration(
    op: OperatingPoint, law: ca.Function, q: Array, qdot: Array, *, d: Array
) -> tuple[Array, Array]:
    """Solve (4) with J q'' + J' q' = 0 for (q'', lambda): the force feedback is an algebraic loop.

    `law` is affine in lambda: u = u_0 + U lambda. `d` (n) is a disturbance force, Eq. (21).
    """
    plant, n = op.plant, op.n
    zero = np.zeros(op.m)
    u_0 = np.asarray(law(q, qdot, zero).full()).ravel()
    columns = [np.asarray(law(q, qdot, unit).full()).ravel() - u_0 for unit in np.eye(op.m)]
    J = plant.J(q)
    matrix = np.block([[plant.M(q), -(J.T + np.column_stack(columns))], [J, np.zeros((op.m, op.m))]])
    right = np.concatenate([u_0 + d - plant.theta(q, qdot), -plant.Jdot_qdot(q, qdot)])
    solution = np.linalg.solve(matrix, right)
    return frozen(solution[:n]), frozen(solution[n:])
