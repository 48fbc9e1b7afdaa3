"""The linearised poles."""

from __future__ import annotations

from firmtouch.design import Design
from firmtouch.report.document import Equation, Figure, Line, Math, Paragraph, Section, Table
from firmtouch.report.figures import s_plane
from firmtouch.report.numbers import complex_number, number


def section(design: Design) -> Section:
    """Write the poles."""
    disagreement = design.loop.poles.disagreement
    return Section(
        "Poles",
        (
            Equation("M dot.double(delta q) + C dot(delta q) + K delta q = J^T (I + G_f) delta lambda", "(19)"),
            Equation("J delta q = 0, quad K = W + N_0", "(20)"),
            _table(design),
            Figure(
                s_plane(design.achieved, design.requested),
                ("Poles of the closed loop: requested (rings) and achieved (crosses).",),
                f"Complex plane with {len(design.achieved)} poles, all to the left of the imaginary axis",
                0.66,
            ),
            Paragraph(
                (
                    "The achieved poles are computed again from the finished gains, as the finite eigenvalues of the "
                    "whole pencil (19), (20); the reduced equation (38) on ",
                    Math("ker J"),
                    f" gives the same to {number(disagreement, 2)}. Largest deviation of a pole from the one asked, "
                    f"relative to it: {number(design.residual, 2)}.",
                )
            ),
        ),
    )


def _table(design: Design) -> Table:
    headings: tuple[Line, ...] = (
        ("requested, 1/s",),
        ("achieved, 1/s",),
        ("damping ratio",),
        ("frequency, rad/s",),
        ("time constant, s",),
    )
    rows = []
    for asked, got in zip(design.requested, design.achieved, strict=True):
        damping, constant = -got.real / abs(got), -1 / got.real
        row = (complex_number(asked), complex_number(got, 6), number(damping, 3), number(abs(got)), number(constant, 3))
        rows.append(tuple((text,) for text in row))
    return Table(headings, tuple(rows), frozenset(range(5)))
