"""One convex problem, compiled once and solved for many eps; the solver's word is heard, and never simply believed."""

from __future__ import annotations

import time
import warnings
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Final

import cvxpy as cp

from firmtouch.mechanics import Array
from firmtouch.synthesis.region.objective import Objective
from firmtouch.synthesis.region.terms.term import Term
from firmtouch.synthesis.region.variables import Variables

_ACCURACY: Final[dict[str, Any]] = {
    "chordal_decomposition_enable": False,
    "presolve_enable": False,
    "tol_gap_abs": 1e-6,
    "tol_gap_rel": 1e-6,
}
"""The objective need not be exact; a compiled problem keeps its form only without decomposition and presolve."""

INSIDE: Final = 1e-5
"""How much more than asked the problem asks for, relatively: the solver is accurate to less, and no term is missed."""

SETTINGS: Final[tuple[dict[str, Any], ...]] = (
    _ACCURACY,
    {
        **_ACCURACY,
        "max_step_fraction": 0.9,
        "equilibrate_max_iter": 50,
        "static_regularization_constant": 1e-7,
        "iterative_refinement_max_iter": 50,
        "max_iter": 400,
    },
)
"""What Clarabel is asked first, and what it is asked when it came to no end: shorter, better conditioned steps."""


def inside(term: Term) -> Term:
    """Ask for a little more than asked."""
    return term.eased(1 / (1 + INSIDE)) if term.can_be_eased else term


class Status(Enum):
    """How a convex problem ended; the text says what follows from it."""

    SOLVED = "solved"
    ALMOST = "almost solved: the gains count only because they passed every check"
    INFEASIBLE = "no gains satisfy the inequalities for this eps"
    UNBOUNDED = "the objective grows without bound: bound the gains or the bandwidth"
    TROUBLE = "the solver came to no end, with either of two settings"

    @property
    def has_gains(self) -> bool:
        """Tell whether there are gains to look at."""
        return self in (Status.SOLVED, Status.ALMOST)


@dataclass(frozen=True, slots=True)
class Attempt:
    """What the solver said for one eps (in 1/s) and tau: W, C in SI and the objective, where there are any."""

    epsilon: float
    status: Status
    objective: float = float("inf")
    W: Array | None = None
    C: Array | None = None
    sigma: float = 1.0
    figures: dict[str, float] = field(default_factory=dict)


class Programme:
    """Minimise the objective subject to all terms; eps and tau are parameters of the compiled problem.

    `solver_time` and `solves` grow with use: what Clarabel itself took.
    """

    def __init__(
        self,
        variables: Variables,
        terms: tuple[Term, ...],
        objective: Objective,
        extra: tuple[Any, ...] = (),
    ) -> None:
        self.variables, self.objective = variables, objective
        constraints = [each for term in terms for each in inside(term).constraints(variables)]
        self.problem = cp.Problem(cp.Minimize(objective.total()), [*constraints, *objective.constraints, *extra])
        self.solver_time, self.solves = 0.0, 0

    def solve(self, epsilon: float, sigma: float = 1.0) -> Attempt:
        """Solve for one eps, in 1/s, with a second try at other settings before the solver is said to be in trouble."""
        v = self.variables
        v.eps.value = epsilon / v.scaling.omega
        v.sigma.value, v.tau.value = sigma, 1 / sigma
        status = Status.TROUBLE
        for settings in SETTINGS:
            status = self._run(settings)
            if status in (Status.SOLVED, Status.INFEASIBLE, Status.UNBOUNDED):
                break
        if not status.has_gains:
            return Attempt(epsilon, status)
        W, C = v.values()
        figures = {name: float(each.value) for name, each in self.objective.expressions.items()}
        return Attempt(epsilon, status, float(self.problem.value), W, C, sigma, figures)

    def _run(self, settings: dict[str, Any]) -> Status:
        self.solves += 1
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # "may be inaccurate": its status says so too
                self.problem.solve(solver=cp.CLARABEL, **settings)
        except cp.SolverError:
            return Status.TROUBLE
        self.solver_time += float(self.problem.solver_stats.solve_time or 0.0)
        match self.problem.status:
            case cp.OPTIMAL:
                return Status.SOLVED
            case cp.OPTIMAL_INACCURATE:
                return Status.ALMOST
            case cp.INFEASIBLE | cp.INFEASIBLE_INACCURATE:
                return Status.INFEASIBLE
            case cp.UNBOUNDED | cp.UNBOUNDED_INACCURATE:
                return Status.UNBOUNDED
            case _:
                return Status.TROUBLE


@dataclass(slots=True)
class Stopwatch:
    """Wall time since it was made."""

    begun: float = field(default_factory=time.perf_counter)

    def read(self) -> float:
        """Give the seconds gone."""
        return time.perf_counter() - self.begun
