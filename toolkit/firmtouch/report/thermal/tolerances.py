"""What the tables' tolerances do to the rise time."""

from __future__ import annotations

from typing import Final

from firmtouch.report.document import Line, Paragraph, Section, Strong, Table
from firmtouch.report.numbers import number
from firmtouch.report.thermal.words import breakable, percent, quantity
from firmtouch.thermal.analysis import Analysis

MOST: Final = 8
"""Effects that are shown, the largest first."""


def section(analysis: Analysis) -> Section | None:
    """Write the effects; without tolerances there is nothing to write."""
    found = analysis.tolerances
    if found is None:
        return None
    text: Line = (
        f"The worst rise time ({found.metric.value}) is ",
        Strong(quantity(found.nominal, "s")),
        " by the numbers of the tables. Each of them is known to its tolerance. Independent errors add up to ",
        Strong(quantity(found.likely, "s")),
        ", and with every number at the end that is slower it is ",
        Strong(quantity(found.worst, "s")),
        ", computed anew. An exponent tells by how many per cent the rise time changes with one per cent of the "
        "number.",
    )
    headings: tuple[Line, ...] = (("what",), ("of",), ("known to ±",), ("exponent",), ("rise time ±",))
    shown = found.effects[:MOST]
    rows: list[tuple[Line, ...]] = [
        (
            (each.quantity,),
            (breakable(each.of),),
            (percent(each.tolerance),),
            (number(each.slope, 2),),
            (percent(each.effect, 2),),
        )
        for each in shown
    ]
    left = len(found.effects) - len(shown)
    caption: Line = (f"The {len(shown)} largest; {left} more do less.",) if left else ()
    return Section("Tolerances", (Paragraph(text), Table(headings, tuple(rows), frozenset({2, 3, 4}), caption)))
