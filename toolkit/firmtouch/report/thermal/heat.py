"""The heat that the sensor takes, and what the reading's own heat does."""

from __future__ import annotations

import math
from collections.abc import Iterator

from firmtouch.report.document import Block, Line, Paragraph, Section, Table
from firmtouch.report.numbers import number
from firmtouch.report.thermal.words import celsius, percent, place_words, quantity
from firmtouch.thermal.analysis import Analysis


def section(analysis: Analysis) -> Section:
    """Write the heat."""
    headings: tuple[Line, ...] = (("what",), ("value",), ("where",))
    rows = tuple(((name,), (value,), (where,)) for name, value, where in _rows(analysis))
    blocks: list[Block] = [Table(headings, rows, frozenset({1}), wide=frozenset({2}))]
    own = analysis.own_heat
    if own is not None:
        limit = "it cannot run away" if math.isinf(own.runaway_power) else (
            f"it would run away at {quantity(own.runaway_power, 'W')}"
        )  # fmt: skip
        blocks.append(
            Paragraph(
                (
                    f"The reading's own current warms the sensed film by {quantity(own.rise, 'K')} while nothing is "
                    f"touched, at {quantity(own.effective_conductance, 'W')}/K to its surroundings; the feedback "
                    f"P|α|/δ is {percent(own.feedback_ratio)}, and {limit}.",
                )
            )
        )
    return Section("Heat", tuple(blocks))


def _rows(analysis: Analysis) -> Iterator[tuple[str, str, str]]:
    heat, pad = analysis.heat, analysis.sensor.pad
    where = place_words(heat.most_in)
    yield "power that holds the face, by area", quantity(heat.hold, "W/m^2"), "untouched"
    yield "most power by area", quantity(heat.most, "W/m^2"), where
    if heat.least < heat.hold:
        yield "least power by area", quantity(heat.least, "W/m^2"), ""
    if pad is not None:
        yield "power that holds a pad", quantity(heat.hold * pad.area, "W"), "untouched"
        yield "most power of a pad", quantity(heat.most * pad.area, "W"), where
        if pad.count > 1:
            all_touch = f"{number(pad.count)} pads, all touching" if where else f"{number(pad.count)} pads"
            yield "most power of all pads", quantity(heat.most * pad.area * pad.count, "W"), all_touch
    yield "hottest that the touched face gets", celsius(heat.hottest), ""
    own = [each for each in analysis.responses if each.drive == analysis.sensor.drive.mode]
    worst = max(own, key=lambda each: each.recovery)
    after = "never" if math.isinf(worst.recovery) else quantity(worst.recovery, "s")
    yield f"recovery after a touch of {quantity(worst.window, 's')}", after, place_words(worst.scenario.words)
