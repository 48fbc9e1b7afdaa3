"""Pareto fronts: how much of one objective another one costs."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import cvxpy as cp
import numpy as np

from firmtouch.errors import InputError, NoDesignError
from firmtouch.modelfile import ModelSpec
from firmtouch.modelfile.vector_units import units_of
from firmtouch.synthesis.region.convex import ConvexSearch
from firmtouch.synthesis.region.objective import Objective
from firmtouch.synthesis.region.problem import RegionProblem
from firmtouch.synthesis.region.programme import Attempt

POINTS: Final = 9
AXES: Final = {"gains": "size of the gains", "margin": "margin of (14)", "cost": "guaranteed cost"}
SIGNS: Final = {"gains": 1, "margin": -1, "cost": 1}
NEARLY: Final = 1e-4


@dataclass(frozen=True, slots=True)
class FrontPoint:
    """One design on a front: its two figures, in the axes' units."""

    x: float
    y: float


@dataclass(frozen=True, slots=True)
class Front:
    """The best y for each x: what the axes are, their units, and the points from one end to the other.

    The first point is best in x alone, the last in y alone; `chosen` is the design itself, if it is on this front.
    """

    x: str
    y: str
    x_unit: str
    y_unit: str
    points: tuple[FrontPoint, ...]
    chosen: FrontPoint | None = None


def pareto_front(problem: RegionProblem, spec: ModelSpec, x: str, y: str) -> Front:
    """Minimise each of two objectives alone, then y under bounds on x between the two ends.

    Raises
    ------
    InputError
        If these two are no pair of different objectives that the file's terms define.
    NoDesignError
        If an end of the front is not found.
    """
    known = ["gains", "margin", *(["cost"] if spec.design.region and spec.design.region.cost else [])]
    if x == y or x not in known or y not in known:
        raise InputError(f"`{x},{y}` is no pair of objectives; take two of: {', '.join(known)}")
    ends = [_only(problem, each, other).figures for each, other in ((x, y), (y, x))]
    if not all(ends):
        raise NoDesignError(
            "there is no front to draw: the convex search, whose condition is sufficient and not necessary, finds no "
            "gains that are best in one objective alone (a largest margin also needs something that bounds the gains)"
        )
    variables = problem.variables()
    objective = Objective(variables, problem.terms, {x: 0.0, y: 1.0})
    bound = cp.Parameter()
    search = ConvexSearch(problem, objective, (objective.expressions[x] <= bound,))
    points = [ends[0]]
    for value in np.linspace(ends[0][x], ends[1][x], POINTS)[1:-1]:
        bound.value = value
        best = search.run().best
        if best.status.has_gains:
            points.append(best.figures)
    points.append(ends[1])
    units = {"gains": units_of(spec).stiffness, "margin": units_of(spec).stiffness, "cost": "s"}
    shown = tuple(FrontPoint(SIGNS[x] * each[x], SIGNS[y] * each[y]) for each in points)
    alone = next(iter(problem.objective)) if len(problem.objective) == 1 else None
    chosen = {x: shown[0], y: shown[-1]}.get(alone) if alone is not None else None
    return Front(AXES[x], AXES[y], units[x], units[y], shown, chosen)


def _only(problem: RegionProblem, name: str, other: str) -> Attempt:
    """Minimise one objective; the other one breaks ties, so that the end of the front belongs to it."""
    return ConvexSearch(replace(problem, objective={name: 1.0, other: NEARLY})).run().best
