"""For which plants the gains hold: what varies, and what becomes of the poles at every vertex of the polytope."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from firmtouch.design import Design
from firmtouch.modelfile import ModelSpec
from firmtouch.regulation import ClosedLoop
from firmtouch.regulation.uncertainty import Polytope
from firmtouch.report.contents.region_words import amount, force_unit, is_uncertain, multiplier_unit, positivity, vertex
from firmtouch.report.document import Block, Line, Math, Paragraph, Section, Table
from firmtouch.report.mathematics import symbol
from firmtouch.report.numbers import number

if TYPE_CHECKING:  # else cvxpy would be loaded for every report
    from firmtouch.synthesis.region import RegionDesign

MOST_ROWS: Final = 12
"""Vertices that are listed; of more, those with the least damping."""
EXACT: Final = 1e-6


def section(design: Design) -> Section | None:
    """Write for which plants a region design holds; nothing if there is one plant alone."""
    region = design.region
    if region is None or not is_uncertain(region):
        return None
    blocks: list[Block] = [
        Paragraph(
            (
                "The gains are the same for all plants in a polytope of ",
                Math("(M, N_0)"),
                f" with {len(region.vertices)} vertices. It contains all that these ranges make of the plant:",
            )
        ),
        _ranges(region.problem.polytope, design),
        *(Paragraph(each) for each in _size(region.problem.polytope, design.model.spec)),
        _vertices(region),
        *(Paragraph(each) for each in _caveats(region)),
    ]
    return Section("Uncertainty", tuple(blocks))


def _ranges(polytope: Polytope, design: Design) -> Table:
    spec = design.model.spec
    rows: list[tuple[Line, ...]] = []
    for name, (low, high) in polytope.parameters.items():
        each = spec.parameters[name]
        interval = f"{number(low)} to {amount(high, each.unit)}"
        rows.append(((Math(symbol(name)),), (interval,), (amount(each.value.value, each.unit),), (each.label or "",)))
    lambda_d = design.loop.operating_point.lambda_d
    for (name, constraint), nominal in zip(spec.constraints.items(), map(float, lambda_d), strict=True):
        half, its_unit = (polytope.lambda_box or {}).get(name, 0.0), multiplier_unit(spec, name)
        if half:
            interval = f"{number(nominal - half)} to {amount(nominal + half, its_unit)}"
            what: Line = (Math("lambda_d"), f" of {name.replace('_', ' ')}")
            rows.append((what, (interval,), (amount(nominal, its_unit),), (constraint.label or "",)))
    return Table(
        (("what varies",), ("range",), ("nominal",), ("",)), tuple(rows), frozenset({1, 2}), wide=frozenset({3})
    )


def _size(polytope: Polytope, spec: ModelSpec) -> Iterator[Line]:
    """Say how much larger the polytope is than what occurs."""
    if polytope.lambda_ball:
        ball = amount(polytope.lambda_ball, force_unit(spec))
        yield (Math("lambda_d"), f" may moreover be wrong by any vector of up to {ball} in norm.")
    if polytope.enlargement <= 1 + EXACT:
        yield ("The polytope is exactly the convex hull of what occurs.",)
    else:
        text = "The polytope is larger than the convex hull of what occurs, by a factor of about "
        yield (f"{text}{number(polytope.enlargement, 3)} in size, so that the conditions are a little conservative.",)
    if polytope.remainder_M or polytope.remainder_N0:
        yield (
            "As some parameters do not enter as polynomials, it is widened by balls that bound the remainder: "
            f"{number(polytope.remainder_M, 2)} around ",
            Math("M"),
            f" and {number(polytope.remainder_N0, 2)} around ",
            Math("N_0"),
            " (2-norms, in SI).",
        )


def _vertices(region: RegionDesign) -> Table:
    K = Math("K" if positivity(region).level == "full" else "K_22")
    headings: tuple[Line, ...] = (("vertex",), ("damping",), ("decay, 1/s",), ("|s|, rad/s",), (K,))
    order = sorted(range(len(region.vertices)), key=lambda i: _damping(region.vertices[i]))
    shown = sorted(order[:MOST_ROWS])
    rows = [(vertex(region, i), *_figures(region, region.vertices[i])) for i in shown]
    rows.append((("nominal plant",), *_figures(region, region.loop)))
    few = ""
    if len(shown) < len(order):
        few = f" Of the {len(order)} vertices, these are the {len(shown)} with the least damping ratio."
    text = "Of all poles the least damping ratio, the least decay rate and the greatest |s|; the least eigenvalue of "
    caption: Line = (text, K, f".{few}")
    return Table(headings, tuple(rows), frozenset({1, 2, 3, 4}), caption, frozenset({0}))


def _figures(region: RegionDesign, loop: ClosedLoop) -> tuple[Line, ...]:
    poles = loop.poles.pencil
    level = loop.full if positivity(region).level == "full" else loop.tangent
    decay, fastest = min(-pole.real for pole in poles), max(abs(pole) for pole in poles)
    values = (_damping(loop), decay, fastest, float(level.K[0]))
    return tuple((number(value),) for value in values)


def _damping(loop: ClosedLoop) -> float:
    return min(-pole.real / abs(pole) for pole in loop.poles.pencil)


def _caveats(region: RegionDesign) -> Iterator[Line]:
    if any(each.untaken for each in region.problem.polytope.vertices):
        yield (
            "A control point is a vertex of the polytope at which no plant stands: its poles bound those of plants "
            "nearby.",
        )
    yield (
        "These are the poles of the linearisation at ",
        Math("q_d"),
        ". A plant that differs from the nominal one has other gravity too, which the law does not compensate: it "
        "comes to rest a little beside ",
        Math("q_d"),
        ", by what the table of steady-state errors gives for the force ",
        Math("d = hat(g) - g"),
        ".",
    )
