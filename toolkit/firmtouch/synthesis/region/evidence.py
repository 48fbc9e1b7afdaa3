"""What proves that finished gains keep the poles of a whole polytope in the region, for others to check."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from firmtouch.regulation import Gains
from firmtouch.synthesis.region.alternation import Multiplier, general_proof
from firmtouch.synthesis.region.problem import RegionProblem
from firmtouch.synthesis.region.proof import best_energy_epsilon
from firmtouch.synthesis.region.terms.term import RegionTerm


@dataclass(frozen=True, slots=True)
class Evidence:
    """eps of [T4] (1/s) for which all inequalities hold; or F and P of each edge, by the name of its term."""

    epsilon: float | None = None
    multipliers: Mapping[str, Multiplier] = field(default_factory=dict)


def find_evidence(problem: RegionProblem, gains: Gains, epsilon: float | None = None) -> Evidence | None:
    """Find eps, beginning with one that is given, or general Lyapunov matrices; none if neither is found."""
    terms = [each for each in problem.terms if isinstance(each, RegionTerm)]
    omega, tangents = problem.scaling.omega, problem.tangents(gains)
    regions = [each.region().in_time_unit(omega) for each in terms]
    best, slack = best_energy_epsilon(tangents, regions, hint=(epsilon or omega) / omega)
    if slack > 0:
        return Evidence(epsilon=best * omega)
    multipliers = general_proof(tangents, regions)
    if multipliers is None:
        return None
    return Evidence(multipliers={term.name: each for term, each in zip(terms, multipliers, strict=True)})
