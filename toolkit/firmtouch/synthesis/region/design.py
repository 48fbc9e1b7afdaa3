"""A region design from its words to checked gains."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from firmtouch.modelfile import ModelSpec
from firmtouch.regulation import ClosedLoop, Gains, OperatingPoint, close_loop
from firmtouch.synthesis.region.audit import TermResult
from firmtouch.synthesis.region.conflicts import explain, missed
from firmtouch.synthesis.region.convex import ConvexSearch, Found, gains_of
from firmtouch.synthesis.region.evidence import Evidence, find_evidence
from firmtouch.synthesis.region.force_shaping import shape_force
from firmtouch.synthesis.region.front import Front
from firmtouch.synthesis.region.margins import Margins, find_margins
from firmtouch.synthesis.region.problem import RegionProblem, build_problem
from firmtouch.synthesis.region.programme import Status, Stopwatch
from firmtouch.synthesis.region.rescue import rescue
from firmtouch.synthesis.region.terms.force_errors import DisturbanceForceError, ForceError

ROUNDS: Final = 5
"""Of sequential programmes around a reference."""


@dataclass(frozen=True, slots=True)
class SearchRecord:
    """How the gains were found: by which stage, at which eps (1/s), and what it took (s)."""

    stage: str
    epsilon: float
    status: Status
    solver_time: float
    total_time: float
    solves: int


@dataclass(frozen=True, slots=True)
class RegionDesign:
    """Gains that meet a specification at every vertex of the polytope, with what they reach there."""

    problem: RegionProblem
    loop: ClosedLoop
    vertices: tuple[ClosedLoop, ...]
    results: tuple[TermResult, ...]
    margins: Margins
    evidence: Evidence | None
    search: SearchRecord
    force_front: Front | None = None
    front: Front | None = None

    @property
    def worst_vertex(self) -> int:
        """The vertex at which the terms have the least margin, each relative to what it asks."""
        worst = min(self.results, key=lambda each: each.margin / each.term.asked if each.term.asked else np.inf)
        return worst.worst_vertex


def design_region(
    op: OperatingPoint, spec: ModelSpec, progress: Callable[[str], None] = lambda _: None
) -> RegionDesign:
    """Find gains that meet a file's specification at every vertex of its polytope; `progress` is told each step.

    Raises
    ------
    NoGainsError
        If none are found; it says which terms conflict.
    InputError
        If the inertia matrix is not positive definite somewhere in the intervals.
    """
    return solve_problem(build_problem(op, spec), progress)


def solve_problem(problem: RegionProblem, progress: Callable[[str], None] = lambda _: None) -> RegionDesign:
    """Search by [T4]; where that finds nothing, by pole assignment (full matrices) or by alternation.

    Raises
    ------
    NoGainsError
        If there are none.
    """
    watch = Stopwatch()
    first, stage, found = _first_stage(problem, progress)
    took, shape = watch.read(), None
    if problem.shaped:
        progress("shaping the contact force")
        shape = shape_force(problem, close_loop(problem.op, first))
    gains = first if shape is None else shape.gains
    checked = problem.audit(gains)
    if not checked.holds:
        raise missed(checked)
    progress("proving margins")
    record = SearchRecord(stage, found.best.epsilon, found.best.status, found.solver_time, took, found.solves)
    return RegionDesign(
        problem=problem,
        loop=checked.nominal,
        vertices=checked.loops,
        results=checked.results,
        margins=find_margins(problem, gains, checked.loops, found.best.epsilon),
        evidence=find_evidence(problem, gains, found.best.epsilon),
        search=record,
        force_front=None if shape is None else shape.front,
    )


def _first_stage(problem: RegionProblem, progress: Callable[[str], None]) -> tuple[Gains, str, Found]:
    """Find W and C for all terms but those that the second stage sees to, or that need a reference."""
    asked = tuple(each for each in problem.terms if not isinstance(each, ForceError))
    plain = problem.with_terms(asked)
    found = ConvexSearch(plain).run()
    if found.best.status.has_gains:
        gains, stage = gains_of(plain, found.best), "convex"
        if problem.shaped or len(asked) == len(problem.terms):
            return gains, stage, found
        return *_around(problem, gains), found
    progress("the convex search found nothing: looking further")
    rescued, stage = rescue(plain)
    if rescued is None:
        progress("finding out which terms conflict")
        raise explain(plain, found.best.status)
    return rescued, stage, found


def _around(problem: RegionProblem, gains: Gains) -> tuple[Gains, str]:
    """Meet bounds on force errors by sequential convex programmes around what was found before."""
    for _ in range(ROUNDS):
        checked = problem.audit(gains)
        if checked.holds:
            break
        K = checked.nominal.split.blocks(checked.nominal.K)
        L = K.X12 @ np.linalg.inv(K.X22)
        terms = tuple(
            replace(each, reference=K.X22 if isinstance(each, DisturbanceForceError) else L)
            if isinstance(each, ForceError)
            else each
            for each in problem.terms
        )
        around = problem.with_terms(terms)
        best = ConvexSearch(around, checked=False).run().best
        if not best.status.has_gains:
            raise missed(checked)
        gains = gains_of(around, best)
    return gains, "convex"
