"""The convex search itself: problem -> programme -> attempts, each re-checked from its gains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from firmtouch.regulation import Gains
from firmtouch.synthesis.region.objective import Objective
from firmtouch.synthesis.region.problem import RegionProblem
from firmtouch.synthesis.region.programme import Attempt, Programme
from firmtouch.synthesis.region.search import search
from firmtouch.synthesis.region.terms.guaranteed_cost import GuaranteedCost


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
        self._cost = next((each for each in problem.terms if isinstance(each, GuaranteedCost)), None)

    def run(self) -> Found:
        """Search for the best eps."""
        attempts = search(self._programme, self.problem.where, self._holds, self._natural if self._cost else None)
        return Found(attempts, self._programme.solver_time, self._programme.solves)

    def _holds(self, attempt: Attempt) -> bool:
        return not self._checked or self.problem.audit(gains_of(self.problem, attempt)).holds

    def _natural(self, epsilon: float) -> float:
        assert self._cost is not None
        return self._cost.natural(self.variables, epsilon)


def gains_of(problem: RegionProblem, attempt: Attempt) -> Gains:
    """Give an attempt's gains."""
    assert attempt.W is not None
    assert attempt.C is not None
    return problem.gains(attempt.W, attempt.C)
