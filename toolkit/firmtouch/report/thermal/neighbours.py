"""What a pad feels of its neighbours."""

from __future__ import annotations

from typing import Final

from firmtouch.report.document import Line, Paragraph, Section, Table
from firmtouch.report.thermal.words import breakable, percent, quantity
from firmtouch.thermal.analysis import Analysis

LEAST: Final = 1e-5


def section(analysis: Analysis) -> Section | None:
    """Write the cross-talk, where there is a pitch."""
    if not analysis.crosstalk or analysis.sensor.pad is None:
        return None
    first, pad = analysis.crosstalk[0], analysis.sensor.pad
    text = (
        f"Pads of {quantity(2 * pad.radius, 'm')} across at a pitch of {quantity(pad.pitch, 'm')} feel each other's "
        f"heat through the object that both touch, {quantity(first.time, 's')} after the touch. “Next pad” is what it "
        "does to the object's face under a pad, of what that pad itself does, at equal heat flows; it blurs that part "
        f"of a signal by which objects differ. “In the signal” is what it takes off the whole signal. "
        f"Through the layers between two pads no more than a share of {_share(first.substrate)} passes."
    )
    whole = pad.count > 2
    headings: tuple[Line, ...] = (("object",), ("next pad",), ("in the signal",))
    if whole:
        headings = (*headings, (f"all {pad.count - 1} others",))
    rows: list[tuple[Line, ...]] = [
        (
            (breakable(each.object),),
            (_share(each.neighbour),),
            (_share(each.signal),),
            *(((_share(each.array),),) if whole else ()),
        )
        for each in analysis.crosstalk
    ]
    return Section("Neighbours", (Paragraph((text,)), Table(headings, tuple(rows), frozenset({1, 2, 3}))))


def _share(value: float) -> str:
    """Write a share; of what is next to nothing, no power of ten."""
    return percent(value) if value >= LEAST else f"< {percent(LEAST)}"
