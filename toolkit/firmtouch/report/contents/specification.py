"""What a region design was asked, what it reaches, and how its gains were found."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from firmtouch.design import Design
from firmtouch.report.contents.region_words import (
    OF_D,
    amount,
    edges,
    is_choice_of_blocks,
    is_uncertain,
    positivity,
    relation,
    vertex,
)
from firmtouch.report.document import (
    Block,
    Code,
    Equation,
    Figure,
    Line,
    Math,
    Matrices,
    Matrix,
    Paragraph,
    Section,
    Table,
)
from firmtouch.report.figures.front import Axis, Tradeoff, front_chart
from firmtouch.report.numbers import number, vector

if TYPE_CHECKING:  # else cvxpy would be loaded for every report
    from firmtouch.synthesis.region import RegionDesign
    from firmtouch.synthesis.region.audit import TermResult
    from firmtouch.synthesis.region.front import Front

_DECAY: Final = "-(P_m A + A^T P_m) - 2 alpha P_m >= 0"
_DAMPING: Final = (
    'mat(delim: "[", sin theta (P_m A + A^T P_m), cos theta (P_m A - A^T P_m); '
    "cos theta (A^T P_m - P_m A), sin theta (P_m A + A^T P_m)) <= 0"
)
_BANDWIDTH: Final = 'mat(delim: "[", w P_m, P_m A; A^T P_m, w P_m) >= 0'
_RESCUES: Final = {
    "fewer edges": "So one edge of the region was left out of a search for small gains, and those that it found "
    "keep that edge all the same.",
    "poles": "So the gains come from pole assignment: one pair of poles for all free directions, on a grid over the "
    "region, and the first one with which all terms hold.",
    "alternation": "So the gains come from an alternation: Lyapunov matrices of a general form for given gains, then "
    "gains for given matrices, until all terms hold.",
    "descent": "So the gains come from a local search on the poles, and turns between general Lyapunov matrices and "
    "gains that began there, until all terms hold.",
}
_OBJECTIVES: Final[dict[str, Line]] = {
    "gains": ("small gains ", Math("norm(W)_F + omega norm(C)_F")),
    "margin": ("a large margin of (14)",),
    "cost": ("a small guaranteed cost",),
    "force_error": ("a small steady-state force error",),
}
_STRUCTURES: Final = {
    "diagonal": "are diagonal: each joint is fed back alone",
    "block": "are block-diagonal: coordinates are fed back together within their groups alone",
    "banded": "are banded: a coordinate is fed back to itself and its neighbours alone",
    "pattern": "have the pattern that the file lists",
}


def section(design: Design) -> Section | None:
    """Write the specification; pole designs have none."""
    region = design.region
    if region is None:
        return None
    blocks: list[Block] = [
        Paragraph(_intro(region)),
        *_inequalities(region),
        _table(region),
        *_notes(region),
        *_structure(region),
        *(Paragraph(each) for each in _found(region)),
        *_fronts(region),
    ]
    return Section("Specification", tuple(blocks))


def _intro(region: RegionDesign) -> Line:
    gains: Line = ("One pair of gains ", Math("W, C"), " was searched for that makes ")
    if not is_uncertain(region):
        return (*gains, "the plant meet all of the following.")
    count = len(region.vertices)
    return (
        *gains,
        f"each of the {count} plants at the vertices of the polytope meet all of the following; the region of the "
        "poles is then proven for every plant between them too.",
    )


def _inequalities(region: RegionDesign) -> Iterator[Block]:
    """Write [T4] for the edges that were asked for."""
    asked = edges(region)
    formulas: list[tuple[Line, str]] = []
    if asked.decay is not None:
        formulas.append(((Math("alpha"), f" = {number(asked.decay)} 1/s"), _DECAY))
    if asked.damping is not None:
        formulas.append(((Math("cos theta"), f" = {number(asked.damping)}"), _DAMPING))
    if asked.bandwidth is not None:
        formulas.append(((Math("w"), f" = {number(asked.bandwidth)} rad/s"), _BANDWIDTH))
    if not formulas:
        return
    yield Paragraph(
        (
            "On the free directions the linearised loop is ",
            Math("dot(x) = A x"),
            " with ",
            Math("x = (z, dot(z))"),
            ". With the energy-like matrix ",
            Math("P_m"),
            " and a number ",
            Math("epsilon > 0"),
            " all is affine in the gains and in the plant:",
        )
    )
    yield Equation(
        'P_m = mat(delim: "[", K_22, epsilon M_22; epsilon M_22, M_22) > 0, quad '
        'P_m A = mat(delim: "[", -epsilon K_22, K_22 - epsilon C_22; -K_22, epsilon M_22 - C_22)',
        "[T4]",
    )
    yield Paragraph(("The region of the poles is a set of matrix inequalities, with ", *_listed(formulas), ":"))
    for _, formula in formulas:
        yield Equation(formula, "[T4]")


def _listed(formulas: list[tuple[Line, str]]) -> Line:
    first, *others = (words for words, _ in formulas)
    return (*first, *(span for each in others for span in (", ", *each)))


def _table(region: RegionDesign) -> Table:
    many = is_uncertain(region)
    headings: tuple[Line, ...] = (("",), ("asked",), ("reached",), ("margin",), *((("worst at",),) if many else ()))
    rows = tuple((*_row(each), *((_worst(region, each),) if many else ())) for each in region.results)
    return Table(headings, rows, frozenset({1, 2, 3}), wide=frozenset({4} if many else ()))


def _row(result: TermResult) -> tuple[Line, ...]:
    term = result.term
    if is_choice_of_blocks(term):
        deviation = "exactly" if result.reached == 0 else f"deviation {number(result.reached, 2)}"
        return ((term.name,), ("as chosen",), (deviation,), ("",))
    reached = (amount(result.reached, term.unit),)
    if np.isinf(term.asked):
        return ((term.name,), ("as small as possible",), reached, ("",))
    asked = f"{relation(term)} {amount(term.asked, term.unit)}"
    return ((term.name,), (asked,), reached, (amount(result.margin, term.unit),))


def _worst(region: RegionDesign, result: TermResult) -> Line:
    return ("nominal plant",) if result.term.nominal else vertex(region, result.worst_vertex)


def _notes(region: RegionDesign) -> Iterator[Block]:
    """Explain what the table's words leave open."""
    term = positivity(region)
    level = "" if term.level == "full" else ", on the directions that the constraints leave free"
    margin: Line = ("The margin of (14) is the greatest ", Math("mu"), " with ", Math("K >= mu D"), level)
    if term.unit == OF_D:
        yield Paragraph((*margin, "; the file asks for the diagonal ", Math("D"), f" = diag{vector(term.D)}."))
    else:
        yield Paragraph((*margin, "; here ", Math("D = I"), "."))


def _structure(region: RegionDesign) -> Iterator[Block]:
    structure = region.problem.structure
    if structure.kind == "full":
        yield Paragraph((Math("W"), " and ", Math("C"), " may be full symmetric matrices."))
        return
    written: Line = (" (", Code(structure.text), ")") if structure.text != structure.kind else ()
    yield Paragraph((Math("W"), " and ", Math("C"), f" {_STRUCTURES[structure.kind]}", *written, "."))
    rows = tuple(tuple("•" if entry else "·" for entry in row) for row in structure.pattern)
    yield Matrices((Matrix(Math('"pattern of" W, C'), rows, ""),))


def _found(region: RegionDesign) -> Iterator[Line]:
    record = region.search
    programmes = f"{record.solves} semidefinite programmes took the solver {number(record.solver_time, 2)} s"
    total = f"{number(record.total_time, 2)} s"
    if record.stage == "convex":
        yield (
            "The gains come from the convex search: one semidefinite programme for each of several ",
            Math("epsilon"),
            ", of which the best is ",
            Math("epsilon"),
            f" = {number(record.epsilon)} 1/s ({record.status.value}). {programmes} of {total} in all.",
        )
        yield ("Among all gains that satisfy this, it looked for ", *_objective(region), ".")
        return
    how = _RESCUES[record.stage]
    if is_uncertain(region):
        how += " General Lyapunov matrices prove the region for all plants between the vertices."
    yield (*_in_vain(region), f" {how} In the first search {programmes}; all took {total}.")
    yield ("These gains satisfy what was asked, and are not the best ones in the sense of the objective.",)


def _in_vain(region: RegionDesign) -> Line:
    """Say how the convex search ended without gains."""
    from firmtouch.synthesis.region.programme import Status

    status = region.search.status
    if status is Status.INFEASIBLE:
        return ("The inequalities above have no solution for any ", Math("epsilon"), " that was tried.")
    return ("The inequalities above gave no gains for any ", Math("epsilon"), f" that was tried ({status.value}).")


def _objective(region: RegionDesign) -> Line:
    weights = region.problem.objective
    spans: list[Line] = []
    for name, weight in weights.items():
        times = f" (weight {number(weight)})" if len(weights) > 1 else ""
        spans.append((*_OBJECTIVES[name], times))
    omega: Line = (" with ", Math("omega"), f" = {number(region.problem.scaling.omega, 3)} rad/s")
    joined: Line = spans[0]
    for each in spans[1:]:
        joined = (*joined, ", ", *each)
    return (*joined, *(omega if "gains" in weights else ()))


def _fronts(region: RegionDesign) -> Iterator[Block]:
    if region.force_front is not None and region.force_front.points:
        yield Paragraph(
            (
                "With the tangent blocks of these gains kept, a second stage chose the normal and mixed blocks, which "
                "trade the contact force's transient for its steady-state error:",
            )
        )
        yield _front(region.force_front, "force-front")
    if region.front is not None and region.front.points:
        yield Paragraph(("How much one objective costs in terms of another, at the same terms:",))
        yield _front(region.front, "front")


def _front(front: Front, prefix: str) -> Figure:
    caption = f"The best {front.y} for each {front.x}; squares are best in one of the two alone"
    design = "; the ring is this design" if front.chosen is not None else ""
    ends = (front.points[0], front.points[-1])
    told = " to ".join(f"{number(p.x, 3)} {front.x_unit} and {number(p.y, 3)} {front.y_unit}" for p in ends)
    alt = f"Front of {front.y} against {front.x} with {len(front.points)} points, from {told}"
    return Figure(front_chart(tradeoff(front), prefix), (f"{caption}{design}.",), alt, 0.66)


def tradeoff(front: Front) -> Tradeoff:
    """Give a front as it is drawn; there must be a point."""
    x, y = (tuple(getattr(each, axis) for each in front.points) for axis in ("x", "y"))
    chosen = None if front.chosen is None else (front.chosen.x, front.chosen.y)
    return Tradeoff(Axis(front.x, front.x_unit, x), Axis(front.y, front.y_unit, y), chosen)
