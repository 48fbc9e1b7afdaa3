"""The convex problem with slack: how far the inequalities of the region are from having a solution, for each eps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import cvxpy as cp
import numpy as np
import scipy.optimize

from firmtouch.regulation import Gains
from firmtouch.synthesis.region.alternation import solve_quietly
from firmtouch.synthesis.region.problem import RegionProblem
from firmtouch.synthesis.region.search import BEYOND
from firmtouch.synthesis.region.terms.term import RegionTerm
from firmtouch.synthesis.region.variables import STRICT, Variables

SMALL_GAINS: Final = 1e-4
"""The weight of the gains beside the slack."""
STEPS: Final = 8
"""Of the search for eps between the neighbours of the best ratio."""


@dataclass(frozen=True, slots=True)
class Missing:
    """The gains that miss the inequalities of [T4] by least for an eps (1/s): by -slack, in scaled coordinates."""

    epsilon: float
    slack: float
    gains: Gains


class Elastic:
    """Maximise the slack of the region's inequalities for given eps, all other terms kept."""

    def __init__(self, problem: RegionProblem) -> None:
        self.problem, self._variables, self._slack = problem, problem.variables(), cp.Variable()
        v, constraints = self._variables, [self._slack <= 1]
        for term in problem.terms:
            if isinstance(term, RegionTerm):
                constraints += v.in_region(term.region().in_time_unit(problem.scaling.omega), self._slack)
            else:
                constraints += term.constraints(v)
        aim = self._slack - SMALL_GAINS * size_of(v)
        self._programme = cp.Problem(cp.Maximize(aim), [*constraints, *v.energy_positive(self._slack)])

    def at(self, epsilon: float) -> Missing | None:
        """Solve for one eps."""
        self._variables.eps.value = epsilon / self.problem.scaling.omega
        if not solve_quietly(self._programme):
            return None
        return Missing(epsilon, float(self._slack.value), self.problem.gains(*self._variables.values()))

    def best(self) -> list[Missing]:
        """Try all ratios, look closer around the best, and give what was found, the least missing first."""
        found = [each for epsilon in self.problem.where.epsilons() if (each := self.at(epsilon)) is not None]
        if found:
            found += self._between(sorted(found, key=lambda each: each.epsilon))
        return sorted(found, key=lambda each: -each.slack)

    def feasible_epsilon(self) -> float | None:
        """Give an eps for which there are gains, if there seems to be one."""
        found = self.best()
        return found[0].epsilon if found and found[0].slack > STRICT else None

    def _between(self, tried: list[Missing]) -> list[Missing]:
        where, at = self.problem.where, max(range(len(tried)), key=lambda i: tried[i].slack)
        low = tried[at - 1].epsilon if at else where.slow
        high = tried[at + 1].epsilon if at + 1 < len(tried) else min(where.fast, BEYOND * tried[at].epsilon)
        more: list[Missing] = []

        def value(logarithm: float) -> float:
            found = self.at(float(np.exp(logarithm)))
            more.extend([found] if found is not None else [])
            return -found.slack if found is not None else 1.0

        bounds = (float(np.log(low)), float(np.log(high)))
        scipy.optimize.minimize_scalar(value, bounds=bounds, method="bounded", options={"maxiter": STEPS})
        return more


def size_of(variables: Variables) -> Any:  # noqa: ANN401  # a cvxpy expression
    """Give the size of the scaled gains, to break ties with."""
    return cp.norm(variables.W, "fro") + cp.norm(variables.C, "fro")
