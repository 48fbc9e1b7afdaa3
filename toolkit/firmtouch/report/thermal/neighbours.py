"""What a pad feels of its neighbours."""

from __future__ import annotations

from typing import Final

from firmtouch.report.document import Line, Paragraph, Section, Table
from firmtouch.report.thermal.words import percent, quantity
from firmtouch.thermal.analysis import Analysis

LEAST: Final = 1e-5


def section(analysis: Analysis) -> Section | None:
    """Write the cross-talk, where there is a pitch."""
    if not analysis.crosstalk or analysis.sensor.pad is None:
        return None
    first, pad = analysis.crosstalk[0], analysis.sensor.pad
    text = (
        f"Pads of {quantity(2 * pad.radius, 'm')} across at a pitch of {quantity(pad.pitch, 'm')} feel each other's "
        "heat through the object that both touch. Given is the rise of the object's face under the next pad, of that "
        f"under the pad itself, {quantity(first.time, 's')} after the touch."
    )
    headings: tuple[Line, ...] = (("object",), ("cross-talk",))
    rows: list[tuple[Line, ...]] = [((each.object,), (_share(each.neighbour),)) for each in analysis.crosstalk]
    return Section("Neighbours", (Paragraph((text,)), Table(headings, tuple(rows), frozenset({1}))))


def _share(value: float) -> str:
    """Write a share; of what is next to nothing, no power of ten."""
    return percent(value) if value >= LEAST else f"< {percent(LEAST)}"
