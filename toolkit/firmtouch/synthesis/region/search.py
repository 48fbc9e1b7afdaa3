"""The scalar eps of [T4]: a search over ratios, each a solve of the one compiled problem, then a closer look."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy.optimize

from firmtouch.synthesis.region.programme import Attempt, Programme, Status

RATIOS: Final = (1.5, 1.2, 2.0, 1.05, 1.35, 2.7, 1.1, 4.0)
"""eps / alpha in the order in which feasible designs were met; without a decay rate alpha stands for 0.4 omega."""
REFINED: Final = 3
"""How often the gaps beside the best eps are halved."""
BEYOND: Final = 1.5
"""How far above the greatest ratio eps is looked for, relatively."""
LARGE: Final = 10
"""From this many free directions on a solve takes long, and the first eps with gains is taken."""
SIGMA_STEPS: Final = 8
WALL: Final = 1e12
"""What a search over the cost's multiplier sees where there are no gains."""
ENOUGH: Final = 1e-3


@dataclass(frozen=True, slots=True)
class Range:
    """The eps (in 1/s) that make sense: above the decay rate, below the bandwidth; `slow` is what ratios refer to."""

    slow: float
    fast: float

    def epsilons(self) -> tuple[float, ...]:
        """List the first ones to try."""
        return tuple(ratio * self.slow for ratio in RATIOS if ratio * self.slow < self.fast)


def search(attempt: Callable[[float], Attempt], where: Range, *, large: bool) -> tuple[Attempt, ...]:
    """Try ratios, refine around the best, and give all attempts, the best one first."""
    attempts: list[Attempt] = []
    for epsilon in where.epsilons():
        attempts.append(attempt(epsilon))
        if attempts[-1].status.has_gains and large:
            return ordered(attempts)
    return refined(attempts, where, attempt)


def ordered(attempts: list[Attempt]) -> tuple[Attempt, ...]:
    """Best first; of those without gains, trouble before infeasibility, as it says less."""
    order = {Status.SOLVED: 0, Status.ALMOST: 0, Status.UNBOUNDED: 1, Status.TROUBLE: 2, Status.INFEASIBLE: 3}
    return tuple(sorted(attempts, key=lambda each: (order[each.status], each.objective)))


def refined(attempts: list[Attempt], where: Range, attempt: Callable[[float], Attempt]) -> tuple[Attempt, ...]:
    """Halve (in the logarithm) the gaps beside the best eps, a few times: first towards its better neighbour.

    A neighbour without gains counts as the worse one, and its gap is looked into too: the best eps may lie at the edge.
    """
    best = ordered(attempts)[0]
    if not best.status.has_gains:
        return ordered(attempts)
    more: list[Attempt] = []
    ends = [Attempt(where.slow, Status.INFEASIBLE), Attempt(min(where.fast, BEYOND * best.epsilon), Status.INFEASIBLE)]
    for _ in range(REFINED):
        tried = sorted([*attempts, *more, *ends], key=lambda each: each.epsilon)
        at = tried.index(best)
        before = best
        for neighbour in sorted((tried[at - 1], tried[at + 1]), key=lambda each: each.objective):
            more.append(attempt(float(np.sqrt(before.epsilon * neighbour.epsilon))))
            if more[-1].objective < best.objective:
                best = more[-1]
                break
        if 0 < before.objective - best.objective < ENOUGH * abs(before.objective):
            break
    return ordered([*attempts, *more])


def with_multiplier(programme: Programme, epsilon: float, around: float, span: tuple[float, float]) -> Attempt:
    """Minimise over the cost's multiplier sigma, between two multiples of a first value, which is tried as well."""
    tried = [programme.solve(epsilon, around)]

    def value(logarithm: float) -> float:
        tried.append(programme.solve(epsilon, around * float(np.exp(logarithm))))
        return min(tried[-1].objective, WALL)

    bounds = (float(np.log(span[0])), float(np.log(span[1])))
    scipy.optimize.minimize_scalar(value, bounds=bounds, method="bounded", options={"maxiter": SIGMA_STEPS})
    return ordered(tried)[0]
