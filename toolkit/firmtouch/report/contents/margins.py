"""How much more the finished gains of a region design bear."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from firmtouch.design import Design
from firmtouch.report.contents.region_words import (
    amount,
    force_unit,
    is_uncertain,
    pole_pair,
    pole_terms,
    positivity,
    vertex,
)
from firmtouch.report.document import Block, Line, Math, Paragraph, Section, Table
from firmtouch.report.mathematics import symbol
from firmtouch.report.numbers import number, unit

if TYPE_CHECKING:  # else cvxpy would be loaded for every report
    from firmtouch.synthesis.region import RegionDesign
    from firmtouch.synthesis.region.margins import Interval

NOTHING_MORE: Final = "as asked, no more"
UNCHANGED: Final = "1 alone"
SAME: Final = 1e-4
"""Ends that differ by less, relatively, are written alike."""


def section(design: Design) -> Section | None:
    """Write the margins; pole designs have none."""
    region = design.region
    if region is None:
        return None
    blocks: list[Block] = [Paragraph(_intro(region)), _table(design, region)]
    if _stands_at_the_edge(region):
        blocks.append(Paragraph((_at_the_edge(region),)))
    if region.margins.edges:
        blocks.append(_edges(region))
    return Section("Margins", tuple(blocks))


def _intro(region: RegionDesign) -> Line:
    if is_uncertain(region):
        return (
            "What the gains bear beyond what was asked. The margins hold for every plant of the polytope at once: each "
            "is proven by one matrix inequality over all of it, not by samples. So they are lower bounds, and the loop "
            "may bear more.",
        )
    return (
        "What the gains bear beyond what was asked. Each margin is proven by one matrix inequality for all that lies "
        "between, not by samples. So they are lower bounds, and the loop may bear more.",
    )


def _table(design: Design, region: RegionDesign) -> Table:
    headings: tuple[Line, ...] = (("margin of",), ("bears",), ("what it means",))
    goal = "with all poles in the region" if pole_terms(region) else "with a stable loop"
    rows = (*_positivity_rows(design, region), *_parameter_rows(design, region, goal), *_gain_rows(region, goal))
    return Table(headings, rows, wide=frozenset({2}))


def _positivity_rows(design: Design, region: RegionDesign) -> Iterator[tuple[Line, ...]]:
    margins, term, spec = region.margins, positivity(region), design.model.spec
    K = "K" if term.level == "full" else "K_22"
    where = "" if term.level == "full" else " on the free directions"
    yield (
        ("(14): ", Math("mu")),
        (amount(margins.mu, term.unit),),
        (Math("K >= mu D"), f"{where}: how far the stiffness is from losing its definiteness"),
    )
    whatever = "" if design.loop.operating_point.m == 1 else ", whatever its direction"
    yield (
        (Math("lambda_d"),),
        (_limited(margins.lambda_d, force_unit(spec)),),
        ("largest error of the contact force with ", Math(f"{K} > 0"), f" still{whatever}"),
    )
    yield (
        (Math("N_0"),),
        (_limited(100 * margins.N0, "%"),),
        ("largest relative error of the plant's own stiffness with ", Math(f"{K} > 0"), " still"),
    )


def _limited(value: float, its_unit: str) -> str:
    return "no limit" if np.isinf(value) else f"up to {amount(value, its_unit)}"


def _parameter_rows(design: Design, region: RegionDesign, goal: str) -> Iterator[tuple[Line, ...]]:
    """Set the tolerated interval beside the asked one."""
    for name, interval in region.margins.parameters.items():
        its_unit = unit(design.model.spec.parameters[name].unit)
        low, high = region.problem.polytope.parameters[name]
        asked = f"asked: {number(low)} to {number(high)} {its_unit}".rstrip()
        yield (
            (Math(symbol(name)),),
            (_tolerated(interval, low, high, its_unit),),
            (f"values {goal}, what else varies staying in its interval ({asked})",),
        )


def _tolerated(interval: Interval, low: float, high: float, its_unit: str) -> str:
    if _same(interval.low, low) and _same(interval.high, high):
        return NOTHING_MORE
    if np.isinf(interval.low) and np.isinf(interval.high):
        return "no limit found"
    if np.isinf(interval.high):
        return f"from {number(interval.low)} {its_unit} on, no upper limit found".replace("  ", " ")
    if np.isinf(interval.low):
        return f"up to {number(interval.high)} {its_unit}, no lower limit found".replace(" ,", ",")
    return f"{number(interval.low)} to {number(interval.high)} {its_unit}".rstrip()


def _same(a: float, b: float) -> bool:
    """Tell whether two ends are the same, for all that the bisections of the margins can tell."""
    from firmtouch.synthesis.region.margins import POLES_TO

    return bool(np.isclose(a, b, rtol=POLES_TO, atol=0))


def _gain_rows(region: RegionDesign, goal: str) -> Iterator[tuple[Line, ...]]:
    for name, interval in (("W", region.margins.W), ("C", region.margins.C)):
        meaning = ("factors on ", Math(name), f" {goal}, the other gains kept")
        yield ((Math(name),), (_multiplier(interval),), meaning)


def _multiplier(interval: Interval) -> str:
    """Write the factors a gain bears; 0 and infinity stand for where the search for a limit ended."""
    from firmtouch.synthesis.region.margins import FARTHEST

    if _same(interval.low, 1) and _same(interval.high, 1):
        return UNCHANGED
    if interval.low > 0 and np.isfinite(interval.high):
        return f"{number(interval.low)} to {number(interval.high)}"
    low = f"from {number(interval.low)}" if interval.low > 0 else f"no limit found down to 1/{FARTHEST:g}"
    high = f"up to {number(interval.high)}" if np.isfinite(interval.high) else f"no limit found up to {FARTHEST:g}"
    return f"{low}, {high}"


def _stands_at_the_edge(region: RegionDesign) -> bool:
    multipliers = (region.margins.W, region.margins.C)
    asked = region.problem.polytope.parameters
    tolerated = [(each, *asked[name]) for name, each in region.margins.parameters.items()]
    return any(_multiplier(each) == UNCHANGED for each in multipliers) or any(
        _tolerated(each, low, high, "") == NOTHING_MORE for each, low, high in tolerated
    )


def _at_the_edge(region: RegionDesign) -> str:
    why = " The search looked for small gains, so it went up to them." if "gains" in region.problem.objective else ""
    return (
        "Where nothing more is borne, the gains fulfil the inequalities with nothing left to spare."
        f"{why} Ask for more to have more: a faster decay, a wider interval, or a large margin as the objective."
    )


def _edges(region: RegionDesign) -> Table:
    many, asked = is_uncertain(region), {each.name: each for each in pole_terms(region)}
    headings: tuple[Line, ...] = (("edge",), ("asked",), ("slack",), ("pole, 1/s",), *((("at",),) if many else ()))
    rows = []
    for each in region.margins.edges:
        bound = amount(asked[each.term].asked, each.unit)
        cells: list[Line] = [(each.term,), (bound,), (amount(each.slack, each.unit),), (pole_pair(each.pole),)]
        rows.append((*cells, *((vertex(region, each.vertex),) if many else ())))
    where = "the nearest pole of any vertex" if many else "the nearest pole"
    caption: Line = (f"How far {where} is from each edge of the region.",)
    return Table(headings, tuple(rows), frozenset({1, 2, 3}), caption, frozenset({4} if many else ()))
