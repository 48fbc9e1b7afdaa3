"""Where the closed loop truly comes to rest under constant errors: the equations that the table linearises."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from firmtouch.errors import NoDesignError
from firmtouch.mechanics import Array, Plant
from firmtouch.mechanics.arrays import frozen
from firmtouch.regulation.closed_loop import ClosedLoop
from firmtouch.regulation.operating_point import OperatingPoint

MOST_STEPS: Final = 30
CONVERGED: Final = 1e-10
"""The last step, in rad or m, and in N relative to the largest lambda_d: below it Newton's method has converged."""


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """q (n) and lambda (m) at rest; `step` is the last step of Newton's method, relative as in `CONVERGED`."""

    q: Array
    lambda_: Array
    step: float


class NoEquilibriumError(NoDesignError):
    """Newton's method found no rest near the operating point; `step` says how far it still moved."""

    def __init__(self, step: float) -> None:
        self.step = step
        super().__init__(
            f"there is no equilibrium near q_d under these errors (Newton's method still moves by {step:.3g}); "
            "smaller errors or a stiffer W would have one"
        )


def closed_loop_equilibrium(
    loop: ClosedLoop,
    *,
    d: ArrayLike = 0.0,
    Delta: ArrayLike = 0.0,
    R: Array | None = None,
    E: ArrayLike = 0.0,
    plant: Plant | None = None,
) -> Equilibrium:
    """Solve for the rest of controller (17), exactly, under constant errors.

        0 = u(q, 0, lambda) - P_q(q) + (R J(q) + E)^T lambda + d,     R Phi(q) + E (q - q_d) = Delta

    d (n) is the force of Eq. (21), Delta (m) the offset of Eq. (28), R (m x m, orthogonal) the rotation of Eq. (33),
    E (m x n) a tilt. `plant` is the true plant where it is not the one of the design (other masses, say).

    Raises
    ------
    NoEquilibriumError
        If Newton's method, from (q_d, lambda_d), does not converge.
    """
    op, gains = loop.operating_point, loop.gains
    plant = plant or op.plant
    rotation = np.eye(op.m) if R is None else R
    tilt = np.broadcast_to(np.asarray(E, dtype=float), (op.m, op.n))
    force, offset = np.asarray(d, dtype=float), np.asarray(Delta, dtype=float)

    def balance(q: Array, lambda_: Array) -> tuple[Array, Array]:
        dq, A = q - op.q_d, rotation @ plant.J(q) + tilt
        u = gains.bias - gains.W @ dq + op.J.T @ gains.G_f @ (lambda_ - op.lambda_d)  # Eq. (17) at rest
        forces = u - plant.P_q(q) + A.T @ lambda_ + force
        stiffness = gains.W + plant.P_qq(q) - np.tensordot(rotation.T @ lambda_, plant.Phi_qq(q), axes=1)
        slope = np.block([[-stiffness, A.T + op.J.T @ gains.G_f], [A, np.zeros((op.m, op.m))]])
        return np.concatenate([forces, rotation @ plant.Phi(q) + tilt @ dq - offset]), slope

    return solve_rest(op, balance)


def solve_rest(op: OperatingPoint, balance: Callable[[Array, Array], tuple[Array, Array]]) -> Equilibrium:
    """Solve balance(q, lambda) = 0 by Newton's method from (q_d, lambda_d); it gives n + m equations and their slope.

    Raises
    ------
    NoEquilibriumError
        If it does not converge.
    """
    q, lambda_, step = op.q_d, op.lambda_d, np.inf
    largest = max(1.0, float(np.abs(op.lambda_d).max()))
    for _ in range(MOST_STEPS):
        residual, slope = balance(q, lambda_)
        if not (np.all(np.isfinite(slope)) and np.all(np.isfinite(residual))):
            raise NoEquilibriumError(float(step))
        change = np.linalg.lstsq(slope, -residual, rcond=None)[0]
        q, lambda_ = q + change[: op.n], lambda_ + change[op.n :]
        step = max(float(np.abs(change[: op.n]).max()), float(np.abs(change[op.n :]).max()) / largest)
        if step < CONVERGED:
            return Equilibrium(frozen(q), frozen(lambda_), step)
    raise NoEquilibriumError(float(step))
