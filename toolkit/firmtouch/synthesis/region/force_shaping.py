"""The second stage for full matrices: K12, K11, C12, C11 and G_f, with the tangent blocks kept [T1], [T6].

The poles are settled; what is left trades the force's transient against its steady-state error:

    transient  || Y U S^-1 [K12 - M12 M22^-1 K22, omega (C12 - M12 M22^-1 C22)] ||   N for each rad of start error
    error      || Y U S^-1 [I, -K12 K22^-1] V^T diag(d) ||                            N under constant forces

With Y = (I + G_f)^-1 given both are convex in K12 and C12; with these given both are convex in Y.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import cvxpy as cp
import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import frozen, symmetric
from firmtouch.regulation import ClosedLoop, Gains
from firmtouch.synthesis.region.alternation import solve_quietly
from firmtouch.synthesis.region.front import Front, FrontPoint
from firmtouch.synthesis.region.problem import RegionProblem
from firmtouch.synthesis.region.programme import INSIDE, inside
from firmtouch.synthesis.region.terms.force_errors import DisturbanceForceError, ForceError
from firmtouch.synthesis.region.terms.term import RegionTerm

POINTS: Final = 9
MINOR: Final = 1e-3
"""The weight of what only breaks ties."""
NEGLIGIBLE: Final = 1e-6
"""Entries of G_f below this are the solver's rounding."""


@dataclass(frozen=True, slots=True)
class ForceShape:
    """Gains with shaped normal blocks, and the front of force transient against force error that they lie on."""

    gains: Gains
    front: Front


def shape_force(problem: RegionProblem, loop: ClosedLoop) -> ForceShape | None:
    """Choose the normal blocks, and the least G_f with which the asked force errors are kept.

    The objective `force_error` takes the least error, any other the least transient that keeps the asked error. Gives
    nothing if the bounds leave no room, so that the first stage's blocks stay.
    """
    shaping, unit = _Shaping(problem, loop), problem.units.multiplier
    first, last = shaping.solve(shaping.transient), shaping.least_error()
    if first is None or last is None:
        return None
    limits = np.linspace(first[0], last[0], POINTS)
    between = [shaping.solve(shaping.error, shaping.transient <= each) for each in limits]
    points = tuple(FrontPoint(*each) for each in between if each is not None)
    chosen = _chosen(shaping)
    if chosen is None:
        return None
    gains = shaping.softened()
    gains = replace(gains, G_f=_least_feedback(problem, gains))
    front = Front("force transient", "force error", unit and f"{unit}/rad", unit, points, FrontPoint(*chosen))
    return ForceShape(gains, front)


class _Shaping:
    """The convex programme of the second stage for the file's G_f; `solve` is asked for points of the front."""

    def __init__(self, problem: RegionProblem, loop: ClosedLoop) -> None:
        self.problem, self.loop, self.variables = problem, loop, problem.variables()
        v, scaling, op = self.variables, problem.scaling, loop.operating_point
        sizes = np.outer(scaling.joint, scaling.joint)
        self.K = scaling.omega**2 * cp.multiply(sizes, v.W) + op.N0
        V1, V2 = loop.split.V1, loop.split.V2
        self.K12, C12 = V1.T @ self.K @ V2, scaling.omega * V1.T @ cp.multiply(sizes, v.C) @ V2
        K, C, M = (loop.split.blocks(X) for X in (loop.K, loop.gains.C, op.M))
        decoupled = np.linalg.solve(M.X22, M.X12.T).T  # [T1]
        outer = np.linalg.solve(np.eye(op.m) + problem.G_f, loop.split.U / loop.split.S)
        drift = [self.K12 - decoupled @ K.X22, scaling.omega * (C12 - decoupled @ C.X22)]
        self.transient = cp.sigma_max(outer @ cp.hstack(drift))
        answer = V1.T - self.K12 @ np.linalg.inv(K.X22) @ V2.T  # Eq. (26)
        self.error = cp.sigma_max(outer @ answer @ np.diag(problem.disturbance))
        self.constraints = self._kept()
        size = cp.norm(v.W, "fro") + cp.norm(v.C, "fro")
        self.tie = MINOR * size / max(float(np.linalg.norm(scaling.scaled_stiffness(loop.gains.W))), 1.0)

    def _kept(self) -> list[Any]:
        """Keep the tangent blocks, and with them the poles, and all terms about W, C and K."""
        v, scaling, gains = self.variables, self.problem.scaling, self.loop.gains
        others = (each for each in self.problem.terms if not isinstance(each, RegionTerm | ForceError))
        return [
            scaling.tangent(gains.W) / scaling.omega**2 == v.W22,
            scaling.tangent(gains.C) / scaling.omega == v.C22,
            *(each for term in others for each in inside(term).constraints(v)),
        ]

    def solve(self, aim: Any, *extra: Any) -> tuple[float, float] | None:  # noqa: ANN401  # cvxpy expressions
        """Minimise an expression; gives transient and error, or nothing if there is no solution."""
        if not solve_quietly(cp.Problem(cp.Minimize(aim + self.tie), [*self.constraints, *extra])):
            return None
        return float(self.transient.value), float(self.error.value)

    def least_error(self) -> tuple[float, float] | None:
        """Minimise the error, and then the transient that goes with it."""
        found = self.solve(self.error)
        return found and (self.solve(self.transient, self.error <= (1 + MINOR) * found[1]) or found)

    def gains(self) -> Gains:
        """Give the gains of the last solution."""
        W, C = self.variables.values()
        return replace(self.loop.gains, W=symmetric(W), C=symmetric(C))

    def softened(self) -> Gains:
        """With K12 as found, make the force error under offsets small: the least normal stiffness that is allowed."""
        K12, gains = self.K12.value, self.gains()
        normal = self.loop.split.V1 / self.loop.split.S
        size = float(np.linalg.norm(normal.T @ self.K.value @ normal, 2))
        found = self.solve(cp.lambda_max(normal.T @ self.K @ normal) / size, self.K12 == K12)
        return gains if found is None else self.gains()


def _chosen(shaping: _Shaping) -> tuple[float, float] | None:
    """Take the point of the front that the file asks for."""
    problem = shaping.problem
    if "force_error" in problem.objective:
        return shaping.least_error()
    asked = [each.asked for each in problem.terms if isinstance(each, DisturbanceForceError)]
    kept = [shaping.error <= each * _reserve(problem) * (1 - INSIDE) for each in asked]
    return shaping.solve(shaping.transient, *kept) or shaping.least_error()


def _reserve(problem: RegionProblem) -> float:
    """Give how much larger the error may be now, as force feedback up to its limit will still divide it."""
    if problem.feedback_limit is None:
        return 1.0
    m = len(problem.G_f)
    ratio = np.linalg.solve(np.eye(m) + np.diag(problem.feedback_limit), np.eye(m) + problem.G_f)
    return float(1 / np.linalg.norm(ratio, 2))


def _least_feedback(problem: RegionProblem, gains: Gains) -> Array:
    """Give the least G_f up to the force path's limit that keeps the asked force errors.

    Y = (I + G_f)^-1 is as large as it may be: maximise trace Y subject to (I + limit)^-1 <= Y <= I and the errors,
    which are linear in Y. Without a limit, or without an asked error, G_f stays as the file has it.
    """
    terms = [each for each in problem.terms if isinstance(each, ForceError)]
    if problem.feedback_limit is None or not terms:
        return problem.G_f
    m = len(problem.G_f)
    Y = cp.Variable((m, m), symmetric=True)
    constraints = [Y >> np.diag(1 / (1 + problem.feedback_limit)), Y << np.eye(m)]
    without = problem.audit(replace(gains, G_f=frozen(np.zeros((m, m))))).loops
    for term in terms:
        errors = [Y @ term.matrix(loop) @ np.diag(term.semi_axes) for loop in without]
        constraints += [cp.sigma_max(each) <= term.asked * (1 - INSIDE) for each in errors]
    if not solve_quietly(cp.Problem(cp.Maximize(cp.trace(Y)), constraints)):
        return frozen(np.diag(problem.feedback_limit))  # the best there is; the audit tells what it misses
    G_f = symmetric(np.linalg.inv(Y.value) - np.eye(m))
    return frozen(np.where(np.abs(G_f) < NEGLIGIBLE, 0.0, G_f))
