"""The three movements of a search: down to r = 0, onto it exactly, and along it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from firmtouch.mechanics.arrays import Array
from firmtouch.regulation.inverse_kinematics.evaluation import EDGE, Evaluation

CLOSE: Final = 0.1
"""|r| (m or rad) from where on Newton's method is tried, and again at each tenth: it is faster where it works."""
MET: Final = 1e-10
"""|r| (m or rad) of a solution; Newton's method ends near 1e-15 but where the solution is singular."""
MOST_STEPS: Final = 40
MOST_SLIDES: Final = 60

Bounds = tuple[Array, Array]
"""Lower and upper ones (n, rad or m), infinite where there are none."""


@dataclass(frozen=True, slots=True)
class Descent:
    """Where a search ended, and r there."""

    q: Array
    residual: Array

    @property
    def largest(self) -> float:
        """The largest |r|."""
        return float(np.max(np.abs(self.residual)))

    @property
    def met(self) -> bool:
        """Whether this is a solution."""
        return self.largest <= MET


@dataclass(frozen=True, slots=True)
class Cost:
    """What shall become small along r = 0, and its gradient; it is settled to `precision`."""

    value: Callable[[Array], float]
    gradient: Callable[[Array], Array]
    precision: float = 1e-9


def descend(at: Evaluation, start: Array, bounds: Bounds) -> Descent:
    """Go down |r|^2 within bounds by a trust region, and end by Newton's method.

    A start where r is not defined ends where it is, with an infinite residual.
    """
    from scipy.optimize import OptimizeResult, least_squares

    start = np.clip(start, *bounds)
    r = at.r(start)
    if not (np.all(np.isfinite(r)) and np.all(np.isfinite(at.J(start)))):
        return Descent(start, np.full(len(r), np.inf))
    arrived: list[Descent] = []
    close = CLOSE

    def try_newton(intermediate_result: OptimizeResult) -> None:
        nonlocal close
        size = float(np.max(np.abs(intermediate_result.fun)))
        if size < close:
            close = size / 10
            end = polish(at, intermediate_result.x, bounds)
            if end.met:
                arrived.append(end)
                raise StopIteration

    result = least_squares(at.r, start, jac=at.J, bounds=bounds, method="trf", max_nfev=MOST_STEPS, callback=try_newton)
    return arrived[0] if arrived else polish(at, result.x, bounds)


def polish(at: Evaluation, q: Array, bounds: Bounds) -> Descent:
    """Take Newton steps of least norm while they help; joints at bounds stay there when they would leave."""
    lower, upper = bounds
    best = Descent(q, at.r(q))
    while best.largest > 0:
        J = at.J(best.q)
        step = np.linalg.lstsq(J, -best.residual, rcond=EDGE)[0]
        leaves = ((best.q <= lower) & (step < 0)) | ((best.q >= upper) & (step > 0))
        if leaves.any():
            step = np.zeros(len(q))
            step[~leaves] = np.linalg.lstsq(J[:, ~leaves], -best.residual, rcond=EDGE)[0]
        q = np.clip(best.q + step, lower, upper)
        end = Descent(q, at.r(q))
        if not end.largest < best.largest:
            break
        best = end
    return best


def slide(at: Evaluation, q: Array, cost: Cost, bounds: Bounds, limits: Bounds) -> Array:
    """Lessen a cost with r = 0 kept, within bounds, which lie within limits; where that fails, stay."""
    from scipy.optimize import minimize

    start = np.clip(q, *bounds)
    if not math.isfinite(cost.value(start)):
        return q
    # Rows of r that say the same near q are taken together: the method needs independent ones.
    U = np.linalg.svd(at.J(q))[0][:, : at.rank(q)].T
    result = minimize(
        cost.value,
        start,
        jac=cost.gradient,
        bounds=list(zip(*bounds, strict=True)),
        constraints={"type": "eq", "fun": lambda x: U @ at.r(x), "jac": lambda x: U @ at.J(x)},
        method="SLSQP",
        options={"maxiter": MOST_SLIDES, "ftol": cost.precision},
    )
    if not np.all(np.isfinite(result.x)):
        return q
    end = polish(at, np.clip(result.x, *limits), limits)
    return end.q if end.met else q
