"""The model's checks."""

from __future__ import annotations

from firmtouch.checks import CheckResult
from firmtouch.design import Design
from firmtouch.report.contents.prose import prose
from firmtouch.report.document import Line, Paragraph, Section, Table
from firmtouch.report.numbers import number


def section(design: Design) -> Section:
    """Write the checks."""
    headings: tuple[Line, ...] = (("check",), ("holds",), ("figure",), ("bound",), ("found",))
    rows = tuple(_row(each) for each in design.checks.results)
    intro = "Is the model what it says it is? Each row holds a figure against a bound."
    return Section("Model checks", (Paragraph((intro,)), Table(headings, rows, frozenset({2, 3}), wide=frozenset({4}))))


def _row(result: CheckResult) -> tuple[Line, ...]:
    told = result.relation == "-"
    figure = "" if told else number(result.figure, 2)
    bound = "" if told else f"{'≤' if result.relation == '<=' else '≥'} {number(result.bound, 2)}"
    mark = "" if told else "yes" if result.holds else "no"
    return (prose(result.name), (mark,), (figure,), (bound,), prose(result.detail))
