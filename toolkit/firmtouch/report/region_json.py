"""`RegionDesign` -> its part of `design.json`: numbers in SI, infinite ones as null."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from firmtouch.regulation import ClosedLoop
    from firmtouch.synthesis.region import RegionDesign
    from firmtouch.synthesis.region.audit import TermResult
    from firmtouch.synthesis.region.front import Front
    from firmtouch.synthesis.region.margins import Interval, Margins


def region_as_json(region: RegionDesign) -> dict[str, Any]:
    """Give what a region design adds to `design.json`."""
    problem, polytope = region.problem, region.problem.polytope
    search = region.search
    return {
        "specification": [_result(each) for each in region.results],
        "objective": dict(problem.objective),
        "structure": {
            "kind": problem.structure.kind,
            "text": problem.structure.text,
            "pattern": [list(row) for row in problem.structure.pattern],
        },
        "margins": _margins(region.margins),
        "uncertainty": {
            "parameters": {name: list(interval) for name, interval in polytope.parameters.items()},
            "lambda_d": {"box": polytope.lambda_box, "ball": polytope.lambda_ball},
            "enlargement": polytope.enlargement,
            "remainder": {"M": polytope.remainder_M, "N0": polytope.remainder_N0},
            "vertices": [
                {"label": vertex.label, "control_point": list(vertex.untaken), "poles": _poles(loop)}
                for vertex, loop in zip(polytope.vertices, region.vertices, strict=True)
            ],
            "worst_vertex": region.worst_vertex,
        },
        "search": {
            "stage": search.stage,
            "epsilon": search.epsilon,
            "status": search.status.name.lower(),
            "solver_time": search.solver_time,
            "total_time": search.total_time,
            "solves": search.solves,
        },
        "front": None if region.front is None else _front(region.front),
        "force_front": None if region.force_front is None else _front(region.force_front),
    }


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _poles(loop: ClosedLoop) -> list[list[float]]:
    return [[s.real, s.imag] for s in loop.poles.pencil]


def _result(result: TermResult) -> dict[str, Any]:
    term = result.term
    return {
        "name": term.name,
        "asked": _finite(term.asked),
        "reached": _finite(result.reached),
        "margin": _finite(result.margin),
        "relation": "<=" if term.at_most else ">=",
        "unit": term.unit,
        "worst_vertex": result.worst_vertex,
    }


def _margins(margins: Margins) -> dict[str, Any]:
    return {
        "mu": margins.mu,
        "lambda_d": _finite(margins.lambda_d),
        "N0": _finite(margins.N0),
        "parameters": {name: _interval(each) for name, each in margins.parameters.items()},
        "W": _interval(margins.W),
        "C": _interval(margins.C),
        "edges": [
            {
                "term": each.term,
                "slack": each.slack,
                "unit": each.unit,
                "pole": [each.pole.real, each.pole.imag],
                "vertex": each.vertex,
            }
            for each in margins.edges
        ],
    }


def _interval(interval: Interval) -> list[float | None]:
    return [_finite(interval.low), _finite(interval.high)]


def _front(front: Front) -> dict[str, Any]:
    return {
        "x": {"name": front.x, "unit": front.x_unit},
        "y": {"name": front.y, "unit": front.y_unit},
        "points": [[each.x, each.y] for each in front.points],
        "chosen": None if front.chosen is None else [front.chosen.x, front.chosen.y],
    }
