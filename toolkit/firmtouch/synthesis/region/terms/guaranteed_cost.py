"""A guaranteed quadratic cost: the optimal-control design with structure and uncertainty [T5]."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import cvxpy as cp
import numpy as np
import scipy.linalg

from firmtouch.mechanics import Array
from firmtouch.regulation import ClosedLoop
from firmtouch.synthesis.region.terms.term import Term
from firmtouch.synthesis.region.variables import STRICT, Constraints, Variables


def _empty() -> Array:
    return np.zeros(0)


@dataclass(frozen=True, kw_only=True)
class GuaranteedCost(Term):
    """The integral of dq^T Q dq + dq'^T Q' dq' + u^T R u is at most J for all starts in an ellipsoid.

    `position`, `velocity` and `torque` are what is acceptable (Bryson): Q = diag(1/position^2) and so on, and J is in
    seconds; `start_position` and `start_velocity` are the ellipsoid's semi-axes. u = -W dq - C dq' are the torques of
    all joints. With V = sigma x^T Pm x / 2, V' <= -(x^T Q x + u^T R u) is, divided by sigma = 1 / tau,

        [[-(PmA + A^T Pm)/2 - tau Q, U^T], [U, (1/tau) I]] >= 0,    U = R^(1/2) [W V2, C V2],    [T5]

    which is affine for a fixed tau; the search looks for the best tau as it does for eps.
    """

    name: str = "guaranteed cost"
    asked: float = np.inf
    unit: str = "s"
    at_most: bool = True
    position: Array = field(default_factory=_empty)
    velocity: Array = field(default_factory=_empty)
    torque: Array = field(default_factory=_empty)
    start_position: Array = field(default_factory=_empty)
    start_velocity: Array = field(default_factory=_empty)

    @property
    def can_be_eased(self) -> bool:
        """Tell whether a bound was asked for."""
        return bool(np.isfinite(self.asked))

    @property
    def exact(self) -> bool:
        """V bounds the cost, and does so with room."""
        return False

    def weights(self, T: Array, omega: float) -> tuple[Array, Array]:
        """Give Q and the inverse shape of the ellipsoid of starts, for x = (z, dz/d(omega t))."""
        Q, E = (
            scipy.linalg.block_diag(
                T.T @ np.diag(position**-2.0) @ T, omega**2 * T.T @ np.diag(velocity**-2.0) @ T
            )
            for position, velocity in (
                (self.position, self.velocity), (self.start_position, self.start_velocity),
            )
        )  # fmt: skip
        return Q, E

    def natural(self, variables: Variables, epsilon: float) -> float:
        """Estimate sigma from a single mass: 2 (sqrt(q' r) + sqrt(q r) / eps), time counted in 1/omega."""
        T, omega, t = variables.scaling.T, variables.scaling.omega, variables.t
        Q, _ = self.weights(T, omega)
        U = (variables.scaling.joint**2 / self.torque)[:, None] * T * omega**2
        r = float(np.trace(U.T @ U)) / t
        velocity, position = (float(np.sqrt(np.trace(X) / t * r)) for X in (Q[t:, t:], Q[:t, :t]))
        return 2 * (velocity + position * omega / epsilon)

    def constraints(self, variables: Variables) -> Constraints:
        """Ask for the inequality at every corner, and for the cost of the worst start."""
        v, scaling = variables, variables.scaling
        Q, E = self.weights(scaling.T, scaling.omega)
        frame = scaling.joint[:, None] * scaling.T
        reach = scaling.omega**2 * scaling.joint / self.torque
        U = cp.bmat([[(reach[:, None] * np.eye(v.n)) @ X @ frame for X in (v.W, v.C)]])
        constraints = v.energy_positive()
        for i in range(len(v.corners)):
            PA, P = v.motion(i), v.energy(i)
            apart = STRICT + v.cushion.N * (1 + v.eps) + v.cushion.M * v.eps
            power = -(PA + PA.T) / 2 - v.tau * Q - apart * np.eye(2 * v.t)
            constraints.append(cp.bmat([[power, U.T], [U, v.sigma * np.eye(v.n)]]) >> 0)
            constraints.append(P + (v.cushion.N + v.cushion.M) * np.eye(2 * v.t) << 2 * scaling.omega * v.cost * E)
        if np.isfinite(self.asked):
            constraints.append(v.cost <= self.asked * v.tau)
        return constraints

    def objective(self, variables: Variables) -> Any:  # noqa: ANN401  # a cvxpy expression
        """Give J, in s."""
        return variables.sigma * variables.cost

    def reached(self, loop: ClosedLoop) -> float:
        """Compute the true cost of the worst start, by the Lyapunov equation of the linearised loop."""
        V2, op = loop.split.V2, loop.operating_point
        Q, E = self.weights(V2, 1.0)
        U = np.hstack([X @ V2 for X in (loop.gains.W, loop.gains.C)]) / self.torque[:, None]
        M22, C22, K22 = (V2.T @ X @ V2 for X in (op.M, loop.gains.C, loop.K))
        t = V2.shape[1]
        A = np.block([[np.zeros((t, t)), np.eye(t)], [-np.linalg.solve(M22, np.hstack([K22, C22]))]])
        cost = scipy.linalg.solve_continuous_lyapunov(A.T, -(Q + U.T @ U))
        return float(scipy.linalg.eigh(cost, E, eigvals_only=True)[-1])
