"""The linearised poles."""

from __future__ import annotations

from firmtouch.design import Design
from firmtouch.report.contents.region_words import edges, is_uncertain, loops, pole_terms
from firmtouch.report.document import Equation, Figure, Line, Math, Paragraph, Section, Table
from firmtouch.report.figures import region_plane, s_plane
from firmtouch.report.figures.s_plane import FARTHEST
from firmtouch.report.numbers import complex_number, number


def section(design: Design) -> Section:
    """Write the poles."""
    return Section(
        "Poles",
        (
            Equation("M dot.double(delta q) + C dot(delta q) + K delta q = J^T (I + G_f) delta lambda", "(19)"),
            Equation("J delta q = 0, quad K = W + N_0", "(20)"),
            _table(design),
            _picture(design),
            Paragraph(_agreement(design)),
        ),
    )


def _picture(design: Design) -> Figure:
    count = len(design.achieved)
    if design.region is None:
        return Figure(
            s_plane(design.achieved, design.requested),
            ("Poles of the closed loop: requested (rings) and achieved (crosses).",),
            f"Complex plane with {count} poles, all to the left of the imaginary axis",
            0.66,
        )
    region, asked = design.region, edges(design.region)
    vertices = [each.poles.pencil for each in region.vertices] if is_uncertain(region) else []
    crosses = " (crosses)"
    if vertices:
        crosses = f": of the nominal plant (crosses), and at the {len(vertices)} vertices of the polytope (dots)"
    within = " in the region that was asked for (green)" if pole_terms(region) else ""
    further = _further(design, asked.bandwidth)
    return Figure(
        region_plane(design.achieved, vertices, decay=asked.decay, damping=asked.damping, bandwidth=asked.bandwidth),
        (f"Poles of the closed loop{within}{crosses}.{further}",),
        f"Complex plane with {count} poles of the nominal plant and those of {len(vertices)} vertices{within}",
        0.66,
    )


def _further(design: Design, bandwidth: float | None) -> str:
    """Tell of a disc that the picture leaves out."""
    farthest = max(abs(pole) for loop in loops(design) for pole in loop.poles.pencil)
    if bandwidth is None or bandwidth <= FARTHEST * farthest:
        return ""
    return f" The disc |s| ≤ {number(bandwidth)} rad/s reaches beyond the picture."


def _agreement(design: Design) -> Line:
    disagreement = number(design.loop.poles.disagreement, 2)
    both: Line = (
        "finite eigenvalues of the whole pencil (19), (20); the reduced equation (38) on ",
        Math("ker J"),
        f" gives the same to {disagreement}.",
    )
    if design.region is not None:
        return ("The poles are computed from the finished gains, as the ", *both)
    residual = f" Largest deviation of a pole from the one asked, relative to it: {number(design.residual, 2)}."
    return (
        "The achieved poles are computed again from the finished gains, as the ",
        *both[:-1],
        f"{both[-1]}{residual}",
    )


def _table(design: Design) -> Table:
    headings: tuple[Line, ...] = (
        ("achieved, 1/s",) if design.region is None else ("nominal pole, 1/s",),
        ("damping ratio",),
        ("frequency, rad/s",),
        ("time constant, s",),
    )
    rows: list[tuple[Line, ...]] = []
    for got in design.achieved:
        damping, constant = -got.real / abs(got), -1 / got.real
        texts = (complex_number(got, 6), number(damping, 3), number(abs(got)), number(constant, 3))
        rows.append(tuple((text,) for text in texts))
    if design.region is None:
        headings = (("requested, 1/s",), *headings)
        rows = [((complex_number(asked),), *row) for asked, row in zip(design.requested, rows, strict=True)]
    return Table(headings, tuple(rows), frozenset(range(len(headings))))
