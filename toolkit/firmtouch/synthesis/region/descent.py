"""A local search on what the terms reach, poles first of all: it proves nothing, and where it ends proofs can begin.

Gains are diagonal in the joints, W_ii = w_i omega^2 M_ii and C_ii = c_i omega M_ii, so that every structure holds them.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import scipy.optimize

from firmtouch.mechanics import Array
from firmtouch.regulation import Gains, close_loop
from firmtouch.synthesis.region.problem import RegionProblem

INSIDE: Final = 0.01
"""How far inside every bound the search ends, relative to what is asked."""
LOOPS: Final = 2500
"""Closed loops that are looked at from each start."""
STARTS: Final = 8
FREQUENCY, DAMPING = 0.7, 0.9
"""Of the first start, in omega: every joint by itself such an oscillator."""
SPREAD: Final = 0.6
"""Standard deviation of the other starts' gains about the first one's, in the logarithm."""
FAR: Final = 1e3
"""What a term misses that is not even finite."""


def descend(problem: RegionProblem) -> Gains | None:
    """Minimise the worst relative miss over terms and vertices (Nelder and Mead); nothing if a term stays missed."""
    n, M, omega = problem.op.n, np.diag(problem.op.M), problem.scaling.omega
    first, rng = np.log(np.repeat([FREQUENCY**2, 2 * DAMPING * FREQUENCY], n)), np.random.default_rng(0)

    def gains(x: Array) -> Gains:
        return problem.gains(np.diag(omega**2 * M * np.exp(x[:n])), np.diag(omega * M * np.exp(x[n:])))

    for spread in (0.0, *[SPREAD] * (STARTS - 1)):
        found = scipy.optimize.minimize(
            lambda x: missed(problem, gains(x)),
            first + spread * rng.normal(size=2 * n),
            method="Nelder-Mead",
            callback=_stop_inside,
            options={"maxfev": LOOPS // len(problem.points), "adaptive": True},
        )
        if found.fun < 0:
            return gains(found.x)
    return None


def missed(problem: RegionProblem, gains: Gains) -> float:
    """Give by how much the worst term is missed at the worst vertex, relative to what it asks: negative is good."""
    unit = problem.scaling.omega**2 * float(np.mean(np.diag(problem.op.M)))  # of a margin that asks for its sign alone
    loops = [close_loop(point, gains) for point in problem.points]
    return max(
        min(-term.margin(term.reached(loop)) / (abs(term.asked) or unit), FAR)
        for term in problem.terms
        for loop in loops
        if np.isfinite(term.asked)
    )


def _stop_inside(intermediate_result: scipy.optimize.OptimizeResult) -> None:
    if intermediate_result.fun < -INSIDE:
        raise StopIteration
