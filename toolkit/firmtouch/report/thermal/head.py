"""The head of a thermal report: verdict, warnings, the numbers one looks for first, and the stack."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

from firmtouch.report.document import Block, Callout, Card, Cards, Figure, Paragraph, Section
from firmtouch.report.figures.thermal import stack_picture
from firmtouch.report.figures.thermal.stack import layout_of
from firmtouch.report.thermal.stack_view import stack_view
from firmtouch.report.thermal.verdict import study_verdict
from firmtouch.report.thermal.words import (
    METRICS,
    celsius,
    coded,
    outcome_words,
    quantity,
    requirement_words,
    tidied,
)
from firmtouch.thermal.analysis import Analysis
from firmtouch.thermal.study import Study

CARDS: Final = 9
"""Three rows of three."""


def section(study: Study) -> Section:
    """Write the head."""
    analysis = study.analysis
    mood = "good" if study.verdict == "met" else "warning"
    blocks: list[Block] = [Callout(mood, (study_verdict(study),))]
    blocks += [Callout("warning", coded(tidied(each))) for each in analysis.warnings]
    if analysis.spec.description:
        blocks.append(Paragraph((analysis.spec.description,)))
    blocks.append(Cards(tuple(_cards(analysis))[:CARDS]))
    blocks.append(_picture(analysis))
    return Section("", tuple(blocks))


def _card(words: str, label: str) -> Card:
    """Split a size into its number and its unit."""
    value, _, unit = words.partition(" ")
    return Card(value, unit, label)


def _cards(analysis: Analysis) -> Iterator[Card]:
    """Give what is asked, then what every sensor has."""
    known = {each.name for each in analysis.outcomes}
    for each in analysis.outcomes:
        worst = " at worst" if each.where else ""
        yield _card(outcome_words(each, each.reached), requirement_words(each, analysis.spec) + worst)
    sensor = analysis.sensor
    if "rise_time" not in known:
        own = [each.rise_10_90 for each in analysis.responses if each.drive == sensor.drive.mode]
        yield _card(quantity(max(own), "s"), f"{METRICS['10-90']} at worst")
    if "power_pad" not in known:
        power = analysis.heat.most
        if sensor.pad is None:
            yield _card(quantity(power, "W/m^2"), "largest heater power by area")
        else:
            yield _card(quantity(power * sensor.pad.area, "W"), "largest power of a pad")
    if "thickness" not in known:
        yield _card(quantity(sensor.stack.thickness, "m"), "thickness of the stack")
    if "surface_temperature" not in known:
        yield _card(celsius(analysis.heat.hottest), "hottest that the touched face gets")
    if (
        sensor.drive.mode == "constant_temperature"
        and "loop_margin" not in known
        and math.isfinite(analysis.loop_margin)
    ):
        yield _card(quantity(analysis.loop_margin, "1"), "modulus margin of the loop")


def _picture(analysis: Analysis) -> Figure:
    view = stack_view(analysis)
    layout = layout_of(view)
    caption = "The stack in cross-section, from what is touched inward"
    caption += (
        ", to scale" if layout.to_scale else ". Left: all of it to scale. Right: each entry high enough to be read"
    )
    if layout.cut:
        caption += f"; {_counted(len(layout.cut), 'layer')} between zigzag lines {_is(layout.cut)} cut short"
    if layout.raised:
        caption += f"; {_counted(len(layout.raised), 'entry')} {_is(layout.raised)} drawn thicker than to scale"
    caption += ". "
    if not layout.to_scale and len(layout.cut) + len(layout.raised) < len(view.bands):
        caption += "The others are to one scale. "
    names = ", ".join(f"{each.name} ({each.size})" for each in view.bands)
    alt = f"Cross-section of the stack, from the touched face inward: {names}; behind: {view.backing}"
    return Figure(stack_picture(view), (caption.strip(),), alt, 1.0, 2)


def _counted(count: int, word: str) -> str:
    many = {"layer": "layers", "entry": "entries"}[word]
    return f"{'one' if count == 1 else count} {word if count == 1 else many}"


def _is(which: frozenset[int]) -> str:
    return "is" if len(which) == 1 else "are"
