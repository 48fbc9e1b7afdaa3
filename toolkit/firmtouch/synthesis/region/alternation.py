"""Where one scalar eps is too little: alternation between the gains and a general Lyapunov matrix.

With y = (z, z', z'') and G = [K22, C22, M22] the closed loop is G y = 0. By Finsler's lemma the poles lie in a region
L + s R + conj(s) R^T < 0 if, for some P > 0 and some F ((n-m) x 3(n-m)),

    L (x) Y1^T P Y1 + R (x) Y1^T P Y2 + R^T (x) Y2^T P Y1 - I (x) (F^T G + G^T F) < 0,

where Y1 y = (z, z') and Y2 y = (z', z''). For fixed F it is affine in the gains, in M22 and N0_22, and in P, so P may
differ from vertex to vertex (and from region to region) and still all plants between the vertices are covered; for
fixed gains it is affine in (F, P). F = [eps I, I, 0] is [T4].
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import cvxpy as cp
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen, symmetric
from firmtouch.regulation.lmi_region import LmiRegion
from firmtouch.regulation.tangent import Tangent

ROUNDS: Final = 20
WIDEST: Final = 30.0
"""Greatest eigenvalue of a P whose least is one: keeps the slack from being bought by size alone."""
SLOPE: Final = 0.02
"""What the multipliers may miss in the acceleration, so that the first ones are not bound to [T4]."""
MOST: Final = 1.0
"""No more slack than this is asked for."""
ACCURATE: Final = {"tol_gap_abs": 1e-5, "tol_gap_rel": 1e-5}
PROVEN: Final = 1e-7


@dataclass(frozen=True, slots=True)
class Multiplier:
    """F of one region and P of each loop, and the slack that they leave: positive is a proof."""

    F: Array
    P: tuple[Array, ...]
    slack: float


def best_multiplier(tangents: Sequence[Tangent], region: LmiRegion, slope: float = SLOPE) -> Multiplier | None:
    """Find F and P for fixed gains with the largest slack; none if the solver comes to no end."""
    t = len(tangents[0].M)
    F, slack = cp.Variable((t, 3 * t)), cp.Variable()
    constraints, matrices = [slack <= MOST], [cp.Variable((2 * t, 2 * t), symmetric=True) for _ in tangents]
    for each, P in zip(tangents, matrices, strict=True):
        G = np.hstack([each.K, each.C, each.M])
        constraints += lyapunov_constraints(region, P, F.T @ G + G.T @ F, slack, slope)
    if not solve_quietly(cp.Problem(cp.Maximize(slack), constraints)):
        return None
    return Multiplier(frozen(F.value), tuple(symmetric(P.value) for P in matrices), float(slack.value))


def lyapunov_constraints(
    region: LmiRegion,
    P: cp.Variable,  # a matrix
    product: Any,  # noqa: ANN401  # a cvxpy expression
    slack: Any,  # noqa: ANN401  # a cvxpy expression
    slope: float,
) -> list[Any]:
    """Write the inequality at one vertex with its own P; `product` is F^T G + G^T F."""
    t = P.shape[0] // 2
    eye, zero = np.eye(t), np.zeros((t, t))
    Y1 = np.block([[eye, zero, zero], [zero, eye, zero]])
    Y2 = np.block([[zero, eye, zero], [zero, zero, eye]])
    still, moving, k = Y1.T @ P @ Y1, Y1.T @ P @ Y2, len(region.L)
    blocks = [
        [
            float(region.L[i, j]) * still + float(region.R[i, j]) * moving + float(region.R[j, i]) * moving.T
            - (product if i == j else 0)
            for j in range(k)
        ]
        for i in range(k)
    ]  # fmt: skip
    state = np.kron(np.eye(k), np.diag([1.0] * 2 * t + [0.0] * t))
    acceleration = np.kron(np.eye(k), np.diag([0.0] * 2 * t + [1.0] * t))
    return [P >> np.eye(2 * t), P << WIDEST * np.eye(2 * t), -cp.bmat(blocks) >> slack * state - slope * acceleration]


def general_proof(tangents: Sequence[Tangent], regions: Sequence[LmiRegion]) -> tuple[Multiplier, ...] | None:
    """Prove that all loops between some have their poles in all regions, each with its own F and P."""
    found = []
    for region in regions:
        multiplier = best_multiplier(tangents, region, slope=-PROVEN)
        if multiplier is None or multiplier.slack <= PROVEN:
            return None
        found.append(multiplier)
    return tuple(found)


def solve_quietly(problem: cp.Problem) -> bool:
    """Solve, and tell whether there is a solution; what it is worth is seen from the gains."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "may be inaccurate"
            problem.solve(solver=cp.CLARABEL, **ACCURATE)
    except cp.SolverError:
        return False
    return problem.status in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE)
