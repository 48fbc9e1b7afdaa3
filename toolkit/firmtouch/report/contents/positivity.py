"""Positivity of (14), of C and of W, on both levels."""

from __future__ import annotations

from firmtouch.design import Design
from firmtouch.regulation.closed_loop import Positivity
from firmtouch.report.document import Equation, Figure, Line, Math, Paragraph, Section, Table
from firmtouch.report.figures import eigenvalue_chart
from firmtouch.report.numbers import number


def section(design: Design) -> Section:
    """Write the positivity."""
    loop = design.loop
    asked = design.model.spec.design.level
    return Section(
        "Positivity",
        (
            Equation("K = W + P_(q q)(q_d) - sum_j lambda_(d j) phi''_j (q_d) > 0", "(14)"),
            Equation("C > 0, quad W > 0"),
            Paragraph(
                (
                    "These conditions (Theorem 1, Corollary 2) make the closed loop locally asymptotically stable. "
                    "What is needed near ",
                    Math("q_d"),
                    " is less: ",
                    Math("K"),
                    " and ",
                    Math("C"),
                    " positive on the free directions ",
                    Math("ker J"),
                    f" (the tangent level). The design was asked to hold on the {asked} level.",
                )
            ),
            Table(
                (("level",), ("holds",), ("matrix",), ("eigenvalues",)),
                (*_rows("full", loop.full), *_rows("tangent", loop.tangent)),
                wide=frozenset({3}),
            ),
            Figure(
                eigenvalue_chart(loop.full, loop.tangent),
                ("Eigenvalues of K, C and W: of the full matrices (dots) and of their tangent blocks (squares).",),
                "Logarithmic chart of the eigenvalues of K, C and W on the full and the tangent level",
                0.78,
            ),
            Paragraph((f"The margin of (14) is its least eigenvalue, {number(float(loop.full.K[0]))} in SI units.",)),
        ),
    )


def _rows(level: str, positivity: Positivity) -> list[tuple[Line, ...]]:
    holds = "yes" if positivity.holds else "no"
    return [
        (
            (level if name == "K" else "",),
            (holds if name == "K" else "",),
            (Math(name),),
            (", ".join(number(float(each)) for each in values),),
        )
        for name, values in (("K", positivity.K), ("C", positivity.C), ("W", positivity.W))
    ]
