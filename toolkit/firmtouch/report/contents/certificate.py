"""What is proven about the gains, claim by claim."""

from __future__ import annotations

from typing import Final

from firmtouch.certificate.decision import Verdict
from firmtouch.certificate.question import Claim, Scope
from firmtouch.design import Design
from firmtouch.report.contents.prose import prose
from firmtouch.report.document import Code, Line, Paragraph, Section, Table
from firmtouch.report.numbers import bound, number

_SCOPES: Final = {
    Scope.NOMINAL: "nominal plant",
    Scope.VERTICES: "vertices",
    Scope.POLYTOPE: "all plants",
}


def section(design: Design) -> Section:
    """Write the certificate."""
    certificate = design.certificate
    varies = certificate.subject.plants.vary
    headings: tuple[Line, ...] = (("claim",), ("asked",), ("proven bound",), ("for",), ("by",), ("bits",))
    rows = tuple(_row(each, varies=varies) for each in certificate.claims)
    if not varies:  # one plant is all there is
        headings, rows = (*headings[:3], *headings[4:]), tuple((*row[:3], *row[4:]) for row in rows)
    numeric = frozenset({1, 2, len(headings) - 1})
    return Section(
        "Certificate",
        (
            Paragraph(_intro(design)),
            Table(headings, rows, numeric, wide=frozenset({0})),
            Paragraph(
                (
                    *prose(
                        "Bounds are rounded to the safe side. They are about the linearised loop at the exact point of "
                        "the surface next to q_d. Anyone can prove them again, without a solver: "
                    ),
                    Code(f"firmtouch verify certificate.json --model {design.model.name}.yaml"),
                )
            ),
        ),
    )


def _intro(design: Design) -> Line:
    count, missing = len(design.certificate.claims), len(design.certificate.open)
    found = (
        f"All {count} claims are proven"
        if not missing
        else f"Of {count} claims {count - missing} are proven, and {missing} not"
    )
    return prose(
        f"{found}, for the exact binary64 numbers of gains and parameters, all rounding enclosed (ball arithmetic). "
        "M, N0, J and the Hessians are enclosed at a point of the surface that is itself proven to exist. A matrix is "
        "positive definite where LDL^T has pivots that are certainly positive."
    )


def _row(claim: Claim, *, varies: bool) -> tuple[Line, ...]:
    unit = f" {claim.unit}" if claim.unit else ""
    sign = ">" if claim.relation == ">" else "<"
    asked = "" if claim.asked is None or claim.route == "comparison" else f"{sign} {number(claim.asked)}{unit}"
    sign = "=" if claim.figure == 0 else sign
    figure = f"{sign} {bound(claim.figure, upwards=claim.relation == '<')}{unit}"
    figure = figure if claim.verdict is Verdict.PROVEN else claim.verdict.value
    scope = _SCOPES[claim.scope] if varies else ""
    return prose(claim.words), (asked,), (figure,), (scope,), prose(claim.route), (str(claim.bits),)
