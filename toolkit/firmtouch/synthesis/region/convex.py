"""The convex search itself: problem -> programme -> attempts, each re-checked from its gains."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from firmtouch.regulation import Gains
from firmtouch.synthesis.region.elastic import Elastic
from firmtouch.synthesis.region.objective import Objective
from firmtouch.synthesis.region.problem import RegionProblem
from firmtouch.synthesis.region.programme import Attempt, Programme, Status
from firmtouch.synthesis.region.search import LARGE, ordered, refined, search, with_multiplier
from firmtouch.synthesis.region.terms.guaranteed_cost import GuaranteedCost
from firmtouch.synthesis.region.terms.term import RegionTerm

WIDELY: Final = (0.25, 64.0)
"""Multiples of a single mass's multiplier among which the one of least cost is looked for."""
AROUND: Final = (0.5, 4.0)
"""Multiples of that one among which another aim looks for its own."""


@dataclass(frozen=True, slots=True)
class Found:
    """What a search found: its attempts, the best one first, and what the solver took (s)."""

    attempts: tuple[Attempt, ...]
    solver_time: float
    solves: int

    @property
    def best(self) -> Attempt:
        """The best attempt."""
        return self.attempts[0]


class ConvexSearch:
    """A problem compiled once; `run` searches eps, each time with the parameters' values of that moment.

    `extra` are further cvxpy constraints on the objective's expressions, such as a bound that a front moves. Gains that
    miss a term at a vertex do not count, unless `checked` is false: then the caller sees to it.
    """

    def __init__(
        self,
        problem: RegionProblem,
        objective: Objective | None = None,
        extra: tuple[Any, ...] = (),
        *,
        checked: bool = True,
    ) -> None:
        self.problem, self._checked = problem, checked
        self.variables = problem.variables() if objective is None else objective.variables
        self.objective = objective or Objective(self.variables, problem.terms, problem.objective)
        self._programme = Programme(self.variables, problem.terms, self.objective, extra)
        self._cheapest = _Cheapest(problem) if any(isinstance(each, GuaranteedCost) for each in problem.terms) else None
        self._large = self.variables.t >= LARGE

    def run(self) -> Found:
        """Search for the best eps; where no ratio has gains, around the one that is least far from having them."""
        where = self.problem.where
        attempts = search(self._attempt, where, large=self._large)
        if attempts[0].status in (Status.INFEASIBLE, Status.TROUBLE) and (epsilon := self._between_ratios()):
            attempts = refined([*attempts, self._attempt(epsilon)], where, self._attempt)
        return self._found(attempts)

    def first(self) -> Found:
        """Take the first eps that has gains: to tell whether there are any."""
        attempts: list[Attempt] = []
        for epsilon in self.problem.where.epsilons():
            attempts.append(self._attempt(epsilon))
            if attempts[-1].status.has_gains:
                return self._found(ordered(attempts))
        if (epsilon_between := self._between_ratios()) is not None:
            attempts.append(self._attempt(epsilon_between))
        return self._found(ordered(attempts))

    def _found(self, attempts: tuple[Attempt, ...]) -> Found:
        programmes = [self._programme, *([self._cheapest.programme] if self._cheapest else [])]
        return Found(attempts, sum(each.solver_time for each in programmes), sum(each.solves for each in programmes))

    def _between_ratios(self) -> float | None:
        about_poles = any(isinstance(each, RegionTerm) for each in self.problem.terms)
        return Elastic(self.problem).feasible_epsilon() if about_poles and not (self._cheapest or self._large) else None

    def _attempt(self, epsilon: float) -> Attempt:
        """Solve for one eps; gains that miss a term do not count."""
        if self._cheapest is None:
            found = self._programme.solve(epsilon)
        else:
            found = with_multiplier(self._programme, epsilon, self._cheapest.sigma(epsilon), AROUND)
        if not found.status.has_gains or not self._checked or self.problem.audit(gains_of(self.problem, found)).holds:
            return found
        return Attempt(epsilon, Status.TROUBLE)


class _Cheapest:
    """The same problem with the least cost as its aim and no bound on it: where a cost's multiplier is to be found."""

    def __init__(self, problem: RegionProblem) -> None:
        self._cost = next(each for each in problem.terms if isinstance(each, GuaranteedCost))
        terms = tuple(replace(each, asked=np.inf) if each is self._cost else each for each in problem.terms)
        self._variables = problem.variables()
        self.programme = Programme(self._variables, terms, Objective(self._variables, terms, {"cost": 1.0}))

    def sigma(self, epsilon: float) -> float:
        """Find the multiplier with the least cost for an eps."""
        natural = self._cost.natural(self._variables, epsilon)
        found = with_multiplier(self.programme, epsilon, natural, WIDELY)
        return found.sigma if found.status.has_gains else natural


def gains_of(problem: RegionProblem, attempt: Attempt) -> Gains:
    """Give an attempt's gains."""
    assert attempt.W is not None
    assert attempt.C is not None
    return problem.gains(attempt.W, attempt.C)
