"""The numbers of a question at a configuration: r, dr/dq, and the measures of what is left to move."""

from __future__ import annotations

import math
from functools import partial
from typing import Final

import casadi as ca
import numpy as np

from firmtouch.mechanics.arrays import Array, call, call_vector, frozen
from firmtouch.regulation.inverse_kinematics.reach import Reach
from firmtouch.regulation.inverse_kinematics.solution import Solution

RANK: Final = 1e-7
"""Singular values below this part of the largest count as zero; those of a solution that is singular are about 1e-8."""
SEED: Final = 19930601
UNLIMITED_SLIDE: Final = 1.0
"""Where an unlimited slide is searched: within this many metres of zero."""
EDGE: Final = 1e-9
"""How far beyond a limit (rad or m) rounding may put a solution that lies on it."""
SAMPLES: Final = 5
"""Configurations at which the rank is counted that the task's rows have but for singularities."""


class Evaluation:
    """r and J = dr/dq of a `Reach`, and manipulability with its gradient."""

    def __init__(self, reach: Reach) -> None:
        self.reach = reach
        q = ca.SX.sym("q", reach.n)
        r, task = (each.expand()(q) for each in (reach.residual, reach.task))
        self.r = partial(call_vector, ca.Function("r", [q], [r]))
        self.J = partial(call, ca.Function("J", [q], [ca.densify(ca.jacobian(r, q))], {"cse": True}))
        self.task = partial(call, ca.Function("task", [q], [task]))
        self._task_q = partial(
            call, ca.Function("task_q", [q], [ca.densify(ca.jacobian(ca.vec(task), q))], {"cse": True})
        )
        self.limited = np.isfinite(reach.lower) & np.isfinite(reach.upper)
        values = [np.linalg.svd(self.task(each), compute_uv=False) for each in self.starts(SAMPLES)]
        self._rank = max(1, *(int(np.sum(each > RANK * each[0])) for each in values))

    def starts(self, count: int) -> Array:
        """Spread configurations within the limits, angles over one turn at most: the middle, then a Halton sequence."""
        from scipy.stats import qmc

        half = np.where(self.reach.revolves, np.pi, UNLIMITED_SLIDE)
        lower, upper = self.reach.lower, self.reach.upper
        wide = ~self.limited | (np.array(self.reach.revolves) & (upper - lower > 2 * half))
        # The turn about zero, moved just so far that it lies within the limits.
        middle = np.clip(0.0, lower + half, upper - half)
        begin = np.where(wide, middle - half, lower)
        end = np.where(wide, middle + half, upper)
        spread = qmc.Halton(self.reach.n, rng=SEED).random(count - 1)
        return frozen(np.vstack([(begin + end)[None, :] / 2, begin + spread * (end - begin)]))

    def rank(self, q: Array) -> int:
        """Count in how many directions r changes with q."""
        values = np.linalg.svd(self.J(q), compute_uv=False)
        return int(np.sum(values > RANK * values[0]))

    def minus_log_room(self, q: Array) -> float:
        """Give -ln of the room, infinite where there is none."""
        below, above = self._parts(q)
        values = np.linalg.svd(self.task(q), compute_uv=False)[: self._rank]
        factors = np.concatenate([values, 4 * below * above])
        return -float(np.sum(np.log(factors))) if np.all(factors > 0) else math.inf

    def minus_log_room_gradient(self, q: Array) -> Array:
        """Give its gradient: d sigma_i = u_i^T dJ v_i of the singular values of the task's rows."""
        below, above = self._parts(q)
        gradient = np.zeros(self.reach.n)
        gradient[self.limited] = (1 / above - 1 / below) / (self.reach.upper - self.reach.lower)[self.limited]
        J = self.task(q)
        U, values, Vt = np.linalg.svd(J, full_matrices=False)
        keep = slice(0, self._rank)
        pseudo = (U[:, keep] / values[keep]) @ Vt[keep]
        return frozen(gradient - pseudo.ravel(order="F") @ self._task_q(q))  # vec runs down the columns

    def solution(self, q: Array) -> Solution:
        """Measure a configuration."""
        below, above = self._parts(q)
        values = np.linalg.svd(self.task(q), compute_uv=False)[: self._rank]
        w = float(np.prod(values))
        return Solution(
            q=frozen(q),
            residual=float(np.max(np.abs(self.r(q)))),
            manipulability=w,
            least_singular_value=float(values[-1]),
            margin=float(np.min(np.concatenate([below, above]), initial=np.inf)),
            room=w * float(np.prod(4 * below * above)),
        )

    def within_one_turn(self, q: Array, toward: Array) -> Array:
        """Take whole turns off angles: within the limits, or else least beyond them, and nearest to `toward`."""
        found = np.array(q)
        for i in np.flatnonzero(self.reach.revolves):
            lower, upper = float(self.reach.lower[i]), float(self.reach.upper[i])
            nearest = q[i] + 2 * np.pi * np.round((np.clip(toward[i], lower, upper) - q[i]) / (2 * np.pi))
            turns = nearest + 2 * np.pi * np.array([0, -1, 1])
            excess = np.maximum(0, np.maximum(turns - upper, lower - turns))
            found[i] = turns[int(np.argmin(np.where(excess < EDGE, 0, excess)))]
        return frozen(found)

    def distance(self, a: Array, b: Array) -> float:
        """Give the largest difference of a joint, whole turns apart."""
        difference = np.abs(a - b)
        turn = np.abs((a - b + np.pi) % (2 * np.pi) - np.pi)
        return float(np.max(np.where(self.reach.revolves, turn, difference)))

    def _parts(self, q: Array) -> tuple[Array, Array]:
        """Give the distances to the lower and the upper limits as parts of the ranges."""
        lower, upper, at = (each[self.limited] for each in (self.reach.lower, self.reach.upper, q))
        return (at - lower) / (upper - lower), (upper - at) / (upper - lower)
