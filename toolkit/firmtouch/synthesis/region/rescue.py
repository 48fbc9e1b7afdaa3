"""What is tried when [T4] has no solution: fewer edges, pole assignment (full matrices), turns (structured gains)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import cvxpy as cp
import numpy as np

from firmtouch.mechanics.arrays import symmetric
from firmtouch.modelfile.sections.design import NormalBlocks
from firmtouch.regulation import Gains, split_directions
from firmtouch.regulation.lmi_region import LmiRegion
from firmtouch.synthesis.normal_blocks import damping_blocks, stiffness_blocks
from firmtouch.synthesis.region.alternation import (
    ROUNDS,
    Multiplier,
    best_multiplier,
    lyapunov_constraints,
    solve_quietly,
)
from firmtouch.synthesis.region.convex import ConvexSearch, gains_of
from firmtouch.synthesis.region.descent import descend
from firmtouch.synthesis.region.elastic import SMALL_GAINS, Elastic, size_of
from firmtouch.synthesis.region.evidence import find_evidence
from firmtouch.synthesis.region.problem import RegionProblem
from firmtouch.synthesis.region.terms.term import RegionTerm

FREQUENCIES: Final = 25
SPREAD: Final = 20.0
"""Without a bandwidth, poles up to this factor faster than the decay rate are tried."""
DAMPINGS: Final = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 1.2)
PATIENCE: Final = 3
GROWTH: Final = 0.05
"""By which part of itself the slack of the alternation must grow in so many rounds."""


def rescue(problem: RegionProblem) -> tuple[Gains | None, str]:
    """Try what fits the structure, and name it."""
    if problem.polytope.remainder_M or problem.polytope.remainder_N0:
        return None, ""  # the proofs that are needed here do not cover a ball around the polytope
    gains = without_one_edge(problem)
    if gains is not None:
        return gains, "fewer edges"
    if problem.structure.kind == "full":
        return assigned_into(problem), "poles"
    gains = alternate(problem, nearest(problem))
    if gains is not None:
        return gains, "alternation"
    return alternate(problem, descend(problem)), "descent"


def without_one_edge(problem: RegionProblem) -> Gains | None:
    """Ask for one edge of the region less: gains that are small often keep it all the same."""
    for term in reversed(problem.terms):
        if isinstance(term, RegionTerm):
            rest = tuple(each for each in problem.terms if each is not term)
            fewer = replace(problem.with_terms(rest), objective={"gains": 1.0})
            best = ConvexSearch(fewer).run().best
            gains = gains_of(fewer, best) if best.status.has_gains else None
            if gains is not None and problem.audit(gains).holds and proven(problem, gains):
                return gains
    return None


def assigned_into(problem: RegionProblem) -> Gains | None:
    """Give every tangent direction one and the same pair of poles, and see whether the rest of the terms holds too.

    K22 = k M22 and C22 = c M22 for poles on a grid over the region; the other blocks as [T1] and [T3] have them.
    """
    op, split = problem.op, split_directions(problem.op.J)
    M, N0, policy = split.blocks(op.M), split.blocks(op.N0), NormalBlocks()
    slow, fast = problem.where.slow, min(problem.where.fast, SPREAD * problem.where.slow)
    for frequency in np.geomspace(slow, fast, FREQUENCIES):
        for damping in DAMPINGS:
            k, c = frequency**2, 2 * damping * frequency
            K = split.assemble(stiffness_blocks(symmetric(k * M.X22), M, N0, policy))
            C = split.assemble(damping_blocks(symmetric(c * M.X22), M, policy))
            gains = problem.gains(K - op.N0, C)
            if problem.audit(gains).holds and proven(problem, gains):
                return gains
    return None


def proven(problem: RegionProblem, gains: Gains) -> bool:
    """Prove the region for all plants between the vertices; one plant alone has its poles for a proof."""
    return len(problem.points) == 1 or find_evidence(problem, gains) is not None


def nearest(problem: RegionProblem) -> Gains | None:
    """Give the gains that miss the inequalities of [T4] by least."""
    found = Elastic(problem).best()
    return found[0].gains if found else None


def alternate(problem: RegionProblem, start: Gains | None) -> Gains | None:
    """Look for gains in turns: given them the best multipliers, given these the best gains, until a proof is found.

    It goes on for as long as the slack grows: a few hundredths of itself in three rounds, or it is given up.
    """
    regions = [
        each.region().in_time_unit(problem.scaling.omega) for each in problem.terms if isinstance(each, RegionTerm)
    ]
    if start is None or not regions:
        return None
    gains, slacks = start, list[float]()
    for _ in range(ROUNDS):
        if problem.audit(gains).holds and proven(problem, gains):
            return gains
        tangents = problem.tangents(gains)
        multipliers = [each for region in regions if (each := best_multiplier(tangents, region)) is not None]
        better = _best_gains(problem, regions, multipliers) if len(multipliers) == len(regions) else None
        if better is None:
            return None
        gains, slack = better
        slacks.append(slack)
        if len(slacks) > PATIENCE and slack - slacks[-1 - PATIENCE] < GROWTH * abs(slack):
            return None
    return None


def _best_gains(
    problem: RegionProblem, regions: Sequence[LmiRegion], multipliers: Sequence[Multiplier]
) -> tuple[Gains, float] | None:
    """Maximise the slack over the gains and P, with the multipliers fixed, and all other terms kept."""
    variables, slack = problem.variables(), cp.Variable()
    others = (each for each in problem.terms if not isinstance(each, RegionTerm))
    constraints = [slack <= 1, *(each for term in others for each in term.constraints(variables))]
    for region, multiplier in zip(regions, multipliers, strict=True):
        for corner, K22 in zip(variables.corners, variables.K22, strict=True):
            G = cp.hstack([K22, variables.C22, corner.M22])
            P = cp.Variable((2 * variables.t, 2 * variables.t), symmetric=True)
            constraints += lyapunov_constraints(region, P, multiplier.F.T @ G + G.T @ multiplier.F, slack, 0.0)
    if not solve_quietly(cp.Problem(cp.Maximize(slack - SMALL_GAINS * size_of(variables)), constraints)):
        return None
    return problem.gains(*variables.values()), float(slack.value)
